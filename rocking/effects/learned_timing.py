"""Learned timing: the recorder of the rotation has a clock of its own, which is late or runs at another pace.

Changes     when what is read happened: of a reading at t after the record began that is at (1 + pace) t - lag
Parameters  pace [1], by how much more time passes between two readings than the recorder says; lag [s], how late they
            are; 0 where absent
Use when    base and response were recorded by different devices, of which one counts its samples by a poor quartz, or
            filters what it reads: how the reading is off, not why
Limits      the same in all tests; what was read before the record of the base began shows the block as it was there.
            A lag tells from that of the base (`rocking.effects.base_motion_lag`) where a block is released alone
Source      none: a clock that is a straight line of another
Status      by hand, against runs that are asked for those moments, and learned from shaken tests (tests)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from rocking.effect import Effect


@dataclass(frozen=True)
class LearnedTiming(Effect):
    """How much faster time goes than the recorder says [1], and how late it is [s]."""

    pace: float = 0.0
    lag: float = 0.0

    name: ClassVar[str] = "learned_timing"
    units: ClassVar[dict[str, str]] = {"pace": "1", "lag": "s"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"pace": (-0.5, 0.5), "lag": (-10.0, 10.0)}

    def moments(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """When what is read at these times since the record began happened [s], none before that, shape (time,)."""
        return np.maximum((1.0 + self.pace) * np.asarray(time, dtype=np.float64) - self.lag, 0.0)
