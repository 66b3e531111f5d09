"""Rounds of lanes on devices, function by function: closed forms, parabolas by hand, blocks that are followed.

`test_devices` has the compiled functions.
"""

import math
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pytest
from functions_of_exact import (
    PAR,
    Followed,
    G,
    base_of,
    column,
    fixed_of,
    flown,
    line_flight_of,
    linear_flight,
    sine_flight,
    sine_flight_of,
)
from functions_of_exact import interpreted as interpreted  # for every test of this file

from rocking.hybrid import ROTATION
from rocking.solvers.exact import jax_flight, jax_lanes, jax_rounds
from rocking.solvers.exact.kernel import Sine
from rocking.solvers.exact.step import Body
from rocking.solvers.recording import MAX_STALLED, REACHED_END, STALL_TIME, STALLED, TOO_MANY_EVENTS
from rocking.solvers.taylor.records import BLOCK

# ------------------------------------------------------------------------------------------------ passing intervals


# Over a dense sampling nothing that is passed over exceeds the threshold; what is not passed over nearly does.
@pytest.mark.parametrize("wave", [False, True])
def test_intervals_that_are_called_quiet_are_and_the_others_nearly_are_not(wave: bool) -> None:
    F, _ = fixed_of(wave)
    base = jax_lanes.Base(0.9 * base_of().values, 0.9 * base_of().peaks)
    F = F._replace(onset=np.array([0.12, 0.12]), k_last=np.array([200, 200]))
    grid = np.linspace(0.0, 1.0, 101)
    for k in range(-3, int(F.count.max()) + 4):
        ahead = jax_rounds.next_quiet(F, base, np.full(2, k), wave)
        for lane in range(2):
            count = F.count[lane]
            if k < 0 or k >= count:
                assert ahead[lane] == (0 if k < 0 else 200)
                continue
            top = 0.0
            for j in range(k, min(max(ahead[lane], k + 1), count)):
                if wave:
                    t = (j + grid) * F.dt[lane]
                    a = F.rate[lane] * t * np.sin(F.omega[lane] * t + F.phase[lane])
                else:
                    own = base.values[F.first[lane] + j : F.first[lane] + j + 2]
                    a = F.scale[lane] * (own[0] + (own[1] - own[0]) * grid)
                top = max(top, np.abs(a).max())
            if wave:  # |a''| <= rate (t omega^2 + 2 omega) between the ends
                t = np.array([k, k + 1]) * F.dt[lane]
                ends = np.abs(F.rate[lane] * t * np.sin(F.omega[lane] * t + F.phase[lane]))
                over = F.rate[lane] * (t[1] * F.omega[lane] ** 2 + 2.0 * F.omega[lane]) * F.dt[lane] ** 2 / 8.0
                assert (ahead[lane] == k) == (ends.max() + over > 0.12)
            if ahead[lane] > k:
                assert top <= 0.12
            else:
                assert top > (0.118 if wave else 0.12 * (1.0 - 1e-9))
    if wave:  # before the envelope reaches the threshold, at one blow
        assert jax_rounds.next_quiet(F, base, np.zeros(2, dtype=int), True).tolist() == [
            math.floor(0.12 / r / dt - 1e-9) - 1 for r, dt in zip(F.rate, F.dt, strict=True)
        ]


# Where the ends of an interval and an eighth of |a''| dt^2 make the threshold to ten digits, one way and the other.
def test_an_interval_of_a_sine_is_quiet_up_to_its_bound_and_not_beyond() -> None:
    F, _ = fixed_of(True)
    for k in (4, 20, 41):
        t = np.array([[k], [k + 1]]) * F.dt
        bound = (F.rate * t * np.abs(np.sin(F.omega * t + F.phase))).max(axis=0)
        bound = bound + F.rate * (t[1] * F.omega**2 + 2.0 * F.omega) * F.dt**2 / 8.0
        for share, quiet in ((1.0 + 1e-10, True), (1.0 - 1e-10, False)):
            ahead = jax_rounds.next_quiet(F._replace(onset=share * bound), base_of(), np.full(2, k), True)
            assert (ahead > k).tolist() == [quiet] * 2


