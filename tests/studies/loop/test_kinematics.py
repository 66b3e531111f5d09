"""Rotation from accelerometers by kinematics alone: a stretch is got back whatever torque acts in it.

The motion is any that a block may do; readings are second differences of the place of the sensor in space, turned into
the block, and share nothing with what is tested.
"""

import math
from collections.abc import Callable

import numpy as np
import pytest

from studies.loop.records.kinematics import Ends, Sensor, turned

G, CORNER, STEP, T = 9.81, 0.1, 0.0025, 0.6
TOP, LOW = Sensor((0.02, 0.75), (1.0, 0.0), 0.03), Sensor((0.05, 0.3), (1.0, 0.0), 0.03)
ASKEW = Sensor((-0.08, 0.3), (0.1, math.sqrt(0.99)), 0.03)
Motion = Callable[[np.ndarray, float], np.ndarray]


def gone(t: np.ndarray, side: float) -> np.ndarray:
    """A swing from impact to impact, at its peak without speed."""
    return np.asarray(side * 0.12 * np.sin(math.pi * t / T))


def motion(t: np.ndarray, side: float) -> np.ndarray:
    """The same under a torque that changes in it, and with what a base of 8 Hz does to it."""
    bump = side * 0.02 * np.sin(2.0 * math.pi * t / T) ** 3
    return np.asarray(gone(t, side) + bump + side * 3e-4 * (np.sin(50.0 * t) - np.sin(50.0 * T) * t / T))


def pushed(t: np.ndarray) -> np.ndarray:
    return np.asarray(2.5 * np.sin(50.0 * t))


def reading(sensor: Sensor, side: float, t: np.ndarray, moves: Motion = motion) -> np.ndarray:
    """By second differences over 0.1 ms of where the sensor is, over a base that is still but under `motion`."""

    def place(t: np.ndarray) -> np.ndarray:
        angle = moves(t, side)
        x, z = sensor.place[0] - side * CORNER, sensor.place[1]
        return np.array([x * np.cos(angle) + z * np.sin(angle), -x * np.sin(angle) + z * np.cos(angle)])

    d, angle = 1e-4, moves(t, side)
    x, z = (place(t + d) - 2.0 * place(t) + place(t - d)) / d**2
    x, z = x + (pushed(t) if moves is motion else 0.0), z + G
    own = x * np.cos(angle) - z * np.sin(angle), x * np.sin(angle) + z * np.cos(angle)
    return np.asarray(sensor.axis[0] * own[0] + sensor.axis[1] * own[1])


# Worst of the cases: 1.9e-5 rad without noise, 1.9e-4 with it. A spline of 25 ms follows the motion closely; of one
# sensor the ends hold what would grow with either exponential.
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("sensors", [(TOP, ASKEW), (TOP,), (LOW,)])
@pytest.mark.parametrize(("noise", "off"), [(0.0, 5e-5), (0.03, 5e-4)])
def test_a_swing_is_got_back_whatever_acts_in_it(
    side: float, sensors: tuple[Sensor, ...], noise: float, off: float
) -> None:
    t = np.arange(3, round(T / STEP) - 2) * STEP
    rng = np.random.default_rng(3)
    read = np.array([reading(s, side, t) for s in sensors]) + noise * rng.standard_normal((len(sensors), t.size))
    read[0, 20:25] = np.nan
    ends = Ends(0.0, T, (True, True), False, 1e-4)
    theta, omega, left = turned(t, read, sensors, (pushed(t), np.zeros(t.size)), G, side * CORNER, ends, 24, 0.3)
    d = 1e-4
    speed = (motion(t + d, side) - motion(t - d, side)) / (2.0 * d)
    np.testing.assert_allclose(theta, motion(t, side), rtol=0.0, atol=off)
    np.testing.assert_allclose(omega, speed, rtol=0.0, atol=10.0 * off)
    assert left < 1.3


def test_of_a_gap_nothing_is_said() -> None:
    t = np.arange(40) * STEP
    ends = Ends(0.0, 0.1, (True, True), False, 1e-4)
    read = np.full((2, t.size), np.nan)
    theta, omega, left = turned(t, read, (TOP, ASKEW), (pushed(t), np.zeros(t.size)), G, CORNER, ends, 4, 0.3)
    assert left == math.inf and not theta.any() and not omega.any()


def test_a_release_is_got_back_from_its_beginning() -> None:
    """The second half of a swing: let go at its peak, it ends on the floor."""
    t = np.arange(0, round(0.5 * T / STEP) - 2) * STEP
    peak = 0.5 * T

    def still(t: np.ndarray) -> np.ndarray:
        return np.zeros(t.size)

    read = np.array([reading(s, 1.0, peak + t, gone) for s in (TOP, ASKEW)])
    ends = Ends(0.0, T - peak, (False, True), True, 1e-4)
    theta, omega, _ = turned(t, read, (TOP, ASKEW), (still(t), still(t)), G, CORNER, ends, 6, 0.3)
    np.testing.assert_allclose(theta, gone(peak + t, 1.0), rtol=0.0, atol=2e-4)
    assert abs(omega[0]) < 1e-3
