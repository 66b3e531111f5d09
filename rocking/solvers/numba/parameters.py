"""The parameters of a run in compiled code: functions of hooks that many runs share, and numbers out of tables.

The hooks find their numbers through pointers into the table, which costs nothing to hand on and needs no code for each
length.  Compiled code is kept on disk only if it holds no other compiled code (numba tells such apart by a number that
is drawn anew in every process), so that this is called by its name, and what it is follows from the types of its
arguments.

Source   none; numba's overloads
Status   batches are single runs, bit for bit, and a second process compiles nothing (tests)
"""

from __future__ import annotations

from typing import Any

from numba import types
from numba.core import cgutils
from numba.core.errors import RequireLiteralValue
from numba.extending import intrinsic, overload
from numba.np.arrayobj import make_array
from numba.np.unsafe import ndarray

from rocking.hybrid import Hooks

# An intrinsic, whose first argument numba gives.
to_fixed_tuple: Any = ndarray.to_fixed_tuple


def with_numbers(like: Any, numbers: Any, values: Any) -> Any:
    """The parameters `like` others, with the numbers of one run, shape (float,), and of its hooks, (slot, number).

    In compiled code the hooks' are pointers into the table, which has to outlive them.
    """
    floats = (float(number) for number in numbers)
    if len(numbers) == len(like):
        return type(like)(*floats)
    return type(like)(*floats, like.hooks._replace(values=tuple(tuple(map(float, row)) for row in values)))


@overload(with_numbers, jit_options={"error_model": "numpy"})
def _with_numbers(like, numbers, values):
    kind, floats = like.instance_class, sum(isinstance(part, types.Float) for part in like)
    if floats == len(like):

        def without(like, numbers, values):
            return kind(*to_fixed_tuple(numbers, floats))

        return without

    count = 2 * len(dict(zip(Hooks._fields, like.types[-1], strict=True))["accelerations"])

    def within(like, numbers, values):
        hooks = like.hooks
        rows = pointers_to_rows(values, count)
        own = Hooks(hooks.accelerations, hooks.restitutions, rows, hooks.pushing, hooks.striking)
        return kind(*to_fixed_tuple(numbers, floats), own)

    return within


@intrinsic
def _pointers_to_rows(_, values, count):
    """Pointers to the first number of each of the rows of a table, of which there have to be `count`."""

    def emit(context, builder, signature, arguments):
        table = make_array(signature.args[0])(context, builder, value=arguments[0])
        width = cgutils.unpack_tuple(builder, table.shape)[1]
        rows = [builder.gep(table.data, [builder.mul(width, width.type(i))]) for i in range(len(signature.return_type))]
        return context.make_tuple(builder, signature.return_type, rows)

    if not isinstance(count, types.IntegerLiteral):
        raise RequireLiteralValue(count)
    return types.UniTuple(types.CPointer(values.dtype), count.literal_value)(values, count), emit


pointers_to_rows: Any = _pointers_to_rows
