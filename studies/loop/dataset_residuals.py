"""The residuals of a test as variables of its dataset: torque by stretch, restitution by impact, and the onset."""

from __future__ import annotations

from typing import Any

import numpy as np

from studies.loop.closing import Finding
from studies.loop.models.model import LoopModel
from studies.loop.observed.residual_impacts import at_rest, impacts, modelled_restitution, onset, onset_level
from studies.loop.observed.residual_torque import path, residual_torque, stretches
from studies.loop.observed.windows import Record
from studies.loop.runs.simulation import Answer

Variables = dict[str, Any]


def by_stretch(finding: Finding, record: Record) -> Variables:
    """Residual torque before and after, and where on the path it was found."""
    setup = finding.setup
    parts = stretches(record)
    seen = path(record, setup.campaign.tests[record.test].base_x, parts)
    out: Variables = {
        "stretch_time": _variable("stretch", seen.time, "s", "middle of the stretch"),
        "stretch_rotation": _variable("stretch", seen.theta, "rad", "mean rotation in the stretch"),
        "stretch_angular_velocity": _variable("stretch", seen.omega, "rad s-1", "mean angular velocity in the stretch"),
        "stretch_base_acceleration": _variable(
            "stretch", seen.base_x, "m s-2", "mean recorded horizontal acceleration of the base in the stretch"
        ),
        "stretch_side": _variable("stretch", seen.side, "1", "side to which the block leans"),
    }
    for stage, model in (("before", finding.before), ("after", finding.after)):
        found = residual_torque(model, setup.simulator, record, parts)
        out[f"torque_residual_{stage}"] = _variable(
            "stretch", found.value, "rad s-2", f"torque per moment of inertia beyond that of the model {stage}"
        )
        out[f"torque_residual_sd_{stage}"] = _variable(
            "stretch", found.sd, "rad s-2", "its standard deviation from the noise of the rotation sensor"
        )
    return out


def by_impact(finding: Finding, record: Record) -> Variables:
    """Measured restitution less that of the model, before and after."""
    seen = impacts(record)
    out: Variables = {
        "impact_time": _variable("impact", seen.time, "s", "time of the impact"),
        "impact_side": _variable("impact", seen.side, "1", "side from which the block comes"),
        "impact_speed": _variable("impact", np.abs(seen.omega), "rad s-1", "angular speed before the impact"),
        "restitution": _variable("impact", seen.restitution, "1", "measured restitution"),
        "restitution_sd": _variable("impact", seen.sd, "1", "its standard deviation"),
    }
    for stage, model in (("before", finding.before), ("after", finding.after)):
        e = modelled_restitution(model, finding.setup.simulator, record.test, seen)
        out[f"restitution_residual_{stage}"] = _variable(
            "impact", seen.restitution - e, "1", f"measured restitution less that of the model {stage}"
        )
    return out


def of_onset(
    finding: Finding, record: Record, models: tuple[LoopModel, LoopModel], answers: tuple[Answer, ...]
) -> Variables:
    """When a forced test first moves, measured and modelled; nothing for a free one."""
    if record.kind != "forced":
        return {}
    level = onset_level(record)
    seen = onset(record.time, record.rotation, level, at_rest(record))
    text = f"first passage of {level:.3g} rad"
    out: Variables = {"onset": ((), seen, {"units": "s", "long_name": f"{text}, measured"})}
    for stage, model, answer in zip(("before", "after"), models, answers, strict=True):
        reading = finding.setup.simulator.recorded(model, record.test, answer.theta)
        at_rest_then = float(finding.setup.simulator.in_test(model, record.test).reading(0.0))
        when = onset(record.time, reading, level, at_rest_then)
        out[f"onset_residual_{stage}"] = (
            (), seen - when, {"units": "s", "long_name": f"{text}, measured less modelled, {stage}"}
        )  # fmt: skip
    return out


def _variable(dim: str, values: Any, units: str, long_name: str) -> tuple[str, Any, dict[str, str]]:
    return dim, values, {"units": units, "long_name": long_name}
