"""Motions as class names and arguments: what a dataset says of a formula besides its values, and the formula again.

The arguments stand as JSON in the attribute `motion_arguments`.  A motion inside another is described in the same way;
samples inside are variables of their own (`horizontal_a_x` for those of the argument `horizontal`), with units.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from excitation.stated import values_in

if TYPE_CHECKING:
    import xarray as xr

SAMPLES = {"a_x": ("m s-2", "acceleration"), "a_z": ("m s-2", "acceleration"), "pitch": ("rad", "angle")}
"""Unit and quantity of the samples that a motion may hold."""


@runtime_checkable
class Made(Protocol):
    """What is told of a motion: `excitation.motion.Motion` has it."""

    @property
    def arguments(self) -> dict[str, Any] | None: ...


def _described(motion: Made, path: str, held: dict[str, tuple[str, NDArray[np.float64]]]) -> dict[str, Any] | None:
    """Class and arguments of a motion, its samples put into `held`; None if arguments do not make it."""
    arguments = motion.arguments
    if arguments is None:
        return None
    for name, value in arguments.items():
        if isinstance(value, Made):
            arguments[name] = _described(value, f"{path}{name}_", held)
            if arguments[name] is None:
                return None
        elif isinstance(value, np.ndarray):
            held[f"{path}{name}"] = (name, value)
            arguments[name] = {"variable": f"{path}{name}"}
    return {"motion_class": type(motion).__name__, "motion_arguments": arguments}


def with_recipe(ds: xr.Dataset, motion: Made) -> xr.Dataset:
    """The dataset with what makes the motion again, if arguments do."""
    held: dict[str, tuple[str, NDArray[np.float64]]] = {}
    described = _described(motion, "", held)
    if described is None:
        return ds
    described["motion_arguments"] = json.dumps(described["motion_arguments"], default=float)
    variables = {
        path: (
            path.removesuffix(name) + "sample",
            values,
            {"units": SAMPLES[name][0], "long_name": f"samples of {path}"},
        )
        for path, (name, values) in held.items()
    }
    return ds.assign(variables).assign_attrs(described)


def made_again(ds: xr.Dataset, classes: dict[str, Any]) -> Any:
    """The motion that the dataset's recipe makes.

    Raises ValueError if the recipe is not JSON, or is that of no motion here.
    """
    name = ds.attrs["motion_class"]
    if name not in classes:
        raise ValueError(f"motion_class={name!r}: want one of {', '.join(sorted(classes))}")
    try:
        return _made(name, json.loads(ds.attrs["motion_arguments"]), ds, classes)
    except (KeyError, TypeError, AttributeError, RecursionError, json.JSONDecodeError):
        found = repr(ds.attrs.get("motion_arguments"))
        found = found if len(found) <= 80 else f"{found[:77]}..."
        raise ValueError(f"motion_arguments={found}: want the arguments of {name} as JSON") from None


def _made(name: str, arguments: dict[str, Any], ds: xr.Dataset, classes: dict[str, Any]) -> Any:
    given: dict[str, Any] = {}
    for key, value in arguments.items():
        if isinstance(value, dict) and "variable" in value:
            given[key] = values_in(ds, value["variable"], SAMPLES[key][1])
        elif isinstance(value, dict):
            given[key] = _made(value["motion_class"], value["motion_arguments"], ds, classes)
        else:
            given[key] = value
    return classes[name](**given)
