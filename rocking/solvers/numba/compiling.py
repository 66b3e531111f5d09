"""Plain functions of the physics, compiled by numba and kept on disk.

numba's disk cache notices a change of the file that holds the compiled function, and no change of a function that it
calls from another file.  So every compiled function here carries in its name a digest of all sources it may depend on:
an edit leads to a new name, and the files of the old one are deleted.  A second process finds what the first compiled.
What is compiled after its sources were edited under a running process is not kept: it would be old physics under the
new name.
"""

from __future__ import annotations

import hashlib
import re
import sys
import warnings
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache, lru_cache
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numba
import numpy as np
from numba.extending import register_jitable

import rocking
from rocking._sources import edited, stamp
from rocking.solvers.interrupts import undisturbed
from rocking.solvers.numba import namespace

# Hooks are pointers in a tuple, which numba calls experimental each time that it sees them.
warnings.filterwarnings("ignore", "First-class function type", numba.core.errors.NumbaExperimentalFeatureWarning)

NOT_KEPT = (
    "compiled code is not kept, and compiled again in every process: neither the package's folder nor one of the user "
    "can be written to; set NUMBA_CACHE_DIR to a folder that can"
)

EDITED = "compiled code is not kept: {} was changed after this process began"

_njit: Any = numba.njit  # whose annotations do not know all of its options
borrowing: Any = _njit(error_model="numpy", _nrt=False)
"""Compile a function that neither makes arrays nor keeps one: without counting references to those that it is given.

Each count is an atomic operation on memory that all threads share; in the kernels of batches they took a sixth of the
time of one thread."""

_registered: dict[FunctionType, frozenset[str]] = {}


def make_jitable(function: Any) -> frozenset[str]:
    """Let compiled code call a plain function and every plain function it calls; the source files of them all.

    Asked by one thread at a time (`rocking.solvers.numba.once`): another one would take for done what is begun.
    """
    if not isinstance(function, FunctionType):
        return frozenset()
    if function not in _registered:
        _registered[function] = frozenset([function.__code__.co_filename])
        register_jitable(error_model="numpy")(function)
        called = (function.__globals__.get(name) for name in sorted(_names(function.__code__)))
        files = [make_jitable(f) for f in called if isinstance(f, FunctionType)]
        _registered[function] = _registered[function].union(*files)
    return _registered[function]


def _reach(thing: Any, files: set[str], constants: dict[str, str], seen: dict[int, Any]) -> None:
    """Gather what compiled code takes from `thing`: source files of functions, types and modules, and constants."""
    function = getattr(thing, "py_func", thing)
    if id(function) in seen:
        return
    seen[id(function)] = function
    if isinstance(function, type | ModuleType):
        module = sys.modules.get(function.__module__) if isinstance(function, type) else function
        if module is not None and module.__name__.partition(".")[0] == rocking.__name__:
            files.add(str(module.__file__))
    elif isinstance(function, FunctionType):
        files.add(function.__code__.co_filename)
        cells = dict(zip(function.__code__.co_freevars, function.__closure__ or (), strict=True))
        defaults = [*(function.__defaults__ or ()), *(function.__kwdefaults__ or {}).values()]
        found = {name: function.__globals__[name] for name in _names(function.__code__) if name in function.__globals__}
        found |= {name: cell.cell_contents for name, cell in cells.items()}
        found |= {f"default {k}": value for k, value in enumerate(defaults)}
        for name, value in found.items():
            if isinstance(value, int | float | str | tuple | np.ndarray):
                constants[f"{function.__module__}.{function.__qualname__}.{name}"] = repr(np.asarray(value).tolist())
            _reach(value, files, constants, seen)


def _names(code: CodeType) -> set[str]:
    """Global names that a function and the functions inside it use."""
    inner = (_names(constant) for constant in code.co_consts if isinstance(constant, CodeType))
    return set(code.co_names).union(*inner)


def _content(name: str) -> bytes:
    path = Path(name)
    return _read(path, stamp(path)) if path.is_file() else name.encode()


@lru_cache(maxsize=1024)
def _read(path: Path, _stamp: tuple[int, int]) -> bytes:
    return path.read_bytes()


