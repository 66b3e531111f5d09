"""A sensor that bends, by hand and against SciPy's roots and splines (rocking.effects.learned_reading)."""

import math

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline
from scipy.optimize import brentq

from excitation import SteadySinusoid
from rocking import Block, Method1, solve
from rocking.effect import Seen
from rocking.effects import load
from rocking.effects.learned_reading import MARKS, MOST, LearnedReading
from rocking.instruments import rotation_sensor
from studies.campaigns import DeclaredBlock
from studies.loop.models.model import LoopModel

DECLARED = DeclaredBlock(0.2, 0.6, 0.25, 30.0)
BENT = {
    "learned_reading": {"square": 0.15, "cubic": -0.6}, "rotation_gain": {"gain": 1.03},
    "rotation_offset": {"offset": 2e-3},
}  # fmt: skip


def by_hand(theta):
    return 1.03 * (theta + 0.15 * theta**2 - 0.6 * theta**3) + 2e-3


def test_a_sensor_reads_the_rotation_its_square_and_its_cube_before_gain_and_offset():
    effects = [load(name)(**values) for name, values in BENT.items()]
    run = solve(Method1(Block(b=0.2, h=0.6)), theta=0.2, t_end=1.5, effects=effects)
    np.testing.assert_allclose(rotation_sensor(run), by_hand(run.theta), rtol=0.0, atol=1e-15)
    # The block moves as it would without a sensor.
    np.testing.assert_array_equal(run.theta, solve(Method1(Block(b=0.2, h=0.6)), theta=0.2, t_end=1.5).theta)


def test_a_model_finds_the_rotation_behind_a_reading():
    model = LoopModel(DECLARED, 0.9, BENT)
    reading = np.array([-0.25, -0.1, 0.0, 1e-3, 0.2, np.nan])
    found = model.rotation(reading)
    roots = [brentq(lambda x, r=r: by_hand(x) - r, -0.5, 0.5, xtol=1e-15) for r in reading[:-1]]
    np.testing.assert_allclose(found[:-1], roots, rtol=0.0, atol=1e-13)
    assert np.isnan(found[-1])
    slope = 1.03 * (1.0 + 0.3 * found[:-1] - 1.8 * found[:-1] ** 2)
    np.testing.assert_allclose(model.reading_slope(found[:-1]), slope, rtol=1e-12)
    assert float(model.rotation(0.1)) == pytest.approx(brentq(lambda x: by_hand(x) - 0.1, -0.5, 0.5), abs=1e-11)


def test_where_nothing_bears_on_the_sensor_a_reading_is_the_rotation():
    readings = np.array([-0.25, 0.0, 0.2, np.nan, np.inf])
    found = LoopModel(DECLARED, 0.9, {"viscous_damping": {"coefficient": 0.1}}).rotation(readings)
    np.testing.assert_array_equal(found, [-0.25, 0.0, 0.2, np.nan, np.nan])


def test_a_reading_beyond_what_a_bent_sensor_can_say_has_no_rotation():
    """theta + 20 theta^2 is nowhere below -1/80 rad."""
    model = LoopModel(DECLARED, 0.9, {"learned_reading": {"square": 20.0}})
    assert np.isnan(model.rotation(-0.02))


@pytest.mark.parametrize("n", [2, 8, MOST])
def test_the_curve_is_the_natural_spline_through_its_values_at_the_knots(n):
    """From one end of what was measured to the other, and constant beyond."""
    ends, coefficients = (-0.17, 0.23), np.random.default_rng(n).normal(size=n + 1)
    own = dict(zip(MARKS, map(float, coefficients), strict=False))
    sensor = LearnedReading(low=ends[0], high=ends[1], intervals=float(n), **own)
    knots, theta = np.linspace(*ends, n + 1), np.linspace(*ends, 301)
    values = sensor.reading(knots) - knots
    assert values[[0, -1]] == pytest.approx(coefficients[[0, -1]], rel=1e-12)
    expected = make_interp_spline(knots, values, k=3, bc_type="natural")(theta)
    np.testing.assert_allclose(sensor.reading(theta) - theta, expected, rtol=0.0, atol=1e-11)
    beyond = np.array([-1.2, 0.9])
    np.testing.assert_allclose(sensor.reading(beyond) - beyond, values[[0, -1]], rtol=1e-12)
    assert float(sensor.reading(0.1)) == pytest.approx(float(sensor.reading(np.array([0.1]))[0]), rel=1e-15)


def test_a_curve_of_nothing_adds_nothing_and_none_goes_beyond_its_intervals():
    assert LearnedReading(square=0.1).reading(0.2) == 0.2 * (1.0 + 0.2 * 0.1)
    with pytest.raises(ValueError, match=r"learned_reading.curve_4=1.0 rad: want none beyond curve_3, the last of 3"):
        LearnedReading(intervals=3.0, curve_4=1.0)
    with pytest.raises(ValueError, match=r"learned_reading.intervals=2.5: want a whole number"):
        LearnedReading(intervals=2.5)
    with pytest.raises(ValueError, match=r"learned_reading.low=0.3 rad: want less than high=0.2"):
        LearnedReading(low=0.3, high=0.2)
    assert repr(LearnedReading(high=0.2, curve_0=1e-3)) == "LearnedReading(high=0.2, curve_0=0.001)"


