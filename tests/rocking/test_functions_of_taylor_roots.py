"""Zeros of the flights of the Taylor solver, function by function: against NumPy's roots and polynomials.

`test_taylor` has the compiled functions.
"""

from typing import Any

import numpy as np
import pytest
from functions_of_taylor import COEFFICIENTS, column, lanes_of
from functions_of_taylor import interpreted as interpreted  # for every test of this file

from rocking.solvers.taylor import roots
from rocking.solvers.taylor.flight import DEGREE
from rocking.solvers.taylor.vector import LANES

EVERY = np.ones(LANES, dtype=bool)


def first_root(c: np.ndarray, h: float, beyond: float = 0.0) -> float:
    """The first zero after `beyond` and within h, inf for none; NumPy finds all by eigenvalues."""
    found = np.roots(np.trim_zeros(c[::-1], "f"))
    real = found.real[np.abs(found.imag) < 1e-9]
    return float(min(real[(real > beyond) & (real <= h)], default=np.inf))


def flights(seed: int, start: Any) -> list[Any]:
    """Random flights, one for each lane, whose terms fall off as those of a step do; some begin on the floor."""
    rng = np.random.default_rng(seed)
    c = [lanes_of(start), lanes_of(rng.uniform(-0.6, 0.6, LANES)), lanes_of(rng.uniform(-2.0, 2.0, LANES))]
    return [*c, *(lanes_of(rng.uniform(-1.0, 1.0, LANES) / float(n)) for n in range(3, DEGREE + 1))]


# |c'(t) - c'(0)| <= sum n |c_n| t^(n-1) from n = 2 on, and of the curvature sum n (n - 1) |c_n| t^(n-2) from 3 on.
def test_bounds_of_slope_and_curvature_are_those_of_the_moduli() -> None:
    h = lanes_of(np.linspace(0.05, 0.9, LANES))
    for lane in range(LANES):
        moduli = np.polynomial.Polynomial(np.abs(column(COEFFICIENTS, lane)))
        slope, curvature = moduli.deriv(), moduli.deriv(2)
        t = h[lane]
        assert roots.change_of_slope(COEFFICIENTS, h)[lane] == pytest.approx(slope(t) - slope(0.0), rel=1e-12)
        assert roots.change_of_curvature(COEFFICIENTS, h)[lane] == pytest.approx(
            curvature(t) - curvature(0.0), rel=1e-12
        )


def test_a_polynomial_is_divided_by_the_time_where_asked_for() -> None:
    where = np.arange(LANES) % 2 == 0
    divided = roots.deflated(COEFFICIENTS, where)
    for lane in range(LANES):
        c = column(COEFFICIENTS, lane)
        assert column(divided, lane).tolist() == ([*c[1:], 0.0] if where[lane] else c.tolist())


def test_the_first_guess_is_the_descent_of_the_parabola() -> None:
    q = [lanes_of(0.3), lanes_of(np.linspace(-0.9, -0.1, LANES)), lanes_of(np.linspace(-1.0, 0.2, LANES))]
    guess = roots.first_guess(q)
    for lane in range(LANES):
        c = column(q, lane)
        inner = c[1] ** 2 - 4.0 * c[0] * c[2]
        wanted = first_root(c, np.inf) if inner > 0.0 else -2.0 * c[0] / c[1]
        assert guess[lane] == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("how", ["newton", "within_bracket"])
def test_the_root_of_a_flight_that_only_falls_is_that_of_numpy(how: str) -> None:
    q = flights(3, np.linspace(0.02, 0.3, LANES))
    q[1], q[2] = lanes_of(np.linspace(-0.9, -0.3, LANES)), lanes_of(np.linspace(-2.5, -1.5, LANES))
    h = lanes_of(0.9)
    wanted = np.arange(LANES) != 2
    root = getattr(roots, how)(q, h, wanted)
    for lane in range(LANES):
        expected = first_root(column(q, lane), 0.9) if wanted[lane] else np.inf
        assert root[lane] == pytest.approx(expected, rel=1e-13)


