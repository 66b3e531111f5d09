"""Many blocks at a time through the nonlinear Method 1: maps, spectra and fragilities from arrays of numbers.

>>> from rocking.solvers.exact.batch import RampedSines
>>> from rocking.solvers.arrays import taylor_batch
>>> waves = RampedSines(omega=[6.0, 12.0], rate=1.5, duration=10.0)
>>> taylor_batch(waves, p=5.3, alpha=0.29, e=0.88, t_end=10.0).overturned.shape
(2,)

Source   as of `rocking.solvers.taylor`.
Status   gives the bits of `solve(..., solver="taylor")`, whatever the number of threads.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from rocking.block import G_STANDARD
from rocking.solvers.exact.batch import (
    ExactBatchResult,
    RampedSines,
    ScaledRecord,
    block_columns,
    carry_arrays,
    motion_columns,
    start_columns,
)


def taylor_batch(
    motion: RampedSines | ScaledRecord,
    *,
    p: ArrayLike,
    alpha: ArrayLike,
    e: ArrayLike,
    t_end: ArrayLike,
    t_start: ArrayLike = 0.0,
    theta: ArrayLike = 0.0,
    omega: ArrayLike = 0.0,
    g: ArrayLike = G_STANDARD,
    rest_speed: ArrayLike = 1e-6,
    max_events: int = 1_000_000,
    workers: int | None = None,
) -> ExactBatchResult:
    """Carry many blocks, each to its fall or to t_end, by the nonlinear Method 1; rocking starts by West's formula.

    Arguments, result and errors are those of `rocking.solvers.exact.batch.exact_batch`, which is the linear one.
    """
    groups = [
        block_columns(p, alpha, g, np.tan(np.asarray(alpha, np.float64)), e, rest_speed),
        start_columns(theta, omega, t_start, t_end),
        motion_columns(motion),
    ]
    return carry_arrays("nonlinear", motion, groups, max_events, workers)
