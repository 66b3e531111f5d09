"""Fig. 17 of Winkler, Meguro & Yamazaki (1995): a free column of two blocks under a 3 Hz sinusoid, in frames.

See          the blocks rock as one, part, rock under different angles, and fall.
Paper says   the same, with the parting at about 21 s of its own ramp, of which it does not print the growth.
Run          python -m studies.fig17 [--quick]  ->  build/studies/fig17.nc, then fig17.png and .pdf, fig17.html to play
             and fig17.gif
"""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from studies.animation.frames import frames
from studies.criteria.columns import Column
from studies.families import column_runs
from studies.running.statements import table
from studies.running.study import Study

COLUMN = Column(2)


def figure(ds: xr.Dataset) -> Figure:
    """Frames at the stages of the response and between them."""
    times, labels = column_runs.instants(ds, 12)
    note = (
        "After Fig. 17 of Winkler, Meguro & Yamazaki (1995): a free column of two blocks under a base motion of "
        f"{ds.attrs['frequency']:g} Hz that grows, by distinct elements. Notice: at first the blocks turn as one; once "
        "the joint between them opens they turn under different angles, until one of them falls."
    )
    return frames(ds, times, labels=labels, note=note)


def check(ds: xr.Dataset) -> xr.Dataset:
    """No statement in numbers on the frames; see fig20, which is of the same run."""
    return table([])


STUDY = Study(
    name="fig17",
    title="Frames of the response of a free column of two blocks (Fig. 17)",
    about="How does a column of two blocks come to fall? One run, in frames.",
    plan=lambda options: column_runs.plan_of(COLUMN, options),
    dataset=column_runs.dataset,
    figures={"fig17": figure},
    check=check,
    arguments=column_runs.arguments,
    films=column_runs.films,
    example='ds.theta.plot.line(x="time")',
)

if __name__ == "__main__":
    STUDY.run()
