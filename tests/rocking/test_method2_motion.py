"""Method 2 in motion: chains of impacts, drops, slides, flights and trips, against closed forms and Method 1."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from excitation import RampedSinusoid
from rocking import Block, Method1, Method2, Mode, Outcome, solve

G = 9.81
SOLVERS = pytest.mark.parametrize("solver", ["numba", "scipy"])


# Nonlinear free rocking of the block of 0.2 x 0.8 m from alpha/2 with Housner's restitution: quadrature of the energy
# integral omega^2 = 2 p^2 (cos(alpha - theta_max) - cos(alpha - theta)) over each swing, in the form theta = m - x^2.
@SOLVERS
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_rough_floor_without_bounce_gives_the_five_impacts_of_housners_chain(
    slender: Block, solver: str, side: float
) -> None:
    alpha, p = math.atan(0.25), math.sqrt(0.75 * G / (0.5 * math.hypot(0.2, 0.8)))

    def quarter(m: float) -> float:
        def slowness(x: float) -> float:
            middle, half = alpha - m + 0.5 * x * x, 0.5 * x * x
            sinc = math.sin(half) / half if half > 0.0 else 1.0
            return 2.0 / (p * math.sqrt(2.0 * math.sin(middle) * sinc))

        return quad(slowness, 0.0, math.sqrt(m), epsabs=1e-13)[0]

    tilt, expected = 0.5 * alpha, []
    e = 1.0 - 1.5 / 17.0
    for swing in range(5):
        expected.append(quarter(tilt) if swing == 0 else expected[-1] + 2.0 * quarter(tilt))
        tilt = alpha - math.acos(math.cos(alpha) + e**2 * (math.cos(alpha - tilt) - math.cos(alpha)))
    run = solve(Method2(slender, friction=1.2, g=G), theta=side * 0.5 * alpha, t_end=2.0, solver=solver)
    # The promise for the two solvers at the default tolerance: 1e-8 s.
    np.testing.assert_allclose(run.impact_times, expected, rtol=0.0, atol=1e-8)
    assert run.mode_durations()[Mode.ROTATION] == pytest.approx(2.0, abs=1e-12)


@SOLVERS
@pytest.mark.parametrize("e_n", [0.0, 0.4])
@pytest.mark.parametrize("mu", [0.2, 0.6])
def test_the_mirror_image_moves_as_the_mirror_image_to_the_last_bit(
    slender: Block, window: Any, mu: float, e_n: float, solver: str
) -> None:
    system = Method2(slender, friction=mu, kinetic_friction=0.8 * mu, normal_restitution=e_n,
                     tangential_restitution=0.2, chatter_time=1e-4, g=G)  # fmt: skip
    runs = []
    for side in (1.0, -1.0):
        motion = window(0.05, 1.5, x=(0.0, side * 5.0, 14.0, 0.2), z=(0.0, 3.0, 21.0, 1.0))
        initial = system.initial_state(theta=side * 0.05, omega=-side * 0.1, u=side * 0.2)
        runs.append(solve(system, motion, initial=initial, t_end=1.5, solver=solver, max_events=3000))
    assert len(runs[0].events) > 5
    np.testing.assert_array_equal(runs[0].events.t, runs[1].events.t)
    np.testing.assert_array_equal(runs[0].mode, runs[1].mode)
    for i, name in enumerate(system.state_names):
        sign = 1.0 if name in ("z", "v") else -1.0
        np.testing.assert_array_equal(runs[0].y[:, i], sign * runs[1].y[:, i], err_msg=name)


# Newton: a flat block dropped from a height z lands after sqrt(2 z/g) with sqrt(2 g z), leaves with e_n times that and
# flies for twice v/g; the series ends after 2 e_n v/(g (1 - e_n)) more.
@SOLVERS
@pytest.mark.parametrize("e_n", [0.3, 0.5, 0.8])
@pytest.mark.parametrize("ratio", [0.25, 1.0, 3.0])
def test_a_dropped_block_bounces_flat_with_e_n_until_the_series_ends(ratio: float, e_n: float, solver: str) -> None:
    system = Method2(Block(b=ratio * 0.4, h=0.4), friction=0.5, normal_restitution=e_n, g=G)
    z = 0.1
    v, fall = math.sqrt(2.0 * G * z), math.sqrt(2.0 * z / G)
    end = fall + 2.0 * e_n * v / (G * (1.0 - e_n))
    run = solve(system, initial=system.initial_state(z=z), t_end=1.2 * end, solver=solver)
    assert run.outcome is Outcome.AT_REST
    flights = np.array([fall + 2.0 * v / G * (e_n - e_n ** (n + 1)) / (1.0 - e_n) for n in range(6)])
    np.testing.assert_allclose(run.impact_times[:6], flights, rtol=0.0, atol=1e-8)
    ups = run.events.y_after[:5, 4]
    np.testing.assert_allclose(ups, v * e_n ** np.arange(1, 6), rtol=1e-9)
    np.testing.assert_array_equal(run.theta, 0.0)
    # A series of less than chatter_time = 1e-5 s is finished at once.
    assert run.events.t[-1] == pytest.approx(end, abs=1.1e-5)


# The same at one corner in spin-free rocking contact is not to be had in closed form; a block that falls on a single
# corner bounces with e_n exactly, by the definition of the law.
def test_a_corner_of_a_tilted_falling_block_bounces_with_e_n(slender: Block) -> None:
    system = Method2(slender, friction=0.4, normal_restitution=0.6, g=G)
    run = solve(system, initial=system.initial_state(theta=0.3, z=0.05), t_end=0.11)
    assert run.impact_times[0] == pytest.approx(math.sqrt(0.1 / G), abs=1e-9)
    assert run.events.y_before[0, 4] == pytest.approx(-math.sqrt(2.0 * G * 0.05), rel=1e-9)
    assert run.events.y_after[0, 4] == pytest.approx(0.6 * math.sqrt(2.0 * G * 0.05), rel=1e-9)


@SOLVERS
@pytest.mark.parametrize("u", [1.0, -1.0])
def test_a_slide_stops_after_v_squared_over_two_mu_g(solver: str, u: float) -> None:
    system = Method2(Block(b=0.5, h=0.5), friction=0.6, kinetic_friction=0.4, g=G)
    run = solve(system, initial=system.initial_state(u=u), t_end=1.0, solver=solver)
    assert run.outcome is Outcome.AT_REST
    middle = run.y[:, 0] - 0.25 * run.s  # of the base, from the corner that the state speaks of
    assert middle[-1] - middle[0] == pytest.approx(math.copysign(1.0 / (2.0 * 0.4 * G), u), rel=1e-9)
    assert run.events.t[0] == pytest.approx(1.0 / (0.4 * G), rel=1e-9)
    assert run.mode_durations()[Mode.SLIDE] == pytest.approx(1.0 / (0.4 * G), rel=1e-9)


# West: (b/h)(g + a_z); Coulomb: mu_s (g + a_z).  The push grows as 8 sin(0.1 t), 0.8 m/s^3.
@SOLVERS
@pytest.mark.parametrize("a_z", [0.0, -3.0])
@pytest.mark.parametrize(("mu_s", "first"), [(0.6, Mode.ROTATION), (0.2, Mode.SLIDE)])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_rest_ends_by_the_lower_of_tipping_and_slipping(
    slender: Block, window: Any, mu_s: float, first: Mode, side: float, a_z: float, solver: str
) -> None:
    motion = window(0.0, 6.0, steady=(0.0, a_z), x=(0.0, side * 8.0, 0.1, 0.0))
    run = solve(Method2(slender, friction=mu_s, kinetic_friction=0.15, g=G), motion, t_end=6.0, solver=solver)
    onset = min(mu_s, 0.25) * (G + a_z)
    assert run.onset_time == pytest.approx(math.asin(onset / 8.0) / 0.1, abs=1e-9)
    assert run.events.mode_after[0] == first
    late = np.searchsorted(run.t, run.onset_time + 0.1)
    if first == Mode.SLIDE:
        assert np.sign(run.y[late, 3]) == -side
    else:
        assert (np.sign(run.theta[late]), run.s[late]) == (-side, -side)


# Newton: under a steady push beyond mu_s g and friction below b/h the block slides with -(a_x - mu_k g), upright.
@SOLVERS
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_steady_push_drags_the_floor_away_with_a_x_less_mu_g(
    slender: Block, constant: Any, side: float, solver: str
) -> None:
    system = Method2(slender, friction=0.2, kinetic_friction=0.15, g=G)
    run = solve(system, constant(side * 5.0, 1.0), t_end=1.0, solver=solver)
    acceleration = -side * (5.0 - 0.15 * (G + 1.0))
    np.testing.assert_allclose(run.y[:, 3], acceleration * run.t, rtol=1e-9, atol=1e-12)
    middle = run.y[:, 0] - 0.1 * run.s  # of the base, from the corner that the state speaks of
    np.testing.assert_allclose(middle, 0.5 * acceleration * run.t**2, rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(run.theta, 0.0)


# Moments about the leading corner: friction mu_k m g at h/2 against m g at b/2; it trips forward if mu_k > b/h.
@SOLVERS
@pytest.mark.parametrize("u", [2.0, -2.0])
def test_a_sliding_block_trips_over_its_leading_corner_when_mu_exceeds_b_over_h(
    slender: Block, u: float, solver: str
) -> None:
    tripping = Method2(slender, friction=0.3, g=G)
    run = solve(tripping, initial=tripping.initial_state(u=u), t_end=0.05, solver=solver)
    assert run.mode[1] == Mode.SLIDE_ROTATION
    assert np.sign(run.theta[-1]) == np.sign(u)
    # At once: omega' = (N/rho2)(mu h/2 - b/2), N = g/D, D = 1 + (b/2)(b/2 - mu h/2)/rho2, Newton at theta = 0.
    rho2 = (0.2**2 + 0.8**2) / 12.0
    N = G / (1.0 + 0.1 * (0.1 - 0.3 * 0.4) / rho2)
    # Over 0.5 ms (10 samples) the rate grows by its own 1e-5, and mu N acts on u by as much.
    assert run.omega[10] / run.t[10] == pytest.approx(math.copysign(N * (0.3 * 0.4 - 0.1) / rho2, u), rel=1e-4)
    upright = Method2(slender, friction=0.2, g=G)
    run = solve(upright, initial=upright.initial_state(u=u), t_end=0.05, solver=solver)
    np.testing.assert_array_equal(run.theta, 0.0)


# Ballistics: the centre of mass on a parabola, the spin constant; the base's own acceleration counts against it.
@SOLVERS
def test_free_flight_is_a_parabola_with_constant_spin(slender: Block, constant: Any, solver: str) -> None:
    system = Method2(slender, friction=0.5, g=G)
    y0, q0 = system.initial_state(theta=0.1, omega=1.7, u=0.4, v=3.0, z=0.3)
    run = solve(system, constant(1.5, -2.0), initial=(y0, q0), t_end=0.5, solver=solver)
    assert len(run.impact_times) == 0
    np.testing.assert_array_equal(run.omega, 1.7)
    # Centre of mass from the +x corner: minus (b/2 cos - h/2 sin, -b/2 sin - h/2 cos).
    theta = run.theta
    x = run.y[:, 0] - 0.1 * np.cos(theta) + 0.4 * np.sin(theta)
    z = run.y[:, 1] + 0.1 * np.sin(theta) + 0.4 * np.cos(theta)
    x_dot = 0.4 + 1.7 * (0.1 * math.sin(0.1) + 0.4 * math.cos(0.1))
    z_dot = 3.0 + 1.7 * (0.1 * math.cos(0.1) - 0.4 * math.sin(0.1))
    t = run.t
    np.testing.assert_allclose(x, x[0] + x_dot * t - 0.5 * 1.5 * t**2, rtol=0.0, atol=1e-8)
    np.testing.assert_allclose(z, z[0] + z_dot * t - 0.5 * (G - 2.0) * t**2, rtol=0.0, atol=1e-8)
    np.testing.assert_allclose(theta, 0.1 + 1.7 * t, rtol=0.0, atol=1e-9)


def least_friction(run: Any, motion: Any, block: Block) -> float:
    """Largest |F|/N over a run of Method 1, from Newton's law for the centre of mass of the rotating block."""
    R, alpha = 0.5 * math.hypot(block.b, block.h), math.atan(block.b / block.h)
    p2, rows = 0.75 * G / R, run.mode == Mode.ROTATION
    theta, omega, s = run.theta[rows], run.omega[rows], run.s[rows]
    a = np.array([motion(float(t)) for t in run.t[rows]], dtype=float)
    psi = alpha - s * theta
    spin = -p2 * (s * (1.0 + a[:, 1] / G) * np.sin(psi) + a[:, 0] / G * np.cos(psi))
    F = a[:, 0] + R * np.cos(psi) * spin + s * R * np.sin(psi) * omega**2
    N = G + a[:, 1] + s * R * np.sin(psi) * spin - R * np.cos(psi) * omega**2
    assert np.all(N > 0.0)
    return float(np.max(np.abs(F) / N))


