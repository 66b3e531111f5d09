"""Files of the studies: whole or not there, with where they come from; and the folder that they go to.

A dataset is written to a temporary file beside its target, brought to the disk and renamed, so that a run that is cut
off leaves no half file under the final name.  Reading a dataset is bounded in memory, and a damaged or foreign file is
one sentence.
"""

from __future__ import annotations

import errno
import glob
import hashlib
import itertools
import math
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import netCDF4
import xarray as xr

from studies.running.interrupts import noted

MOST_BYTES = 2 * 1024**3
"""Of a dataset in memory: a file of a few kilobytes can declare any number of values."""

LEAST_FREE = 1024 * 1024
"""Bytes; a disk with less is full."""

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS)
"""Errors after which no other file can be written there either."""

LONGEST_OPENING = 20.0
"""Seconds that a file without a checksum may take to be opened."""

SEAL = b"\nsha256 "

_counter = itertools.count()


class BadInputError(Exception):
    """What the user asked for cannot be done; the message is one sentence that says what was wanted."""


class DatasetError(BadInputError, ValueError):
    """A file is not the dataset that it should be; the message is one sentence that names it."""


def writable_folder(folder: Path) -> Path:
    """The folder, made if need be.

    Raises:
        BadInputError: it cannot be made or written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise BadInputError(f"--out {folder}: want a folder that can be written to ({reason})") from error
    return folder


def _commit() -> str:
    """Commit of the sources if they lie in a git checkout, marked "+" if they were changed since."""
    here = Path(__file__).resolve()

    def git(*arguments: str) -> str:
        command = ["git", "-C", str(here.parent), *arguments]
        return subprocess.run(command, capture_output=True, text=True, timeout=10, check=True).stdout.strip()

    try:
        # Installed into an environment that lies in somebody else's checkout, this file is not tracked there.
        git("ls-files", "--error-unmatch", here.name)
        return git("describe", "--always", "--dirty=+", "--abbrev=12")
    except (OSError, subprocess.SubprocessError):
        return "unknown"


def provenance(title: str, command: str) -> dict[str, str]:
    """Attributes that say where a dataset comes from."""
    try:
        release = version("rocking-blocks")
    except PackageNotFoundError:
        release = "not installed"
    return {
        "Conventions": "CF-1.11",
        "title": title,
        "source": f"rocking-blocks {release}",
        "commit": _commit(),
        "command": command,
        "history": command,
    }


def temporary_beside(path: Path) -> Path:
    """A name in the same folder that no other process and no other call has: hidden, with the same ending.

    Never the same twice: after a full disk the NetCDF library keeps the file that it could not close.
    """
    return path.with_name(f".{path.stem}.{os.getpid()}-{next(_counter)}{path.suffix}")


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Let `write` fill a temporary file beside `path`, bring it to the disk, then rename it to `path`.

    A link is followed; what is no plain file (a device, a pipe) is written to as it is.  Ctrl-C is heard afterwards.

    Raises:
        OSError: it cannot be written, which leaves `path` as it was.
    """
    target = Path(os.path.realpath(path))
    if target.exists() and not target.is_file() and not target.is_dir():
        write(target)
        return
    temporary = temporary_beside(target)
    with noted():
        try:
            _write_beside(path, target, temporary, write)
        finally:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)


def _write_beside(path: Path, target: Path, temporary: Path, write: Callable[[Path], object]) -> None:
    """Fill the temporary file, bring it to the disk and rename it; OSError names the path that was asked for."""
    try:
        write(temporary)
        with temporary.open("rb") as file:
            os.fsync(file.fileno())
        os.replace(temporary, target)
    except OSError as error:
        # The NetCDF library calls every failure to begin a file a lack of permission.
        number = errno.ENOSPC if error.errno == errno.EACCES and _full(target.parent) else error.errno or errno.EIO
        reason = os.strerror(number) if number == errno.ENOSPC else error.strerror or str(error)
        raise OSError(number, reason, str(path)) from error
    except RuntimeError as error:
        if not str(error).startswith("NetCDF:"):
            raise
        # Nor does it pass on why a write failed.
        full = _full(target.parent)
        reason = os.strerror(errno.ENOSPC) if full else f"{error}; is the disk full?"
        raise OSError(errno.ENOSPC if full else errno.EIO, reason, str(path)) from error


def _full(folder: Path) -> bool:
    """Whether a folder can be written to but for the room."""
    return os.access(folder, os.W_OK) and shutil.disk_usage(folder).free < LEAST_FREE


def seal(path: Path) -> None:
    """Write the checksum of a NetCDF file behind its end, where other programs do not look.

    A damaged file can open without a complaint and show numbers as missing: its own checksums cover the packed numbers
    alone.
    """
    digest = _digest_of(path, path.stat().st_size)
    with path.open("ab") as file:
        file.write(SEAL + digest + b"\n")


