"""The Taylor solver against the SciPy solver, the exact one and closed forms, and what holds exactly."""

import math
from types import SimpleNamespace
from typing import Any

import numba
import numpy as np
import pytest

from excitation import PiecewiseLinear
from rocking import Block, Method1, Method2, Mode, Outcome, solve, solve_batch
from rocking.closed_forms import free_impact_time
from rocking.solvers.arrays import taylor_batch
from rocking.solvers.exact.batch import RampedSines, ScaledRecord, exact_batch
from rocking.solvers.taylor import table as row
from rocking.solvers.taylor.flight import LONGEST, glide
from rocking.solvers.taylor.turns import bound_step
from rocking.solvers.taylor.vector import LANES, load, store

FORMS = pytest.mark.parametrize("form", ["nonlinear", "linear"])


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
        self.max_step = 0.3 / max(abs(omega), 1e-3)


def shaking(seed: int, n: int, peak: float) -> np.ndarray:
    """Random samples, smoothed a little, with the given peak."""
    raw = np.convolve(np.random.default_rng(seed).standard_normal(n + 4), np.ones(5) / 5.0, "valid")
    return peak * raw / np.abs(raw).max()


def straight(t_first: float, dt: float, values: Any) -> PiecewiseLinear:
    return PiecewiseLinear(dt, np.asarray(values, float), start=t_first)


def trusted_events(system: Method1, motion: Any, t_end: float, **start: float) -> tuple[Any, int]:
    """(run by SciPy, number of its first events at which two tolerances agree within 1e-9 s and in kind)."""
    sharp, blunt = (
        solve(system, motion, t_end=t_end, solver="scipy", save_at=(), rtol=rtol, atol=1e-2 * rtol, **start)
        for rtol in (1e-13, 1e-11)
    )
    n = min(len(sharp.events), len(blunt.events))
    same = (np.abs(sharp.events.t[:n] - blunt.events.t[:n]) < 1e-9) & (sharp.events.guard[:n] == blunt.events.guard[:n])
    return sharp, int(n if same.all() else np.argmin(same))


def must_have_the_events(run: Any, sharp: Any, n: int) -> None:
    """The first n events of the SciPy run, to 1e-8 s."""
    # The last one trusted is left out: whether rest or one more impact follows may be a matter of rounding.
    m = min(n, len(run.events)) - (n < len(sharp.events))
    assert m >= n - 1
    np.testing.assert_array_equal(run.events.guard[:m], sharp.events.guard[:m])
    np.testing.assert_array_equal(run.events.mode_after[:m], sharp.events.mode_after[:m])
    np.testing.assert_array_equal(run.events.s_after[:m], sharp.events.s_after[:m])
    np.testing.assert_allclose(run.events.t[:m], sharp.events.t[:m], rtol=0.0, atol=1e-8)
    np.testing.assert_allclose(run.events.y_before[:m], sharp.events.y_before[:m], rtol=0.0, atol=1e-6)
    if n == len(sharp.events):
        assert run.outcome is sharp.outcome
        assert run.t_end == pytest.approx(sharp.t_end, abs=1e-8)
        assert run.peak_rotation == pytest.approx(sharp.peak_rotation, abs=1e-7)


def random_case(seed: int, form: Any) -> tuple[Method1, Any, float, dict[str, float]]:
    """A block from very slender to stocky with restitution 0, 1 or between, its motion, the end, the start."""
    rng = np.random.default_rng(seed)
    h = 10.0 ** rng.uniform(-1.0, 1.0)
    slenderness = 10.0 ** rng.uniform(-1.7, 0.0)
    e = float(rng.choice([0.0, 1.0, rng.uniform(0.2, 1.0), rng.uniform(0.8, 1.0)], p=[0.1, 0.1, 0.4, 0.4]))
    system = Method1(Block(slenderness * h, h), form=form, restitution=e)
    p, g_onset = system.block.p(system.g), system.g * slenderness
    start = {}
    if seed % 3 == 0:
        start = {"theta": rng.uniform(-0.9, 0.9) * system.block.alpha, "omega": rng.uniform(-0.3, 0.3) * p * 0.3}
    if seed % 2 == 0:
        rate, omega = g_onset * p * rng.uniform(0.1, 1.0), p * rng.uniform(0.5, 6.0)
        return system, Ramp(omega, rng.uniform(-3.0, 3.0), rate, 6.0 / p), 8.0 / p, start
    dt, t_first = 0.3 * 10.0 ** rng.uniform(-1.0, 0.5) / p, rng.uniform(-0.5, 0.5) / p
    values = shaking(seed, 24, g_onset * rng.uniform(0.9, 4.0))
    inside = {"t_start": t_first + 3.3 * dt} if seed % 5 == 0 else {"t_start": min(t_first, 0.0)}
    return system, straight(t_first, dt, values), t_first + rng.uniform(15.0, 30.0) * dt, start | inside


