"""The form of a block that is no ideal rectangle: what it stands on, how its edges are rounded, where its mass is.

In the mirrored frame of the carrying side s (phi = s theta >= 0, the floor's x axis along s) the block rolls on an
edge of radius r, whose centre stands at x = a + r phi, z = r.  With q = a - s o and H' = H - r the centre of mass is at

    x = a + r phi - q cos(phi) + H' sin(phi),    z = r + q sin(phi) + H' cos(phi)

so that x' = dx/dphi = r + q sin + H' cos, z' = q cos - H' sin, and the block balances where z' = 0.

Source   own derivation; Housner (1963) and `rocking.method1` are the case r = 0, a = b/2, o = 0, H = h/2.
Status   the block rolls without slipping and stands on the flat part between its two edges when upright.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from rocking.block import Block
from rocking.validation import as_floats


@dataclass(frozen=True)
class Form:
    """Shape and mass of a block as far as rocking knows them.

    Args:
        half_breadth: a, half of the flat part that it stands on [m].
        edge_radius: r [m], 0 or more.
        offset: o, centre of mass to the +x side of the middle [m].
        mass_height: H, centre of mass above the floor when upright [m].
        mass: [kg].
        inertia: about the centre of mass [kg m^2].
        adhesion: moment [N m] beyond West's formula that lift-off from rest takes.
        apart: how far a given restitution is apart on both sides [1]: 1 as the kept angular momentum has it, 0 alike.

    Raises:
        ValueError: a number is out of its range, or the centre of mass is not above the flat part.
    """

    half_breadth: float
    edge_radius: float
    offset: float
    mass_height: float
    mass: float
    inertia: float
    adhesion: float = 0.0
    apart: float = 1.0

    def __post_init__(self) -> None:
        for name, unit in (("half_breadth", "m"), ("mass_height", "m"), ("mass", "kg"), ("inertia", "kg m^2")):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{name}={value!r} {unit}: want a positive number")
        for name, unit in (("edge_radius", "m"), ("adhesion", "N m")):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f"{name}={value!r} {unit}: want 0 or more")
        as_floats(self, "half_breadth", "edge_radius", "offset", "mass_height", "mass", "inertia", "adhesion", "apart")
        if not 0.0 <= self.apart <= 1.0:
            raise ValueError(f"apart={self.apart!r}: want a number from 0 to 1")
        if not abs(self.offset) < self.half_breadth:
            raise ValueError(
                f"offset={self.offset!r} m: want less than half of the breadth it stands on, {self.half_breadth!r} m"
            )
        if not self.edge_radius < self.mass_height:
            raise ValueError(
                f"edge_radius={self.edge_radius!r} m: want less than the height of the centre of mass, "
                f"{self.mass_height!r} m"
            )

    @classmethod
    def of(cls, block: Block) -> Form:
        """The uniform rectangle with sharp edges."""
        return cls(0.5 * block.b, 0.0, 0.0, 0.5 * block.h, block.mass, block.I_c)

    def edited(self, **changes: float) -> Form:
        """The same form with some of its numbers replaced."""
        return replace(self, **changes)

    @property
    def rho2(self) -> float:
        """Square of the radius of gyration about the centre of mass [m^2]."""
        return self.inertia / self.mass

    def theta_c(self, s: float) -> float:
        """Tilt of unstable balance to the side s [rad], positive: where z' = 0."""
        return math.atan2(self.half_breadth - s * self.offset, self.mass_height - self.edge_radius)

    def angular_inertia(self, s: float) -> float:
        """rho2 + x'^2 + z'^2 on the side s when upright [m^2]: inertia per mass about the edge of contact."""
        return self.rho2 + self.mass_height**2 + (self.half_breadth - s * self.offset) ** 2

    def restitution(self, s: float) -> float:
        """Angular velocity after / before the impact at which the side s hands over to the other [1].

        Angular momentum about the new edge is kept (Housner 1963, here for any form):

            (rho2 + H^2 + o^2 - a^2) / (rho2 + H^2 + (o + s a)^2)
        """
        momentum = self.rho2 + self.mass_height**2 + self.offset**2 - self.half_breadth**2
        return momentum / self.angular_inertia(-s)

    @property
    def housner_restitution(self) -> float:
        """Geometric mean of both sides' restitution [1]; 0 where one is below 0."""
        right, left = self.restitution(1.0), self.restitution(-1.0)
        return math.sqrt(right * left) if right > 0.0 and left > 0.0 else 0.0

    def restitutions(self, given: float | None) -> tuple[float, float]:
        """Restitution of eq. (4) when the +x and when the -x edge hands over [1].

        A given one is what was measured: their geometric mean, the two apart as the form would have them, to the power
        of `apart`.  Where that of the form is below zero the block lands on both edges and stops.

        Raises:
            ValueError: one of the two would be above 1.
        """
        right, left = self.restitution(1.0), self.restitution(-1.0)
        if given is None:
            return max(right, 0.0), max(left, 0.0)
        if right <= 0.0 or left <= 0.0:
            return given, given
        apart = (right / left) ** (0.5 * self.apart)
        both = given * apart, given / apart
        if max(both) > 1.0:
            raise ValueError(
                f"restitution={given!r}: with the centre of mass {self.offset:.4g} m off the middle one side would "
                f"have {max(both):.4g}; want a smaller one, since 1 loses nothing"
            )
        return both

    def friction_to_stick(self, given: float | None = None) -> float:
        """Friction [1] with which neither corner slips in an impact of this restitution (`restitutions`)."""
        needed = []
        for s, e in zip((1.0, -1.0), self.restitutions(given), strict=True):
            arm = self.half_breadth + s * self.offset  # of the corner that takes over
            needed.append(self.mass_height * (1.0 - e) / (2.0 * self.half_breadth - (1.0 - e) * arm))
        return max(needed)


def levers(xp: Any, phi: Any, a: Any, r: Any, q: Any, H: Any) -> tuple[Any, Any, Any, Any]:
    """(x, z, x', z') [m] of the centre of mass in the mirrored frame; H is its height less r."""
    sin, cos = xp.sin(phi), xp.cos(phi)
    along, up = H * sin - q * cos, H * cos + q * sin
    return a + r * phi + along, r + up, r + up, -along
