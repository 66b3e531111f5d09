"""Effects that single swings do not show, or only hint at, looked for in whole records.

Whole records are rugged: a small difference grows with every impact.  So they are asked only where swings say nothing
or what they say is not borne out, while they are predictable, and from several starts.

Status   planted effects that swings only hint at are traced (studies/loop_trials.py)
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from studies.loop.fits.estimating import sensor_covariance
from studies.loop.fits.fitting import Fit, fit, fit_records
from studies.loop.models.candidates import Candidate
from studies.loop.models.model import DRIFT, FADING, LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.records.preparing import Setup
from studies.loop.records.scoring import errors
from studies.loop.runs.at_once import at_once
from studies.loop.swings.trials import PAYS, Round, Trial, bic
from studies.loop.whole.remaining import CLOSELY, LEAST_SPEED, remembers
from studies.loop.whole.rivals import TWIN, Rival
from studies.loop.whole.settling import counted_together, predictable
from studies.loop.whole.whole_fits import (
    gain,
    leans_and_all,
    neighbours,
    reweighed,
    weighed_under,
    where_told,
    whole_fit,
)

LEAST_OF_A_SCAN = 0.15
"""Share by which an effect that whole records alone show has to lower their rms: their sums of squares are rugged."""

MISSED = 1.3
"""Rms of whole records over their noise from which they are missed, one or all of them: then they are asked."""

HINT = 6.0
"""What such an effect lowers the criterion of the swings by, at the least: odds of exp(3)."""

MOST_HINTS = 3
"""So many of them are fitted to whole records."""

STARTS = 7
"""Starts of such a fit."""

SPOILT = 1.5
"""A record is spoilt by an effect that makes its rms so many times larger, helped by one that makes it as many times
smaller."""

LEAST_RECORDS = 2
"""So many records an effect has to explain that is scanned, or that swings do not hint at: in one alone, one of many
values may hit by chance."""

TELLING = 3
"""Records on which the starts are compared."""

DRAWS_OF_A_SCAN = 4
"""Draws of base noise under which each of the scanned values is judged; the best one is weighed as well as anything."""

LIKELY = 1.0 / 3.0
"""Share of the scanned values that are judged under what base noise does there: those whose runs come nearest."""


def asked(
    setup: Setup, onto: Trial, whole: Fit, tried: Round, pool: Sequence[Candidate], hint: float = HINT
) -> tuple[Rival, ...]:
    """What whole records confirm of the effects that swings only hint at, and of those scanned.

    Where swings hint at none, of those that they would have first, if these explain more than one record: what is too
    small for a swing may be large after twenty.  Not of floors that give, on which runs take long.
    """
    if hints(onto, tried, hint):
        confirmed = hinted(setup, onto, whole, tried, hint)
    else:
        quick = replace(tried, trials=[t for t in tried.trials if not t.costly])
        confirmed = hinted(setup, onto, whole, quick, -math.inf, LEAST_RECORDS)
    return merged(confirmed, scan(setup, onto, whole, pool))


def merged(one: Sequence[Rival], other: Sequence[Rival]) -> tuple[Rival, ...]:
    """Rivals of both, the best first, each set of effects once."""
    best: dict[tuple[str, ...], Rival] = {}
    for rival in sorted([*one, *other], key=lambda r: r.criterion):
        best.setdefault(rival.trial.names, rival)
    return tuple(best.values())


def ranked(setup: Setup, rivals: Sequence[Rival]) -> tuple[Rival, ...]:
    """The rivals, the best first: by their criterion, but none before one that explains far more of whole records.

    The criterion is of what is predictable, for beyond it no fit finds its way.  To compare what was found needs none:
    a model that goes on where another one is lost says more than one that is closer up to there.  One that is lost
    nowhere is not outdone: how close it is to the end of a record hangs on the noise of the base.
    """
    if not rivals:
        return ()
    by_criterion = sorted(rivals, key=lambda r: r.criterion)
    best = by_criterion[0]
    for rival in by_criterion[1:]:
        if np.any(best.whole.by_window > MISSED) and explains_more(setup, rival.whole, best.whole):
            best = rival
    others = [r for r in by_criterion if r is not best]
    refused = (replace(r, refused=explains_more(setup, best.whole, r.whole)) for r in others)
    return (replace(best, refused=False), *refused)


def as_the_base_moves_them(setup: Setup, rivals: Sequence[Rival]) -> tuple[Rival, ...]:
    """Rivals among which whole records decided, those further from the first one by as much as the base lets them say.

    The noise of the base moves many samples of a record at once, so that a difference of their sums of squares counts
    that much less.  Of those that are twins by that, the one comes first that explains far more up to the ends.
    """
    if len(rivals) < 2:
        return tuple(rivals)
    first = rivals[0]
    times = counted_together(setup, first.trial, first.whole)
    nearer = [replace(r, criterion=first.criterion + (r.criterion - first.criterion) / times) for r in rivals]
    best = nearer[0]
    for rival in nearer[1:]:
        alike = not rival.refused and rival.criterion - first.criterion < TWIN
        if alike and explains_more(setup, rival.whole, best.whole):
            best = rival
    return (best, *(r for r in nearer if r is not best))


def explains_more(setup: Setup, found: Fit, other: Fit) -> bool:
    """Whether a fit of whole records leaves by far less than another one; what is noise to either counts as noise."""
    return _by_far(*_left_by_both(setup, found, other))


def halves(setup: Setup, found: Fit, other: Fit) -> bool:
    """Whether it leaves by far less, and less than half of what the other one leaves over the noise."""
    left, plain, samples = _left_by_both(setup, found, other)
    return _by_far(left, plain, samples) and left - samples < 0.5 * (plain - samples)


def _by_far(left: float, plain: float, samples: int) -> bool:
    return left < plain - PAYS * max(1.0, left / samples)


def _left_by_both(setup: Setup, found: Fit, other: Fit) -> tuple[float, float, int]:
    """What two fits of whole records leave where these tell them apart, and the samples there."""
    sds = [1.0 / np.minimum(w.weights, o.weights) for w, o in zip(found.windows, other.windows, strict=True)]
    own, its = (
        fit(
            setup.simulator, f.model, [], [replace(w, sd=sd) for w, sd in zip(f.windows, sds, strict=True)],
            whole=True, iterations=0,
        )
        for f in (found, other)
    )  # fmt: skip
    return where_told(own, its)


def remembering_all(setup: Setup, trial: Trial, whole: Fit) -> tuple[Trial, Fit]:
    """The trial and its fit on whole records; of one that remembers impacts, all of them, where these prefer that.

    No record shows those that are too slow to end a swing: swings do not tell whether they count, and where they do,
    what swings say of how long impacts are remembered is far off.  Whole records are fitted twice in a row then.
    """
    if not setup.by_rotation or not remembers(trial) or trial.swing.model.get(LEAST_SPEED) == 0.0:
        return trial, whole
    every = _from(trial, trial.swing.model.changed({LEAST_SPEED: 0.0}))
    _, first = leans_and_all(setup, every)
    there = whole_fit(setup, _from(every, first.model))
    return (_from(trial, there.model), there) if explains_more(setup, there, whole) else (trial, whole)


def _from(trial: Trial, model: LoopModel) -> Trial:
    """The trial with a model that is not the one its swings were fitted by; fits of whole records begin from it."""
    return replace(trial, swing=replace(trial.swing, model=model))


def scan(setup: Setup, onto: Trial, whole: Fit, pool: Sequence[Candidate]) -> tuple[Rival, ...]:
    """Of the effects that are scanned on whole records those that pay, each in the form that comes nearest.

    Such an effect acts at lift-off, or on and off as friction gives way: no swing shows it, or only those that begin
    with a slip that nobody knows.  Its sum of squares is rugged, so that it is scanned over its range first, then more
    finely about the best, and fitted from there.
    """
    windows = predictable(whole.windows)
    open_to_it = [c for c in pool if c.scanned and c.effect not in onto.effects]
    if not open_to_it or not windows:
        return ()
    without = fit_records(setup.simulator, whole.model, onto.every, windows, iterations=8)
    begun = [
        (first, candidate)
        for candidate in open_to_it
        # Those that swings may show are asked only where these leave whole records unexplained.
        if (not candidate.in_swings or without.rms > MISSED)
        and (first := _scanned(setup, whole, without, candidate)) is not None
    ]
    found: dict[str, Rival] = {}
    for (_, near), candidate in sorted(begun, key=lambda pair: pair[0][0]):
        if candidate.effect not in found:
            rival = confirmed(setup, onto, whole, without, near, candidate)
            found |= {} if rival is None else {candidate.effect: rival}
    return tuple(found.values())


def confirmed(
    setup: Setup, onto: Trial, whole: Fit, shared: Fit, near: Fit, candidate: Candidate
) -> Rival | None:  # fmt: skip
    """The candidate fitted from near where it explains most, or None if it does not pay.

    shared: a fit of the windows on which rivals are compared.
    """
    without = fit_records(setup.simulator, whole.model, onto.every, near.windows, iterations=8)
    if without.chi2 - near.chi2 < PAYS * max(1.0, near.chi2 / without.samples):
        return None
    parameters = (*onto.calibrated_with(candidate), *onto.parameters, *candidate.parameters)
    cheap = not any(part.costly for part in (*onto.parts, candidate))
    ended = fit_records(setup.simulator, near.model, parameters, near.windows, iterations=12, again=cheap)
    rest = min(_alone(setup, onto, ended), without, key=lambda f: f.chi2)
    if rest.chi2 - ended.chi2 < PAYS * max(1.0, ended.chi2 / ended.samples):
        return None
    helped = _helped(ended, rest)
    if 0 < np.count_nonzero(helped) < LEAST_RECORDS:
        # What lowers another one by far, less than half as it is of what is left there, is no value that hit one alone.
        helped |= _told(ended, rest, counted_together(setup, onto.with_(candidate, onto.swing), ended))
    if np.count_nonzero(helped) < LEAST_RECORDS or not _explains(ended, rest) or _at_the_cost_of_others(ended, rest):
        return None
    # What it makes unpredictable is not in these windows, and may have been explained.
    leans = fit(setup.simulator, ended.model, [], shared.windows, whole=True, iterations=4)
    if _at_the_cost_of_others(leans, shared):
        return None
    compared = fit_records(setup.simulator, ended.model, parameters, leans.windows, iterations=12, again=cheap)
    rival = _as_rival(setup, onto, whole, candidate, ended, parameters, by_itself=True)
    rival = replace(rival, criterion=bic(compared))
    return rival if gain(setup, whole, rival.whole) > LEAST_OF_A_SCAN else None


def _alone(setup: Setup, onto: Trial, found: Fit) -> Fit:
    """A fit of the same records from there without the effect: what it gains is not the effect's own."""
    of, fitted = onto.swing.model.effects, {p.name for p in onto.every}
    effects = {
        name: {k: value for k, value in values.items() if k in of[name]}
        for name, values in found.model.effects.items() if name in of
    }  # fmt: skip
    drift = found.model.drift if DRIFT in fitted else onto.swing.model.drift
    fading = found.model.fading if FADING in fitted else onto.swing.model.fading
    changes = {full: how for full, how in found.model.changes.items() if full in onto.swing.model.changes}
    model = replace(found.model, effects=effects, drift=drift, fading=fading, changes=changes)
    return fit_records(setup.simulator, model, onto.every, found.windows, iterations=8)


