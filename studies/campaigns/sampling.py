"""Channels that were sampled less often than the record: every k-th line filled, or each reading held for k lines.

Status   a channel that was interpolated to the rate of the record is not recognised.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from studies.campaigns.model import Array

LONGEST_STRIDE = 50


def measured(values: Array) -> NDArray[np.bool_]:
    """Which samples are readings of their own, shape (time,): not missing, and not held over from a slower clock."""
    there = np.isfinite(values)
    stride, phase = _held(values)
    if stride > 1:
        there &= np.arange(values.size) % stride == phase
    return there


def independent(values: Array) -> tuple[Array, int]:
    """The readings at the channel's own rate, NaN where missing, and the lines of the record from one to the next."""
    stride, phase = _held(values)
    if stride == 1:
        stride, phase = _filled(values)
    return values[phase::stride], stride


def _filled(values: Array) -> tuple[int, int]:
    """(k, first line) where only every k-th line is filled; (1, 0) if that is not so."""
    there = np.flatnonzero(np.isfinite(values))
    if there.size < 8:
        return 1, 0
    steps, counts = np.unique(np.diff(there), return_counts=True)
    stride = int(steps[np.argmax(counts)])
    regular = counts.max() >= 0.8 * (there.size - 1) and bool(np.all(np.diff(there) % stride == 0))
    return (stride, int(there[0] % stride)) if 1 < stride <= LONGEST_STRIDE and regular else (1, 0)


def _held(values: Array) -> tuple[int, int]:
    """(k, first line) where readings change at every k-th line alone; (1, 0) if that is not so."""
    both = np.isfinite(values[1:]) & np.isfinite(values[:-1])
    changes = np.flatnonzero(both & (values[1:] != values[:-1])) + 1
    if changes.size < 8:
        return 1, 0
    stride = int(np.gcd.reduce(np.diff(changes)))
    # A coarse channel at its own rate changes at irregular places, whose differences have no common divisor.
    if not 1 < stride <= LONGEST_STRIDE:
        return 1, 0
    return stride, int(changes[0] % stride)
