"""A push at given times against SciPy's splines, and against a base that moves so (rocking.effects.learned_push)."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

from excitation import SampledMotion
from rocking import Block, Method1, solve
from rocking.effects import base_with, load
from rocking.effects.learned_push import MOST, LearnedPush, course
from rocking.motion import base_at

STEP = 0.005


def still(seconds: float) -> SampledMotion:
    return SampledMotion(STEP, np.zeros(round(seconds / STEP) + 1))


def felt(motion: object, t: np.ndarray) -> np.ndarray:
    return np.asarray(base_at(np, motion, t, np.asarray(motion.parameters)).a_x) + 0.0 * t  # type: ignore[attr-defined]


def test_it_is_a_cubic_spline_of_the_time_since_the_beginning() -> None:
    """SciPy's B-spline on knots an interval apart, of a run that begins at 2 s."""
    h, c = 0.3, np.array([0.4, -0.2, 0.7, 0.0, 0.5])
    push = LearnedPush(interval=h, **{f"push_{j}": value for j, value in enumerate(c)})
    spline = BSpline(h * np.arange(-6, c.size + 4), np.concatenate([np.zeros(3), c, np.zeros(3)]), 3)
    t = np.linspace(0.0, h * (c.size - 0.001), 400)
    np.testing.assert_allclose(course(push, t), spline(t), rtol=1e-12, atol=1e-14)
    moved = push.base_motion(still(9.0), (2.0, 9.0), 9.81)
    # Between samples, of which there are four in an interval, lies a cubic of their values and slopes.
    np.testing.assert_allclose(felt(moved, 2.0 + t), spline(t), rtol=0.0, atol=5e-4)
    assert not felt(moved, np.linspace(0.0, 1.99, 50)).any() and not felt(moved, np.linspace(4.2, 9.0, 50)).any()


def test_a_block_that_is_pushed_moves_as_on_a_base_that_is_accelerated() -> None:
    """Through liftoff and impacts; another motion's samples are 60 to an interval."""
    block, e = Block(0.2, 0.6, 0.3, 2000.0), 0.92
    push = LearnedPush(interval=0.3, push_1=4.0, push_2=6.0, push_4=-5.0)
    t = STEP * np.arange(601)
    save_at = np.linspace(0.1, 3.0, 59)
    by_push = solve(Method1(block, e), still(3.0), t_end=3.0, save_at=save_at, effects=[push])
    by_base = solve(Method1(block, e), SampledMotion(STEP, course(push, t)), t_end=3.0, save_at=save_at)
    assert np.max(np.abs(by_base.theta)) > 0.01 and by_base.theta[np.argmax(np.abs(by_base.theta) > 1e-3)] < 0.0
    np.testing.assert_allclose(by_push.theta, by_base.theta, rtol=0.0, atol=2e-4 * np.max(np.abs(by_base.theta)))


@pytest.mark.parametrize("share", [0.9, 1.0, 1.1])
def test_a_steady_force_through_the_centre_of_mass_holds_a_block_that_leans(share: float) -> None:
    """Moments about the corner, by hand: m g R sin(alpha - theta) = F R cos(alpha - theta), F to the side of the lean.

    What pushes less lets it fall back, what pushes more tips it over.
    """
    block, lean = Block(0.2, 0.6, 0.3, 2000.0), 0.1
    method = Method1(block)
    force_over_mass = share * method.g * np.tan(block.alpha - lean)  # to +x
    push = LearnedPush(interval=0.1, **{f"push_{j}": -force_over_mass for j in range(20)})
    end = solve(method, still(0.4), t_end=0.4, theta=lean, save_at=[0.4], effects=[push]).theta[0]
    if share == 1.0:
        assert end == pytest.approx(lean, abs=1e-7)
    else:
        assert (end - lean) * (share - 1.0) > 1e-4


def test_it_acts_along_a_floor_that_is_tilted_too_in_whatever_order_they_are_given() -> None:
    effects = [load("base_tilt")(angle=0.1), LearnedPush(interval=0.2, push_3=1.5)]
    t = np.linspace(0.0, 2.0, 101)
    one, other = (felt(base_with(still(2.0), e, (0.0, 2.0), 9.81), t) for e in (effects, effects[::-1]))
    np.testing.assert_array_equal(one, other)
    pushed = felt(base_with(still(2.0), effects[1:], (0.0, 2.0), 9.81), t)
    np.testing.assert_allclose(one, pushed * np.cos(0.1) - 9.81 * np.sin(0.1), rtol=1e-12)


def test_a_share_of_it_acts_where_the_base_is_at_rest() -> None:
    """The base of a release whose sensor recorded noise is at rest too, one that is shaken is not."""
    push = LearnedPush(interval=0.2, at_rest=0.25, still=0.1, push_3=1.5)
    t = np.linspace(0.0, 2.0, 101)
    noise = SampledMotion(STEP, 0.02 * np.random.default_rng(1).standard_normal(401))
    shaking = SampledMotion(STEP, 0.2 * np.sin(STEP * np.arange(401)))
    for below, share in ((still(2.0), 0.25), (noise, 0.25), (shaking, 1.0)):
        pushed = felt(push.base_motion(below, (0.0, 2.0), 9.81), t) - felt(below, t)
        np.testing.assert_allclose(pushed, share * course(push, t), atol=4e-3)


def test_without_a_coefficient_it_is_the_motion() -> None:
    motion = still(1.0)
    assert LearnedPush(interval=0.5).base_motion(motion, (0.0, 1.0), 9.81) is motion


@pytest.mark.parametrize("interval", [0.0, -0.1, float("nan")])
def test_what_is_no_interval_is_refused(interval: float) -> None:
    with pytest.raises(ValueError, match=r"learned_push.interval=.* s: want 0.001 to 1000"):
        LearnedPush(interval=interval)


def test_it_tells_the_coefficients_that_are_given() -> None:
    assert repr(LearnedPush(interval=0.2, push_5=0.3)) == "LearnedPush(interval=0.2, push_5=0.3)"
    assert len(LearnedPush.parameter_names()) == MOST + 3