def _scanned(setup: Setup, whole: Fit, without: Fit, candidate: Candidate) -> tuple[float, Fit] | None:
    """The best of the scanned values and those between it and its neighbours, and how far off it is.

    Each is judged under what base noise does with the effect there: a record that hangs finely on the base then, and
    not without the effect, would own the sum of squares and lead to where it happens to be met.
    """

    def at(values: Mapping[str, float], draws: int | None = DRAWS_OF_A_SCAN) -> tuple[float, Fit] | None:
        try:
            model = without.model.changed({**candidate.fixed, **values})
            windows = weighed_under(setup, model, whole.windows, draws)
            found = fit(setup.simulator, model, [], windows, whole=True, iterations=2)
        except ValueError:
            return None  # it does not go together with what is there already
        # The logarithm, as in a likelihood: what explains a record by making it unpredictable has to pay for it.
        return found.chi2 - 2.0 * sum(float(np.sum(np.log(w.weights * w.noise))) for w in windows), found

    def each(values: Sequence[Mapping[str, float]]) -> list[tuple[float, Fit, Mapping[str, float]]]:
        answers = at_once([partial(at, v) for v in values])
        return [(*answer, v) for v, answer in zip(values, answers, strict=True) if answer is not None]

    found = each(_likely(setup, whole, without, candidate))
    if not found:
        return None
    k = min(range(len(found)), key=lambda i: found[i][0])
    at_best = next(i for i, v in enumerate(candidate.scanned) if v is found[k][2])
    between = [
        {name: value + share * (candidate.scanned[j][name] - value) for name, value in found[k][2].items()}
        for j in (at_best - 1, at_best + 1) if 0 <= j < len(candidate.scanned) for share in (0.25, 0.5, 0.75)
    ]  # fmt: skip
    found += each(between)
    again = at(min(found, key=lambda f: f[0])[2], None)
    if again is None:
        return None
    off, best = again
    windows = predictable(best.windows)
    return (off, fit(setup.simulator, best.model, [], windows, whole=True, iterations=2)) if windows else None


