"""Polynomials of the exact and Taylor solvers and their first roots, function by function: roots by NumPy, or by hand.

`test_exact` has the compiled functions.
"""

import math

import numpy as np
import pytest
from functions_of_exact import COEFFICIENTS, counting, first_fall
from functions_of_exact import interpreted as interpreted  # for every test of this file

from rocking.solvers.piecewise import polynomial


def test_the_value_of_a_polynomial_and_of_its_derivative_are_those_of_numpy() -> None:
    for t in (-0.7, 0.3, 0.9, 1.6):
        plain = np.polynomial.Polynomial(COEFFICIENTS)
        assert polynomial.value(COEFFICIENTS, t) == pytest.approx(plain(t), rel=1e-13)
        assert polynomial.value(polynomial.derivative(COEFFICIENTS), t) == pytest.approx(plain.deriv()(t), rel=1e-13)
        assert polynomial.value(polynomial.below(2.7, COEFFICIENTS), t) == pytest.approx(2.7 - plain(t), rel=1e-12)
    for roots in range(4):
        c = (*[0.0] * roots, *COEFFICIENTS[: 10 - roots])
        assert polynomial.deflated(c) == (*COEFFICIENTS[: 10 - roots], *[0.0] * roots)


# Where all coefficients have one sign the bound is reached at the end; otherwise it is no less than what is sampled.
def test_the_departure_bounds_the_change_and_is_reached_where_all_signs_are_equal() -> None:
    t = np.linspace(0.0, 0.8, 400)
    change = np.polynomial.Polynomial(COEFFICIENTS)(t) - COEFFICIENTS[0]
    assert polynomial.departure(COEFFICIENTS, 0.8) >= np.abs(change).max()
    for sign in (1.0, -1.0):
        same = tuple(sign * abs(x) for x in COEFFICIENTS)
        end = np.polynomial.Polynomial(same)(0.8) - same[0]
        assert polynomial.departure(same, 0.8) == pytest.approx(abs(end), rel=1e-14)


# (r - t) times a polynomial that grows slowly: roots by construction. Newton's method doubles its digits.
def test_the_root_of_a_falling_polynomial_is_found_in_a_few_newton_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = counting(monkeypatch, polynomial, "value")
    for root in (0.03, 0.31, 0.5, 0.77, 0.999999):
        q = (*np.polynomial.polynomial.polymul([root, -1.0], [1.0, 0.3, 0.2, 0.0, 0.02]), *[0.0] * 4)
        calls[0] = 0
        found = polynomial.root_of_falling(q, polynomial.derivative(q), 1.0)
        assert found == pytest.approx(root, rel=1e-14)
        assert calls[0] <= 24  # value and slope of twelve steps, halvings with them
    # The root at the very end, and a stretch whose far end is far away: a halving where Newton's step leaves it.
    q = (1.0, -1.0, *[0.0] * 8)
    assert polynomial.root_of_falling(q, polynomial.derivative(q), 1.0) == 1.0
    steep = (0.1, -1e-3, *[0.0] * 5, -1.0, 0.0, 0.0)
    found = polynomial.root_of_falling(steep, polynomial.derivative(steep), 8.0)
    assert found == pytest.approx(first_fall(steep, 8.0), rel=1e-13)


# Products of (1 - t/r): the first of several roots, a near touch before it, and none; steps grow as at Newton's.
def test_walking_meets_the_first_of_several_roots_and_none_where_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = counting(monkeypatch, polynomial, "value")
    rng = np.random.default_rng(5)
    for _ in range(60):
        roots = np.sort(rng.uniform(0.1, 2.0, 3))
        product = np.polynomial.polynomial.polyfromroots(roots)
        q = (*(product / product[0]), *[0.0] * 6)
        calls[0] = 0
        found = polynomial.root_by_walking(q, polynomial.derivative(q), 1.0)
        if roots[0] < 1.0:
            assert found == pytest.approx(roots[0], rel=1e-7 / (roots[1] - roots[0]))
            assert polynomial.value(q, found) == pytest.approx(0.0, abs=4e-15)
            assert calls[0] <= 150
        else:
            assert found == math.inf
            assert calls[0] <= 150
    assert polynomial.root_by_walking((1.0, 0.5, *[0.0] * 8), (0.5, *[0.0] * 9), 1.0) == math.inf
    touch = (0.25 + 1e-6, -1.0, 1.0, *[0.0] * 7)
    calls[0] = 0
    assert polynomial.root_by_walking(touch, polynomial.derivative(touch), 1.0) == math.inf
    assert calls[0] <= 100
    # For -q'' <= M exactly, as of a parabola that bends down, the first step is the root: 2 evaluations each.
    dome = (1.0, 0.5, -0.75, *[0.0] * 7)
    calls[0] = 0
    assert polynomial.root_by_walking(dome, polynomial.derivative(dome), 5.0) == pytest.approx(
        (0.5 + math.sqrt(0.25 + 3.0)) / 1.5, rel=1e-15
    )
    assert calls[0] <= 10


