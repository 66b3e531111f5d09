"""Mass distribution: centre of mass and inertia are not those of a uniform rectangle.

Changes     height of the centre of mass and moment of inertia about it
Parameters  height [m] of the centre of mass; inertia [kg m^2] about it; the uniform block's where they are absent
Use when    instruments or a head sit on top, the block is hollow or of two materials
Limits      the total mass stays as it is; symmetric
Source      Newton's law with other constants
Status      closed forms with the other p and balance (tests)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from rocking.block import Block
from rocking.effect import Effect
from rocking.form import Form


@dataclass(frozen=True)
class MassDistribution(Effect):
    """Height [m] of the centre of mass and inertia [kg m^2] about it; the uniform block's if not given."""

    height: float | None = None
    inertia: float | None = None

    name: ClassVar[str] = "mass_distribution"
    units: ClassVar[dict[str, str]] = {"height": "m", "inertia": "kg m^2"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"height": (0.0, math.inf), "inertia": (0.0, math.inf)}

    @classmethod
    def absent(cls, block: Block) -> dict[str, float]:
        """Those of a uniform rectangle."""
        return {"height": 0.5 * block.h, "inertia": block.I_c}

    def form(self, form: Form, block: Block) -> Form:
        """The form with the other centre of mass and inertia."""
        changes = {"mass_height": self.height, "inertia": self.inertia}
        return form.edited(**{name: value for name, value in changes.items() if value is not None})
