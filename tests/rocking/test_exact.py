"""The exact solver against closed forms and against the other solvers, and what holds exactly."""

import math
from typing import Any

import numpy as np
import pytest

from rocking import Block, Method1, Method2, Mode, Outcome, solve
from rocking.closed_forms import free_impact_time, half_sine_pulse, rectangular_pulse
from rocking.solvers.exact.kernel import Sine, new_plan, next_shake, sine_interval
from rocking.solvers.exact.solver import Exact
from rocking.solvers.exact.step import acceleration
from rocking.solvers.piecewise.polynomial import deflated, value
from rocking.trajectory import BALANCE


def straight_acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """Straight between the samples par[3:], zero before and after."""
    last = int(par[2]) - 1
    k = max(0, min(int(xp.floor((t - par[0]) / par[1])), last - 1))
    share = (t - (par[0] + k * par[1])) / par[1]
    inside = (t >= par[0]) & (t <= par[0] + last * par[1])
    return xp.where(inside, par[3 + k] + share * (par[4 + k] - par[3 + k]), 0.0), 0.0 * t


class Straight:
    """A base acceleration that is straight between samples."""

    kernel = staticmethod(straight_acceleration)
    max_step = math.inf

    def __init__(self, t_first: float, dt: float, values: Any) -> None:
        samples = np.asarray(values, dtype=float)
        self.piecewise_linear = (t_first, dt, samples)
        self.parameters = np.concatenate([[t_first, dt, samples.size], samples])
        self.breakpoints = tuple(t_first + dt * k for k in range(samples.size))


def ramp_acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """par[2] t sin(par[0] t + par[1]) from 0 to par[3]."""
    inside = (t >= 0.0) & (t <= par[3])
    return xp.where(inside, par[2] * t * xp.sin(par[0] * t + par[1]), 0.0), 0.0 * t


class Ramp:
    """A sine whose amplitude grows linearly."""

    kernel = staticmethod(ramp_acceleration)

    def __init__(self, omega: float, phase: float, rate: float, duration: float) -> None:
        self.ramped_sine = (omega, phase, rate, duration)
        self.parameters = np.array(self.ramped_sine)
        self.breakpoints = (0.0, duration)
        self.max_step = 0.3 / omega


def linear(b: float, h: float, **options: Any) -> Method1:
    return Method1(Block(b=b, h=h), form="linear", **options)


def frequency(system: Method1) -> float:
    return system.block.p(system.g)


def shaking(seed: int, n: int, peak: float) -> np.ndarray:
    """Random samples, smoothed a little, with the given peak."""
    raw = np.convolve(np.random.default_rng(seed).standard_normal(n + 4), np.ones(5) / 5.0, "valid")
    return peak * raw / np.abs(raw).max()


record_and_sine = pytest.mark.parametrize(
    "motion", [Straight(0.0, 0.02, shaking(9, 300, 5.0)), Ramp(12.0, 0.2, 1.0, 6.0)], ids=["record", "sine"]
)


# Housner (1963), through rocking.closed_forms.  Forty impacts, each located to an ulp or two of the time: 1e-13.
@pytest.mark.parametrize(
    ("b", "h", "share", "e"),
    [(0.2, 0.8, 0.5, 0.95), (0.15, 0.5, 0.9, 0.9), (0.5, 1.5, 0.05, 0.98), (3.0, 12.0, 0.7, 0.9)],
)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_free_rocking_decays_as_housner_1963_to_rounding(
    b: float, h: float, share: float, e: float, side: float
) -> None:
    system = linear(b, h, restitution=e)
    alpha, p = system.block.alpha, frequency(system)
    expected = [free_impact_time(share * alpha, alpha, p, e, n) for n in range(1, 41)]
    run = solve(system, theta=side * share * alpha, t_end=expected[-1] + 1e-4, solver="exact")
    np.testing.assert_allclose(run.impact_times, expected, rtol=1e-13, atol=1e-13)