# Its one slope, that of a guess far off, leaves more than rounding after the few steps that it takes.
def test_a_root_that_one_slope_does_not_reach_is_found_within_its_bracket() -> None:
    none = lanes_of(0.0)
    q = [lanes_of(1e-3), lanes_of(-1e-3), none, none, lanes_of(np.linspace(-400.0, -50.0, LANES)), *[none] * 5]
    root = roots.newton(q, lanes_of(0.5), EVERY)
    for lane in range(LANES):
        assert root[lane] == pytest.approx(first_root(column(q, lane), 0.5), rel=1e-13)


def test_a_walk_finds_the_first_root_of_the_lanes_that_are_asked_for() -> None:
    q = flights(5, np.linspace(0.05, 0.2, LANES))
    scratch, lanes = np.zeros((roots.SCRATCH, LANES)), 0b1011 % (1 << LANES)
    found = roots.walk(q, lanes_of(0.8), lanes, scratch)
    for lane in range(LANES):
        asked = (lanes >> lane) & 1
        assert found[lane] == pytest.approx(first_root(column(q, lane), 0.8) if asked else np.inf, rel=1e-11)


# A parabola that dips below the floor and is back above it at the end of the step, and one that stays just above.
@pytest.mark.parametrize(("least", "lands"), [(-0.01, True), (0.01, False)])
def test_a_hollow_flight_lands_where_its_least_height_is_below_the_floor(least: float, lands: bool) -> None:
    lowest, bend = np.linspace(0.1, 0.25, LANES), 4.0  # time [s] at which it is least
    tail = [lanes_of(1e-3)] * (DEGREE - 2)
    q = [lanes_of(least + bend * lowest**2), lanes_of(-2.0 * bend * lowest), lanes_of(bend), *tail]
    found = roots.first_landing(q, q[0], lanes_of(0.4), EVERY, np.zeros((roots.SCRATCH, LANES)))
    for lane in range(LANES):
        assert np.isfinite(found[lane]) == lands
        assert found[lane] == pytest.approx(first_root(column(q, lane), 0.4), rel=1e-11)


def test_a_flight_that_rises_first_and_ends_above_the_floor_may_land_between() -> None:
    """It is bent downward, then upward: a cubic with its first landing at 0.3 s, back above the floor from 0.5 s on."""
    cubic = np.polynomial.Polynomial.fromroots([-0.05, 0.3, 0.5]).coef
    assert cubic[0] > 0.0 and cubic[1] > 0.0 > cubic[2]
    q = [np.linspace(0.5, 2.0, LANES) * c for c in (*cubic, *[0.0] * (DEGREE - 3))]
    q = [lanes_of(c) for c in q]
    found = roots.first_landing(q, q[0], lanes_of(0.9), EVERY, np.zeros((roots.SCRATCH, LANES)))
    assert found == pytest.approx(np.full(LANES, 0.3), rel=1e-11)


# Flights of every kind, near the floor or on it; those that are not near are left alone.
@pytest.mark.parametrize("seed", range(60))
def test_a_flight_lands_where_numpy_finds_its_first_root(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    start = np.where(rng.random(LANES) < 0.3, 0.0, rng.uniform(0.0, 0.15, LANES))
    c, near = flights(seed, start), rng.random(LANES) < 0.85
    c[1] = lanes_of(np.where((start == 0.0) & (rng.random(LANES) < 0.3), 0.0, c[1]))
    h = lanes_of(rng.uniform(0.2, 0.7, LANES))
    found = roots.first_landing(c, c[0], h, near, np.zeros((roots.SCRATCH, LANES)))
    for lane in range(LANES):
        own = column(c, lane)
        leading = own[np.flatnonzero(own)[0]]
        wanted = 0.0 if leading < 0.0 else first_root(own, h[lane], beyond=1e-9)
        assert found[lane] == pytest.approx(wanted if near[lane] else np.inf, rel=1e-9, abs=1e-12)
