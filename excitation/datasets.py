"""Motions from datasets: the way back from `Motion.to_xarray`.

A dataset with `time` and `a_x`, and `a_z` and `pitch` where there are any, each with its `units`, is a motion by
itself.  One that was written from a formula also says which, and then the same formula comes back.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from excitation.motion import Motion
from excitation.sampled import SampledMotion
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


def values_in(ds: xr.Dataset, name: str, quantity: str) -> NDArray[np.float64]:
    """A variable in SI; ValueError if its unit is missing or unknown."""
    unit = ds[name].attrs.get("units")
    if not isinstance(unit, str):
        raise ValueError(f"{name}: has units {unit!r}, want a unit of {quantity} in the attribute `units`")
    return factor(unit, quantity) * np.asarray(ds[name].values, dtype=np.float64)


def _from_recipe(ds: xr.Dataset, classes: dict[str, Any]) -> Motion:
    name = ds.attrs["motion_class"]
    if name not in classes:
        raise ValueError(f"motion_class={name!r}: want one of {', '.join(sorted(classes))}")
    try:
        arguments = json.loads(ds.attrs["motion_arguments"])
        motion = classes[name](**arguments)
    except (KeyError, TypeError, json.JSONDecodeError):
        found = ds.attrs.get("motion_arguments")
        raise ValueError(f"motion_arguments={found!r}: want the arguments of {name} as JSON") from None
    a_x = values_in(ds, "a_x", "acceleration")
    again = motion(values_in(ds, "time", "time"))[0]
    if not np.allclose(again, a_x, rtol=1e-9, atol=1e-9 * float(np.max(np.abs(a_x), initial=0.0))):
        raise ValueError(f"a_x: is not that of {ds.attrs.get('motion')}, which the attributes name")
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

        return _from_recipe(ds, formulas())
    times = values_in(ds, "time", "time")
    optional = {"a_z": "acceleration", "pitch": "angle"}
    parts: dict[str, NDArray[np.float64] | None] = {n: values_in(ds, n, q) for n, q in optional.items() if n in ds}
    parts = {name: values if values is not None and np.any(values) else None for name, values in parts.items()}
    name = str(ds.attrs.get("name", ""))
    return SampledMotion(
        step_of(times), values_in(ds, "a_x", "acceleration"), **parts, start=float(times[0]), name=name
    )
