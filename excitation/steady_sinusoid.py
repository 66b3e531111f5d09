"""The steady sinusoid: a horizontal sine of one amplitude, taken up and taken back smoothly.

    a_x(t) = A w(t) sin(2 pi f t + phase),   0 <= t <= duration;   w rises and falls by half cosine waves

Source   textbook base motion of a sine-dwell test; the tapers are those of a Tukey window (Harris 1978).
Status   a plain sine from 0 to `duration` when neither taper is given.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from excitation.checks import finite, not_negative, not_zero, positive
from excitation.envelopes import modulated, window, window_rates
from excitation.motion import Motion

ROUNDING = 1e-12
"""Share of the duration by which a sum of tapers that fit exactly may miss it: 0.1 + 0.2 > 0.3."""


def _acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z) [m/s^2] at t; par = [omega, phase, amplitude, duration, rise, fall]."""
    return par[2] * window(xp, t, par[3], par[4], par[5]) * xp.sin(par[0] * t + par[1]), 0.0 * t


def _snap(xp: Any, t: Any, par: Any) -> Any:
    """Second derivative of a_x [m/s^4] at t, where both tapers are there."""
    w, w1, w2 = window_rates(xp, t, par[3], par[4], par[5])
    return modulated(xp, (par[2] * w, par[2] * w1, par[2] * w2), (par[0] * t + par[1], par[0], 0.0))[1]


@dataclass(frozen=True)
class SteadySinusoid(Motion):
    """A sine of constant amplitude from 0 to `duration`.

    Args:
        frequency: f [Hz], positive.
        amplitude: A [m/s^2], not zero.
        duration: [s], positive, both tapers in it.
        phase: phase of the sine [rad].
        taper_in, taper_out: times [s] in which the amplitude rises and falls; none if zero.

    Raises:
        ValueError: an argument is out of the range above, or the tapers are longer than the duration.
    """

    frequency: float
    amplitude: float
    duration: float
    phase: float = 0.0
    taper_in: float = 0.0
    taper_out: float = 0.0

    kernel = staticmethod(_acceleration)

    def __post_init__(self) -> None:
        positive("frequency", self.frequency, "Hz")
        not_zero("amplitude", self.amplitude, "m/s^2")
        positive("duration", self.duration, "s")
        finite("phase", self.phase, "rad")
        check_tapers(self.taper_in, self.taper_out, self.duration)

    @property
    def snap_kernel(self) -> Any:
        """Second derivative of a_x as a formula; None if a taper is missing and the sine begins or ends suddenly."""
        return _snap if self.taper_in > 0.0 and self.taper_out > 0.0 else None

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        return np.array(
            [2.0 * math.pi * self.frequency, self.phase, self.amplitude, self.duration, self.taper_in, self.taper_out]
        )

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return taper_breakpoints(self.taper_in, self.taper_out, self.duration)

    @property
    def max_step(self) -> float:
        return 0.05 / self.frequency


def check_tapers(taper_in: float, taper_out: float, duration: float) -> None:
    """Raise ValueError unless both tapers fit into the duration."""
    not_negative("taper_in", taper_in, "s")
    not_negative("taper_out", taper_out, "s")
    if taper_in + taper_out > duration * (1.0 + ROUNDING):
        raise ValueError(f"taper_in + taper_out={taper_in + taper_out!r} s: want at most duration={duration!r} s")


def taper_breakpoints(taper_in: float, taper_out: float, duration: float) -> tuple[float, ...]:
    """Where the tapers begin and end; one time where the second follows at once on the first."""
    steady = duration - taper_in - taper_out > ROUNDING * duration
    return tuple(sorted({0.0, taper_in, duration - taper_out if steady else taper_in, duration}))
