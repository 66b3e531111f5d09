"""Velocity-dependent restitution: what an impact keeps depends on its speed.

Changes     e -> e + slope |omega|, kept within 0 and 1
Parameters  slope [s/rad]; 0 where it is absent
Use when    fast impacts lose more (crushing, slope < 0) or less than slow ones
Limits      linear in speed over the range that was measured
Source      form: the simplest dependence; that measured restitution departs from Housner's, ElGawady et al. (2011)
Status      ratio of speeds at each impact of a free decay (tests)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from rocking.effect import Effect


def steeper(xp: Any, e: Any, omega: Any, s: Any, values: Any) -> Any:
    """e + slope |omega| [1]."""
    return e + values[0] * xp.abs(omega)


@dataclass(frozen=True)
class VelocityDependentRestitution(Effect):
    """Restitution linear in angular speed; slope [s/rad]."""

    slope: float = 0.0

    name: ClassVar[str] = "velocity_dependent_restitution"
    units: ClassVar[dict[str, str]] = {"slope": "s/rad"}
    restitution = staticmethod(steeper)

    def strikes(self) -> bool:
        """With any slope."""
        return self.slope != 0.0
