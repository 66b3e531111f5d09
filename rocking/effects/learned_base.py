"""Learned base: something that gives lies between the base sensor and the block, as a mode of its own.

Changes     the horizontal base motion: a_x + y'', where y'' + 2 damping_ratio w y' + w^2 y = -a_x from rest,
            w = 2 pi frequency: what a plate on springs makes of the acceleration that is recorded below it
Parameters  frequency [Hz], infinite where it is absent; damping_ratio [1]
Use when    the block stands on a plate, a pad or a frame that is not rigid, or the sensor is not where the block is
Limits      one mode, that the block does not pull at; nothing of a pitch or of vertical motion
Source      a single-degree-of-freedom oscillator, its answer exact for straight lines between samples: Nigam & Jennings
            (1969), Bull. Seismol. Soc. Am. 59, 909
Status      against its answer to a sinusoid, and the absent value (tests)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from rocking.altered import AlteredMotion, samples_of, table, table_value
from rocking.effect import Effect
from rocking.motion import BaseMotion

FINER = 16
"""Samples in a period of the mode at the least: its answer is a cubic between them."""

_inner: Any = None
_split: Any = None


def _on_springs(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    a_x, a_z = _inner(xp, t, par[:_split])
    return a_x + table_value(xp, t, par[_split:], 0.0), a_z


def answer(a: NDArray[np.float64], step: float, frequency: float, damping_ratio: float) -> NDArray[np.float64]:
    """Acceleration of a plate on springs relative to what carries it [m/s^2], shape (time,), from rest.

    Args:
        a: acceleration of what carries it [m/s^2], shape (time,), straight between samples.
        step: between samples [s].
        frequency: of the plate [Hz].
        damping_ratio: over the critical one [1].
    """
    from scipy.signal import cont2discrete, lfilter

    w = 2.0 * math.pi * frequency
    relative = ([-1.0, 0.0, 0.0], [1.0, 2.0 * damping_ratio * w, w * w])
    b, c, _ = cont2discrete(relative, step, method="foh")
    return np.asarray(lfilter(np.ravel(b), c, a))


@dataclass(frozen=True)
class LearnedBase(Effect):
    """A plate between the base sensor and the block: its frequency [Hz] and damping ratio [1]."""

    frequency: float = math.inf
    damping_ratio: float = 0.05

    name: ClassVar[str] = "learned_base"
    units: ClassVar[dict[str, str]] = {"frequency": "Hz", "damping_ratio": "1"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"frequency": (0.01, 1e4), "damping_ratio": (0.0, 10.0)}
    rank: ClassVar[int] = 1

    def base_motion(self, motion: BaseMotion, span: tuple[float, float], g: float) -> BaseMotion:
        """The motion of the plate."""
        if math.isinf(self.frequency):
            return motion
        start, step, a_x = samples_of(motion, span)
        count = max(1, math.ceil(step * self.frequency * FINER))
        finer = step / count
        t = start + finer * np.arange(count * (a_x.size - 1) + 1)
        if count > 1:
            a_x = motion.kernel(np, t, np.asarray(motion.parameters, dtype=np.float64))[0] + np.zeros(t.size)
        added = answer(a_x, finer, self.frequency, self.damping_ratio)
        label = f"a plate of {self.frequency:g} Hz, damping ratio {self.damping_ratio:g}"
        return AlteredMotion(motion, table(span, start, finer, added), kernel=_on_springs, max_step=finer, label=label)
