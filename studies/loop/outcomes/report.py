"""`report.html` of a campaign of outcomes: one self-contained page for the person who made the tests.

No script, no font and no picture from elsewhere; every text of the campaign is escaped.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from studies.loop.models.names import OWN, page, parameter_units, readable
from studies.loop.outcomes import figures, text
from studies.loop.outcomes.closing import CHANCE, PAYS
from studies.loop.outcomes.finding import OutcomeFinding, deciding
from studies.loop.outcomes.search import DRAWS
from studies.loop.outcomes.weighing import TWIN
from studies.loop.report.page import TEMPLATE as STYLED
from studies.loop.report.text import number, with_interval
from studies.running.files import write_whole

TEMPLATE = "report.html.jinja"


def report(finding: OutcomeFinding, content: dict[str, Any], tree: xr.DataTree) -> str:
    """The page.

    Args:
        finding: what was found.
        content: of loop.json.
        tree: of loop.nc.
    """
    environment = Environment(
        loader=PackageLoader("studies.loop.outcomes", "."), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    environment.filters |= {"num": _num, "share": _share, "readable": readable}
    return environment.get_template(TEMPLATE).render(_facts(finding, content, tree), style=_style())


def write_report(finding: OutcomeFinding, content: dict[str, Any], tree: xr.DataTree, path: Path) -> None:
    """Write the page, whole or not at all."""
    html = report(finding, content, tree).encode("utf-8")
    write_whole(path, lambda target: target.write_bytes(html))


def _style() -> Markup:
    """The style sheet of the other report: both look alike."""
    environment = Environment(loader=PackageLoader("studies.loop.report", "."), autoescape=True)
    assert environment.loader is not None
    source = environment.loader.get_source(environment, STYLED)[0]
    found = re.search(r"<style>.*?</style>", source, re.DOTALL)
    assert found is not None
    return Markup(found[0])


def _num(value: float | None, units: str = "1", digits: int = 3) -> Markup:
    """A number as it is read, with what it is to the last digit beside it."""
    if value is None or not math.isfinite(value):
        return Markup("–")
    shown = Markup('<data value="{}">{}</data>').format(repr(float(value)), number(value, digits))
    return shown if units == "1" else shown + Markup("&nbsp;{}").format(units)


def _share(value: float | None) -> Markup:
    if value is None or not math.isfinite(value):
        return Markup("–")
    return Markup('<data value="{}">{}</data>').format(repr(float(value)), text.share(value))


def _facts(finding: OutcomeFinding, content: dict[str, Any], tree: xr.DataTree) -> dict[str, Any]:
    campaign, tests = finding.data.campaign, tree["tests"].to_dataset()
    rows = _motions(tests)
    names = [str(row["motion"]) for row in rows]
    return {
        "title": campaign.title or "Untitled campaign",
        "content": content,
        "error": content["error"],
        "block": campaign.block,
        "counts": _counts(finding),
        "verdict": text.verdict(content),
        "twins": text.twins(content),
        "motions": rows,
        "overview": figures.by_motion(tests, names),
        "panels": [
            ("Against the largest base velocity", figures.against(tests, "peak_velocity", "peak velocity [m/s]")),
            ("Against the largest acceleration", figures.against(tests, "peak_acceleration", "peak base [m/s²]")),
            ("Is the probability right?", figures.reliability(tests)),
        ],
        "effects": [_effect(name, content) for name in dict.fromkeys(content["effects"])],
        "calibrated": _calibrated(finding),
        "sure": _sure(finding, content),
        "method": text.method(),
        "candidates": [(row, text.reason(row, content, finding.chosen.names)) for row in content["candidates"]],
        "rounds": [([readable(n) for n in r.onto.names], r.chance) for r in finding.rounds],
        "notes": [*content["notes"], *campaign.warnings],
        "concluded": text.concluded(content),
        "not_concluded": text.not_concluded(content),
        "provenance": dict(tree.attrs),
    }  # fmt: skip


def _counts(finding: OutcomeFinding) -> dict[str, int]:
    data = finding.data
    return {
        "tests": len(data.tests), "fell": int(data.fell.sum()), "motions": int(data.group.max()) + 1,
        "held": int(data.held.sum()), "held_motions": int(np.unique(data.group[data.held]).size),
    }  # fmt: skip


def _motions(tests: xr.Dataset) -> list[dict[str, Any]]:
    """A row for each motion: runs, falls, and how many each model gets wrong; those most wrong after first."""
    rows = []
    for name in dict.fromkeys(str(m) for m in tests.motion.values):
        own = tests.isel(test=np.flatnonzero(tests.motion.values == name))
        fell = own.overturned.values.astype(bool)
        wrong = {s: (own[f"probability_{s}"].values > 0.5) != fell for s in ("before", "after")}
        rows.append(
            {
                "motion": name, "runs": fell.size, "fell": int(fell.sum()), "held": bool(own.held_out.values.any()),
                "before": int(wrong["before"].sum()), "after": int(wrong["after"].sum()),
                "ids": [str(i) for i in own.test.values[wrong["after"]]],
                "low": float(own.peak_velocity.min()), "high": float(own.peak_velocity.max()),
            }
        )  # fmt: skip
    return sorted(rows, key=lambda row: (-row["after"], -row["before"]))


def _effect(name: str, content: dict[str, Any]) -> dict[str, Any]:
    rows = [
        (k.partition(".")[2].replace("_", " "), with_interval(p["value"], p["low"], p["high"]), p["units"])
        for k, p in content["parameters"].items()
        if k.partition(".")[0] == name
    ]
    return {"page": page(name), "parameters": rows, "note": text.EFFECTIVE.get(name, "")}


def _calibrated(finding: OutcomeFinding) -> list[dict[str, Any]]:
    out = []
    for name, meaning in OWN.items():
        if name in finding.intervals:
            after = with_interval(*finding.intervals[name])
            before = finding.stages["before"].model.get(name)
            declared = finding.data.campaign.conditions.restitution if name == "restitution" else None
            out.append({"name": readable(name), "meaning": meaning, "declared": declared, "before": before,
                        "after": after, "units": parameter_units(name)})  # fmt: skip
    return out


def _sure(finding: OutcomeFinding, content: dict[str, Any]) -> list[str]:
    """Facts on which trust can rest, as sentences."""
    counts, error = _counts(finding), content["error"]
    last = deciding(finding)
    tried = len({p.model.restitution for p in finding.base.points}) + sum(
        len(t.points) for r in finding.rounds for t in r.first.values()
    )
    spread = error["holdout_standard_error"]["after"]
    said = [
        f"{counts['held']} of {counts['tests']} tests, all those of {counts['held_motions']} of {counts['motions']} "
        "motions, were held out before anything was fitted. The share wrong among them is "
        f"{text.share(error['after']['holdout'])}"
        + ("" if spread is None else f", give or take {text.share(spread)} (one standard error, by motion)") + ".",
        f"{tried} models were run on all fitted tests. An effect has to have an evidence of {PAYS:g}, and "
        f"outcomes drawn "
        f"{DRAWS} times from the model below may let the best of all that were tried gain as much in at most "
        f"{100 * CHANCE:g} % of the draws"
        + f"; they did in {100 * last.chance:.2g} %.",
        f"Rivals within {TWIN:g} of the best in evidence count as not to be told apart.",
        f"The model after allows for a strength of the motion that is off by a factor of "
        f"{math.exp(content['strength_spread']):.2f} (one standard deviation) and for "
        f"{text.share(content['error_rate'])} "
        "of outcomes that are wrong whatever the strength: what it has to forgive the model to fit the outcomes.",
        "Intervals are 95 %, from weighing the motions anew a thousand times; they hold if the form of the "
        "effect is right.",
    ]  # fmt: skip
    return said
