"""Does a wall help or hurt? Criteria of a column of two blocks over the frequency and the width of the gap to the wall.

See          below some frequency the wall holds the column, above it the wall throws it; the gap moves both.
Paper says   one ought to know the frequency of the ground motion to say whether furniture should stand at a wall, and
             how wide the gap should be; it tests no gap. This answers for its column.
Run          python -m studies.wall_gap [--quick]  ->  build/studies/wall_gap.nc, then wall_gap.png and .pdf
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from studies.claims.bounds import CLAIMS
from studies.criteria.columns import Column, ColumnJob, ColumnSettings, G, criterion
from studies.families.columns import LABELS, QUICK_DURATION, arguments, median
from studies.running.command_line import positive
from studies.running.labelled import PAPER, frequency_axis, gathered
from studies.running.parts import Parts
from studies.running.plot import caption, new_figure
from studies.running.statements import Finding, listed, table
from studies.running.study import Study

FAR = 2.0
"""A gap [m] that the column cannot bridge while it stands."""


@dataclass(frozen=True)
class Plan:
    """What is computed; the free column is a gap without end."""

    gaps: tuple[float, ...] = (0.0, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, FAR)
    frequencies: tuple[float, ...] = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0)
    tiny: tuple[float, ...] = (-1e-6, 0.0, 1e-6)
    settings: ColumnSettings = field(default_factory=ColumnSettings)


def dataset(plan: Plan, parts: Parts) -> xr.Dataset:
    """Criteria next to a wall over (gap, tiny, frequency), and free over (tiny, frequency)."""
    points = list(product((*plan.gaps, math.nan), plan.tiny, plan.frequencies))
    base = plan.settings
    jobs = [ColumnJob(Column(2, gap), f, replace(base, ramp=base.ramp * (1.0 + tiny))) for gap, tiny, f in points]
    results = parts.results(jobs, criterion, "wall_gap")
    per_gap = len(plan.tiny) * len(plan.frequencies)
    shape = (len(plan.gaps), len(plan.tiny), len(plan.frequencies))
    kept = {name: LABELS[name] for name in ("overturning_amplitude", "parting_time", "overturning_time", "note")}
    found = gathered(results[:-per_gap], ("gap", "tiny", "frequency"), shape, kept)
    free = gathered(results[-per_gap:], ("tiny", "frequency"), shape[1:], kept)
    found |= {f"free_{name}": variable for name, variable in free.items()}
    ds = xr.Dataset(found, frequency_axis(plan.frequencies))
    gap = {"units": "m", "long_name": "gap between column and wall"}
    ds = ds.assign_coords(gap=("gap", list(plan.gaps), gap))
    ds = ds.assign_coords(tiny=("tiny", list(plan.tiny), {"units": "1", "long_name": "relative change of the ramp"}))
    return ds.assign_attrs(references=f"{PAPER}, Block assemblies", ramp=base.ramp, friction=base.friction)


def free_median(ds: xr.Dataset) -> xr.DataArray:
    """Median criterion of the free column; as of `median`, a run that stands counts as infinitely strong."""
    free = {name.removeprefix("free_"): ds[name] for name in ("free_overturning_amplitude", "free_note")}
    return median(xr.Dataset(free))


def ratio(ds: xr.Dataset) -> xr.DataArray:
    """Median criterion next to the wall over that of the free column; NaN where one of them has none."""
    return median(ds) / free_median(ds)


def _spread(values: xr.DataArray, dim: str) -> xr.DataArray:
    """Largest over smallest along a dimension; NaN where one is not known."""
    return values.max(dim, skipna=False) / values.min(dim, skipna=False)


def _marks(axis: Any, values: np.ndarray) -> None:
    axis.set_major_locator(FixedLocator(values.tolist()))
    axis.set_minor_locator(NullLocator())


def figure(ds: xr.Dataset) -> Figure:
    """Wall over free, by gap and frequency: as a map (left) and as curves (right)."""
    fig = new_figure(11.5, 4.8)
    left, right = fig.subplots(1, 2)
    near = ds.sel(gap=ds.gap < FAR)
    logarithm = np.log2(ratio(near).transpose("gap", "frequency").values)
    limit = float(np.max(np.abs(logarithm), where=np.isfinite(logarithm), initial=0.5))
    rows = np.arange(near.sizes["gap"])
    mesh = left.pcolormesh(ds.frequency, rows, logarithm, cmap="PuOr", vmin=-limit, vmax=limit, shading="nearest")
    for row, frequency in product(rows, range(ds.sizes["frequency"])):
        value = 2.0 ** logarithm[row, frequency]
        if math.isnan(value):
            continue
        left.text(
            float(ds.frequency[frequency]),
            row,
            f"{value:.2f}",
            ha="center",
            va="center",
            fontsize=8,
            color="w" if abs(logarithm[row, frequency]) > 0.75 * limit else "k",
        )
    left.set_yticks(rows, [f"{1e3 * float(gap):g}" for gap in near.gap])
    _marks(left.xaxis, ds.frequency.values)
    left.set_xlabel("Frequency of the base motion [Hz]")
    left.set_ylabel("Gap to the wall [mm]")
    bar = fig.colorbar(mesh, ax=left, label="Criterion next to the wall over free")
    ticks = list(range(math.ceil(-limit), math.floor(limit) + 1))
    bar.set_ticks(ticks, labels=[f"{2.0**t:g}" for t in ticks])
    free = ds.free_overturning_amplitude / G
    right.fill_between(ds.frequency, free.min("tiny"), free.max("tiny"), color="0.8", lw=0)
    right.plot(ds.frequency, free_median(ds) / G, color="k", lw=2, label="free")
    colours = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442")
    for i, gap in enumerate(near.gap.values):
        curve = median(near.sel(gap=gap)) / G
        right.plot(ds.frequency, curve, color=colours[i % 7], marker="os^Dv<>"[i % 7], ms=4, label=f"{1e3 * gap:g} mm")
    right.set_ylim(bottom=0.0)
    right.set_xlabel("Frequency of the base motion [Hz]")
    right.set_ylabel("Envelope of the base acceleration\nat overturning [g]")
    right.legend(fontsize=8, title="Gap")
    right.grid(alpha=0.3)
    caption(fig, _text(ds, near.gap.values, logarithm))
    return fig


def _text(ds: xr.Dataset, gaps: np.ndarray, logarithm: np.ndarray) -> str:
    """The caption; the worst gap is named where all of them have a criterion at every frequency."""
    ramps = (
        f"medians over {ds.sizes['tiny']} ramps that differ by parts in a million (grey band: their range, free)"
        if ds.sizes["tiny"] > 1
        else "one ramp"
    )
    text = (
        "A column of two blocks of 15 × 50 cm next to a wall fixed to the table, by distinct elements; "
        f"{ramps}. Notice: above 1 the wall helps, below it hurts; "
    )
    if np.isfinite(logarithm).all():
        worst = 1e3 * float(gaps[logarithm.mean(axis=1).argmin()])
        text += f"close to the wall the frequency decides, and over all frequencies a gap of {worst:g} mm is the worst."
    else:
        text += "where a number is missing, half of the runs or more do not fall, free or next to the wall."
    return text


def check(ds: xr.Dataset) -> xr.Dataset:
    """A wall out of reach, and how much frequency and gap matter."""
    found = ratio(ds)
    whole = ds.free_parting_time.isnull().all("tiny")
    far = float(np.abs(found.isel(gap=-1).where(whole) - 1.0).max())
    at_wall, near = found.isel(gap=0), found.sel(gap=ds.gap < FAR)
    by_frequency = {f"{float(f):g} Hz": float(r) for f, r in zip(ds.frequency, at_wall, strict=True)}
    by_gap = _spread(near, "gap")
    spread = {f"{float(f):g} Hz": float(r) for f, r in zip(ds.frequency, by_gap, strict=True)}
    return table(
        [
            Finding(CLAIMS["wall_gap.far"], far, f"gap of {float(ds.gap[-1]):g} m"),
            Finding(CLAIMS["wall_gap.frequency"], float(_spread(at_wall, "frequency")), listed(by_frequency)),
            Finding(CLAIMS["wall_gap.gap"], float(by_gap.max(skipna=False)), listed(spread)),
        ]
    )


def plan_of(options: argparse.Namespace) -> Plan:
    """The plan that the command line asks for.

    Raises:
        BadInputError: an option's value is not one that it can have.
    """
    positive("--ramp", options.ramp)
    positive("--friction", options.friction, zero=True)
    settings = ColumnSettings(ramp=options.ramp * G, friction=options.friction)
    if options.quick:
        return Plan((0.0, 0.02, FAR), (1.0, 3.0), (0.0,), replace(settings, duration=QUICK_DURATION))
    return Plan(settings=settings)


STUDY = Study(
    name="wall_gap",
    title="Does a wall help or hurt a column of two blocks, by frequency and gap",
    about="Should furniture stand at a wall, and how wide should the gap be?",
    plan=plan_of,
    dataset=dataset,
    figures={"wall_gap": figure},
    check=check,
    arguments=arguments,
    example='ds.overturning_amplitude.median("tiny", skipna=False).plot.line(x="frequency")',
)

if __name__ == "__main__":
    STUDY.run()
