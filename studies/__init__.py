"""Figures and criteria: specimens, motions, methods and solvers put together; datasets out.

`python -m studies.fig16` makes Fig. 16 of Winkler, Meguro & Yamazaki (1995); every figure has a `dataset`, a `figure`
and a `check` part, and writes NetCDF first, then draws what is in it.
"""
