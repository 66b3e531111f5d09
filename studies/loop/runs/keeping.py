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
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studies.running.parts import read_arrays, studies_hash, write_arrays

Results = Mapping[str, NDArray[Any]]

FOLDER = ".fits"
"""Where they are, within the folder of --out."""


def _fed(digest: Any, item: Any) -> None:
    """Everything that an object says of itself, and its type, into a digest.

    Raises:
        TypeError: it is of a kind of which nothing is known.
    """
    item = item.item() if isinstance(item, np.generic) else item
    digest.update(type(item).__name__.encode() + b"(")
    if isinstance(item, np.ndarray):
        digest.update(f"{item.dtype.str}{item.shape}".encode() + np.ascontiguousarray(item).tobytes())
    elif item is None or isinstance(item, bool | int | float | str | Path):
        digest.update(repr(item).encode())
    elif is_dataclass(item):
        for each in fields(item):
            _fed(digest, getattr(item, each.name))
    elif isinstance(item, Mapping):
        for name in item:
            _fed(digest, name)
            _fed(digest, item[name])
    elif isinstance(item, Sequence):
        for part in item:
            _fed(digest, part)
    else:
        raise TypeError(f"{item!r}: want numbers, texts, arrays, dataclasses, mappings or sequences of them")
    digest.update(b")")


def digest_of(*items: Any) -> str:
    """A hash of all that the items hold."""
    digest = hashlib.sha256()
    for item in items:
        _fed(digest, item)
    return digest.hexdigest()[:32]


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
