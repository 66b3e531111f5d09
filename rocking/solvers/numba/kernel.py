"""The compiled loop: Dormand-Prince steps, guards looked at within each step, events located and recorded.

The system and the motion come in as function pointers, so the loop is compiled once for each kind of state and kept.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np

from rocking.hybrid import INADMISSIBLE, Discrete
from rocking.solvers.numba.compiling import borrowing
from rocking.solvers.numba.parameters import with_numbers
from rocking.solvers.numba.runge_kutta import STAGES, base_at, dense, error_norm, step
from rocking.solvers.recording import (
    CHECKS_PER_STEP,
    FELL,
    INADMISSIBLE_STATE,
    MAX_STALLED,
    NOT_FINITE,
    REACHED_END,
    STALL_TIME,
    STALLED,
    STEP_TOO_SMALL,
    TOO_MANY_EVENTS,
    inner_limits,
)
from rocking.trajectory import BALANCE

FIRST_STEP = 1e-3  # [s]; the error control mends it at once
SPARE = 4  # rows of the event table that one pass of the loop may fill

limits: Any = borrowing(inner_limits)


@borrowing
def write(row, out):
    """Write a row into the beginning of another one: for a slice numba would compile the words of an error, too."""
    for j in range(row.size):
        out[j] = row[j]


@borrowing
def negative_guard(values, n):
    """Index of the first guard below zero, or -1."""
    for k in range(n):
        if values[k] < 0.0:
            return k
    return -1


@borrowing
def guard_at(guards, motion, kg, x, t, h, y, q, par, mpar, low, high, k, out):
    """Value of guard kg at the share x of the step."""
    dense(y, h, x, k, out)
    return guards(out, q, base_at(motion, t + x * h, low, high, mpar), par)[kg]


@borrowing
def locate(guards, motion, kg, a, b, just_left, t, h, y, q, par, mpar, low, high, k, out):
    """Share of the step in (a, b] at which guard kg falls through zero, on the dense output (Illinois method).

    just_left: the guard is zero at a, where the mode began, and counts as positive an instant later.
    """
    f_a = 1.0 if just_left else guard_at(guards, motion, kg, a, t, h, y, q, par, mpar, low, high, k, out)
    f_b = guard_at(guards, motion, kg, b, t, h, y, q, par, mpar, low, high, k, out)
    artificial = just_left
    for _ in range(200):
        if b - a <= 1e-16 * (1.0 + abs(b)) or f_a <= 0.0:
            break
        x = 0.5 * (a + b) if artificial else (a * f_b - b * f_a) / (f_b - f_a)
        if not a < x < b:
            break
        f_x = guard_at(guards, motion, kg, x, t, h, y, q, par, mpar, low, high, k, out)
        if f_x > 0.0:
            a, f_a = x, f_x
            artificial = False
            f_b *= 0.5
        else:
            b, f_b = x, f_x
            if not artificial:
                f_a *= 0.5
        if f_x == 0.0:
            break
    return b


@borrowing
def first_event(guards, motion, n_guards, t, h, y, y_new, q, par, mpar, low, high, k, out):
    """(guard, share of the step) of the first guard to fall below zero within the step; guard -1 if none does."""
    for check in range(1, CHECKS_PER_STEP + 1):
        a, b = (check - 1) / CHECKS_PER_STEP, check / CHECKS_PER_STEP
        if check == CHECKS_PER_STEP:
            write(y_new, out)
        else:
            dense(y, h, b, k, out)
        values = guards(out, q, base_at(motion, t + b * h, low, high, mpar), par)
        found, share = -1, 2.0
        for kg in range(n_guards):
            if values[kg] < 0.0:
                just_left = check == 1 and guards(y, q, base_at(motion, t, low, high, mpar), par)[kg] == 0.0
                x = locate(guards, motion, kg, a, b, just_left, t, h, y, q, par, mpar, low, high, k, out)
                if x < share:
                    found, share = kg, x
        if found >= 0:
            return found, share
    return -1, 1.0


@borrowing
def polish(flow, guards, motion, kg, share, t, h, y, q, par, mpar, low, high, k, k_try, stage, out):
    """Time from t to the event, by Newton's method with true steps of that length; the state there is left in `out`."""
    d = 1e-4
    ahead = guard_at(guards, motion, kg, min(share + d, 1.0), t, h, y, q, par, mpar, low, high, k, out)
    behind = guard_at(guards, motion, kg, max(share - d, 0.0), t, h, y, q, par, mpar, low, high, k, out)
    slope = (ahead - behind) / ((min(share + d, 1.0) - max(share - d, 0.0)) * h)
    write(k[0], k_try[0])
    tau = share * h
    for _ in range(4):
        step(flow, motion, t, y, tau, q, par, mpar, low, high, k_try, stage, out)
        value = guards(out, q, base_at(motion, t + tau, low, high, mpar), par)[kg]
        change = value / slope
        # A slope that is no use (a guard that only grazes zero) leaves the root of the dense output.
        if not abs(change) < d * h or abs(change) <= 1e-16 * (1.0 + t) or not 0.0 < tau - change <= h:
            break
        tau -= change
    step(flow, motion, t, y, tau, q, par, mpar, low, high, k_try, stage, out)
    return tau


