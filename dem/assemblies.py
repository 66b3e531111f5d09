"""Assemblies that people build: columns, a wall beside them, shelves, masonry, arches, drums, loose stacks.

Source  Winkler, Meguro & Yamazaki (1995), Figs 17-23: columns of two and three equal blocks, free and next to a wall
        that is fixed to the table; running bond, voussoirs and drums as masons lay them
Status  each stands still for as long as it should (tests); the same scenes serve tests, timings and studies
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from dem import checks
from dem.assembly import Assembly, Body, block, bodies_of, body, wall
from dem.shapes import FloatArray

JOINT = 1e-3  # gap between neighbours in a course of masonry [m]: dry joints are never quite closed


MOST_BODIES = 1_000_000
"""Of a scene made here."""


def single(b: float, h: float, d: float, density: float) -> Assembly:
    """One block on the floor: breadth b, height h, depth d [m], density [kg/m^3]. Raises ValueError unless positive."""
    return Assembly((block(b, h, d, density, name="block"),), title="single block")


def column(
    count: int, b: float, h: float, d: float, density: float, *, wall_gap: float | None = None
) -> Assembly:  # fmt: skip
    """Equal blocks on top of each other; the lowest is number 0.

    wall_gap: distance of a wall fixed to the table to the left of the column [m], 0 for a column that leans on it; None
        for a free column. The wall is higher than the column
    Raises ValueError unless count is at least 1 and the sizes are positive.
    """
    _at_least("count", count, 1)
    for label, value in (("b", b), ("h", h)):
        checks.positive(label, value, "m")
    names = _named(count, "block", "lower", "upper", "middle")
    blocks = tuple(block(b, h, d, density, z=i * h, name=name) for i, name in enumerate(names))
    if wall_gap is None:
        return Assembly(blocks, title=f"column of {count}")
    checks.not_negative("wall_gap", wall_gap, "m")
    face = -0.5 * b - wall_gap
    upright = wall(_box(face - b, -0.5 * h, face, (count + 1.0) * h), name="wall")
    return Assembly(blocks, (upright,), title=f"column of {count} next to a wall")


def _named(count: int, one: str, lowest: str, highest: str, between: str) -> list[str]:
    """Names from below."""
    if count == 1:
        return [one]
    middle = [between] if count == 3 else [f"{between} {i}" for i in range(1, count - 1)]
    return [f"{lowest} {one}", *(f"{name} {one}" for name in middle), f"{highest} {one}"]


def bookshelf(
    books: int = 12, *, b: float = 0.8, h: float = 0.35, depth: float = 0.25, board: float = 0.02, lean: bool = True
) -> Assembly:
    """A shelf of four boards, standing on the floor, with upright books of different thickness and height in it.

    books: number; b, h: clear breadth and height inside; depth; board: thickness [m]; lean: fill from the left and
        leave the rest of the breadth free, else spread the books evenly
    Body 0 is the shelf's left side, 1 its right side, 2 its bottom, 3 its top; the books follow from the left. The
    boards lie on each other without glue. Raises ValueError unless the sizes are positive and the books fit.
    """
    _at_least("books", books, 1)
    for name, value in (("b", b), ("h", h), ("depth", depth), ("board", board)):
        checks.positive(name, value, "m")
    half = 0.5 * b
    outlines = [
        _box(-half - board, board, -half, board + h),
        _box(half, board, half + board, board + h),
        _box(-half - board, 0.0, half + board, board),
        _box(-half - board, board + h, half + board, 2.0 * board + h),
    ]
    names = ["left side", "right side", "bottom", "top"]
    boards = bodies_of(outlines, depth, 650.0, material="board", names=names)
    thick = 0.02 + 0.025 * _spread(books, 0.618)
    tall = h * (0.6 + 0.3 * _spread(books, 0.755))
    free = b - float(thick.sum())
    if free <= 0.0:
        raise ValueError(f"books={books}: {books} books take {thick.sum():.3g} m: want them to fit into b={b} m")
    gap = 0.0 if lean else free / (books + 1)
    left = -half + gap + np.concatenate([[0.0], np.cumsum(thick + gap)[:-1]])
    pages = bodies_of(
        [_box(x, board, x + t, board + high) for x, t, high in zip(left, thick, tall, strict=True)],
        0.8 * depth, 800.0, material="book", names=[f"book {i}" for i in range(books)],
    )  # fmt: skip
    return Assembly(boards + pages, title=f"shelf with {books} books")


def running_bond(
    courses: int, across: int, *, b: float = 0.2, h: float = 0.1, d: float = 0.1, density: float = 1800.0,
    joint: float = JOINT,
) -> Assembly:  # fmt: skip
    """A dry masonry wall: each course is shifted by half a block, half blocks close every second one.

    courses, across: number of courses, and of whole blocks in a course; b, h, d: of a block with its joint, its
        height, its depth [m]; joint: gap between neighbours [m]
    Courses are numbered from below, blocks from the left. Raises ValueError unless the numbers are at least 1.
    """
    _at_least("courses", courses, 1)
    _at_least("across", across, 1)
    for name, value in (("b", b), ("h", h), ("d", d)):
        checks.positive(name, value, "m")
    checks.positive("density", density, "kg/m^3")
    checks.not_negative("joint", joint, "m")
    if joint >= 0.5 * b:
        raise ValueError(f"joint={joint} m: want less than half of the breadth b={b} m")
    if courses * across > MOST_BODIES:
        raise ValueError(f"courses={courses}, across={across}: want at most {MOST_BODIES} blocks")
    outlines, names = [], []
    for i in range(courses):
        ends = [0.0, *(np.arange(across - (i % 2 == 0)) + (1.0 if i % 2 == 0 else 0.5)), float(across)]
        for k, (left, right) in enumerate(pairwise(ends)):
            outlines.append(_box(left * b + 0.5 * joint, i * h, right * b - 0.5 * joint, (i + 1) * h))
            names.append(f"course {i} block {k}")
    return Assembly(bodies_of(outlines, d, density, names=names), title=f"running bond, {courses} courses")


def arch(
    voussoirs: int,
    thickness: float,
    *,
    radius: float = 1.0,
    embrace: float = math.pi,
    d: float = 0.2,
    density: float = 2000.0,
) -> Assembly:
    """A circular arch of equal voussoirs on two abutments fixed to the table.

    thickness: t [m]; radius: R of the centre line [m]; embrace: angle that the arch spans [rad], pi for a semicircle
    Voussoirs are numbered from the left. Joints are radial. Raises ValueError for fewer than 2 voussoirs, a thickness
    that is not between 0 and 2 R, or an angle that is not between 0 and pi.
    """
    _at_least("voussoirs", voussoirs, 2)
    checks.positive("radius", radius, "m")
    if not 0.0 < checks.real(thickness) < 2.0 * radius:
        raise ValueError(f"thickness={thickness} m: want more than 0 and less than twice the radius, {2.0 * radius} m")
    if not 0.0 < checks.real(embrace) <= math.pi:
        raise ValueError(f"embrace={embrace} rad: want an angle above 0, at most pi")
    angles = 0.5 * embrace * (1.0 - 2.0 * np.arange(voussoirs + 1) / voussoirs)
    inner, outer = radius - 0.5 * thickness, radius + 0.5 * thickness
    out = np.column_stack([-np.sin(angles), np.cos(angles)])
    centre = np.array([0.0, thickness - inner * math.cos(0.5 * embrace)])
    rings = [inner * out + centre, outer * out + centre]
    stones = [[rings[0][i], rings[1][i], rings[1][i + 1], rings[0][i + 1]] for i in range(voussoirs)]
    left = _abutment(rings[1][0], rings[0][0], thickness)
    right = _abutment(rings[0][-1], rings[1][-1], thickness)
    names = [f"voussoir {i}" for i in range(voussoirs)]
    return Assembly(
        bodies_of(stones, d, density, names=names),
        (wall(left, name="left abutment"), wall(right, name="right abutment")),
        floor=False,
        title=f"arch of {voussoirs} voussoirs",
    )


def _abutment(first: FloatArray, second: FloatArray, depth: float) -> FloatArray:
    """A block whose face is the joint, its body to the right of first -> second, away from the arch."""
    along = (second - first) / np.hypot(*(second - first))
    back = np.array([along[1], -along[0]]) * depth
    wide = 0.5 * depth * along
    face = (first - wide, second + wide)
    return np.array([face[0], face[1], face[1] + back, face[0] + back])


def drum_column(
    drums: int, *, diameter: float = 0.6, taper: float = 0.9, h: float = 3.0, density: float = 2600.0
) -> Assembly:
    """A column of drums in the plane: trapezia that narrow from `diameter` below to `taper` times it, and a capital.

    drums: number; h: height of all drums [m]. The capital is the last body. Raises ValueError unless drums is at least
    1, the sizes are positive and taper is above 0, at most 1.
    """
    _at_least("drums", drums, 1)
    for name, value in (("diameter", diameter), ("h", h)):
        checks.positive(name, value, "m")
    if not 0.0 < checks.real(taper) <= 1.0:
        raise ValueError(f"taper={taper}: want more than 0, at most 1")
    made = []
    for i in range(drums):
        low, high = (0.5 * diameter * (1.0 - (1.0 - taper) * share) for share in (i / drums, (i + 1) / drums))
        z = np.array([i, i + 1]) * h / drums
        corners = [[-low, z[0]], [low, z[0]], [high, z[1]], [-high, z[1]]]
        made.append(body(corners, 0.8 * 2.0 * low, density, name=f"drum {i}"))
    top = 0.5 * diameter * taper
    capital = [[-top, h], [top, h], [1.4 * top, h + 0.4 * diameter], [-1.4 * top, h + 0.4 * diameter]]
    made.append(body(capital, 1.6 * top, density, name="capital"))
    return Assembly(tuple(made), title=f"column of {drums} drums")


def rubble(count: int, *, size: float = 0.2, density: float = 2400.0, seed: int = 0) -> Assembly:
    """Irregular convex stones laid one on the other, each on a flat bed face with its centroid above it.

    count: number; size: breadth of a stone, about [m]. Raises ValueError unless count is at least 1 and size positive.
    """
    _at_least("count", count, 1)
    checks.positive("size", size, "m")
    checks.whole("seed", seed, 0, 2**63 - 1)
    random = np.random.default_rng(seed)
    stones, z = [], 0.0
    for i in range(count):
        stones.append(_stone(random, size, z, density, f"stone {i}"))
        z = float(stones[-1].vertices[:, 1].max())
    return Assembly(tuple(stones), title=f"stack of {count} irregular stones")


def _stone(random: np.random.Generator, size: float, z: float, density: float, name: str) -> Body:
    """Flat below and above, with a bulging corner on each side."""
    high = size * random.uniform(0.35, 0.6)
    bed, top = (size * random.uniform(0.35, 0.45, 2) for _ in range(2))
    bulge, at = size * random.uniform(0.47, 0.55, 2), z + high * random.uniform(0.3, 0.7, 2)
    corners = [
        [-bed[0], z], [bed[1], z], [bulge[1], at[1]], [top[1], z + high], [-top[0], z + high], [-bulge[0], at[0]],
    ]  # fmt: skip
    return body(corners, size, density, name=name)


def _box(left: float, low: float, right: float, high: float) -> list[list[float]]:
    return [[left, low], [right, low], [right, high], [left, high]]


def _spread(count: int, step: float) -> FloatArray:
    """Numbers from 0 to 1 that differ evenly, the same at every call."""
    return np.modf(0.5 + step * np.arange(count))[0]


def _at_least(name: str, value: int, least: int) -> None:
    checks.whole(name, value, least, MOST_BODIES)


__all__ = ["arch", "bookshelf", "column", "drum_column", "rubble", "running_bond", "single"]
