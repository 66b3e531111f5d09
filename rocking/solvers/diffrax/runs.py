"""Runs whole, traced: a single one, and many that go in step.

Status   what comes out is `Response`; the public way to it is `rocking.solvers.diffrax.response`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import lax
from numpy.typing import ArrayLike

from rocking.hybrid import REST, Discrete
from rocking.solvers.diffrax.loop import advance, start
from rocking.solvers.diffrax.model import RUNNING, Inputs, Model, Progress
from rocking.solvers.diffrax.records import Summary, SummaryRecorder
from rocking.solvers.recording import FELL, REACHED_END

CPU_GROUP = 256
"""Runs that go in step on a CPU: fewer pay more for each round, more fall out of its caches."""


class Response(NamedTuple):
    """What came out of a run; in a batch every entry has a leading axis `run`."""

    status: Any  # how it ended: a code of `rocking.solvers.recording`
    overturned: Any  # whether the block fell
    failed: Any  # whether the run could not go on; peak_rotation and margin are NaN then
    at_rest: Any  # whether the block stood still at the end
    peak_rotation: Any  # largest |theta| [rad]; pi/2 if the block fell
    margin: Any  # overturning margin theta_c - peak_rotation [rad]; negative once theta_c was passed
    impacts: Any  # number of impacts
    impact_times: Any  # [s], shape (keep_impacts,), NaN where there was none
    onset_time: Any  # time [s] at which rest first ended, NaN if it did not
    overturning_time: Any  # last outward passage of theta_c [s] before the fall; NaN if the block did not fall
    t_end: Any  # when the run ended [s]
    y: Any  # states at `save_at`, shape (time, state), NaN after the end
    theta_end: Any  # rotation at the end of the run [rad]


class Run(NamedTuple):
    """A run before it starts."""

    par: Any
    motion_par: Any
    breakpoints: Any
    span: Any  # (t_start, t_end) [s]
    max_step: Any
    y0: Any
    q0: Discrete


class Limits(NamedTuple):
    """What is asked of a run beside its numbers."""

    rtol: Any
    atol: Any
    save_at: Any
    max_events: Any


def limits_of(rtol: float, atol: float, save_at: ArrayLike, max_events: int) -> Limits:
    return Limits(jnp.asarray(rtol, float), jnp.asarray(atol, float), jnp.asarray(save_at, float), max_events)


def _inputs(run: Run, limits: Limits) -> Inputs:
    """Numbers of a run for the loop; breakpoints outside the run become stretches without length."""
    low, high = run.span
    inner = jnp.sort(jnp.clip(run.breakpoints, low, high))
    edges = jnp.concatenate([jnp.stack([low]), inner, jnp.stack([high])])
    rtol, atol, save_at, max_events = limits
    return Inputs(run.par, run.motion_par, edges, run.max_step, rtol, atol, save_at, max_events)


def _begin(model: Model, recorder: SummaryRecorder, limits: Limits, run: Run) -> tuple[Progress, Summary]:
    inputs = _inputs(run, limits)
    progress = start(inputs, run.y0, run.q0)
    return progress, recorder.empty(model, inputs, progress.y, progress.q)


@partial(jax.jit, static_argnums=(0, 1))
def run_one(model: Model, recorder: SummaryRecorder, run: Run, limits: Limits) -> Response:
    inputs = _inputs(run, limits)
    end = lax.while_loop(
        lambda now: now[0].status == RUNNING,
        lambda now: advance(model, recorder, inputs, *now),
        _begin(model, recorder, limits, run),
    )
    return _response(model, run, limits, *end)


def groups(run: Run, many: Run, count: int) -> Iterator[Run]:
    """The runs in groups; on a CPU of one size, the last filled up, so that one compiled loop serves them all."""
    size = count
    if next(iter(jnp.zeros(0).devices())).platform == "cpu":
        size = min(CPU_GROUP, 2 ** math.ceil(math.log2(count)))
    for first in range(0, count, size):
        rows = jnp.minimum(jnp.arange(first, first + size), count - 1)
        yield jax.tree.map(lambda leaf, own, rows=rows: leaf[rows] if own else leaf, run, many)


@partial(jax.jit, static_argnums=(0, 1, 2))
def run_many(model: Model, recorder: SummaryRecorder, many: Run, run: Run, limits: Limits) -> Response:
    """All runs in one loop; a run that is over only waits, so its record is not copied every time round."""
    axes = jax.tree.map(lambda own: 0 if own else None, many)
    once_round = jax.vmap(
        lambda run, progress, record: advance(model, recorder, _inputs(run, limits), progress, record), (axes, 0, 0)
    )
    end = lax.while_loop(
        lambda now: jnp.any(now[0].status == RUNNING),
        lambda now: once_round(run, *now),
        jax.vmap(partial(_begin, model, recorder, limits), (axes,))(run),
    )
    return jax.vmap(lambda run, *end: _response(model, run, limits, *end), (axes, 0, 0))(run, *end)


def _response(model: Model, run: Run, limits: Limits, progress: Progress, summary: Summary) -> Response:
    fell, failed = progress.status == FELL, progress.status > FELL
    passage = jnp.where(jnp.isnan(summary.passage), run.span[0], summary.passage)
    return Response(
        status=progress.status,
        overturned=fell,
        failed=failed,
        at_rest=(progress.status == REACHED_END) & (progress.q.mode == REST),
        peak_rotation=jnp.where(failed, jnp.nan, summary.peak),
        margin=jnp.where(failed, jnp.nan, summary.margin),
        impacts=summary.impacts,
        impact_times=summary.impact_times[:-1],
        onset_time=summary.onset,
        overturning_time=jnp.where(fell, passage, jnp.nan),
        t_end=progress.t,
        y=summary.samples.rows[: limits.save_at.size, :-2],
        theta_end=progress.y[model.theta],
    )
