"""One stretch of the exact solver, function by function: flights, tips, events, samples, against closed forms.

`test_exact` has the compiled functions.
"""

import math
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pytest
from functions_of_exact import (
    BODY,
    COEFFICIENTS,
    PAR,
    WAVE,
    G,
    counting,
    flown,
    fresh,
    linear_flight,
    log_of,
    plan_of,
    sine_flight,
)
from functions_of_exact import interpreted as interpreted  # for every test of this file

from rocking.hybrid import REST, ROTATION
from rocking.method1 import FALL, IMPACT, TIP
from rocking.solvers.exact import step
from rocking.solvers.exact.step import Body
from rocking.solvers.recording import FELL, MAX_STALLED, REACHED_END, STALL_TIME, STALLED, TOO_MANY_EVENTS
from rocking.trajectory import BALANCE

# ------------------------------------------------------------------------------------------------ flights and tips


def test_the_closed_forms_solve_the_equation_of_the_block() -> None:
    with mpmath.workdps(40):
        for x, push in (
            (linear_flight(BODY, PAR, 1.3, -2.1), lambda t: 1.3 - 2.1 * t),
            (sine_flight(BODY, PAR, WAVE, 0.9), lambda t: 1.7 * (0.9 + t) * mpmath.sin(5 * (0.9 + t) + 0.4)),
        ):
            want = PAR[0] * (x(0.3) - PAR[1] - BODY.s * push(mpmath.mpf("0.3")) / PAR[2])
            assert float(mpmath.diff(x, 0.3, 2)) == pytest.approx(float(want), rel=1e-9)


@pytest.mark.parametrize("s", [1.0, -1.0])
def test_coefficients_of_a_flight_are_those_of_the_closed_form(s: float) -> None:
    body, plan = BODY._replace(s=s), plan_of()
    t0, tau = 0.7, 0.2
    with mpmath.workdps(50):
        on_line = [float(c) for c in mpmath.taylor(linear_flight(body, PAR, 1.3 - 2.1 * tau, -2.1), 0, 9)]
        on_sine = [float(c) for c in mpmath.taylor(sine_flight(body, PAR, WAVE, t0 + tau), 0, 9)]
        base = mpmath.taylor(lambda t: WAVE.rate * t * mpmath.sin(WAVE.omega * t + WAVE.phase), t0 + tau, 9)
        wave = [float(c) for c in base]
    np.testing.assert_allclose(step.flight(plan, body, t0, tau, (1.3, -2.1), None), on_line, rtol=2e-14)
    np.testing.assert_allclose(step.sine_at(WAVE, t0 + tau), wave, rtol=3e-14, atol=1e-13)
    np.testing.assert_allclose(step.flight(plan, body, t0, tau, (9.0, 9.0), WAVE), on_sine, rtol=2e-12, atol=1e-14)


def test_the_base_is_its_line_or_its_sine() -> None:
    assert step.acceleration(5.0, 0.3, (1.1, -2.0), None) == pytest.approx(0.5)
    assert step.acceleration(0.5, 0.3, (1.1, -2.0), WAVE) == pytest.approx(1.7 * 0.8 * math.sin(4.4))


# Lines: the crossing by hand. a_rest = 0.19 g = 1.8639.
def test_a_block_tips_where_a_line_crosses_the_threshold() -> None:
    plan, limit = plan_of(), 0.19 * G
    assert step.tip(plan, 3.0, 0.1, 0.5, (1.0, 4.0), None) == pytest.approx(((limit - 1.0) / 4.0, 1.0))
    assert step.tip(plan, 3.0, 0.1, 0.5, (-1.0, -4.0), None) == pytest.approx(((limit - 1.0) / 4.0, -1.0))
    assert step.tip(plan, 3.0, 0.1, 0.5, (2.5, -0.1), None) == (0.1, 1.0)
    assert step.tip(plan, 3.0, 0.1, 0.5, (-2.5, 0.1), None) == (0.1, -1.0)
    assert step.tip(plan, 3.0, 0.1, 0.5, (1.0, 1.0), None)[0] == math.inf
    assert step.tip(plan, 3.0, 0.1, 0.5, (limit, 0.0), None)[0] == math.inf  # it stands at the threshold itself
    at, _ = step.tip(plan, 3.0, 0.1, 0.5, (limit - 0.4, 0.8 + 1e-9), None)
    assert at == pytest.approx(0.5, abs=1e-8) and at <= 0.5


