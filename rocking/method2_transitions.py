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
from collections.abc import Callable
from typing import Any, NamedTuple

from rocking.hybrid import (
    INADMISSIBLE,
    REST,
    ROTATION,
    ROTATION_JUMP,
    SLIDE,
    SLIDE_ROTATION,
    TRANSLATION_JUMP,
    WITHIN,
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
    Felt,
    Stance,
    Turning,
    corner_arm,
    feel,
    nothing_turns,
    on_arm,
    sliding_row,
    standing_couples,
    standing_margins,
    standing_on,
    sticking_row,
)

FLAT = 1e-12
"""Both corners count as down when they differ by less than this share of the breadth."""

SNAP = 1e-13
"""A velocity left after an impact that is this small against those before it is rounding, and zero."""


Striking = Callable[..., Any]
"""(xp, e, omega, s, par) -> restitution of a rocking impact at which side s hands over, of TWO_CORNER."""


class Touch(NamedTuple):
    """A block of which corner s is on the floor, with the mode that follows."""

    s: Any
    theta: Any  # [rad]
    u: Any  # tangential velocity of corner s [m/s]
    v: Any  # normal velocity of corner s [m/s], up positive
    omega: Any  # [rad/s]
    mode: Any
    slip: Any


def as_it_is(xp: Any, e: Any, omega: Any, s: Any, par: Any) -> Any:
    """The `Striking` of a block without effects."""
    return e


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


def upright(xp: Any, u: Any, felt: Felt, par: Any, gave_way: Any, tipped: Any, turning: Turning) -> Touch:
    """What a block does that stands on both corners and moves with u [m/s].

    gave_way: rest has just ended, so that it is no candidate although the threshold still reads equal; tipped: it was
    by turning over a corner that rest or slide ended.
    """
    A_x, A_z = felt.A_x, felt.A_z
    still = u == 0.0
    slip = xp.where(still, xp.where(A_x > 0.0, -1.0, 1.0), xp.where(u > 0.0, 1.0, -1.0))
    right, left = standing_couples(xp, felt, par, turning)
    over_right, over_left = standing_margins(A_x, felt, par, right, left)
    side = xp.where(over_right == over_left, slip, xp.where(over_right < over_left, 1.0, -1.0))
    margin = xp.minimum(over_right, over_left) + par.hold
    friction_holds = (par.mu_s == math.inf) | (xp.abs(A_x) <= (1.0 + WITHIN) * par.mu_s * A_z)
    margin = margin + WITHIN * par.a * A_z
    stands = still & (gave_way == 0.0) & friction_holds & (margin >= 0.0)
    tips = still & ((tipped > 0.0) | (margin < 0.0))
    at = on_arm(xp, 0.0, 0.0, side, side * par.a - par.o, -par.H, felt, par, turning)
    _, F, N = sticking_row(0.0, at, felt, par)
    corner_holds = (par.mu_s == math.inf) | (xp.abs(F) <= par.mu_s * N)
    # Sliding on both corners needs the normal force inside the base: mu_k <= b/h for a rectangle, whatever the base
    # does.
    mu = xp.where(par.mu_k < math.inf, par.mu_k, 0.0)
    over_right, over_left = standing_margins(-slip * mu * A_z, felt, par, right, left)
    trip = xp.where(over_right < over_left, 1.0, -1.0)
    trip = xp.where((over_right == over_left) | (par.mu_k == math.inf), slip, trip)
    flat = xp.minimum(over_right, over_left) >= -WITHIN * par.a * A_z
    flat = flat & (par.mu_k < math.inf) & (still | (tipped == 0.0))
    mode = xp.where(flat, SLIDE, SLIDE_ROTATION)
    mode = xp.where(tips & corner_holds, ROTATION, mode)
    mode = xp.where(stands, REST, mode)
    mode = xp.where(A_z > 0.0, mode, TRANSLATION_JUMP)
    s = xp.where(mode == ROTATION, side, xp.where(mode == SLIDE_ROTATION, trip, slip))
    return Touch(s, 0.0, u, 0.0, 0.0, mode, slip)


def falls(omega: Any, at: Stance, felt: Felt, par: Any) -> Any:
    """Acceleration [m/s^2] with which a corner that nothing holds goes down."""
    return felt.A_z + (at.r_z + par.r) * omega * omega + at.r_x * at.C / par.rho2


