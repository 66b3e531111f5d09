"""A rigid block that rocks and slides: friction on the corner it stands on (or the base), impacts located.

Side-mirrored lean phi as in event.py, sharp edges and a level floor.  The foot either sticks or slips at V against
Coulomb friction -kappa N, kappa = mu sign(V).  With N / m = g - D phi'' - Z phi'^2 the slip drops out of the equation
of rotation while it lasts:

    (I_c / m + D^2 + kappa Z D) phi'' = Z (kappa g - (D + kappa Z) phi'^2) + g D

An impact keeps the ratio of angular speeds; its horizontal impulse is what stops slip, or friction times the vertical
impulse m B |phi'| (1 + e) if that is less.  Changes between stick and slip are located, as impacts are: put off to
the next of steps of 5e-5 s they move what friction seems to be by 1e-5 to 1e-3 of itself.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .event import E0, FALLEN, GRAV, IC, REST_SPEED, B, H, M, Response, base
from .parameters import INDEX, World

MU = INDEX["friction"]
STEP = 2e-4  # s
AT_ONCE = 1e-6  # share of a step within which friction does not change again
MOST = 200  # events within a step; 56 is the most that was met, of a block of 4 cm


@njit
def rate(x, c, s, phi, v, sense, P):
    """(phi'', slip acceleration, friction over normal force) while rocking; sense of slip, 0 sticks; unmirrored."""
    ax, az, _, _, _ = base(x, c)
    g, fx = P[GRAV] + az, -s * ax
    D, Z = -P[B] * np.cos(phi) + P[H] * np.sin(phi), P[B] * np.sin(phi) + P[H] * np.cos(phi)
    if sense == 0.0:
        a = (fx * Z + g * D) / (P[IC] / P[M] + D * D + Z * Z)
        return a, 0.0, s * (Z * a - D * v * v - fx) / (g - D * a - Z * v * v)
    kappa = P[MU] * s * sense
    a = (Z * (kappa * g - (D + kappa * Z) * v * v) + g * D) / (P[IC] / P[M] + D * D + kappa * Z * D)
    return a, s * (fx - Z * a + D * v * v - kappa * (g - D * a - Z * v * v)), -s * kappa


@njit
def standing(x, c, sense, P):
    """Slip acceleration while the whole base is down, and friction over normal force."""
    ax, az, _, _, _ = base(x, c)
    if sense == 0.0:
        return 0.0, ax / (P[GRAV] + az)
    return -ax - P[MU] * sense * (P[GRAV] + az), -P[MU] * sense


@njit
def sense_of(ratio, V, P):
    """Sense in which the foot slips, given what sticking would ask of friction."""
    if V != 0.0:
        return np.sign(V)
    return -np.sign(ratio) if abs(ratio) > P[MU] else 0.0


@njit
def step(x, h, c, s, phi, v, V, sense, P):
    """One classical Runge-Kutta step while rocking."""
    a1, b1, _ = rate(x, c, s, phi, v, sense, P)
    v2 = v + 0.5 * h * a1
    a2, b2, _ = rate(x + 0.5 * h, c, s, phi + 0.5 * h * v, v2, sense, P)
    v3 = v + 0.5 * h * a2
    a3, b3, _ = rate(x + 0.5 * h, c, s, phi + 0.5 * h * v2, v3, sense, P)
    v4 = v + h * a3
    a4, b4, _ = rate(x + h, c, s, phi + h * v3, v4, sense, P)
    w = h / 6.0
    return (
        phi + w * (v + 2 * v2 + 2 * v3 + v4),
        v + w * (a1 + 2 * a2 + 2 * a3 + a4),
        V + w * (b1 + 2 * b2 + 2 * b3 + b4),
    )


@njit
def lifting(x, c, sense, P):
    """The side that leaves the floor from standing, 0 if none does."""
    if rate(x, c, 1.0, 0.0, 0.0, sense, P)[0] > 0.0:
        return 1.0
    return -1.0 if rate(x, c, -1.0, 0.0, 0.0, sense, P)[0] > 0.0 else 0.0


@njit
def stopped(V, V1, sense):
    """Slip after a step; none where it would have turned round."""
    return 0.0 if sense == 0.0 or (V1 * sense <= 0.0) else V1


@njit
def let_go(x, h, c, s, phi, v, V, sense, P):
    """Whether by the end of a step while rocking slip has turned round, or sticking asks too much of friction."""
    p1, v1, V1 = step(x, h, c, s, phi, v, V, sense, P)
    return V1 * sense <= 0.0 if sense != 0.0 else abs(rate(x + h, c, s, p1, v1, 0.0, P)[2]) > P[MU]


@njit
def let_go_standing(x, h, c, V, sense, P):
    """The same from standing."""
    if sense == 0.0:
        return abs(standing(x + h, c, 0.0, P)[1]) > P[MU]
    return (V + 0.5 * h * (standing(x, c, sense, P)[0] + standing(x + h, c, sense, P)[0])) * sense <= 0.0


@njit
def strike(s, v, V, P):
    """(angular speed, slip) after an impact that ends a swing on side s with angular velocity v < 0."""
    w = abs(v)
    change = s * P[H] * w * (1.0 - P[E0])
    need, most = change - V, P[MU] * P[B] * w * (1.0 + P[E0])
    impulse = min(most, max(-most, need))
    return P[E0] * w, 0.0 if impulse == need else impulse + V - change


@njit
def stand(x, d, c, V, P):
    """(time used, slip, side that lifts or 0) of a step from standing."""
    sense = sense_of(standing(x, c, 0.0, P)[1], V, P)
    if let_go_standing(x, d, c, V, sense, P):
        lo, hi = 0.0, d
        for _ in range(50):
            mid = 0.5 * (lo + hi)
            if let_go_standing(x, mid, c, V, sense, P):
                hi = mid
            else:
                lo = mid
        if hi > AT_ONCE * d:
            d = hi
    a1, a2 = standing(x, c, sense, P)[0], standing(x + d, c, sense, P)[0]
    side = lifting(x + d, c, sense, P)
    if side == 0.0:
        return d, stopped(V, V + 0.5 * d * (a1 + a2), sense), 0.0
    lo, hi = 0.0, d
    for _ in range(50):
        mid = 0.5 * (lo + hi)
        if lifting(x + mid, c, sense, P) != 0.0:
            hi = mid
        else:
            lo = mid
    am = standing(x + hi, c, sense, P)[0]
    return hi, stopped(V, V + 0.5 * hi * (a1 + am), sense), side


@njit
def rock(x, d, c, s, phi, v, V, P):
    """(time used, phi, v, V) of a step on one corner, cut short at an impact (phi = 0 then) or a change of friction."""
    sense = sense_of(rate(x, c, s, phi, v, 0.0, P)[2], V, P)
    p1, v1, V1 = step(x, d, c, s, phi, v, V, sense, P)
    struck = p1 < 0.0
    if struck:
        lo, hi = 0.0, d
        for _ in range(50):
            mid = 0.5 * (lo + hi)
            if step(x, mid, c, s, phi, v, V, sense, P)[0] > 0.0:
                lo = mid
            else:
                hi = mid
        d = hi
    if let_go(x, d, c, s, phi, v, V, sense, P):
        lo, hi = 0.0, d
        for _ in range(50):
            mid = 0.5 * (lo + hi)
            if let_go(x, mid, c, s, phi, v, V, sense, P):
                hi = mid
            else:
                lo = mid
        if AT_ONCE * d < hi < d:
            d, struck = hi, False
    p1, v1, V1 = step(x, d, c, s, phi, v, V, sense, P)
    return d, 0.0 if struck else p1, v1, stopped(V, V1, sense)


@njit
def run(C, h, every, theta0, P, out, hits, sub):
    """As event.run, with `sub` steps for each piece; out[(sample), (theta, theta', theta'', slip acceleration)]."""
    s = 1.0 if theta0 >= 0 else -1.0
    phi, v, V = abs(theta0), 0.0, 0.0
    rocking, count, d = phi > 0.0, 0, h / sub
    for k in range(C.shape[0] + 1):
        c, x0 = C[min(k, C.shape[0] - 1)], (0.0 if k < C.shape[0] else h)
        if k % every == 0:
            a, A = 0.0, standing(x0, c, sense_of(standing(x0, c, 0.0, P)[1], V, P), P)[0]
            if rocking:
                a, A, _ = rate(x0, c, s, phi, v, sense_of(rate(x0, c, s, phi, v, 0.0, P)[2], V, P), P)
            out[k // every] = np.array((s * phi, s * v, s * a, A))
        if phi > FALLEN:
            return count, k // every + 1
        if k == C.shape[0]:
            break
        for i in range(sub):
            x, end = i * d, (i + 1) * d
            passes = 0
            while end - x >= 1e-12 * d:
                passes += 1
                if passes > MOST:
                    raise RuntimeError("more events within a step than can be followed")
                if not rocking:
                    used, V, side = stand(x, end - x, c, V, P)
                    x += used
                    if side != 0.0:
                        s, phi, v, rocking = side, 0.0, 0.0, True
                    continue
                used, phi, v, V = rock(x, end - x, c, s, phi, v, V, P)
                x += used
                if phi > 0.0 or v >= 0.0:
                    continue
                if abs(v) < REST_SPEED:
                    v, rocking = 0.0, used > 1e-9 * d and lifting(x, c, sense_of(0.0, V, P), P) != 0.0
                    if rocking:
                        s = lifting(x, c, sense_of(0.0, V, P), P)
                    elif used <= 1e-9 * d:
                        x = end
                    continue
                if count < hits.shape[0]:
                    hits[count, 0], hits[count, 1], hits[count, 2] = k * h + x, s * v, s * v * P[E0]
                    count += 1
                v, V = strike(s, v, V, P)
                s = -s
    return count, -1


def simulate(world: World, felt: np.ndarray, h: float, every: int, theta0: float) -> Response:
    """Rotation of a block that may slide; the centre's acceleration goes with it for instruments."""
    n = felt.shape[0] // every + 1
    out, hits = np.full((n, 4), np.nan), np.zeros((5000, 3))
    P = world.vector()
    count, fell = run(felt, h, every, theta0, P, out, hits, max(1, round(h / STEP)))
    theta, w, a, A = out.T.copy()
    # From the corner's slip and the lean to the centre of mass.
    s = np.where(theta < 0, -1.0, 1.0)
    phi = np.abs(theta)
    D, Z = -P[B] * np.cos(phi) + P[H] * np.sin(phi), P[B] * np.sin(phi) + P[H] * np.cos(phi)
    centre = np.stack([A + s * (Z * s * a - D * w * w), -D * s * a - Z * w * w], axis=1)
    return Response(h * every * np.arange(n), theta, w, a, hits[:count].copy(), None if fell < 0 else fell, centre)
