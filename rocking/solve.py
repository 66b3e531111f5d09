"""The one public verb: carry a block through a base motion.

>>> from rocking import Block, Method1, solve
>>> free = solve(Method1(Block(b=0.2, h=0.8), g=9.81), theta=0.122, t_end=2.0, solver="scipy")
>>> len(free.impact_times) >= 4
True
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from rocking.arguments import array_of, check_kinds, check_start, check_tilt
from rocking.effect import Effect
from rocking.hybrid import Discrete, System
from rocking.motion import BaseMotion, Still, pitch_kernel
from rocking.solvers import load
from rocking.trajectory import Trajectory
from rocking.validation import positive, real

DEFAULT_SAMPLES = 1001
"""Samples of a trajectory when no times are asked for."""


def solve(
    system: System,
    motion: BaseMotion | None = None,
    *,
    t_end: float,
    t_start: float = 0.0,
    theta: float = 0.0,
    omega: float = 0.0,
    initial: tuple[tuple[float, ...], Discrete] | None = None,
    solver: str = "numba",
    rtol: float = 1e-9,
    atol: float = 1e-12,
    save_at: ArrayLike | None = None,
    max_events: int = 1_000_000,
    effects: Sequence[Effect] = (),
) -> Trajectory:
    """Carry a block from `t_start` to its fall or to `t_end`.

    Args:
        system: the block under a method: `Method1(...)` or `Method2(...)`.
        motion: what the base does; at rest if not given.
        t_end, t_start: times [s].
        theta, omega: rotation [rad] and angular velocity [rad/s] at the start; at rest and upright if not given.
        initial: state (y, q) at the start, in place of theta and omega, from `initial_state(...)` of the system, or of
            `rocking.effects.compose(system, effects)` where there are effects: its states may be others, and its
            corners elsewhere.
        solver: name of a solver of the entry-point group `rocking.solvers`.
        rtol, atol: relative and absolute tolerance [SI units of the state] of a step.
        save_at: times [s], ascending, shape (time,), at which the state is kept; 1001 equal steps if not given.
        max_events: the run ends as failed when it has more events.
        effects: what the ideal block lacks, of `rocking.effects`.

    Returns:
        Trajectory: samples, events and outcome.  A run that cannot go on ends with `Outcome.FAILED` and a `reason`.

    Raises:
        ValueError: an argument is out of range, the solver is unknown, or it declines the system or the motion, or the
            system cannot carry an effect.
    """
    if not math.isfinite(real(t_start)):
        raise ValueError(f"t_start={t_start!r}: want a finite number")
    if not (math.isfinite(real(t_end)) and t_end > t_start):
        raise ValueError(f"t_end={t_end!r} s: want a time after t_start={t_start!r} s")
    check_start(theta, omega)
    positive("rtol", rtol, "1")
    positive("atol", atol, "SI units of the state")
    if not real(max_events) >= 1.0:
        raise ValueError(f"max_events={max_events!r}: want 1 or more")
    if initial is not None and (theta != 0.0 or omega != 0.0):
        raise ValueError("initial: want it without theta and omega, which it already holds")
    times = np.linspace(t_start, t_end, DEFAULT_SAMPLES) if save_at is None else array_of("save_at", save_at)
    if times.ndim != 1 or np.any(np.diff(times) < 0.0) or not np.all((times >= t_start) & (times <= t_end)):
        raise ValueError(f"save_at: want ascending times between t_start={t_start!r} and t_end={t_end!r} s")
    base = Still() if motion is None else motion
    check_kinds(system, base)
    if effects:
        from rocking.effects import base_with, compose

        system = compose(system, effects)
        base = base_with(base, effects, (float(t_start), float(t_end)), system.g)
    if pitch_kernel(base) is not None and not system.carries_pitch:
        raise ValueError(f"motion={base!r}: {system.name} does not carry a base that pitches")
    carrier = load(solver)
    refusal = carrier.declines(system, base)
    if refusal is not None:
        raise ValueError(f"solver={solver!r} declines: {refusal}")
    y0, q0 = system.initial_state(theta, omega) if initial is None else initial
    if len(y0) != len(system.state_names):
        raise ValueError(f"initial: {len(y0)} numbers, want {', '.join(system.state_names)} of {system.name}")
    if initial is not None:
        check_tilt("initial: theta", y0[system.state_names.index("theta")])
    run = carrier.solve(
        system, base, y0, q0, (float(t_start), float(t_end)),
        rtol=rtol, atol=atol, save_at=times, max_events=max_events,
    )  # fmt: skip
    return replace(run, effects=tuple(effects)) if effects else run
