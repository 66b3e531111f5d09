"""What a loop found against what was planted.

Reads loop.json and the predictions of later tests; knows nothing of how the loop works.  A figure that the loop did
not leave is None, and a malformed loop.json is an error, not a low mark.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from .prediction import rms, rms_of_accelerations
from .truth import Truth

VERDICTS = ("effect", "none", "unexplained")
OVERLARGE_SET = 5  # effects in one set of indistinguishable ones: no answer any more


def tracing(effects: Iterable[str], sets: Iterable[Iterable[str]], truth: Truth) -> str:
    """How the planted effects were found.

    "exact": named as they are; "twin": by one that counts as the same; "set": told apart from all but those that the
    loop says it cannot tell apart; "part": some of several; "no".  Effects without a name are not counted.
    """
    named = set(effects)
    wanted = {e for e in truth.effects if any(e in a for a in truth.accepted)}
    if named == wanted:
        return "exact"
    if any(named == set(a) for a in truth.accepted):
        return "twin"
    groups = [set(s) for s in sets if len(set(s)) < OVERLARGE_SET]

    def same(one: str, other: str) -> bool:
        return one == other or any({one, other} <= g for g in groups)

    answered = [w for w in wanted if any(same(w, n) for n in named)]
    surplus = [n for n in named if not any(same(w, n) for w in wanted)]
    if wanted and len(answered) == len(wanted) and not surplus:
        return "set"
    return "part" if answered else "no"


def coverage(found: dict[str, Any], truth: Truth) -> dict[str, dict[str, float | bool]]:
    """Of each true parameter that the loop gives: whether its interval covers it, relative error and half width."""
    report: dict[str, dict[str, float | bool]] = {}
    for name, true in truth.parameters.items():
        if name not in found:
            continue
        value, low, high = (float(found[name][k]) for k in ("value", "low", "high"))
        scale = abs(true) if true else 1.0
        # A gain of 1.02 is a departure of 0.02.
        if name.endswith("_gain.gain"):
            scale = abs(true - 1.0)
        report[name] = {
            "covered": low <= true <= high,
            "error": (value - true) / scale,
            "half_width": 0.5 * (high - low) / scale,
        }
    return report


def _series(path: Path) -> dict[str, np.ndarray]:
    values = np.genfromtxt(path, delimiter=",", names=True)
    return {name: np.atleast_1d(values[name]) for name in values.dtype.names or ()}


def predicted_errors(folder: Path, truth: Truth) -> dict[str, float]:
    """Error of each predicted test in the campaign's own channel, against the noise-free truth."""
    errors = {}
    for id, true in truth.hidden.items():
        model = _series(folder / f"{id}.csv")
        if model["time"].size != true["time"].size:
            raise ValueError(f"{id}: {model['time'].size} samples predicted, want {true['time'].size}")
        if truth.channel == "rotation":
            errors[id] = rms(model["rotation"], true["rotation"])
            continue
        errors[id] = rms_of_accelerations(model, true)
    return errors


def _overturned(folder: Path) -> dict[str, bool]:
    """predict.json, whichever way it nests the tests."""
    table = json.loads((folder / "predict.json").read_text(encoding="utf-8"))
    tests = table.get("tests", table)
    if isinstance(tests, list):
        tests = {t["id"]: t for t in tests}
    return {id: bool(t["overturned"]) for id, t in tests.items() if isinstance(t, dict) and "overturned" in t}


def _median_error(folder: Path | None, truth: Truth) -> float | None:
    if folder is None or not folder.exists():
        return None
    if truth.channel == "outcome":
        said = _overturned(folder)
        return float(np.mean([said[id] != fell for id, fell in truth.overturned.items()]))
    return float(np.median(list(predicted_errors(folder, truth).values())))


def _ratio(a: float | None, b: float | None) -> float | None:
    return None if a is None or not b else a / b


def judge(loop_dir: Path, truth: Truth, predict: Path | None = None, baseline: Path | None = None) -> dict[str, Any]:
    """All figures of one run.

    Args:
        loop_dir: what `python -m studies.loop CAMPAIGN --out` wrote.
        truth: of the campaign.
        predict, baseline: what `predict` wrote for model.toml and baseline.toml; `loop_dir/predict` and
            `loop_dir/predict-baseline` if not given.

    Raises:
        ValueError: loop.json breaks its format.
    """
    found = json.loads((Path(loop_dir) / "loop.json").read_text(encoding="utf-8"))
    check(found)
    after = _median_error(predict or Path(loop_dir) / "predict", truth)
    before = _median_error(baseline or Path(loop_dir) / "predict-baseline", truth)
    claimed = found["error"]["after"]["holdout"]
    # The loop scores against noisy records, the truth has no noise.
    noisy = None if after is None else (after if truth.channel == "outcome" else math.hypot(after, truth.noise))
    covered = coverage(found["parameters"], truth)
    traced = tracing(found["effects"], found["indistinguishable"], truth)
    if truth.effects and not any(truth.accepted) and found["verdict"] not in truth.verdicts:
        traced = "no"  # nothing to name, but something to see
    true_floor = truth.floor.get("predict")
    return {
        "name": truth.name,
        "truth": "+".join(truth.effects),
        "verdict": found["verdict"],
        "verdict_right": found["verdict"] in truth.verdicts,
        "effects": "+".join(found["effects"]),
        "traced": traced,
        "false_alarm": not truth.effects and found["verdict"] != "none",
        "missed": bool(truth.effects) and found["verdict"] == "none",
        "covered": sum(bool(c["covered"]) for c in covered.values()),
        "parameters": len(covered),
        "worst_parameter_error": max((abs(float(c["error"])) for c in covered.values()), default=None),
        "before": before,
        "after": after,
        "floor": true_floor,
        "after_over_floor": _ratio(after, true_floor),
        "gain": _ratio(before, after),
        "halved": None if before is None or after is None else after <= 0.5 * before,
        "claimed": claimed,
        "claimed_over_true": _ratio(claimed, noisy),
        "claimed_gain": _ratio(found["error"]["before"]["holdout"], claimed),
        "planted_visibility": _ratio(truth.baseline.get("fit"), truth.floor.get("fit")),
    }


def check(found: dict[str, Any]) -> None:
    """ValueError where loop.json lacks a key or says something that cannot be."""
    for key in ("verdict", "effects", "parameters", "indistinguishable", "error", "candidates", "next_test"):
        if key not in found:
            raise ValueError(f"loop.json: lacks {key!r}")
    if found["verdict"] not in VERDICTS:
        raise ValueError(f"loop.json: verdict={found['verdict']!r}, want one of {', '.join(VERDICTS)}")
    if (found["verdict"] == "effect") != bool(found["effects"]) and found["verdict"] != "unexplained":
        raise ValueError(f"loop.json: verdict {found['verdict']!r} with effects {found['effects']}")
    for stage in ("declared", "before", "after"):
        for share in ("fit", "holdout"):
            if not isinstance(found["error"].get(stage, {}).get(share), (int, float)):
                raise ValueError(f"loop.json: error.{stage}.{share} is not a number")
    for name, one in found["parameters"].items():
        if not float(one["low"]) <= float(one["value"]) <= float(one["high"]):
            raise ValueError(f"loop.json: {name}={one['value']} is outside [{one['low']}, {one['high']}]")
