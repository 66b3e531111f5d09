"""What Figs 17, 20 and 22 share: one run of a column from rest until well after its fall, and instants worth seeing.

Source   Winkler, Meguro & Yamazaki (1995), "Block assemblies": columns under a 3 Hz sinusoid
Status   the run itself: `studies.criteria.columns`
"""

from __future__ import annotations

import argparse
import math
from dataclasses import asdict, dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from studies.animation import save
from studies.criteria.columns import PARTED, Column, ColumnJob, ColumnSettings, G, history
from studies.families.columns import QUICK_DURATION
from studies.running.command_line import positive
from studies.running.labelled import PAPER
from studies.running.parts import Parts
from studies.specimens import specimen

PAPER_HZ = 3.0
"""Frequency [Hz] of the paper's run, of which its statements speak."""

LAST = 3.0
"""Time [s] before the end that the GIF shows."""

AFTER = 1.2
"""Time [s] for which a run goes on after the first block has passed its balance."""


@dataclass(frozen=True)
class RunPlan:
    """One run."""

    column: Column
    frequency: float = PAPER_HZ
    settings: ColumnSettings = field(default_factory=ColumnSettings)


def arguments(parser: argparse.ArgumentParser) -> None:
    """--frequency, --ramp and --friction."""
    parser.add_argument(
        "--frequency", type=float, default=PAPER_HZ, metavar="HZ", help="of the base motion (default: 3)"
    )
    parser.add_argument(
        "--ramp",
        type=float,
        default=3.0,
        metavar="G",
        help="acceleration at the end of the 90 s ramp, in g (default: 3)",
    )
    parser.add_argument("--friction", type=float, default=0.7, metavar="MU", help="of all contacts (default: 0.7)")


def plan_of(column: Column, options: argparse.Namespace) -> RunPlan:
    """The plan that the command line asks for.

    Raises:
        BadInputError: an option's value is not one that it can have.
    """
    positive("--frequency", options.frequency)
    positive("--ramp", options.ramp)
    positive("--friction", options.friction, zero=True)
    settings = ColumnSettings(ramp=options.ramp * G, friction=options.friction)
    if options.quick:
        settings = replace(settings, duration=QUICK_DURATION)
    return RunPlan(column, options.frequency, settings)


def stages(ds: xr.Dataset, alpha: float) -> dict[str, float]:
    """Times [s] of what happens to the column, NaN for what does not, by name in the order that one may expect.

    "rocks": a corner of the lowest block leaves the floor; "a joint opens", "another joint opens": neighbours part by
    5 % of alpha, the first and (of three blocks) the second pair; "falls": a block passes its balance for good.
    """
    falls = ds.overturning_time.values
    fell = float(np.nanmin(falls)) if np.isfinite(falls).any() else math.nan
    on_floor = [i for i, name in enumerate(ds.interface.values) if "floor" in str(name)]
    lift = ds.separation_time.values[on_floor]
    apart = np.abs(np.diff(ds.theta.values, axis=1)) / alpha
    until = fell if math.isfinite(fell) else math.inf
    opened = []
    for pair in apart.T:
        first = np.flatnonzero((pair > PARTED) & (ds.time.values <= until))
        opened.append(float(ds.time.values[first[0]]) if first.size else math.nan)
    opened.sort(key=lambda t: math.inf if math.isnan(t) else t)
    found = {"rocks": float(np.nanmin(lift)) if np.isfinite(lift).any() else math.nan}
    names = ("a joint opens", "another joint opens", "a third joint opens")
    return found | dict(zip(names, opened, strict=False)) | {"falls": fell}


def dataset(plan: RunPlan, parts: Parts) -> xr.Dataset:
    """The run as `to_xarray` gives it, with base acceleration, envelope and stages."""
    job = ColumnJob(plan.column, plan.frequency, plan.settings)
    first = history(job)
    end = min(plan.settings.duration, first.overturning_time + AFTER) if first.falls else plan.settings.duration
    run = history(job, t_end=end, stop="never")
    ds = run.to_xarray()
    base = plan.settings.motion(plan.frequency)
    ds["envelope"] = (
        "time",
        base.envelope(run.time),
        {"units": "m s-2", "long_name": "envelope of the base acceleration"},
    )
    a_x = {"units": "m s-2", "long_name": "horizontal base acceleration"}
    ds["base_acceleration"] = ("time", base(run.time)[0], a_x)
    ds.attrs["scene"] = ds.attrs.pop("title")
    found = stages(ds, specimen(plan.settings.block).alpha)
    ds["stage_time"] = ("stage", list(found.values()), {"units": "s", "long_name": "when the stage is reached"})
    ds = ds.assign_coords(stage=("stage", list(found), {"long_name": "stage of the response"}))
    ds.attrs |= {"references": f"{PAPER}, Figs 17, 20 and 22", "frequency": plan.frequency, "plan": repr(asdict(plan))}
    return ds


def said_of(ds: xr.Dataset, number: float) -> float:
    """The number if the run has the frequency of which the paper speaks; NaN, not known, if it has another."""
    return number if float(ds.attrs["frequency"]) == PAPER_HZ else math.nan


def stage_times(ds: xr.Dataset) -> dict[str, float]:
    """The stages of a dataset by name."""
    return {str(name): float(t) for name, t in zip(ds.stage.values, ds.stage_time.values, strict=True)}


def instants(ds: xr.Dataset, count: int = 11) -> tuple[list[float], list[str]]:
    """(times [s], labels): each stage, the widest tilts between them, and the fall in steps."""
    known = {name: t for name, t in stage_times(ds).items() if math.isfinite(t)}
    time, theta = ds.time.values, np.abs(ds.theta.values).max(axis=1)
    period, end = 1.0 / float(ds.attrs["frequency"]), float(time[-1])
    chosen: dict[float, str] = {0.0: "stands"}
    for name, t in known.items():
        # Just after the instant itself, where it can be seen.
        soon = (time >= t) & (time <= min(end, t + 0.5 * period))
        chosen[t if name == "falls" else float(time[soon][np.argmax(theta[soon])])] = name
    marks = [*known.values()]
    for start, stop in pairwise(marks):
        middle = (time > start + 0.4 * (stop - start)) & (time < start + 0.6 * (stop - start))
        if stop - start > 2.0 * period and middle.any():
            chosen[float(time[middle][np.argmax(theta[middle])])] = "between"
    fall = known.get("falls", end)
    for step in range(1, max(1, count - len(chosen)) + 1):
        chosen[fall + (end - fall) * step / max(1, count - len(chosen) + step)] = "fall"
    times = sorted(chosen)[:count]
    return times, ["" if chosen[t] in ("between", "fall") else chosen[t] for t in times]


def films(ds: xr.Dataset, folder: Path) -> list[Path]:
    """A page to play the run, and a GIF of its last seconds."""
    name, end = str(ds.attrs["study"]), float(ds.time[-1])
    title = f"{ds.attrs['title']}, {ds.attrs['frequency']:g} Hz"
    whole = save(ds, folder / f"{name}.html", title=title)
    return [whole, save(ds, folder / f"{name}.gif", title=title, start=max(0.0, end - LAST), fps=10.0)]


def separation(ds: xr.Dataset) -> Any:
    """Largest difference of the angles of neighbours over time [rad]."""
    return np.abs(ds.theta.diff("body")).max("body")