def agree(seeds: range, form: Any) -> int:
    """Compare random cases; the number of events compared."""
    total = 0
    for seed in seeds:
        system, motion, t_end, start = random_case(seed, form)
        sharp, n = trusted_events(system, motion, t_end, **start)
        run = solve(system, motion, t_end=t_end, solver="taylor", save_at=(), **start)
        try:
            must_have_the_events(run, sharp, n)
        except AssertionError as error:
            raise AssertionError(f"seed {seed}: {system}, {start}") from error
        total += n
    return total


@FORMS
def test_taylor_and_scipy_agree_on_random_blocks_and_motions(form: Any) -> None:
    assert agree(range(24), form) > 100


@pytest.mark.slow
@FORMS
def test_taylor_and_scipy_agree_on_hundreds_of_random_blocks_and_motions(form: Any) -> None:
    assert agree(range(24, 324), form) > 2000


# Nonlinear free rocking of a block of 0.2 x 0.8 m from half of alpha, g = 9.81, Housner's restitution: times found by
# integration of the same equation by other means beforehand.
def test_nonlinear_free_rocking_has_the_impacts_found_by_integration() -> None:
    block = Block(0.2, 0.8)
    run = solve(Method1(block, g=9.81), theta=0.5 * block.alpha, t_end=2.5, solver="taylor")
    known = [0.312309, 0.820592, 1.251877, 1.625867, 1.954508]
    np.testing.assert_allclose(run.impact_times[:5], known, rtol=0.0, atol=1e-6)


# Housner (1963), through rocking.closed_forms; each impact is located to an ulp or two of the time.
@pytest.mark.parametrize(
    ("b", "h", "share", "e"), [(0.2, 0.8, 0.5, 0.95), (0.5, 1.5, 0.05, 0.98), (3.0, 12.0, 0.7, 0.9)]
)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_linear_free_rocking_decays_as_housner_1963_to_rounding(
    b: float, h: float, share: float, e: float, side: float
) -> None:
    system = Method1(Block(b, h), form="linear", restitution=e)
    alpha, p = system.block.alpha, system.block.p(system.g)
    expected = [free_impact_time(share * alpha, alpha, p, e, n) for n in range(1, 41)]
    run = solve(system, theta=side * share * alpha, t_end=expected[-1] + 1e-4, solver="taylor")
    np.testing.assert_allclose(run.impact_times, expected, rtol=2e-13, atol=2e-13)


# Without loss the nonlinear block keeps its energy: omega^2/2 = p^2 (cos(alpha - x) - cos(alpha - x_0)), x = |theta|.
def test_a_nonlinear_block_without_loss_keeps_its_energy_over_hundreds_of_impacts() -> None:
    system = Method1(Block(0.2, 0.8), restitution=1.0)
    alpha, p = system.block.alpha, system.block.p(system.g)
    run = solve(system, theta=0.2, t_end=200.0, solver="taylor")
    speed = p * math.sqrt(2.0 * (math.cos(alpha - 0.2) - math.cos(alpha)))
    at_impacts = np.abs(run.events.y_before[:, 1])
    assert len(at_impacts) > 150
    # Rounding of 1e-16 each step, of 40 steps or so a swing.
    np.testing.assert_allclose(at_impacts, speed, rtol=1e-12)
    np.testing.assert_allclose(np.diff(run.impact_times), np.diff(run.impact_times)[0], rtol=1e-11)


@FORMS
@pytest.mark.parametrize("kind", ["record", "sine"])
def test_the_mirror_image_moves_as_the_mirror_image_to_the_last_bit(form: Any, kind: str) -> None:
    values = shaking(9, 300, 5.0)
    runs = []
    for side in (1.0, -1.0):
        motion: Any = straight(0.0, 0.02, side * values) if kind == "record" else Ramp(12.0, 0.2, side, 6.0)
        system = Method1(Block(0.15, 0.5), form=form)
        runs.append(solve(system, motion, theta=side * 0.02, omega=-side * 0.1, t_end=6.0, solver="taylor"))
    assert len(runs[0].impact_times) > 5
    np.testing.assert_array_equal(runs[0].events.t, runs[1].events.t)
    np.testing.assert_array_equal(runs[0].y, -runs[1].y)


