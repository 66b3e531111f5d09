"""What a single lane needs between two flights: the next stretch, the end of a wait or of a chatter, the next run.

A run passes through stretches of its motion: a quiet one before, the record or the wave itself, the last incomplete
interval of a record, and a quiet one after.

A block that chatters, with impacts in an ever quicker series, comes to rest after 2 v / (A (1 - e)) or so, where A is
what pulls it back, and all that is left of the series then is its number.  A batch counts it instead of following it:
an impact multiplies the speed by e (1 + A' t / (3 A)) if A changes at the rate A' over a flight of the time t, and the
number follows from the sum over the series.  Where the terms left out might change the number, or something else than
rest might come of it, the impacts are followed one by one.

Source   own derivation.
"""

from __future__ import annotations

import math

import numpy as np

from rocking.hybrid import REST, ROTATION
from rocking.solvers.numba.compiling import borrowing
from rocking.solvers.recording import FELL, MAX_STALLED, REACHED_END, STALL_TIME, STALLED, TOO_MANY_EVENTS
from rocking.solvers.taylor import table as row
from rocking.solvers.taylor.columns import (
    COUNT,
    ENDED,
    FINISHED,
    FIRST,
    LARGEST,
    LAST_MODE,
    OVERTURNED,
    OVERTURNING,
    SIDE,
)  # fmt: skip
from rocking.solvers.taylor.flight import LONGEST, LONGEST_TURN
from rocking.solvers.taylor.records import LARGEST_SAMPLE
from rocking.solvers.taylor.waits import next_push, wave_exceeds

BEFORE, WITHIN, LAST_PART, AFTER = range(4)
"""Stretches of a motion."""


@borrowing
def moment(t, lane):
    """Time [s] of a lane."""
    return t[row.ORIGIN, lane] + (t[row.K, lane] * t[row.DT, lane] + t[row.TAU, lane])


@borrowing
def bound_step(t, lane, longest, a_max):
    """Set how far x may bulge between the ends of a step: |x''| <= p^2 (1.6 + |a_x|/g) up to the fall."""
    step = min(longest, t[row.LIMIT, lane])
    t[row.BULGE, lane] = 0.125 * t[row.P2, lane] * (1.6 + a_max) * step * step * (1.0 + 1e-6) + 1e-15


@borrowing
def be_quiet(t, lane, start, stop):
    """A stretch without acceleration."""
    t[row.ORIGIN, lane], t[row.K, lane], t[row.TAU, lane], t[row.STOP, lane] = start, 0.0, 0.0, stop - start
    t[row.B0, lane], t[row.B1, lane], t[row.SCALE, lane], t[row.RATE, lane] = 0.0, 0.0, 0.0, 0.0
    t[row.K_EDGE, lane] = 1.0
    bound_step(t, lane, math.inf, 0.0)


@borrowing
def be_in_interval(t, lane, values, k, tau, stop):
    """Interval k of the record from tau to stop."""
    t[row.K, lane], t[row.TAU, lane], t[row.STOP, lane] = k, tau, stop
    at = int(t[row.FIRST, lane]) + k
    t[row.B0, lane], t[row.B1, lane] = t[row.SCALE, lane] * values[at], t[row.SCALE, lane] * values[at + 1]


@borrowing
def enter_record(t, lane, runs):
    """The record, at its begin or where the run starts in it."""
    n, dt, t_first = int(t[row.SAMPLES, lane]), t[row.DT, lane], t[row.BEGIN, lane]
    begin = max(t[row.T_START, lane], t_first)
    k = min(int((begin - t_first) / dt), n - 2)
    whole = whole_intervals(t, lane)
    t_k = t_first + k * dt
    t[row.ORIGIN, lane], t[row.SCALE, lane] = t_first, t[row.SCALE_ON, lane]
    be_in_interval(t, lane, runs.values, k, max(begin - t_k, 0.0), dt if k < whole else t[row.T_END, lane] - t_k)
    t[row.K_EDGE, lane] = max(whole, k + 1)
    bound_step(t, lane, dt, abs(t[row.SCALE, lane]) * runs.motions[int(t[row.RUN, lane]), LARGEST_SAMPLE])


