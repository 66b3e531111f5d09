"""The whole campaign of distinct elements of Winkler, Meguro & Yamazaki (1995), timed on this machine.

Runs     seven single blocks for rocking, three for overturning, columns of two blocks free and next to a wall and a
         column of three, each at 1 to 5 Hz in steps of 0.5 Hz for 90 s, none stopped when a body falls
Accuracy the step is a quarter of the critical one, with located onset: Block 4's is then about 4e-5 s, at which the
         measure of eq. (8) is below that of 2e-6 s with the paper's law (tests/dem/test_assembly_one_block.py)
Run      python benchmarks/dem_campaign.py [--workers N]  ->  benchmarks/results/dem_campaign.csv
"""

from __future__ import annotations

import argparse
import csv
import math
import platform
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import dem

RESULTS = Path(__file__).parent / "results" / "dem_campaign.csv"
G, DENSITY, DURATION = 9.80665, 597.0, 90.0
# Breadth, height, depth [m], Table 1.
SIZES = {
    1: (0.30, 1.00, 0.50), 2: (0.225, 0.75, 0.375), 3: (0.15, 0.50, 0.25), 4: (0.075, 0.25, 0.125),
    5: (0.25, 0.50, 0.25), 6: (0.20, 0.50, 0.25), 7: (0.10, 0.50, 0.25),
}  # fmt: skip
CONTACT = dem.Contact(0.7, damping_ratio=0.1)


def scenes() -> list[tuple[str, dem.Assembly, float]]:
    """(kind, scene, amplitude at the end in g)."""
    rocking = [("rocking", dem.single(*size, DENSITY), 0.6) for size in SIZES.values()]
    overturning = [("overturning", dem.single(*SIZES[number], DENSITY), 2.0) for number in (1, 3, 7)]
    columns = [
        ("assembly", dem.column(count, *SIZES[3], DENSITY, wall_gap=gap), 1.5)
        for count, gap in ((2, None), (2, 0.0), (3, None))
    ]
    return [*rocking, *overturning, *columns]


def run(scene: dem.Assembly, amplitude: float, frequency: float) -> tuple[float, float]:
    """(CPU time [s], steps) of one run."""
    start = time.thread_time()

    def motion(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return amplitude * G * t / DURATION * np.sin(2.0 * math.pi * frequency * t), np.zeros_like(t)

    history = dem.simulate_assembly(
        scene, motion, t_end=DURATION, contact=CONTACT, criteria=dem.Criteria(stop="never", margin=1e3)
    )
    return time.thread_time() - start, history.end_time / float(history.settings["dt"])


def main() -> None:
    """Measure, print and save."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--workers", type=int, default=2, help="runs side by side (default: %(default)s)")
    workers = parser.parse_args().workers
    jobs = [(kind, scene, end, f) for kind, scene, end in scenes() for f in np.arange(1.0, 5.01, 0.5)]
    run(jobs[0][1], 0.1, 1.0)  # compiles
    start = time.perf_counter()
    with ThreadPoolExecutor(workers) as pool:
        found = list(pool.map(lambda job: run(job[1], job[2], float(job[3])), jobs))
    wall = time.perf_counter() - start
    cpu, steps = (math.fsum(values) for values in zip(*found, strict=True))
    head = ["runs", "simulated_s", "steps", "workers", "wall_s", "cpu_s", "python", "machine"]
    line = [
        len(jobs), len(jobs) * DURATION, f"{steps:.4g}", workers, f"{wall:.1f}", f"{cpu:.1f}",
        platform.python_version(), platform.machine(),
    ]  # fmt: skip
    print(", ".join(f"{name} {value}" for name, value in zip(head, line, strict=True)))
    with RESULTS.open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([head, line])


if __name__ == "__main__":
    main()
