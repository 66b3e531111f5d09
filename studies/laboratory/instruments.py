"""From what the block did to what was written down: channels, their noise, and what happens to records."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from studies.campaigns import Channel, Test

from .effects import Lab
from .event import Response, field
from .plans import Plan, worn
from .table import felt_by_motion

Array = np.ndarray


@dataclass(frozen=True)
class Bench:
    """Channels with their noise, the true mounting angles of accelerometers, and what goes wrong with records."""

    channels: tuple[Channel, ...]
    mounting: dict[str, float]  # rad, clockwise, by channel
    nuisances: frozenset[str] = frozenset()


def point_acceleration(
    lab: Lab, response: Response, felt: Array, position: tuple[float, float], every: int = 2
) -> Array:
    """(acceleration - g) of a point of the block, in the block's axes, shape (time, 2) [m/s^2].

    A resolved contact gives the centre of mass's motion; otherwise the point rolls with the mirrored edge of event.py.
    """
    w, P = lab.world, lab.world.vector()
    theta, rate, acc = response.rotation, response.velocity, response.acceleration
    n = theta.size
    last = felt.shape[0] - 1
    frame = np.array([field(0.0, felt[min(every * j, last)], P) for j in range(n)])
    fx, fz, b1, b2 = frame.T
    c, s = np.cos(theta), np.sin(theta)
    if response.centre is not None:
        rx, rz = position[0] - w.offset, position[1] - w.centre_height
        px, pz = rx * c + rz * s, -rx * s + rz * c
        own = response.centre + np.stack([acc * pz - rate**2 * px, -acc * px - rate**2 * pz], axis=1)
        # Here x'' and z'' are over the floor, which pitches in none of the contact simulators.
        total = own - np.stack([fx, fz], axis=1)
        if np.any(b1) or np.any(b2):
            raise ValueError("table_pitch: want the event simulator for accelerometers on a pitching table")
        return _in_block(total, c, s)
    side = np.where(theta < 0, -1.0, 1.0)
    phi = np.abs(theta)
    u, v = side * position[0] - (w.half_breadth - w.radius), position[1] - w.radius
    D, Z = u * np.cos(phi) + v * np.sin(phi), w.radius - u * np.sin(phi) + v * np.cos(phi)
    x = side * (w.half_breadth - w.radius + w.radius * phi + D)
    ax = Z * acc - side * D * rate**2
    az = -side * D * acc + (w.radius - Z) * rate**2
    # Euler, Coriolis and centripetal terms of a floor that turns.
    vx, vz = Z * rate, -side * D * rate
    ax = ax + b2 * Z + 2 * b1 * vz - b1**2 * x
    az = az - b2 * x - 2 * b1 * vx - b1**2 * Z
    return _in_block(np.stack([ax - fx, az - fz], axis=1), c, s)


def _in_block(vector: Array, c: Array, s: Array) -> Array:
    return np.stack([vector[:, 0] * c - vector[:, 1] * s, vector[:, 0] * s + vector[:, 1] * c], axis=1)


def acceleration(lab: Lab, response: Response, felt: Array, channel: Channel, bench: Bench) -> Array:
    """What an accelerometer on the block reads [m/s^2], mounted as it truly is, shape (time,).

    felt: pieces of what the floor does.
    """
    assert channel.position is not None
    total = point_acceleration(lab, response, felt, channel.position)
    turned = bench.mounting[channel.name]
    dx, dz = channel.axis
    axis = np.array([dx * np.cos(turned) + dz * np.sin(turned), -dx * np.sin(turned) + dz * np.cos(turned)])
    return np.asarray(total @ axis)


def reading(lab: Lab, plan: Plan, response: Response, channel: Channel, bench: Bench) -> Array | None:
    """Noise-free samples of a channel; None where a test has none (a free test has no base channel)."""
    lab = worn(lab, plan.order)
    if channel.kind == "rotation":
        return lab.sensors.reads(response.rotation)
    if channel.kind == "block_acceleration":
        # What the air does moves the block, not the floor.
        floor = replace(lab.table, gusts=())
        felt = felt_by_motion(plan.motion, 0.5 / plan.rate, 2 * plan.samples - 1, floor)
        return acceleration(lab, response, felt, channel, bench)
    if plan.motion is None:
        return None
    below = replace(lab.table, plate_frequency=math.inf, gusts=())
    felt = felt_by_motion(plan.motion, 0.5 / plan.rate, 2 * plan.samples - 1, below)
    row = 0 if channel.kind == "base_acceleration_x" else 1
    t = np.arange(plan.samples) / plan.rate - lab.sensors.base_lag
    h = 0.5 / plan.rate
    k = np.clip(np.floor(t / h).astype(int), 0, felt.shape[0] - 1)
    x = np.clip(t - k * h, 0.0, h)
    value = sum(felt[k, row, p] * x**p for p in range(4))
    if row == 0 and lab.sensors.base_corner > 0.0:
        value = value - slowly(value, 1.0 / plan.rate, lab.sensors.base_corner)
    return value / (lab.sensors.base_gain if row == 0 else 1.0)


def slowly(value: Array, step: float, corner: float) -> Array:
    """What a first-order low-pass of that corner [Hz] makes of samples, shape (time,), from zero at the first one."""
    kept, out = math.exp(-2.0 * math.pi * corner * step), np.zeros(value.size)
    for k in range(1, value.size):
        out[k] = kept * out[k - 1] + (1.0 - kept) * 0.5 * (value[k - 1] + value[k])
    return out


def record(
    rng: np.random.Generator, lab: Lab, plan: Plan, response: Response, bench: Bench, *, whole: bool = False
) -> Test:
    """What the laboratory hands over of one test; `whole` keeps the base's record after a fall."""
    data, there = {}, []
    for channel in bench.channels:
        clean = reading(lab, plan, response, channel, bench)
        if clean is not None:
            there.append(channel)
            data[channel.name] = clean + rng.normal(0.0, channel.noise or 0.0, clean.size)
    time = np.arange(plan.samples) / plan.rate
    test = Test(
        plan.id, "free" if plan.kind == "free" else "forced", time, tuple(there), data,
        plan.aimed if plan.kind == "free" else None, plan.motion_name,
        True if response.fell is not None and rng.uniform() < 0.7 else None,
    )  # fmt: skip
    if response.fell is not None and not whole:
        test = _cut(test, int(np.flatnonzero(np.abs(response.rotation) > 0.95)[0]) + 1)
    return spoiled(rng, test, bench)


