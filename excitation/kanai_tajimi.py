"""Filtered white noise under an envelope: the Kanai-Tajimi ground with the filter of Clough & Penzien.

    S(f) = S_0 (1 + 4 z^2 r^2)/((1 - r^2)^2 + 4 z^2 r^2) * q^4/((1 - q^2)^2 + 4 y^2 q^2),   r = f/f_g,  q = f/f_f
    a(t) = E(t) sum_k sqrt(2 S(f_k) df) cos(2 pi f_k t + phi_k)
    E(t) = (t/t_1)^2 up to t_1,  1 up to t_2,  exp(-c (t - t_2)) after

Source   Kanai (1957), Semi-empirical formula for the seismic characteristics of the ground; Tajimi (1960), A
         statistical method of determining the maximum response of a building structure during an earthquake; Clough &
         Penzien (1975), Dynamics of structures, for the second factor; Shinozuka & Deodatis (1991), Simulation of
         stochastic processes by spectral representation; envelope of Jennings, Housner & Tsai (1968), Simulated
         earthquake motions.
Status   the mean square over many seeds is the integral of S; one seed is one motion, the same everywhere.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from excitation.checks import not_negative, positive, real, whole
from excitation.record import Record


@dataclass(frozen=True)
class KanaiTajimi:
    """A stochastic ground.

    Args:
        rms: root mean square of the strong part [m/s^2], positive.
        duration: length of the record [s], positive.
        rise: t_1 [s], when the strong part begins; 0 or more.
        strong_end: t_2 [s], when it ends; not before t_1.
        decay: c [1/s], how fast the motion dies away after it; 0 or more.
        ground_frequency, ground_damping: f_g [Hz] and z [1] of the ground, positive; 2.5 Hz and 0.6 are firm soil.
        filter_frequency, filter_damping: f_f [Hz] and y [1] of the filter that takes out slow motion, positive.

    Raises:
        ValueError: an argument is out of the range above.
    """

    rms: float
    duration: float
    rise: float = 2.0
    strong_end: float = 12.0
    decay: float = 0.3
    ground_frequency: float = 2.5
    ground_damping: float = 0.6
    filter_frequency: float = 0.25
    filter_damping: float = 0.6

    def __post_init__(self) -> None:
        units = {"rms": "m/s^2", "duration": "s", "ground_frequency": "Hz", "filter_frequency": "Hz"}
        for name, unit in (units | {"ground_damping": "1", "filter_damping": "1"}).items():
            positive(name, getattr(self, name), unit)
        not_negative("rise", self.rise, "s")
        not_negative("decay", self.decay, "1/s")
        if not (math.isfinite(real(self.strong_end)) and self.strong_end >= self.rise):
            raise ValueError(f"strong_end={self.strong_end!r} s: want not before rise={self.rise!r} s")

    def shape(self, frequency: ArrayLike) -> NDArray[np.float64]:
        """S(f)/S_0 at `frequency` [Hz], any shape."""
        f = np.asarray(frequency, dtype=np.float64)
        r, q = (f / self.ground_frequency) ** 2, (f / self.filter_frequency) ** 2
        ground = (1.0 + 4.0 * self.ground_damping**2 * r) / ((1.0 - r) ** 2 + 4.0 * self.ground_damping**2 * r)
        return np.asarray(ground * q * q / ((1.0 - q) ** 2 + 4.0 * self.filter_damping**2 * q))

    def envelope(self, t: ArrayLike) -> NDArray[np.float64]:
        """E(t) at `t` [s], any shape; 0 before 0."""
        times = np.asarray(t, dtype=np.float64)
        rising = np.ones_like(times) if self.rise == 0.0 else np.clip(times / self.rise, 0.0, 1.0) ** 2
        falling = np.exp(-self.decay * np.maximum(times - self.strong_end, 0.0))
        return np.asarray(np.where(times >= 0.0, rising * falling, 0.0))

    def record(self, time_step: float, seed: int) -> Record:
        """One motion.

        Args:
            time_step: [s], positive, below half of the duration; frequencies up to 1/(2 time_step) are in it.
            seed: of the phases, a whole number, 0 or more; the same seed gives the same motion.

        Raises:
            ValueError: the step is not positive or too long, or the seed is none.
        """
        positive("time_step", time_step, "s")
        whole("seed", seed, 0)
        if time_step > 0.5 * self.duration:
            raise ValueError(f"time_step={time_step!r} s: want at most half of duration={self.duration!r} s")
        count = round(self.duration / time_step) + 1
        # The sum of cosines repeats after 1/df: twice the length leaves no repetition within the record.
        size = 2 * count
        frequencies = np.fft.rfftfreq(size, time_step)
        power = self.shape(frequencies)
        power[-1] = 0.0  # at the Nyquist frequency a cosine of any phase cannot be held
        amplitudes = np.sqrt(2.0 * power / np.sum(power)) * self.rms
        phases = np.random.default_rng(seed).uniform(0.0, 2.0 * math.pi, frequencies.size)
        # One cosine of amplitude A is a coefficient of A size/2 in the inverse real transform.
        stationary = np.fft.irfft(0.5 * size * amplitudes * np.exp(1j * phases), size)[:count]
        values = self.envelope(time_step * np.arange(count)) * stationary
        return Record(time_step, values, source=f"{self!r}, seed {seed}")
