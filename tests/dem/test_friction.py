"""Steady loads: lever rule under the corners, sliding and tipping of a base that accelerates evenly."""

import numpy as np
import pytest

import dem

G = 9.80665


def steady(a_x, rise=0.0):
    """a_x, reached in `rise` seconds."""

    def motion(t):
        return a_x * (np.minimum(t / rise, 1.0) if rise else np.ones_like(t)), np.zeros_like(t)

    return motion


# Lever rule: moments about the corners of a base of breadth b with the load at x_l from its middle.
@pytest.mark.parametrize("cut", [0.0, 0.06, 0.12])
def test_off_centre_centroid_settles_to_the_lever_rule(overlaps, cut):
    b, h = 0.15, 0.5
    scene = dem.single_polygon([[0, 0], [b, 0], [b, h], [cut, h]], 0.25, 597.0)
    left, right = scene.shape.corners[:2, 0]
    x_l = -0.5 * (left + right)
    history = dem.simulate(scene, t_end=0.5, dt=2e-5, mu=0.5, damping_ratio=0.3)
    under = overlaps(history)
    assert history.outcome is dem.Outcome.AT_REST
    # The settled tilt, m g/(kn b) or 4e-5 rad, moves the centroid by 1e-5 m: 1e-4 of b/2 - x_l.
    assert under[1] / under[0] == pytest.approx((b / 2 + x_l) / (b / 2 - x_l), rel=1e-3)


@pytest.mark.parametrize("share", [-0.9, -0.4, 0.4, 0.9])
def test_steady_acceleration_settles_to_the_lever_rule(block, overlaps, share):
    b, h, a_x = 0.15, 0.5, share * 0.3 * G
    x_l = -a_x * h / (2.0 * G)  # the line of the resultant of gravity and inertia
    history = dem.simulate(block(3), steady(a_x, 0.2), t_end=1.0, dt=2e-5, mu=0.8, damping_ratio=0.3)
    under = overlaps(history)
    # As above; x_l may come as near as b/20 to the corner: 2e-3 there.
    assert under[1] / under[0] == pytest.approx((b / 2 + x_l) / (b / 2 - x_l), rel=3e-3)


def test_block_stands_below_the_friction_limit(block):
    history = dem.simulate(block(3), steady(0.99 * 0.2 * G, 0.2), t_end=1.0, dt=2e-5, mu=0.2, damping_ratio=0.3)
    assert history.outcome is dem.Outcome.AT_REST
    # F/(2 ks) = 6e-7 m and the tilt of the springs times h/2, 6e-6 m. The corners share the shear unevenly while it
    # rises, so one may slip by as little as the other's spring gives.
    assert abs(history.x[-1]) < 1e-5


@pytest.mark.parametrize("sign", [-1, 1])
def test_block_slides_with_the_acceleration_above_mu_g(block, sign):
    a_x = sign * 0.25 * G
    history = dem.simulate(block(3), steady(a_x), t_end=1.0, dt=1e-5, mu=0.2, damping_ratio=0.3, save_every=1000)
    late = history.time > 0.2
    acceleration = 2.0 * np.polyfit(history.time[late], history.x[late], 2)[0]
    # Relative to the base -(a_x - mu g), and nothing is fitted; 1e-5: the stick of the first step or two.
    assert acceleration == pytest.approx(-(a_x - sign * 0.2 * G), rel=1e-4)
    assert history.mode_seconds[dem.Mode.SLIDE] > 0.95


@pytest.mark.parametrize("sign", [-1, 1])
def test_block_tips_at_b_over_h_times_g_and_against_the_acceleration(block, sign):
    def run(share):
        return dem.simulate(
            block(3), steady(sign * share * 0.3 * G, 1.0), t_end=6.0, dt=2e-5, mu=2.0, damping_ratio=0.5
        )

    # The springs' tilt of 4e-5 rad, and the corner that has moved in, lower the limit by about 3e-4.
    assert run(0.998).outcome is dem.Outcome.AT_REST
    fallen = run(1.002)
    assert (fallen.outcome, fallen.side) == (dem.Outcome.OVERTURNED, -sign)


def test_block_without_friction_keeps_its_place_in_space(block):
    history = dem.simulate(block(3), steady(2.0), t_end=0.5, dt=1e-5, mu=0.0, damping_ratio=0.3)
    assert history.x[-1] == pytest.approx(-0.5 * 2.0 * 0.5**2, rel=1e-9)  # x'' = -a_x; rounding of 50,000 sums


def test_a_base_that_is_fast_by_its_own_acceleration_is_no_instability(block):
    # 200 m/s, many times what a fall from its own height or the springs could give the block.
    history = dem.simulate(block(3), steady(400.0), t_end=0.5, dt=1e-5, mu=0.0, damping_ratio=0.3)
    assert (history.outcome, history.end_time) == (dem.Outcome.MOVING, pytest.approx(0.5))
    assert history.x[-1] == pytest.approx(-0.5 * 400.0 * 0.5**2, rel=1e-9)


def test_a_flat_landing_takes_no_more_momentum_than_mu_times_the_normal_impulse(block):
    # Coulomb for impulses: while it slides, change of v_x = mu (change of v_z), whatever spring and dashpot do.
    history = dem.simulate(
        block(1), t_end=5e-3, dt=1e-6, mu=0.1, damping_ratio=0.5, gap0=2e-4, vz0=-0.4, vx0=3.0, g=1e-9, save_every=1
    )
    v_x, v_z = (np.diff(values[[0, 1, -2, -1]])[[0, 2]] / 1e-6 for values in (history.x, history.z))
    # The moment of friction lets the corners land unevenly; the centroid's momentum does not care. 1e-6: rounding of
    # differences of positions over one step.
    assert v_x[0] - v_x[1] == pytest.approx(0.1 * (v_z[1] - v_z[0]), rel=1e-6)
