"""Runs computed side by side, each kept in a file of its own, so that an interruption loses nothing that was finished.

A part is written under a temporary name and renamed: after kill -9 at any moment it is whole or not there.  Its name is
a hash of the job and of all sources that decide its result, so a part is never taken for another, and studies that make
the same run share it.  Parts made with other sources are removed when a study is done.

Source   none, own convention
Status   kill -9, damaged parts and changed settings are tested
"""

from __future__ import annotations

import ast
import hashlib
import io
import os
import shutil
import sys
import zipfile
import zlib
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from tqdm import tqdm

from studies.running.files import write_whole
from studies.running.interrupts import first_done, noted

Job = TypeVar("Job")
Result = dict[str, Any]
"""What a run gives: numbers, texts and arrays by name."""

PHYSICS = ("rocking", "dem", "excitation")
"""Packages whose sources decide what a run gives."""

STUDIES = Path(__file__).resolve().parents[1]


@cache
def sources_hash(module: str = "") -> str:
    """A hash of the sources that decide what a run gives: the physics, and the module of the studies that it is from.

    A module of the studies counts with those of them that it imports, and that these import in turn.
    """
    files = [path for package in PHYSICS for path in sorted((STUDIES.parent / package).rglob("*.py"))]
    digest = hashlib.sha256()
    for path in [*files, *sorted((STUDIES / "criteria").glob("*.py")), STUDIES / "specimens.py", *_reached(module)]:
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def _reached(module: str) -> list[Path]:
    """Files of a module and of all modules of the studies that it reaches by imports; none without a module."""
    own = getattr(sys.modules.get(module), "__file__", None)  # it need not be one of the studies
    found: dict[str, Path] = {}
    ahead = [(module, _file_of(module) or (Path(own) if own else None))]
    while ahead:
        name, file = ahead.pop()
        if file is None or name in found:
            continue
        found[name] = file
        names: list[str] = []
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names += [each.name for each in node.names]
            elif isinstance(node, ast.ImportFrom):
                # One dot is the package that the module is in, or is.
                above = name.split(".")[: None if file.name == "__init__.py" else -1]
                beside = above[: len(above) - node.level + 1] if node.level else []
                base = ".".join([*beside, *([node.module] if node.module else [])])
                names += [base, *(f"{base}.{each.name}" for each in node.names)]
        ahead += [(each, _file_of(each)) for each in names]
    return [found[name] for name in sorted(found)]


def _file_of(module: str) -> Path | None:
    """The source of a module of the studies; None of any other."""
    package, *parts = module.split(".")
    path = STUDIES.joinpath(*parts)
    files = (path.with_suffix(".py"), path / "__init__.py") if package == STUDIES.name else ()
    return next((file for file in files if file.is_file()), None)


@cache
def studies_hash() -> str:
    """A hash of the sources of the studies, which put runs together."""
    digest = hashlib.sha256(sources_hash().encode())
    for path in sorted(STUDIES.rglob("*.py")):
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def hashed(*items: Any) -> str:
    """A short hash of what these say of themselves (`repr`)."""
    return hashlib.sha256("\n".join(map(repr, items)).encode()).hexdigest()[:20]


def _plain(value: np.ndarray) -> Any:
    return value.item() if value.ndim == 0 else value


def read_arrays(path: Path) -> dict[str, np.ndarray] | None:
    """Arrays that were kept in a file; None if it is not there, or damaged."""
    try:
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            return {name: file[name] for name in file.files}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error, RuntimeError, MemoryError):
        return None


def write_arrays(path: Path, arrays: Mapping[str, Any]) -> None:
    """Keep arrays in a file, which appears whole or not at all; its folder is made if need be.

    Raises:
        OSError: it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    packed = io.BytesIO()  # on a full disk NumPy 2.0 leaves its archive open, which complains when it is collected
    np.savez(packed, **arrays)
    write_whole(path, lambda target: target.write_bytes(packed.getvalue()))


class Parts:
    """A folder of finished runs; without a folder nothing is kept.

    Args:
        folder: where parts are kept, made when the first is written.
        workers: runs side by side; as many as there are cores if not given.
    """

    def __init__(self, folder: Path | None = None, workers: int | None = None) -> None:
        self.folder = folder
        self.workers = workers or os.cpu_count() or 1

    def _paths(self, jobs: Sequence[Any], work: Callable[..., Any]) -> list[Path | None]:
        if self.folder is None:
            return [None] * len(jobs)
        base = self.folder / sources_hash()
        about = (work.__module__, work.__qualname__, sources_hash(work.__module__))
        return [base / f"{hashed(*about, job)}.npz" for job in jobs]

    def _kept(self, path: Path | None) -> Result | None:
        found = None if path is None else read_arrays(path)
        return None if found is None else {name: _plain(value) for name, value in found.items()}

    def _keep(self, path: Path | None, result: Mapping[str, Any]) -> None:
        if path is not None:
            write_arrays(path, result)

    def results(self, jobs: Sequence[Job], work: Callable[[Job], Result], label: str) -> list[Result]:
        """What `work` gives for each job, in their order; what was kept is not computed again.

        Args:
            jobs: values whose `repr` says all that decides the result.
            work: called in threads; gives numbers, texts and arrays by name.
            label: heads the bar of progress.

        Raises:
            TypeError: `work` takes something from the function around it, which no job says.
        """
        around = getattr(getattr(work, "__code__", None), "co_freevars", ())
        if around:
            raise TypeError(f"{work.__qualname__} takes {', '.join(around)} from around it: want that in its jobs")
        paths = self._paths(jobs, work)
        found: list[Result | None] = [self._kept(path) for path in paths]

        def kept(job: Job, path: Path | None) -> Result:
            # In the thread that computed it: after Ctrl-C, or when another run fails, it is kept as well.
            result = work(job)
            self._keep(path, result)
            return result

        with noted() as interrupt:
            pool = ThreadPoolExecutor(self.workers)
            try:
                with tqdm(
                    total=len(jobs), initial=sum(r is not None for r in found), unit="run", desc=label, disable=None
                ) as bar:
                    under_way = {pool.submit(kept, job, paths[i]): i for i, job in enumerate(jobs) if found[i] is None}
                    while under_way:
                        for future in first_done(under_way, interrupt):
                            result = future.result()
                            # As it would be read again, so that a run that went on gives the same.
                            found[under_way.pop(future)] = {k: _plain(np.asarray(v)) for k, v in result.items()}
                            bar.update()
            finally:
                # On Ctrl-C, runs that have not begun are dropped; those under way are finished and kept.
                pool.shutdown(wait=True, cancel_futures=True)
        return [result for result in found if result is not None]

    def clear_outdated(self) -> None:
        """Remove parts that were made with other sources."""
        if self.folder is not None and self.folder.exists():
            for old in self.folder.iterdir():
                if old.name != sources_hash():
                    shutil.rmtree(old, ignore_errors=True)
