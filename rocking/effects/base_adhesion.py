"""Base adhesion: the block lifts off only under more than the moment of West's formula.

Changes     lift-off from rest: the overturning moment has to exceed that of the weight by `moment`
Parameters  moment [N m]; 0 where it is absent
Use when    dust, mortar, paint or suction holds the base
Limits      breaks at once and for the whole motion until the block stands still again; impacts in between are free
Source      own statement
Status      onset against the balance of moments (tests)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from rocking.block import Block
from rocking.effect import Effect
from rocking.form import Form


@dataclass(frozen=True)
class BaseAdhesion(Effect):
    """Moment that holds the block at rest [N m]."""

    moment: float = 0.0

    name: ClassVar[str] = "base_adhesion"
    units: ClassVar[dict[str, str]] = {"moment": "N m"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"moment": (0.0, math.inf)}

    def form(self, form: Form, block: Block) -> Form:
        """The form with the adhesion added."""
        return form.edited(adhesion=form.adhesion + self.moment)
