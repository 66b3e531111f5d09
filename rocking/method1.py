"""Method 1: a block that rests or rotates about a bottom corner, and loses speed at each impact.

    theta'' = -p^2 [ s (1 + a_z/g) sin(alpha - s theta) + (a_x/g) cos(alpha - s theta) ]        nonlinear
    theta'' = -p^2 [ s (1 + a_z/g) (alpha - s theta) + a_x/g ]                        linear, eqs (2), (3)
    omega after = e omega before, the other corner carries                                         eq. (4)

A base that pitches turns a_x, g + a_z into its own axes and adds -(1 - (3/4) sin(alpha) sin(alpha - s theta)) times
its angular acceleration (Newton's law in the frame of the floor, own derivation; the square of its speed left out).

Source   Yim, Chopra & Penzien (1980); Winkler, Meguro & Yamazaki (1995), eqs (2)-(4); West's formula, eq. (1), for
         the start of rocking.
Status   no sliding and no jump, whatever the base does: the contact is taken to hold even where it would have to pull.
         Restitution is free between 0 and 1; Housner's is the default, and 0 where that is below zero: a block with
         b/h > sqrt(2) lands on both corners and stops.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, NamedTuple

from rocking.block import G_STANDARD, Block
from rocking.hybrid import REST, ROTATION, WITHIN, Anchor, Base, Discrete, in_floor_axes
from rocking.validation import as_floats, positive, within

FALL, IMPACT, TIP = range(3)


class Parameters(NamedTuple):
    """What the equations take."""

    p2: float  # square of the frequency parameter [1/s^2]
    alpha: float  # slenderness angle [rad]
    g: float  # [m/s^2]
    onset: float  # |a_x| / (g + a_z) at which rocking starts [1]
    e: float  # restitution, eq. (4) [1]
    omega_rest: float  # angular speed [rad/s] below which an impact is the last


def nonlinear_flow(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, Any]:
    """(omega, theta'') of the nonlinear block; zero at rest."""
    psi = par.alpha - q.s * y[0]
    A_x, A_z = in_floor_axes(xp, base, par.g)
    sin = xp.sin(psi)
    pitching = (1.0 - 0.75 * xp.sin(par.alpha) * sin) * base.pitch_acceleration
    rotating = xp.where(q.mode == ROTATION, 1.0, 0.0)
    return rotating * y[1], -rotating * (par.p2 / par.g * (q.s * A_z * sin + A_x * xp.cos(psi)) + pitching)


def linear_flow(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, Any]:
    """(omega, theta'') of eqs (2) and (3) as printed; zero at rest."""
    psi = par.alpha - q.s * y[0]
    A_x, A_z = in_floor_axes(xp, base, par.g)
    pitching = (1.0 - 0.75 * par.alpha * psi) * base.pitch_acceleration
    rotating = xp.where(q.mode == ROTATION, 1.0, 0.0)
    return rotating * y[1], -rotating * (par.p2 / par.g * (q.s * A_z * psi + A_x) + pitching)


def _push(xp: Any, base: Base, par: Parameters) -> tuple[Any, Any]:
    """(acceleration [m/s^2] that drives the standing block over, what it can stand), with that of a pitch in both."""
    A_x, A_z = in_floor_axes(xp, base, par.g)
    cos = xp.cos(par.alpha)
    # H + I_c / (m H) of a uniform rectangle, whose R is 3 g / (4 p^2).
    lever = 0.75 * par.g / par.p2 * (cos + 1.0 / (3.0 * cos))
    return A_x + lever * base.pitch_acceleration, par.onset * A_z


def guards(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters) -> tuple[Any, Any, Any]:
    """Fall (|theta| reaches pi/2), impact (the other corner lands), tip (eq. (1))."""
    rotating = q.mode == ROTATION
    fall = 0.5 * math.pi - xp.abs(y[0])
    impact = xp.where(rotating, q.s * y[0], 1.0)
    push, stands = _push(xp, base, par)
    tip = xp.where(rotating, 1.0, (1.0 + 2.0 * WITHIN) * stands - xp.abs(push))
    return fall, impact, tip


def jump(xp: Any, y: Any, q: Discrete, base: Base, par: Parameters, k: Any) -> tuple[tuple[Any, Any], Discrete]:
    """Impact: eq. (4), and rest if it was the last.  Tip: rotation about the corner that the base drives under."""
    impact = k == IMPACT
    omega = xp.where(impact, par.e * y[1], 0.0)
    push, stands = _push(xp, base, par)
    rests = impact & (xp.abs(omega) < par.omega_rest) & (xp.abs(push) <= (1.0 + WITHIN) * stands)
    pushed = xp.where(push > 0.0, -1.0, 1.0)
    s = xp.where(impact, -q.s, pushed)
    mode = xp.where(rests, REST, ROTATION)
    return (0.0 * y[0], xp.where(rests, 0.0, omega)), Discrete(mode, s, q.slip)


def balance(xp: Any, y: Any, par: Parameters) -> Any:
    """|theta| - theta_c."""
    return xp.abs(y[0]) - par.alpha


@dataclass(frozen=True)
class Method1:
    """A rocking block after Yim's equations.

    Args:
        block: the block.
        restitution: e of eq. (4) [1], 0 to 1; Housner's 1 - 1.5 sin^2(alpha) if not given, or 0 where that is below 0.
        form: "nonlinear", or "linear" as eqs (2) and (3) are printed.
        onset: when rest ends: "west" at |a_x| = (b/h)(g + a_z), eq. (1); "linear" at alpha (g + a_z), where the linear
            equations by themselves leave rest (for form "linear" only: the nonlinear block would fall back).
        g: acceleration of gravity [m/s^2].
        rest_speed: an impact after which |omega| / p is below this [1] is the last one, if the base lets the block
            stand: what is left of the geometric series of impacts is dropped.

    Raises:
        ValueError: an argument is out of the range above.
    """

    block: Block
    restitution: float | None = None
    form: Literal["nonlinear", "linear"] = "nonlinear"
    onset: Literal["west", "linear"] = "west"
    g: float = G_STANDARD
    rest_speed: float = 1e-6

    name = "method1"
    state_names = ("theta", "omega")
    guard_names = ("fall", "impact", "tip")
    carries_pitch = True
    inadmissible_reason = ""
    guards = staticmethod(guards)
    jump = staticmethod(jump)
    balance = staticmethod(balance)

    def __post_init__(self) -> None:
        if not isinstance(self.block, Block):
            raise ValueError(f"block={self.block!r}: want a Block")
        if self.form not in ("nonlinear", "linear"):
            raise ValueError(f"form={self.form!r}: want 'nonlinear' or 'linear'")
        if self.onset not in ("west", "linear"):
            raise ValueError(f"onset={self.onset!r}: want 'west' or 'linear'")
        if self.onset == "linear" and self.form != "linear":
            raise ValueError("onset='linear': want form='linear' with it (the nonlinear block would fall back)")
        positive("g", self.g, "m/s^2")
        positive("rest_speed", self.rest_speed, "1")
        if self.restitution is not None:
            within("restitution", self.restitution, 0.0, 1.0)
        as_floats(self, "restitution", "g", "rest_speed")

    @property
    def e(self) -> float:
        """Restitution of eq. (4) in force [1]."""
        return max(self.block.housner_restitution, 0.0) if self.restitution is None else self.restitution

    @property
    def theta_c(self) -> float:
        """Tilt of unstable balance [rad]."""
        return self.block.alpha

    @property
    def flow(self) -> Callable[..., Any]:
        """The equation of motion in the form chosen."""
        return nonlinear_flow if self.form == "nonlinear" else linear_flow

    @cached_property
    def parameters(self) -> Parameters:
        """The numbers that the equations take."""
        p = self.block.p(self.g)
        onset = self.block.b / self.block.h if self.onset == "west" else self.block.alpha
        return Parameters(p * p, self.block.alpha, self.g, onset, self.e, self.rest_speed * p)

    def initial_state(self, theta: float = 0.0, omega: float = 0.0) -> tuple[tuple[float, float], Discrete]:
        """At rest if upright and still, else rotating about the corner that carries."""
        leans = theta if theta != 0.0 else omega
        s = -1.0 if leans < 0.0 else 1.0
        mode = REST if leans == 0.0 else ROTATION
        return (float(theta), float(omega)), Discrete(mode, s, 1.0)

    def anchor(self, y: Any, rate: Any, s: Any) -> Anchor:
        """The carrying corner, which stands still."""
        return Anchor(s * 0.5 * self.block.b, 0.0, s * 0.5 * self.block.b, 0.0, 0.0, 0.0)
