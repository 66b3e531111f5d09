"""What pulses share: an amplitude, a time scale, and when they begin.

One pulse, one file (`pulse_*.py`): each states its formula, the paper it is from and what it was checked against.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from excitation.checks import finite, not_zero, positive
from excitation.motion import Motion


def inside(t: Any, par: Any) -> Any:
    """Whether t lies within the pulse, both ends in it; par begins with [amplitude, omega, start, duration]."""
    return (t >= par[2]) & (t <= par[2] + par[3])


@dataclass(frozen=True)
class FinitePulse(Motion):
    """A pulse that begins at `start` and is over after `duration`; the base is at rest before and after.

    Args:
        amplitude: a_p [m/s^2], not zero; negative for a pulse the other way.
        period: T_p [s], positive.
        start: when it begins [s].

    Raises:
        ValueError: an argument is out of the range above.
    """

    amplitude: float
    period: float
    start: float = 0.0

    def __post_init__(self) -> None:
        not_zero("amplitude", self.amplitude, "m/s^2")
        positive("period", self.period, "s")
        finite("start", self.start, "s")

    @property
    def duration(self) -> float:
        """Time [s] from start to end: one period."""
        return self.period

    @property
    def end(self) -> float:
        """Time [s] after which the base is at rest."""
        return self.start + self.duration

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        return np.array([self.amplitude, 2.0 * math.pi / self.period, self.start, self.duration])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return (self.start, self.end)

    @property
    def max_step(self) -> float:
        return 0.05 * self.period


@dataclass(frozen=True)
class CentredPulse(Motion):
    """A pulse around `centre` whose tails fade out without an end.

    Args:
        amplitude: largest acceleration a_p [m/s^2], not zero; negative for a pulse the other way.
        period: T_p [s], positive.
        centre: time of the middle [s]; two and a half periods if not given, when the tail at 0 is below 1e-15 a_p.

    Raises:
        ValueError: an argument is out of the range above.
    """

    amplitude: float
    period: float
    centre: float | None = None

    def __post_init__(self) -> None:
        not_zero("amplitude", self.amplitude, "m/s^2")
        positive("period", self.period, "s")
        if self.centre is not None:
            finite("centre", self.centre, "s")

    @property
    def middle(self) -> float:
        """Time of the middle [s]."""
        return 2.5 * self.period if self.centre is None else self.centre

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        return np.array([self.amplitude, 2.0 * math.pi / self.period, self.middle])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """None: the pulse is smooth everywhere."""
        return ()

    @property
    def max_step(self) -> float:
        return 0.05 * self.period
