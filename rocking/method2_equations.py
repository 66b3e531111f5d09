"""Method 2: equations of motion of the six modes, and the guards that end them.

The state is that of the carrying corner s, y = (x, z, theta, u, v, omega): its position and velocity relative to the
base.  What a mode holds fixed is then an entry of y with derivative zero, so no error of integration builds up there.
Of an edge of radius r, on which the block rolls, u and v are the velocities of the point of the block that is on the
floor, and x, whose rate is u, is where the edge's centre stands less r theta.

With the arm (r_x, r_z) from the centre of mass to that point, the field (A_x, A_z) that the centre of mass feels
in the axes of the floor (acceleration of the base less gravity, pitch and all), M = rho2 + r_x^2 + r_z^2, the angular
acceleration k that effects add to a block on a fixed corner and C = M k - rho2 psi'' (psi'' that of the floor's pitch),
per unit mass:

    rest, slide       F = A_x, N = A_z;   F = -slip mu_k A_z, N = A_z
    rotation          M omega' = r_z A_x - r_x A_z - r r_x omega^2 + C,  F, N from the centre of mass's motion
    slide rotation    N = [rho2 (A_z + (r_z + r) omega^2) + r_x C] / (rho2 + r_x (r_x + slip mu_k r_z)),
                      F = -slip mu_k N,  rho2 omega' = r_z F - r_x N + C
    both jumps        F = N = 0,  rho2 omega' = C

An effect that adds an angular acceleration is so a couple, M k, which acts in every mode.

Source   Newton's law for each mode of Ishiyama (1982), Earthquake Eng. Struct. Dyn. 10, 635-650.
Status   the rows of a rectangle and of a form with rounded edges against Lagrange's equations (tests).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from rocking.hybrid import (
    REST,
    ROTATION,
    SLIDE,
    SLIDE_ROTATION,
    TRANSLATION_JUMP,
    WITHIN,
    Base,
    Discrete,
    in_floor_axes,
)

X, Z, THETA, U, V, OMEGA = range(6)
FALL, LANDING, CONTACT, SLIP, STICK, LIFT, TIP = range(7)
FRICTIONAL, KINEMATIC, TWO_CORNER = range(3)

Turning = Callable[..., Any]
"""(xp, theta, omega, s, base, par) -> the angular acceleration [rad/s^2] that effects add on a fixed corner."""


class Parameters(NamedTuple):
    """What the equations and the impact laws take."""

    a: float  # half of the breadth that it stands on [m]
    r: float  # radius of the edges [m]
    o: float  # offset of the centre of mass [m]
    H: float  # its height [m]
    rho2: float  # I_c / m [m^2]
    g: float  # [m/s^2]
    hold: float  # moment of adhesion over mass [m^2/s^2]
    mu_s: float  # static friction [1]
    mu_k: float  # kinetic friction [1]
    e_n: float  # normal restitution [1]
    e_t: float  # tangential restitution [1]
    law: float  # FRICTIONAL, KINEMATIC or TWO_CORNER
    e_right: float  # restitution when the +x corner hands over, TWO_CORNER only [1]
    e_left: float  # when the -x corner does [1]
    ratio_kept: float  # what of the ratio is kept where the base slides, TWO_CORNER only [1]
    omega_rest: float  # angular speed [rad/s] below which a rocking impact is the last
    chatter_time: float  # a series of bounces shorter than this [s] is finished at once
    balance_right: float  # tilt of unstable balance to +x [rad]
    balance_left: float  # to -x [rad], positive


class Felt(NamedTuple):
    """What the block feels of the base."""

    A_x: Any  # field at the centre of mass, along the floor [m/s^2]
    A_z: Any  # normal to it
    base: Base


class Stance(NamedTuple):
    """How the block stands on a corner, or would stand."""

    r_x: Any  # the floor under the corner, from the centre of mass [m]
    r_z: Any
    C: Any  # couple over mass [m^2/s^2]
    M: Any  # inertia over mass about that point [m^2]


def nothing_turns(xp: Any, theta: Any, omega: Any, s: Any, base: Base, par: Any) -> Any:
    """The `Turning` of a block without effects."""
    return 0.0


def corner_arm(xp: Any, theta: Any, s: Any, par: Any) -> tuple[Any, Any]:
    """Position (r_x, r_z) [m] of the floor under corner s from the centre of mass."""
    sin, cos = xp.sin(s * theta), xp.cos(s * theta)
    q, up = par.a - s * par.o, par.H - par.r
    return s * (q * cos - up * sin), -(par.r + q * sin + up * cos)


def feel(xp: Any, y: Any, r_x: Any, r_z: Any, base: Base, par: Any) -> Felt:
    """What the block feels on its carrying corner: a pitch about the middle of where it first stood takes it along."""
    A_x, A_z = in_floor_axes(xp, base, par.g)
    x, z = y[0] + par.r * y[2] - r_x, y[1] - r_z
    return Felt(A_x + base.pitch_acceleration * z, A_z - base.pitch_acceleration * x, base)


def on_arm(
    xp: Any, theta: Any, omega: Any, s: Any, r_x: Any, r_z: Any, felt: Felt, par: Any, turning: Turning
) -> Stance:
    """How the block stands on corner s with that arm."""
    M = par.rho2 + r_x * r_x + r_z * r_z
    C = M * turning(xp, theta, omega, s, felt.base, par) - par.rho2 * felt.base.pitch_acceleration
    return Stance(r_x, r_z, C, M)


def standing_on(xp: Any, theta: Any, omega: Any, s: Any, felt: Felt, par: Any, turning: Turning) -> Stance:
    """How the block stands on corner s."""
    r_x, r_z = corner_arm(xp, theta, s, par)
    return on_arm(xp, theta, omega, s, r_x, r_z, felt, par, turning)


def sticking_row(omega: Any, at: Stance, felt: Felt, par: Any) -> tuple[Any, Any, Any]:
    """(omega', F, N) of a block that rotates about its fixed corner; forces per unit mass [m/s^2]."""
    r_x, r_z, C, M = at
    omega_dot = (r_z * felt.A_x - r_x * felt.A_z - par.r * r_x * omega * omega + C) / M
    F = felt.A_x - r_z * omega_dot + r_x * omega * omega
    N = felt.A_z + r_x * omega_dot + (r_z + par.r) * omega * omega
    return omega_dot, F, N


def sliding_row(xp: Any, omega: Any, slip: Any, at: Stance, felt: Felt, par: Any) -> tuple[Any, Any, Any]:
    """(omega', u', N) of a block that rotates about its corner while that slides; N per unit mass [m/s^2]."""
    r_x, r_z, C, _ = at
    # An infinite friction never lets the corner slide; the row is then not asked for.
    mu = xp.where(par.mu_k < math.inf, par.mu_k, 0.0)
    across = r_x + slip * mu * r_z
    N = (par.rho2 * (felt.A_z + (r_z + par.r) * omega * omega) + r_x * C) / (par.rho2 + r_x * across)
    omega_dot = (C - across * N) / par.rho2
    u_dot = -slip * mu * N - felt.A_x + r_z * omega_dot - r_x * omega * omega
    return omega_dot, u_dot, N


def standing_couples(xp: Any, felt: Felt, par: Any, turning: Turning) -> tuple[Any, Any]:
    """C [m^2/s^2] of a block that stands upright, were it to turn about its +x and its -x corner."""
    right = on_arm(xp, 0.0, 0.0, 1.0, par.a - par.o, -par.H, felt, par, turning)
    left = on_arm(xp, 0.0, 0.0, -1.0, -par.a - par.o, -par.H, felt, par, turning)
    return right.C, left.C


def standing_margins(F: Any, felt: Felt, par: Any, right: Any, left: Any) -> tuple[Any, Any]:
    """Moment over mass [m^2/s^2] that is left before an upright block turns over its +x, its -x corner.

    F: friction over mass [m/s^2]; right, left: its C there.
    """
    return (
        (par.a - par.o) * felt.A_z + par.H * F - right,
        (par.a + par.o) * felt.A_z - par.H * F + left,
    )


def flow(xp: Any, y: Any, q: Discrete, base: Base, par: Any) -> tuple[Any, Any, Any, Any, Any, Any]:
    """dy/dt in the mode q.mode."""
    return flow_with(xp, y, q, base, par, nothing_turns)


def flow_with(
    xp: Any, y: Any, q: Discrete, base: Base, par: Any, turning: Turning
) -> tuple[Any, Any, Any, Any, Any, Any]:
    """The same with effects that turn the block."""
    theta, omega = y[2], y[5]
    r_x, r_z = corner_arm(xp, theta, q.s, par)
    felt = feel(xp, y, r_x, r_z, base, par)
    at = on_arm(xp, theta, omega, q.s, r_x, r_z, felt, par, turning)
    in_air = q.mode >= TRANSLATION_JUMP
    slides = q.mode == SLIDE
    rotates = q.mode == ROTATION
    slips = q.mode == SLIDE_ROTATION
    stuck_omega_dot, _, _ = sticking_row(omega, at, felt, par)
    slip_omega_dot, slip_u_dot, _ = sliding_row(xp, omega, q.slip, at, felt, par)
    mu = xp.where(par.mu_k < math.inf, par.mu_k, 0.0)
    omega_dot = xp.where(rotates, stuck_omega_dot, xp.where(slips, slip_omega_dot, 0.0))
    omega_dot = xp.where(in_air, at.C / par.rho2, omega_dot)
    u_dot = xp.where(slips, slip_u_dot, 0.0)
    u_dot = xp.where(slides, -felt.A_x - q.slip * mu * felt.A_z, u_dot)
    u_dot = xp.where(in_air, -felt.A_x + r_z * omega_dot - omega * omega * r_x, u_dot)
    v_dot = xp.where(in_air, -felt.A_z - r_x * omega_dot - omega * omega * (r_z + par.r), 0.0)
    return y[3], y[4], omega, u_dot, v_dot, omega_dot


def guards(xp: Any, y: Any, q: Discrete, base: Base, par: Any) -> tuple[Any, Any, Any, Any, Any, Any, Any]:
    """Positive while the mode holds; 1 where a guard has no say.

    fall: |theta| reaches pi/2.  landing: the other corner comes down.  contact: the carrying corner comes down from
    a jump.  slip: friction gives way.  stick: the slip comes to a halt.  lift: the floor would have to pull.
    tip: a block at rest, or sliding on both corners, turns over one of them; eq. (1) of Winkler, Meguro & Yamazaki
    (1995), West's formula, for a rectangle at rest.
    """
    return guards_with(xp, y, q, base, par, nothing_turns)


def guards_with(
    xp: Any, y: Any, q: Discrete, base: Base, par: Any, turning: Turning
) -> tuple[Any, Any, Any, Any, Any, Any, Any]:
    """The same with effects that turn the block."""
    theta, omega = y[2], y[5]
    r_x, r_z = corner_arm(xp, theta, q.s, par)
    felt = feel(xp, y, r_x, r_z, base, par)
    at = on_arm(xp, theta, omega, q.s, r_x, r_z, felt, par, turning)
    at_rest = q.mode == REST
    slides = q.mode == SLIDE
    rotates = q.mode == ROTATION
    sliding = slides | (q.mode == SLIDE_ROTATION)
    in_air = q.mode >= TRANSLATION_JUMP
    _, F, N_stick = sticking_row(omega, at, felt, par)
    _, _, N_slide = sliding_row(xp, omega, q.slip, at, felt, par)
    mu_s = xp.where(par.mu_s < math.inf, par.mu_s, 0.0)
    mu_k = xp.where(par.mu_k < math.inf, par.mu_k, 0.0)
    right, left = standing_couples(xp, felt, par, turning)
    friction = xp.where(slides, -q.slip * mu_k * felt.A_z, felt.A_x)
    over_right, over_left = standing_margins(friction, felt, par, right, left)
    # Of a slide by its weight, so that it does not go to zero where the block leaves the floor.
    weight = xp.where(slides & (felt.A_z > 0.0), felt.A_z, par.g)
    margin = xp.minimum(over_right, over_left) + xp.where(slides, 0.0, par.hold) + 2.0 * WITHIN * par.a * felt.A_z
    margin = xp.where(slides & (felt.A_z <= 0.0), par.H * par.g, margin * (par.g / weight))

    fall = 0.5 * math.pi - xp.abs(theta)
    landing = xp.where(rotates | (q.mode == SLIDE_ROTATION), q.s * theta, 1.0)
    landing = xp.where(in_air, y[1] + q.s * 2.0 * par.a * xp.sin(theta), landing)
    contact = xp.where(in_air, y[1], 1.0)
    slip = xp.where(rotates, mu_s * N_stick - xp.abs(F), 1.0)
    slip = xp.where(at_rest, (1.0 + 2.0 * WITHIN) * mu_s * felt.A_z - xp.abs(felt.A_x), slip)
    slip = xp.where(par.mu_s < math.inf, slip, 1.0)
    stick = xp.where(sliding, q.slip * y[3], 1.0)
    lift = xp.where(rotates, N_stick, xp.where(q.mode == SLIDE_ROTATION, N_slide, 1.0))
    lift = xp.where(at_rest | slides, felt.A_z, lift)
    tip = xp.where(at_rest | slides, margin / par.H, 1.0)
    return fall, landing, contact, slip, stick, lift, tip


def balance(xp: Any, y: Any, par: Any) -> Any:
    """|theta| less the tilt of unstable balance to that side."""
    return xp.where(y[2] > 0.0, y[2] - par.balance_right, -y[2] - par.balance_left)
