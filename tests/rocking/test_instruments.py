"""Markers and accelerometers on the block."""

import math

import numpy as np
import pytest

from excitation import RampedSinusoid
from rocking import Block, Method1, Method2, Mode, solve
from rocking.instruments import accelerometer, marker

G = 9.81
BLOCK = Block(0.2, 0.8)
POINT = (0.07, 0.65)


def test_at_rest_upright_the_vertical_axis_reads_g_and_the_horizontal_the_base():
    motion = RampedSinusoid(2.0, 10.0, 2.0)  # (b/h) g = 2.45 m/s^2 is never reached
    run = solve(Method1(BLOCK, g=G), motion, t_end=10.0, save_at=np.linspace(0.0, 9.9, 500))
    assert np.all(run.mode == Mode.REST)
    assert accelerometer(run, POINT, (0.0, 1.0)) == pytest.approx(np.full(500, G), abs=1e-14)
    assert accelerometer(run, POINT, (2.0, 0.0)) == pytest.approx(motion(run.t)[0], abs=1e-14)
    assert marker(run, POINT)[0] == pytest.approx(np.full(500, 0.07), abs=1e-15)


@pytest.mark.parametrize("theta", [0.1, -0.1])
def test_balanced_in_a_lean_it_reads_gravity_alone(theta):
    # A lean of alpha is the (unstable) balance: +X reads -g sin(theta), +Z g cos(theta), whatever the point.
    lean = math.copysign(BLOCK.alpha, theta)
    run = solve(Method1(BLOCK, g=G), theta=lean, t_end=0.01, save_at=[0.0])
    assert accelerometer(run, POINT, (1.0, 0.0)) == pytest.approx([-G * math.sin(lean)], abs=1e-12)
    assert accelerometer(run, POINT, (0.0, 1.0)) == pytest.approx([G * math.cos(lean)], abs=1e-12)


def moving(name):
    """Runs that rock, slide, slide while rocking, and fly; sampled finely."""
    motion = RampedSinusoid(3.0, 3.0, 12.0)
    t = np.arange(0.0, 2.4, 1e-4)
    if name == "method1":
        return solve(Method1(BLOCK, g=G), motion, t_end=2.5, save_at=t)
    if name == "slides":
        return solve(Method2(BLOCK, friction=0.15, g=G), motion, t_end=2.5, save_at=t)
    if name == "rocks and slides":
        return solve(Method2(Block(0.3, 0.8), friction=0.35, g=G), motion, theta=0.2, t_end=2.5, save_at=t)
    system = Method2(BLOCK, friction=0.5, normal_restitution=0.4, g=G)
    return solve(system, motion, initial=system.initial_state(0.1, 0.7, u=0.3, z=0.3), t_end=2.5, save_at=t)


MODES_SEEN = {
    "method1": {Mode.ROTATION},
    "slides": {Mode.SLIDE},
    "rocks and slides": {Mode.ROTATION, Mode.SLIDE_ROTATION},
    "flies": {Mode.ROTATION_JUMP},
}


@pytest.mark.parametrize("name", MODES_SEEN)
def test_accelerometer_reads_the_second_difference_of_the_marker_plus_gravity(name):
    """Where three samples lie in one stretch of one mode: (x'' + a_x) and (z'' + a_z + g) turned into the block."""
    run = moving(name)
    assert set(run.mode.tolist()) >= MODES_SEEN[name]
    x, z = marker(run, POINT)
    h = run.t[1] - run.t[0]
    events = run.events.t
    middle = np.arange(1, run.t.size - 1)
    same = np.searchsorted(events, run.t[middle - 1]) == np.searchsorted(events, run.t[middle + 1])
    i = middle[same]
    assert i.size > 1000
    a_x, a_z = run.motion(run.t[i])
    x_dd = (x[i + 1] - 2.0 * x[i] + x[i - 1]) / h**2 + a_x
    z_dd = (z[i + 1] - 2.0 * z[i] + z[i - 1]) / h**2 + a_z + G
    cos, sin = np.cos(run.theta[i]), np.sin(run.theta[i])
    # Samples carry the dense output's error, 1e-12 m or so, which a second difference at 1e-4 s magnifies by 4e8; the
    # difference itself is good to h^2 x''''/12 ~ 1e-6.  Slip that turns round within a sample is left out above.
    assert accelerometer(run, POINT, (1.0, 0.0))[i] == pytest.approx(x_dd * cos - z_dd * sin, abs=5e-3)
    assert accelerometer(run, POINT, (0.0, 1.0))[i] == pytest.approx(x_dd * sin + z_dd * cos, abs=5e-3)


def test_a_block_in_free_flight_without_spin_reads_nothing_but_what_the_base_cancels():
    # Weightless: a - g_vector = 0 in free fall, whatever the axis.
    system = Method2(BLOCK, friction=0.5, g=G)
    run = solve(system, initial=system.initial_state(z=1.0), t_end=0.3, save_at=[0.1, 0.2])
    assert np.all(run.mode == Mode.TRANSLATION_JUMP)
    assert accelerometer(run, POINT, (0.6, 0.8)) == pytest.approx([0.0, 0.0], abs=1e-13)


@pytest.mark.parametrize(
    ("position", "direction", "message"),
    [
        ((0.0, math.nan), (1.0, 0.0), "position="),
        ((0.0, 0.1), (0.0, 0.0), "direction="),
        ((0.0, 0.1), (1.0, math.inf), "direction="),
    ],
)
def test_bad_position_or_direction_is_named(position, direction, message):
    run = solve(Method1(BLOCK), theta=0.1, t_end=0.1)
    with pytest.raises(ValueError, match=message):
        accelerometer(run, position, direction)
