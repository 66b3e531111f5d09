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


class Samples(NamedTuple):
    """What runs over records share."""

    values: Array  # [m/s^2]
    peaks: Array  # largest |value| of each block


def joined(records: Sequence[tuple[Array, Array]]) -> tuple[Samples, Array]:
    """(samples, rows of scale 1), shape (record, column), of records ((t_first, dt), values)."""
    from rocking.solvers.exact_kernel import BLOCK

    parts, rows, first = [], [], 0
    for (t_first, dt), given in records:
        # One sample alone is an instant, in which nothing happens.
        values = np.asarray(given, np.float64) if len(given) > 1 else np.zeros(2)
        room = -(-(values.size + 2) // BLOCK) * BLOCK
        parts.append(np.concatenate([values, np.zeros(room - values.size)]))
        rows.append((1.0, dt, t_first, first, values.size, np.abs(values).max()))
        first += room
    flat = np.concatenate(parts)
    return Samples(flat, np.abs(flat).reshape(-1, BLOCK).max(axis=1)), np.array(rows, dtype=np.float64)


def scaled(row: Array, scale: ArrayLike, time_scale: ArrayLike) -> Array:
    """A row for each factor on the samples and on the interval, shape (run, column)."""
    table = np.tile(row, (np.size(scale), 1))
    table[:, SCALE] = scale
    table[:, DT] *= np.asarray(time_scale)
    return table
