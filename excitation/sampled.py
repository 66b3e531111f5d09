"""Sampled motions: equally spaced samples of acceleration (and pitch) that can be evaluated at any time.

Between the samples lies a cubic spline, smooth to its second derivative, so that solvers need not stop at a sample
(`SampledMotion`), or a straight line (`PiecewiseLinear`).  Before the first and after the last sample the base is at
rest.  The pitch acceleration is the second derivative of the pitch's spline, so the two belong to one motion.

Source   `excitation.splines`.
Status   linear interpolation changes forced responses noticeably at usual sampling rates; the spline is the default
         for records, the straight lines serve solvers in closed form and comparisons.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from excitation.checks import finite, positive, samples
from excitation.jumps import sampled
from excitation.motion import Motion
from excitation.splines import cubic_value, knots, locate, whole

if TYPE_CHECKING:
    import xarray as xr

HEAD = 5
"""Parameters before the samples: start, step, count, stride of a_z, stride of the pitch (0 where there is none)."""


ROUNDING = 1e-9
"""Share of a step by which a time may miss the first or last sample and still count as it."""


def _cubic(xp: Any, par: Any, row: Any, u: Any) -> Any:
    """The spline in the step whose first row (value, second derivative) is par[row], par[row + 1]."""
    k = whole(xp, row)
    return cubic_value(par[k], par[k + 1], par[k + 2], par[k + 3], u, par[1])


def _acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z) [m/s^2] at t; zero outside the samples."""
    i, u = locate(xp, t, par[0], par[1], par[2])
    inside = (u >= -ROUNDING) & (u <= 1.0 + ROUNDING)
    a_x = _cubic(xp, par, HEAD + 2.0 * i, u)
    a_z = _cubic(xp, par, HEAD + 2.0 * par[2] + par[3] * i, u)
    return xp.where(inside, a_x, 0.0), xp.where(inside, a_z, 0.0)


def _pitch(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(pitch [rad], pitch acceleration [rad/s^2]) at t; zero outside the samples."""
    i, u = locate(xp, t, par[0], par[1], par[2])
    inside = (u >= -ROUNDING) & (u <= 1.0 + ROUNDING)
    before = 2.0 * par[2] + xp.where(par[3] > 0.0, 2.0 * par[2], 4.0)
    k = whole(xp, HEAD + before + par[4] * i)
    angle = cubic_value(par[k], par[k + 1], par[k + 2], par[k + 3], u, par[1])
    acceleration = (1.0 - u) * par[k + 1] + u * par[k + 3]
    return xp.where(inside, angle, 0.0), xp.where(inside, acceleration, 0.0)


def _linear(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z) [m/s^2] at t on straight lines; par = [start, step, count, stride of a_z, a_x ..., a_z ...]."""
    i, u = locate(xp, t, par[0], par[1], par[2])
    inside = (u >= -ROUNDING) & (u <= 1.0 + ROUNDING)
    x = whole(xp, 4.0 + i)
    z = whole(xp, 4.0 + par[2] + par[3] * i)
    a_x = (1.0 - u) * par[x] + u * par[x + 1]
    a_z = (1.0 - u) * par[z] + u * par[z + 1]
    return xp.where(inside, a_x, 0.0), xp.where(inside, a_z, 0.0)


class _Sampled(Motion):
    """What cubic and linear sampled motions share."""

    interpolation: str

    def __init__(
        self, time_step: float, a_x: ArrayLike, a_z: ArrayLike | None = None, *, start: float = 0.0, name: str = ""
    ) -> None:
        positive("time_step", time_step, "s")
        finite("start", start, "s")
        self.time_step, self.start, self.name = float(time_step), float(start), name
        self.a_x = samples("a_x", a_x)
        self.a_z = None if a_z is None else self._like("a_z", a_z)

    def _like(self, name: str, values: ArrayLike) -> NDArray[np.float64]:
        array = samples(name, values)
        if array.size != self.a_x.size:
            raise ValueError(f"{name}: has {array.size} samples, want {self.a_x.size} as in a_x")
        return array

    @property
    def times(self) -> NDArray[np.float64]:
        """Times of the samples [s], shape (time,)."""
        return np.asarray(self.start + self.time_step * np.arange(self.a_x.size), dtype=np.float64)

    @property
    def end(self) -> float:
        """Time of the last sample [s]."""
        return self.start + self.time_step * (self.a_x.size - 1)

    @property
    def max_step(self) -> float:
        return self.time_step

    def to_xarray(self, t: ArrayLike | None = None) -> xr.Dataset:
        """Values at `t` [s], or the samples themselves if `t` is not given, as a dataset with units."""
        ds = super().to_xarray(self.times if t is None else t)
        if t is not None and not np.array_equal(t, self.times):
            return ds
        # Step and samples to the last bit, which differences of times and a spline's evaluation do not give.
        for name, values in self._samples.items():
            ds[name].values = np.array(values)
        return ds.assign_attrs(time_step=self.time_step)

    @property
    def _samples(self) -> dict[str, NDArray[np.float64]]:
        """The samples that were given, by name."""
        given = {"a_x": self.a_x, "a_z": self.a_z, "pitch": getattr(self, "pitch_angle", None)}
        return {name: values for name, values in given.items() if values is not None}

    def _with_recipe(self, ds: xr.Dataset) -> xr.Dataset:
        """What the samples do not say: how they are joined, and the name."""
        return ds.assign_attrs({"interpolation": self.interpolation} | ({"name": self.name} if self.name else {}))

    @property
    def arguments(self) -> dict[str, Any]:
        """What makes the same motion, by name."""
        return {"time_step": self.time_step, "start": self.start, "name": self.name} | self._samples

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, _Sampled) or type(self) is not type(other):
            return False
        return np.array_equal(self.parameters, other.parameters)

    def __hash__(self) -> int:
        return hash((type(self), self.parameters.tobytes()))

    def __repr__(self) -> str:
        label = f"{self.name!r}, " if self.name else ""
        return f"{type(self).__name__}({label}{self.a_x.size} samples at {self.time_step:g} s from {self.start:g} s)"