@borrowing
def enter_wave(t, lane, runs):
    """The ramped sinusoid, at its begin or where the run starts in it."""
    omega, phase, _, duration = runs.motions[int(t[row.RUN, lane])]
    begin, stop = max(t[row.T_START, lane], 0.0), min(t[row.T_END, lane], duration)
    t[row.ORIGIN, lane], t[row.K, lane], t[row.K_EDGE, lane] = 0.0, 0.0, 1.0
    t[row.TAU, lane], t[row.STOP, lane] = begin, stop
    t[row.RATE, lane] = t[row.SCALE_ON, lane]
    t[row.SINE, lane], t[row.COSINE, lane] = math.sin(omega * begin + phase), math.cos(omega * begin + phase)
    bound_step(t, lane, t[row.LIMIT, lane], abs(t[row.RATE, lane]) * stop)


@borrowing
def whole_intervals(t, lane):
    """Intervals of the record that end before the run does."""
    return min(int(max(t[row.T_END, lane] - t[row.BEGIN, lane], 0.0) / t[row.DT, lane]), int(t[row.SAMPLES, lane]) - 1)


@borrowing
def enter_last_part(t, lane, runs):
    """The interval of the record in which the run ends, after all whole ones; False if there is none."""
    whole = whole_intervals(t, lane)
    left = t[row.T_END, lane] - (t[row.BEGIN, lane] + whole * t[row.DT, lane])
    if t[row.K, lane] != whole or whole >= t[row.SAMPLES, lane] - 1.0 or left <= 0.0:
        return False
    be_in_interval(t, lane, runs.values, whole, 0.0, left)
    t[row.K_EDGE, lane] = whole + 1
    return True


@borrowing
def enter(t, lane, runs, wave, stretch):
    """Put the lane at the begin of the first stretch from `stretch` on that has any length; False if there is none."""
    t_start, t_end = t[row.T_START, lane], t[row.T_END, lane]
    if wave is not None:
        first, last = 0.0, runs.motions[int(t[row.RUN, lane]), 3]
    else:
        first = t[row.BEGIN, lane]
        last = first + (t[row.SAMPLES, lane] - 1.0) * t[row.DT, lane]
    if stretch <= BEFORE and t_start < first:
        be_quiet(t, lane, t_start, min(first, t_end))
        t[row.PHASE, lane] = BEFORE
        return True
    if stretch <= WITHIN and t_start < last and t_end > first:
        if wave is not None:
            enter_wave(t, lane, runs)
        else:
            enter_record(t, lane, runs)
        t[row.PHASE, lane] = WITHIN
        return True
    if wave is None and stretch == LAST_PART and enter_last_part(t, lane, runs):
        t[row.PHASE, lane] = LAST_PART
        return True
    if stretch <= AFTER and t_end > last:
        be_quiet(t, lane, max(t_start, last), t_end)
        t[row.PHASE, lane] = AFTER
        return True
    return False


@borrowing
def exceeds_on_record(t, lane, runs):
    """Whether |a_x| exceeds what the block stands, from now to the end of the stretch; the lane is put there."""
    onset, tau, k = t[row.ONSET, lane], t[row.TAU, lane], int(t[row.K, lane])
    first = int(t[row.FIRST, lane])
    threshold = onset / max(abs(t[row.SCALE, lane]), 1e-300) * (1.0 - 1e-12)
    while True:
        b0, b1, stop = t[row.B0, lane], t[row.B1, lane], t[row.STOP, lane]
        rise = (b1 - b0) * t[row.PER_DT, lane]
        b, b_stop = b0 + rise * tau, b0 + rise * stop
        if abs(b) > onset or abs(b_stop) > onset:
            sign = math.copysign(1.0, b if abs(b) > onset else b_stop)
            if abs(b) <= onset:
                tau = min(tau + (sign * onset - b) / rise, stop)
            t[row.TAU, lane], t[row.S, lane] = tau, -sign
            return True
        k += 1
        edge = int(t[row.K_EDGE, lane])
        if k < edge:
            k = max(next_push(runs.values, runs.peaks, first + k, first + edge + 1, threshold) - first - 1, k)
        if k >= edge:
            t[row.K, lane] = edge
            return False
        tau = 0.0
        be_in_interval(t, lane, runs.values, k, tau, t[row.DT, lane])


@borrowing
def exceeds_on_wave(t, lane, runs):
    """Whether |a_x| exceeds what the block stands, from now to the end of the stretch; the lane is put there."""
    omega, phase = t[row.OMEGA, lane], runs.motions[int(t[row.RUN, lane]), 1]
    rate = t[row.RATE, lane]
    tau = wave_exceeds(omega, phase, abs(rate), t[row.ONSET, lane], t[row.TAU, lane], t[row.STOP, lane])
    if tau > t[row.STOP, lane]:
        return False
    sine = math.sin(omega * tau + phase)
    t[row.TAU, lane], t[row.S, lane] = tau, -math.copysign(1.0, rate * sine)
    t[row.SINE, lane], t[row.COSINE, lane] = sine, math.cos(omega * tau + phase)
    return True


