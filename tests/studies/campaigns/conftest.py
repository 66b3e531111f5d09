"""A small campaign made with the ideal block: every number in it is known."""

import numpy as np
import pytest

from excitation import RampedSinusoid, SampledMotion
from rocking import Block, Method1, solve
from rocking.instruments import accelerometer
from studies.campaigns import Campaign, Channel, Conditions, DeclaredBlock, Test, write

STEP = 0.004
RESTITUTION = 0.92
BLOCK = Block(b=0.15, h=0.5, d=0.25, density=600.0)
DECLARED = DeclaredBlock(0.15, 0.5, 0.25, BLOCK.mass)
ROTATION = Channel("rotation", "rotation", 2e-4)
BASE = Channel("base_x", "base_acceleration_x", 0.004)
SENSOR = Channel("acc_top", "block_acceleration", 0.03, (0.0, 0.48), (0.0, 1.0))


def read_only(values):
    values = np.asarray(values, dtype=np.float64)
    values.flags.writeable = False
    return values


def ramp(frequency, duration=6.0, amplitude=7.0):
    """Samples of a ramped sinusoid and the motion through them, as a laboratory knows it."""
    t = STEP * np.arange(round(duration / STEP) + 1)
    a_x = RampedSinusoid(frequency, duration, amplitude)(t)[0]
    return t, a_x, SampledMotion(STEP, a_x)


def free_test(id, theta, rng, duration=3.0, noise=2e-4):
    t = STEP * np.arange(round(duration / STEP) + 1)
    run = solve(Method1(BLOCK, restitution=RESTITUTION), theta=theta, t_end=t[-1], save_at=t)
    rotation = read_only(run.theta + noise * rng.standard_normal(t.size))
    return Test(id, "free", read_only(t), (ROTATION,), {"rotation": rotation}, initial_rotation=theta), run


def forced_test(id, frequency, rng, duration=6.0, amplitude=7.0, noise=2e-4, sensor=False):
    t, a_x, motion = ramp(frequency, duration, amplitude)
    run = solve(Method1(BLOCK, restitution=RESTITUTION), motion, t_end=t[-1], save_at=t)
    n = run.t.size
    data = {
        "rotation": read_only(run.theta + noise * rng.standard_normal(n)),
        "base_x": read_only(a_x[:n] + 0.004 * rng.standard_normal(n)),
    }
    channels = (ROTATION, BASE)
    if sensor:
        reading = accelerometer(run, SENSOR.position, SENSOR.direction)
        data["acc_top"] = read_only(reading + 0.03 * rng.standard_normal(n))
        channels = (ROTATION, BASE, SENSOR)
    return Test(id, "forced", read_only(t[:n]), channels, data), run


@pytest.fixture(scope="session")
def campaign():
    """A free test, two forced ones (one with an accelerometer), one with gaps and its motion named, one to predict."""
    rng = np.random.default_rng(1)
    free, _ = free_test("free-01", 0.19, rng)
    first, _ = forced_test("ramp-3Hz", 3.0, rng)
    second, _ = forced_test("ramp-4Hz", 4.0, rng, sensor=True)
    holed = {k: v.copy() for k, v in first.data.items()}
    holed["rotation"][100:120] = np.nan
    holed["base_x"][300:302] = np.nan
    holed = {k: read_only(v) for k, v in holed.items()}
    named = Test("named é", "forced", first.time, (ROTATION, BASE), holed, motion="ramp x 1.4", overturned=False)
    base = {"base_x": first.data["base_x"]}
    ahead = Test("ahead", "forced", first.time, (BASE,), base)
    blind = Test("free-p", "free", free.time, (), {}, initial_rotation=-0.1)
    tests = (free, first, second, named, ahead, blind)
    channels = (ROTATION, BASE, SENSOR)
    return Campaign('Made "up", with \\ and é', DECLARED, Conditions(0.7, 0.93), channels, tests)


@pytest.fixture
def folder(campaign, tmp_path):
    """The campaign on disk, in a folder whose neighbours belong to the test."""
    write(campaign, tmp_path / "made")
    return tmp_path / "made"
