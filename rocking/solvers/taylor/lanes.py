"""Several blocks side by side, each at its own time: the loop that carries flights, impacts and largest tilts.

A lane is a block on its way through its own run.  In each turn of the loop every lane goes to the end of its sample, or
as far as its Taylor polynomial serves, or to its next impact, whichever comes first; a lane that comes to rest, ends
its stretch of the motion, falls or has too many events is handed to `rocking.solvers.taylor.turns`, which deals with
lanes one by one and puts the next run into a lane that is done.  What a lane holds is a column of a table
(`rocking.solvers.taylor.table`).

Source   Winkler, Meguro & Yamazaki (1995), eqs (1)-(4), in the form of `rocking.method1`.
Status   no operation mixes lanes: a run gives the same bits alone and in any company.
"""

from __future__ import annotations

import math

import numba

from rocking.solvers.numba.compiling import borrowing
from rocking.solvers.recording import MAX_STALLED, STALL_TIME
from rocking.solvers.taylor import table as row
from rocking.solvers.taylor.flight import DEGREE, flight, glide, largest_curvature, push_on_sine, slope, turn, value
from rocking.solvers.taylor.roots import differentiated, first_landing, less, newton
from rocking.solvers.taylor.vector import (
    bits,
    count,
    emitted,
    fma,
    fma_of,
    gather,
    lanes_type,
    least,
    load,
    most,
    size,
    size_of,
    store,
    where,
)

PATIENCE = 4
"""Turns of the loop for which a lane near the floor waits for others before its impact is looked for."""


TAIL = 1e-14
"""Largest size of the last two terms of a nonlinear flight: what is left out is some hundred times less."""

LOW = 0.01
"""A chatter is low while no flight changes what pulls the block back by more than half of this share."""


@emitted(lanes_type)
def tail(c, h):
    """Size of the last two terms of a flight at h."""
    square = h * h
    fourth = square * square
    return fma_of(size_of(c[DEGREE]), h, size_of(c[DEGREE - 1])) * (fourth * fourth)


@numba.njit(error_model="numpy", forceinline=True)
def angle_terms(t, form):
    """(sin, cos) of alpha - pi/4 for the nonlinear block, None for the linear one."""
    if form is None:
        return None
    return load(t, row.TURN_S), load(t, row.TURN_C)


@numba.njit(error_model="numpy", forceinline=True)
def wanted_at_once(x, v, push, p2, alpha, turned, floor, form, wave):
    """The polynomial of a flight, but None for the linear block over a record, whose end is known without."""
    if form is not None:  # one question at a time: numba answers it when it compiles
        return flight(x, v, push, p2, alpha, turned, floor)
    if wave is not None:
        return flight(x, v, push, p2, alpha, turned, floor)
    return None


@numba.njit(error_model="numpy", forceinline=True)
def known(c, x, v, push, p2, alpha, turned, floor):
    """The polynomial of a flight, computed now if it is not yet known."""
    if c is None:
        return flight(x, v, push, p2, alpha, turned, floor)
    return c


@numba.njit(error_model="numpy", forceinline=True)
def end_of_step(c, x, v, push, h, p2, alpha, floor):
    """(x, v) after h, and a bound of the curvature of x until then."""
    if c is None:
        return glide(x, v, push, h, p2, alpha, floor)
    return value(c, h), slope(c, h), largest_curvature(c, h)


@numba.njit(error_model="numpy", forceinline=True)
def may_land(x, x_end, rise):
    """Where a flight may descend through zero; rise: a bound of its curvature times the square of the step.

    It dips below the chord of its ends by an eighth of that at most.  From the floor it rises to x_end if that exceeds
    half of it: then x(t) >= (t/h)(x_end - rise/2).
    """
    bound = rise * (1.0 + 1e-6)
    at_all = least(x, x_end) <= bound * 0.125 + 1e-15
    return at_all & ((x > 0.0) | (x < 0.0) | (x_end <= bound * 0.5))


