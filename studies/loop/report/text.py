"""What the report says in words: the verdict in a sentence, what follows from it and what does not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from studies.loop.models.names import page, parameter_words, readable
from studies.loop.swings.learning import LEARNED
from studies.loop.swings.trials import PAYS
from studies.loop.whole.rivals import TWIN

Content = dict[str, Any]

AT_THE_FLOOR = 1.5
"""Errors up to this many times the noise floor are as good as the noise lets them be."""

MOST_DECIMALS = 8
"""Smaller numbers are written with an exponent."""

NOTHING = 10.0
"""A fall of chi-square below which a candidate explains nothing."""

HINTED = 15.2
"""And from which one is hinted at, named or not: of twenty candidates of two parameters each, chance lets the best one
reach it once in a hundred times."""


def number(value: float | None, digits: int = 3) -> str:
    """A number to so many significant digits; a dash where there is none."""
    if value is None:
        return "–"
    shown = f"{value:.{digits}g}"
    # Up to a million without an exponent; a minus is no hyphen.
    return (f"{float(shown):.0f}" if "e+" in shown and abs(value) < 1e6 else shown).replace("-", "−", int(value < 0.0))


def evidence(value: float | None) -> str:
    """A fall of chi-square, of which less than a tenth is nothing."""
    return "–" if value is None else number(round(value) if abs(value) >= 10.0 else round(value, 1) + 0.0, 6)


def with_interval(value: float, low: float, high: float) -> tuple[str, str, str]:
    """A value and the ends of its interval, all to the second digit of the half-width."""
    half = 0.5 * (high - low)
    if not (half > 0.0 and math.isfinite(half)):
        return number(value), number(low), number(high)
    decimals = 1 - math.floor(math.log10(half))
    if 0 < decimals <= MOST_DECIMALS:
        return tuple(f"{v:.{decimals}f}".replace("-", "−") for v in (value, low, high))  # type: ignore[return-value]
    size = max(abs(low), abs(high))
    digits = max(math.floor(math.log10(size)) + 1 + decimals, 2)
    return number(value, digits), number(low, digits), number(high, digits)


def amount(value: float | None, units: str, digits: int = 3) -> str:
    """A number with its unit."""
    return number(value, digits) if units == "1" or value is None else f"{number(value, digits)} {units}"


def listed(names: Sequence[str], last: str = "and") -> str:
    """Names as a list in a sentence."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {last} {names[-1]}" if names else ""


def effect_words(content: Content, name: str) -> str:
    """An effect, what it is and its parameters, as in "base tilt (the floor is not level; angle 0.0045 rad, ...)"."""
    found = []
    for full, p in content["parameters"].items():
        if full.partition(".")[0] == name:
            value, low, high = with_interval(p["value"], p["low"], p["high"])
            unit = "" if p["units"] == "1" else f" {p['units']}"
            found.append(f"{parameter_words(full)} {value}{unit}, between {low} and {high}")
    about = page(name)
    inside = [about.sentence, *found] if about.sentence else found
    return f"{about.title.lower()} ({'; '.join(inside)})" if inside else about.title.lower()


def falls(content: Content) -> str:
    """Error before and after against the floor, on held-out tests if there are any."""
    error, units = content["error"], content["error"]["units"]
    held = error["after"]["holdout"] is not None
    key, where = (
        ("holdout", "tests that it never saw") if held else ("fit", "the fitted tests (none could be held out)")
    )
    before, after = (amount(error[stage][key], units) for stage in ("before", "after"))
    floor, best = error["noise_floor"], ""
    if floor is not None:
        reached = error["after"][key] <= AT_THE_FLOOR * floor
        best = f"; {'that is down to' if reached else 'it is still above'} the noise floor, {amount(floor, units)}"
    if content["verdict"] == "none":
        return f"its error on {where} is {after}{best}"
    return f"the error on {where} goes from {before} to {after}{best}"


def hint(content: Content) -> str | None:
    """Where nothing was named, the effect that comes nearest to it, if chance would seldom let one come so near."""
    if content["verdict"] != "none":
        return None
    best = max(content.get("candidates", ()), key=lambda row: row["evidence"] or 0.0, default=None)
    if best is None or (best["evidence"] or 0.0) < HINTED:
        return None
    return (
        f"{readable(best['form'])} is hinted at: it lowers chi-square by {evidence(best['evidence'])}, more than "
        f"chance would, but less than the {PAYS:g} that are asked of an effect with a name"
    )


