"""The older three-column text of Turkey's national network (AFAD): lines `KEY : value`, then N-S, E-W and U-D in gal.

Source   files of the network's archive before it took to DYNA: fifteen lines from STRONG GROUND MOTION RECORDS OF
         TURKIYE to RAW PGA VALUES (gal), two of copyright, the names of the columns, one line a sample.
Status   NUMBER OF DATA and the three largest values are checked; the latter are those of the columns to the last digit.
"""

from __future__ import annotations

import re
from datetime import datetime
from typing import NamedTuple

import numpy as np

from excitation.formats.directions import direction_of
from excitation.formats.text import HEADER_WIDTH, TextFile, decimals
from excitation.record import Record
from excitation.units import factor, quantity_of

NAME = "nsmn"
TITLE = "three-column text of AFAD's older archive"
LONGEST_HEADER = 60
COUNT, STEP, PEAKS, START = "NUMBER OF DATA", "SAMPLING INTERVAL (sec)", "RAW PGA VALUES", "RECORD TIME"
_KEY = re.compile(r"^\s*([A-Z][^:]*?)\s*:\s*(.*?)\s*$")
_START_FORMS = ("%d/%m/%Y %H:%M:%S.%f", "%Y/%m/%d %H:%M:%S.%f", "%d/%m/%Y %H:%M:%S", "%Y/%m/%d %H:%M:%S")


def recognises(text: TextFile) -> bool:
    """Whether the first line is that of the archive."""
    return re.match(r"^\s*STRONG GROUND MOTION RECORDS OF TURK", text.head(0)) is not None


class _Header(NamedTuple):
    """Values by key with the index of their line, and the columns' names."""

    values: dict[str, tuple[int, str]]
    columns: list[str]
    size: int


def _header(text: TextFile) -> _Header:
    values: dict[str, tuple[int, str]] = {}
    for i, line in enumerate(text.lines[:LONGEST_HEADER]):
        if sorted(line.split()) == ["E-W", "N-S", "U-D"]:
            return _Header(values, line.split(), i + 1)
        found = _KEY.match(line[:HEADER_WIDTH])
        if found:
            values[found.group(1)] = (i, found.group(2))
    text.fail(min(len(text.lines), LONGEST_HEADER) - 1, "a line with the columns' names N-S, E-W and U-D by here")


def _need(text: TextFile, header: _Header, key: str) -> tuple[int, str, str]:
    """(line index, key as printed, value) of the header line that begins with a key."""
    for printed, (index, value) in header.values.items():
        if printed.upper().startswith(key.upper()):
            return index, printed, value
    text.fail(header.size - 1, f"the header line {key} before the columns' names")


def _start(text: TextFile, header: _Header) -> str:
    if START not in header.values:
        return ""
    index, value = header.values[START]
    for form in _START_FORMS:
        try:
            return datetime.strptime(value.replace("(GMT)", "").replace("(UTC)", "").strip(), form).isoformat()
        except ValueError:
            continue
    text.fail(index, "RECORD TIME as dd/mm/yyyy hh:mm:ss (GMT)")


def _peaks(text: TextFile, header: _Header) -> tuple[int, str, dict[str, str]]:
    """(line index, unit, largest value of each column as printed)."""
    index, printed, value = _need(text, header, PEAKS)
    unit = re.search(r"\((.*?)\)", printed)
    if unit is None or quantity_of(unit.group(1)) != "acceleration":
        text.fail(index, f"{PEAKS} (gal)")
    peaks = dict(re.findall(r"\(([NEU]-[SWD])\)\s*(\S+)", value))
    if set(peaks) != set(header.columns):
        text.fail(index, "the largest values as (N-S) .. (E-W) .. (U-D) ..")
    return index, unit.group(1), peaks


def parse(text: TextFile) -> list[Record]:
    """The three components."""
    header = _header(text)
    count_line, _, value = _need(text, header, COUNT)
    count = text.count(count_line, value, f"{COUNT}: the number of lines, two or more")
    at, _, value = _need(text, header, STEP)
    step = text.positive(at, value, f"{STEP}: the time step")
    peak_line, unit, peaks = _peaks(text, header)
    for i in range(header.size, len(text.lines)):
        if len(text.lines[i].split()) != 3:
            text.fail(i, "three numbers")
    table = text.counted(header.size, len(text.lines), 3 * count, count_line).reshape(count, 3)
    records = []
    for k, name in enumerate(header.columns):
        stated = text.number(peak_line, peaks[name], "the largest values as numbers")
        text.check_peak(peak_line, abs(stated), float(np.max(np.abs(table[:, k]))), decimals(peaks[name]))
        direction = direction_of(name)
        records.append(
            Record(
                step, factor(unit, "acceleration") * table[:, k], component=name, azimuth_deg=direction.azimuth_deg,
                vertical=direction.vertical, station=header.values.get("STATION ID", (0, ""))[1],
                event=header.values.get("EARTHQUAKE DATE", (0, ""))[1], start_time=_start(text, header),
                source=text.name, format=NAME, file_units=unit, sha256=text.sha256,
                metadata={key: found for key, (_, found) in header.values.items() if found},
            )
        )  # fmt: skip
    return records
