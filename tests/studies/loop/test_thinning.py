"""The recorded base motion at fewer samples a second: what is lost, and what a block does under it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from excitation import SampledMotion
from rocking import Block, Method1, solve
from studies.campaigns import Channel, DeclaredBlock, Test
from studies.loop.model import LoopModel
from studies.loop.simulation import Simulator
from studies.loop.thinning import SHARE, factors, thinned, thinning

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
    # The filter of `excitation.resampling` passes 1e-3 of the size at most as error, the spline far less.
    np.testing.assert_allclose(fewer(smooth.times)[0], smooth.a_x, atol=3e-3)
    assert thinned(smooth, 1) is smooth


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
    assert factors([test, at_rest], block.p()) == [thinning(record(3.0), NOISE, block.p()), 1]


def test_effects_that_change_the_base_have_every_sample() -> None:
    t = STEP * np.arange(4003)
    channels = (Channel("base_x", "base_acceleration_x", NOISE),)
    block = DeclaredBlock(0.2, 0.8, 0.3, 30.0)
    simulator = Simulator([Test("ramp", "forced", t, channels, {"base_x": record(3.0).a_x})], factors=[5])
    plain = LoopModel(block, 0.9, {}, 9.81)
    pitching = LoopModel(block, 0.9, {"table_pitch": {"per_acceleration": 1e-4}}, 9.81)
    assert simulator._driving(plain, 0).max_step == pytest.approx(5 * STEP)
    assert simulator._driving(pitching, 0).max_step == pytest.approx(STEP)
    # What sensors on the block read has every sample, whatever runs see.
    np.testing.assert_allclose(simulator.base(plain, 0).a_x, record(3.0).a_x, atol=1e-12)
