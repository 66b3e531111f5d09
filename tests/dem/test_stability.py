"""Critical steps: the anchors, and runs on both sides of the body's own limit."""

import importlib
import math

import numpy as np
import pytest

import dem

simulate_module = importlib.import_module("dem.simulate")

KN = 1.98e7


def test_eq_7_gives_the_papers_step_for_its_lightest_block(block):
    # Winkler, Meguro & Yamazaki (1995): about 5e-4 s; worked out 5.3e-4 s.
    assert dem.eq7_step(block(4).mass, KN) == pytest.approx(5.3e-4, abs=0.05e-4)


# Standing on both corners, kn = ks = 1.98e7 N/m: worked out from the largest eigenvalue [s], to two digits.
@pytest.mark.parametrize(("number", "published"), [(4, 1.9e-4), (3, 5.4e-4)])
def test_critical_step_of_the_body_is_below_eq_7(block, number, published):
    scene = block(number)
    limit = dem.critical_step(scene, KN, KN, 0.0)
    assert limit == pytest.approx(published, abs=0.05e-4)
    assert limit < dem.eq7_step(scene.mass, KN)


@pytest.mark.parametrize("xi", [0.1, 1.0])
def test_damping_lowers_the_step_as_the_closed_form_says(block, xi):
    scene = block(3)
    c = 2.0 * xi * math.sqrt(KN * scene.mass)
    om = 2.0 / dem.critical_step(scene, KN, KN, 0.0)
    modal = c * om / (2.0 * KN)
    expected = 2.0 / om * (math.sqrt(1.0 + modal**2) - modal)
    # Bisection stops at 1e-12.
    assert dem.critical_step(scene, KN, KN, c) == pytest.approx(expected, rel=1e-10)


def growth(monkeypatch, scene, share, xi, ks):
    """How much a tremor of 1e-7 rad/s has grown after 100 steps at `share` of the limit."""
    c = 2.0 * xi * math.sqrt(KN * scene.mass)
    dt = share * dem.critical_step(scene, KN, ks, c)
    monkeypatch.setattr(simulate_module, "critical_step", lambda *arguments: math.inf)
    history = dem.simulate(scene, t_end=4000 * dt, dt=dt, mu=math.inf, damping=c, ks=ks, omega0=1e-7, save_every=1)
    return np.abs(history.omega[-100:]).max() / 1e-7


@pytest.mark.parametrize("number", [3, 4])
@pytest.mark.parametrize("xi", [0.0, 0.1, 1.0])
@pytest.mark.parametrize("ks", [KN, 2.5 * KN])  # softer shear leaves the lying block the stricter one
def test_runs_just_below_the_limit_stay_bounded_and_just_above_grow(monkeypatch, block, number, xi, ks):
    assert growth(monkeypatch, block(number), 0.99, xi, ks) < 10.0
    assert growth(monkeypatch, block(number), 1.01, xi, ks) > 1e3


def test_step_above_the_limit_is_refused_with_name_value_and_limit(block):
    limit = dem.critical_step(block(4), KN, KN, 0.0)
    with pytest.raises(ValueError, match=rf"dt=0\.0002 s: want a step below {limit:.6g} s"):
        dem.simulate(block(4), t_end=1.0, dt=2e-4, mu=0.5, damping=0.0)


def test_a_run_that_blows_up_says_so_and_when(monkeypatch, block):
    monkeypatch.setattr(simulate_module, "critical_step", lambda *arguments: math.inf)
    history = dem.simulate(block(4), t_end=1.0, dt=1.5e-3, mu=0.5, damping_ratio=1.0, gap0=0.01)
    assert history.outcome is dem.Outcome.UNSTABLE
    assert 0.04 < history.end_time < 1.0  # the fall takes 0.045 s
    assert f"t = {history.end_time:.6g} s" in repr(history)
    assert np.isnan(history.overturning_time)
