"""Ctrl-C while `python -m excitation` or `python -m studies...` loads its libraries, a second or two: one line alone.

Source   none; while the module that is to be run is looked for, `sys.argv[0]` is "-m", and the command line names it
Status   interrupted while loading, and nothing done to other programs (tests); the exit status is that of SIGINT, 130
         in a shell
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from types import FrameType

OURS = ("excitation", "studies")


def _asked() -> str:
    """The package whose module is being looked for by `python -m`; "" in any other process."""
    if sys.argv[:1] != ["-m"]:
        return ""
    words = iter(sys.orig_argv[1:])
    named = next((word[2:] or next(words, "") for word in words if word.startswith("-m")), "")
    return named.partition(".")[0]


def _stop(number: int, frame: FrameType | None) -> None:
    """End at once: a library in the middle of its loading may make an ImportError of a KeyboardInterrupt."""
    os.write(2, b"interrupted: nothing was written\n")
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    os.kill(os.getpid(), signal.SIGINT)


def loaded() -> None:
    """What is to run is there: from here on Ctrl-C is a KeyboardInterrupt again, which it can clear up after."""
    if signal.getsignal(signal.SIGINT) is _stop:
        signal.signal(signal.SIGINT, signal.default_int_handler)


# Where the interrupt is ignored, as in a shell's background, or is somebody else's, it stays so.
if (
    _asked() in OURS
    and threading.current_thread() is threading.main_thread()
    and signal.getsignal(signal.SIGINT) is signal.default_int_handler
):
    signal.signal(signal.SIGINT, _stop)
