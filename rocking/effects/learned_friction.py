"""Learned friction: a torque against the motion by any curve of the rotation, where no effect with a name explains it.

Adds        theta'' += c(theta) f(omega), f(omega) = omega / sqrt(omega^2 + 0.00003^2); c a natural cubic spline
            over equal intervals from low to high, beyond which it keeps its last value; each side has its own
Parameters  low and high, where c begins and ends [rad]; intervals, 1 to `MOST` [1]; friction_0 ..., coefficients of c
            [rad/s^2], one more than there are intervals, as those of `rocking.effects.learned_curve`; below zero they
            rub; 0 where absent
Use when    something rubs on one side, or from some rotation on: a cable, a guide, a hinge of an instrument
Limits      no memory, and what it would hold creeps at some 0.00003 rad/s; what is narrower than an interval is smeared
            over it
Source      as `rocking.effects.learned_curve`; Coulomb friction made smooth as in `rocking.effects.learned_term`
Status      a constant and a straight curve against the friction of the learned term, SciPy's splines by way of the
            curve, and the absent value (tests)
"""

from __future__ import annotations

import math
from typing import Any, ClassVar

from rocking.effects.learned_curve import MOST, curve, none_beyond, numbers, rising, tabulated
from rocking.effects.learned_term import SMOOTH
from rocking.form import Form

FRICTION = tuple(f"friction_{j}" for j in range(MOST + 1))
"""Names of the coefficients."""


def torque(xp: Any, theta: Any, omega: Any, s: Any, base: Any, values: Any) -> Any:
    """The curve at this rotation in the direction of the motion [rad/s^2]."""
    return curve(xp, theta - values[0], values, 1) * omega / xp.sqrt(omega * omega + SMOOTH * SMOOTH)


_FIELDS: list[tuple[str, float]] = [
    ("low", -1.0), ("high", 1.0), ("intervals", float(MOST)), *((name, 0.0) for name in FRICTION),
]  # fmt: skip

_Coefficients: Any = tabulated(_FIELDS)


class LearnedFriction(_Coefficients):
    """A curve: where it begins and ends [rad], its intervals and its coefficients [rad/s^2]."""

    name: ClassVar[str] = "learned_friction"
    units: ClassVar[dict[str, str]] = dict.fromkeys(FRICTION, "rad/s^2") | {
        "low": "rad", "high": "rad", "intervals": "1",
    }  # fmt: skip
    ranges: ClassVar[dict[str, tuple[float, float]]] = dict.fromkeys(
        ("low", "high"), (-0.5 * math.pi, 0.5 * math.pi)
    ) | {"intervals": (1.0, float(MOST))}  # fmt: skip
    acceleration = staticmethod(torque)

    def __post_init__(self) -> None:
        super().__post_init__()
        none_beyond(self, "intervals", FRICTION)
        rising(self)

    def values(self, form: Form) -> tuple[float, ...]:
        """Where the curve begins, and its numbers."""
        own = FRICTION[: int(self.intervals) + 1]
        return self.low, *numbers(self.high - self.low, tuple(float(getattr(self, name)) for name in own))
