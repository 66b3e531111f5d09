"""Many runs at once, compiled and spread over the cores: what a map or a spectrum asks for.

Each run is that of `rocking.solvers.numba.solver`, bit for bit, whatever the number of cores; its summary is kept.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
from numba import get_num_threads, types
from numpy.typing import NDArray

from rocking.hybrid import REST, Discrete, System
from rocking.motion import BaseMotion, pitch_kernel
from rocking.solvers.numba import counter
from rocking.solvers.numba.compiling import compiled
from rocking.solvers.numba.functions import (
    Size,
    motion_function,
    parameter_type,
    shared_parameters,
    size_of,
    system_functions,
)
from rocking.solvers.numba.once import once
from rocking.solvers.recording import FELL, REACHED_END, segment_edges
from rocking.solvers.threads import over_runs
from rocking.trajectory import BALANCE

STATUS, T_END, OVERTURNING, THETA_END, PEAK, IMPACTS, ONSET, LAST_MODE = range(8)
COLUMNS = 8

State = tuple[tuple[float, ...], Discrete]


@once
def _loop_over_runs(functions: tuple[Any, ...], kind: Any, size: Size) -> Any:
    """The loop over runs; `functions` are flow, guards, jump, balance, motion and the loop of one run."""

    def batch(
        flow, guards, jump, balance, motion, run, y0, q0, like, numbers, values, mpars, edges, steps, tol, most,
        n_guards, is_impact, at, out, taken, end,
    ):  # fmt: skip
        i = counter.take(taken)
        while i < end:
            q = Discrete(int(q0[i, 0]), q0[i, 1], q0[i, 2])
            status, t, mode, _, peak, _, (times, codes, _, states) = run(
                flow, guards, jump, balance, motion, y0[i], q, like, numbers[i], values[i], mpars[i], edges[i],
                steps[i], tol, np.empty(0), most, n_guards, at,
            )  # fmt: skip
            overturning, onset, impacts = math.nan, math.nan, 0
            for k in range(times.size):
                if codes[k, 0] == BALANCE:
                    overturning = times[k]
                elif is_impact[codes[k, 0]]:
                    impacts += 1
                if math.isnan(onset) and codes[k, 1] == REST and codes[k, 2] != REST:
                    onset = times[k]
            theta = states[times.size - 1, 0, at[0]] if times.size > 0 else y0[i, at[0]]
            out[i, STATUS], out[i, T_END], out[i, OVERTURNING], out[i, THETA_END] = status, t, overturning, theta
            out[i, PEAK], out[i, IMPACTS], out[i, ONSET], out[i, LAST_MODE] = peak, impacts, onset, mode
            i = counter.take(taken)

    f8, i8 = types.float64, types.int64
    row, table = f8[::1], f8[:, ::1]
    pointers = [types.FunctionType(function.nopython_signatures[0]) for function in functions]
    flags, watched = types.boolean[::1], types.UniTuple(i8, 2)
    like = parameter_type(kind, size, numbers=False)
    arguments = (
        *pointers, table, table, like, table, f8[:, :, ::1], table, table, row, row, i8, i8, flags, watched, table,
        i8[::1], i8,
    )  # fmt: skip
    label = f"batch_{kind.__module__}_{kind.__qualname__}_{size.slots}".replace(".", "_")
    return compiled(batch, arguments, label, [str(sys.modules[kind.__module__].__file__)])


def _edges(motions: Sequence[BaseMotion], t_start: float, t_end: float) -> NDArray[np.float64]:
    """Edges of the smooth stretches of each motion, shape (run, edge); short rows are filled up with t_end."""
    rows = [segment_edges(motion, t_start, t_end) for motion in motions]
    table = np.full((len(rows), max(len(row) for row in rows)), t_end)
    for i, row in enumerate(rows):
        table[i, : len(row)] = row
    return table


def run_batch(
    systems: Sequence[System],
    motions: Sequence[BaseMotion],
    states: Sequence[State],
    t_span: tuple[float, float],
    *,
    rtol: float,
    atol: float,
    max_events: int,
) -> dict[str, NDArray[Any]]:
    """The summary of every run, by name, each of shape (run,): how it ended, times [s], angles [rad], impacts.

    Args:
        systems, motions, states: one for each run; the systems of one method and form, the motions of one kernel
            and one number of parameters.
        t_span: start and end [s].
        rtol, atol, max_events: as of `rocking.solve`.

    Raises:
        ValueError: the systems or the motions are not of one kind.
    """
    first, base = systems[0], motions[0]
    kind: Any = type(first.parameters)
    if any(s.flow is not first.flow or s.jump is not first.jump for s in systems):
        raise ValueError("systems: want them of one method and form in a batch")
    if any(
        m.kernel is not base.kernel
        or pitch_kernel(m) is not pitch_kernel(base)
        or len(m.parameters) != len(base.parameters)
        for m in motions
    ):
        raise ValueError("motions: want them of one kind, with as many parameters each, in a batch")
    y0 = np.array([y for y, _ in states], dtype=np.float64)
    names, n_guards, size = first.state_names, len(first.guard_names), size_of(first.parameters)
    functions, run = system_functions(
        first.flow, first.guards, first.jump, first.balance, kind, y0.shape[1], size, n_guards
    )
    every = (*functions, motion_function(base), run)
    loop = _loop_over_runs(every, kind, size)
    out = np.empty((len(systems), COLUMNS))
    arguments = (
        *every,
        y0,
        np.array([[q.mode, q.s, q.slip] for _, q in states], dtype=np.float64),
        *shared_parameters(systems, size),
        np.array([m.parameters for m in motions], dtype=np.float64),
        _edges(motions, *t_span),
        np.array([m.max_step for m in motions], dtype=np.float64),
        np.array([rtol, atol]),
        max_events,
        n_guards,
        np.array([name in ("impact", "landing", "contact") for name in first.guard_names]),
        (names.index("theta"), names.index("omega")),
        out,
    )
    over_runs(lambda taken, end: loop(*arguments, taken, end), len(systems), get_num_threads())
    return {
        "fell": out[:, STATUS] == FELL,
        "failed": ~np.isin(out[:, STATUS], (FELL, REACHED_END)),
        "t_end": out[:, T_END],
        "overturning_time": out[:, OVERTURNING],
        "theta_end": out[:, THETA_END],
        "peak_rotation": out[:, PEAK],
        "impacts": out[:, IMPACTS],
        "onset_time": out[:, ONSET],
        "last_mode": out[:, LAST_MODE],
    }