# On a floor rough enough, without bounce, Method 2 is Method 1: with Housner's e (0.912) or, by `two_corner`, another.
@SOLVERS
@pytest.mark.parametrize("e", [None, 0.95, 0.87])
def test_on_a_rough_floor_method_2_is_method_1(slender: Block, solver: str, e: float | None) -> None:
    motion = RampedSinusoid(frequency=2.0, duration=20.0, final_amplitude=8.0)
    one = solve(Method1(slender, restitution=e, g=G), motion, t_end=7.0, solver=solver)
    assert len(one.impact_times) > 3
    mu = 1.2
    assert least_friction(one, motion, slender) < mu
    law: Any = {} if e is None else {"impact_law": "two_corner", "restitution": e}
    two = solve(Method2(slender, friction=mu, g=G, **law), motion, t_end=7.0, solver=solver)
    assert len(two.impact_times) == len(one.impact_times)
    assert two.outcome is one.outcome
    n = min(10, len(one.impact_times))
    # Two solutions with a local tolerance of 1e-9, whose difference each impact may double.
    np.testing.assert_allclose(two.impact_times[:n], one.impact_times[:n], rtol=0.0, atol=2e-7)


@SOLVERS
def test_infinite_friction_never_slips_where_a_finite_one_does(slender: Block, window: Any, solver: str) -> None:
    motion = window(0.0, 0.5, x=(0.0, 12.0, 4.0 * math.pi, 0.0))
    rough = solve(Method2(slender, friction=math.inf, g=G), motion, t_end=0.25, solver=solver)
    finite = solve(Method2(slender, friction=0.4, g=G), motion, t_end=0.25, solver=solver)
    assert rough.mode_durations()[[Mode.SLIDE, Mode.SLIDE_ROTATION]].sum() == 0.0
    assert finite.mode_durations()[[Mode.SLIDE, Mode.SLIDE_ROTATION]].sum() > 0.01
    one = solve(Method1(slender, g=G), motion, t_end=0.25, solver=solver)
    lifted = np.flatnonzero(rough.events.mode_after == Mode.ROTATION_JUMP)
    same = rough.t < (rough.events.t[lifted[0]] if len(lifted) else 0.25)
    np.testing.assert_allclose(rough.theta[same], one.theta[: len(rough.t)][same], rtol=0.0, atol=1e-8)