def _likely(setup: Setup, whole: Fit, without: Fit, candidate: Candidate) -> list[Mapping[str, float]]:
    """The scanned values whose runs come nearest, in their order.

    One run of each record says enough to leave out most.  Near means by the sum of log(1 + r^2), since what is lost of
    a record is lost, however far off it goes.
    """

    def off(values: Mapping[str, float]) -> float:
        try:
            model = without.model.changed({**candidate.fixed, **values})
            found = fit(setup.simulator, model, [], whole.windows, whole=True, iterations=0)
        except ValueError:
            return math.inf  # it does not go together with what is there already
        return sum(float(np.sum(np.log1p(r * r))) for r in found.residuals)

    each = at_once([partial(off, values) for values in candidate.scanned])
    near = {k: value for k, value in enumerate(each) if value < math.inf}
    kept = sorted(near, key=near.__getitem__)[: math.ceil(LIKELY * len(candidate.scanned))]
    return [candidate.scanned[k] for k in sorted(kept)]


def _as_rival(
    setup: Setup, onto: Trial, whole: Fit, candidate: Candidate, own: Fit, parameters: Sequence[Parameter],
    by_itself: bool = False,
) -> Rival:  # fmt: skip
    """An effect as a fit of whole records has it.

    by_itself: whether it is fitted under what base noise does with the effect there, and not under the weights of
        `whole`, which rivals are compared by.
    """
    if candidate.in_swings:
        swings = fit(setup.simulator, own.model, [], onto.swing.windows, iterations=3).windows
        # As whole records have it: how far the swings would let it go is what they say of it.
        swing = fit(setup.simulator, own.model, parameters, swings, iterations=0)
    else:
        value = {p.name: own.model.get(p.name) for p in candidate.parameters}
        swing = fit(setup.simulator, onto.swing.model.changed(value), onto.every, onto.swing.windows, iterations=3)
    settled = onto.with_(candidate, swing)
    ended = whole_fit(setup, settled, None if by_itself else whole)
    held = errors(setup, ended.model, ended.windows).holdout
    price = bic(ended) - ended.chi2
    return Rival(settled, ended, bic(own), price + (reweighed(setup, ended, whole) if by_itself else ended).chi2, held)


