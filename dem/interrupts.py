"""Compiled loops in threads other than the one that hears Ctrl-C, which only waits for them.

A KeyboardInterrupt between two threads that wait for one another would leave one of them waiting for ever, and what
Ctrl-C raises while LLVM calls Python back, to keep what it compiled, is lost (llvmlite 0.50).

Source   none, own convention
Status   Ctrl-C while threads begin, work and end, and while a loop is compiled, is heard afterwards (tests)
"""

from __future__ import annotations

import _thread
import time
from collections.abc import Callable
from typing import Any

LOOK = 2e-4
"""Seconds between two looks whether the threads have ended; a chunk of steps takes about a tenth of a second."""


def waited_for(begin: Callable[[], object], ended: Callable[[], bool]) -> None:
    """Call `begin` in another thread, and return once `ended()`.

    Raises:
        KeyboardInterrupt: Ctrl-C; what was begun has ended, or was not begun.  A second one does not wait.
    """
    permit = [1]

    def work() -> None:
        try:
            permit.pop()
        except IndexError:  # interrupted before
            return
        begin()

    def wait() -> None:
        while not ended():
            time.sleep(LOOK)

    try:
        _thread.start_new_thread(work, ())
        wait()
    except BaseException:
        try:
            permit.pop()
        except IndexError:
            wait()
        raise


def uninterrupted(kernel: Any, *arguments: Any) -> Any:
    """What `kernel(*arguments)` returns; its first call, which compiles it, is made in another thread.

    Raises:
        KeyboardInterrupt: Ctrl-C; the call has ended.  During a first call a second one does not wait.
    """
    if getattr(kernel, "signatures", True):  # a plain function where numba's compiler is switched off
        return kernel(*arguments)
    returned, failed = list[Any](), list[BaseException]()

    def work() -> None:
        try:
            returned.append(kernel(*arguments))
        except BaseException as error:
            failed.append(error)

    waited_for(work, lambda: bool(returned or failed))
    if failed:
        raise failed[0]
    return returned[0]
