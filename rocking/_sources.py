"""The package's source files as they were when it was imported, so that an edit under a running process is noticed.

Source   none, own convention
Status   code that is compiled after such an edit is not kept (tests)
"""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path


def stamp(path: Path) -> tuple[int, int]:
    """Time of the last change [ns] and size [bytes] of a file."""
    found = path.stat()
    return found.st_mtime_ns, found.st_size


STAMPS: dict[str, tuple[int, int]] = {}
for _path in Path(__file__).parent.rglob("*.py"):
    with suppress(OSError):  # an editor's lock, a link to nowhere, a file that goes
        STAMPS[str(_path)] = stamp(_path)


def edited(name: str) -> bool:
    """Whether a source file of this package is another one than that which was imported; False for other files."""
    if name not in STAMPS:
        return False
    try:
        return stamp(Path(name)) != STAMPS[name]
    except OSError:
        return True
