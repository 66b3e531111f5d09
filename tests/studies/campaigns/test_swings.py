"""Swings, impacts and local states against runs of the solver, whose events are located."""

import math

import numpy as np
import pytest

from rocking import Method1, solve
from studies.campaigns.signals import mean_restitution, segment, state, states

from .conftest import BLOCK, RESTITUTION, STEP, forced_test, free_test, ramp

SIGMA = 2e-4
SYSTEM = Method1(BLOCK, restitution=RESTITUTION)


def impacts_of(run):
    """(time, velocity before, velocity after) of the impacts of a run."""
    struck = np.isin(run.events.t, run.impact_times)
    return run.events.t[struck], run.events.y_before[struck, 1], run.events.y_after[struck, 1]


def test_a_free_decay_is_taken_apart_completely():
    for seed in range(5):
        test, run = free_test("a", 0.19, np.random.default_rng(seed), duration=2.5)
        found = segment(test.time, test.rotation, SIGMA)
        assert len(found.impacts) == len(run.impact_times)
        assert [s.side for s in found.swings] == [(-1) ** k for k in range(len(found.swings))]
        assert all(s.turns for s in found.swings[:-1]) and not found.rests


def test_peaks_of_a_free_decay_obey_the_energy_equation():
    """Between a peak theta and the next impact energy is kept: omega^2 = 2 p^2 (cos(alpha - theta) - cos(alpha))."""
    test, run = free_test("a", 0.19, np.random.default_rng(3), duration=2.5)
    found = segment(test.time, test.rotation, SIGMA)
    _, before, _ = impacts_of(run)
    p, alpha = BLOCK.p(), BLOCK.alpha
    for swing, speed in zip(found.swings[1:-1], before[1:], strict=True):
        gained = 2.0 * p**2 * (math.cos(alpha - abs(swing.peak)) - math.cos(alpha))
        slope = 2.0 * p**2 * math.sin(alpha - abs(swing.peak))
        assert gained == pytest.approx(speed**2, abs=4.0 * slope * swing.peak_sd)


def deviations(seeds=range(4)):
    """Errors over stated standard deviations of impacts and of states, from free and forced runs."""
    out = {name: [] for name in ("time", "before", "after", "rotation", "velocity")}
    for seed in seeds:
        rng = np.random.default_rng(seed)
        made = [(free_test("a", 0.19, rng), None), *((forced_test("b", f, rng), ramp(f)[2]) for f in (3.0, 5.0))]
        for (test, run), motion in made:
            found = segment(test.time, test.rotation, SIGMA)
            times, before, after = impacts_of(run)
            for impact in found.impacts:
                k = int(np.argmin(np.abs(times - impact.time)))
                out["time"].append((impact.time - times[k]) / impact.time_sd)
                out["before"].append((impact.before - before[k]) / impact.before_sd)
                out["after"].append((impact.after - after[k]) / impact.after_sd)
            at = np.sort(rng.uniform(0.05, test.time[-1] - 0.05, 100))
            theta = 0.19 if test.kind == "free" else 0.0
            fine = solve(SYSTEM, motion, theta=theta, t_end=test.time[-1], save_at=at)
            for k, fit in enumerate(states(test.time, test.rotation, at, SIGMA, found)):
                if fit is not None:
                    out["rotation"].append((fit.rotation - fine.theta[k]) / math.sqrt(fit.covariance[0, 0]))
                    out["velocity"].append((fit.velocity - fine.omega[k]) / math.sqrt(fit.covariance[1, 1]))
    return {name: np.array(values)[np.isfinite(values)] for name, values in out.items()}


def test_stated_standard_deviations_are_those_of_the_errors():
    """A normal error has a median of |z| of 0.67 and 5 % beyond 1.96; bias of the fits may widen that by a third."""
    for name, z in deviations().items():
        assert z.size > 200, name
        assert 0.55 < np.median(np.abs(z)) < 0.9, name
        assert np.quantile(np.abs(z), 0.95) < 1.96 * 4 / 3, name
        assert abs(np.mean(z)) < 0.3, name


