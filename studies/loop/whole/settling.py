"""The parameters on which swings and whole records agree, with their covariance.

Status   the intervals' coverage is measured on campaigns with planted effects (studies/loop_coverage.py).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from studies.loop.fits.estimating import robust_covariance, scales, sensor_covariance
from studies.loop.fits.fitting import Fit, fit, fit_records
from studies.loop.models.model import LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.windows import Window
from studies.loop.records.preparing import Setup
from studies.loop.runs.at_once import at_once
from studies.loop.swings.learning import LEARNED
from studies.loop.swings.trials import FURTHER_COSTLY, PAYS, Trial
from studies.loop.whole.floors_that_give import one_minimum
from studies.loop.whole.whole_fits import FEWEST_SAMPLES, drawn_out, neighbours, still_fits

Array = NDArray[np.float64]

PREDICTABLE = 2.0
"""Standard deviation of a sample by all noise, over that by the sensor's, up to which a record is predictable."""

NEIGHBOURS = 11
"""Starts about the swings' estimate from which whole records are fitted."""

ENDED = 4
"""So many of these fits, the best, are ended."""

SAME = 3.0
"""Minima closer than this many standard deviations are one."""


@dataclass(frozen=True)
class Settled:
    """The parameters that swings and whole records agree on, with their covariance."""

    whole: Fit  # whole records with these parameters, leans fitted
    names: tuple[str, ...]
    covariance: Array


def settle(setup: Setup, trial: Trial, whole: Fit) -> Settled:
    """Estimates from swings and from whole records put together, each by its robust covariance.

    Whole records are the sharper the longer they run, and the more the noise of the base sensor is in them: only what
    is still predictable of them says how large a parameter is.
    """
    parameters = trial.every
    names = tuple(p.name for p in parameters)
    minima = _while_predictable(setup, trial, whole)
    fits = [f for f in (trial.swing, *minima[:1]) if f.parameters]
    covariances = [robust_covariance(setup.simulator, setup.noisy, f) for f in fits]
    apart, own, together = None, [*covariances], 1.0
    if len(minima) > 1 and trial.every:
        together = _together(sensor_covariance(setup.simulator, minima[0]), covariances[-1])
        apart = _apart(minima, together, covariances[-1])
        covariances[-1] = covariances[-1] + apart
    both, joint = _joined(names, fits, covariances)
    known = _outer(parameters, both)
    between = apart is not None and bool(np.any(np.diag(apart) > np.diag(own[-1])))
    if between:
        there = [{p.name: m.model.get(p.name) for p in parameters} for m in minima[:ENDED]]
        if trial.costly:
            known = there[0]
        else:
            beside = [_joined(names, [*fits[:-1], m], own)[0] for m in minima[:ENDED]]
            found = [known, *there, *(_outer(parameters, b) for b in beside)]
            known = _explains_most(setup, trial, minima[0], together, found)
    if trial.costly and minima:
        joined = whole.model.changed(known)
        if between or _spoilt(setup, joined, trial.swing.model, minima[0]):
            # Swings have many starts; a minimum of whole records that they refuse is one among many.
            one = len(fits) - 1 if still_fits(setup, trial, minima[0].model) else 0
            known |= fits[one].values
            joint = _in_its_place(names, joint, fits[one], covariances[one])
    model = whole.model.changed(known)
    leans = fit_records(setup.simulator, model, [], whole.windows, iterations=4)
    scale = np.array([p.slope(known[p.name]) for p in parameters])
    joint = _disagreement(fits, covariances) * joint + _by_what_is_assumed(setup, trial)
    widened = joint * np.outer(scale, scale)
    return Settled(leans, names, np.asarray(widened, dtype=np.float64))


def _outer(parameters: Sequence[Parameter], inner: Array) -> dict[str, float]:
    """Parameters by name, from numbers in their scales."""
    return {p.name: p.outer(float(v)) for p, v in zip(parameters, inner, strict=True)}


def _explains_most(
    setup: Setup, trial: Trial, best: Fit, together: float, found: Sequence[dict[str, float]]
) -> dict[str, float]:
    """Of several estimates the one that explains swings and whole records best.

    best: the deepest minimum of whole records; these are compared as far as they are predictable in it.
    together: by how many times a difference of theirs counts less than one of the swings (`_together`).

    Between minima of whole records lies none, so that an average would not predict; but where they say next to nothing
    of a parameter, their best minimum may be where no swing is explained.
    """

    def left(values: dict[str, float]) -> float:
        try:
            model = best.model.changed(values)
            swings = fit(setup.simulator, model, [], trial.swing.windows, iterations=3)
            records = fit_records(setup.simulator, model, [], best.windows, iterations=4)
        except ValueError:
            return math.inf  # what was put together of numbers that do not go together
        return swings.chi2 + records.chi2 / together

    return min(found, key=left)


