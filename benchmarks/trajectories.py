"""How long does one rocking trajectory take, and how far is that from what the arithmetic alone would take?

Cases    E1 and E2 of `cases.py`, Method 1 linear and nonlinear.
Peers    a bare solve_ivp with terminal events (the best of RK45, DOP853, LSODA), heyoka's events, Boost.Odeint (C++)
         with dense output and CVODE (C) with root finding, both compiled on the spot, and this package's solvers scipy,
         numba, diffrax; each left out with a sentence where it does not run.
Measure  CPU time of a run after one that compiles, the least of several, on one thread; `exact` and `taylor` as one run
         (with its Trajectory) and as the mean of a batch over 2001 blocks whose e differs in the sixth digit; number of
         impacts; error of the fifth impact against the taylor solver, whose own against SciPy at rtol 1e-13 is in the
         row of `taylor`.
Floor    the floating operations of the steps and impacts of a run, counted by running the rules of the flights on
         symbols that count, over the rate at which this core does fused multiply-adds (measured here): what a run would
         take if nothing waited, nothing was decided and no lane was idle.
Run      python benchmarks/trajectories.py [--quick]  ->  a table, and benchmarks/results/trajectories.csv
"""

from __future__ import annotations

import argparse
import csv
import math
import platform
import time
from pathlib import Path
from typing import Any

import numpy as np
from cases import BLOCK, FIFTH, acceleration, cases, least
from peers.bare_scipy import impacts_by_solve_ivp
from peers.compiled import BUILDS
from peers.compiled import run as run_compiled
from peers.heyoka_events import heyoka_runner

from rocking import Method1, solve
from rocking.solvers import load
from rocking.solvers.arrays import taylor_batch
from rocking.solvers.exact.batch import RampedSines, ScaledRecord, exact_batch

RESULTS = Path(__file__).parent / "results" / "trajectories.csv"
HEAD = ["case", "form", "by", "cpu_us", "solve_ivp_over_this", "this_over_floor", "impacts", "error_of_fifth_impact_s"]
COUNT = 2001


class Counter:
    """A symbol that counts the operations on it."""

    operations = 0

    def _one(self, *others: Any) -> Counter:
        Counter.operations += 1
        return self

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __neg__ = __gt__ = __lt__ = _one

    def like(self, other: Any) -> Counter:
        return self


def operations_of_a_step(form: str, wave: bool) -> int:
    """Multiplications, additions and fused pairs of a flight with its end, by the rules that emit them."""
    from rocking.solvers.taylor import flight as rules

    kept = rules.fma_of, rules.most_of
    rules.fma_of, rules.most_of = (lambda a, b, c: Counter()._one()), (lambda a, b: Counter()._one())  # type: ignore
    Counter.operations, x = 0, Counter()
    try:
        if form == "linear" and not wave:
            rules.glide(x, x, (x, x), x, x, x, x)
            return Counter.operations
        push = rules.push_on_sine(x, x, x, x, x) if wave else (x, x)
        c = rules.flight(x, x, push, x, x, None if form == "linear" else (x, x), x)
        rules.value(c, x), rules.slope(c, x)
    finally:
        rules.fma_of, rules.most_of = kept
    return Counter.operations


def fused_per_second() -> float:
    """Fused multiply-adds that one core does in a second, counted by element."""
    import numba

    from rocking.solvers.taylor.vector import LANES, fma, load, store

    @numba.njit(error_model="numpy")
    def work(t: Any, n: int) -> None:
        a, b, c, d, e, f = load(t, 0), load(t, 1), load(t, 2), load(t, 3), load(t, 4), load(t, 5)
        x = load(t, 6)
        for _ in range(n):
            a, b, c = fma(a, x, x), fma(b, x, x), fma(c, x, x)
            d, e, f = fma(d, x, x), fma(e, x, x), fma(f, x, x)
        for i, v in enumerate((a, b, c, d, e, f)):
            store(t, i, v)

    table, n = np.full((7, LANES), 0.5), 2_000_000
    seconds, _ = least(lambda: work(table, n), 5)
    return 6 * LANES * n / seconds


def floor_us(form: str, motion: Any, run: Any, per_second: float) -> float:
    """Time [us] of the arithmetic alone: a step for each sample (each eighth of a turn) while it rocks, two an
    impact."""
    wave = getattr(motion, "ramped_sine", None)
    interval = motion.piecewise_linear[1] if wave is None else 1.0 / (8.0 * wave[0])
    steps = run.mode_durations()[2] / interval + 2 * len(run.impact_times)
    return steps * operations_of_a_step(form, wave is not None) / per_second * 1e6


