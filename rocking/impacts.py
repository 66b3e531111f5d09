"""Impulses between a block and the floor, per unit mass.

The block touches at the corner r = (r_x, r_z) from its centre of mass; the corner arrives with the tangential
velocity u and the normal velocity v < 0.  An impulse (P_x, P_z) there changes the velocities of the centre of mass by
(P_x, P_z), the angular velocity (clockwise) by (r_z P_x - r_x P_z) / rho2, and so those of the corner by A P with

    A = [[1 + r_z^2/rho2, -r_x r_z/rho2], [-r_x r_z/rho2, 1 + r_x^2/rho2]],   rho2 = I_c / m.

Laws     `frictional` (default): Chatterjee & Ruina (1998): normal restitution e_n exactly, tangential e_t within
         the friction cone; energy never grows.  `kinematic`: v -> -e_n v and u -> -e_t u, whatever friction would
         allow.  `two_corner`: plastic, with a share of the impulse at the corner that carried, so that rocking impacts
         have a given ratio of angular speeds; where that asks for a corner that pulls, a couple as of rolling
         resistance acts besides.  `frictional` for all others.
Source   Chatterjee & Ruina (1998), J. Appl. Mech. 65, 939-951, for the one-corner law; own derivation for the rest.
Status   Ishiyama (1982) introduced a normal and a tangential coefficient; whether he limited the tangential impulse by
         friction is not known to us, hence the law is a named choice.
"""

from __future__ import annotations

import math
from typing import Any


def corner_impulse(
    xp: Any, r_x: Any, r_z: Any, u: Any, v: Any, rho2: Any, mu: Any, e_n: Any, e_t: Any, kinematic: Any
) -> tuple[Any, Any]:
    """Impulse (P_x, P_z) at one corner that arrives with (u, v), v <= 0."""
    A_xx = 1.0 + r_z * r_z / rho2
    A_xz = -r_x * r_z / rho2
    A_zz = 1.0 + r_x * r_x / rho2
    det = A_xx * A_zz - A_xz * A_xz
    # P_I stops the approach without friction, P_II stops approach and slip; d leads from one to the other.
    p_one_z = -v / A_zz
    p_two_x = -(A_zz * u - A_xz * v) / det
    p_two_z = -(A_xx * v - A_xz * u) / det
    d_x, d_z = p_two_x, p_two_z - p_one_z
    P_x = (1.0 + e_t) * d_x
    P_z = (1.0 + e_n) * p_one_z + (1.0 + e_t) * d_z
    # Outside the friction cone P goes back along d to its edge; without limit to friction that edge is P_z = 0.
    rough = mu == math.inf
    finite_mu = xp.where(rough, 1.0, mu)
    slips = xp.where(rough, P_z < 0.0, xp.abs(P_x) > finite_mu * P_z)
    slope = xp.where(rough, -d_z, xp.abs(d_x) - finite_mu * d_z)
    k = finite_mu * (1.0 + e_n) * p_one_z / xp.where(slips, slope, 1.0)
    P_x = xp.where(slips, k * d_x, P_x)
    P_z = xp.where(slips, (1.0 + e_n) * p_one_z + k * d_z, P_z)
    # The kinematic pair asks for both velocities after the impact and takes whatever impulse that needs.
    du, dv = -(1.0 + e_t) * u, -(1.0 + e_n) * v
    P_x = xp.where(kinematic, (A_zz * du - A_xz * dv) / det, P_x)
    P_z = xp.where(kinematic, (A_xx * dv - A_xz * du) / det, P_z)
    return P_x, P_z


def after_impulse(
    r_x: Any, r_z: Any, u: Any, v: Any, omega: Any, P_x: Any, P_z: Any, rho2: Any
) -> tuple[Any, Any, Any]:
    """Corner velocities and angular velocity (u, v, omega) after the impulse (P_x, P_z) at that corner."""
    spin = (r_z * P_x - r_x * P_z) / rho2
    return u + P_x + r_z * spin, v + P_z - r_x * spin, omega + spin


