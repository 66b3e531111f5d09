"""One round of the exact solver in JAX: intervals without events in a few operations each, then one step of the others.

No operation waits for another lane, so a lane's numbers do not depend on its neighbours.

Source   the passing of intervals: `rocking.solvers.exact.kernel`; the end of a chatter:
         `rocking.solvers.taylor.turns`.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import jax.numpy as jnp
from jax import lax

from rocking.solvers.exact.jax_flight import differentiated, first_descent, flight, push_on_sine, slope, value
from rocking.solvers.exact.jax_lanes import (
    RUNNING,
    Base,
    Fixed,
    Moving,
    ends_of_interval,
    least,
    moment,
    rate_at,
    stop_of,
    turns,
    unit,
)
from rocking.solvers.recording import FELL, MAX_STALLED, REACHED_END, STALL_TIME, STALLED, TOO_MANY_EVENTS
from rocking.solvers.taylor.records import BLOCK

PASSED = 8
"""Intervals that a round may pass."""

LOW = 0.01
"""A chatter is low while no flight changes what pulls the block back by more than half of this share."""


def next_quiet(F: Fixed, base: Base, k: Any, wave: bool) -> Any:
    """The interval after k, or after all that surely do not tip a block that stands: k itself if that one may."""
    moves = (k >= 0) & (k < F.count)
    outside = jnp.where(k < 0, jnp.minimum(0, F.k_last), F.k_last)
    margin = 4096.0 * unit(F.dt)
    if wave:
        rate, t = jnp.abs(F.rate), k * F.dt
        # |a''| <= rate (t omega^2 + 2 omega), so |a| exceeds its ends by no more than that times dt^2/8.
        over = rate * ((t + F.dt) * F.omega**2 + 2.0 * jnp.abs(F.omega)) * F.dt**2 / 8.0
        at_ends = [jnp.abs(t_j * s_j) for t_j, s_j, _ in (turns(F, k, 0.0), turns(F, k + 1, 0.0))]
        quiet = rate * jnp.maximum(*at_ends) + over <= F.onset * (1.0 - margin)
        # Before the envelope reaches the threshold nothing can happen.
        low = jnp.floor(F.onset / jnp.where(rate > 0.0, rate, least(rate)) / F.dt * (1.0 - margin)) - 1.0
        ahead = jnp.clip(low, 0.0, F.count.astype(low.dtype)).astype(k.dtype)
        inside = jnp.where(quiet, jnp.maximum(k + 1, ahead), k)
    else:
        b0, b1 = ends_of_interval(F, base, k)
        quiet = jnp.maximum(jnp.abs(b0), jnp.abs(b1)) <= F.onset * (1.0 - margin)
        block = jnp.clip((F.first + k) // BLOCK, 0, base.peaks.size - 2)
        low = jnp.maximum(base.peaks[block], base.peaks[block + 1]) * jnp.abs(F.scale) <= F.onset * (1.0 - margin)
        far = (k % BLOCK == 0) & low & (k + BLOCK < F.count)
        inside = jnp.where(quiet, jnp.where(far, k + BLOCK, k + 1), k)
    return jnp.minimum(jnp.where(moves, inside, outside), F.k_last)


class Forced(NamedTuple):
    """The part of a flight that belongs to the base, y, over an interval."""

    y: Any  # at its begin
    rate: Any  # derivative there
    y_end: Any
    rate_end: Any


def forced(F: Fixed, base: Base, k: Any, wave: bool) -> Forced:
    """A flight over interval k is x = alpha + s y + u + w, u growing and w decaying as exp(+-p t); its y."""
    if not wave:
        b0, b1 = ends_of_interval(F, base, k)
        return Forced(b0, (b1 - b0) / F.dt, b1, (b1 - b0) / F.dt)
    w2 = F.omega**2 + F.p2
    C = F.p2 * rate_at(F, k) / w2
    D = 2.0 * F.omega * C / w2
    parts = []
    for t, sine, cosine in (turns(F, k, 0.0), turns(F, k + 1, 0.0)):
        parts += [C * t * sine + D * cosine, (C - D * F.omega) * sine + C * t * F.omega * cosine]
    return Forced(*parts)


def pass_intervals(F: Fixed, base: Base, M: Moving, wave: bool) -> Moving:
    """Lanes at the begin of an interval pass it, and some of the next, while nothing can happen there."""
    goes = (M.status == RUNNING) & (M.tau == 0.0) & ~M.tipped & jnp.isinf(M.cap)
    flies, stands = goes & ~M.rests, goes & M.rests
    y = forced(F, base, M.k, wave)
    z, z_rate = M.x - F.alpha - M.s * y.y, (M.v - M.s * y.rate) / F.p
    u, w = 0.5 * (z + z_rate), 0.5 * (z - z_rate)
    tilts, speeds, waits = [M.x], [M.v], [M.k]
    for j in range(1, PASSED + 1):
        u, w = F.grow * u, w / F.grow
        tilts.append(F.alpha + M.s * y.y_end + (u + w))
        speeds.append(F.p * (u - w) + M.s * y.rate_end)
        y_next = forced(F, base, M.k + j, wave)
        if not wave:  # the slope jumps at a sample; y of a sinusoid goes on
            bend = 0.5 * M.s * (y.rate - y_next.rate) / F.p
            u, w = u + bend, w - bend
        y = y_next
        waits.append(next_quiet(F, base, waits[-1], wave))
    # Each number is made once, so that all that follows decides alike.
    tilts, speeds = lax.optimization_barrier((tilts, speeds))
    watch = jnp.minimum(M.peak, F.alpha) - F.swell
    clear = [(x > F.clear) & (x <= watch) for x in tilts]
    k, x, v = jnp.where(stands, waits[-1], M.k), M.x, M.v
    flies &= clear[0]
    for j in range(1, PASSED + 1):
        flies &= clear[j] & (M.k + j <= F.k_last)
        k, x, v = jnp.where(flies, M.k + j, k), jnp.where(flies, tilts[j], x), jnp.where(flies, speeds[j], v)
        # Where the base begins or ends its motion it may jump: a new flight begins there.
        flies &= (M.k + j != 0) & (M.k + j != F.count)
    return M._replace(k=k, x=x, v=v)


class Step(NamedTuple):
    """What a lane tries next: the flight c and a_x/g as polynomials, over h."""

    c: Any
    a: Any
    h: Any
    whole: Any  # whether h ends at the end of the interval


def next_step(F: Fixed, base: Base, M: Moving, wave: bool) -> Step:
    """The step that each lane may take at most."""
    stop = stop_of(F, M.k)
    if wave:
        t, sine, cosine = turns(F, M.k, M.tau)
        a = push_on_sine(rate_at(F, M.k), F.omega, t, sine, cosine)
    else:
        b0, b1 = ends_of_interval(F, base, M.k)
        a = [b0 + (b1 - b0) / F.dt * M.tau, (b1 - b0) / F.dt]
    left = jnp.minimum(stop, M.cap) - M.tau
    h = jnp.minimum(left, F.limit)
    c = flight(M.x, M.v, [M.s * part for part in a], F.p2, F.alpha, M.tipped)
    return Step(c, a, h, (left <= F.limit) & (M.cap >= stop))


NOTHING, TIP, PASSAGE, FALL, CREST, LANDING = range(6)
"""What a lane looks for in a step."""


def wanted(F: Fixed, M: Moving, step: Step) -> tuple[Any, list[Any]]:
    """(what is looked for, the polynomial whose descent through zero tells when)."""
    c, h = step.c, step.h
    x_end, v_end = value(c, h), slope(c, h)
    top = jnp.maximum(M.x, x_end)
    kinds = (
        (jnp.minimum(M.x, x_end) <= F.bulge, LANDING),
        ((M.v > 0.0) & (v_end < 0.0) & (top + F.bulge > M.peak), CREST),
        ((M.x < 0.5 * math.pi) & (x_end >= 0.5 * math.pi), FALL),
        ((M.x < F.alpha) & (x_end >= F.alpha), PASSAGE),
        (M.rests, TIP),
    )
    kind = jnp.full(h.shape, NOTHING)
    for condition, code in kinds:
        kind = jnp.where(condition, code, kind)
    a, a_end = step.a, value(step.a, h)
    side = jnp.where(jnp.abs(a_end) > jnp.abs(a[0]), jnp.sign(a_end), jnp.sign(a[0]))
    below = [-part for part in c]
    threshold = [F.onset - side * a[0], *(-side * part for part in a[1:])]
    threshold = threshold + [jnp.zeros_like(h)] * (len(c) - len(threshold))
    polynomials = {
        TIP: threshold,
        PASSAGE: [F.alpha + below[0], *below[1:]],
        FALL: [0.5 * math.pi + below[0], *below[1:]],
        CREST: differentiated(c),
        LANDING: c,
    }
    q = [jnp.ones_like(h), *(jnp.zeros_like(h) for _ in c[1:])]
    for code, polynomial in polynomials.items():
        q = [jnp.where(kind == code, one, other) for one, other in zip(polynomial, q, strict=True)]
    return kind, q


def chatter(F: Fixed, M: Moving, v: Any, s: Any, a: Any, rise: Any, curve: Any) -> Any:
    """Number of impacts in which the chatter of a block just struck ends; 0 if unsure (`taylor.turns.chatter`)."""
    swing = s
    A_1, A_2 = F.p2 * (F.alpha + swing * a), F.p2 * (F.alpha - swing * a)
    t_1, t_2 = 2.0 * v / A_1, 2.0 * v * F.e / A_2
    change, both = F.p2 * swing * rise, 1.0 / (1.0 - F.e * F.e)
    total, least = (t_1 + t_2) * both, jnp.minimum(A_1, A_2)
    shift = change / 3.0 * (t_1 / A_1 - t_2 / A_2) * both
    drift, bent = jnp.abs(change) * total / least, F.p2 * curve * total * total / least
    unsure = 2.0 * drift**2 + bent + F.p2 * drift * total**2 + drift * F.omega_rest / v + 1e-9 + 64.0 * unit(v)
    lost = -jnp.log(F.e)
    number, margin = (jnp.log(v / F.omega_rest) + shift) / lost, unsure / lost
    follows = (0.75 * v * v / least > M.peak) | (bent > 0.1) | (number < margin)
    follows |= jnp.floor(number - margin) != jnp.floor(number + margin)
    follows |= 2.0 * F.omega_rest * F.e / (4.0 * F.p2) < STALL_TIME
    return jnp.where(follows | ~jnp.isfinite(number), 0, jnp.floor(number) + 1.0).astype(M.impacts.dtype)


class Struck(NamedTuple):
    """A block after an impact."""

    v: Any
    s: Any
    rests: Any
    more: Any  # impacts of its chatter that were counted


def strike(F: Fixed, M: Moving, step: Step, reach: Any, tau: Any, max_events: Any, wave: bool) -> Struck:
    """What an impact at `reach` along the step would leave of a lane."""
    v, s = jnp.maximum(-F.e * slope(step.c, reach), 0.0), -M.s
    a, rise = value(step.a, reach), slope(step.a, reach)
    rests = (v < F.omega_rest) & (jnp.abs(a) <= F.onset)
    left = stop_of(F, M.k) - tau
    curve = jnp.zeros_like(v)
    a_stop = a if wave else a + rise * left
    if wave:
        curve = jnp.abs(rate_at(F, M.k)) * (F.omega**2 * jnp.abs(M.k * F.dt + tau) + 2.0 * jnp.abs(F.omega))
    hold = F.alpha - jnp.maximum(jnp.abs(a), jnp.abs(a_stop))
    series = 2.0 / (F.p2 * (1.0 - F.e)) * v
    steady = (jnp.abs(rise) * series < 0.2 * hold**2) & (v * v < LOW * F.p2 * hold**2)
    ends = (hold > 0.0) & (series < 0.9 * hold * left) & steady & ~rests & jnp.isinf(M.cap)
    more = jnp.where(ends, chatter(F, M, v, s, a, rise, curve), 0)
    more = jnp.where(M.events + 1 + more > max_events, 0, more)
    return Struck(v, s, rests | (more > 0), more)


class Found(NamedTuple):
    """How far a lane goes, and what happens there."""

    step: Step
    kind: Any  # NOTHING where nothing does
    reach: Any
    stays: Any  # the balance is passed on the way to what was found, and looked for first: up to there
    cap: Any


def searched(F: Fixed, base: Base, M: Moving, wave: bool) -> Found:
    """What each lane meets next.

    A decision is made once: were it made again for each number that hangs on it, rounding might make it otherwise.
    """
    step = next_step(F, base, M, wave)
    kind, q = wanted(F, M, step)
    at, found = first_descent(q, step.h)
    reach = jnp.where(kind == NOTHING, step.h, at)
    step, kind, reach = lax.optimization_barrier((step, jnp.where(found, kind, NOTHING), reach))
    beyond = ~M.rests & (kind != PASSAGE) & (M.x < F.alpha) & (value(step.c, reach) >= F.alpha)
    # Once: where rounding alone lifts the tilt above the balance, the second search may not find that either.
    beyond &= jnp.isinf(M.cap)
    beyond, cap = lax.optimization_barrier((beyond, M.tau + reach))
    return Found(step, jnp.where(beyond, NOTHING, kind), jnp.where(beyond, 0.0, reach), beyond, cap)


def moved(F: Fixed, M: Moving, f: Found, struck: Struck) -> Moving:
    """The lanes at the end of their way, before what they have met is counted."""
    calm = (f.kind == LANDING) & struck.rests
    x, v, a = value(f.step.c, f.reach), slope(f.step.c, f.reach), value(f.step.a, f.reach)
    for kind, tilt in ((PASSAGE, F.alpha), (FALL, 0.5 * math.pi), (LANDING, 0.0)):
        x = jnp.where(f.kind == kind, tilt, jnp.maximum(x, 0.0))
    v = jnp.where(f.kind == CREST, 0.0, jnp.where(f.kind == LANDING, struck.v, v))
    keeps = M.rests | f.stays
    s = jnp.where(f.kind == TIP, jnp.where(a < 0.0, jnp.ones_like(a), -jnp.ones_like(a)), M.s)
    tau = M.tau + f.reach
    whole = (f.step.whole & (f.kind == NOTHING) & ~f.stays) & (f.reach >= f.step.h)
    whole = lax.optimization_barrier(whole)
    x = jnp.where(keeps, M.x, x)
    return M._replace(
        x=x,
        v=jnp.where(calm, 0.0, jnp.where(keeps, M.v, v)),
        s=jnp.where(f.kind == LANDING, struck.s, s),
        rests=(M.rests & (f.kind != TIP)) | calm,
        tipped=(f.kind == TIP) | (M.tipped & (f.reach <= 0.0)),
        k=M.k + whole,
        tau=jnp.where(whole, 0.0, tau),
        cap=jnp.where(f.stays, f.cap, jnp.where((tau >= M.cap) | whole, jnp.inf, M.cap)),
        peak=jnp.minimum(jnp.maximum(M.peak, x), jnp.maximum(0.5 * math.pi, M.peak)),
    )


def counted(M: Moving, on: Moving, f: Found, struck: Struck, now: Any, alpha: Any) -> Moving:
    """The lanes `on` their way from M with what they have met in their sums."""
    lands, tips = f.kind == LANDING, f.kind == TIP
    passes = (f.kind == PASSAGE) | (~M.rests & ~f.stays & (M.x < alpha) & (on.x >= alpha))
    met = ((f.kind != NOTHING) & (f.kind != CREST)) | passes
    event = tips | lands
    stalls = jnp.where(now - M.last < STALL_TIME, M.stalls + 1, 0)
    return on._replace(
        passage=jnp.where(passes, now, M.passage),
        onset_time=jnp.where(tips & jnp.isnan(M.onset_time), now, M.onset_time),
        impacts=M.impacts + jnp.where(lands, 1 + struck.more, 0),
        events=M.events + met + jnp.where(lands, struck.more, 0),
        stalls=jnp.where(event, stalls, M.stalls),
        last=jnp.where(event | (f.kind == FALL), now, M.last),
    )


def one_step(F: Fixed, base: Base, M: Moving, max_events: Any, wave: bool) -> Moving:
    """Every lane goes on to the end of its interval or to what happens before, one thing at a time."""
    f = searched(F, base, M, wave)
    tau = M.tau + f.reach
    struck = lax.optimization_barrier(strike(F, M, f.step, f.reach, tau, max_events, wave))
    on = counted(M, moved(F, M, f, struck), f, struck, moment(F, M.k, tau), F.alpha)
    endings = (
        (f.kind == FALL, FELL),
        (on.stalls > MAX_STALLED, STALLED),
        (on.events > max_events, TOO_MANY_EVENTS),
        (on.k > F.k_last, REACHED_END),
    )
    status = on.status
    for condition, code in reversed(endings):
        status = jnp.where(condition, code, status)
    runs = M.status == RUNNING
    return Moving(*(jnp.where(runs, new, old) for new, old in zip(on._replace(status=status), M, strict=True)))