def _digest(body: Any, files: Iterable[str]) -> tuple[str, list[str], list[CodeType]]:
    """A short digest of all sources and constants that a function may depend on; the files, the functions' code."""
    reached, constants, seen = {__file__, *files}, dict[str, str](), dict[int, Any]()
    _reach(body, reached, constants, seen)
    digest = hashlib.sha256(repr(sorted(constants.items())).encode())
    for name in sorted(reached):
        digest.update(_content(name))
    codes = [thing.__code__ for thing in seen.values() if isinstance(thing, FunctionType)]
    return digest.hexdigest()[:12], sorted(reached), codes


def _importable(function: Any) -> bool:
    """Whether another process finds the same function under its name, as a disk cache needs."""
    module = sys.modules.get(function.__module__)
    return function.__module__ != "__main__" and getattr(module, function.__name__, None) is function


def _drop_stale(dispatcher: Any, label: str, digest: str) -> None:
    """Delete cache files that an older version of the sources has left for the same function."""
    folder = dispatcher.stats.cache_path
    if folder is None:
        return
    older = re.compile(rf"\.{re.escape(label)}_([0-9a-f]{{12}})-")
    for path in Path(folder).glob(f"*.{label}_*-*.nb[ci]"):
        found = older.search(path.name)
        if found is not None and found[1] != digest:
            with suppress(OSError):  # another process may have deleted it, or the folder may be read-only
                path.unlink()


def compiled(
    body: Any, signature: Any, label: str, files: Iterable[str] = (), keep: bool = True, parallel: bool = False
) -> Any:
    """`body` compiled for one signature, kept on disk under `label` and the digest of its sources.

    keep=False compiles for this process alone: for functions that another process could not find by name.
    parallel=True spreads loops over `prange` over the cores.
    """
    digest, sources, codes = _digest(body, files)
    changed = next((name for name in sources if keep and edited(name, codes)), None)
    if changed is not None:
        warnings.warn(EDITED.format(changed), RuntimeWarning, stacklevel=2)
        keep = False
    body.__qualname__ = f"{label}_{digest}"
    given: dict[str, Any] = {"nogil": True, "error_model": "numpy", "parallel": parallel}
    try:
        dispatcher = undisturbed(numba.njit(signature, cache=keep, **given), body)
    except RuntimeError as error:
        if "no locator available" not in str(error):
            raise
        warnings.warn(NOT_KEPT, RuntimeWarning, stacklevel=2)
        keep, dispatcher = False, undisturbed(numba.njit(signature, **given), body)
    if keep:
        _drop_stale(dispatcher, label, digest)
    _remember_addresses(dispatcher)
    return dispatcher


def _remember_addresses(dispatcher: Any) -> None:
    """Have addresses of compiled code looked up once: numba asks LLVM anew each time that a function is handed over.

    That took a quarter of a short run, and to find the one that is compiled by hashes of its types half of that.
    """
    for compiled_code in dispatcher.overloads.values():
        library = compiled_code.library
        library.get_pointer_to_function = cache(library.get_pointer_to_function)
    if len(dispatcher.overloads) == 1:
        (only,) = dispatcher.overloads.values()
        dispatcher.get_compile_result = lambda signature: only


def bound(function: Any, arity: int, signature: Any) -> Any:
    """`function(xp, ...)` of the physics as a compiled function of its other arguments."""
    files = make_jitable(function)
    xp = namespace
    bodies: dict[int, Callable[..., Any]] = {
        2: lambda a, b: function(xp, a, b),
        4: lambda a, b, c, d: function(xp, a, b, c, d),
        5: lambda a, b, c, d, e: function(xp, a, b, c, d, e),
    }
    return compiled(bodies[arity], signature, _label(function, arity), files, keep=_importable(function))


def bound_motion(kernel: Any, pitch: Any, signature: Any) -> Any:
    """A motion's kernel and pitch_kernel (None: level) as one compiled function (t, par) -> four numbers."""
    files = make_jitable(kernel) | make_jitable(pitch)
    xp = namespace

    def level(t, par):
        a_x, a_z = kernel(xp, t, par)
        return a_x, a_z, 0.0, 0.0

    def pitching(t, par):
        a_x, a_z = kernel(xp, t, par)
        angle, acceleration = pitch(xp, t, par)
        return a_x, a_z, angle, acceleration

    body, parts = (level, (kernel,)) if pitch is None else (pitching, (kernel, pitch))
    label = "_with_".join(_label(part, 2) for part in parts)
    return compiled(body, signature, label, files, keep=all(_importable(part) for part in parts))


def _label(function: Any, arity: int) -> str:
    name = f"{function.__module__}.{function.__qualname__}_{arity}"
    return name.replace(".", "_").replace("<locals>", "local")
