"""Flights of lanes on devices and searches of their roots, function by function: closed forms, roots by NumPy.

`test_devices` has the compiled functions.
"""

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pytest
from functions_of_exact import BODY, COEFFICIENTS, PAR, WAVE, G, column, first_fall, linear_flight, sine_flight
from functions_of_exact import interpreted as interpreted  # for every test of this file

from rocking.solvers.exact import jax_flight

MANY = [np.array([c, -0.5 * c, 0.3 * c + 0.1]) for c in COEFFICIENTS]


def test_polynomials_of_lanes_are_those_of_numpy() -> None:
    t = np.array([0.3, -0.6, 1.2])
    slopes = jax_flight.differentiated(MANY)
    assert len(slopes) == 10
    for lane in range(3):
        plain = np.polynomial.Polynomial(column(MANY, lane))
        assert jax_flight.value(MANY, t)[lane] == pytest.approx(plain(t[lane]), rel=1e-13)
        assert jax_flight.slope(MANY, t)[lane] == pytest.approx(plain.deriv()(t[lane]), rel=1e-13)
        shorter = column(jax_flight._deflated(MANY, np.array([True, False, True])), lane)
        np.testing.assert_array_equal(shorter, column(MANY, lane) if lane == 1 else [*column(MANY, lane)[1:], 0.0])


# No less than what is sampled, and reached where all coefficients have one sign.
@pytest.mark.parametrize("order", [1, 2])
def test_the_bound_of_the_change_of_a_derivative_is_reached_where_all_signs_are_equal(order: int) -> None:
    t, h = np.linspace(0.0, 0.8, 300), np.full(3, 0.8)
    for c in (MANY, [np.abs(part) for part in MANY]):
        bound = jax_flight._change(c, h, order)
        for lane in range(3):
            derived = np.polynomial.Polynomial(column(c, lane)).deriv(order)
            change = np.abs(derived(t) - derived(0.0)).max()
            assert bound[lane] >= change
            if c is not MANY:
                assert bound[lane] == pytest.approx(change, rel=1e-13)


@pytest.mark.parametrize("s", [1.0, -1.0])
def test_flights_of_lanes_are_those_of_the_closed_forms(s: float) -> None:
    body, t = BODY._replace(s=s), 0.9
    with mpmath.workdps(50):
        on_line = [float(c) for c in mpmath.taylor(linear_flight(body, PAR, 1.3, -2.1), 0, 9)]
        on_sine = [float(c) for c in mpmath.taylor(sine_flight(body, PAR, WAVE, t), 0, 9)]
        wave = mpmath.taylor(lambda t: WAVE.rate / G * t * mpmath.sin(WAVE.omega * t + WAVE.phase), t, 7)
    one, no = np.ones(1), np.array([False])
    angle = WAVE.omega * t + WAVE.phase
    push = jax_flight.push_on_sine(one * WAVE.rate / G, WAVE.omega * one, t * one, np.sin(angle), np.cos(angle))
    np.testing.assert_allclose(np.ravel(push), np.array(wave, dtype=float), rtol=3e-14)
    for parts, want in (([1.3 * one / G, -2.1 * one / G], on_line), (push, on_sine)):
        given = (BODY.x * one, BODY.v * one, [s * part for part in parts], PAR[0] * one, PAR[1] * one)
        np.testing.assert_allclose(np.ravel(jax_flight.flight(*given, no)), want, rtol=3e-12)
        tipped = np.ravel(jax_flight.flight(*given, ~no))
        assert tipped[2] == pytest.approx(max(want[2], 0.0), rel=1e-12)
        bent = tipped[2] - (s * push[2][0] if len(parts) > 2 else 0.0)
        assert tipped[4] == pytest.approx(PAR[0] * bent / 12.0)


def test_newton_within_a_bracket_has_the_root_in_six_steps_and_never_passes_it() -> None:
    root = np.array([0.03, 0.31, 0.5, 0.77, 0.97])
    q = [root, 0.1 * root - 1.0, 0.1 * root - 0.1, -0.1 + 0.02 * root, np.full(5, -0.02), *np.zeros((5, 5))]
    at, done, low = jax_flight._newton(q, np.ones(5))
    assert done.all()
    np.testing.assert_allclose(at, root, rtol=1e-15 * 4)
    assert np.all(low <= root * (1.0 + 1e-15)) and np.any(low > 0.9 * root)


# Products of (1 - t/r): wherever a search stops no root has been passed, and some ten searches come to the root.
def test_searches_of_lanes_come_to_the_first_root_and_never_pass_one() -> None:
    rng = np.random.default_rng(8)
    n = 3000
    c = list((rng.normal(size=(n, 10)) * 0.3 ** np.arange(10) * 10.0 ** rng.uniform(-2.0, 0.0, (n, 10))).T)
    c[0] = np.abs(c[0])
    c[0][::5] = 0.0
    c[1][::10] = 0.0
    want = np.empty(n)
    for i in range(n):
        own = column(c, i)
        start = 2 if i % 10 == 0 else 1 if i % 5 == 0 else 0
        want[i] = 0.0 if own[start] < 0.0 else first_fall(own[start:], 1.0)
    at, lands = jax_flight.first_descent(c, np.ones(n))
    near = 1e-8 + 1e-10
    assert np.all(at <= np.minimum(want, 1.0) + near)
    assert np.all(np.abs(at[lands] - want[lands]) < near)
    assert np.all(want[(at >= 1.0) & ~lands] > 1.0 - near)
    assert np.all(at[~lands] > 0.0)
    # How many are decided at once, as found with these bounds and by no theory: a looser bound decides fewer.
    assert np.mean(lands[want < 1.0]) > 0.912
    assert np.mean(at[want > 1.0] >= 1.0) > 0.860


def test_a_lane_that_is_below_zero_falls_at_once_and_one_that_is_zero_goes_all_the_way() -> None:
    # Below; zero throughout; zero with a slope, a bend or a third power that goes down; one that comes up before.
    c = list(np.zeros((10, 6)))
    c[0][0], c[1][0], c[1][2], c[2][2], c[2][3], c[3][3] = -0.1, 2.0, -1.0, 3.0, -1.0, 3.0
    c[3][4], c[4][4], c[3][5], c[4][5] = -1.0, 3.0, 0.02, -0.1
    at, lands = jax_flight.first_descent(c, np.full(6, 0.7))
    np.testing.assert_allclose(at, [0.0, 0.7, 0.0, 0.0, 0.0, 0.2], rtol=1e-14)
    assert lands.tolist() == [True, False, True, True, True, True]


# Where it is unsure, the step is the root of the parabola below: q0 + q1 t - M t^2/2 with M = max(-q''), by hand.
def test_an_undecided_lane_walks_to_the_root_of_the_parabola_below_it() -> None:
    # q'' = 2 q2 + 6 q3 t between -1.2 and +-1.8: neither hollow nor round, slope 0.3 or -0.3 + changes.
    q0, q1 = np.array([0.4, 0.4]), np.array([0.3, -0.3])
    c = [q0, q1, np.array([-0.1, -0.1]), np.array([0.5, 0.5]), *np.zeros((6, 2))]
    M = 3.0 + 0.2
    at, lands = jax_flight.first_descent(c, np.ones(2))
    want = (np.sqrt(q1**2 + 2.0 * M * q0) + q1) / M
    np.testing.assert_allclose(at, want, rtol=1e-14)
    assert not lands.any()
