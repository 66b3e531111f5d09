"""Making a record's response spectrum follow a target, by changing its Fourier amplitudes and keeping its phases.

Each round divides the target by the spectrum that the record has, and multiplies the Fourier amplitudes by the ratio at
their frequency; outside the target's periods they keep the ratio of its ends.

Source   the iteration of Gasparini & Vanmarcke (1976), SIMQKE, used on a given record.
Status   usual targets are met within a few per cent at every period; what is reached is returned and checked, never
         taken for granted.  Time-domain matching (Al Atik & Abrahamson 2010) keeps more of the record's
         nonstationarity.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from excitation.checks import numbers, positive, whole
from excitation.record import Record
from excitation.spectra import check_periods, response_spectrum


class Match(NamedTuple):
    """A record whose spectrum follows a target."""

    record: Record
    misfit: float  # largest |spectrum/target - 1| over the periods
    rounds: int

    def __repr__(self) -> str:
        return f"<Match: {self.record!r}, misfit {self.misfit:.3g} after {self.rounds} rounds>"


def _changed(record: Record, frequencies: NDArray[np.float64], ratio: NDArray[np.float64]) -> Record:
    """The record with its Fourier amplitudes multiplied by a ratio given at ascending frequencies."""
    size = 2 * record.acceleration.size
    transform = np.fft.rfft(record.acceleration, size)
    f = np.fft.rfftfreq(size, record.time_step)
    gain = np.exp(np.interp(np.log(np.maximum(f, 1e-12)), np.log(frequencies), np.log(ratio)))
    return record.with_samples(np.fft.irfft(transform * gain, size)[: record.acceleration.size])


def matched(
    record: Record,
    periods: ArrayLike,
    pseudo_acceleration: ArrayLike,
    *,
    damping: float = 0.05,
    tolerance: float = 0.05,
    max_rounds: int = 60,
) -> Match:
    """The record changed until its spectrum is the target's within `tolerance`.

    Args:
        record: what to begin with; its phases and length stay.
        periods: of the target [s], ascending, shape (period,), two or more.
        pseudo_acceleration: target PSA [m/s^2], positive, shape (period,).
        damping: of the target, share of critical.
        tolerance: largest share by which the spectrum may miss the target at a period, positive.
        max_rounds: give up after so many.

    Raises:
        ValueError: an argument is out of range, or the target is not met in `max_rounds`: says how close it came.
    """
    natural = check_periods(periods)
    target = numbers("pseudo_acceleration", pseudo_acceleration)
    if natural.size < 2 or np.any(np.diff(natural) <= 0.0):
        raise ValueError(f"periods={periods!r} s: want two or more, ascending")
    if target.shape != natural.shape or not np.all(np.isfinite(target) & (target > 0.0)):
        raise ValueError(f"pseudo_acceleration: want positive numbers, shape ({natural.size},) as the periods")
    if not np.any(record.acceleration):
        raise ValueError("record: is all zeros, want one that moves")
    positive("tolerance", tolerance, "1")
    whole("max_rounds", max_rounds, 0, 1_000_000)
    frequencies = 1.0 / natural[::-1]
    best = Match(record, np.inf, 0)
    current = record
    for rounds in range(max_rounds + 1):
        ratio = target / response_spectrum(current, natural, damping).pseudo_acceleration
        misfit = float(np.max(np.abs(1.0 / ratio - 1.0)))
        if misfit < best.misfit:
            best = Match(current, misfit, rounds)
        if misfit <= tolerance:
            break
        current = _changed(current, frequencies, ratio[::-1])
    if best.misfit > tolerance:
        raise ValueError(
            f"tolerance={tolerance!r}: the target is missed by {best.misfit:.3g} at best in {max_rounds} rounds"
        )
    note = f"spectrum matched within {best.misfit:.3g} in {best.rounds} rounds"
    return best._replace(record=record.with_samples(best.record.acceleration, note=note))
