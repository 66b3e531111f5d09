"""The paper's preliminary analyses: dropped block, eq. (8), eq. (9), free swings."""

import math

import numpy as np
import pytest

import dem
from dem.drop import (
    Drop,
    largest_step_as_good,
    squared_difference,
    stiffness_from_wave_speed,
    wave_speed_from_stiffness,
)
from dem.free_swings import let_go, passages, swings, top_displacement
from rocking.closed_forms import quarter_period

T, SAMPLES = 3.3e-3, 152


@pytest.fixture(scope="module")
def drop():
    return Drop(dem.single_block(0.075, 0.25, 0.125, 597.0), 0.01)


def test_closed_form_of_the_drop_obeys_newton(drop):
    t = np.linspace(0.0, 0.2, 2_000_001)
    z = drop.exact(t)
    acceleration = np.diff(z, 2) / (t[1] - t[0]) ** 2
    force = np.where(z < 0.0, -2.0 * drop.kn * z, 0.0)[1:-1] / drop.scene.mass - drop.g
    # Second differences of numbers of 0.01 m known to 1e-18 m; where it touches inside a step, one of the two forces.
    touching = np.diff(np.sign(z))[1:] != 0
    assert np.abs(acceleration - force)[~touching].max() < 5e-3 * np.abs(force).max()
    assert z[0] == drop.height and z.max() <= drop.height and z.min() < 0.0
    assert drop.exact(np.array([drop.period, 5.0 * drop.period])) == pytest.approx(drop.height)


@pytest.mark.parametrize(("onset", "order"), [("incremental", 1.0), ("overlap", 1.0), ("located", 2.0)])
def test_the_drop_tends_to_the_closed_form(drop, onset, order):
    exact = drop.exact(np.arange(SAMPLES) * T)
    errors = [math.sqrt(squared_difference(exact, drop.history(T / n, onset, T, SAMPLES))) for n in (300, 3000)]
    # A tenth of the step: smaller by 10^order, 2 being that of the leap-frog itself; a fifth of that will do, since
    # where in a step the block lands is as good as chance.
    assert errors[1] < errors[0] / 10.0**order * 5.0


def test_a_located_onset_is_better_than_the_papers_by_eq_8_at_ten_times_its_step(drop):
    exact = drop.exact(np.arange(SAMPLES) * T)
    papers = squared_difference(exact, drop.history(T / 1650, "incremental", T, SAMPLES))  # 2.0e-6 s
    assert squared_difference(exact, drop.history(T / 165, "located", T, SAMPLES)) < papers


def test_eq_8_is_the_sum_of_squares():
    assert squared_difference(np.array([0.0, 1.0, 2.0]), np.array([1.0, 1.0, 4.0])) == 5.0
    with pytest.raises(ValueError, match=r"samples: \(3,\) and \(2,\)"):
        squared_difference(np.zeros(3), np.zeros(2))


def test_the_largest_step_as_good_is_the_last_before_the_first_that_is_worse():
    assert largest_step_as_good([3.0, 1.0, 2.0, 4.0], [5.0, 0.1, 0.2, 0.1], 1.0) == 2.0
    assert math.isnan(largest_step_as_good([1.0], [2.0], 1.0))
    assert math.isnan(largest_step_as_good([1.0, 2.0], [math.nan, 0.0], 1.0))


def test_bad_drops_are_refused_by_name(drop):
    with pytest.raises(ValueError, match=r"height=0\.0 m"):
        Drop(drop.scene, 0.0)
    with pytest.raises(ValueError, match="want a whole part of the sampling interval"):
        drop.history(3e-6, "incremental", 1e-3, 10)
    with pytest.raises(ValueError, match=r"^samples=1: want a whole number, at least 2"):
        drop.history(T / 1000, "located", T, 1)
    with pytest.raises(ValueError, match="onset='late'"):
        drop.history(T / 1000, "late", T, 10)
    with pytest.raises(ValueError, match="want a step below"):
        drop.history(T / 10, "incremental", T, 10)


def test_eq_9_gives_the_papers_stiffness_back():
    # Block 1: 89.6 kg, centres of two such blocks on each other 1 m apart.
    mass = dem.single_block(0.3, 1.0, 0.5, 597.0).mass
    speed = wave_speed_from_stiffness(mass, 1.98e7, 1.0)
    assert speed == pytest.approx(math.sqrt(1.98e7 / mass))
    assert stiffness_from_wave_speed(mass, speed, 1.0) == pytest.approx(1.98e7)
    with pytest.raises(ValueError, match="speed=-1"):
        stiffness_from_wave_speed(1.0, -1.0, 1.0)
    with pytest.raises(ValueError, match="spacing=0"):
        wave_speed_from_stiffness(1.0, 1.0, 0.0)


