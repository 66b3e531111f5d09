"""Whole runs of the exact solver: intervals without events are passed in a few operations each, the others in steps.

Between two samples of a record the base is a line, so x - alpha - s a_x/g is a sum of exp(p t) and exp(-p t), exactly;
u and w are the two parts, carried from sample to sample (at each, the slope jumps).  For rate t sin(omega t + phase)

    x = alpha + s (C t sin + D cos) + u + w,   C = p^2 rate / (g (omega^2 + p^2)),   D = 2 omega C / (omega^2 + p^2)

and the intervals are those of a grid of its own.  No impact can hide within an interval: with F >= |a_x|/g - alpha
it is x'' <= p^2 (x + F), so from a minimum x <= 0 the tilt at the nearer end is at most F (cosh(p dt/2) - 1).  Where it
is more at both ends the interval is clear; the others are gone through by `rocking.solvers.exact.step`.  Nor can a
maximum: x'' >= -p^2 (alpha + max |a_x|/g), so it exceeds the nearer end by no more than that times dt^2/8.

Source   own derivation; linear equation of Winkler, Meguro & Yamazaki (1995), eqs (2), (3).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba
import numpy as np

from rocking.hybrid import REST, ROTATION
from rocking.solvers.exact.step import LONGEST_STEP, STATUS, WATCH, Body, Plan, carry, keep_flight, new_tally
from rocking.solvers.piecewise.polynomial import fma
from rocking.solvers.recording import REACHED_END
from rocking.solvers.taylor.records import BLOCK

LONGEST_TURN = 1.0 / 8.0
"""Longest interval in omega t for a sinusoid."""

SCAN = 64
"""Intervals after which the sinusoid is computed afresh."""


class Record(NamedTuple):
    """A base acceleration that is linear between equally spaced samples, and zero outside."""

    values: Any  # [m/s^2], shape (sample,)
    bends: Any  # second differences of the values, shape (sample,)
    peaks: Any  # largest |value| of each BLOCK of samples
    t_first: float
    dt: float
    per_dt: float


class Sine(NamedTuple):
    """rate t sin(omega t + phase) from 0 to duration."""

    omega: float
    phase: float
    rate: float
    duration: float


@numba.njit(error_model="numpy")
def new_plan(par, dt, a_max, max_events):
    """Constants of a run; par = (p^2, alpha, g, onset, e, omega_rest), dt the interval, a_max bounds |a_x|."""
    p = math.sqrt(par[0])
    longest = max(dt, LONGEST_STEP / p)
    force = max(a_max / par[2] - par[1], 0.0)
    half = math.sinh(0.25 * p * longest)  # cosh(x) - 1 = 2 sinh^2(x/2)
    # The small additions cover the rounding of the bounds themselves.
    clear = 2.0 * half * half * force * (1.0 + 1e-6) + (1e-15 if force > 0.0 else 0.0)
    bulge = par[0] / 8.0 * (par[1] + a_max / par[2]) * (1.0 + 1e-6)
    grow = math.exp(p * dt)
    return Plan(
        p, par[0], par[1], 1.0 / par[2], par[4], par[5], LONGEST_STEP / p, par[3] * par[2], clear, bulge,
        dt, 1.0 / p, grow, 1.0 / grow, max_events,
    )  # fmt: skip


@numba.njit(error_model="numpy")
def next_push(record, k, threshold):
    """First sample from k on whose |value| exceeds the threshold; the number of samples if there is none."""
    n = record.values.size
    while k < n:
        if k % BLOCK == 0 and record.peaks[k // BLOCK] <= threshold:
            k += BLOCK
        elif abs(record.values[k]) > threshold:
            return k
        else:
            k += 1
    return n


@numba.njit(error_model="numpy", forceinline=True)
def limits(plan, tally):
    """Tilts between which, at both ends, an interval has no event and no new largest tilt."""
    return plan.clear, tally[WATCH] - plan.bulge * plan.dt * plan.dt


@numba.njit(error_model="numpy")
def scan_record(plan, body, record, k, k_stop, tally, log):
    """(interval, body at its begin): passes over intervals from k on up to k_stop or to one that is not clear."""
    clear, watch = limits(plan, tally)
    if not clear < body.x <= watch:
        return k, body
    values, bends = record.values, record.bends
    f = body.s * plan.per_g
    ramp = f * record.per_dt
    slope = ramp * (values[k + 1] - values[k])
    z, zd = body.x - fma(f, values[k], plan.alpha), (body.v - slope) * plan.per_p
    u, w = 0.5 * (z + zd), 0.5 * (z - zd)
    grow, decay = plan.grow, plan.decay
    kick = 0.5 * ramp * plan.per_p
    x = body.x
    first = k
    while k < k_stop:
        u_end, w_end = grow * u, decay * w
        x_end = fma(f, values[k + 1], plan.alpha) + (u_end + w_end)
        if not clear < x_end <= watch:
            break
        v = fma(plan.p, u - w, ramp * (values[k + 1] - values[k]))
        keep_flight(
            plan, Body(ROTATION, body.s, x, v), record.t_first + k * record.dt, record.dt, line_of(record, k), None,
            tally, log,
        )  # fmt: skip
        x = x_end
        k += 1
        bend = kick * bends[k]
        u, w = fma(grow, u, -bend), fma(decay, w, bend)
    if k == first:
        return k, body
    last = min(k, values.size - 2)
    return k, Body(ROTATION, body.s, x, fma(plan.p, u - w, ramp * (values[last + 1] - values[last])))


@numba.njit(error_model="numpy")
def line_of(record, k):
    """(a at its begin, slope) of interval k."""
    return record.values[k], (record.values[k + 1] - record.values[k]) * record.per_dt


@numba.njit(error_model="numpy")
def carry_record(plan, body, record, t_start, t_end, tally, log):
    """The block at the end of a run over a record."""
    quiet = (0.0, 0.0)
    n, dt = record.values.size, record.dt
    t_last = record.t_first + (n - 1) * dt
    t = min(max(t_start, record.t_first), t_end)
    body = carry(plan, body, t_start, 0.0, t - t_start, quiet, None, tally, log)
    k = min(max(int((t - record.t_first) / dt), 0), n - 1) if t < t_end else n - 1
    start = max(t - (record.t_first + k * dt), 0.0)
    whole = min(int(max(t_end - record.t_first, 0.0) / dt), n - 1) if t < t_end else 0
    threshold = plan.a_rest * (1.0 - 1e-12)
    while k < n - 1 and tally[STATUS] == REACHED_END:
        t_k = record.t_first + k * dt
        if t_k >= t_end:
            break
        if start == 0.0 and body.mode == REST:
            k_push = next_push(record, k, threshold)
            ahead = max(min(k_push - 1, n - 1), k)
            if ahead > k:
                carry(plan, body, t_k, 0.0, (ahead - k) * dt, quiet, None, tally, log)
            k = ahead
            if k >= whole and k_push >= n:
                break
            t_k = record.t_first + k * dt
            if t_k >= t_end or k >= n - 1:
                break
        elif start == 0.0:
            k_new, body = scan_record(plan, body, record, k, whole, tally, log)
            if k_new > k:
                k = k_new
                continue
        stop = dt if k < whole else min(t_end - t_k, dt)
        body = carry(plan, body, t_k, start, stop, line_of(record, k), None, tally, log)
        k, start = k + 1, 0.0
    if t_end > t_last and tally[STATUS] == REACHED_END:
        t = max(t_last, t_start)
        body = carry(plan, body, t, 0.0, t_end - t, quiet, None, tally, log)
    return body


@numba.njit(error_model="numpy")
def next_shake(plan, sine, dt, k, n):
    """First interval from k on, n if there is none, in which |a_x| may exceed what the block stands."""
    if sine.rate == 0.0:
        return n
    # |a''| <= rate (t omega^2 + 2 omega), so |a| exceeds its ends by no more than that times dt^2/8.
    w = abs(sine.omega)
    over = abs(sine.rate) * (n * dt * w * w + 2.0 * w) * dt * dt / 8.0
    limit = (plan.a_rest - over) * (1.0 - 1e-12)
    k = max(k, min(int(max(limit, 0.0) / abs(sine.rate) / dt) - 1, n))
    if k >= n:
        return n
    turn_c, turn_s = math.cos(sine.omega * dt), math.sin(sine.omega * dt)
    at = 0
    s, c = 0.0, 1.0
    while k < n:
        if at % SCAN == 0:
            angle = sine.omega * (k * dt) + sine.phase
            s, c = math.sin(angle), math.cos(angle)
        s_next, c_next = s * turn_c + c * turn_s, c * turn_c - s * turn_s
        if abs(sine.rate) * max(k * dt * abs(s), (k + 1) * dt * abs(s_next)) > limit:
            return k
        s, c = s_next, c_next
        k += 1
        at += 1
    return n


@numba.njit(error_model="numpy")
def scan_sine(plan, body, sine, dt, k, k_stop, tally, log):
    """(interval, body at its begin), as of `scan_record`."""
    clear, watch = limits(plan, tally)
    if not clear < body.x <= watch:
        return k, body
    w2 = sine.omega * sine.omega + plan.p2
    C = body.s * plan.p2 * sine.rate * plan.per_g / w2
    D = 2.0 * sine.omega * C / w2
    t = k * dt
    angle = sine.omega * t + sine.phase
    sn, cs = math.sin(angle), math.cos(angle)
    # The forced part y and its velocity.
    y, y_v = C * t * sn + D * cs, (C - D * sine.omega) * sn + C * t * sine.omega * cs
    z, zd = body.x - plan.alpha - y, (body.v - y_v) * plan.per_p
    u, w = 0.5 * (z + zd), 0.5 * (z - zd)
    grow, decay = plan.grow, plan.decay
    turn_c, turn_s = math.cos(sine.omega * dt), math.sin(sine.omega * dt)
    first, k_stop = k, min(k_stop, k + SCAN)
    x = body.x
    while k < k_stop:
        u_end, w_end = grow * u, decay * w
        sn_end, cs_end = sn * turn_c + cs * turn_s, cs * turn_c - sn * turn_s
        t = (k + 1) * dt
        x_end = plan.alpha + (C * t * sn_end + D * cs_end) + (u_end + w_end)
        if not clear < x_end <= watch:
            break
        y_v = (C - D * sine.omega) * sn + C * (k * dt) * sine.omega * cs
        there = Body(ROTATION, body.s, x, plan.p * (u - w) + y_v)
        keep_flight(plan, there, k * dt, dt, (0.0, 0.0), sine, tally, log)
        x = x_end
        u, w, sn, cs = u_end, w_end, sn_end, cs_end
        k += 1
    if k == first:
        return k, body
    y_v = (C - D * sine.omega) * sn + C * (k * dt) * sine.omega * cs
    return k, Body(ROTATION, body.s, x, plan.p * (u - w) + y_v)


@numba.njit(error_model="numpy")
def sine_interval(sine, p):
    """(interval [s], number of intervals) of the grid for a sinusoid."""
    longest = LONGEST_STEP / p
    if abs(sine.omega) * longest > LONGEST_TURN:
        longest = LONGEST_TURN / abs(sine.omega)
    n = max(math.ceil(sine.duration / longest), 1)
    return sine.duration / n, n


@numba.njit(error_model="numpy")
def carry_sine(plan, body, sine, t_start, t_end, tally, log):
    """The block at the end of a run over a ramped sinusoid."""
    quiet = (0.0, 0.0)
    dt, n = sine_interval(sine, plan.p)
    t = min(max(t_start, 0.0), t_end)
    body = carry(plan, body, t_start, 0.0, t - t_start, quiet, None, tally, log)
    last = min(t_end, sine.duration)
    k = min(max(int(t / dt), 0), n)
    start = max(t - k * dt, 0.0)
    whole = min(int(max(t_end, 0.0) / dt), n)
    while k < n and k * dt < last and tally[STATUS] == REACHED_END:
        if start == 0.0 and body.mode == REST:
            ahead = next_shake(plan, sine, dt, k, n)
            if ahead > k:
                carry(plan, body, k * dt, 0.0, min(ahead * dt, last) - k * dt, quiet, None, tally, log)
                k = ahead
                continue
        elif start == 0.0:
            k_new, body = scan_sine(plan, body, sine, dt, k, whole, tally, log)
            if k_new > k:
                k = k_new
                continue
        stop = dt if k < whole else min(last - k * dt, dt)
        body = carry(plan, body, k * dt, start, stop, quiet, sine, tally, log)
        k, start = k + 1, 0.0
    if t_end > sine.duration and tally[STATUS] == REACHED_END:
        t = max(sine.duration, t_start)
        body = carry(plan, body, t, 0.0, t_end - t, quiet, None, tally, log)
    return body


@numba.njit(error_model="numpy")
def run_record(par, record, body, t_start, t_end, max_events, log):
    """(tally, body) at the end of a run over a record."""
    a_max = 0.0
    for peak in record.peaks:
        a_max = max(a_max, peak)
    plan = new_plan(par, record.dt, a_max, max_events)
    tally = new_tally(body, plan, t_start, t_end)
    body = carry_record(plan, body, record, t_start, t_end, tally, log)
    return tally, body


@numba.njit(error_model="numpy")
def run_sine(par, sine, body, t_start, t_end, max_events, log):
    """(tally, body) at the end of a run over a ramped sinusoid."""
    dt, _ = sine_interval(sine, math.sqrt(par[0]))
    a_max = abs(sine.rate) * max(min(sine.duration, t_end), 0.0)
    plan = new_plan(par, dt, a_max, max_events)
    tally = new_tally(body, plan, t_start, t_end)
    body = carry_sine(plan, body, sine, t_start, t_end, tally, log)
    return tally, body


@numba.njit(error_model="numpy")
def prepared(values):
    """(second differences, largest moduli by BLOCK) of the samples of a record."""
    n = values.size
    bends = np.zeros(n)
    for k in range(1, n - 1):
        bends[k] = (values[k + 1] - values[k]) - (values[k] - values[k - 1])
    peaks = np.zeros((n + BLOCK - 1) // BLOCK)
    for k in range(n):
        peaks[k // BLOCK] = max(peaks[k // BLOCK], abs(values[k]))
    return bends, peaks
