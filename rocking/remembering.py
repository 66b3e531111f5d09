"""A block whose impacts remember those before and feel the base: Method 1 with effects, with three more states.

    impacts  how many there have been since the start that were faster than least_speed
    pause    time since the last one of these [s]; long before the first one
    use      sum of |omega|^worn_exponent over all of these since the block was new [(rad/s)^worn_exponent]

    e += first exp(-impacts / first_impacts) + recent exp(-pause / recent_time) + worn (1 - exp(-use / worn_use))
         + pushed sign(omega) a_x + shaken |a_x|

omega as it falls on the edge, a_x of the base at that time, in the axes of the floor.

Source   own, a plain description of surfaces that bed in within a test, that take time to recover after an impact, or
         that wear for good: by each impact (exponent 0), or by the energy that it takes (exponent 2), as wear goes with
         work in Archard (1953), J. Appl. Phys. 24, 981; or on how the base is accelerated just then.
Status   Method 1 with effects where all of these are zero, and by hand from impact to impact (tests).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from rocking.composed import IMPACT, ComposedMethod1, OnRigidBlock, balance, guards, jump_with
from rocking.composed import flow as composed_flow
from rocking.hybrid import Anchor, Base, Discrete
from rocking.validation import positive, within

LONG_AGO = 1e6
"""Time since the last impact [s] of a block that has had none."""


class Parameters(NamedTuple):
    """Those of `rocking.composed`, and of what is remembered."""

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
    first: float  # [1]
    first_impacts: float  # [1]
    recent: float  # [1]
    recent_time: float  # [s]
    least_speed: float  # [rad/s]
    worn: float  # [1]
    worn_use: float  # [(rad/s)^worn_exponent]
    worn_exponent: float  # [1]
    pushed: float  # [s^2/m]
    shaken: float  # [s^2/m]
    hooks: Any


def flow(xp: Any, y: Any, q: Discrete, base: Base, par: Any) -> tuple[Any, ...]:
    """(omega, theta'', 0, 1, 0)."""
    omega, acceleration = composed_flow(xp, y, q, base, par)
    return omega, acceleration, 0.0 * y[2], 1.0 + 0.0 * y[3], 0.0 * y[4]


def jump(xp: Any, y: Any, q: Discrete, base: Base, par: Any, k: Any) -> tuple[tuple[Any, ...], Discrete]:
    """Those of `rocking.composed`; an impact that is fast enough counts and wears, and the time since it begins."""
    struck = (k == IMPACT) & (xp.abs(y[1]) > par.least_speed)
    worn = par.worn * (1.0 - xp.exp(-y[4] / par.worn_use))
    more = par.first * xp.exp(-y[2] / par.first_impacts) + par.recent * xp.exp(-y[3] / par.recent_time) + worn
    # It falls on the edge against the side that it leaned to.
    more = more - par.pushed * q.s * base.a_x + par.shaken * xp.abs(base.a_x)
    (theta, omega), after = jump_with(xp, y, q, base, par, k, more, 0.0)
    use = xp.where(struck, y[4] + xp.abs(y[1]) ** par.worn_exponent, y[4])
    return (theta, omega, xp.where(struck, y[2] + 1.0, y[2]), xp.where(struck, 0.0, y[3]), use), after


@dataclass(frozen=True)
class RememberingBlock(OnRigidBlock):
    """A block whose restitution depends on the impacts before; made by `rocking.effects.learned_memory`.

    Args:
        rigid: the block without memory, with its form and hooks.
        first: what the restitution of the first impact has more [1].
        first_impacts: after so many impacts this has fallen to 1/e [1], positive.
        recent: what the restitution of an impact right after another one has more [1].
        recent_time: after so long a pause this has fallen to 1/e [s], positive.
        least_speed: impacts that are not faster are not remembered [rad/s], 0 or more: a base that hardly moves makes
            hundreds that leave no trace.
        worn: what the restitution of a block that has been used for long has more than that of a new one [1].
        worn_use: after so much use this is there but for 1/e [(rad/s)^worn_exponent], positive.
        worn_exponent: power of its speed by which an impact wears [1], 0 or more.
        used: use before the start [(rad/s)^worn_exponent], 0 or more.
        pushed: what the restitution has more per base acceleration, if that has the sense in which the block falls
            [s^2/m].
        shaken: what it has more per base acceleration of either sense [s^2/m].

    Raises:
        ValueError: a number is out of its range.
    """

    rigid: ComposedMethod1
    first: float
    first_impacts: float
    recent: float
    recent_time: float
    least_speed: float = 0.0
    worn: float = 0.0
    worn_use: float = 1.0
    worn_exponent: float = 2.0
    used: float = 0.0
    pushed: float = 0.0
    shaken: float = 0.0

    name = "method1"
    state_names = ("theta", "omega", "impacts", "pause", "use")
    guard_names = ("fall", "impact", "tip_right", "tip_left")
    carries_pitch = True
    inadmissible_reason = ""
    flow = staticmethod(flow)
    guards = staticmethod(guards)
    jump = staticmethod(jump)
    balance = staticmethod(balance)

    def __post_init__(self) -> None:
        within("first", self.first, -1.0, 1.0)
        within("recent", self.recent, -1.0, 1.0)
        positive("first_impacts", self.first_impacts, "1")
        positive("recent_time", self.recent_time, "s")
        within("least_speed", self.least_speed, 0.0, math.inf)
        within("worn", self.worn, -1.0, 1.0)
        positive("worn_use", self.worn_use, "(rad/s)^worn_exponent")
        within("worn_exponent", self.worn_exponent, 0.0, math.inf)
        within("used", self.used, 0.0, math.inf)
        within("pushed", self.pushed, -1.0, 1.0)
        within("shaken", self.shaken, -1.0, 1.0)

    @cached_property
    def parameters(self) -> Parameters:
        """The numbers that the equations take."""
        return Parameters(
            **self.rigid.parameters._asdict(), first=float(self.first), first_impacts=float(self.first_impacts),
            recent=float(self.recent), recent_time=float(self.recent_time), least_speed=float(self.least_speed),
            worn=float(self.worn), worn_use=float(self.worn_use), worn_exponent=float(self.worn_exponent),
            pushed=float(self.pushed), shaken=float(self.shaken),
        )  # fmt: skip

    def initial_state(
        self, theta: float = 0.0, omega: float = 0.0, impacts: float = 0.0, pause: float = LONG_AGO, use: float = 0.0
    ) -> tuple[tuple[float, ...], Discrete]:
        """At rest if upright and still, else rocking on the edge that carries; after so many impacts and so long.

        use: besides what the block had been used before.
        """
        y, q = self.rigid.initial_state(theta, omega)
        return (*y, float(impacts), float(pause), self.used + float(use)), q

    def anchor(self, y: Any, rate: Any, s: Any) -> Anchor:
        """The centre of the edge on which the block rolls."""
        return self.rigid.anchor(y, rate, s)