# Newton: where g + a_z < 0 the floor leaves the block, which then flies with z'' = -(g + a_z) relative to it.
@SOLVERS
def test_a_floor_that_falls_faster_than_g_leaves_the_block_in_the_air(slender: Block, window: Any, solver: str) -> None:
    drop = 3.0
    motion = window(0.2, 0.4, z=(-(G + drop), 0.0, 0.0, 0.0))
    run = solve(Method2(slender, friction=0.5, g=G), motion, t_end=1.0, solver=solver)
    assert run.onset_time == pytest.approx(0.2, abs=1e-12)
    assert run.events.mode_after[0] == Mode.TRANSLATION_JUMP
    # Up with 3 m/s^2 for 0.2 s, then a parabola under g: landing where z = 0.06 + 0.6 t - g t^2/2 vanishes.
    z, v = 0.5 * drop * 0.04, drop * 0.2
    landing = 0.4 + (v + math.sqrt(v**2 + 2.0 * G * z)) / G
    assert run.impact_times[0] == pytest.approx(landing, abs=1e-8)
    assert run.outcome is Outcome.AT_REST
    top = float(np.max(run.y[:, 1]))
    # The highest of the samples, 1 ms apart, is g (0.5 ms)^2/2 below the top at most.
    assert top == pytest.approx(z + v**2 / (2.0 * G), abs=2e-6)
    np.testing.assert_array_equal(run.theta, 0.0)


def test_a_block_at_rest_lifts_off_where_a_growing_fall_of_the_floor_reaches_g(slender: Block, window: Any) -> None:
    motion = window(0.0, 2.0, z=(0.0, -12.0, 1.0, 0.0))
    run = solve(Method2(slender, friction=0.5, g=G), motion, t_end=1.2)
    assert run.onset_time == pytest.approx(math.asin(G / 12.0), abs=1e-9)
    assert run.events.mode_after[0] == Mode.TRANSLATION_JUMP
