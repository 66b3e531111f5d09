"""Response spectra: the largest response of linear oscillators to a record.

    u'' + 2 zeta w u' + w^2 u = -a(t),   SD = max |u|,   PSV = w SD,   PSA = w^2 SD

The record goes in straight lines between its samples; for that the response is exact, and it is looked at forty times
a period at least, so that a peak is missed by 0.3 % at most (1 - cos(pi/40)).

Source   Nigam & Jennings (1969), Calculation of response spectra from strong-motion earthquake records, written as a
         recursive filter; exact step matrices by the matrix exponential of the oscillator with a linear load.
Status   largest responses within the record's own duration; agrees with eqsig and pyrotd.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from excitation.checks import between, numbers
from excitation.record import Record

POINTS_PER_PERIOD = 40
"""Fewest times at which the response is looked at in a period."""

MAX_REFINEMENT = 64
"""Most times per sample; beyond it the oscillator is so stiff that u follows -a/w^2 from sample to sample."""

SHORTEST, LONGEST = 1e-9, 1e9
"""[s], of natural periods: far beyond those of anything that is built, and far from where squares overflow."""

STANDARD_PERIODS = np.round(np.geomspace(0.02, 10.0, 100), 6)


class ResponseSpectrum(NamedTuple):
    """Largest responses by period, each of shape (period,)."""

    periods: NDArray[np.float64]  # [s]
    damping: float  # share of critical
    displacement: NDArray[np.float64]  # SD [m]
    pseudo_velocity: NDArray[np.float64]  # PSV [m/s]
    pseudo_acceleration: NDArray[np.float64]  # PSA [m/s^2]

    def __repr__(self) -> str:
        return (
            f"ResponseSpectrum({self.periods.size} periods, {self.periods.min():.4g} to {self.periods.max():.4g} s, "
            f"damping {self.damping:g}, largest PSA {self.pseudo_acceleration.max():.4g} m/s^2)"
        )


@lru_cache(maxsize=4096)
def _coefficients(omega: float, damping: float, step: float) -> tuple[tuple[float, ...], tuple[float, ...], float]:
    """(b, a) of the filter from acceleration to displacement over one step, and the factor p of a_0 in u_1.

    The state (u, u', load, rate of load) of the oscillator under a linear load goes on by a matrix exponential; its
    first two rows give u_(n+1) = A u_n + p a_n + q a_(n+1), and eliminating u' leaves a filter of second order in u.
    """
    from scipy.linalg import expm

    system = np.zeros((4, 4))
    system[0, 1] = 1.0
    system[1, :3] = -(omega**2), -2.0 * damping * omega, -1.0
    system[2, 3] = 1.0
    whole = expm(system * step)
    a = whole[:2, :2]
    q = whole[:2, 3] / step
    p = whole[:2, 2] - q
    # u = first entry of (z I - A)^-1 (p + z q) a.
    numerator = (q[0], p[0] - a[1, 1] * q[0] + a[0, 1] * q[1], a[0, 1] * p[1] - a[1, 1] * p[0])
    determinant = a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0]
    return tuple(map(float, numerator)), (1.0, float(-a[0, 0] - a[1, 1]), float(determinant)), float(p[0])


def oscillator(acceleration: NDArray[np.float64], step: float, period: float, damping: float) -> NDArray[np.float64]:
    """Displacement [m] relative to the base of an oscillator at rest at first, at the times of the samples."""
    from scipy.signal import lfilter

    b, a, p = _coefficients(2.0 * np.pi / period, damping, step)
    # The filter's memory such that u_0 = 0 and u_1 = p a_0 + q a_1, which is rest at the first sample.
    memory = np.array([-b[0], p - b[1]]) * acceleration[0]
    return np.asarray(lfilter(b, a, acceleration, zi=memory)[0])


def refined(acceleration: NDArray[np.float64], step: float, period: float) -> tuple[NDArray[np.float64], float]:
    """(samples, step) with straight lines between the given ones, close enough for a period."""
    parts = int(min(MAX_REFINEMENT, max(1, np.ceil(POINTS_PER_PERIOD * step / period))))
    if parts == 1:
        return acceleration, step
    fine = np.linspace(0.0, acceleration.size - 1, (acceleration.size - 1) * parts + 1)
    return np.interp(fine, np.arange(acceleration.size), acceleration), step / parts


def response_spectrum(record: Record, periods: ArrayLike | None = None, damping: float = 0.05) -> ResponseSpectrum:
    """Largest responses of oscillators to a record.

    Args:
        record: the motion of their base.
        periods: natural periods [s], positive, shape (period,); 100 from 0.02 to 10 s if not given.
        damping: share of the critical damping, 0 to below 1.

    Raises:
        ValueError: a period is not positive or the damping is out of range.
    """
    natural = check_periods(periods)
    between("damping", damping, 0.0, 0.999, "1")
    largest = np.empty(natural.size)
    for k, period in enumerate(natural):
        samples, step = refined(record.acceleration, record.time_step, period)
        largest[k] = np.max(np.abs(oscillator(samples, step, float(period), damping)))
    omega = 2.0 * np.pi / natural
    return ResponseSpectrum(natural, damping, largest, omega * largest, omega**2 * largest)


def check_periods(periods: ArrayLike | None) -> NDArray[np.float64]:
    """Periods [s] as an array; ValueError unless positive and finite."""
    natural = np.atleast_1d(numbers("periods", STANDARD_PERIODS if periods is None else periods))
    if natural.ndim != 1 or natural.size == 0 or not np.all((natural >= SHORTEST) & (natural <= LONGEST)):
        raise ValueError(f"periods={periods!r} s: want positive numbers, {SHORTEST:g} to {LONGEST:g}, shape (period,)")
    return natural
