"""What every base motion offers: values at any time, and the same formula for compiling solvers.

The base moves horizontally with `a_x` and vertically with `a_z` [m/s^2] and may pitch; gravity is in neither, and pitch
is positive clockwise like the rotation of a block.  A subclass states

- `kernel(xp, t, par) -> (a_x, a_z)`: a plain function of an array namespace (`numpy`, `jax.numpy` or a scalar
  one), one time and the parameter array.  It uses `xp` and arithmetic only (no Python branch on a value), so one source
  serves NumPy, compiled loops and traced code;
- `pitch_kernel(xp, t, par) -> (pitch [rad], pitch acceleration [rad/s^2])`: the same for the pitch; zero if not given;
- `parameters`: the float64 array `par`, shape (parameter,), that both take;
- `displacement_kernel(xp, t, par) -> x [m]`: the displacement of the base from rest, where that is a closed formula and
  the base comes to rest; None if not;
- `snap_kernel(xp, t, par) -> second derivative of a_x [m/s^4]`: where a_x and its slope are continuous; None if not;
- `breakpoints`: times [s] at which the motion or its slope jumps, so that no integration step straddles one;
- `max_step`: the longest step [s] that cannot miss a feature of the motion.
"""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from excitation.checks import numbers

if TYPE_CHECKING:
    import xarray as xr

FloatArray = NDArray[np.float64]


def _level(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """No pitch."""
    return 0.0 * t, 0.0 * t


def _times(t: ArrayLike) -> FloatArray:
    times = numbers("t", t)
    if not np.all(np.isfinite(times)):
        raise ValueError(f"t={t!r}: want finite times [s]")
    return times


class Motion(ABC):
    """A prescribed motion of the base.

    Calling it evaluates it: `a_x, a_z = motion(t)` with `t` [s] of any shape gives two float64 arrays [m/s^2] of that
    shape.  Raises ValueError if `t` holds a value that is no finite number.
    """

    @staticmethod
    @abstractmethod
    def kernel(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
        """(a_x, a_z) [m/s^2] at t [s] for the parameter array, in the array namespace xp."""

    pitch_kernel = staticmethod(_level)
    displacement_kernel: Any = None
    snap_kernel: Any = None

    @property
    @abstractmethod
    def parameters(self) -> FloatArray:
        """The array that `kernel` takes, shape (parameter,)."""

    @property
    @abstractmethod
    def breakpoints(self) -> tuple[float, ...]:
        """Times [s], ascending, at which the motion or its slope jumps."""

    @property
    @abstractmethod
    def max_step(self) -> float:
        """The longest integration step [s] that cannot miss a feature of the motion."""

    @property
    def has_pitch(self) -> bool:
        """Whether the base pitches at all; where it does not, a solver may leave `pitch_kernel` out."""
        return self.pitch_kernel is not _level

    def __call__(self, t: ArrayLike) -> tuple[FloatArray, FloatArray]:
        times = _times(t)
        a_x, a_z = self.kernel(np, times, self.parameters)
        return a_x + np.zeros_like(times), a_z + np.zeros_like(times)

    def pitch(self, t: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Pitch [rad] and its second derivative [rad/s^2] at `t` [s], each of the shape of `t`; clockwise positive."""
        times = _times(t)
        angle, acceleration = self.pitch_kernel(np, times, self.parameters)
        return angle + np.zeros_like(times), acceleration + np.zeros_like(times)

    def to_xarray(self, t: ArrayLike) -> xr.Dataset:
        """Values at the times `t` [s], shape (time,), as a dataset with units; see `excitation.from_xarray`."""
        import xarray as xr

        times = np.atleast_1d(_times(t))
        a_x, a_z = self(times)
        pitch, pitch_acceleration = self.pitch(times)
        columns = {
            "a_x": (a_x, "m s-2", "horizontal base acceleration"),
            "a_z": (a_z, "m s-2", "vertical base acceleration"),
            "pitch": (pitch, "rad", "pitch of the base, clockwise positive"),
            "pitch_acceleration": (pitch_acceleration, "rad s-2", "second derivative of the pitch"),
        }
        ds = xr.Dataset(
            {name: ("time", v, {"units": unit, "long_name": text}) for name, (v, unit, text) in columns.items()},
            coords={"time": ("time", times, {"units": "s", "long_name": "time"})},
            attrs={"motion": repr(self)},
        )
        return self._with_recipe(ds)

    def _with_recipe(self, ds: xr.Dataset) -> xr.Dataset:
        """The dataset with what `excitation.from_xarray` needs to make the same object."""
        from excitation.recipes import with_recipe

        return with_recipe(ds, self)

    @property
    def arguments(self) -> dict[str, Any] | None:
        """What makes the same motion, by name; None if arguments do not."""
        if not dataclasses.is_dataclass(self):
            return None
        return {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}