# The linear block released from upright: x = alpha (1 - cosh p t) + (omega/p) sinh p t.
def test_passage_of_balance_and_fall_have_the_times_of_the_closed_form() -> None:
    system = linear(0.2, 0.8)
    alpha, p = system.block.alpha, frequency(system)
    omega = 1.1 * p * alpha
    run = solve(system, omega=-omega, t_end=5.0, solver="exact")
    assert run.outcome is Outcome.OVERTURNED
    assert run.side == -1
    assert run.overturning_time == pytest.approx(math.atanh(p * alpha / omega) / p, abs=1e-14)
    tau = p * run.t_end
    assert alpha * (1.0 - math.cosh(tau)) + omega / p * math.sinh(tau) == pytest.approx(0.5 * math.pi, abs=1e-13)
    np.testing.assert_array_equal(run.events.guard, [BALANCE, 0])


# Housner's rectangular pulse, which is straight: exp(p t) = A / (A - 1).  At the limit itself the block takes for ever,
# a part 1e-9 beyond it has left after ln(1e9)/p: no rounding of 1e-16 comes near that.
@pytest.mark.parametrize("duration", [0.05, 0.3, 1.0])
@pytest.mark.parametrize("beyond", [1e-9, -1e-9])
def test_rectangular_pulse_overturns_from_housners_amplitude_on(duration: float, beyond: float) -> None:
    system = linear(0.2, 0.8, onset="linear")
    level = rectangular_pulse(duration, frequency(system)) * system.g * system.block.alpha * (1.0 + beyond)
    run = solve(system, Straight(0.5, duration, [level, level]), t_end=20.0, solver="exact")
    assert run.onset_time == 0.5
    assert run.overturned == (beyond > 0.0)
    assert run.side == (-1 if beyond > 0.0 else 0)


# A half sine of 4,000 chords: each misses (omega dt)^2/12 = 5e-8 of the amplitude on average, and 2e-7 is beyond that.
@pytest.mark.parametrize("ratio", [1.0, 4.0])
@pytest.mark.parametrize("beyond", [2e-7, -2e-7])
def test_half_sine_pulse_of_many_chords_overturns_from_the_corrected_amplitude_on(ratio: float, beyond: float) -> None:
    system = linear(0.2, 0.8, onset="linear")
    duration = math.pi / (ratio * frequency(system))
    level = half_sine_pulse(ratio) * system.g * system.block.alpha * (1.0 + beyond)
    pulse = Straight(0.0, duration / 4000, level * np.sin(np.linspace(0.0, math.pi, 4001)))
    assert solve(system, pulse, t_end=20.0, solver="exact").overturned == (beyond > 0.0)


