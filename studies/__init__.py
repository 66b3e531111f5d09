"""Figures and criteria: specimens, motions, methods and solvers put together; datasets out.

`python -m studies` lists the studies, `python -m studies all` makes every one; each has a `dataset`, a `figure` and a
`check` part, and writes NetCDF first, then draws what is in it.  `studies.open("fig16.nc")` opens what was made.
"""

import studies._early  # noqa: F401 (first: it stands guard while the others are loaded)
from studies.analysis import interpolated, open

__all__ = ["interpolated", "open"]
