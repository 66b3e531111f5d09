"""What the channels of a window read in a run: the rotation sensor, or accelerometers on the block, gravity included.

Readings are stacked channel by channel.  Those of many runs of one model are computed at once, since a fit asks for
them some ten thousand times.

Status   between impacts; an impact itself is an impulse, of which a sample says nothing.  A block that has fallen lies
         on its side and its accelerometers read gravity alone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rocking.hybrid import REST, Base
from rocking.instruments import accelerometer_at
from studies.campaigns import Channel
from studies.loop.models.model import LoopModel
from studies.loop.observed.windows import ANY_SIDE, SIDE, Window
from studies.loop.runs.simulation import Answer, Job, Simulator

Array = NDArray[np.float64]


def jobs_of(windows: Sequence[Window], model: int, d_theta: float = 0.0, d_omega: float = 0.0) -> list[Job]:
    """Runs of one model over windows, from their states or from shifted ones [rad, rad/s]."""
    return [
        Job(model, w.test, w.times, w.start, w.theta + d_theta, w.omega + d_omega, w.history, w.struck) for w in windows
    ]


def observe(
    simulator: Simulator, models: Sequence[LoopModel], jobs: Sequence[Job], windows: Sequence[Window]
) -> list[Array]:
    """Readings in each run at the data of its window.

    Args:
        simulator: of the tests that the jobs name.
        models: by the indices that jobs use.
        jobs: runs.
        windows: that of each run.

    Returns:
        For each run the readings that go with the window's data, shape (datum,); NaN for an accelerometer where the
        model leans to another side than the block did, or is at rest where the block was not.
    """
    answers = simulator.run(models, jobs)
    out = [
        simulator.recorded(models[job.model], job.test, answer.theta, w.index) if not w.accelerometers else np.zeros(0)
        for job, answer, w in zip(jobs, answers, windows, strict=True)
    ]
    by_model: dict[tuple[int, int], list[int]] = {}
    for i, (job, w) in enumerate(zip(jobs, windows, strict=True)):
        if w.accelerometers:
            by_model.setdefault((job.model, job.test if models[job.model].varies else -1), []).append(i)
    for (number, _), members in by_model.items():
        _accelerations(simulator, models[number], members, jobs, answers, windows, out)
    return out


def _accelerations(
    simulator: Simulator, model: LoopModel, members: Sequence[int], jobs: Sequence[Job], answers: Sequence[Answer],
    windows: Sequence[Window], out: list[Array],
) -> None:  # fmt: skip
    """Put the readings of all runs of a model in `out`; of one that changes from test to test, of a single test."""
    y = np.concatenate([answers[i].y for i in members])
    theta = np.concatenate([answers[i].theta for i in members])
    mode = np.concatenate([answers[i].mode for i in members])
    s = np.concatenate([answers[i].s for i in members])
    side = np.where(mode == REST, 0.0, s)
    bases = [simulator.base(model, jobs[i].test) for i in members]
    base = Base(*(np.concatenate([row[windows[i].index] for row, i in zip(rows, members, strict=True)])
                  for rows in zip(*bases, strict=True)))  # fmt: skip
    channels = {c.name: c for i in members for c in windows[i].channels}
    there = simulator.in_test(model, jobs[members[0]].test)
    read = {name: readings(there, channel, y, theta, mode, s, base) for name, channel in channels.items()}
    at = 0
    for i in members:
        part = slice(at, at + answers[i].mode.size)
        at = part.stop
        w = windows[i]
        own = [
            simulator.recorded(model, jobs[i].test, theta[part], w.index)
            if c.kind == "rotation" and c is not SIDE and model.remembers
            else read[c.name][part]
            for c in w.channels
        ]
        if w.sides is not None:
            apart = (w.sides != ANY_SIDE) & (w.sides != side[part])
            own = [
                np.where(apart, np.nan, x) if c.kind != "rotation" else x for c, x in zip(w.channels, own, strict=True)
            ]
        out[i] = np.concatenate(own)[w.there]


def readings(
    model: LoopModel, channel: Channel, y: Array, theta: Array, mode: NDArray[np.int64], s: Array, base: Base
) -> Array:
    """Reading of a channel in given states, shape (sample,).

    Args:
        model: whose block, sensors and mounting angles they are.
        channel: rotation, or an accelerometer on the block.
        y: states, shape (sample, state), NaN after a fall.
        theta: true rotation [rad], +-pi/2 after a fall.
        mode, s: mode and carrying side.
        base: what the base does there, as the model has it.
    """
    if channel.kind == "rotation":
        return theta if channel is SIDE else np.asarray(model.reading(theta))
    assert channel.position is not None
    system, (x, z) = model.system, model.axis(channel)
    fallen = np.isnan(y[:, 0])
    standing = np.where(fallen[:, None], 0.0, y), np.where(fallen, REST, mode), np.where(fallen, 1.0, s)
    read = accelerometer_at(system, *standing, base, channel.position, (x, z))
    return np.where(fallen, system.g * (z * np.cos(theta) - x * np.sin(theta)), read)
