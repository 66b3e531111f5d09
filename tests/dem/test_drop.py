"""Flat drops: bounce period, rebound, and the measure of eq. (8) against the exact motion."""

import math

import numpy as np
import pytest

import dem

G = 9.80665
KN = 1.98e7


def drop(scene, height, **kw):
    return dem.simulate(scene, **{"mu": 0.5, "damping": 0.0, "gap0": height, **kw})


def contact_time(om, v):
    """z'' = om^2 (overlap) - g from touching at speed v until the overlap is back at 0."""
    return (2.0 / om) * (math.pi - math.atan(om * v / G))


def exact_height(t, om, height):
    """Height of the corners: parabola and spring in turn, without loss."""
    v = math.sqrt(2.0 * G * height)
    fall, touch = v / G, contact_time(om, v)
    t = np.mod(t + fall, 2.0 * fall + touch)  # 0 at take-off, so that t = 0 is the top
    air = v * t - 0.5 * G * t**2
    s = t - 2.0 * fall
    floor = -(v / om) * np.sin(om * s) - (G / om**2) * (1.0 - np.cos(om * s))
    return np.where(s < 0.0, air, floor)


def test_undamped_block_bounces_back_to_its_height(block):
    history = drop(block(4), 0.01, t_end=0.5, dt=2e-6, save_every=10)
    tops = history.z[1:-1][(history.z[1:-1] >= history.z[:-2]) & (history.z[1:-1] > history.z[2:])]
    assert len(tops) == 5
    # A landing inside a step shifts the energy by up to (om dt)^2/8 = 1.4e-5; five of them.
    assert tops - 0.125 == pytest.approx(0.01, rel=1e-4)


def test_bounce_period_is_flight_plus_contact_in_closed_form(block):
    scene, height = block(4), 0.01
    om = math.sqrt(2.0 * KN / scene.mass)
    v = math.sqrt(2.0 * G * height)
    history = drop(scene, height, t_end=0.6, dt=2e-6, save_every=1)
    below = history.z < 0.125
    landings = np.flatnonzero(below[1:] & ~below[:-1])
    share = (history.z[landings] - 0.125) / (history.z[landings] - history.z[landings + 1])
    periods = np.diff(history.time[landings] + share * 2e-6)
    # Bounce heights are right to 1e-4 (above), so flight times to 5e-5.
    assert len(periods) == 6
    assert periods == pytest.approx(2.0 * v / G + contact_time(om, v), rel=5e-5)


# Linear spring and dashpot, released when the total force is 0 (x'' = 0): Schwager & Poeschel (2007), eq. (21).
# Both corners share the mass, so the ratio of the pair is sqrt(2) times that of one corner.
@pytest.mark.parametrize("xi", [0.02, 0.1, 0.3, 0.6])
def test_damped_rebound_matches_spring_and_dashpot_without_adhesion(block, xi):
    scene = block(4)
    om = math.sqrt(2.0 * KN / scene.mass)
    beta = math.sqrt(2.0) * xi * om
    om_d = math.sqrt(om**2 - beta**2)
    end = (math.pi - math.atan2(2.0 * beta * om_d, om_d**2 - beta**2)) / om_d
    # Hardly any gravity: the closed form has none.
    history = dem.simulate(
        scene, t_end=4e-3, dt=1e-6, mu=0.5, damping_ratio=xi, gap0=2e-4, vz0=-0.4, g=1e-9, save_every=100
    )
    rebound = (history.z[-1] - history.z[-2]) / (history.time[-1] - history.time[-2]) / 0.4
    # The dashpots see the velocity of half a step before, which acts like a mass m - c dt/2: beta dt in the exponent.
    assert rebound == pytest.approx(math.exp(-beta * end), rel=beta * 1e-6 + 1e-5)


def eq8(scene, dt, onset, height):
    """Eq. (8): 2,000 samples over 2 s, the sum of both springs being kn."""
    every = round(1e-3 / dt)
    history = drop(scene, height, t_end=2.0, dt=dt, kn=KN / 2, ks=KN / 2, onset=onset, save_every=every)
    assert history.time.size == 2001
    exact = exact_height(history.time, math.sqrt(KN / scene.mass), height)
    return float(((history.z - 0.125 - exact) ** 2).sum())


# Own trial for one mass on kn, 2,000 samples, dropped from 1 cm [m^2]. The sum hangs on where in a step each of the
# 21 landings falls and scatters over two decades between heights that differ by a few per cent. So a trial's single
# number is claimed to lie within the range found over heights of 1 cm +- 5 %, widened by half at each end.
@pytest.mark.parametrize(
    ("dt", "incremental", "overlap"),
    [(2e-6, 9e-7, 2e-9), (1e-5, 1.6e-5, 1.3e-6), (5e-5, 2.7e-2, 3e-4)],
)
def test_overlap_onset_is_far_better_than_incremental_by_eq_8(block, dt, incremental, overlap):
    heights = np.linspace(0.0095, 0.0105, 11)
    found = {name: [eq8(block(4), dt, name, height) for height in heights] for name in ("incremental", "overlap")}
    for name, published in (("incremental", incremental), ("overlap", overlap)):
        print(f"dt={dt} {name}: median {np.median(found[name]):.2g}, {min(found[name]):.2g} to {max(found[name]):.2g}")
        assert min(found[name]) / 1.5 < published < 1.5 * max(found[name])
    assert np.median(found["overlap"]) < 0.12 * np.median(found["incremental"])
