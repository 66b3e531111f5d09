"""The exact solver against its peers, on the same trajectories to the same accuracy, and maps of many blocks.

Cases    E1: block of 0.15 x 0.50 m, linear Method 1, 10 s of a 3 Hz sine that grows to 1 g.  E2: the same block, 30 s
         of noise at 200 Hz, straight between samples, band 0.5 to 25 Hz, peak 0.40 g; two seeds of which the runs have
         250 to 335 impacts.
Peers    this package's scipy and numba solvers; a bare solve_ivp with a terminal event at each impact, with a maximal
         step of one sample in place of a stop at each; heyoka's event detection on E1, if it is installed.
Measure  CPU time of a run after one that compiles, the least of several; `exact` as one run (with its Trajectory) and
         as the mean of a batch over blocks whose e differs in the sixth digit, on one thread; error of the fifth impact
         against the scipy solver at rtol 1e-13 (a batch gives the bits of single runs).
Run      python benchmarks/exact.py [--quick]  ->  a table, and benchmarks/results/exact.csv
"""

from __future__ import annotations

import argparse
import csv
import math
import platform
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from rocking import Block, Method1, solve
from rocking.solvers.exact_batch import RampedSines, ScaledRecord, exact_batch

RESULTS = Path(__file__).parent / "results" / "exact.csv"
BLOCK = Block(0.15, 0.50)
SYSTEM = Method1(BLOCK, form="linear")
G = SYSTEM.g
FIFTH = 4
HEAD = ["case", "solver", "cpu_us", "scipy_over_this", "solve_ivp_over_this", "impacts", "error_of_fifth_impact_s"]


def straight_acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """Straight between the samples par[3:], zero before and after."""
    last = int(par[2]) - 1
    k = max(0, min(int(xp.floor((t - par[0]) / par[1])), last - 1))
    share = (t - (par[0] + k * par[1])) / par[1]
    inside = (t >= par[0]) & (t <= par[0] + last * par[1])
    return xp.where(inside, par[3 + k] + share * (par[4 + k] - par[3 + k]), 0.0), 0.0 * t


class Noise:
    """Band-limited noise, straight between samples."""

    kernel = staticmethod(straight_acceleration)
    max_step = math.inf

    def __init__(self, seed: int, dt: float = 0.005, duration: float = 30.0, peak: float = 0.4 * G) -> None:
        n = round(duration / dt) + 1
        spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal(n))
        frequency = np.fft.rfftfreq(n, dt)
        spectrum[(frequency < 0.5) | (frequency > 25.0)] = 0.0
        a = np.fft.irfft(spectrum, n)
        self.values = peak * a / np.abs(a).max()
        self.piecewise_linear = (0.0, dt, self.values)
        self.parameters = np.concatenate([[0.0, dt, n], self.values])
        self.breakpoints = tuple(dt * k for k in range(n))


def ramp_acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """par[2] t sin(par[0] t) from 0 to par[1]."""
    return xp.where((t >= 0.0) & (t <= par[1]), par[2] * t * xp.sin(par[0] * t), 0.0), 0.0 * t


class Ramp:
    """A sine that grows to 1 g."""

    kernel = staticmethod(ramp_acceleration)
    max_step = 0.05 / 3.0

    def __init__(self) -> None:
        self.omega, self.duration, self.rate = 6.0 * math.pi, 10.0, G / 10.0
        self.parameters = np.array([self.omega, self.duration, self.rate])
        self.ramped_sine = (self.omega, 0.0, self.rate, self.duration)
        self.breakpoints = (0.0, self.duration)


def least(work: Callable[[], Any], runs: int) -> tuple[float, Any]:
    """(least CPU time [s] of several runs after a first one, result)."""
    result, times = work(), []
    for _ in range(runs):
        start = time.process_time()
        result = work()
        times.append(time.process_time() - start)
    return min(times), result


