"""The rectangular pulse: constant acceleration for a while.

    a_x(t) = a_p,   start <= t <= start + duration

Source   Housner (1963), The behavior of inverted pendulum structures during earthquakes.
Status   closed form; with it a block just overturns when exp(p duration) = A/(A - 1), A = a_p/(g alpha), if linear.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from excitation.checks import finite, not_zero, positive
from excitation.motion import Motion


def _acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z) [m/s^2] at t; par = [amplitude, start, duration]."""
    return xp.where((t >= par[1]) & (t <= par[1] + par[2]), par[0], 0.0), 0.0 * t


@dataclass(frozen=True)
class RectangularPulse(Motion):
    """A constant acceleration from `start` for `duration`.

    Args:
        amplitude: a_p [m/s^2], not zero; negative for a push the other way.
        duration: [s], positive.
        start: when it begins [s].

    Raises:
        ValueError: an argument is out of the range above.
    """

    amplitude: float
    duration: float
    start: float = 0.0

    kernel = staticmethod(_acceleration)

    def __post_init__(self) -> None:
        not_zero("amplitude", self.amplitude, "m/s^2")
        positive("duration", self.duration, "s")
        finite("start", self.start, "s")

    @property
    def end(self) -> float:
        """Time [s] after which the base is at rest."""
        return self.start + self.duration

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        return np.array([self.amplitude, self.start, self.duration])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return (self.start, self.end)

    @property
    def max_step(self) -> float:
        return self.duration
