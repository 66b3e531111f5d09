"""Kernels made of other kernels: plain functions whose callees a compiler finds as globals.

A template is a module function that uses names which stand for other kernels; `bound` puts the kernels in their place.
One template with the same kernels gives one and the same function, so a compiling solver compiles it once a process.
"""

from __future__ import annotations

from types import FunctionType
from typing import Any

_made: dict[tuple[Any, ...], Any] = {}


def bound(template: Any, **names: Any) -> Any:
    """The template with the stated globals; the rest of its module's globals stay."""
    key = template, *sorted(names.items())
    if key not in _made:
        made = FunctionType(template.__code__, {**template.__globals__, **names}, template.__name__)
        return _made.setdefault(key, made)  # of two threads that ask at the same time both get the first one
    return _made[key]
