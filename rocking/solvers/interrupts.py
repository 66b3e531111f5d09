"""Calls of compiled code that hand arrays or named tuples to Python: Ctrl-C is heard once they are handed over.

To make such an object numba calls Python, and there Ctrl-C that came while the compiled code ran is heard: for an array
it comes out as SystemError in place of KeyboardInterrupt, for a named tuple the process dies (numba 0.68).  Compiled
code that returns numbers, or fills arrays that it is given, needs none of this.

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


def handed_over(compiled: Callable[..., Any], *arguments: Any) -> Any:
    """What `compiled(*arguments)` returns.

    Raises:
        KeyboardInterrupt: Ctrl-C came in the meantime; raised after the call.  A second one is heard at once, as while
            the function is compiled.
    """
    # Asked by number: `current_thread` makes an entry that stays for a thread that `threading` did not start.
    if threading.get_ident() != threading.main_thread().ident:
        return compiled(*arguments)
    usual = getsignal(SIGINT)
    if not callable(usual):
        return compiled(*arguments)
    came: list[tuple[int, FrameType | None]] = []

    def note(number: int, frame: FrameType | None) -> None:
        came.append((number, frame))
        if len(came) == 2:
            usual(*came[0])
        if len(came) > 1:
            usual(number, frame)

    signal(SIGINT, note)
    try:
        return compiled(*arguments)
    finally:
        signal(SIGINT, usual)
        if len(came) == 1:
            usual(*came[0])
