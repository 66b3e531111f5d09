"""Records of tests as strangers send them: CSV, plain or gzip, read fast and bounded in memory.

The first line is the header, its first column `time`; fields are separated by commas, numbers have decimal points, an
empty field (or nan) is a missing sample.  UTF-8 with or without a byte order mark; any of the three line ends; quotes
around a field are taken off.  Comment lines are not part of the format.

Source   none: a plain text table.
Status   all numbers to the last bit of what is printed.
"""

from __future__ import annotations

import gzip
import io
import math
import re
import stat
import zlib
from pathlib import Path
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from studies.campaigns.errors import CampaignError, shown

Array = NDArray[np.float64]

MAX_BYTES = 64 * 1024 * 1024
"""Of a record when unpacked; more is refused.  An hour of four channels at 250 Hz has about 40 MB."""

MIN_SAMPLES = 16
"""Fewer say nothing of a motion."""

LONGEST_STEP = 0.1
"""Time between samples [s] above which a swing is not seen: more likely the times are milliseconds."""

SHORTEST_STEP = 1e-6
"""Time between samples [s] below which the times cannot be seconds."""

ALLOWED_JITTER = 0.01
"""Share of a step by which a sample may be off its place, besides the last digit that times are printed with."""

_FOREIGN = re.compile(r"[^0-9eE+\-.,\n nNaA\t]")
_QUOTED = re.compile(r'(?m)(?:(?<=,)|^)"([^",\n]*)"(?=,|$)')
_EMPTY = re.compile(r"(?m)(?:(?<=,)|^)(?=,|$)")


class _Text:
    """The lines of one record, and the sentence about one of them."""

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.header, _, self.body = text.partition("\n")
        self.body = self.body.rstrip("\n\t ")

    def fail(self, line: int, wanted: str, found: str | None = None) -> NoReturn:
        """Raise about a line, counted from 1."""
        raise CampaignError(f"{self.name}, line {line}: found {shown(found or '')}, want {wanted}")


def read_record(path: Path, name: str, wanted: frozenset[str]) -> dict[str, Array]:
    """The columns of a record: `time` first, then its channels, each of shape (time,), NaN where a sample is missing.

    Args:
        path: the file.
        name: what errors call it.
        wanted: names of the channels that it may hold.

    Raises:
        CampaignError: the file cannot be read or is too large, is no CSV in UTF-8, has a column that is no channel,
            or its times are not equally spaced.
    """
    text = _Text(name, _unpacked_text(path, name))
    names = _columns(text, wanted)
    table = _table(text, len(names))
    if len(table) < MIN_SAMPLES:
        raise CampaignError(f"{name}: has {len(table)} samples, want {MIN_SAMPLES} or more")
    _check_times(text, table[:, 0])
    columns = {}
    for k, column in enumerate(names):
        columns[column] = np.ascontiguousarray(table[:, k])
        columns[column].flags.writeable = False
    return columns


def read_bytes(path: Path, name: str, most: int) -> bytes:
    """At most `most` bytes of a plain file; CampaignError if there are more or it cannot be read."""
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            raise CampaignError(f"{name}: is no plain file, want one")
        with path.open("rb") as file:
            data = file.read(most + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, CampaignError):
            raise
        reason = getattr(error, "strerror", None) or type(error).__name__
        raise CampaignError(f"{name}: cannot be read ({reason}), want a file") from None
    if len(data) > most:
        raise CampaignError(f"{name}: has more than {most} bytes, want at most that")
    return data


