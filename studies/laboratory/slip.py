"""A rigid block that rocks and slides: friction on the edge it stands on (or the base), impacts located.

Side-mirrored lean phi and the block's X, Z, D as in event.py; its foot, which has slipped by S in all, either sticks or
slips at V against Coulomb friction -kappa N, kappa = mu sign(V).  With the field f that the centre of mass feels on a
floor that leans and turns (what turns it besides is a couple T), N / m = -f_z - D phi'' - (Z - r) phi'^2 and the slip
drops out of the equation of rotation while it lasts:

    (I_c / m + D^2 + kappa Z D) phi'' = (D + kappa Z) (-f_z - (Z - r) phi'^2) + T / m - I_c b'' / m

An impact keeps the ratio of angular speeds; its horizontal impulse is what stops slip, or friction times the vertical
impulse if that is less.  Where the foot slips so fast that normal forces would then do work on the block, or the block
had more energy after the impact, the ratio is the one at which that ends.  Changes between stick and slip are located,
as impacts are: put off to the next of steps of 5e-5 s they move what friction seems to be by 1e-5 to 1e-3 of itself.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .event import ADH, FALLEN, IC, OFF, REST_SPEED, B, H, M, R, Response, field, own_torque, restitution
from .parameters import INDEX, World, refuse

MU = INDEX["friction"]
STEP = 2e-4  # s
AT_ONCE = 1e-6  # share of a step within which friction does not change again
MOST = 200  # events within a step; 56 is the most that was met, of a block of 4 cm
FOREIGN = ("grind", "heed", "hinge", "guide", "layer", "slosh_mass")
"""Effects that hold, remember or have a mass of their own, which these equations lack."""


@njit
def places(s, phi, P):
    """(X, Z, D) of the centre of mass on side s, mirrored, had the foot not slipped."""
    r = P[R]
    u, w = s * P[OFF] - (P[B] - r), P[H] - r
    D = u * np.cos(phi) + w * np.sin(phi)
    return P[B] - r + r * phi + D, r - u * np.sin(phi) + w * np.cos(phi), D


@njit
def felt(x, c, s, X, Z, vx, vz, P):
    """Field at (X, Z) in motion, mirrored, and the floor's angular acceleration, mirrored."""
    fx, fz, rate, acc = field(x, c, P)
    fx *= s
    fx += -s * acc * Z - 2.0 * s * rate * vz + rate * rate * X
    fz += s * acc * X + 2.0 * s * rate * vx + rate * rate * Z
    return fx, fz, s * acc


@njit
def rate(x, c, s, phi, v, S, V, sense, P):
    """(phi'', slip acceleration, friction over normal force) while rocking; sense of slip, 0 sticks; unmirrored."""
    X, Z, D = places(s, phi, P)
    fx, fz, acc = felt(x, c, s, X + s * S, Z, Z * v + s * V, -D * v, P)
    I = P[IC] / P[M]  # noqa: E741
    J = I + D * D + Z * Z
    T = J * own_torque(s, phi, v, 0.0, P, P[M] * J) - I * acc
    up = -fz - (Z - P[R]) * v * v
    if sense == 0.0:
        a = (fx * Z + (P[R] * v * v - fz) * D + T) / J
        return a, 0.0, s * (Z * a - D * v * v - fx) / (up - D * a)
    kappa = P[MU] * s * sense
    a = ((D + kappa * Z) * up + T) / (I + D * D + kappa * Z * D)
    return a, s * (fx - Z * a + D * v * v - kappa * (up - D * a)), -s * kappa


@njit
def standing(x, c, S, V, sense, P):
    """Slip acceleration while the whole base is down, and friction over normal force."""
    fx, fz, _ = felt(x, c, 1.0, P[OFF] + S, P[H], V, 0.0, P)
    if sense == 0.0:
        return 0.0, fx / fz
    return fx + P[MU] * sense * fz, -P[MU] * sense


@njit
def sense_of(ratio, V, P):
    """Sense in which the foot slips, given what sticking would ask of friction."""
    if V != 0.0:
        return np.sign(V)
    return -np.sign(ratio) if abs(ratio) > P[MU] else 0.0


@njit
def step(x, h, c, s, phi, v, S, V, sense, P):
    """One classical Runge-Kutta step while rocking."""
    a1, b1, _ = rate(x, c, s, phi, v, S, V, sense, P)
    v2, V2 = v + 0.5 * h * a1, V + 0.5 * h * b1
    a2, b2, _ = rate(x + 0.5 * h, c, s, phi + 0.5 * h * v, v2, S + 0.5 * h * V, V2, sense, P)
    v3, V3 = v + 0.5 * h * a2, V + 0.5 * h * b2
    a3, b3, _ = rate(x + 0.5 * h, c, s, phi + 0.5 * h * v2, v3, S + 0.5 * h * V2, V3, sense, P)
    v4, V4 = v + h * a3, V + h * b3
    a4, b4, _ = rate(x + h, c, s, phi + h * v3, v4, S + h * V3, V4, sense, P)
    w = h / 6.0
    return (
        phi + w * (v + 2 * v2 + 2 * v3 + v4),
        v + w * (a1 + 2 * a2 + 2 * a3 + a4),
        S + w * (V + 2 * V2 + 2 * V3 + V4),
        V + w * (b1 + 2 * b2 + 2 * b3 + b4),
    )


