"""Accelerometers on the block in place of the rotation: sides, leans, mounting angles and gravity are found again.

The records are made with the package's SciPy solver, an instrument at the block's own points and noise; g of the
laboratory differs from the loop's own.
"""

import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from excitation import RampedSinusoid
from rocking import Block, Method1, solve
from rocking.effect import Effect
from rocking.effects import compose
from rocking.effects.eccentric_mass import EccentricMass
from rocking.effects.learned_term import LearnedTerm
from rocking.effects.mass_distribution import MassDistribution
from rocking.instruments import accelerometer
from studies.campaigns import Campaign, CampaignError, Channel, Conditions, DeclaredBlock, Test
from studies.loop.closing import STANDARD_GRAVITY
from studies.loop.fits.estimating import sensor_covariance
from studies.loop.fits.fitting import fit
from studies.loop.fits.linearising import linearised
from studies.loop.models.model import LoopModel
from studies.loop.observed.observing import jobs_of, observe
from studies.loop.observed.windows import SIDE, whole_windows
from studies.loop.records import kinematics, reconstruction
from studies.loop.records.preparing import Setup, prepare
from studies.loop.records.reconstruction import put_right
from studies.loop.swings.tracing import baseline
from studies.loop.swings.trials import E

BLOCK = Block(0.2, 0.8, 0.4)
DECLARED = DeclaredBlock(0.2, 0.8, 0.4, BLOCK.mass)
NOISE, BASE_NOISE, STEP = 0.03, 0.004, 0.005
TRUE_E, TRUE_G = 0.91, 9.80
LEANS = (0.17, -0.19, 0.15)
MOUNTED = {"top": 0.012, "left": -0.02}
TOP = Channel("top", "block_acceleration", NOISE, (0.0, 0.78), (1.0, 0.0))
LEFT = Channel("left", "block_acceleration", NOISE, (-0.1, 0.4), (0.0, 1.0))
BASE = Channel("base_x", "base_acceleration_x", BASE_NOISE)


def turned(channel: Channel) -> tuple[float, float]:
    (x, z), angle = channel.axis, MOUNTED[channel.name]
    return x * math.cos(angle) + z * math.sin(angle), -x * math.sin(angle) + z * math.cos(angle)


def measured(effects: tuple[Effect, ...] = ()) -> tuple[Campaign, list[np.ndarray]]:
    """Three free tests and a forced one, and the rotation that nobody measured."""
    rng = np.random.default_rng(7)
    system = compose(Method1(BLOCK, restitution=TRUE_E, g=TRUE_G), effects)
    tests, rotations = [], []
    for k, lean in enumerate((*LEANS, 0.0)):
        motion = RampedSinusoid(3.0, 8.0, 7.0) if lean == 0.0 else None
        t = np.arange(1600 if motion is not None else 1400) * STEP
        run = solve(system, motion, theta=lean, t_end=float(t[-1]), save_at=t, solver="scipy")
        assert np.array_equal(run.t, t)
        data = {c.name: accelerometer(run, c.position, turned(c)) for c in (TOP, LEFT)}  # type: ignore[arg-type]
        data = {name: values + NOISE * rng.standard_normal(t.size) for name, values in data.items()}
        channels = [TOP, LEFT]
        if motion is not None:
            data["base_x"] = motion(t)[0] + BASE_NOISE * rng.standard_normal(t.size)
            channels.append(BASE)
        kind = "forced" if motion is not None else "free"
        tests.append(Test(f"{kind}-{k}", kind, t, tuple(channels), data, initial_rotation=lean or None))  # type: ignore[arg-type]
        rotations.append(run.theta)
    return Campaign("", DECLARED, Conditions(), (TOP, LEFT, BASE), tuple(tests)), rotations


@pytest.fixture(scope="module")
def truth() -> tuple[Campaign, list[np.ndarray]]:
    return measured()


