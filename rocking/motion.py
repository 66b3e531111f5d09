"""What a block needs of the ground: accelerations at any time, as a formula that a solver may compile.

Anything with these members is a motion; `excitation` has many, and ten lines of your own do as well.  A base that also
pitches has a `pitch_kernel(xp, t [s], par) -> (pitch [rad], pitch acceleration [rad/s^2])` besides, clockwise positive;
one whose pitch_kernel may be zero throughout says so in `has_pitch`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from rocking.hybrid import Base


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


def level(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """No pitch."""
    return 0.0 * t, 0.0 * t


def pitch_kernel(motion: BaseMotion) -> Callable[..., tuple[Any, Any]] | None:
    """The motion's pitch_kernel; None if the base stays level."""
    kernel = getattr(motion, "pitch_kernel", None)
    return kernel if kernel is not None and getattr(motion, "has_pitch", True) else None


def base_at(xp: Any, motion: BaseMotion, t: Any, par: Any) -> Base:
    """What the base does at t [s], in the array namespace xp."""
    pitch = pitch_kernel(motion)
    if pitch is None:
        return Base(*motion.kernel(xp, t, par))
    return Base(*motion.kernel(xp, t, par), *pitch(xp, t, par))


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
