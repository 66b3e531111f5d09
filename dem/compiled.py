"""Machine code of the loops over steps, kept on disk and never older than its source.

Source  none, own convention; numba by itself does not see an edit of a function in another file that a kernel calls
Status  a second process hits the cache, an edit anywhere in the package replaces it (tests)
"""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba

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
