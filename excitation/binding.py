"""Kernels made of other kernels: plain functions whose callees a compiler finds as globals.

A template is a module function that uses names which stand for other kernels; `bound` puts the kernels in their place.
One template with the same kernels gives one and the same function, so a compiling solver compiles it once a process.
"""

from __future__ import annotations

from functools import cache
from types import FunctionType
from typing import Any


def bound(template: Any, **names: Any) -> Any:
    """The template with the stated globals; the rest of its module's globals stay."""
    return _bound(template, tuple(sorted(names.items())))


@cache
def _bound(template: Any, names: tuple[tuple[str, Any], ...]) -> Any:
    return FunctionType(template.__code__, {**template.__globals__, **dict(names)}, template.__name__)
