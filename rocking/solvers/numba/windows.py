"""Many runs at once with their samples: what fitting to measured records asks for.

The runs share systems and motions by index, so that a record cut into windows, under many sets of parameters, costs no
more memory than its parts.  Each run is that of `rocking.solvers.numba.solver`, bit for bit.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numba import get_num_threads, types
from numpy.typing import NDArray

from rocking.hybrid import Discrete, System
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

Array = NDArray[np.float64]


class Start(NamedTuple):
    """One run: which system under which motion, from where to where, and from what state."""

    system: int  # index
    motion: int  # index
    t_start: float  # [s]
    t_end: float  # [s]
    y: tuple[float, ...]
    q: Discrete


@dataclass(frozen=True)
class Samples:
    """States of all runs at the times asked for, one run after the other; NaN after the end of a run."""

    y: Array  # shape (sample, state)
    mode: NDArray[np.int64]  # shape (sample,)
    s: Array  # carrying side, shape (sample,)
    fell: NDArray[np.bool_]  # shape (run,)
    failed: NDArray[np.bool_]  # shape (run,)
    t_end: Array  # when each run ended [s], shape (run,)
    overturning_time: Array  # last outward passage of the tilt of unstable balance [s], NaN if none, shape (run,)


@once
def _loop(functions: tuple[Any, ...], kind: Any, size: Size) -> Any:
    """The loop over runs; `functions` are flow, guards, jump, balance, motion and the loop of one run."""

    def windows(
        flow, guards, jump, balance, motion, run, index, y0, q0, like, numbers, values, mpars, edges, steps, tol, times,
        first, most, n_guards, at, y, mode, s, ends, taken, end,
    ):  # fmt: skip
        i = counter.take(taken)
        while i < end:
            q = Discrete(int(q0[i, 0]), q0[i, 1], q0[i, 2])
            system, base = index[i, 0], index[i, 1]
            status, t, _, _, _, saved, (events, codes, _, _) = run(
                flow, guards, jump, balance, motion, y0[i], q, like, numbers[system], values[system], mpars[base],
                edges[i], steps[base], tol, times[first[i] : first[i + 1]], most, n_guards, at,
            )  # fmt: skip
            count = saved[0].shape[0]
            y[first[i] : first[i] + count] = saved[0]
            mode[first[i] : first[i] + count] = saved[1]
            s[first[i] : first[i] + count] = saved[2]
            ends[i, 0], ends[i, 1] = status, t
            for k in range(events.size):
                if codes[k, 0] == -1:
                    ends[i, 2] = events[k]
            i = counter.take(taken)

    f8, i8 = types.float64, types.int64
    row, table = f8[::1], f8[:, ::1]
    pointers = [types.FunctionType(function.nopython_signatures[0]) for function in functions]
    like = parameter_type(kind, size, numbers=False)
    arguments = (
        *pointers, i8[:, ::1], table, table, like, table, f8[:, :, ::1], table, table, row, row, row, i8[::1], i8, i8,
        types.UniTuple(i8, 2), table, i8[::1], row, table, i8[::1], i8,
    )  # fmt: skip
    label = f"windows_{kind.__module__}_{kind.__qualname__}_{size.slots}".replace(".", "_")
    return compiled(windows, arguments, label, [str(sys.modules[kind.__module__].__file__)])


def _rows(arrays: Sequence[Array], fill: float) -> Array:
    """Arrays of different lengths as rows of a table, filled up."""
    table = np.full((len(arrays), max(1, *(len(a) for a in arrays)) if arrays else 1), fill)
    for i, array in enumerate(arrays):
        table[i, : len(array)] = array
    return table


def _edges(starts: Sequence[Start], motions: Sequence[BaseMotion]) -> Array:
    breakpoints = [motion.breakpoints for motion in motions]
    if not any(start.t_start < t < start.t_end for start in starts for t in breakpoints[start.motion]):
        return np.array([(start.t_start, start.t_end) for start in starts], dtype=np.float64)
    rows = [segment_edges(motions[start.motion], start.t_start, start.t_end) for start in starts]
    table = np.empty((len(rows), max(len(row) for row in rows)))
    for i, row in enumerate(rows):
        table[i, : len(row)] = row
        table[i, len(row) :] = row[-1]
    return table


def run_windows(
    systems: Sequence[System],
    motions: Sequence[BaseMotion],
    starts: Sequence[Start],
    save_at: Sequence[Array],
    *,
    rtol: float = 1e-9,
    atol: float = 1e-12,
    max_events: int = 100_000,
) -> Samples:
    """The states of every run at its times.

    Args:
        systems: of one method, with the same hooks.
        motions: of one kernel; their parameters may differ in number where the kernel allows it.
        starts: the runs.
        save_at: times [s] of each run, ascending and within it.
        rtol, atol, max_events: as of `rocking.solve`.

    Raises:
        ValueError: the systems or the motions are not of one kind.
    """
    first, base = systems[0], motions[0]
    kind: Any = type(first.parameters)
    if any(s.flow is not first.flow or s.jump is not first.jump for s in systems):
        raise ValueError("systems: want them of one method and form")
    if any(m.kernel is not base.kernel or pitch_kernel(m) is not pitch_kernel(base) for m in motions):
        raise ValueError("motions: want them of one kind")
    n_guards, size = len(first.guard_names), size_of(first.parameters)
    n = len(first.state_names)
    functions, run = system_functions(first.flow, first.guards, first.jump, first.balance, kind, n, size, n_guards)
    every = (*functions, motion_function(base), run)
    offsets = np.concatenate([[0], np.cumsum([len(times) for times in save_at])]).astype(np.int64)
    y, mode, s = np.full((offsets[-1], n), np.nan), np.full(offsets[-1], -1, np.int64), np.full(offsets[-1], np.nan)
    ends = np.full((len(starts), 3), np.nan)
    loop = _loop(every, kind, size)
    arguments = (
        *every,
        np.array([(start.system, start.motion) for start in starts], dtype=np.int64),
        np.array([start.y for start in starts], dtype=np.float64),
        np.array([(start.q.mode, start.q.s, start.q.slip) for start in starts], dtype=np.float64),
        *shared_parameters(systems, size),
        _rows([np.asarray(m.parameters, dtype=np.float64) for m in motions], 0.0),
        _edges(starts, motions),
        np.array([m.max_step for m in motions], dtype=np.float64),
        np.array([rtol, atol]),
        np.ascontiguousarray(np.concatenate([np.asarray(t, np.float64) for t in save_at])),
        offsets,
        max_events,
        n_guards,
        (first.state_names.index("theta"), first.state_names.index("omega")),
        y,
        mode,
        s,
        ends,
    )
    over_runs(lambda taken, end: loop(*arguments, taken, end), len(starts), get_num_threads())
    status = ends[:, 0]
    return Samples(y, mode, s, status == FELL, ~np.isin(status, (FELL, REACHED_END)), ends[:, 1], ends[:, 2])
