"""What instruments read when effects are there: markers and accelerometers against absolute positions, and sensors."""

import math
from typing import Any

import numpy as np
import pytest

from rocking import Block, Method1, solve
from rocking.effects import parse
from rocking.instruments import accelerometer, marker, rotation_sensor

G = 9.80665
BLOCK = Block(b=0.2, h=0.8)
POINT = (0.07, 0.65)
W, PITCH, RATE = 20.0, 1e-3, 4.0  # of the base below: rad/s, rad, m/s^2


class Shaking:
    """a_x = RATE sin(W t), a_z = sin(1.7 W t) and a pitch of PITCH sin(2 W t), with its acceleration."""

    kernel = staticmethod(lambda xp, t, par: (par[0] * xp.sin(par[1] * t), xp.sin(1.7 * par[1] * t)))
    pitch_kernel = staticmethod(
        lambda xp, t, par: (par[2] * xp.sin(2.0 * par[1] * t), -4.0 * par[1] ** 2 * par[2] * xp.sin(2.0 * par[1] * t))
    )
    breakpoints: tuple[float, ...] = ()
    max_step = 0.01

    def __init__(self, pitch: float) -> None:
        self.parameters = np.array([RATE, W, pitch])

    @property
    def has_pitch(self) -> bool:
        return bool(self.parameters[2] != 0.0)

    def position(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Where the middle of the base is (x, z) [m], and its pitch [rad]."""
        x = -RATE / W**2 * np.sin(W * t)
        return x, -np.sin(1.7 * W * t) / (1.7 * W) ** 2, self.parameters[2] * np.sin(2.0 * W * t)


def turned(angle: Any, x: Any, z: Any) -> tuple[Any, Any]:
    """(x, z) turned clockwise."""
    return x * np.cos(angle) + z * np.sin(angle), -x * np.sin(angle) + z * np.cos(angle)


def on_the_floor(theta: np.ndarray, r: float, a: float) -> tuple[np.ndarray, np.ndarray]:
    """POINT over the floor by geometry: the centre of the edge has rolled by r theta."""
    s = np.where(theta >= 0.0, 1.0, -1.0)
    x, z = turned(theta, POINT[0] - s * a, POINT[1] - r)
    return s * a + r * theta + x, r + z


CASES: dict[str, tuple[tuple[str, ...], float, float, float, float]] = {  # texts, r, a, tilt, pitch
    "rounded": (("rounded_edges.radius=0.03",), 0.03, 0.07, 0.0, 0.0),
    "tilted": (("base_tilt.angle=0.06",), 0.0, 0.1, 0.06, 0.0),
    "pitching": ((), 0.0, 0.1, 0.0, PITCH),
    "narrow and eccentric": (("concave_base.breadth=0.16", "eccentric_mass.offset=0.01"), 0.0, 0.08, 0.0, 0.0),
    "all": (
        ("rounded_edges.radius=0.02", "base_tilt.angle=-0.04", "eccentric_mass.offset=0.01", "tether.stiffness=300"),
        0.02, 0.08, -0.04, PITCH,
    ),
}  # fmt: skip


def run_of(name: str) -> tuple[Any, Shaking]:
    texts, *_, pitch = CASES[name]
    motion = Shaking(pitch)
    t = np.arange(0.0, 1.5, 1e-4)
    # Pitching and otherwise ideal too: something that adds nothing makes the equations the composed ones.
    effects = parse([*texts, "viscous_damping.coefficient=0"])
    run = solve(
        Method1(BLOCK), motion, theta=0.05, t_end=1.5, save_at=t, rtol=1e-11, atol=1e-14, effects=effects
    )  # fmt: skip
    assert len(run.impact_times) >= 2
    return run, motion


@pytest.mark.parametrize("name", CASES)
def test_a_marker_is_where_the_block_carries_it(name: str) -> None:
    run, _ = run_of(name)
    x, z = marker(run, POINT)
    want_x, want_z = on_the_floor(run.theta, *CASES[name][1:3])
    moved = run.theta != 0.0
    np.testing.assert_allclose(x[moved], want_x[moved], atol=1e-14)
    np.testing.assert_allclose(z[moved], want_z[moved], atol=1e-14)


# Absolute position in an inertial frame: base, plus the floor's place turned by tilt and pitch.  Its second difference
# less gravity, on the axis as it stands in that frame, is what the accelerometer feels.
@pytest.mark.parametrize("name", CASES)
def test_an_accelerometer_reads_the_second_difference_of_its_absolute_position(name: str) -> None:
    run, motion = run_of(name)
    _, r, a, tilt, _ = CASES[name]
    t, theta, h = run.t, run.theta, 1e-4
    base_x, base_z, pitch = motion.position(t)
    x, z = turned(tilt + pitch, *on_the_floor(theta, r, a))
    x, z = x + base_x, z + base_z
    middle = np.arange(1, t.size - 1)
    i = middle[np.searchsorted(run.events.t, t[middle - 1]) == np.searchsorted(run.events.t, t[middle + 1])]
    assert i.size > 10_000
    a_x = (x[i + 1] - 2.0 * x[i] + x[i - 1]) / h**2
    a_z = (z[i + 1] - 2.0 * z[i] + z[i - 1]) / h**2 + G
    # Left out of the reading are the terms psi' omega and psi'^2: 2 |psi'| |v| and |psi'|^2 |r| at most.
    rate = 2.0 * W * CASES[name][4]
    left_out = 2.0 * rate * np.max(np.abs(run.omega)) * 0.75 + rate**2 * 0.75
    for axis in ((1.0, 0.0), (0.0, 2.0), (0.6, -0.8)):
        length = math.hypot(*axis)
        d_x, d_z = turned(theta[i] + tilt + pitch[i], axis[0] / length, axis[1] / length)
        reading = accelerometer(run, POINT, axis)[i]
        # Second differences of a smooth curve are good to h^2 x''''/12 ~ 1e-6, rounding of 1e-16 m to 1e-8/h^2.
        assert np.max(np.abs(reading - (a_x * d_x + a_z * d_z))) < 2e-4 + left_out
    if rate == 0.0:
        assert left_out == 0.0


def test_what_the_reading_leaves_out_of_a_pitching_base_is_of_second_order() -> None:
    """A pitch ten times smaller: what is left out falls tenfold with psi' omega; pitch acceleration stays in."""
    worst = []
    for pitch in (PITCH, 0.1 * PITCH):
        motion = Shaking(pitch)
        t = np.arange(0.0, 0.2, 1e-4)
        run = solve(Method1(BLOCK), motion, theta=0.15, t_end=0.2, save_at=t, rtol=1e-12, atol=1e-15)
        base_x, base_z, angle = motion.position(t)
        x, z = turned(angle, *on_the_floor(run.theta, 0.0, 0.1))
        x, z = x + base_x, z + base_z
        i = np.arange(1, t.size - 1)
        i = i[np.searchsorted(run.events.t, t[i - 1]) == np.searchsorted(run.events.t, t[i + 1])]
        a_x = (x[i + 1] - 2.0 * x[i] + x[i - 1]) / 1e-8
        a_z = (z[i + 1] - 2.0 * z[i] + z[i - 1]) / 1e-8 + G
        d_x, d_z = turned(run.theta[i] + angle[i], 1.0, 0.0)
        worst.append(np.max(np.abs(accelerometer(run, POINT, (1.0, 0.0))[i] - (a_x * d_x + a_z * d_z))))
    assert worst[1] == pytest.approx(0.1 * worst[0], rel=0.1)


@pytest.mark.parametrize("solver", ["scipy", "numba"])
def test_an_accelerometer_on_a_tilted_floor_at_rest_reads_gravity_turned(solver: str) -> None:
    run = solve(
        Method1(BLOCK), t_end=0.1, save_at=[0.05], effects=parse(["base_tilt.angle=0.1"]), solver=solver
    )  # fmt: skip
    # +X points down the slope: it reads -g sin(tilt), as a block that leans by as much.
    assert accelerometer(run, POINT, (1.0, 0.0)) == pytest.approx([-G * math.sin(0.1)], abs=1e-12)
    assert accelerometer(run, POINT, (0.0, 1.0)) == pytest.approx([G * math.cos(0.1)], abs=1e-12)


# The centre of mass of the block on springs is part of its state, its acceleration the forces over the mass.
def test_an_accelerometer_on_a_block_on_springs_reads_the_second_difference() -> None:
    t = np.arange(0.0, 0.2, 1e-4)
    effects = parse(["compliant_base.corner_stiffness=2e5", "compliant_base.damping_ratio=0.1", "base_tilt.angle=0.02"])
    run = solve(Method1(BLOCK), theta=0.1, t_end=0.2, save_at=t, rtol=1e-12, atol=1e-15, effects=effects)
    x, z = marker(run, POINT)
    along, up = turned(run.theta, POINT[0], POINT[1] - 0.4)
    np.testing.assert_allclose(x, run.y[:, 0] + along, atol=1e-15)
    np.testing.assert_allclose(z, run.y[:, 1] + up, atol=1e-15)
    i = np.arange(1, t.size - 1)
    i = i[np.searchsorted(run.events.t, t[i - 1]) == np.searchsorted(run.events.t, t[i + 1])]
    # The floor's axes stand still: gravity in them is (g sin, -g cos) of the tilt.
    a_x = (x[i + 1] - 2.0 * x[i] + x[i - 1]) / 1e-8 - G * math.sin(0.02)
    a_z = (z[i + 1] - 2.0 * z[i] + z[i - 1]) / 1e-8 + G * math.cos(0.02)
    d_x, d_z = turned(run.theta[i], 1.0, 0.0)
    assert np.max(np.abs(accelerometer(run, POINT, (1.0, 0.0))[i] - (a_x * d_x + a_z * d_z))) < 1e-3


def test_the_rotation_sensor_reads_gain_times_rotation_plus_offset() -> None:
    texts = ["rotation_offset.offset=0.01", "rotation_gain.gain=1.2", "rounded_edges.radius=0.01"]
    run = solve(Method1(BLOCK), theta=0.1, t_end=0.5, effects=parse(texts))
    np.testing.assert_allclose(rotation_sensor(run), 1.2 * run.theta + 0.01, atol=1e-15)
    plain = solve(Method1(BLOCK), theta=0.1, t_end=0.5)
    np.testing.assert_array_equal(rotation_sensor(plain), plain.theta)
    # The sensor changes what is read, not what happens.
    without = solve(Method1(BLOCK), theta=0.1, t_end=0.5, effects=parse(texts[2:]))
    np.testing.assert_array_equal(run.theta, without.theta)
