"""Learned mode: a mass that swings inside of the block, where no effect with a name explains a measurement.

Adds        a mass mass_ratio m, part of the block's own m, at a height height_ratio H over the base on a spring and a
            dashpot: natural frequency and damping ratio are those with the block held (`rocking.inner_mass`)
Parameters  mass_ratio [1], 0 where absent; height_ratio [1], over the height of the centre of mass; frequency [Hz];
            damping_ratio [1]
Use when    what is left goes on in time with itself from swing to swing: contents that sway, a part that hangs, a
            liquid, a block that bends
Limits      one mode, along the base, and no stop to it; it goes with effects on form, flow and impact, and not with a
            floor that gives or other modes
Source      two bodies and a spring; `rocking.inner_mass`
Status      MuJoCo within a swing, and the absent value (tests)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from rocking.composed import ComposedMethod1
from rocking.effect import Effect
from rocking.hybrid import System
from rocking.inner_mass import BlockWithInnerMass


@dataclass(frozen=True)
class LearnedMode(Effect):
    """Mass [1] and height [1] over those of the block and its centre of mass, frequency [Hz] and damping ratio [1]."""

    mass_ratio: float = 0.0
    height_ratio: float = 1.0
    frequency: float = 1.0
    damping_ratio: float = 0.05

    name: ClassVar[str] = "learned_mode"
    units: ClassVar[dict[str, str]] = {
        "mass_ratio": "1",
        "height_ratio": "1",
        "frequency": "Hz",
        "damping_ratio": "1",
    }
    ranges: ClassVar[dict[str, tuple[float, float]]] = {
        "mass_ratio": (0.0, 0.5),
        "height_ratio": (0.0, 10.0),
        "frequency": (1e-6, 1e6),
        "damping_ratio": (0.0, 1e6),
    }

    def freedoms(self, system: ComposedMethod1) -> System:
        """The block with place and velocity of the mass as states."""
        height = self.height_ratio * system.form.mass_height
        return BlockWithInnerMass(system, self.mass_ratio, height, self.frequency, self.damping_ratio)
