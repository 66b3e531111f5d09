"""What is simulated: rigid convex bodies, walls fixed to the table, and the floor.

Source  none, own convention; signs as in the package head
Status  overlapping, dented and empty bodies are refused with their numbers (tests)
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from dem import checks
from dem.initial_contacts import depths, near_pairs, outlines_of
from dem.materials import Contacts, ContactTable, contact_table
from dem.shapes import FloatArray, Polygon, convex

Thing = TypeVar("Thing")

TOUCHING = 1e-9  # bodies may overlap by this share of their size at the start, for rounding of coordinates


@dataclass(frozen=True, repr=False)
class Body:
    """One movable prism; build it with `body` from its corners where they are.

    shape: outline about its centroid, as it lies; x, z: centroid in the frame of the table [m]
    depth [m], density [kg/m^3]; vx, vz, omega: velocities relative to the table [m/s, rad/s]; material, name
    """

    shape: Polygon
    x: float
    z: float
    depth: float
    density: float
    vx: float = 0.0
    vz: float = 0.0
    omega: float = 0.0
    material: str = "block"
    name: str = ""

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        return f"<Body{name}: {self.shape.outline} at ({self.x:.4g}, {self.z:.4g}) m, mass {self.mass:.4g} kg>"

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return self.density * self.depth * self.shape.area

    @property
    def inertia(self) -> float:
        """Moment of inertia about the centroid [kg m^2]."""
        return self.density * self.depth * self.shape.second_moment

    @property
    def vertices(self) -> FloatArray:
        """Corners in the frame of the table [m], shape (corner, 2)."""
        return self.shape.corners + np.array([self.x, self.z])

    def moving(self, vx: float = 0.0, vz: float = 0.0, omega: float = 0.0) -> Body:
        """The same body with these velocities [m/s, rad/s]."""
        return replace(self, vx=vx, vz=vz, omega=omega)


@dataclass(frozen=True, repr=False)
class Wall:
    """A convex polygon fixed to the table; build it with `wall`."""

    shape: Polygon
    x: float
    z: float
    material: str = "table"
    name: str = ""

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        return f"<Wall{name}: {self.shape.outline} at ({self.x:.4g}, {self.z:.4g}) m>"

    @property
    def vertices(self) -> FloatArray:
        """Corners in the frame of the table [m], shape (corner, 2)."""
        return self.shape.corners + np.array([self.x, self.z])


def body(
    vertices: npt.ArrayLike, depth: float, density: float, *, material: str = "block", name: str = ""
) -> Body:  # fmt: skip
    """A body at rest with its corners where they are.

    vertices: [m], shape (corner, 2), columns x and z in the frame of the table; depth [m]; density [kg/m^3]
    Raises ValueError for a polygon that is not convex or has no area, or unless depth and density are positive.
    """
    checks.positive("depth", depth, "m")
    checks.positive("density", density, "kg/m^3")
    shape, (x, z) = convex(vertices)
    return Body(shape, x, z, float(depth), float(density), material=material, name=name)


def block(
    b: float, h: float, depth: float, density: float, *, x: float = 0.0, z: float = 0.0, tilt: float = 0.0,
    material: str = "block", name: str = "",
) -> Body:  # fmt: skip
    """A rectangular block of breadth b and height h [m] whose lowest point is at height z [m] and whose centroid is at
    x [m], turned clockwise by tilt [rad]. Raises ValueError as `body`."""
    for label, value in (("b", b), ("h", h)):
        checks.positive(label, value, "m")
    for label, value in (("x", x), ("z", z), ("tilt", tilt)):
        checks.finite(label, value, "rad" if label == "tilt" else "m")
    cos, sin = math.cos(tilt), math.sin(tilt)
    flat = np.array([[-b, -h], [b, -h], [b, h], [-b, h]]) / 2.0
    turned = np.column_stack([flat[:, 0] * cos + flat[:, 1] * sin, flat[:, 1] * cos - flat[:, 0] * sin])
    turned += [x, z - turned[:, 1].min()]
    return body(turned, depth, density, material=material, name=name)


def wall(vertices: npt.ArrayLike, *, material: str = "table", name: str = "") -> Wall:
    """A polygon fixed to the table: vertices [m], shape (corner, 2). Raises ValueError unless it is convex."""
    shape, (x, z) = convex(vertices)
    return Wall(shape, x, z, material, name)


def bodies_of(
    outlines: Iterable[npt.ArrayLike],
    depth: float,
    density: float,
    *,
    material: str = "block",
    names: Sequence[str] = (),
) -> tuple[Body, ...]:
    """Bodies of one depth [m] and density [kg/m^3] from the corners of each [m], shape (corner, 2).

    names: one for each body, or none at all
    Raises ValueError as `body`, with the number of the body.
    """
    made = []
    if not isinstance(outlines, Iterable):
        raise ValueError(f"outlines={outlines!r}: want the corners of each body [m]")
    outlines = list(outlines)
    listed = isinstance(names, Iterable) and not isinstance(names, str)
    called = list(names) if listed else []
    fits = len(called) in (0, len(outlines)) and all(isinstance(name, str) for name in called)
    if not (listed and fits):
        raise ValueError(f"names={names!r}: want a list of {len(outlines)} names, one for each body, or none")
    for number, vertices in enumerate(outlines):
        try:
            made.append(body(vertices, depth, density, material=material, name=called[number] if called else ""))
        except ValueError as error:
            raise ValueError(f"body {number}: {error}") from None
    return tuple(made)


@dataclass(frozen=True, eq=False, repr=False)
class Assembly:
    """A scene: bodies, walls, and whether there is a floor (z = 0, without ends).

    standing: the bodies are meant to stand as they are, so that a run begins by letting them settle into their springs
    floor_material: of the floor; a wall has its own

    Raises ValueError, with the numbers of the bodies, where two bodies, or a body and a wall or the floor, overlap.
    """

    bodies: tuple[Body, ...]
    walls: tuple[Wall, ...] = ()
    floor: bool = True
    standing: bool = True
    floor_material: str = "table"
    title: str = field(default="assembly", compare=False)

    def __repr__(self) -> str:
        floor = "a floor" if self.floor else "no floor"
        return f"<Assembly {self.title!r}: {len(self.bodies)} bodies, {len(self.walls)} walls, {floor}>"

    def _repr_html_(self) -> str:
        """The scene drawn, for notebooks."""
        from dem.picture import html_of

        bodies, walls = (((t.vertices, t.name) for t in things) for things in (self.bodies, self.walls))
        return html_of(bodies, walls, self.floor, repr(self)[1:-1])

    def __post_init__(self) -> None:
        object.__setattr__(self, "bodies", _all_of("bodies", self.bodies, Body))
        object.__setattr__(self, "walls", _all_of("walls", self.walls, Wall))
        if not self.bodies:
            raise ValueError("bodies=(): want at least one body")
        _check_velocities(self.bodies)
        _check_floor(self.bodies, self.floor)
        _check_overlaps(self.bodies, self.walls)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Name of each body; "body 3" where it has none."""
        return tuple(body.name or f"body {number}" for number, body in enumerate(self.bodies))

    @property
    def things(self) -> tuple[Body | Wall, ...]:
        """Bodies, then walls."""
        return (*self.bodies, *self.walls)

    @property
    def fixed_materials(self) -> tuple[str, ...]:
        """Material of each wall, then of the floor."""
        walls = tuple(wall.material for wall in self.walls)
        return (*walls, self.floor_material) if self.floor else walls

    @property
    def materials(self) -> tuple[str, ...]:
        """Material of each body, then of each wall, then of the floor."""
        return (*(body.material for body in self.bodies), *self.fixed_materials)

    def contact_table(self, contacts: Contacts) -> ContactTable:
        """Contact parameters by pair of materials. Raises ValueError where a pair that can meet is missing."""
        return contact_table(contacts, [body.material for body in self.bodies], self.fixed_materials)

    @property
    def mass(self) -> float:
        """Mass of all bodies [kg]."""
        return math.fsum(body.mass for body in self.bodies)


