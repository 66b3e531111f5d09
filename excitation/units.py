"""Units at the edges: what a file or a dataset states, and the factor to SI.

Source   g is the standard acceleration of free fall, 9.80665 m/s^2 (3rd CGPM, 1901); 1 gal is 0.01 m/s^2, 1 in is
         0.0254 m.
"""

from __future__ import annotations

import math
import re

STANDARD_GRAVITY = 9.80665
"""Standard acceleration of free fall [m/s^2]: one g in a file."""

_CM, _IN = 0.01, 0.0254
FACTORS: dict[str, dict[str, float]] = {
    "acceleration": {
        "m/s2": 1.0,
        "cm/s2": _CM,
        "mm/s2": 0.001,
        "in/s2": _IN,
        "ft/s2": 0.3048,
        "gal": _CM,
        "g": STANDARD_GRAVITY,
        "mg": 1e-3 * STANDARD_GRAVITY,
        "g/10": 0.1 * STANDARD_GRAVITY,
    },
    "velocity": {"m/s": 1.0, "cm/s": _CM, "mm/s": 0.001, "in/s": _IN},
    "displacement": {"m": 1.0, "cm": _CM, "mm": 0.001, "in": _IN},
    "time": {"s": 1.0, "ms": 1e-3},
    "angle": {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180.0},
    "angular acceleration": {"rad/s2": 1.0, "deg/s2": math.pi / 180.0},
}

LONGEST = 60
"""Characters; a longer text is no unit."""


def plain(unit: str) -> str:
    """One spelling for a unit: `cm/sec/sec`, `CM/SEC**2`, `cm s-2`, `cm.s^-2` are all cm/s2."""
    if len(unit) > LONGEST:
        return unit
    text = unit.strip().lower().replace("seconds", "s").replace("sec", "s").replace("gals", "gal")
    text = re.sub(r"\s*(/)\s*", r"\1", text).rstrip(". ")
    text = text.replace("**", "").replace("^", "").replace("²", "2")
    text = re.sub(r"[\s.*]+s-2$", "/s2", text)
    text = re.sub(r"[\s.*]+s-1$", "/s", text)
    text = re.sub(r"/s/s$", "/s2", text)
    return re.sub(r"/\(?s2\)?$", "/s2", text)


def factor(unit: str, quantity: str) -> float:
    """What to multiply by to have SI; ValueError names the unit and those that are known for the quantity."""
    known = FACTORS[quantity]
    if plain(unit) not in known:
        raise ValueError(f"units {unit!r}: want a unit of {quantity}: {', '.join(known)}")
    return known[plain(unit)]


def quantity_of(unit: str) -> str | None:
    """The quantity that a unit belongs to, or None if it is not known."""
    return next((quantity for quantity, known in FACTORS.items() if plain(unit) in known), None)
