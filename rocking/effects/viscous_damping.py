"""Viscous damping: a torque against the angular velocity.

Adds        theta'' += -c omega
Parameters  coefficient c [1/s], of angular acceleration; 0 where it is absent
Use when    the block moves in a fluid slowly, or hinges and cables resist in proportion to speed
Limits      a loss between impacts only; what an impact loses is restitution
Source      linear damping as of any oscillator
Status      free rocking between impacts against its closed form (tests)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from rocking.effect import Effect


def damping(xp: Any, theta: Any, omega: Any, s: Any, base: Any, values: Any) -> Any:
    """-c omega [rad/s^2]."""
    return -values[0] * omega


@dataclass(frozen=True)
class ViscousDamping(Effect):
    """Torque against the angular velocity; coefficient [1/s]."""

    coefficient: float = 0.0

    name: ClassVar[str] = "viscous_damping"
    units: ClassVar[dict[str, str]] = {"coefficient": "1/s"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"coefficient": (0.0, math.inf)}
    acceleration = staticmethod(damping)