@borrowing
def balance_passage(balance, x_end, h, y, y_end, par, k, out):
    """Share of the step at which the tilt of unstable balance is passed outward; -1 if it is not."""
    if not (balance(y, par) < 0.0 <= balance(y_end, par)):
        return -1.0
    a, b = 0.0, x_end
    for _ in range(60):
        x = 0.5 * (a + b)
        dense(y, h, x, k, out)
        if balance(out, par) < 0.0:
            a = x
        else:
            b = x
    dense(y, h, b, k, out)
    return b


@borrowing
def peak_in_step(watched, x_end, h, y, y_end, k, out):
    """Largest |theta| from the start of the step to its share x_end; watched holds the indices of theta and omega."""
    i, j = watched[0], watched[1]
    peak = max(abs(y[i]), abs(y_end[i]))
    if y[j] * y_end[j] < 0.0:
        a, b = 0.0, x_end
        for _ in range(40):
            x = 0.5 * (a + b)
            dense(y, h, x, k, out)
            if out[j] * y[j] > 0.0:
                a = x
            else:
                b = x
        peak = max(peak, abs(out[i]))
    return peak


@borrowing
def record(count, table_t, table_i, table_s, table_y, t, kg, q_before, q, y_before, y):
    """Add a row to the table of events."""
    i = count[1]
    table_t[i] = t
    table_i[i, 0], table_i[i, 1], table_i[i, 2] = kg, q_before.mode, q.mode
    table_s[i] = q.s
    write(y_before, table_y[i, 0])
    write(y, table_y[i, 1])
    count[1] = i + 1


@borrowing
def save_until(count, save_at, saved_y, saved_i, saved_s, t, h, until, y, q, k, out):
    """Keep the samples up to the time `until` within the step."""
    while count[0] < save_at.size and save_at[count[0]] <= until:
        i = count[0]
        dense(y, h, (save_at[i] - t) / h, k, out)
        write(out, saved_y[i])
        saved_i[i] = q.mode
        saved_s[i] = q.s
        count[0] = i + 1


@numba.njit(error_model="numpy")
def grown(table):
    """The table in an array twice as long."""
    bigger = np.empty((2 * table.shape[0], *table.shape[1:]), table.dtype)
    write(table.ravel(), bigger.ravel())
    return bigger


@borrowing
def all_finite(y, base):
    """Whether state and base acceleration are finite."""
    finite = np.isfinite(base.a_x) and np.isfinite(base.a_z)
    for j in range(y.size):
        finite = finite and np.isfinite(y[j])
    return finite