@FORMS
def test_samples_agree_with_scipy_and_change_no_event(form: Any) -> None:
    system = Method1(Block(0.15, 0.5), form=form)
    motion = straight(0.1, 0.02, shaking(5, 120, 5.0))
    times = np.linspace(0.0, 1.2, 777)
    taylor = solve(system, motion, t_end=1.2, solver="taylor", save_at=times)
    scipy = solve(system, motion, t_end=1.2, solver="scipy", save_at=times, rtol=1e-12, atol=1e-14)
    bare = solve(system, motion, t_end=1.2, solver="taylor", save_at=())
    np.testing.assert_array_equal(taylor.events.t, bare.events.t)
    np.testing.assert_array_equal(taylor.t, times)
    np.testing.assert_allclose(taylor.y, scipy.y, rtol=0.0, atol=1e-8)
    np.testing.assert_array_equal(taylor.mode, scipy.mode)
    np.testing.assert_array_equal(taylor.s, scipy.s)


# Threshold g b/h = 2.45 m/s^2, crossed at a known share of an interval of each push, with a long wait between them.
@FORMS
def test_a_block_comes_to_rest_between_two_pushes_and_leaves_again_where_the_second_crosses(form: Any) -> None:
    values = np.zeros(400)
    values[2], values[300:303] = 4.0, [-2.0, -4.0, -2.0]
    system = Method1(Block(0.2, 0.8), form=form, restitution=0.7)
    run = solve(system, straight(0.0, 0.05, values), t_end=25.0, solver="taylor")
    threshold = 0.25 * system.g
    rests = run.events.t[run.events.mode_after == Mode.REST]
    assert len(rests) == 2
    expected = [0.05 * (1.0 + threshold / 4.0), 0.05 * (300.0 + (threshold - 2.0) / 2.0)]
    np.testing.assert_allclose(run.times_of("tip"), expected, rtol=0.0, atol=1e-14)
    assert run.outcome is Outcome.AT_REST
    np.testing.assert_array_equal(run.y[-1], 0.0)


@FORMS
def test_rest_after_an_impact_waits_for_the_base_to_let_the_block_stand(form: Any) -> None:
    system = Method1(Block(0.2, 0.8), form=form, restitution=0.0)
    # A steady push above the threshold towards -x: without restitution the block may not rest, so it leaves to +x.
    held = solve(system, straight(0.0, 10.0, [-3.0, -3.0]), theta=-0.01, t_end=5.0, solver="taylor")
    assert (held.side, len(held.impact_times)) == (1, 1)
    free = solve(system, theta=-0.01, t_end=5.0, solver="taylor")
    assert (free.outcome, len(free.impact_times)) == (Outcome.AT_REST, 1)


# A jump of the base where the record begins and where it ends: the limits from within decide.
@FORMS
def test_jumps_at_both_ends_of_a_record_act_at_their_very_times(form: Any) -> None:
    system = Method1(Block(0.2, 0.8), form=form)
    run = solve(system, straight(1.0, 0.25, [5.0, 5.0, 5.0]), t_end=1.5, solver="taylor")
    assert (run.events.t[0], run.side, len(run.impact_times)) == (1.0, 0, 0)
    below, above = 0.999999 * system.g * 0.25, 1.000001 * system.g * 0.25
    quiet = solve(system, straight(1.0, 0.25, [below, below, above]), t_end=9.0, solver="taylor")
    assert quiet.onset_time == pytest.approx(1.375, abs=1e-6)
    assert quiet.outcome is Outcome.AT_REST
    late = solve(system, straight(1.0, 0.25, [5.0, 5.0, 5.0]), t_start=1.1, t_end=1.4, solver="taylor")
    assert (late.events.t[0], late.t_end, late.t[-1]) == (1.1, 1.4, 1.4)


