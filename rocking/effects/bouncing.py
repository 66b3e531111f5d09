"""Bouncing: the corner leaves the floor after an impact.

Changes     the modes: Method 2 (Ishiyama's six) in place of Method 1, with a normal restitution and no slip limit but
            that of friction
Parameters  normal_restitution e_n [1], 0 where it is absent; it takes the place of restitution.  friction mu [1],
            infinite where it is absent
Use when    short blocks or stiff floors: after an impact the corner is seen to lift
Limits      those of Method 2; impacts are frictional (Chatterjee & Ruina 1998), so that e of eq. (4) follows: near
            Housner's, and the lower the more the corner bounces
Source      Ishiyama (1982); Lipscombe & Pellegrino (1993) for bouncing of short blocks; `rocking.method2`
Status      tests of Method 2
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

from rocking.effect import Effect
from rocking.hybrid import System
from rocking.method1 import Method1
from rocking.method2 import Method2


@dataclass(frozen=True)
class Bouncing(Effect):
    """Normal restitution [1] of a corner, and friction [1] (infinite if not given)."""

    normal_restitution: float = 0.0
    friction: float = math.inf

    name: ClassVar[str] = "bouncing"
    units: ClassVar[dict[str, str]] = {"normal_restitution": "1", "friction": "1"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"normal_restitution": (0.0, 1.0), "friction": (0.0, math.inf)}

    def modes(self, method: Method1 | Method2) -> System:
        """The block under Method 2 with this restitution of its corners.

        Raises:
            ValueError: Method 2 cannot have these numbers, or another effect has given a friction.
        """
        if isinstance(method, Method2):
            if self.friction < math.inf:
                raise ValueError(
                    f"bouncing.friction={self.friction!r}: sliding.friction={method.friction!r} says it too"
                )
            if self.normal_restitution == 0.0:
                return method
            return replace(
                method, normal_restitution=self.normal_restitution, impact_law="frictional", restitution=None
            )
        law = {}
        if self.normal_restitution == 0.0 and method.restitution is not None:
            law = {"impact_law": "two_corner", "restitution": method.restitution}
        return Method2(
            method.block, friction=self.friction, normal_restitution=self.normal_restitution, g=method.g,
            rest_speed=method.rest_speed, **law,  # type: ignore[arg-type]
        )  # fmt: skip