def carried(
    xp: Any, s: Any, theta: Any, u: Any, omega: Any, felt: Felt, par: Any, gave_way: Any, turning: Turning
) -> Touch:
    """What a block does that stands on corner s alone, which moves with u [m/s] along the floor.

    gave_way: sticking has just ended and is no candidate.
    """
    at = standing_on(xp, theta, omega, s, felt, par, turning)
    _, F, N = sticking_row(omega, at, felt, par)
    rough = par.mu_s == math.inf
    still = u == 0.0
    slip = xp.where(still, xp.where(F > 0.0, -1.0, 1.0), xp.where(u > 0.0, 1.0, -1.0))
    friction_holds = rough | (xp.abs(F) <= par.mu_s * N)
    sticks = still & (gave_way == 0.0) & (N > 0.0) & friction_holds
    _, _, N_slide = sliding_row(xp, omega, slip, at, felt, par)
    flying = xp.where(omega == 0.0, TRANSLATION_JUMP, ROTATION_JUMP)
    # With friction without limit, a corner that must not pull and cannot leave has no admissible motion.
    presses = falls(omega, at, felt, par) > 1e-9 * par.g
    mode = xp.where(N_slide > 0.0, SLIDE_ROTATION, flying)
    mode = xp.where(rough, xp.where(presses, INADMISSIBLE, flying), mode)
    mode = xp.where(sticks, ROTATION, mode)
    return Touch(s, theta, u, 0.0, omega, mode, slip)


def corner_landing(
    xp: Any, s: Any, theta: Any, u: Any, v: Any, omega: Any, felt: Felt, par: Any, rocks: Any, turning: Turning,
    striking: Striking,
) -> Touch:  # fmt: skip
    """Corner s lands with (u, v) while the block tilts by theta; what follows if the other one does not take part."""
    r_x, r_z = corner_arm(xp, theta, s, par)
    kinematic = par.law == KINEMATIC
    P_x, P_z = corner_impulse(xp, r_x, r_z, u, v, par.rho2, par.mu_k, par.e_n, par.e_t, kinematic)
    u_up, v_up, omega_up = after_impulse(r_x, r_z, u, v, omega, P_x, P_z, par.rho2)
    gravity = falls(omega_up, standing_on(xp, theta, omega_up, s, felt, par, turning), felt, par)
    ends = 2.0 * v_up <= par.chatter_time * gravity * (1.0 - par.e_n)

    P_x, P_z = corner_impulse(xp, r_x, r_z, u, v, par.rho2, par.mu_k, 0.0, par.e_t, kinematic)
    u_down, _, omega_down = after_impulse(r_x, r_z, u, v, omega, P_x, P_z, par.rho2)
    shared = rocks & (par.law == TWO_CORNER)
    e = striking(xp, xp.where(s > 0.0, par.e_left, par.e_right), omega, -s, par)
    e = xp.minimum(xp.maximum(e, 0.0), 1.0)
    u_two, omega_two = two_corner_impact(
        xp, s, u, omega, par.a, par.o, par.H, par.rho2, par.mu_k, e, par.ratio_kept
    )  # fmt: skip
    u_down, omega_down = xp.where(shared, u_two, u_down), xp.where(shared, omega_two, omega_down)
    u_down = xp.where(xp.abs(u_down) <= SNAP * (xp.abs(u) + xp.abs(v)), 0.0, u_down)

    stays = shared | (par.e_n == 0.0) | ends
    last = rocks & (xp.abs(omega_down) < par.omega_rest)
    # Brought upright without an impulse along the floor, the block moves on as its centre of mass did.
    u_flat = u_down + par.H * omega_down
    u_flat = xp.where(xp.abs(u_flat) < par.omega_rest * 2.0 * par.H, 0.0, u_flat)
    down = choose(
        xp,
        last,
        upright(xp, u_flat, felt, par, 0.0, 0.0, turning),
        carried(xp, s, theta, u_down, omega_down, felt, par, 0.0, turning),
    )
    up = Touch(s, theta, u_up, v_up, omega_up, ROTATION_JUMP, 1.0)
    return choose(xp, stays, down, up)


def flat_landing(
    xp: Any, s: Any, u: Any, v: Any, omega: Any, felt: Felt, par: Any, rocks: Any, turning: Turning,
    striking: Striking,
) -> Touch:  # fmt: skip
    """Both corners of an upright block land, corner s with (u, v); trips over one of them if the other had to pull."""
    v_centre = v + omega * (s * par.a - par.o)
    u_1, v_1, omega_1, P_plus, P_minus = flat_impact(
        xp, u, v_centre, omega, par.a, par.o, par.H, par.rho2, par.mu_k, par.e_n, par.e_t
    )
    u_1 = xp.where(xp.abs(u_1) <= SNAP * (xp.abs(u) + xp.abs(v)), 0.0, u_1)
    trip = xp.where(P_plus < 0.0, -1.0, 1.0)
    # Velocity of the corner over which the block trips, from that of corner s.
    v_trip = v + par.a * omega * (s - trip)
    v_trip = xp.where(v_trip < 0.0, v_trip, 0.0)
    tripping = corner_landing(xp, trip, 0.0, u, v_trip, omega, felt, par, False, turning, striking)

    ends = 2.0 * v_1 <= par.chatter_time * felt.A_z * (1.0 - par.e_n)
    lower = xp.where(omega_1 > 0.0, 1.0, -1.0)
    v_lower = v_1 - omega_1 * (lower * par.a - par.o)
    stays = v_lower <= FLAT
    mode = xp.where(omega_1 == 0.0, TRANSLATION_JUMP, ROTATION_JUMP)
    bouncing = Touch(lower, 0.0, u_1, v_lower, omega_1, mode, 1.0)
    rolling = carried(xp, lower, 0.0, u_1, omega_1, felt, par, 0.0, turning)
    after = choose(xp, stays & (omega_1 != 0.0), rolling, bouncing)
    u_0, _, _, _, _ = flat_impact(xp, u, v_centre, omega, par.a, par.o, par.H, par.rho2, par.mu_k, 0.0, par.e_t)
    u_0 = xp.where(xp.abs(u_0) <= SNAP * (xp.abs(u) + xp.abs(v)), 0.0, u_0)
    after = choose(xp, ends | (par.e_n == 0.0), upright(xp, u_0, felt, par, 0.0, 0.0, turning), after)
    return choose(xp, (P_plus < 0.0) | (P_minus < 0.0), tripping, after)


