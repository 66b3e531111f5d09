"""What is kept of a traced run: every event in a table, or a few numbers in sum; samples with either.

Arrays in a traced loop have fixed lengths: a table that is full makes the loop pause, and the run goes on with an empty
one; of what a summary has no room for, it keeps the count.

Status   a row of samples is (y, mode, s); a row of events (t, guard, mode before, mode after, s after, y before, y
         after): one array each, since each array in a loop costs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import jax.numpy as jnp
from jax import lax

from rocking.hybrid import Discrete
from rocking.solvers.diffrax.loop import left_rest
from rocking.solvers.diffrax.model import Event, Inputs, Model, Taken
from rocking.solvers.diffrax.steps import fall_through_zero
from rocking.trajectory import BALANCE


class Samples(NamedTuple):
    """States at the times asked for; the last row is spare."""

    rows: Any  # shape (time + 1, state + 2), NaN where the run did not come
    count: Any


def _state_row(y: Any, q: Discrete) -> Any:
    return jnp.concatenate([y, jnp.stack([q.mode.astype(y.dtype), q.s])])


def first_samples(save_at: Any, t: Any, y: Any, q: Discrete) -> Samples:
    """Samples at a start at t."""
    count = jnp.sum(save_at <= t)
    started = jnp.arange(save_at.size + 1) < count
    return Samples(jnp.where(started[:, None], _state_row(y, q)[None, :], jnp.nan), count)


def more_samples(samples: Samples, save_at: Any, taken: Taken) -> Samples:
    """Samples with those of the step, its end included."""
    if save_at.size == 0:
        return samples

    def due(s: Samples) -> Any:
        inside = save_at[jnp.minimum(s.count, save_at.size - 1)] <= taken.t
        return taken.taken & (s.count < save_at.size) & inside

    def with_next(s: Samples) -> Samples:
        row = _state_row(taken.step.at(save_at[s.count]), taken.q)
        return Samples(lax.dynamic_update_index_in_dim(s.rows, row, s.count, 0), s.count + 1)

    return lax.while_loop(due, with_next, samples)


class Table(NamedTuple):
    """All events since the table was last emptied."""

    rows: Any  # shape (row + 1, 5 + 2 state); the last row is spare
    count: Any
    peak: Any  # largest |theta| of the run so far [rad]
    samples: Samples


@dataclass(frozen=True)
class TableRecorder:
    """Keeps every event and the samples."""

    rows: int

    def empty(self, model: Model, inputs: Inputs, y0: Any, q0: Discrete) -> Table:
        """The record of a run that has not started."""
        rows = jnp.zeros((self.rows + 1, 5 + 2 * y0.size), y0.dtype)
        samples = first_samples(inputs.save_at, inputs.edges[0], y0, q0)
        return Table(rows, jnp.asarray(0), jnp.abs(y0[model.theta]), samples)

    def room(self, record: Table) -> Any:
        """Whether there is room for a passage of the balance and an event."""
        return record.count + 2 <= self.rows

    def keep(self, model: Model, inputs: Inputs, record: Table, taken: Taken, event: Event) -> Table:
        """The record with a step and an event."""
        tilt = jnp.abs(_most_tilted(model, taken)[model.theta])
        peak = jnp.where(taken.taken, jnp.maximum(record.peak, tilt), record.peak)
        record = record._replace(peak=peak, samples=more_samples(record.samples, inputs.save_at, taken))
        passage = Event(taken.passed, BALANCE, taken.t_passed, taken.y_passed, taken.q, taken.y_passed, taken.q)
        return self._with(self._with(record, passage), event)

    def _with(self, record: Table, event: Event) -> Table:
        numbers = (event.t, event.guard, event.q_before.mode, event.q.mode, event.q.s)
        head = jnp.stack([jnp.asarray(number, event.y.dtype) for number in numbers])
        row = jnp.concatenate([head, event.y_before, event.y])
        place = jnp.where(event.fired, record.count, self.rows)
        rows = lax.dynamic_update_index_in_dim(record.rows, row, place, 0)
        return record._replace(rows=rows, count=record.count + event.fired)


class Summary(NamedTuple):
    """A run in a few numbers."""

    peak: Any  # largest |theta| [rad]
    margin: Any  # theta_c - peak [rad]
    passage: Any  # last time [s] at which the tilt of unstable balance was passed outward; NaN if never
    onset: Any  # time [s] at which rest first ended; NaN if never
    impacts: Any
    impact_times: Any  # [s], shape (impact + 1,), NaN where there was none; the last is spare
    samples: Samples


@dataclass(frozen=True)
class SummaryRecorder:
    """Keeps what `Summary` names, and the times of the first `impacts` impacts."""

    impacts: int

    def empty(self, model: Model, inputs: Inputs, y0: Any, q0: Discrete) -> Summary:
        """The record of a run that has not started."""
        nothing = jnp.full_like(inputs.edges[0], jnp.nan)
        tilt, margin = jnp.abs(y0[model.theta]), -model.balance(jnp, y0, inputs.par)
        times = jnp.full(self.impacts + 1, jnp.nan, y0.dtype)
        samples = first_samples(inputs.save_at, inputs.edges[0], y0, q0)
        return Summary(tilt, margin, nothing, nothing, jnp.asarray(0), times, samples)

    def room(self, record: Summary) -> Any:
        """There always is."""
        return True

    def keep(self, model: Model, inputs: Inputs, record: Summary, taken: Taken, event: Event) -> Summary:
        """The record with a step and an event."""
        struck = event.fired & jnp.any(jnp.stack([event.guard == k for k in model.impacts]))
        place = jnp.where(struck, jnp.minimum(record.impacts, self.impacts), self.impacts)
        y = _most_tilted(model, taken)
        tilt = jnp.abs(y[model.theta])
        higher = taken.taken & (tilt > record.peak)
        first = left_rest(event) & jnp.isnan(record.onset)
        return Summary(
            peak=jnp.where(higher, tilt, record.peak),
            margin=jnp.where(higher, -model.balance(jnp, y, inputs.par), record.margin),
            passage=jnp.where(taken.passed, taken.t_passed, record.passage),
            onset=jnp.where(first, event.t, record.onset),
            impacts=record.impacts + struck,
            impact_times=lax.dynamic_update_index_in_dim(record.impact_times, event.t, place, 0),
            samples=more_samples(record.samples, inputs.save_at, taken),
        )


def _most_tilted(model: Model, taken: Taken) -> Any:
    """State of largest |theta| on the step: where omega turns inward, or at the end."""
    still, y0, y1 = lax.stop_gradient((taken.step, taken.y0, taken.y))

    def outward(y: Any) -> Any:
        return y[model.theta] * y[model.omega]

    turns = taken.taken & (outward(y0) > 0.0) & (outward(y1) < 0.0)
    zero = jnp.zeros_like(still.t0)
    share = fall_through_zero(
        lambda share: outward(still.at(still.time(share))), turns, zero, outward(y0), zero + 1.0, outward(y1)
    )
    # The turn moves with a parameter, but theta is stationary there: the derivative at a fixed share is the right one.
    return jnp.where(turns, taken.step.at(taken.step.time(share)), taken.y)
