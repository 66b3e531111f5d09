"""Does the block rock the way the recorded base drives it?  A regression that tells signs and gross units.

Between impacts a block obeys theta'' + p^2 s (1 + a_z/g) sin(alpha - s theta) = -p^2 (a_x/g) cos(alpha - s theta), with
s the side it leans to.  Multiplied by a smooth bump and integrated over a short window of a swing, theta'' becomes
theta times the bump's second derivative, so that a noisy rotation need not be differentiated.  Left side against right
side over the windows of a test give a slope: one for a block as declared under the base as recorded, minus one
where one of the two has the wrong sign, 9.8 where the base is in g.

Source   equations (2) and (3) of Winkler, Meguro & Yamazaki (1995), nonlinear form; Messenger & Bortz
         (2021) for regression on the weak form.
Status   a test for factors and signs.  What the ideal block lacks moves the slope: a base that is recorded 5 % too
         large by 5 %, a pitching table by tens of per cent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rocking import G_STANDARD
from studies.campaigns.gaps import interpolated
from studies.campaigns.model import Array, DeclaredBlock, Test
from studies.campaigns.noise import Noise
from studies.campaigns.swings import Segmentation, segment

HALF_WINDOW = 0.05
"""Half-length of a bump [s]; half a swing where that is shorter."""

LEAST_WINDOWS = 8
"""Fewer say nothing."""

OPPOSED = -0.8
"""Correlation below which the sign of a test is clearly wrong: a whole sign apart from the right one (1)."""


@dataclass(frozen=True)
class Drive:
    """Slope and correlation of the drive that the block shows on the drive that the base record gives."""

    slope: float
    correlation: float
    windows: int

    @property
    def opposed(self) -> bool:
        """Whether base and rotation clearly have contradictory signs."""
        return self.windows >= LEAST_WINDOWS and self.correlation < OPPOSED


def drive(test: Test, block: DeclaredBlock, noise: Noise) -> Drive | None:
    """The regression over a test; None where rotation or base was not measured or too few windows are whole.

    Args:
        test: a forced test.
        block: as declared.
        noise: of the rotation.
    """
    rotation, a_x = test.rotation, test.base_x
    if rotation is None or a_x is None or not noise.value > 0.0:
        return None
    zero = 0.0 if math.isnan(noise.level) else noise.level
    theta = interpolated(rotation) - zero
    found = segment(test.time, rotation, noise.value, zero=zero)
    base_z = np.zeros_like(a_x) if test.base_z is None else np.nan_to_num(test.base_z)
    felt, driven = _windows(test.time_step, theta, a_x, base_z, block, found)
    if felt.size < LEAST_WINDOWS or not np.any(driven) or not np.any(felt):
        return None
    across = float(felt @ driven)
    return Drive(
        across / float(driven @ driven), across / math.sqrt(float(felt @ felt) * float(driven @ driven)), felt.size
    )


def _windows(
    step: float, theta: Array, a_x: Array, a_z: Array, block: DeclaredBlock, found: Segmentation
) -> tuple[Array, Array]:
    """What the block felt and what the base drove it with, in each window of each swing."""
    p2 = block.p() ** 2
    felt, driven = [], []
    for swing in found.swings:
        inner = slice(swing.start + 2, swing.stop - 2)
        half = min(round(HALF_WINDOW / step), (inner.stop - inner.start - 1) // 2)
        # A block that falls obeys the same equation, but the floor of the tests need not be there for it.
        if half < 3 or np.nanmax(np.abs(theta[swing.start : swing.stop])) > 1.5 * block.alpha:
            continue
        bump, curvature = _bump(half, step)
        for middle in range(inner.start + half, inner.stop - half, half):
            w = slice(middle - half, middle + half + 1)
            lean = block.alpha - swing.side * theta[w]
            back = p2 * swing.side * (1.0 + a_z[w] / G_STANDARD) * np.sin(lean)
            felt.append(step * float(theta[w] @ curvature + back @ bump))
            driven.append(-step * p2 / G_STANDARD * float((a_x[w] * np.cos(lean)) @ bump))
    pairs = np.array([felt, driven]).reshape(2, -1)
    pairs = pairs[:, np.isfinite(pairs).all(axis=0)]
    return pairs[0], pairs[1]


def _bump(half: int, step: float) -> tuple[Array, Array]:
    """(1 - u^2)^4 on a window of 2 half + 1 samples, and its second derivative in time [1/s^2]."""
    u = np.arange(-half, half + 1) / half
    v = 1.0 - u**2
    return v**4, (48.0 * u**2 * v**2 - 8.0 * v**3) / (half * step) ** 2