def sealed(path: Path) -> bool | None:
    """Whether a file is to the last bit what was sealed; None for one without a seal."""
    length = len(SEAL) + 65
    with path.open("rb") as file:
        end = file.seek(0, os.SEEK_END)
        file.seek(max(0, end - length))
        last = file.read(length)
    if not last.startswith(SEAL):
        return None
    return last[len(SEAL) : -1] == _digest_of(path, end - length)


def _digest_of(path: Path, size: int) -> bytes:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while size > 0 and (block := file.read(min(size, 2**20))):
            digest.update(block)
            size -= len(block)
    return digest.hexdigest().encode()


def clear_unfinished(path: Path) -> None:
    """Remove what runs that were killed have left of `path`; only for who holds its lock (`studies.running.lock`)."""
    target = Path(os.path.realpath(path))
    for left in target.parent.glob(f".{glob.escape(target.stem)}.[0-9]*{target.suffix}"):
        with suppress(OSError):
            left.unlink()


def _declared_size(path: Path) -> int:
    """Bytes that the variables of a NetCDF file take in memory; a text, some fifty besides its characters."""
    with netCDF4.Dataset(path) as file:
        return sum(math.prod(v.shape) * getattr(v.dtype, "itemsize", 64) for v in file.variables.values())


def _can_be_opened(path: Path) -> bool:
    """Whether the NetCDF library comes out of opening a file: damaged ones can crash it or send it round for ever."""
    code = "import sys, netCDF4; netCDF4.Dataset(sys.argv[1]).close()"
    try:
        # -P: what lies beside a stranger's file is not imported.
        done = subprocess.run(
            [sys.executable, "-P", "-c", code, str(path)], capture_output=True, timeout=LONGEST_OPENING
        )
    except subprocess.TimeoutExpired:
        return False
    return done.returncode >= 0  # what it refuses, it refuses here as well, with its reason


def load_dataset(path: Path, most: int = MOST_BYTES) -> xr.Dataset:
    """The dataset of a NetCDF file, loaded.

    Raises:
        DatasetError: it is not there, damaged, no NetCDF, or would take more than `most` bytes.
    """
    if not path.is_file():
        raise DatasetError(f"{path}: is not there or no file, want a NetCDF dataset")
    try:
        seal = sealed(path)
        if seal is False:
            raise ValueError("it is not what was written, by its checksum")
        if seal is None and not _can_be_opened(path):  # it has no checksum: it is a stranger's
            raise ValueError("the NetCDF library does not get through it")
        with noted():
            size = _declared_size(path)  # beforehand: xarray makes room for texts when it opens a file
            if size <= most:
                with xr.open_dataset(path, engine="netcdf4") as opened:
                    return opened.load()
    except Exception as error:  # whatever the libraries meet in a stranger's file means that it is none
        reason = (getattr(error, "strerror", None) or str(error) or type(error).__name__).splitlines()[0][:120]
        raise DatasetError(f"{path}: want a NetCDF dataset, whole ({type(error).__name__}: {reason})") from None
    raise DatasetError(f"{path}: declares {size} bytes of values, want at most {most}")


def save_text(text: str, path: Path) -> None:
    """Write a text."""

    def write(target: Path) -> None:
        target.write_text(text, encoding="utf-8")

    write_whole(path, write)


def save_dataset(ds: xr.Dataset, path: Path) -> None:
    """Write a dataset as NetCDF-4."""
    packed: dict[str, dict[str, Any]] = {
        str(name): {"zlib": True} for name, v in ds.data_vars.items() if v.dtype.kind in "fi" and v.ndim
    }
    # CF: coordinates have no missing values.
    packed |= {str(name): {"_FillValue": None} for name, v in ds.coords.items() if v.dtype.kind == "f"}

    def write(target: Path) -> None:
        ds.to_netcdf(target, engine="netcdf4", encoding=packed)
        seal(target)

    write_whole(path, write)


def save_figure(figure: Any, folder: Path, name: str) -> list[Path]:
    """Write a matplotlib figure as PNG and PDF; the paths."""
    paths = [folder / f"{name}.png", folder / f"{name}.pdf"]
    text = " ".join(figure.get_supxlabel().split())
    for path in paths:
        # The caption goes with the picture. No date in the file: the same dataset gives the same bytes.
        clear_unfinished(path)
        said = {"CreationDate": None, "Subject": text} if path.suffix == ".pdf" else {"Description": text}
        write_whole(path, lambda target, meta=said: figure.savefig(target, dpi=150, metadata=meta))  # type: ignore[misc]
    return paths
