"""A solver of another package: classical Runge-Kutta steps of one length, impacts located by bisection.

Every state within a step is that of a shorter step from the same start, so one function serves the steps, the samples
and the search for events.

Source   Runge-Kutta of order four, Kutta (1901).
Status   Method 1 on a level base.  The step follows from rtol, as the error of order four does; atol is not used.
"""

import math
from itertools import pairwise

import numpy as np

from rocking import Method1, scalars
from rocking.hybrid import Base, Discrete
from rocking.solvers.recording import (
    FELL,
    NOT_FINITE,
    REACHED_END,
    TOO_MANY_EVENTS,
    inner_limits,
    segment_edges,
    trajectory,
)
from rocking.trajectory import BALANCE, Events


class FixedStep:
    """Runge-Kutta steps of one length."""

    name = "fixed-step"

    def declines(self, system, motion):
        """A sentence on what it cannot treat, or None."""
        if type(system) is not Method1:
            return f"it carries Method 1 as it is, not {type(system).__name__}"
        if getattr(motion, "has_pitch", False):
            return "it knows no base that pitches"
        return None

    def solve(self, system, motion, y0, q0, t_span, *, rtol, atol, save_at, max_events):
        """The trajectory from t_span[0] to the fall or t_span[1]."""
        run = Run(system, motion, np.array(y0, dtype=float), q0, save_at)
        # The local error of order four, relative to the 1/p in which a block moves, is about (p h)^4.
        step = min(0.5 * rtol**0.25 / math.sqrt(system.parameters.p2), motion.max_step)
        status, t = REACHED_END, t_span[0]
        for start, stop in pairwise(segment_edges(motion, *t_span)):
            # No step goes over a jump of the base: on either side of it the base has its limit from within.
            run.within = inner_limits(start, stop, motion.max_step)
            status, t = run.carry(float(start), float(stop), step, max_events)
            if status != REACHED_END:
                break
        return trajectory(
            system, motion, self.name, status, (t_span[0], t), int(q0.mode), int(run.q.mode), run.samples(),
            run.table(), max_events, {"steps": run.steps}, run.peak,
        )  # fmt: skip


class Run:
    """Where a run is, and what it has left behind."""

    def __init__(self, system, motion, y, q, save_at):
        self.system, self.motion, self.y, self.q, self.save_at = system, motion, y, q, save_at
        self.saved, self.events, self.steps, self.peak = [], [], 0, abs(y[0])
        self.within = -math.inf, math.inf

    def base(self, t):
        """Base acceleration at t."""
        inside = min(max(t, self.within[0]), self.within[1])
        return Base(*self.motion.kernel(scalars, inside, self.motion.parameters))

    def flow(self, t, y):
        """dy/dt."""
        return np.array(self.system.flow(scalars, y, self.q, self.base(t), self.system.parameters))

    def after(self, t, h):
        """State a time h after t."""
        k1 = self.flow(t, self.y)
        k2 = self.flow(t + 0.5 * h, self.y + 0.5 * h * k1)
        k3 = self.flow(t + 0.5 * h, self.y + 0.5 * h * k2)
        k4 = self.flow(t + h, self.y + h * k3)
        return self.y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)

    def watched(self, t, y):
        """What ends a mode or is to be recorded when it falls below zero: the guards, then the tilt of balance."""
        guards = self.system.guards(scalars, y, self.q, self.base(t), self.system.parameters)
        return [*guards, -self.system.balance(scalars, y, self.system.parameters)]

    def locate(self, t, h, value):
        """The part of the step h at which value(time, state) turns negative, to the rounding of a time."""
        # A guard of zero at the start is one just left: it counts as positive there.
        low, high = 0.0, h
        while (middle := 0.5 * (low + high)) not in (low, high) and high - low > 1e-16 * max(t, h):
            low, high = (low, middle) if value(t + middle, self.after(t, middle)) < 0.0 else (middle, high)
        return high

    def first_event(self, t, h):
        """(part of the step, index) of the first thing watched to turn negative; the whole step and None if none."""
        before, found = self.watched(t, self.y), [(h, None)]
        for k, number in enumerate(self.watched(t + h, self.after(t, h))):
            # Past the balance already: nothing new.  A guard below zero is due, whenever it got there.
            if number < 0.0 and not (k == len(before) - 1 and before[k] < 0.0):
                found.append((self.locate(t, h, lambda time, y, k=k: self.watched(time, y)[k]), k))
        return min(found, key=lambda one: one[0])

    def carry(self, t, stop, step, max_events):
        """Through a stretch where the base moves smoothly: (status, time reached)."""
        while t < stop:
            part, k = self.first_event(t, min(step, stop - t))
            self.save(t, part)
            if self.y[1] * self.after(t, part)[1] < 0.0:  # a swing ends within
                way = math.copysign(1.0, self.y[1])
                turn = self.locate(t, part, lambda _, y, way=way: way * y[1])
                self.peak = max(self.peak, abs(self.after(t, turn)[0]))
            self.y, self.steps = self.after(t, part), self.steps + 1
            t = stop if part == stop - t else t + part
            self.peak = max(self.peak, abs(self.y[0]))
            if not np.all(np.isfinite(self.y)):
                return NOT_FINITE, t
            if k is not None and self.fire(t, k) == FELL:
                return FELL, t
            if len(self.events) > max_events:
                return TOO_MANY_EVENTS, t
        return REACHED_END, t

    def fire(self, t, k):
        """Record event k; let a guard change the mode."""
        y, q, guards = self.y, self.q, len(self.system.guard_names)
        if 0 < k < guards:
            y_after, q_after = self.system.jump(scalars, y, q, self.base(t), self.system.parameters, k)
            self.y, self.q = np.array(y_after), Discrete(int(q_after.mode), q_after.s, q_after.slip)
        self.events.append((t, BALANCE if k == guards else k, q.mode, self.q.mode, self.q.s, y, self.y))
        return FELL if k == 0 else None

    def save(self, t, part):
        """Samples from t to t + part."""
        while len(self.saved) < len(self.save_at) and self.save_at[len(self.saved)] <= t + part:
            at = self.save_at[len(self.saved)]
            self.saved.append((self.after(t, at - t), int(self.q.mode), self.q.s))

    def samples(self):
        """(t, y, mode, s), arrays over time."""
        n = len(self.saved)
        y, mode, s = list(zip(*self.saved, strict=True)) or [()] * 3
        return self.save_at[:n], np.array(y).reshape(n, 2), np.array(mode, dtype=np.int64), np.array(s, dtype=float)

    def table(self):
        """The events as arrays."""
        n, columns = len(self.events), list(zip(*self.events, strict=True)) or [()] * 7
        kinds = (float, np.int64, np.int64, np.int64, float)
        plain = (np.array(column, dtype=kind) for column, kind in zip(columns[:5], kinds, strict=True))
        return Events(*plain, *(np.array(column, dtype=float).reshape(n, 2) for column in columns[5:]))
