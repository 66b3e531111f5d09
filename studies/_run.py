"""What every study's command line shares: the output folder, provenance, and files that are whole or not there.

A dataset is written to a temporary file beside its target and renamed, so that a run that is cut off leaves no half
file under the final name.
"""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import xarray as xr

DEFAULT_OUT = Path("build") / "studies"
"""Where figures go unless --out says otherwise."""


class BadInputError(Exception):
    """What the user asked for cannot be done; the message is one sentence that says what was wanted."""


def add_common_arguments(parser: argparse.ArgumentParser) -> None:
    """--out and --quick."""
    parser.add_argument(
        "--out", type=Path, default=DEFAULT_OUT, metavar="DIR", help="folder for the files (default: %(default)s)"
    )
    parser.add_argument("--quick", action="store_true", help="a small version in seconds: fewer points, coarser steps")


def positive(option: str, value: float, zero: bool = False) -> None:
    """Check a number of the command line.

    Raises:
        BadInputError: it is not positive (or zero, where that is allowed).
    """
    if not (math.isfinite(value) and (value > 0.0 or (zero and value == 0.0))):
        raise BadInputError(f"{option} {value:g}: want a number {'of 0 or more' if zero else 'above 0'}")


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


def one_of(option: str, values: list[Any], known: tuple[Any, ...]) -> list[Any]:
    """The values, in the order of `known`.

    Raises:
        BadInputError: one of them is not known, or there is none.
    """
    for value in values:
        if value not in known:
            raise BadInputError(f"{option} {value}: want one of {', '.join(map(str, known))}")
    return [value for value in known if value in values]


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


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Let `write` fill a temporary file beside `path`, then rename it to `path`."""
    temporary = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        write(temporary)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


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
    write_whole(path, lambda target: ds.to_netcdf(target, engine="netcdf4", encoding=packed))


def save_figure(figure: Any, folder: Path, name: str) -> list[Path]:
    """Write a matplotlib figure as PNG and PDF; the paths."""
    paths = [folder / f"{name}.png", folder / f"{name}.pdf"]
    text = " ".join(figure.get_supxlabel().split())
    for path in paths:
        # The caption goes with the picture. No date in the file: the same dataset gives the same bytes.
        said = {"CreationDate": None, "Subject": text} if path.suffix == ".pdf" else {"Description": text}
        write_whole(path, lambda target, meta=said: figure.savefig(target, dpi=150, metadata=meta))  # type: ignore[misc]
    return paths


def run(main: Callable[[list[str]], object], interrupted: str = "nothing was written") -> None:
    """Run `main` on the command line's arguments: bad input is one sentence and exit status 2.

    Args:
        main: what is run.
        interrupted: what is said of the files after Ctrl-C.
    """
    try:
        main(sys.argv[1:])
    except BadInputError as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print(f"interrupted: {interrupted}", file=sys.stderr)
        sys.exit(130)