def _by_what_is_assumed(setup: Setup, trial: Trial) -> Array:
    """What numbers that were taken for known add to the covariance, in scales of the parameters.

    Each is put at its other value, and the swings fitted again: so far apart estimates may be.
    """
    swing, added = trial.swing, np.zeros((len(trial.every), len(trial.every)))
    for part in trial.parts:
        for name, value in part.assumed.items():
            model = swing.model.changed({name: value})
            other = fit(setup.simulator, model, trial.every, swing.windows, iterations=FURTHER_COSTLY)
            apart = np.array([p.inner(other.model.get(p.name)) - p.inner(swing.model.get(p.name)) for p in trial.every])
            added += np.outer(apart, apart)
    return added


def _spoilt(setup: Setup, joined: LoopModel, swings: LoopModel, best: Fit) -> bool:
    """Whether estimates that were put together explain by far less of whole records than either does by itself.

    On a floor that gives a parameter may say so little that what it has in common with the others carries it away.
    """
    by_both, by_swings = (
        fit_records(setup.simulator, model, [], best.windows, iterations=4).chi2 for model in (joined, swings)
    )
    return by_both > max(by_swings, best.chi2) + PAYS * best.spread


def _joined(names: Sequence[str], fits: Sequence[Fit], covariances: Sequence[Array]) -> tuple[Array, Array]:
    """What estimates say together, weighed by their covariances, in scales of the parameters, and its covariance."""
    total, weighted = np.zeros((len(names), len(names))), np.zeros(len(names))
    for found, covariance in zip(fits, covariances, strict=True):
        # Parameters that a fit does not have, or does not show, have no information in it.
        own = [names.index(p.name) for p in found.parameters]
        seen = [k for k in range(len(own)) if covariance[k, k] > 0.0]
        at = np.array([own[k] for k in seen], dtype=int)
        information = np.linalg.pinv(_inner(found, covariance)[np.ix_(seen, seen)], rcond=1e-14)
        total[np.ix_(at, at)] += information
        weighted[at] += information @ _numbers(found)[seen]
    joint = np.linalg.pinv(total, rcond=1e-14)
    values = np.asarray(joint @ weighted)
    for found in fits:
        for p, value in zip(found.parameters, _numbers(found), strict=True):
            k = names.index(p.name)
            # What no fit shows is as uncertain as can be, and stays where it was.
            if total[k, k] == 0.0:
                values[k], joint[k, k] = value, math.inf
    return values, np.asarray(joint)


def _in_its_place(names: Sequence[str], joint: Array, found: Fit, covariance: Array) -> Array:
    """The covariance of one fit in scales of the parameters; that of all for what this one does not show."""
    shown = [k for k in range(len(found.parameters)) if covariance[k, k] > 0.0]
    at = [names.index(found.parameters[k].name) for k in shown]
    out = joint.copy()
    out[np.ix_(at, at)] = _inner(found, covariance)[np.ix_(shown, shown)]
    return out


def _disagreement(fits: Sequence[Fit], covariances: Sequence[Array]) -> float:
    """Birge ratio, squared: how much further apart two estimates are than they say, 1 or more.

    Source: Birge (1932), Phys. Rev. 40, 207.
    """
    if len(fits) != 2 or fits[0].parameters != fits[1].parameters:
        return 1.0
    first, second = (_inner(f, c) for f, c in zip(fits, covariances, strict=True))
    scale = np.sqrt(np.maximum(np.diag(first) + np.diag(second), 1e-300))
    apart = (_numbers(fits[0]) - _numbers(fits[1])) / scale
    both = (first + second) / np.outer(scale, scale)
    return max(1.0, float(apart @ np.linalg.pinv(both, rcond=1e-12) @ apart) / apart.size)


def _numbers(found: Fit) -> Array:
    """What was fitted, in scales of the parameters: of some the logarithm."""
    return np.array([p.inner(found.model.get(p.name)) for p in found.parameters])


def _inner(found: Fit, covariance: Array) -> Array:
    """Its covariance."""
    scale = scales(found)
    return covariance / np.outer(scale, scale)