# a_x grows as rate t |sin|; it exceeds the threshold first in the cycle in which the envelope does, between the crests.
@pytest.mark.parametrize("phase", [0.0, 1.0, -2.5, math.pi])
@pytest.mark.parametrize("omega", [0.7, 20.0, -20.0])
def test_rocking_starts_when_the_growing_sine_first_exceeds_the_threshold(omega: float, phase: float) -> None:
    system = Method1(Block(0.2, 0.8))
    motion: Any = SimpleNamespace(ramped_sine=(omega, phase, 0.4, 60.0))
    run = solve(system, motion, t_end=60.0, solver="taylor", save_at=())
    t = np.linspace(0.0, 60.0, 2_000_001)
    first = t[np.argmax(np.abs(0.4 * t * np.sin(omega * t + phase)) > system.g * 0.25)]
    assert run.onset_time == pytest.approx(first, abs=4e-5)  # within a step of the grid
    at = run.onset_time
    assert abs(0.4 * at * math.sin(omega * at + phase)) == pytest.approx(system.g * 0.25, rel=1e-12)


# The rule for the end of a chatter: a batch counts the impacts of the series, a single run follows them one by one.
# Counts, rests and all else must be the same to the last bit, whatever the restitution and however the base moves.
@FORMS
@pytest.mark.parametrize("kind", ["record", "sine"])
def test_a_chatter_that_is_counted_has_the_impacts_of_one_that_is_followed(form: Any, kind: str) -> None:
    rng, runs = np.random.default_rng(7), 150
    values, systems, motions = shaking(1, 2000, 5.0), [], []
    for _ in range(runs):
        h = 10.0 ** rng.uniform(-1.0, 0.7)
        systems.append(Method1(Block(h * rng.uniform(0.05, 0.6), h), form=form, restitution=rng.uniform(0.3, 0.999)))
        if kind == "record":
            motions.append(straight(0.25, 0.005, rng.uniform(0.2, 2.0) * values))
        else:
            motions.append(Ramp(rng.uniform(5.0, 30.0), rng.uniform(-3.0, 3.0), rng.uniform(0.1, 1.5), 10.0))
    tilts = rng.choice([0.0, 1e-6, 1e-4, -0.01], runs)
    batch = solve_batch(systems, motions, theta=tilts, t_end=12.0, solver="taylor")
    rests = 0
    for i in range(runs):
        run = solve(systems[i], motions[i], theta=tilts[i], t_end=12.0, solver="taylor", save_at=())
        rests += int((run.events.mode_after == Mode.REST).sum())
        assert batch.impacts[i] == len(run.impact_times)
        for name in ("peak_rotation", "overturning_time", "onset_time", "t_end", "side", "overturned"):
            np.testing.assert_array_equal(getattr(batch, name)[i], getattr(run, name), err_msg=f"run {i}: {name}")
    assert rests > 100


# The geometric series of impacts of a block that is struck once, e v, e^2 v ...: it ends at a known time, after a known
# number of impacts; base at rest, linear.  The flight at speed v takes 2 atanh(v/(p alpha))/p.
@pytest.mark.parametrize("e", [0.3, 0.9, 0.99])
@pytest.mark.parametrize("speed", [1e-5, 1e-3, 0.1])
def test_the_series_of_impacts_ends_at_its_limit_after_the_impacts_of_the_rule(e: float, speed: float) -> None:
    system = Method1(Block(0.2, 0.8), form="linear", restitution=e)
    p, alpha = system.block.p(system.g), system.block.alpha
    count = 1 + math.floor(math.log(1e-6 / (speed * alpha)) / math.log(e))
    times = np.cumsum(2.0 * np.arctanh(speed * e ** np.arange(count)) / p)
    run = solve(system, omega=speed * p * alpha, t_end=30.0 + times[-1], solver="taylor")
    np.testing.assert_allclose(run.impact_times, times, rtol=1e-12)
    assert run.outcome is Outcome.AT_REST
    still = ScaledRecord(np.zeros(2), 1.0)
    batch = exact_batch(still, p=p, alpha=alpha, e=e, omega=speed * p * alpha, t_end=30.0 + times[-1])
    assert int(batch.impacts) == count


