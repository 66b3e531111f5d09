"""What Figs 18, 19 and 23 share: criteria of overturning of columns of distinct elements, and how they are drawn.

Each point is a median over runs whose ramps differ by a few parts in a million: the motion is chaotic, and one run by
itself says little.  What the paper does not print is varied, one parameter at a time.

Source   Winkler, Meguro & Yamazaki (1995), "Block assemblies"
Status   the criterion itself: `studies.criteria.columns`
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from studies.criteria.columns import PARTED, Column, ColumnJob, ColumnSettings, G, criterion, fitted_dashpot
from studies.criteria.overturning import STIFFNESS
from studies.running.command_line import positive
from studies.running.labelled import FREQUENCIES, PAPER, QUICK_FREQUENCIES, frequency_axis, gathered, names_axis
from studies.running.parts import Parts
from studies.running.plot import caption, new_figure
from studies.running.study import settings_of
from studies.specimens import specimen

TINY = (-2e-6, -1e-6, 0.0, 1e-6, 2e-6)
"""Changes of the ramp that mean nothing [1]."""

VARIATIONS: Mapping[str, Mapping[str, Any]] = {
    "friction 0.5": {"friction": 0.5},
    "friction 1.0": {"friction": 1.0},
    "dashpot halved": {"damping": 0.5},
    "dashpot doubled": {"damping": 2.0},
    "stiffness halved": {"stiffness": 0.5},
    "stiffness doubled": {"stiffness": 2.0},
    "ramp to 1.5 g": {"ramp": 1.5 * G},
    "ramp to 6 g": {"ramp": 6.0 * G},
}
"""Changes one at a time; dashpot and stiffness as factors."""

QUICK_DURATION = 15.0

LABELS = {
    "overturning_amplitude": ("m s-2", "envelope of the base acceleration at overturning"),
    "overturning_time": ("s", "time of overturning of the first block that falls"),
    "onset_time": ("s", "time at which the lowest block first leaves the floor"),
    "parting_time": ("s", "time at which two blocks part"),
    "largest_apart": ("1", "largest difference of the angles of two neighbours over alpha until overturning"),
    "fallen": ("1", "number of the block that falls first, 0 the lowest"),
    "note": ("", "overturned, or why there is no amplitude"),
}


@dataclass(frozen=True)
class ColumnsPlan:
    """What is computed."""

    columns: tuple[Column, ...]
    frequencies: tuple[float, ...] = FREQUENCIES
    settings: ColumnSettings = field(default_factory=ColumnSettings)
    tiny: tuple[float, ...] = TINY
    variations: tuple[str, ...] = tuple(VARIATIONS)


def arguments(parser: argparse.ArgumentParser) -> None:
    """--ramp, --friction and --no-variations."""
    parser.add_argument(
        "--ramp",
        type=float,
        default=3.0,
        metavar="G",
        help="acceleration at the end of the 90 s ramp, in g (default: 3)",
    )
    parser.add_argument("--friction", type=float, default=0.7, metavar="MU", help="of all contacts (default: 0.7)")
    parser.add_argument(
        "--no-variations", action="store_true", help="leave out the runs with other friction, dashpot, stiffness, ramp"
    )


def plan_of(columns: Sequence[Column], options: argparse.Namespace) -> ColumnsPlan:
    """The plan that the command line asks for.

    Raises:
        BadInputError: an option's value is not one that it can have.
    """
    positive("--ramp", options.ramp)
    positive("--friction", options.friction, zero=True)
    settings = ColumnSettings(ramp=options.ramp * G, friction=options.friction)
    chosen = () if options.no_variations else tuple(VARIATIONS)
    if options.quick:
        quick = replace(settings, duration=QUICK_DURATION)
        return ColumnsPlan(tuple(columns), QUICK_FREQUENCIES, quick, (0.0,), chosen[:1])
    return ColumnsPlan(tuple(columns), FREQUENCIES, settings, TINY, chosen)


def _varied(settings: ColumnSettings, name: str) -> ColumnSettings:
    change = dict(VARIATIONS[name])
    if "damping" in change:
        change["damping"] *= fitted_dashpot()
    if "stiffness" in change:
        # The dashpot stays: what stiffness does at a fixed dashpot.
        change["stiffness"] *= STIFFNESS
    return replace(settings, **change)


def dataset(plan: ColumnsPlan, parts: Parts, label: str) -> xr.Dataset:
    """Criteria over (column, tiny, frequency), and of the last column over (variation, frequency)."""
    points = list(product(plan.columns, plan.tiny, plan.frequencies))
    base = plan.settings
    jobs = [ColumnJob(column, f, replace(base, ramp=base.ramp * (1.0 + tiny))) for column, tiny, f in points]
    shape = (len(plan.columns), len(plan.tiny), len(plan.frequencies))
    varied = list(product(plan.variations, plan.frequencies))
    jobs += [ColumnJob(plan.columns[-1], f, _varied(base, name)) for name, f in varied]
    results = parts.results(jobs, criterion, label)
    found = gathered(results[: len(points)], ("column", "tiny", "frequency"), shape, LABELS)
    if varied:
        kept = {name: LABELS[name] for name in ("overturning_amplitude", "note")}
        again = gathered(
            results[len(points) :], ("variation", "frequency"), (len(plan.variations), len(plan.frequencies)), kept
        )
        found |= {f"varied_{name}": variable for name, variable in again.items()}
    ds = xr.Dataset(found, frequency_axis(plan.frequencies))
    ds = ds.assign_coords(names_axis("column", [column.label for column in plan.columns], "column"))
    ds = ds.assign_coords(tiny=("tiny", list(plan.tiny), {"units": "1", "long_name": "relative change of the ramp"}))
    if varied:
        ds = ds.assign_coords(names_axis("variation", plan.variations, "what was changed"))
    ds["blocks"] = ("column", [c.count for c in plan.columns], {"units": "1", "long_name": "number of blocks"})
    return ds.assign_attrs(_choices(plan))


def _choices(plan: ColumnsPlan) -> dict[str, Any]:
    """How each parameter was chosen, for the attributes."""
    s, block = plan.settings, specimen(plan.settings.block)
    return {
        "references": f"{PAPER}, Figs 18, 19 and 23",
        "settings": settings_of(plan),
        "specimen": f"blocks of {block.b:g} x {block.h:g} x {block.d:g} m, {block.mass:.4g} kg",
        "ramp_choice": f"linear envelope to {s.ramp:.6g} m/s^2 in {s.duration:g} s; the paper prints about 90 s",
        "friction_choice": f"{s.friction:g} for all contacts; the paper says that it exceeds b/h",
        "damping_choice": f"dashpot {fitted_dashpot():.6g} N s/m, all contacts; fitted to a free vibration of Block 1",
        "parting_choice": f"two blocks have parted once their angles differ by {PARTED:g} alpha",
    }


def median(ds: xr.Dataset, name: str = "overturning_amplitude") -> xr.DataArray:
    """Median over the tiny changes; a run that did not fall counts as infinitely strong."""
    values = ds[name].where(ds.note == "overturned", np.inf)
    middle = values.median("tiny")
    return middle.where(np.isfinite(middle))


COLOURS = ("#0072B2", "#D55E00", "#009E73")
MARKERS = ("o", "s", "^")


def _criteria(ax: Any, ds: xr.Dataset) -> None:
    """Medians with the range under tiny changes."""
    for i, column in enumerate(ds.column.values):
        at = ds.sel(column=column)
        values = at.overturning_amplitude / G
        if ds.sizes["tiny"] > 1:
            ax.fill_between(ds.frequency, values.min("tiny"), values.max("tiny"), color=COLOURS[i], alpha=0.18, lw=0)
        ax.plot(ds.frequency, median(at) / G, color=COLOURS[i], marker=MARKERS[i], ms=5, label=f"{column}: falls")
        parted = (at.parting_time / at.overturning_time * at.overturning_amplitude).median("tiny") / G
        ax.plot(
            ds.frequency,
            parted,
            color=COLOURS[i],
            ls=":",
            marker=MARKERS[i],
            mfc="none",
            ms=4,
            label=f"{column}: parts",
        )
    count = int(ds.blocks[-1])
    block = specimen(json.loads(ds.attrs["settings"])["settings"]["block"])
    ax.axhline(block.b / block.h / count, color="0.4", lw=1, ls=(0, (1, 2)), label=f"West for {count} blocks as one")
    ax.set_ylim(bottom=0.0)
    ax.set_ylabel("Envelope of the base acceleration [g]")
    ax.legend(fontsize=8, loc="upper left", framealpha=0.85)


def _variations(ax: Any, ds: xr.Dataset) -> None:
    """The last column with one parameter changed."""
    at = ds.isel(column=-1)
    values = at.overturning_amplitude / G
    if ds.sizes["tiny"] > 1:
        ax.fill_between(
            ds.frequency, values.min("tiny"), values.max("tiny"), color="0.82", lw=0, label="ramp changed by 1e-6"
        )
    ax.plot(ds.frequency, median(at) / G, color="k", lw=2, label="as on the left")
    pairs = ("#E69F00", "#56B4E9", "#CC79A7", "#009E73")
    styles = [(colour, line) for colour in pairs for line in ("-", "--")]
    for i, name in enumerate(ds.variation.values if "variation" in ds else ()):
        colour, line = styles[i % len(styles)]
        curve = ds.varied_overturning_amplitude.sel(variation=name) / G
        ax.plot(ds.frequency, curve, color=colour, ls=line, marker="ox"[i % 2], ms=4, lw=1, label=str(name))
    ax.set_title(f"{at.column.item()}: one parameter changed at a time", fontsize=10)
    ax.legend(fontsize=7.5, loc="upper left", framealpha=0.85)


def figure(ds: xr.Dataset, text: str) -> Figure:
    """Criteria of overturning and of parting (left), and what moves them (right)."""
    fig = new_figure(11.5, 5.2)
    left, right = fig.subplots(1, 2, sharey=True)
    _criteria(left, ds)
    _variations(right, ds)
    for ax in (left, right):
        ax.set_xlabel("Frequency of the base motion [Hz]")
        ax.grid(alpha=0.3)
    caption(fig, text)
    return fig
