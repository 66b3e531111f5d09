"""`loop.nc`: per test what was measured and what the model gives before and after, with the residuals; the candidates.

    tree = xarray.open_datatree("loop.nc")
    tree["tests/free-01"].rotation_residual_after

Groups   `tests/<id>` (an id that cannot name a group in a file is altered; the attribute `id` has it as it was),
         `candidates`, `parameters`.
"""

from __future__ import annotations

import math
import re
import unicodedata
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from studies.campaigns import Test
from studies.loop.closing import Finding
from studies.loop.dataset_residuals import by_impact, by_stretch, of_onset
from studies.loop.models.model import LoopModel
from studies.loop.models.names import parameter_units
from studies.loop.observed.instruments import accelerations
from studies.loop.observed.windows import Record
from studies.loop.records.scoring import leaning
from studies.loop.runs.simulation import Answer, Job, Simulator
from studies.running.files import provenance, write_whole

STAGES = ("before", "after")
HELD_OUT, FITTED, UNUSED = "held out", "fitted", "not used"


def dataset(finding: Finding) -> xr.DataTree:
    """Everything that was compared, as a tree of datasets with units; see the module."""
    campaign = finding.setup.campaign
    records = {record.test: record for record in finding.setup.records}
    answers = _answers(finding)
    names = group_names([test.id for test in campaign.tests])
    groups: dict[str, xr.Dataset] = {"/": _root(finding), "/tests": xr.Dataset()}
    for k, test in enumerate(campaign.tests):
        data = _of_test(finding, test, k, records.get(k), answers.get(k, ()))
        groups[f"/tests/{names[k]}"] = data
    groups["/parameters"] = _parameters(finding)
    groups["/candidates"] = candidates(finding)
    return xr.DataTree.from_dict(groups)


def save(tree: xr.DataTree, path: Path) -> None:
    """Write the tree as NetCDF-4, whole or not at all."""
    packed = {
        node.path: {
            str(name): {"zlib": True} for name, v in node.data_vars.items() if v.ndim and v.dtype.kind in "fi"
        }
        for node in tree.subtree
    }  # fmt: skip
    write_whole(path, lambda target: tree.to_netcdf(target, engine="netcdf4", encoding=packed))


def group_names(ids: list[str]) -> list[str]:
    """Names of groups for the ids, each once: NetCDF wants a letter, a digit or an underscore first, and NFC."""
    names: list[str] = []
    for id in ids:
        name = unicodedata.normalize("NFC", id)
        if not re.match(r"[A-Za-z0-9_]", name):
            name = f"_{name}"
        while name in names:
            name = f"{name}_"
        names.append(name)
    return names


def role(finding: Finding, test: int) -> str:
    """What a test was used for."""
    if test in finding.setup.held:
        return HELD_OUT
    return FITTED if any(record.test == test for record in finding.setup.records) else UNUSED


def _answers(finding: Finding) -> dict[int, tuple[Answer, Answer]]:
    """Whole runs before and after at all samples of each test that has a record, from its fitted or measured lean."""
    setup = finding.setup
    jobs: dict[int, list[Job]] = {}
    for k, fit in enumerate((finding.before_fit, finding.after_fit)):
        for w in (*fit.windows, *leaning(setup, fit.model, setup.whole_held)):
            time = np.ascontiguousarray(setup.campaign.tests[w.test].time)
            jobs.setdefault(w.test, []).append(Job(k, w.test, time, w.start, w.theta, w.omega, struck=w.struck))
    every = [job for test in jobs for job in jobs[test]]
    found = setup.recorded.run([finding.before, finding.after], every)
    return {test: (found[2 * k], found[2 * k + 1]) for k, test in enumerate(jobs)}


def _variable(dims: str, values: Any, units: str, long_name: str, **more: Any) -> tuple[str, Any, dict[str, Any]]:
    return dims, values, {"units": units, "long_name": long_name, **more}


