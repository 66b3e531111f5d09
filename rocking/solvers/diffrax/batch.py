"""What `rocking.solve_batch` asks of the solver diffrax: many systems and motions of one kind, side by side.

Source   the runs are those of `rocking.solvers.diffrax.response.batch`.
Status   runs go in step, as long as the longest of a group takes: on a CPU no faster than one after the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import jax
import numpy as np

from rocking.hybrid import REST, ROTATION, Discrete, System, numbers_of
from rocking.motion import BaseMotion
from rocking.solvers.devices import jax_device, label
from rocking.solvers.diffrax.model import model_of
from rocking.solvers.diffrax.response import batch


def _of_one_kind(systems: Sequence[System], motions: Sequence[BaseMotion]) -> None:
    """ValueError unless one compiled loop can carry all runs."""
    pairs = {(id(s), id(m)): (s, m) for s, m in zip(systems, motions, strict=True)}.values()
    if len({model_of(s, m) for s, m in pairs}) > 1:
        raise ValueError("systems, motions: want them of one method, form, effects and kind of motion in a batch")
    if len({len(m.parameters) for _, m in pairs}) > 1:
        raise ValueError("motions: want them of one kind, with as many parameters each, in a batch")


def _breakpoints(motions: Sequence[BaseMotion], t_end: float) -> Any:
    """Breakpoints of each motion, shape (run, breakpoint); short rows are filled up with the end."""
    rows = {id(m): m.breakpoints for m in motions}
    table = np.full((len(motions), max(len(row) for row in rows.values())), t_end)
    for i, motion in enumerate(motions):
        table[i, : len(rows[id(motion)])] = rows[id(motion)]
    return table


def run_batch(
    systems: Sequence[System],
    motions: Sequence[BaseMotion],
    states: Sequence[Any],
    t_span: tuple[float, float],
    device: str | None = None,
    **options: Any,
) -> dict[str, Any]:
    """The summary of every run, by name.

    Raises:
        ValueError: the systems or the motions are not of one kind, or the device is not there.
    """
    _of_one_kind(systems, motions)
    where = jax_device("jax-cpu" if device == "cpu" else device) if device is not None else jax.devices()[0]
    y0, modes = np.array([y for y, _ in states], dtype=np.float64), [tuple(q) for _, q in states]
    parameters = jax.tree.map(
        lambda *each: np.array(each, dtype=np.float64), *(numbers_of(s.parameters) for s in systems)
    )
    with jax.default_device(where):
        runs = batch(
            systems[0],
            motions[0],
            t_start=t_span[0],
            t_end=t_span[1],
            initial=(y0, Discrete(*(np.array(column) for column in zip(*modes, strict=True)))),
            parameters=parameters,
            motion_parameters=np.array([m.parameters for m in motions], dtype=np.float64),
            breakpoints=_breakpoints(motions, t_span[1]),
            max_step=np.array([m.max_step for m in motions], dtype=np.float64),
            **options,
        )
    return {
        "fell": runs.overturned,
        "failed": runs.failed,
        "t_end": runs.t_end,
        "overturning_time": runs.overturning_time,
        "theta_end": runs.theta_end,
        "peak_rotation": runs.peak_rotation,
        "impacts": runs.impacts,
        "onset_time": runs.onset_time,
        "last_mode": np.where(runs.at_rest, REST, ROTATION),
        "device": label(where),
    }