def test_whole_blocks_of_quiet_samples_are_passed_at_one_blow() -> None:
    F, _ = fixed_of(False)
    F = F._replace(onset=np.full(2, 0.12), k_last=np.full(2, 500), count=np.full(2, 100), first=np.zeros(2, dtype=int))
    values = np.zeros(160)
    values[70] = 5.0
    base = jax_lanes.Base(values, np.abs(values).reshape(-1, BLOCK).max(axis=1))
    told = [int(jax_rounds.next_quiet(F, base, np.full(2, k), False)[0]) for k in (0, 1, 32, 64, 69, 70, 71, 96)]
    assert told == [32, 2, 33, 65, 69, 70, 72, 97]


@pytest.mark.parametrize("wave", [False, True])
@pytest.mark.parametrize("s", [1.0, -1.0])
def test_lanes_pass_intervals_as_the_closed_forms(wave: bool, s: float) -> None:
    (F, starts), base = fixed_of(wave), base_of()
    M = jax_lanes.begun(F, starts)
    first = np.array([3, 5])
    M = M._replace(
        k=first, tau=np.zeros(2), s=np.full(2, s), rests=np.array([False, False]), x=np.array([0.15, 0.17]),
        v=np.array([0.05, -0.02]), peak=np.full(2, 9.0),
    )  # fmt: skip
    F = F._replace(alpha=np.array([0.23, 0.3]), swell=np.full(2, -9.0))
    on = jax_rounds.pass_intervals(F, base, M, wave)
    assert on.k.tolist() == (first + jax_rounds.PASSED).tolist()
    gs = (G, 9.7)
    for lane in range(2):
        par = (F.p2[lane], F.alpha[lane], gs[lane])
        state, dt = (M.x[lane], M.v[lane]), F.dt[lane]
        body = Body(ROTATION, s, *state)
        if wave:
            own = Sine(F.omega[lane], F.phase[lane], F.rate[lane] * gs[lane], 9.0)
            state = tuple(flown(sine_flight(body, par, own, first[lane] * dt), jax_rounds.PASSED * dt)[0])
        else:
            for j in range(jax_rounds.PASSED):
                at = F.first[lane] + first[lane] + j
                a, b = F.scale[lane] * gs[lane] * base.values[at : at + 2]
                state = tuple(flown(linear_flight(Body(ROTATION, s, *state), par, a, (b - a) / dt), dt)[0])
        np.testing.assert_allclose((on.x[lane], on.v[lane]), state, rtol=1e-11)
    # None of these goes: under way in an interval, just tipped, bounded, too low, as high as the largest, at the end.
    for change in (
        {"tau": np.full(2, 1e-3)}, {"tipped": np.array([True, True])}, {"cap": np.ones(2)}, {"peak": M.x},
        {"status": np.zeros(2, dtype=int)}, {"x": np.array(F.clear)},
    ):  # fmt: skip
        held = jax_rounds.pass_intervals(F._replace(swell=np.full(2, 1e-9)), base, M._replace(**change), wave)
        assert held.k.tolist() == first.tolist()
    ends = jax_rounds.pass_intervals(F._replace(k_last=first + 2), base, M, wave)
    assert ends.k.tolist() == (first + 2).tolist()
    jumps = jax_rounds.pass_intervals(F, base, M._replace(k=np.array([-2, -2])), wave)
    assert jumps.k.tolist() == [0, 0]
    jumps = jax_rounds.pass_intervals(F._replace(k_last=np.full(2, 300)), base, M._replace(k=F.count - 2), wave)
    assert jumps.k.tolist() == F.count.tolist()


# ------------------------------------------------------------------------------------------------ steps


def lanes_like(x: Any, **change: Any) -> Any:
    """Lanes under way, one for each x, in interval 2 of a base; what is told of them is put in."""
    x = np.asarray(x, dtype=float)
    none, whole = np.zeros_like(x), np.zeros(x.shape, dtype=int)
    M = jax_lanes.Moving(
        x=x, v=none, s=none + 1.0, rests=none > 0.0, tipped=none > 0.0, k=whole + 2, tau=none, cap=none + math.inf,
        peak=none + 9.0, passage=none - 1.0, onset_time=none + math.nan, impacts=whole + 3, events=whole + 5,
        stalls=whole + 2, last=none - 4.0, status=whole + jax_lanes.RUNNING,
    )  # fmt: skip
    return M._replace(**{name: np.broadcast_to(value, x.shape) for name, value in change.items()})


