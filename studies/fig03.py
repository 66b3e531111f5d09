"""Fig. 3 of Winkler, Meguro & Yamazaki (1995): the fall of a column of three read off the record of its upper block.

See          the record loses gravity when the block falls, shortly after it passed its balance.
Paper says   the moment was taken from vertical records; no rule is printed.
Run          python -m studies.fig03 [--quick]  ->  build/studies/fig03.nc, then fig03.png and .pdf
"""

from __future__ import annotations

import argparse

import xarray as xr
from matplotlib.figure import Figure

from studies.claims.bounds import CLAIMS
from studies.criteria.columns import ColumnSettings
from studies.families import records as record_figures
from studies.running.parts import Parts
from studies.running.statements import Finding, listed, table
from studies.running.study import Study


def plan_of(options: argparse.Namespace) -> record_figures.RecordPlan:
    """The plan that the command line asks for."""
    return record_figures.plan_of(ColumnSettings(friction=options.friction), options)


def dataset(plan: record_figures.RecordPlan, parts: Parts) -> xr.Dataset:
    """The record at 3 Hz, and the moments over (frequency, seed)."""
    return record_figures.dataset(plan, parts, "fall", "fig03")


def figure(ds: xr.Dataset) -> Figure:
    """The record, and how well the fall is read off it."""
    return record_figures.figure(
        ds,
        "fall",
        "After Fig. 3 of Winkler, Meguro & Yamazaki (1995): the upper block of a column of three, of distinct "
        f"elements, at {ds.attrs['shown_frequency']:g} Hz; pickup at the middle of its top. Notice: blows of rocking "
        "hide the passage of the balance, but once the block falls its record loses gravity for good (lower right: all "
        "frequencies, three seeds of the noise).",
        1.5,
    )


def check(ds: xr.Dataset) -> xr.Dataset:
    """How well the fall is read."""
    worst = abs(record_figures.error(ds)).max("seed", skipna=False)
    by_frequency = {f"{float(f):g} Hz": float(e) for f, e in zip(ds.frequency, worst, strict=True)}
    return table([Finding(CLAIMS["fig03.detection"], float(worst.max(skipna=False)), listed(by_frequency, 2))])


STUDY = Study(
    name="fig03",
    title="Fall of a column of three read off the vertical record of its upper block (Fig. 3)",
    about="When does a block fall, going by an accelerometer on it, and how far is that from the truth?",
    plan=plan_of,
    dataset=dataset,
    figures={"fig03": figure},
    check=check,
    arguments=record_figures.arguments,
    example='ds.reading.plot(x="time")',
)

if __name__ == "__main__":
    STUDY.run()
