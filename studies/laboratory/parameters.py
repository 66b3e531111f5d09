"""The block, its floor and everything that can be odd about them, as one vector for the compiled simulators.

All numbers are SI and radians.  Zero (or infinity, for the slack of a tether) means that an effect is absent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

G = 9.80665


@dataclass(frozen=True)
class World:
    """True block, floor and impact law; the defaults of everything but the block are those of the ideal case."""

    half_breadth: float  # of the base it stands on, m
    centre_height: float  # of the centre of mass over the base, m
    mass: float  # kg
    inertia: float  # about the centre of mass, kg m^2
    restitution: float
    # geometry of block and floor
    radius: float = 0.0  # of the edges, m
    offset: float = 0.0  # of the centre of mass toward +x, m
    tilt: float = 0.0  # of the floor, falling toward +x, rad
    # torques
    viscous: float = 0.0  # 1/s
    quadratic: float = 0.0  # 1/rad
    tether_stiffness: float = 0.0  # N m/rad
    tether_plus: float = math.inf  # slack toward +x, rad
    tether_minus: float = math.inf
    adhesion: float = 0.0  # N m, at lift-off from rest
    # impact law
    slope: float = 0.0  # of restitution against angular speed, s/rad
    side: float = 0.0  # restitution is e (1 + side) after a swing toward +x, e (1 - side) after one toward -x
    leak: float = 0.0  # restitution is e - leak exp(-time since the last impact / leak_time)
    leak_time: float = 1.0  # s
    bedding: float = 0.0  # restitution is e - bedding exp(-impacts so far / 4)
    grind: float = 0.0  # restitution is e - grind (1 - exp(-use / grind_use)), use the sum of squares of impact speeds
    grind_use: float = 1.0  # rad^2/s^2
    used: float = 0.0  # rad^2/s^2, use in the tests before
    heed: float = 0.0  # s^2/m, restitution lost by base acceleration in the sense in which the block falls on its edge
    # torques that no list has
    cubic: float = 0.0  # 1/(s^2 rad^2), angular acceleration -cubic theta^3
    hinge: float = 0.0  # 1/s^2 per rad of lean: Coulomb friction that grows with the lean
    guide: float = 0.0  # 1/s^2, Coulomb friction while leaning toward +x alone
    guide_from: float = 0.0  # rad, lean from which it rubs
    squeeze: float = 0.0  # 1/s, damping that fades with lean
    squeeze_width: float = 1.0  # rad
    side_viscous: float = 0.0  # 1/s, while leaning toward +x alone
    brake: float = 0.0  # 1/s, damping about one rotation alone
    brake_at: float = 0.0  # rad
    brake_width: float = 1.0  # rad
    rib: float = 0.0  # 1/s^2, amplitude of an angular acceleration periodic in rotation
    rib_period: float = 1.0  # rad
    magnet: float = 0.0  # 1/s^2, angular acceleration back toward upright, fading with lean
    magnet_width: float = 1.0  # rad
    layer: float = 0.0  # N m/rad, of a hysteretic spring (Bouc, 1967; Wen, 1976)
    layer_width: float = 1.0  # rad, at which it yields
    slosh_mass: float = 0.0  # kg, hung inside the block
    slosh_length: float = 1.0  # m
    slosh_height: float = 0.0  # m, of its hinge over the base
    slosh_damping: float = 0.0  # 1/s
    # contact, for the simulators that resolve it
    friction: float = math.inf
    stiffness: float = 0.0  # N/m of one corner, or of the whole bed
    damping: float = 0.0  # N s/m, likewise
    give: float = 1.0  # of a corner along the floor over that across it
    springs: float = 2.0  # under the base: two at the corners, or the points by which a bed is summed
    gravity: float = G

    def vector(self) -> np.ndarray:
        """All numbers in the order of the fields, shape (fields,)."""
        return np.array([float(getattr(self, f.name)) for f in fields(self)])

    @property
    def alpha(self) -> float:
        """Tilt of balance of the centred block [rad]."""
        return math.atan2(self.half_breadth, self.centre_height)

    @property
    def corner_inertia(self) -> float:
        """About a corner of the centred block [kg m^2]."""
        return self.inertia + self.mass * (self.half_breadth**2 + self.centre_height**2)


INDEX = {f.name: k for k, f in enumerate(fields(World))}


def refuse(world: object, foreign: tuple[str, ...], which: str) -> None:
    """Of the numbers named, each zero (or nothing) where its effect is absent, none may be there.

    Raises:
        ValueError: one is.
    """
    for name in foreign:
        if getattr(world, name) not in (0.0, ()):
            raise ValueError(f"{name}={getattr(world, name)!r}: not in the laboratory {which}")


def housner(breadth: float, height: float) -> float:
    """Restitution of a uniform block by conservation of angular momentum about the new pivot (Housner, 1963) [1]."""
    return 1.0 - 1.5 * breadth**2 / (breadth**2 + height**2)


def uniform(breadth: float, height: float, mass: float, restitution: float) -> World:
    """The ideal uniform block."""
    return World(0.5 * breadth, 0.5 * height, mass, mass * (breadth**2 + height**2) / 12.0, restitution)
