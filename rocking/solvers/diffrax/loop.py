"""The traced loop: a step, what happens within it, and what follows; once round is `advance`.

Diffrax's own events end an integration at the first change of sign between two steps and know no guard that is zero at
the start, so its solver is stepped here by a loop of our own.  A step is looked at on its dense output; if a guard
falls below zero within it, the step is not taken, and the next one leads right up to the event.

Derivatives (forward mode, first order) are those of the true motion, impacts included.  Lengths of steps and brackets
carry no derivative; where a true step has ended at an event that guard g defines, one Newton correction

    t* = t - g / (dg/dt),  y* = y + (t* - t) dy/dt

takes off the last rounding, and its derivative is that of the implicit function, dt* = -dg / (dg/dt).  Where
dg/dt = 0 (a guard that only grazes zero) no derivative exists, and the event counts as fixed in time.

Source   Hairer, Norsett & Wanner (1993), Solving Ordinary Differential Equations I, II.4 for the step control, II.6 for
         events on dense output; Galan, Feehery & Barton (1999), Appl. Numer. Math. 31, 17-47, for derivatives
         through events.
Status   one source for a single run and for a batch in step; a batch costs as many rounds as its slowest member.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import lax

from rocking.hybrid import INADMISSIBLE, REST, Discrete
from rocking.solvers.diffrax.model import (
    RUNNING,
    Event,
    Inputs,
    Model,
    Physics,
    Progress,
    Recorder,
    Taken,
    discrete,
)
from rocking.solvers.diffrax.steps import (
    ERROR_ORDER,
    Attempt,
    attempt,
    error_norm,
    fall_through_zero,
    first_guard,
)
from rocking.solvers.recording import (
    EDGE,
    FELL,
    INADMISSIBLE_STATE,
    MAX_STALLED,
    NOT_FINITE,
    REACHED_END,
    STALL_TIME,
    STALLED,
    STEP_TOO_SMALL,
    TOO_MANY_EVENTS,
)

FIRST_STEP = 1e-3  # [s]; the error control mends it at once

MAX_CORRECTION = 1e-4
"""Largest Newton correction of an event as a share of a step; beyond it the dense output's root stands."""


def start(inputs: Inputs, y0: Any, q0: Discrete) -> Progress:
    """A run at its beginning."""
    t = jnp.asarray(inputs.edges[0])
    none, zero = jnp.asarray(-1), jnp.asarray(0)
    return Progress(
        t=t, y=jnp.asarray(y0), q=discrete(q0), h=jnp.full_like(t, FIRST_STEP), aim=jnp.zeros_like(t), guard=none,
        stretch=zero, fresh=jnp.asarray(True), last_event=jnp.full_like(t, -jnp.inf), stalled=zero, events=zero,
        steps=zero, status=jnp.asarray(RUNNING),
    )  # fmt: skip


def _physics(model: Model, inputs: Inputs, stretch: Any) -> tuple[Physics, Any]:
    """(functions on the stretch, its end [s])."""
    begin, stop = inputs.edges[stretch], inputs.edges[stretch + 1]
    first, last, longest = lax.stop_gradient((begin, stop, inputs.max_step))
    # As of `recording.inner_limits`.
    margin = jnp.minimum(jnp.where(jnp.isinf(longest), 0.0, EDGE * longest), 0.25 * (last - first))
    low = jnp.maximum(jnp.nextafter(first, jnp.inf), first + margin)
    high = jnp.minimum(jnp.nextafter(last, -jnp.inf), last - margin)
    return Physics(model, inputs.par, inputs.motion_par, low, high), stop


def _corrected(physics: Physics, step: Attempt, q: Discrete, guard: Any, longest: Any) -> tuple[Any, Any]:
    """(time, state) of the event at the end of a step that leads to it; see the head of the file."""
    value = physics.guards(step.t1, step.y1, q)[guard]
    frozen = lax.stop_gradient((physics.par, physics.motion_par, step.t1, step.y1, step.slope))
    par, motion_par, t, y, slope = frozen
    still = replace(physics, par=par, motion_par=motion_par)
    _, rate = jax.jvp(lambda t, y: still.guards(t, y, q)[guard], (t, y), (jnp.ones_like(t), slope))
    change = -value / jnp.where(rate == 0.0, jnp.inf, rate)
    useful = (jnp.abs(change) <= MAX_CORRECTION * longest) & (t + change > step.t0)
    change = change - lax.stop_gradient(jnp.where(useful, 0.0, change))
    return step.t1 + change, step.y1 + slope * change


