"""The compiled entries of the Taylor solver: linear and nonlinear block, record and sinusoid, many runs and one.

Each is compiled once for arrays of plain numbers and kept on disk (`rocking.solvers.numba.compiling`).  A number
written into a call has numba compile a function for that number alone, and all that it hands it on to: what serves one
lane and all, or a first time and others, is given such numbers as those of numpy, which leaves a third less to compile.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numba
import numpy as np
from numba import types

from rocking.hybrid import REST, ROTATION
from rocking.solvers.numba.compiling import borrowing, compiled
from rocking.solvers.piecewise.run_log import new_log
from rocking.solvers.taylor import table as row
from rocking.solvers.taylor.lanes import carry
from rocking.solvers.taylor.log import write_end, write_step, write_wait
from rocking.solvers.taylor.roots import empty_scratch
from rocking.solvers.taylor.turns import answer, be_idle, begin, sum_up
from rocking.solvers.taylor.vector import LANES

SHARE = 3
"""Of the lanes at work a share of one in so many waits near the floor before impacts are looked for."""


@borrowing
def next_run(t, lane, runs, run, form, wave):
    """Put the next run that takes longer than its begin into a lane; the number of the one after it."""
    while run < runs.pars.shape[0]:
        goes_on = begin(t, lane, runs, run, form, wave, np.bool_(False))
        run += 1
        if goes_on:
            return run
        sum_up(t, lane, runs)
    be_idle(t, lane)
    return run


@numba.njit(error_model="numpy")
def carry_all(runs, form, wave):
    """All runs, LANES at a time."""
    t, scratch = np.zeros((row.ALL_ROWS, LANES)), empty_scratch()
    run, busy = np.int64(0), 0
    for lane in range(LANES):
        run = next_run(t, lane, runs, run, form, wave)
        busy += t[row.RUN, lane] >= 0.0
    while busy > 0:
        carry(t, runs.values, form, wave, scratch, runs.max_events, 1 + busy // SHARE, False)
        for lane in range(LANES):
            if t[row.CALL, lane] > 0.0 and not answer(t, lane, runs, wave):
                sum_up(t, lane, runs)
                run = next_run(t, lane, runs, run, form, wave)
                busy -= t[row.RUN, lane] < 0.0


@numba.njit(error_model="numpy")
def carry_one(runs, form, wave, log):
    """One run, in the first lane, written down; (status, last mode, end, events, samples)."""
    t, scratch = np.zeros((row.ALL_ROWS, LANES)), empty_scratch()
    first = np.int64(0)
    for lane in range(1, LANES):
        be_idle(t, lane)
    rests, s = runs.starts[0, 0] == REST, runs.starts[0, 1]
    goes_on = begin(t, first, runs, first, form, wave, np.bool_(True))
    if rests:
        write_wait(t, log, s, goes_on)
    while goes_on:
        carry(t, runs.values, form, wave, scratch, runs.max_events, np.int64(1), True)
        write_step(t, log)
        if t[row.CALL, 0] > 0.0:
            rests, s = t[row.CALL, 0] == row.RESTS, t[row.S, 0]
            goes_on = answer(t, first, runs, wave)
            if rests:
                write_wait(t, log, s, t[row.MODE, 0] == ROTATION)
    write_end(t, log)
    sum_up(t, first, runs)
    return t[row.STATUS, 0], t[row.MODE, 0], t[row.T_END, 0], t[row.WRITTEN, 0], t[row.SAVED, 0]


@numba.njit(error_model="numpy")
def carry_either(runs, form, wave, save_at, room):
    """One run written down, with room for so many events, or all of them where there is no room; (sums, log)."""
    log = new_log(save_at, room)
    if room > 0:
        return carry_one(runs, form, wave, log), log
    carry_all(runs, form, wave)
    return (0.0, 0.0, 0.0, 0.0, 0.0), log


def linear_record(pars, starts, motions, values, peaks, max_events, rows, save_at, room):
    """Linear blocks over records."""
    return carry_either(row.Runs(pars, starts, motions, values, peaks, max_events, rows), None, None, save_at, room)


def nonlinear_record(pars, starts, motions, values, peaks, max_events, rows, save_at, room):
    """Nonlinear blocks over records."""
    return carry_either(row.Runs(pars, starts, motions, values, peaks, max_events, rows), 1, None, save_at, room)


def linear_wave(pars, starts, motions, max_events, rows, save_at, room):
    """Linear blocks over ramped sinusoids."""
    return carry_either(row.Runs(pars, starts, motions, None, None, max_events, rows), None, 1, save_at, room)


def nonlinear_wave(pars, starts, motions, max_events, rows, save_at, room):
    """Nonlinear blocks over ramped sinusoids."""
    return carry_either(row.Runs(pars, starts, motions, None, None, max_events, rows), 1, 1, save_at, room)


@cache
def entry(name: str) -> Any:
    """One of the entries, compiled."""
    bodies = {body.__name__: body for body in (linear_record, nonlinear_record, linear_wave, nonlinear_wave)}
    i8, line, table = types.int64, types.float64[::1], types.float64[:, ::1]
    shared = (line, line) if "record" in name else ()
    return compiled(bodies[name], (table, table, table, *shared, i8, table, line, i8), f"taylor_{name}")
