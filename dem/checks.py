"""Numbers at the public edge: refused with name, value and what was wanted.

Source  none, own convention
Status  tables of bad inputs (tests)
"""

from __future__ import annotations

import math


def positive(name: str, value: float, unit: str) -> None:
    """Raises ValueError unless value is finite and above 0."""
    if not (math.isfinite(value) and value > 0.0):
        raise ValueError(f"{name}={value} {unit}: want a positive, finite number")


def not_negative(name: str, value: float, unit: str) -> None:
    """Raises ValueError unless value is finite and at least 0."""
    if not (math.isfinite(value) and value >= 0.0):
        raise ValueError(f"{name}={value} {unit}: want a finite number, at least 0")


def finite(name: str, value: float, unit: str) -> None:
    """Raises ValueError unless value is finite."""
    if not math.isfinite(value):
        raise ValueError(f"{name}={value} {unit}: want a finite number")