@borrowing
def look_up(t, c, x, v, tau, k, reach, x_end, v_end):
    """Largest tilts, passages of the balance and falls of a step; true in lanes that fall."""
    top = most(x, x_end)
    peak = most(load(t, row.PEAK), top)
    turns = (v > 0.0) & (v_end < 0.0) & (top + load(t, row.BULGE) > load(t, row.PEAK))
    alpha, start = load(t, row.ALPHA), load(t, row.ORIGIN) + fma(k, load(t, row.DT), tau)
    passes, until = (x < alpha) & (x_end >= alpha), reach
    if bits(turns) != 0:
        at = where(turns, newton(differentiated(c), reach, turns), 0.0)
        crest = value(c, at)
        peak = most(peak, crest)
        beyond = turns & (x < alpha) & (crest >= alpha)  # though it may have come back by the end of the step
        passes, until = passes | beyond, where(beyond, at, reach)
    if bits(passes) != 0:
        at = newton(less(alpha, c), until, passes)
        store(t, row.PASSAGE, where(passes, start + at, load(t, row.PASSAGE)))
        store(t, row.PASSED, where(passes, at, load(t, row.PASSED)))
        store(t, row.EVENTS, where(passes, load(t, row.EVENTS) + 1.0, load(t, row.EVENTS)))
    falls = x_end >= 0.5 * math.pi
    if bits(falls) != 0:
        at = where(falls, newton(less(0.5 * math.pi, c), reach, falls), 0.0)
        store(t, row.FELL_AT, start + at)
        store(t, row.V_FELL, slope(c, at))
        store(t, row.REACH_OLD, where(falls, at, load(t, row.REACH_OLD)))
        peak = least(peak, 0.5 * math.pi)
    store(t, row.PEAK, peak)
    store(t, row.WATCH, least(peak, alpha))
    return falls


@numba.njit(error_model="numpy", forceinline=True)
def strike(t, hit, speed, now, push, push_end, rise, left, max_events):
    """Count impacts; what lanes ask for that come to rest, chatter within the time left, or had too many events."""
    events = where(hit, load(t, row.EVENTS) + 1.0, load(t, row.EVENTS))
    at_once = now - load(t, row.LAST) < STALL_TIME
    stalls = where(hit, where(at_once, load(t, row.STALLS) + 1.0, 0.0), load(t, row.STALLS))
    store(t, row.IMPACTS, where(hit, load(t, row.IMPACTS) + 1.0, load(t, row.IMPACTS)))
    store(t, row.EVENTS, events)
    store(t, row.STALLS, stalls)
    store(t, row.LAST, where(hit, now, load(t, row.LAST)))
    enough = (stalls > float(MAX_STALLED)) | (events > float(max_events))
    rests = (speed < load(t, row.OMEGA_REST)) & (size(push) <= load(t, row.ONSET))
    # What is left of the chatter takes this over `hold` at most; see `turns.chatter`.
    hold = load(t, row.HOLD_S) - load(t, row.HOLD_C) * most(size(push), size(push_end))
    series = load(t, row.ZENO) * speed
    steady = (size(rise) * series < 0.2 * (hold * hold)) & (speed * speed < LOW * load(t, row.P2) * (hold * hold))
    ends = (hold > 0.0) & (series < 0.9 * (hold * left)) & steady
    asks = where(rests, float(row.RESTS), where(ends, float(row.CHATTERS), hold * 0.0))
    return where(hit, where(enough, float(row.ENOUGH), asks), hold * 0.0)


@borrowing
def keep_step(t, c, s, k, tau, reach, v_end, hit):
    """Remember the step for the log."""
    for n in range(DEGREE + 1):
        store(t, row.C_FIRST + n, c[n])
    store(t, row.S_OLD, s)
    store(t, row.K_OLD, k)
    store(t, row.TAU_OLD, tau)
    store(t, row.REACH_OLD, reach)
    store(t, row.V_OLD, v_end)
    store(t, row.HIT_OLD, where(hit, 1.0, reach * 0.0))
    store(t, row.PASSED, reach * 0.0 - 1.0)


