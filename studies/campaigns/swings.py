"""A rotation record taken apart: swings to one side, the impacts between them, and stretches of rest.

A swing is a row of samples on one side of upright, beyond `CLOSE` standard deviations of the noise, whose peak is
beyond `OPEN` of them (two thresholds, so that noise about upright makes no swings).  Between two swings to opposite
sides that follow each other at once the block struck the floor; the time of the impact and the angular velocities
before and after it come from local fits on either side.

Status   an impact after which the block stays within the noise is not seen; nor is one in a gap of the record.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from studies.campaigns.gaps import runs
from studies.campaigns.model import Array
from studies.campaigns.smoothing import State, state

OPEN = 6.0
CLOSE = 2.0

LONGEST_PASSAGE = 0.06
"""Time [s] from the last sample of a swing to the first of the next up to which they belong to one impact."""

LEAST_REST = 0.1
"""Time [s] within the noise that counts as rest."""


@dataclass(frozen=True)
class Swing:
    """A swing to one side: samples `start` to `stop` (excluded), and its largest rotation.

    `turns` says whether the block was seen to turn there (its velocity passes zero), rather than the largest rotation
    standing at a gap or an end of the record, or in a fall.
    """

    side: int  # +1 or -1
    start: int
    stop: int
    peak_time: float  # [s]
    peak: float  # [rad], signed, from a local fit
    peak_sd: float  # [rad]
    turns: bool


@dataclass(frozen=True)
class Impact:
    """An impact: when, and the angular velocities [rad/s] before and after it with their standard deviations."""

    time: float
    time_sd: float
    before: float
    before_sd: float
    after: float
    after_sd: float
    swing: int  # number of the swing that it ends

    @property
    def restitution(self) -> tuple[float, float]:
        """Angular velocity after over before, eq. (4), and its standard deviation [1]."""
        e = self.after / self.before
        return e, math.hypot(self.after_sd / self.before, e * self.before_sd / self.before)


def mean_restitution(impacts: Sequence[Impact]) -> tuple[float, float]:
    """One restitution for all impacts, eq. (4), and its standard deviation [1]; NaN where there are none.

    The slope of the velocities after on those before, both noisy: least squares with the weights of Deming's
    regression and the squares of the velocities before put right for their noise, which else makes the slope small.
    """
    rows = np.array([(i.before, i.before_sd, i.after, i.after_sd) for i in impacts], dtype=np.float64).reshape(-1, 4)
    rows = rows[np.isfinite(rows).all(axis=1)]
    # Velocities within their noise hold no more than that.
    rows = rows[np.abs(rows[:, 0]) > 3.0 * rows[:, 1]]
    if not rows.size:
        return math.nan, math.nan
    before, before_sd, after, after_sd = rows.T
    e = 1.0
    for _ in range(5):
        weight = 1.0 / (after_sd**2 + (e * before_sd) ** 2)
        e = float(np.sum(weight * before * after) / np.sum(weight * (before**2 - before_sd**2)))
    return e, 1.0 / math.sqrt(float(np.sum(weight * before**2)))


@dataclass(frozen=True)
class Segmentation:
    """Swings and impacts in the order of time, and (start, stop) samples of rest."""

    swings: tuple[Swing, ...]
    impacts: tuple[Impact, ...]
    rests: tuple[tuple[int, int], ...]

    def bounds(self, swing: int) -> tuple[float, float]:
        """Times [s] of the impacts that begin and end a swing; infinite where none was seen."""
        ending = {impact.swing: impact.time for impact in self.impacts}
        return ending.get(swing - 1, -math.inf), ending.get(swing, math.inf)


def segment(time: Array, rotation: Array, noise: float, *, zero: float = 0.0, rest: float = LEAST_REST) -> Segmentation:
    """Swings, impacts and rest in a record.

    Args:
        time, rotation: the record [s, rad], shape (time,), NaN where missing.
        noise: one standard deviation [rad], positive.
        zero: reading at rest [rad].
        rest: shortest time within the noise that counts as rest [s].

    Raises:
        ValueError: the noise is not positive or the shapes differ.
    """
    if not (math.isfinite(noise) and noise > 0.0):
        raise ValueError(f"noise={noise!r} rad: want a positive number")
    if time.shape != rotation.shape or time.ndim != 1:
        raise ValueError(f"rotation: has shape {rotation.shape}, want {time.shape} as of the times")
    there = np.flatnonzero(np.isfinite(rotation))
    t, x = time[there], rotation[there] - zero
    pieces = _pieces(t, x, noise)
    impacts = _impacts(t, x, noise, pieces)
    ending = {impact.swing: impact.time for impact in impacts}
    swings = []
    for k, (side, a, b) in enumerate(pieces):
        low, high = ending.get(k - 1, -math.inf), ending.get(k, math.inf)
        when, peak, sd, turns = _peak(t, side * x, a, b, noise, low, high)
        swings.append(Swing(side, int(there[a]), int(there[b - 1]) + 1, when, side * peak + zero, sd, turns))
    still = [(a, b) for a, b in runs(np.abs(x) <= 4.0 * noise) if t[b - 1] - t[a] >= rest]
    return Segmentation(tuple(swings), tuple(impacts), tuple((int(there[a]), int(there[b - 1]) + 1) for a, b in still))


def _pieces(t: Array, x: Array, noise: float) -> list[tuple[int, int, int]]:
    """(side, start, stop) of the swings, among the samples that are there."""
    hidden = np.flatnonzero(np.diff(t) > LONGEST_PASSAGE) + 1
    found = []
    for side in (1, -1):
        for a, b in runs(side * x > CLOSE * noise):
            cuts = [a, *[int(c) for c in hidden if a < c < b], b]
            found += [(side, i, j) for i, j in pairwise(cuts) if np.max(side * x[i:j]) > OPEN * noise]
    return sorted(found, key=lambda piece: piece[1])


def _impacts(t: Array, x: Array, noise: float, pieces: list[tuple[int, int, int]]) -> list[Impact]:
    found = []
    for k, ((side, a, b), (other, c, d)) in enumerate(pairwise(pieces)):
        if other == side or t[c] - t[b - 1] > LONGEST_PASSAGE:
            continue
        guess = _crossing(t, x, b - 1, c)
        impact = _impact(t[a:d], x[a:d], noise, guess, k)
        if impact is not None:
            found.append(impact)
    return found


def _crossing(t: Array, x: Array, last: int, first: int) -> float:
    """Where the straight line between the last sample of a swing and the first of the next is zero."""
    return float(t[last] - x[last] * (t[first] - t[last]) / (x[first] - x[last]))


def _impact(t: Array, x: Array, noise: float, guess: float, k: int) -> Impact | None:
    """The impact near `guess`: the zeros of a fit before and of one after it, weighed by their variances."""
    when = guess
    for _ in range(3):
        sides = (state(t, x, when, noise, high=when), state(t, x, when, noise, low=when))
        zeros = [_zero(s) for s in sides if s is not None]
        if not zeros:
            return None
        weights = [1.0 / v for _, v in zeros]
        moved = sum(w * z for w, (z, _) in zip(weights, zeros, strict=True)) / sum(weights)
        # A fit that puts the impact beyond the samples about it was misled by noise.
        when = min(max(moved, guess - LONGEST_PASSAGE / 2.0), guess + LONGEST_PASSAGE / 2.0)
    before, after = sides
    rates = [
        (math.nan, math.nan) if s is None else (s.velocity, math.sqrt(s.covariance[1, 1])) for s in (before, after)
    ]
    return Impact(when, math.sqrt(1.0 / sum(weights)), *rates[0], *rates[1], k)


def _zero(s: State) -> tuple[float, float]:
    """Time [s] at which a fit is zero (one step of Newton), and its variance [s^2]."""
    rate = s.velocity if abs(s.velocity) > 1e-12 else 1e-12
    return s.time - s.rotation / rate, float(s.covariance[0, 0]) / rate**2


def _peak(
    t: Array, x: Array, a: int, b: int, noise: float, low: float, high: float
) -> tuple[float, float, float, bool]:
    """(time [s], rotation [rad], its standard deviation, whether it turns) of a swing to the positive side."""
    top = a + int(np.argmax(x[a:b]))
    when = float(t[top])
    low, high = max(low, float(t[a])), min(high, float(t[b - 1]))
    for _ in range(2):
        fit = state(t, x, when, noise, low=low, high=high)
        if fit is None:
            return float(t[top]), float(x[top]), noise, False
        # The top of the parabola; at a release the record starts there, which leaves the first sample.
        shift = -fit.velocity / fit.acceleration if fit.acceleration < 0.0 else 0.0
        when = float(np.clip(when + np.clip(shift, -fit.reach, fit.reach), t[a], t[b - 1]))
    fit = state(t, x, when, noise, low=low, high=high)
    if fit is None:
        return float(t[top]), float(x[top]), noise, False
    # The top is known to about a sample.
    slack = abs(fit.acceleration) * float(np.median(np.diff(t[a:b]))) if b - a > 1 else 0.0
    turns = abs(fit.velocity) <= 4.0 * math.sqrt(float(fit.covariance[1, 1])) + slack
    return when, fit.rotation, math.sqrt(float(fit.covariance[0, 0])), turns


def states(
    time: Array, rotation: Array, at: Array, noise: float, found: Segmentation, *, zero: float = 0.0
) -> list[State | None]:
    """Rotation [rad] and velocity [rad/s] at each of `at` [s], from samples of the same swing; None where too few.

    At the time of an impact the motion after it is meant.
    """
    edges = np.array([impact.time for impact in found.impacts])
    out = []
    for when in np.atleast_1d(at):
        k = int(np.searchsorted(edges, when, side="right"))
        low = float(edges[k - 1]) if k > 0 else -math.inf
        high = float(edges[k]) if k < edges.size else math.inf
        out.append(state(time, rotation - zero, float(when), noise, low=low, high=high))
    return out
