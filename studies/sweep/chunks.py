"""The chunks of a sweep and their files: each a labelled dataset of its own, whole or not there.

A chunk is a box of points: all values of the last axes, a range of one axis, single values of those before it.  It is
written under a temporary name, brought to the disk and renamed.

Source   none, own convention
Status   boxes cover every point once; kill -9 while writing (tests)
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from studies.running.files import save_dataset, write_whole
from studies.sweep.declared import PARAMETERS, Sweep
from studies.sweep.evaluation import OUTCOMES, VARIABLES

Box = tuple[tuple[int, int], ...]
"""(start, stop) along each axis."""


def boxes(shape: tuple[int, ...], points: int) -> Iterator[Box]:
    """Boxes of at most so many points that cover an array of that shape, each point once, in C order."""
    split = 0
    while split < len(shape) - 1 and math.prod(shape[split + 1 :]) > points:
        split += 1
    behind = math.prod(shape[split + 1 :])
    length = max(1, points // behind)
    rest = tuple((0, size) for size in shape[split + 1 :])
    for before in itertools.product(*(range(size) for size in shape[:split])):
        for start in range(0, shape[split], length):
            yield (*((i, i + 1) for i in before), (start, min(start + length, shape[split])), *rest)


def count_boxes(shape: tuple[int, ...], points: int) -> int:
    """Number of `boxes`."""
    split = 0
    while split < len(shape) - 1 and math.prod(shape[split + 1 :]) > points:
        split += 1
    length = max(1, points // math.prod(shape[split + 1 :]))
    return math.prod(shape[:split]) * -(-shape[split] // length)


def coordinates(sweep: Sweep, box: Box) -> dict[str, Any]:
    """Coordinates of a box, with units and names."""
    found = {}
    for (name, values), (start, stop) in zip(sweep.axes.items(), box, strict=True):
        parameter = PARAMETERS[name]
        units = {"units": parameter.units} if parameter.units else {}
        found[name] = (name, list(values[start:stop]), units | {"long_name": parameter.long_name})
    return found


def variable_attributes() -> dict[str, dict[str, Any]]:
    """Attributes of the variables by name."""
    found: dict[str, dict[str, Any]] = {
        name: {"units": units, "long_name": long_name} for name, (units, long_name) in VARIABLES.items()
    }
    flags = np.arange(len(OUTCOMES.split()), dtype=np.int8)
    return found | {
        "outcome": {"long_name": "what became of the block", "flag_values": flags, "flag_meanings": OUTCOMES}
    }


def as_dataset(sweep: Sweep, box: Box, result: Mapping[str, Any]) -> xr.Dataset:
    """The numbers of a box, labelled."""
    shape = tuple(stop - start for start, stop in box)
    dims, attributes = tuple(sweep.axes), variable_attributes()
    variables = {name: (dims, np.asarray(result[name]).reshape(shape), attributes[name]) for name in attributes}
    attrs = {"title": sweep.title, "declared": sweep.as_json(), "declined": json.dumps(result["declined"])}
    return xr.Dataset(variables, coordinates(sweep, box), attrs)


class Folder:
    """The folder in which the chunks of a sweep are kept until its dataset is whole."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def file(self, number: int) -> Path:
        """The file of a chunk."""
        return self.path / f"chunk-{number:09d}.nc"

    def begin(self, identity: Mapping[str, Any]) -> None:
        """Make the folder, or find it as the same sweep left it.

        Raises:
            ValueError: another sweep, or the same by other sources, has begun there, or the folder is something else.
        """
        note = self.path / "sweep.json"
        foreign = (
            f"{self.path}: want the folder of a sweep that was cut off, or none; remove it, or choose another --out"
        )
        if self.path.exists() and not self.path.is_dir():
            raise ValueError(foreign)
        self.path.mkdir(parents=True, exist_ok=True)
        for left in self.path.glob(".*"):  # of a run that was killed
            left.unlink(missing_ok=True)
        if note.exists():
            try:
                begun = json.loads(note.read_text(encoding="utf-8"))
            except (OSError, ValueError, RecursionError):
                begun = None
            if not isinstance(begun, dict):
                raise ValueError(foreign)
            for key, value in identity.items():
                if begun.get(key) != value:
                    raise ValueError(
                        f"{self.path}: holds a sweep of another {key}; want the same, or remove it, or another --out"
                    )
            return
        if any(self.path.iterdir()):
            raise ValueError(foreign)
        write_whole(note, lambda path: path.write_text(json.dumps(dict(identity)), encoding="utf-8"))

    def done(self, number: int) -> bool:
        """Whether a chunk is there."""
        return self.file(number).exists()

    def keep(self, number: int, ds: xr.Dataset) -> None:
        """Write a chunk."""
        save_dataset(ds, self.file(number))

    def sweep_away(self) -> None:
        """Remove the files of the folder, and the folder if nothing else is in it."""
        for path in itertools.chain(self.path.glob("chunk-*.nc"), self.path.glob(".*"), [self.path / "sweep.json"]):
            path.unlink(missing_ok=True)
        if not any(self.path.iterdir()):
            self.path.rmdir()
