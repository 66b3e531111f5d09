"""Fits over whole records: of a trial, from one start or many, and how two of them compare.

Where runs take long, on floors that give, the beginnings of the records are fitted first.

Status   the order of such fits, and what tells records apart, by planted effects (tests)
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from studies.loop.fits.estimating import sensor_covariance
from studies.loop.fits.fitting import Fit, fit, fit_records
from studies.loop.fits.linearising import ROBUST, objectives
from studies.loop.models.model import LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.spread import variances, weighed
from studies.loop.observed.windows import Window
from studies.loop.records.preparing import Setup
from studies.loop.runs.at_once import at_once
from studies.loop.swings.learning import bends_much
from studies.loop.swings.trials import Trial
from studies.loop.whole.remaining import over_noise, roughly_begun, slips, structure

Array = NDArray[np.float64]

FEW_NEIGHBOURS = 5
"""Starts about the swings' estimate of a fit of whole records that is only to be compared."""

NEARLY, MENDED = 2.0, 3.0
"""A record that is lost in two fits still tells them apart where the smaller rms is so little over what counts as lost,
and the larger one so many times that."""

HORIZONS = (0.15, 0.4)
"""Shares of whole records that are fitted before all of them, where a run takes long and few starts can be tried."""

ROUGHLY = 0.5
"""Share of what swings on a floor that gives leave beyond noise by which another fit of them may be worse."""

FEWEST_SAMPLES = 20
"""Of a part of a record that says something [1]."""


def whole_fit(setup: Setup, trial: Trial, weights_of: Fit | None = None) -> Fit:
    """The trial refitted on whole records, weighed by what base noise does; the leans alone if that is no better.

    weights_of: a fit on whole records whose standard deviations are used; own ones if not given.
    """
    leans, full = leans_and_all(setup, trial, weights_of)
    return full if full.chi2 < leans.chi2 and borne(setup, trial, full) else leans


def leans_and_all(setup: Setup, trial: Trial, weights_of: Fit | None = None) -> tuple[Fit, Fit]:
    """The leans of whole records fitted alone, and everything, whatever swings say of it."""
    model = trial.swing.model
    if weights_of is None:
        windows = weighed_under(setup, model, setup.whole)
    else:
        windows = [replace(w, sd=o.sd) for w, o in zip(setup.whole, weights_of.windows, strict=True)]
    leans = fit_records(setup.simulator, model, [], windows, iterations=4)
    return leans, drawn_out(setup, trial, leans) if trial.costly else all_at_once(setup, trial, leans)


def whole_fit_from_many(setup: Setup, trial: Trial, weights_of: Fit, effects: Collection[str] | None = None) -> Fit:
    """The best of such fits that begin about the swings' estimate: one of them may end in a minimum of its own.

    effects: those that are moved about; all if not given.
    """
    if trial.costly:
        return whole_fit(setup, trial, weights_of)
    starts = [trial]
    sure = sensor_covariance(setup.simulator, trial.swing)
    moved = (p for p in trial.parts if p.in_swings and (effects is None or p.effect in effects))
    for part in moved:
        for model in neighbours(trial.swing, sure, part.parameters[0], FEW_NEIGHBOURS):
            starts.append(replace(trial, swing=replace(trial.swing, model=model)))
    found = at_once([partial(whole_fit, setup, start, weights_of) for start in starts])
    return min(found, key=lambda f: f.chi2)


def weighed_under(setup: Setup, model: LoopModel, windows: Sequence[Window], draws: int | None = None) -> list[Window]:
    """Whole windows, in the order of those of the setup, weighed by what base noise does under a model.

    What weighed them before is left aside, but for what the records themselves say of their noise.

    draws: of the noise; as many as a variance takes if not given.
    """
    plain = [replace(w, sd=o.sd) for w, o in zip(windows, setup.whole, strict=True)]
    return weighed(plain, variances(setup.noisy, len(setup.campaign.tests), model, plain, draws=draws))


def all_at_once(setup: Setup, trial: Trial, leans: Fit) -> Fit:
    """The trial fitted to whole records, from where their leans are fitted."""
    return fit_records(setup.simulator, leans.model, trial.every, leans.windows, iterations=8, again=not trial.costly)


def drawn_out(setup: Setup, trial: Trial, leans: Fit) -> Fit:
    """The same, the beginnings of the records first: what is wrong adds up, and further on minima lie close together.

    Source, of the minima: Voss, Timmer & Kurths (2004), Int. J. Bifurcation Chaos 14, 1905-1933.
    """
    found, windows = begun(setup, trial, leans, HORIZONS)
    return all_at_once(setup, trial, fit_records(setup.simulator, found.model, [], windows, iterations=4))


