"""The functions of a system and of a motion, compiled for one kind of state and kept for the process.

What single runs (`rocking.solvers.numba_events`) and batches (`rocking.solvers.numba_batch`) are made of.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from rocking.hybrid import Base, Discrete


@cache
def motion_function(kernel: Any) -> Any:
    """The motion's kernel compiled as (t, par) -> (a_x, a_z)."""
    from numba import types

    from rocking.solvers.numba_compile import bound

    f8 = types.float64
    return bound(kernel, 2, types.UniTuple(f8, 2)(f8, f8[::1]))


@cache
def system_functions(
    flow: Any, guards: Any, jump: Any, balance: Any, parameters: Any, n: int, n_par: int, n_guards: int
) -> tuple[tuple[Any, ...], Any]:
    """(flow, guards, jump, balance) compiled, and the loop compiled for them."""
    from numba import types

    from rocking.solvers import numba_kernel
    from rocking.solvers.numba_compile import bound, compiled, make_jitable

    f8, i8 = types.float64, types.int64
    row, state = f8[::1], types.UniTuple(f8, n)
    q = types.NamedTuple((i8, f8, f8), Discrete)
    base = types.NamedUniTuple(f8, 2, Base)
    par = types.NamedUniTuple(f8, n_par, parameters)
    signatures = (
        state(row, q, base, par),
        types.UniTuple(f8, n_guards)(row, q, base, par),
        types.Tuple((state, q))(row, q, base, par, i8),
        f8(row, par),
    )
    motion = types.UniTuple(f8, 2)(f8, row)
    functions = tuple(
        bound(function, arity, signature)
        for function, arity, signature in zip((flow, guards, jump, balance), (4, 4, 5, 2), signatures, strict=True)
    )
    pointers = [types.FunctionType(signature) for signature in (*signatures, motion)]
    arguments = (*pointers, row, q, par, row, row, f8, row, row, i8, i8, types.UniTuple(i8, 2))
    label = f"integrate_{parameters.__module__}_{parameters.__qualname__}".replace(".", "_")
    files = make_jitable(flow) | make_jitable(guards) | make_jitable(jump) | make_jitable(balance)
    loop = compiled(_copy(numba_kernel.integrate), arguments, label, files)
    return functions, loop


def _copy(function: Any) -> Any:
    """The same function as an object of its own, whose name may be changed."""
    return type(function)(function.__code__, function.__globals__, function.__name__)
