"""`report.html`: the finding as one self-contained page, for the person who made the tests.

No script, no font and no picture from elsewhere; every text of the campaign is escaped.  The numbers are those of
loop.json and loop.nc, which the page is made from.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from studies.campaigns import Campaign
from studies.loop.closing import Finding
from studies.loop.finding_file import REFUSED
from studies.loop.models.model import MOUNTING
from studies.loop.models.names import OWN, page, parameter_units, parameter_words, readable
from studies.loop.report import figures, tables, text
from studies.loop.swings.trials import LEAST_GAIN, PAYS, bic
from studies.loop.whole.rivals import TWIN
from studies.running.files import write_whole

TEMPLATE = "report.html.jinja"


def report(finding: Finding, content: dict[str, Any], tree: xr.DataTree) -> str:
    """The page.

    Args:
        finding: what was found.
        content: of loop.json.
        tree: of loop.nc.
    """
    environment = Environment(
        loader=PackageLoader("studies.loop.report", "."), autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True,
    )  # fmt: skip
    environment.filters |= {"num": _num, "evidence": _evidence, "readable": readable}
    return environment.get_template(TEMPLATE).render(_facts(finding, content, tree))


def write_report(finding: Finding, content: dict[str, Any], tree: xr.DataTree, path: Path) -> None:
    """Write the page, whole or not at all."""
    html = report(finding, content, tree).encode("utf-8")
    write_whole(path, lambda target: target.write_bytes(html))


def _num(value: float | None, units: str = "1", digits: int = 3) -> Markup:
    """A number as it is read, with what it is to the last digit beside it."""
    if value is None or not math.isfinite(value):
        return Markup("–")
    shown = Markup('<data value="{}">{}</data>').format(repr(float(value)), text.number(value, digits))
    return shown if units == "1" else shown + Markup("&nbsp;{}").format(units)


def _evidence(value: float | None) -> Markup:
    """A fall of chi-square, likewise."""
    if value is None or not math.isfinite(value):
        return Markup("–")
    return Markup('<data value="{}">{}</data>').format(repr(float(value)), text.evidence(value))


def _interval(value: float, low: float, high: float) -> list[Markup]:
    """A value and the ends of its interval, likewise."""
    shown = text.with_interval(value, low, high)
    every = zip((value, low, high), shown, strict=True)
    return [Markup('<data value="{}">{}</data>').format(repr(float(v)), s) for v, s in every]


def _facts(finding: Finding, content: dict[str, Any], tree: xr.DataTree) -> dict[str, Any]:
    campaign = finding.setup.campaign
    tests = tables.tests_of(tree)
    rows, axis = tables.error_rows(tests)
    telling = tables.telling(tests)
    histories = {ds.attrs["id"]: _history(ds) for ds in tests if "error_before" in ds}
    return {
        "title": campaign.title or "Untitled campaign",
        "content": content,
        "error": content["error"],
        "block": campaign.block,
        "conditions": campaign.conditions,
        "channels": campaign.channels,
        "verdict": text.verdict(content),
        "error_rows": rows,
        "axis": axis,
        "floor_at": None if content["error"]["noise_floor"] is None else axis.at(content["error"]["noise_floor"]),
        "measured": tables.measured_rows(tests, campaign),
        "telling": [histories[id] for id in telling],
        "other": [h for id, h in histories.items() if id not in telling],
        "panels": _panels(tests),
        "onsets": tables.onset_rows(tests),
        "effects": [_effect(name, content) for name in dict.fromkeys(content["effects"])],
        "calibrated": _calibrated(finding, campaign),
        "sure": _sure(finding, content),
        "candidates": [(row, text.reason(row, content, finding.chosen.names)) for row in content["candidates"]],
        "rounds": _rounds(finding),
        "learned": _learned(finding),
        "twins": text.twins(content),
        "notes": [*content["notes"], *campaign.warnings],
        "concluded": text.concluded(content),
        "not_concluded": text.not_concluded(content),
        "provenance": dict(tree.attrs),
    }


def _history(ds: xr.Dataset) -> dict[str, Any]:
    return {
        "id": ds.attrs["id"],
        "kind": ds.attrs["kind"],
        "role": ds.attrs["role"],
        "before": float(ds.error_before),
        "after": float(ds.error_after),
        "wide": figures.history(ds, wide=True),
        "narrow": figures.history(ds, wide=False),
    }


def _gathered(tests: list[xr.Dataset], x: str, kind: str) -> figures.Points:
    """Residuals of a kind over all tests against a variable, or against the attribute `number`."""
    seen = [ds for ds in tests if f"{kind}_residual_before" in ds]
    sd = "restitution_sd" if kind == "restitution" else "torque_residual_sd_before"

    def joined(name: str) -> Any:
        return np.concatenate([np.asarray(ds[name].values, dtype=np.float64) for ds in seen] or [np.zeros(0)])

    against = (
        np.concatenate([np.full(ds[sd].size, float(ds.attrs["number"])) for ds in seen] or [np.zeros(0)])
        if x == "number"
        else joined(x)
    )
    return figures.Points(against, joined(f"{kind}_residual_before"), joined(f"{kind}_residual_after"), joined(sd))


_TORQUE = "residual torque [rad/s²]"
_IMPACT = "residual restitution [1]"
_PANELS = (
    ("torque", "stretch_rotation", "Torque against rotation", "rotation [rad]", False),
    ("torque", "stretch_angular_velocity", "Torque against angular velocity", "angular velocity [rad/s]", False),
    ("torque", "stretch_base_acceleration", "Torque against the base", "base acceleration [m/s²]", False),
    ("restitution", "impact_speed", "Impacts against their speed", "angular speed before [rad/s]", False),
    ("restitution", "impact_side", "Impacts against the side", "side from which it comes (−1 left, +1 right)", True),
    ("restitution", "number", "Impacts against the test", "number of the test, as they were done", True),
    ("torque", "number", "Torque against the test", "number of the test, as they were done", True),
)


def _panels(tests: list[xr.Dataset]) -> list[dict[str, Any]]:
    out = []
    for kind, x, title, x_label, steps in _PANELS:
        points = _gathered(tests, x, kind)
        if not points.there.any() or not np.ptp(points.x[points.there]) > 0.0:
            continue
        y_label = _TORQUE if kind == "torque" else _IMPACT
        out.append(
            {
                "title": title,
                "picture": figures.dependence(points, x_label, y_label, steps=steps),
                "before": points.over_noise("before"),
                "after": points.over_noise("after"),
                "count": int(points.there.sum()),
                "kind": kind,
            }
        )
    return out


def _effect(name: str, content: dict[str, Any]) -> dict[str, Any]:
    own = {k: p for k, p in content["parameters"].items() if k.partition(".")[0] == name}
    rows = [(parameter_words(k), _interval(p["value"], p["low"], p["high"]), p["units"]) for k, p in own.items()]
    return {"page": page(name), "parameters": rows}


def _calibrated(finding: Finding, campaign: Campaign) -> list[dict[str, Any]]:
    """What any careful engineer tunes: restitution and mounting angles, as declared, before and after."""
    out = []
    angles = {name: f"how far {name.partition('.')[2]} is turned from its declared axis" for name in finding.intervals
              if name.startswith(f"{MOUNTING}.")}  # fmt: skip
    for name, meaning in (OWN | angles).items():
        if name not in finding.intervals:
            continue
        value, low, high = finding.intervals[name]
        out.append(
            {
                "name": readable(name),
                "meaning": meaning,
                "declared": campaign.conditions.restitution if name == "restitution" else None,
                "before": finding.before.get(name),
                "interval": _interval(value, low, high),
                "units": parameter_units(name),
            }
        )
    return out


def _sure(finding: Finding, content: dict[str, Any]) -> list[str]:
    """Facts on which trust can rest, as sentences."""
    setup, swing = finding.setup, finding.chosen.swing
    start = finding.rounds[0].onto.swing if finding.rounds else swing
    held = (
        f"{len(setup.held)} of {len(setup.records)} tests were held out before anything was fitted and are predicted "
        "whole, from their base motion and their lean at release alone."
    )
    if not setup.held:
        held = "No test could be held out, there are too few: the errors say how well the model fits, not more."
    said = [
        f"{len(setup.swings)} half-swings with {swing.samples} samples were fitted. Their rms misfit is "
        f"{start.rms:.3g} times the noise under the calibrated ideal block and {swing.rms:.3g} times under the model "
        "after (1 is noise alone).",
        held,
        f"An effect has to lower chi-square by {PAYS:g} and the misfit of whole records by {100 * LEAST_GAIN:g} %. "
        f"Rivals within {TWIN:g} of the best count as not to be told apart.",
        "Intervals are 95 % under the model after and the noise of the sensors; they hold if that model is right.",
    ]
    if len(finding.rivals) > 1:
        said.append(_nearest(finding, content["error"]["units"]))
    if not finding.after_fit.converged:
        said.append("The last fit over whole records stopped before it had converged.")
    return said


def _nearest(finding: Finding, units: str) -> str:
    first, *others = finding.rivals
    second = next((r for r in others if not r.refused), others[0])
    name = next((readable(n).lower() for n in second.trial.names if n not in first.trial.names), "the other one")
    if second.trial.effects == first.trial.effects:
        name = f"{name} as another form of the same effect"
    by = second.criterion - first.criterion
    apart = f"{'better' if by < 0.0 else 'worse'} by {text.evidence(abs(by))}"
    of_swings = first.criterion == bic(first.trial.swing)
    counted = "" if of_swings else " of what is predictable of whole records, counted as the noise of the base moves it"
    held = text.amount(second.holdout if math.isfinite(second.holdout) else None, units)
    if second.refused:
        own = text.evidence(second.whole_criterion - first.whole_criterion)
        where = "in single swings" if of_swings else f"in that{counted}"
        return (
            f"The nearest rival, {name}, fits worse by {own} in chi-square over whole records, {apart} {where}; its "
            f"held-out error is {held}."
        )
    why = (
        "" if by >= 0.0 else f", less than the {TWIN:g} that would tell them apart, and whole records speak against it"
    )
    return f"The nearest rival, {name}, fits {apart} in chi-square{counted}{why}; its held-out error is {held}."


def _rounds(finding: Finding) -> list[dict[str, Any]]:
    out = []
    for k, tried in enumerate(finding.every_round, 1):
        rows = [
            {
                "form": tried.added(t).name,
                "evidence": tried.onto.swing.chi2 - t.swing.chi2,
                "score": t.score,
                "why": REFUSED if refused else "",
            }
            for t, refused in tried.tried
        ]
        rows.sort(key=lambda row: -float(row["evidence"]))  # type: ignore[arg-type]
        rows += [{"form": f, "evidence": None, "score": None, "why": why} for f, why in tried.skipped.items()]
        out.append({"number": k, "onto": [readable(name) for name in tried.onto.names], "rows": rows})
    return out


def _learned(finding: Finding) -> list[dict[str, Any]]:
    return [
        {"label": term.label, "description": term.description, "picture": figures.learned(term)}
        for term in finding.learned
    ]
