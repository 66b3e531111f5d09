"""Fig. 22 of Winkler, Meguro & Yamazaki (1995): a column of three blocks under a 3 Hz sinusoid, in frames.

See          the column rocks, one joint opens, then the other, and a block falls.
Paper says   its figure shows representative moments of the same; the text prints no times.
Run          python -m studies.fig22 [--quick]  ->  build/studies/fig22.nc, then fig22.png and .pdf, fig22.html to play
             and fig22.gif
"""

from __future__ import annotations

import math

import xarray as xr
from matplotlib.figure import Figure

from studies.animation.frames import frames
from studies.claims.bounds import CLAIMS
from studies.criteria.columns import Column
from studies.families import column_runs
from studies.running.statements import Finding, listed, table
from studies.running.study import Study

COLUMN = Column(3)


def figure(ds: xr.Dataset) -> Figure:
    """Frames at the stages of the response and between them."""
    times, labels = column_runs.instants(ds, 12)
    note = (
        "After Fig. 22 of Winkler, Meguro & Yamazaki (1995): a free column of three blocks under a base motion of "
        f"{ds.attrs['frequency']:g} Hz that grows, by distinct elements. Notice the order: the column rocks, one joint "
        "opens, then the other, and in the end a block falls."
    )
    return frames(ds, times, labels=labels, note=note)


def check(ds: xr.Dataset) -> xr.Dataset:
    """Whether each stage is met, in order; not known of a column that stands at the end of the ramp."""
    times = column_runs.stage_times(ds)
    met, last = 0, -math.inf
    for t in times.values():
        if math.isnan(t) or t < last:
            break
        met, last = met + 1, t
    number = column_runs.said_of(ds, float(met)) if math.isfinite(times["falls"]) else math.nan
    return table([Finding(CLAIMS["fig22.stages"], number, listed(times, 4))])


STUDY = Study(
    name="fig22",
    title="Frames of the response of a column of three blocks (Fig. 22)",
    about="How does a column of three blocks come to fall? One run, in frames.",
    plan=lambda options: column_runs.plan_of(COLUMN, options),
    dataset=column_runs.dataset,
    figures={"fig22": figure},
    check=check,
    arguments=column_runs.arguments,
    films=column_runs.films,
    example='ds.theta.plot.line(x="time")',
)

if __name__ == "__main__":
    STUDY.run()