def constants_like(n: int, wave: bool = False, **change: Any) -> Any:
    """Constants of n equal runs, the first of `fixed_of`; what is told of them is put in."""
    F, _ = fixed_of(wave)
    F = jax_lanes.Fixed(*(np.full(n, part[0]) for part in F))
    return F._replace(**{name: np.broadcast_to(value, (n,)) for name, value in change.items()})


@pytest.mark.parametrize("wave", [False, True])
def test_the_next_step_of_a_lane_ends_at_its_interval_its_bound_or_its_longest_step(wave: bool) -> None:
    base = base_of()
    tau, cap = np.array([0.0, 0.012, 0.012, 0.0, 0.0]), np.array([math.inf, math.inf, 0.015, math.inf, 0.05])
    limit, k = np.array([0.05, 0.05, 0.05, 0.004, 0.05]), np.array([2, 2, 2, 2, 37])
    F = constants_like(5, wave, limit=limit, dt=0.02, k_last=37, stop_last=0.01)
    M = lanes_like(np.full(5, 0.11), v=0.3, tau=tau, cap=cap, k=k, s=-1.0)
    made = jax_rounds.next_step(F, base, M, wave)
    np.testing.assert_allclose(made.h, [0.02, 0.008, 0.003, 0.004, 0.01], rtol=1e-12)
    assert made.whole.tolist() == [True, True, False, False, True]
    for lane in range(5):
        t = k[lane] * 0.02 + tau[lane]
        if wave:
            own, a = Sine(F.omega[lane], F.phase[lane], F.rate[lane] * G, 9.0), None
            x = sine_flight(Body(ROTATION, -1.0, 0.11, 0.3), PAR, own, t)
            assert column(made.a, lane)[0] == pytest.approx(own.rate / G * t * math.sin(own.omega * t + own.phase))
        else:
            a, b = 1.5 * base.values[k[lane] : k[lane] + 2]
            rate = (b - a) / 0.02
            np.testing.assert_allclose(column(made.a, lane), [(a + rate * tau[lane]) / G, rate / G], rtol=1e-12)
            x = linear_flight(Body(ROTATION, -1.0, 0.11, 0.3), PAR, a + rate * tau[lane], rate)
        with mpmath.workdps(40):
            np.testing.assert_allclose(column(made.c, lane), [float(c) for c in mpmath.taylor(x, 0, 9)], rtol=1e-10)


def parabolas(x: Any, v: Any, b: Any) -> list[np.ndarray]:
    """x + v t - b t^2, lane by lane."""
    x = np.asarray(x, dtype=float)
    return [x, x * 0.0 + v, x * 0.0 - b, *np.zeros((7, x.size))]


