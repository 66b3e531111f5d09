"""Rounded edges: the block rolls on worn edges of a finite radius instead of turning about a sharp corner.

Changes     the levers: the block stands on b - 2 r and rolls on arcs of radius r (`rocking.form`)
Parameters  radius r [m]; 0 where it is absent
Use when    edges are worn, chamfered or crushed
Limits      both edges alike, one radius; rolls without slipping; r below half of the breadth
Source      own derivation (`rocking.form`)
Status      equation of motion against Lagrange's by computer algebra, energy in free rocking (tests)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from rocking.block import Block
from rocking.effect import Effect
from rocking.form import Form


@dataclass(frozen=True)
class RoundedEdges(Effect):
    """Edges of a finite radius [m]."""

    radius: float = 0.0

    name: ClassVar[str] = "rounded_edges"
    units: ClassVar[dict[str, str]] = {"radius": "m"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"radius": (0.0, math.inf)}

    def form(self, form: Form, block: Block) -> Form:
        """Half of the breadth less r, edges of radius r."""
        if not self.radius < form.half_breadth:
            raise ValueError(
                f"rounded_edges.radius={self.radius!r} m: want less than half of the breadth, {form.half_breadth!r} m"
            )
        return form.edited(half_breadth=form.half_breadth - self.radius, edge_radius=self.radius)
