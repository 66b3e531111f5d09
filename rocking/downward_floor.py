"""A block on a floor that gives downward alone: springs and dashpots as in `rocking.soft_floor`, held along it.

The lower corner neither slips nor moves along the floor, so that the centre of mass goes with the rotation,

    x(theta) = s a - (s a - o) cos theta + H sin theta,  x' = dx/dtheta = H cos theta + (s a - o) sin theta

on the side s of theta, and two freedoms are left, its height z over the unloaded floor and theta:

    m z'' = sum N - m A_z
    (I_c + m x'^2) theta'' = sum (-r_x N) - I_c psi'' - m x' (x'' thetadot^2 + A_x),  x'' = d^2 x/dtheta^2

The sums are those of `rocking.soft_floor`, of corners or of a Winkler bed.  x' is continuous where the block is
upright, x'' is not: that instant is located while the block turns there.

Source   Psycharis & Jennings (1983), Earthquake Eng. Struct. Dyn. 11, 57-76: two-spring foundation and Winkler bed,
         which let nothing slide; here without their small angles
Status   Lagrange's equations integrated by SciPy, energy, stiff springs along the floor (tests).  Such springs lead to
         it no further than they are soft beside both feet: these are 2 a cos theta apart, which locks the base where
         k_t a theta^2 is not small beside the weight; here the lower foot alone is held.  A block that has left the
         floor with both corners is still held along it, which a free one is not: where it jumps, take springs.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from rocking.composed import added
from rocking.hybrid import Base, Discrete, in_floor_axes
from rocking.soft_floor import (
    BlockOnSoftFloor,
    Parameters,
    bed,
    foot,
    forces,
    leaning,
    touching,
)
from rocking.soft_floor import guards as guards_of_feet
from rocking.soft_floor import jump as jump_of_feet

UPRIGHT = 5
"""Guard of the instant in which the lower corner becomes the upper one."""

SLOWLY = 1e-3
"""Angular velocity [rad/s] below which that instant is not located: x'' thetadot^2 is nothing there."""


def flow(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, ...]:
    """dy/dt; x follows theta."""
    right, left = foot(xp, y, 1.0, par), foot(xp, y, -1.0, par)
    on_right, on_left = touching(q)
    N_b, moment_b = bed(xp, y, par)
    N_r = forces(xp, right, right.x, on_right, N_b, par).N
    N_l = forces(xp, left, left.x, on_left, N_b, par).N
    A_x, A_z = in_floor_axes(xp, base, par.g)
    A_x = A_x + base.pitch_acceleration * y[1]
    A_z = A_z - base.pitch_acceleration * y[0]
    side = xp.where(y[2] >= 0.0, 1.0, -1.0)
    sin, cos = xp.sin(y[2]), xp.cos(y[2])
    along = side * par.a - par.o
    slope, curvature = par.H * cos + along * sin, along * cos - par.H * sin
    lean = leaning(xp, y[2], par)
    squares = right.r_x**2 + right.r_z**2, left.r_x**2 + left.r_z**2
    inertia = par.rho2 + 0.5 * ((1.0 + lean) * squares[0] + (1.0 - lean) * squares[1])
    couple = added(y[2], y[5], lean, base, par) * inertia - par.rho2 * base.pitch_acceleration
    moment = moment_b - right.r_x * N_r - left.r_x * N_l + couple
    held = curvature * y[5] ** 2 + A_x
    omega_dot = (moment - slope * held) / (par.rho2 + slope**2)
    u_dot = slope * omega_dot + curvature * y[5] ** 2
    return y[3], y[4], y[5], u_dot, N_r + N_l + N_b - A_z, omega_dot, 0.0 * y[0], 0.0 * y[0]


def guards(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, ...]:
    """Those of the feet; and the block turns through upright, from the side that is kept in place of a slip."""
    towards = xp.maximum(q.slip * y[2], q.slip * y[5])
    return (*guards_of_feet(xp, y, q, base, par), xp.where(xp.abs(y[5]) > SLOWLY, towards, 1.0))


def jump(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters, k: Any) -> tuple[tuple[Any, ...], Discrete]:
    """A foot meets the floor or leaves it, or the block has turned through upright."""
    after, now = jump_of_feet(xp, y, q, base, par, k)
    return after, Discrete(now.mode, now.s, xp.where(k == UPRIGHT, -q.slip, q.slip))


@dataclass(frozen=True)
class BlockOnDownwardFloor(BlockOnSoftFloor):
    """A block on springs and dashpots that let nothing move along the floor; made by `rocking.effects.compliant_base`.

    Args:
        rigid, corner_stiffness, damping_ratio, spread: as of `rocking.soft_floor.BlockOnSoftFloor`.
        tangential_ratio: infinite.
        friction: infinite.

    Raises:
        ValueError: as there; or friction, which has no say here, is given.
    """

    name = "downward_floor"
    guard_names = ("fall", "contact", "landing", "right_lifts", "left_lifts", "upright")
    flow = staticmethod(flow)
    guards = staticmethod(guards)
    jump = staticmethod(jump)

    def _check_along(self) -> None:
        if self.tangential_ratio < math.inf:
            raise ValueError(
                f"tangential_ratio={self.tangential_ratio!r}: want inf where nothing moves along the floor"
            )
        if self.friction < math.inf:
            raise ValueError(f"friction={self.friction!r}: want inf where tangential_ratio=inf holds the corners")

    def initial_state(
        self, theta: float = 0.0, omega: float = 0.0, beside: tuple[Sequence[float], Discrete] | None = None
    ) -> tuple[tuple[float, ...], Discrete]:
        """As on springs along the floor; the side of the rotation is kept in place of a slip."""
        y, q = super().initial_state(theta, omega, beside)
        return y, Discrete(q.mode, q.s, math.copysign(1.0, y[2] if y[2] != 0.0 else y[5]))