def hints(onto: Trial, tried: Round, hint: float = HINT) -> list[Trial]:
    """The trials of a round that swings hint at, the strongest hints first; of forms tried in turn the best one.

    Where swings hint at anything, its twins are among them: to tell these apart they have no say.  A floor that gives,
    on which runs take long, is not among them where swings speak for another effect by far.
    """
    ranked = sorted((t for t in tried.trials if t.parts[-1].in_swings), key=lambda t: bic(t.swing))
    if not ranked or bic(ranked[0].swing) >= bic(onto.swing) - hint:
        return []
    enough = max(bic(onto.swing) - hint, bic(ranked[0].swing) + TWIN)
    best: dict[str, Trial] = {}
    for trial in ranked:
        behind = trial.costly and bic(trial.swing) > bic(ranked[0].swing) + PAYS
        if bic(trial.swing) < enough and not behind:
            best.setdefault(trial.parts[-1].after or trial.names[-1], trial)
    return list(best.values())[:MOST_HINTS]


def hinted(
    setup: Setup, onto: Trial, whole: Fit, tried: Round, hint: float = HINT, records: int = 0
) -> tuple[Rival, ...]:  # fmt: skip
    """Of the effects that swings only hint at, those that whole records confirm, the best first.

    hint: what an effect lowers the criterion of the swings by, at the least.
    records: so many that were missed it has to help, or to explain to near their noise, besides.

    An effect may be too small for a swing and yet turn the end of a record.  Records are compared while they are
    predictable, and one that is lost altogether counts less.  What is predictable may be within its noise where the
    rest is not: the base moves many samples at once.
    """
    windows = predictable(whole.windows)
    if not windows or not np.any(whole.by_window > MISSED):
        return ()
    without = fit_records(setup.simulator, whole.model, onto.every, windows, iterations=8)
    # The records that are missed most tell the starts apart.
    telling = np.sort(np.argsort(-without.by_window)[:TELLING])
    some = [windows[i] for i in telling]
    found = []
    for trial in hints(onto, tried, hint):
        models = [trial.swing.model]
        if not trial.costly:
            sure = sensor_covariance(setup.simulator, trial.swing)
            models = neighbours(trial.swing, sure, trial.parts[-1].parameters[0], STARTS)
        begun = at_once(
            [
                partial(fit, setup.simulator, model, trial.every, some, whole=True, iterations=4, central=True)
                for model in models
            ]
        )
        if not begun:
            continue
        nearest, states = min(begun, key=lambda f: f.chi2), list(windows)
        # Runs on floors that give take long: none further where the records that are missed most gain nothing.
        if trial.costly and not _lowers(nearest, _only(without, telling)):
            continue
        for i, window in zip(telling, nearest.windows, strict=True):
            states[i] = window
        own = fit_records(
            setup.simulator, nearest.model, trial.every, states, iterations=12, again=not trial.costly
        )  # fmt: skip
        alone = _alone(setup, onto, own)
        rest = min(alone, without, key=lambda f: f.chi2)
        helped = _helped(own, rest) | ((rest.by_window > MISSED) & (own.by_window < CLOSELY))
        if np.count_nonzero(helped) < records:
            helped |= _told(own, rest, counted_together(setup, trial, own))
        if _at_the_cost_of_others(own, rest) or np.count_nonzero(helped) < records:
            continue
        rival = _as_rival(setup, onto, whole, trial.parts[-1], own, trial.every)
        if _explains(own, rest):
            found.append(rival)
        elif gain(setup, whole, rival.whole) > LEAST_OF_A_SCAN:
            there = replace(onto, swing=replace(onto.swing, model=alone.model))
            if gain(setup, whole_fit(setup, there, whole), rival.whole) > LEAST_OF_A_SCAN:
                found.append(rival)
    return tuple(sorted(found, key=lambda r: r.criterion))


