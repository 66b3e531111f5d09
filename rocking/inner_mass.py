"""A block with a mass inside that swings on a spring and a dashpot, or hangs: Method 1 with effects, two more states.

The mass mu m, a part of the declared mass m, moves by q along a path in the middle of the block, lowest at a height h
over the base.  The path is along the base, or an arc of curvature k on which the mass hangs as a pendulum does, at
phi = k q.  With (c, z) = (sin(phi) / k - s a, h + (1 - cos(phi)) / k) its place in the axes of the block from the
carrying corner, A_x' and A_z' the acceleration of the base less gravity in these axes, and

    l = z cos(phi) - c sin(phi),  n = c cos(phi) + z sin(phi),  A_t = A_x' cos(phi) + A_z' sin(phi)
    v = q' + l omega,  v' = -F - A_t + n omega (omega - k q'),  F = (w^2 - g k) q + 2 zeta w q'
    (M + mu (n^2 - a^2 - h^2)) theta'' = [...] + mu [(c + s a) A_z' - (z - h) A_x' - (2 omega - k q') q' n
                                                     + l (F - n omega^2 + A_t)]

where M and [...] are those of `rocking.composed` with the mass in its middle place.  v, the velocity of the mass along
its path over the corner, does not jump at an impact, since neither a spring nor what holds it to the path carries an
impulse along it.

Source   own derivation (Lagrange's equations of the two bodies).
Status   MuJoCo within a swing, the oscillator and the pendulum in a block at rest, lift-off and the rigid limit
         (tests).  A restitution does not know where the mass is, so that one near 1 may add a little energy.  Where
         edges are rounded the lever of the mass leaves out how far the corner has rolled.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, NamedTuple

from rocking.composed import ComposedMethod1, OnRigidBlock, added, balance, guards_with, jump_with, moment
from rocking.hybrid import ROTATION, Anchor, Base, Discrete, in_floor_axes
from rocking.validation import positive, within

HANGS = 20
"""Steps of Newton's method: one where the path is straight, and few else."""


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
    spring: float  # of w^2 what is no pendulum's [1/s^2]
    curve: float  # curvature of its path [1/m], 0 where that is straight
    arm: float  # its radius [m], 0 where it is straight
    straight: float  # 1 where it is straight, else 0
    hooks: Any


class Inside(NamedTuple):
    """What the mass does to the block, and what happens to it."""

    moment: Any  # over the mass of the block, turning it to +x [m^2/s^2]
    inertia: Any  # to be added, over the mass of the block [m^2]
    speed: Any  # of the mass along its path [m/s]
    v_dot: Any  # [m/s^2]


class Place(NamedTuple):
    """Where a mass is in the axes of the block, over the middle of its base."""

    across: Any  # along the base from the middle [m]
    rise: Any  # over its lowest place [m]
    sin: Any  # of how its path is inclined there
    cos: Any


def place(xp: Any, shift: Any, par: Any) -> Place:
    """The place of the mass at this length of its path [m] from the middle."""
    phi = par.curve * shift
    sin, half = xp.sin(phi), xp.sin(0.5 * phi)
    return Place(par.arm * sin + par.straight * shift, 2.0 * par.arm * half * half, sin, xp.cos(phi))


def levers(at: Place, s: Any, par: Any) -> tuple[Any, Any]:
    """(of the path, of what is normal to it) [m] about the carrying corner."""
    c, z = at.across - s * par.a, par.h + at.rise
    return z * at.cos - c * at.sin, c * at.cos + z * at.sin


