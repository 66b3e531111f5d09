"""Time of one trajectory by each installed solver, side by side in one run, with the accuracy that each reaches.

Case     Block 3 of Winkler, Meguro & Yamazaki (1995) under a 3 Hz sinusoid that grows to 1 g in 10 s; Method 1 linear
         and nonlinear, Method 2 with friction 0.7.
Measure  CPU time of a run after a first one that compiles, the median of several; the error of the fifth impact
         against the SciPy solver at rtol 1e-13; the ratio to the SciPy solver at the same tolerances.
Run      python benchmarks/solvers.py [--runs N]  ->  a table, and benchmarks/results/solvers.csv
"""

from __future__ import annotations

import argparse
import csv
import platform
import statistics
import time
from pathlib import Path

from excitation import RampedSinusoid
from rocking import Block, Method1, Method2, solve
from rocking.solvers import available, load

RESULTS = Path(__file__).parent / "results" / "solvers.csv"
BLOCK = Block(0.15, 0.50, 0.25)
SYSTEMS = {
    "Method 1, linear": Method1(BLOCK, form="linear"),
    "Method 1, nonlinear": Method1(BLOCK),
    "Method 2": Method2(BLOCK, friction=0.7),
}
MOTION = RampedSinusoid(frequency=3.0, duration=10.0, final_amplitude=9.80665)
TOLERANCES = {"rtol": 1e-9, "atol": 1e-12}
FIFTH = 4


def cpu_time(system, solver: str, runs: int) -> tuple[float, float]:
    """(median CPU time of a run [s], time of the fifth impact [s])."""
    times = []
    for _ in range(runs + 1):
        start = time.process_time()
        run = solve(system, MOTION, t_end=10.0, solver=solver, save_at=(), **TOLERANCES)
        times.append(time.process_time() - start)
    return statistics.median(times[1:]), float(run.impact_times[FIFTH])


def main() -> None:
    """Measure, print and save."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=5, help="runs of each solver that count (default: %(default)s)")
    runs = parser.parse_args().runs
    rows = []
    for label, system in SYSTEMS.items():
        exact = solve(system, MOTION, t_end=10.0, solver="scipy", save_at=(), rtol=1e-13, atol=1e-15)
        able = [solver for solver in available() if load(solver).declines(system, MOTION) is None]
        measured = {solver: cpu_time(system, solver, runs) for solver in able}
        reference, _ = measured["scipy"]
        for solver, (seconds, impact) in measured.items():
            error = abs(impact - float(exact.impact_times[FIFTH]))
            rows.append([label, solver, f"{seconds * 1e6:.0f}", f"{reference / seconds:.0f}", f"{error:.1e}"])
    head = ["case", "solver", "cpu_us", "times_faster_than_scipy", "error_of_fifth_impact_s"]
    for row in [head, *rows]:
        print("  ".join(f"{cell:24s}" for cell in row).rstrip())
    RESULTS.parent.mkdir(exist_ok=True)
    with RESULTS.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows(
            [[*head, "python", "machine"], *([*r, platform.python_version(), platform.machine()] for r in rows)]
        )
    print(f"wrote {RESULTS}")


if __name__ == "__main__":
    main()
