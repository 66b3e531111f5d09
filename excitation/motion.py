"""What every base motion offers: values at any time, and the same formula for compiling solvers.

The base moves horizontally with `a_x` and vertically with `a_z` [m/s^2]; gravity is in neither.  A subclass states

- `kernel(xp, t, par) -> (a_x, a_z)`: a plain function of an array namespace (`numpy`, `jax.numpy` or a scalar
  one), one time and the parameter array.  It uses `xp` and arithmetic only (no Python branch on a value), so one source
  serves NumPy, compiled loops and traced code;
- `parameters`: the float64 array `par`, shape (parameter,);
- `breakpoints`: times [s] at which the motion or its slope jumps, so that no integration step straddles one;
- `max_step`: the longest step [s] that cannot miss a feature of the motion.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    import xarray as xr


class Motion(ABC):
    """A prescribed motion of the base.

    Calling it evaluates it: `a_x, a_z = motion(t)` with `t` [s] of any shape gives two float64 arrays [m/s^2] of that
    shape.  Raises ValueError if `t` holds a value that is not finite.
    """

    @staticmethod
    @abstractmethod
    def kernel(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
        """(a_x, a_z) [m/s^2] at t [s] for the parameter array, in the array namespace xp."""

    @property
    @abstractmethod
    def parameters(self) -> NDArray[np.float64]:
        """The array that `kernel` takes, shape (parameter,)."""

    @property
    @abstractmethod
    def breakpoints(self) -> tuple[float, ...]:
        """Times [s], ascending, at which the motion or its slope jumps."""

    @property
    @abstractmethod
    def max_step(self) -> float:
        """The longest integration step [s] that cannot miss a feature of the motion."""

    def __call__(self, t: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        times = np.asarray(t, dtype=np.float64)
        if not np.all(np.isfinite(times)):
            raise ValueError(f"t={t!r}: want finite times [s]")
        a_x, a_z = self.kernel(np, times, self.parameters)
        return a_x + np.zeros_like(times), a_z + np.zeros_like(times)

    def to_xarray(self, t: ArrayLike) -> xr.Dataset:
        """Values at the times `t` [s], shape (time,), as a dataset with units."""
        import xarray as xr

        times = np.atleast_1d(np.asarray(t, dtype=np.float64))
        a_x, a_z = self(times)
        axis = {"units": "m s-2"}
        return xr.Dataset(
            {
                "a_x": ("time", a_x, axis | {"long_name": "horizontal base acceleration"}),
                "a_z": ("time", a_z, axis | {"long_name": "vertical base acceleration"}),
            },
            coords={"time": ("time", times, {"units": "s", "long_name": "time"})},
            attrs={"motion": repr(self)},
        )
