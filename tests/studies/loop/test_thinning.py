"""The recorded base motion at fewer samples a second: what is lost, and what a block does under it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import butter, sosfiltfilt

from excitation import SampledMotion
from rocking import Block, Method1, solve
from studies.campaigns import Channel, DeclaredBlock, Test
from studies.loop.models.model import LoopModel
from studies.loop.runs.simulation import Job, Simulator
from studies.loop.runs.thinning import SHARE, factors, thinned, thinning

P, STEP, NOISE = 5.0, 0.002, 3e-3


def record(frequency: float, noise: float = NOISE, seed: int = 0) -> SampledMotion:
    """A sinusoid of 3 m/s^2 under a smooth envelope, with the noise of its sensor."""
    t = STEP * np.arange(4003)
    a = 3.0 * np.sin(np.pi * t / t[-1]) ** 2 * np.sin(2.0 * np.pi * frequency * t)
    return SampledMotion(STEP, a + noise * np.random.default_rng(seed).standard_normal(t.size), start=1.0)


def test_slow_motion_is_thinned_and_fast_motion_less() -> None:
    factors = [thinning(record(frequency), NOISE, P) for frequency in (3.0, 12.0, 40.0, 150.0)]
    assert factors[0] >= 5 and factors == sorted(factors, reverse=True) and factors[-1] == 1
    # Without noise there is nothing to measure a loss by.
    assert thinning(record(3.0, 0.0), 0.0, P) == 1


@pytest.mark.parametrize("factor", [2, 5, 8])
def test_a_thinned_motion_is_the_motion_below_its_own_rate_and_reaches_as_far(factor: int) -> None:
    smooth = record(3.0, 0.0)
    fewer = thinned(smooth, factor)
    assert fewer.time_step == factor * STEP and fewer.start == smooth.start and fewer.end >= smooth.end - 1e-12
    # A cubic spline of step h through f is off by 5/384 h^4 max|d4f/dt4| at the most (Hall and Meyer 1976).
    bound = 5.0 / 384.0 * 3.0 * (2.0 * np.pi * 3.0 * fewer.time_step) ** 4
    np.testing.assert_allclose(fewer(smooth.times)[0], smooth.a_x, atol=bound)
    assert thinned(smooth, 1) is smooth


@pytest.mark.parametrize("frequency", [3.0, 5.0, 7.0])
def test_a_thinned_motion_keeps_its_size(frequency: float) -> None:
    """The nearest spline takes nothing of a sinusoid in the first order; one through its samples makes it smaller."""
    smooth = record(frequency, 0.0)
    kept = thinned(smooth, 10)(smooth.times)[0] @ smooth.a_x / (smooth.a_x @ smooth.a_x)
    assert abs(kept - 1.0) < 1e-6


@pytest.mark.parametrize("frequency", [2.0, 3.0, 5.0])
def test_a_block_tells_a_thinned_motion_from_its_record_less_than_a_noisy_one(frequency: float) -> None:
    """At 20 ms and without noise it is moved by less than the share that is said of what the noise moves it by."""
    block, t = Block(0.2, 0.8), np.linspace(1.0, 8.0, 1401)

    def rotation(motion: SampledMotion) -> np.ndarray:
        return solve(Method1(block, restitution=0.9), motion, t_start=1.0, t_end=8.0, save_at=t).theta

    smooth = record(frequency, 0.0)
    whole = rotation(smooth)
    assert np.abs(whole).max() > 0.01
    by_noise = np.mean([np.mean((rotation(record(frequency, seed=k)) - whole) ** 2) for k in range(4)])
    assert np.mean((rotation(thinned(smooth, 10)) - whole) ** 2) < SHARE**2 * by_noise


def test_the_loss_is_judged_by_what_the_block_would_do() -> None:
    """The filter behind the limit, integrated apart: a critically damped oscillator on the difference of the two."""
    motion = record(12.0)
    factor = thinning(motion, NOISE, P)
    assert factor > 1
    t = motion.times - motion.start
    quiet = SampledMotion(STEP, np.random.default_rng(7).standard_normal(t.size) * NOISE)

    def response(a: np.ndarray) -> np.ndarray:
        def rate(at: float, y: np.ndarray) -> list[float]:
            return [y[1], P * P * (np.interp(at, t, a) - y[0]) - 2.0 * P * y[1]]

        return solve_ivp(rate, (0.0, t[-1]), [0.0, 0.0], t_eval=t, max_step=STEP, rtol=1e-6, atol=1e-12).y[0]

    loss = response(thinned(motion, factor)(motion.times)[0] - motion.a_x)
    noise = response(quiet.a_x)[1000:]
    # One draw of the noise behind the filter: its own deviation is known to a tenth.
    assert np.abs(loss).max() < 1.2 * SHARE * noise.std()


def test_runs_come_no_further_from_those_without_noise() -> None:
    """On the average of eight draws: noise lets a block tip early, which moves every later impact."""
    block, t = Block(0.2, 0.8), np.linspace(1.0, 6.0, 1001)

    def rotation(motion: SampledMotion) -> np.ndarray:
        return solve(Method1(block, restitution=0.9), motion, t_start=1.0, t_end=6.0, save_at=t).theta

    true = rotation(record(2.0, 0.0))
    assert np.abs(true).max() > 0.02
    apart: list[tuple[float, float]] = []
    for seed in range(8):
        motion = record(2.0, seed=seed)
        factor = thinning(motion, NOISE, block.p())
        assert factor > 1
        runs = rotation(motion), rotation(thinned(motion, factor))
        apart.append(tuple(float(np.mean((run - true) ** 2)) for run in runs))
    every, fewer = np.mean(apart, axis=0)
    assert fewer < every


def test_a_campaign_that_declares_its_mass_distribution_is_thinned_too() -> None:
    t = STEP * np.arange(4003)
    channels = (Channel("base_x", "base_acceleration_x", NOISE),)
    test = Test("ramp", "forced", t, channels, {"base_x": record(3.0).a_x})
    at_rest = Test("free", "free", t, (), {}, initial_rotation=0.1)
    block = DeclaredBlock(0.2, 0.8, 0.3, 30.0, centre_of_mass_height=0.35, inertia=1.5)
    assert factors([test, at_rest], block.p()) == [thinning(record(3.0), NOISE, block.p()), 25]


def test_sensors_on_the_block_read_every_sample_whatever_runs_see() -> None:
    t = STEP * np.arange(4003)
    channels = (Channel("base_x", "base_acceleration_x", NOISE),)
    simulator = Simulator([Test("ramp", "forced", t, channels, {"base_x": record(3.0).a_x})], factors=[5])
    for effects in ({}, {"table_pitch": {"per_acceleration": 1e-4}}):
        model = LoopModel(DeclaredBlock(0.2, 0.8, 0.3, 30.0), 0.9, effects, 9.81)
        assert simulator._driving(model, 0).max_step == pytest.approx(5 * STEP)
        np.testing.assert_allclose(simulator.base(model, 0).a_x, record(3.0).a_x, atol=1e-12)


def test_the_rotation_sensor_feels_the_record_without_gravity_on_a_tilted_floor() -> None:
    t = STEP * np.arange(4003)
    channels = (Channel("base_x", "base_acceleration_x", NOISE),)
    simulator = Simulator([Test("ramp", "forced", t, channels, {"base_x": record(3.0).a_x})])
    model = LoopModel(DeclaredBlock(0.2, 0.8, 0.3, 30.0), 0.9, {"base_tilt": {"angle": 0.05}}, 9.81)
    np.testing.assert_allclose(simulator.seen(model, 0).a_x, record(3.0).a_x, atol=1e-12)
    # Sensors on the block are in the axes of the floor, and feel it.
    along = np.cos(0.05) * record(3.0).a_x - 9.81 * np.sin(0.05)
    np.testing.assert_allclose(simulator.base(model, 0).a_x, along, atol=1e-12)


def earthquake() -> Test:
    """Noise between 0.5 and 10 Hz of 2.5 m/s^2 under a smooth envelope, with that of its sensor."""
    rng, t = np.random.default_rng(3), STEP * np.arange(4001)
    motion = sosfiltfilt(butter(3, [0.5, 10.0], "bandpass", fs=1.0 / STEP, output="sos"), rng.standard_normal(t.size))
    a = 2.5 * motion / np.abs(motion).max() * np.sin(np.pi * t / t[-1]) ** 2 + NOISE * rng.standard_normal(t.size)
    return Test("quake", "forced", t, (Channel("base_x", "base_acceleration_x", NOISE),), {"base_x": a})


# Sizes of a laboratory that has something to find.
@pytest.mark.parametrize(
    "values",
    [
        {"base_tilt.angle": 4e-3}, {"base_motion_gain.gain": 1.03}, {"base_motion_lag.lag": 4e-3},
        {"vertical_motion.ratio": 0.1}, {"vertical_motion.second_harmonic_ratio": 0.3},
        {"table_pitch.per_acceleration": 2e-4}, {"table_pitch.per_displacement": 0.04},
    ],
    ids=lambda values: next(iter(values)),
)  # fmt: skip
def test_what_an_effect_on_the_base_does_to_a_swing_is_kept_by_the_thinned_record(values: dict[str, float]) -> None:
    """Less is lost of it than a tenth of the noise of a good rotation sensor, 1e-4 rad, and than a twentieth of it."""
    block, test = DeclaredBlock(0.2, 0.8, 0.3, 30.0), earthquake()
    (factor,) = factors([test], block.p())
    assert factor >= 4
    plain = LoopModel(block, 0.9, {}, 9.81)
    changed = plain.changed(values)
    swings = [
        Job(model, 0, start + STEP * np.arange(250), start, side * 0.03, 0.0)
        for model in (0, 1) for start in np.arange(1.0, 7.0, 0.4) for side in (1.0, -1.0)
    ]  # fmt: skip
    does = []
    for some in ([factor], [1]):
        theta = np.array([a.theta for a in Simulator([test], factors=some).run([plain, changed], swings)])
        assert np.abs(theta).max() < block.alpha
        does.append(theta[len(swings) // 2 :] - theta[: len(swings) // 2])
    lost = np.sqrt(np.mean((does[0] - does[1]) ** 2))
    assert lost < 1e-5 and lost < 0.05 * np.sqrt(np.mean(does[1] ** 2))
