"""What an instrument on the block would read: a marker seen by a camera, a body-fixed accelerometer.

The block frame has its origin at the middle of the base, X to the right and Z up along the block; leaning by theta
carries a point (X, Z) to (X cos theta + Z sin theta, -X sin theta + Z cos theta) from where the origin is.  An
accelerometer feels gravity too: it reads (a - g_vector) . axis with the absolute acceleration a of its point, so that
at rest upright +Z reads +g, and leaning by theta +X reads -g sin theta.

Source   Winkler, Meguro & Yamazaki (1995), "Shaking table experiments": pickups fixed to the blocks, which read
         horizontal and vertical acceleration only until the block tilts.
Status   between impacts; an impact itself is an impulse, of which a sample says nothing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rocking.effect import Seen
from rocking.hybrid import Anchor, Base, Discrete, System, bind_hooks, in_floor_axes
from rocking.motion import base_at
from rocking.trajectory import Trajectory
from rocking.validation import real

Array = NDArray[np.float64]


class _Motion(NamedTuple):
    """Motion of the anchor of the block relative to the base, and of the block about it; arrays of shape (time,)."""

    anchor: Anchor
    theta: Array
    omega: Array
    omega_dot: Array
    base: Base


def _motion(trajectory: Trajectory) -> _Motion:
    zero = np.zeros_like(trajectory.t)
    there = base_at(np, trajectory.motion, trajectory.t, np.asarray(trajectory.motion.parameters))
    base = Base(*(value + zero for value in there))
    return _moving(trajectory.system, trajectory.y, trajectory.mode, trajectory.s, base)


def _moving(system: System, states: Array, mode: NDArray[np.int64], s: Array, base: Base) -> _Motion:
    y, names = states.T, system.state_names
    zero = np.zeros(s.shape)
    q = Discrete(mode, s, zero + 1.0)
    if "u" in names:
        # The direction of slip, which a sample does not hold, is that of the slip velocity.
        q = q._replace(slip=np.where(y[names.index("u")] < 0.0, -1.0, 1.0))
    rate = [value + zero for value in system.flow(np, y, q, base, bind_hooks(system.parameters, _with_numpy))]
    theta, omega = names.index("theta"), names.index("omega")
    return _Motion(system.anchor(y, rate, s), y[theta], y[omega], rate[omega], base)


def _with_numpy(hook: Any) -> Any:
    return partial(hook, np)


def _pair(values: Any) -> bool:
    """Whether these are two finite numbers."""
    two = isinstance(values, Sequence | np.ndarray) and not isinstance(values, str) and len(values) == 2
    return two and all(math.isfinite(real(value)) for value in values)


def _from_anchor(m: _Motion, position: tuple[float, float]) -> tuple[Array, Array]:
    """Vector [m] from the anchor to the point of the block, in the axes of the floor."""
    if not _pair(position):
        raise ValueError(f"position={position!r} m: want two finite numbers (X, Z) in the block frame")
    along, up = position[0] - m.anchor.X, position[1] - m.anchor.Z
    cos, sin = np.cos(m.theta), np.sin(m.theta)
    return along * cos + up * sin, -along * sin + up * cos


def marker(trajectory: Trajectory, position: tuple[float, float]) -> tuple[Array, Array]:
    """Path (x, z) [m] of a point of the block relative to the base, at the samples of the trajectory, shape (time,).

    Args:
        trajectory: a run of `solve`.
        position: (X, Z) [m] of the point in the block frame.

    Raises:
        ValueError: the position is not two finite numbers.
    """
    m = _motion(trajectory)
    r_x, r_z = _from_anchor(m, position)
    return m.anchor.x + r_x, m.anchor.z + r_z


def accelerometer(trajectory: Trajectory, position: tuple[float, float], direction: tuple[float, float]) -> Array:
    """Reading [m/s^2] of an accelerometer fixed to the block, gravity included, at the samples, shape (time,).

    Args:
        trajectory: a run of `solve`.
        position: (X, Z) [m] of the sensor in the block frame.
        direction: sensitive axis in the block frame; its length does not matter.

    Raises:
        ValueError: the position is not two finite numbers, or the direction has no length.
    """
    there = _motion(trajectory)
    return _reading(there, trajectory.system.g, position, direction)


def accelerometer_at(
    system: System,
    y: Array,
    mode: NDArray[np.int64],
    s: Array,
    base: Base,
    position: tuple[float, float],
    direction: tuple[float, float],
) -> Array:
    """Reading [m/s^2] of an accelerometer fixed to the block in any states, whatever runs they come from.

    Args:
        system: the block.
        y: states, shape (sample, state).
        mode, s: mode and carrying side, shape (sample,).
        base: accelerations [m/s^2] and pitch [rad, rad/s^2] of the base there, arrays of shape (sample,).
        position, direction: as for `accelerometer`.

    Raises:
        ValueError: as for `accelerometer`.
    """
    return _reading(_moving(system, y, mode, s, base), system.g, position, direction)


def _reading(m: _Motion, g: float, position: tuple[float, float], direction: tuple[float, float]) -> Array:
    length = math.hypot(*direction) if _pair(direction) else math.nan
    if not (math.isfinite(length) and length > 0.0):
        raise ValueError(f"direction={direction!r}: want two finite numbers, not both zero")
    r_x, r_z = _from_anchor(m, position)
    A_x, A_z = in_floor_axes(np, m.base, g)
    x, z, pitching = m.anchor.x + r_x, m.anchor.z + r_z, m.base.pitch_acceleration
    # Clockwise rotation: omega' gives (omega' r_z, -omega' r_x), the turning itself -omega^2 r; a pitch the same about
    # the middle of where the block stands.
    a_x = A_x + pitching * z + m.anchor.a_x + m.omega_dot * r_z - m.omega**2 * r_x
    a_z = A_z - pitching * x + m.anchor.a_z - m.omega_dot * r_x - m.omega**2 * r_z
    cos, sin = np.cos(m.theta), np.sin(m.theta)
    d_x, d_z = direction[0] / length, direction[1] / length
    return np.asarray(a_x * (d_x * cos + d_z * sin) + a_z * (-d_x * sin + d_z * cos))


def rotation_sensor(trajectory: Trajectory) -> Array:
    """Reading [rad] of the rotation sensor at the samples, shape (time,): theta with the effects on the sensor.

    Where the recorder has a clock of its own the rotation between two samples is a cubic through them with their
    angular velocities; NaN outside of them.
    """
    from rocking.altered import shaking
    from rocking.effects import read_at, recorded_rotation

    motion = shaking(trajectory.motion)
    there = base_at(np, motion, trajectory.t, np.asarray(motion.parameters))
    seen = Seen(trajectory.t - trajectory.t_start, there.a_x + np.zeros(trajectory.t.size))
    theta, moments = trajectory.theta, read_at(seen.time, trajectory.effects)
    if moments is not seen.time:
        from scipy.interpolate import CubicHermiteSpline

        if theta.size < 2:  # nothing to interpolate
            theta = np.where(moments == seen.time, theta, np.nan)
        else:
            theta = CubicHermiteSpline(seen.time, theta, trajectory.omega, extrapolate=False)(moments)
    return np.asarray(recorded_rotation(theta, trajectory.effects, seen))
