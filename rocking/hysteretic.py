"""A block held by something that yields or creeps: Method 1 with effects, with one more state, the strain z.

    z' = omega - |omega| (z / width) |z / width|^(n - 1) - z / time,      torque on the block -stiffness z

A spring in rotation that slips once it is strained by about its width (Dahl's friction), the more suddenly the greater
n is, that relaxes in some time (Maxwell's element), or both.  It holds a block at rest as well.

Source   Dahl (1968), A solid friction model, TOR-0158(3107-18)-1, The Aerospace Corporation, n = 1; Wen (1976), J. Eng.
         Mech. Div. ASCE 102, 249-263, of any n; Maxwell (1867), Phil. Trans. R. Soc. 157, 49-88.
Status   Dahl's curve, that of n = 2, the equation by another integrator, the elastic limit and what it holds at rest
         (tests).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, NamedTuple

from rocking.composed import ComposedMethod1, OnRigidBlock, added, balance, guards_with, jump_with, moment
from rocking.hybrid import ROTATION, Anchor, Base, Discrete
from rocking.validation import within


class Parameters(NamedTuple):
    """Those of `rocking.composed`, and of what yields."""

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
    stiffness: float  # torque over mass [m^2/s^2] for each rad of strain
    per_width: float  # [1/rad], 0 where it never slips
    per_time: float  # [1/s], 0 where it never relaxes
    sharper: float  # n - 1 [1]
    hooks: Any


NEXT_TO_NOTHING = 1e-30
"""Of a strain over the width, so that its powers have a slope at nothing too."""

TERMS, NEWTON = 55, 6
"""Of the series of a slow pull at half of the most strain, and steps for its inverse: to rounding."""

STEP = 0.1
"""Of Runge and Kutta, over the width and times n: to 1e-8 of the strain."""

ALL_OF_IT = 30.0
"""-log of what is left of the most strain there is from which nothing is left."""


def flow(xp: Any, y: Any, q: Discrete, base: Base, par: Any) -> tuple[Any, ...]:
    """(omega, theta'', z')."""
    theta, omega, strain = y
    rigid, M = moment(xp, theta, omega, q.s, base, par)
    total = q.s * rigid + M * added(theta, omega, q.s, base, par) - par.stiffness * strain
    rotating = xp.where(q.mode == ROTATION, 1.0, 0.0)
    turning = rotating * omega
    return turning, rotating * total / M, turning - yielding(xp, strain, turning, par) * strain


def yielding(xp: Any, strain: Any, omega: Any, par: Any) -> Any:
    """Rate [1/s] at which the strain is lost, by slip and by relaxation."""
    slips = par.per_width * (xp.abs(strain) * par.per_width + NEXT_TO_NOTHING) ** par.sharper
    return xp.abs(omega) * slips + par.per_time


def guards(xp: Any, y: Any, q: Discrete, base: Base, par: Any) -> tuple[Any, ...]:
    """Those of `rocking.composed`, with what is strained still at rest."""
    return guards_with(xp, y, q, base, par, -par.stiffness * y[2])


def jump(xp: Any, y: Any, q: Discrete, base: Base, par: Any, k: Any) -> tuple[tuple[Any, ...], Discrete]:
    """Those of `rocking.composed`; the strain stays."""
    (theta, omega), after = jump_with(xp, y, q, base, par, k, 0.0, -par.stiffness * y[2])
    return (theta, omega, y[2]), after


@dataclass(frozen=True)
class HystereticBlock(OnRigidBlock):
    """A block held by a spring that slips or relaxes; made by `rocking.effects.learned_hysteresis`.

    Args:
        rigid: the block without it, with its form and hooks.
        stiffness: torque on the block [N m] for each rad of strain, 0 or more.
        per_width: one over the strain at which it slips [1/rad], 0 or more.
        per_time: one over the time in which it relaxes [1/s], 0 or more.
        strained: share of the strain of a slow pull to the lean from which a block is let go that is there then [1].
        exponent: n, how suddenly it slips [1], 1 or more.

    Raises:
        ValueError: a number is out of its range.
    """

    rigid: ComposedMethod1
    stiffness: float
    per_width: float
    per_time: float
    strained: float
    exponent: float = 1.0

    name = "method1"
    state_names = ("theta", "omega", "strain")
    state_labels = MappingProxyType({"strain": ("rad", "rotation by which the spring is strained")})
    guard_names = ("fall", "impact", "tip_right", "tip_left")
    carries_pitch = True
    inadmissible_reason = ""
    flow = staticmethod(flow)
    guards = staticmethod(guards)
    jump = staticmethod(jump)
    balance = staticmethod(balance)

    def __post_init__(self) -> None:
        within("stiffness", self.stiffness, 0.0, math.inf)
        within("per_width", self.per_width, 0.0, math.inf)
        within("per_time", self.per_time, 0.0, math.inf)
        within("strained", self.strained, 0.0, 1.0)
        within("exponent", self.exponent, 1.0, math.inf)

    @cached_property
    def parameters(self) -> Parameters:
        """The numbers that the equations take."""
        return Parameters(
            **self.rigid.parameters._asdict(), stiffness=self.stiffness / self.rigid.form.mass,
            per_width=float(self.per_width), per_time=float(self.per_time), sharper=float(self.exponent) - 1.0,
        )  # fmt: skip

    def initial_state(
        self, theta: float = 0.0, omega: float = 0.0, strain: float | None = None
    ) -> tuple[tuple[float, ...], Discrete]:
        """At rest if upright and still, else rocking on the edge that carries.

        Args:
            theta, omega: rotation [rad] and angular velocity [rad/s].
            strain: [rad]; as `strained` says if not given.
        """
        y, q = self.rigid.initial_state(theta, omega)
        if strain is None:
            pulled = abs(theta) if self.strained else 0.0
            if pulled and self.per_width:
                pulled = _pulled(pulled * self.per_width, self.exponent) / self.per_width
            strain = self.strained * math.copysign(pulled, theta)
        return (*y, float(strain)), q

    def anchor(self, y: Any, rate: Any, s: Any) -> Anchor:
        """The centre of the edge on which the block rolls."""
        return self.rigid.anchor(y, rate, s)


def _pulled(turned: float, n: float) -> float:
    """Strain z after a slow pull from none by `turned`, both over the width: dz/dx = 1 - z^n.

    1 - exp(-x) for n = 1.  Else up to a half from x = z + z^(n+1)/(n+1) + z^(2n+1)/(2n+1) + ..., by Newton's method,
    and from there by w = -log(1 - z), which no end slows down, in steps of Runge and Kutta.
    """
    if n == 1.0:
        return -math.expm1(-turned)

    def turned_by(z: float) -> float:
        return math.fsum(z ** (k * n + 1.0) / (k * n + 1.0) for k in range(TERMS))

    left = turned - turned_by(0.5)
    if left <= 0.0:
        z = min(turned, 0.5)
        for _ in range(NEWTON):
            z -= (turned_by(z) - turned) * (1.0 - z**n)
        return z

    def slope(w: float) -> float:
        z = -math.expm1(-w)
        return (1.0 - z**n) * math.exp(w)

    w = -math.log(0.5)
    while left > 0.0 and w < ALL_OF_IT:
        h = min(left, STEP / n)
        first = slope(w)
        second = slope(w + 0.5 * h * first)
        third = slope(w + 0.5 * h * second)
        w += h / 6.0 * (first + 2.0 * (second + third) + slope(w + h * third))
        left -= h
    return -math.expm1(-w)