def _passage(physics: Physics, step: Attempt, y0: Any, y: Any, taken: Any) -> tuple[Any, Any, Any]:
    """(whether, time, state) at which the tilt of unstable balance is passed outward on the step."""
    at_low, at_high = -physics.balance(y0), -physics.balance(y)
    passed = taken & (at_low > 0.0) & (at_high <= 0.0)
    still_step, par, at_low, at_high = lax.stop_gradient((step, physics.par, at_low, at_high))
    still = replace(physics, par=par)

    def inward(x: Any) -> Any:
        return -still.balance(still_step.at(still_step.time(x)))

    zero = jnp.zeros_like(still_step.t0)
    t = step.time(fall_through_zero(inward, passed, zero, at_low, zero + 1.0, at_high))
    y_near, velocity = jax.jvp(step.at, (t,), (jnp.ones_like(t),))
    velocity = lax.stop_gradient(velocity)
    _, rate = jax.jvp(still.balance, (lax.stop_gradient(y_near),), (velocity,))
    change = -physics.balance(y_near) / jnp.where(rate == 0.0, jnp.inf, rate)
    return passed, t + change, y_near + velocity * change


def _next_length(h: Any, tried: Any, size: Any, cut_short: Any) -> Any:
    """Length of the next step [s] from the error of the one tried; one cut short by an edge says only "not less"."""
    size = jnp.where(jnp.isfinite(size), jnp.maximum(size, 1e-12), jnp.inf)
    next_h = tried * jnp.clip(0.9 * size ** (-1.0 / ERROR_ORDER), 0.2, 5.0)
    return jnp.where(cut_short & (size <= 1.0), jnp.maximum(h, next_h), next_h)


class Due(NamedTuple):
    """What this time round is for; at most one of `broken`, `at_once`, `tries` holds, and none if the run is over."""

    broken: Any  # the state or the base motion is not finite
    at_once: Any  # a guard is below zero where the mode begins
    tries: Any  # a step is tried
    aimed: Any  # ... which leads right up to an event
    guard: Any  # the guard of the event
    values: Any  # of the guards now, shape (guard,)


def _due(physics: Physics, stop: Any, c: Progress) -> Due:
    going = (c.status == RUNNING) & (stop > c.t)
    base = physics.base(c.t)
    finite = jnp.all(jnp.isfinite(c.y)) & jnp.isfinite(base.a_x) & jnp.isfinite(base.a_z)
    broken = going & c.fresh & ~finite
    values = physics.guards(c.t, c.y, c.q)
    at_once = going & ~broken & c.fresh & jnp.any(values < 0.0)
    tries = going & ~broken & ~at_once
    guard = jnp.where(at_once, jnp.argmax(values < 0.0), c.guard)
    return Due(broken, at_once, tries, tries & (c.guard >= 0), guard, values)


def _tried(physics: Physics, due: Due, stop: Any, longest: Any, c: Progress) -> tuple[Attempt, Any]:
    """(a step, whether the end of the stretch cut it short); one of no account where none is due."""
    h = jnp.where(due.aimed, c.aim, jnp.where(due.tries, longest, FIRST_STEP))
    to_edge = due.tries & ~due.aimed & (h >= stop - c.t)
    t1 = jnp.where(to_edge, stop, c.t + lax.stop_gradient(h))
    return attempt(lambda t, y: physics.flow(t, y, c.q), c.t, t1, c.y), to_edge


def _judged(physics: Physics, inputs: Inputs, due: Due, step: Attempt, c: Progress) -> tuple[Any, Any, Any]:
    """(error of the step, first guard to fall below zero within it or -1, the time [s] that takes)."""
    step, par, motion_par, y, now = lax.stop_gradient((step, physics.par, physics.motion_par, c.y, due.values))
    still = replace(physics, par=par, motion_par=motion_par)
    size = error_norm(step.error, y, step.y1, inputs.rtol, inputs.atol)
    search = due.tries & ~due.aimed & (size <= 1.0)
    guard, share = first_guard(lambda t, y: still.guards(t, y, c.q), now, step, search, c.fresh)
    return size, guard, share * (step.t1 - step.t0)


