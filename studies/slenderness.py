"""From which frequency rocking precedes overturning, by slenderness.

See          a stocky block rocks for a while before it falls at frequencies at which a slender one falls at once.
Paper says   at low frequency a block falls the moment rocking would begin; from which frequency it rocks before cannot
             be said without its b/h.
Run          python -m studies.slenderness [--quick]  ->  build/studies/slenderness.nc, then slenderness.png and .pdf
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from rocking import Outcome, solve
from studies.claims.bounds import CLAIMS
from studies.criteria.columns import G
from studies.criteria.overturning import METHOD_LABELS, Settings, system_of
from studies.criteria.rocking_onset import rocking_start
from studies.running.command_line import positive
from studies.running.files import BadInputError
from studies.running.labelled import block_axis, frequency_axis, gathered, names_axis
from studies.running.parts import Parts
from studies.running.plot import caption, new_figure
from studies.running.statements import Finding, listed, table
from studies.running.study import Study
from studies.specimens import specimen

BLOCKS = (3, 5, 6, 7)
METHODS = ("method1", "method2")
FREQUENCIES = tuple(round(0.2 * i, 6) for i in range(1, 26))
ONE_PERIOD = 1.0
"""Rocking precedes overturning if it lasts longer than this many periods."""


@dataclass(frozen=True)
class Plan:
    """What is computed; the ramp grows slowly, so that it is not ahead of the block."""

    frequencies: tuple[float, ...] = FREQUENCIES
    settings: Settings = field(default_factory=lambda: Settings(ramp=6.0 * G, duration=180.0))


@dataclass(frozen=True)
class Job:
    """One run."""

    method: str
    block: int
    frequency: float
    settings: Settings


def _times(job: Job) -> dict[str, Any]:
    """Start of rocking and overturning [s] of one run; whether it failed."""
    settings = job.settings
    run = solve(
        system_of(job.method, specimen(job.block), settings), settings.motion(job.frequency), t_end=settings.duration,
        rtol=settings.rtol, atol=settings.atol, save_at=(),
    )  # fmt: skip
    failed = run.outcome is Outcome.FAILED
    return {"onset_time": rocking_start(run), "overturning_time": run.overturning_time, "failed": failed}


def dataset(plan: Plan, parts: Parts) -> xr.Dataset:
    """Times over (method, block, frequency).

    Raises:
        RuntimeError: a run failed, of which nobody can say whether its block stands.
    """
    jobs = [Job(*point, plan.settings) for point in product(METHODS, BLOCKS, plan.frequencies)]
    results = parts.results(jobs, _times, "slenderness")
    failed = sum(result["failed"] for result in results)
    if failed:
        raise RuntimeError(f"{failed} runs failed; want none")
    labels = {"onset_time": ("s", "start of rocking"), "overturning_time": ("s", "time of overturning")}
    shape = (len(METHODS), len(BLOCKS), len(plan.frequencies))
    ds = xr.Dataset(gathered(results, ("method", "block", "frequency"), shape, labels))
    ds = ds.assign_coords(
        block_axis(BLOCKS) | frequency_axis(plan.frequencies) | names_axis("method", METHODS, "method")
    )
    return ds.assign_attrs(ramp=plan.settings.ramp, duration=plan.settings.duration)


def periods(ds: xr.Dataset) -> xr.DataArray:
    """Periods of rocking before overturning; a block that stands at the end of the ramp rocks until then."""
    falls = ds.overturning_time.fillna(float(ds.attrs["duration"]))
    return ((falls - ds.onset_time) * ds.frequency).rename("periods")


def from_which(ds: xr.Dataset) -> xr.DataArray:
    """Lowest frequency from which on every block rocks for longer than one period first [Hz]; NaN if none."""
    longer = (periods(ds) > ONE_PERIOD).isel(frequency=slice(None, None, -1))
    from_there = longer.astype(int).cumprod("frequency").astype(bool)
    return ds.frequency.where(from_there).min("frequency")


def figure(ds: xr.Dataset) -> Figure:
    """Periods of rocking against frequency (left), and the frequency from which there are any against b/h (right)."""
    fig = new_figure(11.0, 4.6)
    left, right = fig.subplots(1, 2, width_ratios=[1.6, 1.0])
    colours = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")
    order = ds.sortby("alpha", ascending=False)
    for i, block in enumerate(order.block.values):
        curve = periods(order).sel({"method": "method2", "block": block})
        label = f"Block {int(block)}, b/h = {float(curve.b / curve.h):.1f}"
        left.plot(ds.frequency, np.maximum(curve, 0.05), color=colours[i], marker="osD^"[i], ms=4, label=label)
    left.axhline(ONE_PERIOD, color="0.4", lw=1, ls=":")
    left.set_yscale("log")
    left.set_xlabel("Frequency of the base motion [Hz]")
    left.set_ylabel("Periods from the start of rocking\nto overturning (Method 2)")
    left.legend(fontsize=8)
    left.grid(alpha=0.3)
    limits = from_which(order)
    for i, method in enumerate(ds.method.values):
        at = limits.sel({"method": method})
        right.plot(
            order.b / order.h, at, marker="os"[i], color=("#D55E00", "#0072B2")[i], label=METHOD_LABELS[str(method)]
        )
    right.set_xlabel("b/h")
    right.set_ylabel("Frequency from which rocking\nprecedes overturning [Hz]")
    right.set_ylim(bottom=0.0)
    right.legend(fontsize=8)
    right.grid(alpha=0.3)
    caption(
        fig,
        f"Blocks of one height on a ramp to {float(ds.attrs['ramp']) / G:.2g} g in {float(ds.attrs['duration']):g} s. "
        "Notice below which frequency a block falls within a period of the start of rocking, and whether that depends "
        "on b/h (right). A block that stands at the end of the ramp is counted as rocking until then.",
    )
    return fig


def check(ds: xr.Dataset) -> xr.Dataset:
    """How much the frequency depends on b/h."""
    limits = from_which(ds).sel({"method": "method2"})
    by_block = {f"b/h {float(b / h):.1f}": float(f) for b, h, f in zip(ds.b, ds.h, limits, strict=True)}
    ratio = float(limits.max() / limits.min()) if bool(limits.notnull().all()) else np.nan
    return table([Finding(CLAIMS["slenderness.frequency"], ratio, "Hz: " + listed(by_block))])


def arguments(parser: argparse.ArgumentParser) -> None:
    """--friction."""
    parser.add_argument("--friction", type=float, default=0.7, metavar="MU", help="Method 2 (default: 0.7)")


def plan_of(options: argparse.Namespace) -> Plan:
    """The plan that the command line asks for.

    Raises:
        BadInputError: an option's value is not one that it can have.
    """
    positive("--friction", options.friction, zero=True)
    if options.friction >= 4.0 / 3.0:
        raise BadInputError(f"--friction {options.friction:g}: want below 4/3 with Method 2 (a corner may jam)")
    plan = Plan()
    plan = replace(plan, settings=replace(plan.settings, friction=options.friction))
    if options.quick:
        return Plan(FREQUENCIES[::4], replace(plan.settings, duration=60.0))
    return plan


STUDY = Study(
    name="slenderness",
    title="From which frequency a block rocks before it falls, by slenderness",
    about="Does a block rock before it falls, or does it fall as it would begin to rock?",
    plan=plan_of,
    dataset=dataset,
    figures={"slenderness": figure},
    check=check,
    arguments=arguments,
    example='(ds.overturning_time - ds.onset_time).sel({"method": "method2"}).plot.line(x="frequency")',
)

if __name__ == "__main__":
    STUDY.run()
