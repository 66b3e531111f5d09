"""Base motion gain: the base sensor's calibration is off.

Changes     the base motion: gain times the recorded horizontal acceleration
Parameters  gain [1], true over recorded; 1 where it is absent
Use when    the accelerometer of the table was calibrated apart from the test
Limits      linear, the horizontal channel alone
Source      none: a calibration factor
Status      tests
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


def _scaled(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    a_x, a_z = _inner(xp, t, par[:_split])
    return par[_split] * a_x, a_z


@dataclass(frozen=True)
class BaseMotionGain(Effect):
    """True over recorded horizontal acceleration of the base [1]."""

    gain: float = 1.0

    name: ClassVar[str] = "base_motion_gain"
    units: ClassVar[dict[str, str]] = {"gain": "1"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"gain": (0.0, math.inf)}
    rank: ClassVar[int] = 0

    def base_motion(self, motion: BaseMotion, span: tuple[float, float], g: float) -> BaseMotion:
        """The motion with its horizontal acceleration scaled."""
        return AlteredMotion(motion, [self.gain], kernel=_scaled, label=f"gain {self.gain:g}")
