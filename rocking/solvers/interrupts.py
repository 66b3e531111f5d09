"""Calls into numba that Ctrl-C must not come out of half way: it is heard once they are done.

Compiled code that hands arrays or named tuples to Python: to make such an object numba calls Python, and there Ctrl-C
that came while the compiled code ran is heard: for an array it comes out as SystemError in place of KeyboardInterrupt,
for a named tuple the process dies (numba 0.68).  Compiled code that returns numbers, or fills arrays that it is given,
needs none of this.

The compiler: LLVM calls Python back to keep what it compiled, and there one Ctrl-C in four is lost, or comes out as a
RuntimeError, and seldom the process dies (llvmlite 0.50).

Source   none, own convention
Status   interrupts at random times within such calls (tests)
"""

from __future__ import annotations

import _signal  # type: ignore[import-not-found]
import math
import threading
from collections import deque
from collections.abc import Callable
from signal import SIGINT
from types import FrameType
from typing import Any

# What `signal` makes of these looks for an Enum of each handler: 10 microseconds a call, a tenth of a short run.
getsignal, signal = _signal.getsignal, _signal.signal


def uninterrupted(call: Callable[..., Any], *arguments: Any) -> Any:
    """What `call(*arguments)` returns.

    Raises:
        KeyboardInterrupt: Ctrl-C came in the meantime; raised after the call.  A second one is heard at once.
    """
    return _put_off(1, call, arguments)


def undisturbed(call: Callable[..., Any], *arguments: Any) -> Any:
    """The same for the compiler, which takes seconds: what is raised within it may be lost, or the process dies.

    Raises:
        KeyboardInterrupt: Ctrl-C came in the meantime, however often; raised after the call.
    """
    return _put_off(math.inf, call, arguments)


def _put_off(most: float, call: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """What the call returns; Ctrl-C is passed on after it, or at once if it comes more than so many times."""
    # Asked by number: `current_thread` makes an entry that stays for a thread that `threading` did not start.
    if threading.get_ident() != threading.main_thread().ident:
        return call(*arguments)
    usual = getsignal(SIGINT)
    if not callable(usual):
        return call(*arguments)
    came, arrived = deque[tuple[int, FrameType | None]](), 0
    raised: list[BaseException] = []  # within the call, which may make something else of it

    def pass_on() -> None:
        while came:
            usual(*came.popleft())

    def note(number: int, frame: FrameType | None) -> None:
        nonlocal arrived
        arrived += 1
        came.append((number, frame))
        if arrived > most:
            try:
                pass_on()
            except BaseException as error:
                raised.append(error)
                raise

    signal(SIGINT, note)
    try:
        return call(*arguments)
    except KeyboardInterrupt:
        raised.clear()
        raise
    finally:
        signal(SIGINT, usual)
        if raised:
            raise raised[0]
        pass_on()
