"""The ramped sinusoid: a horizontal sine whose amplitude grows linearly with time.

    a_x(t) = E(t) sin(2 pi f t + phase),   E(t) = A (t / T) (1 + r(t)),   0 <= t <= T;   0 outside

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

from excitation.motion import Motion

DEPARTURE_TERMS = 8
"""Number of cosines that make up the departure of the envelope."""

MAX_IMPERFECTION = 0.25
"""Largest admissible size; the departure's peaks are two to three times it, and the envelope stays positive."""


def _envelope(xp: Any, t: Any, par: Any) -> Any:
    """Envelope [m/s^2] of the sine at t; par = [omega, phase, rate, duration, (amplitude, omega, phase) ...]."""
    departure = 0.0 * t
    for i in range(4, len(par), 3):
        departure = departure + par[i] * xp.cos(par[i + 1] * t + par[i + 2])
    inside = (t >= 0.0) & (t <= par[3])
    return xp.where(inside, par[2] * t * (1.0 + departure), 0.0)


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
            line over the duration; 0 (off) to 0.25.
        seed: seed of the departure; the same seed gives the same motion.
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

    kernel = staticmethod(_acceleration)

    def __post_init__(self) -> None:
        for name, unit in (("frequency", "Hz"), ("duration", "s"), ("final_amplitude", "m/s^2")):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{name}={value!r} {unit}: want a positive number")
        if not math.isfinite(self.phase):
            raise ValueError(f"phase={self.phase!r} rad: want a finite number")
        if not 0.0 <= self.imperfection <= MAX_IMPERFECTION:
            raise ValueError(f"imperfection={self.imperfection!r}: want 0 to {MAX_IMPERFECTION}")
        period = self.imperfection_period
        if period is not None and not 0.0 < period <= self.duration:
            raise ValueError(f"imperfection_period={period!r} s: want above 0 and at most the duration")

    @cached_property
    def _departure(self) -> NDArray[np.float64]:
        """Cosines of r(t): rows of amplitude, angular frequency, phase; none when the envelope is straight."""
        if self.imperfection == 0.0:
            return np.empty((0, 3))
        rng = np.random.default_rng(self.seed)
        shortest = self.imperfection_period or self.duration / 10.0
        t = np.linspace(0.0, self.duration, 4001)
        rows = np.ones((DEPARTURE_TERMS, 3))
        while True:
            rows[:, 1] = 2.0 * math.pi * rng.uniform(0.0, 1.0 / shortest, DEPARTURE_TERMS)
            rows[:, 2] = rng.uniform(0.0, 2.0 * math.pi, DEPARTURE_TERMS)
            r = np.cos(rows[:, 1, None] * t + rows[:, 2, None]).sum(axis=0)
            # Random phases give the stated rms on average only: scale this draw to have it exactly, and draw
            # again in the rare case that the envelope would turn negative somewhere.
            amplitude = self.imperfection / math.sqrt(float(np.mean(r * r)))
            if np.min(1.0 + amplitude * r) > 0.0:
                break
        rows[:, 0] = amplitude
        return rows

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        rate = self.final_amplitude / self.duration
        head = [2.0 * math.pi * self.frequency, self.phase, rate, self.duration]
        return np.concatenate([head, self._departure.ravel()])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return (0.0, self.duration)

    @property
    def max_step(self) -> float:
        return 0.05 / self.frequency

    def envelope(self, t: ArrayLike) -> NDArray[np.float64]:
        """Amplitude E(t) [m/s^2] of the sine, any shape; zero outside 0 to `duration`."""
        return np.asarray(_envelope(np, np.asarray(t, dtype=np.float64), self.parameters))
