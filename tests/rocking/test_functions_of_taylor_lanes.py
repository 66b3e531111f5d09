"""Steps of lanes of the Taylor solver, function by function: parabolas by hand, closed forms, bisection.

`test_taylor` has the compiled functions.
"""

import math
from typing import Any

import numpy as np
import pytest
from functions_of_taylor import ALPHA, COEFFICIENTS, P2, G, lanes_of, rows_are, runs_of
from functions_of_taylor import interpreted as interpreted  # for every test of this file

from rocking.solvers.recording import MAX_STALLED, STALL_TIME
from rocking.solvers.taylor import flight, lanes, roots, turns
from rocking.solvers.taylor import table as row
from rocking.solvers.taylor.vector import LANES

# ------------------------------------------------------------------------------------------------ parts of a step


def test_the_tail_of_a_flight_is_that_of_its_last_two_terms() -> None:
    h = lanes_of(np.linspace(0.2, 1.1, LANES))
    want = np.abs(COEFFICIENTS[8]) * h**8 + np.abs(COEFFICIENTS[9]) * h**9
    np.testing.assert_allclose(lanes.tail(COEFFICIENTS, h), want, rtol=1e-13)


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


# ------------------------------------------------------------------------------------------------ turns of the loop


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
