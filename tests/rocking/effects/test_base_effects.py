"""Effects on the base: tilt, gain, lag, pitch and vertical motion against formulas, and the plumbing below them."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from excitation import PiecewiseLinear, RampedSinusoid, SampledMotion
from rocking import Block, Method1, Outcome, scalars, solve, solve_batch
from rocking.altered import AlteredMotion, moving_part, table, table_value
from rocking.effects import base_with, compose, load, parse
from rocking.effects.table_pitch import filtered
from rocking.effects.vertical_motion import second_harmonics
from rocking.motion import Still, base_at

G = 9.80665
BLOCK = Block(b=0.2, h=0.8)


def altered(motion: Any, *texts: str, span: tuple[float, float] = (0.0, 10.0)) -> Any:
    return base_with(motion, parse(texts), span, G)


def at(motion: Any, t: Any) -> Any:
    """Base at t; every entry an array of the shape of t."""
    return [np.asarray(v) + np.zeros_like(t) for v in base_at(np, motion, t, np.asarray(motion.parameters))]


T = np.linspace(1.0, 9.0, 4001)


# The floor's axes are (cos, -sin) and (sin, cos) in (x, up) when it falls toward +x: by geometry.
def test_a_tilted_floor_feels_base_acceleration_and_gravity_in_its_own_axes(shaken: Any) -> None:
    beta = 0.07
    a_x, a_z = at(shaken(), T)[:2]
    felt = np.stack([a_x, a_z + G])
    along, normal = np.array([math.cos(beta), -math.sin(beta)]), np.array([math.sin(beta), math.cos(beta)])
    got_x, got_z, pitch, acceleration = at(altered(shaken(), f"base_tilt.angle={beta}"), T)
    np.testing.assert_allclose(got_x, along @ felt, atol=1e-13)
    np.testing.assert_allclose(got_z, normal @ felt - G, atol=1e-13)
    assert not pitch.any()
    assert not acceleration.any()


# Two balances, alpha -+ beta, and two onsets, each where the resultant passes the corner: a = g tan(alpha +- beta).
@pytest.mark.parametrize("beta", [0.03, -0.1])
@pytest.mark.parametrize("s", [1.0, -1.0])
def test_a_tilted_floor_has_two_balances_and_two_onsets(run_with: Any, constant: Any, beta: float, s: float) -> None:
    tilt = f"base_tilt.angle={beta}"
    balance = BLOCK.alpha - s * beta
    assert run_with(tilt, theta=s * (balance - 1e-4), t_end=5.0).overturning_time != 0.0
    over = run_with(tilt, theta=s * (balance + 1e-4), t_end=5.0)
    assert (over.outcome, over.side) == (Outcome.OVERTURNED, s)
    assert abs(over.theta[1]) > balance + 1e-4
    onset = G * math.tan(balance)
    assert len(run_with(tilt, motion=constant(-s * onset * (1 - 1e-9)), t_end=0.1).events) == 0
    tips = run_with(tilt, motion=constant(-s * onset * (1 + 1e-6)), t_end=0.1)
    assert tips.onset_time == 0.0
    assert s * tips.theta[-1] > 0.0


@pytest.mark.parametrize("solver", ["scipy", "numba", pytest.param("diffrax", marks=pytest.mark.slow)])
@pytest.mark.parametrize(("beta", "theta"), [(0.3, 0.0), (-0.3, 0.0), (0.3, -0.1), (1.2, 0.0), (1.2, -0.1)])
def test_on_a_floor_steeper_than_balance_the_block_falls_downhill_at_once(
    run_with: Any, solver: str, beta: float, theta: float
) -> None:
    run = run_with(f"base_tilt.angle={beta}", theta=theta, t_end=5.0, solver=solver)
    assert (run.outcome, run.side) == (Outcome.OVERTURNED, math.copysign(1.0, beta))
    if theta == 0.0:
        assert run.onset_time == 0.0
        assert run.events.t[0] == 0.0


def test_at_the_very_tilt_of_balance_it_stands_and_beyond_it_falls(run_with: Any) -> None:
    for angle, falls in ((BLOCK.alpha * (1 - 1e-12), False), (BLOCK.alpha * (1 + 1e-6), True)):
        assert run_with(f"base_tilt.angle={angle!r}", t_end=20.0).overturned is falls


# A tilted floor is the block of other gravity under a push: theta'' = -p^2 [s sin(alpha - s theta + s beta)].
def test_a_swing_on_a_tilted_floor_is_that_of_gravity_turned(run_with: Any) -> None:
    beta, p2 = 0.05, 0.75 * G / BLOCK.R
    lands = solve_ivp(
        lambda t, y: (y[1], -p2 * math.sin(BLOCK.alpha - y[0] - beta)), (0.0, 3.0), (0.12, 0.0),
        events=lambda t, y: y[0], rtol=1e-12, atol=1e-14,
    )  # fmt: skip
    run = run_with(f"base_tilt.angle={beta}", theta=0.12, t_end=1.0)
    assert run.impact_times[0] == pytest.approx(lands.t_events[0][0], abs=1e-10)


def test_gain_and_lag_alter_the_record_as_they_say(shaken: Any) -> None:
    plain, louder = at(shaken(), T), at(altered(shaken(), "base_motion_gain.gain=1.3"), T)
    np.testing.assert_allclose(louder[0], 1.3 * plain[0], rtol=1e-15)
    np.testing.assert_array_equal(louder[1], plain[1])
    early = at(altered(shaken(), "base_motion_lag.lag=0.05"), T)
    later = at(shaken(), T + 0.05)
    for got, want in zip(early, later, strict=True):
        np.testing.assert_array_equal(got, want)


# A record that is late by 0.05 s shows at 0.75 s the jump that happened at 0.7 s.
@pytest.mark.parametrize("lag", [0.05, -0.2])
@pytest.mark.parametrize("solver", ["scipy", "numba"])
def test_a_lag_carries_the_breakpoints_along(run_with: Any, window: Any, solver: str, lag: float) -> None:
    motion = window(0.7, 1.0, x=(6.0, 0.0, 0.0, 0.0))
    assert altered(motion, f"base_motion_lag.lag={lag}").breakpoints == (0.7 - lag, 1.0 - lag)
    run = run_with(f"base_motion_lag.lag={lag}", motion=motion, t_end=1.2, solver=solver)
    assert run.onset_time == pytest.approx(0.7 - lag, abs=1e-14)


def pitching(t: float | Any) -> tuple[Any, Any]:
    return 0.01 * np.sin(7.0 * t), -0.49 * np.sin(7.0 * t)


class Pitching:
    """A base at rest that pitches."""

    kernel = staticmethod(Still.kernel)
    pitch_kernel = staticmethod(lambda xp, t, par: (0.01 * xp.sin(7.0 * t), -0.49 * xp.sin(7.0 * t)))
    parameters = np.zeros(0)
    breakpoints: tuple[float, ...] = ()
    max_step = 0.05


def test_what_the_motion_says_of_its_pitch_is_kept_and_lags_with_it() -> None:
    for texts, late in (
        (("base_motion_gain.gain=2",), 0.0),
        (("base_tilt.angle=0.1",), 0.0),
        (("base_motion_lag.lag=0.3",), 0.3),
    ):
        got = at(altered(Pitching(), *texts), T)[2:]
        for one, other in zip(got, pitching(T + late), strict=True):
            np.testing.assert_allclose(one, other, atol=1e-15)
    # That of the effect is added to it.
    both = at(altered(Pitching(), "table_pitch.per_acceleration=0.01"), T)[2:]
    for one, other in zip(both, pitching(T), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)


def sinusoid(frequency: float, amplitude: float) -> RampedSinusoid:
    """Ten seconds of growing sine; whole periods."""
    return RampedSinusoid(frequency, 10.0, amplitude)


# pitch = c a_x + k d_x with a_x = (A/T) t sin(w t), d_x its double integral from rest, both differentiated by hand.
@pytest.mark.parametrize("frequency", [1.0, 3.0, 5.0, 7.0])
@pytest.mark.parametrize(("c", "k"), [(1e-3, 0.0), (0.0, 0.1), (1e-3, -0.05)])
def test_the_pitch_of_a_sinusoid_is_that_of_its_formulas(frequency: float, c: float, k: float) -> None:
    w, rate = 2.0 * math.pi * frequency, 0.4
    motion = sinusoid(frequency, 4.0)
    texts = (f"table_pitch.per_acceleration={c}", f"table_pitch.per_displacement={k}")
    _, _, pitch, acceleration = at(altered(motion, *texts), T)
    sin, cos = np.sin(w * T), np.cos(w * T)
    a_x, a_second = rate * T * sin, rate * (2.0 * w * cos - w**2 * T * sin)
    d_x = -rate * (T * sin / w**2 + 2.0 * cos / w**3) + 2.0 * rate / w**3
    # The low-pass lets (f/25 Hz)^8 of it go; displacement has no mean: what is left of one is slow.
    lost = (frequency / 25.0) ** 8
    expected = c * a_second + k * a_x
    assert np.max(np.abs(acceleration - expected)) < (1.5 * lost + 1e-4) * np.max(np.abs(expected))
    angle = c * a_x + k * d_x
    slow = 0.0 if k == 0.0 else 0.1
    assert np.max(np.abs(pitch - angle)) < (1.5 * lost + 1e-4 + slow) * np.max(np.abs(angle))
    swings = pitch - np.convolve(pitch, np.ones(round(1000 / frequency) // 2), "same") / (round(1000 / frequency) // 2)
    wanted = angle - np.convolve(angle, np.ones(round(1000 / frequency) // 2), "same") / (round(1000 / frequency) // 2)
    inner = slice(600, -600)
    assert np.max(np.abs(swings - wanted)[inner]) < 5e-3 * np.max(np.abs(wanted[inner]))


# What the base did at a time is no matter of when the run ends, be it before the motion does or after.
@pytest.mark.parametrize("text", ["table_pitch.per_displacement=0.1", "vertical_motion.second_harmonic_ratio=0.3"])
def test_a_run_does_not_depend_on_when_it_ends(run_with: Any, text: str) -> None:
    motion = sinusoid(2.7, 5.0)
    runs = [run_with(text, motion=motion, theta=0.05, t_end=end) for end in (2.0, 2.13, 10.0, 14.0)]
    for run in runs[1:]:
        np.testing.assert_allclose(run.impact_times[:3], runs[0].impact_times[:3], rtol=0.0, atol=1e-10)


def test_a_rest_before_and_after_a_motion_changes_nothing_within_it() -> None:
    samples = np.sin(np.linspace(0.0, 40.0, 1201)) * np.linspace(0.1, 1.0, 1201) + 0.05
    padded = np.concatenate([np.zeros(300), samples, np.zeros(500)])
    for part, whole in zip(filtered(samples, 0.01), filtered(padded, 0.01), strict=True):
        np.testing.assert_array_equal(whole[300:-500], part)
        assert not whole[:300].any()
        assert not whole[-500:].any()
    for part, whole in zip(second_harmonics(samples), second_harmonics(padded), strict=True):
        np.testing.assert_array_equal(whole[300:-500], part)


# Of three samples that are not zero the rest is left out, of two not: splines want three.
def test_a_motion_of_three_samples_is_one_and_of_two_is_none() -> None:
    a = np.zeros(9)
    assert moving_part(a) == slice(0, 9)
    a[3:5] = 1.0, -2.0
    assert moving_part(a) == slice(0, 9)
    a[5] = 1e-3
    assert moving_part(a) == slice(3, 6)
    a[4] = 0.0
    assert moving_part(a) == slice(3, 6)


SHAPED = [
    "vertical_motion.second_harmonic_ratio=0.5", "table_pitch.per_acceleration=1e-3",
    "table_pitch.per_displacement=0.1", "learned_base.frequency=12", "learned_coupling.corner_frequency=0.3",
]  # fmt: skip
"""Effects that are made of the samples of a whole record."""


def rough(kind: Any, start: float) -> Any:
    """Noise of up to some 20 Hz at 100 samples a second, that begins and ends at once."""
    noise = np.convolve(np.random.default_rng(1).normal(size=400), np.hanning(7) / 3.5, "same")
    return kind(0.01, noise, start=start)


# Where time begins is nothing that a block knows of: record and run are shifted together, or the clock of the record.
@pytest.mark.parametrize("kind", [PiecewiseLinear, SampledMotion])
@pytest.mark.parametrize("text", SHAPED)
def test_what_is_made_of_a_record_moves_along_with_it(kind: Any, text: str) -> None:
    t = np.linspace(1e-6, 5.0, 3001)  # of the record, which ends at 3.99 s
    plain = at(altered(rough(kind, 0.0), text, span=(0.0, 6.0)), t)
    for start in (0.0025, 0.005, 1.005):
        # A rest before the record, be it of whole steps or not, changes nothing within it.
        shifted = altered(rough(kind, start), text, span=(0.0, start + 6.0))
        for one, other in zip(at(shifted, t + start), plain, strict=True):
            np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-9 * max(1.0, np.max(np.abs(other))))
        for before in at(shifted, np.linspace(0.0, start - 1e-6, 101)):
            assert not before.any()
    for lag in (-0.0037, 0.0037):
        late = altered(rough(kind, 0.0), f"base_motion_lag.lag={lag}", text, span=(-0.5, 6.0))
        for one, other in zip(at(late, t - lag), plain, strict=True):
            np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-9 * max(1.0, np.max(np.abs(other))))


@pytest.mark.parametrize("text", SHAPED[:2])
def test_a_block_under_what_is_made_of_a_record_does_not_know_when_the_record_began(run_with: Any, text: str) -> None:
    runs = []
    for start in (0.0, 0.0025, 1.0):
        louder = f"base_motion_gain.gain={3.0!r}"
        run = run_with(text, louder, motion=rough(PiecewiseLinear, start), t_end=start + 1.5)
        runs.append((run.onset_time - start, run.impact_times[:3] - start))
    for onset, impacts in runs[1:]:
        assert onset == pytest.approx(runs[0][0], abs=1e-9)
        np.testing.assert_allclose(impacts, runs[0][1], rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("text", SHAPED[:3])
def test_zeros_before_and_after_a_record_do_not_ring_into_it(text: str) -> None:
    t = np.linspace(0.0, 3.99, 2001)
    alone, plain = rough(PiecewiseLinear, 0.0), None
    for before, after in ((0, 0), (70, 50)):
        padded = np.concatenate([np.zeros(before), alone.a_x, np.zeros(after)])
        found = at(altered(PiecewiseLinear(0.01, padded, start=-0.01 * before), text, span=(-1.0, 6.0)), t)
        plain = found if plain is None else plain
        for one, other in zip(found, plain, strict=True):
            np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-9 * max(1.0, np.max(np.abs(other))))


def test_an_offset_of_the_record_is_no_displacement_that_grows() -> None:
    step = 0.01
    motion = SampledMotion(step, 0.02 * np.ones(6001))
    pitch = at(altered(motion, "table_pitch.per_displacement=1.0", span=(0.0, 60.0)), np.linspace(0.0, 60.0, 6001))[2]
    # Twice integrated it would be 36 m; above 0.1 Hz it is 0.02/(2 pi 0.1)^2 = 0.05 m at the ends, 0 between.
    assert np.max(np.abs(pitch)) < 0.05
    assert np.max(np.abs(pitch[2500:3500])) < 1e-4


# a_x = A sin(w t) is A cos(phi) with phi = w t - pi/2: A cos(2 phi) = -A cos(2 w t), A sin(2 phi) = -A sin(2 w t).
def test_the_second_harmonic_of_a_sinusoid_is_that_of_its_formula() -> None:
    w = 2.0 * math.pi * 3.0
    motion = sinusoid(3.0, 4.0)
    envelope = 0.4 * T
    for text, wave in (
        ("vertical_motion.second_harmonic_ratio=0.3", -np.cos(2.0 * w * T)),
        ("vertical_motion.second_harmonic_quadrature=0.3", -np.sin(2.0 * w * T)),
    ):
        a_x, a_z, *_ = at(altered(motion, text), T)
        np.testing.assert_allclose(a_x, at(motion, T)[0], rtol=1e-15)
        # Cut off at 4 m/s^2 after 10 s the sine has a quadrature of 4/(pi w (10 - t)) more or less than its own; the
        # square over the modulus is off by three times that at most.
        off = 3.0 * 0.3 * 4.0 / (math.pi * w * (10.0 - T))
        assert np.all(np.abs(a_z - 0.3 * envelope * wave) < off)
        assert np.max(off[T < 5.0]) < 0.05 * 0.3 * 4.0
    cross = at(altered(motion, "vertical_motion.ratio=-0.2"), T)
    np.testing.assert_allclose(cross[1], -0.2 * cross[0], rtol=1e-15)


# Effects on the base are put one on the other by rank: what a gain raises, cross-talk, pitch and tilt see raised.
def test_effects_on_the_base_are_stacked_by_rank_and_not_as_given(shaken: Any) -> None:
    texts = [
        "base_tilt.angle=0.05", "table_pitch.per_acceleration=1e-3", "vertical_motion.ratio=0.2",
        "base_motion_gain.gain=1.5", "base_motion_lag.lag=0.02",
    ]  # fmt: skip
    one, other = (at(altered(shaken(), *order), T) for order in (texts, texts[::-1]))
    for got, want in zip(one, other, strict=True):
        np.testing.assert_allclose(got, want, atol=1e-12)
    a_x, a_z = at(shaken(), T + 0.02)[:2]
    a_z, a_x = a_z + 0.2 * 1.5 * a_x, 1.5 * a_x
    np.testing.assert_allclose(one[0], a_x * math.cos(0.05) - (G + a_z) * math.sin(0.05), atol=1e-12)
    pitched = at(altered(shaken(), *texts[1:]), T)
    np.testing.assert_allclose(one[2], pitched[2], atol=1e-12)
    names = ("base_motion_gain", "vertical_motion", "table_pitch", "learned_base", "base_tilt")
    ranks = [load(name).rank for name in names]
    assert ranks == sorted(set(ranks))


# A plate lies on the table: pitch and vertical motion are those of the table, whose sensor is below the plate.
def test_a_plate_does_not_change_how_the_table_below_it_pitches_and_heaves() -> None:
    texts = ["learned_base.frequency=10", "table_pitch.per_acceleration=1e-3", "vertical_motion.ratio=0.5",
             "vertical_motion.second_harmonic_ratio=0.3"]  # fmt: skip
    t = np.linspace(0.0, 3.99, 2001)
    for given in (texts, texts[1:] + texts[:1]):
        both = at(altered(rough(SampledMotion, 0.0), *given), t)
        plate = at(altered(rough(SampledMotion, 0.0), texts[0]), t)
        below = at(altered(rough(SampledMotion, 0.0), *texts[1:]), t)
        for one, other in zip(both, (plate[0], *below[1:]), strict=True):
            np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-10)


# A pitch turns gravity: held at psi it is a tilt of that angle.  Both say the same of the same floor.
def test_a_pitch_that_is_held_is_a_tilt(run_with: Any) -> None:
    held = SampledMotion(0.1, np.zeros(101), pitch=np.full(101, 0.04))
    one = run_with(motion=held, theta=0.1, t_end=2.0)
    other = run_with("base_tilt.angle=0.04", motion=Still(), theta=0.1, t_end=2.0)
    np.testing.assert_allclose(one.impact_times[:6], other.impact_times[:6], atol=1e-9)


def test_a_block_on_a_pitching_floor_comes_to_rest_when_the_floor_does(run_with: Any) -> None:
    motion = RampedSinusoid(2.0, 5.0, 4.0, taper=1.0)
    run = run_with("table_pitch.per_acceleration=2e-3", motion=motion, t_end=25.0, rtol=1e-9, atol=1e-12)
    assert run.onset_time < 5.0
    assert run.outcome is Outcome.AT_REST


@pytest.mark.parametrize("xp", [np, scalars])
def test_a_table_is_the_cubic_spline_through_its_samples(xp: Any) -> None:
    rng = np.random.default_rng(1)
    step, start = 0.02, -0.3
    columns = [rng.normal(size=200), rng.normal(size=200)]
    span = (start, start + 199 * step)
    numbers = table(span, start, step, *columns)
    t = np.linspace(*span, 777)
    for i, column in enumerate(columns):
        spline = CubicSpline(start + step * np.arange(200), column)
        inputs = t if xp is np else t.tolist()
        if xp is np:
            values = table_value(np, inputs, numbers, float(i))
        else:
            values = [table_value(scalars, value, numbers.tolist(), float(i)) for value in inputs]
        np.testing.assert_allclose(values, spline(t), atol=1e-12)
        # Nothing outside.
        for outside in (span[0] - 1e-6, span[1] + 1e-6):
            assert table_value(xp, np.float64(outside) if xp is np else outside, numbers, float(i)) == 0.0


def test_what_lies_before_and_after_a_part_of_a_table_does_not_ring_into_it() -> None:
    rng = np.random.default_rng(3)
    step, t = 0.01, np.linspace(0.5, 0.9, 401)
    own = rng.normal(size=41)
    for around in (np.zeros(50), rng.normal(size=50)):
        numbers = table((0.0, 1.4), 0.0, step, np.concatenate([around, own, around]), part=slice(50, 91))
        np.testing.assert_allclose(
            table_value(np, t, numbers, 0.0), CubicSpline(0.5 + step * np.arange(41), own)(t), atol=1e-12
        )


def test_a_table_that_is_cut_to_the_span_is_the_same_there() -> None:
    rng = np.random.default_rng(2)
    column, step = rng.normal(size=1000), 0.01
    whole, cut = table((0.0, 9.99), 0.0, step, column), table((4.0, 5.0), 0.0, step, column)
    assert cut.size < 0.25 * whole.size
    t = np.linspace(4.0, 5.0, 333)
    np.testing.assert_allclose(table_value(np, t, cut, 0.0), table_value(np, t, whole, 0.0), atol=1e-12)


def test_tables_do_not_step_over_what_they_hold(shaken: Any) -> None:
    motion = shaken()
    assert altered(motion, "base_tilt.angle=0.1").max_step == motion.max_step
    pitched = altered(motion, "table_pitch.per_acceleration=1e-3")
    assert pitched.max_step <= motion.max_step / 4.0
    assert altered(SampledMotion(0.005, np.ones(100)), "table_pitch.per_displacement=1e-3").max_step == 0.005
    # One on top of the other they follow the motion that all of them are of.
    both = altered(motion, "table_pitch.per_acceleration=1e-3", "vertical_motion.second_harmonic_ratio=0.1")
    assert both.max_step == pitched.max_step
    assert "pitch" in repr(pitched)
    assert isinstance(pitched, AlteredMotion)


def test_a_batch_runs_over_altered_motions_of_one_kind() -> None:
    # Tables of one length, as a batch wants: the step of a table follows from the frequency.
    motions = [sinusoid(2.5, amplitude) for amplitude in (3.0, 4.0)]
    gains = [load("base_motion_gain")(gain=g) for g in (0.9, 1.2)]
    pitch, damped = parse(["table_pitch.per_acceleration=5e-4", "viscous_damping.coefficient=0.3"])
    system = compose(Method1(BLOCK), [damped])
    bases = [base_with(m, [gain, pitch], (0.0, 6.0), G) for m, gain in zip(motions, gains, strict=True)]
    assert bases[0].kernel is bases[1].kernel
    batch = solve_batch(system, bases, t_end=6.0, theta=[0.05, 0.08])
    for i, (motion, gain, theta) in enumerate(zip(motions, gains, (0.05, 0.08), strict=True)):
        run = solve(Method1(BLOCK), motion, theta=theta, t_end=6.0, effects=[gain, pitch, damped])
        assert batch.peak_rotation[i] == run.peak_rotation
        assert batch.impacts[i] == len(run.impact_times)


@pytest.mark.parametrize("name", ["exact"])
def test_a_solver_in_closed_form_declines_what_it_does_not_know(shaken: Any, name: str) -> None:
    linear = Method1(BLOCK, form="linear")
    with pytest.raises(ValueError, match=f"solver='{name}' declines: "):
        solve(linear, RampedSinusoid(2.0, 5.0, 3.0), t_end=1.0, effects=parse(["base_tilt.angle=0.02"]), solver=name)
