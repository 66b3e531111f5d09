"""Least squares over windows, each with a state of its own that is eliminated: variable projection, window by window.

The sensitivities go through located impacts by central differences, which are clean because the events are located
and not stepped over.  Parameters may be fitted in a transformed scale (logarithm).  Windows whose residual is several
times the noise count less (Huber, by window), since a missing effect must not own the sum of squares.  Whole records
may be missed by a hundred times the noise, one for something else than all others: there the sum of squares goes on
as the logarithm, so that the parameters are those that explain most records and not those that miss one by less.

Source   Levenberg (1944), Marquardt (1963); Huber (1964); the logarithm: as Cauchy's likelihood has it; elimination of
         local unknowns: Schur complement; residuals of a record that go together: Liang & Zeger (1986), Biometrika 73.
Status   derivatives against each other at two steps, and recovery of planted parameters (tests).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studies.loop.keeping import Results, digest_of
from studies.loop.model import LoopModel
from studies.loop.observing import jobs_of, observe
from studies.loop.simulation import Simulator
from studies.loop.windows import Window

Array = NDArray[np.float64]

STEP = 2e-4
"""Step of a difference, in scales of the parameter."""

UNEVEN = 100.0
"""Times this for what a floor gives: no event is located there, and the steps of a run leave an error as uneven."""

REACH = 4.0
"""A step of a fit moves a logarithm by so many scales at the most: where it says little, its slope points anywhere."""

THETA_STEP, OMEGA_STEP = 2e-6, 2e-5
"""Steps of the state at the start of a window [rad, rad/s]."""

HUBER = 3.0
"""Windows with an rms beyond this many standard deviations count less."""

ROBUST = 4.0
"""The same for whole records, which count by the logarithm beyond it."""

DRAWN_IN = 10.0
"""And for fits of whole records by Huber's sum."""

POLISH = 4
"""Iterations by the logarithm after these."""

DISAGREEING = 1.2
"""Mean square over the variances from which records are missed by more than their noise."""


@dataclass(frozen=True)
class Parameter:
    """A parameter to fit: its full name, typical size of a change, bounds, and whether its logarithm is fitted.

    coarser: how many times the usual step is taken for its slope.
    """

    name: str
    scale: float
    low: float = -math.inf
    high: float = math.inf
    log: bool = False
    coarser: float = 1.0

    def inner(self, value: float) -> float:
        """The number that is fitted."""
        return math.log(value) / self.scale if self.log else value / self.scale

    def outer(self, number: float) -> float:
        """The parameter, within its bounds."""
        value = math.exp(min(number * self.scale, 700.0)) if self.log else number * self.scale
        return min(max(value, self.low), self.high)

    def slope(self, value: float) -> float:
        """Derivative of the parameter by the number that is fitted."""
        return value * self.scale if self.log else self.scale


@dataclass(frozen=True)
class Fit:
    """What came out of a fit."""

    model: LoopModel
    parameters: tuple[Parameter, ...]
    windows: tuple[Window, ...]  # with the fitted states
    chi2: float  # sum of squares over the variances, less for windows far off, prior included
    rms: float  # root mean square over the standard deviations, plain
    samples: int
    converged: bool
    residuals: tuple[Array, ...]  # weighted, by window
    whole: bool = False  # whether the windows are whole records

    @property
    def values(self) -> dict[str, float]:
        """Fitted values by full name."""
        return {p.name: self.model.get(p.name) for p in self.parameters}

    @property
    def by_window(self) -> Array:
        """Rms over the standard deviation, by window."""
        return np.array([math.sqrt(float(np.mean(r * r))) for r in self.residuals])

    @property
    def weights(self) -> Array:
        """How much each window counts [1]."""
        return _weights(self.residuals, ROBUST if self.whole else HUBER, self.whole)

    @property
    def spread(self) -> float:
        """Mean square over the variances, windows far off counting as little as in a fit; 1 or more."""
        squares = sum(w * float(r @ r) for w, r in zip(self.weights, self.residuals, strict=True))
        return max(1.0, squares / max(self.samples, 1))


