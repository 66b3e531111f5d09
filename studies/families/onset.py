"""What Figs 14 and 15 share: criteria of rocking of several blocks by three methods, and how they are drawn.

Source   Winkler, Meguro & Yamazaki (1995), "Criteria of rocking for single blocks"
Status   the criterion itself: `studies.criteria.rocking_onset`
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from studies.criteria.columns import G
from studies.criteria.overturning import METHOD_LABELS, METHODS
from studies.criteria.rocking_onset import OFF_THE_FLOOR, OnsetJob, OnsetSettings, onset
from studies.running.command_line import positive
from studies.running.files import BadInputError
from studies.running.labelled import (
    FREQUENCIES,
    PAPER,
    QUICK_FREQUENCIES,
    block_axis,
    frequency_axis,
    gathered,
    names_axis,
)
from studies.running.parts import Parts
from studies.running.plot import caption, new_figure

QUICK_DURATION = 20.0
"""Of the ramp [s] with --quick."""

LABELS = {
    "lift_acceleration": ("m s-2", "magnitude of the base acceleration at lift-off"),
    "lift_time": ("s", "time of lift-off"),
    "onset_acceleration": ("m s-2", "largest base acceleration until motion follows"),
    "onset_time": ("s", "time at which motion follows"),
    "note": ("", "rocks, or why there is no acceleration"),
}


@dataclass(frozen=True)
class OnsetPlan:
    """What is computed."""

    blocks: tuple[int, ...]
    methods: tuple[str, ...] = METHODS
    frequencies: tuple[float, ...] = FREQUENCIES
    settings: OnsetSettings = field(default_factory=OnsetSettings)


def arguments(parser: argparse.ArgumentParser) -> None:
    """--ramp and --friction."""
    parser.add_argument(
        "--ramp", type=float, default=1.0, metavar="G", help="acceleration at the end of the 90 s ramp, in g"
    )
    parser.add_argument("--friction", type=float, default=0.7, metavar="MU", help="Method 2 and DEM (default: 0.7)")


def plan_of(blocks: Sequence[int], options: argparse.Namespace) -> OnsetPlan:
    """The plan that the command line asks for.

    Raises:
        BadInputError: an option's value is not one that it can have.
    """
    positive("--ramp", options.ramp)
    positive("--friction", options.friction, zero=True)
    if options.friction >= 4.0 / 3.0:
        raise BadInputError(f"--friction {options.friction:g}: want below 4/3 with Method 2 (a corner may jam)")
    settings = OnsetSettings(ramp=options.ramp * G, friction=options.friction)
    if options.quick:
        return OnsetPlan(tuple(blocks), METHODS, QUICK_FREQUENCIES, replace(settings, duration=QUICK_DURATION))
    return OnsetPlan(tuple(blocks), METHODS, FREQUENCIES, settings)


def dataset(plan: OnsetPlan, parts: Parts, label: str) -> xr.Dataset:
    """Criteria of rocking over (method, block, frequency)."""
    points = list(product(plan.methods, plan.blocks, plan.frequencies))
    jobs = [OnsetJob(method, block, frequency, plan.settings) for method, block, frequency in points]
    results = parts.results(jobs, onset, label)
    shape = (len(plan.methods), len(plan.blocks), len(plan.frequencies))
    ds = xr.Dataset(
        gathered(results, ("method", "block", "frequency"), shape, LABELS),
        names_axis("method", plan.methods, "method") | block_axis(plan.blocks) | frequency_axis(plan.frequencies),
    )
    ds["west"] = ("block", (ds.b / ds.h * G).values, {"units": "m s-2", "long_name": "(b/h) g, West's formula"})
    ds.attrs = {
        "references": f"{PAPER}, Figs 14 and 15",
        "motion_choice": f"motion follows: a corner is {1e3 * OFF_THE_FLOOR:g} mm off the floor",
        "ramp_choice": f"linear envelope to {plan.settings.ramp:.6g} m/s^2 in {plan.settings.duration:g} s",
    }
    return ds


def departures(ds: xr.Dataset, variable: str) -> xr.DataArray:
    """|criterion / ((b/h) g) - 1|."""
    return np.abs(ds[variable] / ds.west - 1.0)


def by_method(values: xr.DataArray) -> dict[str, float]:
    """The largest value of each method; NaN where one is not known."""
    return {METHOD_LABELS[str(m)]: largest(values.sel({"method": m})) for m in values.method.values}


def largest(values: xr.DataArray) -> float:
    """The largest value; NaN where one is not known: a block that did not rock bears nothing out."""
    return float(values.max(skipna=False))


STYLES = ("-", "--", "-.", ":")
BLOCK_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")


def _panel(ax: Any, ds: xr.Dataset, method: str) -> None:
    for i, block in enumerate(ds.block.values):
        at = ds.sel({"method": method, "block": block})
        name = f"Block {int(block)}: {100 * float(at.b):g} × {100 * float(at.h):g} cm, b/h = {float(at.b / at.h):.2g}"
        colour = BLOCK_COLOURS[i % 4]
        ax.plot(
            ds.frequency,
            at.onset_acceleration / G,
            color=colour,
            ls=STYLES[i % 4],
            marker="osD^"[i % 4],
            ms=4.5,
            label=name,
        )
        ax.plot(ds.frequency, at.lift_acceleration / G, color=colour, ls="none", marker="_", ms=9, mew=1.5)
    for level in np.unique(np.round((ds.west / G).values, 9)):
        ax.axhline(level, color="0.35", lw=0.9, ls=(0, (1, 2)), zorder=0)
        ax.fill_between(ds.frequency, 0.9 * level, 1.1 * level, color="0.93", lw=0, zorder=-1)
    ax.set_title(METHOD_LABELS[method])
    ax.set_xlabel("Frequency of the base motion [Hz]")
    ax.grid(alpha=0.3)


def figure(ds: xr.Dataset, text: str) -> Figure:
    """Criteria of rocking against frequency, one panel a method."""
    methods = [str(m) for m in ds.method.values]
    fig = new_figure(3.7 * len(methods) + 2.9, 4.7)
    axes = fig.subplots(1, len(methods), sharey=True, squeeze=False)[0]
    for ax, method in zip(axes, methods, strict=True):
        _panel(ax, ds, method)
    # Where nothing rocks, West's lines are all there is to see.
    axes[0].set_ylim(0.0, 1.25 * float(np.fmax(ds.onset_acceleration.max(), ds.west.max())) / G)
    axes[0].set_ylabel("Base acceleration at the\nstart of rocking [g]")
    axes[-1].plot([], [], color="0.2", ls="none", marker="_", ms=9, mew=1.5, label="at lift-off itself")
    axes[-1].plot([], [], color="0.35", lw=0.9, ls=(0, (1, 2)), label="West: (b/h) g, band of 10 %")
    axes[-1].legend(loc="upper left", bbox_to_anchor=(1.02, 1.0), frameon=False, fontsize=8.5)
    missing = int(ds.onset_acceleration.isnull().sum())
    caption(fig, f"{text} At {missing} points no corner rose as far, or the run was declined." if missing else text)
    return fig
