"""What accelerometers on the block would read in a run of the loop, over all samples of a test."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from studies.campaigns import Channel
from studies.loop.models.model import LoopModel
from studies.loop.observed.observing import readings
from studies.loop.runs.simulation import Answer, Simulator

Array = NDArray[np.float64]


def accelerations(model: LoopModel, simulator: Simulator, test: int, answer: Answer, channel: Channel) -> Array:
    """Reading of an accelerometer on the block [m/s^2] at the samples of the test, shape (time,).

    Args:
        model: with its mounting angles.
        simulator: of the tests.
        test: index of the test among them.
        answer: of a run that asked for all of its samples.
        channel: the accelerometer.

    Raises:
        ValueError: the channel is none.
    """
    if channel.position is None:
        raise ValueError(f"channel {channel.name!r}: is of kind {channel.kind}, want block_acceleration")
    base = simulator.base(model, test)
    return readings(simulator.in_test(model, test), channel, answer.y, answer.theta, answer.mode, answer.s, base)
