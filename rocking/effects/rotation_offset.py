"""Rotation offset: the response sensor's zero is off.

Changes     the reading: offset added to the rotation
Parameters  offset [rad]; 0 where it is absent
Use when    the sensor was zeroed apart from the test, or drifts slowly
Limits      one constant for a campaign
Source      none: a calibration constant
Status      tests
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from rocking.effect import Effect


@dataclass(frozen=True)
class RotationOffset(Effect):
    """Recorded less true rotation [rad]."""

    offset: float = 0.0

    name: ClassVar[str] = "rotation_offset"
    units: ClassVar[dict[str, str]] = {"offset": "rad"}
    rank: ClassVar[int] = 1

    def reading(self, theta: Any) -> Any:
        """theta + offset [rad]."""
        return theta + self.offset