@njit
def lifting(x, c, S, V, sense, P):
    """The side that leaves the floor from standing, 0 if none does; a base that slips adheres no longer."""
    for s in (1.0, -1.0):
        _, Z, D = places(s, 0.0, P)
        glue = P[ADH] / (P[IC] + P[M] * (Z * Z + D * D)) if sense == 0.0 else 0.0
        if rate(x, c, s, 0.0, 0.0, S, V, sense, P)[0] > glue:
            return s
    return 0.0


@njit
def stopped(V, V1, sense):
    """Slip after a step; none where it would have turned round."""
    return 0.0 if sense == 0.0 or (V1 * sense <= 0.0) else V1


@njit
def let_go(x, h, c, s, phi, v, S, V, sense, P):
    """Whether by the end of a step while rocking slip has turned round, or sticking asks too much of friction."""
    p1, v1, S1, V1 = step(x, h, c, s, phi, v, S, V, sense, P)
    return V1 * sense <= 0.0 if sense != 0.0 else abs(rate(x + h, c, s, p1, v1, S1, 0.0, 0.0, P)[2]) > P[MU]


@njit
def slid(x, h, c, S, V, sense, P):
    """(S, V) after a step from standing, by the trapezoidal rule."""
    a1 = standing(x, c, S, V, sense, P)[0]
    ahead = V + h * a1
    a2 = standing(x + h, c, S + 0.5 * h * (V + ahead), ahead, sense, P)[0]
    V1 = V + 0.5 * h * (a1 + a2)
    return S + 0.5 * h * (V + V1), V1


@njit
def let_go_standing(x, h, c, S, V, sense, P):
    """The same as let_go from standing."""
    if sense == 0.0:
        return abs(standing(x + h, c, S, 0.0, 0.0, P)[1]) > P[MU]
    return slid(x, h, c, S, V, sense, P)[1] * sense <= 0.0


@njit
def blow(s, w, V, e, P):
    """(slip after an impact that multiplies the angular speed w by e, energy made in it per mass)."""
    half, off = P[B] - P[R], s * P[OFF]
    change = s * P[H] * w * (1.0 - e)
    lift = (half * (1.0 + e) - off * (1.0 - e)) * w
    need, most = change - V, P[MU] * lift
    impulse = min(most, max(-most, need))
    V1 = 0.0 if impulse == need else impulse + V - change
    # Moments about the centre of mass share the vertical impulse among the edges: half w times what the new one bears
    # more.  The old one then comes up with 2 half e w, the new one came down with 2 half w.
    I = P[IC] / P[M]  # noqa: E741
    more = (I * w * (1.0 - e) + s * P[H] * impulse - off * lift) / half
    by_normal = half * w * 0.5 * (e * (lift - more) - (lift + more))
    before, after = V - s * P[H] * w, V1 - s * P[H] * e * w  # of the centre of mass, along the floor
    rise = I * (e * e - 1.0) * w * w + ((half + off) * e * w) ** 2 - ((half - off) * w) ** 2
    return V1, max(by_normal, 0.5 * (after * after - before * before + rise))


@njit
def strike(s, v, V, e, P):
    """(angular speed, slip) after an impact that ends a swing on side s with angular velocity v < 0."""
    w = abs(v)
    nothing = 1e-12 * (w * w * (P[IC] / P[M] + P[H] * P[H]) + V * V)  # what rounding makes of no energy at all
    slips, made = blow(s, w, V, e, P)
    if made > nothing:
        least, most = 0.0, e
        for _ in range(60):
            e = 0.5 * (least + most)
            if blow(s, w, V, e, P)[1] > nothing:
                most = e
            else:
                least = e
        e = least
        slips = blow(s, w, V, e, P)[0]
    return e * w, slips


@njit
def stand(x, d, c, S, V, P):
    """(time used, S, V, side that lifts or 0) of a step from standing."""
    sense = sense_of(standing(x, c, S, V, 0.0, P)[1], V, P)
    if let_go_standing(x, d, c, S, V, sense, P):
        lo, hi = 0.0, d
        for _ in range(50):
            mid = 0.5 * (lo + hi)
            if let_go_standing(x, mid, c, S, V, sense, P):
                hi = mid
            else:
                lo = mid
        if hi > AT_ONCE * d:
            d = hi
    S1, V1 = slid(x, d, c, S, V, sense, P)
    side = lifting(x + d, c, S1, V1, sense, P)
    if side == 0.0:
        return d, S1, stopped(V, V1, sense), 0.0
    lo, hi = 0.0, d
    for _ in range(50):
        mid = 0.5 * (lo + hi)
        S1, V1 = slid(x, mid, c, S, V, sense, P)
        if lifting(x + mid, c, S1, V1, sense, P) != 0.0:
            hi = mid
        else:
            lo = mid
    S1, V1 = slid(x, hi, c, S, V, sense, P)
    return hi, S1, stopped(V, V1, sense), side