@borrowing
def exceeds(t, lane, runs, wave):
    """Whether |a_x| exceeds what the block stands, from now to the end of the stretch; the lane is put there."""
    if wave is not None:
        return exceeds_on_wave(t, lane, runs)
    return exceeds_on_record(t, lane, runs)


@borrowing
def count_event(t, lane, now):
    """One more event at this time; its status if it is one too many."""
    t[row.STALLS, lane] = t[row.STALLS, lane] + 1.0 if now - t[row.LAST, lane] < STALL_TIME else 0.0
    t[row.LAST, lane] = now
    t[row.EVENTS, lane] += 1.0


@borrowing
def wait(t, lane, runs, wave):
    """Let the block stand until the base tips it; False if it stands to the end."""
    t[row.MODE, lane], t[row.X, lane], t[row.V, lane] = REST, 0.0, 0.0
    while True:
        phase = int(t[row.PHASE, lane])
        if phase in (WITHIN, LAST_PART) and exceeds(t, lane, runs, wave):
            t[row.MODE, lane], t[row.FLOOR, lane] = ROTATION, 0.0
            now = moment(t, lane)
            count_event(t, lane, now)
            if math.isnan(t[row.ONSET_TIME, lane]):
                t[row.ONSET_TIME, lane] = now
            return True
        if not enter(t, lane, runs, wave, phase + 1):
            return False


@borrowing
def chatter(t, lane, runs, wave):
    """Number of impacts, up to and with the last one, in which the chatter of a block just struck ends; 0 if unsure.

    The caller has seen to it that the series ends well within the interval, and that the base lets the block stand.
    """
    tau, omega = t[row.TAU, lane], t[row.OMEGA, lane]
    if wave is None:
        rise = (t[row.B1, lane] - t[row.B0, lane]) * t[row.PER_DT, lane]
        b, curve = t[row.B0, lane] + rise * tau, 0.0
    else:
        rate = t[row.RATE, lane]
        b = rate * tau * t[row.SINE, lane]
        rise = rate * (t[row.SINE, lane] + omega * tau * t[row.COSINE, lane])
        curve = abs(rate) * (omega * omega * tau + 2.0 * abs(omega))
    v, e, p2 = t[row.V, lane], t[row.E, lane], t[row.P2, lane]
    swing = t[row.S, lane] * t[row.HOLD_C, lane]
    A_1, A_2 = p2 * (t[row.HOLD_S, lane] + swing * b), p2 * (t[row.HOLD_S, lane] - swing * b)
    t_1, t_2 = 2.0 * v / A_1, 2.0 * v * e / A_2
    change = p2 * swing * rise
    both = 1.0 / (1.0 - e * e)
    total, least = (t_1 + t_2) * both, min(A_1, A_2)
    shift = change / 3.0 * (t_1 / A_1 - t_2 / A_2) * both
    drift = abs(change) * total / least
    bent = p2 * curve * total * total / least
    last = t[row.OMEGA_REST, lane]
    # Left out: the square of the drift, the curve of the base, what of the sum lies beyond the last impact.
    unsure = 2.0 * drift * drift + bent + p2 * drift * total * total + drift * last / v + 1e-9
    lost = -math.log(e)
    number, margin = (math.log(v / last) + shift) / lost, unsure / lost
    # A flight that rises to a new largest tilt, v^2/(2 A) high, must be followed.
    rises = 0.75 * v * v / least > t[row.PEAK, lane]
    if rises or bent > 0.1 or number < margin or math.floor(number - margin) != math.floor(number + margin):
        return 0
    count = math.floor(number) + 1
    stalls = 2.0 * last * e / (4.0 * p2) < STALL_TIME
    return 0 if stalls or t[row.EVENTS, lane] + count > runs.max_events else count


