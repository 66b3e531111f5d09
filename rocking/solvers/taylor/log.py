"""One run of the Taylor solver written down: samples of the flights and every event.

Source   the events are those of `rocking.method1`, in the layout of `rocking.trajectory.Events`.
"""

from __future__ import annotations

import math

from rocking.hybrid import REST, ROTATION
from rocking.method1 import FALL, IMPACT, TIP
from rocking.solvers.numba.compiling import borrowing
from rocking.solvers.piecewise.polynomial import derivative, value
from rocking.solvers.recording import REACHED_END
from rocking.solvers.taylor import table as row
from rocking.trajectory import BALANCE


@borrowing
def write_event(t, log, at, guard, modes, s, before, after):
    """One event at the time `at`, if there is room; before and after are (theta, omega)."""
    i = int(t[row.WRITTEN, 0])
    t[row.WRITTEN, 0] += 1.0
    if i < log.event_t.size:
        log.event_t[i], log.event_s[i] = at, s
        log.event_code[i, 0], log.event_code[i, 1], log.event_code[i, 2] = guard, modes[0], modes[1]
        log.event_y[i, 0, 0], log.event_y[i, 0, 1] = before
        log.event_y[i, 1, 0], log.event_y[i, 1, 1] = after


@borrowing
def write_samples(t, log, c, s, start, reach, mode):
    """Samples from the time `start` to start + reach of the flight c about the corner s."""
    i = int(t[row.SAVED, 0])
    while i < log.save_at.size and log.save_at[i] <= start + reach:
        tau = log.save_at[i] - start
        log.y[i, 0], log.y[i, 1] = s * value(c, tau), s * value(derivative(c), tau)
        log.mode[i], log.s[i] = mode, s
        i += 1
    t[row.SAVED, 0] = i


@borrowing
def write_wait(t, log, s, tips):
    """The block stood, the corner s last to carry, until it tipped or the run ended."""
    until = t[row.LAST, 0] if tips else t[row.T_END, 0]
    write_samples(t, log, (0.0,) * 10, s, until, 0.0, REST)
    if tips:
        write_event(t, log, until, TIP, (REST, ROTATION), t[row.S, 0], (0.0, 0.0), (0.0, 0.0))


@borrowing
def flight_of(t):
    """The flight of the step just made."""
    i = row.C_FIRST
    return (
        t[i, 0], t[i + 1, 0], t[i + 2, 0], t[i + 3, 0], t[i + 4, 0],
        t[i + 5, 0], t[i + 6, 0], t[i + 7, 0], t[i + 8, 0], t[i + 9, 0],
    )  # fmt: skip


@borrowing
def write_step(t, log):
    """The step just made, before what it led to is dealt with."""
    c, s, call = flight_of(t), t[row.S_OLD, 0], int(t[row.CALL, 0])
    start = t[row.ORIGIN, 0] + (t[row.K_OLD, 0] * t[row.DT, 0] + t[row.TAU_OLD, 0])
    write_samples(t, log, c, s, start, t[row.REACH_OLD, 0], ROTATION)
    if t[row.PASSED, 0] >= 0.0:
        at = t[row.PASSED, 0]
        there = (s * value(c, at), s * value(derivative(c), at))
        write_event(t, log, start + at, BALANCE, (ROTATION, ROTATION), s, there, there)
    if call == row.FALLS:
        there = (s * 0.5 * math.pi, s * t[row.V_FELL, 0])
        write_event(t, log, t[row.FELL_AT, 0], FALL, (ROTATION, ROTATION), s, there, there)
    elif t[row.HIT_OLD, 0] > 0.0:
        rests = call == row.RESTS
        after = (0.0, 0.0 if rests else t[row.S, 0] * t[row.V, 0])
        modes = (ROTATION, REST if rests else ROTATION)
        write_event(t, log, t[row.LAST, 0], IMPACT, modes, t[row.S, 0], (0.0, s * t[row.V_OLD, 0]), after)


@borrowing
def write_end(t, log):
    """Samples at the very end, which rounding may leave behind the last step."""
    if t[row.STATUS, 0] == REACHED_END:
        s = t[row.S, 0]
        for i in range(int(t[row.SAVED, 0]), log.save_at.size):
            log.y[i, 0], log.y[i, 1] = s * t[row.X, 0], s * t[row.V, 0]
            log.mode[i], log.s[i] = int(t[row.MODE, 0]), s
        t[row.SAVED, 0] = log.save_at.size