def verdict(content: Content) -> str:
    """The finding in one sentence, or two where an effect that was not named is hinted at."""
    if content["verdict"] == "none":
        least = f"Nothing is missing that these records can show: for the calibrated ideal block, {falls(content)}."
        near = hint(content)
        return least if near is None else f"{least} {near}."
    effects = listed([effect_words(content, name) for name in dict.fromkeys(content["effects"])])
    if content["verdict"] == "unexplained":
        missing = "Something is missing that no effect known to this program explains"
        if any(name in LEARNED for name in content["effects"]):
            return f"{missing}; with what was learned of it in the model, {falls(content)}."
        known = effects or "the calibrated block alone"
        return f"{missing}, and of which nothing could be learned; with {known}, {falls(content)}."
    return f"What the ideal block lacks is {effects}: with that in the model, {falls(content)}."


def twins(content: Content) -> list[str]:
    """A sentence for each set that these data cannot tell apart."""
    return [
        f"{listed([readable(name) for name in names])}: each explains these records as well as the others; which of "
        "them it is has to come from another test or from a look at the block."
        for names in content["indistinguishable"]
    ]


def concluded(content: Content) -> list[str]:
    """What follows from the verdict."""
    if content["verdict"] == "none":
        return [
            "The ideal block with the calibrated restitution and leans predicts these tests about as well as the noise "
            "of the sensors lets any model do.",
            f"{hint(content) or 'No effect that was tried lowered the misfit by more than chance would'}.",
        ]
    if content["verdict"] == "unexplained":
        return [
            "The calibrated ideal block misses these records by more than the noise, in a way that repeats.",
            "No effect that was tried, alone or with others, accounts for it.",
        ]
    names = listed([page(name).title.lower() for name in dict.fromkeys(content["effects"])])
    return [
        f"These records need a term of the form of {names}, of the stated size.",
        "The gain is that over the calibrated block, on tests that neither the fit nor the choice saw; it is no gain "
        "over an untuned model.",
    ]


def not_concluded(content: Content) -> list[str]:
    """What does not follow from it."""
    beyond = "Nothing is said of motions larger, longer or of other frequencies than those of the tests listed above."
    if content["verdict"] == "none":
        return ["That the block is ideal: effects too small to show in these records may be there.", beyond]
    if content["verdict"] == "unexplained":
        return [
            "What the cause is. The learned term, where there is one, describes how the residual looks and no more.",
            "That the missing effect is of a kind that this program could not name: two small ones together, or a "
            "fault of a sensor, may look like this as well.",
            beyond,
        ]
    first = (
        "That the cause has been seen: the records want a term of this form, and a look at the block, the table and "
        "the sensors is the proof."
    )
    rivals = (
        ["Which of the effects that cannot be told apart it is (see above)."] if content["indistinguishable"] else []
    )
    return [first, *rivals, "That nothing else is there: what lies below the remaining error stays unseen.", beyond]


def reason(row: Content, content: Content, parts: Sequence[str]) -> str:
    """Why a candidate was kept or left.

    Args:
        row: of the candidates in loop.json.
        content: of loop.json.
        parts: forms of the effects in the model after.
    """
    if "refused" in row:
        return str(row["refused"])
    same = [r for r in content["candidates"] if r["beside"] == row["beside"] and "refused" not in r]
    best = max((r["evidence"] or 0.0 for r in same), default=0.0)
    if row["form"] in parts and ({row["form"], *row["beside"]} == set(parts) or row["evidence"] == best):
        return "in the model after"
    if "not_refitted" in row:
        why = str(row["not_refitted"])
        return f"not refitted: its {why} is too small" if why.startswith("score ") else f"not refitted: {why}"
    beside = {name.partition("[")[0] for name in row["beside"]}
    own = row["evidence"] or 0.0
    forms = [r["evidence"] or 0.0 for r in same if r["effect"] == row["effect"]]
    if row["effect"] in {form.partition("[")[0] for form in parts}:
        if own >= NOTHING and max(forms) - own < TWIN:
            return "cannot be told apart from the form that was chosen"
    elif own == max(forms) and any(
        row["effect"] in names and not beside & set(names) for names in content["indistinguishable"]
    ):
        return "cannot be told apart from what was chosen"
    if own < NOTHING:
        return "explains nothing"
    if content["verdict"] == "none":
        return "hinted at, too little to be named" if own >= HINTED else "explains too little to be more than chance"
    if own >= best:
        return "explains the most by itself; the model after does without it"
    if own > 0.9 * best:
        return f"comes near, but leaves {evidence(best - own)} more than the best one"
    return f"explains {max(100.0 * own / best, 0.1):.2g} % of what the best one does"
