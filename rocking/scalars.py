"""The array namespace of plain Python floats: what the physics is run with outside any array library."""

from __future__ import annotations

import builtins
from math import cos, exp, floor, sin, sqrt
from typing import Any

__all__ = ["abs", "cos", "exp", "floor", "maximum", "minimum", "sin", "sqrt", "where"]

abs = builtins.abs
minimum = builtins.min
maximum = builtins.max


def where(condition: Any, yes: Any, no: Any) -> Any:
    """One of two values; both have been computed."""
    return yes if condition else no
