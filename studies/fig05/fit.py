"""Free vibration of one block by Method 1 and by distinct elements, and the dashpot with which they come closest.

Source   Winkler, Meguro & Yamazaki (1995), "Material parameters": the damping whose history of the horizontal
         displacement of the middle of the top comes closest
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

import dem
from rocking import Block, Method1, solve
from studies.criteria.free_vibration import scene_of

FloatArray = NDArray[np.float64]
SAMPLE = 5e-3  # [s]
SWINGS = 4


class Fit(NamedTuple):
    """Dashpot [N s/m], and the misfit with it."""

    damping: float
    misfit: float


class Measured(NamedTuple):
    """Frequency of the first four swings [Hz], largest tilt of the fourth [rad], rms change of the curve [m]."""

    frequency: float
    peak: float
    change: float


@dataclass(frozen=True)
class Released:
    """A block let go at a share of its tilt of unstable balance, watched until t_end [s]."""

    block: Block
    release: float
    t_end: float

    @property
    def tilt(self) -> float:
        """At release [rad]."""
        return self.release * self.block.alpha

    @cached_property
    def times(self) -> FloatArray:
        """Of the samples [s]."""
        return np.arange(0.0, self.t_end + 0.5 * SAMPLE, SAMPLE)

    def method1(self, restitution: float) -> FloatArray:
        """Displacement of the middle of the top by nonlinear Method 1 [m]: it stands for the experiment."""
        model = Method1(self.block, restitution=restitution, form="nonlinear")
        run = solve(model, theta=self.tilt, t_end=self.t_end, save_at=self.times)
        theta = np.abs(run.theta)
        # About the corner on which it leans: half the breadth turns up, the height over.
        away = 0.5 * self.block.b * (1.0 - np.cos(theta)) + self.block.h * np.sin(theta)
        return np.copysign(away, run.theta)

    def run(self, damping: float, stiffness: float) -> dem.History:
        """By distinct elements; dashpot [N s/m] and stiffness [N/m], both ways."""
        return dem.let_go(
            scene_of(self.block), self.tilt, t_end=self.t_end, damping=damping, kn=stiffness, ks=stiffness,
        )  # fmt: skip

    def top(self, history: dem.History) -> FloatArray:
        """Displacement of the middle of the top at the samples [m]."""
        return np.interp(self.times, history.time, dem.top_displacement(history))

    def elements(self, damping: float, stiffness: float) -> FloatArray:
        """The same of a new run."""
        return self.top(self.run(damping, stiffness))

    def dashpot(self, ratio: float, stiffness: float) -> float:
        """Dashpot [N s/m] of a share of critical damping."""
        return 2.0 * ratio * math.sqrt(stiffness * self.block.mass)


def rms(difference: FloatArray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(difference**2)))


def misfit(released: Released, target: FloatArray, ratio: float, stiffness: float) -> float:
    """Root mean square difference from the target, over its displacement at release."""
    return rms(released.elements(released.dashpot(ratio, stiffness), stiffness) - target) / abs(float(target[0]))


def fitted(released: Released, target: FloatArray, ratios: Sequence[float], stiffness: float) -> Fit:
    """The dashpot whose curve comes closest: the best of these shares of critical damping, then refined beside it."""
    tried = [misfit(released, target, ratio, stiffness) for ratio in ratios]
    at = int(np.argmin(tried))
    low, high = ratios[max(0, at - 1)], ratios[min(len(ratios) - 1, at + 1)]
    found = minimize_scalar(
        lambda log: misfit(released, target, math.exp(log), stiffness), bounds=(math.log(low), math.log(high)),
        method="bounded", options={"xatol": 1e-3},
    )  # fmt: skip
    ratio, least = min([(math.exp(found.x), float(found.fun)), (ratios[at], tried[at])], key=lambda pair: pair[1])
    return Fit(released.dashpot(ratio, stiffness), least)


def measured(history: dem.History, curve: FloatArray, released: Released) -> Measured:
    """What changed, against a curve [m]."""
    passages, peaks = dem.swings(history.time, history.theta)
    change = rms(released.top(history) - curve)
    if len(passages) < SWINGS:
        return Measured(math.nan, math.nan, change)
    return Measured(0.5 * (SWINGS - 1) / (passages[SWINGS - 1] - passages[0]), float(peaks[SWINGS - 1]), change)