@pytest.fixture(scope="module")
def setup(truth: tuple[Campaign, list[np.ndarray]]) -> Setup:
    return prepare(truth[0], LoopModel(DECLARED, 0.9, {}, STANDARD_GRAVITY))


# Twice the standard deviation that the record itself states; its mounting angles are not yet calibrated then.
def test_the_rotation_is_got_back_but_for_the_last_small_swings(setup: Setup, truth) -> None:
    for record, rotation in zip(setup.records, truth[1], strict=True):
        large = np.isfinite(record.rotation) & (np.abs(rotation) > 0.03)
        assert large.sum() > 0.7 * (np.abs(rotation) > 0.03).sum()
        assert float(np.percentile(np.abs(record.rotation - rotation)[large], 95.0)) < 2.0 * record.noise
        assert record.noise < 3e-3
        assert np.array_equal(np.sign(record.rotation[large]), np.sign(rotation[large]))


def test_leans_and_mounting_angles_begin_near_the_truth(setup: Setup) -> None:
    np.testing.assert_allclose([r.lean for r in setup.records[:3]], LEANS, rtol=0.0, atol=4e-3)
    # At rest the angle of the upright sensor is a matter of the base motion alone, below the onset of rocking.
    assert setup.start.mountings["top"] == pytest.approx(MOUNTED["top"], abs=2e-3)


def test_the_calibration_finds_restitution_mounting_and_gravity(setup: Setup) -> None:
    found = baseline(setup.simulator, setup.start, setup.swings, gravity=setup.reads_gravity)
    assert setup.reads_gravity
    # Two states in each window take up a little of the noise.
    assert 0.95 < found.swing.rms < 1.03
    truth = {"restitution": TRUE_E, "mounting.top": MOUNTED["top"], "mounting.left": MOUNTED["left"], "gravity": TRUE_G}
    covariance = sensor_covariance(setup.simulator, found.swing)
    for k, parameter in enumerate(found.calibrated):
        sd = math.sqrt(covariance[k, k])
        assert abs(found.swing.model.get(parameter.name) - truth[parameter.name]) < 4.0 * sd
        # So sure from four tests: restitution to a third of a per cent, angles to 3 mrad, gravity to 3 mm/s^2.
        assert sd < 3e-3


# In readings the rotation and the angular acceleration nearly cancel: a block whose mass sits a tenth higher and has a
# tenth more inertia reads like a uniform one at 1.2 to 1.4 times the rotation, one a tenth lower at half of it.
@pytest.mark.parametrize(("height", "inertia"), [(1.1, 1.1), pytest.param(0.9, 1.0, marks=pytest.mark.slow)])
def test_leans_are_got_back_of_a_block_with_another_mass(height: float, inertia: float) -> None:
    mass = MassDistribution(height=height * 0.5 * BLOCK.h, inertia=inertia * BLOCK.I_c)
    found = prepare(measured((mass,))[0], LoopModel(DECLARED, 0.9, {}, STANDARD_GRAVITY))
    np.testing.assert_allclose([r.lean for r in found.records[:3]], LEANS, rtol=0.0, atol=4e-3)
    assert "mass_distribution" not in found.start.effects
    [said] = [note for note in found.notes if "centre of mass" in note]
    own = [float(number) for number in re.findall(r"[\d.]+(?= m | kg m)", said)]
    assert own == pytest.approx([mass.height, mass.inertia], rel=0.05)


def test_a_block_with_its_mass_off_the_middle_is_read_as_one() -> None:
    """4 % of half of the base; a part of it a rotation takes up that is some 10 mrad off, the rest stretches show."""
    found = prepare(measured((EccentricMass(offset=4e-3),))[0], LoopModel(DECLARED, 0.9, {}, STANDARD_GRAVITY))
    np.testing.assert_allclose([r.lean for r in found.records[:3]], LEANS, rtol=0.0, atol=4e-3)
    [said] = [note for note in found.notes if "off the middle" in note]
    assert float(re.findall(r"[\d.]+(?= mm)", said)[0]) == pytest.approx(4.0, rel=0.1)
    assert found.start.effects == {}


