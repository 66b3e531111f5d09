"""Fig. 18 of Winkler, Meguro & Yamazaki (1995): criteria of overturning of a free column of two blocks.

See          the column falls at an acceleration that grows with frequency; the dotted line is where its blocks part.
Paper says   distinct elements agree with the tests, less so above 4 Hz; the figure's points are not printed as numbers.
Run          python -m studies.fig18 [--quick]  ->  build/studies/fig18.nc, then fig18.png and .pdf
"""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from studies.criteria.columns import Column
from studies.families import columns as columns_figures
from studies.running.parts import Parts
from studies.running.statements import table
from studies.running.study import Study

COLUMNS = (Column(2),)


def dataset(plan: columns_figures.ColumnsPlan, parts: Parts) -> xr.Dataset:
    """Criteria over (column, tiny, frequency)."""
    return columns_figures.dataset(plan, parts, "fig18")


def figure(ds: xr.Dataset) -> Figure:
    """Criteria of overturning and of parting, and what moves them."""
    return columns_figures.figure(
        ds,
        "After Fig. 18 of Winkler, Meguro & Yamazaki (1995): a free column of two blocks of 15 × 50 cm. Notice: at low "
        "frequency it falls soon after it rocks; the higher the frequency, the longer the way from the parting of the "
        "blocks (dotted) to the fall, and the more chance decides (band: ramps that differ by parts in a million).",
    )


def check(ds: xr.Dataset) -> xr.Dataset:
    """No statement of the paper on this figure alone; see fig19 and fig20."""
    return table([])


STUDY = Study(
    name="fig18",
    title="Criteria of overturning of a free column of two blocks (Fig. 18)",
    about="At which acceleration of the table does a column of two wooden blocks fall?",
    plan=lambda options: columns_figures.plan_of(COLUMNS, options),
    dataset=dataset,
    figures={"fig18": figure},
    check=check,
    arguments=columns_figures.arguments,
    example='ds.overturning_amplitude.median("tiny", skipna=False).plot.line(x="frequency")',
)

if __name__ == "__main__":
    STUDY.run()
