"""Concave base: the block stands on less than its full breadth.

Changes     the breadth between the edges that touch, so the tilt of unstable balance, lift-off and restitution
Parameters  breadth [m]; the block's own where it is absent
Use when    the underside is hollow, or feet stand in from the sides
Limits      symmetric; mass and inertia stay as they are
Source      Housner (1963) with another breadth at the floor
Status      closed forms of the narrower base (tests)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from rocking.block import Block
from rocking.effect import Effect
from rocking.form import Form


@dataclass(frozen=True)
class ConcaveBase(Effect):
    """Breadth that the block stands on [m]; its own if not given."""

    breadth: float | None = None

    name: ClassVar[str] = "concave_base"
    units: ClassVar[dict[str, str]] = {"breadth": "m"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"breadth": (0.0, math.inf)}

    @classmethod
    def absent(cls, block: Block) -> dict[str, float]:
        """The breadth of the block."""
        return {"breadth": block.b}

    def form(self, form: Form, block: Block) -> Form:
        """Half of the breadth, less by half of what is missing."""
        if self.breadth is None:
            return form
        return form.edited(half_breadth=form.half_breadth - 0.5 * (block.b - self.breadth))
