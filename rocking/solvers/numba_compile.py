"""Plain functions of the physics, compiled by numba and kept on disk.

numba's disk cache notices a change of the file that holds the compiled function, and no change of a function that it
calls from another file.  So every compiled function here carries in its name a digest of all sources it may depend on:
an edit leads to a new name, and the files of the old one are deleted.  A second process finds what the first compiled.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

import numba
from numba.extending import register_jitable

import rocking
from rocking.solvers import numba_namespace

_registered: dict[FunctionType, frozenset[str]] = {}


def make_jitable(function: Any) -> frozenset[str]:
    """Let compiled code call a plain function and every plain function it calls; the source files of them all."""
    if not isinstance(function, FunctionType):
        return frozenset()
    if function not in _registered:
        _registered[function] = frozenset([function.__code__.co_filename])
        register_jitable(error_model="numpy")(function)
        called = (function.__globals__.get(name) for name in function.__code__.co_names)
        files = [make_jitable(f) for f in called if isinstance(f, FunctionType)]
        _registered[function] = _registered[function].union(*files)
    return _registered[function]


@cache
def _package_sources() -> tuple[str, ...]:
    folder = Path(rocking.__file__).parent
    return tuple(sorted(str(path) for path in folder.rglob("*.py")))


@cache
def _digest(files: frozenset[str]) -> str:
    """A short digest of the contents of `files` and of all sources of this package."""
    digest = hashlib.sha256()
    for name in sorted(files.union(_package_sources())):
        path = Path(name)
        digest.update(path.read_bytes() if path.is_file() else name.encode())
    return digest.hexdigest()[:12]


def _importable(function: Any) -> bool:
    """Whether another process finds the same function under its name, as a disk cache needs."""
    module = sys.modules.get(function.__module__)
    return function.__module__ != "__main__" and getattr(module, function.__name__, None) is function


def _drop_stale(dispatcher: Any, label: str, digest: str) -> None:
    """Delete cache files that an older version of the sources has left for the same function."""
    folder = dispatcher.stats.cache_path
    if folder is None:
        return
    for path in Path(folder).glob(f"*.{label}_*-*.nb[ci]"):
        if f".{label}_{digest}-" not in path.name:
            with suppress(OSError):  # another process may have deleted it, or the folder may be read-only
                path.unlink()


def compiled(
    body: Any, signature: Any, label: str, files: Iterable[str] = (), keep: bool = True, parallel: bool = False
) -> Any:
    """`body` compiled for one signature, kept on disk under `label` and the digest of its sources.

    keep=False compiles for this process alone: for functions that another process could not find by name.
    parallel=True spreads loops over `prange` over the cores.
    """
    digest = _digest(frozenset(files))
    body.__qualname__ = f"{label}_{digest}"
    dispatcher = numba.njit(signature, cache=keep, nogil=True, error_model="numpy", parallel=parallel)(body)
    if keep:
        _drop_stale(dispatcher, label, digest)
    return dispatcher


def bound(function: Any, arity: int, signature: Any) -> Any:
    """`function(xp, ...)` of the physics as a compiled function of its other arguments."""
    files = make_jitable(function)
    xp = numba_namespace
    bodies: dict[int, Callable[..., Any]] = {
        2: lambda a, b: function(xp, a, b),
        4: lambda a, b, c, d: function(xp, a, b, c, d),
        5: lambda a, b, c, d, e: function(xp, a, b, c, d, e),
    }
    label = f"{function.__module__}.{function.__qualname__}".replace(".", "_").replace("<locals>", "local")
    return compiled(bodies[arity], signature, label, files, keep=_importable(function))
