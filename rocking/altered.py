"""A base motion that an effect has altered: the motion as it was, and a formula on top of it.

Source   none: plumbing of the effects on the base motion (`rocking.effects`).
Status   exact where the formula is; an altered kernel exists in this process only, so a compiling solver compiles it
         anew in each process (a fraction of a second).
"""

from __future__ import annotations

from functools import cached_property
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rocking.motion import BaseMotion, level, pitch_kernel

_made: dict[tuple[Any, ...], Any] = {}


def _bound(template: Any, inner: Any, inner_pitch: Any, split: int) -> Any:
    """A template with the names that it leaves open: a plain function, whose callees a compiler finds as globals.

    The same names give one and the same function, also in threads that ask at the same time.
    """
    key = template, inner, inner_pitch, split
    if key not in _made:
        names = {**template.__globals__, "_inner": inner, "_inner_pitch": inner_pitch, "_split": split}
        return _made.setdefault(key, FunctionType(template.__code__, names, template.__name__))
    return _made[key]


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
        turned: whether the accelerations are in other axes than below, with gravity in them.
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
        turned: bool = False,
        label: str = "",
    ) -> None:
        self.below, self.late, self.turned, self.label = below, late, turned, label
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


def shaking(motion: BaseMotion) -> BaseMotion:
    """The motion without what turns its axes and so brings gravity into them."""
    while isinstance(motion, AlteredMotion) and motion.turned:
        motion = motion.below
    return motion


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

FEWEST = 4
"""Samples of a motion at the least."""

ROUNDING = 1e-9
"""Share of a step by which a time may miss a sample and still count as it, and of the largest sample that is rest."""


def _unaltered(motion: BaseMotion) -> BaseMotion:
    """The motion below all that has altered it."""
    while isinstance(motion, AlteredMotion):
        motion = motion.below
    return motion


class Samples(NamedTuple):
    """A motion at equal steps."""

    start: float  # time of the first sample [s]
    step: float  # between samples [s]
    a_x: NDArray[np.float64]  # [m/s^2], shape (time,)
    own: int  # so many from the first on are the motion's own; after them it is at rest


def samples_of(motion: BaseMotion, span: tuple[float, float]) -> Samples:
    """The whole motion and span at steps that go through the motion's own samples, without a rest before the motion.

    What is made of them for a run then does not depend on when the run begins or ends.  A motion without samples is
    followed at a fifth of its longest step, or in 2,000 steps if that has no bound; its breakpoints fix where.
    """
    breakpoints = motion.breakpoints or span
    first, last = breakpoints[0], breakpoints[-1]
    source = _unaltered(motion)
    step = getattr(source, "time_step", None)
    if step is None:
        step = min(source.max_step / 5.0, (max(last, span[1]) - min(first, span[0])) / 2000.0)
        step = (last - first) / np.ceil((last - first) / step - ROUNDING) if last - first > step else step
    before, own, after = (
        max(0, int(np.ceil(length / step - ROUNDING))) for length in (first - span[0], last - first, span[1] - last)
    )
    t = first + step * np.arange(-before, max(own + after + 1, FEWEST))
    a_x = motion.kernel(np, t, np.asarray(motion.parameters, dtype=np.float64))[0] + np.zeros_like(t)
    if not a_x[:before].any():
        t, a_x, before = t[before:], a_x[before:], 0
    own = max(before + own + 1, FEWEST)
    return Samples(float(t[0]), float(step), a_x, a_x.size if a_x[own:].any() else own)


def moving_part(a: NDArray[np.float64]) -> slice:
    """From the first sample that is not zero to the last; all of them if there are fewer than three between.

    A rest that is added before or after a motion then changes nothing within it.
    """
    size = np.abs(a)
    moving = np.flatnonzero(size > ROUNDING * np.max(size))
    few = moving.size == 0 or moving[-1] - moving[0] < 2
    return slice(0, a.size) if few else slice(int(moving[0]), int(moving[-1]) + 1)


def table(
    span: tuple[float, float], start: float, step: float, *columns: NDArray[np.float64], part: slice = slice(None)
) -> NDArray[np.float64]:
    """Samples over the span as numbers of a formula: [start, step, count, then (value, slope) of each column by turns].

    Slopes are those of the cubic spline through the samples of the part, and of others through those before and after
    it: what happens in one of them does not ring into the next.
    """
    values = np.column_stack(columns)
    first = min(max(0, int((span[0] - start) / step) - MARGIN), len(values) - 2)
    stop = max(int((span[1] - start) / step) + MARGIN, first + 2)
    low, high, _ = part.indices(len(values))
    inside = values[first:stop]
    slopes = [_slopes(piece, step) for piece in np.split(inside, np.clip([low - first, high - first], 0, len(inside)))]
    both = np.stack([inside, np.concatenate(slopes)], axis=2)
    return np.concatenate([[start + first * step, step, len(inside)], both.transpose(1, 0, 2).ravel()])


def _slopes(values: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    """Of the cubic spline through samples, shape (time, column); zero for a single one."""
    from scipy.interpolate import CubicSpline

    if len(values) < 2 or not values.any():
        return np.zeros_like(values)
    t = step * np.arange(len(values))
    return np.asarray(CubicSpline(t, values)(t, 1))


def _whole(xp: Any, x: Any) -> Any:
    """The integer part of x >= 0, fit for an index."""
    i = xp.floor(x)
    # floor of one number is an int in Python and numba, that of an array has floats; the type decides which line runs.
    if hasattr(i, "astype"):
        return i.astype("int32")
    return i


def table_value(xp: Any, t: Any, numbers: Any, column: Any) -> Any:
    """Value at t [s] of a column of a `table`, a cubic between samples; zero outside."""
    last = numbers[2] - 1.0
    at = (t - numbers[0]) / numbers[1]
    place = xp.minimum(xp.maximum(at, 0.0), last)
    i = xp.minimum(1.0 * xp.floor(place), last - 1.0)
    u = place - i
    k = _whole(xp, 3.0 + 2.0 * (column * numbers[2] + i))
    left, left_slope, right, right_slope = numbers[k], numbers[k + 1], numbers[k + 2], numbers[k + 3]
    rise, dt = right - left, numbers[1]
    bend = (1.0 - u) * (left_slope * dt - rise) - u * (right_slope * dt - rise)
    inside = (at >= -ROUNDING) & (at <= last + ROUNDING)
    return xp.where(inside, left + u * rise + u * (1.0 - u) * bend, 0.0)
