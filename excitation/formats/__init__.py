"""Reading and writing records: one format, one file.

`read` finds the format by what stands in the file, never by its name.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from excitation.formats import columns, cosmos, csmip, dyna, knet, nsmn, peer, seismology, smc
from excitation.formats.text import is_text, read_bytes, text_file
from excitation.record import Record, RecordFileError

READERS: dict[str, Any] = {module.NAME: module for module in (peer, knet, dyna, nsmn, cosmos, smc, csmip)}
"""Formats whose header states everything, in the order in which they are tried."""

WRITERS: dict[str, Any] = {module.NAME: module for module in (peer, dyna, smc, columns)}

LARGEST_ACCELERATION = 1e8
"""[m/s^2]: ten million g, above all that a sensor on a structure measures."""
SHORTEST_STEP, LONGEST_STEP = 1e-7, 1e4
"""[s], of a record."""


def read(
    path: str | Path, *, format: str | None = None, units: str | None = None, time_units: str | None = None
) -> list[Record]:
    """The acceleration records in a file, in SI.

    Args:
        path: the file.
        format: one of `formats()`; found by what the file holds if not given.
        units: unit of acceleration for a file that states none (columns without headings, miniSEED, SAC).
        time_units: unit of the time column for a file that states none.

    Raises:
        RecordFileError: (a ValueError) the file is not what its header promises, or in no known format; says file,
            line, what was found and what was wanted.
        ValueError: an argument is unknown, or states a unit that the file states itself.
        OSError: the file cannot be opened.
    """
    if format is not None and format not in formats():
        raise ValueError(f"format={format!r}: want one of {', '.join(formats())}")
    return [_plausible(record) for record in _parsed(path, format, units, time_units)]


def _plausible(record: Record) -> Record:
    """The record, or the error that its numbers cannot be a motion: a digit or the unit is damaged."""
    largest = float(np.max(np.abs(record.acceleration)))
    if largest > LARGEST_ACCELERATION:
        raise RecordFileError(
            f"{record.source}: reaches {largest:.4g} m/s^2, want at most {LARGEST_ACCELERATION:g} m/s^2"
        )
    if not SHORTEST_STEP <= record.time_step <= LONGEST_STEP:
        raise RecordFileError(
            f"{record.source}: has a time step of {record.time_step:g} s, want {SHORTEST_STEP:g} to {LONGEST_STEP:g} s"
        )
    return record


def _parsed(path: str | Path, format: str | None, units: str | None, time_units: str | None) -> list[Record]:
    """Records by the reader that the arguments or the file name."""
    name, data = Path(path).name, read_bytes(path)
    if format == seismology.NAME or not is_text(data):
        return seismology.parse(name, data, units)
    text = text_file(name, data)
    found = format or next((key for key, module in READERS.items() if module.recognises(text)), None)
    if found is None and columns.recognises(text):
        found = columns.NAME
    if found is None:
        return seismology.parse(name, data, units)
    if found == columns.NAME:
        return columns.parse(text, units, time_units)
    for argument, value in (("units", units), ("time_units", time_units)):
        if value is not None:
            raise ValueError(f"{argument}={value!r}: want none, a {READERS[found].TITLE} file states its own")
    records: list[Record] = READERS[found].parse(text)
    return records


def formats() -> dict[str, str]:
    """Names of the formats that `read` takes, with what they are."""
    modules = (*READERS.values(), columns, seismology)
    return {module.NAME: module.TITLE for module in modules}


def write(path: str | Path, record: Record | Sequence[Record], format: str) -> None:
    """Write a record, or several of one time step and length as columns.

    Args:
        path: the file; written over if it is there.
        record: what to write.
        format: `columns` (every bit of the samples), `dyna`, `peer` or `smc` (their digits).

    Raises:
        ValueError: the format is none of these, or cannot hold the record or so many.
    """
    if format not in WRITERS:
        raise ValueError(f"format={format!r}: want one of {', '.join(WRITERS)}")
    records = [record] if isinstance(record, Record) else list(record)
    if not records or (len(records) > 1 and format != columns.NAME):
        raise ValueError(f"record: {len(records)} of them, want one, or one or more in the format {columns.NAME}")
    WRITERS[format].write(path, *records)


__all__ = ["READERS", "WRITERS", "Record", "RecordFileError", "formats", "read", "write"]
