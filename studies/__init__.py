"""Figures and criteria: specimens, motions, methods and solvers put together; datasets out.

`python -m studies` lists the studies, `python -m studies all` makes every one; each has a `dataset`, a `figure` and a
`check` part, and writes NetCDF first, then draws what is in it.  `studies.open("fig16.nc")` opens what was made.

A file beside this one, and a package with a `__main__`, is a command; what commands share is in `running` (files, runs
side by side, command lines), `criteria` (thresholds of one block or column) and `families` (figures of one kind).
"""

import excitation._early  # noqa: F401 (first: it stands guard while the others are loaded)
from studies.analysis import interpolated, open

__all__ = ["interpolated", "open"]
