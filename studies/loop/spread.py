"""How far a response would move if the base sensor's noise were drawn again: what no model can predict.

Near balance and after many impacts a response depends on the base motion more finely than it was measured.  Samples
are weighed by the sensor's variance and twice the variance of the response to redrawn noise, so that such stretches
do not own the sum of squares, for any rival alike.

Status   the recorded base is taken as the true one and noise of the declared size is added to it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studies.campaigns import Test
from studies.loop.model import LoopModel
from studies.loop.simulation import Job, Simulator
from studies.loop.windows import Window

Array = NDArray[np.float64]

DRAWS = 4
SMOOTHING = 0.3
"""Seconds over which the variance is averaged."""


def redrawn(tests: Sequence[Test], noise: Array, seed: int = 0, draws: int = DRAWS) -> Simulator:
    """The tests with base noise added, `draws` times over: test i of draw k has index k * len(tests) + i.

    Args:
        tests: of the campaign.
        noise: standard deviation of the horizontal base channel of each test [m/s^2], shape (test,).
        seed: of the noise.
    """
    rng = np.random.default_rng(seed)
    noisy = []
    for _ in range(draws):
        for test, sd in zip(tests, noise, strict=True):
            data = dict(test.data)
            channel = test.channel("base_acceleration_x")
            if channel is not None:
                data[channel.name] = data[channel.name] + sd * rng.standard_normal(test.time.size)
            noisy.append(replace(test, data=data))
    return Simulator(noisy, list(range(len(tests))) * draws)


def variances(
    noisy: Simulator,
    count: int,
    model: LoopModel,
    windows: Sequence[Window],
    leans: Sequence[float] | None = None,
    seed: int = 1,
) -> list[Array]:
    """Variance [rad^2] of the response at the samples of each window, under redrawn noise.

    Args:
        noisy: of `redrawn`.
        count: number of tests of the campaign.
        model: under which the responses are computed.
        windows: whole records.
        leans: standard deviation of the rotation at the start of each window [rad]; none if not given.
        seed: of the leans.
    """
    draws = len(noisy.tests) // count
    rng = np.random.default_rng(seed)
    jobs = []
    for k in range(draws):
        for i, w in enumerate(windows):
            lean = 0.0 if leans is None else leans[i] * rng.standard_normal()
            jobs.append(Job(0, k * count + w.test, w.times, w.start, w.theta + lean, w.omega))
    answers = noisy.run([model], jobs)
    n = len(windows)
    out = []
    for i, w in enumerate(windows):
        each = np.array([answers[k * n + i].theta for k in range(draws)])
        out.append(_smoothed(np.var(each, axis=0, ddof=1), w.times))
    return out


def _smoothed(variance: Array, times: Array) -> Array:
    if times.size < 3:
        return variance
    width = max(1, round(SMOOTHING / float(np.median(np.diff(times)))))
    padded = np.pad(variance, (width // 2, width - 1 - width // 2), mode="edge")
    return np.convolve(padded, np.ones(width) / width, mode="valid")


def weighed(windows: Sequence[Window], spreads: Sequence[Array]) -> list[Window]:
    """The windows with standard deviations that hold twice the variance of the response besides the sensor's."""
    return [replace(w, sd=np.sqrt(w.noise**2 + 2.0 * v)) for w, v in zip(windows, spreads, strict=True)]


def floor(window: Window, variance: Array) -> float:
    """Root mean square [rad] that the true model would score: sensor noise and what redrawn noise does."""
    return math.sqrt(window.noise**2 + float(np.mean(variance)))
