"""The compiled entries of the exact solver: one run written down, and many runs summed up.

Each is compiled once for arrays of plain numbers and kept on disk (`rocking.solvers.numba_compile`).
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numba
import numpy as np
from numba import types

from rocking.hybrid import REST, ROTATION
from rocking.solvers.exact_kernel import Record, Sine, prepared, run_record, run_sine
from rocking.solvers.exact_step import END, EVENTS, IMPACTS, PASSAGE, PEAK, SAVED, STATUS, Body, Log
from rocking.solvers.numba_compile import compiled
from rocking.solvers.recording import FELL, REACHED_END

OVERTURNED, SIDE, PASSED, LARGEST, COUNT, FINISHED, ENDED = range(7)
"""Columns of what a batch gives for each run."""


@numba.njit(error_model="numpy")
def new_log(save_at, room):
    """An empty log with room for so many events."""
    n = save_at.size
    return Log(
        save_at, np.empty((n, 2)), np.empty(n, np.int64), np.empty(n),
        np.empty(room), np.empty((room, 3), np.int64), np.empty(room), np.empty((room, 2, 2)),
    )  # fmt: skip


@numba.njit(error_model="numpy")
def finish(tally, log, body):
    """Samples at the very end, which rounding may leave behind the last interval."""
    if tally[STATUS] == REACHED_END:
        for i in range(int(tally[SAVED]), log.save_at.size):
            log.y[i, 0], log.y[i, 1] = body.s * body.x, body.s * body.v
            log.mode[i], log.s[i] = body.mode, body.s
        tally[SAVED] = log.save_at.size


def single_record(par, head, values, start, save_at, max_events, room):
    """One run over a record, written down: (tally, last mode, log).

    head = (t_first, dt), start = (mode, s, x, v, t_start, t_end).
    """
    bends, peaks = prepared(values)
    record = Record(values, bends, peaks, head[0], head[1], 1.0 / head[1], 1.0)
    log = new_log(save_at, room)
    body = Body(int(start[0]), start[1], start[2], start[3])
    tally, body = run_record(par, record, body, start[4], start[5], max_events, log)
    finish(tally, log, body)
    return tally, body.mode, log


def single_sine(par, wave, start, save_at, max_events, room):
    """One run over a ramped sinusoid, written down."""
    log = new_log(save_at, room)
    body = Body(int(start[0]), start[1], start[2], start[3])
    sine = Sine(wave[0], wave[1], wave[2], wave[3])
    tally, body = run_sine(par, sine, body, start[4], start[5], max_events, log)
    finish(tally, log, body)
    return tally, body.mode, log


@numba.njit(error_model="numpy")
def begin(start):
    """The block at the start of a run; start = (theta, omega, ...)."""
    leans = start[0] if start[0] != 0.0 else start[1]
    s = -1.0 if leans < 0.0 else 1.0
    return Body(REST if leans == 0.0 else ROTATION, s, s * start[0], s * start[1])


@numba.njit(error_model="numpy")
def sum_up(tally, body, row):
    """What a batch keeps of a run."""
    fell = tally[STATUS] == FELL
    row[OVERTURNED] = 1.0 if fell else 0.0
    row[SIDE] = body.s if fell else 0.0
    row[PASSED] = tally[PASSAGE] if fell else np.nan
    row[LARGEST], row[COUNT], row[ENDED] = tally[PEAK], tally[IMPACTS], tally[END]
    row[FINISHED] = 1.0 if fell or tally[STATUS] == REACHED_END else 0.0


def batch_record(pars, starts, stretches, head, values, max_events, rows):
    """Runs over one record; stretches = (scale, time scale) of each."""
    bends, peaks = prepared(values)
    for i in range(pars.shape[0]):
        scale, slower = stretches[i, 0], stretches[i, 1]
        dt = head[1] * slower
        record = Record(values, bends, peaks, head[0], dt, 1.0 / dt, scale)
        tally, body = run_record(pars[i], record, begin(starts[i]), starts[i, 2], starts[i, 3], max_events, None)
        sum_up(tally, body, rows[i])


def batch_sine(pars, starts, waves, max_events, rows):
    """Runs over ramped sinusoids; waves = (omega, phase, rate, duration) of each."""
    for i in range(pars.shape[0]):
        sine = Sine(waves[i, 0], waves[i, 1], waves[i, 2], waves[i, 3])
        tally, body = run_sine(pars[i], sine, begin(starts[i]), starts[i, 2], starts[i, 3], max_events, None)
        sum_up(tally, body, rows[i])


@cache
def entry(name: str) -> Any:
    """One of the four entries, compiled."""
    i8, row, table = types.int64, types.float64[::1], types.float64[:, ::1]
    signatures = {
        "single_record": (single_record, (row, row, row, row, row, i8, i8)),
        "single_sine": (single_sine, (row, row, row, row, i8, i8)),
        "batch_record": (batch_record, (table, table, table, row, row, i8, table)),
        "batch_sine": (batch_sine, (table, table, table, i8, table)),
    }
    body, signature = signatures[name]
    return compiled(body, signature, f"exact_{name}")


class Sums(NamedTuple):
    """What the caller of a single run reads of its tally."""

    status: int
    end: float
    events: int
    saved: int
    peak: float


def named(tally: Any) -> Sums:
    """The tally of a single run by names."""
    return Sums(int(tally[STATUS]), float(tally[END]), int(tally[EVENTS]), int(tally[SAVED]), float(tally[PEAK]))
