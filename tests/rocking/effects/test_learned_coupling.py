"""A base sensor that loses slow motion, against closed forms and SciPy's filters (rocking.effects.learned_coupling)."""

import math

import numpy as np
import pytest
from scipy.signal import lsim

from excitation import OneSinePulse, SampledMotion
from rocking.effects import base_with, load
from rocking.effects.learned_coupling import LearnedCoupling
from rocking.motion import base_at

STEP = 0.004


def there(motion, t):
    return base_at(np, motion, t, np.asarray(motion.parameters))


@pytest.mark.parametrize("corner", [0.05, 0.5, 3.0])
def test_a_record_that_was_high_passed_is_what_it_was(corner: float) -> None:
    """True motion through s / (s + w) by SciPy's simulation of linear systems, and back."""
    t = STEP * np.arange(2000)
    rough = np.random.default_rng(2).normal(size=t.size)
    true = 2.0 * np.convolve(rough, np.hanning(25) / 12.5, "same") * np.hanning(t.size)
    w = 2.0 * math.pi * corner
    _, recorded, _ = lsim(([1.0, 0.0], [1.0, w]), true, t)
    motion = LearnedCoupling(corner).base_motion(SampledMotion(STEP, recorded), (0.0, t[-1]), 9.81)
    # SciPy's system takes straight lines between samples for the true motion, the package for the recorded one: at the
    # 20 Hz of this record these differ by (W step)^2 / 12 of what is added, 2 % of w/W of the motion.
    assert np.max(np.abs(true - recorded)) > 10.0 * 2e-3 * corner
    np.testing.assert_allclose(there(motion, t).a_x, true, rtol=0.0, atol=2e-3 * corner)


def test_of_a_sine_pulse_what_is_added_is_its_velocity() -> None:
    """By hand: a sin(W t) has the velocity (a/W)(1 - cos(W t)); afterwards it is at rest, as the record says."""
    pulse = OneSinePulse(3.0, 0.8)
    motion = LearnedCoupling(0.2).base_motion(pulse, (0.0, 2.0), 9.81)
    W = 2.0 * math.pi / 0.8
    t = np.linspace(0.0, 0.799, 200)
    expected = 3.0 * np.sin(W * t) + 2.0 * math.pi * 0.2 * 3.0 / W * (1.0 - np.cos(W * t))
    np.testing.assert_allclose(there(motion, t).a_x, expected, rtol=0.0, atol=1e-4)
    np.testing.assert_allclose(there(motion, np.linspace(0.85, 2.0, 50)).a_x, 0.0, atol=1e-4)
    assert np.all(there(motion, t).a_z == 0.0)


def test_of_a_record_that_begins_and_ends_at_once_what_is_added_rises_within_it() -> None:
    """By hand: 1 m/s^2 for 2 s has the velocity t, so that 1 + w t was there; the record says nothing of later."""
    motion = LearnedCoupling(0.4).base_motion(SampledMotion(STEP, np.ones(501)), (0.0, 4.0), 9.81)
    t = np.linspace(0.0, 2.0, 101)
    np.testing.assert_allclose(there(motion, t).a_x, 1.0 + 2.0 * math.pi * 0.4 * t, rtol=0.0, atol=1e-9)
    assert not there(motion, np.linspace(2.0 + STEP, 4.0, 50)).a_x.any()


def test_without_a_corner_it_is_the_record() -> None:
    recorded = SampledMotion(STEP, np.sin(STEP * np.arange(500)))
    assert LearnedCoupling().base_motion(recorded, (0.0, 2.0), 9.81) is recorded


def test_beside_a_gain_and_a_late_clock_the_order_in_which_they_are_given_does_not_matter() -> None:
    recorded = SampledMotion(STEP, np.sin(2.0 * math.pi * 3.0 * STEP * np.arange(1500)))
    effects = [load("base_motion_gain")(gain=1.2), LearnedCoupling(0.3), load("base_motion_lag")(lag=0.2)]
    t = np.linspace(2.0, 5.0, 151)
    one, other = (there(base_with(recorded, e, (0.0, 5.0), 9.81), t).a_x for e in (effects, effects[::-1]))
    np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-9)
    alone = there(base_with(recorded, effects[1:2], (0.0, 6.0), 9.81), t + 0.2).a_x
    np.testing.assert_allclose(one, 1.2 * alone, rtol=0.0, atol=1e-4)


@pytest.mark.parametrize("corner", [-0.1, 1000.0])
def test_what_is_no_corner_is_refused(corner: float) -> None:
    with pytest.raises(ValueError, match=r"learned_coupling.corner_frequency=.* Hz: want 0 to 100"):
        LearnedCoupling(corner)
