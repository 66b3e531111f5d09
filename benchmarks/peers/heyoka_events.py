"""Method 1 by heyoka's Taylor integrator and its terminal events; a record goes sample by sample."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np


def heyoka_runner(
    system: Any, motion: Any, a_x: Callable[[float], float], t_end: float
) -> Callable[[], np.ndarray] | str:
    """A function that gives the impact times [s], or a sentence on why there is none."""
    try:
        import heyoka as hy
    except ImportError:
        return "heyoka left out: not installed"
    par = system.parameters
    theta, omega = hy.make_vars("theta", "omega")
    s, wave = hy.par[0], getattr(motion, "ramped_sine", None)
    base = wave[2] * hy.time * hy.sin(wave[0] * hy.time) if wave else hy.par[1] + hy.par[2] * (hy.time - hy.par[3])
    push = base / par.g
    psi = par.alpha - s * theta
    pull = s * psi + push if system.form == "linear" else s * hy.sin(psi) + push * hy.cos(psi)
    impacts: list[float] = []

    def strike(ta: Any, d_sgn: int) -> bool:
        impacts.append(ta.time)
        after = par.e * ta.state[1]
        ta.state[:] = [0.0, after]
        ta.pars[0] = -ta.pars[0]
        return not (abs(after) < par.omega_rest and abs(a_x(ta.time)) <= par.onset * par.g)  # False: the block stands

    event = hy.t_event(s * theta, callback=strike, direction=hy.event_direction.negative)
    flow = [(theta, omega), (omega, -par.p2 * pull)]
    rocking = hy.taylor_adaptive(
        flow, [0.0, 0.0], pars=[1.0] if wave else [1.0, 0.0, 0.0, 0.0], t_events=[event], tol=1e-15
    )
    grid = np.linspace(0.0, t_end, 4001) if wave else motion.piecewise_linear[1] * np.arange(len(motion.a_x))
    above = np.abs([a_x(t) for t in grid]) > par.onset * par.g

    def next_tip(t: float) -> float:
        """First time from t on at which |a_x| exceeds the threshold; inf if there is none."""
        from scipy.optimize import brentq

        after = np.flatnonzero(above & (grid > t))
        if len(after) == 0:
            return math.inf
        k = int(after[0])
        return float(brentq(lambda x: abs(a_x(x)) - par.onset * par.g, max(grid[k - 1], t), grid[k], xtol=1e-15))

    def carry(t: float) -> bool:
        """On to the end of the run or, over a record, of the sample; whether the block still rocks."""
        if wave:
            rocking.propagate_until(t_end)
            return rocking.time >= t_end
        dt, values = motion.piecewise_linear[1:]
        k = min(int(t / dt + 1e-9), len(values) - 2)
        while k < len(values) - 1:
            rocking.pars[1:] = [values[k], (values[k + 1] - values[k]) / dt, k * dt]
            rocking.propagate_until((k + 1) * dt)
            if rocking.time < (k + 1) * dt - 1e-12:
                return False
            k += 1
        return True

    def run() -> np.ndarray:
        impacts.clear()
        t = next_tip(0.0)
        while t < t_end:
            rocking.time, rocking.state[:], rocking.pars[0] = t, [0.0, 0.0], -math.copysign(1.0, a_x(t))
            rocking.reset_cooldowns()
            t = math.inf if carry(t) else next_tip(rocking.time)
        return np.array(impacts)

    return run