def test_of_a_parabola_that_falls_the_first_guess_is_the_root_and_four_looks_suffice(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    calls = counting(monkeypatch, polynomial, "value")
    for q0, q1, q2 in ((0.1, -1.0, 0.4), (0.1, -1.0, -0.4), (0.01, -0.3, 0.5)):
        q = (q0, q1, q2, 0.003, -0.002, *[0.0] * 5)
        calls[0] = 0
        found = polynomial.root_by_parabola(q, polynomial.derivative(q), 1.0)
        assert found == pytest.approx(first_fall(q, 1.0), rel=1e-14)
        assert calls[0] <= 6
    q = (0.1, -1.0, 0.4, 0.003, *[0.0] * 6)
    root = first_fall(q, 1.0)
    assert polynomial.root_by_parabola(q, polynomial.derivative(q), 0.9 * root) == math.inf
    assert polynomial.root_by_parabola(q, polynomial.derivative(q), 1.001 * root) == pytest.approx(root, rel=1e-14)
    # It turns before the guess: unsure.
    assert polynomial.root_by_parabola((1.0, -1.0, 1.0, *[0.0] * 7), (-1.0, 2.0, *[0.0] * 8), 1.0) == -1.0
    # A third power that moves the root a little beyond what is certain, or takes it away there.
    late = (0.1, -1.0, 0.0, 80.0, *[0.0] * 6)
    assert polynomial.root_by_parabola(late, polynomial.derivative(late), 1.0) == -1.0


# Rounding alone: abs is what an error of 1e-14 in the value of the polynomial moves its root by.
@pytest.mark.parametrize("kind", ["plain", "zero"])
def test_the_first_descent_of_random_polynomials_is_the_first_root_of_numpy(kind: str) -> None:
    rng = np.random.default_rng(3)
    seen = [0, 0]
    for _ in range(400):
        c = rng.normal(size=10) * 0.8 ** np.arange(10) * 10.0 ** rng.uniform(-2.0, 0.0, 10)
        c[0] = abs(c[0]) if kind == "plain" else 0.0
        if kind == "zero":
            c[1] = abs(c[1])
        want = first_fall(c if kind == "plain" else c[1:], 1.0)
        found = polynomial.first_descent(tuple(c), 1.0)
        seen[math.isfinite(want)] += 1
        if math.isfinite(want):
            steep = abs(np.polynomial.Polynomial(c).deriv()(want))
            assert found == pytest.approx(want, rel=2e-15, abs=1e-14 / steep)
        else:
            assert found == math.inf
    assert min(seen) > 40


def test_a_polynomial_that_is_or_turns_negative_at_zero_descends_there_and_one_that_is_zero_never() -> None:
    nine = [0.0] * 9
    assert polynomial.first_descent((-1e-9, 5.0, *nine[1:]), 1.0) == 0.0
    assert polynomial.first_descent((0.0, -1e-9, 5.0, *nine[2:]), 1.0) == 0.0
    assert polynomial.first_descent((0.0, 0.0, -1e-9, *nine[2:]), 1.0) == 0.0
    assert polynomial.first_descent((0.0, *nine), 1.0) == math.inf
    # From level, neither rising nor falling at once.
    assert polynomial.first_descent((0.25, 0.0, -1.0, *nine[2:]), 1.0) == pytest.approx(0.5, rel=1e-15)
    assert polynomial.first_descent((0.25, 0.0, -1.0, *nine[2:]), 0.49) == math.inf


def test_where_bounds_of_the_slope_decide_nothing_is_walked(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = counting(monkeypatch, polynomial, "root_by_walking")
    for c in ((0.1, 1.0, -0.4, *[0.0] * 7), (0.1, -1.0, 0.4, *[0.0] * 7), (3.0, -1.0, 0.4, *[0.0] * 7)):
        polynomial.first_descent(c, 1.0)
    assert calls[0] == 0
