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
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rocking.hybrid import Base, Discrete
from rocking.trajectory import Trajectory

Array = NDArray[np.float64]


class _Motion(NamedTuple):
    """Motion of the carrying corner relative to the base, and of the block about it; arrays of shape (time,)."""

    x: Array
    z: Array
    a_x: Array
    a_z: Array
    theta: Array
    omega: Array
    omega_dot: Array
    base: Base


def _motion(trajectory: Trajectory) -> _Motion:
    system = trajectory.system
    y = trajectory.y.T
    a_x, a_z = trajectory.motion.kernel(np, trajectory.t, np.asarray(trajectory.motion.parameters))
    zero = np.zeros_like(trajectory.t)
    base = Base(a_x + zero, a_z + zero)
    q = Discrete(trajectory.mode, trajectory.s, zero + 1.0)
    if "u" in system.state_names:
        # The direction of slip, which a sample does not hold, is that of the slip velocity.
        q = q._replace(slip=np.where(y[system.state_names.index("u")] < 0.0, -1.0, 1.0))
    rate = dict(zip(system.state_names, system.flow(np, y, q, base, system.parameters), strict=True))
    state = dict(zip(system.state_names, y, strict=True))
    x = state.get("x", trajectory.s * 0.5 * system.block.b)
    u_dot, v_dot = (np.asarray(rate.get(name, zero)) + zero for name in ("u", "v"))
    return _Motion(x, state.get("z", zero), u_dot, v_dot, state["theta"], state["omega"], rate["omega"] + zero, base)


def _from_corner(trajectory: Trajectory, m: _Motion, position: tuple[float, float]) -> tuple[Array, Array]:
    """Vector [m] from the carrying corner to the point of the block, in space."""
    if len(position) != 2 or not all(math.isfinite(value) for value in position):
        raise ValueError(f"position={position!r} m: want two finite numbers (X, Z) in the block frame")
    along = position[0] - trajectory.s * 0.5 * trajectory.system.block.b
    up = position[1]
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
    r_x, r_z = _from_corner(trajectory, m, position)
    return m.x + r_x, m.z + r_z


def accelerometer(trajectory: Trajectory, position: tuple[float, float], direction: tuple[float, float]) -> Array:
    """Reading [m/s^2] of an accelerometer fixed to the block, gravity included, at the samples, shape (time,).

    Args:
        trajectory: a run of `solve`.
        position: (X, Z) [m] of the sensor in the block frame.
        direction: sensitive axis in the block frame; its length does not matter.

    Raises:
        ValueError: the position is not two finite numbers, or the direction has no length.
    """
    length = math.hypot(*direction) if len(direction) == 2 else math.nan
    if not (math.isfinite(length) and length > 0.0):
        raise ValueError(f"direction={direction!r}: want two finite numbers, not both zero")
    m = _motion(trajectory)
    r_x, r_z = _from_corner(trajectory, m, position)
    # Clockwise rotation: omega' gives (omega' r_z, -omega' r_x), the turning itself -omega^2 r.
    a_x = m.base.a_x + m.a_x + m.omega_dot * r_z - m.omega**2 * r_x
    a_z = m.base.a_z + m.a_z - m.omega_dot * r_x - m.omega**2 * r_z + trajectory.system.g
    cos, sin = np.cos(m.theta), np.sin(m.theta)
    d_x, d_z = direction[0] / length, direction[1] / length
    return np.asarray(a_x * (d_x * cos + d_z * sin) + a_z * (-d_x * sin + d_z * cos))
