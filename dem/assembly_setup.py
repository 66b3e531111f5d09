"""Arrays of a run of an assembly, as the compiled loop takes them.

Source  none, own layout (see `dem.arrays`)
Status  see the package head
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dem import arrays as q
from dem.arrays import Lists, Outline, Watched, lists_of
from dem.assembly import Assembly
from dem.materials import ContactTable
from dem.narrow_phase import Grid, Materials
from dem.shapes import FloatArray, Polygon


class Room(NamedTuple):
    """Places for pairs, slots and entries of the grid; grown when they do not suffice."""

    pairs: int
    slots: int
    entries: int

    def doubled(self) -> Room:
        return Room(2 * self.pairs, 2 * self.slots, 2 * self.entries)


def room_for(assembly: Assembly) -> Room:
    """A first guess."""
    things = len(assembly.bodies) + len(assembly.walls)
    return Room(16 + 8 * things, 64 + 24 * things, 256 + 32 * things)


def bodies_of(assembly: Assembly) -> FloatArray:
    """State at the start, shape (quantity, body)."""
    movable, things = assembly.bodies, assembly.things
    bodies = np.zeros((q.QUANTITIES, len(things) + 1))
    bodies[q.COS] = 1.0
    bodies[q.X, :-1] = [thing.x for thing in things]
    bodies[q.Z, :-1] = [thing.z for thing in things]
    bodies[q.RADIUS, :-1] = [thing.shape.radius for thing in things]
    own = slice(0, len(movable))
    for row, name in ((q.VX, "vx"), (q.VZ, "vz"), (q.OMEGA, "omega"), (q.MASS, "mass"), (q.INERTIA, "inertia")):
        bodies[row, own] = [getattr(body, name) for body in movable]
    bodies[q.PER_MASS, own] = 1.0 / bodies[q.MASS, own]
    bodies[q.PER_INERTIA, own] = 1.0 / bodies[q.INERTIA, own]
    bodies[q.START_Z] = bodies[q.Z]
    for side, row in enumerate((q.TILT_RIGHT, q.TILT_LEFT)):
        bodies[row, own] = [body.shape.theta_c[side] for body in movable]
    bodies[[q.CROSSED, q.FELL]] = math.nan
    return bodies


def outline_of(assembly: Assembly) -> Outline:
    """Corners and edges of all things, the floor last."""
    things = assembly.things
    floor = int(assembly.floor)
    count = np.array([len(thing.shape.corners) for thing in things] + [floor])
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    owner = np.repeat(np.arange(len(count)), count)
    corners = np.concatenate([thing.shape.corners for thing in things] + [np.zeros((floor, 2))])
    centre = np.array([(thing.x, thing.z) for thing in things] + [(0.0, 0.0)])[owner]
    own = np.arange(len(owner))
    following = np.where(own + 1 < first[owner] + count[owner], own + 1, first[owner])
    previous = np.where(own > first[owner], own - 1, first[owner] + count[owner] - 1)
    side = corners[following] - corners
    high = np.hypot(side[:, 0], side[:, 1])
    normal = np.stack([side[:, 1], -side[:, 0]], axis=1) / np.where(high > 0.0, high, 1.0)[:, None]
    low, is_corner = np.zeros(len(owner)), np.ones(len(owner), np.int64)
    if assembly.floor:
        normal[-1], low[-1], high[-1], is_corner[-1] = (0.0, 1.0), -math.inf, math.inf, 0
    place = np.stack([*corners.T, *normal.T, *(corners + centre).T, *normal.T, low, high])
    return Outline(
        np.ascontiguousarray(place),
        np.ascontiguousarray(np.stack([owner, previous, following, is_corner]), np.int64),
        np.ascontiguousarray(np.stack([first, count]), np.int64),
    )


def materials_of(assembly: Assembly, table: ContactTable) -> Materials:
    """Laws by material, and the material of each body."""
    numbers = [table.names.index(name) for name in assembly.materials] + ([] if assembly.floor else [0])
    return Materials(table.kn, table.ks, table.c, table.ratio, table.mu, np.array(numbers, np.int64))


def grid_of(bodies: int, room: Room) -> Grid:
    """Working space of the broad phase."""
    buckets = 1 << max(6, math.ceil(math.log2(2 * bodies)))
    return Grid(
        np.zeros((bodies, 4)),
        np.zeros(buckets + 1, np.int64),
        np.zeros((room.entries, 3), np.int64),
        np.zeros((room.pairs, 2), np.int64),
    )


def cell_size(assembly: Assembly, skin: float) -> float:
    """Cells as wide as a typical body [m]."""
    return float(2.0 * np.median([body.shape.radius for body in assembly.bodies]) + 2.0 * skin)


def default_skin(assembly: Assembly) -> float:
    """An eighth of the shortest edge or least breadth of anything in the scene, but at most a tenth of a typical
    body."""
    shapes = [thing.shape for thing in assembly.things]
    shortest = min(min(_edges(shape).min(), least_breadth(shape)) for shape in shapes)
    return float(min(shortest / 8.0, 0.1 * np.median([body.shape.radius for body in assembly.bodies])))


def _edges(shape: Polygon) -> FloatArray:
    return np.hypot(*(np.roll(shape.corners, -1, axis=0) - shape.corners).T)


def least_breadth(shape: Polygon) -> float:
    """Least distance of two parallel lines that hold the polygon between them [m]."""
    side = np.roll(shape.corners, -1, axis=0) - shape.corners
    normal = np.stack([side[:, 1], -side[:, 0]], axis=1) / _edges(shape)[:, None]
    inward = (normal * shape.corners).sum(axis=1)[:, None] - normal @ shape.corners.T
    return float(inward.max(axis=1).min())


def watched_interfaces(lists: Lists, outline: Outline, theta: FloatArray) -> Watched:
    """The pairs that touch now, with the two contacts of each that lie farthest apart."""
    between: list[tuple[int, int]] = []
    ends: list[list[tuple[int, int]]] = []
    for p in range(int(lists.size[0])):
        touching = [
            (int(corner), int(edge))
            for k in range(lists.pair[q.START, p], lists.pair[q.START, p + 1])
            for v in [int(lists.slot[k, q.ACTIVE])]
            if v >= 0
            for corner, edge in [lists.slot[k, [q.CORNER + v, q.EDGE + v]]]
        ]
        if touching:
            touching.sort(key=lambda contact: (outline.place[q.AT_X, contact[0]], outline.place[q.AT_Z, contact[0]]))
            between.append((int(lists.pair[q.FIRST, p]), int(lists.pair[q.SECOND, p])))
            ends.append([touching[0], touching[-1] if len(touching) > 1 else (-1, -1)])
    bodies = np.array(between, np.int64).reshape(-1, 2)
    contacts = np.array(ends, np.int64).reshape(-1, 2, 2)
    return Watched(bodies, contacts, theta[bodies[:, 1]] - theta[bodies[:, 0]], np.full(len(bodies), math.nan))


def larger(old: Lists, bodies: int, room: Room) -> Lists:
    """The same lists with more room."""
    new = lists_of(bodies, room.pairs, room.slots)
    for before, after in zip(old, new, strict=True):
        after[tuple(slice(0, length) for length in before.shape)] = before
    return new
