"""Residuals of windows, their derivatives, and the states at the starts of windows eliminated.

The sensitivities go through located impacts by central differences, which are clean because the events are located
and not stepped over.  Each window has a state of its own that no other knows: it is projected off, window by window.
Windows whose residual is several times the noise count less (Huber, by window), since a missing effect must not own
the sum of squares.  Whole records may be missed by a hundred times the noise, one for something else than all others:
there the sum of squares goes on as the logarithm, so that the parameters are those that explain most records and not
those that miss one by less.

Source   Huber (1964); the logarithm: as Cauchy's likelihood has it; elimination of local unknowns: Schur complement.
Status   derivatives against each other at two steps (tests).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studies.loop.models.model import LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.observing import jobs_of, observe
from studies.loop.observed.windows import Window
from studies.loop.runs.simulation import Simulator

Array = NDArray[np.float64]

STEP = 2e-4
"""Step of a difference, in scales of the parameter."""

THETA_STEP, OMEGA_STEP = 2e-6, 2e-5
"""Steps of the state at the start of a window [rad, rad/s]."""

HUBER = 3.0
"""Windows with an rms beyond this many standard deviations count less."""

ROBUST = 4.0
"""The same for whole records, which count by the logarithm beyond it."""

UNLIKE = 0.5
"""Slopes to both sides that differ by more than this share of the smallest one are not of one tangent."""


def residuals(simulator: Simulator, model: LoopModel, windows: Sequence[Window]) -> list[Array]:
    """Weighted residuals of every window; what cannot be compared (`observe`) counts as the noise does, 1."""
    return compared_all(read_of(simulator, model, windows), windows)


def read_of(simulator: Simulator, model: LoopModel, windows: Sequence[Window]) -> list[Array]:
    """What the channels of every window read."""
    return observe(simulator, [model], jobs_of(windows, 0), windows)


def compared_all(read: Sequence[Array], windows: Sequence[Window]) -> list[Array]:
    return [_compared(w, x) for x, w in zip(read, windows, strict=True)]


def _compared(window: Window, read: Array) -> Array:
    r = (window.data - read) * window.weights
    return np.where(np.isnan(r), 1.0, r) if window.sides is not None else r


@dataclass(frozen=True)
class Prior:
    """What is known of a lean at release, as one more residual: what the sensor said less what it says of the state.

    Where the sensor said nothing: the rotation that was aimed at less that of the state.
    """

    residual: float  # over its standard deviation [1]
    by_parameters: Array  # shape (parameter,)
    by_theta: float


def prior(model: LoopModel, window: Window) -> float:
    """The residual that what is known of the start adds [1]; 0 where nothing is."""
    if not 0.0 < window.theta_sd < math.inf:
        return 0.0
    model = model.in_test(window.test)
    said = model.at_peak(window.theta) if window.lean_read else window.theta
    return (window.theta_prior - said) / window.theta_sd


class Ends(NamedTuple):
    """Models a difference away in one parameter, by their index; 0 is the one that is not moved."""

    up: int
    down: int
    apart: float  # how far they are apart, in scales of the parameter
    above: float  # how much of that is above

    @property
    def beside(self) -> bool:
        """Whether both are moved."""
        return self.up != 0 and self.down != 0


def priors(models: Sequence[LoopModel], ends: Sequence[Ends], windows: Sequence[Window]) -> list[Prior | None]:
    """Of each window; `models` and `ends` of `about`."""
    out: list[Prior | None] = []
    for w in windows:
        if not 0.0 < w.theta_sd < math.inf:
            out.append(None)
            continue
        each = [prior(model, w) for model in models]
        slope = float(models[0].in_test(w.test).reading_slope(w.theta)) if w.lean_read else 1.0
        rows = np.array([(each[e.up] - each[e.down]) / e.apart for e in ends])
        out.append(Prior(each[0], rows, -slope / w.theta_sd))
    return out


@dataclass(frozen=True)
class Linear:
    """Residuals and their derivatives, by window: by the inner parameters and by the state at the start."""

    residuals: list[Array]
    by_parameters: list[Array]  # shape (sample, parameter)
    by_state: list[Array]  # shape (sample, 2)
    priors: list[Prior | None]


def linearised(
    simulator: Simulator,
    model: LoopModel,
    parameters: Sequence[Parameter],
    windows: Sequence[Window],
    *,
    central: bool = True,
    cautious: bool = False,
    read: Sequence[Array] | None = None,
) -> Linear:
    """Residuals of all windows and their derivatives by differences: central ones, or one-sided at a bound.

    central: False for one-sided differences everywhere, which cost half and serve a step of a fit.
    cautious: where a window moves otherwise to one side than to the other, as one does whose contacts chatter, the
        slope by a parameter is the smallest of both and their mean: two ways to go are no slope.
    read: what the channels read there, if that is known.
    """
    n = len(windows)
    models, ends = about(model, parameters, central)
    shifts = [(THETA_STEP, 0.0), (0.0, OMEGA_STEP)]
    shifts += [(-theta, -omega) for theta, omega in shifts] if central else []
    # What is known of a state has no slope, and its runs are spared.
    free = [[i for i, w in enumerate(windows) if k in free_states(w)] for k in range(2)]
    known = [] if read is None else [*read]
    jobs = [job for k in range(0 if read is None else 1, len(models)) for job in jobs_of(windows, k)]
    there = [*windows] * (len(models) - (read is not None))
    for k, shift in enumerate(shifts):
        of_these = [windows[i] for i in free[k % 2]]
        jobs += jobs_of(of_these, 0, *shift)
        there += of_these
    every = known + observe(simulator, models, jobs, there)
    moved = iter(every[len(models) * n :])
    every = every[: len(models) * n]
    for k in range(len(shifts)):
        seen = {i: next(moved) for i in free[k % 2]}
        every += [seen.get(i, every[i]) for i in range(n)]
    r = left_over(every, windows, len(models) + len(shifts))
    first = len(models)
    state = [(first, first + 2 if central else 0, THETA_STEP), (first + 1, first + 3 if central else 0, OMEGA_STEP)]
    width = 2.0 if central else 1.0
    by_state = [
        np.column_stack([(r[a][i] - r[b][i]) / (width * step) for a, b, step in state]) for i in range(n)
    ]  # fmt: skip
    return Linear(r[0], slopes(r, ends, cautious), by_state, priors(models, ends, windows))


def about(model: LoopModel, parameters: Sequence[Parameter], central: bool) -> tuple[list[LoopModel], list[Ends]]:
    """A model and those a difference away, and which of them belong to each parameter."""
    models, ends = [model], []
    for p in parameters:
        at, step = p.inner(model.get(p.name)), p.coarser * STEP
        up, down = p.outer(at + step), p.outer(at - step)
        if not central:
            up, down = (up, p.outer(at)) if p.inner(up) > at else (p.outer(at), down)
        place = []
        for value in (up, down):
            place.append(0 if value == model.get(p.name) else len(models))
            models += [model.changed({p.name: value})] if place[-1] else []
        ends.append(Ends(place[0], place[1], p.inner(up) - p.inner(down), p.inner(up) - at))
    return models, ends


def left_over(read: Sequence[Array], windows: Sequence[Window], count: int) -> list[list[Array]]:
    """Weighted residuals of so many runs of all windows."""
    n = len(windows)
    r = [[(w.data - read[k * n + i]) * w.weights for i, w in enumerate(windows)] for k in range(count)]
    for i in (i for i, w in enumerate(windows) if w.sides is not None):
        # What one of the runs cannot compare, none does: a derivative would mistake it for a jump.
        apart = np.any([np.isnan(r[k][i]) for k in range(count)], axis=0)
        for k in range(count):
            r[k][i] = np.where(apart, 1.0, r[k][i])
    return r


def slopes(r: Sequence[Sequence[Array]], ends: Sequence[Ends], cautious: bool = False) -> list[Array]:
    """Derivatives by the parameters, by window, shape (sample, parameter); `cautious` as of `linearised`."""
    one = _smallest if cautious else _chord
    return [
        np.column_stack([one([own[i] for own in r], e) for e in ends]) if ends else np.zeros((r[0][i].size, 0))
        for i in range(len(r[0]))
    ]


def _chord(r: Sequence[Array], e: Ends) -> Array:
    return np.asarray((r[e.up] - r[e.down]) / e.apart)


def _smallest(r: Sequence[Array], e: Ends) -> Array:
    """The chord, or where the slopes to both sides are not alike the smallest of the three."""
    chord = _chord(r, e)
    if not e.beside:
        return chord
    above, below = (r[e.up] - r[0]) / e.above, (r[0] - r[e.down]) / (e.apart - e.above)
    each = (chord, above, below)
    size = [float(np.linalg.norm(x)) for x in each]
    unlike = np.linalg.norm(above - below) > UNLIKE * min(size)
    return np.asarray(each[int(np.argmin(size))]) if unlike else chord


def weights_of(r: Sequence[Array], huber: float, whole: bool) -> Array:
    """Weight of each window: one within `huber` standard deviations, then falling with the rms, or its square."""
    rms = np.array([math.sqrt(float(np.mean(x * x))) if x.size else 0.0 for x in r])
    weights = np.minimum(1.0, huber / np.maximum(rms, 1e-30))
    return weights**2 if whole else weights


def objectives(
    model: LoopModel, r: Sequence[Array], windows: Sequence[Window], huber: float = HUBER, whole: bool = False
) -> Array:
    """Sum of squares of each window, less than that beyond `huber`, with the prior of its state.

    model: whose sensor reads the state at the start.
    whole: whether windows are whole records, which count by the logarithm.
    """
    out = np.empty(len(windows))
    for i, (x, w) in enumerate(zip(r, windows, strict=True)):
        square = float(x @ x)
        rms = math.sqrt(square / max(x.size, 1))
        if rms > huber:
            beyond = huber**2 * (1.0 + 2.0 * math.log(rms / huber)) if whole else 2.0 * huber * rms - huber**2
            square = x.size * beyond
        out[i] = square + prior(model, w) ** 2
    return out


def free_states(window: Window) -> list[int]:
    """Which of (theta, omega) at the start are unknown."""
    return [k for k, sd in enumerate((window.theta_sd, window.omega_sd)) if sd > 0.0]


@dataclass(frozen=True)
class _Projected:
    """One window with its states eliminated, and what gives them back."""

    A: Array  # derivatives by the parameters, less what the states can follow; shape (sample + prior, parameter)
    r: Array  # residual, likewise
    Q: Array  # orthonormal columns that the states can follow, shape (sample + prior, free)
    free: list[int]  # which of the states are free
    inverse: Array  # R^-1 of the states' derivatives
    QA: Array
    Qr: Array


def _projected(r: Array, A: Array, S: Array, window: Window, weight: float, known: Prior | None) -> _Projected:
    free = free_states(window)
    S = S[:, free]
    if known is not None:
        # It does not count less where the window does.
        share = 1.0 / math.sqrt(weight)
        A = np.vstack([A, share * known.by_parameters])
        r = np.append(r, share * known.residual)
        S = np.vstack([S, [share * known.by_theta if k == 0 else 0.0 for k in free]])
    if not free:
        nothing = np.zeros((r.size, 0))
        return _Projected(A, r, nothing, free, np.zeros((0, 0)), np.zeros((0, A.shape[1])), np.zeros(0))
    Q, R = np.linalg.qr(S)
    QA, Qr = Q.T @ A, Q.T @ r
    return _Projected(A - Q @ QA, r - Q @ Qr, Q, free, np.linalg.pinv(R), QA, Qr)


def reduced(lin: Linear, windows: Sequence[Window], weights: Array) -> tuple[Array, Array, list[_Projected]]:
    """Normal equations of the parameters with the states eliminated."""
    n = lin.by_parameters[0].shape[1] if lin.by_parameters else 0
    matrix, gradient, each = np.zeros((n, n)), np.zeros(n), []
    rows = zip(lin.residuals, lin.by_parameters, lin.by_state, windows, weights, lin.priors, strict=True)
    for r, A, S, w, weight, known in rows:
        part = _projected(r, A, S, w, weight, known)
        matrix += weight * (part.A.T @ part.A)
        gradient += weight * (part.A.T @ part.r)
        each.append(part)
    return matrix, gradient, each


def stepped(windows: Sequence[Window], each: Sequence[_Projected], step: Array) -> list[Window]:
    """The windows with the states that go with a step of the parameters."""
    out = []
    for w, part in zip(windows, each, strict=True):
        change = np.zeros(2)
        if part.free:
            change[part.free] = -part.inverse @ (part.Qr + part.QA @ step)
        limit = np.array([0.1, 1.0])
        change = np.clip(change, -limit, limit)
        out.append(w.moved(w.theta + change[0], w.omega + change[1]))
    return out
