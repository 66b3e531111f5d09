"""State of an assembly: one float64 row per quantity, index = body (movable ones first, then walls, the floor last).

Source  none, own layout; positions, velocities and normals are those in the frame of the table
Status  see the package head

`bodies` is an array of shape (quantity, body), its rows named below. Corners and edges of all bodies lie one after the
other in the arrays of `Outline`. Edge e runs from corner e to the next corner, counter-clockwise, so a body has as many
edges as corners and one index names both. The floor is a body with one edge without ends and no corner.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

# Rows of `bodies`: pose [m, rad] and its direction cosines; velocities half a step before the pose [m/s, rad/s]
X, Z, THETA, COS, SIN, VX, VZ, OMEGA = range(8)
# mass [kg], inertia [kg m^2] and their reciprocals, 0 for what is fixed; farthest corner [m]
MASS, INERTIA, PER_MASS, PER_INERTIA, RADIUS = range(8, 13)
# acceleration of the table's frame at the body in the last step [m/s^2, rad/s^2]; pose when the contacts were listed
FIELD_X, FIELD_Z, FIELD_TURN, LISTED_X, LISTED_Z, LISTED_THETA = range(13, 19)
# pose from which a fall is measured; tilts of balance from there [rad]; 1 while beyond the balance; when the balance
# was last passed outwards [s]; when the body fell [s]
START_THETA, START_Z, TILT_RIGHT, TILT_LEFT, BEYOND, CROSSED, FELL = range(19, 26)
# force left over, gravity = 1; energy ledgers and, at the last sample, energies [J]
UNBALANCE, DASHPOT, FRICTION, ONSET, WORK, KINETIC, POTENTIAL, ELASTIC = range(26, 34)
QUANTITIES = 34

# Rows of Outline.place.
LOCAL_X, LOCAL_Z, LOCAL_NX, LOCAL_NZ, AT_X, AT_Z, N_X, N_Z, LOW, HIGH = range(10)
# Rows of Outline.link and Outline.span.
OWNER, PREVIOUS, FOLLOWING, IS_CORNER = range(4)
FROM, COUNT = range(2)


class Outline(NamedTuple):
    """Corners and edges.

    place: corner and outward normal of its edge in the body's frame and in the table's; where the edge begins and ends,
        from its corner [m], shape (10, corner)
    link: body, neighbouring corners of the same body, 0 for the floor and 1 for a true corner, shape (4, corner)
    span: first corner and number of corners, shape (2, body)
    """

    place: FloatArray
    link: IntArray
    span: IntArray


# Rows of Lists.pair, columns of Lists.slot (corner and edge are two each).
FIRST, SECOND, START = range(3)
CORNER, EDGE, ACTIVE = 0, 2, 4
# Columns of Lists.kept: overlap and place along the edge [m]; springs F_n, F_s [N]; totals N, T; the part of the
# springs that acts (it differs from F_n, F_s only where a contact begins or ends within the step).
OVERLAP, PLACE, SPRING_N, SPRING_S, TOTAL_N, TOTAL_S, ACTING_N, ACTING_S = range(8)
# Columns of Lists.law.
KN, KS, DAMPING, MU = range(4)
# Columns of Lists.load: sums of a pair in this step.
FORCE_X, FORCE_Z, MOMENT_FIRST, MOMENT_SECOND, LOST_DASHPOT, LOST_FRICTION, LOST_ONSET, IN_SPRINGS = range(8)


class Lists(NamedTuple):
    """Pairs of bodies that may touch, in order of (first, second), and their slots: places where they may touch.

    size: pairs, slots; row: first pair of each body as first of the pair, shape (body + 1,)
    pair: bodies of a pair and its first slot, shape (3, pair + 1); law: kn, ks, c, mu, shape (pair, 4)
    of_body, at: pairs of body b are at[of_body[b]:of_body[b + 1]], ascending
    load: forces on the first body, clockwise moments on both, energies lost, energy in the springs, shape (pair, 8)
    slot: corners of its one or two variants, -1 if there is no second; their edges; which is active, or -1, shape
        (slot, 5)
    kept: what is carried from step to step, shape (slot, 8)
    """

    size: IntArray
    row: IntArray
    pair: IntArray
    law: FloatArray
    of_body: IntArray
    at: IntArray
    load: FloatArray
    slot: IntArray
    kept: FloatArray


class Watched(NamedTuple):
    """Interfaces whose opening is watched: bodies, shape (interface, 2); corner and edge of the contact at each end,
    shape (interface, 2, 2), -1 if there is none; relative rotation at the start [rad] and when it opened [s]."""

    between: IntArray
    ends: IntArray
    turn: FloatArray
    opened: FloatArray


class Saved(NamedTuple):
    """Samples: times; motion of the chosen bodies, shape (sample, body, 6); energies, shape (sample, 7); column of each
    body, -1 if not kept."""

    time: FloatArray
    motion: FloatArray
    energy: FloatArray
    column: IntArray


def lists_of(bodies: int, pairs: int, slots: int) -> Lists:
    """Empty lists with room for so many pairs and slots."""
    return Lists(
        size=np.zeros(2, np.int64),
        row=np.zeros(bodies + 1, np.int64),
        pair=np.zeros((3, pairs + 1), np.int64),
        law=np.zeros((pairs, 4)),
        of_body=np.zeros(bodies + 1, np.int64),
        at=np.zeros(2 * pairs, np.int64),
        load=np.zeros((pairs, 8)),
        slot=np.zeros((slots, 5), np.int64),
        kept=np.zeros((slots, 8)),
    )
