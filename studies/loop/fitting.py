"""Least squares over windows, each with a state of its own that is eliminated: variable projection, window by window.

The sensitivities go through located impacts by central differences, which are clean because the events are located
and not stepped over.  Parameters may be fitted in a transformed scale (logarithm).  Windows whose residual is several
times the noise count less (Huber, by window), since a missing effect must not own the sum of squares.

Source   Levenberg (1944), Marquardt (1963); Huber (1964); elimination of local unknowns: Schur complement.
Status   derivatives against each other at two steps, and recovery of planted parameters (tests).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studies.loop.model import LoopModel
from studies.loop.simulation import Answer, Job, Simulator
from studies.loop.windows import Window

Array = NDArray[np.float64]

STEP = 2e-4
"""Step of a difference, in scales of the parameter."""

THETA_STEP, OMEGA_STEP = 2e-6, 2e-5
"""Steps of the state at the start of a window [rad, rad/s]."""

HUBER = 3.0
"""Windows with an rms beyond this many standard deviations count less."""


@dataclass(frozen=True)
class Parameter:
    """A parameter to fit: its full name, typical size of a change, bounds, and whether its logarithm is fitted."""

    name: str
    scale: float
    low: float = -math.inf
    high: float = math.inf
    log: bool = False

    def inner(self, value: float) -> float:
        """The number that is fitted."""
        return math.log(value) / self.scale if self.log else value / self.scale

    def outer(self, number: float) -> float:
        """The parameter, within its bounds."""
        value = math.exp(number * self.scale) if self.log else number * self.scale
        return min(max(value, self.low), self.high)


@dataclass(frozen=True)
class Fit:
    """What came out of a fit."""

    model: LoopModel
    parameters: tuple[Parameter, ...]
    windows: tuple[Window, ...]  # with the fitted states
    chi2: float  # sum of squares over the variances, Huber's for windows far off, prior included
    rms: float  # root mean square over the standard deviations, plain
    samples: int
    covariance: Array  # of the parameters in their outer scale
    converged: bool
    residuals: tuple[Array, ...]  # weighted, by window

    @property
    def values(self) -> dict[str, float]:
        """Fitted values by full name."""
        return {p.name: self.model.get(p.name) for p in self.parameters}

    @property
    def by_window(self) -> Array:
        """Rms over the standard deviation, by window."""
        return np.array([math.sqrt(float(np.mean(r * r))) for r in self.residuals])


def _jobs(windows: Sequence[Window], model: int, d_theta: float = 0.0, d_omega: float = 0.0) -> list[Job]:
    return [Job(model, w.test, w.times, w.start, w.theta + d_theta, w.omega + d_omega) for w in windows]


def _residual(model: LoopModel, answer: Answer, window: Window) -> Array:
    return np.asarray((window.data - model.reading(answer.theta)) * window.weights)


def residuals(simulator: Simulator, model: LoopModel, windows: Sequence[Window]) -> list[Array]:
    """Weighted residuals of every window."""
    answers = simulator.run([model], _jobs(windows, 0))
    return [_residual(model, a, w) for a, w in zip(answers, windows, strict=True)]


@dataclass(frozen=True)
class Linear:
    """Residuals and their derivatives, by window: by the inner parameters and by the state at the start."""

    residuals: list[Array]
    by_parameters: list[Array]  # shape (sample, parameter)
    by_state: list[Array]  # shape (sample, 2)


def linearised(
    simulator: Simulator, model: LoopModel, parameters: Sequence[Parameter], windows: Sequence[Window]
) -> Linear:
    """Residuals of all windows and their derivatives by central differences (one-sided at a bound)."""
    models, sides = [model], []
    for p in parameters:
        at = p.inner(model.get(p.name))
        ends = [p.outer(at + STEP), p.outer(at - STEP)]
        sides.append(p.inner(ends[0]) - p.inner(ends[1]))
        models += [model.changed({p.name: value}) for value in ends]
    jobs = [job for k in range(len(models)) for job in _jobs(windows, k)]
    for theta, omega in ((THETA_STEP, 0.0), (-THETA_STEP, 0.0), (0.0, OMEGA_STEP), (0.0, -OMEGA_STEP)):
        jobs += _jobs(windows, 0, theta, omega)
    answers, n = simulator.run(models, jobs), len(windows)
    own = [model, *models[1:], model, model, model, model]
    r = [[_residual(own[k], answers[k * n + i], w) for i, w in enumerate(windows)] for k in range(len(own))]
    first = len(models)
    by_parameters = [
        np.column_stack([(r[1 + 2 * j][i] - r[2 + 2 * j][i]) / side for j, side in enumerate(sides)])
        if sides else np.zeros((r[0][i].size, 0))
        for i in range(n)
    ]  # fmt: skip
    by_state = [
        np.column_stack([
            (r[first][i] - r[first + 1][i]) / (2.0 * THETA_STEP),
            (r[first + 2][i] - r[first + 3][i]) / (2.0 * OMEGA_STEP),
        ])
        for i in range(n)
    ]  # fmt: skip
    return Linear(r[0], by_parameters, by_state)


def _weights(r: Sequence[Array], huber: float) -> Array:
    """Weight of each window: one within `huber` standard deviations, then falling as Huber's."""
    rms = np.array([math.sqrt(float(np.mean(x * x))) if x.size else 0.0 for x in r])
    return np.minimum(1.0, huber / np.maximum(rms, 1e-30))


