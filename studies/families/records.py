"""What Figs 2 and 3 share: moments read off a vertical record, beside what the simulation knows.

Source   Winkler, Meguro & Yamazaki (1995), Figs 2 and 3
Status   the reading: `studies.criteria.pickups`
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from studies.criteria.columns import Column, ColumnSettings, G
from studies.criteria.pickups import NOISE, fall_record, onset_record
from studies.running.command_line import positive
from studies.running.labelled import FREQUENCIES, PAPER, QUICK_FREQUENCIES, frequency_axis, gathered
from studies.running.parts import Parts
from studies.running.plot import caption, new_figure

THREE = Column(3)
"""The column whose fall is read."""

LABELS = {
    "true_time": ("s", "moment in the simulation"),
    "read_time": ("s", "moment read off the record"),
    "true_amplitude": ("m s-2", "base acceleration at the moment in the simulation"),
    "read_amplitude": ("m s-2", "base acceleration at the moment read off the record"),
}


@dataclass(frozen=True)
class RecordPlan:
    """What is computed."""

    settings: ColumnSettings
    frequencies: tuple[float, ...] = FREQUENCIES
    seeds: tuple[int, ...] = (1, 2, 3)
    shown: float = 3.0  # frequency of the record that is drawn [Hz]


@dataclass(frozen=True)
class RecordJob:
    """One record."""

    what: str  # "start" or "fall"
    frequency: float
    seed: int
    settings: ColumnSettings


def plan_of(settings: ColumnSettings, options: argparse.Namespace) -> RecordPlan:
    """The plan that the command line asks for.

    Raises:
        BadInputError: an option's value is not one that it can have.
    """
    positive("--friction", options.friction, zero=True)
    if options.quick:
        return RecordPlan(settings, QUICK_FREQUENCIES[1:2], (1,))
    return RecordPlan(settings)


def arguments(parser: argparse.ArgumentParser) -> None:
    """--friction."""
    parser.add_argument("--friction", type=float, default=0.7, metavar="MU", help="of all contacts (default: 0.7)")


def record(job: RecordJob) -> dict[str, Any]:
    """The record of a job and the moments on it."""
    if job.what == "start":
        return onset_record(job.settings.block, job.frequency, job.settings, job.seed)
    return fall_record(THREE, job.frequency, job.settings, job.seed)


def moments(job: RecordJob) -> dict[str, Any]:
    """The moments of a job without its record."""
    found = record(job)
    return {name: found[name] for name in LABELS}


def dataset(plan: RecordPlan, parts: Parts, what: str, label: str) -> xr.Dataset:
    """The record that is drawn over time, and the moments over (frequency, seed)."""
    jobs = [RecordJob(what, f, seed, plan.settings) for f, seed in product(plan.frequencies, plan.seeds)]
    results = parts.results(jobs, moments, label)
    shape = (len(plan.frequencies), len(plan.seeds))
    ds = xr.Dataset(gathered(results, ("frequency", "seed"), shape, LABELS), frequency_axis(plan.frequencies))
    ds = ds.assign_coords(seed=("seed", list(plan.seeds), {"units": "1", "long_name": "seed of the noise"}))
    shown = record(RecordJob(what, plan.shown, plan.seeds[0], plan.settings))
    ds = ds.assign_coords(time=("time", shown["time"], {"units": "s", "long_name": "time"}))
    ds["reading"] = ("time", shown["reading"], {"units": "m s-2", "long_name": "vertical reading, gravity with it"})
    a_x = {"units": "m s-2", "long_name": "horizontal base acceleration"}
    ds["base_acceleration"] = ("time", shown["base_acceleration"], a_x)
    ds.attrs = {"references": f"{PAPER}, Figs 2 and 3", "shown_frequency": plan.shown, "noise": NOISE}
    return ds


def error(ds: xr.Dataset) -> xr.DataArray:
    """Relative error of the base acceleration that is read."""
    return ds.read_amplitude / ds.true_amplitude - 1.0


def _zoom(ax: Any, ds: xr.Dataset, marks: Sequence[tuple[float, str, str]], width: float) -> None:
    known = [t for t, _, _ in marks if math.isfinite(t)]
    near = ds.sel(time=slice(np.mean(known) - width, np.mean(known) + width)) if known else ds
    ax.plot(near.time, near.reading, color="0.15", lw=0.7)
    for t, colour, label in marks:
        when = f"{t:.2f} s" if math.isfinite(t) else "none"
        ax.axvline(t, color=colour, ls="--" if "read" in label else "-", lw=1.4, label=f"{label}: {when}")
    ax.set_xlabel("Time [s]")
    ax.set_ylabel("Reading [m/s²]")
    low, high = ax.get_ylim()
    ax.set_ylim(max(low, -2.5 * G), min(high, 4.0 * G))  # impacts go far beyond
    ax.legend(fontsize=8, loc="lower left")
    ax.grid(alpha=0.3)


def figure(ds: xr.Dataset, what: str, text: str, width: float, start: float = 0.0) -> Figure:
    """Base motion, record, the moments near by, and the error of what is read over frequency."""
    fig = new_figure(12.0, 6.2)
    grid = fig.add_gridspec(2, 2, width_ratios=[1.5, 1.0])
    top = fig.add_subplot(grid[0, 0])
    below, zoom, errors = (
        fig.add_subplot(grid[1, 0], sharex=top),
        fig.add_subplot(grid[0, 1]),
        fig.add_subplot(grid[1, 1]),
    )
    shown = ds.sel(time=slice(start, None))
    top.plot(shown.time, shown.base_acceleration / G, color="0.35", lw=0.5)
    top.set_ylabel("Base acceleration [g]")
    below.plot(shown.time, shown.reading, color="0.15", lw=0.4)
    low, high = np.percentile(shown.reading, [0.02, 99.9])
    below.set_ylim(1.3 * low - 2.0 * G, 1.3 * high + 2.0 * G)
    below.set_ylabel("Vertical reading\non the block [m/s²]")
    below.set_xlabel("Time [s]")
    at = ds.sel(frequency=ds.attrs["shown_frequency"]).isel(seed=0)
    marks = [
        (float(at.true_time), "#0072B2", f"{what} (simulation)"),
        (float(at.read_time), "#D55E00", f"{what} (read)"),
    ]
    for ax in (top, below):
        for t, colour, label in marks:
            ax.axvline(t, color=colour, ls="--" if "read" in label else "-", lw=1.2)
        ax.grid(alpha=0.3)
    _zoom(zoom, ds, marks, width)
    for i in range(ds.sizes["seed"]):
        values = 100.0 * error(ds).isel(seed=i)
        errors.plot(ds.frequency, values, color="#0072B2", ls="none", marker="osD"[i % 3], ms=4, mfc="none")
    errors.axhline(0.0, color="0.4", lw=0.8)
    errors.set_xlabel("Frequency of the base motion [Hz]")
    errors.set_ylabel("Error of the base\nacceleration read [%]")
    errors.grid(alpha=0.3)
    caption(fig, text)
    return fig
