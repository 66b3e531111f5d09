"""CSMIP (CDMG, CGS) .V1 and .V2: text, integers and reals in fixed columns, then samples; several channels.

Source   Shakal & Huang (1985), Standard tape format for CSMIP strong-motion data tapes, report OSMS 85-03.  Volume 1
         has 13 lines of text, volume 2 has 25; then 100 integers in (16I5), and 50 or 100 reals in (8F10.3).  Volume 2
         goes on with acceleration, velocity and displacement, each under a line with count, step and unit.  Volume 1
         goes on with pairs of time and acceleration in 5(2F7.3) or, in files of digital recorders, with equally spaced
         samples under a line such as `13200 Accelerogram points at 200 pts/sec in units of g. Format: (8f9.6)`.
Status   the acceleration of every channel; velocity and displacement are counted and left.  Unequally spaced pairs of a
         volume 1 are laid on equal steps by straight lines, and the record says so.  The three layouts of samples are
         those of files of 1983, 1994 and 2012.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from excitation.formats.clock import start_time
from excitation.formats.directions import Direction, direction_of
from excitation.formats.text import TextFile, decimals, fortran_width
from excitation.record import Record
from excitation.units import factor, quantity_of

NAME = "csmip"
TITLE = "CSMIP .V1 and .V2"
V1_TEXT, V2_TEXT = 13, 25
INTEGER_LINES = 7
V1_REAL_LINES, V2_REAL_LINES = 7, 13
V1_COUNT, V1_LONG_COUNT, V2_COUNT, V2_STEP = 27, 32, 52, 60
TIME_RESOLUTION = 0.001
"""Times of a volume 1 are printed to a thousandth of a second."""
STEP_RESOLUTION = 0.5e-3 + 1e-12
"""Half of the last digit of the step [s] among the reals of a volume 2, and what rounding adds."""

_DATA = (
    r"^\s*(?P<n>\S+)\s+POINTS OF (?P<kind>ACCEL|VELOC|DISPL)\w* DATA,? EQUALLY SPACED AT\s+(?P<dt>\S+)\s+SEC"
    r"\.?,?\s*(?:\(UNITS:\s*|IN\s+)(?P<unit>[^)(,.\s]+)\)?\.?\s*(?P<format>\([^)]*\))?"
)
_V1_DATA = (
    r"^\s*(?P<n>\S+)\s+ACCELEROGRAM POINTS AT\s+(?P<rate>\S+)\s+PTS/SEC\s+IN UNITS OF\s+(?P<unit>\S+)"
    r"[\s.]*(?:FORMAT:)?\s*(?P<format>\([^)]*\))"
)
_V1_WANTED = "(count) Accelerogram points at (rate) pts/sec in units of (unit). Format: (format)"
_WANTED = "(count) POINTS OF ACCEL DATA EQUALLY SPACED AT (step) SEC. (UNITS: CM/SEC/SEC)"
_KINDS = {"ACCEL": "acceleration", "VELOC": "velocity", "DISPL": "displacement"}


def recognises(text: TextFile) -> bool:
    """Whether the first line is that of a volume 1 or 2."""
    return re.match(r"^\s*(UN)?CORRECTED ACCELEROGRAM", text.head(0), re.IGNORECASE) is not None


@dataclass(frozen=True)
class _Channel:
    """Where a channel's header stands and what it says."""

    text: TextFile
    first: int
    text_lines: int
    integers: Any
    reals: Any

    @property
    def data(self) -> int:
        """Index of the first line after the headers."""
        real_lines = V1_REAL_LINES if self.text_lines == V1_TEXT else V2_REAL_LINES
        return self.first + self.text_lines + INTEGER_LINES + real_lines

    def find(self, pattern: str) -> tuple[int, re.Match[str]] | None:
        """(line index, match) of the first text line that fits."""
        for i in range(self.first, self.first + self.text_lines):
            found = re.search(pattern, self.text.head(i), re.IGNORECASE)
            if found:
                return i, found
        return None


