"""The pitching sinusoid: the base turns to and fro, with an amplitude that is even or grows linearly.

    pitch(t) = A g(t) w(t) sin(2 pi f t + phase),   0 <= t <= duration;   g = 1, or t/duration if growing

w rises and falls by half cosine waves, so that neither the angle nor its rate jumps, whatever the phase; the pitch
acceleration is the exact second derivative.

Source   elementary calculus; the window is that of `excitation.steady_sinusoid`.
Status   the second derivative is checked by integration.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from excitation.checks import finite, not_zero, positive
from excitation.envelopes import modulated, window_rates
from excitation.motion import Motion
from excitation.steady_sinusoid import check_tapers, taper_breakpoints


def _still(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z): none."""
    return 0.0 * t, 0.0 * t


def _pitch(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(pitch [rad], its acceleration [rad/s^2]) at t; par = [A, omega, phase, duration, rise, fall, even, rate]."""
    w, w1, w2 = window_rates(xp, t, par[3], par[4], par[5])
    g, g1 = par[6] + par[7] * t, par[7]
    envelope = (par[0] * g * w, par[0] * (g1 * w + g * w1), par[0] * (2.0 * g1 * w1 + g * w2))
    return modulated(xp, envelope, (par[1] * t + par[2], par[1], 0.0))


@dataclass(frozen=True)
class SinusoidalPitch(Motion):
    """A base that pitches sinusoidally and does nothing else; see `Combined` for more.

    Args:
        frequency: f [Hz], positive.
        amplitude: A [rad], not zero; clockwise positive.
        duration: [s], positive, both tapers in it.
        phase: phase of the sine [rad].
        growing: whether the amplitude grows linearly from zero to A at the end.
        taper_in, taper_out: times [s], positive, in which the pitch sets in and goes; one period each, or half of the
            duration if that is less, if not given.

    Raises:
        ValueError: an argument is out of the range above, or the tapers are longer than the duration.
    """

    frequency: float
    amplitude: float
    duration: float
    phase: float = 0.0
    growing: bool = False
    taper_in: float | None = None
    taper_out: float | None = None

    kernel = staticmethod(_still)
    pitch_kernel = staticmethod(_pitch)

    def __post_init__(self) -> None:
        positive("frequency", self.frequency, "Hz")
        not_zero("amplitude", self.amplitude, "rad")
        positive("duration", self.duration, "s")
        finite("phase", self.phase, "rad")
        for name in ("taper_in", "taper_out"):
            if getattr(self, name) is not None:
                positive(name, getattr(self, name), "s")
        check_tapers(*self.tapers, self.duration)

    @property
    def tapers(self) -> tuple[float, float]:
        """Times [s] in which the pitch sets in and goes."""
        usual = min(1.0 / self.frequency, 0.5 * self.duration)
        return tuple(usual if t is None else t for t in (self.taper_in, self.taper_out))  # type: ignore[return-value]

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        growth = (0.0, 1.0 / self.duration) if self.growing else (1.0, 0.0)
        omega = 2.0 * math.pi * self.frequency
        return np.array([self.amplitude, omega, self.phase, self.duration, *self.tapers, *growth])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return taper_breakpoints(*self.tapers, self.duration)

    @property
    def max_step(self) -> float:
        return min(0.05 / self.frequency, *self.tapers)
