"""What a lane of the Taylor solver asks for between steps, function by function: stretches, waits, chatters.

`test_taylor` has the compiled functions.
"""

import math
from typing import Any

import numpy as np
import pytest
from functions_of_taylor import ALPHA, P2, G, rows_are, runs_of
from functions_of_taylor import interpreted as interpreted  # for every test of this file

from rocking.hybrid import REST, ROTATION
from rocking.solvers.recording import FELL, MAX_STALLED, REACHED_END, STALL_TIME, STALLED, TOO_MANY_EVENTS
from rocking.solvers.taylor import columns, turns, waits
from rocking.solvers.taylor import table as row
from rocking.solvers.taylor.vector import LANES


def begun(runs: Any, run: int, wave: Any, form: Any = None, lane: int = 3, logging: bool = False) -> np.ndarray:
    table = np.full((row.ALL_ROWS, LANES), 77.0)
    assert turns.begin(table, lane, runs, run, form, wave, logging)
    assert (np.delete(table, lane, axis=1) == 77.0).all()
    return table


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


# From the threshold itself to twice the other one: it stands up to there, two thirds of the way.
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_block_at_its_threshold_stands_until_the_other_one_is_crossed(side: float) -> None:
    runs = runs_of(False)
    table = begun(runs, 0, None)
    turns.enter_record(table, 3, runs)
    turns.be_in_interval(table, 3, runs.values, 0, 0.0, 0.02)
    table[row.ONSET, 3], table[row.B0, 3], table[row.B1, 3] = 0.2, 0.2 * side, -0.4 * side
    assert turns.exceeds(table, 3, runs, None)
    assert table[row.TAU, 3] == pytest.approx(2.0 / 3.0 * 0.02, rel=1e-12) and table[row.S, 3] == side


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


def test_the_crest_of_a_growing_sine_is_where_its_slope_is_zero() -> None:
    """t |sin(omega t)| has the slope of sin a + (wt + a) cos a: to rounding, of any half cycle from the first on."""
    for wt in np.linspace(-math.pi, 60.0, 400):
        a = waits.crest(wt)
        assert max(0.5 * math.pi, -wt) <= a <= math.pi
        assert math.sin(a) + (wt + a) * math.cos(a) == pytest.approx(0.0, abs=1e-15 * (10.0 + wt))


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


@pytest.mark.parametrize(
    ("phase", "level", "at"), [(math.pi / 6.0, 3.0, 3.0), (-math.pi / 6.0, 3.0, 3.0), (0.0, 3.0, math.inf)]
)
def test_a_wave_that_does_not_turn_grows_in_a_straight_line(phase: float, level: float, at: float) -> None:
    """By hand: 2 t |sin(phase)| is at the level at t = level / (2 |sin(phase)|); never where the sine is zero."""
    assert waits.wave_exceeds(0.0, phase, 2.0, level, 0.0, 10.0) == pytest.approx(at, rel=1e-12)
    assert waits.wave_exceeds(0.0, phase, 2.0, level, 0.0, 2.9) == math.inf
