"""The ramped sinusoid: a horizontal sine whose amplitude grows linearly with time.

    a_x(t) = E(t) sin(2 pi f t + phase),   E(t) = A min(t / T, 1) (1 + r(t)) c(t),   0 <= t <= T + hold + taper

The amplitude may be held for a while after the ramp and then taken back to zero by c(t), half a cosine wave; without
hold and taper the base is at rest after T.

Source   base motion of the shaking-table tests of Winkler, Meguro & Yamazaki (1995), section "Shaking table
         experiments"; the departure r(t) stands for their remark (section "The effect of slenderness") that a constant
         slope of the envelope could not be kept.
Status   the paper prints no value for A, T or the size of the departure, so r = 0 unless it is asked for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from excitation.checks import finite, not_negative, positive, real, whole
from excitation.envelopes import MAX_IMPERFECTION, departure, falling
from excitation.motion import Motion


def _envelope(xp: Any, t: Any, par: Any) -> Any:
    """Envelope [m/s^2] of the sine at t; par = [omega, phase, rate, T, (amplitude, omega, phase) ..., hold, taper]."""
    departure = 0.0 * t
    for i in range(4, len(par) - 2, 3):
        departure = departure + par[i] * xp.cos(par[i + 1] * t + par[i + 2])
    hold_end = par[3] + par[-2]
    inside = (t >= 0.0) & (t <= hold_end + par[-1])
    ramp = par[2] * xp.minimum(t, par[3]) * (1.0 + departure)
    return xp.where(inside, ramp * falling(xp, t, hold_end, par[-1]), 0.0)


def _acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """Base acceleration (a_x, a_z) [m/s^2] at t."""
    return _envelope(xp, t, par) * xp.sin(par[0] * t + par[1]), 0.0 * t


@dataclass(frozen=True)
class RampedSinusoid(Motion):
    """A sine whose amplitude grows linearly from zero to `final_amplitude` in `duration`.

    Args:
        frequency: f [Hz], positive.
        duration: T [s], positive; the base is at rest after it.
        final_amplitude: A [m/s^2], positive: the envelope at T.
        phase: phase of the sine [rad].
        imperfection: size of the smooth random departure of the envelope, as its rms share of the straight
            line (and of the held one) until the end; 0 (off) to 0.25.
        seed: seed of the departure, a whole number, 0 or more; the same seed gives the same motion.
        hold: time [s] for which the final amplitude is kept after the ramp.
        taper: time [s] in which it then goes back to zero.
        imperfection_period: shortest period [s] in the departure; `duration / 10` if not given.

    Raises:
        ValueError: an argument is out of the range above.
    """

    frequency: float
    duration: float
    final_amplitude: float
    phase: float = 0.0
    imperfection: float = 0.0
    seed: int = 0
    imperfection_period: float | None = None
    hold: float = 0.0
    taper: float = 0.0

    kernel = staticmethod(_acceleration)

    def __post_init__(self) -> None:
        for name, unit in (("frequency", "Hz"), ("duration", "s"), ("final_amplitude", "m/s^2")):
            positive(name, getattr(self, name), unit)
        finite("phase", self.phase, "rad")
        if not 0.0 <= real(self.imperfection) <= MAX_IMPERFECTION:
            raise ValueError(f"imperfection={self.imperfection!r}: want 0 to {MAX_IMPERFECTION}")
        whole("seed", self.seed, 0)
        not_negative("hold", self.hold, "s")
        not_negative("taper", self.taper, "s")
        period = self.imperfection_period
        if period is not None and not 0.0 < real(period) <= self.duration:
            raise ValueError(f"imperfection_period={period!r} s: want above 0 and at most the duration")

    @cached_property
    def _departure(self) -> NDArray[np.float64]:
        """Cosines of r(t): rows of amplitude, angular frequency, phase; none when the envelope is straight."""
        if self.imperfection == 0.0:
            return np.empty((0, 3))
        shortest = self.imperfection_period or self.duration / 10.0
        return departure(self.imperfection, shortest, self.end, self.seed)

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        rate = self.final_amplitude / self.duration
        head = [2.0 * math.pi * self.frequency, self.phase, rate, self.duration]
        return np.concatenate([head, self._departure.ravel(), [self.hold, self.taper]])

    @property
    def end(self) -> float:
        """Time [s] after which the base is at rest."""
        return self.duration + self.hold + self.taper

    @property
    def ramped_sine(self) -> tuple[float, float, float, float] | None:
        """(omega, phase, rate, duration) in SI units for closed forms; None unless the ramp is all there is."""
        if self.imperfection > 0.0 or self.hold > 0.0 or self.taper > 0.0:
            return None
        rate = self.final_amplitude / self.duration
        return (2.0 * math.pi * self.frequency, self.phase, rate, self.duration)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return tuple(sorted({0.0, self.duration, self.duration + self.hold, self.end}))

    @property
    def max_step(self) -> float:
        return 0.05 / self.frequency

    def envelope(self, t: ArrayLike) -> NDArray[np.float64]:
        """Amplitude E(t) [m/s^2] of the sine, any shape; zero before 0 and after `end`."""
        return np.asarray(_envelope(np, np.asarray(t, dtype=np.float64), self.parameters))
