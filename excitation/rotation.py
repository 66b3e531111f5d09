"""Two horizontal components as one motion: other axes, and measures that do not depend on the sensor's orientation.

    RotDnn   the nn-th percentile, over all directions in the plane, of the largest response in a direction

Source   Boore (2010), Orientation-independent, nongeometric-mean measures of seismic intensity from two horizontal
         components of motion.
Status   agrees with pyrotd, which turns in the same way.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from excitation.checks import between, finite, numbers, whole
from excitation.record import Record, same_sampling
from excitation.spectra import check_periods, oscillator, refined

DEFAULT_ANGLES = 180
"""Directions from 0 to just below 180 degrees: one a degree."""


def _check_pair(first: Record, second: Record) -> None:
    """Raise ValueError unless both are horizontal, at right angles where azimuths are known, and sampled alike."""
    same_sampling(first, second)
    for name, record in (("first", first), ("second", second)):
        if record.vertical:
            raise ValueError(f"{name}={record!r}: is vertical, want a horizontal record")
    if first.azimuth_deg is None or second.azimuth_deg is None:
        return
    apart = (second.azimuth_deg - first.azimuth_deg) % 360.0
    if min(abs(apart - 90.0), abs(apart - 270.0)) > 1e-6:
        raise ValueError(f"azimuth_deg: of the records is {apart:g} deg apart, want 90 or 270")


def turned(first: Record, second: Record, azimuth_deg: float) -> tuple[Record, Record]:
    """The two components along an azimuth and 90 degrees clockwise of it.

    Args:
        first, second: horizontal records at right angles with known azimuths, of one time step and length.
        azimuth_deg: direction of the first of the new axes, degrees clockwise from north.

    Raises:
        ValueError: an azimuth is missing, they are not at right angles, one is vertical, or the sampling differs.
    """
    _check_pair(first, second)
    finite("azimuth_deg", azimuth_deg, "deg")
    if first.azimuth_deg is None or second.azimuth_deg is None:
        raise ValueError(
            f"azimuth_deg: of the records is {first.azimuth_deg} and {second.azimuth_deg}, want two numbers"
        )
    made = []
    for azimuth in (azimuth_deg, azimuth_deg + 90.0):
        values = sum(
            math.cos(math.radians(azimuth - r.azimuth_deg)) * r.acceleration
            for r in (first, second)
            if r.azimuth_deg is not None
        )
        azimuth %= 360.0
        record = first.with_samples(values, note=f"turned to {azimuth:g} deg")
        made.append(replace(record, component=f"{azimuth:g}", azimuth_deg=azimuth))
    return made[0], made[1]


def directional_peaks(x: NDArray[np.float64], y: NDArray[np.float64], angles: int) -> NDArray[np.float64]:
    """Largest |x cos + y sin| in each of `angles` directions from 0 to 180 degrees, shape (direction,).

    Only corners of the path's convex hull can be farthest in any direction, so only those are turned.
    """
    from scipy.spatial import ConvexHull

    points = np.column_stack([x, y])
    theta = np.pi * np.arange(angles) / angles
    axes = np.vstack([np.cos(theta), np.sin(theta)])
    # A path along a line has no hull; Qhull's own test of that is not needed, the rank says it.
    if np.linalg.matrix_rank(points - points[0], tol=1e-9 * float(np.max(np.abs(points), initial=0.0))) == 2:
        points = points[ConvexHull(points, qhull_options="QJ Pp").vertices]
    return np.asarray(np.max(np.abs(points @ axes), axis=0))


def rotd(
    first: Record,
    second: Record,
    periods: ArrayLike | None = None,
    *,
    percentiles: Sequence[float] = (0.0, 50.0, 100.0),
    damping: float = 0.05,
    angles: int = DEFAULT_ANGLES,
) -> NDArray[np.float64]:
    """RotDnn pseudo-accelerations [m/s^2] of two horizontal records at right angles, shape (percentile, period).

    Args:
        first, second: records of one time step and length, horizontal; their azimuths, where both are known, 90 degrees
            apart.
        periods: natural periods [s], shape (period,); 100 from 0.02 to 10 s if not given.
        percentiles: nn, 0 to 100: RotD00 is the least direction, RotD50 the median, RotD100 the greatest.
        damping: share of the critical damping.
        angles: number of directions in half a turn, 2 or more.

    Raises:
        ValueError: the sampling differs, they are not at right angles, one is vertical, or an argument is out of range.
    """
    _check_pair(first, second)
    natural = check_periods(periods)
    between("damping", damping, 0.0, 0.999, "1")
    nn = check_percentiles(percentiles, angles)
    values = np.empty((nn.size, natural.size))
    for k, period in enumerate(natural.tolist()):
        x, y = (
            oscillator(*refined(record.acceleration, record.time_step, period), period, damping)
            for record in (first, second)
        )
        values[:, k] = (2.0 * np.pi / period) ** 2 * np.percentile(directional_peaks(x, y, angles), nn)
    return values


def rotd_peaks(
    first: Record, second: Record, *, percentiles: Sequence[float] = (0.0, 50.0, 100.0), angles: int = DEFAULT_ANGLES
) -> NDArray[np.float64]:
    """RotDnn of the largest ground acceleration [m/s^2], shape (percentile,); arguments and errors as `rotd`."""
    _check_pair(first, second)
    nn = check_percentiles(percentiles, angles)
    return np.asarray(np.percentile(directional_peaks(first.acceleration, second.acceleration, angles), nn))


def check_percentiles(percentiles: Sequence[float], angles: int) -> NDArray[np.float64]:
    """The percentiles as an array; ValueError unless 0 to 100 and of two directions or more."""
    nn = numbers("percentiles", percentiles)
    if nn.ndim != 1 or nn.size == 0 or not np.all((nn >= 0.0) & (nn <= 100.0)):
        raise ValueError(f"percentiles={percentiles!r}: want numbers from 0 to 100")
    whole("angles", angles, 2)
    between("angles", angles, 2.0, 1e6, "directions")
    return nn