@borrowing
def begin(t, lane, runs, run, form, wave, logging):
    """Put a run into a lane; False if it is over already."""
    p2, alpha, g, onset, e, omega_rest = runs.pars[run]
    mode, s, x, v, t_start, t_end = runs.starts[run]
    p = math.sqrt(p2)
    for i in range(row.ROWS):
        t[i, lane] = 0.0
    t[row.X, lane], t[row.V, lane], t[row.S, lane] = x, v, s
    t[row.P, lane], t[row.P2, lane], t[row.ALPHA, lane] = p, p2, alpha
    t[row.E, lane], t[row.OMEGA_REST, lane], t[row.ONSET, lane] = e, omega_rest, onset
    t[row.TURN_S, lane], t[row.TURN_C, lane] = math.sin(alpha - 0.25 * math.pi), math.cos(alpha - 0.25 * math.pi)
    t[row.HOLD_S, lane] = alpha if form is None else math.sin(alpha)
    t[row.HOLD_C, lane] = 1.0 if form is None else math.cos(alpha)
    t[row.ZENO, lane] = math.inf if logging else 2.0 / (p2 * (1.0 - e))
    t[row.RUN, lane], t[row.T_START, lane], t[row.T_END, lane] = run, t_start, t_end
    t[row.PEAK, lane], t[row.WATCH, lane] = abs(x), min(abs(x), alpha)
    t[row.PASSAGE, lane], t[row.ONSET_TIME, lane] = t_start, math.nan
    t[row.LAST, lane], t[row.FLOOR, lane], t[row.STATUS, lane] = -math.inf, -math.inf, REACHED_END
    t[row.DT, lane], t[row.PER_DT, lane], t[row.LIMIT, lane] = 1.0, 1.0, LONGEST / p
    if wave is not None:
        turns = runs.motions[run, 0]
        t[row.OMEGA, lane], t[row.SCALE_ON, lane] = turns, runs.motions[run, 2] / g
        t[row.LIMIT, lane] = min(LONGEST / p, LONGEST_TURN / max(abs(turns), 1e-300))
    else:
        scale, t[row.DT, lane], t[row.BEGIN, lane], t[row.FIRST, lane], t[row.SAMPLES, lane], _ = runs.motions[run]
        t[row.SCALE_ON, lane] = scale / g
        t[row.PER_DT, lane] = 1.0 / t[row.DT, lane]
    enter(t, lane, runs, wave, np.int64(BEFORE))
    t[row.MODE, lane] = mode
    return mode != REST or wait(t, lane, runs, wave)


@borrowing
def be_idle(t, lane):
    """Put nothing into a lane: a flight without forces that never asks for anything."""
    for i in range(row.ROWS):
        t[i, lane] = 0.0
    t[row.X, lane], t[row.S, lane], t[row.P, lane], t[row.DT, lane], t[row.PER_DT, lane] = 1.0, 1.0, 1.0, 1.0, 1.0
    t[row.STOP, lane], t[row.K_EDGE, lane], t[row.WATCH, lane] = math.inf, math.inf, math.inf
    t[row.BULGE, lane], t[row.LIMIT, lane], t[row.RUN, lane] = -1.0, 1.0, -1.0


@borrowing
def answer(t, lane, runs, wave):
    """Give a lane what it asks for; False if its run is over, with STATUS and T_END set."""
    call = int(t[row.CALL, lane])
    goes_on = True
    if call == row.EDGE:
        goes_on = enter(t, lane, runs, wave, int(t[row.PHASE, lane]) + 1)
    elif call == row.RESTS:
        goes_on = wait(t, lane, runs, wave)
    elif call == row.CHATTERS:
        count = chatter(t, lane, runs, wave)
        if count > 0:
            t[row.IMPACTS, lane] += count
            t[row.EVENTS, lane] += count
            goes_on = wait(t, lane, runs, wave)
    elif call == row.FALLS:
        t[row.STATUS, lane], t[row.T_END, lane] = FELL, t[row.FELL_AT, lane]
        return False
    if call == row.ENOUGH or t[row.EVENTS, lane] > runs.max_events or t[row.STALLS, lane] > MAX_STALLED:
        stalled = t[row.STALLS, lane] > MAX_STALLED
        t[row.STATUS, lane], t[row.T_END, lane] = STALLED if stalled else TOO_MANY_EVENTS, t[row.LAST, lane]
        return False
    return goes_on


@borrowing
def sum_up(t, lane, runs):
    """Write down what became of the run in a lane."""
    out = runs.rows[int(t[row.RUN, lane])]
    status = t[row.STATUS, lane]
    fell = status == FELL
    out[OVERTURNED] = 1.0 if fell else 0.0
    out[SIDE] = t[row.S, lane] if fell else 0.0
    out[OVERTURNING] = t[row.PASSAGE, lane] if fell else np.nan
    out[LARGEST], out[COUNT], out[ENDED] = t[row.PEAK, lane], t[row.IMPACTS, lane], t[row.T_END, lane]
    out[FINISHED] = 1.0 if fell or status == REACHED_END else 0.0
    out[FIRST], out[LAST_MODE] = t[row.ONSET_TIME, lane], t[row.MODE, lane]
