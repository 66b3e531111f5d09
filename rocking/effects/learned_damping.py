"""Learned damping: a torque along the speed by any curve of the rotation, where no effect with a name explains it.

Adds        theta'' += omega d, d a natural cubic spline over equal intervals, beyond whose ends it keeps its last
            values: of |theta| from upright to its reach, alike on both sides, where low is 0; of theta from low to its
            reach, each side its own, where low is below 0
Parameters  low and reach, where d begins and ends [rad]; intervals, 1 to `MOST` [1]; damping_0 ..., coefficients of d
            [1/s], one more than there are intervals, as those of `rocking.effects.learned_curve`; below zero they damp;
            0 where absent
Use when    what is lost along the way depends on where the block is: air squeezed out near upright, a pad, a guide, a
            brake that is passed on one side
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
    low = values[0]
    return omega * curve(xp, xp.where(low < 0.0, theta - low, xp.abs(theta)), values, 1)


_FIELDS: list[tuple[str, float]] = [
    ("low", 0.0), ("reach", 1.0), ("intervals", float(MOST)), *((name, 0.0) for name in DAMPING),
]  # fmt: skip

_Coefficients: Any = tabulated(_FIELDS)


class LearnedDamping(_Coefficients):
    """A curve: where it begins and ends [rad], its intervals and its coefficients [1/s]."""

    name: ClassVar[str] = "learned_damping"
    units: ClassVar[dict[str, str]] = dict.fromkeys(DAMPING, "1/s") | {"low": "rad", "reach": "rad", "intervals": "1"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {
        "low": (-0.5 * math.pi, 0.0),
        "reach": (1e-6, 0.5 * math.pi),
        "intervals": (1.0, float(MOST)),
    }
    acceleration = staticmethod(torque)

    def __post_init__(self) -> None:
        super().__post_init__()
        none_beyond(self, "intervals", DAMPING)

    def values(self, form: Form) -> tuple[float, ...]:
        """Where the curve begins, and its numbers."""
        own = DAMPING[: int(self.intervals) + 1]
        coefficients = tuple(float(getattr(self, name)) for name in own)
        return self.low, *numbers(self.reach - self.low, coefficients)
