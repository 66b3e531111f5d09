"""The recorded base motion at fewer samples a second, for runs: as few as move the block as the record does.

Runs step from node to node of the base motion.  A record of 500 samples a second holds, beyond some 40 Hz, hardly
anything but its sensor's noise, which moves no block.  How much a record loses by being sampled less often is judged
by what the block would do: both the loss and the sensor's noise pass a filter with the block's own rate, and the loss
must stay far below the noise.  Of all splines of so few nodes the thinned motion is the one nearest to the record: to
first order it loses nothing of a motion's size, which would move a block more than as much noise does.

Source   the filter: a critically damped oscillator of the block's rate p, as rotation follows acceleration with 1/p^2
         below p and 1/omega^2 above it
Status   runs under thinned records come, on the average of eight draws, as near to those under the record without noise
         as runs under every sample do: noise lets a block tip early, and what is filtered out does so no more (tests)
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from excitation import SampledMotion
from studies.campaigns import Test
from studies.campaigns.base_motion import base_motion
from studies.campaigns.signals import noise_told

Array = NDArray[np.float64]

LONGEST = 0.0205
"""Longest time [s] between samples of a thinned motion."""

AT_REST = 0.05
"""The same of a base at rest [s]; the error of a run then stays a hundred thousandth of the noise of a usual sensor."""

SHARE = 0.15
"""Of what the sensor's noise does to the block, the most that may be lost."""


def base_noise(test: Test) -> float:
    """Standard deviation of the horizontal base channel of a test [m/s^2], declared or estimated.

    It is 0 without such a channel, and where a record is too short to tell.
    """
    channel = test.channel("base_acceleration_x")
    if channel is None or test.base_x is None:
        return 0.0
    return float(channel.noise or noise_told(test.base_x, test.time_step) or 0.0)


def factors(tests: Sequence[Test], p: float) -> list[int]:
    """`thinning` of the base of each test, for a block of rate p [1/s]; as far as goes for a base at rest."""
    return [_of(base_motion(test), test, p) for test in tests]


def _of(motion: SampledMotion | None, test: Test, p: float) -> int:
    if motion is None:
        return max(1, min(int(AT_REST / test.time_step), test.time.size - 1))
    return thinning(motion, base_noise(test), p)


def thinning(motion: SampledMotion, noise: float, p: float) -> int:
    """Samples of a motion that one of the thinned motion stands for: the most that lose nothing worth speaking of.

    Args:
        motion: as it was recorded.
        noise: standard deviation of its samples [m/s^2]; with 0 nothing is thinned.
        p: rate of the block, sqrt(m g R / I) [1/s].
    """
    if noise <= 0.0:
        return 1
    step = motion.time_step
    limit = SHARE * noise * _of_white_noise(p, step)
    for factor in range(int(LONGEST / step), 1, -1):
        if max(np.max(np.abs(_filtered(p, step, loss))) for loss in _lost(motion, factor)) <= limit:
            return factor
    return 1


def thinned(motion: SampledMotion, factor: int) -> SampledMotion:
    """The motion with one sample for every `factor` of them, what these cannot hold filtered out.

    It reaches as far as the motion does, or somewhat further.
    """
    if factor == 1:
        return motion
    a_x, a_z = (None if a is None else _less(a, motion.time_step, factor) for a in (motion.a_x, motion.a_z))
    assert a_x is not None
    return SampledMotion(factor * motion.time_step, a_x, a_z, start=motion.start, name=motion.name)


def _less(a: Array, step: float, factor: int) -> Array:
    """Samples of the cubic spline with a node for every `factor` samples that is nearest to all of them.

    It keeps the size of what it can hold, where one through filtered samples would make fast motion smaller.
    """
    from scipy.interpolate import make_lsq_spline

    a = np.concatenate([a, np.full(-(a.size - 1) % factor, a[-1])])
    t = step * np.arange(a.size)
    nodes = t[::factor]
    degree = min(3, nodes.size - 1)
    # Not a knot at the second node and the last but one, as of a spline that is drawn through its nodes.
    ends = [nodes[0]] * (degree + 1), [nodes[-1]] * (degree + 1)
    return np.asarray(make_lsq_spline(t, a, np.concatenate([ends[0], nodes[2:-2], ends[1]]), degree)(nodes))


def _lost(motion: SampledMotion, factor: int) -> list[Array]:
    """What the channels of a motion lose at its samples."""
    fewer = thinned(motion, factor)
    return [
        there - a for a, there in zip((motion.a_x, motion.a_z), fewer(motion.times), strict=True) if a is not None
    ]  # fmt: skip


def _filtered(p: float, step: float, a: Array) -> Array:
    """Response of a critically damped oscillator of rate p to a, over 1/p^2."""
    from scipy.signal import bilinear, lfilter

    return np.asarray(lfilter(*bilinear([p * p], [1.0, 2.0 * p, p * p], 1.0 / step), a))


def _of_white_noise(p: float, step: float) -> float:
    """Standard deviation of white noise of deviation 1 behind that filter."""
    pulse = np.zeros(math.ceil(20.0 / (p * step)))
    pulse[0] = 1.0
    return float(np.linalg.norm(_filtered(p, step, pulse)))
