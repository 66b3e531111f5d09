"""The functions of a system and of a motion, compiled for one kind of state and kept for the process; their parameters.

What single runs (`rocking.solvers.numba.solver`) and batches (`rocking.solvers.numba.batch`) are made of.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rocking.hybrid import Base, Discrete, Hooks, System
from rocking.motion import BaseMotion, pitch_kernel
from rocking.solvers.numba.once import once


class Size(NamedTuple):
    """Sizes of the parameters of a system."""

    floats: int
    slots: int  # for hooks on the flow, and as many on the impact; 0 for a system without hooks


def motion_function(motion: BaseMotion) -> Any:
    """The motion compiled as (t, par) -> (a_x, a_z, pitch, pitch acceleration)."""
    return _motion_function(motion.kernel, pitch_kernel(motion))


@once
def _motion_function(kernel: Any, pitch: Any) -> Any:
    from numba import types

    from rocking.solvers.numba.compiling import bound_motion

    f8 = types.float64
    return bound_motion(kernel, pitch, types.UniTuple(f8, 4)(f8, f8[::1]))


def compiled_parameters(par: Any) -> Any:
    """The parameters of a system as compiled functions take them: floats, and hooks as pointers, but for their numbers.

    What these are a run is told beside it (`rocking.solvers.numba.parameters`).
    """
    numbers = [float(value) for name, value in zip(par._fields, par, strict=True) if name != "hooks"]
    return type(par)(*numbers, compiled_hooks(par.hooks)) if hasattr(par, "hooks") else type(par)(*numbers)


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


def compiled_hooks(hooks: Hooks) -> Hooks:
    """The functions of the hooks compiled, without their numbers."""
    accelerations = tuple(_hook(function, 5) for function in hooks.accelerations)
    restitutions = tuple(_hook(function, 4) for function in hooks.restitutions)
    swing = (np.float64(0.1), np.float64(0.1), np.float64(1.0))
    for function, row in zip((*hooks.accelerations, *hooks.restitutions), hooks.values, strict=True):
        _check_reach(function, swing if function in hooks.restitutions else (*swing, Base(0.0, 0.0, 0.0, 0.0)), row)
    return hooks._replace(accelerations=accelerations, restitutions=restitutions, values=())


_within_reach: set[tuple[Any, int]] = set()


def _check_reach(function: Any, arguments: tuple[Any, ...], row: Sequence[float]) -> None:
    """ValueError where a hook takes a number beyond its own: compiled code would go on reading what lies behind."""
    if (function, len(row)) in _within_reach:
        return
    try:
        with np.errstate(all="ignore"):
            function(np, *arguments, tuple(map(np.float64, row)))
    except IndexError:
        name = f"{function.__module__}.{function.__qualname__}"
        raise ValueError(f"{name}: takes a number beyond the {len(row)} that there are of its effect") from None
    _within_reach.add((function, len(row)))


def _hook_signature(arity: int) -> Any:
    """Of an acceleration (theta, omega, s, base, values), or of a restitution (e, omega, s, values)."""
    from numba import types

    f8 = types.float64
    base = (types.NamedUniTuple(f8, 4, Base),) if arity == 5 else ()
    return f8(f8, f8, f8, *base, types.CPointer(f8))


@once
def _hook(function: Any, arity: int) -> Any:
    from rocking.solvers.numba.compiling import bound

    return bound(function, arity, _hook_signature(arity))


def parameter_type(kind: Any, size: Size, numbers: bool = True) -> Any:
    """numba's type of the parameters: floats, then hooks if there are any slots for them.

    numbers: with those of the hooks, a pointer to the first of each.  A tuple of them all would be handed from function
    to function number by number: most of what there is to compile, and code anew for each length; of arrays, threads
    would count references to memory that they share.
    """
    from numba import types

    # Pointers to functions are told apart by how their types are written, and that is without the module: the
    # Parameters of two methods with as many numbers would be one.
    kind.__name__ = f"{kind.__module__}.{kind.__qualname__}"
    f8 = types.float64
    if size.slots == 0:
        return types.NamedUniTuple(f8, size.floats, kind)
    pointers = [types.UniTuple(types.FunctionType(_hook_signature(arity)), size.slots) for arity in (5, 4)]
    values = types.UniTuple(types.CPointer(f8), 2 * size.slots) if numbers else types.Tuple(())
    hooks = types.NamedTuple((*pointers, values, types.int64, types.int64), Hooks)
    return types.NamedTuple((*(f8,) * size.floats, hooks), kind)


def size_of(par: Any) -> Size:
    """How many floats and slots for hooks the parameters of a system have."""
    hooks = getattr(par, "hooks", None)
    return Size(len(par), 0) if hooks is None else Size(len(par) - 1, len(hooks.accelerations))


@once
def system_functions(
    flow: Any, guards: Any, jump: Any, balance: Any, parameters: Any, n: int, size: Size, n_guards: int
) -> tuple[tuple[Any, ...], Any]:
    """(flow, guards, jump, balance) compiled, and the loop compiled for them."""
    from numba import types

    from rocking.solvers.numba import kernel
    from rocking.solvers.numba.compiling import bound, compiled, make_jitable

    f8, i8 = types.float64, types.int64
    row, state = f8[::1], types.UniTuple(f8, n)
    q = types.NamedTuple((i8, f8, f8), Discrete)
    base = types.NamedUniTuple(f8, 4, Base)
    par = parameter_type(parameters, size)
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
    like = parameter_type(parameters, size, numbers=False)
    arguments = (*pointers, row, q, like, row, f8[:, ::1], row, row, f8, row, row, i8, i8, types.UniTuple(i8, 2))
    label = f"integrate_{parameters.__module__}_{parameters.__qualname__}_{size.slots}".replace(".", "_")
    files = make_jitable(flow) | make_jitable(guards) | make_jitable(jump) | make_jitable(balance)
    loop = compiled(_copy(kernel.integrate), arguments, label, files)
    return functions, loop


def _copy(function: Any) -> Any:
    """The same function as an object of its own, whose name may be changed."""
    return type(function)(function.__code__, function.__globals__, function.__name__)
