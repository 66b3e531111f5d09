"""COSMOS .V1c and .V2c: text, integers and reals under lines that say how many and in which format, then samples.

Source   COSMOS Strong Motion Programs Board (2001), COSMOS strong motion data format, version 1.20.  Integer 54 is the
         azimuth of the sensor, 1 to 360 (400 up, 401 down, 402 vertical); real 62 the time step in ms, real 34 that
         of the raw record in s.
Status   the acceleration of every channel; velocity and displacement are counted and left.  Raw counts (.V0) are
         refused: their sensitivity is not applied here.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from excitation.formats.clock import start_time
from excitation.formats.directions import Direction, direction_of
from excitation.formats.text import HEADER_WIDTH, TextFile, decimals, fortran_width
from excitation.record import Record
from excitation.units import factor, quantity_of

NAME = "cosmos"
TITLE = "COSMOS .V1c and .V2c"
AZIMUTH, STEP_MS, RAW_STEP = 53, 61, 33
UP = {400: 1.0, 401: -1.0, 402: 1.0}
_QUANTITY = r"(?P<kind>acceleration|velocity|displacement|accel|veloc|displ)"
_DATA = rf"^\s*(?P<n>\S+)\s+{_QUANTITY}\.?\s+(?:pts|points)"
_DATA_WANTED = "(count) acceleration pts, approx (length) secs, units=(unit),Format=(format)"


def recognises(text: TextFile) -> bool:
    """Whether the first line says (Format v..)."""
    return re.search(r"\(format v", text.head(0), re.IGNORECASE) is not None


def _block(text: TextFile, index: int, what: str) -> tuple[Any, int]:
    """(numbers, index of the next line) of a header block under its line of facts."""
    wanted = f"(count) {what}-header values follow on (count) lines, Format= (format)"
    found = text.match(index, rf"^\s*(\d+)\s+{what}-header.*?(\d+)\s+lines?.*Format\s*=\s*(\(.*?\))", wanted)
    layout = fortran_width(found.group(3))
    if layout is None or len(found.group(1)) > 6:
        text.fail(index, wanted)
    return text.rows(index + 1, int(found.group(1)), layout[0], index, layout[1])


def _comments(text: TextFile, index: int) -> tuple[list[str], int]:
    """(comments, index of the next line)."""
    wanted = '(count) Comment line(s) follow, each starting with a "|"'
    count = int(text.match(index, r"^\s*(\d{1,6})\s+Comment", wanted).group(1))
    for i in range(index + 1, index + 1 + count):
        text.match(i, r"^\s*\|", f"a comment that begins with |, one of {count}")
    return [line.strip().lstrip("|").strip() for line in text.lines[index + 1 : index + 1 + count]], index + 1 + count


def _step(text: TextFile, reals: Any, at: int, index: int, count: int, unknown: float) -> float:
    """Time step [s] from the real header, checked against the length in the line of facts."""
    length = text.match(index, r"approx\.?\s+([\d.]+)\s+sec", _DATA_WANTED).group(1)
    known = [
        (scale * reals[k], k)
        for k, scale in ((STEP_MS, 1e-3), (RAW_STEP, 1.0))
        if k < reals.size and reals[k] > 0.0 and reals[k] != unknown
    ]
    if not known:
        text.fail(at, f"the time step [ms] as real {STEP_MS + 1} or [s] as real {RAW_STEP + 1} of the block below")
    step, _ = known[0]
    stated = text.number(index, length, _DATA_WANTED)
    if abs(count * step - stated) > 1.01 + step:
        text.fail(index, f"approx {count * step:.4g} secs: {count} samples at the real header's step of {step:g} s")
    return float(step)


def _unknown(text: TextFile, first: int, last: int) -> float:
    """The number that stands for unknown real values."""
    for i in range(first, last):
        found = re.search(r"unknown/unspecified:\s*(-?\d+)[,\s]+(-?[\d.]+)", text.head(i))
        if found:
            return text.number(i, found.group(2), "the number that stands for unknown real values")
    return -999.0


def _check_peak(text: TextFile, first: int, last: int, unit: str, largest: float) -> None:
    """The text header's Max against the samples [SI]."""
    for i in range(first, last):
        found = re.search(r"^Processed.*Max\s*=\s*(-?[\d.]+)\s+(\S+)", text.head(i), re.IGNORECASE)
        if found and quantity_of(found.group(2)) == "acceleration":
            scale = factor(found.group(2), "acceleration")
            stated = text.number(i, found.group(1), "the largest acceleration as a number")
            text.check_peak(i, scale * abs(stated), largest, scale * decimals(found.group(1)))


