"""Missing samples: where they are, and base motions made whole where that is safe.

A gap of the base is filled with the cubic spline through its neighbours when it is short, and refused otherwise: the
block feels every sample of the base, and nobody knows what was in a long gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studies.campaigns.errors import CampaignError
from studies.campaigns.model import Array, Test

LONGEST_FILL = 0.025
"""Longest gap that is filled [s]: a quarter of a period at 10 Hz, where ground motion and tables have little left."""

ALWAYS = 2
"""Missing samples in a row that are filled whatever they last."""


@dataclass(frozen=True)
class Gap:
    """Missing samples `start` to `stop` (excluded)."""

    start: int
    stop: int

    @property
    def size(self) -> int:
        """Number of missing samples."""
        return self.stop - self.start

    def too_long(self, step: float, longest: float) -> bool:
        """Whether it is not filled: more than `ALWAYS` samples, longer than `longest` [s]; step: of the record [s]."""
        return self.size > ALWAYS and (self.size + 1) * step > longest * (1.0 + 1e-9)


def runs(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """(start, stop) of each row of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def gaps(values: Array) -> list[Gap]:
    """Where samples are missing, in order."""
    return [Gap(a, b) for a, b in runs(~np.isfinite(values))]


def interpolated(values: Array) -> Array:
    """`values` with its inner gaps on the cubic spline through the other samples; the ends stay as they are."""
    from scipy.interpolate import CubicSpline

    there = np.flatnonzero(np.isfinite(values))
    if there.size < 4 or there.size == values.size:
        return values.copy()
    inner = np.arange(there[0], there[-1] + 1)
    missing = inner[~np.isfinite(values[inner])]
    whole = values.copy()
    whole[missing] = CubicSpline(there, values[there])(missing)
    return whole


def fill_error(values: Array, size: int, trials: int = 200) -> float:
    """RMS error of filling a gap of `size` samples, from leaving out known ones in places spread over the record.

    NaN where the record has no whole stretch that is long enough.
    """
    reach = size + 12
    starts = np.linspace(0, values.size - reach, trials).astype(int) if values.size > reach else np.empty(0, int)
    errors = []
    for start in np.unique(starts):
        piece = values[start : start + reach]
        if not np.isfinite(piece).all():
            continue
        holed = piece.copy()
        holed[6 : 6 + size] = np.nan
        errors.append(interpolated(holed)[6 : 6 + size] - piece[6 : 6 + size])
    return float(np.sqrt(np.mean(np.square(errors)))) if errors else float("nan")


def whole_base(test: Test, name: str, longest: float = LONGEST_FILL) -> Array:
    """A base channel of a test with its short gaps filled, shape (time,).

    Args:
        test: the test.
        name: of the channel.
        longest: gap [s] up to which samples are filled.

    Raises:
        CampaignError: a gap is longer, or lies at an end of the record.
    """
    values = test.data[name]
    found = gaps(values)
    for gap in found:
        at_end = gap.start == 0 or gap.stop == values.size
        if at_end or gap.too_long(test.time_step, longest):
            place = "at an end of the record" if at_end else f"in a row, longer than {longest:g} s"
            raise CampaignError(
                f"test {test.id!r}: {name} has {gap.size} samples missing from {test.time[gap.start]:.6g} s on, "
                f"{place}, want a base motion that can be made whole"
            )
    return interpolated(values) if found else values
