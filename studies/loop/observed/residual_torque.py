"""Residual torque: the angular acceleration that a measured motion needs beyond a model's equation of motion along it.

A swing between two impacts is cut into stretches.  In each the model's theta''(theta, omega, base) is taken along the
measured path (a local polynomial through the samples), integrated twice, and taken off the samples; what is left over
has the residual angular acceleration as its curvature, which a parabola fitted by least squares gives.  The smoothing
does not enter as a bias where the model is right, as it would if a curvature of the path itself were compared.

Source   weak form of the equation of motion, as in Messenger & Bortz (2021), weak SINDy.
Status   a known torque is found again, and its stated deviation holds (tests).  The deviation is that of the rotation
         sensor alone.  Models with further freedoms (two springs, sliding) have no torque that is a function of
         rotation and speed: NaN.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rocking.hybrid import ROTATION, Base, Discrete, System, bind_hooks
from rocking.motion import base_at
from rocking.remembering import RememberingBlock
from studies.campaigns.swings import OPEN
from studies.loop.models.model import LoopModel
from studies.loop.observed.windows import Record
from studies.loop.runs.simulation import Simulator

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Parts = list[tuple[Indices, int]]
"""Samples of each stretch, and the side to which the block leans there."""

LENGTH = 0.2
"""Length [s] that stretches have at the most, about: longer ones average what they are to show."""

SHORTEST = 0.05
"""Stretches below this [s] say nothing through the noise."""

LEAST = 12
"""Samples of a stretch at the least."""

DEGREE = 5
"""Of the polynomial that stands for the path within a stretch."""


@dataclass(frozen=True)
class Path:
    """What was measured in the stretches of a record, arrays of shape (stretch,): middle, and means over each."""

    time: Array  # [s]
    theta: Array  # [rad]
    omega: Array  # [rad/s]
    base_x: Array  # recorded horizontal acceleration of the base [m/s^2]
    side: NDArray[np.int64]  # +1 or -1


@dataclass(frozen=True)
class Residual:
    """Angular acceleration beyond the model's [rad/s^2] and its standard deviation, arrays of shape (stretch,)."""

    value: Array
    sd: Array


def stretches(record: Record) -> Parts:
    """(indices of the samples, side) of each stretch of a record, in the order of time."""
    found: Parts = []
    for k, swing in enumerate(record.found.swings):
        low, high = record.found.bounds(k)
        inside = np.arange(swing.start, swing.stop)
        t, x = record.time[inside], record.rotation[inside]
        inside = inside[(t > low) & (t < high) & np.isfinite(x) & (np.abs(x) > OPEN * record.noise)]
        for piece in _unbroken(record.time, inside):
            count = max(1, round(float(record.time[piece[-1]] - record.time[piece[0]]) / LENGTH))
            found += [(part, swing.side) for part in np.array_split(piece, count) if _long_enough(record.time, part)]
    return found


def _unbroken(time: Array, inside: Indices) -> list[Indices]:
    """The samples in rows without a gap of more than two samples."""
    if not inside.size:
        return []
    step = float(np.median(np.diff(time)))
    return np.split(inside, np.flatnonzero(np.diff(time[inside]) > 3.5 * step) + 1)


def _long_enough(time: Array, part: Indices) -> bool:
    return part.size >= LEAST and float(time[part[-1]] - time[part[0]]) >= SHORTEST


def path(record: Record, base_x: Array | None, parts: Parts) -> Path:
    """What was measured in the stretches; the base is at rest where `base_x` [m/s^2] is None."""
    rows = []
    for part, _ in parts:
        t = record.time[part]
        theta, omega = _smooth(t, record.rotation[part])
        felt = 0.0 if base_x is None else float(np.nanmean(base_x[part]))
        rows.append((0.5 * (t[0] + t[-1]), float(np.mean(theta)), float(np.mean(omega)), felt))
    time, theta, omega, base = np.array(rows, dtype=np.float64).reshape(-1, 4).T
    return Path(time, theta, omega, base, np.array([side for _, side in parts], dtype=np.int64))


def residual_torque(model: LoopModel, simulator: Simulator, record: Record, parts: Parts) -> Residual:
    """What the measured motion needs beyond the model in each stretch.

    Args:
        model: whose equation of motion is compared.
        simulator: of the campaign, which has the base motions.
        record: of one of its tests.
        parts: of `stretches`.
    """
    value, sd = np.full(len(parts), np.nan), np.full(len(parts), np.nan)
    model = simulator.in_test(model, record.test)
    if not rocks_alone(model.system):
        return Residual(value, sd)
    motion = model.base(simulator.bases[record.test], simulator.spans[record.test])
    base = base_at(np, motion, record.time, np.asarray(motion.parameters))
    for k, (part, side) in enumerate(parts):
        t, x = record.time[part], model.rotation(record.rotation[part])
        if not np.isfinite(x).all():
            continue  # the sensor of the model cannot say that
        theta, omega = _smooth(t, x)
        there = Base(*(np.broadcast_to(v, record.time.shape)[part] for v in base))
        needed = _acceleration(model, theta, omega, float(side), there)
        value[k], sd[k] = _curvature(t, x - _twice_integrated(t, needed), record.noise / _gain(model, x))
    return Residual(value, sd)


def rocks_alone(system: System) -> bool:
    """Whether rotation and angular velocity, beside what impacts leave behind, are all that moves."""
    return tuple(system.state_names) == ("theta", "omega") or isinstance(system, RememberingBlock)


def _gain(model: LoopModel, theta: Array) -> float:
    """What the sensor makes of a small change about these rotations, on average [1]."""
    return float(np.mean(np.abs(model.reading_slope(theta))))


def with_numpy(par: Any) -> Any:
    """Parameters of a system whose hooks work on arrays."""
    return bind_hooks(par, lambda hook: partial(hook, np))


def _acceleration(model: LoopModel, theta: Array, omega: Array, side: float, base: Base) -> Array:
    system = model.system
    s = np.full(theta.shape, side)
    q = Discrete(np.full(theta.shape, ROTATION), s, np.ones(theta.shape))
    others = [np.zeros(theta.shape)] * (len(system.state_names) - 2)
    rate = system.flow(np, (theta, omega, *others), q, base, with_numpy(system.parameters))[1]
    return np.asarray(rate + np.zeros(theta.shape))


def _scaled(t: Array) -> tuple[Array, float]:
    half = 0.5 * float(t[-1] - t[0])
    return (t - 0.5 * (t[0] + t[-1])) / half, half


def _smooth(t: Array, x: Array) -> tuple[Array, Array]:
    """Rotation and velocity of the polynomial through the samples of a stretch."""
    u, half = _scaled(t)
    c = np.polynomial.legendre.legfit(u, x, DEGREE)
    slope = np.polynomial.legendre.legval(u, np.polynomial.legendre.legder(c)) / half
    return np.asarray(np.polynomial.legendre.legval(u, c)), np.asarray(slope)


def _twice_integrated(t: Array, acceleration: Array) -> Array:
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(t, acceleration).antiderivative(2)(t))


def _curvature(t: Array, left: Array, noise: float) -> tuple[float, float]:
    """Second derivative of the parabola through what is left, and its standard deviation."""
    u, half = _scaled(t)
    design = np.vander(u, 3, increasing=True)
    normal = np.linalg.inv(design.T @ design)
    c = normal @ (design.T @ left)
    return 2.0 * float(c[2]) / half**2, 2.0 * noise * float(np.sqrt(normal[2, 2])) / half**2
