"""The array namespace of plain Python floats: what the physics is run with outside any array library."""

from __future__ import annotations

import builtins
from math import cos, sin
from typing import Any

__all__ = ["abs", "cos", "sin", "where"]

abs = builtins.abs


def where(condition: Any, yes: Any, no: Any) -> Any:
    """One of two values; both have been computed."""
    return yes if condition else no
