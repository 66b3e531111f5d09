"""Columns of text: time and one or more accelerations, each with its unit in the header or stated by the reader.

    # anything
    time [s], a_x [m/s^2], up [g]
    0.000, 0.0012, -0.0003

Separated by commas, semicolons, tabs or blanks.  Without a header line the first column is time, and the units have to
be stated: nothing is guessed.

Source   none: the usual text table.
Status   the time column must be equally spaced to a thousandth of a step or to the digits that it is printed with,
         which have to tell a fifth of a step.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from excitation.formats.directions import direction_of, name_of
from excitation.formats.text import TextFile, decimals, quoted, to_float, to_floats, write_lines
from excitation.record import Record, same_sampling
from excitation.units import factor, quantity_of

NAME = "columns"
TITLE = "text columns with units, .csv and .txt"
SEPARATORS = (";", ",", "\t", None)
_FIELD = re.compile(r"[^\s\[(]*+[^\S\r\n]{0,9}[\[(][^\])]{0,99}[\])]|\S++")
LONGEST_HEADING = 20000


def split(heading: str, separator: str | None) -> list[str]:
    """Fields of a heading; brackets keep blanks together where blanks separate."""
    return _FIELD.findall(heading) if separator is None else heading.split(separator)


def name_and_unit(field: str) -> tuple[str, str]:
    """`a_x [m/s^2]` or `"a_x (m/s^2)"` as name and unit; the unit empty if none stands in brackets."""
    plain = field.strip().strip('"').strip()
    for opening, closing in ("[]", "()"):
        if plain.endswith(closing) and opening in plain:
            name, _, unit = plain[:-1].rpartition(opening)
            return name.strip(), unit.strip()
    return plain, ""


def _separator(line: str) -> str | None:
    return next((s for s in SEPARATORS if s is None or s in line), None)


def _is_numbers(line: str) -> bool:
    return all(to_float(v) is not None for v in line.split(_separator(line)))


def _first_line(text: TextFile) -> int:
    """Index of the heading, or of the first numbers if there is none."""
    for i, line in enumerate(text.lines):
        if line.strip() and not line.lstrip().startswith(("#", "%", "!")):
            return i
    text.fail(len(text.lines), "a heading or numbers")


def recognises(text: TextFile) -> bool:
    """Whether a line of numbers comes first, or one heading and then numbers, two columns or more."""
    lines = [x for x in text.lines[:200] if x.strip() and not x.lstrip().startswith(("#", "%", "!"))][:2]
    if len(lines) < 2 or not _is_numbers(lines[1]):
        return False
    return len(lines[1].split(_separator(lines[1]))) >= 2


def _table(text: TextFile, first: int, separator: str | None, width: int) -> NDArray[np.float64]:
    """The numbers from line `first` on, shape (time, column)."""
    lines = [(i, text.lines[i]) for i in range(first, len(text.lines)) if text.lines[i].strip()]
    for i, line in lines:
        found = len(line.split(separator))
        if found != width:
            text.fail(i, f"{width} columns as in the first line")
    values = to_floats([field for _, line in lines for field in line.split(separator)])
    if values is None:
        bad = next(i for i, line in lines if to_floats(line.split(separator)) is None)
        text.fail(bad, f"{width} finite numbers")
    return np.asarray(values.reshape(len(lines), width))


def _headings(text: TextFile, index: int, separator: str | None, units: str | None, time_units: str | None) -> list[
    tuple[str, str]
]:  # fmt: skip
    """(name, unit) of each column."""
    numbers = _is_numbers(text.lines[index])
    if not numbers and to_float(text.lines[index].split(separator)[0]) is not None:
        text.fail(index, "finite numbers, or a heading, whose first column is the time")
    if not numbers and len(text.lines[index]) > LONGEST_HEADING:
        text.fail(index, f"a heading of at most {LONGEST_HEADING} characters")
    fields = text.lines[index].split(separator) if numbers else split(text.lines[index], separator)
    headings: list[tuple[str, str]] = []
    for k, text_of in enumerate(fields):
        name, stated = ("", "") if numbers else name_and_unit(text_of)
        unit = stated or (time_units if k == 0 else units) or ""
        quantity = "time" if k == 0 else "acceleration"
        if not unit:
            text.fail(index, f"the unit of column {k + 1} in brackets, or stated as an argument")
        if quantity_of(unit) != quantity:
            text.fail(index, f"a unit of {quantity} for column {k + 1}, not {quoted(unit, 20)}")
        headings.append((name, unit))
    if len(headings) < 2:
        text.fail(index, "a time column and one or more of acceleration")
    return headings


def _step(text: TextFile, first: int, times: NDArray[np.float64], printed: str, scale: float) -> float:
    """The equal spacing [s] of the time column."""
    step = (float(times[-1]) - float(times[0])) / (times.size - 1)
    if not step > 0.0:
        text.fail(first, "times that ascend")
    off = np.abs(times - times[0] - step * np.arange(times.size))
    # A printed time is off by half its last digit, and so is the first one that they are measured from.
    allowed = max(1e-3 * step, 2.0 * scale * printed_resolution(printed))
    if np.max(off) > min(allowed, 0.2 * step):
        worst = int(np.argmax(off))
        rows = [i for i in range(first, len(text.lines)) if text.lines[i].strip()]
        wanted = f"{(times[0] + worst * step) / scale:.6g} as the time: equal steps of {step / scale:.6g}"
        text.fail(rows[worst], wanted + (", printed to a fifth of one or finer" if np.max(off) <= allowed else ""))
    return _exact(step, times)


def _exact(step: float, times: NDArray[np.float64]) -> float:
    """The step to the last bit where a neighbour of it, or fewer digits, give the very times."""
    for near in (float(f"{step:.12g}"), step, float(np.nextafter(step, np.inf)), float(np.nextafter(step, 0.0))):
        if np.array_equal(times[0] + near * np.arange(times.size), times):
            return near
    return step


def printed_resolution(number: str) -> float:
    """Half of the last digit of a printed number, its exponent in it."""
    mantissa, _, exponent = number.strip().lower().replace("d", "e").partition("e")
    return decimals(mantissa) * 10.0 ** min(300.0, float(exponent or 0))


def parse(text: TextFile, units: str | None = None, time_units: str | None = None) -> list[Record]:
    """One record for each column but the first, which is time; units as arguments where the file states none."""
    index = _first_line(text)
    separator = _separator(text.lines[index])
    headings = _headings(text, index, separator, units, time_units)
    first = index if _is_numbers(text.lines[index]) else index + 1
    table = _table(text, first, separator, len(headings))
    if len(table) < 2:
        text.fail(len(text.lines), "two samples or more")
    scale = factor(headings[0][1], "time")
    tokens = [line.split(separator)[0] for line in text.lines[first : first + 200] if line.strip()]
    finest = min(tokens, key=printed_resolution)
    step = _step(text, first, scale * table[:, 0], finest, scale)
    records = []
    for k, (name, unit) in enumerate(headings[1:], start=1):
        direction = direction_of(name)
        records.append(
            Record(
                step, direction.sign * factor(unit, "acceleration") * table[:, k], component=direction.component,
                azimuth_deg=direction.azimuth_deg, vertical=direction.vertical, source=text.name, format=NAME,
                file_units=unit, sha256=text.sha256,
            )
        )  # fmt: skip
    return records


def write(path: str | Path, record: Record, *others: Record) -> None:
    """Write records of one time step and length in m/s^2, to the last bit; ValueError if they differ."""
    records = (record, *others)
    for other in others:
        same_sampling(record, other)
    names = [re.sub(r"[\[\](),;\s\"]+", "_", name_of(r)) or f"a_{k}" for k, r in enumerate(records, start=1)]
    lines = [f"time [s],{','.join(f'{name} [m/s^2]' for name in names)}"]
    columns = [record.times, *(r.acceleration for r in records)]
    lines += [",".join(repr(float(v)) for v in row) for row in zip(*columns, strict=True)]
    write_lines(path, lines)
