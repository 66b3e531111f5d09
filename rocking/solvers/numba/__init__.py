"""Compiled with numba: any system of plain functions, adaptive Runge-Kutta with located events; the default.

`solver` is what the entry point names, `batch` carries many runs, `windows` many with their samples; `compiling` keeps
compiled code on disk, for the solvers `exact` and `taylor` too.
"""
