"""Learned reading: a rotation sensor that is not linear, as a short series.

Changes     the reading: theta + square theta^2 + cubic theta^3, before a gain and an offset
Parameters  square [1/rad], cubic [1/rad^2]; 0 where absent
Use when    a sensor bends toward the ends of its range, or an arc is read for an angle: how the reading is off, not why
Limits      two terms, without hysteresis or drift; outside of what was measured they say nothing
Source      a calibration curve (JCGM 200:2012, 4.31) as a series
Status      by hand, and learned from decays of the laboratory with a cube added to what its sensor reads (tests)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from rocking.effect import Effect


@dataclass(frozen=True)
class LearnedReading(Effect):
    """What a sensor adds to the rotation, by its square and its cube."""

    square: float = 0.0
    cubic: float = 0.0

    name: ClassVar[str] = "learned_reading"
    units: ClassVar[dict[str, str]] = {"square": "1/rad", "cubic": "1/rad^2"}
    rank: ClassVar[int] = -1  # a gain and an offset are of what the sensor has made of the rotation

    def reading(self, theta: Any) -> Any:
        """theta + square theta^2 + cubic theta^3 [rad]."""
        return theta * (1.0 + theta * (self.square + self.cubic * theta))