def batch_time(system: Any, motion: Any, t_end: float, runs: int) -> tuple[float, np.ndarray]:
    """(CPU time of a run in a batch [s], impacts of each)."""
    par = system.parameters
    wave = getattr(motion, "ramped_sine", None)
    base = RampedSines(wave[0], wave[2], wave[3]) if wave else ScaledRecord(motion.a_x, motion.piecewise_linear[1])
    near = par.e * (1.0 + 1e-6 * np.linspace(-1.0, 1.0, COUNT))
    carry = exact_batch if system.form == "linear" else taylor_batch
    same = {"p": math.sqrt(par.p2), "alpha": par.alpha, "g": par.g, "workers": 1, "t_end": t_end}
    seconds, result = least(lambda: carry(base, e=near, **same), runs)
    return seconds / COUNT, result.impacts


def measured(system: Any, motion: Any, t_end: float, quick: bool) -> dict[str, tuple[float, np.ndarray] | str]:
    """(CPU time [s], impact times [s]) by peer, or a sentence."""
    a_x, slow = acceleration(motion), 1 if quick else 3
    found: dict[str, Any] = {}
    for method in ("RK45", "DOP853", "LSODA"):
        found[f"solve_ivp {method}"] = least(lambda m=method: impacts_by_solve_ivp(system, a_x, t_end, m), slow)
    runner = heyoka_runner(system, motion, a_x, t_end)
    found["heyoka"] = runner if isinstance(runner, str) else least(runner, 10)
    for name in BUILDS:
        found[name] = run_compiled(name, system, motion, t_end, 20, 1e-10)
    for name, runs in (("scipy", slow), ("diffrax", 3), ("numba", 10), ("exact", 50), ("taylor", 50)):
        refusal = load(name).declines(system, motion)
        if refusal is not None:
            found[name] = f"{name} left out: {refusal}"
        elif not (quick and name == "diffrax"):
            found[name] = least(
                lambda n=name: (
                    solve(system, motion, t_end=t_end, solver=n, save_at=(), rtol=1e-9, atol=1e-12).impact_times
                ),
                runs,
            )
    return found


def compare(case: str, form: Any, motion: Any, t_end: float, per_second: float, quick: bool) -> list[list[str]]:
    """Rows of one case."""
    system = Method1(BLOCK, form=form)
    found = measured(system, motion, t_end, quick)
    run = solve(system, motion, t_end=t_end, solver="taylor", save_at=())
    until = float(run.impact_times[FIFTH]) + 1e-3
    sharp = solve(system, motion, t_end=until, solver="scipy", save_at=(), rtol=1e-13, atol=1e-15)
    seconds, impacts = batch_time(system, motion, t_end, 5)
    floor = floor_us(form, motion, run, per_second)
    bare = min(v[0] for name, v in found.items() if name.startswith("solve_ivp"))
    found[f"taylor, batch of {COUNT}"] = (seconds, run.impact_times)
    rows = []
    for name, value in found.items():
        if isinstance(value, str):
            print(f"{case} {form}: {value}")
            continue
        cpu, times = value
        against = sharp.impact_times if name.startswith("taylor") else run.impact_times
        error = abs(float(times[FIFTH]) - float(against[FIFTH]))
        number = impacts.mean() if "batch" in name else len(times)
        numbers = [f"{cpu * 1e6:.4g}", f"{bare / cpu:.4g}", f"{cpu * 1e6 / floor:.3g}", f"{number:.0f}", f"{error:.1e}"]
        rows.append([case, form, name, *numbers])
    rows.append([case, form, "arithmetic alone", f"{floor:.3g}", f"{bare * 1e6 / floor:.4g}", "1", "", ""])
    return rows


def main() -> None:
    """Measure, print and save."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few runs, without diffrax")
    quick = parser.parse_args().quick
    begin, per_second, rows = time.perf_counter(), fused_per_second(), []
    print(f"one core: {per_second * 1e-9:.1f}e9 fused multiply-adds a second")
    for case, (motion, t_end) in cases().items():
        for form in ("linear", "nonlinear"):
            rows += compare(case, form, motion, t_end, per_second, quick)
    for row in [HEAD, *rows]:
        print("  ".join(f"{cell:21s}" for cell in row).rstrip())
    RESULTS.parent.mkdir(exist_ok=True)
    with RESULTS.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*HEAD, "python", "machine"])
        writer.writerows([*row, platform.python_version(), platform.machine()] for row in rows)
    print(f"wrote {RESULTS} in {time.perf_counter() - begin:.0f} s")


if __name__ == "__main__":
    main()
