"""The table of the lanes: a column for each run under way, a row for each number that belongs to it.

Status   the order is free; no more than `rocking.solvers.taylor.lanes`, `turns` and `log` know it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from rocking.solvers.taylor.flight import DEGREE

(
    X, V, S, K, TAU, STOP, B0, B1, SINE, COSINE, FLOOR, PEAK, WATCH, PASSAGE, PASSED, IMPACTS, EVENTS, STALLS, LAST,
    CALL, FELL_AT, V_FELL, P, P2, ALPHA, TURN_S, TURN_C, HOLD_S, HOLD_C, E, OMEGA_REST, ONSET, DT, PER_DT, ORIGIN,
    K_EDGE, SCALE, BULGE, ZENO, OMEGA, RATE, PHASE, RUN, MODE, ONSET_TIME, T_START, T_END, SCALE_ON, SAVED, WRITTEN,
    STATUS, LIMIT, FIRST, SAMPLES, BEGIN,
) = range(55)  # fmt: skip
"""Rows of the table.  State: x = s theta, v = s omega, carrying corner s, interval k, time tau in it, its end, a_x/g at
both ends of it, sine and cosine of the wave.  CALL says what a lane wants (below); the others are constants of a run,
sums, and what `rocking.solvers.taylor.turns` remembers.  Of a record: where its samples are, how many, when the first
is."""

ROWS = 55

NOTHING, EDGE, RESTS, CHATTERS, FALLS, ENOUGH = range(6)
"""What a lane may ask for: the next stretch of the motion, a place to wait, the end of a chatter, the end of the run
because it fell, or because it had too many events."""

S_OLD, K_OLD, TAU_OLD, REACH_OLD, V_OLD, HIT_OLD, C_FIRST = range(ROWS, ROWS + 7)
"""Further rows where a run is written down: the step just made, and from C_FIRST on its flight."""

ALL_ROWS = C_FIRST + DEGREE + 1


class Runs(NamedTuple):
    """What is to be carried: one row for each run, and what they share."""

    pars: Any  # p^2, alpha, g, onset, e, omega_rest
    starts: Any  # mode, s, s theta, s omega, t_start, t_end
    motions: Any  # record: columns of `rocking.solvers.taylor.records`; sinusoid: omega, phase, rate, duration
    values: Any  # samples of all records, each filled up with zeros; None for sinusoids
    peaks: Any  # largest |sample| of each block of them
    max_events: int
    rows: Any  # what became of each
