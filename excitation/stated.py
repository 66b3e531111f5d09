"""What a dataset states: values with their units, and times that are equally spaced.

Source   units as of `excitation.units`
Status   each refusal is tested
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from excitation.checks import numbers, real
from excitation.units import factor

if TYPE_CHECKING:
    import xarray as xr

UNIFORM = 1e-6
"""Largest departure of a time from the equal spacing, in steps."""


def step_of(times: NDArray[np.float64], tolerance: float = UNIFORM) -> float:
    """The equal spacing [s] of ascending times; ValueError if there is none."""
    if times.ndim != 1 or times.size < 2:
        raise ValueError(f"time: has shape {times.shape}, want two times or more in one dimension")
    step = (times[-1] - times[0]) / (times.size - 1)
    if not (np.isfinite(step) and step > 0.0):
        raise ValueError(f"time: goes from {times[0]} to {times[-1]} s, want ascending finite times")
    off = np.abs(times - (times[0] + step * np.arange(times.size))) / step
    if not np.all(off <= tolerance):
        worst = int(np.argmax(np.where(np.isfinite(off), off, np.inf)))
        raise ValueError(f"time: sample {worst} at {times[worst]} s is not on the equal spacing of {step:.9g} s")
    return float(step)


def stated_step(ds: xr.Dataset, times: NDArray[np.float64]) -> float:
    """The spacing [s] of the times, to the last bit if the attribute `time_step` [s] has it; ValueError if not even."""
    step = step_of(times)
    stated = real(ds.attrs.get("time_step", step))
    if not abs(stated - step) <= UNIFORM * step:
        raise ValueError(f"time_step={ds.attrs.get('time_step')!r} s: the times are {step:.9g} s apart, want the same")
    return stated


def values_in(ds: xr.Dataset, name: str, quantity: str) -> NDArray[np.float64]:
    """A variable in SI; ValueError if its unit is missing or unknown."""
    unit = ds[name].attrs.get("units")
    if not isinstance(unit, str):
        raise ValueError(f"{name}: has units {unit!r}, want a unit of {quantity} in the attribute `units`")
    return factor(unit, quantity) * numbers(name, ds[name].values)