@FORMS
@pytest.mark.parametrize("kind", ["record", "sine"])
def test_neighbours_in_the_vector_and_threads_change_no_bit(form: Any, kind: str) -> None:
    carry = exact_batch if form == "linear" else taylor_batch
    scale = np.linspace(0.3, 3.0, 500)
    same = {"p": 5.0, "alpha": 0.29, "e": 0.9, "t_end": 10.0}
    values = shaking(3, 2000, 7.0)

    def motion(factor: Any) -> Any:
        return ScaledRecord(values, 0.005, scale=factor) if kind == "record" else RampedSines(15.0, factor, 9.0)

    together = carry(motion(scale), workers=2, **same)
    backwards = carry(motion(scale[::-1]), workers=1, **same)
    alone = carry(motion(scale[250]), workers=1, **same)
    assert 0 < together.overturned.sum() < 500
    for one, two, three in zip(together, backwards, alone, strict=True):
        np.testing.assert_array_equal(one, two[::-1])
        np.testing.assert_array_equal(one[250], three)


def test_too_many_events_end_the_run_as_failed_alone_and_in_a_batch() -> None:
    run = solve(Method1(Block(0.2, 0.8)), theta=0.1, t_end=20.0, solver="taylor", max_events=7)
    assert run.outcome is Outcome.FAILED
    assert ("max_events=7" in run.reason, len(run.events)) == (True, 8)
    still = ScaledRecord(np.zeros(2), 1.0)
    batch = taylor_batch(still, p=5.0, alpha=0.2, e=0.9, theta=[0.0, 0.1], t_end=9.0, max_events=7)
    np.testing.assert_array_equal(batch.finished, [True, False])
    np.testing.assert_array_equal(batch.impacts, [0, 8])


def test_a_run_with_more_events_than_first_made_room_for_is_whole() -> None:
    run = solve(Method1(Block(0.2, 0.8), restitution=0.998), theta=0.1, t_end=400.0, solver="taylor", save_at=())
    assert len(run.impact_times) > 1024
    assert np.all(np.diff(run.events.t) > 0.0)


def test_it_declines_in_a_sentence_what_it_cannot_carry(slender: Block, window: Any) -> None:
    with pytest.raises(ValueError, match=r"solver='taylor' declines: .*not 'method2'"):
        solve(Method2(slender, friction=0.7), t_end=1.0, solver="taylor")
    with pytest.raises(ValueError, match=r"solver='taylor' declines: Window has no closed form"):
        solve(Method1(slender), window(0.0, 1.0), t_end=1.0, solver="taylor")


def test_a_threshold_too_low_for_the_nonlinear_block_cannot_be_asked_for() -> None:
    with pytest.raises(TypeError, match="onset"):
        taylor_batch(RampedSines(12.0, 1.0, 10.0), p=5.0, alpha=0.3, e=0.9, t_end=1.0, onset=0.1)  # type: ignore[call-arg]


# From its balance at rest, under u = -t: x'' = p^2 (x + t), so x = sinh(p t)/p - t and x' = cosh(p t) - 1.
def test_a_glide_of_the_longest_step_is_that_of_the_hyperbolic_functions_to_rounding() -> None:
    p = np.linspace(0.2, 20.0, LANES)
    h = LONGEST / p

    @numba.njit
    def glided(t: Any, out: Any) -> None:
        none = load(t, 0)
        x, v, _ = glide(none, none, (none, load(t, 1)), load(t, 2), load(t, 3), none, none)
        store(out, 0, x)
        store(out, 1, v)

    out = np.empty((2, LANES))
    glided(np.array([np.zeros(LANES), -np.ones(LANES), h, p * p]), out)
    terms = [LONGEST**n / math.factorial(n) for n in range(2, 16)]
    np.testing.assert_allclose(out[0], math.fsum(terms[1::2]) / p, rtol=2e-15)
    np.testing.assert_allclose(out[1], math.fsum(terms[::2]), rtol=2e-15)


# An arc of curvature C is C h^2/8 above its chord. A block 4 km high takes steps of more than a second.
@pytest.mark.parametrize("step", [0.01, 1.7])
def test_a_flight_bulges_between_the_ends_of_a_step_by_no_more_than_is_said(step: float) -> None:
    table = np.zeros((row.ALL_ROWS, LANES))
    table[row.P2, 2], table[row.LIMIT, 2] = (LONGEST / step) ** 2, step
    bound_step(table, 2, 1e9, 0.9)
    highest = (LONGEST / step) ** 2 * (1.6 + 0.9) * step**2 / 8.0
    assert highest <= table[row.BULGE, 2] <= highest * (1.0 + 1e-5)
    bound_step(table, 2, 0.5 * step, 0.9)
    assert table[row.BULGE, 2] == pytest.approx(0.25 * highest, rel=1e-5)
