"""Compliant base: the floor gives under the corners.

Adds        two freedoms, springs and dashpots under the corners or spread under the base (`rocking.soft_floor`)
Parameters  corner_stiffness k [N/m], infinite (rigid) where it is absent; damping_ratio xi = c / (2 sqrt(k m)) [1] of
            a corner, which takes the place of restitution; spread [1], the share of the normal springs and dashpots
            that is a Winkler bed as stiff in all as two corners, 0 where it is absent; tangential_ratio [1], a
            corner's stiffness along the floor over k, 1 where it is absent, infinite where the floor gives downward
            alone and the lower corner stays in its place (`rocking.downward_floor`); friction mu of the corners [1],
            infinite where it is absent: then they are held until they leave the floor, which makes impacts harder than
            those of any foot that friction holds.  spring_slider [1]: 1 where friction limits the spring along the
            floor alone (`rocking.spring_slider`), 2 where it is that of the spring into it alone, too, 0 (unless given)
            where it limits spring and dashpot in series
Use when    the block stands on rubber, soil or a soft table, or rattles audibly
Limits      on a bed the corners alone are held along the floor, by the friction of the whole bed; not together with
            rounded_edges.  Beside sliding its friction is that of the corners
Source      Psycharis & Jennings (1983), Earthquake Eng. Struct. Dyn. 11, 57-76
Status      see `rocking.soft_floor`, `rocking.spring_slider` and `rocking.downward_floor`
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

from rocking.composed import ComposedMethod1
from rocking.downward_floor import BlockOnDownwardFloor
from rocking.effect import Effect
from rocking.hybrid import System
from rocking.spring_slider import sliding_as


@dataclass(frozen=True)
class CompliantBase(Effect):
    """Stiffness of a corner [N/m], its damping ratio, what of it is a bed, stiffness along the floor, friction, and
    whether that limits the spring alone."""

    corner_stiffness: float = math.inf
    damping_ratio: float = 1.0
    spread: float = 0.0
    tangential_ratio: float = 1.0
    friction: float = math.inf
    spring_slider: float = 0.0

    name: ClassVar[str] = "compliant_base"
    units: ClassVar[dict[str, str]] = {
        "corner_stiffness": "N/m",
        "damping_ratio": "1",
        "spread": "1",
        "tangential_ratio": "1",
        "friction": "1",
        "spring_slider": "1",
    }
    ranges: ClassVar[dict[str, tuple[float, float]]] = {
        "corner_stiffness": (0.0, math.inf),
        "damping_ratio": (0.0, 10.0),
        "spread": (0.0, 1.0),
        "tangential_ratio": (0.0, math.inf),
        "friction": (0.0, math.inf),
        "spring_slider": (0.0, 2.0),
    }
    unbounded: ClassVar[frozenset[str]] = frozenset({"tangential_ratio"})

    def has_feet(self) -> bool:
        """Where the floor gives."""
        return self.corner_stiffness < math.inf

    def freedoms(self, system: ComposedMethod1) -> System:
        """The block on springs; the rigid one if they are infinitely stiff.

        Raises:
            ValueError: numbers that do not go together.
        """
        if self.corner_stiffness == math.inf:
            return system
        made: Callable[..., System] = sliding_as(self.name, self.spring_slider)
        if self.tangential_ratio == math.inf:
            if self.spring_slider:
                raise ValueError(
                    f"compliant_base.spring_slider={self.spring_slider!r}: want 0 beside "
                    "compliant_base.tangential_ratio=inf, with which nothing slips"
                )
            made = BlockOnDownwardFloor
        return made(
            system, self.corner_stiffness, self.damping_ratio, self.spread, self.tangential_ratio, self.friction
        )
