"""What solvers share in putting a trajectory together: how a run ended, and the table of events."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rocking.hybrid import Mode, System
from rocking.motion import BaseMotion
from rocking.trajectory import Events, Outcome, Trajectory

REACHED_END, FELL, INADMISSIBLE_STATE, STALLED, STEP_TOO_SMALL, TOO_MANY_EVENTS, NOT_FINITE = range(7)

STALL_TIME = 1e-12
"""Events closer than this [s] do not advance the run."""

MAX_STALLED = 100
"""So many of them in a row end it."""

CHECKS_PER_STEP = 4
"""Guards are looked at this often within a step, so that one which dips below zero and back is seen."""


EDGE = 2e-9
"""Share of a motion's longest step by which it may already show, before an edge, what lies behind it: sampled motions
forgive a time such a rounding where they begin and end."""


def inner_limits(start: Any, stop: Any, max_step: Any) -> tuple[Any, Any]:
    """Times [s] to which a solver keeps while it looks at the base between two edges: its limits from within."""
    share = EDGE * max_step if max_step < np.inf else 0.0
    margin = min(share, 0.25 * (stop - start))
    return max(np.nextafter(start, np.inf), start + margin), min(np.nextafter(stop, -np.inf), stop - margin)


def segment_edges(motion: BaseMotion, t_start: float, t_end: float) -> NDArray[np.float64]:
    """Times between which the motion is smooth, from t_start to t_end, shape (segment + 1,)."""
    inner = [t for t in motion.breakpoints if t_start < t < t_end]
    return np.array([t_start, *sorted(inner), t_end])


def _reason(status: int, system: System, t: float, max_events: int) -> str:
    return {
        INADMISSIBLE_STATE: f"at {t:.9g} s: {system.inadmissible_reason}",
        STALLED: f"at {t:.9g} s: more than {MAX_STALLED} events without time going on",
        STEP_TOO_SMALL: f"at {t:.9g} s: the tolerance asks for a step too small for floating point",
        TOO_MANY_EVENTS: f"at {t:.9g} s: more than max_events={max_events} events",
        NOT_FINITE: f"at {t:.9g} s: the state or the base motion is not finite",
    }.get(status, "")


def trajectory(
    system: System,
    motion: BaseMotion,
    solver: str,
    status: int,
    span: tuple[float, float],
    first_mode: int,
    last_mode: int,
    samples: tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[Any]],
    events: Events,
    max_events: int,
    statistics: dict[str, int],
    peak: float,
) -> Trajectory:
    """A Trajectory from what a solver has gathered; samples are (t, y, mode, s), span the times really covered.

    peak is the largest |theta| [rad] of the run, between the samples too.
    """
    if status == FELL:
        outcome = Outcome.OVERTURNED
    elif status == REACHED_END:
        outcome = Outcome.AT_REST if last_mode == Mode.REST else Outcome.MOVING
    else:
        outcome = Outcome.FAILED
    t, y, mode, s = samples
    reason = _reason(status, system, span[1], max_events)
    return Trajectory(
        system, motion, solver, t, y, mode, s, events, span[0], span[1], first_mode, outcome, reason, statistics, peak
    )
