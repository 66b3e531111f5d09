"""Base tilt: the floor is not level.

Changes     the base motion as the block feels it: along the floor a_x cos(beta) - (g + a_z) sin(beta), normal to it
            a_x sin(beta) + (g + a_z) cos(beta)
Parameters  angle beta [rad], positive when the floor falls toward +x; 0 where it is absent
Use when    the table or the plinth was levelled by eye
Limits      constant; the table itself moves horizontally, and rotation is measured from the floor
Source      own derivation: gravity and base acceleration in the axes of the floor
Status      the two tilts of balance, and onset on either side (tests)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from rocking.altered import AlteredMotion
from rocking.effect import Effect
from rocking.motion import BaseMotion

_inner: Any = None
_split: Any = None


def _in_axes_of_the_floor(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    a_x, a_z = _inner(xp, t, par[:_split])
    cos, sin, g = par[_split], par[_split + 1], par[_split + 2]
    return a_x * cos - (g + a_z) * sin, a_x * sin + (g + a_z) * cos - g


@dataclass(frozen=True)
class BaseTilt(Effect):
    """Angle of the floor [rad], positive when it falls toward +x."""

    angle: float = 0.0

    name: ClassVar[str] = "base_tilt"
    units: ClassVar[dict[str, str]] = {"angle": "rad"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"angle": (-0.5 * math.pi, 0.5 * math.pi)}
    rank: ClassVar[int] = 5  # it turns whatever the base does, and a push

    def base_motion(self, motion: BaseMotion, span: tuple[float, float], g: float) -> BaseMotion:
        """The motion in the axes of the tilted floor."""
        numbers = [math.cos(self.angle), math.sin(self.angle), g]
        label = f"floor tilted by {self.angle:g} rad"
        return AlteredMotion(motion, numbers, kernel=_in_axes_of_the_floor, turned=True, label=label)
