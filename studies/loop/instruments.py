"""What the instruments of a campaign would read in a run of the loop: body-fixed accelerometers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rocking.instruments import accelerometer
from rocking.trajectory import Events, Outcome, Trajectory
from studies.campaigns import Campaign, Channel
from studies.loop.model import LoopModel
from studies.loop.simulation import Answer, Simulator

Array = NDArray[np.float64]


def accelerations(model: LoopModel, campaign: Campaign, test: int, answer: Answer, channel: Channel) -> Array:
    """Reading of an accelerometer on the block [m/s^2] at the samples of the test, shape (time,).

    Raises:
        ValueError: the channel is none.
    """
    record = campaign.tests[test]
    if channel.position is None:
        raise ValueError(f"channel {channel.name!r}: is of kind {channel.kind}, want block_acceleration")
    simulator = Simulator([record])
    motion = model.base(simulator.bases[0], simulator.spans[0])
    run = _trajectory(model.system, motion, record.time, answer)
    return accelerometer(run, channel.position, channel.axis)


def _trajectory(system: Any, motion: Any, time: Array, answer: Answer) -> Trajectory:
    """The samples of an answer as a trajectory without events."""
    none = np.zeros(0)
    events = Events(
        none, none.astype(np.int64), none.astype(np.int64), none.astype(np.int64), none,
        np.zeros((0, answer.y.shape[1])), np.zeros((0, answer.y.shape[1])),
    )  # fmt: skip
    ends = (float(time[0]), float(time[-1]))
    outcome = Outcome.OVERTURNED if answer.fell else Outcome.MOVING
    peak = float(np.nanmax(np.abs(answer.theta))) if answer.theta.size else math.nan
    return Trajectory(
        system, motion, "numba", time, answer.y, answer.mode, answer.s, events, *ends, int(answer.mode[0]), outcome,
        peak_rotation=peak,
    )  # fmt: skip
