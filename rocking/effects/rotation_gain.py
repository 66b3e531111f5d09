"""Rotation gain: the response sensor's calibration is off.

Changes     the reading: gain times the rotation
Parameters  gain [1], recorded over true; 1 where it is absent
Use when    a potentiometer or a camera's scale was calibrated apart from the test
Limits      linear
Source      none: a calibration factor
Status      tests
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from rocking.effect import Effect


@dataclass(frozen=True)
class RotationGain(Effect):
    """Recorded over true rotation [1]."""

    gain: float = 1.0

    name: ClassVar[str] = "rotation_gain"
    units: ClassVar[dict[str, str]] = {"gain": "1"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"gain": (0.0, math.inf)}
    rank: ClassVar[int] = 0

    def reading(self, theta: Any) -> Any:
        """gain theta [rad]."""
        return self.gain * theta