def residuals(simulator: Simulator, model: LoopModel, windows: Sequence[Window]) -> list[Array]:
    """Weighted residuals of every window; what cannot be compared (`observe`) counts as the noise does, 1."""
    return _compared_all(_read(simulator, model, windows), windows)


def _read(simulator: Simulator, model: LoopModel, windows: Sequence[Window]) -> list[Array]:
    """What the channels of every window read."""
    return observe(simulator, [model], jobs_of(windows, 0), windows)


def _compared_all(read: Sequence[Array], windows: Sequence[Window]) -> list[Array]:
    return [_compared(w, x) for x, w in zip(read, windows, strict=True)]


def _compared(window: Window, read: Array) -> Array:
    r = (window.data - read) * window.weights
    return np.where(np.isnan(r), 1.0, r) if window.sides is not None else r


@dataclass(frozen=True)
class Linear:
    """Residuals and their derivatives, by window: by the inner parameters and by the state at the start."""

    residuals: list[Array]
    by_parameters: list[Array]  # shape (sample, parameter)
    by_state: list[Array]  # shape (sample, 2)


def linearised(
    simulator: Simulator,
    model: LoopModel,
    parameters: Sequence[Parameter],
    windows: Sequence[Window],
    *,
    central: bool = True,
    read: Sequence[Array] | None = None,
) -> Linear:
    """Residuals of all windows and their derivatives by differences: central ones, or one-sided at a bound.

    central: False for one-sided differences everywhere, which cost half and serve a step of a fit.
    read: what the channels read there, if that is known.
    """
    n = len(windows)
    models, ends = _about(model, parameters, central)
    known = [] if read is None else [*read]
    jobs = [job for k in range(0 if read is None else 1, len(models)) for job in jobs_of(windows, k)]
    shifts = [(THETA_STEP, 0.0), (0.0, OMEGA_STEP)]
    shifts += [(-theta, -omega) for theta, omega in shifts] if central else []
    for theta, omega in shifts:
        jobs += jobs_of(windows, 0, theta, omega)
    count = len(models) + len(shifts)
    every = known + observe(simulator, models, jobs, [*windows] * (count - (read is not None)))
    r = _left(every, windows, count)
    first = len(models)
    state = [(first, first + 2 if central else 0, THETA_STEP), (first + 1, first + 3 if central else 0, OMEGA_STEP)]
    width = 2.0 if central else 1.0
    by_state = [
        np.column_stack([(r[a][i] - r[b][i]) / (width * step) for a, b, step in state]) for i in range(n)
    ]  # fmt: skip
    return Linear(r[0], _slopes(r, ends), by_state)


def _about(
    model: LoopModel, parameters: Sequence[Parameter], central: bool
) -> tuple[list[LoopModel], list[tuple[int, int, float]]]:
    """A model and those a difference away; for each parameter the two to take apart, and how far they are apart."""
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
        ends.append((place[0], place[1], p.inner(up) - p.inner(down)))
    return models, ends


def _left(read: Sequence[Array], windows: Sequence[Window], count: int) -> list[list[Array]]:
    """Weighted residuals of so many runs of all windows."""
    n = len(windows)
    r = [[(w.data - read[k * n + i]) * w.weights for i, w in enumerate(windows)] for k in range(count)]
    for i in (i for i, w in enumerate(windows) if w.sides is not None):
        # What one of the runs cannot compare, none does: a derivative would mistake it for a jump.
        apart = np.any([np.isnan(r[k][i]) for k in range(count)], axis=0)
        for k in range(count):
            r[k][i] = np.where(apart, 1.0, r[k][i])
    return r


def _slopes(r: Sequence[Sequence[Array]], ends: Sequence[tuple[int, int, float]]) -> list[Array]:
    """Derivatives by the parameters, by window, shape (sample, parameter)."""
    return [
        np.column_stack([(r[a][i] - r[b][i]) / side for a, b, side in ends]) if ends else np.zeros((r[0][i].size, 0))
        for i in range(len(r[0]))
    ]


def _weights(r: Sequence[Array], huber: float, whole: bool) -> Array:
    """Weight of each window: one within `huber` standard deviations, then falling with the rms, or its square."""
    rms = np.array([math.sqrt(float(np.mean(x * x))) if x.size else 0.0 for x in r])
    weights = np.minimum(1.0, huber / np.maximum(rms, 1e-30))
    return weights**2 if whole else weights


