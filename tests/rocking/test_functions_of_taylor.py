"""Functions of the Taylor solver one by one, run as plain Python on NumPy arrays: closed forms, mpmath, sampling.

Nothing is compiled: loads and stores are those of arrays, and a vector of the processor is a row of one;
`test_taylor` has the compiled functions.
"""

import math
from collections.abc import Iterator
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pytest
from numba.core.dispatcher import Dispatcher

from rocking.hybrid import REST, ROTATION
from rocking.solvers.piecewise import polynomial
from rocking.solvers.recording import FELL, MAX_STALLED, REACHED_END, STALL_TIME, STALLED, TOO_MANY_EVENTS
from rocking.solvers.taylor import columns, flight, lanes, roots, turns, waits
from rocking.solvers.taylor import table as row
from rocking.solvers.taylor.records import BLOCK
from rocking.solvers.taylor.vector import LANES

G = 9.81
P2, ALPHA = 9.0, 0.23


class Row(np.ndarray):
    """One number for each lane."""

    def like(self, other: Any) -> Any:
        """A number in every lane."""
        return lanes_of(other)


def lanes_of(values: Any) -> Any:
    """The values, or one for all, as a row of lanes."""
    return np.broadcast_to(np.asarray(values, dtype=float), (LANES,)).copy().view(Row)


def put(t: Any, place: int, value: Any) -> None:
    t[place] = value


PLAIN = {
    "fma": lambda a, b, c: a * b + c,
    "fma_of": lambda a, b, c: a * b + c,
    "where": np.where,
    "where_of": np.where,
    "least": np.minimum,
    "least_of": np.minimum,
    "most": np.maximum,
    "most_of": np.maximum,
    "size": np.abs,
    "size_of": np.abs,
    "root_of": np.sqrt,
    "load": lambda t, place: lanes_of(t[place]),
    "store": put,
    "gather": lambda values, index: values[np.asarray(index, dtype=int)],
    "bits": lambda mask: sum(1 << lane for lane in range(LANES) if mask[lane]),
    "count": lambda mask: int(np.sum(mask)),
}


