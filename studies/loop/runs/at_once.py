"""Fits that do not depend on each other, done at once.

About half of a fit is compiled runs, which are spread over the cores, and half is Python, which one thread at a time
does: two fits at once keep two cores busy, and more at once would wait for each other.

Source   none, own convention
Status   what comes out is the same to the last digit (tests)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from numba import get_num_threads

from rocking.solvers.threads import side_by_side

T = TypeVar("T")

AT_ONCE = 2
"""Fits at once."""


def at_once(tasks: Sequence[Callable[[], T]]) -> list[T]:
    """What the tasks return, in their order, none of which depends on another one.

    Raises:
        KeyboardInterrupt: Ctrl-C, after the runs that are under way.
        Exception: what a task raised, of several that failed the first in time.
    """
    return side_by_side(tasks, AT_ONCE, get_num_threads())
