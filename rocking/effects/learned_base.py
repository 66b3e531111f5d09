"""Learned base: something that gives moves between the base sensor and the block, as a mode of its own.

Changes     the horizontal base motion: a_x + share y'', where y'' + 2 damping_ratio w y' + w^2 y = -a_x from rest,
            w = 2 pi frequency: with share 1 what a plate on springs makes of the acceleration that is recorded below
            it; with a small one below 0 what a table of a given force does on which something else of that frequency
            stands, -share / (1 - share) of all that moves, of what is recorded of its drive
Parameters  frequency [Hz], infinite where it is absent; damping_ratio [1]; share of the answer that is added [1]
Use when    the block stands on a plate, a pad or a frame that is not rigid, or the sensor is not where the block is;
            the table resonates
Limits      one mode, that the block does not pull at; nothing of a pitch or of vertical motion
Source      a single-degree-of-freedom oscillator, its answer exact for straight lines between samples: Nigam & Jennings
            (1969), Bull. Seismol. Soc. Am. 59, 909
Status      against its answer to a sinusoid, its equation under a record that begins and ends at once by another
            integrator, and the absent value (tests)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
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
    _, a_z = _inner(xp, t, par[:_split])
    return table_value(xp, t, par[_split:], 0.0), a_z


def answer(
    a: NDArray[np.float64], step: float, frequency: float, damping_ratio: float, own: int | None = None
) -> NDArray[np.float64]:
    """Acceleration of a plate on springs relative to what carries it [m/s^2], shape (time,), from rest.

    Args:
        a: acceleration of what carries it [m/s^2], shape (time,), straight between samples.
        step: between samples [s].
        frequency: of the plate [Hz].
        damping_ratio: over the critical one [1].
        own: after so many samples, with which it ends at once, it is at rest; all of them if not given.
    """
    from scipy.signal import lfilter

    lines, steps, c = _filters(step, frequency, damping_ratio)
    own = a.size if own is None else own
    after_jump = lfilter(steps, c, np.ones(a.size))
    # By itself the filter takes what it is given to come up from zero in the step before the first sample.
    goes_on = np.concatenate([a[:own], np.full(a.size - own, a[own - 1])]) - a[0]
    out = lfilter(lines, c, goes_on) + a[0] * after_jump
    out[own:] -= a[own - 1] * after_jump[1 : a.size - own + 1]
    return np.asarray(out)


@lru_cache(maxsize=256)  # a fit asks for one plate under many records
def _filters(step: float, frequency: float, damping_ratio: float) -> tuple[NDArray[np.float64], ...]:
    """Numerators for straight lines and for steps between samples, and their denominator."""
    from scipy.signal import cont2discrete

    w = 2.0 * math.pi * frequency
    relative = ([-1.0, 0.0, 0.0], [1.0, 2.0 * damping_ratio * w, w * w])
    lines, c, _ = cont2discrete(relative, step, method="foh")
    steps, _, _ = cont2discrete(relative, step, method="zoh")
    return np.ravel(lines), np.ravel(steps), np.asarray(c)


@dataclass(frozen=True)
class LearnedBase(Effect):
    """A plate between the base sensor and the block, or the like: its frequency [Hz] and damping ratio [1].

    share: of its answer that is added [1].
    """

    frequency: float = math.inf
    damping_ratio: float = 0.05
    share: float = 1.0

    name: ClassVar[str] = "learned_base"
    units: ClassVar[dict[str, str]] = {"frequency": "Hz", "damping_ratio": "1", "share": "1"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {
        "frequency": (0.01, 1e4), "damping_ratio": (0.0, 10.0), "share": (-10.0, 10.0),
    }  # fmt: skip
    rank: ClassVar[int] = 3  # pitch and vertical motion are those of the table below it

    def base_motion(self, motion: BaseMotion, span: tuple[float, float], g: float) -> BaseMotion:
        """The motion of the plate."""
        if math.isinf(self.frequency) or self.share == 0.0:
            return motion
        start, step, a_x, own = samples_of(motion, span)
        count = max(1, math.ceil(step * self.frequency * FINER))
        finer, own = step / count, count * (own - 1) + 1
        t = start + finer * np.arange(count * (a_x.size - 1) + 1)
        if count > 1:
            a_x = motion.kernel(np, t, np.asarray(motion.parameters, dtype=np.float64))[0] + np.zeros(t.size)
        # That of the plate itself goes on smoothly where the motion jumps, as where a record begins or ends.
        moves = a_x + self.share * answer(a_x, finer, self.frequency, self.damping_ratio, own)
        numbers = table(span, start, finer, moves, part=slice(own))
        label = f"a plate of {self.frequency:g} Hz, damping ratio {self.damping_ratio:g}"
        label += "" if self.share == 1.0 else f", {self.share:g} of its answer"
        return AlteredMotion(motion, numbers, kernel=_on_springs, max_step=finer, label=label)
