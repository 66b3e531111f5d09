"""Flights of the Taylor solver as polynomials, function by function: mpmath's series, closed forms, sampling.

`test_taylor` has the compiled functions.
"""

import math
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pytest
from functions_of_taylor import ALPHA, COEFFICIENTS, column, lanes_of
from functions_of_taylor import interpreted as interpreted  # for every test of this file

from rocking.solvers.taylor import flight, roots
from rocking.solvers.taylor.vector import LANES


def test_polynomials_of_lanes_are_those_of_numpy() -> None:
    t = lanes_of(np.linspace(-0.9, 1.3, LANES))
    for lane in range(LANES):
        plain = np.polynomial.Polynomial(column(COEFFICIENTS, lane))
        assert flight.value(COEFFICIENTS, t)[lane] == pytest.approx(plain(t[lane]), rel=1e-12)
        assert flight.slope(COEFFICIENTS, t)[lane] == pytest.approx(plain.deriv()(t[lane]), rel=1e-12)
        derived = roots.differentiated(COEFFICIENTS)
        np.testing.assert_allclose(column(derived, lane)[:-1], np.asarray(plain.deriv().coef, dtype=float), rtol=1e-15)
        less = column(roots.less(2.5, COEFFICIENTS), lane)
        np.testing.assert_allclose(less, [2.5 - plain.coef[0], *-plain.coef[1:]])
    for n in range(1, 8):  # each length of a series, by its number of pairs
        series = COEFFICIENTS[:n]
        want = np.polynomial.Polynomial(column(series, 3))(0.7)
        assert flight.evaluated(series, lanes_of(0.7))[3] == pytest.approx(want, rel=1e-13)


def test_a_coefficient_of_a_product_is_that_of_numpy() -> None:
    a, b = COEFFICIENTS[:6], COEFFICIENTS[3:9]
    for n in range(1, 7):
        want = np.polynomial.polynomial.polymul(column(a[:n], 2), column(b[:n], 2))[n - 1]
        assert flight.multiplied(a[:n], b[:n])[2] == pytest.approx(want, rel=1e-13)


def test_sine_and_cosine_by_their_series_are_those_of_the_library() -> None:
    z = lanes_of(np.linspace(-0.8, 0.8, LANES))
    sine, cosine = flight.sine_and_cosine(z)
    np.testing.assert_allclose(sine, np.sin(z), rtol=3e-16, atol=1e-17)
    np.testing.assert_allclose(cosine, np.cos(z), rtol=3e-16)
    start, angle = np.linspace(-3.0, 3.0, LANES), lanes_of(np.linspace(-1.0, 1.0, LANES) * flight.LONGEST_TURN)
    turned = flight.turn(lanes_of(np.sin(start)), lanes_of(np.cos(start)), angle)
    np.testing.assert_allclose(np.array(turned), [np.sin(start + angle), np.cos(start + angle)], rtol=0.0, atol=3e-16)


# The polynomial is put into the equation, and both sides are expanded by mpmath.
@pytest.mark.parametrize("form", [None, "nonlinear"])
@pytest.mark.parametrize("terms", [2, 8])
def test_a_flight_solves_the_equation_of_the_block_term_by_term(form: Any, terms: int) -> None:
    x, v = np.linspace(0.01, 1.5, LANES), np.linspace(-0.6, 0.9, LANES)
    push = [lanes_of(np.linspace(0.1, 0.4, LANES) * (-1.3) ** n) for n in range(terms)]
    p2, alpha = np.linspace(4.0, 9.0, LANES), np.linspace(0.1, 0.4, LANES)
    turned = None if form is None else (lanes_of(np.sin(alpha - math.pi / 4)), lanes_of(np.cos(alpha - math.pi / 4)))
    given = [lanes_of(part) for part in (x, v)] + [push] + [lanes_of(part) for part in (p2, alpha)]
    c = flight.flight(*given, turned, lanes_of(-math.inf))
    kept = flight.flight(*given, turned, lanes_of(0.0))
    np.testing.assert_allclose(kept[2], np.maximum(c[2], 0.0))
    for lane in (0, 5, 11):
        own, u = column(c, lane), column(push, lane)

        def force(t: Any, own: Any = own, u: Any = u, lane: int = lane) -> Any:
            psi = alpha[lane] - mpmath.polyval(list(own[::-1]), t)
            pushed = mpmath.polyval(list(u[::-1]), t)
            if form is None:
                return -p2[lane] * (psi + pushed)
            return -p2[lane] * (mpmath.sin(psi) + pushed * mpmath.cos(psi))

        with mpmath.workdps(40):
            right = [float(a) for a in mpmath.taylor(force, 0, 7)]
        left = [own[n + 2] * (n + 1) * (n + 2) for n in range(8)]
        assert own[:2].tolist() == [x[lane], v[lane]]
        np.testing.assert_allclose(left, right, rtol=1e-10, atol=1e-12)


