"""Floors that give, found from how releases begin.

A release begins at rest from a lean, so that of its first swings nothing is unknown, where of any other swing it is how
the floor gave before: no rotation shows that.  The first swings of releases lead a fit to the floor from afar, and are
short; then come more of them, whole releases, and all whole records.

Source   none, own convention
Status   planted floors, found from any start of a range over two decades (tests, studies/loop_trials.py)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from studies.loop.fits.fitting import Fit, fit, fit_records
from studies.loop.models.candidates import SLIDES_BELOW, Candidate, no_harder, sliding_on, with_friction
from studies.loop.models.model import LoopModel
from studies.loop.observed.windows import Window
from studies.loop.records.preparing import Setup
from studies.loop.swings.trials import LEAST_GAIN, PAYS, Trial
from studies.loop.whole.floors_that_give import SAME
from studies.loop.whole.remaining import STRUCTURE, declared_noise
from studies.loop.whole.whole_fits import FEWEST_SAMPLES, all_at_once, gain, weighed_under
from studies.loop.whole.whole_records import MISSED

FIRST, THEN = (1, 2, 4, 8), (16,)
"""Swings of each release that are fitted before all of it, from several starts, and where these led.

Of four at once the sum of squares has minima beside the true one; from one, and then two, nearly all starts lead there.
"""

STARTS = 6
"""Starts that are gone on from: those that explain most of the first swing as they are."""

ENOUGH = 2
"""So many of them that lead to a floor which meets the first swings are enough."""

NEAR, ENOUGH_NEAR = 3.0, 4
"""Rms over the noise of one swing from which a floor is near: so many starts that lead there without meeting more are
enough as well.  With other friction, or by another law of slip, it may be met."""

FAR_OFF = 15.0
"""The same of several swings from which a fit goes no further."""

BY_CHANCE = 4.0
"""Standard deviations of noise alone up to which one swing of each release has to be met: its friction and its law of
slip tell in those that follow."""

SLIDES, FRICTIONS = 0.01, 16
"""Share of b/h by which friction is over that where one is tried with shaken records first, and how many up to what
was taken, by equal shares of that: near b/h a hundredth decides whether a block slides or rocks."""

AS_HARD_ALONG, HELD = 1.0, 3.0
"""Stiffness along the floor over that into it [1] of a floor of which releases do not tell it, and what is far from
that: the harder it is, the longer runs take."""

HARDEST_ALONG = 10.0
"""The same up to which it is fitted to releases; beyond, the corners are all but held."""

FEWEST = 2
"""Releases from which a floor is told."""


@dataclass(frozen=True)
class Told:
    """A floor that meets all releases."""

    candidate: Candidate
    model: LoopModel
    releases: tuple[Window, ...]  # from the leans that were found


def from_releases(
    setup: Setup, onto: Trial, pool: Sequence[Candidate], tell: Callable[[str], None] = lambda text: None
) -> tuple[Trial, Fit] | None:
    """The first floor that meets all releases, with its fit on whole records; none where none does, or they are few.

    What it is tried on top of is fitted with it.

    Its friction is fitted too, with the first swings only where they are not met without that, and how its corners slip
    is that which meets the releases.  Its swings have the states that serve the model best, and no say in its
    parameters.

    Args:
        setup: what the loop works on.
        onto: the calibrated block, or that with effects.
        pool: candidates; those that are floors are tried, softer ones under their own name.
        tell: is told what is being done.
    """
    if not tell_of_floors(setup):
        return None
    for floor in (c for c in pool if c.costly and c.beyond is None):
        tell(f"{floor.name}, from releases")
        told = _told(setup, onto, floor, _releases(setup))
        if told is not None:
            return _on_all_records(setup, onto, _by_its_name(told, pool))
    return None


def tell_of_floors(setup: Setup) -> bool:
    """Whether there are releases enough to tell a floor from: what none of them is met by is no floor then."""
    return setup.by_rotation and len(_releases(setup)) >= FEWEST


def by_releases(trial: Trial) -> bool:
    """Whether a trial is one of a floor that was told from releases: its swings have no say in it."""
    return trial.costly and not trial.swing.parameters


def _releases(setup: Setup) -> list[Window]:
    return [w for w in setup.whole if setup.campaign.tests[w.test].kind == "free"]


def _first_swings(setup: Setup, releases: Sequence[Window], counts: Sequence[int]) -> list[list[Window]]:
    """The releases up to so many swings each, for each of the counts."""
    out = []
    for count in counts:
        parts = [w.until(_end_of(setup, w, count)) for w in releases]
        out.append([p if p.data.size >= FEWEST_SAMPLES else w for p, w in zip(parts, releases, strict=True)])
    return out


def _end_of(setup: Setup, release: Window, count: int) -> float:
    """When so many swings of a release are over [s]; its end if it has no more."""
    ends = sorted(float(w.times[-1]) for w in setup.swings if w.record == release.record)
    return ends[count - 1] if len(ends) >= count else float(release.times[-1])


def _told(setup: Setup, onto: Trial, floor: Candidate, releases: Sequence[Window]) -> Told | None:
    """That floor, if it meets the releases from some start.

    With friction as it is taken to be, or fitted too; other laws of slip are asked last, or where something is left.
    """
    declared = onto.swing.model.declared
    first = _first_swings(setup, releases, FIRST)
    further = [*_first_swings(setup, releases, THEN), list(releases)]
    fixed, freed = (_no_harder_along(c) for c in (no_harder(floor, declared), with_friction(floor, declared)))
    without = _left_without(setup, onto, first)
    starts = _best_starts(setup, onto, fixed, first[0])
    forms: list[tuple[Candidate, Mapping[str, float]]] = [(fixed, {})]
    if floor.otherwise:
        forms += [(freed, {}), *((form, law) for law in floor.otherwise for form in (fixed, freed))]
    for k, (form, changed) in enumerate(forms):
        begun = [model.changed(changed) for model in starts]
        found, near = _from_starts(setup, onto, form, begun, first, without, NEAR if k else FAR_OFF)
        carried = (_carried_on(setup, fitted, further) for fitted in found)
        best = min((f for f in carried if f is not None), key=lambda f: f.chi2, default=None)
        if best is not None:
            best = _preferred(setup, _by_every_law(setup, onto, best, found, freed, further))
            best = _as_hard_along(setup, best, floor)
            slip = {name: best.model.get(name) for law in floor.otherwise for name in law}
            candidate = with_friction(floor, declared)
            return Told(replace(candidate, fixed={**candidate.fixed, **slip}, otherwise=()), best.model, best.windows)
        if k == 0:
            starts = near  # how corners slip is told by more than one swing
    return None


def _no_harder_along(floor: Candidate) -> Candidate:
    """A floor that is fitted no harder along itself than runs allow that many times."""
    parameters = (replace(p, high=HARDEST_ALONG) if p.name == floor.minima_in else p for p in floor.parameters)
    return replace(floor, parameters=tuple(parameters))


def _by_every_law(
    setup: Setup, onto: Trial, best: Fit, found: Sequence[Fit], freed: Candidate, further: Sequence[Sequence[Window]]
) -> list[Fit]:
    """Of each law of slip the fit that meets releases best, its friction fitted, where one leaves something of them.

    found: the fits of the first swings, from which each begins: by a wrong law it is led away from there.
    """
    if best.rms <= STRUCTURE:
        return [best]
    out = [best]
    parameters = (*onto.calibrated_with(freed), *onto.parameters, *freed.parameters)
    for law in ({}, *freed.otherwise):
        carried = []
        for first in found:
            model, windows = first.model.changed(law), first.windows
            begun = fit(setup.simulator, model, parameters, windows, huber=math.inf, iterations=8, central=True)
            carried.append(_carried_on(setup, begun, further) if begun.rms < MISSED else None)
        own = [other for other in carried if other is not None]
        out += [min(own, key=lambda f: f.chi2)] if own else []
    least = min(other.chi2 for other in out)
    return [other for other in out if other.chi2 < least + PAYS]


def _as_hard_along(setup: Setup, best: Fit, floor: Candidate) -> Fit:
    """The fit of releases, or one of a floor as hard along itself as into itself that meets them as well."""
    along = floor.minima_in
    if not along or 1.0 / HELD < best.model.get(along) / AS_HARD_ALONG < HELD:
        return best
    held = best.model.changed({along: AS_HARD_ALONG})
    others = [p for p in best.parameters if p.name != along]
    found = fit(setup.simulator, held, others, best.windows, whole=True, iterations=8, central=True)
    return replace(found, parameters=best.parameters) if found.chi2 < best.chi2 + PAYS else best


def _preferred(setup: Setup, fits: Sequence[Fit]) -> Fit:
    """Of fits that releases do not tell apart that which whole records prefer, as they are."""
    if len(fits) == 1:
        return fits[0]
    windows = weighed_under(setup, fits[0].model, setup.whole)
    whole = [fit_records(setup.simulator, f.model, [], windows, iterations=4).chi2 for f in fits]
    return fits[int(np.argmin(whole))]


def _best_starts(setup: Setup, onto: Trial, floor: Candidate, first: Sequence[Window]) -> list[LoopModel]:
    """Starts, those before that explain most of the first swings as they are."""
    there: list[tuple[float, int, LoopModel]] = []
    for k, start in enumerate(floor.starts):
        try:
            model = onto.swing.model.changed({**floor.fixed, **start})
            found = fit(setup.simulator, model, [], first, huber=math.inf, iterations=0)
        except ValueError:
            continue  # numbers that do not go together on this block
        there.append((found.chi2, k, model))
    return [model for _, _, model in sorted(there)[:STARTS]]


def _left_without(setup: Setup, onto: Trial, first: Sequence[Sequence[Window]]) -> list[float]:
    """Chi-square of the first swings of the releases without a floor that gives."""
    out, windows = [], list(first[0])
    for more in first:
        windows = _as_far(more, windows)
        there = fit(setup.simulator, onto.swing.model, onto.every, windows, huber=math.inf, iterations=8, central=True)
        windows = list(there.windows)
        out.append(there.chi2)
    return out


def _from_starts(
    setup: Setup,
    onto: Trial,
    floor: Candidate,
    starts: Sequence[LoopModel],
    first: Sequence[Sequence[Window]],
    without: Sequence[float],
    far_off: float,
) -> tuple[list[Fit], list[LoopModel]]:
    """Fits that meet the first swings of the releases, the best of each minimum; and where starts led that came near.

    Plain least squares: from afar all releases are missed by far, and have to count.

    without: chi-square of each of `first` without the floor; one that leaves more goes no further.
    """
    found: list[Fit] = []
    near: list[Fit] = []
    parameters = (*onto.calibrated_with(floor), *onto.parameters, *floor.parameters)
    for start in starts:
        model, windows = start, list(first[0])
        for k, more in enumerate(first):
            windows = _as_far(more, windows)
            there = fit(setup.simulator, model, parameters, windows, huber=math.inf, iterations=8, central=True)
            if k == 0 and not there.converged and there.rms > _of_noise(setup, there):  # on its way, it may be
                there = fit(
                    setup.simulator, there.model, parameters, there.windows, huber=math.inf, iterations=8, central=True
                )
            model, windows = there.model, list(there.windows)
            if there.chi2 > without[k]:
                break
            if k == 0 and there.rms < NEAR:
                near.append(there)
            if there.rms > (_of_noise(setup, there) if k == 0 else far_off):
                break
        else:
            found += [there] if there.rms < MISSED else []
        if len(found) == ENOUGH or len(near) == ENOUGH_NEAR:
            break
    return _of_each_minimum(floor, found), [f.model for f in sorted(near, key=lambda f: f.chi2)[:ENOUGH]]


def _of_noise(setup: Setup, fitted: Fit) -> float:
    """Rms over its noise that a floor may leave of one swing: more than that, and it is none, whatever follows."""
    if not declared_noise(setup):
        return MISSED
    return max(STRUCTURE, 1.0 + BY_CHANCE / math.sqrt(2.0 * max(fitted.samples, 1)))


def _as_far(windows: Sequence[Window], fitted: Sequence[Window]) -> list[Window]:
    """Windows from the leans of others of the same releases."""
    return [w.moved(o.theta, o.omega) for w, o in zip(windows, fitted, strict=True)]


def _of_each_minimum(floor: Candidate, found: Sequence[Fit]) -> list[Fit]:
    """Of fits that are of one minimum along the floor the best one."""
    out: list[Fit] = []
    for fitted in sorted(found, key=lambda f: f.chi2):
        along = floor.minima_in
        if all(along and abs(math.log(fitted.model.get(along) / o.model.get(along))) > SAME for o in out):
            out.append(fitted)
    return out


def _carried_on(setup: Setup, first: Fit, further: Sequence[Sequence[Window]]) -> Fit | None:
    """A fit of the first swings of releases carried on to more of them, as long as they are met."""
    found = first
    for more in further:
        windows = _as_far(more, found.windows)
        found = fit(setup.simulator, found.model, first.parameters, windows, whole=True, iterations=8, central=True)
        if found.rms >= MISSED:
            return None
    return found


def _by_its_name(told: Told, pool: Sequence[Candidate]) -> Told:
    """The floor by the name that one as hard has: corners on which it is a bounce that is seen."""
    for c in pool:
        if c.same_as is None or c.beyond is None or told.candidate.name not in c.beyond[1]:
            continue
        stiffness, most = c.beyond[0], c.beyond[1][told.candidate.name]
        named = with_friction(c, told.model.declared)
        same = c.same_as(told.model)
        if told.model.get(stiffness) <= most or any(not p.low <= same[p.name] <= p.high for p in named.parameters):
            continue
        effects = {k: v for k, v in told.model.effects.items() if k != told.candidate.effect}
        slip = {name: same[name] for law in named.otherwise for name in law}
        candidate = replace(named, fixed={**named.fixed, **slip}, otherwise=())
        values = {p.name: same[p.name] for p in named.parameters}
        model = replace(told.model, effects=effects).changed({**candidate.fixed, **values})
        return Told(candidate, model, told.releases)
    return told


def _with_friction_of_shaken(setup: Setup, trial: Trial, model: LoopModel, windows: Sequence[Window]) -> LoopModel:
    """The model, or that with the friction with which whole records are met best as they are, if these are missed.

    Releases may tell little of it: where friction gives way under shaking alone it is far from what was taken.
    """
    friction = next((p for p in trial.parts[-1].parameters if p.name.endswith(".friction")), None)
    weighed = weighed_under(setup, model, windows)
    as_it_is = fit(setup.simulator, model, [], weighed, whole=True, iterations=0)
    if friction is None or as_it_is.rms < MISSED:
        return model
    tips, taken = friction.low, model.get(friction.name)
    if taken <= (1.0 + SLIDES) * tips:
        return model
    values = tips * (1.0 + np.geomspace(SLIDES, taken / tips - 1.0, FRICTIONS, endpoint=False))
    tried = [
        fit(setup.simulator, model.changed({friction.name: float(v)}), [], weighed, whole=True, iterations=0)
        for v in values
    ]
    return min([as_it_is, *tried], key=lambda f: f.chi2).model


def _on_all_records(setup: Setup, onto: Trial, told: Told) -> tuple[Trial, Fit]:
    """The floor fitted to whole records, shaken ones too, and the trial of it."""
    trial = onto.with_(told.candidate, onto.swing)
    leant = {w.test: w for w in told.releases}
    known = [w.moved(leant[w.test].theta, leant[w.test].omega) if w.test in leant else w for w in setup.whole]
    model = _with_friction_of_shaken(setup, trial, told.model, known)
    leans = fit_records(setup.simulator, model, [], weighed_under(setup, model, known), iterations=4)
    whole = all_at_once(setup, trial, leans)
    if not whole.converged:
        whole = all_at_once(setup, trial, whole)
    trial, whole = _with_its_sliding(setup, onto, trial, whole)
    swing = fit(setup.simulator, whole.model, [], onto.swing.windows, iterations=3)
    return replace(trial, swing=swing), whole


def _with_its_sliding(setup: Setup, onto: Trial, trial: Trial, whole: Fit) -> tuple[Trial, Fit]:
    """The same, with sliding by its name where friction near b/h is what whole records are met by."""
    floor = trial.parts[-1]
    friction = next((p for p in floor.parameters if p.name == f"{floor.effect}.friction"), None)
    if friction is None or whole.model.get(friction.name) > SLIDES_BELOW * friction.low:
        return trial, whole
    gripping = whole.model.changed({friction.name: floor.starts[0][friction.name]})
    if gain(setup, fit_records(setup.simulator, gripping, [], whole.windows, iterations=4), whole) <= LEAST_GAIN:
        return trial, whole
    slides = sliding_on(floor)
    effects = {name: dict(values) for name, values in whole.model.effects.items()}
    effects["sliding"] = {"friction": effects[floor.effect].pop("friction"), "ratio_kept": 0.0}
    named = onto.with_(slides, trial.swing)
    parameters = tuple(replace(p, name="sliding.friction") if p == friction else p for p in whole.parameters)
    return named, replace(whole, model=replace(whole.model, effects=effects), parameters=parameters)
