"""Angular-velocity ratio e of rocking on dashpots, and the limit of stiff, critically damped corners.

e of a swing is measured by energies: sqrt(E2/E1), E = cos(alpha - |theta|) - cos(alpha) at the peaks of |theta| before
and after the impact. Peaks of omega are not used: the corner's springs ring on them.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dem

G = 9.80665


def swings(history):
    """Peak |theta| of each swing and the times at which theta passes 0."""
    theta, time = history.theta, history.time
    at = np.flatnonzero(theta[1:] * theta[:-1] < 0.0)
    crossings = time[at] + theta[at] / (theta[at] - theta[at + 1]) * (time[at + 1] - time[at])
    return np.array([np.abs(part).max() for part in np.split(theta, at + 1)]), crossings


def ratios(peaks, alpha):
    energy = np.cos(alpha - peaks) - math.cos(alpha)
    return np.sqrt(energy[1:] / energy[:-1])


# Numbers of an independent trial of springs and dashpots at the corners, rough floor, Coulomb on the spring's force.
TABLE = [(0.0, 0.963), (0.02, 0.950), (0.1, 0.904), (0.3, 0.879), (1.0, 0.8751)]


@pytest.mark.parametrize(("xi", "published"), TABLE)
def test_restitution_falls_with_damping_as_tabulated(block, xi, published):
    alpha = math.atan(0.3)
    history = dem.simulate(
        block(1), t_end=0.9, dt=5e-6, mu=1.0, damping_ratio=xi, theta0=0.12, save_every=20, coulomb="spring"
    )
    # One unit of the table's last digit: the trial says nothing finer of step and of how a swing was measured.
    assert ratios(swings(history)[0][:2], alpha)[0] == pytest.approx(published, abs=0.001)


@pytest.mark.parametrize(("xi", "published"), TABLE)
def test_where_coulombs_limit_acts_moves_the_restitution_by_less_than_half_a_per_cent(block, xi, published):
    # With the limit on spring and dashpot together a landing corner slips less and loses less: e is never lower.
    alpha = math.atan(0.3)
    history = dem.simulate(block(1), t_end=0.9, dt=5e-6, mu=1.0, damping_ratio=xi, theta0=0.12, save_every=20)
    e = ratios(swings(history)[0][:2], alpha)[0]
    assert published - 0.001 <= e <= published + 0.005


@pytest.mark.parametrize("kn", [1.98e7, 1.98e9])
def test_restitution_at_fixed_damping_ratio_hardly_depends_on_stiffness(block, kn):
    history = dem.simulate(
        block(1), t_end=0.9, dt=2e-6, mu=1.0, damping_ratio=0.1, theta0=0.12, kn=kn, ks=kn, save_every=50,
        coulomb="spring",
    )  # fmt: skip
    # The same trial: 0.904 to 0.907 from 1.98e7 to 1.98e9 N/m, to the last digit.
    assert 0.904 - 0.001 <= ratios(swings(history)[0][:2], math.atan(0.3))[0] <= 0.907 + 0.001


def method_1(b, h, theta0, impacts):
    """Nonlinear rocking with Housner's impact: times of the impacts and peaks between them."""
    alpha, radius = math.atan(b / h), math.hypot(b, h) / 2.0
    p2, e = 0.75 * G / radius, 1.0 - 1.5 * math.sin(alpha) ** 2

    def flat(t, y, s):
        return y[0]

    def turn(t, y, s):
        return y[1]

    flat.terminal, t, theta, omega, s = True, 0.0, theta0, 0.0, 1.0
    times, peaks = [], [theta0]
    for _ in range(impacts):
        flow = solve_ivp(
            lambda t, y, s: (y[1], -p2 * s * math.sin(alpha - s * y[0])),
            (t, t + 10.0), (theta, omega), args=(s,), events=(flat, turn), rtol=1e-10, atol=1e-12,
        )  # fmt: skip
        if times:
            peaks.append(abs(flow.y_events[1][0][0]))
        t, omega = float(flow.t_events[0][-1]), e * float(flow.y_events[0][-1][1])
        times.append(t)
        s = -s
        theta = s * 1e-14
    return np.array(times), np.array(peaks)


def test_reference_gives_the_known_impact_times():
    # Nonlinear free rocking, b = 0.2, h = 0.8 m, theta0 = alpha/2, g = 9.81 (own closed check to 1e-6).
    times, _ = method_1(0.2, 0.8, math.atan(0.25) / 2.0, 5)
    scale = math.sqrt(9.81 / G)  # times go with g^(-1/2)
    assert times / scale == pytest.approx([0.312309, 0.820592, 1.251877, 1.625867, 1.954508], abs=2e-6)


def test_dem_block_tends_to_method_1_as_stiffness_grows(block):
    # Overdamped corners (xi = 3): at xi = 1 the limit of stiffness is e = 0.8766, 0.0004 above Housner's ratio.
    times, peaks = method_1(0.15, 0.5, 0.12, 4)
    e_housner, errors = 1.0 - 1.5 * math.sin(math.atan(0.3)) ** 2, []
    for kn, dt in ((1.98e6, 2e-5), (1.98e7, 1e-5), (1.98e8, 4e-6), (1.98e9, 1e-6)):
        history = dem.simulate(
            block(3), t_end=1.5, dt=dt, mu=math.inf, damping_ratio=3.0, theta0=0.12, kn=kn, ks=kn, save_every=20
        )
        found_peaks, found_times = swings(history)
        e = ratios(found_peaks[:2], math.atan(0.3))[0]
        errors.append(
            (np.abs(found_times[:4] - times).max(), np.abs(found_peaks[:4] - peaks).max(), abs(e - e_housner))
        )
    print("impact times, peaks, e:", *(f"({a:.1e} s, {b:.1e} rad, {c:.1e})" for a, b, c in errors))
    # The overlap under the weight, m g/kn, is a tilt of m g/(kn b): errors go with 1/kn until those of the step.
    assert np.all(np.diff(errors, axis=0) < 0.0)
    assert errors[-1][0] < 1e-4
    assert errors[-1][1] < 1e-5
    assert errors[-1][2] < 2e-5