def bare_solve_ivp(motion: Any, t_end: float, method: str) -> np.ndarray:
    """Impact times by SciPy's own event loop, with the rest rule and the threshold of the linear Method 1."""
    from scipy.integrate import solve_ivp

    from rocking import scalars

    p2, alpha, g, onset, e, omega_rest = SYSTEM.parameters
    par = [float(v) for v in motion.parameters]

    def a_x(t: float) -> float:
        return motion.kernel(scalars, t, par)[0]

    def impact(t: float, y: Any) -> float:
        return s * y[0]

    def tip(t: float, y: Any) -> float:
        return onset * g - abs(a_x(t))

    impact.terminal, impact.direction = True, -1.0  # type: ignore[attr-defined]
    tip.terminal, tip.direction = True, -1.0  # type: ignore[attr-defined]

    def stand(t: float, y: Any) -> tuple[float, float]:
        return 0.0, 0.0

    def rock(t: float, y: Any) -> tuple[float, float]:
        return y[1], p2 * (y[0] - s * alpha - a_x(t) / g)

    t, y, s, resting, impacts = 0.0, [0.0, 0.0], 1.0, True, []
    while t < t_end:
        right, event = (stand, tip) if resting else (rock, impact)
        # With a longer step solve_ivp misses swings that begin and end within one, and the kinks of a record.
        part = solve_ivp(right, (t, t_end), y, method=method, events=event, rtol=1e-10, atol=1e-13, max_step=0.005)
        t = float(part.t[-1])
        if part.status != 1:
            break
        if resting:
            resting, s, y = False, -math.copysign(1.0, a_x(t)), [0.0, 0.0]
        else:
            impacts.append(t)
            omega = e * float(part.y[1, -1])
            s = -s
            resting = abs(omega) < omega_rest and abs(a_x(t)) <= onset * g
            y = [0.0, 0.0 if resting else omega]
    return np.array(impacts)


def heyoka_runner() -> Callable[[], np.ndarray] | None:
    """Impact times of E1 by heyoka's event detection; None if heyoka is not installed."""
    try:
        import heyoka as hy
    except ImportError:
        return None
    p2, alpha, g, onset, e, omega_rest = SYSTEM.parameters
    theta, omega = hy.make_vars("theta", "omega")
    motion = Ramp()
    s = hy.par[0]
    a_x = motion.rate * hy.time * hy.sin(motion.omega * hy.time)
    flow = [(theta, omega), (omega, p2 * (theta - s * alpha - a_x / g))]
    impacts: list[float] = []

    def strike(ta: Any, d_sgn: int) -> bool:
        impacts.append(ta.time)
        after = e * ta.state[1]
        ta.state[:] = [0.0, after]
        ta.pars[0] = -ta.pars[0]
        now = motion.rate * ta.time * math.sin(motion.omega * ta.time)
        rests = abs(after) < omega_rest and abs(now) <= onset * g
        return not rests  # False stops here: the block stands

    event = hy.t_event(s * theta, callback=strike, direction=hy.event_direction.negative)
    rocking = hy.taylor_adaptive(flow, [0.0, 0.0], pars=[1.0], t_events=[event], tol=1e-15)
    times = np.linspace(0.0, motion.duration, 4001)
    pushes = motion.rate * times * np.sin(motion.omega * times)

    def next_tip(t: float) -> float:
        """First time from t on at which |a_x| rises through the threshold; inf if there is none."""
        from scipy.optimize import brentq

        after = np.flatnonzero((times > t) & (np.abs(pushes) > onset * g))
        if len(after) == 0:
            return math.inf
        k = int(after[0])
        return float(
            brentq(
                lambda x: abs(motion.rate * x * math.sin(motion.omega * x)) - onset * g, max(times[k - 1], t), times[k]
            )
        )

    def run() -> np.ndarray:
        impacts.clear()
        t = next_tip(0.0)
        while t < motion.duration:
            push = motion.rate * t * math.sin(motion.omega * t)
            rocking.time, rocking.state[:], rocking.pars[0] = t, [0.0, 0.0], -math.copysign(1.0, push)
            rocking.reset_cooldowns()
            rocking.propagate_until(motion.duration)
            t = next_tip(rocking.time) if rocking.time < motion.duration else math.inf
        return np.array(impacts)

    return run