def slot_and_pin(theta: list[float], play: float) -> list[float]:
    """A pin in a slot: the slot moves when the pin has come to one of its ends."""
    slot, out = 0.0, []
    for pin in theta:
        if pin - slot > play:
            slot = pin - play
        elif slot - pin > play:
            slot = pin + play
        out.append(slot)
    return out


def test_play_stays_behind_by_half_of_the_gap() -> None:
    sensor = LearnedReading(play=0.01)
    there_and_back = [0.0, 0.005, 0.02, 0.03, 0.025, 0.011, 0.009, -0.02, -0.015, 0.0]
    seen = Seen(np.zeros(10), np.zeros(10))
    found = sensor.recorded(np.array(there_and_back), seen)
    np.testing.assert_allclose(found, slot_and_pin(there_and_back, 0.01), rtol=0.0, atol=1e-15)
    # It says what it said while the gap is crossed: 0.02 on the way down to 0.01, then it lags on the other side.
    np.testing.assert_allclose(found, [0.0, 0.0, 0.01, 0.02, 0.02, 0.02, 0.019, -0.01, -0.01, -0.01], atol=1e-15)
    np.testing.assert_array_equal(sensor.reading(np.array(there_and_back)), there_and_back)


def test_a_window_that_begins_within_the_gap_knows_the_peak_before_it() -> None:
    """A parabola from 0.2 rad down at 1 rad/s^2: cut off at any time, it reads what the whole of it reads."""
    sensor, t = LearnedReading(play=0.002), 0.004 * np.arange(100)
    for side in (1.0, -1.0):
        whole = side * (0.2 - 0.5 * (t - 0.1) ** 2)
        read = sensor.recorded(whole, Seen(t, 0.0 * t))
        assert np.sum(read == read[26]) > 20  # it stays where it was at the peak
        for first in (10, 25, 30, 40, 60):
            part = sensor.recorded(whole[first:], Seen(t[first:], 0.0 * t[first:]))
            np.testing.assert_allclose(part, read[first:], rtol=0.0, atol=1e-12)


def test_drift_and_the_base_are_added_to_what_has_come_through_the_play() -> None:
    sensor = LearnedReading(play=0.01, cubic=2.0, drift=1e-3, base=2e-3)
    time, a_x, theta = np.array([0.0, 1.0, 2.0]), np.array([0.0, 3.0, -1.0]), np.array([0.11, 0.21, 0.0])
    through = np.array([0.1, 0.2, 0.01])
    expected = through + 2.0 * through**3 + 1e-3 * time + 2e-3 * a_x
    np.testing.assert_allclose(sensor.recorded(theta, Seen(time, a_x)), expected, rtol=1e-12)


def test_on_a_tilted_floor_the_sensor_feels_the_shaking_and_not_gravity() -> None:
    """On a base at rest it says what it says on a level one, on one that shakes `base` times the record besides."""
    block, sensor, tilt = Method1(Block(0.3, 1.0)), LearnedReading(base=2e-3), load("base_tilt")(angle=0.05)
    still = solve(block, t_end=0.5, effects=[sensor, tilt], save_at=[0.0, 0.5])
    np.testing.assert_array_equal(rotation_sensor(still), [0.0, 0.0])
    motion, t = SteadySinusoid(1.0, 2.0, 3.0), np.linspace(0.0, 1.0, 11)
    shaken = solve(block, motion, t_end=1.0, effects=[sensor, tilt], save_at=t)
    np.testing.assert_allclose(rotation_sensor(shaken), shaken.theta + 2e-3 * motion(t)[0], rtol=0.0, atol=1e-15)


def test_the_sensor_of_a_run_feels_its_base_and_the_time_since_its_start() -> None:
    given = {"drift": 1e-3, "base": 2e-3}
    motion = SteadySinusoid(1.0, 2.0, 3.0)
    t = np.linspace(0.0, 2.0, 21)
    run = solve(Method1(Block(0.2, 0.6)), motion, theta=0.05, t_end=2.0, save_at=t,
                effects=[LearnedReading(**given), load("rotation_gain")(gain=1.1)])  # fmt: skip
    assert run.t[-1] > 1.0
    expected = 1.1 * (run.theta + 1e-3 * run.t + 2e-3 * motion(run.t)[0])
    np.testing.assert_allclose(rotation_sensor(run), expected, rtol=0.0, atol=1e-12)


def test_a_model_finds_the_rotation_of_a_peak_behind_the_play() -> None:
    model = LoopModel(DECLARED, 0.9, {"learned_reading": {"play": 0.002}, "rotation_offset": {"offset": 0.01}})
    for theta in (0.2, -0.15):
        assert model.at_peak(theta) == pytest.approx(theta - math.copysign(0.002, theta) + 0.01, abs=1e-15)
        assert model.peak(model.at_peak(theta)) == pytest.approx(theta, abs=1e-15)
    plain = LoopModel(DECLARED, 0.9, {"rotation_gain": {"gain": 2.0}})
    assert not plain.remembers and plain.at_peak(0.1) == 0.2 and plain.peak(0.2) == 0.1
