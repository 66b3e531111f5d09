"""Whole runs of the exact solver over a record or a sine, function by function: closed forms, blocks followed.

`test_exact` has the compiled functions.
"""

import math
from typing import Any

import numpy as np
import pytest
from functions_of_exact import (
    PAR,
    WAVE,
    Followed,
    G,
    counting,
    flown,
    fresh,
    line_flight_of,
    linear_flight,
    log_of,
    plan_of,
    sine_flight,
    sine_flight_of,
)
from functions_of_exact import interpreted as interpreted  # for every test of this file

from rocking.hybrid import REST, ROTATION
from rocking.solvers.exact import kernel, step
from rocking.solvers.exact.kernel import Record, Sine
from rocking.solvers.exact.step import Body
from rocking.solvers.taylor.records import BLOCK


def test_constants_of_a_run_are_its_parameters_and_bounds() -> None:
    plan = plan_of(0.02, 4.0)
    assert plan[:6] == pytest.approx((3.0, 9.0, 0.23, 1.0 / G, 0.8, 1e-3))
    assert (plan.longest, plan.a_rest, plan.dt, plan.per_p) == pytest.approx((1 / 36, 0.19 * G, 0.02, 1 / 3))
    assert (plan.grow, plan.decay, plan.max_events) == pytest.approx((math.exp(0.06), math.exp(-0.06), 40))
    # |x''| <= p^2 (alpha + |a_x|/g) below the balance: an arc rises by an eighth of that times the square of its chord.
    assert plan.bulge == pytest.approx(9.0 * (0.23 + 4.0 / G) / 8.0, rel=2e-6)
    assert plan.bulge >= 9.0 * (0.23 + 4.0 / G) / 8.0
    assert plan_of(0.02, 0.2 * G).clear == 0.0  # the base cannot overcome alpha: no impact between positive tilts


def test_the_next_push_is_the_first_sample_beyond_and_quiet_blocks_are_not_looked_at() -> None:
    values = np.zeros(3 * BLOCK + 5)
    values[[7, 40, 70, 100]] = -0.5, 2.0, -3.0, 9.0
    bends, peaks = kernel.prepared(values)
    record = Record(values, bends, peaks, 0.0, 0.1, 10.0)
    for k in range(values.size + 1):
        for threshold in (0.4, 0.5, 1.0, 2.5, 4.0, 10.0):
            over = np.flatnonzero(np.abs(values[k:]) > threshold)
            assert kernel.next_push(record, k, threshold) == (k + over[0] if over.size else values.size)
    assert peaks.tolist() == [0.5, 2.0, 3.0, 9.0]
    unseen = Record(np.where(np.arange(values.size) < BLOCK, 5.0, values), bends, peaks, 0.0, 0.1, 10.0)
    assert kernel.next_push(unseen, 0, 0.5) == 40
    assert kernel.next_push(unseen, 0, 0.49) == 0
    assert kernel.next_push(unseen, 1, 0.5) == 1


def test_second_differences_of_a_record_are_those_of_numpy_and_zero_at_its_ends() -> None:
    values = np.random.default_rng(2).normal(size=BLOCK + 9)
    bends, peaks = kernel.prepared(values)
    np.testing.assert_allclose(bends, [0.0, *np.diff(values, 2), 0.0], atol=1e-15)
    np.testing.assert_array_equal(peaks, [np.abs(values[:BLOCK]).max(), np.abs(values[BLOCK:]).max()])


RECORD = (np.array([0.2, 0.5, -0.3, 0.9, 1.4, 0.6, -0.8, -0.2, 0.4]), 0.02, 0.3)


def record_of(values: Any, dt: float, t_first: float) -> Record:
    bends, peaks = kernel.prepared(values)
    return Record(values, bends, peaks, t_first, dt, 1.0 / dt)


