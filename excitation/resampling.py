"""Other time steps for a record, and other speeds.

Source   scipy.signal.resample_poly for the band-limited change of rate; similitude of gravity-driven models: lengths by
         lambda, accelerations by 1, times by sqrt(lambda) (Harris & Sabnis 1999, Structural modeling and experimental
         techniques, true replica models).
Status   content below 0.8 of the lower Nyquist frequency passes to 1e-3.
"""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np

from excitation.checks import finite, positive
from excitation.record import Record

MAX_RATIO = 10000
"""Largest numerator or denominator of the ratio of rates."""


def resampled(record: Record, time_step: float) -> Record:
    """The record at another time step, with what the new step cannot hold filtered out.

    Args:
        record: what to resample.
        time_step: the new step [s]; its ratio to the old one must be one of whole numbers up to 10000.

    Raises:
        ValueError: the step is not positive, the ratio is not such a fraction, or fewer than two samples would be left.
    """
    from scipy.signal import resample_poly

    positive("time_step", time_step, "s")
    ratio = record.time_step / time_step
    # Beyond that none is near; of infinity there is no fraction.
    fraction = Fraction(ratio).limit_denominator(MAX_RATIO) if ratio < MAX_RATIO + 1 else Fraction(0)
    if fraction.numerator > MAX_RATIO or fraction <= 0 or abs(float(fraction) - ratio) > 1e-9 * ratio:
        raise ValueError(f"time_step={time_step!r} s: want a ratio to {record.time_step!r} s of small whole numbers")
    count = math.floor(record.duration / time_step * (1.0 + 1e-12)) + 1
    if count < 2:
        raise ValueError(f"time_step={time_step!r} s: want two samples or more in {record.duration:g} s")
    if fraction.denominator == fraction.numerator == 1:
        return record
    # A longer filter than SciPy's default: its band then reaches 0.8 of the lower Nyquist frequency.
    longest = max(fraction.numerator, fraction.denominator)
    values = resample_poly(
        record.acceleration, fraction.numerator, fraction.denominator, window=_low_pass(longest), padtype="line"
    )
    return record.with_samples(
        values[:count], time_step, note=f"resampled from {record.time_step:g} to {time_step:g} s"
    )


def _low_pass(longest: int) -> np.ndarray:
    from scipy.signal import firwin

    half = 32 * longest
    return np.asarray(firwin(2 * half + 1, 0.9 / longest, window=("kaiser", 7.0)))


def time_scaled(record: Record, factor: float) -> Record:
    """The record made longer (factor above 1) or shorter; accelerations stay, frequencies are divided by it."""
    positive("factor", factor, "1")
    return record.with_samples(record.acceleration, record.time_step * factor, note=f"time scaled by {factor:g}")


def similar(record: Record, length_scale: float) -> Record:
    """The record for a model whose lengths are `length_scale` times the prototype's, under the same gravity.

    Accelerations stay, times go with sqrt(length_scale), so velocities do too and displacements with length_scale.
    Raises ValueError if the scale is not positive.
    """
    positive("length_scale", length_scale, "1")
    return time_scaled(record, math.sqrt(length_scale))


def trimmed(record: Record, start: float, end: float) -> Record:
    """The samples from `start` to `end` [s] after the first one; ValueError unless two or more lie there."""
    finite("start", start, "s")
    finite("end", end, "s")
    first = math.ceil(start / record.time_step - 1e-9)
    last = math.floor(end / record.time_step + 1e-9)
    if not (0 <= first < last < record.acceleration.size):
        raise ValueError(
            f"start={start!r}, end={end!r} s: want 0 <= start < end <= {record.duration:g} s, two samples apart"
        )
    kept = record.with_samples(record.acceleration[first : last + 1], note=f"cut to {start:g}-{end:g} s")
    return replace(kept, start_time="") if first else kept
