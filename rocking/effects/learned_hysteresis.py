"""Learned hysteresis: a torque that lags behind the rotation, where no effect with a name explains a measurement.

Adds        a torque -stiffness z, z' = omega - |omega| (z/width) |z/width|^(exponent - 1) - z / time
            (`rocking.hysteretic`)
Parameters  stiffness [N m/rad], 0 where absent; width [rad], infinite where it never slips; time [s], infinite where it
            never relaxes; strained [1], the share of the strain of a slow pull to the lean that a released block has;
            exponent [1], 1 or more, the sharper the knee of its curve the more
Use when    what is left depends on the way to a rotation and not on the rotation alone: a layer that shears and slips,
            cables that rub, a pad that creeps
Limits      one element; it goes with effects on form, flow and impact, and not with a floor that gives or other modes
Source      Dahl (1968), TOR-0158(3107-18)-1, The Aerospace Corporation; Wen (1976), J. Eng. Mech. Div. ASCE 102,
            249-263, of the exponent; Maxwell (1867), Phil. Trans. R. Soc. 157, 49-88
Status      Dahl's curve, that of an exponent of two, another integrator, and the absent value (tests)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from rocking.composed import ComposedMethod1
from rocking.effect import Effect
from rocking.hybrid import System
from rocking.hysteretic import HystereticBlock


@dataclass(frozen=True)
class LearnedHysteresis(Effect):
    """Stiffness [N m/rad], width [rad], time [s] and exponent [1] of what yields, and its strain at a release [1]."""

    stiffness: float = 0.0
    width: float = math.inf
    time: float = math.inf
    strained: float = 0.0
    exponent: float = 1.0

    name: ClassVar[str] = "learned_hysteresis"
    units: ClassVar[dict[str, str]] = {
        "stiffness": "N m/rad",
        "width": "rad",
        "time": "s",
        "strained": "1",
        "exponent": "1",
    }
    ranges: ClassVar[dict[str, tuple[float, float]]] = {
        "stiffness": (0.0, 1e12),
        "width": (1e-9, 1e9),
        "time": (1e-9, 1e9),
        "strained": (0.0, 1.0),
        "exponent": (1.0, 100.0),
    }

    def freedoms(self, system: ComposedMethod1) -> System:
        """The block with the strain as a state."""
        slips, creeps = 1.0 / self.width, 1.0 / self.time
        return HystereticBlock(system, self.stiffness, slips, creeps, self.strained, self.exponent)
