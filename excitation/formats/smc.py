"""SMC of the USGS: eleven lines of text, 48 integers, 50 reals, comments, then acceleration in cm/s^2 in columns.

Source   USGS National Strong-Motion Program, SMC-format data files: integers in (8I10), reals in (5E15.7), samples in
         8(1PE10.4E1) or, with more digits, 5(1PE14.7E1); integer 13 the vertical, 14 the horizontal orientation, 16 the
         number of comments, 17 of samples; real 2 the samples a second, 30 and 32 the extremes.  -32768 and 1.7E+38
         stand for what is not known.
Status   reads accelerograms, corrected or not; writes eight digits.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from excitation.formats.directions import Direction
from excitation.formats.text import TextFile, one_line, write_lines
from excitation.record import Record
from excitation.units import factor

NAME = "smc"
TITLE = "SMC of the USGS"
TEXT_LINES, INTEGER_LINES, REAL_LINES = 11, 6, 10
NO_INTEGER, NO_REAL = -32768, 1.7e38
VERTICAL, HORIZONTAL, COMMENTS, COUNT = 12, 13, 15, 16
RATE, LARGEST, LEAST = 1, 29, 31
_TYPE = re.compile(
    r"^\s*([0-9])\s+(UNCORRECTED|CORRECTED|VELOCITY|DISPLACEMENT|RESPONSE|UNKNOWN|FOURIER)", re.IGNORECASE
)


def recognises(text: TextFile) -> bool:
    """Whether the first line is a type such as `2 CORRECTED ACCELEROGRAM`."""
    return _TYPE.match(text.head(0)) is not None


def _width(text: TextFile, index: int) -> int:
    """Width of a column of samples: up to and with the one-digit exponent."""
    found = text.match(index, r"^\s*[+-]?\d*\.\d+E[+-]\d", "samples such as 1.5057E+0 in columns")
    return found.end()


def _headers(text: TextFile) -> tuple[Any, Any]:
    """(48 integers, 50 reals)."""
    first = TEXT_LINES + INTEGER_LINES
    if len(text.lines) < first + REAL_LINES:
        text.fail(len(text.lines), "48 integers and 50 reals after 11 lines of text")
    integers = text.counted(TEXT_LINES, first, 48, TEXT_LINES, 10)
    reals = text.counted(first, first + REAL_LINES, 50, first, 15)
    return integers, reals


def _direction(integers: Any) -> Direction:
    """Where the sensor points: vertical angles are counted from up."""
    if integers[HORIZONTAL] != NO_INTEGER and integers[VERTICAL] in (NO_INTEGER, 90):
        azimuth = float(integers[HORIZONTAL]) % 360.0
        return Direction(f"{integers[HORIZONTAL]:g}", azimuth, False, 1.0)
    if integers[VERTICAL] in (0, 180):
        return Direction("UP", None, True, 1.0 if integers[VERTICAL] == 0 else -1.0)
    return Direction("", None, False, 1.0)


def parse(text: TextFile) -> list[Record]:
    """The one record of the file."""
    if not re.match(r"^\s*[12]\s+(UN)?CORRECTED ACCELEROGRAM", text.head(0), re.IGNORECASE):
        text.fail(0, "1 UNCORRECTED ACCELEROGRAM or 2 CORRECTED ACCELEROGRAM")
    integers, reals = _headers(text)
    first = TEXT_LINES + INTEGER_LINES + REAL_LINES
    count_line = TEXT_LINES + COUNT // 8
    if not 2 <= integers[COUNT] < 1e12 or integers[COUNT] != round(integers[COUNT]):
        text.fail(count_line, "the number of samples, two or more, as integer 17")
    comments = integers[COMMENTS]
    if not 0 <= comments <= 10000:
        text.fail(TEXT_LINES + COMMENTS // 8, "the number of comment lines, 0 to 10000, as integer 16")
    if not 1e-6 < reals[RATE] < 1e6:
        text.fail(TEXT_LINES + INTEGER_LINES, "the samples a second, above 1e-6 and below 1e6, as real 2")
    data = first + int(comments)
    for i in range(first, data):
        text.match(i, r"^\|", f"a comment that begins with |, one of {int(comments)}")
    width = _width(text, data)
    values = text.counted(data, len(text.lines), int(integers[COUNT]), count_line, width)
    for k, extreme in ((LARGEST, np.max(values)), (LEAST, np.min(values))):
        if abs(reals[k]) < 0.9 * NO_REAL:
            at = TEXT_LINES + INTEGER_LINES + k // 5
            text.check_peak(at, float(reals[k]), float(extreme), 10.0 ** (8 - width) * abs(float(extreme)) + 1e-6)
    direction = _direction(integers)
    station = re.search(r"station\s*=\s*(.*?)\s*(component|$)", text.head(5), re.IGNORECASE)
    comment_text = " ".join(line[1:].strip() for line in text.lines[first:data]).strip()
    return [
        Record(
            1.0 / float(reals[RATE]), direction.sign * factor("cm/s2", "acceleration") * values,
            component=direction.component, azimuth_deg=direction.azimuth_deg, vertical=direction.vertical,
            station=station.group(1) if station else "",
            event=" ".join(text.lines[3].split()), source=text.name, format=NAME, file_units="cm/s^2",
            sha256=text.sha256, metadata={"type": text.lines[0].strip(), "comments": comment_text},
        )
    ]  # fmt: skip


def write(path: str | Path, record: Record) -> None:
    """Write a record in cm/s^2, eight digits, and its azimuth in whole degrees.

    Values below 1e-9 of a unit become zero: the exponent has one digit.
    Raises ValueError if a value is too large for the format, 1e10 cm/s^2 and more, or the azimuth of no whole degrees.
    """
    if record.azimuth_deg is not None and record.azimuth_deg != round(record.azimuth_deg):
        raise ValueError(f"azimuth_deg={record.azimuth_deg:g}: want whole degrees for SMC")
    values = 100.0 * record.acceleration
    if np.max(np.abs(values)) >= 9.9e9:
        raise ValueError(f"acceleration: reaches {np.max(np.abs(values)):g} cm/s^2, want below 9.9e9 for SMC")
    integers = [NO_INTEGER] * 48
    integers[VERTICAL] = 0 if record.vertical else 90
    integers[HORIZONTAL] = NO_INTEGER if record.azimuth_deg is None else round(record.azimuth_deg)
    integers[COMMENTS], integers[COUNT] = 1, values.size
    if not record.vertical and record.azimuth_deg is None:
        integers[VERTICAL] = NO_INTEGER
    reals = [NO_REAL] * 50
    reals[RATE], reals[LARGEST], reals[LEAST] = 1.0 / record.time_step, float(np.max(values)), float(np.min(values))
    name = f"station = {one_line(record.station)}"
    lines = ["2 CORRECTED ACCELEROGRAM", "*", "", one_line(record.event) or "*", "*", name, *["*"] * 5]
    lines += ["".join(f"{v:10d}" for v in integers[i : i + 8]) for i in range(0, 48, 8)]
    lines += ["".join(f"{v:15.7E}" for v in reals[i : i + 5]) for i in range(0, 50, 5)]
    lines += ["|" + one_line(record.source)]
    lines += ["".join(_sample(v) for v in values[i : i + 5]) for i in range(0, values.size, 5)]
    write_lines(path, lines)


def _sample(value: float) -> str:
    """A number as 1PE14.7E1: an exponent of one digit."""
    mantissa, exponent = f"{value:.7E}".split("E")
    if int(exponent) < -9:
        mantissa, exponent = "0.0000000", "0"
    return f"{mantissa}E{int(exponent):+d}".rjust(14)
