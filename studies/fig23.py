"""Fig. 23 of Winkler, Meguro & Yamazaki (1995): criteria of overturning of a free column of three blocks.

See          the column of three falls earlier than that of two, and its joints open long before.
Paper says   distinct elements agree reasonably with the tests; the figure's points are not printed as numbers.
Run          python -m studies.fig23 [--quick]  ->  build/studies/fig23.nc, then fig23.png and .pdf
"""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from studies.claims.bounds import CLAIMS
from studies.criteria.columns import COLUMN_BLOCK, Column, G
from studies.families import columns as columns_figures
from studies.running.parts import Parts
from studies.running.statements import Finding, table
from studies.running.study import Study
from studies.specimens import specimen

COLUMNS = (Column(3),)


def dataset(plan: columns_figures.ColumnsPlan, parts: Parts) -> xr.Dataset:
    """Criteria over (column, tiny, frequency)."""
    return columns_figures.dataset(plan, parts, "fig23")


def figure(ds: xr.Dataset) -> Figure:
    """Criteria of overturning and of parting, and what moves them."""
    return columns_figures.figure(
        ds,
        "After Fig. 23 of Winkler, Meguro & Yamazaki (1995): a free column of three blocks of 15 × 50 cm. Notice: its "
        "blocks part soon after it begins to rock, and at high frequency it goes on for long in pieces before one of "
        "them falls. Bands: ramps that differ by parts in a million.",
    )


def check(ds: xr.Dataset) -> xr.Dataset:
    """Whether every run falls, and none below West's acceleration of the column as one block."""
    block = specimen(COLUMN_BLOCK)
    west = block.b / block.h / 3.0 * G
    falls = (ds.note == "overturned").all(["column", "tiny"])
    return table(
        [
            Finding(CLAIMS["fig23.falls"], float(falls.mean())),
            Finding(CLAIMS["fig23.west"], float(ds.overturning_amplitude.min() / west)),
        ]
    )


STUDY = Study(
    name="fig23",
    title="Criteria of overturning of a column of three blocks (Fig. 23)",
    about="At which acceleration of the table does a column of three wooden blocks fall?",
    plan=lambda options: columns_figures.plan_of(COLUMNS, options),
    dataset=dataset,
    figures={"fig23": figure},
    check=check,
    arguments=columns_figures.arguments,
    example='ds.overturning_amplitude.median("tiny", skipna=False).plot.line(x="frequency")',
)

if __name__ == "__main__":
    STUDY.run()
