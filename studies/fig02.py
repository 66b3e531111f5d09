"""Fig. 2 of Winkler, Meguro & Yamazaki (1995): the start of rocking read off the vertical record of Block 2.

See          the record leaves its noise soon after the block has lifted off.
Paper says   the moment was taken from vertical records, since a pickup turns with the block; no rule is printed.
Run          python -m studies.fig02 [--quick]  ->  build/studies/fig02.nc, then fig02.png and .pdf
"""

from __future__ import annotations

import argparse

import xarray as xr
from matplotlib.figure import Figure

from studies.claims.bounds import CLAIMS
from studies.criteria.columns import ColumnSettings, G
from studies.families import records as record_figures
from studies.running.parts import Parts
from studies.running.statements import Finding, listed, table
from studies.running.study import Study

BLOCK = 2


def plan_of(options: argparse.Namespace) -> record_figures.RecordPlan:
    """The plan that the command line asks for."""
    return record_figures.plan_of(ColumnSettings(ramp=1.0 * G, friction=options.friction, block=BLOCK), options)


def dataset(plan: record_figures.RecordPlan, parts: Parts) -> xr.Dataset:
    """The record at 3 Hz, and the moments over (frequency, seed)."""
    return record_figures.dataset(plan, parts, "start", "fig02")


def figure(ds: xr.Dataset) -> Figure:
    """The record, and how well the start is read off it."""
    return record_figures.figure(
        ds,
        "lift-off",
        "After Fig. 2 of Winkler, Meguro & Yamazaki (1995): Block 2 (22.5 × 75 cm) of distinct elements on a table "
        f"that shakes harder and harder, at {ds.attrs['shown_frequency']:g} Hz; pickup at the middle of the top, noise "
        f"of {ds.attrs['noise']:g} m/s². Notice: first impacts drown in the noise, so the start is read a little late "
        "(lower right: all frequencies, three seeds of the noise).",
        1.5,
        start=5.0,
    )


def check(ds: xr.Dataset) -> xr.Dataset:
    """How well the start is read."""
    worst = abs(record_figures.error(ds)).max("seed", skipna=False)
    by_frequency = {f"{float(f):g} Hz": float(e) for f, e in zip(ds.frequency, worst, strict=True)}
    return table([Finding(CLAIMS["fig02.detection"], float(worst.max(skipna=False)), listed(by_frequency, 2))])


STUDY = Study(
    name="fig02",
    title="Start of rocking read off the vertical record of Block 2 (Fig. 2)",
    about="When does a block begin to rock, going by an accelerometer on it, and how far is that from the truth?",
    plan=plan_of,
    dataset=dataset,
    figures={"fig02": figure},
    check=check,
    arguments=record_figures.arguments,
    example='ds.reading.plot(x="time")',
)

if __name__ == "__main__":
    STUDY.run()
