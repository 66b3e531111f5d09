"""Tether: a cable or a safety string that pulls the block back once it leans further than its slack.

Adds        theta'' += -sign(theta) (k / I) max(|theta| - slack, 0), I about the edge of contact when upright
Parameters  slack [rad]; stiffness k [N m/rad], 0 where it is absent; side: +1 or -1 where it pulls from one side
            only, 0 on both
Use when    cables of instruments or a fall arrest may come taut
Limits      elastic and massless; the lever of the string is taken as constant
Source      Hooke's law
Status      loss of no energy, and the reach of a swing into the tether against the balance of energy (tests)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from rocking.effect import Effect
from rocking.form import Form


def pull(xp: Any, theta: Any, omega: Any, s: Any, base: Any, values: Any) -> Any:
    """Pull on the side to which the block leans [rad/s^2]; values = (slack, k/I to +x, k/I to -x)."""
    beyond = xp.maximum(xp.abs(theta) - values[0], 0.0)
    return xp.where(theta > 0.0, -values[1] * beyond, values[2] * beyond)


@dataclass(frozen=True)
class Tether(Effect):
    """String that pulls beyond its slack; slack [rad], stiffness [N m/rad], side +1, -1 or 0 (both)."""

    slack: float = 0.0
    stiffness: float = 0.0
    side: float = 0.0

    name: ClassVar[str] = "tether"
    units: ClassVar[dict[str, str]] = {"slack": "rad", "stiffness": "N m/rad", "side": "1"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {
        "slack": (0.0, 0.5 * math.pi),
        "stiffness": (0.0, math.inf),
        "side": (-1.0, 1.0),
    }
    acceleration = staticmethod(pull)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.side not in (-1.0, 0.0, 1.0):
            raise ValueError(f"tether.side={self.side!r}: want 1, -1 or 0 (both sides)")

    def values(self, form: Form) -> tuple[float, ...]:
        """(slack [rad], stiffness over inertia [1/s^2] to +x, the same to -x)."""
        rates = [self.stiffness / (form.mass * form.angular_inertia(s)) for s in (1.0, -1.0)]
        return self.slack, rates[0] * (self.side >= 0.0), rates[1] * (self.side <= 0.0)