def _of_test(
    finding: Finding, test: Test, index: int, record: Record | None, answers: tuple[Answer, ...]
) -> xr.Dataset:
    models = (finding.before, finding.after)
    data: dict[str, Any] = {}
    for axis, base in (("x", test.base_x), ("z", test.base_z)):
        if base is not None:
            text = "recorded acceleration of the base, " + ("horizontal" if axis == "x" else "vertical")
            data[f"base_acceleration_{axis}"] = _variable("time", base, "m s-2", text)
    if test.rotation is not None:
        data["rotation"] = _variable("time", test.rotation, "rad", "measured rotation")
    if record is not None and answers:
        data |= _sensors(finding, record, models, answers) | _errors(finding, test)
        if finding.setup.by_rotation:
            data |= _rotations(finding.setup.recorded, record, models, answers)
            parts = (
                by_stretch(finding, record),
                by_impact(finding, record),
                of_onset(finding, record, models, answers),
            )
            data |= {name: v for part in parts for name, v in part.items()}
        else:
            data |= _unmeasured_rotations(record, models, answers)
    time = _variable("time", test.time, "s", "time")
    attributes = {"id": test.id, "kind": test.kind, "role": role(finding, index), "number": index + 1}
    if test.motion is not None:
        attributes["motion"] = test.motion
    if test.overturned is not None:
        attributes["overturned"] = int(test.overturned)
    return xr.Dataset(data, {"time": time}, attributes)


def _rotations(
    simulator: Simulator, record: Record, models: tuple[LoopModel, LoopModel], answers: tuple[Answer, ...]
) -> dict[str, Any]:
    """Readings of the rotation sensor before and after, residuals where the record is used, and their rms."""
    out: dict[str, Any] = {}
    for stage, model, answer in zip(STAGES, models, answers, strict=True):
        reading = simulator.recorded(model, record.test, answer.theta)
        residual = record.rotation - reading
        fallen = "+-pi/2 after a fall"
        out[f"rotation_{stage}"] = _variable("time", reading, "rad", f"rotation of the model {stage}", comment=fallen)
        out[f"rotation_residual_{stage}"] = _variable(
            "time", residual, "rad", f"measured less modelled rotation, {stage}",
            comment="missing where the record is missing, on a rail, or after a fall",
        )  # fmt: skip
    out["rotation_noise"] = ((), record.noise, {"units": "rad", "long_name": "standard deviation of the sensor"})
    return out


def _unmeasured_rotations(
    record: Record, models: tuple[LoopModel, LoopModel], answers: tuple[Answer, ...]
) -> dict[str, Any]:
    """Rotations of the models, and what accelerometers say of the rotation through the ideal block."""
    text = "rotation as accelerometers show it through the calibrated ideal block"
    out: dict[str, Any] = {"rotation_estimate": _variable("time", record.rotation, "rad", text)}
    for stage, answer in zip(STAGES, answers, strict=True):
        out[f"rotation_{stage}"] = _variable("time", answer.theta, "rad", f"rotation of the model {stage}")
    return out


def _errors(finding: Finding, test: Test) -> dict[str, Any]:
    """Rms of the residual in the campaign's own channel."""
    return {
        f"error_{stage}": (
            (), finding.errors[stage].by_test.get(test.id, math.nan),
            {"units": finding.units.replace("/s^2", " s-2"), "long_name": f"rms of the residual, {stage}"},
        )
        for stage in STAGES
    }  # fmt: skip