@pytest.mark.parametrize("phase", [0.4, 0.4 + math.pi])
def test_a_block_tips_where_a_sine_first_crosses_the_threshold(phase: float) -> None:
    wave, plan = WAVE._replace(phase=phase), plan_of()
    for t0 in np.arange(1.0, 3.0, 0.025):
        t = t0 + np.linspace(0.005, 0.025, 20001)
        a = wave.rate * t * np.sin(wave.omega * t + wave.phase)
        over = np.flatnonzero(np.abs(a) > plan.a_rest)
        at, sign = step.tip(plan, t0, 0.005, 0.025, (0.0, 0.0), wave)
        if not over.size:
            assert at > 0.025
        elif over[0] == 0:
            assert (at, sign) == (0.005, math.copysign(1.0, a[0]))
        else:
            assert at == pytest.approx(t[over[0]] - t0, abs=2e-6)
            assert sign == math.copysign(1.0, a[over[0]])


# ------------------------------------------------------------------------------------------------ events and samples


def test_the_sums_of_a_run_begin_with_its_own_start() -> None:
    for x, watch in ((-0.11, 0.11), (0.5, 0.23)):
        tally = fresh(plan_of(), BODY._replace(x=x), 7.0)
        assert tally[[step.PEAK, step.WATCH, step.PASSAGE, step.END]].tolist() == [abs(x), watch, 0.5, 7.0]
        assert tally[step.LAST_EVENT] == -math.inf
        assert tally[step.STATUS] == REACHED_END
        assert tally[[step.STALLS, step.EVENTS, step.IMPACTS, step.SAVED]].tolist() == [0.0, 0.0, 0.0, 0.0]


def test_an_event_is_written_down_with_its_state_before_and_after() -> None:
    tally, log = fresh(plan_of()), log_of(room=2)
    before, after = Body(ROTATION, -1.0, 0.3, 0.7), Body(REST, 1.0, 0.2, 0.9)
    for t in (1.0, 2.0, 3.0):
        step.note(tally, log, t, IMPACT, before, after, 9)
    assert tally[step.EVENTS] == 3.0
    assert log.event_t.tolist() == [1.0, 2.0]
    assert log.event_code[1].tolist() == [IMPACT, ROTATION, REST]
    assert log.event_s.tolist() == [1.0, 1.0]
    assert log.event_y[1].tolist() == [[-0.3, -0.7], [0.2, 0.9]]
    assert (tally[step.LAST_EVENT], tally[step.STALLS], tally[step.STATUS]) == (3.0, 0.0, REACHED_END)


def test_a_run_ends_by_a_fall_by_too_many_events_or_by_time_that_stands_still() -> None:
    tally, log = fresh(plan_of()), log_of(room=0)
    step.note(tally, log, 1.0, FALL, BODY, BODY, 9)
    assert (tally[step.STATUS], tally[step.END]) == (FELL, 1.0)
    tally = fresh(plan_of())
    for n in range(3):
        assert tally[step.STATUS] == REACHED_END
        step.note(tally, log, 1.0 + n, IMPACT, BODY, BODY, 2)
    assert (tally[step.STATUS], tally[step.END]) == (TOO_MANY_EVENTS, 3.0)
    tally = fresh(plan_of())
    step.note(tally, log, 1.0, BALANCE, BODY, BODY, 0)
    assert (tally[step.EVENTS], tally[step.LAST_EVENT], tally[step.STATUS]) == (1.0, -math.inf, REACHED_END)
    tally = fresh(plan_of())
    for n in range(MAX_STALLED + 2):
        assert tally[step.STATUS] == REACHED_END
        step.note(tally, log, n * 0.9 * STALL_TIME, IMPACT, BODY, BODY, 10**6)
    assert (tally[step.STATUS], tally[step.STALLS]) == (STALLED, MAX_STALLED + 1.0)
    step.note(tally, log, 1.0, IMPACT, BODY, BODY, 10**6)
    assert tally[step.STALLS] == 0.0


def test_samples_of_a_stretch_are_those_of_its_flight() -> None:
    log, body = log_of([0.9, 1.0, 1.25, 1.5, 1.6]), BODY
    tally = fresh(plan_of())
    tally[step.SAVED] = 1.0
    step.keep(tally, log, body, COEFFICIENTS, 1.0, 0.5)
    plain = np.polynomial.Polynomial(COEFFICIENTS)
    assert tally[step.SAVED] == 4.0
    tau = np.array([0.0, 0.25, 0.5])
    np.testing.assert_allclose(log.y[1:4], -np.column_stack([plain(tau), plain.deriv()(tau)]), rtol=1e-13)
    assert np.isnan(log.y[[0, 4]]).all()
    assert log.mode[1:4].tolist() == [ROTATION] * 3 and log.s[1:4].tolist() == [-1.0] * 3
    assert step.standing(body) == (0.11, *[0.0] * 9)