def test_a_push_of_a_growing_sine_has_the_terms_of_mpmath() -> None:
    t, omega, phase = 1.3, 5.0, 0.4
    angle = omega * t + phase
    found = flight.push_on_sine(*(lanes_of(part) for part in (0.7, omega, t, math.sin(angle), math.cos(angle))))
    with mpmath.workdps(40):
        want = [float(a) for a in mpmath.taylor(lambda s: 0.7 * s * mpmath.sin(omega * s + phase), t, 7)]
    np.testing.assert_allclose(column(found, 4), want, rtol=1e-13)


# x = alpha + u + A cosh + B sinh.
def test_a_glide_is_the_closed_form_and_its_curvature_that_of_its_ends() -> None:
    p = np.linspace(0.5, 6.0, LANES)
    h = np.full(LANES, flight.LONGEST) / p
    x, v = np.linspace(0.0, 0.6, LANES), np.linspace(0.5, -0.5, LANES)
    u, rate = np.linspace(-0.3, 0.3, LANES), np.linspace(1.0, -2.0, LANES)
    A, B = x - ALPHA - u, (v - rate) / p
    x_end = ALPHA + u + rate * h + A * np.cosh(p * h) + B * np.sinh(p * h)
    v_end = rate + p * (A * np.sinh(p * h) + B * np.cosh(p * h))
    given = [lanes_of(x), lanes_of(v), (lanes_of(u), lanes_of(rate)), lanes_of(h), lanes_of(p * p), lanes_of(ALPHA)]
    found = flight.glide(*given, lanes_of(-math.inf))
    np.testing.assert_allclose(found[0], x_end, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(found[1], v_end, rtol=1e-12, atol=1e-15)
    tau = np.linspace(0.0, 1.0, 200)[:, None] * h
    curvature = (p * p * (A * np.cosh(p * tau) + B * np.sinh(p * tau))).max(axis=0)
    np.testing.assert_allclose(found[2], np.maximum(curvature, 0.0), rtol=1e-12, atol=1e-13)
    lifted = flight.glide(*given, lanes_of(0.0))
    up = A < 0.0
    np.testing.assert_allclose(lifted[0][up], (x + v * h + (v - rate) * (np.sinh(p * h) / p - h))[up], rtol=1e-13)


# What the terms from the fourth on add is bounded by their moduli; without them it is the greater of both ends.
def test_the_largest_curvature_of_a_flight_is_that_of_its_ends_and_a_bound_between() -> None:
    rng = np.random.default_rng(6)
    c = [lanes_of(rng.normal(size=LANES)) for _ in range(10)]
    h = lanes_of(np.linspace(0.1, 0.7, LANES))
    short = [*c[:4], *(lanes_of(0.0) for _ in range(6))]
    ends = np.maximum(np.maximum(2.0 * c[2], 2.0 * c[2] + 6.0 * c[3] * h), 0.0)
    np.testing.assert_allclose(flight.largest_curvature(short, h), ends, rtol=1e-14)
    beyond = sum(n * (n - 1) * np.abs(c[n]) * h ** (n - 2) for n in range(4, 10))
    bound = flight.largest_curvature(c, h)
    np.testing.assert_allclose(bound, ends + beyond, rtol=1e-13)
    for lane in range(LANES):
        sampled = np.polynomial.Polynomial(column(c, lane)).deriv(2)(np.linspace(0.0, h[lane], 300))
        assert bound[lane] >= sampled.max()
