"""Parameters that the loop fits: a scale, bounds, and whether the logarithm is what is fitted.

Status   the steps of differences are held by derivatives at two steps (tests of `studies.loop.fits.linearising`)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

UNEVEN = 100.0
"""Times the usual step for what a floor gives: no event is located there, and the steps of a run leave an error as
uneven."""


@dataclass(frozen=True)
class Parameter:
    """A parameter to fit: its full name, typical size of a change, bounds, and whether its logarithm is fitted.

    coarser: how many times the usual step is taken for its slope.
    """

    name: str
    scale: float
    low: float = -math.inf
    high: float = math.inf
    log: bool = False
    coarser: float = 1.0

    def inner(self, value: float) -> float:
        """The number that is fitted."""
        return math.log(value) / self.scale if self.log else value / self.scale

    def outer(self, number: float) -> float:
        """The parameter, within its bounds."""
        value = math.exp(min(number * self.scale, 700.0)) if self.log else number * self.scale
        return min(max(value, self.low), self.high)

    def slope(self, value: float) -> float:
        """Derivative of the parameter by the number that is fitted."""
        return value * self.scale if self.log else self.scale
