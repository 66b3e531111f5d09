"""Which run is next: a counter that the threads of a loop over runs share.

Each thread calls the compiled loop once and takes run after run.  Such a call costs up to a millisecond, most of it to
hand over the functions that the loop is given: as much as ten runs over one swing of a block.

Source   none; an atomic addition gives each number once
Status   each of three million numbers once, on four threads (tests)
"""

from __future__ import annotations

from typing import Any

from numba import types
from numba.extending import intrinsic


def _take(typing_context, counter):
    """counter[0], which is raised by 1 in the same moment; counter: int64, shape (1,)."""

    def codegen(context, builder, signature, arguments):
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.atomic_rmw("add", array.data, context.get_constant(types.int64, 1), "monotonic")

    return types.int64(counter), codegen


take: Any = intrinsic(_take)
