"""A block on a floor that gives: a spring and a dashpot under each bottom corner, three freedoms.

With F and N of each corner that touches (compression d of its foot, slip e since it touched, both with their rates),

    N = max(k d + c d', 0),  F = -(k e + c e') where N > 0,  c = 2 xi sqrt(k m)
    m x'' = sum F - m A_x,  m z'' = sum N - m A_z,  I_c theta'' = sum (r_z F - r_x N) - I_c psi''

about the centre of mass (x, z), the base in the axes of the floor and psi'' its pitch acceleration.  The feet do not
slip.  Where each foot touched is part of the state, so that tangential forces start from zero at each touch-down.

Source   Psycharis & Jennings (1983), Earthquake Eng. Struct. Dyn. 11, 57-76: two-spring foundation with uplift; the
         tangential springs are those of the distinct elements of Winkler, Meguro & Yamazaki (1995).
Status   energy balance, the static sink, periods of small oscillation and the rigid limit (tests).  A block that stands
         on both corners has mode REST, on one ROTATION, on none ROTATION_JUMP; it never stands wholly still.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from rocking.composed import ComposedMethod1
from rocking.hybrid import REST, ROTATION, ROTATION_JUMP, Anchor, Base, Discrete, in_floor_axes
from rocking.validation import positive, within

FALL, RIGHT, LEFT = range(3)
X, Z, THETA, U, V, OMEGA, FOOT_RIGHT, FOOT_LEFT = range(8)


class Parameters(NamedTuple):
    """What the equations take; masses are divided out."""

    a: float  # half of the breadth between the feet [m]
    o: float  # offset of the centre of mass [m]
    H: float  # its height [m]
    rho2: float  # I_c / m [m^2]
    g: float  # [m/s^2]
    k: float  # stiffness over mass [1/s^2]
    c: float  # dashpot over mass [1/s]
    balance_right: float  # tilt of unstable balance to +x [rad]
    balance_left: float  # to -x [rad], positive
    hooks: Any  # Hooks; those of an impact are not asked for, since its loss follows from the dashpots


class Foot(NamedTuple):
    """One corner: its arm from the centre of mass, its height over the floor and the velocities of both."""

    r_x: Any  # [m]
    r_z: Any
    x: Any  # [m]
    height: Any
    u: Any  # [m/s]
    v: Any


def foot(xp: Any, y: Any, side: float, par: Parameters) -> Foot:
    """The corner of that side, +1.0 or -1.0."""
    sin, cos = xp.sin(y[2]), xp.cos(y[2])
    along, up = side * par.a - par.o, -par.H
    r_x, r_z = along * cos + up * sin, -along * sin + up * cos
    return Foot(r_x, r_z, y[0] + r_x, y[1] + r_z, y[3] + y[5] * r_z, y[4] - y[5] * r_x)


def forces(xp: Any, at: Foot, touched: Any, touches: Any, par: Parameters) -> tuple[Any, Any]:
    """(F, N) over mass [m/s^2] of a foot that first touched the floor at x = touched."""
    N = xp.where(touches, xp.maximum(-par.k * at.height - par.c * at.v, 0.0), 0.0)
    F = xp.where(N > 0.0, -par.k * (at.x - touched) - par.c * at.u, 0.0)
    return F, N


def touching(q: Discrete) -> tuple[Any, Any]:
    """Whether the right and the left foot touch."""
    return (q.mode == REST) | ((q.mode == ROTATION) & (q.s > 0.0)), (q.mode == REST) | (
        (q.mode == ROTATION) & (q.s < 0.0)
    )


def flow(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, ...]:
    """dy/dt; what the two feet do not hold is free."""
    right, left = foot(xp, y, 1.0, par), foot(xp, y, -1.0, par)
    on_right, on_left = touching(q)
    F_r, N_r = forces(xp, right, y[6], on_right, par)
    F_l, N_l = forces(xp, left, y[7], on_left, par)
    A_x, A_z = in_floor_axes(xp, base, par.g)
    # A pitch about the middle of where the block stands carries the centre of mass along.
    A_x = A_x + base.pitch_acceleration * y[1]
    A_z = A_z - base.pitch_acceleration * y[0]
    moment = right.r_z * F_r - right.r_x * N_r + left.r_z * F_l - left.r_x * N_l
    omega_dot = moment / par.rho2 - base.pitch_acceleration
    for i in range(par.hooks.pushing):
        omega_dot = omega_dot + par.hooks.accelerations[i](y[2], y[5], q.s, base, par.hooks.values[i])
    return y[3], y[4], y[5], F_r + F_l - A_x, N_r + N_l - A_z, omega_dot, 0.0 * y[6], 0.0 * y[7]


def guards(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, Any, Any]:
    """Fall, and for each foot the way to where it meets or leaves the floor."""
    on_right, on_left = touching(q)
    right, left = foot(xp, y, 1.0, par).height, foot(xp, y, -1.0, par).height
    fall = 0.5 * math.pi - xp.abs(y[2])
    return fall, xp.where(on_right, -right, right), xp.where(on_left, -left, left)


def jump(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters, k: Any) -> tuple[tuple[Any, ...], Discrete]:
    """A foot meets the floor, where its tangential spring starts anew, or leaves it."""
    on_right, on_left = touching(q)
    at_right, at_left = k == RIGHT, k == LEFT
    now_right, now_left = on_right ^ at_right, on_left ^ at_left
    foot_right = xp.where(at_right & now_right, foot(xp, y, 1.0, par).x, y[6])
    foot_left = xp.where(at_left & now_left, foot(xp, y, -1.0, par).x, y[7])
    mode = xp.where(now_right & now_left, REST, xp.where(now_right | now_left, ROTATION, ROTATION_JUMP))
    s = xp.where(now_right & now_left, q.s, xp.where(now_right, 1.0, xp.where(now_left, -1.0, q.s)))
    return (y[0], y[1], y[2], y[3], y[4], y[5], foot_right, foot_left), Discrete(mode, s, q.slip)


def balance(xp: Any, y: Any, par: Parameters) -> Any:
    """|theta| less the tilt of unstable balance of the rigid block to that side."""
    return xp.where(y[2] > 0.0, y[2] - par.balance_right, -y[2] - par.balance_left)


@dataclass(frozen=True)
class BlockOnTwoSprings:
    """A block on two springs and dashpots; made by `rocking.effects.compliant_base`.

    Args:
        rigid: the block on a rigid floor, with its form and hooks; its restitution is not used, for the loss of an
            impact follows from the dashpots.
        corner_stiffness: k of a corner, normal and tangential [N/m], positive.
        damping_ratio: xi = c / (2 sqrt(k m)) of a corner [1], 0 or more.

    Raises:
        ValueError: a number is out of its range, or the block has rounded edges.
    """

    rigid: ComposedMethod1
    corner_stiffness: float
    damping_ratio: float

    name = "two_springs"
    state_names = ("x", "z", "theta", "u", "v", "omega", "foot_right", "foot_left")
    guard_names = ("fall", "contact", "landing")
    carries_pitch = True
    inadmissible_reason = ""
    flow = staticmethod(flow)
    guards = staticmethod(guards)
    jump = staticmethod(jump)
    balance = staticmethod(balance)

    def __post_init__(self) -> None:
        positive("corner_stiffness", self.corner_stiffness, "N/m")
        within("damping_ratio", self.damping_ratio, 0.0, math.inf)
        if self.rigid.form.edge_radius != 0.0:
            raise ValueError("compliant_base: it does not go together with rounded_edges")

    @property
    def block(self) -> Any:
        """The ideal block."""
        return self.rigid.block

    @property
    def g(self) -> float:
        """Acceleration of gravity [m/s^2]."""
        return self.rigid.g

    @property
    def effects(self) -> tuple[Any, ...]:
        """What was composed."""
        return self.rigid.effects

    @property
    def theta_c(self) -> float:
        """The smaller of the two tilts of unstable balance of the rigid block [rad]."""
        return self.rigid.theta_c

    @cached_property
    def parameters(self) -> Parameters:
        """The numbers that the equations take."""
        form = self.rigid.form
        per_mass = self.corner_stiffness / form.mass
        return Parameters(
            form.half_breadth, form.offset, form.mass_height, form.rho2, float(self.g), per_mass,
            2.0 * self.damping_ratio * math.sqrt(per_mass), form.theta_c(1.0), form.theta_c(-1.0), self.rigid.hooks,
        )  # fmt: skip

    def initial_state(self, theta: float = 0.0, omega: float = 0.0) -> tuple[tuple[float, ...], Discrete]:
        """In static balance of heights: on both feet when upright and still, else on the one to which it leans.

        A leaning block is let go from there: its foot is pressed in by the whole weight.
        """
        par = self.parameters
        leans = theta if theta != 0.0 else omega
        s = -1.0 if leans < 0.0 else 1.0
        if leans == 0.0:
            return self._standing(par), Discrete(REST, s, 1.0)
        cos, sin = math.cos(theta), math.sin(theta)
        along, up = s * par.a - par.o, -par.H
        r_x, r_z = along * cos + up * sin, -along * sin + up * cos
        x, z = s * par.a - r_x, -par.g / par.k - r_z
        u, v = -omega * r_z, omega * r_x
        return (x, z, theta, u, v, omega, s * par.a, -s * par.a), Discrete(ROTATION, s, 1.0)

    @staticmethod
    def _standing(par: Parameters) -> tuple[float, ...]:
        """At rest on both feet, each pressed in by its share of the weight."""
        right, left = (0.5 * par.g / par.k * (1.0 + s * par.o / par.a) for s in (1.0, -1.0))
        theta = math.asin((right - left) / (2.0 * par.a))
        cos, sin = math.cos(theta), math.sin(theta)
        z = -0.5 * (right + left) + par.H * cos - par.o * sin
        x = par.o * cos + par.H * sin
        return (x, z, theta, 0.0, 0.0, 0.0, par.a * cos, -par.a * cos)

    def anchor(self, y: Any, rate: Any, s: Any) -> Anchor:
        """The centre of mass."""
        form = self.rigid.form
        return Anchor(form.offset, form.mass_height, y[0], y[1], rate[3], rate[4])