def test_a_block_that_a_torque_of_its_own_turns_is_read_by_kinematics() -> None:
    """A guide rubs on one side with 0.4 rad/s^2: the ideal block cannot be fitted to any swing to that side."""
    campaign, rotations = measured((LearnedTerm(friction=-0.2, side_friction=-0.2),))
    found = prepare(campaign, LoopModel(DECLARED, 0.9, {}, STANDARD_GRAVITY))
    np.testing.assert_allclose([r.lean for r in found.records[:3]], LEANS, rtol=0.0, atol=4e-3)
    for record, rotation in zip(found.records, rotations, strict=True):
        large = np.isfinite(record.rotation) & (np.abs(rotation) > 0.03)
        for side in (-1.0, 1.0):
            there = np.abs(rotation) * (np.sign(rotation) == side) > 0.03
            assert (large & there).sum() > 0.7 * there.sum()
        # Two sensors tell it to so much of their noise; the ideal block told a good swing to half of that.
        assert float(np.percentile(np.abs(record.rotation - rotation)[large], 95.0)) < 4.0 * record.noise


def test_a_block_that_lies_there_is_in_no_swing(truth, monkeypatch: pytest.MonkeyPatch) -> None:
    """Struck over after 1 s, its accelerometers read gravity for 6 s: the other records are read as they were."""
    rng, first, asked = np.random.default_rng(9), truth[0].tests[0], list[float]()
    lying = first.time > 1.0
    data = {
        name: np.where(lying, value + NOISE * rng.standard_normal(lying.size), first.data[name])
        for name, value in (("top", -TRUE_G), ("left", 0.0))
    }

    def noted(time: np.ndarray, *given: Any) -> Any:
        asked.append(float(time[-1] - time[0]))
        return kinematics.turned(time, *given)

    monkeypatch.setattr(reconstruction, "turned", noted)
    campaign = replace(truth[0], tests=(replace(first, data=data), *truth[0].tests[1:]))
    found = prepare(campaign, LoopModel(DECLARED, 0.9, {}, STANDARD_GRAVITY))
    np.testing.assert_allclose([r.lean for r in found.records[1:3]], LEANS[1:], rtol=0.0, atol=4e-3)
    assert not any("centre of mass" in note for note in found.notes)
    # 25 / p of this block: no spline of hundreds of knots goes through what lasts longer.
    assert all(lasted < 6.0 for lasted in asked)


def test_nothing_is_left_of_no_stretches(setup: Setup) -> None:
    assert put_right(setup.simulator, setup.start, []) == ([], 0)


def test_a_uniform_block_is_read_as_one_and_nothing_is_said(setup: Setup) -> None:
    assert not any("centre of mass" in note for note in setup.notes)


def test_readings_of_a_run_are_those_of_the_instrument(setup: Setup, truth) -> None:
    model = LoopModel(DECLARED, TRUE_E, {}, TRUE_G, mountings=MOUNTED)
    [window] = whole_windows([setup.records[0]])
    window = window.moved(LEANS[0], 0.0)
    [read] = observe(setup.simulator, [model], jobs_of([window], 0), [window])
    own = np.isfinite(read)
    assert own.mean() > 0.9
    left = (window.data - read)[own] / window.weights[own] ** -1.0
    # The true model leaves the noise; not the samples of a chattering end, where the side may be told wrongly.
    assert float(np.median(np.abs(left))) < 0.8


# What one run cannot compare (it leans to another side) must not show as a slope of a million.
def test_derivatives_do_not_see_the_jump_at_an_impact(setup: Setup) -> None:
    model = LoopModel(DECLARED, TRUE_E, {}, TRUE_G, mountings=MOUNTED)
    windows = setup.swings[:8]
    fine = linearised(setup.simulator, model, [E], windows)
    # One per cent of restitution moves a reading by some tenths of its noise after an impact, not by a jump of 200.
    assert max(float(np.abs(a).max()) for a in fine.by_parameters) < 30.0


