"""Sets of effects that explain nearly as much as the chosen one, each fitted to the end, and those that are its twins.

Status   twins are named in campaigns where two effects are alike by theory (tests of trials)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from studies.loop.fits.fitting import Fit, fit
from studies.loop.records.preparing import Setup
from studies.loop.records.scoring import errors
from studies.loop.runs.at_once import at_once
from studies.loop.swings.trials import FURTHER_COSTLY, Round, Trial, bic
from studies.loop.whole.whole_fits import whole_fit, whole_fit_from_many

TWIN = 12.0
"""A rival whose criterion is within this of the best cannot be told apart: odds of exp(-6) or better."""

NEAR_TWIN = 400.0
"""Rivals within this after the search are fitted again to the end before they are ruled out."""

LEFT_BY_A_RIVAL = 0.7
"""What a rival may leave at the most, by then, of what the best one explains, beyond some `TWIN`s: where that is less
than `NEAR_TWIN`, all that explain nothing would else be near."""

SOME_TWINS = 3.0


@dataclass(frozen=True)
class Rival:
    """A set of effects as it ended: fits, criterion and errors."""

    trial: Trial
    whole: Fit
    criterion: float  # bic of the swings; where whole records decided theirs, apart as the base lets them be
    whole_criterion: float
    holdout: float  # median error over held-out tests [rad]
    refused: bool = False  # whether whole records speak for the best one by far, whatever the criterion says


def near_all(setup: Setup, rounds: Sequence[Round], best: Trial, whole: Fit) -> tuple[Rival, ...]:
    """The same over several rounds, what is in more than one of them once.

    rounds: of each effect what was tried in its place; the chosen trial may be in all of them.
    """
    found: dict[frozenset[str], Rival] = {}
    for tried in rounds:
        others = [t for t in tried.trials if frozenset(t.names) not in found]
        for rival in near(setup, replace(tried, trials=others), best, whole):
            found.setdefault(frozenset(rival.trial.names), rival)
    return tuple(sorted(found.values(), key=lambda r: r.criterion))


def near(setup: Setup, tried: Round, best: Trial, whole: Fit) -> tuple[Rival, ...]:
    """The chosen trial and those of its round that come near, each fitted to the end; the best first."""
    explained = bic(tried.onto.swing) - bic(best.swing)
    enough = min(NEAR_TWIN, max(SOME_TWINS * TWIN, LEFT_BY_A_RIVAL * explained))

    def ended(trial: Trial) -> Rival:
        if trial is best and trial.costly:
            # The search went to the end with it, and its fit on whole records is there.
            held = errors(setup, whole.model, whole.windows).holdout
            return Rival(trial, whole, bic(trial.swing), bic(whole), held)
        iterations, tolerance = (FURTHER_COSTLY, 1e-4) if trial.costly else (20, 1e-6)
        swing = fit(
            setup.simulator, trial.swing.model, trial.every, trial.swing.windows, iterations=iterations,
            tolerance=tolerance,
        )  # fmt: skip
        settled = replace(trial, swing=swing if swing.chi2 <= trial.swing.chi2 else trial.swing)
        own = whole_fit(setup, settled, whole)
        if trial is best and whole.chi2 < own.chi2:  # it may have been found from another start
            own = whole
        held = errors(setup, own.model, own.windows).holdout
        return Rival(settled, own, bic(settled.swing), bic(own), held)

    ranked = sorted(tried.trials, key=lambda t: bic(t.swing))
    close = [t for t in ranked if t is best or bic(t.swing) - bic(best.swing) <= enough]
    return tuple(sorted(at_once([partial(ended, trial) for trial in close]), key=lambda r: r.criterion))


def twins_from_many(setup: Setup, rivals: Sequence[Rival], weights_of: Fit) -> tuple[Rival, ...]:
    """The same, where the best has twins each of these fitted on whole records from more starts: they have to decide.

    One fit alone may end in a minimum of its own, and the twin that is in luck would be preferred.  What all of them
    have is left where it is.
    """
    least = min((r.criterion for r in rivals), default=0.0)
    alike = [r for r in rivals if r.criterion - least < TWIN]
    if len({r.trial.effects for r in alike}) < 2 or any(r.trial.costly for r in alike):
        return tuple(rivals)
    common = set.intersection(*(set(r.trial.effects) for r in alike))
    found = []
    for r in rivals:
        if any(r is twin for twin in alike):
            own_effects = set(r.trial.effects) - common
            many = whole_fit_from_many(setup, r.trial, weights_of, own_effects)
            own = min(r.whole, many, key=lambda f: f.chi2)
            if own is not r.whole:
                held = errors(setup, own.model, own.windows).holdout
                r = replace(r, whole=own, whole_criterion=bic(own), holdout=held)
        found.append(r)
    return tuple(found)


def standing(
    rivals: Sequence[Rival], refused: Callable[[Rival], bool], preferred: Callable[[Rival, Rival], bool]
) -> tuple[Rival, ...]:
    """The rivals, the best one first that is not refused; of its twins the one that whole records prefer by far.

    One that is refused is a twin still where swings do not tell it from the best: whole records are rugged.  Where they
    would prefer it by more, it counts as refused, and comes last.

    refused: whether whole records speak against a rival by far.
    preferred: whether they speak for one rival against another by far.
    """
    by_criterion = sorted(rivals, key=lambda r: r.criterion)
    first = next((r for r in by_criterion if not refused(r)), None)
    if first is None:
        return tuple(by_criterion)
    alike = [r for r in by_criterion if r is not first and abs(r.criterion - first.criterion) < TWIN and not refused(r)]
    for rival in alike:
        if preferred(rival, first):
            first = rival
    before = [r for r in by_criterion if r.criterion < first.criterion - TWIN]
    others = [r for r in by_criterion if r is not first and all(r is not b for b in before)]
    return (first, *others, *(replace(r, refused=True) for r in before))


def other_forms(rivals: Sequence[Rival]) -> tuple[tuple[str, str], ...]:
    """Of the best of the rivals each form of an effect with another form of it that these data do not tell from it."""
    best, *others = rivals or (None,)
    return tuple(
        (mine, its)
        for r in others
        if best is not None and not r.refused and r.trial.effects == best.trial.effects
        and r.criterion - best.criterion < TWIN
        for mine, its in zip(best.trial.names, r.trial.names, strict=True)
        if mine != its
    )  # fmt: skip


def twins(rivals: Sequence[Rival], about: Trial | None = None) -> tuple[tuple[str, ...], ...]:
    """Sets that these data cannot tell apart: an effect and those that may stand in its place.

    Args:
        rivals: the best first.
        about: the trial of which each of them has one effect in the place of another; the best one's if not given.
    """
    if len(rivals) < 2:
        return ()
    best = rivals[0]
    close = [r for r in rivals if r is best or (not r.refused and r.criterion - best.criterion < TWIN)]
    centre = next((r.trial for r in close if about is not None and r.trial.names == about.names), best.trial)
    sets: dict[str, list[str]] = {}
    for r in close:
        gone = [e for e in centre.effects if e not in r.trial.effects]
        new = [e for e in r.trial.effects if e not in centre.effects]
        if len(gone) == len(new) == 1:
            sets.setdefault(gone[0], [gone[0]]).append(new[0])
    return tuple(tuple(dict.fromkeys(names)) for names in sets.values())
