"""Records cut into windows that a model can predict: one swing, several, or the whole record.

Under shaking a small difference grows with each impact, so that a model which is nearly right predicts one half-swing
and not a record.  A window begins at the peak of a swing with a state of its own, which is fitted along with it, or
at the start of the record, from rest or from the lean at release.

Status   windows that begin from rest are whole records only; hops that stay within the noise are in no swing window.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studies.campaigns import Test
from studies.campaigns.clipping import before_overturning, clipped
from studies.campaigns.smoothing import state
from studies.campaigns.swings import Segmentation, segment

Array = NDArray[np.float64]

PEAK_OVER_NOISE = 12.0
"""Peaks below this many standard deviations begin or end no window."""

RELEASE_SD = 2e-3
"""How far from what was aimed at a lean by hand may be [rad], one standard deviation."""


@dataclass(frozen=True)
class Record:
    """The rotation record of a test as the loop uses it."""

    test: int  # index
    kind: str  # "free" or "forced"
    time: Array  # [s]
    rotation: Array  # reading [rad], NaN where missing, clipped or after a fall
    noise: float  # one standard deviation [rad]
    lean: float  # rotation at the start [rad]
    lean_sd: float  # 0 where the block starts at rest
    found: Segmentation


@dataclass(frozen=True)
class Window:
    """A part of a record, with the state at its start and what is known of that beforehand."""

    record: int  # index into the records
    test: int  # index of the test
    start: float  # [s]
    times: Array  # [s]
    data: Array  # reading [rad], finite
    noise: float  # [rad]
    theta: float  # rotation at the start [rad]
    omega: float  # angular velocity at the start [rad/s]
    theta_sd: float  # prior standard deviation about `theta`; inf: free, 0: fixed
    omega_sd: float
    theta_prior: float = 0.0  # what the prior is about
    sd: Array | None = None  # standard deviation of each sample [rad], where it is more than the noise

    @property
    def weights(self) -> Array:
        """One over the standard deviation of each sample [1/rad]."""
        return 1.0 / (np.full(self.times.size, self.noise) if self.sd is None else self.sd)

    def moved(self, theta: float, omega: float) -> Window:
        """The window with another state at its start."""
        return replace(self, theta=theta, omega=omega)


def record_of(test: Test, index: int, noise: float, balance: float) -> Record | None:
    """The record of a test with a rotation channel; None if it has none, or too few samples."""
    reading = test.rotation
    if reading is None or int(np.isfinite(reading).sum()) < 20:
        return None
    usable = np.isfinite(reading) & ~clipped(reading) & before_overturning(test.time, reading, balance)
    rotation = np.where(usable, reading, np.nan)
    if int(usable.sum()) < 20:
        return None
    lean, sd = 0.0, 0.0
    if test.kind == "free":
        lean, sd = _lean(test, rotation, noise)
    return Record(index, test.kind, test.time, rotation, noise, lean, sd, segment(test.time, rotation, noise))


def _lean(test: Test, rotation: Array, noise: float) -> tuple[float, float]:
    """Lean at release and its standard deviation [rad]: from the first samples, or as it was aimed at."""
    found = state(test.time, rotation, float(test.time[0]), noise, widest=0.1)
    if found is None:
        return float(test.initial_rotation or 0.0), RELEASE_SD
    return found.rotation, max(2.0 * math.sqrt(float(found.covariance[0, 0])), 0.5 * noise)


def _cut(record: Record, number: int, start: float, stop: float) -> tuple[Array, Array]:
    first, last = np.searchsorted(record.time, [start - 1e-12, stop + 1e-12])
    part = slice(int(first), int(last))
    there = np.isfinite(record.rotation[part])
    return np.ascontiguousarray(record.time[part][there]), np.ascontiguousarray(record.rotation[part][there])


def _anchors(record: Record) -> list[list[tuple[float, float, float]]]:
    """Rows of (time, rotation, velocity) at consecutive peaks with nothing unseen between them."""
    rows: list[list[tuple[float, float, float]]] = [[]]
    ending = {impact.swing for impact in record.found.impacts}
    for k, swing in enumerate(record.found.swings):
        low, high = record.found.bounds(k)
        at_start = swing.start == 0 and record.kind == "free"
        usable = (swing.turns or at_start) and abs(swing.peak) > PEAK_OVER_NOISE * record.noise
        if k > 0 and k - 1 not in ending and rows[-1]:
            rows.append([])
        if not usable:
            if rows[-1]:
                rows.append([])
            continue
        found = state(record.time, record.rotation, swing.peak_time, record.noise, low=low, high=high)
        if found is not None:
            rows[-1].append((swing.peak_time, found.rotation, 0.0 if at_start else found.velocity))
    return [row for row in rows if len(row) > 1]


def swing_windows(records: Sequence[Record], swings: int = 1) -> list[Window]:
    """Windows from one peak to the one `swings` further on; the state at the start is free."""
    windows = []
    for number, record in enumerate(records):
        for row in _anchors(record):
            for k in range(0, len(row) - 1, swings):
                start, theta, omega = row[k]
                stop = row[min(k + swings, len(row) - 1)][0]
                times, data = _cut(record, number, start, stop)
                if times.size >= 8:
                    windows.append(
                        Window(number, record.test, start, times, data, record.noise, theta, omega, math.inf, math.inf)
                    )
    return windows


def whole_windows(records: Sequence[Record]) -> list[Window]:
    """Each record from its start: from rest, or from a lean that is known only so well."""
    windows = []
    for number, record in enumerate(records):
        times, data = _cut(record, number, float(record.time[0]), float(record.time[-1]))
        windows.append(
            Window(
                number, record.test, float(record.time[0]), times, data, record.noise, record.lean, 0.0,
                record.lean_sd, 0.0, record.lean,
            )
        )  # fmt: skip
    return windows
