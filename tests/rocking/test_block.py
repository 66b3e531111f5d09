"""The block: its geometry, its mass and the constants of rocking."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rocking import G_STANDARD, WOOD_DENSITY, Block, Method1, Method2

SIZES = st.floats(0.01, 20.0)


def test_half_diagonal_of_a_three_four_five_block_is_two_and_a_half() -> None:
    block = Block(b=3.0, h=4.0)
    assert abs(block.R - 2.5) < 1e-15


def test_slenderness_angle_is_measured_from_the_vertical() -> None:
    # tan(alpha) = b/h; b/h = 1/sqrt(3) is 30 degrees, not 60.
    assert Block(b=1.0, h=math.sqrt(3.0)).alpha == pytest.approx(math.pi / 6.0, rel=1e-15)


# Riemann sums of r^2 dm over a grid of cells.  Midpoint cells miss (b^2 + h^2)/(12 n^2) of m/12 (b^2 + h^2): 1/n^2.
@pytest.mark.parametrize(("b", "h"), [(0.2, 0.8), (0.3, 1.0), (1.5, 0.4)])
def test_moments_of_inertia_equal_the_sum_over_small_cells(b: float, h: float) -> None:
    n = 1000
    block = Block(b=b, h=h, d=0.5, density=700.0)
    x = (np.arange(n) + 0.5) / n * b
    z = (np.arange(n) + 0.5) / n * h
    cell = 700.0 * 0.5 * b * h / n**2
    about_corner = cell * n * (np.sum(x**2) + np.sum(z**2))
    about_centre = cell * n * (np.sum((x - b / 2) ** 2) + np.sum((z - h / 2) ** 2))
    np.testing.assert_allclose(block.I_O, about_corner, rtol=1.0 / n**2)
    np.testing.assert_allclose(block.I_c, about_centre, rtol=1.1 / n**2)


# Housner (1963): p^2 = 3 g / (4 R) for a uniform rectangle.
@given(b=SIZES, h=SIZES, g=st.floats(1.0, 30.0))
def test_frequency_parameter_is_three_g_over_four_R(b: float, h: float, g: float) -> None:
    R = 0.5 * math.sqrt(b * b + h * h)
    assert Block(b=b, h=h).p(g) ** 2 == pytest.approx(0.75 * g / R, rel=1e-13)


def test_frequency_parameter_takes_standard_gravity_unless_told() -> None:
    # CGPM 1901: 9.80665 m/s^2.
    assert G_STANDARD == 9.80665
    assert Block(b=0.6, h=0.8).p() ** 2 == pytest.approx(0.75 * 9.80665 / 0.5, rel=1e-14)


def test_frequency_parameter_knows_neither_depth_nor_density() -> None:
    assert Block(b=0.2, h=0.8, d=3.0, density=2500.0).p() == pytest.approx(Block(b=0.2, h=0.8).p(), rel=1e-15)


# Housner (1963): angular momentum about the corner that lands is kept.  Written out: before the impact the block turns
# about the old corner with omega = 1, so the centre of mass moves with R in a direction square to its arm from there;
# L = I_c + arm x velocity about the new corner; after it L = (I_c + R^2) e, per unit mass.
@given(b=SIZES, h=SIZES)
def test_housner_restitution_keeps_angular_momentum_about_the_new_corner(b: float, h: float) -> None:
    R2 = 0.25 * (b * b + h * h)
    I_c = (b * b + h * h) / 12.0
    # Clockwise spin 1 about the old corner: the centre, at (-b/2, h/2) from the old +x corner, has velocity (h/2, b/2).
    velocity = (0.5 * h, 0.5 * b)
    arm = (0.5 * b, 0.5 * h)  # from the new corner, at -x
    momentum = I_c + arm[1] * velocity[0] - arm[0] * velocity[1]
    assert Block(b=b, h=h).housner_restitution == pytest.approx(momentum / (I_c + R2), abs=1e-14)


def test_housner_restitution_vanishes_at_a_breadth_of_sqrt_two_heights() -> None:
    assert Block(b=math.sqrt(2.0), h=1.0).housner_restitution == pytest.approx(0.0, abs=1e-15)


# Winkler, Meguro & Yamazaki (1995), Table 1 and section on numerical stability: Block 4, 7.5 x 25 x 12.5 cm, weighs
# 1.4 kg; the paper prints two digits.
def test_block_4_of_the_paper_weighs_one_point_four_kilograms() -> None:
    assert WOOD_DENSITY == 597.0
    assert Block(b=0.075, h=0.25, d=0.125).mass == pytest.approx(1.4, abs=0.05)
    assert Block(b=0.2, h=0.8, d=0.5, density=1000.0).mass == pytest.approx(80.0, rel=1e-14)


def test_a_block_cannot_be_changed() -> None:
    with pytest.raises(AttributeError):
        Block(b=0.2, h=0.8).b = 0.3  # type: ignore[misc]


# 2 ** -24 is the rounding of 32 bits; what is computed in them is that far off.
def test_a_size_of_32_bits_is_taken_as_the_number_that_it_is_and_computed_with_in_64() -> None:
    short, full = Block(np.float32(0.3), np.float32(0.7)), Block(float(np.float32(0.3)), float(np.float32(0.7)))
    assert short == full and repr(short) == repr(full)
    for name in ("mass", "R", "alpha", "I_c", "I_O", "housner_restitution"):
        assert type(getattr(short, name)) is float
        assert getattr(short, name) == getattr(full, name)
    assert short.p(9.81) == full.p(9.81)


@pytest.mark.parametrize("method", [Method1, Method2])
def test_coefficients_of_32_bits_leave_the_parameters_in_64(method: Any) -> None:
    given = {"g": 9.81, "rest_speed": 1e-5} | ({"restitution": 0.9} if method is Method1 else {"friction": 0.3})
    short = {name: np.float32(value) for name, value in given.items()}
    system = method(Block(0.2, 0.8), **short)
    assert system.parameters == method(Block(0.2, 0.8), **{k: float(v) for k, v in short.items()}).parameters
    assert {type(value) for value in system.parameters} == {float}
