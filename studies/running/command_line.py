"""What the command lines share: options, checks of their values, and how a command ends.

Source   none, own convention
Status   each way to end is tried on real processes (tests)
"""

from __future__ import annotations

import argparse
import math
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from excitation._early import loaded
from studies.running.files import NO_ROOM, BadInputError

DEFAULT_OUT = Path("build") / "studies"
"""Where figures go unless --out says otherwise."""


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


def one_of(option: str, values: list[Any], known: tuple[Any, ...]) -> list[Any]:
    """The values, in the order of `known`.

    Raises:
        BadInputError: one of them is not known, or there is none.
    """
    for value in values:
        if value not in known:
            raise BadInputError(f"{option} {value}: want one of {', '.join(map(str, known))}")
    return [value for value in known if value in values]


def said_of(error: OSError, kept: str) -> str:
    """A sentence about a file that cannot be read or written, and what to do."""
    place = f"{error.filename}: " if error.filename else ""
    advice = "make room" if error.errno in NO_ROOM else "mend that"
    return f"{place}cannot be read or written ({error.strerror or error}); {advice} and run it again: {kept}"


def run(main: Callable[[list[str]], object], interrupted: str = "nothing was written") -> None:
    """Run `main` on the command line's arguments: bad input is one sentence and exit status 2.

    A file that cannot be written is one sentence and 1, Ctrl-C one and 130.

    Args:
        main: what is run.
        interrupted: what is said of the files after Ctrl-C and after a full disk.
    """
    loaded()
    try:
        main(sys.argv[1:])
        sys.stdout.flush()
    except BadInputError as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(2)
    except BrokenPipeError:
        # Whoever read what is printed has enough of it; what is left in the buffer goes nowhere.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except OSError as error:
        print(f"error: {said_of(error, interrupted)}", file=sys.stderr)
        sys.exit(1)
    except MemoryError:
        print(f"error: not enough memory; want less at a time, as with --workers 1: {interrupted}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        print(f"interrupted: {interrupted}", file=sys.stderr)
        sys.exit(130)
