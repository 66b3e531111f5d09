"""A block with a mass inside that swings on a spring and a dashpot: Method 1 with effects, with two more states.

The mass mu m, a part of the declared mass m, moves by q along the base, at a height h over it in the middle of the
block; c = q - s a is where it is along the base from the carrying corner, A_x' and A_z' the acceleration of the base
less gravity in the axes of the block, and

    v = q' + h omega,  v' = -w^2 q - 2 zeta w q' + c omega^2 - A_x'
    (M + mu (c^2 - a^2 - h^2)) theta'' = [...] + mu [q A_z' - 2 c q' omega + h (w^2 q + 2 zeta w q' - c omega^2 + A_x')]

where M and [...] are those of `rocking.composed` with the mass in its middle place.  v, the velocity along the base of
the mass over that of the corner, does not jump at an impact, since a spring carries no impulse.

Source   own derivation (Lagrange's equations of the two bodies).
Status   MuJoCo within a swing, the oscillator in a block at rest, lift-off and the rigid limit (tests).  A restitution
         does not know where the mass is, so that one near 1 may add a little energy.  Where edges are rounded the
         lever of the mass leaves out how far the corner has rolled.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, NamedTuple

from rocking.composed import ComposedMethod1, OnRigidBlock, added, balance, guards_with, jump_with, moment
from rocking.hybrid import ROTATION, Anchor, Base, Discrete, in_floor_axes
from rocking.validation import positive, within


class Parameters(NamedTuple):
    """Those of `rocking.composed`, and of the mass."""

    a: float
    r: float
    o: float
    H: float
    rho2: float
    g: float
    hold: float
    e_right: float
    e_left: float
    omega_rest: float
    balance_right: float
    balance_left: float
    mu: float  # mass over that of the whole block [1]
    h: float  # its height over the base [m]
    w: float  # natural circular frequency of the mass, the block held [rad/s]
    damping: float  # 2 zeta w [1/s]
    hooks: Any


class Inside(NamedTuple):
    """What the mass does to the block, and what happens to it."""

    moment: Any  # over the mass of the block, turning it to +x [m^2/s^2]
    inertia: Any  # to be added, over the mass of the block [m^2]
    v_dot: Any  # [m/s^2]


def inside(xp: Any, y: Any, q: Discrete, base: Base, par: Any) -> Inside:
    """The mass in this state."""
    theta, omega, shift, v = y
    sin, cos, c = xp.sin(theta), xp.cos(theta), shift - q.s * par.a
    A_x, A_z = in_floor_axes(xp, base, par.g)
    # A pitch about the middle of where the block stands carries the mass along, here as if in its middle place.
    A_x = A_x + base.pitch_acceleration * (q.s * par.a * sin + par.h * cos)
    A_z = A_z - base.pitch_acceleration * (q.s * par.a * (1.0 - cos) + par.h * sin)
    along, normal = A_x * cos - A_z * sin, A_x * sin + A_z * cos
    slide = v - par.h * omega
    drawn = par.w * par.w * shift + par.damping * slide - c * omega * omega + along
    turning = par.mu * (shift * normal - 2.0 * c * slide * omega + par.h * drawn)
    return Inside(turning, par.mu * (c * c - par.a * par.a - par.h * par.h), -drawn)


def flow(xp: Any, y: Any, q: Discrete, base: Base, par: Any) -> tuple[Any, ...]:
    """(omega, theta'', q', v')."""
    within_it = inside(xp, y, q, base, par)
    rigid, M = moment(xp, y[0], y[1], q.s, base, par)
    total = q.s * rigid + M * added(y[0], y[1], q.s, base, par) + within_it.moment
    rotating = xp.where(q.mode == ROTATION, 1.0, 0.0)
    return rotating * y[1], rotating * total / (M + within_it.inertia), y[3] - par.h * y[1], within_it.v_dot


def guards(xp: Any, y: Any, q: Discrete, base: Base, par: Any) -> tuple[Any, ...]:
    """Those of `rocking.composed`, with what the mass adds to the moment on a block at rest."""
    return guards_with(xp, y, q, base, par, inside(xp, y, q, base, par).moment)


def jump(xp: Any, y: Any, q: Discrete, base: Base, par: Any, k: Any) -> tuple[tuple[Any, ...], Discrete]:
    """Those of `rocking.composed`; place and velocity of the mass stay."""
    (theta, omega), after = jump_with(
        xp, y, q, base, par, k, 0.0, inside(xp, (0.0, 0.0, y[2], y[3]), q, base, par).moment
    )
    return (theta, omega, y[2], y[3]), after


@dataclass(frozen=True)
class BlockWithInnerMass(OnRigidBlock):
    """A block with a mass inside that swings; made by `rocking.effects.learned_mode`.

    Args:
        rigid: the block with the mass held in its middle place, with its form and hooks.
        mass_ratio: mass over that of the whole block [1], 0 to 0.5.
        height: of the mass over the base [m], 0 or more.
        frequency: natural frequency of the mass while the block is held [Hz], positive.
        damping_ratio: of the same [1], 0 or more.

    Raises:
        ValueError: a number is out of its range, or so much of the inertia is in the mass that the rest has none.
    """

    rigid: ComposedMethod1
    mass_ratio: float
    height: float
    frequency: float
    damping_ratio: float

    name = "method1"
    state_names = ("theta", "omega", "shift", "velocity")
    state_labels = MappingProxyType(
        {
            "shift": ("m", "position of the mass in the block, along its base from the middle"),
            "velocity": ("m s-1", "velocity of the mass along the base of the block, over that of the corner"),
        }
    )
    guard_names = ("fall", "impact", "tip_right", "tip_left")
    carries_pitch = True
    inadmissible_reason = ""
    flow = staticmethod(flow)
    guards = staticmethod(guards)
    jump = staticmethod(jump)
    balance = staticmethod(balance)

    def __post_init__(self) -> None:
        within("mass_ratio", self.mass_ratio, 0.0, 0.5)
        within("height", self.height, 0.0, math.inf)
        positive("frequency", self.frequency, "Hz")
        within("damping_ratio", self.damping_ratio, 0.0, math.inf)
        form = self.rigid.form
        # Of the rest about the middle of the base, less what the mass has: positive for a body of positive mass.
        left = form.rho2 + form.mass_height**2 - self.mass_ratio * (self.height**2 + form.half_breadth**2)
        if left <= 0.0:
            raise ValueError(
                f"mass_ratio={self.mass_ratio!r}: at a height of {self.height:.4g} m more than the moment of inertia "
                "of the whole block would be in the mass; want less of one or the other"
            )

    @cached_property
    def parameters(self) -> Parameters:
        """The numbers that the equations take."""
        w = 2.0 * math.pi * self.frequency
        return Parameters(
            **self.rigid.parameters._asdict(), mu=float(self.mass_ratio), h=float(self.height), w=w,
            damping=2.0 * self.damping_ratio * w,
        )  # fmt: skip

    def initial_state(
        self, theta: float = 0.0, omega: float = 0.0, shift: float | None = None, slide: float = 0.0
    ) -> tuple[tuple[float, ...], Discrete]:
        """At rest if upright and still, else rocking on the edge that carries.

        Args:
            theta, omega: rotation [rad] and angular velocity [rad/s].
            shift: of the mass in the block [m]; where it hangs still at this lean on a level base if not given.
            slide: its velocity in the block [m/s].
        """
        y, q = self.rigid.initial_state(theta, omega)
        par = self.parameters
        hangs = par.g * math.sin(theta) / par.w**2
        return (*y, hangs if shift is None else float(shift), float(slide) + par.h * omega), q

    def anchor(self, y: Any, rate: Any, s: Any) -> Anchor:
        """The centre of the edge on which the block rolls."""
        return self.rigid.anchor(y, rate, s)
