"""Compiled loops over runs, spread over the cores in threads, and stopped by Ctrl-C between two pieces.

The compiled code releases the interpreter lock.  numba's own parallel loops cannot take functions in a tuple (hooks)
and compile for longer; besides, what runs in pieces can be interrupted between them.

The thread that calls waits without a lock of Python's: a KeyboardInterrupt between the taking of one, as a future has,
and the `with` that is to give it back leaves it taken, and then a worker waits for it, and the caller for the worker.
"""

from __future__ import annotations

import _thread
import time
from collections import deque
from collections.abc import Callable, Sequence

PIECES_PER_THREAD = 8
"""So many pieces even out runs of different length."""

SHORTEST_PIECE = 4
"""Runs of a piece; fewer would not pay for handing them over."""

SHORTEST_LOOK, LONGEST_LOOK = 5e-5, 2e-3
"""Seconds between two looks whether the other threads have ended; they grow as it takes longer."""


def over_runs(piece: Callable[[int, int], None], count: int, threads: int) -> None:
    """Call `piece(first, last)` for pieces that cover 0 to `count`, on so many threads."""
    size = max(SHORTEST_PIECE, -(-count // (threads * PIECES_PER_THREAD)))
    over_pieces(piece, [(first, min(first + size, count)) for first in range(0, count, size)], threads)


def over_pieces(piece: Callable[[int, int], None], bounds: Sequence[tuple[int, int]], threads: int) -> None:
    """Call `piece(first, last)` for all of `bounds`, on so many threads; with one, on this one.

    Raises:
        KeyboardInterrupt: Ctrl-C; the pieces under way are ended, the others not begun.  A second one does not wait.
        Exception: what the first piece that failed raised; so too.
    """
    count = min(threads, len(bounds))
    if count < 2:
        for first, last in bounds:
            piece(first, last)
        return
    waiting, failed = deque(bounds), list[BaseException]()
    begun, ended, closed = list[int](), list[int](), list[int]()

    def work() -> None:
        try:
            while True:
                try:
                    first, last = waiting.popleft()
                except IndexError:
                    return
                piece(first, last)
        except BaseException as error:
            failed.append(error)
            waiting.clear()

    def help_out() -> None:
        begun.append(1)
        if not closed:
            work()
        ended.append(1)

    def wait(for_all: bool) -> None:
        look = SHORTEST_LOOK
        while len(ended) < (count if for_all else len(begun)):
            time.sleep(look)
            look = min(1.5 * look, LONGEST_LOOK)

    # This thread only waits: what Ctrl-C raises within a call of compiled code may come out as another error.
    try:
        for _ in range(count):
            _thread.start_new_thread(help_out, ())
        wait(for_all=True)
    except BaseException:
        waiting.clear()
        closed.append(1)  # who begins from here on does nothing
        wait(for_all=False)
        raise
    if failed:
        raise failed[0]
