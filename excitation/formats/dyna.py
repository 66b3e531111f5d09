"""DYNA 1.2 .ASC: the Engineering Strong Motion database (ESM), ITACA, and AFAD's Turkish archive.

Source   ESM, description of the ASCII format DYNA 1.2: lines `KEY: value`, then one sample to a line;
         SAMPLING_INTERVAL_S, NDATA, UNITS, DATA_TYPE and STREAM say what they are.
Status   reads ESM's and AFAD's files; writes the keys that it needs to read.
"""

from __future__ import annotations

import re
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from excitation.formats.directions import Direction, direction_of, name_of
from excitation.formats.text import HEADER_WIDTH, TextFile, decimals, one_line, write_lines
from excitation.record import Record
from excitation.units import factor, quantity_of

NAME = "dyna"
TITLE = "DYNA .ASC of ESM, ITACA and AFAD"
_KEY = re.compile(r"^([A-Z][A-Z0-9_/^]*):(.*)$")
_DATES = ("%Y%m%d_%H%M%S.%f", "%Y%m%d_%H%M%S", "%d/%m/%Y %H:%M:%S.%f", "%d/%m/%Y %H:%M:%S")


def recognises(text: TextFile) -> bool:
    """Whether the file begins with lines `KEY: value`, EVENT_NAME first."""
    return text.lines[0].startswith("EVENT_NAME:")


class _Header:
    """Values by key, each with the line that it stands on."""

    def __init__(self, text: TextFile) -> None:
        self.text = text
        self.values: dict[str, tuple[int, str]] = {}
        self.size = 0
        for i, line in enumerate(text.lines):
            found = _KEY.match(line[:HEADER_WIDTH])
            if found is None:
                break
            self.values[found.group(1)] = (i, found.group(2).strip())
            self.size = i + 1

    def need(self, key: str, wanted: str) -> tuple[int, str]:
        """(line index, value) of a key that must be there."""
        if key not in self.values:
            self.text.fail(self.size, f"the header line {key}: {wanted}")
        index, value = self.values[key]
        if not value:
            self.text.fail(index, f"{key}: {wanted}")
        return index, value

    def get(self, key: str) -> str:
        """Value of a key, empty if it is not there."""
        return self.values.get(key, (0, ""))[1]


def _start_time(header: _Header) -> str:
    value = header.get("DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS")
    for form in _DATES:
        try:
            return datetime.strptime(value, form).isoformat()
        except ValueError:
            continue
    if value:
        index, _ = header.values["DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS"]
        header.text.fail(index, "the time of the first sample as yyyymmdd_hhmmss or dd/mm/yyyy hh:mm:ss")
    return ""


def _check_peak(header: _Header, scale: float, values: np.ndarray) -> None:
    if not header.get("PGA_CM/S^2"):
        return
    index, stated = header.values["PGA_CM/S^2"]
    peak = header.text.number(index, stated, "the peak as a number [cm/s^2]")
    found = 100.0 * scale * float(np.max(np.abs(values)))
    header.text.check_peak(index, abs(peak), found, decimals(stated))


def _direction(stream: str) -> Direction:
    """The direction of a stream: the last letter of a SEED channel such as HNE, or a direction's usual name."""
    if re.fullmatch(r"[A-Za-z]{2}[ENZenz]", stream):
        return direction_of(stream[-1])._replace(component=stream)
    return direction_of(stream)


def parse(text: TextFile) -> list[Record]:
    """The one record of the file."""
    header = _Header(text)
    at, kind = header.need("DATA_TYPE", "ACCELERATION")
    if kind.upper() != "ACCELERATION":
        text.fail(at, "DATA_TYPE: ACCELERATION")
    at, unit = header.need("UNITS", "a unit of acceleration")
    if quantity_of(unit) != "acceleration":
        text.fail(at, "UNITS: a unit of acceleration")
    at, value = header.need("SAMPLING_INTERVAL_S", "the time step [s]")
    step = text.positive(at, value, "SAMPLING_INTERVAL_S: the time step [s]")
    at, value = header.need("NDATA", "the number of samples")
    count = text.count(at, value, "NDATA: the number of samples, two or more")
    values = text.counted(header.size, len(text.lines), count, at)
    scale = factor(unit, "acceleration")
    _check_peak(header, scale, values)
    stream = header.get("STREAM")
    direction = _direction(stream)
    network = header.get("NETWORK")
    event = (header.get("EVENT_NAME"), header.get("EVENT_DATE_YYYYMMDD"), header.get("EVENT_TIME_HHMMSS"))
    return [
        Record(
            step, direction.sign * scale * values, component=direction.component, azimuth_deg=direction.azimuth_deg,
            vertical=direction.vertical,
            station=".".join(v for v in (network, header.get("STATION_CODE")) if v),
            event=" ".join(v for v in event if v), start_time=_start_time(header), source=text.name, format=NAME,
            file_units=unit, sha256=text.sha256, metadata={k: v for k, (_, v) in header.values.items() if v},
        )
    ]  # fmt: skip


def _start_text(record: Record) -> str:
    """The start in UTC, as a time without a zone is."""
    if not record.start_time:
        return ""
    try:
        start = datetime.fromisoformat(record.start_time)
        utc = start if start.tzinfo is None else start.astimezone(UTC)
        return utc.strftime("%Y%m%d_%H%M%S.%f")
    except (ValueError, OverflowError):
        raise ValueError(f"start_time={record.start_time!r}: want ISO 8601 such as 2019-07-28T16:09:19.87") from None


def _sample(value: float) -> str:
    return f"{value:.9g}"


def write(path: str | Path, record: Record) -> None:
    """Write a record in cm/s^2, nine digits."""
    values = 100.0 * record.acceleration
    peak = int(np.argmax(np.abs(values)))
    understood = _direction(record.component)[1:] == (record.azimuth_deg, record.vertical, 1.0)
    stream = record.component if understood else name_of(record)
    header = {
        "EVENT_NAME": record.event,
        "STATION_CODE": record.station,
        "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS": _start_text(record),
        "SAMPLING_INTERVAL_S": f"{record.time_step:.12g}",
        "NDATA": str(values.size),
        "STREAM": stream,
        "UNITS": "cm/s^2",
        "PGA_CM/S^2": f"{float(_sample(values[peak])):.6f}",
        "TIME_PGA_S": f"{peak * record.time_step:.6f}",
        "HEADER_FORMAT": "DYNA 1.2",
        "DATA_TYPE": "ACCELERATION",
    }
    lines = [f"{key}: {one_line(value)}" for key, value in header.items()]
    write_lines(path, [*lines, *(_sample(v) for v in values)])
