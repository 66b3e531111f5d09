"""Text files of numbers as strangers send them: read whole, bounded in memory, errors that name file and line."""

from __future__ import annotations

import errno
import hashlib
import itertools
import os
import re
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from excitation.record import RecordFileError

MAX_BYTES = 256 * 1024 * 1024
"""Larger files are refused: a day of three components at 200 Hz in text is about 600 MB, an event less than 10 MB."""

_NOT_A_NUMBER = re.compile(r"[^0-9eEdD+\-.\s]")
_FORTRAN = re.compile(r"\(?\s*(?:1P,?)?\s*(\d{0,6})\s*[IFEDG]\s*(\d{1,6})(?:\.\d+)?[A-Z]?\d*\s*\)?", re.IGNORECASE)

HEADER_WIDTH = 400
"""Characters of a line that patterns are looked for in: five times what headers have, and few enough that a pattern
that has to go back takes no time (one on a line of a million digits can take an hour)."""

_counter = itertools.count()

LARGEST_NUMBER = 1e60
"""Above all that a file may mean (1.7e38 stands for what is not known), and far from where products overflow."""


@dataclass(frozen=True)
class TextFile:
    """The lines of a file; numbers of lines in errors count from 1, indices from 0."""

    name: str
    lines: list[str] = field(repr=False)
    sha256: str
    suffix: str = ""

    def fail(self, index: int, wanted: str) -> NoReturn:
        """Raise RecordFileError about one line: what stands there and what was wanted."""
        if index >= len(self.lines):
            raise RecordFileError(f"{self.name}: ends after line {len(self.lines)}, want {wanted}")
        raise RecordFileError(f"{self.name}, line {index + 1}: found {quoted(self.lines[index])}, want {wanted}")

    def head(self, index: int) -> str:
        """The first HEADER_WIDTH characters of a line that is there, to look for patterns in."""
        return self.lines[index][:HEADER_WIDTH]

    def line(self, index: int, wanted: str) -> str:
        """The line at an index, or the error that the file ends before it."""
        if index >= len(self.lines):
            self.fail(index, wanted)
        return self.lines[index]

    def match(self, index: int, pattern: str, wanted: str) -> re.Match[str]:
        """What a pattern finds at the head of a line, or the error that it does not; case does not matter."""
        found = re.search(pattern, self.line(index, wanted)[:HEADER_WIDTH], re.IGNORECASE)
        if found is None:
            self.fail(index, wanted)
        return found

    def number(self, index: int, text: str, wanted: str) -> float:
        """`text` of a line as a finite number, zero or of a size that can be divided by."""
        value = to_float(text)
        if value is None or 0.0 < abs(value) < 1.0 / LARGEST_NUMBER:
            self.fail(index, wanted)
        return value

    def positive(self, index: int, text: str, wanted: str) -> float:
        """`text` of a line as a number above zero."""
        value = self.number(index, text, wanted)
        if not value > 0.0:
            self.fail(index, wanted)
        return value

    def count(self, index: int, text: str, wanted: str) -> int:
        """`text` of a line as a whole number of samples, two or more."""
        if not re.fullmatch(r"\s*\d{1,12}\s*", text) or int(text) < 2:
            self.fail(index, wanted)
        return int(text)

    def block(self, first: int, last: int, width: int | None = None) -> NDArray[np.float64]:
        """The numbers in lines first to last (excluded), separated by blanks or in columns of `width`."""
        lines = self.lines[first:last]
        fields = _fields(lines, width)
        values = to_floats(fields)
        if values is None:
            self._blame(first, lines, width)
        return values

    def _blame(self, first: int, lines: list[str], width: int | None) -> NoReturn:
        """The error about the first line that does not hold numbers."""
        for offset, line in enumerate(lines):
            if to_floats(_fields([line], width)) is None:
                columns = "" if width is None else f" in columns of {width} characters"
                self.fail(first + offset, f"finite numbers{columns}")
        self.fail(first, "finite numbers")

    def counted(self, first: int, last: int, count: int, declared_at: int, width: int | None = None) -> Any:
        """The numbers of lines first to last, which must be `count` as line `declared_at` says."""
        values = self.block(first, last, width)
        if values.size != count:
            raise RecordFileError(
                f"{self.name}, lines {first + 1} to {min(last, len(self.lines))}: hold {values.size} values, "
                f"want {count} as line {declared_at + 1} says"
            )
        return values

    def rows(self, first: int, count: int, per_line: int, declared_at: int, width: int) -> tuple[Any, int]:
        """`count` numbers, `per_line` to a line in columns of `width`, and the index of the line after them."""
        last = first + -(-count // per_line)
        if last > len(self.lines):
            self.fail(len(self.lines), f"{count} values from line {first + 1} on, as line {declared_at + 1} says")
        return self.counted(first, last, count, declared_at, width), last

    def check_peak(self, index: int, declared: float, found: float, resolution: float) -> None:
        """Raise unless the largest sample is what the header says, to its printed resolution and half a per cent."""
        if abs(declared - found) > 0.005 * abs(declared) + resolution:
            self.fail(index, f"the largest sample, {found:.6g}")


def to_float(text: str) -> float | None:
    """A finite number, or None; stricter than Python's own (no nan, no underscores)."""
    values = to_floats([text.strip()]) if text.strip() and " " not in text.strip() else None
    return None if values is None else float(values[0])


def decimals(text: str) -> float:
    """Half of the last digit that a number is printed with: `1.63` gives 0.005."""
    found = re.search(r"\.(\d*)", text)
    return 0.5 * 10.0 ** -len(found.group(1)) if found else 0.5


def quoted(text: str, longest: int = 80) -> str:
    """A text from a file in quotes, with escapes for what does not show, cut where it is long."""
    shown = repr(text[:longest])
    return shown if len(text) <= longest and len(shown) <= longest + 2 else f"{shown[: longest - 2]}...{shown[-1]}"


def one_line(text: str) -> str:
    """A text without line ends and control characters, for a header line of its own."""
    return re.sub(r"[\x00-\x1f\x7f-\x9f\u2028\u2029]+", " ", text).strip()


def fortran_width(text: str) -> tuple[int, int] | None:
    """(numbers to a line, width) of a Fortran format such as (8F10.3); None if it is none."""
    found = _FORTRAN.fullmatch(text.strip())
    if found is None:
        return None
    per_line, width = int(found.group(1) or 1), int(found.group(2))
    return (per_line, width) if 0 < per_line <= 1000 and 0 < width <= 100 else None


def _fields(lines: list[str], width: int | None) -> list[str]:
    if width is None:
        return " ".join(lines).split()
    return [line[i : i + width] for line in lines for i in range(0, len(line.rstrip()), width)]


def to_floats(fields: list[str]) -> NDArray[np.float64] | None:
    """The fields as finite numbers up to LARGEST_NUMBER, or None."""
    joined = "\n".join(fields)
    if _NOT_A_NUMBER.search(joined):
        return None
    if "d" in joined or "D" in joined:
        fields = joined.replace("d", "e").replace("D", "E").split("\n")
    try:
        values = np.array(fields, dtype=np.float64) if fields else np.empty(0)
    except ValueError:
        return None
    return values if np.all(np.abs(values) <= LARGEST_NUMBER) else None  # not-a-number compares false


def read_bytes(path: str | Path) -> bytes:
    """The bytes of a file; OSError if it cannot be read, RecordFileError if it is empty or too large."""
    size = Path(path).stat().st_size
    name = Path(path).name
    if size == 0:
        raise RecordFileError(f"{name}: is empty, want a record")
    if size > MAX_BYTES:
        raise RecordFileError(f"{name}: has {size} bytes, want at most {MAX_BYTES}")
    return Path(path).read_bytes()


def write_whole(path: str | Path, write: Callable[[Path], object]) -> None:
    """Let `write` fill a temporary file beside `path`, then rename it: a run that is cut off leaves no half file.

    A link is followed; what is no plain file (a device, a pipe) is written to as it is.

    Raises:
        OSError: it cannot be written, which leaves `path` as it was.
    """
    target = Path(os.path.realpath(path))
    if target.exists() and not target.is_file() and not target.is_dir():
        write(target)
        return
    temporary = target.with_name(f".{target.stem}.{os.getpid()}-{next(_counter)}{target.suffix}")
    try:
        write(temporary)
        os.replace(temporary, target)
    except OSError as error:
        raise OSError(error.errno or errno.EIO, error.strerror or str(error), str(path)) from error
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def write_lines(path: str | Path, lines: Iterable[str]) -> None:
    """Write a text of these lines in UTF-8, whole or not at all."""
    text = "\n".join([*lines, ""])
    write_whole(path, lambda target: target.write_text(text, encoding="utf-8"))


def is_text(data: bytes) -> bool:
    """Whether the bytes look like text in ASCII, UTF-8 or Latin-1: no control characters but blanks and line ends."""
    control = bytes(set(range(32)) - {9, 10, 12, 13, 26}) + b"\x7f"
    return not any(c in control for c in set(data))


def text_file(name: str, data: bytes) -> TextFile:
    """Lines of a file in UTF-8, or in Latin-1 if it is not UTF-8 (station names); RecordFileError if it is no text."""
    if not is_text(data):
        raise RecordFileError(f"{name}: holds control characters, want text in ASCII, UTF-8 or Latin-1")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    # Ends of files from DOS are padded with the character 26, lines of blanks after or before it.
    lines = re.split(r"\r\n|\n|\r", text.rstrip("\x1a \t\r\n\f"))
    while lines and not lines[-1].strip():
        lines.pop()
    if not lines:
        raise RecordFileError(f"{name}: holds blanks only, want a record")
    return TextFile(name, lines, hashlib.sha256(data).hexdigest(), Path(name).suffix.lower())