def objectives(r: Sequence[Array], windows: Sequence[Window], huber: float = HUBER, whole: bool = False) -> Array:
    """Sum of squares of each window, less than that beyond `huber`, with the prior of its state.

    whole: whether windows are whole records, which count by the logarithm.
    """
    out = np.empty(len(windows))
    for i, (x, w) in enumerate(zip(r, windows, strict=True)):
        square = float(x @ x)
        rms = math.sqrt(square / max(x.size, 1))
        if rms > huber:
            beyond = huber**2 * (1.0 + 2.0 * math.log(rms / huber)) if whole else 2.0 * huber * rms - huber**2
            square = x.size * beyond
        out[i] = square
        if 0.0 < w.theta_sd < math.inf:
            out[i] += ((w.theta - w.theta_prior) / w.theta_sd) ** 2
    return out


def _free(window: Window) -> list[int]:
    """Which of (theta, omega) at the start are unknown."""
    return [k for k, sd in enumerate((window.theta_sd, window.omega_sd)) if sd > 0.0]


def _prior(window: Window, free: list[int]) -> tuple[Array, Array]:
    """Rows that the prior of the state adds: (derivative by the free states, residual)."""
    rows, values = [], []
    if 0 in free and window.theta_sd < math.inf:
        rows.append([-1.0 / window.theta_sd if k == 0 else 0.0 for k in free])
        values.append((window.theta_prior - window.theta) / window.theta_sd)
    return np.array(rows).reshape(len(rows), len(free)), np.array(values)


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


def _projected(r: Array, A: Array, S: Array, window: Window, weight: float) -> _Projected:
    free = _free(window)
    rows, values = _prior(window, free)
    A = np.vstack([A, np.zeros((len(values), A.shape[1]))])
    r = np.concatenate([r, values / math.sqrt(weight)])
    if not free:
        nothing = np.zeros((r.size, 0))
        return _Projected(A, r, nothing, free, np.zeros((0, 0)), np.zeros((0, A.shape[1])), np.zeros(0))
    Q, R = np.linalg.qr(np.vstack([S[:, free], rows / math.sqrt(weight)]))
    QA, Qr = Q.T @ A, Q.T @ r
    return _Projected(A - Q @ QA, r - Q @ Qr, Q, free, np.linalg.pinv(R), QA, Qr)


def _reduced(lin: Linear, windows: Sequence[Window], weights: Array) -> tuple[Array, Array, list[_Projected]]:
    """Normal equations of the parameters with the states eliminated."""
    n = lin.by_parameters[0].shape[1] if lin.by_parameters else 0
    matrix, gradient, each = np.zeros((n, n)), np.zeros(n), []
    for r, A, S, w, weight in zip(lin.residuals, lin.by_parameters, lin.by_state, windows, weights, strict=True):
        part = _projected(r, A, S, w, weight)
        matrix += weight * (part.A.T @ part.A)
        gradient += weight * (part.A.T @ part.r)
        each.append(part)
    return matrix, gradient, each


def _stepped(windows: Sequence[Window], each: Sequence[_Projected], step: Array) -> list[Window]:
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


def fit(
    simulator: Simulator,
    model: LoopModel,
    parameters: Sequence[Parameter],
    windows: Sequence[Window],
    *,
    huber: float | None = None,
    whole: bool = False,
    iterations: int = 15,
    tolerance: float = 1e-3,
    start_damping: float = 1e-3,
    central: bool = False,
) -> Fit:
    """Fit the parameters and the states at the starts of the windows.

    Args:
        simulator, model: where to start; effects of the parameters are in it.
        parameters: what to fit; none fits the states alone.
        windows: with states to start from.
        huber: rms of a window beyond which it counts less; `HUBER`, or `ROBUST` for whole records, if not given; inf
            for plain least squares.
        whole: whether windows are whole records, which count by the logarithm beyond that.
        iterations: the most that are done.
        tolerance: a relative fall of the sum of squares below which the fit has converged.
        central: whether slopes are central differences; whole records bend too much for one-sided ones.

    Returns:
        Fit: the best point that was met.
    """
    if huber is None:
        huber = ROBUST if whole else HUBER
    how = _How(huber, whole, iterations, tolerance, start_damping, central)
    if simulator.keeper is None:
        return _fit(simulator, model, parameters, windows, how)
    key = digest_of("fit", simulator.digest, model, tuple(parameters), tuple(windows), how)
    kept = simulator.keeper.read(key)
    if kept is not None:
        return _restored(kept, model, parameters, windows, whole)
    found = _fit(simulator, model, parameters, windows, how)
    simulator.keeper.write(key, _results(found))
    return found


