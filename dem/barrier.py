"""Workers wait for each other between the stages of a step, in compiled code.

Source  none; a worker raises its own counter and waits until all others have raised theirs
Status  runs with one and two workers give the same bits (tests)

A stage takes microseconds, too short for a pool of threads to be told of each. Whoever waits longer lets other threads
have the core.
"""

from __future__ import annotations

import os

from numba import types
from numba.extending import intrinsic

from dem.compiled import inner

APART = 16  # counters lie this many places apart, on cache lines of their own
PATIENCE = 1000  # looks at a counter before the core is given away


@intrinsic
def _read(typing_context, cells, index):
    """cells[index], seen with all that was written before it was set."""

    def generate(context, builder, signature, arguments):
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.load_atomic(builder.gep(array.data, [arguments[1]]), "acquire", 8)

    return types.int64(cells, types.int64), generate


@intrinsic
def _write(typing_context, cells, index, value):
    """cells[index] = value, with all that was written before it."""

    def generate(context, builder, signature, arguments):
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        builder.store_atomic(arguments[2], builder.gep(array.data, [arguments[1]]), "release", 8)
        return context.get_dummy_value()

    return types.void(cells, types.int64, types.int64), generate


if os.name == "posix":
    _yield_core = types.ExternalFunction("sched_yield", types.int32())

    @inner
    def _rest():
        _yield_core()

else:

    @inner
    def _rest():
        pass


@inner
def wait_for_all(counters, worker, workers):
    """Return when all workers have come here as often as this one; counters: int64, shape (workers * APART,)."""
    if workers == 1:
        return
    mine = counters[worker * APART] + 1
    _write(counters, worker * APART, mine)  # type: ignore[call-arg]
    for other in range(workers):
        looks = 0
        while _read(counters, other * APART) < mine:
            looks += 1
            if looks == PATIENCE:
                looks = 0
                _rest()
