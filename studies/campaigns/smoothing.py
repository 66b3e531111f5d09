"""Rotation and angular velocity at a given time from noisy samples, with their covariance.

A cubic is fitted by least squares to the samples about the time, on one side of an impact if one is near.  The
stretch grows while a cubic still fits to the noise (chi-square) and its rotation and velocity agree with those of all
shorter stretches, so the fit uses as many samples as the motion allows.

Source   Fan & Gijbels (1996), Local Polynomial Modelling and Its Applications, for local fits; Goldenshluger &
         Nemirovski (1997) for the stretch (intersection of confidence intervals).
Status   the covariance is that of the noise alone; the bias of the cubic adds up to a third to the standard deviation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studies.campaigns.model import Array

DEGREE = 3
LEAST = 7
"""Samples of the shortest stretch."""

TOLERATED = 2.0
"""Standard deviations by which chi-square may exceed its mean where a cubic counts as fitting."""

HOPELESS = 6.0
"""Standard deviations beyond which no longer stretch is tried; up to there noise may have had a bad moment."""

AGREE = 1.25
"""Standard deviations about the estimates of all shorter stretches that have to have a common point with this one's."""

BACK_OFF = 0.65
"""Share of the widest stretch that fits which is used: bias falls faster than noise rises.

This and `AGREE` were chosen on simulated free and forced runs, so that errors are 1.0 to 1.3 of their stated standard
deviations.
"""

GROWTH = 1.25


@dataclass(frozen=True)
class State:
    """Rotation [rad] and angular velocity [rad/s] at a time [s], their covariance (2, 2), and what they rest on."""

    time: float
    rotation: float
    velocity: float
    covariance: NDArray[np.float64]
    acceleration: float  # [rad/s^2], of the fitted cubic at the time
    reach: float  # half-length of the stretch [s]
    samples: int


def state(
    time: Array, rotation: Array, at: float, noise: float, *,
    low: float = -math.inf, high: float = math.inf, widest: float = 0.15,
) -> State | None:  # fmt: skip
    """The motion at `at` [s] from the samples between `low` and `high` [s]; None where there are too few near it.

    Args:
        time, rotation: the record [s, rad], shape (time,), NaN where missing.
        at: the time [s]; may lie between `low` and `high` or at one of them.
        noise: one standard deviation [rad], positive.
        low, high: times [s] of the impacts around, beyond which another motion goes on.
        widest: half-length of the longest stretch [s].

    Raises:
        ValueError: the noise is not positive.
    """
    if not (math.isfinite(noise) and noise > 0.0):
        raise ValueError(f"noise={noise!r} rad: want a positive number")
    first, last = np.searchsorted(time, [max(low, at - widest), min(high, at + widest)])
    t, x = time[first : last + 1], rotation[first : last + 1]
    usable = np.isfinite(x) & (t >= low) & (t <= high)
    t, x = t[usable], x[usable]
    distance = np.sort(np.abs(t - at))
    if distance.size < LEAST or distance[0] > 0.25 * widest:
        return None
    best = None
    low_ends, high_ends = np.full(2, -np.inf), np.full(2, np.inf)
    count = LEAST
    while count <= distance.size:
        fit, excess = _fitted(t, x, at, float(distance[count - 1]), noise)
        found, sd = np.array([fit.rotation, fit.velocity]), np.sqrt(np.diag(fit.covariance))
        low_ends, high_ends = np.maximum(low_ends, found - AGREE * sd), np.minimum(high_ends, found + AGREE * sd)
        if best is not None and (excess > HOPELESS or np.any(low_ends > high_ends)):
            break
        best = fit if best is None or excess <= TOLERATED else best
        count = max(count + 1, math.ceil(count * GROWTH))
    if best is None:
        return None
    used = max(LEAST, round(BACK_OFF * best.samples))
    return _fitted(t, x, at, float(distance[used - 1]), noise)[0]


def _design(t: Array, at: float, reach: float) -> Array:
    return np.vander((t - at) / reach, DEGREE + 1, increasing=True)


def _near(t: Array, x: Array, at: float, reach: float) -> tuple[Array, Array]:
    near = np.abs(t - at) <= reach * (1.0 + 1e-12)
    return t[near], x[near]


def _fitted(t: Array, x: Array, at: float, reach: float, noise: float) -> tuple[State, float]:
    """The fit, and the standard deviations by which its chi-square exceeds the mean."""
    t, x = _near(t, x, at, reach)
    design = _design(t, at, reach)
    normal = np.linalg.inv(design.T @ design)
    c = normal @ (design.T @ x)
    freedom = t.size - DEGREE - 1
    excess = (float(np.sum((x - design @ c) ** 2)) / noise**2 - freedom) / math.sqrt(2.0 * freedom)
    scale = np.array([1.0, 1.0 / reach])
    spread = np.asarray(noise**2 * normal[:2, :2] * np.outer(scale, scale), dtype=np.float64)
    fit = State(at, float(c[0]), float(c[1] / reach), spread, float(2.0 * c[2] / reach**2), reach, t.size)
    return fit, excess
