"""Base motions with a closed form, which say so by one of two attributes; a_z = 0 in both.

- `ramped_sine`: (omega [rad/s], phase [rad], rate [m/s^3], duration [s]) or None; a_x = rate t sin(omega t + phase)
  from 0 to duration, else 0;
- `piecewise_linear`: (t_first [s], dt [s], values [m/s^2] of shape (sample,)) or None; a_x runs straight from sample to
  sample, and is 0 before the first and after the last.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rocking.hybrid import System
from rocking.method1 import Method1, guards, jump, linear_flow, nonlinear_flow
from rocking.motion import BaseMotion, Still, pitch_kernel

Array = NDArray[np.float64]


def ramped_sine(motion: Any) -> Array | None:
    """(omega, phase, rate, duration) of a motion that is a ramped sine, else None.

    Raises:
        ValueError: the motion gives numbers that are not finite, or a duration that is not positive.
    """
    wave = getattr(motion, "ramped_sine", None)
    if wave is None:
        return None
    omega, phase, rate, duration = (float(number) for number in wave)
    if not (np.all(np.isfinite([omega, phase, rate, duration])) and duration > 0.0):
        raise ValueError(f"ramped_sine={tuple(wave)!r}: want finite numbers and a positive duration")
    return np.array([omega, phase, rate, duration])


def piecewise_linear(motion: Any) -> tuple[Array, Array] | None:
    """((t_first, dt), values) of a motion that is straight between equally spaced samples, else None.

    Raises:
        ValueError: the motion gives numbers that are not finite, an interval that is not positive, or no sample.
    """
    if isinstance(motion, Still):
        return np.array([math.inf, 1.0]), np.zeros(1)
    record = getattr(motion, "piecewise_linear", None)
    if record is None:
        return None
    t_first, dt, values = float(record[0]), float(record[1]), np.asarray(record[2], dtype=np.float64)
    if not (math.isfinite(t_first) and math.isfinite(dt) and dt > 0.0):
        raise ValueError(f"piecewise_linear: t_first={t_first!r} s, dt={dt!r} s: want finite and dt positive")
    if values.ndim != 1 or values.size == 0 or not np.all(np.isfinite(values)):
        raise ValueError("piecewise_linear: want finite values of shape (sample,), one sample or more")
    return np.array([t_first, dt]), values


def refusal(system: System, motion: BaseMotion, forms: tuple[str, ...]) -> str | None:
    """Why solvers of Method 1 over such motions cannot carry this one; None if they can.

    forms: those of Method 1 that the solver carries.
    """
    if not isinstance(system, Method1):
        return f"it carries {' or '.join(forms)} Method 1 alone, not {system.name!r}"
    if system.form not in forms:
        return "it carries the linear Method 1; the nonlinear form has no closed form"
    plain = {"linear": linear_flow, "nonlinear": nonlinear_flow}[system.form]
    if system.flow is not plain or system.guards is not guards or system.jump is not jump:
        return "it carries Method 1 as it is, not with other equations put in their place"
    if pitch_kernel(motion) is not None:
        return f"it carries blocks on a level base, and {type(motion).__name__} pitches"
    if ramped_sine(motion) is None and piecewise_linear(motion) is None:
        return (
            f"{type(motion).__name__} has no closed form that it knows: neither a ramped sine nor straight between "
            "equally spaced samples (attributes ramped_sine, piecewise_linear; a cubic spline is not)"
        )
    return None
