"""Critical step of an assembly: from all its contacts as the scene is given, and from each body alone.

Source  own derivation in `dem.stability`, here with the stiffness of the whole scene: a contact at r_1, r_2 from the
        centroids of two bodies adds J' diag(kn, ks) J, J the rows that give its normal and shear velocity
Status  runs just below the limit stay bounded, runs just above it grow (tests); columns of two and three blocks

With dashpots that see the velocity of half a step before, the limit is the dt at which the largest eigenvalue of
inv(M) (dt^2 K + 2 dt C) is 4. Every place where two bodies touch counts as pressed and sticking. Bodies that fall on
others may meet more contacts than those; each body is therefore also taken by itself with any one of its sides flat on
a wall, and a run that still grows is stopped and says so.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from scipy.optimize import brentq
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import eigsh

from dem import checks
from dem.assembly import Assembly
from dem.initial_contacts import IntArray, Touch, near_pairs, outlines_of, touches
from dem.materials import Contacts, ContactTable
from dem.shapes import FloatArray
from dem.stability import levers_of_side, step_of_side

DENSE = 150  # up to so many freedoms all eigenvalues are computed
NEAR = 1e-6  # things this close count as touching, as a share of the largest body


def assembly_critical_step(assembly: Assembly, contact: Contacts) -> float:
    """Largest stable step [s] of an assembly as it stands, with the contact parameters of its run.

    Raises ValueError unless it is an Assembly, and where `contact` lacks a pair of materials.
    """
    checks.kind("assembly", assembly, Assembly, "an Assembly, as column(3, b, h, d, density) makes it")
    table = assembly.contact_table(contact)
    numbers = np.array([table.names.index(name) for name in assembly.materials])
    alone = min(
        _alone(body.mass, body.inertia, body.shape.corners.tobytes(), *_stiffest(table, numbers[i], numbers, body.mass))
        for i, body in enumerate(assembly.bodies)
    )
    return min(alone, _together(assembly, table, numbers))


def _stiffest(table: ContactTable, own: int, numbers: IntArray, mass: float) -> tuple[float, float, float]:
    """Largest kn, ks, c that a body of this material and mass may meet in the scene."""
    others = np.unique(numbers)
    return (
        float(table.kn[own, others].max()),
        float(table.ks[own, others].max()),
        max(table.dashpot(own, other, mass) for other in others),
    )


@lru_cache(maxsize=4096)
def _alone(mass: float, inertia: float, corners: bytes, kn: float, ks: float, c: float) -> float:
    """Step of one body with any one side flat on something fixed; infinite where it can meet nothing."""
    if kn == 0.0:
        return math.inf
    outline = np.frombuffer(corners).reshape(-1, 2)
    masses = np.array([mass, mass, inertia])
    pairs = zip(outline, np.roll(outline, -1, axis=0), strict=True)
    return min(step_of_side(levers_of_side(first, second), masses, kn, ks, c) for first, second in pairs)


def _together(assembly: Assembly, table: ContactTable, numbers: IntArray) -> float:
    """Step of all bodies with all their contacts; infinite where nothing touches."""
    touch = all_touches(assembly)
    if not len(touch.first):
        return math.inf
    scaled, movable = _rows(assembly, touch)
    i, j = numbers[touch.first], numbers[touch.second]
    stiff = np.stack([table.kn[i, j], table.ks[i, j]], axis=1).ravel()
    per_mass = np.array([1.0 / body.mass for body in assembly.bodies] + [0.0] * (len(numbers) - movable))
    reduced = 1.0 / (per_mass[touch.first] + per_mass[touch.second])
    loss = np.repeat(table.c[i, j] + table.ratio[i, j] * 2.0 * np.sqrt(table.kn[i, j] * reduced), 2)

    def excess(dt: float) -> float:
        return _largest(scaled, dt * dt * stiff + 2.0 * dt * loss) - 4.0

    high = 2.0 / math.sqrt(_largest(scaled, stiff))
    if not loss.any():
        return high
    return float(brentq(excess, 1e-9 * high, high * (1.0 + 1e-9), xtol=1e-9 * high))


def all_touches(assembly: Assembly, reach: float = 0.0) -> Touch:
    """Contacts among bodies, with walls and with the floor, the latter numbered last.

    reach: how far off an edge is felt [m]
    """
    things = assembly.things
    outlines = outlines_of(things)
    within = max(reach, NEAR * max(body.shape.radius for body in assembly.bodies))
    touch = touches(outlines, near_pairs(assembly.bodies, assembly.walls), within)
    if not assembly.floor:
        return touch
    own = outlines.corners[: len(assembly.bodies)]
    b, c = np.nonzero((np.abs(own[..., 1]) <= within) & (outlines.lengths[: len(assembly.bodies)] > 0.0))
    up = np.tile([0.0, 1.0], (len(b), 1))
    on_floor = Touch(b, np.full(b.shape, len(things)), own[b, c], up, b, c, np.zeros_like(c))
    return Touch(*(np.concatenate(columns) for columns in zip(touch, on_floor, strict=True)))


def _rows(assembly: Assembly, touch: Touch) -> tuple[csr_matrix, int]:
    """J inv(sqrt(M)), normal and shear row of each contact in turn, and the number of movable bodies."""
    movable = len(assembly.bodies)
    centre = np.array([[body.x, body.z] for body in assembly.bodies])
    root = np.sqrt([[body.mass, body.mass, body.inertia] for body in assembly.bodies])
    count = len(touch.first)
    rows, columns, values = [], [], []
    for side, sign in ((touch.first, 1.0), (touch.second, -1.0)):
        own = np.flatnonzero(side < movable)
        body = side[own]
        r = touch.point[own] - centre[body]
        for shear, n in ((0, touch.normal[own]), (1, np.stack([touch.normal[own, 1], -touch.normal[own, 0]], axis=1))):
            turn = n[:, 0] * r[:, 1] - n[:, 1] * r[:, 0]
            for freedom, value in enumerate((n[:, 0], n[:, 1], turn)):
                rows.append(2 * own + shear)
                columns.append(3 * body + freedom)
                values.append(sign * value / root[body, freedom])
    shape = (2 * count, 3 * movable)
    return csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape), movable


def _largest(scaled: csr_matrix, weights: FloatArray) -> float:
    """Largest eigenvalue of J' diag(weights) J."""
    matrix = (scaled.T @ scaled.multiply(weights[:, None])).tocsr()
    if matrix.shape[0] <= DENSE:
        return float(np.linalg.eigvalsh(matrix.toarray())[-1])
    start = np.random.default_rng(0).standard_normal(matrix.shape[0])
    return float(eigsh(matrix, k=1, which="LA", v0=start, tol=1e-9, return_eigenvectors=False)[0])
