"""Fig. 19 of Winkler, Meguro & Yamazaki (1995): criteria of a column of two blocks next to a wall, beside the free one.

See          where the wall holds the column and where it throws it.
Paper says   below 2 Hz the free column falls first, above 2 Hz the one next to the wall.
Run          python -m studies.fig19 [--quick]  ->  build/studies/fig19.nc, then fig19.png and .pdf
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from studies.claims.bounds import CLAIMS
from studies.criteria.columns import Column
from studies.families import columns as columns_figures
from studies.running.parts import Parts
from studies.running.statements import Finding, listed, table
from studies.running.study import Study

COLUMNS = (Column(2), Column(2, 0.0))


def dataset(plan: columns_figures.ColumnsPlan, parts: Parts) -> xr.Dataset:
    """Criteria over (column, tiny, frequency)."""
    return columns_figures.dataset(plan, parts, "fig19")


def figure(ds: xr.Dataset) -> Figure:
    """Criteria of overturning and of parting, and what moves them."""
    return columns_figures.figure(
        ds,
        "After Fig. 19 of Winkler, Meguro & Yamazaki (1995): a column of two blocks that stands against a wall fixed "
        "to the table, beside the free one of Fig. 18. Notice where the two curves cross: the wall takes away one "
        "direction of fall and gives blows instead. Bands: ramps that differ by parts in a million.",
    )


def check(ds: xr.Dataset) -> xr.Dataset:
    """Which of the two falls first, below and above 2 Hz."""
    free, wall = (columns_figures.median(ds).isel(column=i) for i in (0, 1))
    ratio = wall / free
    by_frequency = {f"{float(f):g} Hz": float(r) for f, r in zip(ds.frequency, ratio, strict=True)}
    detail = "wall over free: " + listed(by_frequency)
    known = ratio.notnull()

    def share(chosen: xr.DataArray, holds: xr.DataArray) -> float:
        chosen = chosen & known
        return float(holds.where(chosen).mean()) if bool(chosen.any()) else np.nan

    return table(
        [
            Finding(CLAIMS["fig19.low"], share(ds.frequency < 2.0, ratio > 1.0), detail),
            Finding(CLAIMS["fig19.high"], share(ds.frequency > 2.0, ratio < 1.0), detail),
        ]
    )


STUDY = Study(
    name="fig19",
    title="Criteria of overturning of a column of two blocks next to a wall (Fig. 19)",
    about="Does a wall help a column of two blocks, or throw it?",
    plan=lambda options: columns_figures.plan_of(COLUMNS, options),
    dataset=dataset,
    figures={"fig19": figure},
    check=check,
    arguments=columns_figures.arguments,
    example='ds.overturning_amplitude.median("tiny", skipna=False).plot.line(x="frequency", hue="column")',
)

if __name__ == "__main__":
    STUDY.run()
