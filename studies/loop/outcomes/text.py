"""What the report on outcomes says in words: the verdict in a sentence, what follows from it and what does not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from studies.loop.models.names import page, readable
from studies.loop.outcomes.search import FINAL
from studies.loop.report.text import effect_words, listed, number
from studies.loop.swings.learning import LEARNED

Content = dict[str, Any]

EFFECTIVE = {
    "concave_base": "The breadth is an effective one: of a flat block with two edges that falls as this one does. "
    "Nothing here shows that the base is that narrow; worn or uneven edges, contact that moves inward, or motion out "
    "of the plane may all look like it.",
    "rounded_edges": "The radius is an effective one: of a flat block with two round edges that falls as this one "
    "does.",
    "mass_distribution": "Height and inertia are effective ones: of a flat block with two edges that falls as this one "
    "does.",
    "base_motion_gain": "A gain of the motion cannot be told from a block that falls more, or less, easily than "
    "declared.",
}
"""What must be said of a parameter that outcomes alone gave."""


def share(value: float) -> str:
    """A share in percent."""
    return f"{100.0 * value:.1f} %"


def falls(content: Content) -> str:
    """Share wrong before and after, on held-out tests."""
    error = content["error"]
    floor = f"a true model would miss {share(error['noise_floor'])}, since the motions are known to their noise only"
    before, after = (share(error[stage]["holdout"]) for stage in ("before", "after"))
    if content["verdict"] == "none":
        return f"it predicts {after} of the outcomes wrong in motions that it never saw ({floor})"
    return f"the share of outcomes predicted wrong goes from {before} to {after} in motions that it never saw ({floor})"


def verdict(content: Content) -> str:
    """The finding in one sentence."""
    if content["verdict"] == "none":
        return f"Nothing is missing that these outcomes can show: for the calibrated ideal block, {falls(content)}."
    names = list(dict.fromkeys(n for n in content["effects"] if n not in LEARNED))
    found = listed([effect_words(content, name) for name in names])
    if content["verdict"] == "unexplained":
        with_it = f" on top of {found}" if names else ""
        return (
            f"Something is missing{with_it} that no effect known to this program explains; with the model after, "
            f"{falls(content)}."
        )
    return f"The outcomes ask for {found}: with that in the model, {falls(content)}."


def twins(content: Content) -> list[str]:
    """A sentence for each set that these outcomes cannot tell apart."""
    return [
        f"{listed([readable(name) for name in names])}: each explains these outcomes about as well as the others."
        for names in content["indistinguishable"]
    ]


def concluded(content: Content) -> list[str]:
    """What follows from the verdict."""
    if content["verdict"] == "none":
        return ["No effect that was tried explains these outcomes better than chance would, with all that were tried."]
    said = ["The gain is that over the calibrated block, on motions that neither the fit nor the choice saw."]
    names = [page(n).title.lower() for n in dict.fromkeys(content["effects"]) if n not in LEARNED]
    if names:
        said.insert(0, f"Who falls is described far better by a block with {listed(names)} than by the ideal one.")
    if content["verdict"] == "unexplained":
        said.append("More outcomes are missed than the noise of the motions accounts for.")
    return said


def not_concluded(content: Content) -> list[str]:
    """What does not follow from it."""
    beyond = "Nothing is said of motions unlike those of these tests, nor of how far the block rocks without falling."
    if content["verdict"] == "none":
        return ["That the block is ideal: an outcome says little, and effects of some size may be hidden here.", beyond]
    said = [EFFECTIVE[name] for name in dict.fromkeys(content["effects"]) if name in EFFECTIVE]
    if content["indistinguishable"]:
        said.append("Which of the effects that cannot be told apart it is.")
    if content["verdict"] == "unexplained":
        said.append("What the rest is: no candidate accounts for it.")
    said.append("That nothing else is there: what lies below the remaining error stays unseen.")
    return [*said, beyond]


def reason(row: Mapping[str, Any], content: Content, parts: tuple[str, ...]) -> str:
    """Why a candidate was kept or left."""
    if row["form"] in parts:
        return "in the model after"
    if "not_refitted" in row:
        return f"not tried: {row['not_refitted']}"
    beside = {name.partition("[")[0] for name in row["beside"]}
    if any(row["effect"] in names and not beside & set(names) for names in content["indistinguishable"]):
        return "cannot be told apart from what was chosen"
    if row["evidence"] <= 0.0:
        return "explains no more than its parameters cost"
    same = (r for r in content["candidates"] if r["beside"] == row["beside"] and r["evidence"] is not None)
    best = max((r["evidence"] for r in same), default=0.0)
    if content["verdict"] == "none" or not parts:
        return "explains too little to be more than chance"
    return f"explains less: {number(best - row['evidence'])} below the best"


def method() -> str:
    """How evidence was come by."""
    return (
        "Evidence is the gain of twice the log-likelihood over what it was tried beside, with the "
        "price of the "
        f"further parameters (ln n each) taken off; it is computed at the {FINAL} best points of each form that "
        f"came near, "
        "each motion run at several strengths, and for the others from one run of each motion."
    )
