"""Method 2: equations of motion of the six modes, and the guards that end them.

The state is that of the carrying corner s, y = (x, z, theta, u, v, omega): its position and velocity relative to the
base.  What a mode holds fixed is then an entry of y with derivative zero, so no error of integration builds up there.
With psi = alpha - s theta, G = g + a_z, rho2 = I_c/m and forces per unit mass:

    rest, slide       F = a_x, N = G;   F = -slip mu_k G, N = G
    rotation          omega' = -p^2 [ s (G/g) sin psi + (a_x/g) cos psi ],  F, N from the centre of mass's motion
    slide rotation    N = (G - R cos psi omega^2) / D,  F = -slip mu_k N,  omega' = (r_z F - r_x N) / rho2
    both jumps        F = N = 0

Source   Newton's law for each mode of Ishiyama (1982), Earthquake Eng. Struct. Dyn. 10, 635-650.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from rocking.hybrid import REST, ROTATION, SLIDE, SLIDE_ROTATION, TRANSLATION_JUMP, Base, Discrete

X, Z, THETA, U, V, OMEGA = range(6)
FALL, LANDING, CONTACT, SLIP, STICK, LIFT, TIP = range(7)
FRICTIONAL, KINEMATIC, TWO_CORNER = range(3)


class Parameters(NamedTuple):
    """What the equations and the impact laws take."""

    b: float  # breadth [m]
    h: float  # height [m]
    R: float  # half of the diagonal [m]
    alpha: float  # slenderness angle [rad]
    rho2: float  # I_c / m [m^2]
    g: float  # [m/s^2]
    mu_s: float  # static friction [1]
    mu_k: float  # kinetic friction [1]
    e_n: float  # normal restitution [1]
    e_t: float  # tangential restitution [1]
    law: float  # FRICTIONAL, KINEMATIC or TWO_CORNER
    share: float  # share of a rocking impact's normal impulse at the old corner, TWO_CORNER only [1]
    ratio_kept: float  # what of the ratio is kept where the base slides, TWO_CORNER only [1]
    omega_rest: float  # angular speed [rad/s] below which a rocking impact is the last
    chatter_time: float  # a series of bounces shorter than this [s] is finished at once


def corner_arm(xp: Any, theta: Any, s: Any, par: Parameters) -> tuple[Any, Any]:
    """Position (r_x, r_z) [m] of corner s from the centre of mass."""
    psi = par.alpha - s * theta
    return s * par.R * xp.sin(psi), -par.R * xp.cos(psi)


def sticking_row(xp: Any, theta: Any, omega: Any, s: Any, base: Base, par: Parameters) -> tuple[Any, Any, Any]:
    """(omega', F, N) of a block that rotates about its fixed corner s; forces per unit mass [m/s^2]."""
    r_x, r_z = corner_arm(xp, theta, s, par)
    G = par.g + base.a_z
    omega_dot = (r_z * base.a_x - r_x * G) / (par.rho2 + par.R * par.R)
    F = base.a_x - r_z * omega_dot + r_x * omega * omega
    N = G + r_x * omega_dot + r_z * omega * omega
    return omega_dot, F, N


def sliding_row(
    xp: Any, theta: Any, omega: Any, s: Any, slip: Any, base: Base, par: Parameters
) -> tuple[Any, Any, Any]:
    """(omega', u', N) of a block that rotates about its corner s while that slides; N per unit mass [m/s^2]."""
    r_x, r_z = corner_arm(xp, theta, s, par)
    # An infinite friction never lets the corner slide; the row is then not asked for.
    mu = xp.where(par.mu_k < math.inf, par.mu_k, 0.0)
    D = 1.0 + r_x * (r_x + slip * mu * r_z) / par.rho2
    N = (par.g + base.a_z + r_z * omega * omega) / D
    omega_dot = -(slip * mu * r_z + r_x) * N / par.rho2
    u_dot = -slip * mu * N - base.a_x + r_z * omega_dot - r_x * omega * omega
    return omega_dot, u_dot, N


def flow(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, Any, Any, Any, Any, Any]:
    """dy/dt in the mode q.mode."""
    theta, omega = y[2], y[5]
    G = par.g + base.a_z
    in_air = q.mode >= TRANSLATION_JUMP
    slides = q.mode == SLIDE
    rotates = q.mode == ROTATION
    slips = q.mode == SLIDE_ROTATION
    r_x, r_z = corner_arm(xp, theta, q.s, par)
    stuck_omega_dot, _, _ = sticking_row(xp, theta, omega, q.s, base, par)
    slip_omega_dot, slip_u_dot, _ = sliding_row(xp, theta, omega, q.s, q.slip, base, par)
    mu = xp.where(par.mu_k < math.inf, par.mu_k, 0.0)
    omega_dot = xp.where(rotates, stuck_omega_dot, xp.where(slips, slip_omega_dot, 0.0))
    u_dot = xp.where(slips, slip_u_dot, 0.0)
    u_dot = xp.where(slides, -base.a_x - q.slip * mu * G, u_dot)
    u_dot = xp.where(in_air, -base.a_x - omega * omega * r_x, u_dot)
    v_dot = xp.where(in_air, -G - omega * omega * r_z, 0.0)
    return y[3], y[4], omega, u_dot, v_dot, omega_dot


def guards(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, Any, Any, Any, Any, Any, Any]:
    """Positive while the mode holds; 1 where a guard has no say.

    fall: |theta| reaches pi/2.  landing: the other corner comes down.  contact: the carrying corner comes down from
    a jump.  slip: friction gives way.  stick: the slip comes to a halt.  lift: the floor would have to pull.
    tip: West's formula, eq. (1) of Winkler, Meguro & Yamazaki (1995).
    """
    theta, omega = y[2], y[5]
    G = par.g + base.a_z
    at_rest = q.mode == REST
    rotates = q.mode == ROTATION
    sliding = (q.mode == SLIDE) | (q.mode == SLIDE_ROTATION)
    in_air = q.mode >= TRANSLATION_JUMP
    _, F, N_stick = sticking_row(xp, theta, omega, q.s, base, par)
    _, _, N_slide = sliding_row(xp, theta, omega, q.s, q.slip, base, par)
    mu_s = xp.where(par.mu_s < math.inf, par.mu_s, 0.0)
    push = xp.abs(base.a_x)

    fall = 0.5 * math.pi - xp.abs(theta)
    landing = xp.where(rotates | (q.mode == SLIDE_ROTATION), q.s * theta, 1.0)
    landing = xp.where(in_air, y[1] + q.s * par.b * xp.sin(theta), landing)
    contact = xp.where(in_air, y[1], 1.0)
    slip = xp.where(at_rest, mu_s * G - push, xp.where(rotates, mu_s * N_stick - xp.abs(F), 1.0))
    slip = xp.where(par.mu_s < math.inf, slip, 1.0)
    stick = xp.where(sliding, q.slip * y[3], 1.0)
    lift = xp.where(rotates, N_stick, xp.where(q.mode == SLIDE_ROTATION, N_slide, 1.0))
    lift = xp.where(at_rest | (q.mode == SLIDE), G, lift)
    tip = xp.where(at_rest, par.b / par.h * G - push, 1.0)
    return fall, landing, contact, slip, stick, lift, tip


def balance(xp: Any, y: Any, par: Parameters) -> Any:
    """|theta| - theta_c."""
    return xp.abs(y[2]) - par.alpha