def fit_records(
    simulator: Simulator, model: LoopModel, parameters: Sequence[Parameter], windows: Sequence[Window], *,
    iterations: int = 15, again: bool = True,
) -> Fit:  # fmt: skip
    """Fit whole records, those far off counting by the logarithm.

    A record that is lost at the start may stay so, since it hardly counts: if one is lost at the end, the fit begins
    again where Huber's sum draws it in.

    again: False to leave that out.
    """
    found = fit(simulator, model, parameters, windows, whole=True, iterations=iterations, central=True)
    if not parameters or not again or found.by_window.max(initial=0.0) < ROBUST:
        return found
    drawn = fit(simulator, model, parameters, windows, huber=DRAWN_IN, iterations=iterations, central=True)
    other = fit(simulator, drawn.model, parameters, drawn.windows, whole=True, iterations=POLISH, central=True)
    return min(found, other, key=lambda f: f.chi2)


@dataclass(frozen=True)
class _How:
    """Options of a fit."""

    huber: float
    whole: bool
    iterations: int
    tolerance: float
    start_damping: float
    central: bool


def _results(found: Fit) -> dict[str, Array]:
    """A fit as arrays."""
    return {
        "values": np.array([found.model.get(p.name) for p in found.parameters]),
        "states": np.array([(w.theta, w.omega) for w in found.windows]).reshape(len(found.windows), 2),
        "numbers": np.array([found.chi2, found.rms, found.samples, found.converged]),
        "sizes": np.array([r.size for r in found.residuals], dtype=np.int64),
        "residuals": np.concatenate([np.zeros(0), *found.residuals]),
    }


def _restored(
    kept: Results, model: LoopModel, parameters: Sequence[Parameter], windows: Sequence[Window], whole: bool
) -> Fit:
    """The fit that was kept as arrays."""
    values = {p.name: float(v) for p, v in zip(parameters, kept["values"], strict=True)}
    moved = [w.moved(float(a), float(b)) for w, (a, b) in zip(windows, kept["states"], strict=True)]
    chi2, rms, samples, converged = kept["numbers"]
    each = np.split(kept["residuals"], np.cumsum(kept["sizes"])[:-1]) if windows else []
    return Fit(
        model.changed(values), tuple(parameters), tuple(moved), float(chi2), float(rms), int(samples),
        bool(converged), tuple(each), whole,
    )  # fmt: skip


def _fit(
    simulator: Simulator, model: LoopModel, parameters: Sequence[Parameter], windows: Sequence[Window], how: _How
) -> Fit:
    windows = list(windows)
    damping, converged = how.start_damping, False
    read = _read(simulator, model, windows)
    for _ in range(how.iterations):
        lin = linearised(simulator, model, parameters, windows, central=how.central, read=read)
        each = objectives(lin.residuals, windows, how.huber, how.whole)
        objective = float(each.sum())
        weights = _weights(lin.residuals, how.huber, how.whole)
        matrix, gradient, back = _reduced(lin, windows, weights)
        accepted = False
        for _ in range(8):
            step = _solve(matrix, gradient, damping)
            values = _moved(model, parameters, step)
            actual = np.array([
                p.inner(values[p.name]) - p.inner(model.get(p.name)) for p in parameters
            ])  # fmt: skip
            try:
                trial = model.changed(values)
                better = _better(simulator, trial, windows, _stepped(windows, back, actual), each, how)
            except ValueError:
                damping = max(damping, 1e-6) * 10.0
                continue
            if better.objective < objective:
                accepted = True
                break
            damping = max(damping, 1e-6) * 10.0
            if damping > 1e8:
                break
        if not accepted:
            converged = True
            break
        fall = (objective - better.objective) / max(better.objective, 1e-30)
        model, windows, read = trial, better.windows, better.read
        damping = max(damping * 0.2, 1e-9)
        if fall < how.tolerance:
            converged = True
            break
    left = _compared_all(read, windows)
    joined = np.concatenate(left) if left else np.zeros(0)
    return Fit(
        model, tuple(parameters), tuple(windows), float(objectives(left, windows, how.huber, how.whole).sum()),
        math.sqrt(float(np.mean(joined**2))) if joined.size else math.nan, joined.size, converged, tuple(left),
        how.whole,
    )  # fmt: skip


