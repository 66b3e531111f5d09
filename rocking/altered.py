"""A base motion that an effect has altered: the motion as it was, and a formula on top of it.

Source   none: plumbing of the effects on the base motion (`rocking.effects`).
Status   exact where the formula is; an altered kernel exists in this process only, so a compiling solver compiles it
         anew in each process (a fraction of a second).
"""

from __future__ import annotations

from functools import cache, cached_property
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rocking.motion import BaseMotion, level, pitch_kernel


@cache
def _bound(template: Any, inner: Any, inner_pitch: Any, split: int) -> Any:
    """A template with the names that it leaves open: a plain function, whose callees a compiler finds as globals."""
    names = {**template.__globals__, "_inner": inner, "_inner_pitch": inner_pitch, "_split": split}
    return FunctionType(template.__code__, names, template.__name__)


class AlteredMotion:
    """A motion under formulas that may call the kernels of the motion below.

    Args:
        below: the motion as it was.
        numbers: what the formulas take, shape (number,): they find them in par[_split:], and the parameters of the
            motion below in par[:_split].
        kernel: template (xp, t, par) -> (a_x, a_z) [m/s^2] that calls `_inner(xp, t, par[:_split])`; the motion's own
            if not given.
        pitch: template (xp, t, par) -> (pitch [rad], pitch acceleration [rad/s^2]) that calls
            `_inner_pitch(xp, t, par[:_split])`; the motion's own if not given.
        late: how much earlier [s] everything happens than below.
        max_step: longest integration step [s] that the formulas allow.
        label: what is shown of the alteration.
    """

    def __init__(
        self,
        below: BaseMotion,
        numbers: ArrayLike,
        *,
        kernel: Any = None,
        pitch: Any = None,
        late: float = 0.0,
        max_step: float = np.inf,
        label: str = "",
    ) -> None:
        self.below, self.late, self.label = below, late, label
        self.numbers = np.atleast_1d(np.asarray(numbers, dtype=np.float64))
        own_pitch = pitch_kernel(below)
        open_names = (below.kernel, level if own_pitch is None else own_pitch, below.parameters.size)
        self.kernel = _bound(_as_below if kernel is None else kernel, *open_names)
        self.has_pitch = own_pitch is not None or pitch is not None
        self.pitch_kernel = _bound(_pitch_as_below if pitch is None else pitch, *open_names)
        self.max_step = min(below.max_step, max_step)

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        """Those of the motion below, then the numbers of the formulas."""
        return np.concatenate([np.asarray(self.below.parameters, dtype=np.float64), self.numbers])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Times [s] at which the motion or its slope jumps."""
        return tuple(t - self.late for t in self.below.breakpoints)

    def __repr__(self) -> str:
        return f"{self.below!r} with {self.label}"


# Names for what `_bound` puts in their place.
_inner: Any = None
_inner_pitch: Any = None
_split: Any = None


def _as_below(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    return _inner(xp, t, par[:_split])


def _pitch_as_below(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    return _inner_pitch(xp, t, par[:_split])


MARGIN = 32
"""Samples beyond the span on either side that a table keeps, after which its spline does not feel that it ends."""


def _extent(motion: BaseMotion, span: tuple[float, float]) -> tuple[float, float]:
    """From where the motion or the span begins [s] to where the later of them ends."""
    return min(span[0], *motion.breakpoints, span[0]), max(span[1], *motion.breakpoints, span[1])


def _step(motion: BaseMotion, length: float) -> float:
    """Time between samples [s] that follow the motion: its own where it has samples, else a fifth of its longest step.

    A motion without any scale of time is followed in 2,000 samples.
    """
    own = getattr(motion, "time_step", None)
    if own is not None:
        return float(own)
    if isinstance(motion, AlteredMotion):
        return _step(motion.below, length)
    return min(motion.max_step / 5.0, length / 2000.0)


def samples_of(motion: BaseMotion, span: tuple[float, float]) -> tuple[float, float, NDArray[np.float64]]:
    """(time of the first sample [s], time step [s], a_x [m/s^2] of the whole motion and span, shape (time,)).

    What is made of them for a run then does not depend on when the run ends.
    """
    start, end = _extent(motion, span)
    step = _step(motion, end - start)
    t = start + step * np.arange(max(4, int(np.ceil((end - start) / step - 1e-9)) + 1))
    a_x, _ = motion.kernel(np, t, np.asarray(motion.parameters, dtype=np.float64))
    return start, step, a_x + np.zeros_like(t)


def moving_part(a: NDArray[np.float64]) -> slice:
    """From the first sample that is not zero to the last; all of them if there are fewer than three between.

    A rest that is added before or after a motion then changes nothing within it.
    """
    moving = np.flatnonzero(a)
    few = moving.size == 0 or moving[-1] - moving[0] < 2
    return slice(0, a.size) if few else slice(int(moving[0]), int(moving[-1]) + 1)


def table(span: tuple[float, float], start: float, step: float, *columns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Samples over the span as numbers of a formula: [start, step, count, then (value, slope) of each column by turns].

    Slopes are those of the cubic spline through the samples.
    """
    from scipy.interpolate import CubicSpline

    first = max(0, int((span[0] - start) / step) - MARGIN)
    inside = slice(first, int((span[1] - start) / step) + MARGIN)
    parts = []
    for column in columns:
        values = column[inside]
        slopes = CubicSpline(step * np.arange(values.size), values)(step * np.arange(values.size), 1)
        parts.append(np.column_stack([values, slopes]).ravel())
    return np.concatenate([[start + first * step, step, columns[0][inside].size], *parts])


def _whole(xp: Any, x: Any) -> Any:
    """The integer part of x >= 0, fit for an index."""
    i = xp.floor(x)
    # floor of one number is an int in Python and numba, that of an array has floats; the type decides which line runs.
    if hasattr(i, "astype"):
        return i.astype("int32")
    return i


def table_value(xp: Any, t: Any, numbers: Any, column: Any) -> Any:
    """Value at t [s] of a column of a `table`, a cubic between samples; the end values outside."""
    last = numbers[2] - 1.0
    place = xp.minimum(xp.maximum((t - numbers[0]) / numbers[1], 0.0), last)
    i = xp.minimum(1.0 * xp.floor(place), last - 1.0)
    u = place - i
    k = _whole(xp, 3.0 + 2.0 * (column * numbers[2] + i))
    left, left_slope, right, right_slope = numbers[k], numbers[k + 1], numbers[k + 2], numbers[k + 3]
    rise, dt = right - left, numbers[1]
    bend = (1.0 - u) * (left_slope * dt - rise) - u * (right_slope * dt - rise)
    return left + u * rise + u * (1.0 - u) * bend
