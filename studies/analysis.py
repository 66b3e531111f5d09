"""Datasets in the hands of users: opened with units that plot well, criteria between the points that were computed.

    import studies
    ds = studies.open("fig16.nc")
    studies.interpolated(ds.overturning_amplitude, frequency=2.3)

Source   none, own convention
Status   interpolation against criteria computed at the points between (tests)
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from studies.running.command_line import DEFAULT_OUT
from studies.running.files import load_dataset

PLAIN = {
    "m s-2": "m/s²", "m s-1": "m/s", "rad s-1": "rad/s", "kg m2": "kg m²", "N m-1": "N/m", "1": "–",
    "m/s^2": "m/s²",
}  # fmt: skip
"""Units as CF writes them, the last as earlier runs of distinct elements have it, and as a figure should."""


def open(file: str | Path, *, cf_units: bool = False) -> xr.Dataset:
    """A dataset of a study, loaded, with units as a figure should have them.

    Args:
        file: path, or the name of a file in build/studies.
        cf_units: leave the units as the file has them (CF), for further processing.

    Raises:
        FileNotFoundError: neither is there.
        ValueError: the file is damaged, no NetCDF, or declares more values than memory should take.
    """
    path = Path(file)
    if not path.exists() and not (DEFAULT_OUT / path).exists():
        raise FileNotFoundError(f"{file}: neither there nor in {DEFAULT_OUT}; python -m studies all makes the datasets")
    ds = load_dataset(path if path.exists() else DEFAULT_OUT / path)
    if not cf_units:
        for variable in ds.variables.values():
            if variable.attrs.get("units") in PLAIN:
                variable.attrs["units"] = PLAIN[variable.attrs["units"]]
    return ds


def interpolated(criterion: xr.DataArray, **at: ArrayLike) -> xr.DataArray:
    """A criterion between the points at which it was computed: its logarithm linearly in the coordinates.

    Args:
        criterion: positive, over coordinates that ascend.
        at: values by the name of the coordinate, as frequency=[1.2, 3.4].

    Returns:
        The criterion there; NaN outside the points and beside a gap, since nothing is known there.

    Raises:
        ValueError: a name is not a dimension with numbers, or a value of the criterion is not positive.
    """
    for name in at:
        if name not in criterion.dims or criterion[name].dtype.kind not in "fiu":
            raise ValueError(f"{name}: want a dimension with numbers, one of {', '.join(map(str, criterion.dims))}")
    if bool((criterion <= 0.0).any()):
        raise ValueError("criterion: want positive values (NaN where there is none)")
    points: dict[Any, Any] = {name: np.atleast_1d(np.asarray(values, dtype=np.float64)) for name, values in at.items()}
    logarithm: xr.DataArray = xr.apply_ufunc(np.log, criterion)
    found: xr.DataArray = xr.apply_ufunc(np.exp, logarithm.interp(points, method="linear"))
    return found.assign_attrs(criterion.attrs).rename(criterion.name)