@borrowing
def carry(t, values, form, wave, scratch, max_events, quorum, logging):
    """Carry all lanes until one asks for something, or for one step where the run is written down."""
    x, v, s = load(t, row.X), load(t, row.V), load(t, row.S)
    k, tau, stop = load(t, row.K), load(t, row.TAU), load(t, row.STOP)
    b0, b1, floor = load(t, row.B0), load(t, row.B1), load(t, row.FLOOR)
    sine, cosine = load(t, row.SINE), load(t, row.COSINE)
    none = x * 0.0
    p2, alpha, turned = load(t, row.P2), load(t, row.ALPHA), angle_terms(t, form)
    call = none
    waited = 0
    while True:
        if wave is None:
            rise = (b1 - b0) * load(t, row.PER_DT)
            push = (s * fma(rise, tau, b0), s * rise)
        else:
            rate, omega, now = load(t, row.RATE), load(t, row.OMEGA), load(t, row.ORIGIN) + tau
            push = push_on_sine(s * rate, omega, now, sine, cosine)
        rest, limit = stop - tau, load(t, row.LIMIT)
        whole = rest <= limit
        h = where(whole, rest, limit)
        c = wanted_at_once(x, v, push, p2, alpha, turned, floor, form, wave)
        if form is not None:
            long = tail(c, h) > TAIL
            while bits(long) != 0:
                h, whole = where(long, 0.5 * h, h), whole & ~long
                long = tail(c, h) > TAIL
        kept = where(h > 0.0, none - math.inf, floor)
        (x_end, v_end, curvature), reach = end_of_step(c, x, v, push, h, p2, alpha, floor), h
        hit, call = none > 0.0, none
        near = may_land(x, x_end, curvature * (h * h))
        if bits(near) != 0:
            waited += 1
            if waited >= PATIENCE or count(near) >= quorum:
                waited = 0
                path = known(c, x, v, push, p2, alpha, turned, floor)
                landing = first_landing(path, x, h, near, scratch)
                hit = landing <= h
                x_end = most(x_end, 0.0)
                if bits(hit) != 0:
                    reach = where(hit, landing, h)
                    x_end, v_end = where(hit, 0.0, x_end), where(hit, slope(path, reach), v_end)
                    whole = whole & ~hit
            else:
                x_end, v_end, reach = where(near, x, x_end), where(near, v, v_end), where(near, 0.0, h)
                whole, kept = whole & ~near, where(near, floor, kept)
        if logging:
            keep_step(t, known(c, x, v, push, p2, alpha, turned, floor), s, k, tau, reach, v_end, hit)
        if bits(most(x, x_end) + load(t, row.BULGE) > load(t, row.WATCH)) != 0:
            path = known(c, x, v, push, p2, alpha, turned, floor)
            call = where(look_up(t, path, x, v, tau, k, reach, x_end, v_end), float(row.FALLS), call)
        x, v, tau, floor = x_end, v_end, tau + reach, kept
        if wave is not None:
            sine, cosine = turn(sine, cosine, omega * reach)
        if bits(hit) != 0:
            speed = most(-(load(t, row.E) * v), 0.0)
            v, s = where(hit, speed, v), where(hit, -s, s)
            now = load(t, row.ORIGIN) + fma(k, load(t, row.DT), tau)
            if wave is None:
                a, a_end = fma(rise, tau, b0), fma(rise, stop, b0)
            else:
                a = rate * (now * sine)
                a_end, rise = a, rate * fma(omega * now, cosine, sine)
            call = most(call, strike(t, hit, speed, now, a, a_end, rise, stop - tau, max_events))
        tau = where(whole, 0.0, tau)
        k = where(whole, k + 1.0, k)
        call = where(whole & (k >= load(t, row.K_EDGE)), most(call, float(row.EDGE)), call)
        if wave is None:
            stop = where(whole, load(t, row.DT), stop)
            b0 = where(whole, b1, b0)
            b1 = where(whole, load(t, row.SCALE) * gather(values, load(t, row.FIRST) + (k + 1.0)), b1)
        if logging or bits(call > 0.0) != 0:
            break
    store(t, row.CALL, call)
    store(t, row.X, x)
    store(t, row.V, v)
    store(t, row.S, s)
    store(t, row.K, k)
    store(t, row.TAU, tau)
    store(t, row.STOP, stop)
    store(t, row.B0, b0)
    store(t, row.B1, b1)
    store(t, row.FLOOR, floor)
    store(t, row.SINE, sine)
    store(t, row.COSINE, cosine)