def integrate(
    flow, guards, jump, balance, motion, y0, q0, like, numbers, values, mpar, edges, max_step, tolerances, save_at,
    max_events, n_guards, watched,
):  # fmt: skip
    """Carry the system over the stretches between `edges`; see `rocking.solvers.numba.solver` for what comes back."""
    n = y0.size
    par = with_numbers(like, numbers, values)
    rtol, atol = tolerances[0], tolerances[1]
    k, k_try = np.empty((STAGES, n)), np.empty((STAGES, n))
    stage, y_new, out, y_end = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    saved_y, saved_i, saved_s = np.empty((save_at.size, n)), np.empty(save_at.size, np.int64), np.empty(save_at.size)
    table_t, table_i, table_s, table_y = np.empty(64), np.empty((64, 3), np.int64), np.empty(64), np.empty((64, 2, n))
    count = np.zeros(4, np.int64)  # samples, events, steps, events in a row without time going on
    y, q = y0.copy(), Discrete(q0.mode, q0.s, q0.slip)
    t, h, last_event, status = edges[0], FIRST_STEP, -np.inf, REACHED_END
    peak = abs(y[watched[0]])
    while count[0] < save_at.size and save_at[count[0]] <= t:
        write(y, saved_y[count[0]])
        saved_i[count[0]], saved_s[count[0]] = q.mode, q.s
        count[0] += 1
    for stretch in range(edges.size - 1):
        stop = edges[stretch + 1]
        low, high = limits(edges[stretch], stop, max_step)
        fresh = True
        while t < stop and status == REACHED_END:
            if count[1] + SPARE > table_t.size:
                table_t, table_i, table_s, table_y = grown(table_t), grown(table_i), grown(table_s), grown(table_y)
            kg = -1
            tau = 0.0
            if fresh:
                base = base_at(motion, t, low, high, mpar)
                if not all_finite(y, base):
                    status = NOT_FINITE
                    break
                kg = negative_guard(guards(y, q, base, par), n_guards)
                write(y, y_end)
                slope = flow(y, q, base, par)
                for j in range(n):
                    k[0, j] = slope[j]
            if kg < 0:
                h = min(h, max_step, stop - t)
                step(flow, motion, t, y, h, q, par, mpar, low, high, k, stage, y_new)
                error = error_norm(y, y_new, h, k, rtol, atol)
                if not error <= 1.0:
                    tried = h
                    h *= max(0.2, 0.9 * error**-0.2) if error < np.inf else 0.2
                    fresh = False
                    if h < 1e-15 * (1.0 + abs(t)):
                        # What is not finite leaves no step an error that could be judged.
                        base = base_at(motion, t + tried, low, high, mpar)
                        status = STEP_TOO_SMALL if all_finite(y_new, base) else NOT_FINITE
                    continue
                count[2] += 1
                kg, share = first_event(guards, motion, n_guards, t, h, y, y_new, q, par, mpar, low, high, k, out)
                write(y_new, y_end)
                tau = h
                if kg >= 0:
                    tau = polish(
                        flow, guards, motion, kg, share, t, h, y, q, par, mpar, low, high, k, k_try, stage, y_end
                    )
                # A step that ends a stretch ends at its edge, which the sum may miss by a rounding.
                until = stop if kg < 0 and h == stop - t else t + tau
                save_until(count, save_at, saved_y, saved_i, saved_s, t, h, until, y, q, k, out)
                peak = max(peak, peak_in_step(watched, tau / h, h, y, y_end, k, out))
                x = balance_passage(balance, tau / h, h, y, y_end, par, k, out)
                if x >= 0.0:
                    record(count, table_t, table_i, table_s, table_y, t + x * h, np.int64(BALANCE), q, q, out, out)
                t = until
                h = h * min(5.0, 0.9 * max(error, 1e-10) ** -0.2)
                write(y_end, y)
                write(k[STAGES - 1], k[0])
                fresh = kg >= 0
            if kg >= 0:
                q_before = q
                if kg > 0:
                    after, q = jump(y, q, base_at(motion, t, low, high, mpar), par, kg)
                    for j in range(n):
                        y[j] = after[j]
                record(count, table_t, table_i, table_s, table_y, t, kg, q_before, q, y_end, y)
                count[3] = count[3] + 1 if t - last_event < STALL_TIME else 0
                last_event = t
                if kg == 0:
                    status = FELL
                elif q.mode == INADMISSIBLE:
                    status = INADMISSIBLE_STATE
                elif count[3] > MAX_STALLED:
                    status = STALLED
                elif count[1] > max_events:
                    status = TOO_MANY_EVENTS
        if status != REACHED_END:
            break
    saved = (saved_y[: count[0]], saved_i[: count[0]], saved_s[: count[0]])
    table = (table_t[: count[1]], table_i[: count[1]], table_s[: count[1]], table_y[: count[1]])
    return status, t, q.mode, count[2], peak, saved, table