@pytest.mark.parametrize("s", [1.0, -1.0])
def test_intervals_of_a_record_are_passed_as_the_closed_form_from_one_to_the_next(s: float) -> None:
    values, dt, t_first = RECORD
    record, plan = record_of(*RECORD), plan_of(dt, 2.0)
    body = Body(ROTATION, s, 0.15, 0.05)
    want = [(body.x, body.v)]
    for k in range(values.size - 1):
        x = linear_flight(Body(ROTATION, s, *want[-1]), PAR, values[k], (values[k + 1] - values[k]) / dt)
        want.append(tuple(flown(x, dt)[0]))
    tilts = np.array(want)[:, 0]
    for first in (0, 2):
        there = Body(ROTATION, s, *want[first])
        for k_stop in (first, first + 1, 5, 8):
            tally, log = fresh(plan), log_of(t_first + dt * np.arange(9.0) + 0.5 * dt)
            tally[step.WATCH], tally[step.SAVED] = 1.0, first
            k, on = kernel.scan_record(plan, there, record, first, k_stop, tally, log)
            assert k == k_stop
            np.testing.assert_allclose((on.x, on.v), want[k], rtol=1e-12)
            assert (on.mode, on.s, tally[step.SAVED]) == (ROTATION, s, k_stop)
            for j in range(first, k_stop):
                x = linear_flight(Body(ROTATION, s, *want[j]), PAR, values[j], (values[j + 1] - values[j]) / dt)
                np.testing.assert_allclose(log.y[j], s * flown(x, 0.5 * dt)[0], rtol=1e-12)
    # It stops before a tilt that might be the largest, or not clear of the floor.
    rising = np.argmax(tilts > tilts[0] * 1.02) if tilts.max() > tilts[0] * 1.02 else 0
    tally = fresh(plan)
    tally[step.WATCH] = 0.5 * (tilts[rising - 1] + tilts[rising]) + plan.bulge * dt * dt if rising else 1.0
    k, on = kernel.scan_record(plan, body, record, 0, 8, tally, log_of())
    assert k == (rising - 1 if rising else 8)
    tally[step.WATCH] = body.x
    assert kernel.scan_record(plan, body, record, 0, 8, tally, log_of()) == (0, body)
    low = plan._replace(clear=body.x)
    tally[step.WATCH] = 1.0
    assert kernel.scan_record(low, body, record, 0, 8, tally, log_of()) == (0, body)
    assert kernel.limits(low, tally) == (body.x, 1.0 - plan.bulge * dt * dt)
    assert kernel.line_of(record, 3) == pytest.approx((0.9, 25.0))


@pytest.mark.parametrize("s", [1.0, -1.0])
def test_intervals_of_a_sine_are_passed_as_the_closed_form_from_one_to_the_next(s: float) -> None:
    dt, n = kernel.sine_interval(WAVE, 3.0)
    plan = plan_of(dt, 4.0)
    assert n * dt == pytest.approx(6.0) and dt <= 1.0 / 40.0 < 6.0 / (n - 1)
    body, first = Body(ROTATION, s, 0.13, 0.02), 11
    x = sine_flight(body, PAR, WAVE, first * dt)
    want = flown(x, dt * np.arange(6))
    for k_stop in range(first, first + 6):
        tally, log = fresh(plan), log_of(dt * (first + np.arange(6.0) + 0.5))
        tally[step.WATCH] = 9.0
        k, on = kernel.scan_sine(plan, body, WAVE, dt, first, k_stop, tally, log)
        assert k == k_stop and (on.mode, on.s) == (ROTATION, s)
        np.testing.assert_allclose((on.x, on.v), want[k - first], rtol=1e-12)
        assert tally[step.SAVED] == k - first
    np.testing.assert_allclose(log.y[:5], s * flown(x, dt * (np.arange(5) + 0.5)), rtol=1e-11)
    tally[step.WATCH] = body.x
    assert kernel.scan_sine(plan, body, WAVE, dt, first, first + 5, tally, log_of()) == (first, body)
    low = plan._replace(clear=body.x)
    tally[step.WATCH] = 9.0
    assert kernel.scan_sine(low, body, WAVE, dt, first, first + 5, tally, log_of()) == (first, body)


@pytest.mark.parametrize(("omega", "longest"), [(5.0, 1 / 40), (-5.0, 1 / 40), (1.0, 1 / 36), (0.0, 1 / 36)])
def test_a_sine_is_laid_over_the_fewest_intervals_that_are_short_enough(omega: float, longest: float) -> None:
    dt, n = kernel.sine_interval(WAVE._replace(omega=omega), 3.0)
    assert dt * n == pytest.approx(6.0, rel=1e-15)
    assert dt <= longest * (1 + 1e-15) < 6.0 / (n - 1)


# |a''| <= rate (t omega^2 + 2 omega), so between its ends |a_x| is more by an eighth of that times dt^2 at most.
def test_the_interval_in_which_a_sine_may_tip_is_not_called_long_before() -> None:
    plan = plan_of()
    for omega, phase in ((5.0, 0.4), (-5.0, 1.0), (0.8, 2.0), (0.0, 1.0), (9.0, -2.0)):
        for rate in (0.7, -0.7):
            wave = Sine(omega, phase, rate, 30.0)
            dt, n = kernel.sine_interval(wave, 3.0)
            for start in (0, 3, 150):
                k = kernel.next_shake(plan, wave, dt, start, n)
                t = dt * np.arange(n + 1)
                a = np.abs(rate * t * np.sin(omega * t + phase))
                over = 0.7 * (30.0 * omega**2 + 2.0 * abs(omega)) * dt**2 / 8.0
                reached = np.maximum(a[:-1], a[1:]) > plan.a_rest - over
                reached[:start] = False
                assert k == (np.argmax(reached) if reached.any() else n)
    assert kernel.next_shake(plan, WAVE._replace(rate=0.0), 0.1, 2, 9) == 9


