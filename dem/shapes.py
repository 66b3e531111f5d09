"""Convex polygons: area, centroid, second moment, corners in the body frame, tilts of balance.

Source  area integrals of a polygon by triangles (Green's theorem); signs of the tilt as in the package head
Status  rectangle, triangle and trapezium checked against closed forms
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dem import checks

FloatArray = npt.NDArray[np.float64]

LARGEST = 1e9
"""[m], of a coordinate: far from where fourth powers of lengths overflow."""

FLAT = 1e-9  # corners this close in height, as a share of the size, count as one flat base


@dataclass(frozen=True, eq=False, repr=False)
class Polygon:
    """A convex polygon; build it with `polygon`, `rectangle` (these stand on a flat side) or `convex`.

    corners: from the centroid [m], shape (corner, 2), columns X (right) and Z (up), counter-clockwise
    area [m^2]; second_moment: polar, about the centroid [m^4]; radius: farthest corner [m]
    theta_c: tilts of unstable balance, leaning to +x and to -x, both positive [rad]; nan for one of `convex` that
        does not stand
    """

    corners: FloatArray
    area: float
    second_moment: float
    radius: float
    theta_c: tuple[float, float]

    def __repr__(self) -> str:
        return f"<Polygon: {self.outline}, area {self.area:.4g} m^2>"

    @property
    def outline(self) -> str:
        """Number of corners and size of the box around them, in words."""
        b, h = np.ptp(self.corners, axis=0)
        return f"{len(self.corners)} corners, {b:.4g} x {h:.4g} m"


def rectangle(b: float, h: float) -> Polygon:
    """Rectangle of breadth b and height h [m]. Raises ValueError unless both are positive and finite."""
    checks.positive("b", b, "m")
    checks.positive("h", h, "m")
    x, z = b / 2.0, h / 2.0
    return polygon([[-x, -z], [x, -z], [x, z], [-x, z]])


def polygon(vertices: npt.ArrayLike) -> Polygon:
    """Polygon from its vertices.

    vertices: [m], shape (corner, 2), columns x and z in any frame whose z points up, either sense of turning.
    Raises ValueError unless it is strictly convex, finite, and stands on its lowest side with the centroid
    above that side.
    """
    corners, area, _ = _about_centroid(vertices)
    return _measured(corners, area, _balance_tilts(corners))


def convex(vertices: npt.ArrayLike) -> tuple[Polygon, tuple[float, float]]:
    """Polygon that need not stand by itself, as a voussoir does not, and where its centroid lies [m].

    vertices: as for `polygon`. `theta_c` is nan both ways where there is no flat lowest side below the centroid.
    Raises ValueError unless it is strictly convex and finite.
    """
    corners, area, centroid = _about_centroid(vertices)
    try:
        tilts = _balance_tilts(corners)
    except ValueError:
        tilts = (math.nan, math.nan)
    return _measured(corners, area, tilts), centroid


def _about_centroid(vertices: npt.ArrayLike) -> tuple[FloatArray, float, tuple[float, float]]:
    """(corners from the centroid, counter-clockwise; area; centroid)."""
    points = _turning_left(_checked(vertices))
    middle = points.mean(axis=0)
    points = points - middle
    following = np.roll(points, -1, axis=0)
    cross = points[:, 0] * following[:, 1] - following[:, 0] * points[:, 1]
    area = float(cross.sum()) / 2.0
    centroid = ((points + following) * cross[:, None]).sum(axis=0) / (6.0 * area)
    corners = points - centroid
    corners.setflags(write=False)
    return corners, area, (float(middle[0] + centroid[0]), float(middle[1] + centroid[1]))


def _measured(corners: FloatArray, area: float, theta_c: tuple[float, float]) -> Polygon:
    return Polygon(
        corners=corners,
        area=area,
        second_moment=_polar_moment(corners),
        radius=float(np.hypot(corners[:, 0], corners[:, 1]).max()),
        theta_c=theta_c,
    )


def _checked(vertices: npt.ArrayLike) -> FloatArray:
    points = checks.numbers("vertices", vertices)
    if points.ndim != 2 or points.shape[0] < 3 or points.shape[1] != 2:
        raise ValueError(f"vertices of shape {points.shape}: want (corner, 2) with at least 3 corners")
    if not np.isfinite(points).all():
        raise ValueError(f"vertices={points.tolist()}: want finite coordinates [m]")
    if np.abs(points).max() > LARGEST:
        raise ValueError(f"vertices={points.tolist()}: want coordinates up to {LARGEST:g} m")
    return points


def _turning_left(points: FloatArray) -> FloatArray:
    """The same points counter-clockwise; refuses dents, straight corners and crossings."""
    side = np.roll(points, -1, axis=0) - points
    after = np.roll(side, -1, axis=0)
    turn = np.arctan2(
        side[:, 0] * after[:, 1] - side[:, 1] * after[:, 0],
        (side * after).sum(axis=1),
    )
    if turn.sum() < 0.0:
        points, turn = points[::-1].copy(), -turn[::-1]
    # A convex outline turns the same way at every corner, and once round in all.
    if turn.min() <= FLAT or abs(float(turn.sum()) - 2.0 * math.pi) > 1e-6:
        raise ValueError(f"vertices={points.tolist()}: want a strictly convex polygon, corners in order")
    return points


def _polar_moment(corners: FloatArray) -> float:
    """Sum over the triangles from the centroid: (cross/12)(a.a + a.b + b.b)."""
    following = np.roll(corners, -1, axis=0)
    cross = corners[:, 0] * following[:, 1] - following[:, 0] * corners[:, 1]
    squares = (corners * corners + corners * following + following * following).sum(axis=1)
    return float((cross * squares).sum()) / 12.0


def _balance_tilts(corners: FloatArray) -> tuple[float, float]:
    """Tilts (to +x, to -x) at which the centroid stands over the end corner that then carries the body."""
    radius = float(np.hypot(corners[:, 0], corners[:, 1]).max())
    base = corners[corners[:, 1] < corners[:, 1].min() + FLAT * radius]
    left, right = float(base[:, 0].min()), float(base[:, 0].max())
    if len(base) < 2 or not left < 0.0 < right:
        raise ValueError(
            f"base from {left} to {right} m beside the centroid: want a flat lowest side below the centroid"
        )
    mirrored = (corners * np.array([-1.0, 1.0]))[::-1]
    return _balance_to_the_right(corners, right), _balance_to_the_right(mirrored, -left)


def _balance_to_the_right(corners: FloatArray, right: float) -> float:
    """Roll over the corners, from the right end of the base on, until one is reached over which to balance."""
    lowest = corners[:, 1].min()
    start = int(np.argmin(np.abs(corners[:, 0] - right) + np.abs(corners[:, 1] - lowest)))
    for step in range(len(corners)):
        x, z = corners[(start + step) % len(corners)]
        after = corners[(start + step + 1) % len(corners)]
        next_side_flat = math.atan2(after[1] - z, after[0] - x) % (2.0 * math.pi)
        balance = math.atan2(x, -z) % (2.0 * math.pi)
        if balance <= next_side_flat:
            return balance
    raise ValueError(f"corners={corners.tolist()}: want a polygon that has a balance")
