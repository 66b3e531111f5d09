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
from dem.initial_contacts import Touch
from dem.materials import ContactTable
from dem.narrow_phase import Grid, Materials
from dem.shapes import FloatArray


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


class Place(NamedTuple):
    """Where two things touch: their numbers, and which corner of one on which edge of the other."""

    first: int
    second: int
    corner: int
    edge: int


def pressing(lists: Lists) -> list[Place]:
    """The contacts that press now."""
    return [
        Place(
            int(lists.pair[q.FIRST, p]),
            int(lists.pair[q.SECOND, p]),
            *map(int, lists.slot[k, [q.CORNER + v, q.EDGE + v]]),
        )
        for p in range(int(lists.size[0]))
        for k in range(lists.pair[q.START, p], lists.pair[q.START, p + 1])
        for v in [int(lists.slot[k, q.ACTIVE])]
        if v >= 0
    ]


def touching(touch: Touch, outline: Outline) -> list[Place]:
    """The places where things touch as they are laid."""
    # The last corner of things with fewer corners than others is there once more at the end.
    first, last = outline.span[q.FROM], outline.span[q.COUNT] - 1
    on = touch.first + touch.second - touch.owner
    corner = first[touch.owner] + np.minimum(touch.corner, last[touch.owner])
    edge = first[on] + np.minimum(touch.edge, last[on])
    columns = (touch.first, touch.second, corner, edge)
    return [Place(*row) for row in zip(*(column.tolist() for column in columns), strict=True)]


def watched_interfaces(places: list[Place], outline: Outline, theta: FloatArray) -> Watched:
    """The pairs that touch at these places, with the two places of each that lie farthest apart."""
    pairs: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for place in places:
        pairs.setdefault((place.first, place.second), []).append((place.corner, place.edge))
    ends = []
    for pair in sorted(pairs):
        along = sorted(pairs[pair], key=lambda one: (outline.place[q.AT_X, one[0]], outline.place[q.AT_Z, one[0]]))
        ends.append([along[0], along[-1] if len(along) > 1 else (-1, -1)])
    between = np.array(sorted(pairs), np.int64).reshape(-1, 2)
    contacts = np.array(ends, np.int64).reshape(-1, 2, 2)
    return Watched(between, contacts, theta[between[:, 1]] - theta[between[:, 0]], np.full(len(between), math.nan))


def larger(old: Lists, bodies: int, room: Room) -> Lists:
    """The same lists with more room."""
    new = lists_of(bodies, room.pairs, room.slots)
    for before, after in zip(old, new, strict=True):
        after[tuple(slice(0, length) for length in before.shape)] = before
    return new
