"""The stochastic point source: noise whose mean spectrum is that of a shear fault seen from afar.

    A(f) = C M_0 (2 pi f)^2/(1 + (f/f_c)^2) * (1/R) exp(-pi f R/(Q(f) beta)) * exp(-pi kappa f)   [m/s]
    C = 0.55 * 0.707 * 2/(4 pi rho beta^3),   f_c = 0.49 beta (stress drop/M_0)^(1/3),   log10 M_0 = 1.5 M + 9.05
    Q(f) = Q_0 max(f, 1 Hz)^eta,   duration = 1/f_c + 0.05 s/km * R

Source   Boore (2003), Simulation of ground motion using the stochastic method: the spectrum, the window of Saragoni &
         Hart (1974) with its peak at a fifth and 5 % of it left at the end of twice the duration, and the order of
         steps; Brune (1970, 1971) for the source, Hanks & Kanamori (1979) for the moment, Atkinson & Boore (1995) for
         the path duration.
Status   the mean square spectrum over many seeds is A(f)^2.  One scattering of distances only, 1/R, and no
         amplification by the site: multiply the spectrum where that matters.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from excitation.checks import between, not_negative, positive, whole
from excitation.record import Record

RADIATION, PARTITION, FREE_SURFACE = 0.55, 1.0 / math.sqrt(2.0), 2.0
WINDOW_PEAK, WINDOW_LEFT, WINDOW_LENGTH = 0.2, 0.05, 2.0
PATH_DURATION = 0.05e-3
"""Seconds that a metre of path adds to the duration."""


@dataclass(frozen=True)
class PointSource:
    """An earthquake far enough to be a point.

    Args:
        magnitude: moment magnitude M, 0 to 9.5.
        distance: R [m], positive.
        stress_drop: [Pa], positive; 5 to 20 MPa is usual.
        density, shear_velocity: rho [kg/m^3] and beta [m/s] at the source, positive.
        quality, quality_exponent: Q_0, positive, and eta, 0 or more.
        kappa: [s], 0 or more: the site's loss of high frequencies.

    Raises:
        ValueError: an argument is out of the range above.
    """

    magnitude: float
    distance: float
    stress_drop: float = 1e7
    density: float = 2800.0
    shear_velocity: float = 3500.0
    quality: float = 180.0
    quality_exponent: float = 0.45
    kappa: float = 0.04

    def __post_init__(self) -> None:
        between("magnitude", self.magnitude, 0.0, 9.5, "1")
        units = {"distance": "m", "stress_drop": "Pa", "density": "kg/m^3", "shear_velocity": "m/s", "quality": "1"}
        for name, unit in units.items():
            positive(name, getattr(self, name), unit)
        not_negative("quality_exponent", self.quality_exponent, "1")
        not_negative("kappa", self.kappa, "s")

    @property
    def moment(self) -> float:
        """M_0 [N m]."""
        return float(10.0 ** (1.5 * self.magnitude + 9.05))

    @property
    def corner_frequency(self) -> float:
        """f_c [Hz]."""
        return 0.49 * self.shear_velocity * float((self.stress_drop / self.moment) ** (1.0 / 3.0))

    @property
    def duration(self) -> float:
        """Duration [s] of the strong part."""
        return 1.0 / self.corner_frequency + PATH_DURATION * self.distance

    def spectrum(self, frequency: ArrayLike) -> NDArray[np.float64]:
        """A(f), Fourier amplitude of the acceleration [m/s], at `frequency` [Hz], any shape."""
        f = np.asarray(frequency, dtype=np.float64)
        constant = RADIATION * PARTITION * FREE_SURFACE / (4.0 * math.pi * self.density * self.shear_velocity**3)
        source = constant * self.moment * (2.0 * math.pi * f) ** 2 / (1.0 + (f / self.corner_frequency) ** 2)
        quality = self.quality * np.maximum(f, 1.0) ** self.quality_exponent
        path = np.exp(-math.pi * f * self.distance / (quality * self.shear_velocity)) / self.distance
        return np.asarray(source * path * np.exp(-math.pi * self.kappa * f))

    def window(self, t: ArrayLike) -> NDArray[np.float64]:
        """Window of the noise at `t` [s], 1 at its peak, any shape."""
        share = np.maximum(np.asarray(t, dtype=np.float64), 0.0) / (WINDOW_LENGTH * self.duration)
        e, n = WINDOW_PEAK, WINDOW_LEFT
        b = -e * math.log(n) / (1.0 + e * (math.log(e) - 1.0))
        return np.asarray((math.e / e * share) ** b * np.exp(-b / e * share))

    def record(self, time_step: float, seed: int) -> Record:
        """One motion; the same seed gives the same one.

        Raises ValueError unless `time_step` [s] is positive and at most a tenth of the duration, and `seed` a whole
        number, 0 or more.
        """
        positive("time_step", time_step, "s")
        whole("seed", seed, 0)
        if time_step > 0.1 * self.duration:
            raise ValueError(f"time_step={time_step!r} s: want at most a tenth of the duration, {self.duration:g} s")
        count = math.ceil(1.5 * WINDOW_LENGTH * self.duration / time_step)
        noise = np.random.default_rng(seed).normal(size=count) * self.window(time_step * np.arange(count))
        size = 2 ** math.ceil(math.log2(2 * count))
        transform = np.fft.rfft(noise, size)
        transform /= math.sqrt(float(np.mean(np.abs(transform) ** 2)))
        # A continuous spectrum [m/s] over the step is the discrete one.
        shaped = transform * self.spectrum(np.fft.rfftfreq(size, time_step)) / time_step
        return Record(time_step, np.fft.irfft(shaped, size)[:count], source=f"{self!r}, seed {seed}")
