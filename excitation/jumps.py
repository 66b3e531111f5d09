"""Samples of a motion that jumps, such that the curve through them gives the base the velocity that the motion does.

A sample stands for the step around it, half of one at either end.  Where a jump J comes d steps after the nearest
sample, it takes the share of J that lies in what it stands for: (1/2 - d) J, and half of J where it falls on the jump.

Source   elementary calculus: a cubic spline and straight lines both have the integral step * sum of samples, but for
         what the ends add.
Status   velocities are those of closed forms; within a few steps of an end a part of the step remains.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from excitation.motion import Motion

NEAR = 1e-6
"""Share of a step at which a motion is looked at beside a place where it may jump."""

LEAST = 1e-4
"""Share of the largest acceleration that is a jump: what is continuous changes by far less within two of NEAR."""


def sampled(motion: Motion, times: NDArray[np.float64], time_step: float) -> NDArray[np.float64]:
    """a_x and a_z [m/s^2] of a motion at equally spaced times [s], two or more, shape (2, time)."""
    plain = np.array(motion(times))
    near = NEAR * time_step
    points = np.array([t for t in motion.breakpoints if times[0] - near <= t <= times[-1] + near])
    before, after = np.array(motion(points - near)), np.array(motion(points + near))
    largest = np.max(np.abs(np.hstack([plain, before, after])), axis=1, keepdims=True)
    made = plain.copy()
    for axis, i in np.argwhere(np.abs(after - before) > LEAST * largest):
        jump = after[axis, i] - before[axis, i]
        k = int(np.argmin(np.abs(times - points[i])))
        late = (points[i] - times[k]) / time_step
        begins, ends = (-0.5 if k > 0 else 0.0), (0.5 if k < times.size - 1 else 0.0)
        share = (ends - late) / (ends - begins)
        # How much of the jump the sample has: on the jump itself all, nothing or half, as the motion has it there.
        on_it = round(2.0 * float((plain[axis, k] - before[axis, i]) / jump)) / 2.0
        has = on_it if abs(late) <= NEAR else float(late < 0.0)
        made[axis, k] += jump * (share - has)
    return made
