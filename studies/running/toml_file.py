"""TOML files as strangers send them: bounded, and whatever is wrong is one sentence that names the file.

Source   none, own convention
Status   damaged, foreign, nested and overlong files (tests)
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

MOST_BYTES = 2 * 1024 * 1024
"""A declaration or a model takes some kilobytes."""


def read_toml(path: Path, most: int = MOST_BYTES) -> dict[str, Any]:
    """What a TOML holds.

    Raises:
        ValueError: it cannot be read, is longer than `most` bytes, or is no TOML in UTF-8.
    """
    if path.exists() and not path.is_file():
        raise ValueError(f"{path}: is no file, want a file that can be read")
    try:
        with path.open("rb") as file:
            data = file.read(most + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ValueError(f"{path}: want a file that can be read ({reason})") from None
    if len(data) > most:
        raise ValueError(f"{path}: has more than {most} bytes, want at most that")
    try:
        return tomllib.loads(data.decode("utf-8"))
    except RecursionError:
        raise ValueError(f"{path}: want TOML (it is nested too deeply)") from None
    except ValueError as error:
        raise ValueError(f"{path}: want TOML ({str(error).splitlines()[0][:120]})") from None
