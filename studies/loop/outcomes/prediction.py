"""Probability of falling in each test by a model and what is not known, and the files that carry both.

`model.toml` of a campaign of outcomes has a further table:

    [outcomes]        spread [1] of the logarithm of the strength of a motion, error_rate [1]

With it a test is run at several strengths of its motion; the more probable outcome is the predicted one.

Status   without that table a test is run once, and its outcome is that of the run.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from studies.campaigns import Campaign, Test
from studies.campaigns.errors import shown
from studies.campaigns.lost_base import used
from studies.loop.models.model import LoopModel
from studies.loop.models.model_file import ModelError, write_model
from studies.loop.outcomes.data import scaled
from studies.loop.outcomes.likelihood import Array, Noise, probability, weights
from studies.loop.outcomes.runs import FINE, Falls, falls_of
from studies.loop.prediction import write_predictions
from studies.loop.runs.keeping import Keeper
from studies.loop.runs.simulation import Simulator
from studies.running.files import save_text
from studies.running.toml_file import read_toml

SECTION = "outcomes"

LEAST_WEIGHT = 1e-3
"""Strengths that count less than this are not run."""


def falls_at_strengths(
    models: Sequence[LoopModel], spreads: Sequence[float], tests: Sequence[Test], numbers: Sequence[int],
    tell: Callable[[str], None] = lambda text: None, keeper: Keeper | None = None,
) -> Falls:  # fmt: skip
    """Whether each model falls under whole records at each of the strengths, shape (model, strength, test).

    A strength that hardly counts at the spread of a model is not run and taken as the nominal one.
    """
    middle = FINE.index(0.0)
    order = [middle, *(k for k in range(len(FINE)) if k != middle)]
    out = np.zeros((len(models), len(FINE), len(tests)), dtype=bool)
    counts = np.array([weights(FINE, spread) >= LEAST_WEIGHT for spread in spreads])
    for done, k in enumerate(order, 1):
        tell(f"predicting whole records, strength {done} of {len(FINE)}")
        wanted = [i for i in range(len(models)) if k == middle or counts[i, k]]
        if wanted:
            simulator = Simulator([scaled(test, math.exp(FINE[k])) for test in tests], list(numbers), keeper)
            out[wanted, k] = falls_of(simulator, [models[i] for i in wanted])
        for i in set(range(len(models))) - set(wanted):
            out[i, k] = out[i, middle]
    return out


def write_outcome_model(model: LoopModel, noise: Noise, path: Path, title: str) -> None:
    """A model with its noise; the file appears whole or not at all."""
    write_model(model, path, title, {SECTION: asdict(noise)})


def read_noise(path: Path) -> Noise | None:
    """The noise of a model that outcomes were learned from; None for another model.

    Raises:
        ModelError: the table lacks an entry, or it is no number within its range.
    """
    try:
        table = read_toml(path).get(SECTION)
    except ValueError as error:
        raise ModelError(f"{error}; want a model.toml that the loop wrote") from None
    if table is None:
        return None
    ranges = {"spread": (0.0, math.inf), "error_rate": (0.0, 0.5)}
    for key, (low, high) in ranges.items():
        value = table.get(key) if isinstance(table, dict) else None
        if isinstance(value, bool) or not isinstance(value, int | float) or not low < value < high:
            raise ModelError(f"{path}: {SECTION}.{key}={shown(value)}: want a number between {low:g} and {high:g}")
    return Noise(float(table["spread"]), float(table["error_rate"]))


def probabilities(
    model: LoopModel, noise: Noise, campaign: Campaign, tell: Callable[[str], None] = lambda text: None
) -> Array:
    """Probability of falling in each test of a campaign, shape (test,)."""
    found = falls_at_strengths([model], [noise.spread], used(campaign).tests, range(len(campaign.tests)), tell)
    return probability(found[0], FINE, noise)


def write_outcome_predictions(
    model: LoopModel, noise: Noise, campaign: Campaign, folder: Path, tell: Callable[[str], None] = lambda text: None
) -> dict[str, Any]:
    """As `write_predictions`, with the probability of falling; `overturned` is the more probable outcome.

    The rotations, and the time of overturning, are those of the one run with the motion as recorded: where that run
    stands although a fall is the more probable, the time is null.
    """
    summary = write_predictions(model, campaign, folder, tell)
    for test, p in zip(campaign.tests, probabilities(model, noise, campaign, tell), strict=True):
        row = summary[test.id]
        row |= {"overturned": bool(p > 0.5), "probability": float(p)}
        row["time"] = row["time"] if row["overturned"] else None
    save_text(json.dumps({"tests": summary}, indent=1) + "\n", folder / "predict.json")
    return summary