def beginnings(windows: Sequence[Window], share: float) -> dict[int, Window]:
    """That share of the time of each record, by its index, where enough of it was read."""
    parts = (w.until(float(w.times[0] + share * (w.times[-1] - w.times[0]))) for w in windows)
    return {i: w for i, w in enumerate(parts) if w.data.size >= FEWEST_SAMPLES}


def begun(setup: Setup, trial: Trial, start: Fit, shares: Sequence[float]) -> tuple[Fit, list[Window]]:
    """The trial fitted to beginnings of whole records, one after the other; and these from the leans that it found.

    start: whole records, from which it begins.
    """
    found, windows = start, list(start.windows)
    for share in shares:
        parts = beginnings(windows, share)
        if not parts:
            continue
        first = fit_records(setup.simulator, found.model, [], [*parts.values()], iterations=4)
        found = all_at_once(setup, trial, first)
        for i, window in zip(parts, found.windows, strict=True):
            windows[i] = windows[i].moved(window.theta, window.omega)
    return found, windows


def borne(setup: Setup, trial: Trial, found: Fit) -> bool:
    """Whether swings bear what a fit of whole records found; met closely by a floor that gives, these hold the same."""
    return roughly_begun(setup, trial, found) or still_fits(setup, trial, found.model)


def still_fits(setup: Setup, trial: Trial, model: LoopModel) -> bool:
    """Whether parameters from whole records serve the swings too: else that fit is stuck elsewhere.

    A curve follows what acts as far as its intervals let it, and swings and whole records want it a little different:
    of one that leaves them without structure nothing more is asked.
    """
    there = fit(setup.simulator, model, [], trial.swing.windows, iterations=3)
    least = 30.0 + 0.01 * trial.swing.chi2
    if trial.costly:
        # How a floor gave before a swing began is known but roughly: where that leaves something, it has little say.
        least += ROUGHLY * max(trial.swing.chi2 - trial.swing.samples, 0.0)
    if there.chi2 - trial.swing.chi2 < least:
        return True
    if slips(trial) or not any(map(bends_much, trial.parts)):
        return False
    there = replace(there, parameters=trial.swing.parameters)
    return over_noise(setup, replace(trial, swing=there)) < structure(setup)


def neighbours(found: Fit, covariance: Array, p: Parameter, count: int) -> list[LoopModel]:
    """Models up to two standard deviations from a fit in one of its parameters: whole records are rugged."""
    if p not in found.parameters:
        return []
    k = found.parameters.index(p)
    value, sd = found.model.get(p.name), math.sqrt(max(float(covariance[k, k]), 0.0))
    out: list[LoopModel] = []
    for share in np.linspace(-2.0, 2.0, count if sd > 0.0 else 0):
        moved = min(max(value + float(share) * sd, p.low), p.high)
        try:
            model = found.model.changed({p.name: moved})
            model.system  # noqa: B018 - refuses what does not go together
        except ValueError:
            continue
        out.append(model)
    return out


def reweighed(setup: Setup, other: Fit, found: Fit) -> Fit:
    """A fit of whole records under the standard deviations of another one, as it is."""
    windows = [replace(w, sd=o.sd) for w, o in zip(other.windows, found.windows, strict=True)]
    return fit(setup.simulator, other.model, [], windows, whole=True, iterations=0)


def gain(setup: Setup, without: Fit, found: Fit) -> float:
    """Share by which a fit of whole records lowers the rms, what is far off counting little, of one without it [1]."""
    with_it, without_it, _ = where_told(found, reweighed(setup, without, found))
    return 1.0 - math.sqrt(with_it / without_it)


def telling(one: Fit, other: Fit) -> NDArray[np.bool_]:
    """Which records tell two fits of whole records apart, shape (record,).

    How far off a block is after it went the other way, or fell in the last second, is chance: a record that is lost in
    both fits is told by one of them only if that nearly explains it, and the other one does so by far less.
    """
    least, most = np.minimum(one.by_window, other.by_window), np.maximum(one.by_window, other.by_window)
    return np.asarray((least < ROBUST) | ((least < NEARLY * ROBUST) & (most > MENDED * least)))


def where_told(one: Fit, other: Fit) -> tuple[float, float, int]:
    """Chi-square of two fits of whole records, and the samples, where records are `telling`; everywhere if none is."""
    told = telling(one, other)
    kept = np.flatnonzero(told) if told.any() else np.arange(told.size)
    first, second = (
        float(objectives(f.model, [f.residuals[i] for i in kept], [f.windows[i] for i in kept], ROBUST, True).sum())
        for f in (one, other)
    )
    return first, second, sum(one.residuals[i].size for i in kept)
