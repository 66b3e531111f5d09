"""The linear Method 1 in closed form between impacts: nothing is integrated, impacts are located to rounding.

For base motions with a closed form, which say so by one of two attributes:

- `ramped_sine`: (omega [rad/s], phase [rad], rate [m/s^3], duration [s]) or None; a_x = rate t sin(omega t + phase)
  from 0 to duration, else 0, and a_z = 0;
- `piecewise_linear`: (t_first [s], dt [s], values [m/s^2] of shape (sample,)) or None; a_x runs straight from sample to
  sample, is 0 before the first and after the last, and a_z = 0;

and for a base at rest.  Many runs at a time: `rocking.solvers.exact.batch`, on a GPU too (`rocking.solvers.devices`).

Source   Winkler, Meguro & Yamazaki (1995), eqs (1)-(4); the closed forms are derived in `rocking.solvers.exact.kernel`.
Status   tolerances have nothing to act on here; the error is that of rounding, which each impact multiplies as it does
         any difference between two runs.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rocking.arguments import writable
from rocking.hybrid import REST, ROTATION, Discrete, System
from rocking.motion import BaseMotion
from rocking.solvers.interrupts import uninterrupted
from rocking.solvers.piecewise.motion import piecewise_linear, ramped_sine, refusal
from rocking.solvers.recording import trajectory
from rocking.solvers.taylor.batch import parameter_row
from rocking.trajectory import Events, Trajectory

Array = NDArray[np.float64]

FIRST_ROOM = 1024
"""Events for which a run has room at first; one with more is run again."""


class Exact:
    """Closed form between located impacts, for the linear Method 1."""

    name = "exact"
    batch_takes_device = True

    def declines(self, system: System, motion: BaseMotion) -> str | None:
        """A sentence for anything but the linear Method 1 over a base with a closed form; None for that."""
        return refusal(system, motion, ("linear",))

    def solve_batch(self, systems: Any, motions: Any, states: Any, t_span: tuple[float, float], **options: Any) -> Any:
        """Summaries of many runs: on a GPU if there is one, else by the linear kernel of `taylor.batch`."""
        from rocking.solvers.devices import chosen
        from rocking.solvers.taylor.batch import run_batch

        device = chosen(options.get("device"), len(systems))
        if device is None:
            return run_batch(systems, motions, states, t_span, options["max_events"])
        from rocking.solvers.exact.jax_batch import carry_on_device

        return run_batch(systems, motions, states, t_span, options["max_events"], device, carry_on_device)

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
        if int(q0.mode) not in (REST, ROTATION):
            raise ValueError(f"initial: mode {int(q0.mode)} is none of Method 1's; want {REST} or {ROTATION}")
        s = float(q0.s)
        start = np.array([float(q0.mode), s, s * y0[0], s * y0[1], *t_span])
        tally, last_mode, log = _run(system, motion, start, writable(save_at), max_events)
        saved, events = int(tally.saved), int(tally.events)
        code = log.event_code[:events]
        return trajectory(
            system,
            motion,
            self.name,
            int(tally.status),
            (t_span[0], float(tally.end)),
            int(q0.mode),
            int(last_mode),
            (save_at[:saved], log.y[:saved], log.mode[:saved], log.s[:saved]),
            Events(
                log.event_t[:events], code[:, 0], code[:, 1], code[:, 2], log.event_s[:events],
                log.event_y[:events, 0], log.event_y[:events, 1],
            ),
            max_events,
            {"events": events},
            tally.peak,
        )  # fmt: skip


def _run(system: System, motion: BaseMotion, start: Array, save_at: Array, max_events: int) -> Any:
    """(tally, last mode, log) of one run, with room for all of its events."""
    from rocking.solvers.exact.entry import entry, named

    wave = ramped_sine(motion)
    record = None if wave is not None else piecewise_linear(motion)
    par = np.array(parameter_row(system))
    room = FIRST_ROOM
    while True:
        if record is not None:
            # A copy of the samples: the compiled code takes no array that is read-only.
            tally, last_mode, log = uninterrupted(
                entry("single_record"), par, record[0], np.array(record[1]), start, save_at, max_events, room
            )
        else:
            tally, last_mode, log = uninterrupted(entry("single_sine"), par, wave, start, save_at, max_events, room)
        sums = named(tally)
        if sums.events <= room:
            return sums, last_mode, log
        room = int(sums.events)
