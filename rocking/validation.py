"""Checks of arguments at the public edge: one sentence with name, value and what was wanted."""

from __future__ import annotations

import math


def positive(name: str, value: float, unit: str) -> None:
    """Raise ValueError unless `value` is a positive finite number."""
    if not (math.isfinite(value) and value > 0.0):
        raise ValueError(f"{name}={value!r} {unit}: want a positive number")


def within(name: str, value: float, low: float, high: float) -> None:
    """Raise ValueError unless low <= value <= high (a bound that is infinite may be reached)."""
    if math.isnan(value) or not low <= value <= high:
        raise ValueError(f"{name}={value!r}: want {low:g} to {high:g}")
