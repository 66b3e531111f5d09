"""Base motion lag: the clock of the base sensor is late.

Changes     the base motion: what the record shows at t + lag happens at t
Parameters  lag [s], how late the record is; 0 where it is absent
Use when    base and response were recorded by different devices
Limits      constant in time
Source      none: a shift of the clock
Status      tests
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from rocking.altered import AlteredMotion
from rocking.effect import Effect
from rocking.motion import BaseMotion

_inner: Any = None
_inner_pitch: Any = None
_split: Any = None


def _earlier(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    return _inner(xp, t + par[_split], par[:_split])


def _pitch_earlier(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    return _inner_pitch(xp, t + par[_split], par[:_split])


@dataclass(frozen=True)
class BaseMotionLag(Effect):
    """How late the record of the base is [s]."""

    lag: float = 0.0

    name: ClassVar[str] = "base_motion_lag"
    units: ClassVar[dict[str, str]] = {"lag": "s"}
    rank: ClassVar[int] = 0

    def base_motion(self, motion: BaseMotion, span: tuple[float, float], g: float) -> BaseMotion:
        """The motion earlier by the lag."""
        pitch = _pitch_earlier if getattr(motion, "pitch_kernel", None) is not None else None
        return AlteredMotion(
            motion, [self.lag], kernel=_earlier, pitch=pitch, late=self.lag, label=f"record late by {self.lag:g} s"
        )
