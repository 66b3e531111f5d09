"""Method 2: what follows when a mode ends.

A threshold is located by the solver; which mode follows is decided by consistency: a candidate is kept if its contact
forces are admissible (no pull, friction within its cone).  Impacts end a mode too; `rocking.impacts` has their laws.

Source   own derivation from Newton's and Coulomb's laws for the six modes of Ishiyama (1982).
Status   a series of bounces that would end within `chatter_time` is finished at once with the law at e_n = 0, and
         a rocking impact slower than `omega_rest` brings the block upright (and a slip slower than `omega_rest` h then
         to a halt): these rules are the only approximations.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from rocking.hybrid import (
    INADMISSIBLE,
    REST,
    ROTATION,
    ROTATION_JUMP,
    SLIDE,
    SLIDE_ROTATION,
    TRANSLATION_JUMP,
    Base,
    Discrete,
)
from rocking.impacts import after_impulse, corner_impulse, flat_impact, two_corner_impact
from rocking.method2_equations import (
    CONTACT,
    KINEMATIC,
    LANDING,
    LIFT,
    SLIP,
    STICK,
    TIP,
    TWO_CORNER,
    Parameters,
    corner_arm,
    sliding_row,
    sticking_row,
)

FLAT = 1e-12
"""Both corners count as down when they differ by less than this share of the breadth."""

SNAP = 1e-13
"""A velocity left after an impact that is this small against those before it is rounding, and zero."""


class Touch(NamedTuple):
    """A block of which corner s is on the floor, with the mode that follows."""

    s: Any
    theta: Any  # [rad]
    u: Any  # tangential velocity of corner s [m/s]
    v: Any  # normal velocity of corner s [m/s], up positive
    omega: Any  # [rad/s]
    mode: Any
    slip: Any


def choose(xp: Any, condition: Any, yes: Touch, no: Touch) -> Touch:
    """One of two contacts."""
    return Touch(
        xp.where(condition, yes.s, no.s),
        xp.where(condition, yes.theta, no.theta),
        xp.where(condition, yes.u, no.u),
        xp.where(condition, yes.v, no.v),
        xp.where(condition, yes.omega, no.omega),
        xp.where(condition, yes.mode, no.mode),
        xp.where(condition, yes.slip, no.slip),
    )


def upright(xp: Any, u: Any, base: Base, par: Parameters, gave_way: Any, tipped: Any) -> Touch:
    """What a block does that stands on both corners and moves with u [m/s].

    gave_way: rest has just ended, so that it is no candidate although the threshold still reads equal; tipped: it was
    West's formula that ended it.
    """
    G = par.g + base.a_z
    push_size = xp.abs(base.a_x)
    push = xp.where(base.a_x > 0.0, -1.0, 1.0)
    still = u == 0.0
    slip = xp.where(still, push, xp.where(u > 0.0, 1.0, -1.0))
    friction_holds = (par.mu_s == math.inf) | (push_size <= par.mu_s * G)
    stable = push_size <= par.b / par.h * G
    stands = still & (gave_way == 0.0) & friction_holds & stable
    tips = still & ((tipped > 0.0) | (push_size > par.b / par.h * G))
    _, F, N = sticking_row(xp, 0.0, 0.0, push, base, par)
    corner_holds = (par.mu_s == math.inf) | (xp.abs(F) <= par.mu_s * N)
    # Sliding on both corners needs the normal force inside the base: mu_k <= b/h, whatever the base does.
    sliding = xp.where(par.mu_k <= par.b / par.h, SLIDE, SLIDE_ROTATION)
    mode = xp.where(tips & corner_holds, ROTATION, sliding)
    mode = xp.where(stands, REST, mode)
    mode = xp.where(G > 0.0, mode, TRANSLATION_JUMP)
    return Touch(slip, 0.0, u, 0.0, 0.0, mode, slip)


def carried(xp: Any, s: Any, theta: Any, u: Any, omega: Any, base: Base, par: Parameters, gave_way: Any) -> Touch:
    """What a block does that stands on corner s alone, which moves with u [m/s] along the floor.

    gave_way: sticking has just ended and is no candidate.
    """
    _, F, N = sticking_row(xp, theta, omega, s, base, par)
    rough = par.mu_s == math.inf
    still = u == 0.0
    slip = xp.where(still, xp.where(F > 0.0, -1.0, 1.0), xp.where(u > 0.0, 1.0, -1.0))
    friction_holds = rough | (xp.abs(F) <= par.mu_s * N)
    sticks = still & (gave_way == 0.0) & (N > 0.0) & friction_holds
    _, _, N_slide = sliding_row(xp, theta, omega, s, slip, base, par)
    flying = xp.where(omega == 0.0, TRANSLATION_JUMP, ROTATION_JUMP)
    # With friction without limit, a corner that must not pull and cannot leave has no admissible motion.
    _, r_z = corner_arm(xp, theta, s, par)
    presses = par.g + base.a_z + r_z * omega * omega > 1e-9 * par.g
    mode = xp.where(N_slide > 0.0, SLIDE_ROTATION, flying)
    mode = xp.where(rough, xp.where(presses, INADMISSIBLE, flying), mode)
    mode = xp.where(sticks, ROTATION, mode)
    return Touch(s, theta, u, 0.0, omega, mode, slip)


def corner_landing(
    xp: Any, s: Any, theta: Any, u: Any, v: Any, omega: Any, base: Base, par: Parameters, rocks: Any
) -> Touch:
    """Corner s lands with (u, v) while the block tilts by theta; what follows if the other one does not take part."""
    r_x, r_z = corner_arm(xp, theta, s, par)
    kinematic = par.law == KINEMATIC
    P_x, P_z = corner_impulse(xp, r_x, r_z, u, v, par.rho2, par.mu_k, par.e_n, par.e_t, kinematic)
    u_up, v_up, omega_up = after_impulse(r_x, r_z, u, v, omega, P_x, P_z, par.rho2)
    gravity = par.g + base.a_z + r_z * omega_up * omega_up
    ends = 2.0 * v_up <= par.chatter_time * gravity * (1.0 - par.e_n)

    P_x, P_z = corner_impulse(xp, r_x, r_z, u, v, par.rho2, par.mu_k, 0.0, par.e_t, kinematic)
    u_down, _, omega_down = after_impulse(r_x, r_z, u, v, omega, P_x, P_z, par.rho2)
    shared = rocks & (par.law == TWO_CORNER)
    u_two, omega_two = two_corner_impact(
        xp, s, u, omega, par.b, par.h, par.rho2, par.mu_k, par.share, par.ratio_kept
    )  # fmt: skip
    u_down, omega_down = xp.where(shared, u_two, u_down), xp.where(shared, omega_two, omega_down)
    u_down = xp.where(xp.abs(u_down) <= SNAP * (xp.abs(u) + xp.abs(v)), 0.0, u_down)

    stays = shared | (par.e_n == 0.0) | ends
    last = rocks & (xp.abs(omega_down) < par.omega_rest)
    # Brought upright without an impulse along the floor, the block moves on as its centre of mass did.
    u_flat = u_down + 0.5 * par.h * omega_down
    u_flat = xp.where(xp.abs(u_flat) < par.omega_rest * par.h, 0.0, u_flat)
    down = choose(
        xp,
        last,
        upright(xp, u_flat, base, par, 0.0, 0.0),
        carried(xp, s, theta, u_down, omega_down, base, par, 0.0),
    )
    up = Touch(s, theta, u_up, v_up, omega_up, ROTATION_JUMP, 1.0)
    return choose(xp, stays, down, up)


def flat_landing(xp: Any, s: Any, u: Any, v: Any, omega: Any, base: Base, par: Parameters, rocks: Any) -> Touch:
    """Both corners of an upright block land, corner s with (u, v); trips over one of them if the other had to pull."""
    r_x = s * 0.5 * par.b
    u_1, v_1, omega_1, P_plus, P_minus = flat_impact(
        xp, u, v + omega * r_x, omega, par.b, par.h, par.rho2, par.mu_k, par.e_n, par.e_t
    )
    u_1 = xp.where(xp.abs(u_1) <= SNAP * (xp.abs(u) + xp.abs(v)), 0.0, u_1)
    trip = xp.where(P_plus < 0.0, -1.0, 1.0)
    # Velocity of the corner over which the block trips, from that of corner s.
    v_trip = v + 0.5 * par.b * omega * (s - trip)
    tripping = corner_landing(xp, trip, 0.0, u, xp.where(v_trip < 0.0, v_trip, 0.0), omega, base, par, False)

    ends = 2.0 * v_1 <= par.chatter_time * (par.g + base.a_z) * (1.0 - par.e_n)
    lower = xp.where(omega_1 > 0.0, 1.0, -1.0)
    v_lower = v_1 - omega_1 * lower * 0.5 * par.b
    stays = v_lower <= FLAT
    mode = xp.where(omega_1 == 0.0, TRANSLATION_JUMP, ROTATION_JUMP)
    bouncing = Touch(lower, 0.0, u_1, v_lower, omega_1, mode, 1.0)
    rolling = carried(xp, lower, 0.0, u_1, omega_1, base, par, 0.0)
    after = choose(xp, stays & (omega_1 != 0.0), rolling, bouncing)
    u_0, _, _, _, _ = flat_impact(xp, u, v + omega * r_x, omega, par.b, par.h, par.rho2, par.mu_k, 0.0, par.e_t)
    u_0 = xp.where(xp.abs(u_0) <= SNAP * (xp.abs(u) + xp.abs(v)), 0.0, u_0)
    after = choose(xp, ends | (par.e_n == 0.0), upright(xp, u_0, base, par, 0.0, 0.0), after)
    return choose(xp, (P_plus < 0.0) | (P_minus < 0.0), tripping, after)


def impact(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters, k: Any) -> tuple[Touch, Any]:
    """(contact after, x of its corner [m]) when a corner comes down: guard LANDING the other one, CONTACT this one."""
    rocks = (k == LANDING) & (q.mode < TRANSLATION_JUMP)
    other = xp.where(k == LANDING, 1.0, 0.0)
    s = q.s * (1.0 - 2.0 * other)
    theta = xp.where(rocks, 0.0, y[2])
    omega = y[5]
    span_x, span_z = q.s * par.b * xp.cos(theta), q.s * par.b * xp.sin(theta)
    x = y[0] - other * span_x
    u = y[3] + other * omega * span_z
    v = y[4] + other * omega * span_x
    v = xp.where(v < 0.0, v, 0.0)
    one = corner_landing(xp, s, theta, u, v, omega, base, par, rocks)
    # The corner that did not land takes part if it is as low and comes down too, or if it stood there and is driven
    # down.  If it was on its way up and is driven down, its own landing follows at once.
    height = s * par.b * xp.sin(theta)
    comes_down = v + omega * s * par.b * xp.cos(theta) < 0.0
    driven_down = one.v + one.omega * s * par.b * xp.cos(theta) < 0.0
    both = (xp.abs(height) <= FLAT * par.b) & xp.where(rocks, driven_down, comes_down)
    after = choose(xp, both, flat_landing(xp, s, u, v, omega, base, par, rocks), one)
    return after, x + 0.5 * par.b * (after.s - s)


def jump(
    xp: Any, y: Any, q: Discrete, base: Base, par: Parameters, k: Any
) -> tuple[tuple[Any, Any, Any, Any, Any, Any], Discrete]:
    """State and mode after guard k has ended the mode q.mode."""
    is_impact = (k == LANDING) | (k == CONTACT)
    landed, x_landed = impact(xp, y, q, base, par, k)

    flat = (q.mode == REST) | (q.mode == SLIDE)
    u = xp.where(k == STICK, 0.0, y[3])
    ended_rest = xp.where((k == SLIP) | (k == TIP), 1.0, 0.0)
    standing = upright(xp, u, base, par, ended_rest, xp.where(k == TIP, 1.0, 0.0))
    ended_stick = xp.where((k == SLIP) | (k == LIFT), 1.0, 0.0)
    leaning = carried(xp, q.s, y[2], u, y[5], base, par, ended_stick)
    flying = Touch(q.s, y[2], u, 0.0, y[5], xp.where(y[5] == 0.0, TRANSLATION_JUMP, ROTATION_JUMP), q.slip)
    leaning = choose(xp, (q.mode == SLIDE_ROTATION) & (k == LIFT), flying, leaning)
    flying = Touch(q.s, 0.0 * y[2], u, 0.0, 0.0, TRANSLATION_JUMP, q.slip)
    standing = choose(xp, k == LIFT, flying, standing)
    changed = choose(xp, flat, standing, leaning)
    # An upright block may have changed to its other corner, which stands a breadth away.
    x_changed = y[0] + 0.5 * par.b * (changed.s - q.s)

    after = choose(xp, is_impact, landed, changed)
    x = xp.where(is_impact, x_landed, x_changed)
    return (x, 0.0, after.theta, after.u, after.v, after.omega), Discrete(after.mode, after.s, after.slip)
