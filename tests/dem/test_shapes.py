"""Area, moments and tilts of balance of convex polygons."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import dem

LENGTHS = st.floats(0.01, 10.0)


@given(b=LENGTHS, h=LENGTHS)
def test_rectangle_matches_closed_forms(b, h):
    shape = dem.rectangle(b, h)
    # Sums of four products: a few roundings.
    assert shape.area == pytest.approx(b * h, rel=1e-14)
    assert shape.second_moment == pytest.approx(b * h * (b * b + h * h) / 12.0, rel=1e-14)
    assert shape.radius == pytest.approx(math.hypot(b, h) / 2.0, rel=1e-14)
    assert shape.theta_c == pytest.approx((math.atan(b / h),) * 2, rel=1e-13)
    assert np.array_equal(shape.corners[:, 0], -shape.corners[[1, 0, 3, 2], 0])


@given(base=LENGTHS, height=LENGTHS, shift=st.floats(-5.0, 5.0))
def test_isosceles_triangle_matches_closed_forms_wherever_it_lies(base, height, shift):
    shape = dem.polygon([[shift, shift], [shift + base, shift], [shift + base / 2, shift + height]])
    # Centroid at a third of the height; polar moment b h (3 b^2 + 4 h^2)/144. The shift costs 5/0.01 in rounding.
    assert shape.corners[0] == pytest.approx([-base / 2, -height / 3], rel=1e-11, abs=1e-13)
    assert shape.second_moment == pytest.approx(base * height * (3 * base**2 + 4 * height**2) / 144.0, rel=1e-10)


def test_sense_of_turning_does_not_matter():
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    assert np.array_equal(
        np.sort(dem.polygon(square).corners, axis=0), np.sort(dem.polygon(square[::-1]).corners, axis=0)
    )


def test_balance_is_over_each_end_of_the_base_by_itself():
    shape = dem.polygon([[0, 0], [1, 0], [1, 2], [0.5, 2]])
    (left, bottom), (right, _) = shape.corners[0], shape.corners[1]
    assert shape.theta_c == pytest.approx((math.atan2(right, -bottom), math.atan2(-left, -bottom)), rel=1e-14)


def test_balance_lies_on_the_next_corner_where_the_body_rolls_over_the_first():
    # A regular octagon balances over each corner half a side's turn, pi/8, on.
    angles = math.pi * (np.arange(8) + 0.5) / 4.0
    octagon = np.column_stack([np.sin(angles), np.cos(angles)])
    assert dem.polygon(octagon).theta_c == pytest.approx((math.pi / 8.0,) * 2, rel=1e-12)
    # A shallow cut, flat at atan(0.1), hands the block over to the second corner before it balances on the first.
    block = dem.polygon([[0.0, 0.0], [0.9, 0.0], [1.0, 0.01], [1.0, 2.0], [0.0, 2.0]])
    first, second = block.corners[1:3]
    assert math.atan2(first[0], -first[1]) > math.atan(0.1)
    assert block.theta_c[0] == pytest.approx(math.atan2(second[0], -second[1]), rel=1e-12)


def test_mass_and_inertia_of_a_block():
    scene = dem.single_block(0.15, 0.5, 0.25, 597.0)
    assert scene.mass == pytest.approx(597.0 * 0.15 * 0.5 * 0.25, rel=1e-14)
    assert scene.inertia == pytest.approx(scene.mass * (0.15**2 + 0.5**2) / 12.0, rel=1e-14)


@pytest.mark.parametrize(
    ("vertices", "message"),
    [
        ([[0, 0], [1, 0]], "at least 3 corners"),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0]], r"shape \(3, 3\)"),
        ([[0, 0], [1, 0], [1, math.nan]], "finite"),
        ([[0, 0], [1, 0], [0.2, 0.2], [0, 1]], "convex"),
        ([[0, 0], [1, 1], [1, 0], [0, 1]], "convex"),
        ([[0, 0], [0.5, 0], [1, 0], [1, 1]], "convex"),
        ([[0, 0], [1, 0], [1, 0], [1, 1]], "convex"),
        ([[0, 0], [1, 1], [-1, 1]], "flat lowest side"),
        ([[0, 0], [0.1, 0], [3, 1], [2.9, 1]], "below the centroid"),
    ],
)
def test_polygon_refuses_what_cannot_stand(vertices, message):
    with pytest.raises(ValueError, match=message):
        dem.polygon(vertices)


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf])
@pytest.mark.parametrize("place", range(4))
def test_block_refuses_bad_sizes_by_name(place, bad):
    sizes = [0.15, 0.5, 0.25, 597.0]
    sizes[place] = bad
    with pytest.raises(ValueError, match=f"^{('b', 'h', 'd', 'density')[place]}={bad}"):
        dem.single_block(*sizes)
