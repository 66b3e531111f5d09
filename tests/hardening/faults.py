"""What the tests of faults share: small disks, folders that cannot be written to, processes that are cut off."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest


def _mount(*arguments: str) -> bool:
    try:
        return subprocess.run(["mount", *arguments], capture_output=True).returncode == 0
    except OSError:
        return False


@contextmanager
def disk(folder: Path, size: str) -> Iterator[Path]:
    """A disk of that size at a new folder; the test is skipped where none can be mounted."""
    folder.mkdir()
    if not _mount("-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)):
        pytest.skip("mounting a small disk takes root")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", str(folder)], capture_output=True, check=True)


def read_only(mounted: Path) -> None:
    """Let nothing be written to a mounted disk any more."""
    assert _mount("-o", "remount,ro", str(mounted))


def command(*arguments: str) -> list[str]:
    """A command of the package, in the interpreter of the tests."""
    return [sys.executable, "-m", *map(str, arguments)]


# An interrupt that the tests ignore, as in a background, their children would ignore too.  Not by `preexec_fn`: that
# forks a process in which JAX may have threads.
HEARING = "import os, signal, sys; signal.signal(signal.SIGINT, signal.SIG_DFL); os.execv(sys.argv[1], sys.argv[1:])"


def started(arguments: list[str], **more: object) -> subprocess.Popen[str]:
    """A command that runs by itself, in a group of its own, and hears Ctrl-C even if the tests do not."""
    pipe = subprocess.PIPE
    return subprocess.Popen(  # type: ignore[call-overload, no-any-return]
        [sys.executable, "-c", HEARING, *arguments], stdout=pipe, stderr=pipe, text=True, start_new_session=True, **more
    )


def wait_for(there: Callable[[], bool], child: subprocess.Popen[str], seconds: float = 240.0) -> None:
    """Until something is there, or the command has ended by itself."""
    end = time.monotonic() + seconds
    while not there() and child.poll() is None:
        assert time.monotonic() < end, "it took too long"
        time.sleep(0.005)


def killed(child: subprocess.Popen[str]) -> None:
    """kill -9, and nothing else: what it has started goes on or not, as it would."""
    os.kill(child.pid, signal.SIGKILL)
    assert child.wait() == -signal.SIGKILL
    for pipe in (child.stdout, child.stderr):
        if pipe is not None:
            pipe.close()
