"""Sliding: friction gives way.

Changes     the modes: Method 2 (Ishiyama's six) in place of Method 1
Parameters  friction mu [1], static and kinetic; no slip at any load (infinite) where it is absent; ratio_kept [1],
            what an impact keeps of the ratio of angular velocities where the base slides
Use when    the base acceleration comes near mu g, or the block is stocky
Limits      those of Method 2; a given restitution is carried by its two-corner law, which cannot have one below
            Housner's
Source      Ishiyama (1982); `rocking.method2`
Status      tests of Method 2
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from rocking.effect import Effect
from rocking.hybrid import System
from rocking.method1 import Method1
from rocking.method2 import Method2


@dataclass(frozen=True)
class Sliding(Effect):
    """Friction coefficient [1]; infinite if not given.  `ratio_kept` of `rocking.Method2` [1]."""

    friction: float = math.inf
    ratio_kept: float = 0.0

    name: ClassVar[str] = "sliding"
    units: ClassVar[dict[str, str]] = {"friction": "1", "ratio_kept": "1"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"friction": (0.0, math.inf), "ratio_kept": (0.0, 1.0)}

    def modes(self, method: Method1 | Method2) -> System:
        """The block under Method 2 with this friction.

        Raises:
            ValueError: Method 2 cannot have these numbers, or another effect has given a friction.
        """
        if isinstance(method, Method2):
            if method.friction < math.inf:
                raise ValueError(
                    f"sliding.friction={self.friction!r}: bouncing.friction={method.friction!r} says it too"
                )
            return replace(method, friction=self.friction, ratio_kept=self.ratio_kept)
        law: dict[str, Any] = {}
        if method.restitution is not None or self.ratio_kept > 0.0:
            law = {"impact_law": "two_corner", "restitution": method.e, "ratio_kept": self.ratio_kept}
        return Method2(method.block, friction=self.friction, g=method.g, rest_speed=method.rest_speed, **law)
