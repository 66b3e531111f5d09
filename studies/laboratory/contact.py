"""A rigid block of three degrees of freedom on springs and dashpots that push and never pull.

Two springs at the corners, or a bed, by Gauss's quadrature over the part of the base that is below the floor.  A soft
floor, and with stiff springs of little damping a block that bounces: nothing about impacts is put in, so what the law
of restitution would be comes out of the contact.  Along the floor each corner below it is held by a spring that begins
where it touched and a dashpot, as strong as Coulomb's friction lets them be.  Torques are those of event.py:
accelerations of a block on a fixed corner, times its inertia there.  Steps are small, and smaller where a contact
begins or ends, sticks or slips; rotation positive clockwise.

Source   of springs along the floor: Cundall (1971); Mindlin (1949), two thirds to one of that across it for like bodies
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .event import FALLEN, IC, OFF, B, H, M, Response, field, own_torque
from .parameters import INDEX, World, refuse

MU, K, CD, NS, GIVE = (INDEX[k] for k in ("friction", "stiffness", "damping", "springs", "give"))
STEP = 1e-5  # s
FINEST = 1.0 / 256.0  # of a step: parts of this length and less are not cut up further
FOREIGN = (
    "radius", "adhesion", "slope", "side", "leak", "bedding", "grind", "heed", "hinge", "guide", "layer", "slosh_mass",
)  # fmt: skip
"""What these equations lack: no impact is at an instant, and corners are sharp."""


POINTS = 15
"""Of the quadrature of a bed: exact but for where a dashpot would have to pull."""
PLACES, SHARES = np.polynomial.legendre.leggauss(POINTS)


@njit
def below(z, sn, cs, P):
    """(middle, half of the length) of the part of the base that is below the floor, along it from its middle."""
    # A point xi of the base is at z - (xi - offset) sin - h cos.
    if abs(sn) < 1e-15:
        return 0.0, P[B]
    end = P[OFF] + (z - P[H] * cs) / sn
    if sn > 0.0:
        low, high = min(max(end, -P[B]), P[B]), P[B]
    else:
        low, high = -P[B], max(min(end, P[B]), -P[B])
    return 0.5 * (low + high), 0.5 * (high - low)


@njit
def corner(side, y, sn, cs, P):
    """(arm x, arm z, depth below the floor, velocity along it) of the corner of that side."""
    xi = side * P[B] - P[OFF]
    rx, rz = xi * cs - P[H] * sn, -xi * sn - P[H] * cs
    return rx, rz, -(y[1] + rz), y[3] + rz * y[5]


@njit
def pushes(y, sn, cs, P):
    """Of the springs across the floor: (force, torque, force at the left corner, at the right one).

    Of a bed the whole force may hold either corner.
    """
    n = int(P[NS])
    middle, half = 0.0, P[B]
    if n > 2:
        middle, half = below(y[1], sn, cs, P)
    total, torque, left, right = 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        share = 1.0 if n == 2 else 0.5 * SHARES[i] * half / P[B]
        k, d = share * P[K], share * P[CD]
        xi = middle + half * (2.0 * i - 1.0 if n == 2 else PLACES[i])
        rx, rz = (xi - P[OFF]) * cs - P[H] * sn, -(xi - P[OFF]) * sn - P[H] * cs
        depth = -(y[1] + rz)
        if depth <= 0.0:
            continue
        push = max(0.0, k * depth - d * (y[4] - rx * y[5]))
        total += push
        torque -= push * rx
        left, right = (push if i == 0 else left), (push if i == 1 else right)
    return (total, torque, left, right) if n == 2 else (total, torque, total, total)


@njit
def held(push, P):
    """Largest force along the floor that friction gives."""
    return P[MU] * push if push > 0.0 else 0.0


@njit
def along_the_floor(P):
    """Stiffness and damping of a corner along the floor, its loss the same share as across it."""
    share = 1.0 if P[NS] == 2.0 else 0.5
    return share * P[K] / P[GIVE], share * P[CD] / np.sqrt(P[GIVE])


@njit
def rate(x, c, y, P):
    """Accelerations (x, z, theta) of the centre of mass over the floor, and how fast the corners stretch their springs.

    State y = (x, z, theta, x', z', theta', stretch of the left corner, of the right one).
    """
    fx, fz, turn, acc = field(x, c, P)
    fx = P[M] * (fx - acc * y[1] - 2.0 * turn * y[4] + turn * turn * y[0])
    fz = P[M] * (fz + acc * y[0] + 2.0 * turn * y[3] + turn * turn * y[1])
    cs, sn = np.cos(y[2]), np.sin(y[2])
    s = 1.0 if y[2] >= 0.0 else -1.0
    reach = P[B] - s * P[OFF]
    J = P[IC] + P[M] * (reach * reach + P[H] * P[H])
    push, turning, left, right = pushes(y, sn, cs, P)
    fz += push
    torque = s * J * own_torque(s, s * y[2], s * y[5], 0.0, P, J) - P[IC] * acc + turning
    k, d = along_the_floor(P)
    slips = np.zeros(2)
    for i in range(2):
        _, rz, depth, u = corner(2.0 * i - 1.0, y, sn, cs, P)
        if depth <= 0.0:
            continue
        most = held(left if i == 0 else right, P)
        stretch = min(most / k, max(-most / k, y[6 + i]))  # `slip` cuts it, but at the end of a step
        drag = min(most, max(-most, -k * stretch - d * u))
        fx += drag
        torque += drag * rz
        slips[i] = u
    return fx / P[M], fz / P[M], torque / P[IC], slips[0], slips[1]


@njit
def advance(x, h, c, y, P):
    """One classical Runge-Kutta step, in place."""
    a = rate(x, c, y, P)
    k1 = np.array((y[3], y[4], y[5], a[0], a[1], a[2], a[3], a[4]))
    z = y + 0.5 * h * k1
    a = rate(x + 0.5 * h, c, z, P)
    k2 = np.array((z[3], z[4], z[5], a[0], a[1], a[2], a[3], a[4]))
    z = y + 0.5 * h * k2
    a = rate(x + 0.5 * h, c, z, P)
    k3 = np.array((z[3], z[4], z[5], a[0], a[1], a[2], a[3], a[4]))
    z = y + h * k3
    a = rate(x + h, c, z, P)
    k4 = np.array((z[3], z[4], z[5], a[0], a[1], a[2], a[3], a[4]))
    y += h / 6.0 * (k1 + 2 * k2 + 2 * k3 + k4)
    slip(y, P)


@njit
def slip(y, P):
    """A corner that left the floor lets go of its spring, one that friction does not hold drags it along, in place."""
    cs, sn = np.cos(y[2]), np.sin(y[2])
    _, _, left, right = pushes(y, sn, cs, P)
    k, _ = along_the_floor(P)
    for i in range(2):
        most = held(left if i == 0 else right, P) / k
        under = corner(2.0 * i - 1.0, y, sn, cs, P)[2] > 0.0
        y[6 + i] = min(most, max(-most, y[6 + i])) if under else 0.0


@njit
def contacts(y, P):
    """Which springs push, which corners are below the floor and which of these slip, a bit each."""
    cs, sn = np.cos(y[2]), np.sin(y[2])
    n = int(P[NS])
    middle, half = below(y[1], sn, cs, P) if n > 2 else (0.0, P[B])
    found = 0
    for i in range(n):
        xi = middle + half * (2.0 * i - 1.0 if n == 2 else PLACES[i])
        rx, rz = (xi - P[OFF]) * cs - P[H] * sn, -(xi - P[OFF]) * sn - P[H] * cs
        depth = -(y[1] + rz)
        if depth > 0.0 and P[K] * depth > P[CD] * (y[4] - rx * y[5]):
            found |= 1 << i
    _, _, left, right = pushes(y, sn, cs, P)
    k, _ = along_the_floor(P)
    for i in range(2):
        if corner(2.0 * i - 1.0, y, sn, cs, P)[2] > 0.0:
            found |= 1 << (n + i)
            # `slip` sets it to that, to rounding.
            if k * abs(y[6 + i]) >= (1.0 - 1e-12) * held(left if i == 0 else right, P):
                found |= 1 << (n + 2 + i)
    return found


@njit
def across(x, d, c, y, before, P):
    """A step, in place, cut up where a contact changes in it; the contacts after it."""
    done, part, begin = 0.0, 1.0, y.copy()
    while done < 1.0:
        part = min(part, 1.0 - done)
        begin[:] = y
        advance(x + done * d, part * d, c, y, P)
        after = contacts(y, P)
        if after != before and part > FINEST:
            y[:] = begin
            part *= 0.5
            continue
        done, before, part = done + part, after, 2.0 * part
    return before


@njit
def run(C, h, every, y, P, out, sub):
    """Fill out[(sample), (theta, theta', theta'', x'', z'')]; the sample at which it had fallen, -1 if it stood."""
    d, touching = h / sub, contacts(y, P)
    for k in range(C.shape[0] + 1):
        c, x0 = C[min(k, C.shape[0] - 1)], (0.0 if k < C.shape[0] else h)
        if k % every == 0:
            a = rate(x0, c, y, P)
            out[k // every] = np.array((y[2], y[5], a[2], a[0], a[1]))
        if abs(y[2]) > FALLEN:
            return k // every + 1
        if k == C.shape[0]:
            break
        for i in range(sub):
            touching = across(i * d, d, c, y, touching, P)
    return -1


def start(world: World, theta0: float) -> np.ndarray:
    """At rest on its springs, or held at a lean with its weight on one corner or on a part of the bed."""
    weight, offset = world.mass * world.gravity, world.offset
    if theta0 == 0.0:
        corners = world.springs == 2
        depth = weight / (world.stiffness * (2 if corners else 1))
        # The floor's tilt and the offset turn it until the springs hold.
        turned = weight * (offset + world.tilt * world.centre_height) / (world.half_breadth**2 * world.stiffness)
        turned *= 0.5 if corners else 3.0
        pulled = 0.5 * weight * np.sin(world.tilt) / along_the_floor(world.vector())[0]
        height = world.centre_height - depth - turned * offset
        return np.array([offset, height, turned, 0.0, 0.0, 0.0, pulled, pulled])
    phi, s = abs(theta0), np.sign(theta0)
    high = (world.half_breadth - s * offset) * np.sin(phi) + world.centre_height * np.cos(phi)
    along = s * world.half_breadth * (1.0 - np.cos(phi)) + offset * np.cos(phi) + s * world.centre_height * np.sin(phi)
    if world.springs == 2:
        return np.array([along, high - weight / world.stiffness, theta0, *[0.0] * 5])
    # A bed takes the weight on a part of it: sink until that carries it, or on all of it as deep as it has to.
    step, sink = 2.0 * world.half_breadth * np.sin(phi), weight / world.stiffness
    depth = np.sqrt(2.0 * sink * step)
    height = high - (depth if depth < step else sink + 0.5 * step)
    return np.array([along, height, theta0, *[0.0] * 5])


def simulate(world: World, felt: np.ndarray, h: float, every: int, theta0: float) -> Response:
    """Rotation of a block on springs; there is no list of impacts.

    Raises:
        ValueError: the world has an effect that these equations lack, or springs that give nowhere.
    """
    refuse(world, FOREIGN, "of a block on springs")
    if world.springs not in (2.0, POINTS):
        raise ValueError(f"springs={world.springs!r}: want 2, or {POINTS} of a bed")
    if not (world.stiffness > 0.0 and world.give > 0.0):
        raise ValueError(f"stiffness={world.stiffness!r}, give={world.give!r}: want springs that give, both above 0")
    n = felt.shape[0] // every + 1
    out = np.full((n, 5), np.nan)
    fell = run(felt, h, every, start(world, theta0), world.vector(), out, max(1, round(h / STEP)))
    theta, w, a, x, z = out.T.copy()
    centre = np.stack([x, z], axis=1)
    return Response(h * every * np.arange(n), theta, w, a, np.zeros((0, 3)), None if fell < 0 else fell, centre)
