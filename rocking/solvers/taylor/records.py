"""Records for the Taylor solver: the samples of all of them in one array, and a row of numbers for each.

Status   a record is filled up with zeros, two or more, to whole blocks, whose largest |sample| is known beforehand.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

SCALE, DT, T_FIRST, FIRST, SAMPLES, LARGEST_SAMPLE = range(6)
"""Columns of the table of motions, where these are records: factor on the samples, interval [s], time of the first
sample [s], where it is in the array, number of samples, largest |sample|."""


BLOCK = 32
"""Samples whose largest |a| is known beforehand, to pass over them at rest."""


class Samples(NamedTuple):
    """What runs over records share."""

    values: Array  # [m/s^2]
    peaks: Array  # largest |value| of each block


def joined(records: Sequence[tuple[Array, Array]]) -> tuple[Samples, Array]:
    """(samples, rows of scale 1), shape (record, column), of records ((t_first, dt), values)."""
    # One sample alone is an instant, in which nothing happens.
    heads, values = [head for head, _ in records], [v if len(v) > 1 else np.zeros(2) for _, v in records]
    counts = np.array([len(v) for v in values])
    rooms = -(-(counts + 2) // BLOCK) * BLOCK
    firsts = np.concatenate([[0], np.cumsum(rooms)[:-1]])
    flat = np.zeros(int(rooms.sum()))
    for first, of_one in zip(firsts, values, strict=True):
        flat[first : first + len(of_one)] = of_one
    peaks = np.abs(flat).reshape(-1, BLOCK)
    while peaks.shape[1] > 1:  # by halves: NumPy is slow where it reduces over few
        half = peaks.shape[1] // 2
        peaks = np.maximum(peaks[:, :half], peaks[:, half:])
    peaks = np.ascontiguousarray(peaks[:, 0])
    rows = np.ones((len(records), 6))
    rows[:, T_FIRST], rows[:, DT] = np.array(heads, dtype=np.float64).reshape(-1, 2).T
    rows[:, FIRST], rows[:, SAMPLES] = firsts, counts
    rows[:, LARGEST_SAMPLE] = np.maximum.reduceat(peaks, firsts // BLOCK)
    return Samples(flat, peaks), rows


def scaled(row: Array, scale: ArrayLike, time_scale: ArrayLike) -> Array:
    """A row for each factor on the samples and on the interval, shape (run, column)."""
    table = np.tile(row, (np.size(scale), 1))
    table[:, SCALE] = scale
    table[:, DT] *= np.asarray(time_scale)
    return table
