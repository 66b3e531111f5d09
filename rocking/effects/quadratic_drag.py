"""Quadratic drag: a torque against the square of the angular velocity.

Adds        theta'' += -c |omega| omega
Parameters  coefficient c [1/rad], of angular acceleration; 0 where it is absent
Use when    the block is light and broad and the air is still
Limits      not for gusts, nor for speeds so low that the drag of air is viscous
Source      drag in proportion to the square of speed: Newton's law of resistance
Status      loss of energy over a swing against a quadrature (tests)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from rocking.effect import Effect


def drag(xp: Any, theta: Any, omega: Any, s: Any, base: Any, values: Any) -> Any:
    """-c |omega| omega [rad/s^2]."""
    return -values[0] * xp.abs(omega) * omega


@dataclass(frozen=True)
class QuadraticDrag(Effect):
    """Torque against the square of the angular velocity; coefficient [1/rad]."""

    coefficient: float = 0.0

    name: ClassVar[str] = "quadratic_drag"
    units: ClassVar[dict[str, str]] = {"coefficient": "1/rad"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"coefficient": (0.0, math.inf)}
    acceleration = staticmethod(drag)
