"""The parameters of one run out of those of many, in compiled code.

The runs of a batch share their hooks, which are functions; what differs are numbers, which stand in tables.  Compiled
code is kept on disk only if it holds no other compiled code (numba tells such apart by a number that is drawn anew in
every process), so that this is called by its name, and what it is follows from the types of its arguments.

Source   none; numba's overloads
Status   batches are single runs, bit for bit, and a second process compiles nothing (tests)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numba import types
from numba.extending import overload
from numba.np.unsafe import ndarray
from numpy.typing import NDArray

from rocking.hybrid import Hooks, System
from rocking.solvers.numba.functions import Size, compiled_parameters

# An intrinsic, whose first argument numba gives.
to_fixed_tuple: Any = ndarray.to_fixed_tuple

SLOTS = 4
"""Hooks on the motion, and on the impact, that a batch has room for."""


def shared_parameters(systems: Sequence[System], size: Size) -> tuple[Any, NDArray[np.float64], NDArray[np.float64]]:
    """The parameters of the first system, compiled; the numbers of each, and those of its hooks.

    Returns:
        parameters: with the hooks, which all systems share.
        numbers: shape (system, size.floats).
        values: shape (system, 2 size.slots, size.width).

    Raises:
        ValueError: the systems have different hooks, or more than there is room for.
    """
    first = systems[0].parameters
    numbers = np.array([s.parameters[: size.floats] for s in systems], dtype=np.float64)
    if size.slots == 0:
        return compiled_parameters(first), numbers, np.zeros((len(systems), 0, 0))
    if size.slots != SLOTS:
        raise ValueError(f"effects: want at most {SLOTS} on the motion and {SLOTS} on the impact in a batch")
    each = [s.parameters.hooks for s in systems]
    if any(h._replace(values=()) != each[0]._replace(values=()) for h in each):
        raise ValueError("systems: want the same effects on the equations of motion and on the impact in a batch")
    if any(len(h.values[0]) != size.width for h in each):
        raise ValueError("systems: want effects with as many numbers each in a batch")
    return compiled_parameters(first), numbers, np.array([h.values for h in each], dtype=np.float64)


def with_numbers(like: Any, numbers: Any, values: Any) -> Any:
    """The parameters `like` others, with the numbers of one run, shape (float,), and of its hooks, (slot, number)."""
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

    # A tuple is as long as its type says, and numba writes none out by itself.
    width = len(dict(zip(Hooks._fields, like.types[-1], strict=True))["values"][0])

    def with_four(like, numbers, values):
        rows = (
            to_fixed_tuple(values[0], width), to_fixed_tuple(values[1], width), to_fixed_tuple(values[2], width),
            to_fixed_tuple(values[3], width), to_fixed_tuple(values[4], width), to_fixed_tuple(values[5], width),
            to_fixed_tuple(values[6], width), to_fixed_tuple(values[7], width),
        )  # fmt: skip
        hooks = like.hooks
        own = Hooks(hooks.accelerations, hooks.restitutions, rows, hooks.pushing, hooks.striking)
        return kind(*to_fixed_tuple(numbers, floats), own)

    return with_four