def predictable(windows: Sequence[Window]) -> list[Window]:
    """Whole windows up to where the noise of the base sensor makes more of the motion than the sensor's own noise.

    Beyond it the sum of squares is rugged: it has a minimum, sharp and wrong, beside every other.
    """
    out = []
    for w in windows:
        seen = w.noise if w.felt is None else np.hypot(w.noise, w.felt)
        lost = w.there[1.0 / w.weights > PREDICTABLE * seen] % w.times.size  # the data are stacked channel by channel
        short = w.until(float(w.times[lost.min()])) if lost.size else w
        out += [short] if short.data.size >= FEWEST_SAMPLES else []
    return out


def _while_predictable(setup: Setup, trial: Trial, whole: Fit) -> list[Fit]:
    """The parameters fitted to what is predictable of whole records, the best first; none if nothing is.

    The fits begin at either estimate and about that of the swings, since the sum of squares may have many minima.
    """
    windows = predictable(whole.windows)
    if not windows:
        return []
    # Where a run takes long, either estimate alone is a start.
    ended = 1 if trial.costly else ENDED
    named = [part for part in trial.parts if part.in_swings and part.effect not in LEARNED and not trial.costly]
    about: list[LoopModel] = []
    if named:
        sure = sensor_covariance(setup.simulator, trial.swing)
        about = [model for part in named for model in neighbours(trial.swing, sure, part.parameters[0], NEIGHBOURS)]
    starts = [whole.model, trial.swing.model, *about]
    if trial.costly and one_minimum(trial, trial.swing.model, whole.model):
        starts = starts[:1]

    def begun(model: LoopModel) -> Fit:
        leans = fit_records(setup.simulator, model, [], windows, iterations=4)
        if trial.costly and model is trial.swing.model:
            return drawn_out(setup, trial, leans)
        return fit(setup.simulator, model, trial.every, leans.windows, whole=True, iterations=4, central=True)

    def to_the_end(found: Fit) -> Fit:
        again = not trial.costly
        return fit_records(setup.simulator, found.model, trial.every, found.windows, iterations=12, again=again)

    fits = sorted(at_once([partial(begun, model) for model in starts]), key=lambda f: f.chi2)
    best = at_once([partial(to_the_end, f) for f in fits[:ended]])
    return sorted([*best, *fits[ended:]], key=lambda f: f.chi2)


def _together(by_sensor: Array, covariance: Array) -> float:
    """How many times too large a difference of chi-square of whole records is: the noise of the base moves many of
    their samples at once.

    As much as the covariance by all noise is over that by the sensor's alone, 1 or more.
    """
    return max(1.0, float(np.max(np.diag(covariance) / np.maximum(np.diag(by_sensor), 1e-300))))


def counted_together(setup: Setup, trial: Trial, whole: Fit) -> float:
    """The same of what is predictable of whole records, as they are fitted; 1 if nothing is."""
    windows = predictable(whole.windows)
    if not windows or not trial.every:
        return 1.0
    there = fit(setup.simulator, whole.model, trial.every, windows, whole=True, iterations=0)
    return _together(
        sensor_covariance(setup.simulator, there), robust_covariance(setup.simulator, setup.noisy, there)
    )  # fmt: skip


def _apart(minima: Sequence[Fit], together: float, covariance: Array) -> Array:
    """What other minima add to the covariance of the best one: they may be the right one if they are nearly as deep.

    together: by how many times a difference of chi-square counts less (`_together`).
    """
    best = minima[0]
    sds = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    values = [np.array([f.model.get(p.name) for p in best.parameters]) for f in minima]
    kept = [0]
    for k in range(1, len(minima)):
        if all(np.any(np.abs(values[k] - values[other]) > SAME * sds) for other in kept):
            kept.append(k)
    weights = np.array([math.exp(-0.5 * (minima[k].chi2 - best.chi2) / together) for k in kept])
    away = np.array([values[k] - values[0] for k in kept])
    return np.asarray((away.T * weights) @ away / weights.sum(), dtype=np.float64)


def intervals(chosen: Trial, settled: Settled) -> dict[str, tuple[float, float, float]]:
    """Value and 95 % interval of each parameter, with what the base sensor's noise does to it."""
    bounds = {p.name: p for p in (*chosen.swing.parameters, *chosen.every)}
    out = {}
    for k, name in enumerate(settled.names):
        p, value = bounds[name], settled.whole.model.get(name)
        half = 1.96 * math.sqrt(max(float(settled.covariance[k, k]), 0.0)) / p.slope(value)
        out[name] = (value, p.outer(p.inner(value) - half), p.outer(p.inner(value) + half))
    return out
