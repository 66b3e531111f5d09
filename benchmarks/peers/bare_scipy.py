"""Method 1 by SciPy's own event loop: a terminal event at each impact, no step longer than 5 ms."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp


def impacts_by_solve_ivp(system: Any, a_x: Callable[[float], float], t_end: float, method: str) -> np.ndarray:
    """Impact times [s] at rtol 1e-10."""
    par = system.parameters
    p2, alpha, g, onset, e = par.p2, par.alpha, par.g, par.onset, par.e

    def impact(t: float, y: Any) -> float:
        return s * y[0]

    def tip(t: float, y: Any) -> float:
        return onset * g - abs(a_x(t))

    def fall(t: float, y: Any) -> float:
        return 0.5 * math.pi - abs(y[0])

    for event in (impact, tip, fall):
        event.terminal, event.direction = True, -1.0  # type: ignore[attr-defined]

    def stand(t: float, y: Any) -> tuple[float, float]:
        return 0.0, 0.0

    def linear(t: float, y: Any) -> tuple[float, float]:
        return y[1], p2 * (y[0] - s * alpha - a_x(t) / g)

    def nonlinear(t: float, y: Any) -> tuple[float, float]:
        psi = alpha - s * y[0]
        return y[1], -p2 * (s * math.sin(psi) + a_x(t) / g * math.cos(psi))

    rock = linear if system.form == "linear" else nonlinear
    t, y, s, resting, impacts = 0.0, [0.0, 0.0], 1.0, True, []
    while t < t_end:
        right, events = (stand, (tip,)) if resting else (rock, (impact, fall))
        # With a longer step solve_ivp misses swings that begin and end within one, and the kinks of a record.
        part = solve_ivp(right, (t, t_end), y, method=method, events=events, rtol=1e-10, atol=1e-13, max_step=0.005)
        t = float(part.t[-1])
        if part.status != 1 or (not resting and len(part.t_events[1])):
            break
        if resting:
            resting, s, y = False, -math.copysign(1.0, a_x(t)), [0.0, 0.0]
        else:
            impacts.append(t)
            omega = e * float(part.y[1, -1])
            s = -s
            resting = abs(omega) < par.omega_rest and abs(a_x(t)) <= onset * g
            y = [0.0, 0.0 if resting else omega]
    return np.array(impacts)
