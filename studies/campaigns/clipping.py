"""What in a record is no faithful reading: the rails of a sensor, and what comes after the block has fallen.

Source   none; thresholds stated with their reasons.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from studies.campaigns.gaps import runs
from studies.campaigns.model import Array

LEAST_RUN = 4
"""Equal extreme samples in a row that make a rail: noise of a digit or more hardly ever repeats an extreme thrice."""

LEAST_TOTAL = 6
"""Samples at the rail altogether."""

PILE = 4.0
"""Samples at the rail over samples within the same distance below it: a smooth peak has at most 1/(sqrt(2)-1) = 2.4."""


def clipped(values: Array) -> NDArray[np.bool_]:
    """Which samples sit on a rail (the sensor saturates), shape (time,).

    A rail is the largest or smallest reading, repeated exactly in runs, with a pile of samples that no smooth peak
    makes, and away from where the record rests.
    """
    mask = np.zeros(values.shape, dtype=bool)
    there = np.isfinite(values)
    if np.count_nonzero(there) < 2 * LEAST_TOTAL:
        return mask
    for sign in (1.0, -1.0):
        mask |= _on_rail(sign * values, there)
    return mask


def _on_rail(values: Array, there: NDArray[np.bool_]) -> NDArray[np.bool_]:
    none = np.zeros(values.shape, dtype=bool)
    top, rest = float(np.max(values[there])), float(np.median(values[there]))
    span = top - float(np.min(values[there]))
    if span <= 0.0 or top - rest < 0.2 * span:
        return none
    at = there & (values >= top - 1e-9 * span)
    if np.count_nonzero(at) < LEAST_TOTAL or longest_run(at) < LEAST_RUN:
        return none
    levels = np.unique(values[there])
    digit = float(np.min(np.diff(levels)[-20:])) if levels.size > 20 else 0.0
    depth = max(1e-3 * span, digit)
    near = np.count_nonzero(there & ~at & (values >= top - 2.0 * depth))
    return at if np.count_nonzero(at) >= PILE * near else none


def longest_run(mask: NDArray[np.bool_]) -> int:
    """Length of the longest row of true values."""
    return max((stop - start for start, stop in runs(mask)), default=0)


def overturning_time(time: Array, rotation: Array, balance: float, factor: float = 1.3) -> float:
    """When the record shows the block pass the tilt of unstable balance for good [s]; NaN if it does not.

    Args:
        time, rotation: the record [s, rad], shape (time,), NaN where missing.
        balance: tilt of unstable balance [rad], as declared.
        factor: a fall is believed once |rotation| exceeds `factor * balance`, which allows for a declared value that
            is not the true one, and does not come back below `balance`.
    """
    there = np.flatnonzero(np.isfinite(rotation))
    lean = np.abs(rotation[there])
    if not lean.size or lean.max() <= factor * balance:
        return math.nan
    below = np.flatnonzero(lean <= balance)
    first = int(below[-1]) + 1 if below.size else 0
    if first >= lean.size or lean[first:].max() <= factor * balance:
        return math.nan
    if first == 0:
        return float(time[there[0]])
    a, b = lean[first - 1], lean[first]
    t_a, t_b = time[there[first - 1]], time[there[first]]
    return float(t_a + (balance - a) / (b - a) * (t_b - t_a))


def before_overturning(time: Array, rotation: Array, balance: float) -> NDArray[np.bool_]:
    """Which samples come before the fall that the record shows, shape (time,); all if it shows none."""
    fell = overturning_time(time, rotation, balance)
    return np.ones(time.shape, dtype=bool) if math.isnan(fell) else time < fell


def ends_in_motion(rotation: Array, noise: float, zero: float = 0.0, share: float = 0.02) -> bool:
    """Whether the record stops while the block still rocks: the last `share` of its samples is not at rest."""
    there = rotation[np.isfinite(rotation)]
    last = there[-max(5, round(share * there.size)) :]
    return bool(np.max(np.abs(last - zero)) > 6.0 * noise) if last.size else False
