"""Rotation of a block from accelerometers on it, by rigid-body kinematics alone: whatever turns it about a corner.

On the corner of the side s, at (s b / 2, 0), a point at (x, z) of the block reads along an axis (e_x, e_z) of its own

    e_x (A_x cos t - (g + A_z) sin t + t'' z - t'^2 (x - s b / 2))
        + e_z (A_x sin t + (g + A_z) cos t - t'' (x - s b / 2) - t'^2 z),    t the rotation, positive clockwise.

A stretch between two impacts is a spline, zero at either end, with what the base does to any block besides: a share of
the twice integrated record, since jerks of the base are jerks of the block.  So one sensor is enough where both ends
are known; mass, inertia and torques need not be.

Source   kinematics of a rigid body; the readings themselves as in `rocking.instruments`
Status   blocks of another mass and with a torque of their own are got back (tests)
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_simpson
from scipy.interpolate import BSpline

Array = NDArray[np.float64]

DEGREE = 5
"""Of the spline: its second derivative, which is read, is smooth too."""

STEPS = 8
"""Of Gauss and Newton; the readings are nearly linear in the rotation."""


@dataclass(frozen=True)
class Sensor:
    """An accelerometer: its place from the middle of the base [m], its axis in the block, and one sd [m/s^2]."""

    place: tuple[float, float]
    axis: tuple[float, float]
    sd: float


@dataclass(frozen=True)
class Ends:
    """Of a stretch: times of either end [s], whether the block is upright there, and whether it is let go there."""

    begin: float
    end: float
    upright: tuple[bool, bool]
    released: bool
    sd: float  # of the rotation where it is upright [rad]: impacts fall between samples


def turned(
    time: Array, read: Array, sensors: Sequence[Sensor], base: tuple[Array, Array], g: float, corner: float, ends: Ends,
    intervals: int, most: float,
) -> tuple[Array, Array, float]:  # fmt: skip
    """Rotation [rad] and angular speed [rad/s] in a stretch on one corner, and the mean square of what they leave.

    That is infinite, and the block upright, where nothing was read.

    Args:
        time: samples [s], shape (time,).
        read: readings [m/s^2], NaN where missing, shape (sensor, time).
        sensors: what read them.
        base: horizontal and vertical acceleration of the base [m/s^2], each of shape (time,).
        g: gravity [m/s^2].
        corner: place of the corner along the base from its middle [m].
        ends: of the stretch.
        intervals: of the spline, 1 or more.
        most: rotation that no block has [rad]; keeps what readings leave open within it.
    """
    columns = _columns(time, base[0], ends, intervals)
    theta_by, omega_by, turn_by = columns
    held, zeros = _held(ends, intervals, theta_by.shape[1], time, base[0], most)
    weights = np.array([1.0 / sensor.sd for sensor in sensors])[:, None]
    there = np.isfinite(read)
    found = np.zeros(theta_by.shape[1])
    for _ in range(STEPS):
        theta, omega, turning = (by @ found for by in columns)
        rows, left = [held], [zeros - held @ found]
        for k, sensor in enumerate(sensors):
            predicted, by_theta, by_omega, by_turn = _reading(sensor, theta, omega, turning, base, g, corner)
            rows.append(
                weights[k] * (by_theta[:, None] * theta_by + by_omega[:, None] * omega_by + by_turn * turn_by)[there[k]]
            )
            left.append(weights[k] * (read[k] - predicted)[there[k]])
        step = np.linalg.lstsq(np.vstack(rows), np.concatenate(left), rcond=None)[0]
        found = found + step
    theta, omega, turning = (by @ found for by in columns)
    missed = np.concatenate([
        (weights[k] * (read[k] - _reading(sensor, theta, omega, turning, base, g, corner)[0]))[there[k]]
        for k, sensor in enumerate(sensors)
    ])  # fmt: skip
    return theta, omega, float(np.mean(missed**2)) if missed.size else math.inf


def _reading(
    sensor: Sensor, theta: Array, omega: Array, turning: Array, base: tuple[Array, Array], g: float, corner: float
) -> tuple[Array, Array, Array, float]:
    """What a sensor reads, and its derivatives by rotation, angular speed and angular acceleration."""
    (x, z), (e_x, e_z) = sensor.place, sensor.axis
    x -= corner
    A_x, up = base[0], g + base[1]
    cos, sin = np.cos(theta), np.sin(theta)
    along, by_turn = e_x * x + e_z * z, e_x * z - e_z * x
    still = e_x * (A_x * cos - up * sin) + e_z * (A_x * sin + up * cos)
    by_theta = e_z * (A_x * cos - up * sin) - e_x * (A_x * sin + up * cos)
    return still + by_turn * turning - along * omega**2, by_theta, -2.0 * along * omega, by_turn


def _columns(time: Array, pushed: Array, ends: Ends, intervals: int) -> tuple[Array, Array, Array]:
    """What each coefficient does to the rotation, its first and its second derivative, shape (time, coefficient)."""
    splines = _splines(ends, intervals)
    own = [splines(time, nu) for nu in range(3)]
    speed = cumulative_simpson(pushed, x=time, initial=0.0)
    shares = cumulative_simpson(speed, x=time, initial=0.0), speed, pushed
    theta, omega, turning = (np.column_stack([a, b]) for a, b in zip(own, shares, strict=True))
    return theta, omega, turning


def _splines(ends: Ends, intervals: int) -> BSpline:
    inner = np.linspace(ends.begin, ends.end, intervals + 1)
    knots = np.concatenate([[ends.begin] * DEGREE, inner, [ends.end] * DEGREE])
    return BSpline(knots, np.eye(intervals + DEGREE), DEGREE)


def _held(
    ends: Ends, intervals: int, count: int, time: Array, pushed: Array, most: float
) -> tuple[Array, Array]:  # fmt: skip
    """Rows and right sides of what is known beside the readings: the ends, and that nothing is beyond all measure."""
    splines = _splines(ends, intervals)
    rows = [np.eye(count)[: count - 1] / most]
    # What the record adds is zero, with its slope, at the first sample; at the end it is what it is at the last.
    speed = cumulative_simpson(pushed, x=time, initial=0.0)
    last = float(cumulative_simpson(speed, x=time, initial=0.0)[-1] + speed[-1] * (ends.end - time[-1]))
    for where, upright, share in ((ends.begin, ends.upright[0], 0.0), (ends.end, ends.upright[1], last)):
        if upright:
            rows.append(np.append(splines(where), share)[None, :] / ends.sd)
    if ends.released:
        rows.append(np.append(splines(ends.begin, 1), 0.0)[None, :] / ends.sd)
    held = np.vstack(rows)
    return held, np.zeros(held.shape[0])
