"""How noisy a channel is, from its own record: what its smoothest and its quietest stretches leave.

Two estimates of one standard deviation are made in short windows, of which the quiet quarter decides, so that motion,
impacts and outliers in the other windows do not matter:

* high frequency: differences of 8th order take out what changes slowly and enlarge white noise by sqrt(C(16, 8));
* quiet stretch: scatter about a straight line, which keeps noise of all frequencies but needs a block, or table, at
  rest.

A quantile of windows is smaller than their mean even where the noise is the same in all of them; it is put right with
the chi-square distribution that windows of white noise have.

Source   differences as filters: Kendall, Stuart & Ord (1983), The Advanced Theory of Statistics 3, section 46 (the
         variate-difference method).  Effective degrees of freedom: Satterthwaite (1946).
Status   the high-frequency estimate is right for white noise, too low for a record that was low-passed.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass
from typing import Literal

import numpy as np

from studies.campaigns.gaps import interpolated
from studies.campaigns.model import Array
from studies.campaigns.sampling import independent

ORDER = 8
"""Of the differences: motion at a tenth of the sampling rate is let through by 2e-2 / 113."""

WINDOW = 32
"""Samples of a window of differences."""

QUIET_WINDOW = 0.4
"""Length of a quiet stretch [s]: some periods of what a laboratory hums with."""

WHITE = 3.0
"""Quiet stretch over high frequency up to which the noise counts as white and the stretch as rest."""

AT_REST = 0.01
"""Share of the largest reading up to which the quietest stretch counts as rest though its noise is not white."""


@dataclass(frozen=True)
class Noise:
    """Estimates of one standard deviation in the unit of the channel, and the one to use (`value`)."""

    value: float
    basis: Literal["quiet stretch", "high frequency", "last digit"]
    high_frequency: float
    quiet: float  # NaN where the record is shorter than a stretch
    level: float  # median reading at rest, NaN where the record shows no rest


def noise(values: Array, time_step: float) -> Noise:
    """Noise of a record.

    Args:
        values: samples, shape (time,), NaN where missing.
        time_step: between them [s].

    Raises:
        ValueError: 48 samples in a row are nowhere, without which there may be no window of 32.
    """
    from scipy.stats import chi2

    kept, stride = independent(values)
    fast = _windows_of_differences(kept)
    if not fast.size:
        raise ValueError(f"noise: has no {WINDOW + WINDOW // 2} samples in a row, want them without gaps")
    rho = np.array([math.comb(2 * ORDER, ORDER + j) for j in range(1, ORDER + 1)]) / math.comb(2 * ORDER, ORDER)
    freedom = (WINDOW - ORDER) / (1.0 + 2.0 * float(np.sum(rho**2)))
    high = _sigma(fast, 0.25, freedom, chi2)
    width = max(24, round(QUIET_WINDOW / (time_step * stride)))
    slow, level = _windows_about_lines(kept, width)
    quiet = _sigma(slow, 0.1, width - 2.0, chi2) if slow.size else math.nan
    digit = _last_digit(kept) / math.sqrt(12.0)
    largest = float(np.nanmax(np.abs(kept - np.nanmedian(kept))))
    return _chosen(high, quiet, level, digit, largest)


def noise_told(values: Array, time_step: float) -> float | None:
    """Standard deviation of the noise of a record as it tells, across gaps if need be; None if it is too short.

    Where 48 samples in a row are nowhere, gaps are filled by a spline, which has less noise than samples have: with
    each thirteenth of them missing the estimate is 14 % low.
    """
    with suppress(ValueError):
        return float(noise(values, time_step).value)
    with suppress(ValueError):
        return float(noise(interpolated(values), time_step).value)
    return None


def _chosen(high: float, quiet: float, level: float, digit: float, largest: float) -> Noise:
    rests = quiet <= max(WHITE * high, digit) or quiet <= AT_REST * largest
    value = quiet if rests else high
    level = level if rests else math.nan
    if max(value, high) < digit:
        return Noise(digit, "last digit", high, quiet, level)
    basis: Literal["quiet stretch", "high frequency"] = "quiet stretch" if rests else "high frequency"
    return Noise(value, basis, high, quiet, level)


def _sigma(variances: Array, share: float, freedom: float, chi2: type) -> float:
    """Standard deviation from the quantile of windows, put right for being a low one."""
    found = float(np.quantile(variances, share))
    return math.sqrt(found * freedom / float(chi2.ppf(share, freedom)))  # type: ignore[attr-defined]


def _windows_of_differences(values: Array) -> Array:
    """Mean squares of the scaled differences, one for each window without gaps."""
    starts = range(0, values.size - WINDOW + 1, WINDOW // 2)
    if values.size < WINDOW:
        return np.empty(0)
    table = np.stack([values[i : i + WINDOW] for i in starts])
    table = table[np.isfinite(table).all(axis=1)]
    return np.asarray(np.mean(np.diff(table, ORDER, axis=1) ** 2, axis=1) / math.comb(2 * ORDER, ORDER))


def _windows_about_lines(values: Array, width: int) -> tuple[Array, float]:
    """Variance about a line in each window, and the median reading of the quietest tenth of the windows."""
    starts = range(0, values.size - width + 1, max(1, width // 2))
    rows = [values[i : i + width] for i in starts]
    rows = [row for row in rows if np.count_nonzero(np.isfinite(row)) >= 0.9 * width]
    if not rows:
        return np.empty(0), math.nan
    variances, levels = np.empty(len(rows)), np.empty(len(rows))
    for k, row in enumerate(rows):
        there = np.isfinite(row)
        u = np.arange(width)[there] - 0.5 * width
        levels[k] = np.median(row[there])
        centred = row[there] - np.mean(row[there])
        u = u - np.mean(u)
        slope = float(u @ centred) / float(u @ u)
        variances[k] = float(np.sum((centred - slope * u) ** 2)) / (u.size - 2)
    quietest = np.argsort(variances)[: max(1, len(rows) // 10)]
    return variances, float(np.median(levels[quietest]))


def _last_digit(values: Array) -> float:
    """Smallest difference between two different readings; zero if all are the same."""
    levels = np.unique(values[np.isfinite(values)])
    steps = np.diff(levels)
    # Readings that differ by rounding of the last bit are the same reading.
    steps = steps[steps > 1e-9 * max(1e-300, float(np.max(np.abs(levels))))]
    return float(steps.min()) if steps.size else 0.0