def _objective(r: Sequence[Array], windows: Sequence[Window], huber: float) -> float:
    """Huber's sum of squares by window, and the priors of the states."""
    total = 0.0
    for x, w in zip(r, windows, strict=True):
        square = float(x @ x)
        rms = math.sqrt(square / max(x.size, 1))
        total += square if rms <= huber else x.size * (2.0 * huber * rms - huber**2)
        if 0.0 < w.theta_sd < math.inf:
            total += ((w.theta - w.theta_prior) / w.theta_sd) ** 2
    return total


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
    huber: float = HUBER,
    iterations: int = 15,
    tolerance: float = 1e-3,
    start_damping: float = 1e-3,
    give_up: float = math.inf,
) -> Fit:
    """Fit the parameters and the states at the starts of the windows.

    Args:
        simulator, model: where to start; effects of the parameters are in it.
        parameters: what to fit; none fits the states alone.
        windows: with states to start from.
        huber: see above; inf for plain least squares.
        iterations: the most that are done.
        tolerance: a relative fall of the sum of squares below which the fit has converged.
        give_up: after three iterations, stop if the sum of squares is above this.

    Returns:
        Fit: the best point that was met.
    """
    windows = list(windows)
    damping, converged = start_damping, False
    objective, lin = math.inf, None
    for iteration in range(iterations):
        lin = linearised(simulator, model, parameters, windows)
        objective = _objective(lin.residuals, windows, huber)
        if iteration >= 3 and objective > give_up:
            break
        weights = _weights(lin.residuals, huber)
        matrix, gradient, back = _reduced(lin, windows, weights)
        accepted = False
        for _ in range(8):
            step = _solve(matrix, gradient, damping)
            values = _moved(model, parameters, step)
            actual = np.array([
                p.inner(values[p.name]) - p.inner(model.get(p.name)) for p in parameters
            ])  # fmt: skip
            trial_windows = _stepped(windows, back, actual)
            try:
                trial = model.changed(values)
                r = residuals(simulator, trial, trial_windows)
            except ValueError:
                damping = max(damping, 1e-6) * 10.0
                continue
            found = _objective(r, trial_windows, huber)
            if found < objective:
                accepted = True
                break
            damping = max(damping, 1e-6) * 10.0
            if damping > 1e8:
                break
        if not accepted:
            converged = True
            break
        fall = (objective - found) / max(found, 1e-30)
        model, windows, objective = trial, trial_windows, found
        damping = max(damping * 0.2, 1e-9)
        if fall < tolerance:
            converged = True
            break
    return _result(simulator, model, parameters, windows, huber, converged)


def _solve(matrix: Array, gradient: Array, damping: float) -> Array:
    if not gradient.size:
        return np.zeros(0)
    scale = np.sqrt(np.maximum(np.diag(matrix), 1e-30))
    normal = matrix / np.outer(scale, scale)
    return np.asarray(-np.linalg.lstsq(normal + damping * np.eye(len(scale)), gradient / scale, rcond=1e-12)[0] / scale)