def test_first_passage_of_a_block_let_go_is_housners_quarter_period():
    scene = dem.single_block(0.1, 1.0, 0.5, 597.0)  # so slender that the linear equation holds
    alpha = math.atan(0.1)
    p = math.sqrt(3.0 * 9.80665 / (4.0 * 0.5 * math.hypot(0.1, 1.0)))
    history = let_go(scene, 0.4 * alpha, t_end=2.0, damping=2e4, kn=1e9, ks=1e9)
    found = swings(history.time, history.theta)
    # sin x = x to alpha^2/6 of 1e-3, and the springs give by 1e-6 m.
    assert found.passages[0] == pytest.approx(quarter_period(0.4 * alpha, alpha, p), rel=3e-3)
    assert found.peaks[0] == pytest.approx(0.4 * alpha)
    assert np.all(np.diff(found.peaks) < 0.0)


def test_the_top_moves_as_the_middle_of_the_upper_edge():
    scene = dem.single_block(0.3, 1.0, 0.5, 597.0)
    history = let_go(scene, 0.1, t_end=0.5, damping=1e4)
    corners, theta = scene.shape.corners, history.theta
    upper = corners[corners[:, 1] > 0.0]
    x = [history.x + c[0] * np.cos(theta) + c[1] * np.sin(theta) for c in upper]
    assert top_displacement(history) == pytest.approx(0.5 * (x[0] + x[1]), abs=1e-12)


def test_a_block_is_let_go_about_its_lowest_corner():
    """The lowest of four corners, found by turning each: it is where it was when the block stood upright at x = 0."""
    scene = dem.single_block(0.3, 1.0, 0.5, 597.0)
    for tilt in (0.1, -0.25, 1.1):
        start = let_go(scene, tilt, t_end=1e-3, damping=1e4)
        turn = np.array([[math.cos(tilt), math.sin(tilt)], [-math.sin(tilt), math.cos(tilt)]])
        turned = scene.shape.corners @ turn.T
        lowest = int(turned[:, 1].argmin())
        assert start.x[0] + turned[lowest, 0] == pytest.approx(scene.shape.corners[lowest, 0], abs=1e-12)


@pytest.mark.parametrize("interval", [2e-3, 1e-2])
def test_samples_are_about_the_interval_apart(interval):
    """The nearest whole number of steps: half a step off at the most; the end comes when it comes."""
    history = let_go(dem.single_block(0.3, 1.0, 0.5, 597.0), 0.1, t_end=0.1, damping=1e4, dt=1.5e-4, interval=interval)
    assert np.diff(history.time)[:-1] == pytest.approx(interval, abs=0.75e-4)


@pytest.mark.parametrize(
    ("theta", "at"),
    [
        ([0.2, 0.1, 0.0, -0.1, -0.2], [2.0]),
        ([0.2, 0.1, 0.0, 0.1, 0.2], []),
        ([-0.2, -0.1, 0.0, 0.0, 0.1], [3.0]),
        ([0.2, 0.1, -0.1, 0.0, -0.1], [1.5]),
        ([0.0, 0.0, 0.1, -0.1, 0.0], [2.5]),
    ],
)
def test_a_sample_upright_is_one_passage_or_none(theta, at):
    found = swings(np.arange(5.0), np.array(theta))
    assert found.passages == pytest.approx(at) and len(found.peaks) == len(at)
    assert len(passages(np.array(theta))) == len(at)


@pytest.mark.parametrize(
    ("time", "theta", "message"),
    [
        ([0.0, 1.0, 2.0], [0.1, math.nan, -0.1], r"^theta\[1\]=nan rad: want finite numbers"),
        ([0.0, math.inf, 2.0], [0.1, 0.0, -0.1], r"^time\[1\]=inf s: want finite numbers"),
        ([0.0, 1.0], [0.1, 0.0, -0.1], r"^time, theta of shapes \(2,\), \(3,\): want one rotation per time"),
        ("x", [0.1], "^time='x': want numbers"),
    ],
)
def test_swings_of_what_is_no_sampled_rotation_are_refused(time, theta, message):
    with pytest.raises(ValueError, match=message):
        dem.swings(time, theta)
