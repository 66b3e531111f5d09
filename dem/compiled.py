"""Machine code of the loops over steps, kept on disk and never older than its source.

Source  none, own convention; numba by itself does not see an edit of a function in another file that a kernel calls
Status  a second process hits the cache, an edit anywhere in the package replaces it, Ctrl-C while a kernel is compiled
        is heard (tests)
"""

from __future__ import annotations

import _thread
import hashlib
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba

LOOK = 1e-3
"""Seconds between two looks whether a kernel has been compiled."""

NOT_KEPT = (
    "compiled code is not kept, and compiled again in every process: neither the package's folder nor one of the user "
    "can be written to; set NUMBA_CACHE_DIR to a folder that can"
)

# Functions that a loop calls. They make no arrays, so numba need not count references to those they are given, which
# would take longer than their work; and division by zero gives what NumPy gives.
# Those marked `hot` are copied into the loop.
_OPTIONS: dict[str, Any] = {"_nrt": False, "error_model": "numpy"}
inner = numba.njit(**_OPTIONS)
hot = numba.njit(**_OPTIONS, forceinline=True)


def compiled(function: Callable[..., Any], **options: Any) -> Any:
    """The function compiled, its machine code kept on disk under a name that changes with any source here."""
    name, module = function.__name__, function.__module__.rpartition(".")[2]
    function.__qualname__ = f"{name}_{_digest()}"
    kernel = _kept_if_possible(function, options)
    if hasattr(kernel, "stats"):  # not where numba's compiler is switched off
        _drop_stale(Path(str(kernel.stats.cache_path)), f"{module}.{name}_", function.__qualname__)
    return kernel


def called(kernel: Any, *arguments: Any) -> Any:
    """What `kernel(*arguments)` returns; the first call of a kernel, which compiles it, is made in another thread.

    LLVM calls Python back to keep what it compiled.  What Ctrl-C raises there in the main thread is lost
    (llvmlite 0.50).

    Raises:
        KeyboardInterrupt: Ctrl-C; the first call is ended.  A second one does not wait.
    """
    if getattr(kernel, "signatures", True):  # a plain function where numba's compiler is switched off
        return kernel(*arguments)
    permit, returned, failed, ended = [1], list[Any](), list[BaseException](), list[int]()

    def work() -> None:
        try:
            permit.pop()
        except IndexError:  # interrupted before
            return
        try:
            returned.append(kernel(*arguments))
        except BaseException as error:
            failed.append(error)
        finally:
            ended.append(1)

    def wait() -> None:
        while not ended:
            time.sleep(LOOK)

    try:
        _thread.start_new_thread(work, ())
        wait()
    except BaseException:
        try:
            permit.pop()
        except IndexError:
            wait()
        raise
    if failed:
        raise failed[0]
    return returned[0]


def _kept_if_possible(function: Callable[..., Any], options: dict[str, Any]) -> Any:
    """The compiled function, kept on disk; for this process alone, which a warning says, where no folder can be had."""
    given: dict[str, Any] = {"nogil": True, "error_model": "numpy", **options}
    try:
        return numba.njit(cache=True, **given)(function)
    except RuntimeError as error:
        if "no locator available" not in str(error):
            raise
    warnings.warn(NOT_KEPT, RuntimeWarning, stacklevel=2)
    return numba.njit(**given)(function)


def _digest() -> str:
    """Short hash of all sources of this package."""
    sources = sorted(Path(__file__).parent.glob("*.py"))
    return hashlib.sha256(b"\0".join(path.read_bytes() for path in sources)).hexdigest()[:12]


def _drop_stale(folder: Path, prefix: str, current: str) -> None:
    """Delete this package's cache files of other digests."""
    for path in folder.glob(f"{prefix}*.nb[ic]"):
        if current not in path.name:
            try:
                path.unlink()
            except OSError:
                continue  # a read-only folder, or another process was first: the file is merely unused
