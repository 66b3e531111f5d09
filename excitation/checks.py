"""Checks of arguments: one sentence with name, value and what was wanted."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray


def finite(name: str, value: float, unit: str) -> None:
    """Raise ValueError unless `value` is a finite number."""
    if not math.isfinite(value):
        raise ValueError(f"{name}={value!r} {unit}: want a finite number")


def positive(name: str, value: float, unit: str) -> None:
    """Raise ValueError unless `value` is finite and above zero."""
    if not (math.isfinite(value) and value > 0.0):
        raise ValueError(f"{name}={value!r} {unit}: want a positive number")


def not_negative(name: str, value: float, unit: str) -> None:
    """Raise ValueError unless `value` is finite and zero or more."""
    if not (math.isfinite(value) and value >= 0.0):
        raise ValueError(f"{name}={value!r} {unit}: want zero or more")


def not_zero(name: str, value: float, unit: str) -> None:
    """Raise ValueError unless `value` is finite and differs from zero."""
    if not math.isfinite(value) or value == 0.0:
        raise ValueError(f"{name}={value!r} {unit}: want a finite number other than zero")


def between(name: str, value: float, low: float, high: float, unit: str) -> None:
    """Raise ValueError unless low <= value <= high."""
    if not low <= value <= high:
        raise ValueError(f"{name}={value!r} {unit}: want {low:g} to {high:g}")


def samples(name: str, values: Any, least: int = 2) -> NDArray[np.float64]:
    """`values` as a read-only float64 array of its own, shape (time,); ValueError unless finite and long enough."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: want numbers, shape (time,)") from None
    if array.ndim != 1 or array.size < least:
        raise ValueError(f"{name}: has shape {array.shape}, want {least} samples or more in one dimension")
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise ValueError(f"{name}: sample {bad[0]} is {array[bad[0]]}, want finite numbers")
    array.flags.writeable = False
    return array
