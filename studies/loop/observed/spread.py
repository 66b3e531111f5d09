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

from rocking.soft_floor import BlockOnSoftFloor
from studies.campaigns import Test
from studies.loop.models.model import LoopModel
from studies.loop.observed.observing import observe
from studies.loop.observed.windows import Window
from studies.loop.runs.simulation import Job, Simulator

Array = NDArray[np.float64]

DRAWS = 32
"""As many as a covariance takes.

The few records that say most often hang finely on the base: of 4 draws standard deviations came out at 0.24 to 2.3
times the spread of fits under other noises, of 32 at 0.72 to 1.7 times.
"""

FEW = 16
"""As many as a variance takes that is averaged over samples.

Where a response hangs finely on the base most noises move it little and a few far. Of 4 draws, which had none of these,
a shaken record weighed so much that fits of all records left releases by 1.6 times their noise to meet it.
"""

FEW_ON_SPRINGS = 4
"""The same of a block on a floor that gives, of which runs take long."""

SMOOTHING = 0.3
"""Seconds over which the variance is averaged."""


def redrawn(
    tests: Sequence[Test], noise: Array, seed: int = 0, draws: int = DRAWS, factors: Sequence[int] | None = None
) -> Simulator:
    """The tests with base noise added, `draws` times over: test i of draw k has index k * len(tests) + i.

    Args:
        tests: of the campaign.
        noise: standard deviation of the horizontal base channel of each test [m/s^2], shape (test,).
        seed: of the noise.
        factors: as of `Simulator`, of each test.
    """
    rng = np.random.default_rng(seed)
    noisy = [test for _ in range(draws) for test in with_base_noise(tests, noise, rng)]
    return Simulator(noisy, [*range(len(tests))] * draws, factors=None if factors is None else [*factors] * draws)


def with_base_noise(tests: Sequence[Test], noise: Array, rng: np.random.Generator) -> list[Test]:
    """The tests with noise of that standard deviation [m/s^2], shape (test,), on the horizontal base channel."""
    noisy = []
    for test, sd in zip(tests, noise, strict=True):
        channel, data = test.channel("base_acceleration_x"), dict(test.data)
        if channel is not None:
            data[channel.name] = data[channel.name] + sd * rng.standard_normal(test.time.size)
        noisy.append(replace(test, data=data))
    return noisy


def variances(
    noisy: Simulator,
    count: int,
    model: LoopModel,
    windows: Sequence[Window],
    leans: Sequence[float] | None = None,
    seed: int = 1,
    draws: int | None = None,
) -> list[Array]:
    """Variance [unit of the channel squared] of the readings of each window, under redrawn noise, shape (datum,).

    Args:
        noisy: of `redrawn`.
        count: number of tests of the campaign.
        model: under which the responses are computed.
        windows: whole records.
        leans: standard deviation of the rotation at the start of each window [rad]; none if not given.
        seed: of the leans.
        draws: of the noise, the first of those in `noisy`; as many as a variance takes if not given.
    """
    if draws is None:
        draws = FEW_ON_SPRINGS if isinstance(model.system, BlockOnSoftFloor) else FEW
    read = _drawn(noisy, count, model, windows, leans, seed, draws)
    out = []
    for i, w in enumerate(windows):
        each = _variance(np.array([drawn[i] for drawn in read]))
        # The data are stacked channel by channel.
        channel, sample = np.divmod(w.there, w.times.size)
        out.append(np.concatenate([
            _smoothed(each[channel == c], w.times[sample[channel == c]]) for c in range(len(w.channels))
        ]))  # fmt: skip
    return out


def furthest_moved(
    simulator: Simulator, noisy: Simulator, count: int, model: LoopModel, windows: Sequence[Window]
) -> Array:
    """Rms of each window over its weights that the largest of redrawn noises would leave of the model's own response.

    So far off are records of a block that is that model, now and then; more in the tails than variances say.

    Args:
        simulator: of the tests as recorded.
        noisy, count, model, windows: as of `variances`.

    Returns:
        Shape (window,), with the sensor's own noise [1].
    """
    moved = _moved(simulator, noisy, count, model, windows, [w.weights for w in windows])
    return np.asarray(np.sqrt(moved.max(axis=0) + [_mean_square(w.noise * w.weights) for w in windows]))


