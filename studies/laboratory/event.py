"""A rigid block that rocks on a moving floor, every impact and lift-off located.

Mirrored coordinates: on side s = +1 or -1 (the corner it stands on) the lean is phi = s theta >= 0 and x points to s.
The edge is an arc of radius r that rolls without slip; its centre is at C = (B - r + r phi, r).  With (u, w) from C to
the centre of mass in the block, the latter lies at  X = B - r + r phi + D,  Z = r - u sin phi + w cos phi,  where
D = u cos phi + w sin phi;  dX/dphi = Z,  dZ/dphi = -D.  Lagrange's equation, J = I_c + m (Z^2 + D^2):

    J phi'' = m (r D phi'^2 + f_x Z - f_z D) - b'' (I_c + m (Z^2 + X D)) + m b'^2 Z (X - D) + torques

in the field f of the floor's frame (gravity and the floor's acceleration, both turned by the floor's own angle b).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from .parameters import INDEX, World

# Compiled anew in each process: numba's cache looks at one file alone and would keep old places of INDEX.
B, H, M, IC, E0 = (INDEX[k] for k in ("half_breadth", "centre_height", "mass", "inertia", "restitution"))
R, OFF, TILT, GRAV = (INDEX[k] for k in ("radius", "offset", "tilt", "gravity"))
VIS, QUA, TK, TP, TM, ADH = (
    INDEX[k] for k in ("viscous", "quadratic", "tether_stiffness", "tether_plus", "tether_minus", "adhesion")
)
SLOPE, SIDE, LEAK, LEAKT, BED = (INDEX[k] for k in ("slope", "side", "leak", "leak_time", "bedding"))
GRI, GRIU, USED, HEED = (INDEX[k] for k in ("grind", "grind_use", "used", "heed"))
CUB, HIN, SVIS, RIB, RIBP = (INDEX[k] for k in ("cubic", "hinge", "side_viscous", "rib", "rib_period"))
MAG, MAGW, LAY, LAYW = (INDEX[k] for k in ("magnet", "magnet_width", "layer", "layer_width"))
GUI, GUIF, SQU, SQUW = (INDEX[k] for k in ("guide", "guide_from", "squeeze", "squeeze_width"))
BRA, BRAT, BRAW = (INDEX[k] for k in ("brake", "brake_at", "brake_width"))
SM, SL, SH, SD = (INDEX[k] for k in ("slosh_mass", "slosh_length", "slosh_height", "slosh_damping"))

REST_SPEED = 1e-4  # rad/s after an impact, below which the block may come to rest
FALLEN = 1.2  # rad


@njit
def base(x, c):
    """(a_x, a_z, pitch, rate, acceleration) at x [s] into a piece."""
    x2 = x * x
    x3 = x2 * x
    return (
        c[0, 0] + c[0, 1] * x + c[0, 2] * x2 + c[0, 3] * x3,
        c[1, 0] + c[1, 1] * x + c[1, 2] * x2 + c[1, 3] * x3,
        c[2, 0] + c[2, 1] * x + c[2, 2] * x2 + c[2, 3] * x3,
        c[3, 0] + c[3, 1] * x + c[3, 2] * x2 + c[3, 3] * x3,
        c[4, 0] + c[4, 1] * x + c[4, 2] * x2 + c[4, 3] * x3,
    )


@njit
def field(x, c, P):
    """(f_x, f_z) in the floor's frame, unmirrored, and the floor's angular rate and acceleration."""
    ax, az, pitch, rate, acc = base(x, c)
    b = P[TILT] + pitch
    sb, cb = np.sin(b), np.cos(b)
    return (P[GRAV] + az) * sb - ax * cb, -(P[GRAV] + az) * cb - ax * sb, rate, acc


@njit
def rubbing(s, phi, P):
    """Dry friction, as an angular acceleration."""
    return P[HIN] * phi + (P[GUI] if s > 0 and phi >= P[GUIF] else 0.0)


@njit
def own_torque(s, phi, v, z, P, J):
    """Angular acceleration by everything that is neither weight nor base, but dry friction."""
    theta = s * phi
    a = -P[VIS] * v - P[QUA] * v * abs(v) - P[CUB] * phi**3
    if theta > P[TP]:
        a -= P[TK] * (phi - P[TP]) / J
    if -theta > P[TM]:
        a -= P[TK] * (phi - P[TM]) / J
    if s > 0:
        a -= P[SVIS] * v
    if P[SQU] != 0.0:
        a -= P[SQU] * np.exp(-phi / P[SQUW]) * v
    if P[BRA] != 0.0:
        a -= P[BRA] * np.exp(-(((theta - P[BRAT]) / P[BRAW]) ** 2)) * v
    if P[RIB] != 0.0:
        a += s * P[RIB] * np.sin(2 * np.pi * theta / P[RIBP])
    if P[MAG] != 0.0:
        a -= P[MAG] * np.exp(-phi / P[MAGW])
    return a - s * P[LAY] * z / J


@njit
def hang(s, phi, r, P):
    """Point H of the hanging mass's hinge: derivatives of its place by phi, first and second (times phi'^2)."""
    u, w = -(P[B] - r), P[SH] - r
    dx = u * np.cos(phi) + w * np.sin(phi)
    hz = r - u * np.sin(phi) + w * np.cos(phi)
    return hz, -dx, -dx, r - hz


@njit
def acceleration(x, c, s, phi, v, q, qd, turn, P):
    """(phi'', q', qd') in mirrored phi; q is the strain of the layer or the angle of the hanging mass (unmirrored)."""
    r = P[R]
    u, w = s * P[OFF] - (P[B] - r), P[H] - r
    cp, sp = np.cos(phi), np.sin(phi)
    D = u * cp + w * sp
    Z = r - u * sp + w * cp
    X = P[B] - r + r * phi + D
    J = P[IC] + P[M] * (Z * Z + D * D)
    fx, fz, rate, acc = field(x, c, P)
    fx *= s
    Q = P[M] * (r * D * v * v + fx * Z - fz * D)
    Q += -s * acc * (P[IC] + P[M] * (Z * Z + X * D)) + P[M] * rate * rate * Z * (X - D)
    if P[SM] == 0.0:
        a = Q / J + own_torque(s, phi, v, q, P, J) - rubbing(s, phi, P) * turn
        dq = 0.0
        if P[LAY] != 0.0:
            dq = s * v - abs(v) * q * abs(q) / P[LAYW] ** 2
        return a, dq, 0.0
    # Two degrees of freedom: the block and a mass hung in it on an arm of length l, psi mirrored like phi.
    m, length = P[SM], P[SL]
    psi, om = s * q, s * qd
    a1, a2, b1, b2 = hang(s, phi, r, P)
    ex, ez = length * np.cos(psi), length * np.sin(psi)
    bx, bz = b1 * v * v - ez * om * om, b2 * v * v + ex * om * om
    m11, m12, m22 = J + m * (a1 * a1 + a2 * a2), m * (a1 * ex + a2 * ez), m * length * length
    r1 = Q + m * (a1 * (fx - bx) + a2 * (fz - bz)) + J * own_torque(s, phi, v, 0.0, P, J)
    r2 = m * (ex * (fx - bx) + ez * (fz - bz)) - m22 * P[SD] * om
    det = m11 * m22 - m12 * m12
    return (m22 * r1 - m12 * r2) / det, qd, s * (m11 * r2 - m12 * r1) / det


@njit
def at_rest(x, c, q, qd, P):
    """Acceleration of the hanging mass while the block stands."""
    if P[SM] == 0.0:
        return 0.0
    fx, fz, _, _ = field(x, c, P)
    return (np.cos(q) * fx + np.sin(q) * fz) / P[SL] - P[SD] * qd


@njit
def lift(x, c, s, q, qd, P):
    """Angular acceleration with which side s would leave, less what adhesion holds back."""
    a, _, _ = acceleration(x, c, s, 0.0, 0.0, q, qd, 0.0, P)
    u = s * P[OFF] - (P[B] - P[R])
    return a - P[ADH] / (P[IC] + P[M] * (P[H] ** 2 + u * u))


@njit
def rk4(x, h, c, s, phi, v, q, qd, turn, P):
    """One classical Runge-Kutta step."""
    a1, d1, e1 = acceleration(x, c, s, phi, v, q, qd, turn, P)
    v2 = v + 0.5 * h * a1
    a2, d2, e2 = acceleration(x + 0.5 * h, c, s, phi + 0.5 * h * v, v2, q + 0.5 * h * d1, qd + 0.5 * h * e1, turn, P)
    v3 = v + 0.5 * h * a2
    a3, d3, e3 = acceleration(x + 0.5 * h, c, s, phi + 0.5 * h * v2, v3, q + 0.5 * h * d2, qd + 0.5 * h * e2, turn, P)
    v4 = v + h * a3
    a4, d4, e4 = acceleration(x + h, c, s, phi + h * v3, v4, q + h * d3, qd + h * e3, turn, P)
    w = h / 6.0
    return (
        phi + w * (v + 2 * v2 + 2 * v3 + v4),
        v + w * (a1 + 2 * a2 + 2 * a3 + a4),
        q + w * (d1 + 2 * d2 + 2 * d3 + d4),
        qd + w * (e1 + 2 * e2 + 2 * e3 + e4),
    )


@njit
def restitution(s, speed, since, count, use, ax, P):
    """Speed after over before, for an impact that ends a swing on side s while the base is accelerated by ax."""
    e = P[E0] + P[SLOPE] * speed - P[LEAK] * np.exp(-since / P[LEAKT]) - P[BED] * np.exp(-count / 4.0)
    e -= P[GRI] * (1.0 - np.exp(-use / P[GRIU])) - P[HEED] * s * ax
    e *= 1.0 + s * P[SIDE]
    if P[OFF] != 0.0:
        # What is gained over the balance of angular momentum is the same on both sides; the balance is not.
        k = P[B] - P[R]
        before = P[IC] + P[M] * (P[H] ** 2 + P[OFF] ** 2 - k * k)
        after = P[IC] + P[M] * (P[H] ** 2 + (P[OFF] + s * k) ** 2)
        centred = (P[IC] + P[M] * (P[H] ** 2 - k * k)) / (P[IC] + P[M] * (P[H] ** 2 + k * k))
        e *= before / after / centred
    return min(1.0, max(0.0, e))


@njit
def locate(x, h, c, s, phi, v, q, qd, turn, P, which):
    """Step after which phi (which = 0) or v (1) has changed sign within h: Newton kept in a bracket."""
    sign = 1.0 if which == 0 else (1.0 if v > 0 else -1.0)
    lo, hi, tau = 0.0, h, 0.5 * h
    for _ in range(80):
        p1, v1, q1, d1 = rk4(x, tau, c, s, phi, v, q, qd, turn, P)
        f = p1 if which == 0 else v1
        if sign * f > 0:
            lo = tau
        else:
            hi = tau
        if hi - lo < 1e-14 * h:
            break
        slope = v1
        if which == 1:
            slope, _, _ = acceleration(x + tau, c, s, p1, v1, q1, d1, turn, P)
        new = tau - f / slope if slope != 0.0 else 0.5 * (lo + hi)
        if not lo < new < hi:
            new = 0.5 * (lo + hi)
        if abs(new - tau) < 1e-15 * h:
            tau = new
            break
        tau = new
    return tau


@njit
def side_that_lifts(x, c, q, qd, P):
    """The side that accelerates upward from rest, 0 if none does."""
    lp, lm = lift(x, c, 1.0, q, qd, P), lift(x, c, -1.0, q, qd, P)
    if lp > 0.0 and lp >= lm:
        return 1.0
    if lm > 0.0:
        return -1.0
    return 0.0


@njit
def direction(x, c, s, phi, v, q, qd, P):
    """Sense of motion that dry friction works against; 0 where it holds the block."""
    if v != 0.0 or rubbing(s, phi, P) == 0.0:
        return np.sign(v)
    a, _, _ = acceleration(x, c, s, phi, 0.0, q, qd, 0.0, P)
    return np.sign(a) if abs(a) > rubbing(s, phi, P) else 0.0


@njit
def run(C, h, every, theta0, P, out, hits):
    """Fill out[(sample), (theta, theta', theta'')] and hits[(impact), (time, theta' before, theta' after)].

    Returns impacts, and the number of the sample at which it had fallen (-1 if it stood).
    """
    s = 1.0 if theta0 >= 0 else -1.0
    phi, v, q, qd, last, turn = abs(theta0), 0.0, 0.0, 0.0, -1e9, 0.0
    rocking = phi > 0.0
    count, use = 0, P[USED]
    for k in range(C.shape[0] + 1):
        c = C[min(k, C.shape[0] - 1)]
        x = 0.0 if k < C.shape[0] else h
        if k % every == 0:
            j = k // every
            a = 0.0
            if rocking:
                a, _, _ = acceleration(x, c, s, phi, v, q, qd, turn, P)
            out[j, 0], out[j, 1], out[j, 2] = s * phi, s * v, s * a
        if phi > FALLEN:
            return count, k // every + 1
        if k == C.shape[0]:
            break
        guard = 0
        while x < h and guard < 500:
            guard += 1
            left = h - x
            if not rocking:
                k1 = at_rest(x, c, q, qd, P)
                qn, dn = q, qd
                if P[SM] != 0.0:
                    k2 = at_rest(x + 0.5 * left, c, q + 0.5 * left * qd, qd + 0.5 * left * k1, P)
                    qn, dn = q + left * (qd + 0.5 * left * k2), qd + left * k2
                s1 = side_that_lifts(h, c, qn, dn, P)
                if s1 == 0.0:
                    x, q, qd = h, qn, dn
                    break
                lo, hi = 0.0, left
                if side_that_lifts(x, c, q, qd, P) != 0.0:
                    hi = 0.0
                for _ in range(60):
                    mid = 0.5 * (lo + hi)
                    share = mid / left
                    if side_that_lifts(x + mid, c, q + share * (qn - q), qd + share * (dn - qd), P) != 0.0:
                        hi = mid
                    else:
                        lo = mid
                share = hi / left
                x, q, qd = x + hi, q + share * (qn - q), qd + share * (dn - qd)
                s, phi, v, rocking = side_that_lifts(x, c, q, qd, P), 0.0, 0.0, True
                left = h - x
                if s == 0.0 or left <= 0.0:
                    rocking, s = s != 0.0, (s if s != 0.0 else 1.0)
                    if left <= 0.0:
                        break
                    continue
            turn = direction(x, c, s, phi, v, q, qd, P)
            dry = rubbing(s, phi, P) != 0.0
            if dry and turn == 0.0 and phi > 0.0:
                x = h  # held for the rest of the step
                break
            p1, v1, q1, d1 = rk4(x, left, c, s, phi, v, q, qd, turn, P)
            if dry and v != 0.0 and v * v1 < 0.0 and phi > 0.0 and (p1 > 0.0 or v > 0.0):
                tau = locate(x, left, c, s, phi, v, q, qd, turn, P, 1)
                p1, v1, q1, d1 = rk4(x, tau, c, s, phi, v, q, qd, turn, P)
                if p1 > 0.0:
                    x, phi, v, q, qd = x + tau, p1, 0.0, q1, d1
                    continue
                p1 = -1.0
            if p1 >= 0.0:
                x, phi, v, q, qd = h, p1, v1, q1, d1
                break
            tau = locate(x, left, c, s, phi, v, q, qd, turn, P, 0)
            p1, v1, q1, d1 = rk4(x, tau, c, s, phi, v, q, qd, turn, P)
            x += tau
            time = k * h + x
            e = restitution(s, abs(v1), time - last, count, use, base(x, c)[0], P)
            use += v1 * v1
            v2 = e * abs(v1)
            if P[SM] != 0.0:
                # The hanging mass keeps its momentum along its own arc while the hinge jerks.
                dvx = P[SH] * s * (-v2 - v1)
                dvz = (P[B] - P[R]) * (v2 - v1)
                d1 -= (np.cos(q1) * dvx + np.sin(q1) * dvz) / P[SL]
            if abs(v1) > REST_SPEED and count < hits.shape[0]:
                hits[count, 0], hits[count, 1], hits[count, 2] = time, s * v1, s * v1 * e
                count += 1
                last = time
            s, phi, v, q, qd = -s, 0.0, v2, q1, d1
            if v < REST_SPEED:
                s1 = side_that_lifts(x, c, q, qd, P)
                v = 0.0
                if s1 == 0.0 or tau < 1e-9 * h:
                    rocking = False
                    if tau < 1e-9 * h:
                        break
                else:
                    s = s1
    return count, -1


@dataclass(frozen=True)
class Response:
    """Rotation [rad] and its derivatives at the samples, NaN from the fall on; impacts as (time, before, after)."""

    time: np.ndarray
    rotation: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    impacts: np.ndarray
    fell: int | None
    centre: np.ndarray | None = None  # acceleration of the centre of mass over the floor, where contact is resolved


def simulate(world: World, felt: np.ndarray, h: float, every: int, theta0: float) -> Response:
    """Rotation of `world` on a floor given by cubic pieces of length `h` [s], sampled at every so many pieces."""
    n = felt.shape[0] // every + 1
    out, hits = np.full((n, 3), np.nan), np.zeros((5000, 3))
    count, fell = run(felt, h, every, theta0, world.vector(), out, hits)
    rotation, velocity, acceleration = out.T.copy()
    time = h * every * np.arange(n)
    return Response(time, rotation, velocity, acceleration, hits[:count].copy(), None if fell < 0 else fell)
