"""A recorder of the rotation with a clock of its own, by hand and on runs (rocking.effects.learned_timing)."""

import numpy as np
import pytest

from rocking import Block, Method1, solve
from rocking.effects import load, parse, read_at
from rocking.instruments import rotation_sensor
from studies.campaigns import Channel, DeclaredBlock
from studies.campaigns import Test as Record
from studies.loop.models.model import LoopModel
from studies.loop.runs.simulation import Job, Peak, Simulator

BLOCK = Block(b=0.2, h=0.8)
PACE, LAG = 0.01, 0.02


def test_a_reading_is_of_another_moment() -> None:
    """Of a reading at 2 s: 1.01 x 2 s - 0.02 s; none from before the record."""
    timing = load("learned_timing")(pace=PACE, lag=LAG)
    np.testing.assert_allclose(timing.moments(np.array([0.0, 0.01, 1.0, 2.0])), [0.0, 0.0, 0.99, 2.0], atol=1e-15)
    time = np.array([1.0])
    assert read_at(time, parse(["viscous_damping.coefficient=0.1"])) is time


def test_a_sensor_reads_the_rotation_of_that_moment() -> None:
    """A run that is asked for those moments is another way to the same readings."""
    time = np.linspace(0.0, 1.2, 1201)
    effects = parse([f"learned_timing.pace={PACE}", f"learned_timing.lag={LAG}"])
    run = solve(Method1(BLOCK), theta=0.1, t_end=1.2, save_at=time, effects=effects)
    moments = np.maximum((1.0 + PACE) * time - LAG, 0.0)
    there = solve(Method1(BLOCK), theta=0.1, t_end=1.2, save_at=np.unique(moments[moments <= 1.2]))
    # The block is let go at its lean; within a step of 1 ms an impact bends the cubic by less than 1e-4 rad.
    np.testing.assert_allclose(rotation_sensor(run), np.interp(moments, there.t, there.theta), rtol=0.0, atol=1e-4)
    np.testing.assert_array_equal(rotation_sensor(run)[:20], 0.1)
    [alone] = rotation_sensor(solve(Method1(BLOCK), theta=0.1, t_end=1.2, save_at=[0.5], effects=effects))
    assert np.isnan(alone)  # of another moment than the one sample


def test_the_loop_runs_a_record_at_the_moments_that_it_is_of() -> None:
    """The same run without a clock, asked for the moments; from the middle of the record too."""
    time = 0.004 * np.arange(501)
    channels = (Channel("base", "base_acceleration_x", 1e-3), Channel("rotation", "rotation", 1e-4))
    push = 4.0 * np.sin(12.0 * time)
    test = Record("forced-0", "forced", time, channels, {"base": push, "rotation": 0.0 * time})
    plain = LoopModel(DeclaredBlock(0.2, 0.8, 0.2, 70.0), 0.93)
    timed = plain.changed({"learned_timing.pace": PACE, "learned_timing.lag": LAG})
    simulator = Simulator([test])
    moments = np.maximum((1.0 + PACE) * time - LAG, 0.0)
    for first, theta in ((0, 0.0), (200, 0.05)):
        [read] = simulator.run([timed], [Job(0, 0, time[first:], float(time[first]), theta)])
        there = np.unique(moments[first:])
        [run] = simulator.run([plain], [Job(0, 0, there, float(moments[first]), theta)])
        assert np.ptp(read.theta) > 0.01
        np.testing.assert_allclose(read.theta, np.interp(moments[first:], there, run.theta), rtol=0.0, atol=1e-12)


def test_what_is_carried_to_a_swing_is_of_the_moment_too() -> None:
    """A block that slips is run from the peak before, at the time when that was."""
    time = 0.004 * np.arange(501)
    channels = (Channel("base", "base_acceleration_x", 1e-3), Channel("rotation", "rotation", 1e-4))
    test = Record("forced-0", "forced", time, channels, {"base": 3.0 * np.sin(9.0 * time), "rotation": 0.0 * time})
    slips = LoopModel(DeclaredBlock(0.2, 0.8, 0.2, 70.0), 0.93, {"sliding": {"friction": 0.27}})
    timed = slips.changed({"learned_timing.pace": PACE, "learned_timing.lag": LAG})

    def at(t: float) -> float:
        return (1.0 + PACE) * t - LAG

    simulator, peaks = Simulator([test]), (0.6, 0.9)
    [read] = simulator.run(
        [timed], [Job(0, 0, np.array([1.4]), 1.2, 0.05, 0.0, tuple(Peak(t, 0.05, 0.0) for t in peaks))]
    )
    [run] = simulator.run(
        [slips], [Job(0, 0, np.array([at(1.4)]), at(1.2), 0.05, 0.0, tuple(Peak(at(t), 0.05, 0.0) for t in peaks))]
    )
    np.testing.assert_array_equal(read.y, run.y)


@pytest.mark.parametrize("pace", [0.6, -0.6])
def test_a_clock_of_another_world_is_refused(pace: float) -> None:
    with pytest.raises(ValueError, match=r"learned_timing\.pace=.* 1: want -0\.5 to 0\.5"):
        load("learned_timing")(pace=pace)