WANTED = (jax_rounds.NOTHING, jax_rounds.TIP, jax_rounds.PASSAGE, jax_rounds.FALL, jax_rounds.CREST, jax_rounds.LANDING)
MEETS = {  # x, v, b, rests -> over a step of 0.5, with a bound of 0.02 and a largest tilt of 0.3
    "flies": (0.10, 0.1, 0.0, False, jax_rounds.NOTHING, 0.5),
    "stands": (0.00, 0.0, 0.0, True, jax_rounds.TIP, 0.3),
    "passes": (0.10, 1.0, 0.0, False, jax_rounds.PASSAGE, 0.13),
    "falls": (1.50, 0.5, 0.0, False, jax_rounds.FALL, 2.0 * (0.5 * math.pi - 1.5)),
    "turns": (0.27, 0.4, 0.5, False, jax_rounds.CREST, 0.4),
    "turns low": (0.12, 0.2, 0.4, False, jax_rounds.NOTHING, 0.5),
    "lands": (0.10, -0.4, 0.0, False, jax_rounds.LANDING, 0.25),
    "leaves": (0.01, 1.0, 1.0, False, jax_rounds.PASSAGE, 0.5 - math.sqrt(0.03)),
}


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_what_a_lane_looks_for_and_where_are_those_of_parabolas_by_hand(side: float) -> None:
    x, v, b, rests, kinds, at = (np.array(part) for part in zip(*MEETS.values(), strict=True))
    F = constants_like(len(MEETS), bulge=0.02)
    M = lanes_like(x, v=v, rests=rests, peak=0.3)
    none = np.zeros_like(x)
    a = [none + side * 0.04, none + side * 0.5]  # exceeds the 0.19 at 0.3
    made = jax_rounds.Step(parabolas(x, v, b), a, none + 0.5, none == 0.0)
    kind, q = jax_rounds.wanted(F, M, made)
    told = dict(zip(MEETS, kind.tolist(), strict=True))
    want = dict(zip(MEETS, kinds.tolist(), strict=True))
    assert told == want
    reach, found = jax_flight.first_descent(q, made.h)
    assert found.tolist() == [code != jax_rounds.NOTHING for code in kinds]
    np.testing.assert_allclose(reach, at, rtol=1e-9)
    # Just below the bound and just above; a largest tilt that no crest can exceed, and one that it may.
    edge = constants_like(2, bulge=np.array([0.0999, 0.1001]))
    low = jax_rounds.Step(parabolas([0.1, 0.1], 0.1, 0.0), [np.zeros(2)] * 2, np.full(2, 0.5), np.full(2, True))
    assert jax_rounds.wanted(edge, lanes_like([0.1, 0.1], v=0.1), low)[0].tolist() == [0, jax_rounds.LANDING]
    crest = jax_rounds.Step(parabolas([0.12, 0.12], 0.2, 0.4), low.a, low.h, low.whole)
    M = lanes_like([0.12, 0.12], v=0.2, peak=np.array([0.1399, 0.1401]))
    assert jax_rounds.wanted(constants_like(2, bulge=0.02), M, crest)[0].tolist() == [jax_rounds.CREST, 0]


def struck_like(v: Any, wave: bool = False, a: Any = 0.0, rise: Any = 0.0, **change: Any) -> Any:
    """A landing at the speed v in the middle of an interval of 0.2 s, with a_x/g = a + rise t there."""
    v = np.atleast_1d(np.asarray(v, dtype=float))
    F = constants_like(v.size, wave, **{"dt": 0.2, "omega_rest": 1e-6, **change.pop("fixed", {})})
    M = lanes_like(0.05 + 0.0 * v, **change)
    c = parabolas(0.05 + 0.0 * v, -v, 0.0)
    reach, none = 0.05 / v, 0.0 * v
    made = jax_rounds.Step(c, [none + a - rise * reach, none + rise], reach, none == 0.0)
    return jax_rounds.strike(F, M, made, reach, none + 0.1, 50, wave)


def test_an_impact_of_a_lane_leaves_e_of_its_speed_on_the_other_corner() -> None:
    out = struck_like([0.3, 0.5], s=np.array([1.0, -1.0]))
    np.testing.assert_allclose(out.v, [0.24, 0.4], rtol=1e-12)
    assert (out.s.tolist(), out.rests.tolist(), out.more.tolist()) == ([-1.0, 1.0], [False, False], [0, 0])
    speed = 0.99e-6 / 0.8
    for a, rests in ((0.18, True), (-0.18, True), (0.2, False), (-0.2, False)):
        assert struck_like(speed, a=a, fixed={"alpha": 0.1}).rests.tolist() == [rests]
    assert struck_like(1.01e-6 / 0.8, a=0.18, fixed={"alpha": 0.1}).rests.tolist() == [False]