def _direction(integers: Any, comments: list[str]) -> Direction:
    """Where the sensor points; from the channel's code (SCNL) where the integer does not say."""
    code = int(integers[AZIMUTH]) if integers.size > AZIMUTH else -999
    if code in UP:
        return Direction("UP", None, True, UP[code])
    if 1 <= code <= 360:
        return Direction(str(code), float(code % 360), False, 1.0)
    found = (re.search(r"SCNL>?:?\s*\w+\.(\w+)\.", comment[:HEADER_WIDTH]) for comment in comments)
    scnl = next((match for match in found if match), None)
    if scnl:
        return direction_of(scnl.group(1)[-1])._replace(component=scnl.group(1))
    return Direction("", None, False, 1.0)


def _channel(text: TextFile, first: int) -> tuple[Record | None, int]:
    """(record or None if it is no acceleration, index of the line after the channel)."""
    wanted = "Corrected acceleration (Format v01.20 with 13 text lines)"
    head = text.match(first, r"\(format v\S*\s+with\s+(\d{1,3})\s+text", wanted)
    at = first + int(head.group(1))
    text_end = at
    integers, at = _block(text, at, "Integer")
    real_line = at
    reals, at = _block(text, at, "Real")
    comments, at = _comments(text, at)
    found = text.match(at, _DATA, _DATA_WANTED)
    count = text.count(at, found["n"], _DATA_WANTED)
    unit, layout_text = text.match(at, r"units\s*=\s*([^,(]+).*Format\s*=\s*(\(.*?\))", _DATA_WANTED).groups()
    layout = fortran_width(layout_text)
    if layout is None:
        text.fail(at, "a format such as (8F10.5)")
    values, after = text.rows(at + 1, count, layout[0], at, layout[1])
    text.match(after, r"end[- ]of[- ]data", "a line End-of-data")
    if not found["kind"].lower().startswith("accel"):
        return None, after + 1
    if quantity_of(unit) != "acceleration":
        text.fail(at, "a unit of acceleration, not counts or volts")
    step = _step(text, reals, real_line, at, count, _unknown(text, first, text_end))
    values = factor(unit, "acceleration") * values
    _check_peak(text, first, text_end, unit, float(np.max(np.abs(values))))
    direction = _direction(integers, comments)
    titles = [line.strip() for line in text.lines[first:text_end]]
    codes = (re.search(r"Code:\s*(\S+)", text.head(i)) for i in range(first, text_end))
    station = next((match for match in codes if match), None)
    event = re.search(r"(?:Record|Rcrd) of (.*)", titles[1][:HEADER_WIDTH] if len(titles) > 1 else "")
    return Record(
        step, direction.sign * values, component=direction.component, azimuth_deg=direction.azimuth_deg,
        vertical=direction.vertical,
        station=station.group(1) if station else "", event=event.group(1) if event else "",
        start_time=start_time(text, first, text_end), source=text.name, format=NAME,
        file_units=unit.strip(), sha256=text.sha256,
        metadata={"title": titles[0], "header": " | ".join(titles), "comments": " | ".join(comments)},
    ), after + 1  # fmt: skip


def parse(text: TextFile) -> list[Record]:
    """The acceleration of each channel."""
    records, at = [], 0
    while at < len(text.lines):
        record, at = _channel(text, at)
        if record is not None:
            records.append(record)
        while at < len(text.lines) and not text.lines[at].strip():
            at += 1
    if not records:
        text.fail(0, "at least one channel of acceleration")
    return records
