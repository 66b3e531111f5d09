"""Sweeps of criteria over one core and over all of them, and what keeping the chunks costs.

Cases    method1, method2, dem: the criteria of Fig. 16 at 1600 (distinct elements: 40) points over height, slenderness
         and frequency, ramps of 10 s to 4 g; chunks of 64 (4) points
Peers    the same points in one call of `studies.sweep.evaluation.evaluate` on one thread, with no chunk and no file:
         what the runs alone take
Measure  wall and CPU time after a first sweep of a few points that compiles; the best of several, taken in turns;
         "times faster" is the wall time on one worker over this one, "over the runs" this CPU time over the peer's
Load     mean load of the machine in the minute before (column "load"): where it is 0.5 or more, other work took its
         share of the wall times
Run      python benchmarks/sweeps.py [--runs N]  ->  a table, and benchmarks/results/sweeps.csv
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import platform
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from studies import sweep
from studies.sweep.evaluation import evaluate

RESULTS = Path(__file__).parent / "results" / "sweeps.csv"
RAMP = {"ramp": {"kind": "ramped_sinusoid", "duration": 10.0, "final_amplitude": 4.0 * 9.80665}}
POINTS = {"method1": (40, 64), "method2": (40, 64), "dem": (1, 4)}
"""Heights, and points of a chunk; 5 slendernesses and 8 frequencies come with each height."""


def plan(method: str, heights: int) -> sweep.Sweep:
    """The points of a method."""
    axes = {
        "h": np.linspace(0.25, 1.0, heights).tolist(),
        "slenderness": np.linspace(0.2, 0.4, 5).tolist(),
        "frequency": np.linspace(1.0, 4.5, 8).tolist(),
    }
    return sweep.Sweep(axes=axes, fixed={"method": method}, excitations=RAMP)


def times(work: Callable[[], Any]) -> tuple[float, float]:
    """(wall, CPU) time [s]."""
    wall, cpu = time.perf_counter(), time.process_time()
    work()
    return time.perf_counter() - wall, time.process_time() - cpu


def carried_out(declared: sweep.Sweep, workers: int, points: int, number: list[int]) -> None:
    """The whole sweep into a folder of its own."""
    number[0] += 1
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / f"{number[0]}.nc"
        sweep.run(declared, out, workers=workers, chunk_points=points, progress=False).close()


def measured(method: str, workers: list[int], runs: int) -> list[dict[str, Any]]:
    """Rows of a method: the runs alone, and the sweep by number of workers."""
    heights, points = POINTS[method]
    declared, number = plan(method, heights), [0]
    whole = [(0, size) for size in declared.shape]
    work: dict[str, Callable[[], Any]] = {"runs alone": lambda: evaluate(json.loads(declared.as_json()), whole)}
    work |= {
        f"{n} worker{'s' * (n > 1)}": lambda n=n: carried_out(declared, n, points, number)  # type: ignore[misc]
        for n in workers
    }
    evaluate(json.loads(declared.as_json()), [(0, 1), (0, 1), (0, 2)])
    taken: dict[str, list[tuple[float, float]]] = {name: [] for name in work}
    for _ in range(runs):
        for name, run in work.items():
            taken[name].append(times(run))
    best = {name: (min(wall for wall, _ in found), min(cpu for _, cpu in found)) for name, found in taken.items()}
    first = best[f"{workers[0]} worker"][0]
    return [
        {
            "method": method, "points": declared.size, "by": name, "wall_s": f"{wall:.2f}", "cpu_s": f"{cpu:.2f}",
            "times_faster": "" if name == "runs alone" else f"{first / wall:.2f}",
            "over_the_runs": f"{cpu / best['runs alone'][1]:.2f}",
        }
        for name, (wall, cpu) in best.items()
    ]  # fmt: skip


def main() -> None:
    """Measure, print and save."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=3, help="of which the best counts (default: %(default)s)")
    runs = parser.parse_args().runs
    load = f"{os.getloadavg()[0]:.1f}"
    cores = os.cpu_count() or 1
    workers = sorted({1, *(n for n in (2, 4, 8, 16) if n < cores), cores})
    rows = [row for method in POINTS for row in measured(method, workers, runs)]
    for row in rows:
        row |= {"load": load, "python": platform.python_version(), "machine": platform.machine()}
        print(", ".join(f"{name} {value}" for name, value in row.items()))
    with RESULTS.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
