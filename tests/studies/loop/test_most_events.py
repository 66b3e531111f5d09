"""How many impacts a run of a fit may have: more than any block that is seen to rock, and not without end."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rocking import Block, Method1, Method2, solve
from studies.campaigns import Channel, DeclaredBlock, Test
from studies.loop.model import LoopModel
from studies.loop.simulation import MOST_EVENTS, MOST_TO_REST, SMALLEST, Job, Simulator, most_events

BLOCK = Block(0.2, 0.8, 0.4)
DECLARED = DeclaredBlock(0.2, 0.8, 0.4, BLOCK.mass)


@pytest.mark.parametrize("share", [SMALLEST, 1e-2])
def test_a_block_that_rocks_through_the_smallest_share_all_the_time_has_so_many_impacts(share: float) -> None:
    """Run with nothing lost, against its period 4 acosh(1 / (1 - r)) / p for small r (Housner 1963)."""
    system = Method1(BLOCK, restitution=1.0, g=9.81)
    run = solve(system, theta=share * BLOCK.alpha, t_end=2.0)
    least = BLOCK.p(9.81) * 2.0 / (2.0 * math.sqrt(2.0 * share))
    assert len(run.impact_times) == pytest.approx(least, rel=0.02)
    assert len(run.impact_times) < most_events(system, 2.0) - MOST_TO_REST + 2 or share < 1e-3


def test_a_block_that_loses_next_to_nothing_comes_to_rest_before_a_run_fails() -> None:
    """By hand: from the speed of a fall from upright, 0.3 p, to 1e-6 p are ln(3e5) / -ln(0.995) = 2516 impacts."""
    run = solve(Method1(BLOCK, restitution=0.995, g=9.81), theta=0.9 * BLOCK.alpha, t_end=600.0)
    assert run.theta[-1] == 0.0 and 2000 < len(run.impact_times) < MOST_TO_REST


def test_a_block_that_slides_or_jumps_may_have_as_many_as_ever() -> None:
    assert most_events(Method2(BLOCK, friction=0.6), 2.0) == MOST_EVENTS
    assert most_events(Method1(BLOCK, g=9.81), 1e6) == MOST_EVENTS


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
