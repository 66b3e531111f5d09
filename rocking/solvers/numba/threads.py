"""Compiled loops over runs, spread over the cores in threads.

The compiled code releases the interpreter lock.  numba's own parallel loops cannot take functions in a tuple (hooks)
and compile for longer; besides, what runs in pieces can be interrupted between them.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numba

PIECES_PER_THREAD = 8
"""So many pieces even out runs of different length."""

SHORTEST_PIECE = 4
"""Runs of a piece; fewer would not pay for handing them over."""


def over_runs(piece: Callable[[int, int], None], count: int) -> None:
    """Call `piece(first, last)` for pieces that cover 0 to `count`, on as many threads as numba is set to use."""
    threads = numba.get_num_threads()
    size = max(SHORTEST_PIECE, -(-count // (threads * PIECES_PER_THREAD)))
    bounds = [(first, min(first + size, count)) for first in range(0, count, size)]
    if threads == 1 or len(bounds) == 1:
        for first, last in bounds:
            piece(first, last)
        return
    with ThreadPoolExecutor(threads) as pool:
        futures = [pool.submit(piece, first, last) for first, last in bounds]
        try:
            for future in futures:
                future.result()
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise
