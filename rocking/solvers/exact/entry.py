"""The compiled entries of the exact solver: one run written down, over a record or a sinusoid.

Each is compiled once for arrays of plain numbers and kept on disk (`rocking.solvers.numba.compiling`).
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numba
from numba import types

from rocking.solvers.exact.kernel import Record, Sine, prepared, run_record, run_sine
from rocking.solvers.exact.step import END, EVENTS, PEAK, SAVED, STATUS, Body
from rocking.solvers.numba.compiling import compiled
from rocking.solvers.piecewise.run_log import new_log
from rocking.solvers.recording import REACHED_END


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
    record = Record(values, bends, peaks, head[0], head[1], 1.0 / head[1])
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


@cache
def entry(name: str) -> Any:
    """One of the two entries, compiled."""
    i8, row = types.int64, types.float64[::1]
    signatures = {
        "single_record": (single_record, (row, row, row, row, row, i8, i8)),
        "single_sine": (single_sine, (row, row, row, row, i8, i8)),
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