def impact(
    xp: Any, y: Any, q: Discrete, felt: Felt, par: Any, k: Any, turning: Turning, striking: Striking
) -> tuple[Touch, Any]:
    """(contact after, x of its corner [m]) when a corner comes down: guard LANDING the other one, CONTACT this one."""
    rocks = (k == LANDING) & (q.mode < TRANSLATION_JUMP)
    other = xp.where(k == LANDING, 1.0, 0.0)
    s = q.s * (1.0 - 2.0 * other)
    theta = xp.where(rocks, 0.0, y[2])
    omega = y[5]
    breadth = 2.0 * par.a
    span_x, span_z = q.s * breadth * xp.cos(theta), q.s * breadth * xp.sin(theta)
    x = y[0] - other * span_x
    u = y[3] + other * omega * span_z
    v = y[4] + other * omega * span_x
    v = xp.where(v < 0.0, v, 0.0)
    one = corner_landing(xp, s, theta, u, v, omega, felt, par, rocks, turning, striking)
    # The corner that did not land takes part if it is as low and comes down too, or if it stood there and is driven
    # down.  If it was on its way up and is driven down, its own landing follows at once.
    height = s * breadth * xp.sin(theta)
    comes_down = v + omega * s * breadth * xp.cos(theta) < 0.0
    driven_down = one.v + one.omega * s * breadth * xp.cos(theta) < 0.0
    both = (xp.abs(height) <= FLAT * breadth) & xp.where(rocks, driven_down, comes_down)
    after = choose(xp, both, flat_landing(xp, s, u, v, omega, felt, par, rocks, turning, striking), one)
    return after, x + par.a * (after.s - s)


def jump(
    xp: Any, y: Any, q: Discrete, base: Base, par: Any, k: Any
) -> tuple[tuple[Any, Any, Any, Any, Any, Any], Discrete]:
    """State and mode after guard k has ended the mode q.mode."""
    return jump_with(xp, y, q, base, par, k, nothing_turns, as_it_is)


def jump_with(
    xp: Any, y: Any, q: Discrete, base: Base, par: Any, k: Any, turning: Turning, striking: Striking
) -> tuple[tuple[Any, Any, Any, Any, Any, Any], Discrete]:
    """The same with effects that turn the block and change its restitution."""
    is_impact = (k == LANDING) | (k == CONTACT)
    # The centre of mass stays where it is, and so does what it feels.
    felt = feel(xp, y, *corner_arm(xp, y[2], q.s, par), base, par)
    landed, x_landed = impact(xp, y, q, felt, par, k, turning, striking)

    flat = (q.mode == REST) | (q.mode == SLIDE)
    u = xp.where(k == STICK, 0.0, y[3])
    ended_rest = xp.where((k == SLIP) | (k == TIP), 1.0, 0.0)
    standing = upright(xp, u, felt, par, ended_rest, xp.where(k == TIP, 1.0, 0.0), turning)
    ended_stick = xp.where((k == SLIP) | (k == LIFT), 1.0, 0.0)
    leaning = carried(xp, q.s, y[2], u, y[5], felt, par, ended_stick, turning)
    flying = Touch(q.s, y[2], u, 0.0, y[5], xp.where(y[5] == 0.0, TRANSLATION_JUMP, ROTATION_JUMP), q.slip)
    leaning = choose(xp, (q.mode == SLIDE_ROTATION) & (k == LIFT), flying, leaning)
    flying = Touch(q.s, 0.0 * y[2], u, 0.0, 0.0, TRANSLATION_JUMP, q.slip)
    standing = choose(xp, k == LIFT, flying, standing)
    changed = choose(xp, flat, standing, leaning)
    # An upright block may have changed to its other corner, which stands a breadth away.
    x_changed = y[0] + par.a * (changed.s - q.s)

    after = choose(xp, is_impact, landed, changed)
    x = xp.where(is_impact, x_landed, x_changed)
    return (x, 0.0, after.theta, after.u, after.v, after.omega), Discrete(after.mode, after.s, after.slip)
