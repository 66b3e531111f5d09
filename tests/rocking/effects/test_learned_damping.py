"""The learned damping against viscous damping and the curve that it takes (rocking.effects.learned_damping)."""

import math

import numpy as np
import pytest

from rocking import Block, Method1, solve
from rocking.effects import load
from rocking.effects.learned_curve import MOST, curve, numbers
from rocking.effects.learned_damping import DAMPING, LearnedDamping, torque
from rocking.form import Form
from rocking.hybrid import Base

FORM = Form.__new__(Form)  # the coefficients do not depend on the block
STILL = Base(0.0, 0.0, 0.0, 0.0)


def test_it_is_the_curve_at_the_rotation_on_either_side_times_the_speed() -> None:
    """The curve itself is held against SciPy's splines in test_learned_curve."""
    coefficients = (0.4, -0.1, 0.3)
    effect = LearnedDamping(reach=0.1, intervals=2.0, **dict(zip(DAMPING, coefficients, strict=False)))
    for theta, omega in ((0.03, 0.7), (-0.03, 0.7), (0.08, -0.2), (-0.3, -0.2)):
        found = torque(np, theta, omega, np.sign(theta), STILL, effect.values(FORM))
        assert found == pytest.approx(omega * curve(np, abs(theta), numbers(0.1, coefficients), 0), rel=1e-12)


def test_it_goes_with_the_speed() -> None:
    effect = LearnedDamping(low=-0.05, reach=0.15, intervals=1.0, damping_0=0.4, damping_1=-0.1)
    one, other = (torque(np, 0.02, omega, 1.0, STILL, effect.values(FORM)) for omega in (1.0, -0.7))
    assert other == pytest.approx(-0.7 * one, rel=1e-12) and one != 0.0


@pytest.mark.parametrize("low", [0.0, -0.2])
def test_a_constant_curve_is_viscous_damping(low: float) -> None:
    """theta'' += -c omega, by another effect's code: the same run through impacts."""
    system, c = Method1(Block(b=0.2, h=0.8)), 0.4
    same = LearnedDamping(low=low, reach=0.1, **dict.fromkeys(DAMPING, -c))
    save_at = [0.3, 0.8, 1.5]
    one = solve(system, theta=0.15, t_end=1.5, effects=[same], save_at=save_at)
    other = solve(system, theta=0.15, t_end=1.5, effects=[load("viscous_damping")(coefficient=c)], save_at=save_at)
    assert len(one.impact_times) > 1
    np.testing.assert_allclose(one.theta, other.theta, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"intervals": 2.5}, r"learned_damping.intervals=2.5: want a whole number"),
        ({"intervals": 2.0, "damping_3": 0.1}, r"learned_damping.damping_3=0.1 1/s: want none beyond damping_2"),
        ({"intervals": MOST + 1.0}, r"learned_damping.intervals=17.0 1: want 1 to 16"),
        ({"low": 0.1}, r"learned_damping.low=0.1 rad: want -1.5708 to 0"),
        ({"reach": 0.0}, r"learned_damping.reach=0.0 rad: want 1e-06 to 1.5708"),
        ({"damping_0": math.nan}, r"learned_damping.damping_0=nan 1/s: want a number"),
    ],
)
def test_what_is_no_curve_is_refused(given: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        LearnedDamping(**given)


def test_it_tells_the_parameters_that_are_given() -> None:
    assert repr(LearnedDamping(reach=0.2, damping_3=-0.5)) == "LearnedDamping(reach=0.2, damping_3=-0.5)"
