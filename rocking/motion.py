"""What a block needs of the ground: accelerations at any time, as a formula that a solver may compile.

Anything with these members is a motion; `excitation` has many, and ten lines of your own do as well.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray


class BaseMotion(Protocol):
    """A prescribed motion of the base."""

    @property
    def kernel(self) -> Callable[..., tuple[Any, Any]]:
        """Plain function (xp, t [s], par) -> (a_x, a_z) [m/s^2] that uses `xp` and arithmetic alone."""

    @property
    def parameters(self) -> NDArray[np.float64]:
        """The array `par`, shape (parameter,)."""

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Times [s], ascending, at which the motion or its slope jumps."""

    @property
    def max_step(self) -> float:
        """The longest integration step [s] that cannot miss a feature; inf if there is none to miss."""


def _no_acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    return 0.0 * t, 0.0 * t


class Still:
    """A base at rest."""

    kernel = staticmethod(_no_acceleration)
    parameters = np.zeros(0)
    breakpoints: tuple[float, ...] = ()
    max_step = float("inf")

    def __repr__(self) -> str:
        return "Still()"