def test_restitution_is_recovered():
    for seed in range(3):
        rng = np.random.default_rng(seed)
        for test, _ in (free_test("a", 0.19, rng), forced_test("b", 4.0, rng), forced_test("c", 3.0, rng)):
            e, sd = mean_restitution(segment(test.time, test.rotation, SIGMA).impacts)
            assert e == pytest.approx(RESTITUTION, abs=4.0 * sd) and sd < 0.02
    assert all(math.isnan(v) for v in mean_restitution(()))


def test_quiet_noise_has_no_swings_and_is_rest():
    values = SIGMA * np.random.default_rng(1).standard_normal(3000)
    found = segment(STEP * np.arange(3000), values, SIGMA)
    assert found.swings == () and found.impacts == ()
    rested = sum(b - a for a, b in found.rests)
    assert rested > 2900


def test_a_reading_at_rest_that_is_not_zero_is_taken_off():
    test, _ = free_test("a", 0.19, np.random.default_rng(2))
    plain = segment(test.time, test.rotation, SIGMA)
    moved = segment(test.time, test.rotation + 0.01, SIGMA, zero=0.01)
    assert [i.time for i in moved.impacts] == pytest.approx([i.time for i in plain.impacts], abs=1e-9)
    assert moved.swings[0].peak == pytest.approx(plain.swings[0].peak + 0.01, abs=1e-9)


def test_no_impact_is_claimed_across_a_gap():
    test, run = free_test("a", 0.19, np.random.default_rng(2))
    hidden = test.rotation.copy()
    strike = run.impact_times[2]
    hidden[np.abs(test.time - strike) < 0.05] = np.nan
    found = segment(test.time, hidden, SIGMA)
    assert min(abs(i.time - strike) for i in found.impacts) > 0.1
    assert len(found.impacts) == len(segment(test.time, test.rotation, SIGMA).impacts) - 1


def test_a_small_gap_costs_accuracy_only():
    test, run = free_test("a", 0.19, np.random.default_rng(2))
    holed = test.rotation.copy()
    strike = run.impact_times[2]
    holed[np.abs(test.time - strike) < 0.01] = np.nan
    found = min(segment(test.time, holed, SIGMA).impacts, key=lambda i: abs(i.time - strike))
    assert abs(found.time - strike) < 4.0 * found.time_sd < 0.01


def test_bounds_of_a_swing_are_the_impacts_about_it():
    test, _ = free_test("a", 0.19, np.random.default_rng(2))
    found = segment(test.time, test.rotation, SIGMA)
    assert found.bounds(0) == (-math.inf, found.impacts[0].time)
    assert found.bounds(3) == (found.impacts[2].time, found.impacts[3].time)


def test_a_cubic_is_fitted_exactly_and_its_covariance_is_least_squares():
    t = np.linspace(0.0, 0.4, 101)
    x = 0.1 + 0.5 * t - 2.0 * t**2 + 3.0 * t**3
    fit = state(t, x, 0.2, 1e-4)
    assert fit.rotation == pytest.approx(0.1 + 0.1 - 0.08 + 0.024, abs=1e-12)
    assert fit.velocity == pytest.approx(0.5 - 0.8 + 0.36, abs=1e-10)
    assert fit.acceleration == pytest.approx(-4.0 + 3.6, abs=1e-8)
    inside = t[np.abs(t - 0.2) <= fit.reach * (1 + 1e-9)] - 0.2
    design = np.vander(inside, 4, increasing=True)
    assert fit.covariance == pytest.approx(1e-8 * np.linalg.inv(design.T @ design)[:2, :2], rel=1e-6)


def test_nothing_is_said_where_there_are_no_samples():
    t = STEP * np.arange(500)
    x = np.zeros(500)
    x[100:300] = np.nan
    assert state(t, x, 0.8, SIGMA) is None
    assert state(t, np.zeros(500), 0.5, SIGMA, low=0.49, high=0.51) is None


@pytest.mark.parametrize("noise", [0.0, -1.0, math.nan])
def test_noise_has_to_be_positive(noise):
    with pytest.raises(ValueError, match="want a positive number"):
        segment(np.arange(9.0), np.zeros(9), noise)
    with pytest.raises(ValueError, match="want a positive number"):
        state(np.arange(9.0), np.zeros(9), 4.0, noise)


def test_shapes_have_to_agree():
    with pytest.raises(ValueError, match="rotation: has shape"):
        segment(np.arange(9.0), np.zeros(8), 1.0)
