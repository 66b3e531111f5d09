"""The loop's models with the true parameters beside the laboratory, which shares no code with them, on a known base.

What gives or slips is left out: there the two have laws of contact of their own (`studies.laboratory.contact`,
`studies.laboratory.slip`).
"""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import pytest

from studies.campaigns import Channel, DeclaredBlock, Test
from studies.laboratory.effects import NAMED, Draw, Lab
from studies.laboratory.parameters import uniform
from studies.laboratory.plans import Plan, respond
from studies.laboratory.table import Motion, quake, ramp
from studies.loop.models.model import LoopModel
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
    time = np.arange(plan.samples) / RATE
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
    model = LoopModel(BLOCK, RESTITUTION, given, G)
    for id, motion in motions().items():
        plan = Plan(id, "free" if motion is None else "forced", RATE, 1500, lean=0.0 if motion else 0.15, motion=motion)
        test = told(lab, plan)
        simulator = Simulator([test])
        [answer] = simulator.run([model], [Job(0, 0, test.time, 0.0, plan.lean)])
        theirs = lab.sensors.reads(respond(lab, plan).rotation)
        assert np.abs(theirs).max() > 0.01
        off = float(np.sqrt(np.mean((simulator.recorded(model, 0, answer.theta) - theirs) ** 2)))
        assert off < (QUIET if (effect, kind) in OF_THE_RECORD else 0.1 * QUIET), id
