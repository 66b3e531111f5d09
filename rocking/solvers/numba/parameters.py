"""The parameters of a run in compiled code: functions of hooks that many runs share, and numbers out of tables.

The hooks find their numbers through pointers into the table, which costs nothing to hand on and needs no code for each
length.  Compiled code is kept on disk only if it holds no other compiled code (numba tells such apart by a number that
is drawn anew in every process), so that this is called by its name, and what it is follows from the types of its
arguments.

Source   none; numba's overloads
Status   batches are single runs, bit for bit, and a second process compiles nothing (tests)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numba import types
from numba.core import cgutils
from numba.core.errors import RequireLiteralValue
from numba.extending import intrinsic, overload
from numba.np.arrayobj import make_array
from numba.np.unsafe import ndarray
from numpy.typing import NDArray

from rocking.hybrid import Hooks, System
from rocking.solvers.numba.functions import Size, compiled_parameters

# An intrinsic, whose first argument numba gives.
to_fixed_tuple: Any = ndarray.to_fixed_tuple


def shared_parameters(systems: Sequence[System], size: Size) -> tuple[Any, NDArray[np.float64], NDArray[np.float64]]:
    """The parameters of the first system, compiled; the numbers of each, and those of its hooks.

    Returns:
        parameters: with the hooks, which all systems share, and without their numbers.
        numbers: shape (system, size.floats).
        values: shape (system, 2 size.slots, number); of no length without hooks.

    Raises:
        ValueError: the systems have different hooks, or of different lengths.
    """
    first = systems[0].parameters
    numbers = np.array([s.parameters[: size.floats] for s in systems], dtype=np.float64)
    if size.slots == 0:
        return compiled_parameters(first), numbers, np.zeros((len(systems), 0, 0))
    each = [s.parameters.hooks for s in systems]
    if any(h._replace(values=()) != each[0]._replace(values=()) for h in each):
        raise ValueError("systems: want the same effects on the equations of motion and on the impact in a batch")
    if any(len(h.values[0]) != len(each[0].values[0]) for h in each):
        raise ValueError("systems: want effects with as many numbers each in a batch")
    return compiled_parameters(first), numbers, np.array([h.values for h in each], dtype=np.float64)


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
