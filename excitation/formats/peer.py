"""PEER NGA .AT2: four lines of header, then acceleration in g in rows of five.

Source   PEER Strong Motion Database and NGA-West2 flat files: third line the quantity and its unit, fourth line
         `NPTS= 7999, DT= .0050 SEC` or, in older files, `7999 0.0050 NPTS, DT`.
Status   reads both headers; writes the newer one with seven digits.
"""

from __future__ import annotations

import re
from pathlib import Path

from excitation.formats.directions import direction_of, name_of
from excitation.formats.text import HEADER_WIDTH, TextFile, one_line, write_lines
from excitation.record import Record
from excitation.units import STANDARD_GRAVITY, factor, quantity_of

NAME = "peer"
TITLE = "PEER NGA .AT2"
_SIZES = (
    r"NPTS\s*=\s*(?P<n>[^\s,]+)\s*,?\s*DT\s*=\s*(?P<dt>[^\s,]+)",
    r"^\s*(?P<n>\d+)\s+(?P<dt>[0-9.]\S*)\s+NPTS\s*,\s*DT",
)


def recognises(text: TextFile) -> bool:
    """Whether the third line names a quantity in units and the fourth NPTS."""
    head = [line[:HEADER_WIDTH].upper() for line in text.lines[:4]]
    return len(head) > 2 and re.search(r"TIME (SERIES|HISTORY).*UNITS? OF", head[2]) is not None


def parse(text: TextFile) -> list[Record]:
    """The one record of the file."""
    wanted = "ACCELERATION TIME SERIES IN UNITS OF G, or another unit of acceleration"
    quantity, unit = text.match(2, r"(\w+) TIME (?:SERIES|HISTORY).*UNITS? OF\s+(\S+)", wanted).groups()
    if quantity.upper() != "ACCELERATION" or quantity_of(unit) != "acceleration":
        text.fail(2, wanted)
    wanted = "NPTS= (samples), DT= (time step) SEC"
    line = text.line(3, wanted)[:HEADER_WIDTH]
    found = next((m for m in (re.search(p, line, re.IGNORECASE) for p in _SIZES) if m), None)
    if found is None:
        text.fail(3, wanted)
    count, step = text.count(3, found["n"], wanted), text.positive(3, found["dt"], wanted)
    values = text.counted(4, len(text.lines), count, 3)
    event, _, name = text.lines[1].strip().rpartition(",")
    direction = direction_of(name)
    return [
        Record(
            step, direction.sign * factor(unit, "acceleration") * values, component=direction.component,
            azimuth_deg=direction.azimuth_deg, vertical=direction.vertical, event=event.strip(), source=text.name,
            format=NAME, file_units=unit, sha256=text.sha256, metadata={"title": text.lines[0].strip()},
        )
    ]  # fmt: skip


def write(path: str | Path, record: Record) -> None:
    """Write a record in g, seven digits."""
    direction = one_line(name_of(record)).replace(",", " ")
    values = record.acceleration / STANDARD_GRAVITY
    rows = ["".join(f"{v:15.7E}" for v in values[i : i + 5]) for i in range(0, values.size, 5)]
    head = [
        "PEER NGA STRONG MOTION DATABASE RECORD",
        f"{one_line(record.event or record.source)}, {direction}",
        "ACCELERATION TIME SERIES IN UNITS OF G",
        f"NPTS= {values.size:6d}, DT= {record.time_step:.10g} SEC",
    ]
    write_lines(path, [*head, *rows])
