"""How long does a map of many blocks take on a GPU?  The linear maps of `maps.py`, small and large.

Maps     ramped sinusoids, frequency 0.5 to 5 Hz and amplitude 0.3 to 4 g, block of 0.15 x 0.50 m; blocks of height 0.2
         to 5 m, b/h = 0.3, under 30 s of noise, peak 0.08 to 1.2 g.  Method 1 linear, in double and single precision.
Peers    this package's compiled batch in the same run, on two threads and on all cores of that machine.
Measure  wall time, arrays in and arrays out, the least of three after one that compiles; how many runs fall otherwise
         than by the compiled batch.  Runs of hundreds of impacts multiply rounding, so that some do with any other
         order of operations.
Run      python benchmarks/maps_on_device.py [--quick] [--device gpu]  ->  a table, and
         benchmarks/results/maps_on_device.csv (of a GPU alone).  Refused where JAX has no such device.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import platform
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from cases import BLOCK, G, noise

from rocking import Method1
from rocking.solvers.devices import PRECISIONS, jax_device
from rocking.solvers.exact.batch import RampedSines, ScaledRecord, exact_batch

RESULTS = Path(__file__).parent / "results" / "maps_on_device.csv"
HEAD = ["map", "by", "runs", "first_s", "wall_s", "two_threads_over_this", "fall_otherwise", "overturned", "impacts"]
SIDES = {"sinusoids": (64, 200, 1000), "blocks, record": (64, 200, 1000)}
QUICK = {"sinusoids": (16,), "blocks, record": (16,)}


def maps(sides: dict[str, tuple[int, ...]]) -> Iterator[tuple[str, Any, dict[str, Any]]]:
    """(name, motions, blocks and times) of each map."""
    par = Method1(BLOCK).parameters
    same: dict[str, Any] = {"p": math.sqrt(par.p2), "alpha": par.alpha, "e": par.e, "g": par.g}
    for n in sides["sinusoids"]:
        omega, rate = 2.0 * math.pi * np.linspace(0.5, 5.0, n), np.linspace(0.3, 4.0, n) * G / 10.0
        yield f"{n} x {n} sinusoids", RampedSines(omega[:, None], rate, 10.0), {**same, "t_end": 10.0}
    for n in sides["blocks, record"]:
        p = np.sqrt(0.75 * G / (0.5 * np.geomspace(0.2, 5.0, n) * math.hypot(0.3, 1.0)))
        record = ScaledRecord(noise(0), 0.005, scale=np.linspace(0.2, 3.0, n))
        yield f"{n} x {n} blocks, record", record, {**same, "p": p[:, None], "t_end": 30.0}


def timed(motion: Any, options: dict[str, Any]) -> tuple[float, float, Any]:
    """(time of the first call, least of three others [s], result)."""
    walls = []
    for _ in range(4):
        begin = time.perf_counter()
        result = exact_batch(motion, **options)
        walls.append(time.perf_counter() - begin)
    return walls[0], min(walls[1:]), result


def rows_of(name: str, motion: Any, same: dict[str, Any], device: str) -> list[list[str]]:
    """The lines of one map."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    ways: list[dict[str, Any]] = [{"device": "cpu", "workers": workers} for workers in dict.fromkeys((2, cores))]
    ways += [{"device": device, "precision": precision} for precision in PRECISIONS]
    rows, compiled, peer = [], None, math.nan
    for way in ways:
        first, wall, result = timed(motion, {**same, **way})
        if compiled is None:
            compiled, peer = result, wall
        where = str(result.device.flat[0]) + (f", {way['workers']} threads" if "workers" in way else "")
        rows.append([
            name, where, str(result.overturned.size), f"{first:.3g}", f"{wall:.3g}", f"{peer / wall:.3g}",
            str(int(np.sum(result.overturned != compiled.overturned))), f"{result.overturned.mean():.1%}",
            f"{result.impacts.mean():.0f}",
        ])  # fmt: skip
        print("  ".join(f"{cell:24s}" for cell in rows[-1]).rstrip(), flush=True)
    return rows


def main() -> None:
    """Measure, print and save."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="small maps, of which no results are kept")
    parser.add_argument("--device", choices=("gpu", "jax-cpu"), default="gpu", help="of JAX")
    arguments = parser.parse_args()
    try:
        jax_device(arguments.device)
    except ValueError as error:
        parser.error(str(error))
    print("  ".join(f"{cell:24s}" for cell in HEAD).rstrip())
    kept = not arguments.quick and arguments.device == "gpu"
    rows: list[list[str]] = []
    for name, motion, same in maps(QUICK if arguments.quick else SIDES):
        rows += rows_of(name, motion, same, arguments.device)
        if kept:  # what is measured stays, should the next map not fit into the GPU's time
            save(rows)
    if kept:
        print(f"wrote {RESULTS}")


def save(rows: list[list[str]]) -> None:
    """Write the table."""
    RESULTS.parent.mkdir(exist_ok=True)
    with RESULTS.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*HEAD, "python", "machine"])
        writer.writerows([*row, platform.python_version(), platform.machine()] for row in rows)


if __name__ == "__main__":
    main()