class SampledMotion(_Sampled):
    """A motion given by equally spaced samples, with a cubic spline between them.

    Args:
        time_step: time between samples [s], positive.
        a_x: horizontal acceleration [m/s^2], shape (time,), two samples or more.
        a_z: vertical acceleration [m/s^2], shape (time,); none if not given.
        pitch: pitch of the base [rad], shape (time,), clockwise positive; none if not given.
        start: time of the first sample [s].
        name: what is shown of the motion.

    Raises:
        ValueError: a sample is not finite, the lengths differ, or `time_step` is not positive.
    """

    interpolation = "cubic"
    kernel = staticmethod(_acceleration)
    pitch_kernel = staticmethod(_pitch)

    @property
    def has_pitch(self) -> bool:
        """Whether pitch samples were given."""
        return self.pitch_angle is not None

    def __init__(
        self,
        time_step: float,
        a_x: ArrayLike,
        a_z: ArrayLike | None = None,
        pitch: ArrayLike | None = None,
        *,
        start: float = 0.0,
        name: str = "",
    ) -> None:
        super().__init__(time_step, a_x, a_z, start=start, name=name)
        self.pitch_angle = None if pitch is None else self._like("pitch", pitch)

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        blocks, strides = [knots(self.a_x, self.time_step)], []
        for values in (self.a_z, self.pitch_angle):
            blocks.append(np.zeros(4) if values is None else knots(values, self.time_step))
            strides.append(0.0 if values is None else 2.0)
        return np.concatenate([[self.start, self.time_step, self.a_x.size, *strides], *blocks])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """The first and the last sample: between them the spline is smooth to its second derivative."""
        return (self.start, self.end)

    @classmethod
    def of(
        cls, horizontal: Motion, vertical: Motion | None = None, *, time_step: float, end: float, start: float = 0.0
    ) -> SampledMotion:
        """Samples of other motions from `start` to `end` [s]: `horizontal` along x, `vertical`'s a_x along z.

        Where the steps do not end at `end`, the last sample is the first one beyond it.
        Without `vertical`, the vertical acceleration and the pitch are those of `horizontal`.  A jump of the
        acceleration is smoothed over the steps beside it, and the base is left with the velocity that the motion gives
        it (`excitation.jumps`).  Raises ValueError if the step or the span is not positive.
        """
        positive("time_step", time_step, "s")
        finite("start", start, "s")
        finite("end", end, "s")
        positive("end - start", end - start, "s")
        steps = math.ceil((end - start) / time_step - ROUNDING)
        t = np.asarray(start + time_step * np.arange(max(2, steps + 1)), dtype=np.float64)
        a_x, a_z = sampled(horizontal, t, time_step)
        pitch, _ = horizontal.pitch(t)
        if vertical is not None:
            a_z = sampled(vertical, t, time_step)[0]
        return cls(
            time_step,
            a_x,
            a_z if np.any(a_z) else None,
            pitch if np.any(pitch) else None,
            start=start,
            name=repr(horizontal),
        )


class PiecewiseLinear(_Sampled):
    """A motion given by equally spaced samples, with straight lines between them; arguments as `SampledMotion`.

    It takes no pitch: the acceleration of a pitch that goes in straight lines would be a row of blows.
    """

    interpolation = "linear"
    kernel = staticmethod(_linear)

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        vertical = np.zeros(2) if self.a_z is None else self.a_z
        stride = 0.0 if self.a_z is None else 1.0
        return np.concatenate([[self.start, self.time_step, self.a_x.size, stride], self.a_x, vertical])

    @property
    def piecewise_linear(self) -> tuple[float, float, NDArray[np.float64]] | None:
        """(start [s], step [s], samples [m/s^2]) for closed forms; None where the base moves up and down too."""
        return (self.start, self.time_step, self.a_x) if self.a_z is None else None

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Every sample: the slope jumps there."""
        return tuple(self.times.tolist())