def _cut(test: Test, keep: int) -> Test:
    return replace(test, time=test.time[:keep], data={k: v[:keep] for k, v in test.data.items()})


def spoiled(rng: np.random.Generator, test: Test, bench: Bench) -> Test:
    """The record after what happens to records."""
    if "truncated" in bench.nuisances and rng.uniform() < 0.4:
        test = _cut(test, int(rng.uniform(0.6, 0.9) * test.time.size))
    data = dict(test.data)
    for channel in test.channels:
        v = data[channel.name].copy()
        if "clipping" in bench.nuisances and channel.kind == "rotation":
            top = 0.8 * float(np.nanmax(np.abs(v)))
            v = np.clip(v, -top, top)
        if "missing" in bench.nuisances and channel.is_response:
            v[rng.uniform(size=v.size) < 0.01] = np.nan
            hole = int(rng.uniform(0.2, 0.9) * v.size)
            v[hole : hole + 12] = np.nan
        if "quantised" in bench.nuisances:
            grain = 1e-4 if channel.kind == "rotation" else 2e-3
            v = np.round(v / grain) * grain
        data[channel.name] = np.round(v, 6)
    return replace(test, time=np.round(test.time, 6), data=data)


def without_response(test: Test) -> Test:
    """The same test as one to predict."""
    base = tuple(c for c in test.channels if not c.is_response)
    return replace(test, channels=base, data={c.name: test.data[c.name] for c in base}, overturned=None)