def floors(
    simulator: Simulator, noisy: Simulator, count: int, model: LoopModel, windows: Sequence[Window],
    leans: Sequence[float],
) -> list[float]:  # fmt: skip
    """Root mean square that the true model would score in each window [unit of the channel]: the median over noises.

    The sensor's noise, and what noise of the base and of the leans does. Where one noise in ten lets the block fall, a
    mean would be of these falls alone.

    Args:
        simulator: of the tests as recorded.
        noisy, count, model, windows, leans: as of `variances`.
    """
    ones = [np.ones(w.data.size) for w in windows]
    moved = np.median(_moved(simulator, noisy, count, model, windows, ones, leans), axis=0)
    return [math.sqrt(m + float(np.mean(w.noise**2))) for m, w in zip(moved.tolist(), windows, strict=True)]


def _moved(
    simulator: Simulator, noisy: Simulator, count: int, model: LoopModel, windows: Sequence[Window],
    weights: Sequence[Array], leans: Sequence[float] | None = None,
) -> Array:  # fmt: skip
    """Mean square by which each noise moves the weighed readings of each window, shape (draw, window)."""
    jobs = [Job(0, w.test, w.times, w.start, w.theta, w.omega, struck=w.struck) for w in windows]
    own = observe(simulator, [model], jobs, windows)
    return np.array([
        [_mean_square((read - still) * by) for read, still, by in zip(drawn, own, weights, strict=True)]
        for drawn in _drawn(noisy, count, model, windows, leans, 1, DRAWS)
    ])  # fmt: skip


def _mean_square(values: Array) -> float:
    """Of those that can be compared; 0 of none."""
    there = np.isfinite(values)
    return float(np.mean(values[there] ** 2)) if there.any() else 0.0


def _drawn(
    noisy: Simulator, count: int, model: LoopModel, windows: Sequence[Window], leans: Sequence[float] | None,
    seed: int, draws: int,
) -> list[list[Array]]:  # fmt: skip
    """Readings of each window in each draw; arguments as of `variances`."""
    draws = min(draws, len(noisy.tests) // count)
    rng = np.random.default_rng(seed)
    jobs = []
    for k in range(draws):
        for i, w in enumerate(windows):
            lean = 0.0 if leans is None else leans[i] * rng.standard_normal()
            jobs.append(Job(0, k * count + w.test, w.times, w.start, w.theta + lean, w.omega, struck=w.struck))
    read = observe(noisy, [model], jobs, [*windows] * draws)
    n = len(windows)
    return [read[k * n : (k + 1) * n] for k in range(draws)]


def _variance(drawn: Array) -> Array:
    """Variance over the draws that can be compared; 0 where fewer than two can."""
    there = np.isfinite(drawn)
    count = there.sum(axis=0)
    mean = np.where(there, drawn, 0.0).sum(axis=0) / np.maximum(count, 1)
    square = np.where(there, (drawn - mean) ** 2, 0.0).sum(axis=0)
    return np.asarray(np.where(count > 1, square / np.maximum(count - 1, 1), 0.0))


def _smoothed(variance: Array, times: Array) -> Array:
    if times.size < 3:
        return variance
    width = max(1, round(SMOOTHING / float(np.median(np.diff(times)))))
    padded = np.pad(variance, (width // 2, width - 1 - width // 2), mode="edge")
    return np.convolve(padded, np.ones(width) / width, mode="valid")


def weighed(windows: Sequence[Window], spreads: Sequence[Array]) -> list[Window]:
    """The windows with standard deviations that hold twice the variance of the response besides the sensor's."""
    own = [w.noise if w.sd is None else w.sd for w in windows]
    return [replace(w, sd=np.sqrt(sd**2 + 2.0 * v)) for w, sd, v in zip(windows, own, spreads, strict=True)]
