"""The criterion of overturning, one run at a time."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import dem
from rocking import Method1, Method2, Mode, solve
from studies.criteria.overturning import METHODS, Settings, overturning
from studies.specimens import specimen

SETTINGS = Settings(damping=42800.0, dt=1e-5)


def test_criterion_is_the_envelope_at_the_last_passage_of_theta_c():
    """Read off a finely sampled history, without the located events."""
    block = specimen(3)
    found = overturning("method1", block, 2.0, SETTINGS)
    motion = SETTINGS.motion(2.0)
    t = np.arange(0.0, 10.0, 1e-4)
    run = solve(Method1(block, form="linear"), motion, t_end=10.0, save_at=t)
    outside = np.abs(run.theta) >= block.alpha
    last = run.t[1:][outside[1:] & ~outside[:-1]][-1]
    assert found.time == pytest.approx(last, abs=1e-4)
    assert found.amplitude == pytest.approx(SETTINGS.ramp * last / SETTINGS.duration, rel=1e-4)


@pytest.mark.parametrize("method", METHODS)
def test_shares_of_time_sum_to_one(method):
    found = overturning(method, specimen(3), 3.0, SETTINGS)
    assert found.note == "overturned"
    for fraction in (found.mode_fraction, found.mode_fraction_late):
        assert fraction.sum() == pytest.approx(1.0, abs=1e-9)
        assert np.all(fraction >= 0.0)


def test_late_share_is_read_over_the_second_half_of_the_time():
    """Method 2 off a finely sampled history of modes; sampling at 1 ms moves a share by less than 2 %."""
    found = overturning("method2", specimen(3), 3.0, SETTINGS)
    t = np.arange(0.5 * found.time, found.time, 1e-3)
    run = solve(Method2(specimen(3), friction=0.7), SETTINGS.motion(3.0), t_end=SETTINGS.duration, save_at=t)
    sampled = np.bincount(run.mode, minlength=6) / t.size
    assert found.mode_fraction_late == pytest.approx(sampled, abs=0.02)


# A run that is told: at rest for 2 s, rocking to 6 s, sliding and rocking to the fall at 8 s and beyond it.
def test_late_shares_of_a_distinct_element_are_of_the_second_half_of_its_time(monkeypatch):
    t = np.arange(0.0, 10.5, 0.5)
    clock = np.zeros((t.size, 6))
    clock[:, Mode.REST] = np.minimum(t, 2.0)
    clock[:, Mode.ROTATION] = np.clip(t - 2.0, 0.0, 4.0)
    clock[:, Mode.SLIDE_ROTATION] = np.maximum(t - 6.0, 0.0)
    at_the_fall = np.array([np.interp(8.0, t, column) for column in clock.T])
    told = SimpleNamespace(
        outcome=None, side=1, overturning_time=8.0, time=t, mode_clock=clock, mode_seconds_to_overturning=at_the_fall
    )
    monkeypatch.setattr(dem, "simulate", lambda *_, **__: told)
    found = overturning("dem", specimen(3), 2.0, replace(Settings(), damping=100.0))
    assert found.mode_fraction[[Mode.REST, Mode.ROTATION, Mode.SLIDE_ROTATION]] == pytest.approx([0.25, 0.5, 0.25])
    # From 4 s to 8 s: two seconds of rotation, two of both.
    assert found.mode_fraction_late[[Mode.REST, Mode.ROTATION, Mode.SLIDE_ROTATION]] == pytest.approx([0.0, 0.5, 0.5])


@pytest.mark.parametrize("method", METHODS)
def test_ramp_below_west_leaves_the_block_standing(method):
    # West, eq. (1) of the paper: nothing moves below (b/h) g = 0.3 g.
    found = overturning(method, specimen(3), 2.0, replace(SETTINGS, ramp=0.29 * 9.80665, duration=10.0))
    assert math.isnan(found.amplitude)
    assert found.note.startswith("standing at the end of the ramp, 2.844 m/s^2 (0.29 g)")


@pytest.mark.parametrize("method", METHODS)
def test_slow_ramp_at_low_frequency_overturns_near_west_and_never_below(method):
    # West's formula, eq. (1), is a lower bound; at 1 Hz Block 3 falls within a small multiple of it.
    west = 0.3 * 9.80665
    found = overturning(method, specimen(3), 1.0, replace(SETTINGS, ramp=8.0, duration=40.0))
    assert west <= found.amplitude <= 2.0 * west


# Block 7 has Housner's restitution 0.942; one that loses more falls later in the ramp, by Method 2 as by Method 1.
def test_a_restitution_below_housners_is_had_by_both_methods():
    for method in ("method1", "method2"):
        lossy, plain = (
            overturning(method, specimen(7), 3.0, replace(SETTINGS, form="nonlinear", restitution=e)).amplitude
            for e in (0.8, None)
        )
        assert lossy > plain


def test_settings_that_a_method_cannot_have_are_declined_with_the_reason():
    # Where friction is 4/3 or more a sliding corner of a uniform block may jam, whatever its b/h.
    found = overturning("method2", specimen(7), 3.0, replace(SETTINGS, friction=1.5))
    assert math.isnan(found.amplitude)
    assert found.note.startswith("declined: friction=1.5 (kinetic): want below 4/3")
    no_dashpot = overturning("dem", specimen(7), 3.0, replace(SETTINGS, damping=math.nan))
    assert no_dashpot.note == "declined: no dashpot gives this restitution in a free vibration"


def test_solvers_give_the_same_criterion():
    # At 1 Hz the block falls after few impacts; where it rocks for long, the last digit decides (chaos).
    fast = overturning("method1", specimen(3), 1.0, SETTINGS)
    reference = overturning("method1", specimen(3), 1.0, replace(SETTINGS, solver="scipy"))
    assert fast.amplitude == pytest.approx(reference.amplitude, rel=1e-6)


def test_a_solver_that_declines_is_said_with_its_sentence():
    found = overturning("method2", specimen(3), 3.0, replace(SETTINGS, solver="exact"))
    assert math.isnan(found.amplitude)
    assert found.note.startswith("declined: solver='exact' declines: it carries linear Method 1 alone")


def test_closed_form_gives_the_same_criterion_as_the_integrator():
    exact = overturning("method1", specimen(3), 1.0, replace(SETTINGS, solver="exact"))
    assert exact.amplitude == pytest.approx(overturning("method1", specimen(3), 1.0, SETTINGS).amplitude, rel=1e-6)


def test_a_given_restitution_is_never_computed_under_another_law_than_asked_for():
    settings = replace(SETTINGS, restitution=0.9, normal_restitution=0.3, impact_law="kinematic")
    found = overturning("method2", specimen(3), 3.0, settings)
    assert math.isnan(found.amplitude)
    assert found.note.startswith("declined: restitution=0.9: want impact_law='two_corner' with it, not 'kinematic'")