# hold = alpha - max(|a|, |a_stop|); the series takes 2 v / (p^2 (1 - e) hold) at most.
def test_a_chatter_of_a_lane_is_counted_where_it_is_low_steady_and_ends_in_time() -> None:
    def counts(v: float, **change: Any) -> bool:
        out = struck_like(v / 0.8, **change)
        assert bool(out.rests[0]) == (out.more[0] > 0)
        return bool(out.more[0] > 0)

    zeno, v = 2.0 / (9.0 * 0.2), 1e-6 * 0.8**-20.5
    assert counts(v) and struck_like(v / 0.8).more.tolist() == [21]
    assert not counts(v, cap=0.15)
    # What is left at the rest speed takes 2 v e/(4 p^2) at least: time goes on, or not.
    for more, want in ((1.01, True), (0.99, False)):
        last = more * STALL_TIME * 4.0 * 9.0 / (2.0 * 0.8)
        assert counts(last * 0.8**-10.5, fixed={"omega_rest": last}) is want
    assert counts(v, events=28) and not counts(v, events=29)
    low = math.sqrt(0.01 * 9.0) * (0.23 - 0.03)
    below = 1e-6 * 0.8 ** -(math.floor(math.log(low / 1e-6) / -math.log(0.8) - 0.5) + 0.5)
    long: Any = {"a": 0.03, "fixed": {"dt": 99.0}, "events": -50}
    assert counts(below, **dict(long)) and not counts(below / 0.8, **dict(long))
    for a in (0.03, -0.03):
        hold = 0.2
        above, below = (1.0 + 1e-3) * zeno * v / (0.9 * hold), (1.0 - 1e-3) * zeno * v / (0.9 * hold)
        assert counts(v, a=a, fixed={"dt": 0.1 + above}) and not counts(v, a=a, fixed={"dt": 0.1 + below})
    # The other end of the interval holds less: 0.23 - (0.01 + 0.4 0.1) = 0.18; on a sine it is not looked at.
    above, below = ((1.0 + d) * zeno * v / (0.9 * 0.18) for d in (1e-3, -1e-3))
    for s in (1.0, -1.0):
        for left, want in ((above, True), (below, False)):
            rise = s * 0.04 / left
            assert bool((abs(rise) * zeno * v < 0.2 * 0.18**2) and want) == counts(
                v, a=s * 0.01, rise=rise, fixed={"dt": 0.1 + left}
            )
    assert not counts(v, a=0.24, fixed={"onset": 9.0})


# With d = A' T/A over the time T of the series, and c = p^2 |a''| T^2/A, the number may be off by
# (2 d^2 + c + d (p T)^2 + d last/v)/ln(1/e): it is not told within so much of a whole number, and told elsewhere.
@pytest.mark.parametrize(
    ("drift", "square", "bent"), [(0.01, 0.02, 0.0), (0.002, 0.02, 0.0), (0.01, 0.002, 0.0), (0.004, 0.002, 2e-4)]
)
def test_a_chatter_of_a_lane_is_left_alone_within_what_its_number_is_unsure_by(
    drift: float, square: float, bent: float
) -> None:
    A, numbers = 9.0 * 0.23, np.arange(39.97, 40.03, 5e-5)
    total = math.sqrt(square / 9.0)
    v, n = total * A * 0.2 / 2.0, numbers.size
    F, M = constants_like(n, omega_rest=v * 0.8**numbers), lanes_like(np.zeros(n))
    rise, curve = drift * A / (9.0 * total), bent * A / (9.0 * total**2)
    told = jax_rounds.chatter(F, M, np.full(n, v), M.s, np.zeros(n), np.full(n, rise), np.full(n, curve)).tolist()
    margin = (2.0 * drift**2 + bent + drift * square + drift * 0.8**40) / -math.log(0.8)
    assert 5e-5 * told.count(0) == pytest.approx(2.0 * margin, rel=0.01, abs=1e-4)
    assert set(told) == {0, 40, 41}


def found_like(kind: Any, reach: Any, x: Any, v: Any = -0.2, **change: Any) -> Any:
    kind, n = np.asarray(kind), len(kind)
    none = np.zeros(n)
    made = jax_rounds.Step(parabolas(x, v, 0.5), [none - 0.3, none + 0.1], none + 0.5, none == 0.0)
    parts = {"step": made, "kind": kind, "reach": none + reach, "stays": none > 0.0, "cap": none + 0.77}
    return jax_rounds.Found(**{**parts, **change})


