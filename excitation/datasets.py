"""Motions from datasets: the way back from `Motion.to_xarray`.

A dataset with `time` and `a_x`, and `a_z` and `pitch` where there are any, each with its `units`, is a motion by
itself: a cubic spline, or straight lines if its attribute `interpolation` says `linear`.  One that was written from a
formula, or from several motions combined, also says which, and then the same object comes back (`excitation.recipes`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from excitation.motion import Motion
from excitation.recipes import made_again
from excitation.sampled import PiecewiseLinear, SampledMotion
from excitation.units import factor

if TYPE_CHECKING:
    import xarray as xr

QUANTITIES = {
    "a_x": "acceleration",
    "a_z": "acceleration",
    "pitch": "angle",
    "pitch_acceleration": "angular acceleration",
}
"""What a dataset may hold of a motion besides `time`, in the order in which a motion gives it."""

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
    stated = float(ds.attrs.get("time_step", step))
    if not abs(stated - step) <= UNIFORM * step:
        raise ValueError(f"time_step={stated!r} s: the times are {step:.9g} s apart, want the same")
    return stated


def values_in(ds: xr.Dataset, name: str, quantity: str) -> NDArray[np.float64]:
    """A variable in SI; ValueError if its unit is missing or unknown."""
    unit = ds[name].attrs.get("units")
    if not isinstance(unit, str):
        raise ValueError(f"{name}: has units {unit!r}, want a unit of {quantity} in the attribute `units`")
    return factor(unit, quantity) * np.asarray(ds[name].values, dtype=np.float64)


def _from_recipe(ds: xr.Dataset, classes: dict[str, Any]) -> Motion:
    """The motion of the recipe, if the dataset's values are its."""
    motion = made_again(ds, classes)
    times = values_in(ds, "time", "time")
    again = dict(zip(QUANTITIES, (*motion(times), *motion.pitch(times)), strict=True))
    for part, quantity in QUANTITIES.items():
        if part in ds:
            stated = values_in(ds, part, quantity)
            if not np.allclose(again[part], stated, rtol=1e-9, atol=1e-9 * float(np.max(np.abs(stated), initial=0.0))):
                raise ValueError(f"{part}: is not that of {ds.attrs.get('motion')}, which the attributes name")
    return motion


def from_xarray(ds: xr.Dataset) -> Motion:
    """The motion that a dataset holds.

    Args:
        ds: `time` and `a_x`, optionally `a_z` and `pitch`, each of shape (time,) with a `units` attribute.

    Raises:
        ValueError: a variable or unit is missing or unknown, times are not equally spaced, or the samples are not
            those of the formula that the attributes name.
    """
    for name in ("time", "a_x"):
        if name not in ds:
            raise ValueError(f"dataset: holds {sorted(map(str, ds.variables))}, want {name}")
    if "motion_class" in ds.attrs:
        from excitation import formulas

        sampled = {kind.__name__: kind for kind in (SampledMotion, PiecewiseLinear)}
        return _from_recipe(ds, formulas() | sampled)
    times = values_in(ds, "time", "time")
    parts = {name: values_in(ds, name, QUANTITIES[name]) for name in ("a_z", "pitch") if name in ds}
    parts = {name: values for name, values in parts.items() if np.any(values)}
    shared: dict[str, Any] = {"start": float(times[0]), "name": str(ds.attrs.get("name", ""))}
    samples = (stated_step(ds, times), values_in(ds, "a_x", "acceleration"))
    if ds.attrs.get("interpolation", "cubic") == "cubic":
        return SampledMotion(*samples, parts.get("a_z"), parts.get("pitch"), **shared)
    if ds.attrs["interpolation"] != "linear" or "pitch" in parts:
        raise ValueError(f"interpolation={ds.attrs['interpolation']!r}: want cubic, or linear for a base without pitch")
    return PiecewiseLinear(*samples, parts.get("a_z"), **shared)
