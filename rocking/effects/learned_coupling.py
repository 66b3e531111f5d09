"""Learned coupling: the base sensor does not follow slow motion, as one that is coupled through a capacitor.

Changes     the horizontal base motion: a_x + w v, v the recorded acceleration integrated from rest,
            w = 2 pi corner_frequency: what a first-order high-pass has taken off
Parameters  corner_frequency [Hz], at which the sensor passes 0.71 of a sinusoid; 0 where it is absent
Use when    a piezoelectric accelerometer or an amplifier without direct coupling recorded the base, or a record was
            high-passed before it was handed over
Limits      first order, and causal from the first sample on; a drift of the record is integrated with it; after the
            record the base is at rest, whatever its velocity was; nothing of a vertical channel
Source      own derivation: the inverse of s / (s + w); the integral is that of straight lines between samples
Status      a sine pulse, a record that went through SciPy's high-pass, and the absent value (tests)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from rocking.altered import AlteredMotion, samples_of, table, table_value
from rocking.effect import Effect
from rocking.motion import BaseMotion

_inner: Any = None
_split: Any = None


def _with_slow_motion(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    a_x, a_z = _inner(xp, t, par[:_split])
    return a_x + table_value(xp, t, par[_split:], 0.0), a_z


@dataclass(frozen=True)
class LearnedCoupling(Effect):
    """A base sensor that loses slow motion: its corner frequency [Hz]."""

    corner_frequency: float = 0.0

    name: ClassVar[str] = "learned_coupling"
    units: ClassVar[dict[str, str]] = {"corner_frequency": "Hz"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"corner_frequency": (0.0, 100.0)}
    rank: ClassVar[int] = 1  # integrated after a late clock was set right: its table ends with the run

    def base_motion(self, motion: BaseMotion, span: tuple[float, float], g: float) -> BaseMotion:
        """The motion with what the sensor lost."""
        if self.corner_frequency == 0.0:
            return motion
        start, step, a_x, own = samples_of(motion, span)
        moving = a_x[:own]
        velocity = np.zeros(a_x.size)
        velocity[1:own] = step * np.cumsum(0.5 * (moving[1:] + moving[:-1]))
        numbers = table(span, start, step, 2.0 * math.pi * self.corner_frequency * velocity, part=slice(own))
        label = f"what a sensor lost below {self.corner_frequency:g} Hz"
        return AlteredMotion(motion, numbers, kernel=_with_slow_motion, max_step=step, label=label)