def test_sides_are_known_and_the_change_is_a_channel(setup: Setup) -> None:
    record = setup.records[0]
    assert record.channels[-1] is SIDE
    assert record.sides is not None and set(np.unique(record.sides)) <= {-1, 0, 1}
    assert not setup.by_rotation


def test_a_change_of_side_that_was_not_read_falls_anywhere_in_the_gap(truth) -> None:
    """Readings that are left out for 0.02 s about each impact: the rotation there is known to how far the block turns
    meanwhile, and the model with the true parameters bears it."""
    campaign, rotations = truth
    tests, gap = [], 4
    for test, rotation in zip(campaign.tests, rotations, strict=True):
        impacts = np.flatnonzero(np.diff(np.sign(rotation)) != 0)
        out = np.zeros(rotation.size, dtype=bool)
        for k in impacts[np.abs(np.gradient(rotation, STEP)[impacts]) > 0.05]:
            out[k - 1 : k - 1 + gap] = True
        data = {name: np.where(out & (name != "base_x"), np.nan, x) for name, x in test.data.items()}
        tests.append(replace(test, data=data))
    setup = prepare(replace(campaign, tests=tuple(tests)), LoopModel(DECLARED, 0.9, {}, STANDARD_GRAVITY))
    for record, rotation in zip(setup.records, rotations, strict=True):
        side = record.channels.index(SIDE)
        [told] = np.nonzero(np.isfinite(record.observed[side]))
        # The speeds of small swings, which last for few samples, are known but roughly.
        fast = told[np.abs(np.gradient(rotation, STEP)[told]) > 0.2]
        assert fast.size > 3
        off = (record.observed[side, fast] - rotation[fast]) / record.noises[side, fast]
        assert np.max(np.abs(off)) < math.sqrt(3.0)  # the half width of what is as likely everywhere
    model = setup.start.changed(
        {"restitution": TRUE_E, "gravity": TRUE_G, **{f"mounting.{k}": v for k, v in MOUNTED.items()}}
    )
    assert fit(setup.simulator, model, [], setup.swings, iterations=6).rms < 1.03


def test_a_campaign_without_a_response_is_refused(truth) -> None:
    campaign = truth[0]
    bare = Campaign(
        "", DECLARED, Conditions(), (BASE,),
        (Test("forced-0", "forced", campaign.tests[3].time, (BASE,), {"base_x": campaign.tests[3].data["base_x"]}),),
    )  # fmt: skip
    with pytest.raises(CampaignError, match="rotation channel or accelerometers on the block"):
        prepare(bare, LoopModel(DECLARED, 0.9))


# With the rotation measured too, the same truth stands behind all channels, and the fit has to leave their noise.
def test_accelerometers_beside_a_rotation_are_calibrated_with_it(truth) -> None:
    rng, rotation = np.random.default_rng(8), Channel("rotation", "rotation", 2e-4)
    tests = []
    for test, theta in zip(truth[0].tests, truth[1], strict=True):
        data = {**test.data, "rotation": theta + 2e-4 * rng.standard_normal(theta.size)}
        tests.append(replace(test, channels=(rotation, *test.channels), data=data))
    campaign = replace(truth[0], channels=(rotation, *truth[0].channels), tests=tuple(tests))
    setup = prepare(campaign, LoopModel(DECLARED, 0.9, {}, TRUE_G))
    assert setup.by_rotation
    found = baseline(setup.simulator, setup.start, setup.swings)
    assert 0.95 < found.swing.rms < 1.05
    for name, angle in MOUNTED.items():
        assert found.swing.model.mountings[name] == pytest.approx(angle, abs=2e-3)