def _sensors(
    finding: Finding, record: Record, models: tuple[LoopModel, LoopModel], answers: tuple[Answer, ...]
) -> dict[str, Any]:
    """Accelerometers on the block, measured and modelled."""
    out: dict[str, Any] = {}
    there = [c for c in record.channels if c.kind == "block_acceleration"]
    for number, channel in enumerate(there, 1):
        name, about = f"block_acceleration_{number}", {"channel": channel.name}
        measured = record.recorded[record.channels.index(channel)]
        out[name] = _variable("time", measured, "m s-2", "measured acceleration on the block", **about)
        noise = float(record.noises[record.channels.index(channel), 0])
        out[f"{name}_noise"] = ((), noise, {"units": "m s-2", "long_name": "standard deviation of the sensor"})
        for stage, model, answer in zip(STAGES, models, answers, strict=True):
            reading = accelerations(model, finding.setup.recorded, record.test, answer, channel)
            text = "acceleration on the block"
            out[f"{name}_{stage}"] = _variable("time", reading, "m s-2", f"{text} of the model {stage}", **about)
            out[f"{name}_residual_{stage}"] = _variable(
                "time", measured - reading, "m s-2", f"measured less modelled {text}, {stage}", **about
            )
    return out


def _root(finding: Finding) -> xr.Dataset:
    campaign = finding.setup.campaign
    attributes = provenance(campaign.title, "python -m studies.loop CAMPAIGN.toml --out DIR") | {
        "verdict": finding.verdict,
        "effects": ", ".join(finding.chosen.effects),
        "noise_floor": finding.noise_floor,
        "compared": "rotation" if finding.setup.by_rotation else "block_acceleration_1",
        "error_units": finding.units,
    }
    return xr.Dataset(attrs=attributes)


def _parameters(finding: Finding) -> xr.Dataset:
    """Fitted parameters of the model after, with their intervals."""
    names = list(finding.intervals)
    values = np.array([finding.intervals[name] for name in names], dtype=np.float64).reshape(-1, 3)
    texts = ("fitted value", "lower end of the 95 % interval", "upper end of the 95 % interval")
    data: dict[str, Any] = {
        key: _variable("parameter", values[:, k], "see unit", text)
        for k, (key, text) in enumerate(zip(("value", "low", "high"), texts, strict=True))
    }
    units = [parameter_units(name) for name in names]
    data["unit"] = ("parameter", _texts(units), {"long_name": "unit of the parameter"})
    return xr.Dataset(data, {"parameter": ("parameter", _texts(names))})


def _texts(values: list[str]) -> NDArray[np.object_]:
    return np.array(values, dtype=object)


def candidates(finding: Finding) -> xr.Dataset:
    """Scores and evidence of each form of an effect in each round; NaN where it was not tried."""
    rounds = finding.every_round
    forms = list(dict.fromkeys(f for r in rounds for f in (*(r.added(t).name for t, _ in r.tried), *r.skipped)))
    shape = (len(rounds), len(forms))
    evidence, score, held = np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape, np.nan)
    reason, refused = np.full(shape, "", dtype=object), np.zeros(shape, dtype=bool)
    holdout = {frozenset(rival.trial.names): rival.holdout for rival in finding.rivals}
    for i, tried in enumerate(rounds):
        for trial, set_aside in tried.tried:
            j = forms.index(tried.added(trial).name)
            evidence[i, j] = tried.onto.swing.chi2 - trial.swing.chi2
            score[i, j], held[i, j] = trial.score, holdout.get(frozenset(trial.names), math.nan)
            refused[i, j] = set_aside
        for form, why in tried.skipped.items():
            reason[i, forms.index(form)] = why
    two = ("round", "form")
    data = {
        "evidence": (two, evidence, {"units": "1", "long_name": "fall of chi-square in the refit over swings"}),
        "score": (two, score, {"units": "1", "long_name": "fall of chi-square to first order, before the refit"}),
        "holdout_error": (two, held, {"units": finding.units, "long_name": "median rms error over held-out tests"}),
        "not_refitted": (two, reason, {"long_name": "why it was not refitted"}),
        "refused": (
            two,
            refused,
            {"long_name": "whether swings would have taken it and whole records speak against it"},
        ),
        "onto": ("round", _texts([", ".join(r.onto.names) for r in rounds]), {"long_name": "effects there already"}),
        "effect": ("form", _texts([form.partition("[")[0] for form in forms]), {"long_name": "name of the effect"}),
    }
    return xr.Dataset(data, {"round": np.arange(1, len(rounds) + 1), "form": _texts(forms)})
