"""Where two convex bodies may touch: corners on edges, their overlap, and which corner holds which end; no forces.

A corner c touches an edge e of another body when its projection falls within the edge and its overlap
d = -(c - q).n is positive, q a corner and n the outward normal of the edge, which turns with its body.

Aligned edges. An edge on an edge is two contacts, one at each end of the stretch that they share. Which body's corner
is the end changes when one block slides past the alignment, so a slot holds both *variants* of one end, (corner of B,
edge of A) and (corner of A, edge of B), of which one at most is active. The active one is kept until its corner passes
the end of its edge; then the other takes over with the forces stored. Corners are sharp: there is no rounding between
the normals of the two, and a block that slides onto a neighbour which stands a hair's breadth higher trips over it.

Choice of the edge. A contact begins on an edge that faces the corner (its inward normal lies among the normals between
the corner's own two edges, give or take a tolerance); near an edge's end, on the edge of least overlap of those that
face it; and never while the corner presses on another edge of the same body. It then stays on this edge until it
ceases.

Beginning. The corner has to be in the body: behind all of its edges, not this one alone, behind which it may be while
the bodies are apart, beside an acute corner or a hair above the next edge. The slack at the ends is for a corner that
comes through this edge in this step. Where two edges land on each other with acute ends, such a corner may already be
out of the body again; then it counts that the two edges overlap there.

Source  Cundall's corner/edge contacts as in Winkler, Meguro & Yamazaki (1995), Figs 7 and 8; one contact per end is
        ours
Status  hand-over through exact alignment is continuous; lists with a skin and lists made at every step give the same
        bits
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dem import arrays as q
from dem.assembly import TOUCHING
from dem.broad_phase import boxes_of, floor_pairs, in_order, near_pairs
from dem.compiled import hot, inner


class Judgement(NamedTuple):
    """When a corner counts as on an edge, as floats.

    skin: slots are listed within this distance; update_after: and listed anew when a body may have moved by this [m]
    reach: an edge is felt from this far off [m]
    end_slack: a corner may lie this far beyond the end of an edge [m]; one that presses already, as far as its overlap
    facing: an edge faces a corner to within this angle [rad]
    """

    skin: float
    update_after: float
    reach: float
    end_slack: float
    facing: float


class Materials(NamedTuple):
    """Laws by pair of materials, each array of shape (material, material): kn, ks [N/m], c [N s/m], share of critical
    damping added to it, mu; material of each body."""

    kn: np.ndarray
    ks: np.ndarray
    c: np.ndarray
    ratio: np.ndarray
    mu: np.ndarray
    of: np.ndarray


class Grid(NamedTuple):
    """Working space of the broad phase."""

    box: np.ndarray
    heads: np.ndarray
    entries: np.ndarray
    found: np.ndarray


@hot
def locate(outline, c, e, reach):
    """(overlap of corner c with edge e, place of its projection along the edge from the edge's corner) [m]."""
    dx, dz = outline.place[q.AT_X, c] - outline.place[q.AT_X, e], outline.place[q.AT_Z, c] - outline.place[q.AT_Z, e]
    n_x, n_z = outline.place[q.N_X, e], outline.place[q.N_Z, e]
    return reach - (dx * n_x + dz * n_z), dz * n_x - dx * n_z


@hot
def within(outline, e, place, slack):
    """Does the place lie on edge e, give or take slack?"""
    return outline.place[q.LOW, e] - slack <= place <= outline.place[q.HIGH, e] + slack


@inner
def faces(outline, c, e, tolerance):
    """Does the inward normal of edge e lie between the outward normals of the two edges that meet in corner c?"""
    before = outline.link[q.PREVIOUS, c]
    w_x, w_z = -outline.place[q.N_X, e], -outline.place[q.N_Z, e]
    give = -math.sin(tolerance)
    if outline.place[q.N_X, before] * w_z - outline.place[q.N_Z, before] * w_x < give:
        return False
    if w_x * outline.place[q.N_Z, c] - w_z * outline.place[q.N_X, c] < give:
        return False
    return (
        w_x * (outline.place[q.N_X, before] + outline.place[q.N_X, c])
        + w_z * (outline.place[q.N_Z, before] + outline.place[q.N_Z, c])
        > 0.0
    )


@inner
def begins(outline, c, e, judgement):
    """Overlap [m] of a corner on an edge that it may begin to touch, else -1."""
    d, place = locate(outline, c, e, judgement.reach)
    if d <= 0.0 or not within(outline, e, place, judgement.end_slack) or not faces(outline, c, e, judgement.facing):
        return -1.0
    if not outline.link[q.IS_CORNER, e]:
        return d
    beside = outline.link[q.PREVIOUS, e] if place < 0.5 * outline.place[q.HIGH, e] else outline.link[q.FOLLOWING, e]
    d_beside, _ = locate(outline, c, beside, judgement.reach)
    if 0.0 <= d_beside < d and faces(outline, c, beside, judgement.facing):
        return -1.0
    return d


@inner
def inside(outline, c, e, reach, slack):
    """Is corner c behind all other edges of the body of edge e, or beyond them by no more than slack?"""
    other = outline.link[q.FOLLOWING, e]
    while other != e:
        d, _ = locate(outline, c, other, reach)
        if d < -slack:
            return False
        other = outline.link[q.FOLLOWING, other]
    return True


@inner
def _end_and_edge(outline, c, e, place):
    """The end of edge e near corner c, and the edge at c that faces e if the two edges overlap there."""
    end = e if place < 0.5 * outline.place[q.HIGH, e] else outline.link[q.FOLLOWING, e]
    # Both outlines turn left: the start of one edge lies at the end of the edge that faces it.
    return end, outline.link[q.PREVIOUS, c] if end == e else c


@inner
def _before(bodies, outline, i, dt):
    """Where corner i was a step ago, and the normal of its edge: x, z, n_x, n_z."""
    own = outline.link[q.OWNER, i]
    theta = bodies[q.THETA, own] - dt * bodies[q.OMEGA, own]
    c, s = math.cos(theta), math.sin(theta)
    x, z = outline.place[q.LOCAL_X, i], outline.place[q.LOCAL_Z, i]
    n_x, n_z = outline.place[q.LOCAL_NX, i], outline.place[q.LOCAL_NZ, i]
    return (
        bodies[q.X, own] - dt * bodies[q.VX, own] + (x * c + z * s),
        bodies[q.Z, own] - dt * bodies[q.VZ, own] + (z * c - x * s),
        n_x * c + n_z * s,
        n_z * c - n_x * s,
    )


@inner
def passes(bodies, outline, c, e, judgement, dt):
    """Has corner c come through the line of edge e in this step?"""
    x, z, _, _ = _before(bodies, outline, c, dt)
    q_x, q_z, n_x, n_z = _before(bodies, outline, e, dt)
    size = max(bodies[q.RADIUS, outline.link[q.OWNER, c]], bodies[q.RADIUS, outline.link[q.OWNER, e]])
    d = judgement.reach - ((x - q_x) * n_x + (z - q_z) * n_z)
    return d <= judgement.end_slack + TOUCHING * size


@inner
def overlap_beyond(outline, c, e, judgement):
    """Do edge e and the edge at corner c that faces it overlap at the end of e near c, wherever c has got to?

    At acute ends both corners may be out of the other body while the edges overlap. It tells them from a corner that
    goes past the end of e.
    """
    _, place = locate(outline, c, e, judgement.reach)
    end, facing_edge = _end_and_edge(outline, c, e, place)
    d, _ = locate(outline, end, facing_edge, judgement.reach)
    return d > 0.0


@inner
def enters(bodies, outline, c, e, judgement, dt):
    """Is corner c in the body of edge e, or has it come through the edge, be it beside the end by a hair?"""
    if inside(outline, c, e, judgement.reach, 0.0):
        return True
    near = inside(outline, c, e, judgement.reach, judgement.end_slack) or overlap_beyond(outline, c, e, judgement)
    return near and passes(bodies, outline, c, e, judgement, dt)


@inner
def presses_elsewhere(lists, first, last, k, c):
    """Is corner c active in a slot of first..last other than k?"""
    for m in range(first, last):
        v = lists.slot[m, q.ACTIVE]
        if m != k and v >= 0 and lists.slot[m, q.CORNER + v] == c:
            return True
    return False


@inner
def joins(bodies, outline, lists, first, last, c, e, judgement, dt):
    """Has corner c, not just come through edge e, a corner at an end of e that presses on one of c's two edges?"""
    after, before = outline.link[q.FOLLOWING, e], outline.link[q.PREVIOUS, c]
    for m in range(first, last):
        v = lists.slot[m, q.ACTIVE]
        if v >= 0 and lists.slot[m, q.CORNER + v] in (e, after) and lists.slot[m, q.EDGE + v] in (c, before):
            return not passes(bodies, outline, c, e, judgement, dt)
    return False


@inner
def beginning(bodies, outline, lists, first, last, k, judgement, dt):
    """The variant of the idle slot k that begins to touch (of least overlap), or -1."""
    best, least = -1, np.inf
    for v in range(2):
        c, e = lists.slot[k, q.CORNER + v], lists.slot[k, q.EDGE + v]
        if c < 0:
            break
        d = begins(outline, c, e, judgement)
        if not 0.0 < d < least or presses_elsewhere(lists, first, last, k, c):
            continue
        if enters(bodies, outline, c, e, judgement, dt):
            best, least = v, d
    return best


@inner
def _holds(lists, k, c, e):
    """Which variant of slot k is corner c on edge e; -1 if none."""
    for v in range(2):
        if lists.slot[k, q.CORNER + v] == c and lists.slot[k, q.EDGE + v] == e:
            return v
    return -1


@inner
def _partner(outline, c, e, place, near):
    """(corner, edge) that may hold the same end as c on e, or -1, -1: e's corner near c, on c's edge that faces e."""
    end, facing_edge = _end_and_edge(outline, c, e, place)
    if (outline.place[q.AT_X, c] - outline.place[q.AT_X, end]) ** 2 + (
        outline.place[q.AT_Z, c] - outline.place[q.AT_Z, end]
    ) ** 2 > near * near:
        return -1, -1
    return end, facing_edge


@inner
def _add(lists, count, c, e, partner, facing_edge):
    """Append a slot; the new number of slots, or -1 without room."""
    if count == lists.slot.shape[0]:
        return -1
    lists.slot[count, q.CORNER], lists.slot[count, q.EDGE] = c, e
    lists.slot[count, q.CORNER + 1], lists.slot[count, q.EDGE + 1] = partner, facing_edge
    lists.slot[count, q.ACTIVE] = -1
    lists.kept[count, :] = 0.0
    return count + 1


LOOSE = 0.3  # an edge that faces a corner while a list lasts does so to within this when it is made [rad]


@inner
def _list_corners(outline, lists, first, count, a, b, judgement):
    """Append the slots of corners of body a near edges of body b; the new number of slots, or -1."""
    skin = judgement.skin
    for c in range(outline.span[q.FROM, a], outline.span[q.FROM, a] + outline.span[q.COUNT, a]):
        if not outline.link[q.IS_CORNER, c]:
            continue
        for e in range(outline.span[q.FROM, b], outline.span[q.FROM, b] + outline.span[q.COUNT, b]):
            d, place = locate(outline, c, e, judgement.reach)
            if abs(d) > skin or not within(outline, e, place, skin) or not faces(outline, c, e, LOOSE):
                continue
            known = False
            for k in range(first, count):
                known = known or _holds(lists, k, c, e) >= 0
            if known:
                continue
            partner, facing_edge = -1, -1
            if outline.link[q.IS_CORNER, e]:
                partner, facing_edge = _partner(outline, c, e, place, 2.0 * skin)
                if partner >= 0 and not faces(outline, partner, facing_edge, LOOSE):
                    partner, facing_edge = -1, -1
            count = _add(lists, count, c, e, partner, facing_edge)
            if count < 0:
                return -1
    return count


@inner
def _carry(old, old_pair, lists, first, count):
    """Hand the active contacts of a pair over to the new list; the new number of slots, or -1."""
    for m in range(old.pair[q.START, old_pair], old.pair[q.START, old_pair + 1]):
        v = old.slot[m, q.ACTIVE]
        if v < 0:
            continue
        c, e = old.slot[m, q.CORNER + v], old.slot[m, q.EDGE + v]
        place, variant = -1, 0
        for k in range(first, count):
            which = _holds(lists, k, c, e)
            if which >= 0 and lists.slot[k, q.ACTIVE] < 0:
                place, variant = k, which
                break
        if place < 0:  # pressed in by more than the skin, or the slot is taken by the other end of a short edge
            place = count
            count = _add(lists, count, c, e, np.int64(-1), np.int64(-1))
            if count < 0:
                return -1
        lists.slot[place, q.ACTIVE] = variant
        for i in range(lists.kept.shape[1]):
            lists.kept[place, i] = old.kept[m, i]
    return count


@inner
def _old_pair(old, a, b):
    """Where the pair is in the old lists, or -1."""
    for p in range(old.row[a], old.row[a + 1]):
        if old.pair[q.SECOND, p] == b:
            return p
    return -1


@inner
def _set_law(law, materials, bodies, a, b):
    """kn, ks, c, mu of a pair; the mass that a share of critical damping refers to is the reduced one."""
    i, j = materials.of[a], materials.of[b]
    reduced = 1.0 / (bodies[q.PER_MASS, a] + bodies[q.PER_MASS, b])
    law[0], law[1], law[3] = materials.kn[i, j], materials.ks[i, j], materials.mu[i, j]
    law[2] = materials.c[i, j] + materials.ratio[i, j] * 2.0 * math.sqrt(materials.kn[i, j] * reduced)


@inner
def _link_bodies(lists, pairs):
    """Pairs of each body, ascending."""
    lists.of_body[:] = 0
    for p in range(pairs):
        lists.of_body[lists.pair[q.FIRST, p] + 1] += 1
        lists.of_body[lists.pair[q.SECOND, p] + 1] += 1
    for b in range(lists.of_body.size - 1):
        lists.of_body[b + 1] += lists.of_body[b]
    for p in range(pairs):
        for b in (lists.pair[q.FIRST, p], lists.pair[q.SECOND, p]):
            lists.at[lists.of_body[b]] = p
            lists.of_body[b] += 1
    for b in range(lists.of_body.size - 1, 0, -1):
        lists.of_body[b] = lists.of_body[b - 1]
    lists.of_body[0] = 0


@inner
def make_lists(bodies, outline, old, lists, grid, cell, movable, materials, judgement):
    """List the pairs and slots for the present poses into `lists`, with the contacts of `old`; False without room."""
    floor = bodies.shape[1] - 1
    boxes_of(outline, floor, 0.5 * (judgement.skin + judgement.reach), grid.box)
    pairs = near_pairs(grid.box, floor, movable, cell, grid.heads, grid.entries, grid.found)
    if pairs >= 0 and outline.span[q.COUNT, floor] > 0:
        boxes_of(outline, floor, judgement.skin + judgement.reach, grid.box)
        pairs = floor_pairs(grid.box, movable, floor, grid.found, pairs)
    if pairs < 0 or pairs > lists.pair.shape[1] - 1:
        return False
    in_order(grid.found, pairs, lists.row, lists.pair[q.FIRST], lists.pair[q.SECOND])
    count = np.int64(0)  # of a plain 0 numba compiles all that takes it anew
    for p in range(pairs):
        a, b = lists.pair[q.FIRST, p], lists.pair[q.SECOND, p]
        lists.pair[q.START, p] = count
        start = count
        count = _list_corners(outline, lists, start, count, a, b, judgement)
        if count >= 0:
            count = _list_corners(outline, lists, start, count, b, a, judgement)
        before = _old_pair(old, a, b)
        if count >= 0 and before >= 0:
            count = _carry(old, before, lists, start, count)
        if count < 0:
            return False
        _set_law(lists.law[p], materials, bodies, a, b)
    lists.pair[q.START, pairs] = count
    lists.size[0], lists.size[1] = pairs, count
    _link_bodies(lists, pairs)
    for b in range(movable):
        bodies[q.LISTED_X, b], bodies[q.LISTED_Z, b] = bodies[q.X, b], bodies[q.Z, b]
        bodies[q.LISTED_THETA, b] = bodies[q.THETA, b]
    return True
