"""Fig. 14 of Winkler, Meguro & Yamazaki (1995): criteria of rocking of Blocks 1 to 4, alike in shape.

See          all sizes begin to rock near (b/h) g = 0.3 g; motion that one could measure follows a little above it.
Paper says   no significant difference between sizes; methods and distinct elements agree; (b/h) g decides alone.
Run          python -m studies.fig14 [--quick]  ->  build/studies/fig14.nc, then fig14.png and .pdf
"""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from studies.claims.bounds import CLAIMS
from studies.families import onset as onset_figures
from studies.running.parts import Parts
from studies.running.statements import Finding, listed, table
from studies.running.study import Study

BLOCKS = (1, 2, 3, 4)


def dataset(plan: onset_figures.OnsetPlan, parts: Parts) -> xr.Dataset:
    """Criteria of rocking over (method, block, frequency)."""
    return onset_figures.dataset(plan, parts, "fig14")


def figure(ds: xr.Dataset) -> Figure:
    """One panel a method."""
    return onset_figures.figure(
        ds,
        "After Fig. 14 of Winkler, Meguro & Yamazaki (1995). Notice: four blocks of one slenderness, the largest four "
        "times as large as the smallest, begin to rock at one acceleration at every frequency. Lines: largest "
        "acceleration until a corner is 0.05 mm off the floor; dashes: at lift-off itself, which Methods 1 and 2 take "
        "from eq. (1) and the distinct elements find by themselves.",
    )


def check(ds: xr.Dataset) -> xr.Dataset:
    """The paper's statements on Fig. 14."""
    lift = onset_figures.departures(ds, "lift_acceleration").sel({"method": "dem"})
    motion = onset_figures.departures(ds, "onset_acceleration")
    a = ds.onset_acceleration
    spread = (a.max("block", skipna=False) - a.min("block", skipna=False)) / a.mean("block", skipna=False)
    by_block = {f"Block {int(n)}": onset_figures.largest(lift.sel(block=n)) for n in ds.block.values}
    return table(
        [
            Finding(CLAIMS["fig14.lift"], onset_figures.largest(lift), listed(by_block)),
            Finding(CLAIMS["fig14.motion"], onset_figures.largest(motion), listed(onset_figures.by_method(motion))),
            Finding(CLAIMS["fig14.size"], onset_figures.largest(spread), listed(onset_figures.by_method(spread))),
        ]
    )


STUDY = Study(
    name="fig14",
    title="Criteria of rocking of blocks of different size (Fig. 14)",
    about="A wooden block stands on a table that shakes harder and harder; when does it begin to rock?",
    plan=lambda options: onset_figures.plan_of(BLOCKS, options),
    dataset=dataset,
    figures={"fig14": figure},
    check=check,
    arguments=onset_figures.arguments,
    example='(ds.onset_acceleration / ds.west).plot.line(x="frequency", col="method")',
)

if __name__ == "__main__":
    STUDY.run()
