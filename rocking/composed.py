"""Method 1 with effects: a block of any form that rests or rocks, with whatever the effects add to its equations.

Mirrored to the carrying side (phi = s theta), with the levers of `rocking.form` and the base in the axes of the floor,

    M phi'' = -[ A_z z' + s A_x x' + r z' omega^2 + s psi'' (z x' - x z' + rho2) ],   M = rho2 + x'^2 + z'^2

(Lagrange's equation per mass; psi'' is the pitch acceleration), to which the effects add their own angular
accelerations.  Lift-off follows from the same line: a side begins to carry when its phi'' at rest rises above what
adhesion holds.  At an impact omega is multiplied by the restitution of the form, or by the one given, after which the
effects have their say.

Source   own derivation; the case without effects is `rocking.method1` (Yim, Chopra & Penzien 1980).
Status   equal to Method 1 to rounding when every effect is absent (tests).  No sliding and no jump.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

from rocking.form import Form, levers
from rocking.hybrid import REST, ROTATION, WITHIN, Anchor, Base, Discrete, Hooks, in_floor_axes
from rocking.method1 import Method1

FALL, IMPACT, TIP_RIGHT, TIP_LEFT = range(4)


class Parameters(NamedTuple):
    """What the equations take."""

    a: float  # half of the breadth that it stands on [m]
    r: float  # radius of the edges [m]
    o: float  # offset of the centre of mass [m]
    H: float  # height of the centre of mass less r [m]
    rho2: float  # I_c / m [m^2]
    g: float  # [m/s^2]
    hold: float  # moment of adhesion over mass [m^2/s^2]
    e_right: float  # restitution when the +x edge hands over [1]
    e_left: float  # when the -x edge does [1]
    omega_rest: float  # angular speed [rad/s] below which an impact is the last
    balance_right: float  # tilt of unstable balance to +x [rad]
    balance_left: float  # to -x [rad], positive
    hooks: Any  # Hooks


def added(theta: Any, omega: Any, s: Any, base: Base, par: Any) -> Any:
    """Angular acceleration [rad/s^2] that the effects add."""
    total = 0.0
    for i in range(par.hooks.pushing):
        total = total + par.hooks.accelerations[i](theta, omega, s, base, par.hooks.values[i])
    return total


def changed(xp: Any, e: Any, omega: Any, s: Any, par: Any) -> Any:
    """Restitution [1] of an impact at which the side s hands over, with the say of the effects."""
    slots = len(par.hooks.restitutions)
    for i in range(par.hooks.striking):
        e = par.hooks.restitutions[i](e, omega, s, par.hooks.values[slots + i])
    return e


def moment(xp: Any, theta: Any, omega: Any, s: Any, base: Base, par: Parameters) -> tuple[Any, Any]:
    """(s times the driving moment over mass [m^2/s^2], M [m^2]) without effects."""
    x, z, x_phi, z_phi = levers(xp, s * theta, par.a, par.r, par.a - s * par.o, par.H)
    A_x, A_z = in_floor_axes(xp, base, par.g)
    pitching = base.pitch_acceleration * (z * x_phi - x * z_phi + par.rho2)
    torque = -(A_z * z_phi + s * (A_x * x_phi + pitching) + par.r * z_phi * omega * omega)
    return torque, par.rho2 + x_phi * x_phi + z_phi * z_phi


def flow(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, Any]:
    """(omega, theta''); zero at rest."""
    torque, M = moment(xp, y[0], y[1], q.s, base, par)
    rotating = xp.where(q.mode == ROTATION, 1.0, 0.0)
    return rotating * y[1], rotating * (q.s * torque / M + added(y[0], y[1], q.s, base, par))


def _held(xp: Any, s: Any, base: Base, par: Parameters, pushing: Any, within: float) -> Any:
    """Moment over mass [m^2/s^2] that is left before the side s begins to carry; below zero it does.

    pushing: what else turns the block to +x [m^2/s^2]; within: share of the weight's moment that counts as nothing.
    """
    # The levers of phi = 0, without their sines.
    q, z = par.a - s * par.o, par.r + par.H
    A_x, A_z = in_floor_axes(xp, base, par.g)
    torque = -(A_z * q + s * (A_x * z + base.pitch_acceleration * (z * z - s * par.o * q + par.rho2)))
    M = par.rho2 + z * z + q * q
    return par.hold - torque - s * (M * added(0.0, 0.0, s, base, par) + pushing) + within * A_z * q


def guards(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, Any, Any, Any]:
    """Fall (|theta| reaches pi/2), impact (the other edge lands), tip to +x and to -x (rest ends)."""
    return guards_with(xp, y, q, base, par, 0.0)


def guards_with(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters, pushing: Any) -> tuple[Any, Any, Any, Any]:
    """The same with so large a moment over mass besides that turns a block at rest to +x [m^2/s^2]."""
    rotating = q.mode == ROTATION
    fall = 0.5 * math.pi - xp.abs(y[0])
    impact = xp.where(rotating, q.s * y[0], 1.0)
    right, left = (
        _held(xp, 1.0, base, par, pushing, 2.0 * WITHIN),
        _held(xp, -1.0, base, par, pushing, 2.0 * WITHIN),
    )
    # Where nothing holds either side, as above a base that falls away, the block tips to the one that is held less.
    to_right = xp.where(rotating | ((right < 0.0) & (left < right)), 1.0, right)
    to_left = xp.where(rotating | ((left < 0.0) & (right <= left)), 1.0, left)
    return fall, impact, to_right, to_left


def _after(xp: Any, omega: Any, s: Any, par: Parameters, more: Any) -> Any:
    """Angular velocity after the impact at which the side s hands over; the restitution stays within 0 and 1."""
    e = changed(xp, xp.where(s > 0.0, par.e_right, par.e_left) + more, omega, s, par)
    return xp.minimum(xp.maximum(e, 0.0), 1.0) * omega


def jump(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters, k: Any) -> tuple[tuple[Any, Any], Discrete]:
    """Impact, and rest if it was the last.  Tip: rotation about the edge to which the moment turns."""
    return jump_with(xp, y, q, base, par, k, 0.0, 0.0)


def jump_with(
    xp: Any, y: Any, q: Discrete, base: Base, par: Parameters, k: Any, more: Any, pushing: Any
) -> tuple[tuple[Any, Any], Discrete]:
    """The same with so much more restitution [1], and so large a moment over mass besides [m^2/s^2]."""
    impact = k == IMPACT
    omega = xp.where(impact, _after(xp, y[1], q.s, par, more), 0.0)
    right, left = _held(xp, 1.0, base, par, pushing, WITHIN), _held(xp, -1.0, base, par, pushing, WITHIN)
    holds = (right >= 0.0) & (left >= 0.0)
    rests = impact & (xp.abs(omega) < par.omega_rest) & holds
    s = xp.where(impact, -q.s, xp.where(k == TIP_RIGHT, 1.0, -1.0))
    mode = xp.where(rests, REST, ROTATION)
    return (0.0 * y[0], xp.where(rests, 0.0, omega)), Discrete(mode, s, q.slip)


def balance(xp: Any, y: Any, par: Parameters) -> Any:
    """|theta| less the tilt of unstable balance to that side."""
    return xp.where(y[0] > 0.0, y[0] - par.balance_right, -y[0] - par.balance_left)


@dataclass(frozen=True)
class ComposedMethod1:
    """Method 1 (nonlinear) for a block of any form, with hooks; made by `rocking.effects.compose`.

    Args:
        method: the ideal block: its restitution, gravity and rest speed are kept.
        form: the form of the block.
        hooks: what effects add to flow and impact.
        effects: for the record, what was composed.

    Raises:
        ValueError: the method is linear, or one side would have a restitution above 1.
    """

    method: Method1
    form: Form
    hooks: Hooks
    effects: tuple[Any, ...] = field(default=())

    name = "method1"
    state_names = ("theta", "omega")
    guard_names = ("fall", "impact", "tip_right", "tip_left")
    carries_pitch = True
    inadmissible_reason = ""
    guards = staticmethod(guards)
    jump = staticmethod(jump)
    balance = staticmethod(balance)
    flow = staticmethod(flow)

    def __post_init__(self) -> None:
        if self.method.form != "nonlinear":
            raise ValueError(f"form={self.method.form!r}: effects on the equations want the nonlinear Method 1")
        self.form.restitutions(self.method.restitution)

    @property
    def block(self) -> Any:
        """The ideal block."""
        return self.method.block

    @property
    def g(self) -> float:
        """Acceleration of gravity [m/s^2]."""
        return self.method.g

    @property
    def restitutions(self) -> tuple[float, float]:
        """Restitution of eq. (4) when the +x and when the -x edge hands over [1]."""
        return self.form.restitutions(self.method.restitution)

    @property
    def theta_c(self) -> float:
        """The smaller of the two tilts of unstable balance [rad]."""
        return min(self.form.theta_c(1.0), self.form.theta_c(-1.0))

    @cached_property
    def parameters(self) -> Parameters:
        """The numbers that the equations take."""
        form, (right, left) = self.form, self.restitutions
        return Parameters(
            form.half_breadth, form.edge_radius, form.offset, form.mass_height - form.edge_radius, form.rho2,
            float(self.g), form.adhesion / form.mass, right, left, self.method.rest_speed * self.block.p(self.g),
            form.theta_c(1.0), form.theta_c(-1.0), self.hooks,
        )  # fmt: skip

    def initial_state(self, theta: float = 0.0, omega: float = 0.0) -> tuple[tuple[float, float], Discrete]:
        """At rest if upright and still, else rocking on the edge that carries."""
        return self.method.initial_state(theta, omega)

    def anchor(self, y: Any, rate: Any, s: Any) -> Anchor:
        """The centre of the edge on which the block rolls."""
        X, r = s * self.form.half_breadth, self.form.edge_radius
        return Anchor(X, r, X + r * y[0], r, r * rate[1], 0.0)


class OnRigidBlock:
    """What a block with further freedoms has of the rigid one that it is made of, `rigid`."""

    rigid: ComposedMethod1

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