@dataclass(frozen=True)
class _Better:
    """Windows with states that are no worse than they were, what their channels read, and the sum of squares."""

    windows: list[Window]
    read: list[Array]
    objective: float


def _better(
    simulator: Simulator, model: LoopModel, windows: Sequence[Window], stepped: Sequence[Window], before: Array,
    how: _How,
) -> _Better:  # fmt: skip
    """Of each window the stepped state, or a shorter step or none where that is better.

    A window whose linearisation says nothing (an impact on the wrong side of a sample) would else stop all others.
    """
    chosen = list(stepped)
    read = _read(simulator, model, chosen)
    each = objectives(_compared_all(read, chosen), chosen, how.huber, how.whole)
    for share in (0.25, 0.0):
        worse = np.flatnonzero(each > before)
        if not worse.size:
            break
        other = [
            windows[i].moved(
                windows[i].theta + share * (stepped[i].theta - windows[i].theta),
                windows[i].omega + share * (stepped[i].omega - windows[i].omega),
            )
            for i in map(int, worse)
        ]  # fmt: skip
        there = _read(simulator, model, other)
        found = objectives(_compared_all(there, other), other, how.huber, how.whole)
        for i, window, seen, value in zip(worse, other, there, found, strict=True):
            if value < each[i]:
                chosen[i], read[i], each[i] = window, seen, value
    return _Better(chosen, read, float(each.sum()))


def _solve(matrix: Array, gradient: Array, damping: float) -> Array:
    if not gradient.size:
        return np.zeros(0)
    scale = np.sqrt(np.maximum(np.diag(matrix), 1e-30))
    normal = matrix / np.outer(scale, scale)
    return np.asarray(-np.linalg.lstsq(normal + damping * np.eye(len(scale)), gradient / scale, rcond=1e-12)[0] / scale)


def _moved(model: LoopModel, parameters: Sequence[Parameter], step: Array) -> dict[str, float]:
    moved = (min(max(float(d), -REACH), REACH) if p.log else float(d) for p, d in zip(parameters, step, strict=True))
    return {p.name: p.outer(p.inner(model.get(p.name)) + d) for p, d in zip(parameters, moved, strict=True)}


def sensor_covariance(simulator: Simulator, found: Fit) -> Array:
    """Covariance of the fitted parameters by the sensors' noise alone, shape (parameter, parameter).

    In the outer scale.  A fit that is worse than the noise has parameters that are less sure than the noise says.
    """
    lin = linearised(simulator, found.model, found.parameters, found.windows, central=False)
    matrix, _, _ = _reduced(lin, found.windows, found.weights)
    scale = _scales(found)
    spread = found.spread if found.whole else max(1.0, found.rms**2)
    return np.asarray(spread * np.linalg.pinv(matrix) * np.outer(scale, scale), dtype=np.float64)


def _scales(found: Fit) -> Array:
    """Derivatives of the outer by the inner numbers."""
    return np.array([p.slope(found.model.get(p.name)) for p in found.parameters])


