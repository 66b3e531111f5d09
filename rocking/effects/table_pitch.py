"""Table pitch: the table rotates a little as it shakes.

Adds        pitch = per_acceleration a_x + per_displacement d_x, with its acceleration, about the middle of where the
            block stands; positive as the block's rotation
Parameters  per_acceleration [rad/(m/s^2)], per_displacement [rad/m]; 0 where they are absent
Use when    a table has a compliant guide, an overturning moment of its own, or a guide that is not straight
Limits      quasi-static: in phase at all frequencies.  The acceleration behind per_acceleration is low-passed at 25 Hz,
            as its second derivative would be noise; displacement is the record integrated twice above 0.1 Hz, so
            that a drift of the record within some seconds is taken for a displacement
Source      own derivation of what a pitch does to a block: `rocking.composed`
Status      pitch of a sinusoid and its acceleration against their formulas (tests)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from rocking.altered import AlteredMotion, moving_part, samples_of, table, table_value
from rocking.effect import Effect
from rocking.motion import BaseMotion

LOW_PASS = 25.0
"""Frequency [Hz] at which the acceleration behind the pitch is passed by half; eighth order."""

HIGH_PASS = 0.1
"""Frequency [Hz] at which the displacement is passed by half; fourth order."""

_inner_pitch: Any = None
_split: Any = None


def _with_table(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    angle, acceleration = _inner_pitch(xp, t, par[:_split])
    numbers = par[_split:]
    return angle + table_value(xp, t, numbers, 0.0), acceleration + table_value(xp, t, numbers, 1.0)


def filtered(a: NDArray[np.float64], step: float) -> tuple[NDArray[np.float64], ...]:
    """(low-passed acceleration, its second derivative, displacement) of the samples, shape (time,) each.

    Acausal, by sines over the length of the samples: beyond its ends the motion goes on as its own image in the end
    point, so that neither a velocity that is left there nor a sample other than zero sets anything ringing.
    """
    from scipy.fft import dst, idst

    part = moving_part(a)
    whole, a = np.zeros((3, a.size)), a[part]
    inner, line = slice(1, -1), np.linspace(a[0], a[-1], a.size)
    f = 0.5 * np.arange(1, a.size - 1) / ((a.size - 1) * step)
    omega2 = (2.0 * np.pi * f) ** 2
    low = dst((a - line)[inner], 1) / (1.0 + (f / LOW_PASS) ** 8)
    high = 1.0 / (1.0 + (HIGH_PASS / f) ** 4)
    smooth, curvature, displacement = whole[:, part]
    smooth[:] = line
    smooth[inner] += idst(low, 1)
    curvature[inner] = idst(-omega2 * low, 1)
    displacement[inner] = idst(-dst(a[inner], 1) * high / omega2, 1)
    return tuple(whole)


@dataclass(frozen=True)
class TablePitch(Effect):
    """Pitch of the table with its acceleration [rad/(m/s^2)] and with its displacement [rad/m]."""

    per_acceleration: float = 0.0
    per_displacement: float = 0.0

    name: ClassVar[str] = "table_pitch"
    units: ClassVar[dict[str, str]] = {"per_acceleration": "rad/(m/s^2)", "per_displacement": "rad/m"}
    rank: ClassVar[int] = 2

    def base_motion(self, motion: BaseMotion, span: tuple[float, float], g: float) -> BaseMotion:
        """The motion with the pitch added."""
        start, step, a_x, own = samples_of(motion, span)
        a_x = a_x[:own]
        smooth, curvature, displacement = filtered(a_x, step)
        angle = self.per_acceleration * smooth + self.per_displacement * displacement
        acceleration = self.per_acceleration * curvature + self.per_displacement * a_x
        numbers = table(span, start, step, angle, acceleration, part=moving_part(a_x))
        label = f"pitch {self.per_acceleration:g} rad/(m/s^2), {self.per_displacement:g} rad/m"
        return AlteredMotion(motion, numbers, pitch=_with_table, max_step=step, label=label)
