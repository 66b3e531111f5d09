"""Compiled Dormand-Prince with located events: the default.

Impacts are bracketed on the dense output and then located by Newton's method with true steps, so their accuracy is
that of a step and not of the interpolant.  Compiled code is kept on disk (`rocking.solvers.numba.compiling`); a run
releases the interpreter lock, so threads run side by side.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rocking.arguments import writable
from rocking.hybrid import Discrete, System
from rocking.motion import BaseMotion
from rocking.solvers.interrupts import uninterrupted
from rocking.solvers.numba.functions import motion_function, shared_parameters, size_of, system_functions
from rocking.solvers.recording import segment_edges, trajectory
from rocking.trajectory import Events, Trajectory


def _discrete(q: Discrete) -> Discrete:
    return Discrete(int(q.mode), float(q.s), float(q.slip))


class NumbaEvents:
    """Compiled Dormand-Prince 5(4) with located events."""

    name = "numba"

    def declines(self, system: System, motion: BaseMotion) -> str | None:
        """None: any plain functions compile; one that does not is numba's own error."""
        return None

    def solve_batch(self, systems: Any, motions: Any, states: Any, t_span: tuple[float, float], **options: Any) -> Any:
        """Summaries of many runs; see `rocking.solvers.numba.batch.run_batch`."""
        from rocking.solvers.numba.batch import run_batch

        return run_batch(systems, motions, states, t_span, **options)

    def solve(
        self,
        system: System,
        motion: BaseMotion,
        y0: tuple[float, ...],
        q0: Discrete,
        t_span: tuple[float, float],
        *,
        rtol: float,
        atol: float,
        save_at: NDArray[np.float64],
        max_events: int,
    ) -> Trajectory:
        """The trajectory from t_span[0] to the fall or t_span[1]."""
        par = system.parameters
        kind: Any = type(par)
        n_guards = len(system.guard_names)
        size = size_of(par)
        functions, loop = system_functions(
            system.flow, system.guards, system.jump, system.balance, kind, len(y0), size, n_guards
        )
        like, numbers, values = shared_parameters([system], size)
        status, t, last_mode, steps, peak, saved, table = uninterrupted(
            loop,
            *functions,
            motion_function(motion),
            np.array(y0, dtype=np.float64),
            _discrete(q0),
            like,
            numbers[0],
            values[0],
            writable(motion.parameters),
            segment_edges(motion, *t_span),
            float(motion.max_step),
            np.array([rtol, atol]),
            writable(save_at),
            max_events,
            n_guards,
            (system.state_names.index("theta"), system.state_names.index("omega")),
        )
        y, mode, s = saved
        times, codes, carrying, states = table
        events = Events(times, codes[:, 0], codes[:, 1], codes[:, 2], carrying, states[:, 0], states[:, 1])
        return trajectory(
            system,
            motion,
            self.name,
            status,
            (t_span[0], t),
            int(q0.mode),
            last_mode,
            (save_at[: len(y)], y, mode, s),
            events,
            max_events,
            {"steps": int(steps)},
            peak,
        )