# x = alpha - 0.05 + v t - b t^2: a parabola whose passage, crest and fall are known.
def test_passage_crest_and_fall_of_a_step_are_those_of_the_parabola() -> None:
    plan, log = plan_of(), log_of()

    def looked(x: float, v: float, b: float, reach: float) -> tuple[Any, float]:
        c = (x, v, -b, *[0.0] * 7)
        tally = fresh(plan)
        end = step.look_up(
            plan, Body(ROTATION, 1.0, x, v), c, 2.0, reach, x + v * reach - b * reach**2, v - 2 * b * reach, tally, log
        )
        return tally, end

    tally, end = looked(0.18, 0.5, 0.0, 0.3)
    assert end == math.inf
    assert tally[step.PASSAGE] == pytest.approx(2.1)
    assert tally[step.EVENTS] == 1.0
    assert log.event_y[0, 0].tolist() == pytest.approx([0.23, 0.5])
    assert (tally[step.PEAK], tally[step.WATCH]) == pytest.approx((0.33, 0.23))
    tally, end = looked(0.1, 0.4, 1.0, 0.35)
    assert tally[step.PEAK] == pytest.approx(0.14) and tally[step.WATCH] == pytest.approx(0.14)
    assert (tally[step.EVENTS], tally[step.PASSAGE], end) == (0.0, 0.5, math.inf)
    tally, end = looked(0.12, -0.4, 0.0, 0.1)
    assert tally[step.PEAK] == pytest.approx(0.12)
    tally, end = looked(0.01, -0.01, -0.1, 0.1)
    assert tally[step.PEAK] == 0.11  # as large as before
    tally, end = looked(1.4, 1.0, 0.0, 0.5)
    assert end == pytest.approx(0.5 * math.pi - 1.4)
    assert tally[step.PEAK] == 0.5 * math.pi and tally[step.EVENTS] == 0.0


def test_an_impact_reverses_the_speed_by_e_and_rests_below_the_rest_speed_where_the_base_lets_it() -> None:
    plan = plan_of()
    after = step.after_impact(plan, BODY, -0.5, 1.0, 0.1, (1.0, 0.0), None)
    assert after == pytest.approx((ROTATION, 1.0, 0.0, 0.4))
    assert step.after_impact(plan, BODY, -1e-3, 1.0, 0.1, (1.0, 0.0), None) == Body(REST, 1.0, 0.0, 0.0)
    for line in ((-1.0, -20.0), (1.0, 20.0)):  # the base has become too much at tau = 0.1
        after = step.after_impact(plan, BODY, -1e-3, 1.0, 0.1, line, None)
        assert after == pytest.approx((ROTATION, 1.0, 0.0, 8e-4))
    assert step.after_impact(plan, BODY, 1e-18, 1.0, 0.1, (5.0, 0.0), None).v == 0.0
    still = plan._replace(omega_rest=0.0)
    assert step.after_impact(still, BODY, 0.0, 1.0, 0.1, (0.0, 0.0), None).mode == ROTATION


# ------------------------------------------------------------------------------------------------ stretches