def two_corner_impact(
    xp: Any, s: Any, u: Any, omega: Any, a: Any, o: Any, H: Any, rho2: Any, mu: Any, e: Any, ratio_kept: Any
) -> tuple[Any, Any]:
    """(u, omega) after a plastic rocking impact on corner s that both corners of an upright block share.

    The block stands on 2 a, its centre of mass is at a height H and o to the +x side of the middle.  The corners share
    the normal impulse so that omega is multiplied by e where the base did not slide before.  Where it slides with u,
    friction adds to the moment: with `ratio_kept` = 0 the normal impulse stays where it is, with 1 the ratio of angular
    velocities stays, and the impulse moves; linear in between.  Normal forces do no work on the block on the whole, so
    that energy never grows; an e beyond that is not reached.

    No corner is pulled.  What would ask for it (an e below Housner's; a ratio that is kept) has all of the normal
    impulse at the new corner and a couple against the rotation besides: that impulse times an arm by which it is moved
    beyond the corner, as in rolling resistance.  The couple does not turn the block back.
    """
    w, U = s * omega, s * u  # turning onto corner s is positive, and so is slip to its side
    off = s * o
    q = a - off  # arm of the new corner
    rough = mu == math.inf
    finite_mu = xp.where(rough, 1.0, mu)

    def friction(loss: Any) -> tuple[Any, Any, Any]:
        """(impulse, whether it stops the slip, impulse that stops it) where the speed of rotation loses so much."""
        needed = -U - H * loss
        most = finite_mu * (2.0 * a * w - q * loss)
        sticks = rough | (xp.abs(needed) <= most)
        return xp.where(sticks, needed, xp.where(needed < 0.0, -most, most)), sticks, needed

    def loss_at(arm: Any) -> Any:
        """Loss with the normal impulse at that place, from the centre of mass to the new corner [m]."""
        stopped = (2.0 * a * arm * w - H * U) / (rho2 + H * H + arm * q)
        _, sticks, needed = friction(stopped)
        lever = arm + xp.where(needed < 0.0, -finite_mu, finite_mu) * H
        inertia = rho2 + lever * q  # positive unless friction stops the slip
        slid = 2.0 * a * lever * w / xp.where(inertia > 0.0, inertia, 1.0)
        return xp.where(sticks, stopped, slid)

    def lossless() -> Any:
        """Loss at which normal forces do no work: what the old corner gains as it rises, the new one loses.

        Of a block that is off its middle and sticks, friction may do work then; the loss leaves no energy of it.
        """
        inertia, more = rho2 + H * H + q * q, -4.0 * a * off * w * w
        stopped = smaller_root(xp, inertia, -H * U, more - 2.0 * H * U * w, w)
        in_all = smaller_root(xp, inertia, 0.0, more - 2.0 * H * U * w - U * U, w)
        stopped = xp.where(in_all > stopped, in_all, stopped)
        _, sticks, needed = friction(stopped)
        arm = xp.where(needed < 0.0, -finite_mu, finite_mu) * H
        inertia = rho2 + (arm + q) * q
        slid = smaller_root(
            xp, xp.where(inertia > 0.0, inertia, 1.0), 2.0 * a * arm * w, 4.0 * a * w * w * (arm - off), w
        )
        return xp.where(sticks, stopped, slid)

    # Where the normal impulse is if the base did not slide before, as far as friction holds in the impact.
    share = (1.0 - e) / (2.0 * a - (1.0 - e) * q)
    drags = xp.where(rough | (H * share <= finite_mu), H * share, finite_mu)
    place = share * rho2 + drags * H
    least, stays, all_new = lossless(), loss_at(place), loss_at(q)
    most = xp.where(place > q, w, all_new)
    most = xp.where(most > all_new, most, all_new)
    stays = xp.where(stays > most, most, stays)
    loss = (1.0 - ratio_kept) * stays + ratio_kept * (1.0 - e) * w
    loss = xp.where(loss < least, least, loss)
    P_x, sticks, _ = friction(loss)
    return xp.where(sticks, 0.0, s * (U + P_x + H * loss)), s * (w - loss)


def smaller_root(xp: Any, A: Any, B: Any, at_zero: Any, w: Any) -> Any:
    """The root L nearer to zero of A (w - L)^2 + B (w - L) + C, of which the value at L = 0 is given; A > 0."""
    half = 0.5 * (2.0 * A * w + B)
    root = xp.sqrt(xp.maximum(half * half - A * at_zero, 0.0))
    whole = half + root
    return xp.where(whole > 0.0, at_zero / xp.where(whole > 0.0, whole, 1.0), 0.0)


def flat_impact(
    xp: Any, u: Any, v: Any, omega: Any, a: Any, o: Any, H: Any, rho2: Any, mu: Any, e_n: Any, e_t: Any
) -> tuple[Any, Any, Any, Any, Any]:
    """(u, v, omega, P_plus, P_minus) after both corners of an upright block have landed at once.

    u is the horizontal velocity of the base, v and omega those of the centre of mass and of the block; a, o and H as
    of `two_corner_impact`.  A negative P_plus or P_minus (normal impulse at the +x, -x corner) says that the floor
    would have to pull there.
    """
    P_n = -(1.0 + e_n) * v
    x_dot = u + H * omega
    x_speed = xp.abs(x_dot)
    wanted = (1.0 + e_t) * x_speed
    # min() written with where: an infinite mu times a P_n of zero must not decide.
    held = (P_n > 0.0) & (wanted <= mu * P_n)
    taken = xp.where(held, wanted, xp.where(P_n > 0.0, xp.where(held, 0.0, mu), 0.0) * P_n)
    P_x = xp.where(x_dot > 0.0, -taken, taken)
    difference = ((1.0 + e_n) * rho2 * omega - H * P_x + o * P_n) / a
    omega_after = -e_n * omega
    u_after = x_dot + P_x - H * omega_after
    return u_after, -e_n * v, omega_after, 0.5 * (P_n + difference), 0.5 * (P_n - difference)
