"""Learned term: what is left when no effect with a name explains a measurement.

Adds        theta'' += bias + side s + spring theta + cubic theta^3 + friction f(omega) + damping omega
            + side_damping s omega + drag |omega| omega + cubic_damping omega^3 + base a_x
            + structural |theta| f(omega) + side_friction s f(omega) + outward s |omega|,
            f(omega) = omega / sqrt(omega^2 + 0.00003^2);
            e += restitution_side s + restitution_speed |omega| + restitution_square omega^2
Parameters  coefficients of these terms, in SI units of an angular acceleration or of restitution; 0 where absent
Use when    a term is wanted that says how the residual looks, not what it comes from
Limits      no memory and no further freedom; outside of what was measured it says nothing
Source      a small expansion in the state, as in the identification of nonlinear systems from residuals
Status      each term against its formula, and the absent value (tests)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from rocking.effect import Effect
from rocking.form import Form

SMOOTH = 3e-5
"""Angular speed [rad/s] over which friction changes sign.

What friction would hold creeps: at no more than this speed where less than 0.7 of it pushes, faster only near all of
it.  Smoothed over 0.001 rad/s, shaken records of a block that a guide rubs (0.37 rad/s^2) were missed by 3 and 4.4
times a noise of 3e-4 rad.
"""


def torque(xp: Any, theta: Any, omega: Any, s: Any, base: Any, values: Any) -> Any:
    """The expansion in rotation, speed, side and base motion [rad/s^2]."""
    rest = values[0] + values[1] * s + values[2] * theta + values[3] * theta * theta * theta + values[9] * base.a_x
    friction = values[4] + values[13] * xp.abs(theta) + values[14] * s
    rubbing = friction * omega / xp.sqrt(omega * omega + SMOOTH * SMOOTH)
    speed = values[5] + values[6] * s + values[7] * xp.abs(omega) + values[8] * omega * omega
    return rest + rubbing + speed * omega + values[15] * s * xp.abs(omega)


def loss(xp: Any, e: Any, omega: Any, s: Any, values: Any) -> Any:
    """The expansion of restitution in side and speed [1]."""
    return e + values[10] * s + values[11] * xp.abs(omega) + values[12] * omega * omega


@dataclass(frozen=True)
class LearnedTerm(Effect):
    """Coefficients of a small expansion of torque and restitution."""

    bias: float = 0.0
    side: float = 0.0
    spring: float = 0.0
    cubic: float = 0.0
    friction: float = 0.0
    damping: float = 0.0
    side_damping: float = 0.0
    drag: float = 0.0
    cubic_damping: float = 0.0
    base: float = 0.0
    restitution_side: float = 0.0
    restitution_speed: float = 0.0
    restitution_square: float = 0.0
    structural: float = 0.0
    side_friction: float = 0.0
    outward: float = 0.0

    name: ClassVar[str] = "learned_term"
    units: ClassVar[dict[str, str]] = {
        "bias": "rad/s^2",
        "side": "rad/s^2",
        "spring": "1/s^2",
        "cubic": "1/(rad^2 s^2)",
        "friction": "rad/s^2",
        "damping": "1/s",
        "side_damping": "1/s",
        "drag": "1/rad",
        "cubic_damping": "s/rad^2",
        "base": "rad/m",
        "restitution_side": "1",
        "restitution_speed": "s/rad",
        "restitution_square": "s^2/rad^2",
        "structural": "1/s^2",
        "side_friction": "rad/s^2",
        "outward": "1/s",
    }
    acceleration = staticmethod(torque)
    restitution = staticmethod(loss)

    def strikes(self) -> bool:
        """With any of its coefficients of restitution."""
        return (self.restitution_side, self.restitution_speed, self.restitution_square) != (0.0, 0.0, 0.0)

    def values(self, form: Form) -> tuple[float, ...]:
        """The coefficients in the order of the fields."""
        return tuple(float(getattr(self, name)) for name in self.parameter_names())
