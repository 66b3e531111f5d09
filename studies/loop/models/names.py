"""What a person calls an effect: title, sentence and sections of its page, units of its parameters."""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass

from rocking.effects import load
from studies.loop.models.model import CHANGE, DRIFT, FADING, GRAVITY, MOUNTING, RESTITUTION

_SECTION = re.compile(r"^([A-Z][a-z]*(?: [a-z]+)?)\s{2,}(\S.*)$")

OWN = {
    RESTITUTION: "angular velocity after an impact over that before",
    DRIFT: "change of restitution from one test to the next",
    FADING: "how fast the change of restitution fades from test to test, as exp(-fading number)",
    GRAVITY: "acceleration of gravity, as accelerometers on the block read it",
}
"""Parameters that belong to no effect."""

OF_THE_CALIBRATION = {MOUNTING: "rad", GRAVITY: "m/s^2"}
"""Units of what is calibrated, where it has some."""


@dataclass(frozen=True)
class Page:
    """The head of an effect's module: what it is and its sections (Changes, Parameters, Use when, Limits, Source)."""

    name: str
    title: str
    sentence: str
    sections: tuple[tuple[str, str], ...]


OF_A_CHANGE = Page(
    CHANGE, "Learned change", "parameters are others from test to test in the course of the campaign",
    (
        ("Changes", "a parameter of another effect, or the restitution, by number of the test or what impacts took"),
        ("Parameters", "per_test, from the first test to the next, which fades as exp(-fading number); step, "
         "from the test from_test on, counted from 0"),
        ("Limits", "what changes within a test is taken at its middle; later tests take as much as others did"),
    ),
)  # fmt: skip
"""Of what no module in `rocking.effects` holds, since a single test knows nothing of it."""


def page(name: str) -> Page:
    """The page of an effect; of a module without such a head, its name alone."""
    if name == CHANGE:
        return OF_A_CHANGE
    effect = load(name)
    text = sys.modules[effect.__module__].__doc__ or ""
    lines = text.strip().splitlines() or [""]
    title, colon, sentence = lines[0].partition(":")
    if not colon:
        title, sentence = readable(name), lines[0]
    sections: list[tuple[str, str]] = []
    for line in lines[1:]:
        head = _SECTION.match(line)
        if head:
            sections.append((head[1], head[2].strip()))
        elif sections and line.strip():
            sections[-1] = (sections[-1][0], f"{sections[-1][1]} {line.strip()}")
    plain = tuple((key, value.replace("`", "")) for key, value in sections)
    return Page(name, title.strip(), sentence.strip().rstrip("."), plain)


def readable(name: str) -> str:
    """A name in words: "table_pitch[acceleration]" as "Table pitch (acceleration)"."""
    effect, bracket, form = name.partition("[")
    words = effect.replace("_", " ")
    return (words[:1].upper() + words[1:]) + (f" ({form.rstrip(']').replace('_', ' ')})" if bracket else "")


def parameter_words(full: str) -> str:
    """A parameter of an effect in words, without the effect; of a change what changes, and how."""
    effect, _, parameter = full.partition(".")
    if effect == CHANGE:
        how, _, changed = parameter.partition(".")
        of, _, own = changed.partition(".")
        what = f"{own.replace('_', ' ')} of {readable(of).lower()}" if own else of
        return f"{how.replace('_', ' ')}, {what}"
    return parameter.replace("_", " ")


def parameter_units(full: str) -> str:
    """Units of a parameter by its full name, "1" where it has none."""
    effect, _, parameter = full.partition(".")
    if effect == CHANGE:
        how, _, changed = parameter.partition(".")
        return "1" if how in ("fading", "from_test", "by_use") else parameter_units(changed)
    if effect in OF_THE_CALIBRATION:
        return OF_THE_CALIBRATION[effect]
    return load(effect).units.get(parameter, "1") if parameter else "1"
