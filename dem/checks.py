"""Numbers at the public edge: refused with name, value and what was wanted.

Source  none, own convention
Status  tables of bad inputs (tests)
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray


def real(value: Any) -> float:
    """`value` as a float; NaN, which no check lets pass, for what is no number: a text, a list, None, 10**400."""
    if isinstance(value, (str, bytes)) or getattr(value, "ndim", False):
        return math.nan
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        return math.nan


def positive(name: str, value: float, unit: str) -> None:
    """Raises ValueError unless value is finite and above 0."""
    if not (math.isfinite(real(value)) and value > 0.0):
        raise ValueError(f"{name}={value} {unit}: want a positive, finite number")


def not_negative(name: str, value: float, unit: str) -> None:
    """Raises ValueError unless value is finite and at least 0."""
    if not (math.isfinite(real(value)) and value >= 0.0):
        raise ValueError(f"{name}={value} {unit}: want a finite number, at least 0")


def friction(name: str, value: Any) -> None:
    """Raises ValueError unless value is a friction coefficient, 0 to infinity."""
    if not real(value) >= 0.0:
        raise ValueError(f"{name}={value}: want a friction coefficient from 0 to math.inf")


def kind(name: str, value: Any, wanted: type, example: str) -> None:
    """Raises ValueError unless value is an object of that class."""
    if not isinstance(value, wanted):
        raise ValueError(f"{name}={value!r}: want {example}")


def finite(name: str, value: float, unit: str) -> None:
    """Raises ValueError unless value is finite."""
    if not math.isfinite(real(value)):
        raise ValueError(f"{name}={value} {unit}: want a finite number")


def whole(name: str, value: Any, least: int, most: int = 2**62) -> int:
    """`value` as an int; ValueError unless it is a whole number from `least` to `most`."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not least <= value <= most:
        limit = f" and at most {most}" if most < 2**62 else ""
        raise ValueError(f"{name}={value!r}: want a whole number, at least {least}{limit}")
    return int(value)


def numbers(name: str, values: Any) -> NDArray[np.float64]:
    """`values` as float64; ValueError where they are no numbers, or rows of different lengths."""
    try:
        if not isinstance(values, str):
            return np.array(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        pass
    shown = repr(values)
    raise ValueError(f"{name}={shown if len(shown) <= 80 else shown[:77] + '...'}: want numbers")