def test_a_lane_is_moved_to_what_it_met_and_stays_what_it_is_otherwise() -> None:
    x = np.array([0.60, 0.0, 0.60, 0.60, 0.60, 0.60])
    M = lanes_like(x, v=-0.2, tau=0.01, s=-1.0, rests=np.array([False, True, *[False] * 4]), peak=0.55)
    f = found_like(WANTED, 0.2, x)
    struck = jax_rounds.Struck(np.full(6, 0.123), np.full(6, 1.0), np.full(6, False), np.zeros(6, dtype=int))
    on = jax_rounds.moved(constants_like(6), M, f, struck)
    np.testing.assert_allclose(on.x, [0.54, 0.0, 0.23, 0.5 * math.pi, 0.54, 0.0], rtol=1e-14)
    np.testing.assert_allclose(on.v, [-0.4, -0.2, -0.4, -0.4, 0.0, 0.123], rtol=1e-14)
    assert on.s.tolist() == [-1.0, 1.0, -1.0, -1.0, -1.0, 1.0]  # a_x < 0 tips it onto its corner +1
    assert not on.rests.any() and on.tipped.tolist() == [False, True, *[False] * 4]
    np.testing.assert_allclose(on.tau, 0.21)
    assert on.k.tolist() == [2] * 6 and np.isinf(on.cap).all()
    np.testing.assert_allclose(on.peak, [0.55, 0.55, 0.55, 0.5 * math.pi, 0.55, 0.55])
    calm = jax_rounds.moved(constants_like(6), M, f, struck._replace(rests=np.full(6, True)))
    assert calm.rests.tolist() == [False] * 5 + [True] and calm.v[5] == 0.0 and calm.v[0] == pytest.approx(-0.4)
    whole = found_like(WANTED, 0.5, x)
    on = jax_rounds.moved(constants_like(6), M._replace(cap=np.full(6, 9.0)), whole, struck)
    assert on.k.tolist() == [3, 2, 2, 2, 2, 2]
    np.testing.assert_allclose(on.tau, [0.0, *[0.51] * 5])
    assert np.isinf(on.cap).tolist() == [True, *[False] * 5]
    stays = found_like(WANTED, 0.0, x, stays=np.full(6, True))
    on = jax_rounds.moved(constants_like(6), M, stays, struck)
    assert on.cap.tolist() == [0.77] * 6 and on.x[0] == 0.60 and on.v[0] == -0.2
    reached = jax_rounds.moved(constants_like(6), M._replace(cap=np.full(6, 0.21)), f, struck)
    assert np.isinf(reached.cap).all()
    tipped = M._replace(tipped=np.full(6, True))
    assert jax_rounds.moved(constants_like(6), tipped, found_like([0] * 6, 0.0, x), struck).tipped.all()
    assert not jax_rounds.moved(constants_like(6), tipped, found_like([0] * 6, 0.1, x), struck).tipped.any()


def test_what_a_lane_met_is_counted_once_and_at_its_time() -> None:
    M = lanes_like(np.full(6, 0.1))
    struck = jax_rounds.Struck(np.zeros(6), np.zeros(6), np.zeros(6), np.full(6, 4))
    on = jax_rounds.counted(M, M, found_like(WANTED, 0.2, M.x), struck, np.full(6, 7.5), 0.23)
    assert on.passage.tolist() == [-1.0, -1.0, 7.5, -1.0, -1.0, -1.0]
    np.testing.assert_equal(on.onset_time, [math.nan, 7.5, *[math.nan] * 4])
    assert on.impacts.tolist() == [3, 3, 3, 3, 3, 8]
    assert on.events.tolist() == [5, 6, 6, 6, 5, 10]
    assert on.stalls.tolist() == [2, 0, 2, 2, 2, 0]
    assert on.last.tolist() == [-4.0, 7.5, -4.0, 7.5, -4.0, 7.5]
    M = M._replace(last=np.full(6, 0.0), onset_time=np.full(6, 1.0))
    on = jax_rounds.counted(M, M, found_like(WANTED, 0.2, M.x), struck, np.full(6, 0.9 * STALL_TIME), 0.23)
    assert on.stalls.tolist() == [2, 3, 2, 2, 2, 3] and (on.onset_time == 1.0).all()