def _event(physics: Physics, due: Due, t: Any, y: Any, q: Discrete) -> Event:
    """The event at (t, y), if one is due there."""
    fired = due.aimed | due.at_once
    y_after, q_after = lax.cond(fired & (due.guard != 0), lambda: physics.jump(t, y, q, due.guard), lambda: (y, q))
    return Event(fired, due.guard, t, y, q, y_after, q_after)


def advance(model: Model, recorder: Recorder, inputs: Inputs, c: Progress, record: Any) -> tuple[Progress, Any]:
    """Once round: try a step and take it, or find an event in it, or let one happen.  A run that is over stays."""
    physics, stop = _physics(model, inputs, c.stretch)
    due = _due(physics, stop, c)
    longest = jnp.minimum(c.h, inputs.max_step)
    step, to_edge = _tried(physics, due, stop, longest, c)
    size, guard, aim = _judged(physics, inputs, due, step, c)
    fits = due.aimed | (size <= 1.0)
    taken = due.tries & fits & (guard < 0)

    t_event, y_event = _corrected(physics, step, c.q, c.guard, longest)
    t_event = t_event - lax.stop_gradient(jnp.maximum(t_event - stop, 0.0))
    t = jnp.where(due.aimed, t_event, jnp.where(taken, step.t1, c.t))
    y = jnp.where(due.aimed, y_event, jnp.where(taken, step.y1, c.y))
    event = _event(physics, due, t, y, c.q)
    passage = _passage(physics, step, c.y, y, taken)
    record = recorder.keep(model, inputs, record, Taken(taken, step, c.y, t, y, c.q, *passage), event)

    measured = due.tries & ~due.aimed
    length = lax.stop_gradient(_next_length(c.h, step.t1 - step.t0, size, to_edge))
    at_edge = taken & ~event.fired & (t >= stop)
    progress = Progress(
        t=t,
        y=event.y,
        q=event.q,
        h=jnp.where(measured, length, c.h),
        aim=aim,
        guard=guard,
        stretch=c.stretch + (at_edge | ((c.status == RUNNING) & (stop <= c.t))),
        fresh=event.fired | at_edge | (c.fresh & ~taken),
        last_event=jnp.where(event.fired, lax.stop_gradient(t), c.last_event),
        stalled=jnp.where(event.fired, jnp.where(t - c.last_event < STALL_TIME, c.stalled + 1, 0), c.stalled),
        events=c.events + event.fired + passage[0],
        steps=c.steps + (measured & taken),
        status=c.status,
    )
    return progress._replace(status=_status(inputs, progress, due.broken, event, measured & ~fits, size)), record


def _status(inputs: Inputs, c: Progress, broken: Any, event: Event, refused: Any, size: Any) -> Any:
    """Whether the run goes on, and how it ended if not; the first that holds counts.

    size: error of the step; no number where state or base motion are not finite within it.
    """
    fired = event.fired
    stuck = refused & (c.h < 1e-15 * (1.0 + jnp.abs(c.t)))
    endings = (
        (broken, NOT_FINITE),
        (fired & (event.guard == 0), FELL),
        (fired & (c.q.mode == INADMISSIBLE), INADMISSIBLE_STATE),
        (fired & (c.stalled > MAX_STALLED), STALLED),
        (fired & (c.events > inputs.max_events), TOO_MANY_EVENTS),
        (stuck & ~jnp.isfinite(size), NOT_FINITE),
        (stuck, STEP_TOO_SMALL),
        (c.t >= inputs.edges[-1], REACHED_END),
    )
    status = jnp.asarray(RUNNING)
    for condition, code in reversed(endings):
        status = jnp.where(condition, code, status)
    return jnp.where(c.status == RUNNING, status, c.status)


def left_rest(event: Event) -> Any:
    """Whether the event ended rest."""
    return event.fired & (event.q_before.mode == REST) & (event.q.mode != REST)