def test_a_run_over_a_record_has_the_impacts_of_the_block_that_is_followed() -> None:
    rng = np.random.default_rng(11)
    values, dt, t_first = 2.5 * np.sin(0.4 * np.arange(60)) + rng.normal(size=60), 0.02, 0.25
    body = Body(ROTATION, 1.0, 0.08, 0.0)
    for t_start, t_end in ((0.0, 1.2), (0.31, 1.0), (0.25, 1.9), (0.0, 0.11)):
        one, edges = Followed(body, PAR), t_first + dt * np.arange(60)
        one.t = t_start
        pieces = [(0.0, 0.0, 0.0, t_first)]
        pieces += [(values[k], (values[k + 1] - values[k]) / dt, edges[k], edges[k + 1]) for k in range(59)]
        for a, slope, begin, end in [*pieces, (0.0, 0.0, edges[-1], 9.0)]:
            if end > t_start and begin < t_end:
                one.over(None, line_flight_of(PAR, a, slope, begin), min(end, t_end))
        log = log_of()
        tally, on = kernel.run_record(PAR, record_of(values, dt, t_first), body, t_start, t_end, 400, log)
        assert tally[step.IMPACTS] == len(one.impacts)
        np.testing.assert_allclose(log.event_t[: len(one.impacts)], one.impacts, rtol=1e-9)
        np.testing.assert_allclose((on.x, on.v, on.s), (one.body.x, one.body.v, one.body.s), rtol=1e-7)
        assert tally[step.PEAK] >= one.peak * (1.0 - 1e-12) and tally[step.PEAK] < one.peak + 1e-4
        assert tally[step.END] == t_end


def test_a_run_over_a_sine_has_the_impacts_of_the_block_that_is_followed() -> None:
    wave, body = Sine(5.0, 0.4, 1.1, 1.5), Body(ROTATION, 1.0, 0.08, 0.0)
    for t_start, t_end in ((-0.2, 1.3), (0.31, 1.9), (0.0, 0.11)):
        one = Followed(body, PAR)
        one.t = t_start
        pieces = [(-9.0, 0.0, None), (0.0, wave.duration, wave), (wave.duration, 9.0, None)]
        for begin, end, shakes in pieces:
            if end > t_start and begin < t_end:
                flight = sine_flight_of(PAR, wave) if shakes else line_flight_of(PAR, 0.0, 0.0, begin)
                one.over(None, flight, min(end, t_end))
        log = log_of()
        tally, on = kernel.run_sine(PAR, wave, body, t_start, t_end, 400, log)
        assert tally[step.IMPACTS] == len(one.impacts)
        np.testing.assert_allclose(log.event_t[: len(one.impacts)], one.impacts, rtol=1e-9)
        np.testing.assert_allclose((on.x, on.v, on.s), (one.body.x, one.body.v, one.body.s), rtol=1e-7)
        assert tally[step.PEAK] >= one.peak * (1.0 - 1e-12) and tally[step.PEAK] < one.peak + 1e-4


def test_a_block_that_stands_over_a_record_or_sine_leaves_at_the_first_crossing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rest, limit = Body(REST, 1.0, 0.0, 0.0), PAR[3] * G
    values = np.zeros(150)
    values[100:] = -0.5 * np.arange(50)
    carries = counting(monkeypatch, kernel, "carry")
    tally, _ = kernel.run_record(PAR, record_of(values, 0.02, 0.3), rest, 0.1, 9.0, 1, log := log_of())
    assert log.event_t[0] == pytest.approx(0.3 + 2.0 + limit / 25.0, rel=1e-12)
    assert carries[0] <= 60  # the quiet begin is passed at once, the fall has no more intervals than this
    tally, _ = kernel.run_record(PAR, record_of(0.1 * values, 0.02, 0.3), rest, 0.1, 2.9, 1, log := log_of([0.2, 2.5]))
    assert tally[step.EVENTS] == 0.0 and tally[step.SAVED] == 2.0
    t = np.arange(0.0, 3.0, 1e-5)
    first = t[np.argmax(np.abs(WAVE.rate * t * np.sin(WAVE.omega * t + WAVE.phase)) > limit)]
    carries[0] = 0
    kernel.run_sine(PAR, WAVE, rest, -0.5, 0.05 + first, 9, log := log_of())
    assert log.event_t[0] == pytest.approx(first, abs=1.1e-5)
    assert carries[0] <= 8
