"""A free-standing rectangular block: its size, mass and the constants of rocking that follow from them.

Source   Housner (1963) for R, alpha, p and the restitution; Winkler, Meguro & Yamazaki (1995), Table 1, for names.
Status   a uniform rectangle; what departs from it is an effect, not a block.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from rocking.validation import as_floats, positive

G_STANDARD = 9.80665
"""Standard acceleration of gravity [m/s^2] (CGPM 1901)."""

WOOD_DENSITY = 597.0
"""Density [kg/m^3] at which Block 4 of the paper weighs the 1.4 kg that the paper gives."""


@dataclass(frozen=True)
class Block:
    """A uniform rectangular block that rocks in the plane of its breadth and height.

    Args:
        b: breadth [m], positive.
        h: height [m], positive.
        d: depth [m], positive, out of the plane of motion; it matters for the mass alone.
        density: density [kg/m^3], positive.

    Raises:
        ValueError: a size or the density is not a positive finite number.
    """

    b: float
    h: float
    d: float = 1.0
    density: float = WOOD_DENSITY

    def __post_init__(self) -> None:
        for name, unit in (("b", "m"), ("h", "m"), ("d", "m"), ("density", "kg/m^3")):
            positive(name, getattr(self, name), unit)
        as_floats(self, "b", "h", "d", "density")

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return self.density * self.b * self.h * self.d

    @property
    def R(self) -> float:
        """Half of the diagonal [m]: from a bottom corner to the centre of mass."""
        return 0.5 * math.hypot(self.b, self.h)

    @property
    def alpha(self) -> float:
        """Slenderness angle [rad], atan(b/h): also the tilt of unstable balance theta_c on a level base."""
        return math.atan2(self.b, self.h)

    @property
    def I_c(self) -> float:
        """Moment of inertia [kg m^2] about the centre of mass."""
        return self.mass * (self.b**2 + self.h**2) / 12.0

    @property
    def I_O(self) -> float:
        """Moment of inertia [kg m^2] about a bottom corner."""
        return self.I_c + self.mass * self.R**2

    def p(self, g: float = G_STANDARD) -> float:
        """Frequency parameter [rad/s], sqrt(m g R / I_O)."""
        return math.sqrt(self.mass * g * self.R / self.I_O)

    @property
    def housner_restitution(self) -> float:
        """Ratio of the angular velocities after and before an impact, 1 - 1.5 sin^2(alpha) [1].

        Housner (1963): angular momentum about the new corner is kept.  Below zero for b/h > sqrt(2), where the block
        lands on both corners and stops: to turn back, the floor would have to pull at the old one.
        """
        return 1.0 - 1.5 * math.sin(self.alpha) ** 2
