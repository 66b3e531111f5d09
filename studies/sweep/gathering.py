"""The chunks of a sweep put into one dataset, one at a time, so that its size does not matter.

The file is laid out in the order in which chunks come, so that each piece of it is compressed once and few are held.

Source   CF conventions 1.11 for the attributes
Status   the dataset of an interrupted sweep equals that of one that was not; finished in half of the memory that its
         numbers take (tests)
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr

from studies.running.files import load_dataset, provenance, seal, write_whole
from studies.running.interrupts import noted
from studies.sweep.chunks import Box, Folder, boxes, coordinates, variable_attributes
from studies.sweep.declared import Sweep
from studies.sweep.evaluation import G

PIECE = 65_536
"""Points of a compressed piece of the file: half a megabyte of each variable."""


def _skeleton(target: netCDF4.Dataset, sweep: Sweep) -> None:
    """Dimensions, coordinates and variables without numbers."""
    whole = tuple((0, size) for size in sweep.shape)
    for name, (_, values, attributes) in coordinates(sweep, whole).items():
        target.createDimension(name, len(values))
        kind: Any = str if isinstance(values[0], str) else "f8"
        variable = target.createVariable(name, kind, (name,))
        variable[:] = np.array(values, dtype=object if kind is str else np.float64)
        variable.setncatts(attributes)
    # By itself the library chooses pieces of a like share of every axis, all of which are under way to the end.
    piece = tuple(stop - start for start, stop in next(boxes(sweep.shape, PIECE)))
    for name, attributes in variable_attributes().items():
        kind, missing = ("i1", None) if name == "outcome" else ("f8", np.nan)
        variable = target.createVariable(
            name, kind, tuple(sweep.axes), zlib=True, fill_value=missing, chunksizes=piece,
            chunk_cache=4 * np.dtype(kind).itemsize * math.prod(piece),
        )  # fmt: skip
        variable.setncatts(attributes)


def _chunk(stated: str, box: Box, path: Path) -> xr.Dataset:
    """The chunk of that box, of the sweep that is stated so."""
    try:
        ds = load_dataset(path)
        shape = tuple(stop - start for start, stop in box)
        fits = all(name in ds and ds[name].shape == shape for name in variable_attributes())
        json.loads(ds.attrs["declined"])
        if fits and ds.attrs["declared"] == stated:
            return ds
    except (KeyError, TypeError, ValueError):
        pass
    path.unlink(missing_ok=True)
    raise RuntimeError(f"{path}: was damaged and is removed; the same command computes it again") from None


def gather(sweep: Sweep, folder: Folder, points: int, target: Path, attributes: dict[str, str]) -> None:
    """Write the dataset of all chunks.

    Raises:
        RuntimeError: a chunk cannot be read; it has been removed.
    """
    declined, stated = set[str](), sweep.as_json()

    def write(path: Path) -> None:
        with noted() as interrupt, netCDF4.Dataset(path, "w") as file:
            _skeleton(file, sweep)
            for number, box in enumerate(boxes(sweep.shape, points)):
                interrupt.hear()
                part, where = _chunk(stated, box, folder.file(number)), tuple(slice(*pair) for pair in box)
                for name in variable_attributes():
                    file[name][where] = part[name].values
                declined.update(json.loads(part.attrs["declined"]))
            file.setncatts(attributes | {"declined": json.dumps(sorted(declined))})
        seal(path)

    write_whole(target, write)


def count(ds: xr.Dataset, outcome: int) -> int:
    """Points of that outcome, counted piece by piece."""
    parts = (tuple(slice(*pair) for pair in box) for box in boxes(ds.outcome.shape, 16 * PIECE))
    return sum(int((ds.outcome[part] == outcome).sum()) for part in parts)


def attributes_of(sweep: Sweep, identity: dict[str, Any], command: str) -> dict[str, str]:
    """Enough to make the dataset again."""
    again = {
        "references": "criteria after Winkler, Meguro & Yamazaki (1995)",
        "declared": sweep.as_json(),
        "sources": str(identity["sources"]),
        "gravity": f"{G} m s-2",
    }
    return provenance(sweep.title, command) | again