def gains(
    simulator: Simulator,
    fitted: Fit,
    candidates: Mapping[str, Sequence[Parameter]],
    model_of: Mapping[str, LoopModel],
    huber: float = HUBER,
) -> dict[str, float]:
    """Score test: by how much each candidate would lower chi-square, to first order from the fit that lacks it.

    What the fitted parameters and the states can absorb is projected off first.

    Args:
        fitted: the fit without the candidates.
        candidates: parameters by candidate.
        model_of: for each candidate the model with its effect in it, at its absent value.
        huber: as of the fit.

    Returns:
        The gain by candidate; infinite for one that does not run at its absent value or a difference away from it.
    """
    weights, windows = _weights(fitted.residuals, huber, False), fitted.windows
    plain = linearised(simulator, fitted.model, fitted.parameters, windows)
    k, out = len(fitted.parameters), {}
    for name, parameters in candidates.items():
        try:
            models, ends = _about(model_of[name], parameters, True)
            if all(up and down for up, down, _ in ends):  # no slope is one-sided
                models, ends = models[1:], [(up - 1, down - 1, side) for up, down, side in ends]
            read = [x for model in models for x in _read(simulator, model, windows)]
        except ValueError:
            out[name] = math.inf
            continue
        own = _slopes(_left(read, windows, len(models)), ends)
        both = [np.hstack(pair) for pair in zip(plain.by_parameters, own, strict=True)]
        matrix, gradient, _ = _reduced(Linear(plain.residuals, both, plain.by_state), windows, weights)
        inverse = np.linalg.pinv(matrix[:k, :k]) if k else np.zeros((0, 0))
        left = matrix[k:, k:] - matrix[k:, :k] @ inverse @ matrix[:k, k:]
        g = gradient[k:] - matrix[k:, :k] @ inverse @ gradient[:k]
        out[name] = float(g @ np.linalg.pinv(left, rcond=1e-10) @ g)
    return out


def robust_covariance(simulator: Simulator, noisy: Simulator, found: Fit) -> Array:
    """Covariance of the fitted parameters when base noise moves the responses too: the sandwich estimator.

    Under the fitted model each record is answered again under redrawn base noise; what that does to the gradient is
    put between two inverses of the information.  Windows are taken as independent.  Where the model misses records by
    more than the noise, what it misses goes together within a record: the gradients that the records leave, one against
    another, are put between as well; of too few records the whole is taken times the mean square that is left.  The
    information of a record that counts less is that of its weight, somewhat more than it has.

    Args:
        simulator: of the fit.
        noisy: of `spread.redrawn`, of the same tests.
        found: the fit.

    Returns:
        Covariance in the outer scale, shape (parameter, parameter).
    """
    windows, model = found.windows, found.model
    lin = linearised(simulator, model, found.parameters, windows)
    weights = _weights(lin.residuals, ROBUST if found.whole else HUBER, found.whole)
    matrix, _, each = _reduced(lin, windows, weights)
    count = len(simulator.tests)
    draws = len(noisy.tests) // count
    jobs = jobs_of(windows, 0)
    for k in range(draws):
        jobs += [replace(job, test=count * (k + 1) + job.test) for job in jobs_of(windows, 0)]
    read = observe(Simulator.joined(simulator, noisy), [model], jobs, [*windows] * (draws + 1))
    meat, n = np.zeros_like(matrix), len(windows)
    for i, (w, part, weight) in enumerate(zip(windows, each, weights, strict=True)):
        sensor = (w.noise * w.weights) ** 2
        own = part.A[: w.data.size]
        meat += weight**2 * (own.T * sensor) @ own
        for k in range(draws):
            moved = np.nan_to_num((read[(k + 1) * n + i] - read[i]) * w.weights)
            g = weight * (own.T @ moved)
            meat += np.outer(g, g) / draws
    records, beside = sorted({w.record for w in windows}), found.spread
    if found.spread > DISAGREEING and len(records) > len(found.parameters):
        beside = 1.0
        for record in records:
            of_it = [(p, k) for p, w, k in zip(each, windows, weights, strict=True) if w.record == record]
            g = np.sum([k * (p.A.T @ p.r) for p, k in of_it], axis=0)
            meat += len(records) / (len(records) - len(found.parameters)) * np.outer(g, g)
    inverse = np.linalg.pinv(matrix)
    scale = _scales(found)
    return np.asarray(beside * (inverse @ meat @ inverse) * np.outer(scale, scale), dtype=np.float64)