def _channel(text: TextFile, first: int) -> _Channel:
    volume = text.match(
        first, r"^\s*(UN)?CORRECTED ACCELEROGRAM", "(UN)CORRECTED ACCELEROGRAM at the start of a channel"
    )
    text_lines, real_lines, real_count = (
        (V1_TEXT, V1_REAL_LINES, 50) if volume.group(1) else (V2_TEXT, V2_REAL_LINES, 100)
    )
    at = first + text_lines
    if at + INTEGER_LINES + real_lines >= len(text.lines):
        text.fail(len(text.lines), f"{text_lines} lines of text, 100 integers, {real_count} reals and samples")
    integers = text.counted(at, at + INTEGER_LINES, 100, at, 5)
    at += INTEGER_LINES
    reals = text.counted(at, at + real_lines, real_count, at, 10)
    return _Channel(text, first, text_lines, integers, reals)


def _series(text: TextFile, index: int, kind: str) -> tuple[NDArray[np.float64], float, str, int]:
    """(samples, step [s], unit, index of the next line) of a series under its line of facts."""
    found = text.match(index, _DATA, _WANTED.replace("ACCEL", kind))
    count, step = text.count(index, found["n"], _WANTED), text.positive(index, found["dt"], _WANTED)
    if found["kind"].upper() != kind or quantity_of(found["unit"]) != _KINDS[kind]:
        text.fail(index, _WANTED.replace("ACCEL", kind))
    layout = fortran_width(found["format"]) if found["format"] else _layout(text, index + 1, count)
    if layout is None:
        text.fail(index, "a format such as (8F10.3)")
    values, after = text.rows(index + 1, count, layout[0], index, layout[1])
    return values, step, found["unit"], after


def _layout(text: TextFile, index: int, count: int) -> tuple[int, int]:
    """(numbers to a line, width) where no format is stated: eight, in as many columns as the first line fills."""
    line = text.line(index, "samples").rstrip()
    per_line = min(8, count)
    if not line or len(line) % per_line:
        text.fail(index, f"{per_line} samples in columns of one width")
    return per_line, len(line) // per_line


def _direction(channel: _Channel) -> Direction:
    """Where the sensor points, from `CHAN  1:  90 DEG`."""
    found = channel.find(r"CHAN\w*\s*\d+\s*:\s*(\d+ DEG|[A-Z0-9]+)")
    return direction_of(found[1].group(1) if found else "")


def _record(
    channel: _Channel, values: NDArray[np.float64], step: float, unit: str, extra: dict[str, str] | None = None
) -> Record:
    direction = _direction(channel)
    text, first = channel.text, channel.first
    station = channel.find(r"STATION (?:NO|ID)\.?\s*(\w+)")
    event = channel.find(r"^(.*EARTHQUAKE.*)") or channel.find(r"(?:RECORD|RCRD) OF (.*?)(?:\s{2,}|$)")
    titles = [line.strip() for line in text.lines[first : first + channel.text_lines] if line.strip()]
    return Record(
        step, direction.sign * factor(unit, "acceleration") * values, component=direction.component,
        azimuth_deg=direction.azimuth_deg, vertical=direction.vertical,
        station=station[1].group(1) if station else "", event=event[1].group(1).strip() if event else "",
        start_time=start_time(text, first, first + channel.text_lines),
        source=text.name, format=NAME, file_units=unit, sha256=text.sha256,
        metadata={"title": titles[0], "header": " | ".join(titles)} | (extra or {}),
    )  # fmt: skip


def _volume2(channel: _Channel) -> tuple[Record, int]:
    """(record, index of the line after the channel)."""
    text, at = channel.text, channel.data
    values, step, unit, at = _series(text, at, "ACCEL")
    stated_at = channel.first + V2_TEXT + V2_COUNT // 16
    if round(channel.integers[V2_COUNT]) != values.size:
        text.fail(stated_at, f"{values.size} as integer {V2_COUNT + 1}, the count of line {channel.data + 1}")
    stated_at = channel.first + V2_TEXT + INTEGER_LINES + V2_STEP // 8
    if abs(channel.reals[V2_STEP] - step) > STEP_RESOLUTION:
        text.fail(stated_at, f"{step:g} as real {V2_STEP + 1}, the step of line {channel.data + 1}")
    for kind in ("VELOC", "DISPL"):
        if at < len(text.lines) and re.search(_DATA, text.head(at), re.IGNORECASE):
            _, _, _, at = _series(text, at, kind)
    _check_peak(channel, r"PEAK ACCELERATION\s*=\s*(\S+)\s+(\S+)", values, unit)
    return _record(channel, values, step, unit), at


