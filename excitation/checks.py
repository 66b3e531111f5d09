"""Checks of arguments: one sentence with name, value and what was wanted."""

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


def finite(name: str, value: float, unit: str) -> None:
    """Raise ValueError unless `value` is a finite number."""
    if not math.isfinite(real(value)):
        raise ValueError(f"{name}={value!r} {unit}: want a finite number")


def positive(name: str, value: float, unit: str) -> None:
    """Raise ValueError unless `value` is finite and above zero."""
    if not (math.isfinite(real(value)) and value > 0.0):
        raise ValueError(f"{name}={value!r} {unit}: want a positive number")


def not_negative(name: str, value: float, unit: str) -> None:
    """Raise ValueError unless `value` is finite and zero or more."""
    if not (math.isfinite(real(value)) and value >= 0.0):
        raise ValueError(f"{name}={value!r} {unit}: want zero or more")


def not_zero(name: str, value: float, unit: str) -> None:
    """Raise ValueError unless `value` is finite and differs from zero."""
    if not math.isfinite(real(value)) or value == 0.0:
        raise ValueError(f"{name}={value!r} {unit}: want a finite number other than zero")


def between(name: str, value: float, low: float, high: float, unit: str) -> None:
    """Raise ValueError unless low <= value <= high."""
    if not low <= real(value) <= high:
        raise ValueError(f"{name}={value!r} {unit}: want {low:g} to {high:g}")


def samples(name: str, values: Any, least: int = 2) -> NDArray[np.float64]:
    """`values` as a read-only float64 array of its own, shape (time,); ValueError unless finite and long enough."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name}: want numbers, shape (time,)") from None
    if array.ndim != 1 or array.size < least:
        raise ValueError(f"{name}: has shape {array.shape}, want {least} samples or more in one dimension")
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise ValueError(f"{name}: sample {bad[0]} is {array[bad[0]]}, want finite numbers")
    array.flags.writeable = False
    return array


def whole(name: str, value: Any, least: int, most: int = 2**62) -> int:
    """`value` as an int; ValueError unless it is a whole number from `least` to `most`."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not least <= value <= most:
        range_ = f"{least} to {most}" if most < 2**62 else f"{least} or more"
        raise ValueError(f"{name}={value!r}: want {range_}, a whole number")
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