def _only(found: Fit, records: Iterable[int]) -> Fit:
    """What a fit says of some of the records."""
    kept = [*records]
    return replace(
        found, windows=tuple(found.windows[i] for i in kept), residuals=tuple(found.residuals[i] for i in kept)
    )


def _lowers(own: Fit, without: Fit) -> bool:
    """Whether an effect lowers what is left of records at all."""
    with_it, plain, _ = where_told(own, without)
    return with_it < plain


def _explains(own: Fit, without: Fit) -> bool:
    """Whether an effect lowers what is left of records by enough; what is lost with and without it says nothing."""
    with_it, plain, _ = where_told(own, without)
    return with_it < (1.0 - LEAST_OF_A_SCAN) ** 2 * plain


def _helped(own: Fit, without: Fit) -> NDArray[np.bool_]:
    """Which records an effect helps that were missed."""
    return np.asarray((without.by_window > MISSED) & (without.by_window > SPOILT * own.by_window))


def _told(own: Fit, without: Fit, together: float) -> NDArray[np.bool_]:
    """Which records an effect lowers by far, few as their predictable samples may be over their noise.

    together: by how many times a difference of chi-square is too large, since the base moves many samples at once.
    """
    samples = np.array([r.size for r in own.residuals])
    return np.asarray((without.by_window**2 - own.by_window**2) * samples > PAYS * together)


def _at_the_cost_of_others(own: Fit, without: Fit) -> bool:
    """Whether an effect that helps some records spoils others that were explained: what really acts does not."""
    explained = without.by_window < MISSED
    return bool(np.any(explained & (own.by_window > MISSED) & (own.by_window > SPOILT * without.by_window)))
