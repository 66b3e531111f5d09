"""The motion within a short stretch of time, event by event: the part of the exact solver that knows the block.

With x = s theta, v = s omega the linear equation reads x'' = p^2 (x - alpha - s a_x/g), whichever corner carries; a
step of at most 1/12 in p t (and 1/8 in omega t for a sinusoid) is its Taylor polynomial of degree nine to below
rounding.  The base is a line, a = a + slope tau, or, where `sine` is given, rate t sin(omega t + phase).

Source   Winkler, Meguro & Yamazaki (1995), eqs (1)-(4), in the form of `rocking.method1`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np

from rocking.hybrid import REST, ROTATION
from rocking.method1 import FALL, IMPACT, TIP
from rocking.solvers.piecewise.polynomial import NONE, below, derivative, first_descent, fma, value
from rocking.solvers.recording import FELL, MAX_STALLED, REACHED_END, STALL_TIME, STALLED, TOO_MANY_EVENTS
from rocking.trajectory import BALANCE

SIXTH = 1.0 / 6.0

LONGEST_STEP = 1.0 / 12.0
"""Longest step in p t: x^(10) t^10 / 10! is then below 1e-17 of the tilts at play."""

PEAK, WATCH, PASSAGE, END, LAST_EVENT, STALLS, EVENTS, IMPACTS, STATUS, SAVED = range(10)
TALLY = 10
"""What a run adds up, one float64 each: largest tilt, the lesser of that and alpha, last passage of
balance, end of the run, last event, events without time going on, events, impacts, status, samples kept."""


class Plan(NamedTuple):
    """Constants of one run."""

    p: float
    p2: float
    alpha: float
    per_g: float  # 1 / g [s^2/m]
    e: float
    omega_rest: float
    longest: float  # step of a Taylor polynomial [s]
    a_rest: float  # |a_x| up to which the block stands [m/s^2]
    clear: float  # with a tilt above this at both ends of an interval, no impact lies within
    bulge: float  # a maximum exceeds the tilts at both ends of an interval by no more than this times its square
    dt: float  # interval [s]
    per_p: float
    grow: float  # exp(p dt) of an interval
    decay: float  # exp(-p dt)
    max_events: int


class Body(NamedTuple):
    """State of the block."""

    mode: int
    s: float
    x: float  # s theta
    v: float  # s omega


@numba.njit(error_model="numpy", forceinline=True)
def flight_on_line(plan, body, a, slope):
    """Taylor coefficients of x over a base whose acceleration is a + slope tau."""
    p2, f = plan.p2, body.s * plan.per_g
    c2 = 0.5 * p2 * (body.x - fma(f, a, plan.alpha))
    c3 = (p2 * SIXTH) * (body.v - f * slope)
    p4 = p2 * p2
    p6 = p4 * p2
    return (
        body.x, body.v, c2, c3, c2 * (p2 * (1 / 12)), c3 * (p2 * 0.05), c2 * (p4 * (1 / 360)), c3 * (p4 * (1 / 840)),
        c2 * (p6 * (1 / 20160)), c3 * (p6 * (1 / 60480)),
    )  # fmt: skip


@numba.njit(error_model="numpy", forceinline=True)
def sine_at(sine, t):
    """Taylor coefficients at t of rate t sin(omega t + phase)."""
    w = sine.omega
    e0 = sine.rate * math.sin(w * t + sine.phase)
    e1 = w * sine.rate * math.cos(w * t + sine.phase)
    w2 = w * w
    w4 = w2 * w2
    w6, w8 = w4 * w2, w4 * w4
    e2, e4, e6, e8 = e0 * (w2 * -0.5), e0 * (w4 * (1 / 24)), e0 * (w6 * (-1 / 720)), e0 * (w8 * (1 / 40320))
    e3, e5, e7, e9 = e1 * (w2 * -SIXTH), e1 * (w4 * (1 / 120)), e1 * (w6 * (-1 / 5040)), e1 * (w8 * (1 / 362880))
    return (
        t * e0, fma(t, e1, e0), fma(t, e2, e1), fma(t, e3, e2), fma(t, e4, e3),
        fma(t, e5, e4), fma(t, e6, e5), fma(t, e7, e6), fma(t, e8, e7), fma(t, e9, e8),
    )  # fmt: skip


@numba.njit(error_model="numpy", forceinline=True)
def flight_on_sine(plan, body, a):
    """Taylor coefficients of x over a base whose acceleration has the Taylor coefficients a."""
    p2, f = plan.p2, body.s * plan.per_g
    c2 = 0.5 * p2 * (body.x - fma(f, a[0], plan.alpha))
    c3 = (p2 * SIXTH) * (body.v - f * a[1])
    c4, c5 = (p2 * (1 / 12)) * (c2 - f * a[2]), (p2 * 0.05) * (c3 - f * a[3])
    c6, c7 = (p2 * (1 / 30)) * (c4 - f * a[4]), (p2 * (1 / 42)) * (c5 - f * a[5])
    c8, c9 = (p2 * (1 / 56)) * (c6 - f * a[6]), (p2 * (1 / 72)) * (c7 - f * a[7])
    return body.x, body.v, c2, c3, c4, c5, c6, c7, c8, c9


@numba.njit(error_model="numpy", forceinline=True)
def flight(plan, body, t0, tau, line, sine):
    """Taylor coefficients of x from the time t0 + tau on."""
    if sine is None:
        return flight_on_line(plan, body, line[0] + line[1] * tau, line[1])
    return flight_on_sine(plan, body, sine_at(sine, t0 + tau))


@numba.njit(error_model="numpy")
def acceleration(t0, tau, line, sine):
    """a_x [m/s^2] at t0 + tau."""
    if sine is None:
        return line[0] + line[1] * tau
    t = t0 + tau
    return sine.rate * t * math.sin(sine.omega * t + sine.phase)


@numba.njit(error_model="numpy")
def tip(plan, t0, tau, stop, line, sine):
    """(tau at which |a_x| exceeds what the block stands, or NONE; sign of a_x there), from tau to stop."""
    if sine is None:
        a, a_stop = line[0] + line[1] * tau, line[0] + line[1] * stop
        if abs(a) > plan.a_rest:
            return tau, math.copysign(1.0, a)
        if abs(a_stop) <= plan.a_rest:
            return NONE, 1.0
        sign = math.copysign(1.0, a_stop)
        return min(tau + (sign * plan.a_rest - a) / line[1], stop), sign
    a_t = sine_at(sine, t0 + tau)
    forward = first_descent(below(plan.a_rest, a_t), stop - tau)
    backward = first_descent(below(plan.a_rest, below(0.0, a_t)), stop - tau)
    return (tau + forward, 1.0) if forward < backward else (tau + backward, -1.0)


@numba.njit(error_model="numpy", forceinline=True)
def note(tally, log, t, guard, before, after, max_events):
    """Count an event, write it down if there is room, and end the run if it is one too many."""
    i = int(tally[EVENTS])
    tally[EVENTS] += 1.0
    if i < log.event_t.size:
        log.event_t[i] = t
        log.event_code[i, 0], log.event_code[i, 1], log.event_code[i, 2] = guard, before.mode, after.mode
        log.event_s[i] = after.s
        log.event_y[i, 0, 0], log.event_y[i, 0, 1] = before.s * before.x, before.s * before.v
        log.event_y[i, 1, 0], log.event_y[i, 1, 1] = after.s * after.x, after.s * after.v
    if guard == BALANCE:
        return
    tally[STALLS] = tally[STALLS] + 1.0 if t - tally[LAST_EVENT] < STALL_TIME else 0.0
    tally[LAST_EVENT] = t
    if guard == FALL:
        tally[STATUS], tally[END] = FELL, t
    elif tally[STALLS] > MAX_STALLED:
        tally[STATUS], tally[END] = STALLED, t
    elif tally[EVENTS] > max_events:
        tally[STATUS], tally[END] = TOO_MANY_EVENTS, t


@numba.njit(error_model="numpy")
def keep(tally, log, body, c, t, reach):
    """Samples from t to t + reach of the flight c."""
    i = int(tally[SAVED])
    while i < log.save_at.size and log.save_at[i] <= t + reach:
        tau = log.save_at[i] - t
        log.y[i, 0] = body.s * value(c, tau)
        log.y[i, 1] = body.s * value(derivative(c), tau)
        log.mode[i], log.s[i] = body.mode, body.s
        i += 1
    tally[SAVED] = i


@numba.njit(error_model="numpy")
def standing(body):
    """The flight of a block that stands."""
    return body.x, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


@numba.njit(error_model="numpy")
def look_up(plan, body, c, t, reach, x_end, v_end, tally, log):
    """Passage of the balance, fall and largest tilt within a step; the length of the step up to a fall."""
    if body.x < plan.alpha:
        tau = first_descent(below(plan.alpha, c), reach)
        if tau <= reach:
            tally[PASSAGE] = t + tau
            there = Body(body.mode, body.s, value(c, tau), value(derivative(c), tau))
            note(tally, log, t + tau, BALANCE, there, there, plan.max_events)
    tau = first_descent(below(0.5 * math.pi, c), reach)
    if tau <= reach:
        tally[PEAK] = 0.5 * math.pi
        return tau
    top = max(body.x, x_end)
    if body.v > 0.0 and v_end < 0.0:
        turn = first_descent(derivative(c), reach)
        top = max(top, value(c, min(turn, reach)))
    tally[PEAK] = max(tally[PEAK], top)
    tally[WATCH] = min(tally[PEAK], plan.alpha)
    return NONE


@numba.njit(error_model="numpy", forceinline=True)
def after_impact(plan, body, v, t0, tau, line, sine):
    """The block after an impact at the speed v < 0: on the other corner, or at rest."""
    speed = max(-plan.e * v, 0.0)
    if speed < plan.omega_rest and abs(acceleration(t0, tau, line, sine)) <= plan.a_rest:
        return Body(REST, -body.s, 0.0, 0.0)
    return Body(ROTATION, -body.s, 0.0, speed)


@numba.njit(error_model="numpy")
def carry(plan, body, t0, start, stop, line, sine, tally, log):
    """The block at t0 + stop from t0 + start on, where the base is smooth; every event on the way is located."""
    tau, just_tipped = start, False
    while tau < stop and tally[STATUS] == REACHED_END:
        if body.mode == REST:
            at, sign = tip(plan, t0, tau, stop, line, sine)
            keep(tally, log, body, standing(body), t0, min(at, stop))
            if at > stop:
                return body
            before, body = body, Body(ROTATION, -sign, 0.0, 0.0)
            note(tally, log, t0 + at, TIP, before, body, plan.max_events)
            tau, just_tipped = at, True
            continue
        h = min(stop - tau, plan.longest)
        c = flight(plan, body, t0, tau, line, sine)
        if just_tipped and c[2] < 0.0:  # rounding: nothing pulls back where the tip was located
            c = (c[0], c[1], 0.0, c[3], c[4], c[5], c[6], c[7], c[8], c[9])
        just_tipped = False
        hit = first_descent(c, h)
        reach = min(hit, h)
        x_end, v_end = value(c, reach), value(derivative(c), reach)
        fall = NONE
        if max(body.x, x_end) > tally[WATCH] - plan.bulge * h * h:
            fall = look_up(plan, body, c, t0 + tau, reach, x_end, v_end, tally, log)
        keep(tally, log, body, c, t0 + tau, min(fall, reach))
        if fall <= reach:
            body = Body(body.mode, body.s, 0.5 * math.pi, value(derivative(c), fall))
            note(tally, log, t0 + tau + fall, FALL, body, body, plan.max_events)
        elif hit <= h:
            tau += hit
            before = Body(body.mode, body.s, x_end, v_end)
            body = after_impact(plan, body, v_end, t0, tau, line, sine)
            tally[IMPACTS] += 1.0
            note(tally, log, t0 + tau, IMPACT, before, body, plan.max_events)
        else:
            body = Body(body.mode, body.s, x_end, v_end)
            tau = stop if h == stop - tau else tau + h
    return body


@numba.njit(error_model="numpy")
def keep_flight(plan, body, t0, length, line, sine, tally, log):
    """Samples of a flight without events from t0 to t0 + length."""
    tau = 0.0
    while tau < length and tally[SAVED] < log.save_at.size and log.save_at[int(tally[SAVED])] <= t0 + length:
        h = min(length - tau, plan.longest)
        c = flight(plan, body, t0, tau, line, sine)
        keep(tally, log, body, c, t0 + tau, h)
        body = Body(body.mode, body.s, value(c, h), value(derivative(c), h))
        tau += h


@numba.njit(error_model="numpy")
def new_tally(body, plan, t_start, t_end):
    """The tally at the start of a run."""
    tally = np.zeros(TALLY)
    tally[PEAK] = abs(body.x)
    tally[WATCH] = min(tally[PEAK], plan.alpha)
    tally[PASSAGE], tally[END], tally[LAST_EVENT], tally[STATUS] = t_start, t_end, -math.inf, REACHED_END
    return tally