def _all_of(name: str, things: Any, wanted: type[Thing]) -> tuple[Thing, ...]:
    """A tuple of the things; ValueError unless all are what is wanted."""
    if not isinstance(things, Iterable):
        raise ValueError(f"{name}={things!r}: want a tuple of {name}")
    things = tuple(things)
    for number, thing in enumerate(things):
        checks.kind(
            f"{name}[{number}]", thing, wanted, f"a {wanted.__name__}, as dem.{wanted.__name__.lower()} makes it"
        )
    return things


def _check_velocities(bodies: Sequence[Body]) -> None:
    for number, thing in enumerate(bodies):
        for label in ("x", "z", "vx", "vz", "omega"):
            if not math.isfinite(checks.real(getattr(thing, label))):
                raise ValueError(f"body {number}: {label}={getattr(thing, label)}: want a finite number")
        if not (math.isfinite(thing.mass) and thing.mass > 0.0):
            raise ValueError(f"body {number}: mass={thing.mass} kg: want a positive, finite number")


def _check_floor(bodies: Sequence[Body], floor: bool) -> None:
    for number, thing in enumerate(bodies):
        lowest = float(thing.vertices[:, 1].min())
        if floor and lowest < -TOUCHING * thing.shape.radius:
            raise ValueError(f"body {number} is {-lowest:.3g} m in the floor: want it at z = 0 or above")


def _check_overlaps(bodies: Sequence[Body], walls: Sequence[Wall]) -> None:
    things: tuple[Body | Wall, ...] = (*bodies, *walls)
    pairs = near_pairs(bodies, walls)
    deep = depths(outlines_of(things), pairs)
    radius = np.array([thing.shape.radius for thing in things])
    wrong = np.flatnonzero(deep > TOUCHING * radius[pairs].max(axis=1))
    if len(wrong):
        i, j = pairs[wrong[0]]
        label = f"body {j}" if j < len(bodies) else f"wall {j - len(bodies)}"
        raise ValueError(f"body {i} and {label} overlap by {deep[wrong[0]]:.3g} m: want them apart or just touching")
