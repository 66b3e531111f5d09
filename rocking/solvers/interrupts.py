"""Calls into numba that Ctrl-C must not come out of half way: it is heard once they are done.

Compiled code that hands arrays or named tuples to Python: to make such an object numba calls Python, and there Ctrl-C
that came while the compiled code ran is heard: for an array it comes out as SystemError in place of KeyboardInterrupt,
for a named tuple the process dies (numba 0.68).  Compiled code that returns numbers, or fills arrays that it is given,
needs none of this.

The compiler: LLVM calls Python back to keep what it compiled, and there one Ctrl-C in four is lost, or comes out as a
RuntimeError (llvmlite 0.50).

Source   none, own convention
Status   interrupts at random times within such calls (tests)
"""

from __future__ import annotations

import _signal  # type: ignore[import-not-found]
import threading
from collections.abc import Callable
from signal import SIGINT
from types import FrameType
from typing import Any

# What `signal` makes of these looks for an Enum of each handler: 10 microseconds a call, a tenth of a short run.
getsignal, signal = _signal.getsignal, _signal.signal


def uninterrupted(call: Callable[..., Any], *arguments: Any) -> Any:
    """What `call(*arguments)` returns.

    Raises:
        KeyboardInterrupt: Ctrl-C came in the meantime; raised after the call.  A second one is heard at once,
            or after the call too where LLVM drops it.
    """
    # Asked by number: `current_thread` makes an entry that stays for a thread that `threading` did not start.
    if threading.get_ident() != threading.main_thread().ident:
        return call(*arguments)
    usual = getsignal(SIGINT)
    if not callable(usual):
        return call(*arguments)
    came: list[tuple[int, FrameType | None]] = []
    lost: list[BaseException] = []  # what was raised within the call, until it has come out of it

    def note(number: int, frame: FrameType | None) -> None:
        came.append((number, frame))
        if len(came) == 1:
            return
        try:
            if len(came) == 2:
                usual(*came[0])
            usual(number, frame)
        except BaseException as error:
            lost.append(error)
            raise

    signal(SIGINT, note)
    try:
        return call(*arguments)
    except KeyboardInterrupt:
        lost.clear()
        raise
    finally:
        signal(SIGINT, usual)
        if len(came) == 1:
            usual(*came[0])
        if lost:
            raise lost[0]