@njit
def rock(x, d, c, s, phi, v, S, V, P):
    """(time used, phi, v, S, V) of a step on one edge, cut short at an impact (phi = 0) or a change of friction."""
    sense = sense_of(rate(x, c, s, phi, v, S, V, 0.0, P)[2], V, P)
    if V != 0.0 and let_go(x, AT_ONCE * d, c, s, phi, v, S, V, sense, P):
        V = 0.0
        sense = sense_of(rate(x, c, s, phi, v, S, V, 0.0, P)[2], V, P)
    struck = step(x, d, c, s, phi, v, S, V, sense, P)[0] < 0.0
    if struck:
        lo, hi = 0.0, d
        for _ in range(50):
            mid = 0.5 * (lo + hi)
            if step(x, mid, c, s, phi, v, S, V, sense, P)[0] > 0.0:
                lo = mid
            else:
                hi = mid
        d = hi
    if let_go(x, d, c, s, phi, v, S, V, sense, P):
        lo, hi = 0.0, d
        for _ in range(50):
            mid = 0.5 * (lo + hi)
            if let_go(x, mid, c, s, phi, v, S, V, sense, P):
                hi = mid
            else:
                lo = mid
        if AT_ONCE * d < hi < d:
            d, struck = hi, False
    p1, v1, S1, V1 = step(x, d, c, s, phi, v, S, V, sense, P)
    return d, 0.0 if struck else p1, v1, S1, stopped(V, V1, sense)


@njit
def sample(x, c, s, phi, v, S, V, rocking, P):
    """(theta, theta', theta'', slip acceleration)."""
    if rocking:
        a, A, _ = rate(x, c, s, phi, v, S, V, sense_of(rate(x, c, s, phi, v, S, V, 0.0, P)[2], V, P), P)
        return np.array((s * phi, s * v, s * a, A))
    A = standing(x, c, S, V, sense_of(standing(x, c, S, V, 0.0, P)[1], V, P), P)[0]
    return np.array((s * phi, s * v, 0.0, A))


@njit
def run(C, h, every, theta0, P, out, hits, sub):
    """As event.run, with `sub` steps for each piece; out[(sample), (theta, theta', theta'', slip acceleration)]."""
    s = 1.0 if theta0 >= 0 else -1.0
    phi, v, S, V = abs(theta0), 0.0, 0.0, 0.0
    rocking, count, d, last = phi > 0.0, 0, h / sub, -1e9
    for k in range(C.shape[0] + 1):
        c, x0 = C[min(k, C.shape[0] - 1)], (0.0 if k < C.shape[0] else h)
        if k % every == 0:
            out[k // every] = sample(x0, c, s, phi, v, S, V, rocking, P)
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
                    used, S, V, side = stand(x, end - x, c, S, V, P)
                    x += used
                    if side != 0.0:
                        s, phi, v, rocking = side, 0.0, 0.0, True
                    continue
                used, phi, v, S, V = rock(x, end - x, c, s, phi, v, S, V, P)
                x += used
                if phi > 0.0 or v >= 0.0:
                    continue
                if abs(v) < REST_SPEED:
                    side = lifting(x, c, S, V, sense_of(0.0, V, P), P) if used > 1e-9 * d else 0.0
                    v, rocking = 0.0, side != 0.0
                    if rocking:
                        s = side
                    elif used <= 1e-9 * d:
                        x = end
                    continue
                time = k * h + x
                e = restitution(s, abs(v), time - last, count, 0.0, 0.0, P)
                if count < hits.shape[0]:
                    hits[count, 0], hits[count, 1], hits[count, 2] = time, s * v, s * v * e
                    count += 1
                    last = time
                v, V = strike(s, v, V, e, P)
                s = -s
    return count, -1


def simulate(world: World, felt: np.ndarray, h: float, every: int, theta0: float) -> Response:
    """Rotation of a block that may slide; the centre's acceleration goes with it for instruments.

    Raises:
        ValueError: the world has an effect that these equations lack.
    """
    refuse(world, FOREIGN, "of a block that slides")
    n = felt.shape[0] // every + 1
    out, hits = np.full((n, 4), np.nan), np.zeros((5000, 3))
    P = world.vector()
    count, fell = run(felt, h, every, theta0, P, out, hits, max(1, round(h / STEP)))
    theta, w, a, A = out.T.copy()
    # From the foot's slip and the lean to the centre of mass.
    s = np.where(theta < 0, -1.0, 1.0)
    phi, u, up = np.abs(theta), s * P[OFF] - (P[B] - P[R]), P[H] - P[R]
    D, rise = u * np.cos(phi) + up * np.sin(phi), up * np.cos(phi) - u * np.sin(phi)
    Z = rise + P[R]
    centre = np.stack([A + s * (Z * s * a - D * w * w), -D * s * a - rise * w * w], axis=1)
    return Response(h * every * np.arange(n), theta, w, a, hits[:count].copy(), None if fell < 0 else fell, centre)