# Where no search found the passage and the tilt is beyond the balance all the same, it has passed it.
def test_a_balance_that_rounding_passes_is_passed() -> None:
    M = lanes_like([0.22, 0.22, 0.23, 0.22, 0.22], rests=np.array([False, False, False, True, False]))
    on, nothing = M._replace(x=np.array([0.23, 0.229, 0.24, 0.23, 0.23])), [jax_rounds.NOTHING] * 5
    f = found_like(nothing, 0.2, M.x, stays=np.array([False, False, False, False, True]))
    struck = jax_rounds.Struck(np.zeros(5), np.zeros(5), np.zeros(5), np.zeros(5, dtype=int))
    there = jax_rounds.counted(M, on, f, struck, np.full(5, 7.5), 0.23)
    assert there.passage.tolist() == [7.5, -1.0, -1.0, -1.0, -1.0] and there.events.tolist() == [6, 5, 5, 5, 5]


# MAX_STALLED events without time going on may be, as may all the events that the caller allows; one more may not.
@pytest.mark.parametrize("wave", [False, True])
def test_a_lane_ends_past_its_limits_and_not_at_them(wave: bool) -> None:
    stalls = [0, MAX_STALLED, MAX_STALLED + 1, 0, 0, 0, 0]
    events = [0, 0, 0, 40, 41, 0, 0]
    M = lanes_like(np.full(7, 0.11), v=0.3, stalls=stalls, events=events)
    F = constants_like(7, wave, limit=1.0, k_last=[9, 9, 9, 9, 9, 3, 2])
    on = jax_rounds.one_step(F, base_of(), M, 40, wave)
    assert on.k.tolist() == [3] * 7 and (on.x > 0.11).all()
    runs = jax_lanes.RUNNING
    assert on.status.tolist() == [runs, runs, STALLED, runs, TOO_MANY_EVENTS, runs, REACHED_END]


# Rounds to the end over a record and a sine: the impacts of the block that is followed by its closed forms.
@pytest.mark.parametrize("wave", [False, True])
def test_rounds_of_lanes_have_the_impacts_of_the_block_that_is_followed(wave: bool) -> None:
    F, starts = fixed_of(wave)
    starts[:, 0] = ROTATION
    starts[:, 2] = np.abs(starts[:, 2])
    base = base_of()
    M = jax_lanes.begun(F, starts)
    rounds = 0
    while (M.status == jax_lanes.RUNNING).any():
        M = jax_rounds.one_step(F, base, jax_rounds.pass_intervals(F, base, M, wave), 1000, wave)
        rounds += 1
        assert rounds < 400
    for lane, g in enumerate((G, 9.7)):
        par = (F.p2[lane], F.alpha[lane], g, F.onset[lane], F.e[lane], F.omega_rest[lane])
        one = Followed(Body(ROTATION, *starts[lane, 1:4]), par)
        one.t, t_end = starts[lane, 4], starts[lane, 5]
        edges = F.origin[lane] + F.dt[lane] * np.arange(F.count[lane] + 1)
        if wave:
            own = Sine(F.omega[lane], F.phase[lane], F.rate[lane] * g, edges[-1])
            one.over(None, sine_flight_of(par, own), min(t_end, edges[-1]))
        else:
            one.over(None, line_flight_of(par, 0.0, 0.0, 0.0), edges[0])
            for k in range(F.count[lane]):
                a, b = F.scale[lane] * g * base.values[F.first[lane] + k : F.first[lane] + k + 2]
                one.over(None, line_flight_of(par, a, (b - a) / F.dt[lane], edges[k]), min(edges[k + 1], t_end))
        one.over(None, line_flight_of(par, 0.0, 0.0, 0.0), t_end)
        assert M.impacts[lane] == len(one.impacts)
        if M.status[lane] == REACHED_END:
            np.testing.assert_allclose(
                (M.x[lane], M.v[lane], M.s[lane]), (one.body.x, one.body.v, one.body.s), rtol=1e-7
            )
            assert one.peak * (1.0 - 1e-12) <= M.peak[lane] < one.peak + 1e-4
