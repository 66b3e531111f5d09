"""Noise estimates against noise of known size added to known motions."""

import math

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from studies.campaigns.signals import independent, measured, noise

from .conftest import STEP, forced_test, free_test, ramp


@pytest.mark.parametrize("seed", range(4))
def test_white_noise_alone(seed):
    values = 3.0 + 2e-4 * np.random.default_rng(seed).standard_normal(2500)
    found = noise(values, STEP)
    assert found.basis == "quiet stretch" and found.value == pytest.approx(2e-4, rel=0.12)
    assert found.high_frequency == pytest.approx(2e-4, rel=0.12)
    assert found.level == pytest.approx(3.0, abs=1e-4)


def test_no_bias_over_many_records():
    """The mean over 60 records is right to 3 %: low quantiles are put right."""
    rng = np.random.default_rng(5)
    found = [noise(rng.standard_normal(2000), STEP) for _ in range(60)]
    assert np.mean([f.high_frequency for f in found]) == pytest.approx(1.0, abs=0.03)
    assert np.mean([f.quiet for f in found]) == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("sigma", [2e-5, 2e-4, 2e-3])
def test_of_a_rotation_while_the_block_rocks(sigma):
    """A free decay rocks from first to last, with an impact every tenth of a second."""
    rng = np.random.default_rng(7)
    for test, _ in (free_test("a", 0.19, rng, noise=sigma), forced_test("b", 3.0, rng, noise=sigma)):
        assert noise(test.rotation, STEP).value == pytest.approx(sigma, rel=0.15)


def test_of_a_base_that_never_rests():
    _, a_x, _ = ramp(5.0)
    values = a_x + 0.004 * np.random.default_rng(2).standard_normal(a_x.size)
    found = noise(values[300:], STEP)
    assert found.basis == "high frequency" and found.value == pytest.approx(0.004, rel=0.15)
    assert math.isnan(found.level)


def test_low_passed_noise_is_seen_in_the_quiet_stretch():
    """A filter at a tenth of the sampling rate hides the noise from the differences; before the motion it shows."""
    rng = np.random.default_rng(4)
    coloured = sosfilt(butter(4, 0.2, output="sos"), rng.standard_normal(5000))
    coloured *= 0.02 / np.std(coloured)
    t = STEP * np.arange(5000)
    motion = np.where(t > 8.0, 5.0 * np.sin(2 * np.pi * 2.0 * (t - 8.0)), 0.0)
    found = noise(motion + coloured, STEP)
    assert found.high_frequency < 0.002
    assert found.basis == "quiet stretch" and found.value == pytest.approx(0.02, rel=0.3)


def test_a_coarse_last_digit_is_noise_too():
    """Rounded to 1e-3, a smooth motion is off by up to half of that: standard deviation 1e-3/sqrt(12)."""
    t = STEP * np.arange(2000)
    values = np.round(0.1 * np.sin(2 * np.pi * 0.05 * t), 3)
    assert noise(values, STEP).value >= 1e-3 / math.sqrt(12.0)


def test_missing_samples_do_not_matter():
    rng = np.random.default_rng(8)
    values = 2e-4 * rng.standard_normal(3000)
    values[rng.random(3000) < 0.01] = np.nan
    values[500:600] = np.nan
    assert noise(values, STEP).value == pytest.approx(2e-4, rel=0.12)


def test_too_broken_a_record_is_refused():
    values = np.ones(200)
    values[::10] = np.nan
    with pytest.raises(ValueError, match="no 48 samples in a row"):
        noise(values, STEP)


@pytest.mark.parametrize("stride", [2, 5])
@pytest.mark.parametrize("phase", [0, 1])
def test_slower_channels_are_recognised(stride, phase):
    rng = np.random.default_rng(9)
    slow = rng.standard_normal(400)
    sparse = np.full(400 * stride, np.nan)
    sparse[phase::stride] = slow
    held = np.repeat(slow, stride)[stride - phase if phase else 0 :]
    for values in (sparse, held):
        kept, found = independent(values)
        assert found == stride
        assert np.isin(kept[np.isfinite(kept)], slow).all() and kept.size >= 399
        assert np.count_nonzero(measured(values)) in (399, 400)
        assert noise(values, STEP).value == pytest.approx(1.0, rel=0.25)


def test_a_full_or_coarse_or_holed_channel_is_no_slower_one():
    rng = np.random.default_rng(10)
    full = rng.standard_normal(900)
    holed = full.copy()
    holed[rng.random(900) < 0.2] = np.nan
    coarse = np.round(0.4 * full)
    rest = np.zeros(900)
    for values in (full, holed, coarse, rest):
        assert independent(values)[1] == 1
        assert np.array_equal(measured(values), np.isfinite(values))
