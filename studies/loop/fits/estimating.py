"""What a fit says of its parameters: how sure they are, and what another one would gain.

Source   score test: Rao (1948); sandwich estimator: Huber (1967); residuals of a record that go together: Liang & Zeger
         (1986), Biometrika 73.
Status   scores against refits, and covariances against the spread of many fits (tests).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from studies.loop.fits.fitting import Fit
from studies.loop.fits.linearising import (
    HUBER,
    ROBUST,
    Linear,
    Prior,
    about,
    left_over,
    linearised,
    priors,
    read_of,
    reduced,
    slopes,
    weights_of,
)
from studies.loop.models.model import LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.observing import jobs_of, observe
from studies.loop.runs.at_once import at_once
from studies.loop.runs.simulation import Simulator

Array = NDArray[np.float64]

DISAGREEING = 1.2
"""Mean square over the variances from which records are missed by more than their noise."""


def sensor_covariance(simulator: Simulator, found: Fit) -> Array:
    """Covariance of the fitted parameters by the sensors' noise alone, shape (parameter, parameter).

    In the outer scale, slopes cautious as of `robust_covariance`.  A fit that is worse than the noise has parameters
    that are less sure than the noise says.
    """
    lin = linearised(simulator, found.model, found.parameters, found.windows, cautious=True)
    matrix, _, _ = reduced(lin, found.windows, found.weights)
    scale = scales(found)
    spread = found.spread if found.whole else max(1.0, found.rms**2)
    return np.asarray(spread * np.linalg.pinv(matrix) * np.outer(scale, scale), dtype=np.float64)


def scales(found: Fit) -> Array:
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
    plain = linearised(simulator, fitted.model, fitted.parameters, fitted.windows)

    def gained(name: str) -> float:
        beside = _slopes_beside(simulator, fitted, model_of[name], candidates[name])
        return math.inf if beside is None else _gained(fitted, plain, *beside, huber)

    return dict(zip(candidates, at_once([partial(gained, name) for name in candidates]), strict=True))


def gains_of_changes(
    simulator: Simulator,
    fitted: Fit,
    candidates: Mapping[str, Sequence[Parameter]],
    model_of: Mapping[str, LoopModel],
    courses: Mapping[str, Array],
    huber: float = HUBER,
) -> dict[tuple[str, str], float]:
    """Score test of parameters that change in the course of a campaign, as of `gains`.

    Args:
        fitted: the fit without the candidates.
        candidates: parameters by candidate, each with a change of its own.
        model_of: for each candidate the model with its effect in it, at its absent value or as fitted.
        courses: by how much of itself a change has come about in each test, by course; shape (test,).
        huber: as of the fit.

    Returns:
        The gain by candidate and course; none of a candidate that does not run there.
    """
    plain = linearised(simulator, fitted.model, fitted.parameters, fitted.windows)
    tests = [w.test for w in fitted.windows]

    def gained(name: str) -> dict[tuple[str, str], float]:
        beside, out = _slopes_beside(simulator, fitted, model_of[name], candidates[name]), {}
        if beside is None:
            return {}
        own, known = beside
        for course, share in courses.items():
            changed = [np.hstack([x, share[test] * x]) for x, test in zip(own, tests, strict=True)]
            priors_changed = [
                p and replace(p, by_parameters=np.append(p.by_parameters, share[test] * p.by_parameters))
                for p, test in zip(known, tests, strict=True)
            ]
            out[name, course] = _gained(fitted, plain, changed, priors_changed, huber)
        return out

    each = at_once([partial(gained, name) for name in candidates])
    return {course: gain for of_one in each for course, gain in of_one.items()}


_Beside = tuple[list[Array], list[Prior | None]]
"""Derivatives by the parameters of a candidate, by window, and what is known of the states by them."""


def _slopes_beside(
    simulator: Simulator, fitted: Fit, model: LoopModel, parameters: Sequence[Parameter]
) -> _Beside | None:
    """Those of a candidate at a fit that lacks it; None where it does not run there or a difference away."""
    try:
        # One-sided: a score ranks, and costs half for many parameters.
        models, ends = about(model, parameters, False)
        read = [x for each in models for x in read_of(simulator, each, fitted.windows)]
    except ValueError:
        return None
    return slopes(left_over(read, fitted.windows, len(models)), ends), priors(models, ends, fitted.windows)


def _gained(fitted: Fit, plain: Linear, own: Sequence[Array], known: Sequence[Prior | None], huber: float) -> float:
    """By how much chi-square falls to first order, what is fitted already and the states projected off."""
    weights, k = weights_of(fitted.residuals, huber, False), len(fitted.parameters)
    both_known = [
        one and other and replace(one, by_parameters=np.append(one.by_parameters, other.by_parameters))
        for one, other in zip(plain.priors, known, strict=True)
    ]
    both = [np.hstack(pair) for pair in zip(plain.by_parameters, own, strict=True)]
    matrix, gradient, _ = reduced(Linear(plain.residuals, both, plain.by_state, both_known), fitted.windows, weights)
    inverse = np.linalg.pinv(matrix[:k, :k]) if k else np.zeros((0, 0))
    left = matrix[k:, k:] - matrix[k:, :k] @ inverse @ matrix[:k, k:]
    g = gradient[k:] - matrix[k:, :k] @ inverse @ gradient[:k]
    return float(g @ np.linalg.pinv(left, rcond=1e-10) @ g)


def robust_covariance(simulator: Simulator, noisy: Simulator, found: Fit) -> Array:
    """Covariance of the fitted parameters when base noise moves the responses too: the sandwich estimator.

    Under the fitted model each record is answered again under redrawn base noise; what that does to the gradient is
    put between two inverses of the information.  Windows are taken as independent.  Where the model misses records by
    more than the noise, what it misses goes together within a record: the gradients that the records leave, one against
    another, are put between as well; of too few records the whole is taken times the mean square that is left.  The
    information of a record that counts less is that of its weight, somewhat more than it has; slopes are cautious
    (`linearised`), since one window that goes another way a difference apart would else have all the information.

    Args:
        simulator: of the fit.
        noisy: of `spread.redrawn`, of the same tests.
        found: the fit.

    Returns:
        Covariance in the outer scale, shape (parameter, parameter).
    """
    windows, model = found.windows, found.model
    lin = linearised(simulator, model, found.parameters, windows, cautious=True)
    weights = weights_of(lin.residuals, ROBUST if found.whole else HUBER, found.whole)
    matrix, _, each = reduced(lin, windows, weights)
    count = len(simulator.tests)
    draws = len(noisy.tests) // count
    read = read_of(simulator, model, windows)
    jobs = [job._replace(test=count * k + job.test) for k in range(draws) for job in jobs_of(windows, 0)]
    again = observe(noisy, [model], jobs, [*windows] * draws)
    meat, n = np.zeros_like(matrix), len(windows)
    for i, (w, part, weight) in enumerate(zip(windows, each, weights, strict=True)):
        sensor = (w.noise * w.weights) ** 2
        own = part.A[: w.data.size]
        meat += weight**2 * (own.T * sensor) @ own
        for k in range(draws):
            moved = np.nan_to_num((again[k * n + i] - read[i]) * w.weights)
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
    scale = scales(found)
    return np.asarray(beside * (inverse @ meat @ inverse) * np.outer(scale, scale), dtype=np.float64)
