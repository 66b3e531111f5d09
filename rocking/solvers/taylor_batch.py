"""Many blocks at a time through the Taylor solver: the kernels, fed from tables and spread over threads.

Threads take portions of the runs in turn; each run is one thread's and one lane's, and gives the same bits wherever.

Source   as of `rocking.solvers.taylor`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rocking.hybrid import REST, ROTATION
from rocking.solvers.exact_motion import piecewise_linear, ramped_sine

Array = NDArray[np.float64]

PORTION = 1024
"""Runs that a thread takes at a time, at most."""

OVERTURNED, SIDE, OVERTURNING, LARGEST, COUNT, FINISHED, ENDED, FIRST, LAST_MODE = range(9)
"""Columns of what comes back of each run, as in `rocking.solvers.taylor_turns`."""

COLUMNS = 9


def record_arguments(head: Array, values: Array) -> tuple[Array, Array, Array]:
    """What the kernels take for a record: its samples and two zeros, the largest of each block, (t_first, dt)."""
    from rocking.solvers.exact_kernel import BLOCK

    # One sample alone is an instant, in which nothing happens.
    padded = np.concatenate([values if values.size > 1 else np.zeros(2), np.zeros(2)])
    whole = np.concatenate([padded, np.zeros(-padded.size % BLOCK)])
    return padded, np.abs(whole).reshape(-1, BLOCK).max(axis=1), np.ascontiguousarray(head, dtype=np.float64)


def carry_portions(
    form: str,
    record: tuple[Array, Array, Array] | None,
    part: Callable[[int, int], Sequence[Array]],
    count: int,
    max_events: int,
    workers: int | None = None,
) -> Array:
    """What became of each run, shape (count, COLUMNS).

    form: "linear" or "nonlinear"; record: of `record_arguments`, None for sinusoids; part: gives the tables (pars,
    starts, motions) of the runs from the first number up to the second.
    """
    from rocking.solvers.taylor_entry import entry

    kernel = entry(f"{form}_{'wave' if record is None else 'record'}")
    rows, threads = np.empty((count, COLUMNS)), workers or os.cpu_count() or 1
    portion = max(64, min(PORTION, -(-count // (4 * threads))))

    def carry(first: int) -> None:
        stop = min(first + portion, count)
        kernel(*part(first, stop), *(record or ()), max_events, rows[first:stop], np.empty(0), 0)

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(carry, range(0, count, portion)))
    return rows


def start_rows(theta: Array, omega: Array, t_start: Array, t_end: Array) -> Array:
    """(mode, s, s theta, s omega, t_start, t_end) of blocks released or at rest."""
    leans = np.where(theta != 0.0, theta, omega)
    s = np.where(leans < 0.0, -1.0, 1.0)
    mode = np.where(leans == 0.0, float(REST), float(ROTATION))
    return np.ascontiguousarray(np.stack([mode, s, s * theta, s * omega, t_start, t_end], axis=1))


def parameter_row(system: Any) -> tuple[float, ...]:
    """(p^2, alpha, g, onset, e, omega_rest) of a Method 1."""
    par = system.parameters
    return tuple(float(v) for v in (par.p2, par.alpha, par.g, par.onset, par.e, par.omega_rest))


def start_row(y: Any, q: Any, t_span: tuple[float, float]) -> tuple[float, ...]:
    """(mode, s, s theta, s omega, t_start, t_end) of a state of Method 1.

    Raises:
        ValueError: the mode is none of Method 1's.
    """
    if int(q.mode) not in (REST, ROTATION):
        raise ValueError(f"initial: mode {int(q.mode)} is none of Method 1's; want {REST} or {ROTATION}")
    s = float(q.s)
    return float(q.mode), s, s * float(y[0]), s * float(y[1]), *t_span


def run_batch(
    systems: Sequence[Any], motions: Sequence[Any], states: Sequence[Any], t_span: tuple[float, float], max_events: int
) -> dict[str, NDArray[Any]]:
    """The summary of every run, by name, as `rocking.solve_batch` asks a solver for it.

    Systems are of Method 1 and of one form; motions are ramped sinusoids or straight between samples, each as it likes.

    Raises:
        ValueError: the systems are not of one form.
    """
    form = systems[0].form
    if any(system.form != form for system in systems):
        raise ValueError("systems: want them of one method and form in a batch")
    pars = np.array([parameter_row(system) for system in systems])
    starts = np.array([start_row(y, q, t_span) for y, q in states])
    rows = np.empty((len(systems), COLUMNS))
    for record, members, table in _by_motion(motions):
        own = [pars[members], starts[members], table]

        def part(first: int, stop: int, own: list[Array] = own) -> list[Array]:
            return [t[first:stop] for t in own]

        rows[members] = carry_portions(form, record, part, len(members), max_events)
    fell = rows[:, OVERTURNED] > 0.0
    return {
        "fell": fell,
        "failed": rows[:, FINISHED] == 0.0,
        "t_end": rows[:, ENDED],
        "overturning_time": np.where(fell, rows[:, OVERTURNING], np.nan),
        "theta_end": rows[:, SIDE],
        "peak_rotation": rows[:, LARGEST],
        "impacts": rows[:, COUNT],
        "onset_time": rows[:, FIRST],
        "last_mode": rows[:, LAST_MODE],
    }


def _by_motion(motions: Sequence[Any]) -> list[tuple[Any, NDArray[np.int64], Array]]:
    """(record or None, which runs, their table of motions) for all sinusoids together and for each record."""
    groups: dict[int, list[int]] = {}
    waves: dict[int, Any] = {}
    for i, motion in enumerate(motions):
        if id(motion) not in waves:
            waves[id(motion)] = ramped_sine(motion)
        groups.setdefault(0 if waves[id(motion)] is not None else id(motion), []).append(i)
    parts: list[tuple[Any, NDArray[np.int64], Array]] = []
    for key, numbers in groups.items():
        members = np.array(numbers)
        if key == 0:
            parts.append((None, members, np.array([waves[id(motions[i])] for i in numbers])))
            continue
        record = piecewise_linear(motions[numbers[0]])
        if record is None:
            raise ValueError(f"motions: {type(motions[numbers[0]]).__name__} is neither sinusoid nor record")
        parts.append((record_arguments(*record), members, np.ones((len(numbers), 2))))
    return parts
