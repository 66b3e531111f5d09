"""The chirp: a horizontal sine whose frequency sweeps from one value to another.

    a_x(t) = A w(t) sin(2 pi phi(t) + phase),   0 <= t <= T
    linear        phi = f_0 t + (f_1 - f_0) t^2 / (2 T)
    logarithmic   phi = f_0 T / ln(f_1/f_0) ((f_1/f_0)^(t/T) - 1)

Source   the two sweeps as scipy.signal.chirp has them; tapers as in `excitation.steady_sinusoid`.
Status   agrees with scipy.signal.chirp.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from excitation.checks import finite, not_zero, positive
from excitation.envelopes import modulated, window, window_rates
from excitation.motion import Motion
from excitation.steady_sinusoid import check_tapers, taper_breakpoints

SWEEPS = ("linear", "logarithmic")


def _acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z) [m/s^2] at t; par = [f_0, slope, log rate, phase, amplitude, duration, rise, fall].

    slope [Hz/s] is zero for a logarithmic sweep, log rate [1/s] is zero for a linear one.
    """
    a_x = par[4] * window(xp, t, par[5], par[6], par[7]) * xp.sin(_angle(xp, t, par))
    return a_x, 0.0 * t


def _angle(xp: Any, t: Any, par: Any) -> Any:
    """Argument of the sine [rad]."""
    within = xp.minimum(xp.maximum(t, 0.0), par[5])
    # One of slope and log rate is zero.
    mean = par[0] * _mean_exp(xp, par[2] * within) + 0.5 * par[1] * within
    return 2.0 * math.pi * (mean * within) + par[3]


def _mean_exp(xp: Any, x: Any) -> Any:
    """(exp(x) - 1)/x to rounding: the difference loses its digits where x is small, ten terms of the series do not."""
    small = xp.abs(x) < 0.1
    series = 1.0 + 0.0 * x
    for n in range(10, 1, -1):
        series = 1.0 + x / n * series
    return xp.where(small, series, (xp.exp(x) - 1.0) / xp.where(small, 1.0, x))


def _snap(xp: Any, t: Any, par: Any) -> Any:
    """Second derivative of a_x [m/s^4] at t, where both tapers are there."""
    within = xp.minimum(xp.maximum(t, 0.0), par[5])
    w, w1, w2 = window_rates(xp, t, par[5], par[6], par[7])
    # One of slope and log rate is zero: the frequency is f_0 exp(log rate t) + slope t.
    grown = par[0] * xp.exp(par[2] * within)
    rates = (2.0 * math.pi * (grown + par[1] * within), 2.0 * math.pi * (par[2] * grown + par[1]))
    return modulated(xp, (par[4] * w, par[4] * w1, par[4] * w2), (_angle(xp, t, par), *rates))[1]


@dataclass(frozen=True)
class Chirp(Motion):
    """A sine of constant amplitude whose frequency goes from `start_frequency` to `end_frequency` in `duration`.

    Args:
        start_frequency, end_frequency: f_0, f_1 [Hz], positive; different ones for a logarithmic sweep.
        amplitude: A [m/s^2], not zero.
        duration: T [s], positive, both tapers in it.
        sweep: "linear" or "logarithmic" in time.
        phase: phase of the sine at the start [rad].
        taper_in, taper_out: times [s] in which the amplitude rises and falls; none if zero.

    Raises:
        ValueError: an argument is out of the range above.
    """

    start_frequency: float
    end_frequency: float
    amplitude: float
    duration: float
    sweep: str = "linear"
    phase: float = 0.0
    taper_in: float = 0.0
    taper_out: float = 0.0

    kernel = staticmethod(_acceleration)

    def __post_init__(self) -> None:
        positive("start_frequency", self.start_frequency, "Hz")
        positive("end_frequency", self.end_frequency, "Hz")
        not_zero("amplitude", self.amplitude, "m/s^2")
        positive("duration", self.duration, "s")
        finite("phase", self.phase, "rad")
        check_tapers(self.taper_in, self.taper_out, self.duration)
        if self.sweep not in SWEEPS:
            raise ValueError(f"sweep={self.sweep!r}: want one of {', '.join(SWEEPS)}")
        if self.sweep == "logarithmic" and self.start_frequency == self.end_frequency:
            raise ValueError(f"end_frequency={self.end_frequency!r} Hz: want another one than start_frequency")

    @property
    def snap_kernel(self) -> Any:
        """Second derivative of a_x as a formula; None if a taper is missing and the sine begins or ends suddenly."""
        return _snap if self.taper_in > 0.0 and self.taper_out > 0.0 else None

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        slope = log_rate = 0.0
        if self.sweep == "linear":
            slope = (self.end_frequency - self.start_frequency) / self.duration
        else:
            log_rate = math.log(self.end_frequency / self.start_frequency) / self.duration
        head = [self.start_frequency, slope, log_rate, self.phase, self.amplitude, self.duration]
        return np.array([*head, self.taper_in, self.taper_out])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return taper_breakpoints(self.taper_in, self.taper_out, self.duration)

    @property
    def max_step(self) -> float:
        return 0.05 / max(self.start_frequency, self.end_frequency)
