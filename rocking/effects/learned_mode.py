"""Learned mode: a mass that swings inside of the block, where no effect with a name explains a measurement.

Adds        a mass mass_ratio m, part of the block's own m, at a height height_ratio H over the base on a spring and a
            dashpot, or on an arm: natural frequency and damping ratio are those with the block held
            (`rocking.inner_mass`)
Parameters  mass_ratio [1], 0 where absent; height_ratio [1], over the height of the centre of mass; frequency [Hz];
            damping_ratio [1]; hanging [1], share of its stiffness that is a pendulum's: 0 for a spring along the base,
            1 for a mass that hangs, which turns by what its arm of g / (2 pi f)^2 lets it; apart [1], share of the mass
            that centre and inertia of the block leave out, held in its middle place: 0 where the block was weighed
            with what is in it, 1 where they are those of the block without
Use when    what is left goes on in time with itself from swing to swing: contents that sway, a part that hangs, a
            liquid, a block that bends.  What hangs and swings far is no linear mode
Limits      one mode, and no stop to it; it goes with effects on form, flow and impact, and not with a
            floor that gives or other modes
Source      two bodies and a spring; `rocking.inner_mass`
Status      MuJoCo within a swing, on a slide and on a hinge, and the absent value (tests)
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from rocking.composed import ComposedMethod1
from rocking.effect import Effect
from rocking.form import Form
from rocking.hybrid import System
from rocking.inner_mass import BlockWithInnerMass


@dataclass(frozen=True)
class LearnedMode(Effect):
    """Mass [1] and height [1] over those of the block and its centre of mass, frequency [Hz], damping ratio [1], how
    far it hangs [1] and how much of it was left out [1]."""

    mass_ratio: float = 0.0
    height_ratio: float = 1.0
    frequency: float = 1.0
    damping_ratio: float = 0.05
    hanging: float = 0.0
    apart: float = 0.0

    name: ClassVar[str] = "learned_mode"
    units: ClassVar[dict[str, str]] = {
        "mass_ratio": "1",
        "height_ratio": "1",
        "frequency": "Hz",
        "damping_ratio": "1",
        "hanging": "1",
        "apart": "1",
    }
    ranges: ClassVar[dict[str, tuple[float, float]]] = {
        "mass_ratio": (0.0, 0.5),
        "height_ratio": (0.0, 10.0),
        "frequency": (1e-6, 1e6),
        "damping_ratio": (0.0, 1e6),
        "hanging": (0.0, 1.0),
        "apart": (0.0, 1.0),
    }

    def freedoms(self, system: ComposedMethod1) -> System:
        """The block with place and velocity of the mass as states."""
        form, height = system.form, self.height_ratio * system.form.mass_height
        if self.apart > 0.0:
            system = replace(system, form=_with_mass(form, self.apart * self.mass_ratio, height))
        return BlockWithInnerMass(system, self.mass_ratio, height, self.frequency, self.damping_ratio, self.hanging)


def _with_mass(form: Form, share: float, height: float) -> Form:
    """The form of a block of which all but this share is as the form says, and that in the middle at this height."""
    centre, offset = (1.0 - share) * form.mass_height + share * height, (1.0 - share) * form.offset
    rest = (1.0 - share) * (form.rho2 + form.mass_height**2 + form.offset**2)
    rho2 = rest + share * height**2 - centre**2 - offset**2
    return form.edited(mass_height=centre, offset=offset, inertia=form.mass * rho2)
