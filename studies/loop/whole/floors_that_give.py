"""Swings and whole records brought to one minimum, on floors that give above all.

Their sums of squares have minima close together, those of whole records in the stiffness along the floor above all.
Runs take long, so that each is fitted from a few starts; where either led to what the other one prefers, that is fitted
again.

Status   planted floors (studies/loop_trials.py), and the order of fits with stubs (tests)
"""

from __future__ import annotations

import math
from dataclasses import replace

from studies.loop.fits.fitting import Fit, fit, fit_records
from studies.loop.models.model import LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.windows import Window
from studies.loop.records.preparing import Setup
from studies.loop.swings.trials import FURTHER_COSTLY, PAYS, Trial
from studies.loop.whole.remaining import CLOSELY, met
from studies.loop.whole.whole_fits import HORIZONS, all_at_once, beginnings, begun, borne, whole_fit

APART = (0.4, 2.5)
"""Times the stiffness along the floor from which other minima of whole records are looked for."""

SAME = 0.2
"""Minima whose stiffnesses along the floor are so near, by their logarithms, are one."""


def in_agreement(setup: Setup, trial: Trial, whole: Fit) -> tuple[Trial, Fit]:
    """The trial and its fit on whole records, both in the minimum that serves both best of those that were found.

    With the law by which corners slip that serves both, too.
    """
    again = from_whole_records(setup, trial, whole)
    if again is not trial:
        trial, whole = again, whole_fit(setup, again)
    trial, whole = _elsewhere(setup, trial, whole) or (trial, whole)
    return _by_another_law(setup, trial, whole) or (trial, whole)


def _by_another_law(setup: Setup, trial: Trial, whole: Fit) -> tuple[Trial, Fit] | None:
    """The same by another law, where whole records are missed, if they prefer it by far and swings do not refuse it."""
    laws = [(k, law) for k, part in enumerate(trial.parts) for law in part.otherwise]
    if not laws or met(setup, whole, CLOSELY):
        return None
    best: tuple[Trial, Fit] | None = None
    for k, law in laws:
        part = replace(trial.parts[k], fixed={**trial.parts[k].fixed, **law}, otherwise=())
        model = whole.model.changed(law)
        there = fit(setup.simulator, model, [], trial.swing.windows, iterations=3)
        swing = fit(setup.simulator, model, trial.every, there.windows, iterations=FURTHER_COSTLY)
        if swing.chi2 > trial.swing.chi2 + PAYS:
            continue
        other = replace(trial, parts=(*trial.parts[:k], part, *trial.parts[k + 1 :]), swing=swing)
        found = whole_fit(setup, other, whole)
        if found.chi2 < (whole if best is None else best[1]).chi2 - PAYS * found.spread:
            best = other, found
    return best


def from_whole_records(setup: Setup, trial: Trial, whole: Fit) -> Trial:
    """The trial, its swings fitted anew from where whole records led if that explains them better by far.

    On a floor that gives they have minima close together, too, and were fitted from a few starts.  Of a few shaken
    tests alone they may have several on a hard one.
    """
    there = fit(setup.simulator, whole.model, [], trial.swing.windows, iterations=3)
    if there.chi2 > trial.swing.chi2 - PAYS:
        return trial
    return replace(trial, swing=fit(setup.simulator, whole.model, trial.every, there.windows, iterations=12))


def one_minimum(trial: Trial, one: LoopModel, other: LoopModel) -> bool:
    """Whether whole records have one minimum where two models of a floor that gives are, or lead to one."""
    along = _along(trial)
    return along is not None and _near(along, one, other)


def _along(trial: Trial) -> Parameter | None:
    """The stiffness along the floor, if the trial has one."""
    return next((p for part in trial.parts for p in part.parameters if p.name == part.minima_in), None)


def _near(along: Parameter, one: LoopModel, other: LoopModel) -> bool:
    return abs(math.log(one.get(along.name) / other.get(along.name))) < SAME


def _elsewhere(setup: Setup, trial: Trial, whole: Fit) -> tuple[Trial, Fit] | None:
    """The same in another minimum of whole records, if they prefer that by far and swings do not refuse it."""
    along = _along(trial)
    apart = [] if along is None else _begun_apart(setup, trial, whole, along)
    if not apart:
        return None
    first, windows = min(apart, key=lambda pair: pair[0].chi2)
    parts = beginnings(whole.windows, HORIZONS[-1])
    if fit_records(setup.simulator, whole.model, [], [*parts.values()], iterations=4).chi2 < first.chi2:
        return None
    leans = fit_records(setup.simulator, first.model, [], windows, iterations=4)
    found = all_at_once(setup, trial, leans)
    if found.chi2 > whole.chi2 - PAYS * found.spread or not borne(setup, trial, found):
        return None
    there = fit(setup.simulator, found.model, [], trial.swing.windows, iterations=3)
    swing = fit(setup.simulator, found.model, trial.every, there.windows, iterations=12)
    return replace(trial, swing=swing), found


def _begun_apart(setup: Setup, trial: Trial, whole: Fit, along: Parameter) -> list[tuple[Fit, list[Window]]]:
    """Beginnings of whole records fitted from other stiffnesses along the floor, as `begun` gives them.

    Those that lead back to where whole records are go no further.
    """
    value, apart = whole.model.get(along.name), []
    for times in APART:
        start = whole.model.changed({along.name: min(max(times * value, along.low), along.high)})
        found, windows = replace(whole, model=start), list(whole.windows)
        for share in HORIZONS:
            found, windows = begun(setup, trial, replace(whole, model=found.model, windows=tuple(windows)), [share])
            if _near(along, found.model, whole.model):
                break
        else:
            apart.append((found, windows))
    return apart