def _moved(model: LoopModel, parameters: Sequence[Parameter], step: Array) -> dict[str, float]:
    return {p.name: p.outer(p.inner(model.get(p.name)) + d) for p, d in zip(parameters, step, strict=True)}


def _result(
    simulator: Simulator, model: LoopModel, parameters: Sequence[Parameter], windows: list[Window], huber: float,
    converged: bool,
) -> Fit:  # fmt: skip
    lin = linearised(simulator, model, parameters, windows)
    weights = _weights(lin.residuals, huber)
    matrix, _, _ = _reduced(lin, windows, weights)
    joined = np.concatenate(lin.residuals) if lin.residuals else np.zeros(0)
    # A fit that is worse than the noise has parameters that are less sure than the noise says.
    spread = max(1.0, float(np.mean(joined**2))) if joined.size else 1.0
    scale = np.array([_slope(p, model.get(p.name)) for p in parameters])
    covariance: Array = np.zeros((0, 0))
    if parameters:
        covariance = np.asarray(spread * np.linalg.pinv(matrix) * np.outer(scale, scale), dtype=np.float64)
    return Fit(
        model, tuple(parameters), tuple(windows), _objective(lin.residuals, windows, huber),
        math.sqrt(float(np.mean(joined**2))) if joined.size else math.nan, joined.size, covariance, converged,
        tuple(lin.residuals),
    )  # fmt: skip


def _slope(p: Parameter, value: float) -> float:
    """Derivative of the outer by the inner number."""
    return value * p.scale if p.log else p.scale


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
    """
    weights = _weights(fitted.residuals, huber)
    out = {}
    for name, parameters in candidates.items():
        every = (*fitted.parameters, *parameters)
        lin = linearised(simulator, model_of[name], every, fitted.windows)
        matrix, gradient, _ = _reduced(lin, fitted.windows, weights)
        k = len(fitted.parameters)
        inverse = np.linalg.pinv(matrix[:k, :k]) if k else np.zeros((0, 0))
        left = matrix[k:, k:] - matrix[k:, :k] @ inverse @ matrix[:k, k:]
        g = gradient[k:] - matrix[k:, :k] @ inverse @ gradient[:k]
        out[name] = float(g @ np.linalg.pinv(left, rcond=1e-10) @ g)
    return out


def robust_covariance(simulator: Simulator, noisy: Simulator, found: Fit) -> Array:
    """Covariance of the fitted parameters when base noise moves the responses too: the sandwich estimator.

    Under the fitted model each record is answered again under redrawn base noise; what that does to the gradient is
    put between two inverses of the information.  Windows are taken as independent.

    Args:
        simulator: of the fit.
        noisy: of `spread.redrawn`, of the same tests.
        found: the fit.

    Returns:
        Covariance in the outer scale, shape (parameter, parameter).
    """
    windows, model = found.windows, found.model
    lin = linearised(simulator, model, found.parameters, windows)
    weights = _weights(lin.residuals, HUBER)
    matrix, _, each = _reduced(lin, windows, weights)
    count = len(simulator.tests)
    draws = len(noisy.tests) // count
    jobs = _jobs(windows, 0) + [
        Job(0, k * count + w.test, w.times, w.start, w.theta, w.omega) for k in range(draws) for w in windows
    ]
    runner = Simulator.joined(simulator, noisy)
    shifted = [Job(0, job.test + (count if i >= len(windows) else 0), *_rest(job)) for i, job in enumerate(jobs)]
    answers = runner.run([model], shifted)
    meat, n = np.zeros_like(matrix), len(windows)
    for i, (w, part, weight) in enumerate(zip(windows, each, weights, strict=True)):
        sensor = (w.noise * w.weights) ** 2
        own = part.A[: w.times.size]
        meat += weight**2 * (own.T * sensor) @ own
        for k in range(draws):
            moved = (answers[(k + 1) * n + i].theta - answers[i].theta) * w.weights
            g = weight * (own.T @ moved)
            meat += np.outer(g, g) / draws
    inverse = np.linalg.pinv(matrix)
    scale = np.array([_slope(p, model.get(p.name)) for p in found.parameters])
    return np.asarray(inverse @ meat @ inverse * np.outer(scale, scale), dtype=np.float64)


def _rest(job: Job) -> tuple[Array, float, float, float]:
    return job.times, job.start, job.theta, job.omega
