"""One candidate on top of a trial: from all of its starts on some windows, then on all of them, then to the end.

Source   none, own convention
Status   studies/loop_trials.py measures what is found so
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import partial

import numpy as np

from studies.loop.fits.estimating import gains
from studies.loop.fits.fitting import Fit, fit
from studies.loop.fits.linearising import HUBER, objectives
from studies.loop.models.candidates import Candidate
from studies.loop.models.model import LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.windows import Window
from studies.loop.runs.at_once import at_once
from studies.loop.runs.simulation import Simulator
from studies.loop.swings.lost_windows import afresh, with_lost_found
from studies.loop.swings.trials import PAYS, First, Trial

SOME = 50
"""Windows on which starts are compared."""

SOME_COSTLY = 16
"""The same where a run takes long."""

SCOUTED = 2
"""Starts of a candidate with scouts from which all of its parameters are fitted."""

FURTHER = 8
"""Steps of a fit on some windows that a few have left worse than without the candidate."""

NOTHING = 0.05
"""A gain on some of the windows below this share of `PAYS` promises nothing."""

HOPEFUL, HOPEFUL_TO_LEAD = 0.3, 0.1
"""A candidate is fitted to the end if it leaves no more than this share of the best one's gain; the second if the best
alone is asked for."""

_Start = tuple[LoopModel, Sequence[Window], float]
"""A model, the windows from where it fits them better as it is, and what it leaves of them."""


def on_some(simulator: Simulator, onto: Trial, candidate: Candidate) -> First | str:
    """The best of the fits from all starts after a few steps, or why there is none."""
    chosen = chosen_for(onto, candidate)
    some = [onto.swing.windows[i] for i in chosen]
    parameters = (*onto.calibrated_with(candidate), *onto.parameters, *candidate.parameters)
    scouts = tuple(p for p in candidate.parameters if p.name in candidate.scouts)
    begun: list[Fit] = []
    reason = "no start led anywhere"
    nothing = nothing_of(onto, candidate)
    starts: list[_Start] = []
    own = best_by_score(simulator, onto.swing.of(chosen), candidate) if candidate.scored else candidate.starts
    for start in (*own, *([nothing] if candidate.smooth else [])):
        try:
            model = onto.swing.model.changed({**candidate.fixed, **start})
            starts.append((model, *((some, 0.0) if candidate.smooth else afresh(simulator, model, some))))
        except ValueError as refusal:
            reason = str(refusal)
    apart: list[_Start] = []
    if candidate.screened:
        apart = _best_of_parts(starts, candidate.parts)
        starts = sorted(starts, key=lambda start: start[2])[: candidate.screened]
        apart = [start for start in apart if all(start is not other for other in starts)]
    for model, windows, _ in starts:
        try:
            begun.append(fit(simulator, model, scouts or parameters, windows, iterations=2 if scouts else 3))
        except ValueError as refusal:
            reason = str(refusal)
    begun.sort(key=lambda f: f.chi2)
    if scouts:
        starts = [(f.model, f.windows, f.chi2) for f in begun[:SCOUTED]]
        begun = []
        for model, windows, _ in (*starts, *apart):
            try:
                begun.append(fit(simulator, model, parameters, windows, iterations=3))
            except ValueError as refusal:
                reason = str(refusal)
    if not begun:
        return reason
    best, without = min(begun, key=lambda f: f.chi2), of_some(onto.swing, chosen)
    if best.chi2 > without and not best.converged and not (candidate.costly or onto.costly):
        # What is worse than nothing of it has not arrived: it says nothing yet of what it may explain.
        best = fit(simulator, best.model, parameters, best.windows, iterations=FURTHER)
    return First(best.model, parameters, without - best.chi2)


def promise(simulator: Simulator, onto: Trial, pool: Iterable[Candidate], times: float = 1.0) -> float:
    """By how much the criterion of the swings would fall with the best of a pool, to first order, as some windows say.

    What noise alone would have them say, 1 for each number that is asked of them, is said of no others.  Of what enters
    linearly by its size alone (its scouts), that size is asked at the best of its starts.  What takes another form of
    what went before promises as much as that.

    times: what scores are multiplied by before parameters are paid for.
    """
    windows = onto.swing.windows
    chosen = every_so_many(len(windows), SOME)
    fitted, price = onto.swing.of(chosen), math.log(max(onto.swing.samples, 2))
    best = -math.inf
    for candidate in (c for c in pool if not c.after):
        own = tuple(p for p in candidate.parameters if candidate.smooth or p.name in candidate.scouts)
        models = _at_nothing(fitted.model, candidate, own, nothing_of(onto, candidate))
        scores = gains(simulator, fitted, dict.fromkeys(models, own), models).values()
        score = max((score for score in scores if math.isfinite(score)), default=-math.inf)
        over_chance = max(score - len(own), 0.0)
        best = max(best, times * over_chance * len(windows) / len(chosen) - len(candidate.parameters) * price)
    return best


def best_by_score(simulator: Simulator, fitted: Fit, candidate: Candidate) -> list[Mapping[str, float]]:
    """The starts of a candidate of which the score of a scout is largest: what enters linearly promises something near
    where it is alone, at the price of a run or two.

    fitted: without the candidate.
    """
    scouts = tuple(p for p in candidate.parameters if p.name in candidate.scouts)
    models = _at_nothing(fitted.model, candidate, scouts, candidate.absent(fitted.model.declared))
    best = ranked_by_score(simulator, fitted, scouts, models)[: candidate.scored]
    return [candidate.starts[int(k)] for k in best]


def _at_nothing(
    model: LoopModel, candidate: Candidate, linear: Sequence[Parameter], nothing: Mapping[str, float]
) -> dict[str, LoopModel]:
    """The model with the candidate in it from each of its starts, by their numbers, but for what enters linearly."""
    models = dict[str, LoopModel]()
    for k, start in enumerate(candidate.starts or (nothing,)):
        with suppress(ValueError):
            models[str(k)] = model.changed({**candidate.fixed, **start, **{p.name: nothing[p.name] for p in linear}})
    return models


def ranked_by_score(
    simulator: Simulator, fitted: Fit, parameters: Sequence[Parameter], models: Mapping[str, LoopModel]
) -> list[str]:
    """Which of the models, by name, gain most by the parameters, the first first; none that does not run as it is."""
    scores = gains(simulator, fitted, dict.fromkeys(models, parameters), models)
    said = {k: score for k, score in scores.items() if math.isfinite(score)}
    return sorted(said, key=lambda k: -said[k])


def on_all(simulator: Simulator, onto: Trial, candidate: Candidate, first: First) -> Fit:
    """The candidate fitted to all windows by a few steps from its best start.

    States that serve it worse than none of it does, of one that does much, are begun from what records show, too: all
    at once it would go anywhere from there.
    """
    whole = onto.swing.windows
    if not candidate.smooth or fit(simulator, first.model, [], whole, iterations=0).chi2 > onto.swing.chi2:
        whole = tuple(afresh(simulator, first.model, whole)[0])
    promising = first.gained > NOTHING * PAYS
    return fit(simulator, first.model, first.parameters, whole, iterations=4 if promising else 1)


def to_the_end(
    simulator: Simulator,
    onto: Trial,
    begun: Sequence[tuple[Candidate, Fit]],
    tell: Callable[[str], None],
    before: float,
    hopeful: float = HOPEFUL,
) -> list[tuple[Candidate, Fit]]:
    """The candidates with their fits, those that come near the best of all until they converge.

    before: the lowest chi-square of candidates that were fitted before.
    hopeful: what near is, of the best one's gain.
    """
    lowest = min([first.chi2 for _, first in begun] + [before])
    near = lowest + max(hopeful * (onto.swing.chi2 - lowest), PAYS)

    def further(candidate: Candidate, first: Fit) -> Fit:
        if first.chi2 > near:
            return first
        swing = first
        if not first.converged:
            tell(f"{candidate.name}, to the end")
            on = fit(simulator, first.model, first.parameters, first.windows, iterations=12)
            swing = on if on.chi2 <= first.chi2 else first
        return with_lost_found(simulator, swing)

    swings = at_once([partial(further, candidate, first) for candidate, first in begun])
    return [(candidate, swing) for (candidate, _), swing in zip(begun, swings, strict=True)]


def chosen_for(onto: Trial, candidate: Candidate) -> list[int]:
    """Windows on which the starts of a candidate are compared: every so many of them.

    Of one that acts in few of them, those of which the trial leaves most beyond noise: no others hold much to explain.
    """
    windows = onto.swing.windows
    some_of = SOME_COSTLY if candidate.costly or onto.costly else SOME
    if not candidate.slips:
        return every_so_many(len(windows), some_of)
    left = objectives(onto.swing.model, onto.swing.residuals, windows, HUBER) - [r.size for r in onto.swing.residuals]
    return sorted(int(i) for i in np.argsort(-left, kind="stable")[:some_of])


def of_some(found: Fit, chosen: Iterable[int]) -> float:
    """Chi-square of some windows, less for those far off."""
    those = [*chosen]
    some = [found.windows[i] for i in those]
    return float(objectives(found.model, [found.residuals[i] for i in those], some, HUBER).sum())


def nothing_of(onto: Trial, candidate: Candidate) -> dict[str, float]:
    """Parameters of the candidate at which it adds nothing to a trial, within their bounds.

    A span over which nothing changes has none of its own there.
    """
    declared = onto.swing.model.declared
    found = candidate.nothing(declared) if candidate.effect in onto.effects else candidate.absent(declared)
    return found | {p.name: min(max(found[p.name], p.low), p.high) for p in candidate.parameters}


def every_so_many(count: int, some: int) -> list[int]:
    """Every so many of `count` indices, from the first on, that they are about `some`."""
    return list(range(0, count, max(1, count // some)))


def _best_of_parts(starts: Sequence[_Start], parts: int) -> list[_Start]:
    """Of so many parts of the starts, in their order, that which leaves least."""
    each = np.array_split(np.arange(len(starts)), parts) if parts else []
    return [min((starts[i] for i in map(int, part)), key=lambda start: start[2]) for part in each if part.size]