def compare_first_events(system: Method1, motion: Any, t_end: float, count: int, **start: float) -> int:
    """The first events by both solvers; the number compared.

    DOP853 at rtol 1e-12 keeps a trajectory within some 1e-11 until impacts have multiplied that: 1e-9 s over the first
    few.  The last event is left out: the next one may be a matter of rounding (rest or one more impact).
    """
    exact = solve(system, motion, t_end=t_end, solver="exact", save_at=(), **start)
    scipy = solve(system, motion, t_end=t_end, solver="scipy", save_at=(), rtol=1e-12, atol=1e-14, **start)
    n = min(count, max(len(exact.events), len(scipy.events)))
    np.testing.assert_array_equal(exact.events.guard[:n], scipy.events.guard[:n])
    np.testing.assert_array_equal(exact.events.mode_after[:n], scipy.events.mode_after[:n])
    np.testing.assert_array_equal(exact.events.s_after[:n], scipy.events.s_after[:n])
    np.testing.assert_allclose(exact.events.t[:n], scipy.events.t[:n], rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(exact.events.y_before[:n], scipy.events.y_before[:n], rtol=0.0, atol=1e-8)
    return n


@pytest.mark.parametrize("seed", range(40))
def test_exact_and_scipy_agree_on_random_blocks_over_random_records(seed: int) -> None:
    rng = np.random.default_rng(seed)
    h = 10.0 ** rng.uniform(-1.0, 1.0)
    system = linear(h * rng.uniform(0.1, 0.5), h, restitution=rng.uniform(0.3, 1.0))
    dt = 10.0 ** rng.uniform(-1.5, 0.3)
    values = shaking(seed, 24, system.g * system.block.b / h * rng.uniform(1.1, 4.0))
    t_first = rng.uniform(0.0, 1.0)
    released = {"theta": rng.uniform(-0.7, 0.7) * system.block.alpha} if seed % 3 == 0 else {}
    assert compare_first_events(system, Straight(t_first, dt, values), t_first + 26.0 * dt, 8, **released) > 0


@pytest.mark.parametrize("seed", range(20))
def test_exact_and_scipy_agree_on_random_blocks_over_ramped_sines(seed: int) -> None:
    rng = np.random.default_rng(1000 + seed)
    h = 10.0 ** rng.uniform(-0.7, 0.7)
    system = linear(h * rng.uniform(0.1, 0.5), h)
    rate = system.g * system.block.b / h * rng.uniform(0.5, 2.0)
    motion = Ramp(2.0 * math.pi * rng.uniform(0.3, 6.0), rng.uniform(-math.pi, math.pi), rate, 4.0)
    assert compare_first_events(system, motion, 5.0, 10) > 0


def test_samples_agree_with_scipy_and_change_no_event() -> None:
    system = linear(0.15, 0.5)
    motion = Straight(0.1, 0.02, shaking(5, 120, 5.0))
    times = np.linspace(0.0, 3.0, 1234)
    exact = solve(system, motion, t_end=3.0, solver="exact", save_at=times)
    scipy = solve(system, motion, t_end=3.0, solver="scipy", save_at=times, rtol=1e-12, atol=1e-14)
    bare = solve(system, motion, t_end=3.0, solver="exact", save_at=())
    assert len(bare.impact_times) > 5
    np.testing.assert_array_equal(exact.events.t, bare.events.t)
    np.testing.assert_array_equal(exact.t, times[: len(exact.t)])
    n = min(len(exact.t), len(scipy.t))
    assert abs(len(exact.t) - len(scipy.t)) <= 1
    # omega jumps at an impact; between the two solvers' times of it (1e-9 s apart) lies no sample.
    np.testing.assert_allclose(exact.y[:n], scipy.y[:n], rtol=0.0, atol=1e-8)
    np.testing.assert_array_equal(exact.mode[:n], scipy.mode[:n])


@record_and_sine
def test_the_mirror_image_moves_as_the_mirror_image_to_the_last_bit(motion: Any) -> None:
    if isinstance(motion, Straight):
        mirrored: Any = Straight(0.0, 0.02, -motion.piecewise_linear[2])
    else:
        mirrored = Ramp(*motion.ramped_sine[:2], -motion.ramped_sine[2], motion.ramped_sine[3])
    runs = [
        solve(linear(0.15, 0.5), base, theta=side * 0.02, omega=-side * 0.1, t_end=6.0, solver="exact")
        for base, side in ((motion, 1.0), (mirrored, -1.0))
    ]
    assert len(runs[0].impact_times) > 5
    np.testing.assert_array_equal(runs[0].events.t, runs[1].events.t)
    np.testing.assert_array_equal(runs[0].y, -runs[1].y)


def test_a_record_with_its_own_midpoints_between_the_samples_is_the_same_motion() -> None:
    values = shaking(5, 200, 5.0)
    refined = np.interp(np.arange(0.0, 199.001, 1.0 / 64.0), np.arange(200), values)
    system = linear(0.15, 0.5)
    one, other = (
        solve(system, Straight(0.0, dt, v), t_end=15.0, solver="exact")
        for dt, v in ((0.02, values), (0.02 / 64.0, refined))
    )
    assert len(one.impact_times) > 20
    # Rounding of 1e-16, multiplied by the impacts on the way (some 1e4 for the first twenty).
    np.testing.assert_allclose(one.events.t[:20], other.events.t[:20], rtol=0.0, atol=1e-11)


@record_and_sine
def test_a_run_in_two_parts_is_the_run_in_one(motion: Any) -> None:
    system = linear(0.15, 0.5)
    whole = solve(system, motion, t_end=6.0, solver="exact")
    t_cut = float(whole.impact_times[3]) + 0.0123
    first = solve(system, motion, t_end=t_cut, solver="exact")
    theta, omega = first.y[-1]
    second = solve(system, motion, t_start=t_cut, t_end=6.0, theta=theta, omega=omega, solver="exact")
    times = np.concatenate([first.events.t, second.events.t])
    n = min(len(first.events) + 5, len(whole.events))
    assert n > 6
    # Rounding of the state at the cut, multiplied by the few impacts that follow.
    np.testing.assert_allclose(times[:n], whole.events.t[:n], rtol=0.0, atol=1e-12)


def test_a_later_record_gives_the_same_motion_later() -> None:
    system = linear(0.15, 0.5)
    values = shaking(11, 200, 5.0)
    early = solve(system, Straight(0.0, 0.015625, values), t_end=6.0, solver="exact")
    late = solve(system, Straight(64.0, 0.015625, values), t_start=64.0, t_end=70.0, solver="exact")
    assert len(early.impact_times) > 10
    # Sample times are whole numbers of 1/64 s, hence exact; what is left is an ulp of 64 s.
    np.testing.assert_allclose(late.events.t - 64.0, early.events.t, rtol=0.0, atol=3e-14)


# Froude: lengths times 4 and times times 2 leave accelerations as they are.
def test_a_block_of_four_times_the_size_moves_alike_in_twice_the_time() -> None:
    values = shaking(13, 100, 5.0)
    small = solve(linear(0.15, 0.5), Straight(0.0, 0.05, values), t_end=6.0, solver="exact")
    large = solve(linear(0.6, 2.0), Straight(0.0, 0.1, values), t_end=12.0, solver="exact")
    n = min(20, len(small.events))
    assert n > 5
    np.testing.assert_allclose(large.events.t[:n], 2.0 * small.events.t[:n], rtol=0.0, atol=1e-11)


# Threshold g b/h = 0.25 g = 2.4517 m/s^2, crossed at a known share of an interval of each push.
def test_a_block_comes_to_rest_between_two_pushes_and_leaves_again_where_the_second_crosses_the_threshold() -> None:
    values = np.zeros(400)
    values[2], values[300:303] = 4.0, [-2.0, -4.0, -2.0]
    system = linear(0.2, 0.8, restitution=0.7)
    run = solve(system, Straight(0.0, 0.05, values), t_end=20.0, solver="exact")
    threshold = 0.25 * system.g
    tips = run.times_of("tip")
    rests = run.events.t[run.events.mode_after == Mode.REST]
    assert len(rests) == 2
    assert rests[0] < tips[1]
    expected = [0.05 * (1.0 + threshold / 4.0), 0.05 * (300.0 + (threshold - 2.0) / 2.0)]
    np.testing.assert_allclose(tips, expected, rtol=0.0, atol=1e-14)
    np.testing.assert_array_equal(run.events.s_after[run.events.guard == 2], [-1.0, 1.0])
    assert run.outcome is Outcome.AT_REST
    np.testing.assert_array_equal(run.y[-1], 0.0)


def test_rest_after_an_impact_waits_for_the_base_to_let_the_block_stand() -> None:
    # Steady push above the threshold towards -x: without restitution the block may not rest, so it leaves to +x.
    held = Straight(0.0, 10.0, [-3.0, -3.0])
    run = solve(linear(0.2, 0.8, restitution=0.0), held, theta=-0.01, t_end=5.0, solver="exact")
    assert run.side == 1
    assert len(run.impact_times) == 1
    free = solve(linear(0.2, 0.8, restitution=0.0), theta=-0.01, t_end=5.0, solver="exact")
    assert len(free.impact_times) == 1
    assert free.outcome is Outcome.AT_REST


# A jump of the base where the record begins and where it ends: the limits from within decide.
def test_jumps_at_both_ends_of_a_record_act_at_their_very_times() -> None:
    system = linear(0.2, 0.8)
    run = solve(system, Straight(1.0, 0.25, [5.0, 5.0, 5.0]), t_end=1.5, solver="exact")
    assert run.events.t[0] == 1.0
    below = 0.999999 * system.g * 0.25
    quiet = solve(system, Straight(1.0, 0.25, [below, below, 1.000001 * system.g * 0.25]), t_end=9.0, solver="exact")
    assert quiet.onset_time == pytest.approx(1.375, abs=1e-6)
    assert quiet.outcome is Outcome.AT_REST
    late = solve(system, Straight(1.0, 0.25, [5.0, 5.0, 5.0]), t_start=1.1, t_end=1.4, solver="exact")
    assert late.events.t[0] == 1.1
    assert late.t_end == 1.4
    assert late.t[-1] == 1.4


@pytest.mark.parametrize("b", [0.02, 0.2, 2.0])
def test_an_impact_within_a_long_interval_is_found_however_short_the_dip(b: float) -> None:
    # The base turns the block round just below zero.  Against samples so many that each interval is shorter than a dip.
    system = linear(b, 4.0 * b)
    p, alpha, g = frequency(system), system.block.alpha, system.g
    values = np.array([0.0, -3.0]) * alpha * g
    dt = 2.0 / p
    fine = np.interp(np.linspace(0.0, 1.0, 4097), [0.0, 1.0], values)
    counts = []
    for omega in np.linspace(0.02, 0.6, 60) * p * alpha:
        run, reference = (
            solve(system, Straight(0.0, step, v), omega=omega, t_end=dt, solver="exact", save_at=())
            for step, v in ((dt, values), (dt / 4096, fine))
        )
        n = min(5, len(reference.events))
        np.testing.assert_allclose(run.events.t[:n], reference.events.t[:n], rtol=0.0, atol=1e-10 / p)
        counts.append(len(run.impact_times))
    assert min(counts) == 0 < max(counts)


def test_a_block_without_loss_keeps_its_swing_over_a_hundred_impacts() -> None:
    system = linear(0.2, 0.8, restitution=1.0)
    run = solve(system, theta=0.2, t_end=120.0, solver="exact", save_at=())
    quarter = math.acosh(1.0 / (1.0 - 0.2 / system.block.alpha)) / frequency(system)
    expected = quarter * (1.0 + 2.0 * np.arange(len(run.impact_times)))
    assert len(expected) > 100
    # The rounding of each swing, some 1e-15, acts on the period of all later ones: n^2/2 of them, times a few.
    np.testing.assert_allclose(run.impact_times, expected, rtol=0.0, atol=5e-11)


def test_a_run_with_more_events_than_first_made_room_for_is_whole() -> None:
    system = linear(0.2, 0.8, restitution=0.998)
    run = solve(system, theta=0.1, t_end=400.0, solver="exact", save_at=())
    expected = math.ceil(math.log(1e-6 / math.sqrt(2 * 0.1 * system.block.alpha - 0.01)) / math.log(0.998))
    assert len(run.impact_times) == expected > 1024
    assert np.all(np.diff(run.events.t) > 0.0)


def test_too_many_events_end_the_run_as_failed() -> None:
    run = solve(linear(0.2, 0.8), theta=0.1, t_end=20.0, solver="exact", max_events=7)
    assert run.outcome is Outcome.FAILED
    assert ("max_events=7" in run.reason, len(run.events)) == (True, 8)


def test_a_record_that_is_read_only_is_carried() -> None:
    values = shaking(3, 100, 5.0)
    values.flags.writeable = False
    motion: Any = Straight(0.0, 0.02, values)
    assert solve(linear(0.15, 0.5), motion, t_end=2.0, solver="exact").onset_time > 0.0


def test_it_declines_in_a_sentence_what_it_has_no_closed_form_for(slender: Block, window: Any) -> None:
    with pytest.raises(ValueError, match=r"solver='exact' declines: .*nonlinear form has no closed form"):
        solve(Method1(slender), t_end=1.0, solver="exact")
    with pytest.raises(ValueError, match=r"solver='exact' declines: .*not 'method2'"):
        solve(Method2(slender, friction=0.7), t_end=1.0, solver="exact")
    with pytest.raises(ValueError, match=r"solver='exact' declines: Window has no closed form"):
        solve(linear(0.2, 0.8), window(0.0, 1.0), t_end=1.0, solver="exact")


def test_it_refuses_motions_that_are_not_finite() -> None:
    with pytest.raises(ValueError, match="want finite values"):
        Exact().declines(linear(0.2, 0.8), Straight(0.0, 0.1, [0.0, math.nan]))
    with pytest.raises(ValueError, match="want finite and dt positive"):
        Exact().declines(linear(0.2, 0.8), Straight(0.0, 0.0, [0.0, 1.0]))
    with pytest.raises(ValueError, match="want finite numbers and a positive duration"):
        Exact().declines(linear(0.2, 0.8), Ramp(math.inf, 0.0, 1.0, 1.0))


# How far a tilt may be from straight between two samples: half the step squared times what pushes towards the floor,
# (a_max / g - alpha) p^2, with cosh for the growth. A step is an interval, or a twelfth of 1/p where it is longer.
@pytest.mark.parametrize(("p", "dt", "step"), [(0.5, 0.01, 1.0 / 6.0), (4.0, 0.01, 1.0 / 48.0), (0.5, 0.3, 0.3)])
def test_between_tilts_called_clear_there_is_no_impact(p: float, dt: float, step: float) -> None:
    plan = new_plan((p * p, 0.2, 9.81, 0.2, 0.9, 1e-6), dt, 9.81, 10)
    sagged = 0.8 * (math.cosh(0.5 * p * step) - 1.0)
    assert plan.clear == pytest.approx(sagged, rel=1e-5)
    assert plan.clear >= sagged
    assert plan.longest == pytest.approx(1.0 / (12.0 * p))


# Two pushes with a long rest between: what is saved while the block stands must not take the place of what follows.
def test_a_block_that_rests_between_two_pushes_is_saved_as_scipy_saves_it() -> None:
    values = np.zeros(400)
    values[10:20], values[300:312] = 4.0, -4.0
    system, times = linear(0.2, 0.8, restitution=0.3), np.arange(0.0, 4.6, 0.01)
    run, other = (
        solve(system, Straight(0.0, 0.0125, values), t_end=4.6, save_at=times, solver=solver)
        for solver in ("exact", "scipy")
    )
    assert run.theta[280] == 0.0 and np.abs(run.theta[320:]).max() > 0.02
    np.testing.assert_allclose(run.theta, other.theta, rtol=0.0, atol=1e-7)


# Where the crest of a sine just passes the threshold, the samples on either side of it may both be below.
def test_no_interval_in_which_a_sine_first_passes_the_threshold_is_taken_for_quiet() -> None:
    p, a_rest = 4.0, 0.2 * 9.81
    hidden = 0
    for phase in np.linspace(-math.pi, math.pi, 200):
        sine = Sine(20.0, phase, 0.2, 40.0)
        dt, n = sine_interval(sine, p)
        t = np.arange(9.5, 10.5, 1e-5)
        first = int(t[np.argmax(np.abs(0.2 * t * np.sin(20.0 * t + phase)) > a_rest)] / dt)
        found = next_shake(new_plan((p * p, 0.2, 9.81, 0.2, 0.9, 1e-6), dt, 8.0, 10), sine, dt, 0, n)
        assert found <= first
        ends = dt * np.array([first, first + 1])
        hidden += bool(np.all(np.abs(0.2 * ends * np.sin(20.0 * ends + phase)) < a_rest))
    assert hidden > 5


def test_the_base_of_a_growing_sine_is_rate_times_t_times_the_sine() -> None:
    found = [acceleration(1.5, tau, (0.0, 0.0), Sine(7.0, 0.3, 0.8, 9.0)) for tau in (0.0, 0.25, 1.0)]
    t = np.array([1.5, 1.75, 2.5])
    np.testing.assert_allclose(found, 0.8 * t * np.sin(7.0 * t + 0.3), rtol=1e-14)


@pytest.mark.parametrize("roots", [0, 1, 2, 3])
def test_a_polynomial_without_its_roots_at_zero_times_these_is_the_polynomial(roots: int) -> None:
    c = tuple(0.0 if n < roots else (-1.0) ** n * (n + 1.0) for n in range(10))
    for t in (0.3, 0.7, 1.1):
        assert t**roots * value(deflated(c), t) == pytest.approx(value(c, t), rel=1e-13)