def compare(case: str, motion: Any, t_end: float, quick: bool) -> list[list[str]]:
    """Rows of one case: each solver's CPU time, and the accuracy that it reaches."""
    reference = solve(SYSTEM, motion, t_end=t_end, solver="scipy", save_at=(), rtol=1e-13, atol=1e-15).impact_times
    slow = 1 if quick else 3

    def by(solver: str) -> Callable[[], np.ndarray]:
        return lambda: solve(SYSTEM, motion, t_end=t_end, solver=solver, save_at=(), rtol=1e-9, atol=1e-12).impact_times

    measured = {"scipy": least(by("scipy"), slow)}
    measured |= {
        f"solve_ivp {m}": least(lambda m=m: bare_solve_ivp(motion, t_end, m), slow) for m in ("RK45", "DOP853")
    }
    measured["numba"] = least(by("numba"), 10)
    measured["exact, one run"] = least(by("exact"), 50)
    if case.startswith("E1") and (heyoka := heyoka_runner()) is not None:
        measured["heyoka"] = least(heyoka, 20)
    count = 2000
    near = SYSTEM.e * (1.0 + 1e-6 * np.linspace(-1.0, 1.0, count + 1))
    shaken = (
        RampedSines(*motion.ramped_sine[::2], 10.0) if case.startswith("E1") else ScaledRecord(motion.values, 0.005)
    )
    seconds, batch = least(lambda: run_batch(shaken, near, t_end), 5)
    row = f"exact, batch of {count + 1}"
    measured[row] = (seconds / (count + 1), measured["exact, one run"][1])
    bare = min(measured[name][0] for name in measured if name.startswith("solve_ivp"))
    rows = []
    for name, (cpu, impacts) in measured.items():
        error = abs(float(impacts[FIFTH]) - float(reference[FIFTH]))
        number = float(batch.impacts.mean()) if name == row else float(len(impacts))
        ratios = [f"{measured['scipy'][0] / cpu:.4g}", f"{bare / cpu:.4g}"]
        rows.append([case, name, f"{cpu * 1e6:.4g}", *ratios, f"{number:.0f}", f"{error:.1e}"])
    return rows


def run_batch(motion: Any, e: Any, t_end: float, workers: int = 1, **options: Any) -> Any:
    """A batch of the block of all cases."""
    par = SYSTEM.parameters
    arguments = {"p": math.sqrt(par.p2), "alpha": par.alpha, "onset": par.onset, **options}
    return exact_batch(motion, e=e, t_end=t_end, workers=workers, **arguments)


def time_map(case: str, motion: Any, t_end: float, **options: Any) -> list[list[str]]:
    """Wall and CPU time of a map on two threads."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = run_batch(motion, SYSTEM.e, t_end, 2, **options)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    label = f"{case}: {wall:.2f} s wall, {cpu:.2f} s CPU, {result.overturned.mean():.0%} overturned"
    return [
        [
            label,
            "exact, 2 threads",
            f"{cpu / result.overturned.size * 1e6:.4g}",
            "",
            "",
            f"{result.impacts.mean():.0f}",
            "",
        ]
    ]


def maps(quick: bool) -> list[list[str]]:
    """The two maps."""
    n = 50 if quick else 200
    frequency, amplitude = np.linspace(0.5, 5.0, n)[:, None], np.linspace(0.3, 4.0, n) * G
    rows = time_map(
        f"{n} x {n} ramped sines, 0.5-5 Hz, 0.3-4 g", RampedSines(2 * np.pi * frequency, amplitude / 10, 10.0), 10.0
    )
    n = 100 if quick else 1000
    h, scale = np.geomspace(0.2, 5.0, n)[:, None], np.linspace(0.2, 3.0, n)
    p = np.sqrt(0.75 * G / (0.5 * h * math.hypot(0.3, 1.0)))
    return rows + time_map(
        f"{n} x {n} record of 30 s, h 0.2-5 m, peak 0.08-1.2 g",
        ScaledRecord(Noise(0).values, 0.005, scale=scale),
        30.0,
        p=p,
    )


def main() -> None:
    """Measure, print and save."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few runs and small maps")
    quick = parser.parse_args().quick
    rows = compare("E1", Ramp(), 10.0, quick)
    rows += [
        row for seed in ((0,) if quick else (0, 17)) for row in compare(f"E2, seed {seed}", Noise(seed), 30.0, quick)
    ]
    rows += maps(quick)
    for row in [HEAD, *rows]:
        print("  ".join(f"{cell:20s}" for cell in row).rstrip())
    RESULTS.parent.mkdir(exist_ok=True)
    with RESULTS.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*HEAD, "python", "machine"])
        writer.writerows([*row, platform.python_version(), platform.machine()] for row in rows)
    print(f"wrote {RESULTS}")


if __name__ == "__main__":
    main()
