"""`loop.nc` of a campaign of outcomes: who fell, the probability of it by each model, and every candidate.

    tree = xarray.open_datatree("loop.nc")
    tree["tests"].probability_after

Groups   `tests` (dimension test), `candidates` (round, form), `parameters`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from studies.loop.models.names import parameter_units
from studies.loop.outcomes.finding import METRIC, STAGES, OutcomeFinding
from studies.running.files import provenance

COMMAND = "python -m studies.loop CAMPAIGN.toml --out DIR"


def dataset(finding: OutcomeFinding) -> xr.DataTree:
    """Everything that was compared, as a tree of datasets with units; see the module."""
    return xr.DataTree.from_dict(
        {"/": _root(finding), "/tests": _tests(finding), "/candidates": _candidates(finding),
         "/parameters": _parameters(finding)}
    )  # fmt: skip


def _root(finding: OutcomeFinding) -> xr.Dataset:
    attributes = provenance(finding.data.campaign.title, COMMAND) | {
        "verdict": finding.verdict,
        "effects": ", ".join(finding.chosen.effects),
        "metric": METRIC,
        "noise_floor": finding.floor["holdout"],
    }
    return xr.Dataset(attrs=attributes)


def _texts(values: list[str]) -> NDArray[np.object_]:
    return np.array(values, dtype=object)


def _tests(finding: OutcomeFinding) -> xr.Dataset:
    data = finding.data
    peak = [math.nan if t.base_x is None else float(np.nanmax(np.abs(t.base_x))) for t in data.tests]
    columns: dict[str, Any] = {
        "overturned": ("test", data.fell, {"long_name": "whether the block fell, as noted"}),
        "motion": ("test", _texts([t.motion or t.id for t in data.tests]), {"long_name": "name of the base motion"}),
        "held_out": ("test", data.held, {"long_name": "whether neither fit nor choice saw it"}),
        "peak_acceleration": (
            "test", np.array(peak), {"units": "m s-2", "long_name": "largest recorded horizontal base acceleration"},
        ),
        "peak_velocity": (
            "test", np.array([peak_velocity(t) for t in data.tests]),
            {"units": "m s-1", "long_name": "largest horizontal base velocity", "comment": "record high-passed"},
        ),
    }  # fmt: skip
    for stage in STAGES:
        p = finding.stages[stage].probability
        text = f"probability of falling by the model {stage}"
        columns[f"probability_{stage}"] = ("test", p, {"units": "1", "long_name": text})
    return xr.Dataset(columns, {"test": ("test", _texts([t.id for t in data.tests]))})


HIGH_PASS = 0.1
"""Hz below which a recorded acceleration says nothing of the velocity."""


def peak_velocity(test: Any) -> float:
    """Largest base velocity [m/s] from the recorded acceleration, slow drift taken out; NaN without a base record."""
    if test.base_x is None:
        return math.nan
    a = np.nan_to_num(test.base_x - np.nanmean(test.base_x))
    # Twice as long, so that the end of a record does not run into its beginning.
    n = 2 * a.size
    f = np.fft.rfftfreq(n, test.time_step)
    spectrum = np.fft.rfft(a, n)
    gain = (f / HIGH_PASS) ** 4 / (1.0 + (f / HIGH_PASS) ** 4)
    v = np.fft.irfft(np.divide(spectrum * gain, 2j * np.pi * f, out=np.zeros_like(spectrum), where=f > 0.0), n)
    return float(np.max(np.abs(v[: a.size])))


def _parameters(finding: OutcomeFinding) -> xr.Dataset:
    names = list(finding.intervals)
    values = np.array([finding.intervals[name] for name in names], dtype=np.float64).reshape(-1, 3)
    texts = ("fitted value", "lower end of the 95 % interval", "upper end of the 95 % interval")
    columns: dict[str, Any] = {
        key: ("parameter", values[:, k], {"units": "see unit", "long_name": text})
        for k, (key, text) in enumerate(zip(("value", "low", "high"), texts, strict=True))
    }
    units = _texts([parameter_units(name) for name in names])
    columns["unit"] = ("parameter", units, {"long_name": "unit of the parameter"})
    return xr.Dataset(columns, {"parameter": ("parameter", _texts(names))})


def _candidates(finding: OutcomeFinding) -> xr.Dataset:
    rounds = finding.rounds
    names = list(dict.fromkeys(form for r in rounds for form in (*r.first, *r.skipped)))
    value = np.full((len(rounds), len(names)), np.nan)
    every, settled = value.copy(), value.copy()
    reason = np.full(value.shape, "", dtype=object)
    for i, tried in enumerate(rounds):
        for form, one in tried.first.items():
            value[i, names.index(form)] = one.points[0].value
        for one in tried.refined:
            every[i, names.index(one.names[-1])] = finding.search.criterion(one) - finding.search.criterion(tried.onto)
            settled[i, names.index(one.names[-1])] = finding.rival_errors.get(one.names, math.nan)
        for form, why in tried.skipped.items():
            reason[i, names.index(form)] = why
    two = ("round", "form")
    texts = {
        "log_likelihood": (value, "largest log-likelihood of the fitted outcomes, each motion at its strength"),
        "evidence": (every, "gain of twice the log-likelihood at all strengths, parameters priced"),
        "holdout_error": (settled, "share of held-out outcomes predicted wrong"),
    }
    columns: dict[str, Any] = {k: (two, v, {"units": "1", "long_name": text}) for k, (v, text) in texts.items()}
    columns |= {
        "not_tried": (two, reason, {"long_name": "why it could not be tried"}),
        "chance": (
            "round", np.array([tried.chance for tried in rounds]),
            {"units": "1", "long_name": "share of outcomes drawn from the model below in which as much is gained"},
        ),
        "onto": ("round", _texts([", ".join(r.onto.names) for r in rounds]), {"long_name": "effects there already"}),
    }  # fmt: skip
    return xr.Dataset(columns, {"round": np.arange(1, len(rounds) + 1), "form": _texts(names)})