# Free flight on a line from x = 0.11: impact where the closed form vanishes, by mpmath's root.
def test_a_stretch_is_carried_as_the_closed_form_through_its_impact() -> None:
    body = Body(ROTATION, -1.0, 0.03, 0.1)
    x = linear_flight(body, PAR, 1.3, -2.1)
    with mpmath.workdps(30):
        hit = float(mpmath.findroot(x, 0.3))
    (_, v_hit), after = flown(x, hit)[0], Body(ROTATION, 1.0, 0.0, 0.0)
    after = after._replace(v=-0.8 * v_hit)
    y = linear_flight(after, PAR, 1.3 - 2.1 * hit, -2.1)
    times = np.linspace(0.0, 0.6, 41)
    tally, log = fresh(plan_of(), body), log_of(3.0 + times)
    end = step.carry(plan_of(), body, 3.0, 0.0, 0.6, (1.3, -2.1), None, tally, log)
    assert log.event_t[0] - 3.0 == pytest.approx(hit, abs=1e-15 * 10)
    first = times < hit
    np.testing.assert_allclose(log.y[first], -flown(x, times[first]), rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(log.y[~first], flown(y, times[~first] - hit), rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose((end.x, end.v), flown(y, 0.6 - hit)[0], rtol=1e-12)
    assert (end.s, end.mode, tally[step.IMPACTS], tally[step.EVENTS]) == (1.0, ROTATION, 1.0, 1.0)
    np.testing.assert_allclose(log.event_y[0], [[0.0, -v_hit], [0.0, after.v]], rtol=1e-12, atol=1e-14)
    with mpmath.workdps(30):
        crest = float(x(mpmath.findroot(lambda t: mpmath.diff(x, t), 0.1)))
    assert tally[step.PEAK] == pytest.approx(crest, rel=1e-14)
    assert tally[step.WATCH] == pytest.approx(crest, rel=1e-14)


# On the sine, in two parts and from a later begin; and the largest tilt is looked for near the largest so far alone.
def test_a_stretch_on_a_sine_is_the_closed_form_from_wherever_it_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    body = Body(ROTATION, 1.0, 0.12, 0.05)
    t = np.linspace(0.0, 0.05, 6)
    want = flown(sine_flight(body, PAR, WAVE, 1.03), t)
    looks = counting(monkeypatch, step, "look_up")
    for peak, many in ((0.2, False), (0.0, True)):
        tally, log = fresh(plan_of()), log_of(1.03 + t)
        tally[step.PEAK] = tally[step.WATCH] = peak
        looks[0] = 0
        end = step.carry(plan_of(), body, 1.0, 0.03, 0.08, (9.0, 9.0), WAVE, tally, log)
        np.testing.assert_allclose((end.x, end.v), want[-1], rtol=1e-11)
        np.testing.assert_allclose(log.y[:-1], want[:-1], rtol=1e-12)
        assert (looks[0] > 0) is many
        assert tally[step.PEAK] == pytest.approx(max(peak, want[:, 0].max()) if many else peak, rel=1e-12)


def test_a_fall_ends_the_stretch_where_the_tilt_is_a_right_angle() -> None:
    body = Body(ROTATION, -1.0, 0.2, 1.0)
    x = linear_flight(body, PAR, 0.5, 0.2)
    with mpmath.workdps(30):
        passage = float(mpmath.findroot(lambda t: x(t) - PAR[1], 0.03))
        fall = float(mpmath.findroot(lambda t: x(t) - mpmath.pi / 2, 0.8))
    tally, log = fresh(plan_of(), body), log_of([2.0 + 0.5 * fall, 2.0 + fall + 0.01])
    end = step.carry(plan_of(), body, 2.0, 0.0, 3.0, (0.5, 0.2), None, tally, log)
    assert (tally[step.STATUS], end.x, tally[step.SAVED]) == (FELL, 0.5 * math.pi, 1.0)
    assert tally[step.END] == pytest.approx(2.0 + fall, rel=1e-14)
    assert tally[step.PASSAGE] == pytest.approx(2.0 + passage, rel=1e-14)
    assert end.v == pytest.approx(flown(x, fall)[0, 1], rel=1e-12)
    assert log.event_code[:2, 0].tolist() == [BALANCE, FALL]


def test_a_block_that_stands_leaves_where_the_base_lets_it_and_rocks_from_there() -> None:
    rest, plan = Body(REST, 1.0, 0.0, 0.0), plan_of()
    at = (0.19 * G - 1.0) / 4.0
    tally, log = fresh(plan, rest), log_of([2.1, 2.0 + at + 0.05])
    end = step.carry(plan, rest, 2.0, 0.1, 0.5, (1.0, 4.0), None, tally, log)
    assert log.event_t[0] == pytest.approx(2.0 + at, rel=1e-14)
    assert log.event_code[0].tolist() == [TIP, REST, ROTATION] and log.event_s[0] == -1.0
    # The onset is below the tilt that the block bears, 0.19 < 0.23: it is pulled back, and what pulls back is left out.
    on = step.carry(plan, rest, 2.0, 0.1, at + 0.02, (1.0, 4.0), None, fresh(plan, rest), log_of())
    with mpmath.workdps(30):
        c = mpmath.taylor(linear_flight(Body(ROTATION, -1.0, 0.0, 0.0), PAR, 0.19 * G, 4.0), 0, 9)
        c[2] = mpmath.mpf(0)
        want = [float(mpmath.polyval(c[::-1], 0.02)), float(mpmath.diff(lambda t: mpmath.polyval(c[::-1], t), 0.02))]
    np.testing.assert_allclose((on.x, on.v), want, rtol=1e-13)
    tally, log = fresh(plan, rest), log_of([2.1, 2.3])
    end = step.carry(plan, rest, 2.0, 0.1, 0.5, (1.0, 1.0), None, tally, log)
    assert end == rest and tally[step.EVENTS] == 0.0 and tally[step.SAVED] == 2.0 and log.mode.tolist() == [REST] * 2


def test_samples_without_events_are_those_of_the_closed_form_over_several_steps() -> None:
    t = np.array([0.0, 0.01, 0.05, 0.11, 0.2])
    for line, sine, x in (
        ((1.3, -2.1), None, linear_flight(BODY, PAR, 1.3, -2.1)),
        ((9.0, 9.0), WAVE, sine_flight(BODY, PAR, WAVE, 1.0)),
    ):
        tally, log = fresh(plan_of()), log_of([*(1.0 + t), 1.21])
        step.keep_flight(plan_of(), BODY, 1.0, 0.2 + 1e-9, line, sine, tally, log)
        assert tally[step.SAVED] == t.size
        np.testing.assert_allclose(log.y[:-1], -flown(x, t), rtol=1e-11)
