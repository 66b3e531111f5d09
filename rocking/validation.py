"""Checks of arguments at the public edge: one sentence with name, value and what was wanted."""

from __future__ import annotations

import math
from typing import Any


def real(value: Any) -> float:
    """`value` as a float; NaN, which no check lets pass, for what is no number: a text, a list, None, 10**400."""
    if isinstance(value, (str, bytes)) or getattr(value, "ndim", False):
        return math.nan
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        return math.nan


def as_floats(thing: Any, *names: str) -> None:
    """Keep these numbers of a frozen dataclass as Python's: one of 32 bits would have all that follows in 32 bits."""
    for name in names:
        value = getattr(thing, name)
        if value is not None and type(value) not in (float, int):
            object.__setattr__(thing, name, float(value))


def positive(name: str, value: float, unit: str) -> None:
    """Raise ValueError unless `value` is a positive finite number."""
    if not (math.isfinite(real(value)) and value > 0.0):
        raise ValueError(f"{name}={value!r} {unit}: want a positive number")


def within(name: str, value: float, low: float, high: float) -> None:
    """Raise ValueError unless low <= value <= high (a bound that is infinite may be reached)."""
    if not low <= real(value) <= high:
        raise ValueError(f"{name}={value!r}: want {low:g} to {high:g}")
