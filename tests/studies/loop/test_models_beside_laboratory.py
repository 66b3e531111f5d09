"""The loop's models with the true parameters beside the laboratory, which shares no code with them, on a known base.

What gives or slips is left out: there the two have laws of contact of their own (`studies.laboratory.contact`,
`studies.laboratory.slip`).
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studies.campaigns import Channel, DeclaredBlock, Test, read
from studies.laboratory.campaign import make_campaign
from studies.laboratory.effects import NAMED, Draw, Lab
from studies.laboratory.parameters import uniform
from studies.laboratory.plans import Plan, respond
from studies.laboratory.table import Motion, quake, ramp
from studies.loop.models.model import LoopModel
from studies.loop.observed.instruments import accelerations
from studies.loop.prediction import predict
from studies.loop.runs.simulation import Job, Simulator

BLOCK, RESTITUTION, RATE, NOISE, G = DeclaredBlock(0.2, 0.7, 0.3, 30.0), 0.92, 250.0, 0.004, 9.80665
CONTACT = {"compliant_base", "winkler_bed", "bouncing", "sliding"}

QUIET = 1e-4
"""Noise of the quietest sensor of rotation that the laboratory has [rad]: a model may be off by a tenth of it, rms."""

OF_THE_RECORD = {("table_pitch", 0.5), ("vertical_motion", 0.5)}
"""What the base does is a displacement or a harmonic, of which the record alone says less: by as much as that noise."""

CASES = [(effect, 0.5) for effect in sorted(NAMED.keys() - CONTACT)] + [("table_pitch", 0.2), ("vertical_motion", 0.2)]
"""Each effect with the number by which the laboratory draws its kind: that on the acceleration at 0.2."""


def motions() -> dict[str, Motion | None]:
    rng = np.random.default_rng(5)
    return {"release": None, "ramp": ramp(rng, 3.5, 5.0), "quake": quake(rng, 4.2)}


def told(lab: Lab, plan: Plan) -> Test:
    """The test with a base that its sensor, its gain and its clock included, records without noise."""
    time = np.arange(plan.samples) / plan.rate
    if plan.motion is None:
        return Test(plan.id, "free", time, (), {}, initial_rotation=plan.lean)
    base = plan.motion.derivative(2, time - lab.sensors.base_lag) / lab.sensors.base_gain
    return Test(plan.id, "forced", time, (Channel("base_x", "base_acceleration_x", NOISE),), {"base_x": base})


@pytest.mark.parametrize(("effect", "kind"), CASES)
def test_a_model_with_the_true_parameters_does_what_the_laboratory_does(effect: str, kind: float) -> None:
    ideal = Lab(uniform(BLOCK.breadth, BLOCK.height, BLOCK.mass, RESTITUTION))
    lab, parameters = NAMED[effect](ideal, Draw(1.0, 0.5, 0.5, kind), 1.0)
    given: dict[str, dict[str, float]] = defaultdict(dict)
    for name, value in parameters.items():
        given[effect][name] = float(value)
    must_agree(effect, lab, LoopModel(BLOCK, RESTITUTION, given, G), kind)


def must_agree(effect: str, lab: Lab, model: LoopModel, kind: float = 0.5, rate: float = RATE) -> None:
    for id, motion in motions().items():
        how, lean = ("free", 0.15) if motion is None else ("forced", 0.0)
        plan = Plan(id, how, rate, round(6.0 * rate), lean=lean, motion=motion)
        test = told(lab, plan)
        simulator = Simulator([test])
        [answer] = simulator.run([model], [Job(0, 0, test.time, 0.0, plan.lean)])
        theirs = lab.sensors.reads(respond(lab, plan).rotation)
        assert np.abs(theirs).max() > 0.01
        off = float(np.sqrt(np.mean((simulator.recorded(model, 0, answer.theta) - theirs) ** 2)))
        assert off < (QUIET if (effect, kind) in OF_THE_RECORD else 0.1 * QUIET), id


@pytest.mark.parametrize(("share", "arm"), [(0.01, 0.06), (0.05, 0.06), (0.01, 0.3)])
def test_a_mass_that_hangs_does_what_the_laboratory_s_does(share: float, arm: float) -> None:
    """It swings far; what is left of the block has the declared mass, centre and inertia together with it.

    Without damping: the laboratory's is by the air, the model's by the hinge.  Of 0.05 an earthquake that is read at
    250 Hz leaves up to 6e-5 rad, since between samples it is not quite what a spline has there.
    """
    height = 0.2 + arm
    inner, low = share * BLOCK.mass, height - arm
    mass = BLOCK.mass - inner
    centre = (BLOCK.mass * BLOCK.centre_height - inner * low) / mass
    about_floor = BLOCK.I_c + BLOCK.mass * BLOCK.centre_height**2 - inner * low**2
    world = replace(
        uniform(BLOCK.breadth, BLOCK.height, BLOCK.mass, RESTITUTION), mass=mass, centre_height=centre,
        inertia=about_floor - mass * centre**2, slosh_mass=inner, slosh_length=arm, slosh_height=height,
        slosh_damping=0.0,
    )  # fmt: skip
    own = {"mass_ratio": share, "height_ratio": low / BLOCK.centre_height, "damping_ratio": 0.0, "hanging": 1.0}
    own["frequency"] = float(np.sqrt(G / arm)) / (2.0 * np.pi)
    must_agree("slosh", Lab(world), LoopModel(BLOCK, RESTITUTION, {"learned_mode": own}, G), rate=1000.0)


@pytest.mark.parametrize(("share", "arm"), [(0.01, 0.06), (0.02, 0.3)])
def test_a_mass_that_was_not_weighed_is_apart_from_what_is_declared(share: float, arm: float) -> None:
    """It hangs in the laboratory's block over and above the declared mass, centre and inertia.

    Of 0.05 an earthquake in which the block comes to rest and tips again leaves 5e-4 rad, releases and ramps no more
    than here: the two let it rest at different speeds, which the mass goes on with.
    """
    low = 0.2
    world = replace(
        uniform(BLOCK.breadth, BLOCK.height, BLOCK.mass, RESTITUTION), slosh_mass=share * BLOCK.mass, slosh_length=arm,
        slosh_height=low + arm, slosh_damping=0.0,
    )  # fmt: skip
    own = {"mass_ratio": share / (1.0 + share), "height_ratio": low / BLOCK.centre_height, "damping_ratio": 0.0}
    own |= {"frequency": float(np.sqrt(G / arm)) / (2.0 * np.pi), "hanging": 1.0, "apart": 1.0}
    must_agree("slosh", Lab(world), LoopModel(BLOCK, RESTITUTION, {"learned_mode": own}, G), rate=1000.0)


def test_the_floor_of_accelerometers_is_what_a_model_with_the_true_parameters_scores_there(tmp_path: Path) -> None:
    """From the recorded base and the leans as they were set, in their own channel; the median of four tests."""
    truth = make_campaign(4, ["viscous_damping"], tmp_path, channel="block_acceleration")
    campaign = read(tmp_path / "predict" / "campaign.toml")
    given = {"viscous_damping": {"coefficient": truth.parameters["viscous_damping.coefficient"]}}
    model = LoopModel(campaign.block, truth.restitution, given, G, mountings=truth.about["mounting"])
    simulator = Simulator(campaign.tests)
    scores = []
    for k, (test, answer) in enumerate(zip(campaign.tests, predict(model, campaign, simulator), strict=True)):
        sensors = [channel for channel in campaign.channels if channel.kind == "block_acceleration"]
        off = [accelerations(model, simulator, k, answer, c) - truth.hidden[test.id][c.name] for c in sensors]
        scores.append(float(np.sqrt(np.mean(np.square(off)))))
    assert len(sensors) == 3 and min(scores) > 0.0
    assert float(np.median(scores)) == pytest.approx(truth.floor["predict"], rel=1e-3)
    assert truth.baseline["predict"] > truth.floor["predict"]
