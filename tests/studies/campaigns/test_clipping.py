"""Rails of sensors, falls, and records that stop early."""

import math

import numpy as np
import pytest

from studies.campaigns.signals import before_overturning, clipped, ends_in_motion, overturning_time

from .conftest import BLOCK, STEP, forced_test, free_test, ramp


@pytest.mark.parametrize("sides", [(1.0,), (-1.0,), (1.0, -1.0)])
def test_a_rail_is_found_to_the_sample(sides):
    rng = np.random.default_rng(1)
    _, a_x, _ = ramp(3.0)
    values = a_x + 0.004 * rng.standard_normal(a_x.size)
    railed = values.copy()
    for side in sides:
        railed = side * np.minimum(side * railed, 4.0)
    assert np.array_equal(clipped(railed), railed != values) and clipped(railed).sum() > 50
    assert not clipped(values).any()


def test_a_rail_that_a_few_peaks_touch():
    _, a_x, _ = ramp(3.0)
    railed = np.minimum(a_x, 6.5)
    assert np.array_equal(clipped(railed), a_x >= 6.5)


@pytest.mark.parametrize("digit", [1e-12, 1e-3, 0.05])
def test_smooth_peaks_are_no_rails_however_coarse(digit):
    t = STEP * np.arange(3000)
    for values in (np.sin(2 * np.pi * t), np.sin(2 * np.pi * 0.2 * t) * np.exp(-0.1 * t)):
        assert not clipped(np.round(values / digit) * digit).any()


def test_rest_is_no_rail():
    values = np.zeros(1000)
    values[400:600] = np.sin(np.linspace(0, np.pi, 200))
    assert not clipped(values)[:400].any() and not clipped(np.zeros(100)).any()
    assert not clipped(np.full(100, np.nan)).any()


def test_a_fall_is_dated_as_the_solver_dates_it():
    """The solver locates the passage of alpha; the record is interpolated between two samples."""
    rng = np.random.default_rng(2)
    test, run = forced_test("fall", 2.0, rng, duration=12.0, amplitude=16.0)
    assert run.overturned
    fell = overturning_time(test.time, test.rotation, BLOCK.alpha)
    assert fell == pytest.approx(run.overturning_time, abs=STEP)
    mask = before_overturning(test.time, test.rotation, BLOCK.alpha)
    assert np.array_equal(mask, test.time < fell) and not mask.all()


def test_no_fall_where_the_block_comes_back_or_only_nears_balance():
    t = STEP * np.arange(1000)
    assert math.isnan(overturning_time(t, 1.5 * np.sin(np.pi * t / t[-1]), 0.3))
    assert math.isnan(overturning_time(t, 0.35 * t / t[-1], 0.3))
    assert before_overturning(t, 0.2 * np.sin(t), 0.3).all()
    assert math.isnan(overturning_time(t, np.full(1000, np.nan), 0.3))


def test_a_fall_across_missing_samples():
    t = STEP * np.arange(1000)
    rotation = 0.1 * np.exp(t)
    rotation[rotation > 1.5] = np.nan
    exact = math.log(3.0)
    gap = (t > exact - 0.02) & (t < exact + 0.02)
    rotation[gap] = np.nan
    assert overturning_time(t, rotation, 0.3) == pytest.approx(exact, abs=0.002)


def test_records_that_stop_early_are_told_from_those_that_end_at_rest():
    rng = np.random.default_rng(3)
    rocking, _ = free_test("a", 0.19, rng, duration=1.5)
    rested = np.concatenate([rocking.rotation, 2e-4 * rng.standard_normal(300)])
    assert ends_in_motion(rocking.rotation, 2e-4) and not ends_in_motion(rested, 2e-4)
    assert not ends_in_motion(rested + 0.01, 2e-4, zero=0.01)
