"""What a person calls an effect: title, sentence and sections of its page, units of its parameters."""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass

from rocking.effects import load
from studies.loop.models.model import DRIFT, FADING, GRAVITY, MOUNTING, RESTITUTION

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


def page(name: str) -> Page:
    """The page of an effect; of a module without such a head, its name alone."""
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


def parameter_units(full: str) -> str:
    """Units of a parameter by its full name, "1" where it has none."""
    effect, _, parameter = full.partition(".")
    if effect in OF_THE_CALIBRATION:
        return OF_THE_CALIBRATION[effect]
    return load(effect).units.get(parameter, "1") if parameter else "1"
