"""Assemblies of distinct elements: cost of a contact, real time, growth with the number of blocks, and peers beside.

Scenes   one block and a column of three of Winkler, Meguro & Yamazaki (1995), running-bond walls, on a table that
         shakes with 0.2 g at 5 Hz; MuJoCo and pymunk with the same bodies, friction and motion, at 1e-3 and 1e-4 s
Measure  CPU time of a run less that of a run of one step (setting up, settling), the best of several; with two
         workers wall time. "contacts" are those that touch in the end
Run      python benchmarks/dem_assemblies.py [--runs N] [--quick | --growth]  ->  benchmarks/results/dem_assemblies.csv
"""

from __future__ import annotations

import argparse
import csv
import math
import platform
import time
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
from dem_peers import run_mujoco, run_pymunk

import dem

RESULTS = Path(__file__).parent / "results" / "dem_assemblies.csv"
B, H, D, DENSITY, G, MU = 0.15, 0.50, 0.25, 597.0, 9.80665, 0.7
GROWTH = [(3, 3), (10, 10), (32, 31), (100, 100)]  # courses and blocks across: 10 to 10,000 blocks
CONTACT = dem.Contact(MU, damping_ratio=0.1)
HEAD = (
    "scene", "bodies", "engine", "step_s", "simulated_s", "seconds", "clock", "simulated_s_per_s", "us_per_step",
    "contacts", "ns_per_contact_and_step", "python", "machine",
)  # fmt: skip


def shaken(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """0.2 g at 5 Hz."""
    return 0.2 * G * np.sin(10.0 * math.pi * t), np.zeros_like(t)


def best(work: Callable[[], object], runs: int, clock: Callable[[], float]) -> float:
    """Shortest time of several [s]."""
    times = []
    for _ in range(runs):
        start = clock()
        work()
        times.append(clock() - start)
    return min(times)


def time_dem(
    label: str, scene: dem.Assembly, t_end: float, share: float, runs: int, workers: int = 1, settle: bool = True
) -> list[object]:
    """A row for this engine at a step that is `share` of the critical one."""
    step = share * dem.assembly_critical_step(scene, CONTACT)
    clock = time.perf_counter if workers > 1 else time.process_time

    def run(duration: float) -> dem.AssemblyHistory:
        return dem.simulate_assembly(
            scene, shaken, t_end=duration, dt=step, contact=CONTACT, criteria=dem.Criteria(stop="never"),
            workers=workers, save_every=10**9, settle=settle,
        )  # fmt: skip

    run(step)  # compiles
    seconds = best(lambda: run(t_end), runs, clock) - best(lambda: run(step), runs, clock)
    contacts = int(run(step).settings["contacts"])
    name = "dem" if workers == 1 else f"dem, {workers} workers"
    return row(label, scene, name, step, t_end, seconds, clock, contacts)


def show(cells: Iterable[object]) -> None:
    """Print a line of the table but for Python and machine."""
    print("  ".join(f"{cell!s:14.14s}" for cell in list(cells)[:-2]).rstrip(), flush=True)


def row(label, scene, engine, step, t_end, seconds, clock, contacts=None) -> list[object]:
    """One line of the table."""
    per_step = seconds / (t_end / step)
    made = [
        label, len(scene.bodies), engine, f"{step:.3g}", t_end, f"{seconds:.3f}",
        "wall" if clock is time.perf_counter else "cpu", f"{t_end / seconds:.3g}", f"{per_step * 1e6:.3f}", contacts or
        "", f"{per_step / contacts * 1e9:.1f}" if contacts else "", platform.python_version(), platform.machine(),
    ]  # fmt: skip
    show(made)
    return made


def time_peers(label: str, scene: dem.Assembly, t_end: float) -> list[list[object]]:
    """Rows for the other engines."""
    rows = []
    for name, run in (("MuJoCo", run_mujoco), ("pymunk", run_pymunk)):
        for step in (1e-3, 1e-4):
            duration = t_end * step / 1e-3
            seconds = best(
                lambda run=run, duration=duration, step=step: run(
                    scene, shaken, duration, step, MU, lambda *_: False
                ),
                1,
                time.process_time,
            )  # fmt: skip
            rows.append(row(label, scene, name, step, duration, seconds, time.process_time))
    return rows


def main() -> None:
    """Measure, print and save."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=3, help="runs that count (default: %(default)s)")
    parser.add_argument("--quick", action="store_true", help="shorter runs, and no wall of 10,000 blocks")
    parser.add_argument("--growth", action="store_true", help="measure growth alone and keep the other rows there are")
    arguments = parser.parse_args()
    runs, short = arguments.runs, 0.2 if arguments.quick else 1.0
    show(HEAD)
    rows = kept_rows() if arguments.growth else scene_rows(runs, short)
    for size in GROWTH[:3] if arguments.quick else GROWTH:
        rows.append(time_dem("growth", dem.running_bond(*size), 0.12, 0.5, 1, settle=False))
    RESULTS.parent.mkdir(exist_ok=True)
    with RESULTS.open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([HEAD, *rows])
    print(f"wrote {RESULTS}")


def scene_rows(runs: int, short: float) -> list[list[object]]:
    """Everything but growth."""
    block, column = dem.single(B, H, D, DENSITY), dem.column(3, B, H, D, DENSITY)
    wall, large = dem.running_bond(10, 10), dem.running_bond(32, 31)
    rows = [
        time_dem("one block", block, 60.0 * short, 0.25, runs),
        time_dem("column of 3", column, 30.0 * short, 0.25, runs),
        time_dem("wall of 100", wall, 2.0 * short, 0.25, runs),
        time_dem("wall of 100", wall, 2.0 * short, 0.5, runs),
        time_dem("wall of 1000", large, 0.3, 0.5, runs),
        time_dem("wall of 1000", large, 0.3, 0.5, runs, workers=2),
    ]
    peers = (("one block", block, 5.0), ("column of 3", column, 5.0), ("wall of 100", wall, 0.5))
    for label, scene, t_end in (*peers, ("wall of 1000", large, 0.05)):
        rows += time_peers(label, scene, t_end * short)
    return rows


def kept_rows() -> list[list[object]]:
    """Rows of the results that are there, growth left out."""
    with RESULTS.open(newline="") as file:
        return [list(line) for line in list(csv.reader(file))[1:] if line[0] != "growth"]


if __name__ == "__main__":
    main()
