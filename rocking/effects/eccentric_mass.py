"""Eccentric mass: the centre of mass is off the middle of the base.

Changes     the levers of the two sides: balance, lift-off and restitution differ between left and right
Parameters  offset [m], toward +x; 0 where it is absent; apart, how far a given restitution is apart on both sides [1]:
            1 as the kept angular momentum has it, 0 alike
Use when    the block is not uniform, or carries instruments on one side
Limits      less than half of the breadth; the inertia about the centre of mass stays as it is
Source      own derivation (`rocking.form`)
Status      mirror image, closed forms of each side (tests)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from rocking.block import Block
from rocking.effect import Effect
from rocking.form import Form


@dataclass(frozen=True)
class EccentricMass(Effect):
    """Offset of the centre of mass toward +x [m], and how far a given restitution is `apart` on both sides [1]."""

    offset: float = 0.0
    apart: float = 1.0

    name: ClassVar[str] = "eccentric_mass"
    units: ClassVar[dict[str, str]] = {"offset": "m", "apart": "1"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"apart": (0.0, 1.0)}

    def form(self, form: Form, block: Block) -> Form:
        """The centre of mass moved by the offset."""
        return form.edited(offset=form.offset + self.offset, apart=self.apart)
