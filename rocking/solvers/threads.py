"""Compiled loops over runs, spread over the cores in threads, and stopped by Ctrl-C between two runs or pieces of them.

The compiled code releases the interpreter lock.  numba's own parallel loops cannot take functions in a tuple (hooks)
and compile for longer; besides, threads that take run after run, or piece after piece, can be stopped in between.

Work in which compiled loops and Python take turns is done side by side too (`side_by_side`): while one thread is in
compiled code another one has the interpreter.

The thread that calls waits without a lock of Python's: a KeyboardInterrupt between the taking of one, as a future has,
and the `with` that is to give it back leaves it taken, and then a worker waits for it, and the caller for the worker.
"""

from __future__ import annotations

import _thread
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

FEWEST_RUNS = 4
"""Of a thread; fewer would not pay for handing them over."""

FIRST_PIECE = 16
"""Runs after which one thread looks for Ctrl-C for the first time."""

LONG_ENOUGH = 0.05
"""Seconds between two such looks: after a shorter piece the next one is twice as large, after one of more than twice
as long half."""

SHORTEST_LOOK, LONGEST_LOOK = 5e-5, 2e-3
"""Seconds between two looks whether the other threads have ended; they grow as it takes longer."""

TURN = 5e-5
"""Seconds after which a thread side by side with others has to let one have the interpreter that comes out of compiled
code: the usual 5e-3 are longer than most calls of compiled code are."""

T = TypeVar("T")


class _Thread(threading.local):
    """What holds of the thread that asks: nothing, or that it is one of those side by side."""

    share: int | None = None  # cores for its compiled loops
    stopped: Sequence[object] = ()  # not empty once it is to end


_this = _Thread()


def _look() -> None:
    """KeyboardInterrupt where this thread is one of those side by side, and they are to end."""
    if _this.stopped:
        raise KeyboardInterrupt


def side_by_side(tasks: Sequence[Callable[[], T]], workers: int, threads: int) -> list[T]:
    """What the tasks return, in their order; they are called on so many threads, with one, or within one, on this one.

    Args:
        tasks: none may depend on another one.
        workers: threads of Python; as much of the work as is in Python is done by one at a time.
        threads: cores that compiled loops of all tasks together have.

    Raises:
        KeyboardInterrupt: Ctrl-C; tasks under way end after the run, or piece of runs, that they are at.
        Exception: what a task raised, of several that failed the first in time.
    """
    workers = min(workers, threads, len(tasks))
    if workers < 2 or _this.share is not None:
        return [task() for task in tasks]
    found: dict[int, T] = {}
    stopped: list[int] = []

    def some(first: int, last: int) -> None:
        _this.share, _this.stopped = threads // workers, stopped
        for k in range(first, last):
            _look()
            found[k] = tasks[k]()

    usual = sys.getswitchinterval()
    try:
        sys.setswitchinterval(TURN)
        over_pieces(some, [(k, k + 1) for k in range(len(tasks))], workers, lambda: stopped.append(1))
    finally:
        sys.setswitchinterval(usual)
    return [found[k] for k in range(len(tasks))]


def over_runs(work: Callable[[NDArray[np.int64], int], None], count: int, threads: int) -> None:
    """Have runs 0 to `count` done on so many threads; with one, on this one.

    Args:
        work: `work(counter, end)` takes from `counter`, int64, shape (1,), run after run below `end`, in a moment
            (`rocking.solvers.numba.counter.take`).

    Raises:
        KeyboardInterrupt: Ctrl-C; the runs under way are ended, with one thread those of a piece.
    """
    counter = np.zeros(1, dtype=np.int64)
    threads = min(threads, _this.share or threads, -(-count // FEWEST_RUNS))
    if threads > 1:
        over_pieces(
            lambda first, last: work(counter, count), [(0, count)] * threads, threads, lambda: counter.fill(count)
        )
        return
    begun, size = 0, FIRST_PIECE
    while begun < count:
        end, clock = min(begun + size, count), time.perf_counter()
        _look()
        work(counter, end)
        counter[0] = begun = end
        took = time.perf_counter() - clock
        size = 2 * size if took < LONG_ENOUGH else size if took < 2.0 * LONG_ENOUGH else max(size // 2, 1)


def over_pieces(
    piece: Callable[[int, int], None],
    bounds: Sequence[tuple[int, int]],
    threads: int,
    stop: Callable[[], None] = lambda: None,
) -> None:
    """Call `piece(first, last)` for all of `bounds`, on so many threads; with one, on this one.

    stop: ends the pieces under way; called, more than once perhaps, where no further one is to be begun.

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
            stop()

    def help_out() -> None:
        begun.append(1)
        if not closed:
            work()
        ended.append(1)

    def wait(for_all: bool) -> None:
        look = SHORTEST_LOOK
        while len(ended) < (count if for_all else len(begun)):
            if for_all:
                _look()
            time.sleep(look)
            look = min(1.5 * look, LONGEST_LOOK)

    # This thread only waits: what Ctrl-C raises within a call of compiled code may come out as another error.
    try:
        for _ in range(count):
            _thread.start_new_thread(help_out, ())
        wait(for_all=True)
    except BaseException:
        waiting.clear()
        stop()
        closed.append(1)  # who begins from here on does nothing
        wait(for_all=False)
        raise
    if failed:
        raise failed[0]
