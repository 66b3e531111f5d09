"""`loop.json`: the finding in numbers, for whoever scripts the loop."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from studies.loop.closing import Finding
from studies.loop.models.model import DRIFT, FADING, MOUNTING
from studies.loop.models.names import parameter_units
from studies.running.files import save_text
from studies.running.json_values import json_values

REFUSED = "whole records speak against it"
"""Why a trial that swings would have taken is no rival."""


def as_json(finding: Finding, next_test: str) -> dict[str, Any]:
    """The finding as plain values; NaN becomes null."""
    parameters = {}
    for name, (value, low, high) in finding.intervals.items():
        effect, _, parameter = name.partition(".")
        # A restitution that drifts from test to test is learned, and of no effect's own parameters.
        if (parameter and effect != MOUNTING) or name in (DRIFT, FADING):
            parameters[name] = {
                "value": value,
                "low": low,
                "high": high,
                "units": parameter_units(name),
                "level": 0.95,
            }
    errors = {name: {"fit": e.fit, "holdout": e.holdout} for name, e in finding.errors.items()}
    content = {
        "verdict": finding.verdict,
        "effects": list(dict.fromkeys(finding.chosen.effects)),
        "parameters": parameters,
        "indistinguishable": [list(names) for names in finding.indistinguishable],
        "error": {
            "metric": finding.metric,
            "units": finding.units,
            "noise_floor": finding.noise_floor,
            **errors,
        },
        "candidates": _candidates(finding),
        "restitution": finding.after.restitution,
        "mountings": dict(finding.after.mountings),
        "held_out": [finding.setup.campaign.tests[i].id for i in finding.setup.held],
        "notes": list(finding.notes),
        "next_test": next_test,
    }
    plain: dict[str, Any] = json_values(content)
    return plain


def _candidates(finding: Finding) -> list[dict[str, Any]]:
    """What was tried in the place of each effect: held-out error where it was computed, fall of chi-square.

    Those that explained most come first, those that whole records refused last.
    """
    rivals = {frozenset(r.trial.names): r for r in finding.rivals}
    rows: list[dict[str, Any]] = []
    for tried in finding.deciding:
        beside = list(tried.onto.names)
        for t, refused in tried.tried:
            rival = rivals.get(frozenset(t.names))
            part = tried.added(t)
            rows.append(
                {
                    "effect": part.effect,
                    "form": part.name,
                    "beside": beside,
                    "holdout_error": rival and rival.holdout,
                    "evidence": tried.onto.swing.chi2 - t.swing.chi2,
                    "criterion": rival and rival.criterion,
                    "whole_criterion": rival and rival.whole_criterion,
                    **({"refused": REFUSED} if refused else {}),
                }
            )
        rows += [
            {
                "effect": name.partition("[")[0], "form": name, "beside": beside, "holdout_error": None,
                "evidence": None, "not_refitted": why,
            }
            for name, why in tried.skipped.items()
        ]  # fmt: skip
    by_evidence = sorted(rows, key=lambda row: -(row["evidence"] if row["evidence"] is not None else -math.inf))
    return sorted(by_evidence, key=lambda row: "refused" in row)


def write_finding(content: dict[str, Any], path: Path) -> None:
    """Write loop.json, whole or not at all."""
    save_text(json.dumps(content, indent=1) + "\n", path)
