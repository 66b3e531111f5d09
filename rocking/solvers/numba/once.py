"""What is compiled is compiled once in a process, also where two threads ask for it at the same time.

Source   none, own convention
Status   threads that ask at the same time get one and the same (tests)
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any

from rocking.solvers.interrupts import undisturbed


def once(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, called once for the same arguments: `functools.cache` would call it in each thread that asks.

    What compiled code is made of is told apart by identity, so that a second one would be compiled for again.
    """
    known: dict[tuple[Any, ...], Any] = {}

    def make(arguments: tuple[Any, ...]) -> None:
        from numba.core.compiler_lock import global_compiler_lock

        # The compiler takes this lock itself: with another one two threads might wait for each other.
        with global_compiler_lock:
            if arguments not in known:
                known[arguments] = function(*arguments)

    @wraps(function)
    def asked(*arguments: Any) -> Any:
        if arguments not in known:
            undisturbed(make, arguments)  # Ctrl-C would leave the lock taken
        return known[arguments]

    return asked