def decoded(data: bytes, name: str) -> str:
    """Text in UTF-8 with its line ends made \\n; CampaignError if it is something else."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise CampaignError(f"{name}: is in UTF-16, want UTF-8")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise CampaignError(f"{name}, line {line}: is not in UTF-8, want UTF-8") from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _unpacked_text(path: Path, name: str) -> str:
    data = read_bytes(path, name, MAX_BYTES)
    if data.startswith(b"\x1f\x8b"):
        try:
            with gzip.GzipFile(fileobj=io.BytesIO(data)) as file:
                data = file.read(MAX_BYTES + 1)
        except (OSError, EOFError, zlib.error) as error:
            raise CampaignError(f"{name}: is a damaged gzip file ({shown(str(error))}), want a whole one") from None
        if len(data) > MAX_BYTES:
            raise CampaignError(f"{name}: has more than {MAX_BYTES} bytes when unpacked, want at most that")
    text = decoded(data, name)
    if not text.strip():
        raise CampaignError(f"{name}: is empty, want a header and samples")
    return text


def _columns(text: _Text, wanted: frozenset[str]) -> list[str]:
    """Names in the header, each a channel but the first, which is time."""
    names = [field.strip().removeprefix('"').removesuffix('"').strip() for field in text.header.split(",")]
    if names[0] != "time":
        hint = " (columns are separated by commas)" if re.match(r"\"?time\"?\s*[;\t ]", text.header) else ""
        text.fail(1, f"a header that starts with 'time'{hint}", text.header)
    for k, column in enumerate(names[1:], start=1):
        if column in names[:k]:
            text.fail(1, "each column once", column)
        if column not in wanted:
            known = ", ".join(sorted(wanted)) or "none"
            text.fail(1, f"a column that is a declared channel ({shown(known)[1:-1]})", column)
    return names


def _table(text: _Text, width: int) -> Array:
    """The numbers, shape (time, column); the fast way, and line by line where that finds something odd."""
    body = text.body
    if not body:
        return np.empty((0, width))
    if '"' in body:
        body = _QUOTED.sub(r"\1", body)
    if _FOREIGN.search(body) is None and "\n\n" not in body and not body.startswith("\n"):
        filled = _EMPTY.sub("nan", body) if ",," in body or ",\n" in body or body[-1] == "," else body
        try:
            table = np.loadtxt(io.StringIO(filled), delimiter=",", comments=None, ndmin=2, dtype=np.float64)
        except ValueError:
            table = np.empty((0, 0))
        if table.shape == (filled.count("\n") + 1, width) and not np.isinf(table).any():
            return table
    return _slowly(text, body, width)


def _slowly(text: _Text, body: str, width: int) -> Array:
    """The numbers line by line, naming the first line that is wrong."""
    rows = []
    for number, line in enumerate(body.split("\n"), start=2):
        fields = line.split(",")
        if not line.strip():
            text.fail(number, "a line of numbers", line)
        if len(fields) != width:
            hint = " (numbers with decimal points)" if len(fields) == 2 * width else ""
            text.fail(number, f"{width} fields as in the header{hint}", line)
        row = [_number(field) for field in fields]
        if None in row:
            hint = " with decimal points" if '"' in line or ";" in line else ""
            text.fail(number, f"finite numbers{hint}, or nothing where a sample is missing", line)
        rows.append(row)
    return np.array(rows, dtype=np.float64)


def _number(field: str) -> float | None:
    """A finite number, NaN for a missing sample, None for anything else."""
    field = field.strip(" \t")
    if not field or field.lower() == "nan":
        return math.nan
    if _FOREIGN.search(field) or not field.isascii():
        return None
    try:
        value = float(field)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _check_times(text: _Text, time: Array) -> None:
    """Raise unless the times ascend in equal steps that can be seconds."""
    missing = np.flatnonzero(np.isnan(time))
    if missing.size:
        text.fail(int(missing[0]) + 2, "a time in every line", "no time")
    steps = np.diff(time)
    back = np.flatnonzero(steps <= 0.0)
    if back.size:
        text.fail(int(back[0]) + 3, f"a time after {time[back[0]]:.10g} s", f"{time[back[0] + 1]:.10g}")
    step = float(np.median(steps))
    if not SHORTEST_STEP <= step <= LONGEST_STEP:
        raise CampaignError(
            f"{text.name}: has a sample every {step:.4g} s, want steps of {SHORTEST_STEP:g} to {LONGEST_STEP:g} s "
            "(times in seconds)"
        )
    mean = float(time[-1] - time[0]) / (time.size - 1)
    off = np.abs(time - time[0] - mean * np.arange(time.size))
    allowed = min(max(ALLOWED_JITTER * mean, _resolution(text)), 0.45 * mean)
    if off.max() > allowed:
        jumps = np.flatnonzero(np.abs(steps - step) > 2.0 * allowed)
        first = int(jumps[0]) + 1 if jumps.size else int(np.argmax(off))
        wanted = f"{time[first - 1] + step:.10g} s as the time, in equal steps of {step:.6g} s"
        text.fail(first + 2, wanted, f"{time[first]:.10g}")


def _resolution(text: _Text) -> float:
    """The last digit of the printed times [s], from the finest of the first lines."""
    digits = [field.split(",", 1)[0].strip('" ') for field in text.body[:20000].split("\n")[:200]]
    finest = 1.0
    for field in digits:
        mantissa, _, exponent = field.lower().partition("e")
        places = len(mantissa.partition(".")[2])
        if re.fullmatch(r"[+-]?\d{1,3}|", exponent):
            finest = min(finest, 10.0 ** (int(exponent or 0) - places))
    return finest
