"""Checks of arrays, systems and motions at the public edge: one sentence with name, value and what was wanted."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rocking.validation import real


def array_of(name: str, values: Any) -> NDArray[np.float64]:
    """`values` as numbers; ValueError where they are none, or rows of different lengths."""
    try:
        if np.asarray(values).dtype.kind in "biuf":
            return np.asarray(values, dtype=np.float64)
        if np.asarray(values).dtype.kind == "O":  # whole numbers beyond 64 bits, None, anything
            return np.array(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        pass
    shown = repr(values)
    raise ValueError(f"{name}={shown if len(shown) <= 80 else shown[:77] + '...'}: want numbers")


def writable(values: Any) -> NDArray[np.float64]:
    """`values` as numbers in a row that may be written to, which compiled code asks of what it only reads too."""
    return np.require(values, np.float64, ["C", "W"])


def check_start(theta: Any, omega: Any) -> None:
    """ValueError unless a block may be released so: rotation [rad], angular velocity [rad/s]."""
    for name, value in (("theta", theta), ("omega", omega)):
        if not math.isfinite(real(value)):
            raise ValueError(f"{name}={value!r}: want a finite number")
    check_tilt("theta", theta)


def check_tilt(name: str, theta: Any) -> None:
    """ValueError unless a rotation [rad], or each of several, is that of a block that has not fallen."""
    fallen = np.ravel(theta)[~(np.abs(np.ravel(theta)) < 0.5 * math.pi)]
    if fallen.size:
        shown = theta if np.ndim(theta) == 0 else float(fallen[0])
        raise ValueError(f"{name}={shown!r} rad: want between -pi/2 and pi/2, where the block lies on its side")


def check_kinds(system: Any, motion: Any, plural: str = "") -> None:
    """ValueError unless the system can be carried and the motion be asked for accelerations."""
    if not hasattr(system, "initial_state"):
        raise ValueError(f"system{plural}={system!r}: want a system, such as Method1(Block(b=0.3, h=1.8))")
    if not any(hasattr(motion, way) for way in ("kernel", "ramped_sine", "piecewise_linear")):
        raise ValueError(f"motion{plural}={motion!r}: want a motion as those of `excitation`, or None")
