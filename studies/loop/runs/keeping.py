"""Fits and runs that a loop has done, kept on the disk until its files are written: a loop that was cut off goes on.

A result is found again by all that it came from: records, model, parameters, windows, options, and the sources.

Source   none, own convention
Status   a loop that was killed gives the files of one that was not, and repeats no fit that was finished (tests)
"""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studies.running.parts import read_arrays, studies_hash, write_arrays

Results = Mapping[str, NDArray[Any]]

FOLDER = ".fits"
"""Where they are, within the folder of --out."""


@cache
def _names_of(kind: Any) -> tuple[str, ...] | None:
    """Names of the fields of a dataclass; None for any other type."""
    return tuple(each.name for each in fields(kind)) if is_dataclass(kind) else None


def _said(item: Any, known: dict[int, tuple[Any, bytes]]) -> bytes:
    """Everything that an object says of itself, and its type.

    known: others and what they said, by identity: windows of one record share most of what they hold.

    Raises:
        TypeError: it is of a kind of which nothing is known.
    """
    kind: Any = type(item)
    if kind is not float and isinstance(item, np.generic):
        return _said(item.item(), known)
    name = type(item).__name__.encode()
    if kind is float or item is None or isinstance(item, bool | int | float | str | Path):
        return b"%s(%s)" % (name, repr(item).encode())
    if id(item) in known:
        return known[id(item)][1]
    if isinstance(item, np.ndarray):
        said = [f"{item.dtype.str}{item.shape}".encode(), item.tobytes()]
    elif (names := _names_of(kind)) is not None:
        said = [_said(getattr(item, each), known) for each in names]
    elif isinstance(item, Mapping):
        said = [_said(part, known) for pair in item.items() for part in pair]
    elif isinstance(item, Sequence):
        said = [_said(part, known) for part in item]
    else:
        raise TypeError(f"{item!r}: want numbers, texts, arrays, dataclasses, mappings or sequences of them")
    whole = b"%s(%s)" % (name, b"".join(said))
    known[id(item)] = item, whole
    return whole


def digest_of(*items: Any) -> str:
    """A hash of all that the items hold."""
    return hashlib.sha256(_said(items, {})).hexdigest()[:32]


class Keeper:
    """Results in a folder of a loop's output.

    Args:
        out: folder of the output; the results lie in a hidden folder in it.
    """

    def __init__(self, out: Path) -> None:
        self.folder = out / FOLDER
        self._place = self.folder / studies_hash()

    def _path(self, key: str) -> Path:
        return self._place / f"{key}.npz"

    def read(self, key: str) -> Results | None:
        """What was kept under a key; None if nothing was, or if it is damaged."""
        return read_arrays(self._path(key))

    def write(self, key: str, results: Results) -> None:
        """Keep results under a key.

        Raises:
            OSError: they cannot be written.
        """
        write_arrays(self._path(key), results)

    def clear(self) -> None:
        """Forget everything: the files that it was for are written."""
        shutil.rmtree(self.folder, ignore_errors=True)
