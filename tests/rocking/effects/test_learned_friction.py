"""The learned friction against that of the learned term; its curve is held in test_learned_curve."""

import math

import numpy as np
import pytest

from rocking import Block, Method1, solve
from rocking.effects import load
from rocking.effects.learned_curve import MOST
from rocking.effects.learned_friction import LearnedFriction, torque
from rocking.form import Form
from rocking.hybrid import Base

FORM = Form.__new__(Form)  # the coefficients do not depend on the block
STILL = Base(0.0, 0.0, 0.0, 0.0)


def test_it_is_against_the_motion_and_smooth_about_rest() -> None:
    """By hand: f(omega) is 1/sqrt(2) at the speed over which it is smoothed."""
    effect = LearnedFriction(low=-0.05, high=0.15, intervals=1.0, friction_0=0.4, friction_1=-0.1)
    fast, back, slow = (
        torque(np, 0.02, omega, 1.0, STILL, effect.values(FORM)) for omega in (50.0, -50.0, 3e-5)
    )  # fmt: skip
    assert back == -fast != 0.0
    assert slow == pytest.approx(fast / math.sqrt(2.0), rel=1e-9)


@pytest.mark.parametrize("ends", [(0.2, -0.2), (-0.3, -0.1)])
def test_one_interval_is_a_straight_line(ends: tuple[float, float]) -> None:
    effect = LearnedFriction(low=-0.2, high=0.2, intervals=1.0, friction_0=ends[0], friction_1=ends[1])
    for theta in (-0.1, 0.03, 0.2):
        by_hand = 0.5 * (ends[0] + ends[1]) + 0.5 * (ends[1] - ends[0]) * theta / 0.2
        assert torque(np, theta, 1e3, 1.0, STILL, effect.values(FORM)) == pytest.approx(by_hand, abs=1e-9)


def test_a_constant_curve_is_the_friction_of_the_learned_term() -> None:
    """By another effect's code: the same run through impacts."""
    effect = LearnedFriction(low=-0.2, high=0.2, intervals=1.0, friction_0=-0.3, friction_1=-0.3)
    save_at = [0.3, 0.8, 1.5]
    system = Method1(Block(b=0.2, h=0.8))
    one = solve(system, theta=0.15, t_end=1.5, effects=[effect], save_at=save_at)
    other = solve(system, theta=0.15, t_end=1.5, effects=[load("learned_term")(friction=-0.3)], save_at=save_at)
    assert len(one.impact_times) > 1
    np.testing.assert_allclose(one.theta, other.theta, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"intervals": 2.5}, r"learned_friction.intervals=2.5: want a whole number"),
        (
            {"intervals": 2.0, "friction_3": 0.1},
            r"learned_friction.friction_3=0.1 .*: want none beyond friction_2",
        ),
        ({"intervals": MOST + 1.0}, r"learned_friction.intervals=17.0 1: want 1 to 16"),
        ({"low": 0.3, "high": 0.2}, r"learned_friction.low=0.3 rad: want less than high=0.2"),
        ({"friction_0": math.nan}, r"learned_friction.friction_0=nan rad/s\^2: want a number"),
    ],
)
def test_what_is_no_curve_is_refused(given: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        LearnedFriction(**given)


def test_it_tells_the_parameters_that_are_given() -> None:
    assert repr(LearnedFriction(high=0.2, friction_3=-0.5)) == "LearnedFriction(high=0.2, friction_3=-0.5)"
