"""What the block feels against what the base record gives."""

from dataclasses import replace

import numpy as np
import pytest

from excitation import SampledMotion
from rocking import Method1, solve
from studies.campaigns import Test
from studies.campaigns.signals import noise
from studies.campaigns.signs import drive

from .conftest import BASE, BLOCK, DECLARED, ROTATION, STEP, forced_test, free_test, read_only


def made(frequency=3.0, seed=1):
    return forced_test("a", frequency, np.random.default_rng(seed))[0]


def driven(test, **scale):
    data = {name: read_only(scale.get(name, 1.0) * values) for name, values in test.data.items()}
    changed = replace(test, data=data)
    return drive(changed, DECLARED, noise(changed.rotation, STEP))


@pytest.mark.parametrize("frequency", [3.0, 4.0, 5.0])
def test_slope_is_one_for_the_ideal_block(frequency):
    """Method 1 integrates the equation that the regression tests; the noise leaves some per cent."""
    found = driven(made(frequency))
    assert found.slope == pytest.approx(1.0, abs=0.05) and found.correlation > 0.95 and not found.opposed


@pytest.mark.parametrize(("scale", "slope"), [(-1.0, -1.0), (1 / 9.80665, 9.80665), (1.05, 1 / 1.05)])
def test_slope_tells_signs_units_and_gain(scale, slope):
    found = driven(made(), base_x=scale)
    assert found.slope == pytest.approx(slope, rel=0.05) and found.opposed == (scale < 0.0)


def test_a_mirrored_rotation_is_opposed():
    assert driven(made(), rotation=-1.0).opposed


def test_vertical_motion_is_taken_into_account():
    """A strong vertical motion in step with the horizontal one."""
    t = STEP * np.arange(1501)
    a_x = 5.0 * np.sin(2 * np.pi * 3.0 * t) * (t / t[-1])
    a_z = 4.0 * np.sin(2 * np.pi * 6.0 * t + 1.0)
    run = solve(Method1(BLOCK, restitution=0.92), SampledMotion(STEP, a_x, a_z), t_end=t[-1], save_at=t)
    rotation = run.theta + 2e-4 * np.random.default_rng(1).standard_normal(run.t.size)
    vertical = replace(BASE, name="base_z", kind="base_acceleration_z")
    data = {"rotation": rotation, "base_x": a_x[: run.t.size], "base_z": a_z[: run.t.size]}
    test = Test("v", "forced", t[: run.t.size], (ROTATION, BASE, vertical), data)
    level = noise(rotation, STEP)
    assert drive(test, DECLARED, level).slope == pytest.approx(1.0, abs=0.05)
    without = replace(test, channels=test.channels[:2], data={k: data[k] for k in ("rotation", "base_x")})
    assert drive(without, DECLARED, level).correlation < drive(test, DECLARED, level).correlation


def test_nothing_is_said_without_a_base_or_swings():
    rng = np.random.default_rng(1)
    free, _ = free_test("f", 0.19, rng)
    assert drive(free, DECLARED, noise(free.rotation, STEP)) is None
    weak, _ = forced_test("w", 3.0, rng, amplitude=1.0)
    assert drive(weak, DECLARED, noise(weak.rotation, STEP)) is None
