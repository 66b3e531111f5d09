"""The functions of a system and of a motion, compiled for one kind of state and kept for the process.

What single runs (`rocking.solvers.numba_events`) and batches (`rocking.solvers.numba_batch`) are made of.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from rocking.hybrid import Base, Discrete, Hooks
from rocking.motion import BaseMotion, pitch_kernel


def motion_function(motion: BaseMotion) -> Any:
    """The motion compiled as (t, par) -> (a_x, a_z, pitch, pitch acceleration)."""
    return _motion_function(motion.kernel, pitch_kernel(motion))


@cache
def _motion_function(kernel: Any, pitch: Any) -> Any:
    from numba import types

    from rocking.solvers.numba_compile import bound_motion

    f8 = types.float64
    return bound_motion(kernel, pitch, types.UniTuple(f8, 4)(f8, f8[::1]))


def compiled_parameters(par: Any) -> Any:
    """The parameters of a system as compiled functions take them: floats, and hooks as pointers."""
    numbers = [float(value) for name, value in zip(par._fields, par, strict=True) if name != "hooks"]
    if not hasattr(par, "hooks"):
        return type(par)(*numbers)
    hooks = par.hooks
    return type(par)(*numbers, compiled_hooks(hooks)._replace(values=np.ascontiguousarray(hooks.values, np.float64)))


def compiled_hooks(hooks: Hooks) -> Hooks:
    """The functions of the hooks compiled; the values as they are."""
    accelerations = tuple(_hook(function, 5) for function in hooks.accelerations)
    return Hooks(accelerations, tuple(_hook(function, 4) for function in hooks.restitutions), hooks.values)


def _hook_signature(arity: int) -> Any:
    """Of an acceleration (theta, omega, s, base, values), or of a restitution (e, omega, s, values)."""
    from numba import types

    f8 = types.float64
    base = (types.NamedUniTuple(f8, 4, Base),) if arity == 5 else ()
    return f8(f8, f8, f8, *base, f8[::1])


@cache
def _hook(function: Any, arity: int) -> Any:
    from rocking.solvers.numba_compile import bound

    return bound(function, arity, _hook_signature(arity))


def parameter_type(kind: Any, n_par: int, slots: int) -> Any:
    """numba's type of the parameters: n_par floats, then hooks if there are any slots for them."""
    from numba import types

    f8 = types.float64
    if slots == 0:
        return types.NamedUniTuple(f8, n_par, kind)
    pointers = [types.UniTuple(types.FunctionType(_hook_signature(arity)), slots) for arity in (5, 4)]
    hooks = types.NamedTuple((*pointers, f8[:, ::1]), Hooks)
    return types.NamedTuple((*(f8,) * n_par, hooks), kind)


def shape_of(par: Any) -> tuple[int, int]:
    """(number of floats, slots for hooks) of the parameters of a system."""
    hooks = getattr(par, "hooks", None)
    return (len(par), 0) if hooks is None else (len(par) - 1, len(hooks.accelerations))


@cache
def system_functions(
    flow: Any, guards: Any, jump: Any, balance: Any, parameters: Any, n: int, n_par: int, slots: int, n_guards: int
) -> tuple[tuple[Any, ...], Any]:
    """(flow, guards, jump, balance) compiled, and the loop compiled for them."""
    from numba import types

    from rocking.solvers import numba_kernel
    from rocking.solvers.numba_compile import bound, compiled, make_jitable

    f8, i8 = types.float64, types.int64
    row, state = f8[::1], types.UniTuple(f8, n)
    q = types.NamedTuple((i8, f8, f8), Discrete)
    base = types.NamedUniTuple(f8, 4, Base)
    par = parameter_type(parameters, n_par, slots)
    signatures = (
        state(row, q, base, par),
        types.UniTuple(f8, n_guards)(row, q, base, par),
        types.Tuple((state, q))(row, q, base, par, i8),
        f8(row, par),
    )
    motion = types.UniTuple(f8, 4)(f8, row)
    functions = tuple(
        bound(function, arity, signature)
        for function, arity, signature in zip((flow, guards, jump, balance), (4, 4, 5, 2), signatures, strict=True)
    )
    pointers = [types.FunctionType(signature) for signature in (*signatures, motion)]
    arguments = (*pointers, row, q, par, row, row, f8, row, row, i8, i8, types.UniTuple(i8, 2))
    label = f"integrate_{parameters.__module__}_{parameters.__qualname__}_{slots}".replace(".", "_")
    files = make_jitable(flow) | make_jitable(guards) | make_jitable(jump) | make_jitable(balance)
    loop = compiled(_copy(numba_kernel.integrate), arguments, label, files)
    return functions, loop


def _copy(function: Any) -> Any:
    """The same function as an object of its own, whose name may be changed."""
    return type(function)(function.__code__, function.__globals__, function.__name__)
