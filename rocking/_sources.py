"""Whether source files are still those that this process runs, so that an edit under it is noticed.

Files of this package are compared with what they were when it was imported.  Of other files, as those of base motions,
that is not known: there the functions in use are looked for in what the file holds now.

Source   none, own convention
Status   code that is compiled after such an edit is not kept (tests)
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from functools import lru_cache
from importlib.abc import InspectLoader
from pathlib import Path
from types import CodeType


def stamp(path: Path) -> tuple[int, int]:
    """Time of the last change [ns] and size [bytes] of a file."""
    found = path.stat()
    return found.st_mtime_ns, found.st_size


STAMPS: dict[str, tuple[int, int]] = {}
for _path in Path(__file__).parent.rglob("*.py"):
    with suppress(OSError):  # an editor's lock, a link to nowhere, a file that goes
        STAMPS[str(_path)] = stamp(_path)


def edited(name: str, codes: Iterable[CodeType] = ()) -> bool:
    """Whether a source file is another one than that which was imported.

    codes: of functions in use; those of this file tell of a file that is not of this package.  False for what is no
    file, as a cell of a notebook.
    """
    path = Path(name)
    try:
        if name in STAMPS:
            return stamp(path) != STAMPS[name]
        own = {code for code in codes if code.co_filename == name}
        return bool(own) and path.is_file() and not own <= _within(path, stamp(path))
    except (OSError, SyntaxError, ValueError):
        return True


@lru_cache(maxsize=256)
def _within(path: Path, _stamp: tuple[int, int]) -> frozenset[CodeType]:
    """The code of every function in a file."""
    found, waiting = set[CodeType](), [InspectLoader.source_to_code(path.read_bytes(), str(path))]
    while waiting:
        inner = [constant for constant in waiting.pop().co_consts if isinstance(constant, CodeType)]
        found.update(inner)
        waiting += inner
    return frozenset(found)
