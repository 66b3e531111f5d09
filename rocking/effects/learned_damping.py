"""Learned damping: a torque along the speed by any curve of the rotation, where no effect with a name explains it.

Adds        theta'' += omega d(|theta|), d a natural cubic spline over equal intervals from upright to its reach, beyond
            which it keeps its last value; alike on both sides
Parameters  reach, where d ends [rad]; intervals, 1 to `MOST` [1]; damping_0 ..., coefficients of d [1/s], one more than
            there are intervals, as those of `rocking.effects.learned_curve`; below zero they damp; 0 where absent
Use when    what is lost along the way depends on where the block is: air squeezed out near upright, a pad, a guide
Limits      no memory; what is narrower than an interval is smeared over it
Source      as `rocking.effects.learned_curve`
Status      a constant curve against viscous damping, SciPy's splines by way of the curve, and the absent value (tests)
"""

from __future__ import annotations

import math
from typing import Any, ClassVar

from rocking.effects.learned_curve import MOST, curve, none_beyond, numbers, tabulated
from rocking.form import Form

DAMPING = tuple(f"damping_{j}" for j in range(MOST + 1))
"""Names of the coefficients."""


def torque(xp: Any, theta: Any, omega: Any, s: Any, base: Any, values: Any) -> Any:
    """The curve at this rotation times the angular velocity [rad/s^2]."""
    return omega * curve(xp, xp.abs(theta), values, 0)


_FIELDS: list[tuple[str, float]] = [("reach", 1.0), ("intervals", float(MOST)), *((name, 0.0) for name in DAMPING)]

_Coefficients: Any = tabulated(_FIELDS)


class LearnedDamping(_Coefficients):
    """A curve: where it ends [rad], its intervals and its coefficients [1/s]."""

    name: ClassVar[str] = "learned_damping"
    units: ClassVar[dict[str, str]] = dict.fromkeys(DAMPING, "1/s") | {"reach": "rad", "intervals": "1"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {
        "reach": (1e-6, 0.5 * math.pi),
        "intervals": (1.0, float(MOST)),
    }
    acceleration = staticmethod(torque)

    def __post_init__(self) -> None:
        super().__post_init__()
        none_beyond(self, "intervals", DAMPING)

    def values(self, form: Form) -> tuple[float, ...]:
        """The numbers of the curve."""
        own = DAMPING[: int(self.intervals) + 1]
        return numbers(self.reach, tuple(float(getattr(self, name)) for name in own))
