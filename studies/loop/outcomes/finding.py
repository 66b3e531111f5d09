"""What was found in outcomes, and `loop.json` from it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from rocking.effects import load
from studies.loop.models.model import DRIFT, LoopModel
from studies.loop.outcomes.candidates import UNSEEN
from studies.loop.outcomes.data import OutcomeData
from studies.loop.outcomes.likelihood import Array, Bools, Noise
from studies.loop.outcomes.search import Round, Search, Tried
from studies.running.json_values import json_values

METRIC = "share of outcomes predicted wrong"

Verdict = Literal["effect", "none", "unexplained"]

STAGES = ("declared", "before", "after")


@dataclass(frozen=True)
class Stage:
    """A model, its noise, and its probability of falling in each test of the data, from whole records."""

    model: LoopModel
    noise: Noise
    probability: Array  # shape (test,)

    @property
    def falls(self) -> Bools:
        """The more probable outcome, shape (test,)."""
        return self.probability > 0.5

    def wrong(self, data: OutcomeData) -> Bools:
        """Where that is not what was noted, shape (test,)."""
        return np.asarray(self.falls != data.fell)


@dataclass(frozen=True)
class OutcomeFinding:
    """What closing the loop on outcomes found."""

    data: OutcomeData
    search: Search
    verdict: Verdict
    stages: dict[str, Stage]  # declared, before, after
    base: Tried
    chosen: Tried
    rivals: tuple[Tried, ...]  # the chosen first, then those that cannot be told apart
    rival_errors: dict[tuple[str, ...], float]  # share wrong of held-out tests, by forms
    rounds: tuple[Round, ...]
    intervals: dict[str, tuple[float, float, float]]
    indistinguishable: tuple[tuple[str, ...], ...]
    floor: dict[str, float]  # fit, holdout: share that the model after would miss if it were true
    structure: float  # how often the floor alone gives as many wrong fitted tests
    notes: tuple[str, ...]
    next_test: str

    def error(self, stage: str) -> dict[str, float]:
        """Share wrong of the fitted tests and of those held out."""
        wrong = self.stages[stage].wrong(self.data)
        return {"fit": float(wrong[~self.data.held].mean()), "holdout": float(wrong[self.data.held].mean())}

    def standard_error(self, stage: str) -> float:
        """Standard error of the held-out share, motions taken as the independent facts."""
        data, wrong = self.data, self.stages[stage].wrong(self.data).astype(float)
        groups = np.unique(data.group[data.held])
        if groups.size < 2:
            return math.nan
        mean = wrong[data.held].mean()
        sums = np.array([(wrong[data.group == g] - mean).sum() for g in groups])
        return float(math.sqrt(groups.size / (groups.size - 1) * np.sum(sums**2)) / data.held.sum())


def as_json(finding: OutcomeFinding) -> dict[str, Any]:
    """The finding as plain values."""
    parameters = {}
    for name, (value, low, high) in finding.intervals.items():
        effect, _, parameter = name.partition(".")
        if parameter or name == DRIFT:  # a restitution that drifts is learned, and of no effect's own parameters
            units = load(effect).units.get(parameter, "1") if parameter else "1"
            parameters[name] = {"value": value, "low": low, "high": high, "units": units, "level": 0.95}
    data, after = finding.data, finding.stages["after"]
    return {
        "verdict": finding.verdict,
        "effects": list(dict.fromkeys(finding.chosen.effects)),
        "parameters": parameters,
        "indistinguishable": [list(names) for names in finding.indistinguishable],
        "error": {
            "metric": METRIC,
            "units": "1",
            "noise_floor": finding.floor["holdout"],
            **{stage: finding.error(stage) for stage in STAGES},
            "holdout_standard_error": {stage: json_values(finding.standard_error(stage)) for stage in STAGES},
        },
        "candidates": candidate_rows(finding),
        "restitution": after.model.restitution,
        "strength_spread": after.noise.spread,
        "error_rate": after.noise.error_rate,
        "chance": [tried.chance for tried in finding.rounds],
        "held_out": [test.id for test, held in zip(data.tests, data.held, strict=True) if held],
        "notes": list(finding.notes),
        "next_test": finding.next_test,
    }


def deciding(finding: OutcomeFinding) -> Round:
    """The round in which what was chosen was compared; the first where nothing was."""
    own = finding.chosen.names
    return next((r for r in finding.rounds if any(t.names == own for t in r.refined)), finding.rounds[0])


def candidate_rows(finding: OutcomeFinding) -> list[dict[str, Any]]:
    """What was tried, in the round that decided and in the others; what it was tried beside.

    Evidence is the gain of twice the log-likelihood, with the price of the parameters taken off.
    """
    last = deciding(finding)
    rows = _rows(finding, last)
    for other in finding.rounds:
        rows += [] if other is last else _rows(finding, other)
    for form, why in UNSEEN.items():
        rows.append(_not_refitted(last, form, why))
    return rows


def _not_refitted(tried: Round, form: str, why: str) -> dict[str, Any]:
    return {
        "effect": form.partition("[")[0], "form": form, "beside": list(tried.onto.names), "holdout_error": None,
        "evidence": None, "not_refitted": why,
    }  # fmt: skip


def _rows(finding: OutcomeFinding, one: Round) -> list[dict[str, Any]]:
    """What was tried in one round, the best first."""
    search = finding.search
    settled = {t.names[-1]: t for t in one.refined}
    rows: list[dict[str, Any]] = []
    for form, tried in one.first.items():
        row: dict[str, Any] = {
            "effect": tried.effects[-1], "form": form, "beside": list(one.onto.names), "holdout_error": None,
        }  # fmt: skip
        if form in settled:
            row["evidence"] = search.criterion(settled[form]) - search.criterion(one.onto)
            own = settled[form].names == finding.chosen.names
            row["holdout_error"] = (
                finding.error("after")["holdout"] if own else finding.rival_errors.get(settled[form].names)
            )
        else:
            # Runs at the nominal strength alone, for both.
            gain = 2.0 * (tried.points[0].value - one.onto.points[0].value)
            row["evidence"] = gain - search.price(len(tried.parameters) - len(one.onto.parameters))
        rows.append(row)
    rows.sort(key=lambda row: -row["evidence"])
    return rows + [_not_refitted(one, form, why) for form, why in one.skipped.items()]
