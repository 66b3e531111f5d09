"""Ctrl-C where it does no harm: noted while a file is written or threads are waited for, and heard at a safe place.

A KeyboardInterrupt may come between any two lines of Python, also between the taking of a lock and the `with` that is
to give it back.  The lock that xarray holds around the NetCDF library, or the one within a future, then stays taken,
and whoever wants it next, as the closing of that very file does, waits for ever.  A second Ctrl-C is heard at once.

Source   none, own convention
Status   interrupts while a file is written and while threads are at work (tests)
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Collection, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import contextmanager
from types import FrameType
from typing import Any, TypeVar

T = TypeVar("T")

LOOK = 0.1
"""Seconds between two looks whether Ctrl-C has come, where threads are waited for."""


class Noted:
    """An interrupt that is put off until `hear` is called."""

    def __init__(self) -> None:
        self.came = False
        self.asked = False
        self.usual: Any = None

    def note(self, number: int, frame: FrameType | None) -> None:
        """What SIGINT calls: put off the first, let a second one through."""
        if self.came:
            self.usual(number, frame)
        self.came = self.asked = True

    def hear(self) -> None:
        """Do what an interrupt that was put off would have done.

        Raises:
            KeyboardInterrupt: there was one, and this is what it does, as usual.
        """
        if self.asked:
            self.asked = False
            self.usual(signal.SIGINT, None)


_active: Noted | None = None


@contextmanager
def noted() -> Iterator[Noted]:
    """Put off Ctrl-C until the end of the block, or until it is asked for.

    Outside the main thread, where no interrupt comes, and where interrupts are ignored, nothing is changed; a block
    within a block belongs to the outer one.

    Raises:
        KeyboardInterrupt: at the end, if one came, also where something else was raised.
    """
    global _active
    usual = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(usual):
        yield Noted()
        return
    if _active is not None:
        yield _active
        return
    own = Noted()
    own.usual = usual
    try:
        _active = own
        signal.signal(signal.SIGINT, own.note)
        yield own
    except Exception:
        own.hear()  # whoever catches the error would go on
        raise
    finally:
        _active = None
        signal.signal(signal.SIGINT, usual)
    own.hear()


def first_done(futures: Collection[Future[T]], interrupt: Noted) -> set[Future[T]]:
    """Those that are done, as soon as there is one.

    Raises:
        KeyboardInterrupt: Ctrl-C came while they were waited for, or before.
    """
    while True:
        interrupt.hear()
        done, _ = wait(futures, timeout=LOOK, return_when=FIRST_COMPLETED)
        if done:
            return done