def _check_peak(channel: _Channel, pattern: str, values: NDArray[np.float64], unit: str) -> None:
    """Raise unless the largest sample is the (number, unit) that a pattern finds in the text lines, if it does."""
    peak = channel.find(pattern)
    if peak is None or quantity_of(peak[1].group(2).rstrip(",")) != "acceleration":
        return
    stated = channel.text.number(peak[0], peak[1].group(1), "the peak as a number")
    scale = factor(peak[1].group(2).rstrip(","), "acceleration") / factor(unit, "acceleration")
    resolution = decimals(peak[1].group(1)) * scale
    channel.text.check_peak(peak[0], abs(stated) * scale, float(np.max(np.abs(values))), resolution)


_V1_PEAK = r"UNCOR.*MAX\s*=\s*(\S+)\s+(\S+)"


def _even_volume1(channel: _Channel) -> tuple[Record, int]:
    """(record, index of the line after the channel) of a volume 1 with samples under a line of facts."""
    text, at = channel.text, channel.data
    if re.search(_DATA, text.head(at), re.IGNORECASE):
        values, step, unit, after = _series(text, at, "ACCEL")
        return _record(channel, values, step, unit), after
    found = text.match(at, _V1_DATA, _V1_WANTED)
    count, rate = text.count(at, found["n"], _V1_WANTED), text.positive(at, found["rate"], _V1_WANTED)
    layout, unit = fortran_width(found["format"]), found["unit"].strip()
    if layout is None or quantity_of(unit) != "acceleration":
        text.fail(at, _V1_WANTED)
    values, after = text.rows(at + 1, count, layout[0], at, layout[1])
    # Counts above 99999 do not fit into an integer of five columns and stand as 0 or less there.
    for k in (V1_COUNT, V1_LONG_COUNT):
        if channel.integers[k] > 0 and round(channel.integers[k]) != count:
            text.fail(channel.first + V1_TEXT + k // 16, f"{count} as integer {k + 1}, the count of line {at + 1}")
    _check_peak(channel, _V1_PEAK, values, unit)
    return _record(channel, values, 1.0 / rate, unit), after


def _volume1(channel: _Channel) -> tuple[Record, int]:
    """(record, index of the line after the channel)."""
    text, at = channel.text, channel.data
    if re.search("[A-Z]{3}", text.head(at), re.IGNORECASE):
        return _even_volume1(channel)
    count_line = channel.first + V1_TEXT + V1_COUNT // 16
    count = round(channel.integers[V1_COUNT])
    if count < 2:
        text.fail(count_line, f"the number of samples, two or more, as integer {V1_COUNT + 1}")
    found = channel.find(r"UNITS?.*?SEC\.?\s*(?:AND|&|,)\s*([A-Z0-9/]+)")
    if found is None or quantity_of(found[1].group(1)) != "acceleration":
        where = channel.first if found is None else found[0]
        text.fail(where, "a line such as UNITS OF UNCOR ACCEL ARE SEC AND G/10 in the text header")
    pairs, after = text.rows(at, 2 * count, 10, count_line, 7)
    times, values, step = pairs[0::2], pairs[1::2], (pairs[-2] - pairs[0]) / (count - 1)
    wrong = np.flatnonzero(np.diff(times) < 0.0)
    if wrong.size or step <= 0.0:
        text.fail(at + int(wrong[0] + 1 if wrong.size else 0) // 5, "ascending times")
    _check_peak(channel, _V1_PEAK, values, found[1].group(1))
    even = times[0] + step * np.arange(count)
    if np.max(np.abs(times - even)) <= TIME_RESOLUTION:
        return _record(channel, values, step, found[1].group(1)), after
    note = {"processing": f"unequally spaced samples laid on steps of {step:.6g} s by straight lines"}
    return _record(channel, np.interp(even, times, values), step, found[1].group(1), note), after


def parse(text: TextFile) -> list[Record]:
    """The acceleration of each channel."""
    records, at = [], 0
    while at < len(text.lines):
        channel = _channel(text, at)
        record, at = (_volume1 if channel.text_lines == V1_TEXT else _volume2)(channel)
        records.append(record)
        text.match(at, r"END OF DATA", "a line END OF DATA FOR CHANNEL")
        at += 1
        while at < len(text.lines) and not text.lines[at].strip():
            at += 1
    return records
