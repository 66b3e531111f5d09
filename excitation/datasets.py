"""Motions from datasets: the way back from `Motion.to_xarray`.

A dataset with `time` and `a_x`, and `a_z` and `pitch` where there are any, each with its `units`, is a motion by
itself: a cubic spline, or straight lines if its attribute `interpolation` says `linear`.  One that was written from a
formula, or from several motions combined, also says which, and then the same object comes back (`excitation.recipes`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from excitation.motion import Motion
from excitation.recipes import made_again
from excitation.sampled import PiecewiseLinear, SampledMotion
from excitation.stated import stated_step, values_in

if TYPE_CHECKING:
    import xarray as xr

QUANTITIES = {
    "a_x": "acceleration",
    "a_z": "acceleration",
    "pitch": "angle",
    "pitch_acceleration": "angular acceleration",
}
"""What a dataset may hold of a motion besides `time`, in the order in which a motion gives it."""


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
