"""A rigid block of three degrees of freedom on springs and dashpots that push and never pull.

Two springs at the corners, or a bed under the base, summed over points of the part that is below the floor.  A soft
floor, and with stiff springs of little damping a block that bounces: nothing about impacts is put in, so what the law
of restitution would be comes out of the contact.  Friction is Coulomb's with a steep ramp through zero slip.  Torques
are those of event.py: accelerations of a block on a fixed corner, times its inertia there.  Small fixed steps; rotation
positive clockwise.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .event import FALLEN, IC, OFF, B, H, M, Response, field, own_torque
from .parameters import INDEX, World, refuse

MU, K, CD, NS = (INDEX[k] for k in ("friction", "stiffness", "damping", "springs"))
CREEP = 5e-4  # m/s
STEP = 1e-5  # s
FOREIGN = ("radius", "adhesion", "slope", "side", "leak", "bedding", "hinge", "guide", "layer", "slosh_mass", "give")
"""What these equations lack: no impact is at an instant, and corners are sharp."""


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
def rate(x, c, y, P):
    """Accelerations (x, z, theta) of the centre of mass over the floor, state y = (x, z, theta, x', z', theta')."""
    fx, fz, turn, acc = field(x, c, P)
    fx = P[M] * (fx - acc * y[1] - 2.0 * turn * y[4] + turn * turn * y[0])
    fz = P[M] * (fz + acc * y[0] + 2.0 * turn * y[3] + turn * turn * y[1])
    n = int(P[NS])
    k, d = P[K], P[CD]
    cs, sn = np.cos(y[2]), np.sin(y[2])
    middle, half = 0.0, P[B]
    if n > 2:
        middle, half = below(y[1], sn, cs, P)
        k, d = k * half / (P[B] * n), d * half / (P[B] * n)
    s = 1.0 if y[2] >= 0.0 else -1.0
    reach = P[B] - s * P[OFF]
    J = P[IC] + P[M] * (reach * reach + P[H] * P[H])
    torque = s * J * own_torque(s, s * y[2], s * y[5], 0.0, P, J) - P[IC] * acc
    for i in range(n):
        xi = middle + half * (2.0 * i - 1.0 if n == 2 else (2.0 * i + 1.0) / n - 1.0)
        rx, rz = (xi - P[OFF]) * cs - P[H] * sn, -(xi - P[OFF]) * sn - P[H] * cs
        depth = -(y[1] + rz)
        if depth <= 0.0:
            continue
        push = max(0.0, k * depth - d * (y[4] - rx * y[5]))
        drag = -P[MU] * push * min(1.0, max(-1.0, (y[3] + rz * y[5]) / CREEP))
        fx += drag
        fz += push
        torque += drag * rz - push * rx
    return fx / P[M], fz / P[M], torque / P[IC]


@njit
def advance(x, h, c, y, P):
    """One classical Runge-Kutta step, in place."""
    a = rate(x, c, y, P)
    k1 = np.array((y[3], y[4], y[5], a[0], a[1], a[2]))
    z = y + 0.5 * h * k1
    a = rate(x + 0.5 * h, c, z, P)
    k2 = np.array((z[3], z[4], z[5], a[0], a[1], a[2]))
    z = y + 0.5 * h * k2
    a = rate(x + 0.5 * h, c, z, P)
    k3 = np.array((z[3], z[4], z[5], a[0], a[1], a[2]))
    z = y + h * k3
    a = rate(x + h, c, z, P)
    k4 = np.array((z[3], z[4], z[5], a[0], a[1], a[2]))
    y += h / 6.0 * (k1 + 2 * k2 + 2 * k3 + k4)


@njit
def run(C, h, every, y, P, out, sub):
    """Fill out[(sample), (theta, theta', theta'', x'', z'')]; the sample at which it had fallen, -1 if it stood."""
    d = h / sub
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
            advance(i * d, d, c, y, P)
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
        return np.array([offset, world.centre_height - depth - turned * offset, turned, 0.0, 0.0, 0.0])
    phi, s = abs(theta0), np.sign(theta0)
    high = (world.half_breadth - s * offset) * np.sin(phi) + world.centre_height * np.cos(phi)
    along = s * world.half_breadth * (1.0 - np.cos(phi)) + offset * np.cos(phi) + s * world.centre_height * np.sin(phi)
    if world.springs == 2:
        return np.array([along, high - weight / world.stiffness, theta0, 0.0, 0.0, 0.0])
    # A bed takes the weight on a part of it: sink until that carries it, or on all of it as deep as it has to.
    step, sink = 2.0 * world.half_breadth * np.sin(phi), weight / world.stiffness
    depth = np.sqrt(2.0 * sink * step)
    height = high - (depth if depth < step else sink + 0.5 * step)
    return np.array([along, height, theta0, 0.0, 0.0, 0.0])


def simulate(world: World, felt: np.ndarray, h: float, every: int, theta0: float) -> Response:
    """Rotation of a block on springs; there is no list of impacts.

    Raises:
        ValueError: the world has an effect that these equations lack.
    """
    refuse(world, FOREIGN, "of a block on springs")
    n = felt.shape[0] // every + 1
    out = np.full((n, 5), np.nan)
    fell = run(felt, h, every, start(world, theta0), world.vector(), out, max(1, round(h / STEP)))
    theta, w, a, x, z = out.T.copy()
    centre = np.stack([x, z], axis=1)
    return Response(h * every * np.arange(n), theta, w, a, np.zeros((0, 3)), None if fell < 0 else fell, centre)
