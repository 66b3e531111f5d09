"""Interpolation between equally spaced samples, as formulas that compile.

A cubic spline is kept as rows (value, second derivative) at its knots: within a step of length h, with u from 0 to 1,

    f = (1-u) f_0 + u f_1 + h^2/6 [((1-u)^3 - (1-u)) m_0 + (u^3 - u) m_1],   f'' = (1-u) m_0 + u m_1

Source   de Boor (1978), A Practical Guide to Splines, chapter IV; not-a-knot end conditions.
Status   values and second derivatives as scipy.interpolate.CubicSpline to rounding.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def whole(xp: Any, x: Any) -> Any:
    """The integer part of x >= 0, fit for an index: int for scalars, an integer array for arrays."""
    i = xp.floor(x)
    # floor gives an int for one number (Python, numba) and floats for arrays (numpy, jax); compiled code
    # sees one branch only, since the type decides.
    if hasattr(i, "astype"):
        return i.astype("int32")
    return i


def locate(xp: Any, t: Any, start: Any, step: Any, count: Any) -> tuple[Any, Any]:
    """Number of the sampling step that holds t, as a whole float, and the share u of it that is past."""
    x = (t - start) / step
    i = 1.0 * xp.floor(xp.maximum(xp.minimum(x, count - 2.0), 0.0))
    return i, x - i


def cubic_value(f0: Any, m0: Any, f1: Any, m1: Any, u: Any, h: Any) -> Any:
    """The spline at the share u of a step."""
    v = 1.0 - u
    return v * f0 + u * f1 + h * h / 6.0 * (v * (v * v - 1.0) * m0 + u * (u * u - 1.0) * m1)


def knots(values: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    """Rows (value, second derivative), raveled, shape (2 * time,); a straight line for two samples."""
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(step * np.arange(values.size), values)
    return np.column_stack([values, spline(step * np.arange(values.size), 2)]).ravel()
