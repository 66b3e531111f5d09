"""Pairs of neighbouring outlines of a scene as given, how deep they overlap and where they touch; whole arrays at once.

Source  separating axes for convex polygons (Ericson, Real-time collision detection, 2005, ch. 5)
Status  against pairs compared one by one (tests)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from dem.shapes import FloatArray, Polygon

IntArray = npt.NDArray[np.int64]


class Placed(Protocol):
    """A body or a wall."""

    @property
    def shape(self) -> Polygon: ...
    @property
    def x(self) -> float: ...
    @property
    def z(self) -> float: ...


class Outlines(NamedTuple):
    """Corners and outward normals of the edges that follow them, each of shape (thing, corner, 2), the last corner
    repeated where a polygon has fewer; lengths of the edges [m], 0 for repeated corners, shape (thing, corner)."""

    corners: FloatArray
    normals: FloatArray
    lengths: FloatArray


class Touch(NamedTuple):
    """Where things touch: things; point [m] and direction of the normal force, shape (contact, 2); whose corner it is,
    its number there, and that of the other's edge, as in `Outlines`."""

    first: IntArray
    second: IntArray
    point: FloatArray
    normal: FloatArray
    owner: IntArray
    corner: IntArray
    edge: IntArray


def outlines_of(things: Sequence[Placed]) -> Outlines:
    """Outlines in the frame of the table."""
    most = max(len(thing.shape.corners) for thing in things)
    corners = np.stack(
        [
            np.concatenate(
                [own := thing.shape.corners + np.array([thing.x, thing.z]), own[-1:].repeat(most - len(own), 0)]
            )
            for thing in things
        ]
    )
    closing = np.roll(corners, -1, axis=1)
    side = closing - corners
    lengths = np.hypot(side[..., 0], side[..., 1])
    safe = np.where(lengths > 0.0, lengths, 1.0)[..., None]
    normals = np.stack([side[..., 1], -side[..., 0]], axis=-1) / safe
    return Outlines(corners, normals, lengths)


def near_pairs(bodies: Sequence[Placed], walls: Sequence[Placed]) -> IntArray:
    """Pairs (body, later body or wall) whose boxes meet, walls numbered after the bodies, shape (pair, 2)."""
    centres = np.array([[thing.x, thing.z] for thing in bodies])
    reach = np.array([thing.shape.radius for thing in (*bodies, *walls)])
    tree = cKDTree(centres)
    found = [tree.query_pairs(2.0 * reach[: len(bodies)].max(), output_type="ndarray")]
    for k, fixed in enumerate(walls):
        near = np.array(
            tree.query_ball_point([fixed.x, fixed.z], fixed.shape.radius + reach[: len(bodies)].max()), np.int64
        )
        found.append(np.column_stack([near, np.full(near.shape, len(bodies) + k)]))
    pairs = np.concatenate(found).astype(np.int64)
    places = np.array([[thing.x, thing.z] for thing in (*bodies, *walls)])
    apart = np.hypot(*(places[pairs[:, 0]] - places[pairs[:, 1]]).T)
    pairs = pairs[apart <= reach[pairs].sum(axis=1) * (1.0 + 1e-6)]
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def depths(outlines: Outlines, pairs: IntArray) -> FloatArray:
    """Least way that separates each pair [m], negative if apart, shape (pair,)."""
    least = np.full(len(pairs), np.inf)
    for i, j in ((0, 1), (1, 0)):
        inward = _overlaps(outlines, pairs[:, i], pairs[:, j]).max(axis=2)
        least = np.minimum(least, np.where(outlines.lengths[pairs[:, i]] > 0.0, inward, np.inf).min(axis=1))
    return least


def _overlaps(outlines: Outlines, edges_of: IntArray, corners_of: IntArray) -> FloatArray:
    """Overlap of each corner with each edge's line [m], shape (pair, edge, corner)."""
    corners, normals = outlines.corners, outlines.normals
    offset = (normals[edges_of] * corners[edges_of]).sum(axis=-1)
    return offset[:, :, None] - np.einsum("pek,pck->pec", normals[edges_of], corners[corners_of])


def touches(outlines: Outlines, pairs: IntArray, within: float) -> Touch:
    """Contacts of corners with facing edges at most `within` [m] away; one per point of a pair."""
    found = [_touches_one_way(outlines, pairs, i, j, within) for i, j in ((0, 1), (1, 0))]
    every = Touch(*map(np.concatenate, zip(*found, strict=True)))
    places = np.round(every.point / max(within, 1e-12) / 4.0)
    _, once = np.unique(np.column_stack([every.first, every.second, places]), axis=0, return_index=True)
    return Touch._make(column[once] for column in every)


def _touches_one_way(outlines: Outlines, pairs: IntArray, i: int, j: int, within: float) -> Touch:
    """Corners of the pair's member j on edges of its member i."""
    edges_of, corners_of = pairs[:, i], pairs[:, j]
    corners, normals, lengths = outlines
    overlap = _overlaps(outlines, edges_of, corners_of)
    along = np.stack([-normals[..., 1], normals[..., 0]], axis=-1)
    start = (along[edges_of] * corners[edges_of]).sum(axis=-1)
    place = np.einsum("pek,pck->pec", along[edges_of], corners[corners_of]) - start[:, :, None]
    on = (np.abs(overlap) <= within) & (place >= -within) & (place <= lengths[edges_of][:, :, None] + within)
    # The edge faces the corner: its inward normal lies between the normals of the corner's two edges.
    before = np.roll(normals, 1, axis=1)
    inward = -normals[edges_of][:, :, None, :]
    turn_in = _cross(before[corners_of][:, None], inward)
    turn_out = _cross(inward, normals[corners_of][:, None])
    on &= (turn_in >= -0.1) & (turn_out >= -0.1) & (lengths[edges_of] > 0.0)[:, :, None]
    on &= (lengths[corners_of] > 0.0)[:, None, :]
    p, e, c = np.nonzero(on)
    point, normal = corners[corners_of[p], c], normals[edges_of[p], e]
    return Touch(pairs[p, 0], pairs[p, 1], point, normal, corners_of[p], c, e)


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
