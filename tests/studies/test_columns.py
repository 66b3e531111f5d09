"""Criteria of columns and of the start of rocking, against histories and closed forms; what a pickup reads."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import dem
from rocking import Method1, detection, solve
from rocking.instruments import accelerometer
from studies.criteria import pickups
from studies.criteria.columns import Column, ColumnJob, ColumnSettings, G, criterion, history, parting
from studies.criteria.pickups import SAMPLE, fall_record, vertical_reading
from studies.criteria.rocking_onset import BEYOND_WEST, OnsetJob, OnsetSettings, onset
from studies.specimens import specimen

FAST = ColumnSettings(ramp=20.0, duration=20.0)


def test_criterion_of_a_column_is_the_envelope_when_a_block_last_passes_its_balance():
    """Read off a finely sampled history: the last outward passage of the block that falls."""
    job = ColumnJob(Column(2), 1.0, FAST)
    found = criterion(job)
    run = history(job, sample=1e-3)
    fallen = run.falls[0].body
    alpha = math.atan2(0.15, 0.5)
    # The upper block's balance is over its own foot; the lower one carries both.
    assert found["note"] == "overturned" and found["fallen"] == fallen
    assert found["overturning_amplitude"] == pytest.approx(20.0 * found["overturning_time"] / 20.0)
    tilt = np.abs(run.theta[:, fallen])
    last = run.time[1:][(tilt[1:] >= alpha) & (tilt[:-1] < alpha)]
    assert found["overturning_time"] <= last[-1] + 0.05


def test_one_block_falls_as_the_single_distinct_element_does():
    # Another engine of the package on the same block: dem.simulate with the paper's step.
    settings = replace(FAST, ramp=10.0)
    found = criterion(ColumnJob(Column(1), 1.0, settings))
    block = specimen(3)
    run = dem.simulate(
        dem.single_block(block.b, block.h, block.d, block.density), settings.motion(1.0), t_end=20.0, mu=0.7,
        damping=settings.contact.damping, dt=1e-5,
    )  # fmt: skip
    assert found["overturning_time"] == pytest.approx(run.overturning_time, rel=2e-3)


def test_a_column_that_stands_and_one_that_is_refused_say_so():
    stands = criterion(ColumnJob(Column(2), 2.0, replace(FAST, ramp=1.0, duration=5.0)))
    assert math.isnan(stands["overturning_amplitude"]) and stands["note"].startswith("standing at the end")
    refused = criterion(ColumnJob(Column(0), 2.0, FAST))
    assert refused["note"].startswith("declined: count=0")


def test_a_stiff_column_lifts_at_west_of_its_outline():
    # b/(2h) g for two blocks as one: 0.15 g; 0.1 mm off the floor takes a little more, as motion does in fig14.
    found = criterion(ColumnJob(Column(2), 1.0, ColumnSettings(ramp=3.0, duration=60.0)))
    west = 0.15 * G * 60.0 / 3.0
    assert west <= found["onset_time"] <= 1.1 * west


def test_parting_is_read_where_angles_differ():
    class Run:
        time = np.linspace(0.0, 1.0, 11)
        theta = np.stack([np.zeros(11), np.linspace(0.0, 0.1, 11)], axis=1)

    when, largest = parting(Run, 1.0, 0.85)  # type: ignore[arg-type]
    assert (when, largest) == (pytest.approx(0.6), pytest.approx(0.08))


def test_method_1_lifts_at_west_and_a_tilted_floor_lowers_it_by_its_angle():
    from rocking.effects.base_tilt import BaseTilt

    plain = onset(OnsetJob("method1", 3, 2.0, OnsetSettings()))
    assert plain["lift_acceleration"] == pytest.approx(0.3 * G, rel=1e-6)
    assert plain["onset_acceleration"] >= plain["lift_acceleration"]
    tilted = onset(OnsetJob("method1", 3, 2.0, OnsetSettings(effects=(BaseTilt(angle=0.01),))))
    # A block on a floor tilted by beta leaves at g tan(alpha - beta) to the lower side.
    expected = G * math.tan(math.atan(0.3) - 0.01)
    assert tilted["lift_acceleration"] == pytest.approx(expected, rel=1e-3)


def test_a_pickup_reads_what_the_analytic_instrument_reads():
    """The same motion, once as positions and velocities of a body and once as a trajectory of Method 1."""
    block = specimen(3)
    base = ColumnSettings(ramp=10.0, duration=20.0).motion(2.0)
    t = np.arange(0.0, 5.0, SAMPLE)
    run = solve(Method1(block, form="nonlinear"), base, t_end=20.0, theta=0.5 * block.alpha, save_at=t[t < 0.2])
    theta, omega, s = run.theta[:, None], run.omega[:, None], run.s[:, None]
    psi = block.alpha - s * theta
    # From the pivot to the centre of mass, and the velocity of a rotation that is positive clockwise.
    r_x, r_z = -s * block.R * np.sin(psi), block.R * np.cos(psi)
    body = SimpleNamespace(time=run.t, theta=theta, omega=omega, vx=omega * r_z, vz=-omega * r_x)
    assert run.impact_times[0] > 0.2
    when, reading = vertical_reading(body, 0, block.h, base)  # type: ignore[arg-type]
    exact = accelerometer(run, (0.0, block.h), (0.0, 1.0))
    # The mean over a sample is that of its ends but for the curvature of the record: 1e-4 of g here.
    assert reading == pytest.approx(0.5 * (exact[1:] + exact[:-1]), abs=2e-3)
    assert when == pytest.approx(0.5 * (run.t[1:] + run.t[:-1]))


def test_a_pickup_of_a_standing_block_reads_gravity():
    settings = ColumnSettings(ramp=8.0, duration=10.0)
    run = history(ColumnJob(Column(1), 1.0, settings), t_end=2.0, sample=SAMPLE)
    t, reading = vertical_reading(run, 0, specimen(3).h, settings.motion(1.0))
    assert reading[t < 2.0] == pytest.approx(G, abs=0.01)


def test_an_onset_is_looked_for_until_the_envelope_is_well_beyond_west_and_no_longer():
    """By hand: b/h of Block 3 is 0.3, so 0.3 g of a ramp of 2 m/s^2 in 10 s, times the margin, or all of the ramp."""
    block = specimen(3)
    slow = OnsetSettings(ramp=2.0, duration=10.0)
    assert OnsetJob("method1", 3, 2.0, slow).t_end == 10.0
    fast = OnsetSettings(ramp=100.0, duration=10.0)
    expected = BEYOND_WEST * block.b / block.h * G * 0.1
    assert OnsetJob("method1", 3, 2.0, fast).t_end == pytest.approx(expected)
    assert expected < 10.0


def test_the_quiet_part_of_a_column_s_record_ends_before_west_s_level_for_its_whole_height(monkeypatch):
    """West: a block tips at b/h g, three of them as one at a third of it; four fifths of the time to it are quiet."""
    settings, quiet = ColumnSettings(ramp=20.0, duration=3.0), []

    def detect(t, reading, **options):
        quiet.append(options["quiet"])
        return detection.detect_overturning(t, reading, **options)

    monkeypatch.setattr(pickups, "detect_overturning", detect)
    found = fall_record(Column(3), 1.0, settings, 1)
    [(begin, end)] = quiet
    assert begin == 0.0
    assert settings.motion(1.0).envelope(end / 0.8) == pytest.approx(G * 0.3 / 3.0)
    assert end < found["true_time"] < found["time"][-1]


@pytest.mark.parametrize("seed", [1, 2])
def test_an_onset_record_begins_to_rock_when_the_floor_reaches_west_s_level(seed):
    """West: a corner carries nothing more at |a_x| = (b/h) g; on its springs, at some 75 Hz, the block follows."""
    settings = ColumnSettings(ramp=30.0, duration=5.0, damping=3e3)
    found = pickups.onset_record(3, 3.0, settings, seed)
    t = np.linspace(0.0, 0.8, 80_001)
    level = np.abs(30.0 / 5.0 * t * np.sin(2.0 * math.pi * 3.0 * t))
    first = np.flatnonzero(level > 0.3 * G)[0]
    west, slope = t[first], np.gradient(level, t)[first]
    assert found["true_time"] == pytest.approx(west, abs=2.0 * SAMPLE)
    assert found["true_amplitude"] == pytest.approx(0.3 * G, abs=2.0 * SAMPLE * slope)
    assert west < found["read_time"] < found["time"][-1] < 0.8


def test_a_block_that_slides_has_not_lifted_off():
    """Coulomb: friction of 0.2 turns no block of b/h 0.3; with 0.7 it lifts off at West's (b/h) g."""
    settings = OnsetSettings(duration=20.0)
    slides, rocks = (onset(OnsetJob("method2", 3, 3.0, replace(settings, friction=mu))) for mu in (0.2, 0.7))
    assert math.isnan(slides["lift_acceleration"]) and math.isnan(slides["lift_time"])
    assert slides["note"].startswith("no corner is 0.05 mm off the floor")
    assert rocks["lift_acceleration"] == pytest.approx(0.3 * G, rel=1e-6)


def test_a_distinct_element_leaves_the_floor_near_west_and_its_corner_then_rises():
    """Springs give by m g/(2 kn) under the standing block: its corner leaves the floor a little after West's level, and
    is 0.05 mm off it in this half cycle or the next."""
    settings, block = OnsetSettings(duration=4.0), specimen(3)
    found = onset(OnsetJob("dem", 3, 3.0, settings))
    assert found["note"] == "rocks"
    west = block.b / block.h * G
    assert found["lift_acceleration"] == pytest.approx(west, rel=0.05)
    assert found["lift_time"] < found["onset_time"] < found["lift_time"] + 1.0 / 3.0