@pytest.fixture(autouse=True)
def interpreted(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Every function by its Python source."""
    for module in (polynomial, flight, roots, waits, lanes, turns):
        for name, thing in list(vars(module).items()):
            if isinstance(thing, Dispatcher):
                monkeypatch.setattr(module, name, thing.py_func)
            elif name in PLAIN:
                monkeypatch.setattr(module, name, PLAIN[name])
    with np.errstate(all="ignore"):
        yield


COEFFICIENTS = [lanes_of((-1.0) ** (n // 2) * (n + 1.3) ** 1.5 * np.linspace(0.5, 1.5, LANES)) for n in range(10)]


def column(c: Any, lane: int) -> np.ndarray:
    return np.array([part[lane] for part in c])


# ------------------------------------------------------------------------------------------------ flight


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


def test_the_tail_of_a_flight_is_that_of_its_last_two_terms() -> None:
    h = lanes_of(np.linspace(0.2, 1.1, LANES))
    want = np.abs(COEFFICIENTS[8]) * h**8 + np.abs(COEFFICIENTS[9]) * h**9
    np.testing.assert_allclose(lanes.tail(COEFFICIENTS, h), want, rtol=1e-13)


# ------------------------------------------------------------------------------------------------ lanes


# Parabolas whose curvature is the bound: those that dip below zero between positive ends, and those that do not.
def test_a_step_may_land_where_a_parabola_of_the_largest_curvature_would() -> None:
    rise = 0.8
    may = lanes.may_land(lanes_of(0.09), lanes_of(0.09), lanes_of(rise))
    assert may.all()
    assert not lanes.may_land(lanes_of(0.1 * 1.01), lanes_of(0.3), lanes_of(rise)).any()
    assert not lanes.may_land(lanes_of(0.3), lanes_of(0.1 * 1.01), lanes_of(rise)).any()
    assert lanes.may_land(lanes_of(0.3), lanes_of(0.0999999), lanes_of(rise)).all()
    assert lanes.may_land(lanes_of(0.1), lanes_of(0.3), lanes_of(rise)).all()  # to the last bit
    assert lanes.may_land(lanes_of(0.3), lanes_of(-0.1), lanes_of(0.0)).all()
    # From the floor: up to half of it or less it may come down again; more, and it has flown.
    assert lanes.may_land(lanes_of(0.0), lanes_of(0.39), lanes_of(rise)).all()
    assert not lanes.may_land(lanes_of(0.0), lanes_of(0.41), lanes_of(rise)).any()
    assert lanes.may_land(lanes_of(-1e-9), lanes_of(0.41), lanes_of(rise)).all()


def test_angles_and_flights_are_those_of_the_form_that_is_asked_for() -> None:
    table = np.random.default_rng(1).normal(size=(row.ALL_ROWS, LANES))
    assert lanes.angle_terms(table, None) is None
    found = lanes.angle_terms(table, True)
    np.testing.assert_array_equal(np.array(found), table[[row.TURN_S, row.TURN_C]])
    given = [lanes_of(a) for a in (0.1, 0.3)], (lanes_of(0.1), lanes_of(0.2)), lanes_of(P2), lanes_of(ALPHA)
    (x, v), push, p2, alpha = given
    floor = lanes_of(-math.inf)
    assert lanes.wanted_at_once(x, v, push, p2, alpha, None, floor, None, None) is None
    c = lanes.wanted_at_once(x, v, push, p2, alpha, None, floor, None, True)
    np.testing.assert_array_equal(c, flight.flight(x, v, push, p2, alpha, None, floor))
    np.testing.assert_array_equal(lanes.known(None, x, v, push, p2, alpha, None, floor), c)
    assert lanes.known(c, None, None, None, None, None, None, None) is c
    h = lanes_of(0.02)
    by_polynomial = lanes.end_of_step(c, x, v, push, h, p2, alpha, floor)
    by_glide = lanes.end_of_step(None, x, v, push, h, p2, alpha, floor)
    np.testing.assert_allclose(by_polynomial[:2], by_glide[:2], rtol=1e-13)


# x = x_0 + v t - b t^2: passes the balance, turns below it, turns beyond it, falls, tilts far; the others stay low.
def test_passage_crest_and_fall_of_a_step_are_those_of_the_parabolas() -> None:
    x = lanes_of([0.18, 0.10, 0.20, 1.40, 0.90, *[0.05] * (LANES - 5)])
    v = lanes_of([0.50, 0.40, 0.40, 1.00, 0.50, *[-0.1] * (LANES - 5)])
    b = lanes_of([0.00, 1.00, 1.00, 0.00, *[0.0] * (LANES - 4)])
    reach = lanes_of([0.30, 0.35, 0.40, 0.50, *[0.1] * (LANES - 4)])
    table = np.zeros((row.ALL_ROWS, LANES))
    table[row.ALPHA], table[row.PEAK], table[row.ORIGIN], table[row.DT] = ALPHA, 0.11, 5.0, 0.25
    table[row.EVENTS], table[row.PASSAGE], table[row.PASSED], table[row.REACH_OLD] = 7.0, -3.0, -1.0, 9.0
    table[row.BULGE] = 0.5
    c = (x, v, -b, *(lanes_of(0.0) for _ in range(7)))
    x_end, v_end = x + v * reach - b * reach**2, v - 2.0 * b * reach
    falls = lanes.look_up(table, c, x, v, lanes_of(0.125), lanes_of(2.0), reach, x_end, v_end)
    assert falls.tolist() == [False, False, False, True, *[False] * (LANES - 4)]
    crossing = 0.2 - math.sqrt(0.01)
    start = 5.0 + 0.5 + 0.125
    np.testing.assert_allclose(table[row.PEAK, :5], [0.33, 0.14, 0.24, 0.5 * math.pi, 0.95], rtol=1e-14)
    np.testing.assert_allclose(table[row.WATCH, :5], [0.23, 0.14, 0.23, 0.23, 0.23], rtol=1e-14)
    np.testing.assert_allclose(table[row.PASSAGE, :5], [start + 0.1, -3.0, start + crossing, -3.0, -3.0], rtol=1e-14)
    np.testing.assert_allclose(table[row.PASSED, :5], [0.1, -1.0, crossing, -1.0, -1.0], rtol=1e-12)
    np.testing.assert_allclose(table[row.EVENTS, :5], [8.0, 7.0, 8.0, 7.0, 7.0])
    fell = 0.5 * math.pi - 1.4
    assert table[row.FELL_AT, 3] == pytest.approx(start + fell)
    assert (table[row.V_FELL, 3], table[row.REACH_OLD, 3]) == pytest.approx((1.0, fell))
    assert table[row.REACH_OLD, 0] == 9.0
    # Where no tilt of the step can exceed the largest so far its turn is not looked for.
    table[row.PEAK], table[row.BULGE], table[row.EVENTS] = 0.9, 1e-6, 0.0
    c = (x[1] + 0.0 * x, v[1] + 0.0 * x, c[2][1] + 0.0 * x, *c[3:])
    lanes.look_up(table, c, *c[:2], *(lanes_of(a) for a in (0.0, 0.0, 0.35, 0.1175, -0.3)))
    assert (table[row.PEAK] == 0.9).all() and (table[row.EVENTS] == 0.0).all()


def struck(hit: Any = True, **change: Any) -> tuple[float, Any]:
    """What `strike` answers, lane by lane, to one set of numbers that changes as told."""
    usual = {
        "speed": 0.01, "now": 4.0, "push": 0.03, "push_end": -0.02, "rise": 0.01, "left": 9.0, "max_events": 50,
        row.EVENTS: 5.0, row.STALLS: 2.0, row.LAST: 3.0, row.IMPACTS: 4.0, row.OMEGA_REST: 1e-6, row.ONSET: 0.19,
        row.HOLD_S: 0.23, row.HOLD_C: 0.9, row.ZENO: 2.0 / (P2 * 0.2), row.P2: P2,
    }  # fmt: skip
    usual.update(change.pop("rows", {}))
    usual.update(change)
    table = np.zeros((row.ALL_ROWS, LANES))
    for name, value in usual.items():
        if isinstance(name, int):
            table[name] = value
    parts = [lanes_of(usual[name]) for name in ("speed", "now", "push", "push_end", "rise", "left")]
    strike: Any = lanes.strike
    asks = strike(table, lanes_of(1.0 if hit else 0.0) > 0.5, *parts, usual["max_events"])
    assert np.ptp(asks) == 0.0
    return float(asks[0]), table[:, 0]


def test_an_impact_is_counted_and_what_it_asks_for_is_that_of_its_speed_and_push() -> None:
    asks, table = struck()
    assert (asks, table[row.EVENTS], table[row.IMPACTS]) == (row.CHATTERS, 6.0, 5.0)
    assert (table[row.STALLS], table[row.LAST]) == (0.0, 4.0)
    asks, table = struck(False)
    assert (asks, table[row.EVENTS], table[row.IMPACTS], table[row.STALLS], table[row.LAST]) == (
        0.0,
        5.0,
        4.0,
        2.0,
        3.0,
    )
    _, table = struck(now=3.0 + 0.9 * STALL_TIME, rows={row.LAST: 3.0})
    assert table[row.STALLS] == 0.0 if 3.0 + 0.9 * STALL_TIME - 3.0 >= STALL_TIME else 3.0
    _, table = struck(now=0.9 * STALL_TIME, rows={row.LAST: 0.0})
    assert table[row.STALLS] == 3.0
    # At rest: a speed below the rest speed, and a push that the block bears; at the limits of both.
    assert struck(speed=0.9e-6)[0] == row.RESTS
    assert struck(speed=0.9e-6, push=0.19, push_end=0.4)[0] == row.RESTS
    assert struck(speed=0.9e-6, push=-0.191, push_end=0.4)[0] == row.NOTHING
    assert struck(speed=0.9e-6, push=0.191, push_end=0.4)[0] == row.NOTHING
    # Too many events, or too many without time going on, before all else.
    assert struck(speed=0.9e-6, max_events=5)[0] == row.ENOUGH
    assert struck(max_events=6)[0] == row.CHATTERS
    stalled = {row.STALLS: float(MAX_STALLED), row.LAST: 4.0}
    assert struck(rows=stalled)[0] == row.ENOUGH
    assert struck(rows={**stalled, row.STALLS: MAX_STALLED - 1.0})[0] == row.CHATTERS


# hold = alpha - 0.9 max(|a|, |a_end|); the series takes (2/(p^2 (1 - e))) v/hold at most.
def test_a_chatter_is_asked_for_where_it_is_low_steady_and_ends_in_time() -> None:
    zeno = 2.0 / (P2 * 0.2)
    for push, push_end in ((0.03, -0.02), (0.01, -0.03), (-0.03, 0.0)):
        hold = 0.23 - 0.9 * 0.03
        low = math.sqrt(0.01 * P2) * hold
        for speed, asks in ((0.99 * low, row.CHATTERS), (1.01 * low, row.NOTHING)):
            assert struck(speed=speed, push=push, push_end=push_end, rise=0.0)[0] == asks
        series = zeno * 0.01
        for left, asks in ((1.01 * series / (0.9 * hold), row.CHATTERS), (0.99 * series / (0.9 * hold), row.NOTHING)):
            assert struck(left=left, push=push, push_end=push_end, rise=0.0)[0] == asks
        for sign in (1.0, -1.0):
            limit = sign * 0.2 * hold**2 / series
            for rise, asks in ((0.99 * limit, row.CHATTERS), (1.01 * limit, row.NOTHING)):
                assert struck(rise=rise, push=push, push_end=push_end)[0] == asks
    assert struck(push_end=0.27, left=-9.0)[0] == row.NOTHING  # nothing holds the block


def test_a_step_that_is_remembered_is_whole() -> None:
    table = np.zeros((row.ALL_ROWS, LANES))
    parts = [lanes_of(n + 0.5) for n in range(5)]
    s, k, tau, reach, v_end = parts
    lanes.keep_step(table, COEFFICIENTS, s, k, tau, reach, v_end, np.arange(LANES) % 2 == 1)
    np.testing.assert_array_equal(table[row.C_FIRST : row.C_FIRST + 10], np.array(COEFFICIENTS))
    for name, want in zip(("S_OLD", "K_OLD", "TAU_OLD", "REACH_OLD", "V_OLD"), parts, strict=True):
        np.testing.assert_array_equal(table[getattr(row, name)], want)
    assert table[row.HIT_OLD].tolist() == [0.0, 1.0] * (LANES // 2)
    assert (table[row.PASSED] == -1.0).all()


# ------------------------------------------------------------------------------------------------ turns


def runs_of(wave: bool, max_events: int = 50) -> Any:
    """Two runs: over a record of 40 or 30 samples, the second behind the first in one array; or over a sine."""
    rng = np.random.default_rng(9)
    values = np.zeros(128)
    values[:40], values[64:94] = rng.normal(size=40), rng.normal(size=30)
    motions = [[5.0, 0.4, 1.7, 1.5], [-9.0, 0.1, 2.0, 1.25]] if wave else [
        [1.5, 0.02, 0.25, 0.0, 40.0, 4.0], [-2.0, 0.03, 0.35, 64.0, 30.0, 3.0]]  # fmt: skip
    pars = np.array([[P2, ALPHA, G, 0.19, 0.8, 1e-6], [16.0, 0.3, 9.7, 0.25, 0.7, 1e-5]])
    starts = np.array([[ROTATION, 1.0, 0.1, 0.0, 0.0, 1.0], [ROTATION, -1.0, -0.4, 0.3, 0.4, 2.3]])
    return row.Runs(
        pars, starts, np.array(motions), None if wave else values, np.abs(values).reshape(-1, BLOCK).max(axis=1),
        max_events, np.full((2, 20), np.nan),
    )  # fmt: skip


def begun(runs: Any, run: int, wave: Any, form: Any = None, lane: int = 3, logging: bool = False) -> np.ndarray:
    table = np.full((row.ALL_ROWS, LANES), 77.0)
    assert turns.begin(table, lane, runs, run, form, wave, logging)
    assert (np.delete(table, lane, axis=1) == 77.0).all()
    return table


def rows_are(table: Any, lane: int = 3, **want: float) -> None:
    for name, value in want.items():
        assert table[getattr(row, name), lane] == pytest.approx(value, rel=1e-12, abs=1e-300, nan_ok=True), name


@pytest.mark.parametrize("form", [None, "nonlinear"])
def test_a_run_begins_with_its_own_constants_and_start(form: Any) -> None:
    table = begun(runs_of(False), 1, None, form)
    rows_are(
        table, X=-0.4, V=0.3, S=-1.0, P=4.0, P2=16.0, ALPHA=0.3, E=0.7, OMEGA_REST=1e-5, ONSET=0.25, RUN=1.0,
        TURN_S=math.sin(0.3 - math.pi / 4), TURN_C=math.cos(0.3 - math.pi / 4), T_START=0.4, T_END=2.3, PEAK=0.4,
        WATCH=0.3, PASSAGE=0.4, ONSET_TIME=math.nan, LAST=-math.inf, FLOOR=-math.inf, STATUS=REACHED_END, DT=0.03,
        PER_DT=1 / 0.03, LIMIT=1 / 64, ZENO=2.0 / (16.0 * 0.3), SCALE_ON=-2.0 / 9.7, BEGIN=0.35, FIRST=64.0,
        SAMPLES=30.0, MODE=ROTATION, HOLD_S=0.3 if form is None else math.sin(0.3),
        HOLD_C=1.0 if form is None else math.cos(0.3), PHASE=turns.WITHIN, ORIGIN=0.35, K=1.0, TAU=0.02, EVENTS=0.0,
        IMPACTS=0.0, STALLS=0.0,
    )  # fmt: skip
    assert begun(runs_of(False), 1, None, form, logging=True)[row.ZENO, 3] == math.inf
    table = begun(runs_of(True), 1, True, form)
    rows_are(table, OMEGA=-9.0, SCALE_ON=2.0 / 9.7, LIMIT=1 / 72, PHASE=turns.WITHIN, RATE=2.0 / 9.7, DT=1.0)
    assert begun(runs_of(True), 0, True, form)[row.LIMIT, 3] == pytest.approx(1 / 48)


# A record from 0.25 s to 1.03 s, of which 0.75 s are gone through: 37 whole intervals and one hundredth.
def test_stretches_over_a_record_follow_one_another_without_a_gap() -> None:
    runs = runs_of(False)
    table, values, scale = begun(runs, 0, None), runs.values, 1.5 / G
    rows_are(table, ORIGIN=0.0, K=0.0, TAU=0.0, STOP=0.25, B0=0.0, B1=0.0, SCALE=0.0, K_EDGE=1.0, PHASE=turns.BEFORE)
    bulge = P2 * 1.6 / 48**2 / 8.0
    assert bulge <= table[row.BULGE, 3] < bulge * 1.00001 + 1e-14
    assert turns.enter(table, 3, runs, None, turns.WITHIN)
    rows_are(table, ORIGIN=0.25, K=0.0, TAU=0.0, STOP=0.02, B0=scale * values[0], B1=scale * values[1], SCALE=scale)
    rows_are(table, K_EDGE=37.0, PHASE=turns.WITHIN)
    bulge = P2 * (1.6 + scale * 4.0) * 0.02**2 / 8.0
    assert bulge <= table[row.BULGE, 3] < bulge * 1.00001 + 1e-14
    assert turns.moment(table, 3) == pytest.approx(0.25)
    assert not turns.enter_last_part(table, 3, runs)  # not there yet
    table[row.K, 3] = 37.0
    assert turns.enter(table, 3, runs, None, turns.LAST_PART)
    rows_are(table, K=37.0, TAU=0.0, B0=scale * values[37], B1=scale * values[38], K_EDGE=38.0, PHASE=turns.LAST_PART)
    assert table[row.STOP, 3] == pytest.approx(0.01)
    assert not turns.enter(table, 3, runs, None, turns.AFTER)
    # The second record ends before its run: no last part, and a quiet stretch.
    table = begun(runs, 1, None)
    rows_are(table, K=1.0, STOP=0.03, B0=-2.0 / 9.7 * values[65], B1=-2.0 / 9.7 * values[66], K_EDGE=29.0)
    table[row.K, 3] = 29.0
    assert turns.enter(table, 3, runs, None, turns.LAST_PART)
    rows_are(table, ORIGIN=0.35 + 29 * 0.03, STOP=2.3 - 0.35 - 29 * 0.03, K=0.0, RATE=0.0, PHASE=turns.AFTER)
    assert turns.moment(table, 3) == pytest.approx(0.35 + 29 * 0.03)


def test_a_run_that_begins_or_ends_within_the_first_interval_is_all_in_it() -> None:
    runs = runs_of(False)
    runs.starts[0, 4:] = 0.255, 0.265
    table = begun(runs, 0, None)
    rows_are(table, ORIGIN=0.25, K=0.0, TAU=0.005, STOP=0.015, K_EDGE=1.0, PHASE=turns.WITHIN)
    runs.starts[0, 4:] = 0.1, 0.2
    table = begun(runs, 0, None)
    rows_are(table, ORIGIN=0.1, STOP=0.1, PHASE=turns.BEFORE)
    assert not turns.enter(table, 3, runs, None, turns.WITHIN)
    runs.starts[0, 4:] = 1.5, 2.0
    rows_are(begun(runs, 0, None), ORIGIN=1.5, STOP=0.5, PHASE=turns.AFTER)


def test_stretches_over_a_sine_follow_one_another_without_a_gap() -> None:
    runs = runs_of(True)
    runs.starts[0, 4:] = -0.5, 1.7
    table = begun(runs, 0, True)
    rows_are(table, ORIGIN=-0.5, STOP=0.5, RATE=0.0, PHASE=turns.BEFORE)
    assert turns.enter(table, 3, runs, True, turns.WITHIN)
    rows_are(table, ORIGIN=0.0, K=0.0, K_EDGE=1.0, TAU=0.0, STOP=1.5, RATE=1.7 / G, SINE=math.sin(0.4))
    rows_are(table, COSINE=math.cos(0.4), PHASE=turns.WITHIN)
    bulge = P2 * (1.6 + 1.7 / G * 1.5) / 48**2 / 8.0
    assert bulge <= table[row.BULGE, 3] < bulge * 1.00001 + 1e-14
    assert turns.enter(table, 3, runs, True, turns.LAST_PART)
    rows_are(table, ORIGIN=1.5, STOP=0.2, PHASE=turns.AFTER)
    table = begun(runs, 1, True)
    rows_are(table, TAU=0.4, STOP=1.25, SINE=math.sin(-3.5), COSINE=math.cos(-3.5))


# The first crossing over a dense sampling of the line through the samples, from every start and for every threshold.
def test_a_block_over_a_record_leaves_where_the_line_through_the_samples_first_crosses() -> None:
    runs = runs_of(False)
    for run, begin, dt, first, scale, n in ((0, 0.25, 0.02, 0, 1.5 / G, 37), (1, 0.35, 0.03, 64, -2.0 / 9.7, 29)):
        at = np.linspace(0.0, n * dt, n * 1000 + 1)
        a = scale * np.interp(at, dt * np.arange(n + 1), runs.values[first : first + n + 1])
        for onset in (0.02, 0.1, 0.2, 0.3, 0.9):
            for start in (0.0, 0.013, 0.2, 0.4):
                table = begun(runs, run, None)
                turns.enter_record(table, 3, runs)
                table[row.ONSET, 3], table[row.K, 3] = onset, int(start / dt)
                k = int(start / dt)
                turns.be_in_interval(table, 3, runs.values, k, start - k * dt, dt)
                left = turns.exceeds(table, 3, runs, None)
                over = np.flatnonzero((np.abs(a) > onset) & (at >= start - 1e-12))
                assert left == bool(over.size)
                if left:
                    assert turns.moment(table, 3) - begin == pytest.approx(max(at[over[0]], start), abs=1.1e-3 * dt)
                    assert table[row.S, 3] == -math.copysign(1.0, a[over[0]])
                    k = int(table[row.K, 3])
                    rows_are(table, B0=scale * runs.values[first + k], B1=scale * runs.values[first + k + 1])
                else:
                    assert table[row.K, 3] == n


def test_a_block_over_a_sine_leaves_where_it_first_crosses() -> None:
    runs = runs_of(True)
    for run, (omega, phase, rate, duration), g in ((0, runs.motions[0], G), (1, runs.motions[1], 9.7)):
        runs.starts[run, 4:] = 0.0, 3.0
        at = np.linspace(0.0, duration, 150001)
        a = rate / g * at * np.sin(omega * at + phase)
        for onset in (0.01, 0.1, 0.2, 0.25, 0.4):
            table = begun(runs, run, True)
            table[row.ONSET, 3] = onset
            over = np.flatnonzero(np.abs(a) > onset)
            assert turns.exceeds(table, 3, runs, True) == bool(over.size)
            if over.size:
                tau = table[row.TAU, 3]
                assert tau == pytest.approx(at[over[0]], abs=2e-5)
                rows_are(table, S=-math.copysign(1.0, a[over[0]]), SINE=math.sin(omega * tau + phase))
                rows_are(table, COSINE=math.cos(omega * tau + phase))


def test_events_are_counted_and_those_without_time_going_on() -> None:
    table = np.zeros((row.ALL_ROWS, LANES))
    for now in (1.0, 1.0, 1.0 + 0.5 * STALL_TIME, 2.0):
        turns.count_event(table, 2, now)
    assert table[[row.EVENTS, row.STALLS, row.LAST], 2].tolist() == [4.0, 0.0, 2.0]
    turns.count_event(table, 2, 2.0)
    assert table[[row.EVENTS, row.STALLS, row.LAST], 2].tolist() == [5.0, 1.0, 2.0]


def test_a_block_at_rest_waits_through_all_stretches_for_the_first_push() -> None:
    runs = runs_of(False)
    runs.starts[0, 0] = REST
    table = begun(runs, 0, None)
    rows_are(table, MODE=ROTATION, X=0.0, V=0.0, FLOOR=0.0, EVENTS=1.0, PHASE=turns.WITHIN)
    left = turns.moment(table, 3)
    rows_are(table, ONSET_TIME=left, LAST=left)
    a = 1.5 / G * np.interp(left, 0.25 + 0.02 * np.arange(40), runs.values[:40])
    assert abs(a) == pytest.approx(0.19, rel=1e-12) or abs(a) > 0.19
    table[row.ONSET, 3], table[row.ONSET_TIME, 3] = 99.0, 0.123
    assert not turns.wait(table, 3, runs, None)
    rows_are(table, MODE=REST, EVENTS=1.0, ONSET_TIME=0.123)
    runs.pars[0, 3] = 99.0
    assert not turns.begin(table, 3, runs, 0, None, None, False)


def chatters(e: float, v: float, b: float, rise: float, s: float) -> tuple[int, int]:
    """(impacts told, impacts followed) of the linear block under a line, by the closed form of each flight."""
    runs = runs_of(False, 10**6)
    table = begun(runs, 0, None)
    table[row.DT, 3], table[row.PER_DT, 3], table[row.TAU, 3] = 0.5, 2.0, 0.1
    table[row.B0, 3], table[row.B1, 3] = b - 0.1 * rise, b + 0.4 * rise
    table[row.V, 3], table[row.S, 3], table[row.E, 3], table[row.PEAK, 3] = v, s, e, 9.0
    told = turns.chatter(table, 3, runs, None)
    p, n, t = math.sqrt(P2), 0, 0.0
    while v >= 1e-6:
        u = s * (b + rise * t)
        A, B = -ALPHA - u, (v - s * rise) / p
        x = 2.0 * v / (P2 * (ALPHA + u))
        for _ in range(40):  # sums of sinh and cosh, from their series, lest nothing be left of a low flight
            ch, sh = 2.0 * math.sinh(0.5 * p * x) ** 2, (p * x) ** 3 / 6.0 * (1.0 + (p * x) ** 2 / 20.0)
            f, df = A * ch + v * x + B * sh, v + A * p * math.sinh(p * x) + B * p * ch
            x -= f / df
        v, t, s, n = -e * df, t + x, -s, n + 1
    return told, n


def test_a_chatter_has_the_impacts_of_flights_followed_one_by_one() -> None:
    sure = 0
    for e in (0.45, 0.6, 0.8, 0.9):
        for v in (3e-5, 1e-4, 7e-4, 3e-3, 6e-3):
            for b, rise in ((0.0, 0.0), (0.08, 0.0), (0.05, 0.3), (-0.06, -0.4), (0.1, -2.0)):
                for s in (1.0, -1.0):
                    told, want = chatters(e, v, b, rise, s)
                    assert told in (0, want)
                    sure += told > 0
    assert sure >= 184  # of 200


# |unsure| = 1e-9 on a steady base: only where ln(v/last)/ln(1/e) is whole to 1e-9 it is not told.
def test_a_steady_chatter_is_told_unless_it_ends_at_the_rest_speed_itself_rises_or_is_one_too_many() -> None:
    def told(v: float, wave: Any = None, max_events: int = 100, **change: float) -> int:
        runs = runs_of(wave is not None, max_events)
        table = begun(runs, 0, wave)
        for name, value in {"V": v, "B0": 0.0, "B1": 0.0, "TAU": 0.01, "EVENTS": 3.0, "RATE": 0.0, **change}.items():
            table[getattr(row, name), 3] = value
        return int(turns.chatter(table, 3, runs, wave))

    assert told(1e-6 * 0.8**-10.5) == 11
    assert told(1e-6 * 0.8**-10.5, True) == 11
    assert told(1e-6 * 0.8**-10) == 0
    assert told(1e-6 * 0.8 ** -(10 + 1e-7)) == 11
    assert told(1e-6 * 0.8 ** -(10 - 1e-7)) == 10
    assert told(1e-6 * 0.8**-10.5, max_events=14) == 11
    assert told(1e-6 * 0.8**-10.5, max_events=13) == 0
    # What is left at the rest speed takes 2 v e/(4 p^2) at least: time goes on, or not.
    for more, count in ((1.01, 11), (0.99, 0)):
        last = more * STALL_TIME * 4.0 * P2 / (2.0 * 0.8)
        assert told(last * 0.8**-10.5, OMEGA_REST=last) == count
    v = 3e-3
    highest = 0.75 * v * v / (P2 * ALPHA)
    assert told(v, PEAK=1.01 * highest) > 0
    assert told(v, PEAK=0.99 * highest) == 0
    # On a sine: what its curve leaves unsure. bent = p^2 |a''| T^2/A with |a''| <= rate (omega^2 t + 2 omega).
    total = 2.0 * v * (1.0 + 0.8) / (P2 * ALPHA) / (1.0 - 0.64)
    for bent, sure in ((0.2, False), (1e-8, True)):
        rate = bent * P2 * ALPHA / (P2 * total**2) / (25.0 * 0.01 + 10.0)
        assert (told(v, True, RATE=rate, SINE=0.0, COSINE=0.0) > 0) is sure


# With d = A' T/A over the time T of the series the number may be off by (2 d^2 + d (p T)^2 + d last/v)/ln(1/e): it is
# not told within so much of a whole number, and told elsewhere.
@pytest.mark.parametrize(("drift", "square"), [(0.01, 0.02), (0.002, 0.02), (0.01, 0.002)])
def test_a_chatter_is_left_alone_within_what_its_number_is_unsure_by(drift: float, square: float) -> None:
    runs, A = runs_of(False, 100), P2 * ALPHA
    total = math.sqrt(square / P2)
    v, rise = total * A * 0.2 / 2.0, drift * A / (P2 * total)
    table = begun(runs, 0, None)
    table[row.V, 3], table[row.TAU, 3] = v, 0.01
    table[row.B0, 3], table[row.B1, 3] = -0.01 * rise, 0.01 * rise
    numbers = np.arange(39.97, 40.03, 5e-5)
    told = []
    for number in numbers:
        table[row.OMEGA_REST, 3] = v * 0.8**number
        told.append(turns.chatter(table, 3, runs, None))
    unsure = 2.0 * drift**2 + drift * square + drift * 0.8**40
    margin = unsure / -math.log(0.8)
    assert 5e-5 * told.count(0) == pytest.approx(2.0 * margin, rel=0.01, abs=1e-4)
    assert set(told) == {0, 40, 41}


def asked(call: int, **change: float) -> tuple[bool, np.ndarray]:
    runs = runs_of(False, 50)
    table = begun(runs, 1, None)
    table[row.CALL, 3] = call
    for name, value in change.items():
        table[getattr(row, name), 3] = value
    return turns.answer(table, 3, runs, None), table


def test_a_lane_is_given_what_it_asks_for() -> None:
    goes, table = asked(row.EDGE, K=29.0)
    assert goes and table[row.PHASE, 3] == turns.AFTER
    assert not asked(row.EDGE, PHASE=turns.AFTER)[0]
    goes, table = asked(row.FALLS, FELL_AT=1.75)
    rows_are(table, STATUS=FELL, T_END=1.75)
    assert not goes
    goes, table = asked(row.RESTS, ONSET=99.0)
    assert not goes
    rows_are(table, MODE=REST, STATUS=REACHED_END, X=0.0)
    goes, table = asked(row.ENOUGH, EVENTS=51.0, LAST=1.5)
    rows_are(table, STATUS=TOO_MANY_EVENTS, T_END=1.5)
    assert not goes
    goes, table = asked(row.RESTS, STALLS=MAX_STALLED + 1.0, LAST=1.5, ONSET=99.0)
    rows_are(table, STATUS=STALLED, T_END=1.5)
    assert not goes
    assert asked(row.EDGE, K=29.0, EVENTS=50.0, STALLS=MAX_STALLED)[0]
    assert not asked(row.EDGE, K=29.0, EVENTS=51.0)[0]
    v = 1e-5 * 0.7**-4.5
    goes, table = asked(row.CHATTERS, V=v, B0=0.0, B1=0.0, PEAK=9.0, IMPACTS=2.0, EVENTS=7.0, ONSET=99.0)
    rows_are(table, IMPACTS=7.0, EVENTS=12.0, MODE=REST)
    assert not goes
    goes, table = asked(row.CHATTERS, V=v, B0=0.0, B1=0.0, PEAK=1e-30, IMPACTS=2.0, EVENTS=7.0)
    rows_are(table, IMPACTS=2.0, EVENTS=7.0, V=v)
    assert goes


def test_an_idle_lane_asks_for_nothing_however_long_it_flies() -> None:
    table = np.full((row.ALL_ROWS, LANES), 77.0)
    turns.be_idle(table, 5)
    assert (np.delete(table, 5, axis=1) == 77.0).all()
    rows_are(table, 5, X=1.0, S=1.0, P=1.0, P2=0.0, DT=1.0, PER_DT=1.0, STOP=math.inf, K_EDGE=math.inf, WATCH=math.inf)
    rows_are(table, 5, LIMIT=1.0, RUN=-1.0, V=0.0)
    assert table[row.BULGE, 5] < 0.0


def test_what_became_of_a_run_is_written_into_its_own_row() -> None:
    runs = runs_of(False)
    for status, fell, finished in ((FELL, 1.0, 1.0), (REACHED_END, 0.0, 1.0), (STALLED, 0.0, 0.0)):
        table = begun(runs, 1, None)
        for n, name in enumerate(("PASSAGE", "PEAK", "IMPACTS", "T_END", "ONSET_TIME", "MODE")):
            table[getattr(row, name), 3] = n + 0.5
        table[row.STATUS, 3] = status
        turns.sum_up(table, 3, runs)
        out = runs.rows[1]
        assert (out[columns.OVERTURNED], out[columns.FINISHED], out[columns.SIDE]) == (fell, finished, -fell)
        np.testing.assert_equal(out[columns.OVERTURNING], 0.5 if fell else math.nan)
        want = [1.5, 2.5, 3.5, 4.5, 5.5]
        names = (columns.LARGEST, columns.COUNT, columns.ENDED, columns.FIRST, columns.LAST_MODE)
        assert [out[name] for name in names] == want
        assert np.isnan(runs.rows[0]).all()


def interval(form: Any, wave: Any, **change: Any) -> np.ndarray:
    """Lanes in interval 4 of a record, or on a sine, each with its own state; what is told of them is put in."""
    runs = runs_of(wave is not None)
    table = np.zeros((row.ALL_ROWS, LANES))
    for lane in range(LANES):
        turns.begin(table, lane, runs, 0, form, wave, False)
        turns.enter(table, lane, runs, wave, turns.WITHIN)
        if wave is None:
            turns.be_in_interval(table, lane, runs.values, 4, 0.003, 0.02)
        else:
            table[row.TAU, lane] = 0.5
            table[row.SINE, lane], table[row.COSINE, lane] = math.sin(2.9), math.cos(2.9)
    usual = {"X": np.linspace(0.05, 0.2, LANES), "V": np.linspace(0.4, -0.5, LANES), "S": [1.0, -1.0] * (LANES // 2),
             "FLOOR": -math.inf, "PEAK": 0.9, "WATCH": ALPHA, **change}  # fmt: skip
    for name, value in usual.items():
        table[getattr(row, name)] = value
    return table


def closed(table: Any, lane: int, h: Any) -> tuple[Any, Any]:
    """(x, v) of the linear block of a lane after h: C t sin + D cos or a line, and cosh and sinh."""
    p, s = 3.0, table[row.S, lane]

    def forced(t: Any) -> Any:
        if table[row.OMEGA, lane] == 0.0:
            rise = (table[row.B1, lane] - table[row.B0, lane]) / 0.02
            return s * (table[row.B0, lane] + rise * t), s * rise
        w, angle = 5.0, 5.0 * t + 0.4
        C = s * P2 * 1.7 / G / (w * w + P2)
        D = 2.0 * w * C / (w * w + P2)
        return C * t * np.sin(angle) + D * np.cos(angle), (C - D * w) * np.sin(angle) + C * t * w * np.cos(angle)

    tau = table[row.TAU, lane]
    (y, y_v), (y_h, y_v_h) = forced(tau), forced(tau + h)
    A, B = table[row.X, lane] - ALPHA - y, (table[row.V, lane] - y_v) / p
    ch, sh = np.cosh(p * h), np.sinh(p * h)
    return ALPHA + y_h + A * ch + B * sh, y_v_h + p * (A * sh + B * ch)


# One turn of the loop: the closed form at the end of the sample, or after the longest step of a sine.
@pytest.mark.parametrize("wave", [None, True])
def test_lanes_go_to_the_end_of_their_sample_as_the_closed_form(wave: Any) -> None:
    values = runs_of(False).values
    table = interval(None, wave)
    before, h = table.copy(), 0.017 if wave is None else 1 / 48
    lanes.carry(table, values, None, wave, np.zeros((roots.SCRATCH, LANES)), 50, LANES, True)
    want = np.array([closed(before, lane, h) for lane in range(LANES)])
    np.testing.assert_allclose(table[row.X], want[:, 0], rtol=1e-12)
    np.testing.assert_allclose(table[row.V], want[:, 1], rtol=1e-11)
    assert (table[row.CALL] == row.NOTHING).all() and (table[row.S] == before[row.S]).all()
    assert (table[row.PEAK] == 0.9).all()
    np.testing.assert_allclose(table[row.REACH_OLD], h)
    if wave is None:
        assert (table[row.K] == 5.0).all() and (table[row.TAU] == 0.0).all()
        np.testing.assert_allclose(table[[row.B0, row.B1], 0], 1.5 / G * values[5:7])
        np.testing.assert_allclose(table[row.STOP], 0.02)
    else:
        assert (table[row.K] == 0.0).all()
        np.testing.assert_allclose(table[row.TAU], 0.5 + h)
        angle = 5.0 * (0.5 + h) + 0.4
        np.testing.assert_allclose(table[[row.SINE, row.COSINE], 0], [math.sin(angle), math.cos(angle)], rtol=1e-13)
    half = interval(None, wave, LIMIT=0.01)
    lanes.carry(half, values, None, wave, np.zeros((roots.SCRATCH, LANES)), 50, LANES, True)
    np.testing.assert_allclose(half[row.X], [closed(before, lane, 0.01)[0] for lane in range(LANES)], rtol=1e-12)
    np.testing.assert_allclose(half[row.TAU], before[row.TAU] + 0.01)
    assert (half[row.K] == before[row.K]).all() and (half[row.B0] == before[row.B0]).all()


# Steps of the nonlinear block are halved until their last two terms are below 1e-14.
def test_the_nonlinear_block_takes_the_longest_half_whose_tail_is_small() -> None:
    table = interval("nonlinear", None, P2=4000.0)
    before = table.copy()
    lanes.carry(table, runs_of(False).values, "nonlinear", None, np.zeros((roots.SCRATCH, LANES)), 50, LANES, True)
    c, tau = table[row.C_FIRST : row.C_FIRST + 10], table[row.REACH_OLD]
    assert (tau < 0.017).any()
    tail = np.abs(c[8]) * tau**8 + np.abs(c[9]) * tau**9
    assert (tail <= 1e-14).all()
    longer = np.abs(c[8]) * (2.0 * tau) ** 8 + np.abs(c[9]) * (2.0 * tau) ** 9
    assert (longer[tau < 0.017] > 1e-14).all()
    halvings = np.log2(0.017 / tau)
    np.testing.assert_allclose(halvings, np.round(halvings), atol=1e-9)
    for lane in range(LANES):
        plain = np.polynomial.Polynomial(c[:, lane])
        assert table[row.X, lane] == pytest.approx(plain(tau[lane]), rel=1e-12)
        assert table[row.V, lane] == pytest.approx(plain.deriv()(tau[lane]), rel=1e-11)
    np.testing.assert_array_equal(table[row.K], before[row.K] + (tau >= 0.017))


# Every lane lands at its own time, by bisection of the closed form; even lanes so slowly that they then rest.
@pytest.mark.parametrize("wave", [None, True])
def test_lanes_land_where_the_closed_form_vanishes_and_leave_with_e_of_the_speed(wave: Any) -> None:
    table = interval(None, wave, X=np.linspace(0.001, 0.003, LANES), V=-0.4, WATCH=0.9)
    table[row.OMEGA_REST, ::4], table[row.ONSET] = 9.0, 0.5
    before = table.copy()
    lanes.carry(table, runs_of(False).values, None, wave, np.zeros((roots.SCRATCH, LANES)), 50, 1, True)
    for lane in range(LANES):
        low, high = 0.0, 0.0169
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if closed(before, lane, middle)[0] > 0.0 else (low, middle)
        assert table[row.REACH_OLD, lane] == pytest.approx(high, rel=1e-11)
        assert table[row.V, lane] == pytest.approx(-0.8 * closed(before, lane, high)[1], rel=1e-11)
        assert table[row.TAU, lane] == pytest.approx(before[row.TAU, lane] + high, rel=1e-12)
        now = turns.moment(before, lane) + high
        rows_are(table, lane, X=0.0, S=-before[row.S, lane], K=before[row.K, lane], FLOOR=-math.inf, LAST=now)
        rows_are(table, lane, IMPACTS=1.0, EVENTS=before[row.EVENTS, lane] + 1.0, HIT_OLD=1.0, STALLS=0.0)
        assert table[row.CALL, lane] == (row.RESTS if lane % 4 == 0 else row.NOTHING)


def test_lanes_fall_and_pass_the_balance_and_reach_the_edge_within_a_step() -> None:
    table = interval(None, None, X=[1.565, ALPHA - 0.002] * (LANES // 2), V=0.6, PEAK=0.01, WATCH=0.01, K_EDGE=5.0)
    before, values = table.copy(), runs_of(False).values
    lanes.carry(table, values, None, None, np.zeros((roots.SCRATCH, LANES)), 50, LANES, True)
    assert table[row.CALL].tolist() == [row.FALLS, row.EDGE] * (LANES // 2)
    for lane in range(4):
        level = 0.5 * math.pi if lane % 2 == 0 else ALPHA
        low, high = 0.0, 0.017
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if closed(before, lane, middle)[0] < level else (low, middle)
        at = table[row.FELL_AT if lane % 2 == 0 else row.PASSAGE, lane]
        assert at == pytest.approx(turns.moment(before, lane) + high, rel=1e-13)
        if lane % 2:
            rows_are(table, lane, PEAK=closed(before, lane, 0.017)[0], WATCH=ALPHA, EVENTS=before[row.EVENTS, lane] + 1)
        else:
            rows_are(table, lane, PEAK=0.5 * math.pi, V_FELL=closed(before, lane, high)[1])
    # Below the largest tilt, by more than a flight bulges, nothing is looked up; above, it is.
    for peak, top in ((0.35, 0.35), (0.3, 0.3)):
        flat = interval(None, None, X=0.299, V=0.0, PEAK=peak, WATCH=peak, BULGE=0.01)
        start = flat.copy()
        lanes.carry(flat, values, None, None, np.zeros((roots.SCRATCH, LANES)), 50, LANES, True)
        ends = np.array([closed(start, lane, 0.017)[0] for lane in range(LANES)])
        np.testing.assert_allclose(flat[row.PEAK], np.maximum(top, ends), rtol=1e-13)


# Lanes near the floor wait for others: their impact is looked for after four turns, or at once where enough are near.
def test_lanes_near_the_floor_wait_no_longer_than_four_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    searches: list[int] = []
    search = lanes.first_landing

    def noted(*given: Any) -> Any:
        searches.append(1)
        return search(*given)

    monkeypatch.setattr(lanes, "first_landing", noted)
    for quorum, looked in ((LANES, [0, 0, 0, 1]), (1, [1])):
        table = interval(None, None, X=[0.001] + [0.15] * (LANES - 1), V=-0.4, OMEGA_REST=9.0, ONSET=0.5, K_EDGE=99.0)
        searches.clear()
        lanes.carry(table, runs_of(False).values, None, None, np.zeros((roots.SCRATCH, LANES)), 50, quorum, False)
        assert len(searches) == 1
        rows_are(table, 0, CALL=row.RESTS, IMPACTS=1.0, K=4.0)
        rows_are(table, 1, CALL=row.NOTHING, IMPACTS=0.0, K=4.0 + len(looked))
        assert table[row.TAU, 0] > 0.003
