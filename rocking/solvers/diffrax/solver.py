"""Diffrax's Dormand-Prince 8(7) in JAX, with located events.

The system's functions are traced once for each system, motion and sizes of arrays (rounded up to powers of two);
parameters are arguments, so runs with other numbers use the same compiled loop.  Steps, events and derivatives:
`rocking.solvers.diffrax.loop`; derivatives and batches for users: `rocking.solvers.diffrax.response`.

Source   Kidger (2021), On Neural Differential Equations, thesis, Oxford, for Diffrax.
Status   JAX's 64-bit mode is on while a run is carried, and only then.  The first run of a kind compiles for seconds.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from numpy.typing import NDArray

from rocking.hybrid import Discrete, System, numbers_of
from rocking.motion import BaseMotion
from rocking.solvers.diffrax.loop import advance, start
from rocking.solvers.diffrax.model import RUNNING, Inputs, Model, Progress, model_of
from rocking.solvers.diffrax.records import Table, TableRecorder
from rocking.solvers.recording import segment_edges, trajectory
from rocking.trajectory import Events, Trajectory

RECORDER = TableRecorder(rows=256)
"""Events that a run leaves between two pauses of the compiled loop."""

SMALLEST_ARRAY = 16
"""Arrays of edges and of samples are padded to this length or the next power of two."""


@partial(jax.jit, static_argnums=0)
def _carry(model: Model, inputs: Inputs, progress: Progress, table: Table) -> tuple[Progress, Table]:
    """On until the run is over or the table full."""

    def on(now: tuple[Progress, Table]) -> Any:
        return (now[0].status == RUNNING) & RECORDER.room(now[1])

    return lax.while_loop(on, lambda now: advance(model, RECORDER, inputs, *now), (progress, table))


@partial(jax.jit, static_argnums=0)
def _begin(model: Model, inputs: Inputs, y0: Any, q0: Discrete) -> tuple[Progress, Table]:
    progress = start(inputs, y0, q0)
    return progress, RECORDER.empty(model, inputs, progress.y, progress.q)


def padded(values: NDArray[np.float64], fill: float) -> NDArray[np.float64]:
    """The values, filled up to a length that many runs share."""
    length = SMALLEST_ARRAY
    while length < len(values):
        length *= 2
    return np.concatenate([values, np.full(length - len(values), fill)])


class DiffraxEvents:
    """Dormand-Prince 8(7) of Diffrax with located events."""

    name = "diffrax"
    batch_takes_device = True

    def declines(self, system: System, motion: BaseMotion) -> str | None:
        """None: any plain functions trace; one that does not is JAX's own error."""
        return None

    def solve_batch(self, systems: Any, motions: Any, states: Any, t_span: tuple[float, float], **options: Any) -> Any:
        """Summaries of many runs; see `rocking.solvers.diffrax.batch.run_batch`."""
        from rocking.solvers.diffrax.batch import run_batch

        return run_batch(systems, motions, states, t_span, **options)

    def solve(
        self,
        system: System,
        motion: BaseMotion,
        y0: tuple[float, ...],
        q0: Discrete,
        t_span: tuple[float, float],
        *,
        rtol: float,
        atol: float,
        save_at: NDArray[np.float64],
        max_events: int,
    ) -> Trajectory:
        """The trajectory from t_span[0] to the fall or t_span[1]."""
        model = model_of(system, motion)
        chunks = []
        with jax.enable_x64(True):
            inputs = Inputs(
                par=jax.tree.map(lambda value: jnp.asarray(value, float), numbers_of(system.parameters)),
                motion_par=jnp.asarray(motion.parameters, float),
                edges=jnp.asarray(padded(np.unique(segment_edges(motion, *t_span)), t_span[1])),
                max_step=jnp.asarray(motion.max_step, float),
                rtol=jnp.asarray(rtol, float),
                atol=jnp.asarray(atol, float),
                save_at=jnp.asarray(padded(save_at, np.inf)),
                max_events=jnp.asarray(max_events),
            )
            progress, table = _begin(model, inputs, jnp.asarray(y0, float), q0)
            while int(progress.status) == RUNNING:
                progress, table = _carry(model, inputs, progress, table)
                chunks.append(np.asarray(table.rows)[: int(table.count)])
                table = table._replace(count=jnp.zeros_like(table.count))
        return trajectory(
            system,
            motion,
            self.name,
            int(progress.status),
            (t_span[0], float(progress.t)),
            int(q0.mode),
            int(progress.q.mode),
            _samples(table, save_at, len(y0)),
            _events(np.concatenate(chunks), len(y0)),
            max_events,
            {"steps": int(progress.steps)},
            float(table.peak),
        )


def _samples(table: Table, save_at: NDArray[np.float64], n: int) -> tuple[Any, Any, Any, Any]:
    count = min(int(table.samples.count), len(save_at))
    rows = np.asarray(table.samples.rows)[:count]
    return save_at[:count], rows[:, :n], rows[:, n].astype(np.int64), rows[:, n + 1]


def _events(rows: NDArray[np.float64], n: int) -> Events:
    codes = rows[:, 1:4].astype(np.int64)
    return Events(rows[:, 0], codes[:, 0], codes[:, 1], codes[:, 2], rows[:, 4], rows[:, 5 : 5 + n], rows[:, 5 + n :])
