"""Sliding: friction gives way.

Changes     the modes: Method 2 (Ishiyama's six) in place of Method 1.  On a floor that gives, or beside a bounce that
            lasts, it is the friction of the corners there, and nothing else (`rocking.soft_floor`)
Parameters  friction mu [1], static and kinetic; no slip at any load (infinite) where it is absent; ratio_kept [1],
            what an impact keeps of the ratio of angular velocities where the base slides; beside bouncing nothing
Use when    the base acceleration comes near mu g, or the block is stocky
Limits      those of Method 2; a given restitution is carried by its two-corner law, one below Housner's with a couple
            that resists the rotation.  Not with effects that have further freedoms
Source      Ishiyama (1982); `rocking.method2`
Status      tests of Method 2
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from rocking.effect import Effect
from rocking.form import Form
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

    def modes(self, method: Method1 | Method2, form: Form | None) -> Method2:
        """The block under Method 2 with this friction.

        Raises:
            ValueError: Method 2 cannot have these numbers, or another effect has given a friction.
        """
        if isinstance(method, Method2):
            if method.friction < math.inf:
                raise ValueError(
                    f"sliding.friction={self.friction!r}: bouncing.friction={method.friction!r} says it too"
                )
            if method.normal_restitution > 0.0:
                return replace(method, friction=self.friction)  # the ratio of what bounces follows from the bounces
            return replace(method, friction=self.friction, **self._law(method, form))
        return Method2(
            method.block, friction=self.friction, g=method.g, rest_speed=method.rest_speed, form=form,
            **self._law(method, form),
        )  # fmt: skip

    def _law(self, method: Method1 | Method2, form: Form | None) -> dict[str, Any]:
        """The law of impacts that carries restitution and `ratio_kept`: frictional impacts have Housner's and 0."""
        e = method.restitution
        if e is None and self.ratio_kept == 0.0:
            return {}
        if e is None:
            e = max(method.block.housner_restitution, 0.0) if form is None else form.housner_restitution
        return {"impact_law": "two_corner", "restitution": e, "ratio_kept": self.ratio_kept}
