"""The readable reference: SciPy's DOP853 between located events.

Source   Hairer, Norsett & Wanner (1993), Solving Ordinary Differential Equations I, for DOP853 and its dense output.
Status   slow (tens of milliseconds a second of rocking); carries every system that is a set of plain functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rocking import scalars
from rocking.hybrid import INADMISSIBLE, Base, Discrete, System, bind_hooks
from rocking.motion import BaseMotion, base_at
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
    segment_edges,
    trajectory,
)
from rocking.trajectory import BALANCE, Events, Trajectory

State = NDArray[np.float64]


class _Run:
    """One run: where it is, and what it has left behind."""

    def __init__(self, system: System, motion: BaseMotion, y: State, q: Discrete, save_at: State) -> None:
        self.system, self.motion = system, motion
        self.par = bind_hooks(system.parameters, lambda hook: partial(hook, scalars))
        self.motion_par = [float(v) for v in motion.parameters]
        self.y, self.q = y, q
        self.save_at = save_at
        self.saved: list[tuple[State, int, float]] = []
        self.events: list[tuple[float, int, int, int, float, State, State]] = []
        self.stalled = 0
        self.theta, self.omega = system.state_names.index("theta"), system.state_names.index("omega")
        self.peak = abs(float(y[self.theta]))
        self.statistics = {"steps": 0, "flow_evaluations": 0}
        self.low, self.high = -math.inf, math.inf

    def base(self, t: float) -> Base:
        """Base acceleration; at an edge of a smooth stretch, its limit from within."""
        inside = min(max(t, self.low), self.high)
        return base_at(scalars, self.motion, inside, self.motion_par)

    def flow(self, t: float, y: State) -> tuple[float, ...]:
        self.statistics["flow_evaluations"] += 1
        return self.system.flow(scalars, y.tolist(), self.q, self.base(t), self.par)

    def finite_after(self, t: float, y: State) -> bool:
        """Whether base and slope are finite just after t, further than the smallest step that DOP853 tries."""
        ahead = t + 100.0 * abs(math.nextafter(t, math.inf) - t)
        return bool(np.all(np.isfinite([*self.base(ahead), *self.flow(ahead, y)])))

    def guards(self, t: float, y: State) -> tuple[float, ...]:
        return self.system.guards(scalars, y.tolist(), self.q, self.base(t), self.par)

    def balance(self, y: State) -> float:
        return self.system.balance(scalars, y.tolist(), self.par)

    def record(self, t: float, guard: int, before: tuple[State, Discrete]) -> None:
        y, q = before
        self.events.append((t, guard, int(q.mode), int(self.q.mode), float(self.q.s), y, self.y))

    def save_until(self, t: float, state_at: Callable[[float], State]) -> None:
        """Samples up to and including t."""
        while len(self.saved) < len(self.save_at) and self.save_at[len(self.saved)] <= t:
            at = self.save_at[len(self.saved)]
            self.saved.append((state_at(float(at)), int(self.q.mode), float(self.q.s)))

    def fire(self, t: float, k: int) -> int | None:
        """Let guard k end the mode; a status if that ends the run."""
        before = (self.y, self.q)
        if k == 0:
            self.record(t, k, before)
            return FELL
        y, q = self.system.jump(scalars, self.y.tolist(), self.q, self.base(t), self.par, k)
        self.y, self.q = np.array(y, dtype=float), Discrete(int(q.mode), float(q.s), float(q.slip))
        recent = bool(self.events) and t - self.events[-1][0] < STALL_TIME
        self.stalled = self.stalled + 1 if recent else 0
        self.record(t, k, before)
        if self.q.mode == INADMISSIBLE:
            return INADMISSIBLE_STATE
        return STALLED if self.stalled > MAX_STALLED else None

    def record_peak(self, t0: float, t1: float, state_at: Callable[[float], State]) -> None:
        """Keep the largest |theta| of the run so far, with that inside the step where omega changes sign."""
        from scipy.optimize import brentq

        times = [t0, t1]
        if state_at(t0)[self.omega] * state_at(t1)[self.omega] < 0.0:
            times.append(float(brentq(lambda x: state_at(x)[self.omega], t0, t1, xtol=1e-14, rtol=1e-14)))
        self.peak = max(self.peak, *(abs(float(state_at(t)[self.theta])) for t in times))

    def record_balance(self, t0: float, t1: float, state_at: Callable[[float], State]) -> None:
        """Record an outward passage of the tilt of unstable balance within a step."""
        from scipy.optimize import brentq

        if self.balance(state_at(t0)) < 0.0 <= self.balance(state_at(t1)):
            t = float(brentq(lambda x: self.balance(state_at(x)), t0, t1, xtol=1e-14, rtol=1e-14))
            self.events.append((t, BALANCE, int(self.q.mode), int(self.q.mode), float(self.q.s), *2 * (state_at(t),)))


def _first_event(
    run: _Run, t_mode: float, t0: float, t1: float, state_at: Callable[[float], State]
) -> tuple[float, int] | None:
    """The first guard to fall below zero in (t0, t1], as (time, guard); t_mode is when the mode began."""
    from scipy.optimize import brentq

    times = np.linspace(t0, t1, CHECKS_PER_STEP + 1)
    for a, b in pairwise(times):
        after = run.guards(b, state_at(b))
        found = []
        for k in (k for k, g in enumerate(after) if g < 0.0):

            def guard(t: float, k: int = k) -> float:
                # Zero when the mode begins means just left: positive an instant later.
                return 1.0 if t == t_mode else run.guards(t, state_at(t))[k]

            root = brentq(guard, a, b, xtol=1e-15, rtol=8.9e-16) if guard(a) > 0.0 else a
            found.append((float(root), k))
        if found:
            return min(found)
    return None


def _smooth_stretch(
    run: _Run, t: float, t_stop: float, rtol: float, atol: float, max_events: int
) -> tuple[float, int | None]:
    """Carry the run from t to t_stop, where the motion is smooth; (time reached, status if the run is over)."""
    from scipy.integrate import DOP853

    while t < t_stop:
        low = [k for k, g in enumerate(run.guards(t, run.y)) if g < 0.0]
        if not np.all(np.isfinite([*run.y, *run.base(t)])):
            return t, NOT_FINITE
        if len(run.events) > max_events:
            return t, TOO_MANY_EVENTS
        if low:
            status = run.fire(t, low[0])
            if status is not None:
                return t, status
            continue
        stepper = DOP853(run.flow, t, run.y, t_stop, max_step=run.motion.max_step, rtol=rtol, atol=atol)
        t_mode, event = t, None
        while event is None and stepper.status == "running":
            stepper.step()
            if stepper.status == "failed":
                return t, STEP_TOO_SMALL if run.finite_after(stepper.t, stepper.y) else NOT_FINITE
            run.statistics["steps"] += 1
            state_at: Callable[[float], State] = stepper.dense_output()
            event = _first_event(run, t_mode, stepper.t_old, stepper.t, state_at)
            t = stepper.t if event is None else event[0]
            run.save_until(t, state_at)
            run.record_peak(stepper.t_old, t, state_at)
            run.record_balance(stepper.t_old, t, state_at)
            run.y = stepper.y if event is None else np.asarray(state_at(t))
        if event is not None:
            status = run.fire(t, event[1])
            if status is not None:
                return t, status
    return t, None


class ScipyEvents:
    """SciPy's DOP853 with events located on its dense output."""

    name = "scipy"

    def declines(self, system: System, motion: BaseMotion) -> str | None:
        """None: plain functions are all it needs."""
        return None

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
        run = _Run(system, motion, np.array(y0, dtype=float), q0, save_at)
        run.save_until(t_span[0], lambda _: run.y)
        t, status = t_span[0], None
        edges = segment_edges(motion, *t_span)
        for start, stop in pairwise(edges):
            run.low, run.high = inner_limits(start, stop, motion.max_step)
            t, status = _smooth_stretch(run, float(start), float(stop), rtol, atol, max_events)
            if status is not None:
                break
        return trajectory(
            system,
            motion,
            self.name,
            REACHED_END if status is None else status,
            (t_span[0], t),
            int(q0.mode),
            int(run.q.mode),
            _samples(run, len(y0)),
            _events(run, len(y0)),
            max_events,
            run.statistics,
            run.peak,
        )


def _samples(run: _Run, n: int) -> tuple[Any, Any, Any, Any]:
    count = len(run.saved)
    y = np.array([row[0] for row in run.saved], dtype=float).reshape(count, n)
    mode = np.array([row[1] for row in run.saved], dtype=np.int64)
    return run.save_at[:count], y, mode, np.array([row[2] for row in run.saved], dtype=float)


def _events(run: _Run, n: int) -> Events:
    columns = list(zip(*run.events, strict=True)) or [()] * 7
    t, guard, before, after, s, y_before, y_after = columns
    count = len(t)
    return Events(
        np.array(t, dtype=float),
        np.array(guard, dtype=np.int64),
        np.array(before, dtype=np.int64),
        np.array(after, dtype=np.int64),
        np.array(s, dtype=float),
        np.array(y_before, dtype=float).reshape(count, n),
        np.array(y_after, dtype=float).reshape(count, n),
    )
