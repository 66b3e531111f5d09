"""Many linear runs at a time: the bits of solver="taylor", whatever the number of threads, and the closed forms."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from rocking import Block, Method1, solve
from rocking.solvers.exact.batch import ExactBatchResult, RampedSines, ScaledRecord, exact_batch

BLOCK = Block(b=0.15, h=0.5)
SYSTEM = Method1(BLOCK, form="linear")
P = BLOCK.p()
SAME = {"p": P, "alpha": BLOCK.alpha, "e": SYSTEM.e, "onset": BLOCK.b / BLOCK.h}


def record(seed: int, n: int = 2000, peak: float = 5.0) -> np.ndarray:
    """Random samples, smoothed a little, with the given peak."""
    raw = np.convolve(np.random.default_rng(seed).standard_normal(n + 4), np.ones(5) / 5.0, "valid")
    return peak * raw / np.abs(raw).max()


def assert_is_the_single_run(batch: ExactBatchResult, i: Any, run: Any) -> None:
    assert batch.overturned[i] == run.overturned
    assert batch.side[i] == run.side
    assert batch.impacts[i] == len(run.impact_times)
    np.testing.assert_array_equal(batch.overturning_time[i], run.overturning_time)
    assert batch.t_end[i] == run.t_end
    assert batch.finished[i]
    assert batch.peak_rotation[i] == run.peak_rotation >= np.abs(run.theta).max(initial=0.0) * (1.0 - 1e-15)


def test_a_batch_of_sinusoids_gives_the_bits_of_single_runs() -> None:
    omega = 2.0 * math.pi * np.array([0.5, 1.3, 2.0, 4.7])
    rate = np.array([0.4, 1.0, 3.0])
    batch = exact_batch(RampedSines(omega[:, None], rate, 10.0, 0.3), t_end=12.0, **SAME)
    assert batch.overturned.shape == (4, 3)
    assert 0 < batch.overturned.sum() < 12
    for i, w in enumerate(omega):
        for j, r in enumerate(rate):
            motion: Any = SimpleNamespace(ramped_sine=(w, 0.3, r, 10.0))
            assert_is_the_single_run(batch, (i, j), solve(SYSTEM, motion, t_end=12.0, solver="taylor"))


@pytest.mark.parametrize("scale", [0.5, 1.0, 2.0])
def test_a_batch_over_a_record_gives_the_bits_of_single_runs(scale: float) -> None:
    # A power of 2 as the factor leaves every sample and difference exact.
    values = record(1)
    h = np.array([0.3, 0.5, 0.9, 3.0])
    systems = [Method1(Block(b=0.3 * size, h=size), form="linear") for size in h]
    par = np.array([system.parameters for system in systems])
    batch = exact_batch(
        ScaledRecord(values, 0.01, 0.25, scale),
        p=np.array([system.block.p() for system in systems]), alpha=par[:, 1], e=par[:, 4], onset=par[:, 3], t_end=21.0,
    )  # fmt: skip
    for i, system in enumerate(systems):
        motion: Any = SimpleNamespace(piecewise_linear=(0.25, 0.01, scale * values))
        assert_is_the_single_run(batch, i, solve(system, motion, t_end=21.0, solver="taylor"))


def test_other_factors_of_scale_and_time_change_a_run_by_rounding_alone() -> None:
    values = record(2)
    scale, slower = np.array([0.7, 1.1, 1.3]), np.array([0.9, 1.0, 1.7])
    batch = exact_batch(ScaledRecord(values, 0.01, 0.0, scale, slower), t_end=2.0, **SAME)
    for i in range(3):
        motion: Any = SimpleNamespace(piecewise_linear=(0.0, 0.01 * slower[i], scale[i] * values))
        run = solve(SYSTEM, motion, t_end=2.0, solver="exact")
        # Few impacts: rounding of 1e-16 is not multiplied much before 2 s.
        assert batch.impacts[i] == len(run.impact_times)
        assert batch.t_end[i] == pytest.approx(run.t_end, abs=1e-11)


def test_threads_change_no_bit() -> None:
    values = record(3, peak=7.0)
    scale = np.linspace(0.3, 3.0, 1500)
    one, two, seven = (
        exact_batch(ScaledRecord(values, 0.01, scale=scale), t_end=20.0, workers=n, **SAME) for n in (1, 2, 7)
    )
    assert 0 < one.overturned.sum() < 1500
    for name, first, second, third in zip(ExactBatchResult._fields, one, two, seven, strict=True):
        np.testing.assert_array_equal(first, second, err_msg=name)
        np.testing.assert_array_equal(first, third, err_msg=name)


def test_the_mirror_image_of_a_batch_falls_to_the_other_side_at_the_same_bits() -> None:
    values = record(4, peak=7.0)
    scale = np.linspace(0.3, 3.0, 300)
    one, other = (
        exact_batch(ScaledRecord(values, 0.01, scale=side * scale), t_end=20.0, theta=side * 0.01, **SAME)
        for side in (1.0, -1.0)
    )
    np.testing.assert_array_equal(one.side, -other.side)
    for name in ("overturned", "overturning_time", "peak_rotation", "impacts", "t_end"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


# Released from rest at theta_0, a block swings to no more than that again; its largest tilt is the one at the start.
# Pushed from upright by omega, it reaches alpha (1 - sqrt(1 - (omega/(p alpha))^2)) at a time between all steps.
def test_the_peak_is_that_of_the_closed_form() -> None:
    still = ScaledRecord(np.zeros(2), 1.0)
    theta = np.array([0.01, 0.1, 0.2, -0.25])
    released = exact_batch(still, theta=theta, t_end=30.0, **SAME)
    np.testing.assert_array_equal(released.peak_rotation, np.abs(theta))
    share = np.array([1e-4, 0.01, 0.3, 0.9, -0.99])
    pushed = exact_batch(still, omega=share * P * BLOCK.alpha, t_end=30.0, **SAME)
    expected = -BLOCK.alpha * np.expm1(0.5 * np.log1p(-(share**2)))
    # Rounding of tilts of the order of alpha: 1e-16 each step of the way.
    np.testing.assert_allclose(pushed.peak_rotation, expected, rtol=1e-13, atol=1e-16)


# Without restitution each swing starts anew, and no impact multiplies the rounding of the interpolated samples.
def test_a_peak_between_samples_is_that_of_a_record_with_many_more() -> None:
    values = record(5, n=300, peak=4.0)
    fine = np.interp(np.linspace(0.0, 299.0, 299 * 64 + 1), np.arange(300), values)
    scale = np.linspace(0.8, 1.2, 40)
    coarse, refined = (
        exact_batch(ScaledRecord(v, dt, scale=scale), t_end=3.0, **SAME | {"e": 0.0})
        for v, dt in ((values, 0.01), (fine, 0.01 / 64))
    )
    np.testing.assert_array_equal(coarse.impacts, refined.impacts)
    np.testing.assert_allclose(coarse.peak_rotation, refined.peak_rotation, rtol=0.0, atol=1e-12)


def test_a_run_with_too_many_events_is_unfinished_and_the_others_are_not() -> None:
    still = ScaledRecord(np.zeros(2), 1.0)
    batch = exact_batch(still, theta=[0.0, 0.1], t_end=9.0, max_events=5, **SAME)
    np.testing.assert_array_equal(batch.finished, [True, False])
    np.testing.assert_array_equal(batch.t_end[:1], [9.0])
    assert batch.t_end[1] < 9.0


def test_one_run_gives_arrays_without_dimension() -> None:
    batch = exact_batch(RampedSines(12.0, 1.0, 10.0), t_end=10.0, **SAME)
    assert all(column.shape == () for column in batch)
    assert all(
        column.dtype == wanted
        for column, wanted in zip(batch[:-1], (bool, int, float, float, int, float, bool), strict=True)
    )


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"p": [5.0, -1.0]}, r"p=-1.0 rad/s: want above 0 and finite"),
        ({"alpha": 1.7}, r"alpha=1.7 rad: want above 0 to 1.5708"),
        ({"e": math.nan}, r"e=nan 1: want 0 to 1"),
        ({"onset": 0.1}, r"onset: want alpha or more"),
        ({"g": 0.0}, r"g=0.0 m/s\^2: want above 0 and finite"),
        ({"rest_speed": 0.0}, r"rest_speed=0.0 1: want above 0 and finite"),
        ({"theta": 1.6}, r"theta=1.6 rad"),
        ({"t_end": 0.0}, r"t_end: want a time after t_start"),
        ({"max_events": 0}, r"max_events=0: want 1 or more"),
        ({"workers": 0}, r"workers=0: want 1 or more"),
        ({"motion": RampedSines(1.0, math.inf, 1.0)}, r"rate=inf m/s\^3"),
        ({"motion": RampedSines(1.0, 1.0, 0.0)}, r"duration=0.0 s: want above 0 and finite"),
        ({"motion": ScaledRecord([1.0], 0.1)}, r"values: want finite accelerations of shape \(sample,\), two"),
        ({"motion": ScaledRecord([1.0, 2.0], 0.0)}, r"dt=0.0 s: want above 0 and finite"),
        ({"motion": ScaledRecord([1.0, 2.0], 0.1, time_scale=[1.0, 0.0])}, r"time_scale=0.0 1: want above 0"),
        ({"motion": "sine"}, r"motion=str: want RampedSines or ScaledRecord"),
        ({"p": [1.0, 2.0], "e": [0.5, 0.6, 0.7]}, r"shape mismatch"),
    ],
)  # fmt: skip
def test_wrong_arguments_are_refused_in_a_sentence(change: dict[str, Any], sentence: str) -> None:
    arguments = {"motion": RampedSines(12.0, 1.0, 10.0), "t_end": 10.0, **SAME, **change}
    with pytest.raises(ValueError, match=sentence):
        exact_batch(arguments.pop("motion"), **arguments)
