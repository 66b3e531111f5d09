"""How many events a run of a fit may have: all that a block comes to which is shaken by hardly more than its onset, and
not without end where it keeps all its speed in impacts."""

from __future__ import annotations

import math

import numpy as np
import pytest

from excitation import SampledMotion
from rocking import Block, Method1, Method2, solve
from studies.campaigns import Channel, DeclaredBlock, Test
from studies.loop.models.model import LoopModel
from studies.loop.runs.simulation import FEWEST_EVENTS, KEEPS_ALL, MOST_EVENTS, SMALLEST, Job, Simulator, most_events

BLOCK = Block(0.2, 0.8, 0.4)
DECLARED = DeclaredBlock(0.2, 0.8, 0.4, BLOCK.mass)


def test_a_block_that_keeps_all_may_rock_through_the_smallest_share_all_the_time() -> None:
    """By a run with nothing lost: an impact each half of its period, 4 acosh(1 / (1 - r)) / p (Housner 1963)."""
    system = Method1(BLOCK, restitution=1.0, g=9.81)
    run = solve(system, theta=SMALLEST * BLOCK.alpha, t_end=2.0)
    assert most_events(system, 2.0) - FEWEST_EVENTS == pytest.approx(len(run.impact_times), rel=0.02)


def test_a_block_that_is_shaken_by_hardly_more_than_its_onset_has_more_impacts_and_runs_through() -> None:
    """It tips and comes to rest again with each turn of the base, and rotates by less than any sensor sees."""
    t = np.arange(6000) * 0.002
    base = 1.02 * 9.81 * 0.25 * np.sin(2.0 * math.pi * 5.0 * t)
    system = Method1(BLOCK, restitution=0.93, g=9.81)
    run = solve(system, SampledMotion(0.002, base), t_end=float(t[-1]))
    assert len(run.impact_times) > 5000 and np.max(np.abs(run.theta)) < 1e-4
    assert most_events(system, 12.0) > 2 * len(run.impact_times)
    channels = (Channel("rotation", "rotation", 1e-4), Channel("base_x", "base_acceleration_x", 4e-3))
    tests = [Test("steady", "forced", t, channels, {"rotation": np.zeros(t.size), "base_x": base})]
    (found,) = Simulator(tests).run([LoopModel(DECLARED, 0.93, {}, 9.81)], [Job(0, 0, t, 0.0, 0.0)])
    assert not found.failed and np.max(np.abs(found.theta)) < 1e-4


def test_no_other_block_is_cut_short() -> None:
    slender = Block(0.03, 1.0, 0.3)  # Housner's restitution is 0.9987
    for system in (Method2(BLOCK, friction=0.6), Method1(BLOCK, g=9.81), Method1(slender, g=9.81)):
        assert most_events(system, 2.0) == MOST_EVENTS
    assert most_events(Method1(BLOCK, restitution=KEEPS_ALL, g=9.81), 2.0) < MOST_EVENTS
    assert most_events(Method1(BLOCK, restitution=1.0, g=9.81), 1e6) == MOST_EVENTS


def test_a_model_that_loses_nothing_in_slow_impacts_fails() -> None:
    """By hand: with e = 1 - c omega the number of impacts grows as exp(c p^2 t / 2): exp(4.5 t) here."""
    t = np.arange(2500) * 0.004
    channels = (Channel("rotation", "rotation", 1e-4),)
    tests = [Test("free", "free", t, channels, {"rotation": np.zeros(t.size)}, initial_rotation=0.05)]
    models = [
        LoopModel(DECLARED, e, {"velocity_dependent_restitution": {"slope": slope}}, 9.81)
        for e, slope in ((0.9, 0.0), (1.0, -0.5))
    ]
    ideal, rattles = Simulator(tests).run(models, [Job(k, 0, t, 0.0, 0.05) for k in range(2)])
    assert not ideal.failed and rattles.failed
