"""Many blocks at a time through the Taylor solver: the kernels, fed from tables and spread over threads.

Threads take portions of the runs in turn; each run is one thread's and one lane's, and gives the same bits wherever.

Source   as of `rocking.solvers.taylor`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rocking.hybrid import REST, ROTATION
from rocking.solvers.devices import label
from rocking.solvers.interrupts import uninterrupted
from rocking.solvers.piecewise.motion import piecewise_linear, ramped_sine
from rocking.solvers.taylor.columns import (
    COLUMNS,
    COUNT,
    ENDED,
    FINISHED,
    FIRST,
    LARGEST,
    LAST_MODE,
    OVERTURNED,
    OVERTURNING,
    SIDE,
)  # fmt: skip
from rocking.solvers.taylor.records import Samples, joined
from rocking.solvers.threads import over_pieces

Array = NDArray[np.float64]

PORTION = 1024
"""Runs that a thread takes at a time, at most."""


def carry_portions(
    form: str,
    record: Samples | None,
    part: Callable[[int, int], Sequence[Array]],
    count: int,
    max_events: int,
    workers: int | None = None,
) -> Array:
    """What became of each run, shape (count, COLUMNS).

    form: "linear" or "nonlinear"; record: None for sinusoids; part: gives the tables (pars, starts, motions) of the
    runs from the first number up to the second.
    """
    from rocking.solvers.taylor.entry import entry

    kernel = entry(f"{form}_{'wave' if record is None else 'record'}")
    rows, threads = np.empty((count, COLUMNS)), workers or os.cpu_count() or 1
    portion = max(64, min(PORTION, -(-count // (4 * threads))))

    def carry(first: int, stop: int) -> None:
        uninterrupted(kernel, *part(first, stop), *(record or ()), max_events, rows[first:stop], np.empty(0), 0)

    over_pieces(carry, [(first, min(first + portion, count)) for first in range(0, count, portion)], threads)
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
    systems: Sequence[Any],
    motions: Sequence[Any],
    states: Sequence[Any],
    t_span: tuple[float, float],
    max_events: int,
    device: Any = None,
    on_device: Callable[[Samples | None, Array, Array, Array, int, Any], Array] | None = None,
) -> dict[str, Any]:
    """The summary of every run, by name, as `rocking.solve_batch` asks a solver for it.

    Systems are of Method 1 and of one form; motions are ramped sinusoids or straight between samples, each as it likes.
    device, on_device: one of JAX, and what carries portions there; the compiled kernels if not given.

    Raises:
        ValueError: the systems are not of one form.
    """
    form = systems[0].form
    if any(system.form != form for system in systems):
        raise ValueError("systems: want them of one method and form in a batch")
    pars = np.array([parameter_row(system) for system in systems])
    starts = np.array([start_row(y, q, t_span) for y, q in states])
    rows = np.empty((len(systems), COLUMNS))
    for record, members, table in _by_kind(motions):
        own = [pars[members], starts[members], table]

        def part(first: int, stop: int, own: list[Array] = own) -> list[Array]:
            return [t[first:stop] for t in own]

        if on_device is None:
            rows[members] = carry_portions(form, record, part, len(members), max_events)
        else:
            rows[members] = on_device(record, own[0], own[1], own[2], max_events, device)
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
        "device": label(device),
    }


def _by_kind(motions: Sequence[Any]) -> list[tuple[Samples | None, NDArray[np.int64], Array]]:
    """(samples or None, which runs, their table of motions) for all sinusoids together and for all records together."""
    different = {id(motion): motion for motion in motions}
    waves = {key: wave for key, m in different.items() if (wave := ramped_sine(m)) is not None}
    records = {key: piecewise_linear(m) for key, m in different.items() if key not in waves}
    keys = np.array([id(motion) for motion in motions])
    on_wave = np.array([id(motion) in waves for motion in motions])
    parts: list[tuple[Samples | None, NDArray[np.int64], Array]] = []
    if waves:
        parts.append((None, np.flatnonzero(on_wave), np.array([waves[key] for key in keys[on_wave]])))
    for key, record in records.items():
        if record is None:
            raise ValueError(f"motions: {type(different[key]).__name__} is neither sinusoid nor record")
    if records:
        samples, rows = joined([record for record in records.values() if record is not None])
        number = {key: i for i, key in enumerate(records)}
        parts.append((samples, np.flatnonzero(~on_wave), rows[[number[key] for key in keys[~on_wave]]]))
    return parts
