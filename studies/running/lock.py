"""One run at a time on a target: whoever comes second waits, or is told who is at work.

The lock is the system's own (flock) on a hidden file beside the target, so that it ends with its process however that
ends: nothing is left to be cleaned up after kill -9 or a power cut.

Source   none, own convention
Status   two processes on one target, one of them killed (tests); where the system has no flock, or the file system
         does not keep it, nothing is locked and a line on stderr says so
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from studies.running.files import BadInputError

try:
    import fcntl
except ImportError:  # not a Unix
    fcntl = None  # type: ignore[assignment]


def _name(target: Path) -> Path:
    return target.with_name(f".{target.name}.lock")


def _acquired(path: Path, wait: bool) -> int:
    """A descriptor that holds the lock; BlockingIOError if another process does and it is not waited for."""
    while True:
        held = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            fcntl.flock(held, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
            # Who held it before may have removed the file meanwhile: then this is a lock on nothing.
            with suppress(OSError):
                if os.path.samestat(os.fstat(held), os.stat(path)):
                    return held
        except BaseException:
            os.close(held)
            raise
        os.close(held)


def _holder(path: Path) -> str:
    with suppress(OSError, ValueError):
        return f"process {int(path.read_text())}"
    return "another process"


@contextmanager
def alone(target: Path, wait: bool = True) -> Iterator[None]:
    """Hold the lock of a target.

    Args:
        target: what is going to be written; its folder is there.
        wait: whether to wait until whoever holds it is done, saying so on stderr.

    Raises:
        BadInputError: another process holds it and it is not waited for.
    """
    path = _name(target)
    held = None
    try:
        if fcntl is None:
            raise OSError("no flock on this system")
        try:
            held = _acquired(path, wait=False)
        except BlockingIOError:
            if not wait:
                raise BadInputError(
                    f"{target}: {_holder(path)} is writing it; wait until it is done, or choose another --out"
                ) from None
            print(f"{target}: waiting for {_holder(path)}, which is writing it", file=sys.stderr, flush=True)
            held = _acquired(path, wait=True)
        os.truncate(held, 0)
        os.write(held, str(os.getpid()).encode())
    except OSError as error:
        if held is None:
            print(f"{target}: is not locked against other runs ({error.strerror or error})", file=sys.stderr)
    try:
        yield
    finally:
        if held is not None:
            with suppress(OSError):
                path.unlink()
            os.close(held)