def inside(xp: Any, y: Any, q: Discrete, base: Base, par: Any) -> Inside:
    """The mass in this state."""
    theta, omega, shift, v = y
    sin, cos = xp.sin(theta), xp.cos(theta)
    at = place(xp, shift, par)
    lever, normal = levers(at, q.s, par)
    A_x, A_z = in_floor_axes(xp, base, par.g)
    # A pitch about the middle of where the block stands carries the mass along, here as if in its middle place.
    A_x = A_x + base.pitch_acceleration * (q.s * par.a * sin + par.h * cos)
    A_z = A_z - base.pitch_acceleration * (q.s * par.a * (1.0 - cos) + par.h * sin)
    along, up = A_x * cos - A_z * sin, A_x * sin + A_z * cos
    on_path = along * at.cos + up * at.sin
    speed = v - lever * omega
    turns = par.curve * speed
    drawn = par.spring * shift + par.damping * speed + on_path
    turning = par.mu * (
        at.across * up - at.rise * along - (2.0 * omega - turns) * speed * normal
        + lever * (drawn - normal * omega * omega)
    )  # fmt: skip
    inertia = par.mu * (normal * normal - par.a * par.a - par.h * par.h)
    return Inside(turning, inertia, speed, normal * omega * (omega - turns) - drawn)


def flow(xp: Any, y: Any, q: Discrete, base: Base, par: Any) -> tuple[Any, ...]:
    """(omega, theta'', q', v')."""
    within_it = inside(xp, y, q, base, par)
    rigid, M = moment(xp, y[0], y[1], q.s, base, par)
    total = q.s * rigid + M * added(y[0], y[1], q.s, base, par) + within_it.moment
    rotating = xp.where(q.mode == ROTATION, 1.0, 0.0)
    return rotating * y[1], rotating * total / (M + within_it.inertia), within_it.speed, within_it.v_dot


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
        hanging: share of its stiffness that is a pendulum's [1], 0 to 1: 0 for a spring along the base, 1 for a mass
            that hangs, on an arm of g / (2 pi frequency)^2.

    Raises:
        ValueError: a number is out of its range, or so much of the inertia is in the mass that the rest has none.
    """

    rigid: ComposedMethod1
    mass_ratio: float
    height: float
    frequency: float
    damping_ratio: float
    hanging: float = 0.0

    name = "method1"
    state_names = ("theta", "omega", "shift", "velocity")
    state_labels = MappingProxyType(
        {
            "shift": ("m", "position of the mass in the block, along its path from the middle"),
            "velocity": ("m s-1", "velocity of the mass along its path in the block, over that of the corner"),
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
        within("hanging", self.hanging, 0.0, 1.0)
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
        rigid = self.rigid.parameters
        curve = self.hanging * w * w / rigid.g
        return Parameters(
            **rigid._asdict(), mu=float(self.mass_ratio), h=float(self.height), w=w,
            damping=2.0 * self.damping_ratio * w, spring=(1.0 - self.hanging) * w * w,
            curve=curve, arm=1.0 / curve if curve > 0.0 else 0.0, straight=0.0 if curve > 0.0 else 1.0,
        )  # fmt: skip

    def initial_state(
        self, theta: float = 0.0, omega: float = 0.0, shift: float | None = None, slide: float = 0.0
    ) -> tuple[tuple[float, ...], Discrete]:
        """At rest if upright and still, else rocking on the edge that carries.

        Args:
            theta, omega: rotation [rad] and angular velocity [rad/s].
            shift: of the mass along its path [m]; where it hangs still at this lean on a level base if not given.
            slide: its velocity in the block [m/s].
        """
        y, q = self.rigid.initial_state(theta, omega)
        shift = self._hangs(theta) if shift is None else float(shift)
        return (*y, shift, float(slide) + self._lever(shift, q.s) * omega), q

    def slide(self, y: Sequence[float], s: float) -> float:
        """Velocity of the mass in the block [m/s] in a state that stands on the edge of that side."""
        return float(y[3] - self._lever(y[2], s) * y[1])

    def _lever(self, shift: float, s: float) -> float:
        par = self.parameters
        return float(levers(place(math, shift, par), s, par)[0])

    def _hangs(self, theta: float) -> float:
        """Where it is held against its weight at a lean, by Newton's method from the angle of a pendulum."""
        par = self.parameters
        shift = par.g * theta / par.w**2
        for _ in range(HANGS):
            off = par.curve * shift - theta
            shift -= (par.spring * shift + par.g * math.sin(off)) / (par.spring + par.g * par.curve * math.cos(off))
        return shift

    def anchor(self, y: Any, rate: Any, s: Any) -> Anchor:
        """The centre of the edge on which the block rolls."""
        return self.rigid.anchor(y, rate, s)
