"""Amplitudes that rise, fall and wander: half cosine waves as formulas that compile, and random departures."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

DEPARTURE_TERMS = 8
"""Number of cosines that make up the departure of an envelope."""

MAX_IMPERFECTION = 0.25
"""Largest admissible size; the departure's peaks are two to three times it, and the envelope stays positive."""


def departure(size: float, shortest: float, duration: float, seed: int) -> NDArray[np.float64]:
    """Cosines of a smooth random departure r(t) of an envelope from what it should be.

    Rows of amplitude, angular frequency [rad/s] and phase [rad], shape (term, 3): r(t) is the sum of their cosines, its
    rms from 0 to `duration` [s] is `size`, none is shorter than `shortest` [s], and 1 + r stays positive.
    """
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, duration, 4001)
    rows = np.ones((DEPARTURE_TERMS, 3))
    while True:
        rows[:, 1] = 2.0 * math.pi * rng.uniform(0.0, 1.0 / shortest, DEPARTURE_TERMS)
        rows[:, 2] = rng.uniform(0.0, 2.0 * math.pi, DEPARTURE_TERMS)
        r = np.cos(rows[:, 1, None] * t + rows[:, 2, None]).sum(axis=0)
        # Random phases give the stated rms on average only: scale this draw to have it exactly, and draw
        # again in the rare case that the envelope would turn negative somewhere.
        amplitude = size / math.sqrt(float(np.mean(r * r)))
        if np.min(1.0 + amplitude * r) > 0.0:
            break
    rows[:, 0] = amplitude
    return rows


def rising(xp: Any, t: Any, start: Any, length: Any) -> Any:
    """0 until `start`, 1 from `start + length` on, half a cosine wave between; a jump if `length` is 0."""
    safe = xp.where(length > 0.0, length, 1.0)
    share = xp.minimum(xp.maximum((t - start) / safe, 0.0), 1.0)
    smooth = 0.5 * (1.0 - xp.cos(math.pi * share))
    return xp.where(length > 0.0, smooth, xp.where(t >= start, 1.0, 0.0))


def falling(xp: Any, t: Any, start: Any, length: Any) -> Any:
    """1 until `start`, 0 from `start + length` on, half a cosine wave between; a jump if `length` is 0."""
    safe = xp.where(length > 0.0, length, 1.0)
    share = xp.minimum(xp.maximum((t - start) / safe, 0.0), 1.0)
    smooth = 0.5 * (1.0 + xp.cos(math.pi * share))
    return xp.where(length > 0.0, smooth, xp.where(t <= start, 1.0, 0.0))


def window_rates(xp: Any, t: Any, duration: Any, rise: Any, fall: Any) -> tuple[Any, Any, Any]:
    """`window` with its first [1/s] and second [1/s^2] derivatives; `rise` and `fall` positive.

    The first is continuous; the second jumps where the tapers begin and end.
    """
    a, b = math.pi / rise, math.pi / fall
    up = a * xp.minimum(xp.maximum(t, 0.0), rise)
    down = b * xp.minimum(xp.maximum(t - duration + fall, 0.0), fall)
    r, f = 0.5 * (1.0 - xp.cos(up)), 0.5 * (1.0 + xp.cos(down))
    rises, falls = (t >= 0.0) & (t <= rise), (t >= duration - fall) & (t <= duration)
    r1, f1 = xp.where(rises, 0.5 * a * xp.sin(up), 0.0), xp.where(falls, -0.5 * b * xp.sin(down), 0.0)
    r2, f2 = xp.where(rises, 0.5 * a * a * xp.cos(up), 0.0), xp.where(falls, -0.5 * b * b * xp.cos(down), 0.0)
    return r * f, r1 * f + r * f1, r2 * f + 2.0 * r1 * f1 + r * f2


def modulated(xp: Any, envelope: tuple[Any, Any, Any], phase: tuple[Any, Any, Any]) -> tuple[Any, Any]:
    """(E sin phi, its second derivative) from E and phi with their first two derivatives."""
    sine, cosine = xp.sin(phase[0]), xp.cos(phase[0])
    second = envelope[1] * phase[1] * 2.0 + envelope[0] * phase[2]
    return envelope[0] * sine, (envelope[2] - envelope[0] * phase[1] * phase[1]) * sine + second * cosine


def window(xp: Any, t: Any, duration: Any, rise: Any, fall: Any) -> Any:
    """0 before 0 and after `duration`, rising in the first `rise` and falling in the last `fall` of it."""
    return rising(xp, t, 0.0, rise) * falling(xp, t, duration - fall, fall)
