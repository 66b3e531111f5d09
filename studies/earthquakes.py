"""Columns under synthetic earthquakes: a column of two against one block of its outline, with and without a_z.

See          the share of motions that fell each, by peak acceleration, with vertical motion and without.
Paper says   earthquake excitation was applied in its tests and is left to a later simulation.
Run          python -m studies.earthquakes [--quick]  ->  build/studies/earthquakes.nc, then earthquakes.png and .pdf
Source       motions: Kanai (1957), Tajimi (1960), Clough & Penzien (1975), as of `excitation.KanaiTajimi`
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import dem
from excitation import KanaiTajimi, scaled_to
from studies.claims.bounds import CLAIMS
from studies.criteria.columns import COLUMN_BLOCK, G, fitted_dashpot
from studies.criteria.overturning import STIFFNESS
from studies.running.command_line import positive
from studies.running.labelled import PAPER, names_axis
from studies.running.parts import Parts
from studies.running.plot import caption, new_figure
from studies.running.statements import Finding, listed, table
from studies.running.study import Study
from studies.specimens import specimen

SCENES = {"one block": 1, "column of two": 2}
"""Number of blocks that make the outline of 15 x 100 cm."""

DURATION, TIME_STEP = 16.0, 0.01
WHOLE = (dem.Ending.FELL, dem.Ending.REACHED_END)
"""Ends of a run that tell whether anything falls."""

VERTICAL = 2.0 / 3.0
"""Peak of the vertical motion over that of the horizontal one [1]: the ratio of many codes."""


@dataclass(frozen=True)
class Plan:
    """What is computed."""

    peaks: tuple[float, ...] = tuple(np.geomspace(0.18 * G, 0.48 * G, 8).round(4).tolist())
    seeds: int = 8
    friction: float = 0.7


@dataclass(frozen=True)
class Job:
    """One run."""

    blocks: int
    vertical: float
    seed: int
    peak: float  # [m/s^2]
    friction: float


def scene_of(blocks: int) -> dem.Assembly:
    """A column of two blocks of the paper, or one block of its outline."""
    x = specimen(COLUMN_BLOCK)
    return dem.column(blocks, x.b, 2.0 * x.h / blocks, x.d, x.density)


def _falls(job: Job) -> dict[str, Any]:
    """Whether anything falls, and when [s]; whether the run failed."""
    ground = KanaiTajimi(1.0, DURATION, rise=2.0, strong_end=10.0, decay=0.5)
    horizontal = scaled_to(ground.record(TIME_STEP, job.seed), pga=job.peak)
    upwards = None
    if job.vertical > 0.0:
        # Of its own, and quicker than the horizontal one, as vertical motions are.
        quick = KanaiTajimi(1.0, DURATION, rise=2.0, strong_end=10.0, decay=0.5, ground_frequency=6.0)
        upwards = scaled_to(quick.record(TIME_STEP, 1000 + job.seed), pga=job.vertical * job.peak)
    base = horizontal.motion(upwards, interpolation="linear")
    contact = dem.Contact(job.friction, damping=fitted_dashpot(), kn=STIFFNESS, ks=STIFFNESS)
    run = dem.simulate_assembly(scene_of(job.blocks), base, t_end=DURATION + 2.0, contact=contact)
    return {"fell": bool(run.falls), "time": run.overturning_time, "failed": run.ending not in WHOLE}


def dataset(plan: Plan, parts: Parts) -> xr.Dataset:
    """Whether a scene falls over (scene, vertical, peak, seed).

    Raises:
        RuntimeError: a run became unstable, a body left the scene, or a run was cut off.
    """
    vertical = (0.0, VERTICAL)
    points = product(SCENES.values(), vertical, plan.peaks, range(plan.seeds))
    jobs = [Job(blocks, up, seed, peak, plan.friction) for blocks, up, peak, seed in points]
    results = parts.results(jobs, _falls, "earthquakes")
    failed = sum(result["failed"] for result in results)
    if failed:
        raise RuntimeError(f"{failed} runs failed; want none")
    shape = (len(SCENES), len(vertical), len(plan.peaks), plan.seeds)
    dims = ("scene", "vertical", "peak", "seed")
    flags = {"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": "stands falls"}
    fell = np.array([result["fell"] for result in results], dtype=np.int8).reshape(shape)
    times = np.array([result["time"] for result in results]).reshape(shape)
    ds = xr.Dataset(
        {
            "fell": (dims, fell, {"long_name": "whether a block falls", **flags}),
            "overturning_time": (dims, times, {"units": "s", "long_name": "time of overturning"}),
        },
        coords=names_axis("scene", list(SCENES), "scene of 15 x 100 cm")
        | {
            "vertical": ("vertical", list(vertical), {"units": "1", "long_name": "vertical over horizontal peak"}),
            "peak": ("peak", list(plan.peaks), {"units": "m s-2", "long_name": "peak horizontal acceleration"}),
            "seed": ("seed", list(range(plan.seeds)), {"units": "1", "long_name": "seed of the motion"}),
        },
    )
    return ds.assign_attrs(references=f"{PAPER}, Block assemblies", friction=plan.friction)


def least(ds: xr.Dataset) -> xr.DataArray:
    """Least peak of those computed that fells [m/s^2]; infinite if none does."""
    return ds.peak.where(ds.fell.astype(bool)).min("peak").fillna(np.inf)


def figure(ds: xr.Dataset) -> Figure:
    """Share of motions that fell each scene (left), and the least felling peaks, motion by motion (right)."""
    fig = new_figure(11.0, 4.5)
    left, right = fig.subplots(1, 2)
    for i, scene in enumerate(ds.scene.values):
        for j, up in enumerate(ds.vertical.values):
            share = ds.fell.sel(scene=scene, vertical=up).mean("seed")
            label = f"{scene}, {'with' if up else 'no'} vertical motion"
            colour = ("#0072B2", "#D55E00")[i]
            fill = "none" if up else colour
            left.plot(ds.peak / G, share, ms=5, label=label, color=colour, ls=("-", "--")[j], marker="os"[i], mfc=fill)
    left.axvline(0.15, color="0.4", lw=1, ls=":")
    left.set_xlabel("Peak horizontal acceleration [g]")
    left.set_ylabel("Share of the motions that fell it")
    left.legend(fontsize=8)
    left.grid(alpha=0.3)
    found = least(ds) / G
    width = float(ds.peak.max()) / G * 1.1
    start = float(ds.peak.min()) / G * 0.8
    for j, up in enumerate(ds.vertical.values):
        at = found.sel(vertical=up).clip(max=width)
        x, y = (at.sel(scene=name) for name in ds.scene.values)
        shift = (j - 0.5) * 0.004
        right.plot(x + shift, y + shift, ls="none", marker="o^"[j], mfc="none", color=("#0072B2", "#D55E00")[j],
                   label=f"{'with' if up else 'no'} vertical motion")  # fmt: skip
    right.plot([start, width], [start, width], color="0.5", lw=0.8)
    right.set_xlabel(f"Least felling peak, {ds.scene.values[0]} [g]")
    right.set_ylabel(f"Least felling peak, {ds.scene.values[1]} [g]")
    right.legend(fontsize=8)
    right.grid(alpha=0.3)
    caption(
        fig,
        f"A column of two blocks of 15 × 50 cm and one block of its outline under {ds.sizes['seed']} synthetic "
        "motions, by distinct elements. Notice whether the points on the right lie below the line (the column falls "
        "first); those at the upper or right edge did not fall. Dotted: West's acceleration of the outline.",
    )
    return fig


def check(ds: xr.Dataset) -> xr.Dataset:
    """Whether the column falls first, and whether vertical motion matters; of two that stand nothing is known."""
    felling = least(ds)
    block, column = (felling.sel(scene=name) for name in SCENES)
    known = np.isfinite(block) | np.isfinite(column)
    first, last = (column < block).where(known), (column > block).where(known)
    earlier = {f"vertical {float(up):.2g}": float(first.sel(vertical=up).mean()) for up in ds.vertical.values}
    without, upwards = (felling.isel(vertical=i) for i in (0, 1))
    changed = (without != upwards).where(np.isfinite(without) | np.isfinite(upwards)).mean("seed")
    by_scene = {str(name): float(changed.sel(scene=name)) for name in ds.scene.values}
    detail = listed(earlier) + f"; later in {float(last.mean()):.3g}, in the rest alike"
    return table(
        [
            Finding(CLAIMS["earthquakes.column"], float(first.mean()), detail),
            Finding(CLAIMS["earthquakes.vertical"], float(changed.max(skipna=False)), listed(by_scene)),
        ]
    )


def arguments(parser: argparse.ArgumentParser) -> None:
    """--friction."""
    parser.add_argument("--friction", type=float, default=0.7, metavar="MU", help="of all contacts (default: 0.7)")


def plan_of(options: argparse.Namespace) -> Plan:
    """The plan that the command line asks for.

    Raises:
        BadInputError: an option's value is not one that it can have.
    """
    positive("--friction", options.friction, zero=True)
    full = Plan(friction=options.friction)
    return Plan(full.peaks[2::3], 1, options.friction) if options.quick else full


STUDY = Study(
    name="earthquakes",
    title="A column of two and one block of its outline under synthetic earthquakes",
    about="Does a column fall earlier than one block of its outline, and does vertical motion matter?",
    plan=plan_of,
    dataset=dataset,
    figures={"earthquakes": figure},
    check=check,
    arguments=arguments,
    example='ds.fell.mean("seed").isel(vertical=0).plot.line(x="peak")',
)

if __name__ == "__main__":
    STUDY.run()
