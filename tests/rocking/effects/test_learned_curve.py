"""The learned curve, and those of damping and friction, against SciPy's natural splines."""

import math

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from rocking import Block, Method1, solve
from rocking.effects import load
from rocking.effects.learned_curve import COUNT, EVEN, MOST, ODD, LearnedCurve, curve, numbers, torque
from rocking.form import Form
from rocking.hybrid import Base

FORM = Form.__new__(Form)  # the coefficients do not depend on the block
STILL = Base(0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("n", [1, 4, MOST])
def test_a_curve_is_the_natural_spline_through_its_values_at_the_knots(n: int) -> None:
    """SciPy's spline with zero second derivatives at both ends, through the curve's own values at the knots."""
    rng, reach = np.random.default_rng(n), 0.23
    coefficients = tuple(rng.normal(size=n + 1))
    own = numbers(reach, coefficients)
    assert len(own) == COUNT
    knots, phi = np.linspace(0.0, reach, n + 1), np.linspace(0.0, reach, 200)
    there = curve(np, knots, own, 0)
    # At its ends the value is the coefficient; a straight line stays one.
    assert there[[0, -1]] == pytest.approx([coefficients[0], coefficients[-1]], rel=1e-12)
    if n > 1:
        spline = make_interp_spline(knots, there, k=3, bc_type="natural")
        np.testing.assert_allclose(curve(np, phi, own, 0), spline(phi), rtol=0.0, atol=1e-11)
    else:
        np.testing.assert_allclose(curve(np, phi, own, 0), np.interp(phi, knots, there), rtol=0.0, atol=1e-12)
    np.testing.assert_array_equal(curve(np, np.array([reach, 2.0 * reach]), own, 0), [there[-1], there[-1]])


@pytest.mark.parametrize(
    ("name", "kind", "end"), [("learned_damping", "damping", "reach"), ("learned_friction", "friction", "high")]
)
def test_a_curve_from_end_to_end_has_a_shape_of_its_own_on_either_side(name: str, kind: str, end: str) -> None:
    """SciPy's spline through the values at the knots, on both sides of upright, and its ends beyond them.

    At 1,000 rad/s, where a friction is smooth by less than rounding; a damping goes with the speed.
    """
    low, high, speed = -0.05, 0.15, 1e3
    coefficients = {f"{kind}_{j}": value for j, value in enumerate((0.4, -0.1, 0.3, -0.2, 0.1))}
    effect = load(name)(**{"low": low, end: high, "intervals": 4.0, **coefficients})
    scale, knots = speed if kind == "damping" else 1.0, np.linspace(low, high, 5)

    def found(theta: float) -> float:
        return float(effect.acceleration(np, theta, speed, np.sign(theta), STILL, effect.values(FORM)) / scale)

    spline = make_interp_spline(knots, [found(x) for x in knots], k=3, bc_type="natural")
    for theta in np.linspace(low, high, 41):
        assert found(theta) == pytest.approx(float(spline(theta)), abs=1e-12)
    # The coefficients at the ends are the values there.
    assert found(-0.4) == found(low) == pytest.approx(0.4, rel=1e-12)
    assert found(0.4) == found(high) == pytest.approx(0.1, rel=1e-12)


def test_one_curve_is_alike_on_both_sides_and_the_other_has_one_sign() -> None:
    odd = LearnedCurve(**dict.fromkeys(ODD, 0.3)).values(FORM)
    even = LearnedCurve(**dict.fromkeys(EVEN, 0.3)).values(FORM)
    for theta, s in ((0.1, 1.0), (-0.1, -1.0)):
        assert torque(np, theta, 2.0, s, STILL, odd) == pytest.approx(0.3 * s, rel=1e-12)
        assert torque(np, theta, 2.0, s, STILL, even) == pytest.approx(0.3, rel=1e-12)


def test_a_straight_odd_curve_is_a_spring() -> None:
    """theta'' += -k theta, as the learned term's spring has it: the same run."""
    block, k = Block(b=0.2, h=0.8), 0.7
    line = {name: -k * j / MOST * 0.2 for j, name in enumerate(ODD)}
    system = Method1(block)
    one = solve(system, theta=0.15, t_end=2.0, effects=[LearnedCurve(odd_reach=0.2, **line)], save_at=[0.5, 1.0, 2.0])
    other = solve(system, theta=0.15, t_end=2.0, effects=[load("learned_term")(spring=-k)], save_at=[0.5, 1.0, 2.0])
    np.testing.assert_allclose(one.theta, other.theta, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"odd_intervals": 2.5}, r"learned_curve.odd_intervals=2.5: want a whole number"),
        ({"odd_intervals": 2.0, "odd_3": 0.1}, r"learned_curve.odd_3=0.1 rad/s\^2: want none beyond odd_2"),
        ({"even_intervals": 17.0}, r"learned_curve.even_intervals=17.0 1: want 1 to 16"),
        ({"even_reach": 0.0}, r"learned_curve.even_reach=0.0 rad: want 1e-06 to 1.5708"),
        ({"odd_0": math.nan}, r"learned_curve.odd_0=nan rad/s\^2: want a number"),
    ],
)
def test_what_is_no_curve_is_refused(given: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        LearnedCurve(**given)


def test_a_curve_tells_the_parameters_that_are_given() -> None:
    assert repr(LearnedCurve(odd_reach=0.2, odd_3=-0.5)) == "LearnedCurve(odd_reach=0.2, odd_3=-0.5)"
    assert repr(LearnedCurve()) == "LearnedCurve()"
