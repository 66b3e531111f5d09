"""A body leaned to one side and let go: displacement of its top, passages through upright, and peaks of its swings.

Source  Winkler, Meguro & Yamazaki (1995), "Material parameters" and Fig. 5: one base edge of a block is lifted, the
        block is released, and the horizontal displacement of the middle of its top is compared over 7 s
Status  first passage against Housner's quarter period (tests)
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from dem import checks
from dem.arrays import IntArray
from dem.history import History
from dem.scenes import Scene
from dem.shapes import FloatArray
from dem.simulate import simulate
from dem.stability import critical_step

FRICTION = 10.0  # so rough a floor that nothing but the dashpots and the landings takes energy


class Swings(NamedTuple):
    """Passages through upright [s], shape (passage,); largest tilts before the first of them and between each and the
    next [rad], shape (passage,)."""

    passages: FloatArray
    peaks: FloatArray

    def __repr__(self) -> str:
        until = f" until {self.passages[-1]:.4g} s" if len(self.passages) else ""
        largest = f", largest tilt {max(self.peaks):.4g} rad" if len(self.peaks) else ""
        return f"<Swings: {len(self.passages)} passages{until}{largest}>"


def let_go(
    scene: Scene, tilt: float, *, t_end: float, damping: float, kn: float = 1.98e7, ks: float = 1.98e7,
    dt: float | None = None, g: float = 9.80665, interval: float = 1e-3,
) -> History:  # fmt: skip
    """Free vibration of a body from a tilt [rad] at rest, about the corner on which it would then lean if it had stood
    upright with its centroid at x = 0.

    t_end [s]; damping: dashpot of a corner, both ways [N s/m]; kn, ks: stiffness of a corner [N/m]
    dt: step [s]; None: a twentieth of the critical one; interval: between samples, about [s]; g: gravity [m/s^2]
    Raises ValueError for a bad argument, as `dem.simulate`.
    """
    checks.kind("scene", scene, Scene, "a Scene, as single_block(b, h, d, density) makes it")
    checks.positive("interval", interval, "s")
    checks.finite("tilt", tilt, "rad")
    checks.positive("t_end", t_end, "s")
    if dt is not None:
        checks.positive("dt", dt, "s")
    step = 0.05 * critical_step(scene, kn, ks, damping) if dt is None else dt
    corners = scene.shape.corners
    turned = corners[:, 0] * math.cos(tilt) + corners[:, 1] * math.sin(tilt)
    carries = int(np.argmin(corners[:, 1] * math.cos(tilt) - corners[:, 0] * math.sin(tilt)))
    return simulate(
        scene, t_end=t_end, mu=FRICTION, damping=damping, dt=step, kn=kn, ks=ks, g=g, theta0=tilt,
        x0=float(corners[carries, 0] - turned[carries]),
        save_every=max(1, round(min(interval, t_end) / step)),
    )  # fmt: skip


def top_displacement(history: History) -> FloatArray:
    """Horizontal displacement of the middle of the top since the block stood upright at x = 0 [m], shape (time,)."""
    corners = history.scene.shape.corners
    top = corners[np.isclose(corners[:, 1], corners[:, 1].max())].mean(axis=0)
    return history.x + top[0] * (np.cos(history.theta) - 1.0) + top[1] * np.sin(history.theta)


def passages(theta: FloatArray) -> IntArray:
    """Indices of the last samples before a rotation [rad], shape (time,), goes to the other side of upright.

    A sample of exactly 0 belongs to the side of the one before it: to touch upright is no passage.
    """
    there = np.flatnonzero(theta != 0.0)
    over = np.flatnonzero(np.diff(np.sign(theta[there])) != 0)
    return there[over + 1] - 1


def swings(time: FloatArray, theta: FloatArray) -> Swings:
    """Passages and peaks of a sampled rotation; time [s] and theta [rad] of shape (time,).

    Raises ValueError unless both are finite and of one such shape.
    """
    time, theta = checks.numbers("time", time), checks.numbers("theta", theta)
    if time.ndim != 1 or time.shape != theta.shape:
        raise ValueError(f"time, theta of shapes {time.shape}, {theta.shape}: want one rotation per time")
    for name, values, unit in (("time", time, "s"), ("theta", theta, "rad")):
        if not np.isfinite(values).all():
            first = int(np.argmin(np.isfinite(values)))
            raise ValueError(f"{name}[{first}]={values[first]} {unit}: want finite numbers")
    upright = passages(theta)
    share = theta[upright] / (theta[upright] - theta[upright + 1])
    tilt = np.abs(theta)
    edges = [0, *upright]
    peaks = [float(tilt[a : b + 1].max()) for a, b in pairwise(edges)]
    return Swings(time[upright] + share * (time[upright + 1] - time[upright]), np.array(peaks))
