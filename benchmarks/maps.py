"""How long does a map of many blocks take?  200 x 200 ramped sinusoids, and 1000 x 1000 blocks under a record of 30 s.

Maps     frequency 0.5 to 5 Hz and amplitude 0.3 to 4 g of a 10 s ramp, block of 0.15 x 0.50 m; height 0.2 to 5 m and
         peak 0.08 to 1.2 g of 30 s of noise at 200 Hz, b/h = 0.3.  Method 1 linear and nonlinear.
Peers    Boost.Odeint (C++) and this package's numba batch, on a sample of the points of each map, over one core.
Floor    on the same sample, as of `trajectories.py`: the floating operations at the speed of this core, nothing else.
Measure  wall and CPU time of the whole map on two threads, arrays in and arrays out; CPU time of a run, mean.  A GPU is
         measured by `maps_on_device.py`.
Run      python benchmarks/maps.py [--quick]  ->  a table, and benchmarks/results/maps.csv
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
from cases import BLOCK, G, noise
from peers.compiled import run as run_compiled
from trajectories import floor_us, fused_per_second

from excitation import PiecewiseLinear, RampedSinusoid
from rocking import Block, Method1, solve, solve_batch
from rocking.solvers.arrays import taylor_batch
from rocking.solvers.exact.batch import RampedSines, ScaledRecord, exact_batch

RESULTS = Path(__file__).parent / "results" / "maps.csv"
HEAD = ["map", "form", "by", "runs", "wall_s", "cpu_s", "cpu_us_a_run", "this_over_taylor", "overturned", "impacts"]
SAMPLE = 64


def whole(form: str, motion: Any, options: dict[str, Any]) -> tuple[list[str], float]:
    """(runs, wall, CPU, CPU of a run ..., CPU of a run [s]) of a whole map on two threads."""
    carry: Any = exact_batch if form == "linear" else taylor_batch
    fields = {"omega": 1.0, "rate": 1.0} if isinstance(motion, RampedSines) else {"scale": 1.0}
    where = {"device": "cpu"} if form == "linear" else {}
    carry(motion._replace(**fields), **{name: np.asarray(v).ravel()[:1] for name, v in options.items()})
    wall, cpu = time.perf_counter(), time.process_time()
    result = carry(motion, workers=2, **where, **options)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    n = result.overturned.size
    numbers = [str(n), f"{wall:.3g}", f"{cpu:.3g}", f"{cpu / n * 1e6:.3g}", "1"]
    return [*numbers, f"{result.overturned.mean():.1%}", f"{result.impacts.mean():.0f}"], cpu / n


def arithmetic(systems: list[Any], motions: list[Any], t_end: float, mean: float) -> list[str]:
    """The cells of what the floating operations alone would take, as of `trajectories.py`."""
    per_second, floors = fused_per_second(), []
    for system, motion in zip(systems, motions, strict=True):
        run = solve(system, motion, t_end=t_end, solver="taylor", save_at=())
        floors.append(floor_us(system.form, motion, run, per_second))
    floor = float(np.mean(floors))
    return ["arithmetic alone", str(len(systems)), "", "", f"{floor:.3g}", f"{floor * 1e-6 / mean:.3g}", "", ""]


def sampled(form: Any, points: list[tuple[Any, Any]], t_end: float, mean: float) -> list[list[str]]:
    """Rows of the peers on a sample of points; `mean` is what taylor takes for a run of the map [s]."""
    systems, motions = [Method1(block, form=form) for block, _ in points], [motion for _, motion in points]
    rows = []
    single = [run_compiled("odeint", s, m, t_end, 1, 1e-10) for s, m in zip(systems, motions, strict=True)]
    done = [one for one in single if not isinstance(one, str)]
    for sentence in {one for one in single if isinstance(one, str)}:
        print(f"{form}: {sentence}")
    if done:
        times = np.array([one[0] for one in done])
        counts = np.mean([len(one[1]) for one in done])
        rows.append(["odeint", str(len(done)), "", "", f"{times.mean() * 1e6:.3g}", f"{times.mean() / mean:.3g}", "",
                     f"{counts:.0f}"])  # fmt: skip
    for solver in ("numba", "taylor"):
        solve_batch(systems[:2], motions[:2], t_end=t_end, solver=solver)
        begin = time.process_time()
        result = solve_batch(systems, motions, t_end=t_end, solver=solver)
        cpu = (time.process_time() - begin) / len(points)
        fallen, struck = f"{result.overturned.mean():.1%}", f"{result.impacts.mean():.0f}"
        label = f"solve_batch, {solver}"
        rows.append([label, str(len(points)), "", "", f"{cpu * 1e6:.3g}", f"{cpu / mean:.3g}", fallen, struck])
    return [*rows, arithmetic(systems, motions, t_end, mean)]


def main() -> None:
    """Measure, print and save."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="small maps, of which no results are kept")
    quick = parser.parse_args().quick
    rows, rng, par = [], np.random.default_rng(1), Method1(BLOCK).parameters
    n = 50 if quick else 200
    frequency, amplitude = np.linspace(0.5, 5.0, n), np.linspace(0.3, 4.0, n) * G
    waves = RampedSines(2.0 * math.pi * frequency[:, None], amplitude / 10.0, 10.0)
    label = f"{n} x {n} sinusoids"
    same = {"p": math.sqrt(par.p2), "alpha": par.alpha, "e": par.e, "g": par.g, "t_end": 10.0}
    at = rng.integers(0, n, (SAMPLE, 2))
    points = [(BLOCK, RampedSinusoid(float(frequency[i]), 10.0, float(amplitude[j]))) for i, j in at]
    for form in ("linear", "nonlinear"):
        numbers, mean = whole(form, waves, same)
        rows.append([label, form, "taylor, 2 threads", *numbers])
        rows += [[label, form, *row] for row in sampled(form, points, 10.0, mean)]
    n = 100 if quick else 1000
    h, scale, values = np.geomspace(0.2, 5.0, n), np.linspace(0.2, 3.0, n), noise(0)
    p = np.sqrt(0.75 * G / (0.5 * h * math.hypot(0.3, 1.0)))
    label = f"{n} x {n} blocks, record"
    same |= {"p": p[:, None], "t_end": 30.0}
    at = rng.integers(0, n, (SAMPLE, 2))
    points = [(Block(0.3 * h[i], h[i]), PiecewiseLinear(0.005, scale[j] * values)) for i, j in at]
    for form in ("linear", "nonlinear"):
        numbers, mean = whole(form, ScaledRecord(values, 0.005, scale=scale), same)
        rows.append([label, form, "taylor, 2 threads", *numbers])
        rows += [[label, form, *row] for row in sampled(form, points, 30.0, mean)]
    for row in [HEAD, *rows]:
        print("  ".join(f"{cell:20s}" for cell in row).rstrip())
    if quick:
        return
    RESULTS.parent.mkdir(exist_ok=True)
    with RESULTS.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*HEAD, "python", "machine"])
        writer.writerows([*row, platform.python_version(), platform.machine()] for row in rows)
    print(f"wrote {RESULTS}")


if __name__ == "__main__":
    main()
