"""Method 1 by Taylor polynomials on the samples of the base motion: the fastest there is for many nonlinear blocks.

A step ends at the next sample, or where the polynomial no longer serves, or at an impact, which is a root of the
polynomial itself; sine and cosine of the tilt follow by the recurrences of automatic differentiation.  For the
nonlinear and the linear form, over motions that `rocking.solvers.piecewise.motion` describes: ramped sinusoids, records
that are straight between samples, and a base at rest.  Batches carry several runs in the lanes of a vector
(`rocking.solvers.taylor.lanes`) and give the bits of single runs.

Source   Winkler, Meguro & Yamazaki (1995), eqs (1)-(4); `rocking.solvers.taylor.flight` for the polynomials.
Status   tolerances have nothing to act on here: steps are short enough for the error to be that of rounding, 1e-13 of a
         tilt or so for the first few impacts, each of which multiplies it as it does any difference between two runs.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rocking.arguments import writable
from rocking.hybrid import Discrete, System
from rocking.motion import BaseMotion
from rocking.solvers.interrupts import uninterrupted
from rocking.solvers.piecewise.motion import piecewise_linear, ramped_sine, refusal
from rocking.solvers.recording import trajectory
from rocking.solvers.taylor.batch import parameter_row, run_batch, start_row
from rocking.solvers.taylor.columns import COLUMNS, LARGEST
from rocking.solvers.taylor.records import joined
from rocking.trajectory import Events, Trajectory

FIRST_ROOM = 1024
"""Events for which a run has room at first; one with more is run again."""


class Taylor:
    """Taylor polynomials between located impacts, for Method 1."""

    name = "taylor"

    def declines(self, system: System, motion: BaseMotion) -> str | None:
        """A sentence for anything but Method 1 over a base with a closed form; None for that."""
        return refusal(system, motion, ("nonlinear", "linear"))

    def solve_batch(self, systems: Any, motions: Any, states: Any, t_span: tuple[float, float], **options: Any) -> Any:
        """Summaries of many runs; see `rocking.solvers.taylor.batch.run_batch`."""
        return run_batch(systems, motions, states, t_span, options["max_events"])

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
        """The trajectory from t_span[0] to the fall or t_span[1]; rtol and atol have nothing to act on."""
        start = np.array([start_row(y0, q0, t_span)])
        times = writable(save_at)
        (status, last_mode, end, events, saved), log, peak = _run(system, motion, start, times, max_events)
        events, saved = int(events), int(saved)
        code = log.event_code[:events]
        return trajectory(
            system,
            motion,
            self.name,
            int(status),
            (t_span[0], float(end)),
            int(q0.mode),
            int(last_mode),
            (save_at[:saved], log.y[:saved], log.mode[:saved], log.s[:saved]),
            Events(
                log.event_t[:events], code[:, 0], code[:, 1], code[:, 2], log.event_s[:events],
                log.event_y[:events, 0], log.event_y[:events, 1],
            ),
            max_events,
            {"events": events},
            peak,
        )  # fmt: skip


def _run(system: Any, motion: BaseMotion, start: Any, save_at: Any, max_events: int) -> tuple[Any, Any, float]:
    """(sums, log, largest tilt) of one run, with room for all of its events."""
    from rocking.solvers.taylor.entry import entry

    wave = ramped_sine(motion)
    record = None if wave is not None else piecewise_linear(motion)
    par, rows = np.array([parameter_row(system)]), np.empty((1, COLUMNS))
    moves: tuple[Any, ...] = (wave[None, :],) if wave is not None else ()
    if record is not None:
        samples, table = joined([record])
        moves = (table, *samples)
    kernel = entry(f"{system.form}_{'record' if wave is None else 'wave'}")
    room = FIRST_ROOM
    while True:
        sums, log = uninterrupted(kernel, par, start, *moves, max_events, rows, save_at, room)
        if sums[3] <= room:
            return sums, log, float(rows[0, LARGEST])
        room = int(sums[3])
