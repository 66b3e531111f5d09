"""The search, one effect after the other: what was tried, what swings and whole records accept of it.

Status   rounds with stubs for fits (tests); `studies.loop.search.searching` says where they lead
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from studies.loop.fits.fitting import Fit
from studies.loop.models.candidates import Candidate
from studies.loop.records.preparing import Setup
from studies.loop.swings.tracing import FAR_LESS, search, search_costly
from studies.loop.swings.trials import LEAST_GAIN, PAYS, Round, Trial, pays
from studies.loop.whole.floors_of_releases import by_releases
from studies.loop.whole.floors_that_give import in_agreement
from studies.loop.whole.remaining import (
    MISSED_BY_FAR,
    by_chance,
    explains,
    over_noise,
    rms_but_for_one,
    slips,
    structure,
)
from studies.loop.whole.rivals import Rival
from studies.loop.whole.whole_fits import MENDED, gain, reweighed, telling, whole_fit
from studies.loop.whole.whole_records import HINT, MISSED, asked, explains_more, merged, ranked

Tell = Callable[[str], None]
Accepted = tuple[Trial, Fit]
"""A trial and its fit on whole records."""

MOST_EFFECTS = 3

MOST_EFFECTS_COSTLY = 2
"""The same where runs take long."""

MUCH_OVER_NOISE = 1.5
"""What a first effect leaves of swings, over what structure begins with, from which whole records are not asked."""

NOTHING_LEFT = 1.02
"""Rms over the noise in the swings below which no third effect is looked for."""


@dataclass(frozen=True)
class Path:
    """What was accepted, one on top of the other."""

    trials: list[Trial]
    rounds: list[Round]  # those that brought in the effects first, one each
    fits: list[Fit]  # of the trials on whole records
    rivals: tuple[Rival, ...] = ()  # of the last trial where whole records decided among them
    decided: frozenset[str] = frozenset()  # the forms on which they decided
    said: tuple[str, ...] = ()  # of the way there
    term: Trial | None = None  # one coefficient without a name that explains what none of this does

    @property
    def last(self) -> Trial:
        """All that was accepted."""
        return self.trials[-1]

    @property
    def whole(self) -> Fit:
        """Its fit on whole records."""
        return self.fits[-1]


def followed(
    setup: Setup, begin: Path, pool: Sequence[Candidate], tell: Tell, *, later: bool = False,
    begun: Sequence[Round] = (), most: int = MOST_EFFECTS, by_swings: bool = False,
) -> Path:  # fmt: skip
    """The search, one effect after the other.

    begin: what is accepted already.
    later: whether candidates whose runs take long are left out; then two effects have to be enough.
    begun: rounds of a search that left them out, swings alone having been asked if they are left out again.
    most: effects after which it ends.
    by_swings: whether whole records are not asked for effects that swings only hint at.
    """
    path, rounds, fits = list(begin.trials), list(begin.rounds), list(begin.fits)
    rivals, decided = begin.rivals, set(begin.decided)
    for depth in range(len(rounds), most):
        if depth > 1 and ((later and not by_chance(setup, path[-1])) or path[-1].swing.rms < NOTHING_LEFT):
            break
        last, whole = path[-1], fits[-1]
        if last.costly and (
            depth >= MOST_EFFECTS_COSTLY or explains(setup, last, whole) or stands_alone(setup, last, whole)
        ):
            break
        known = next((r for r in begun if same(r.onto, path[-1])), None)
        if known is None or not later:
            tell(f"tracing, round {depth + 1}")
        hopeless = {name for r in rounds for name, why in r.skipped.items() if why == FAR_LESS}
        left, known = _without(hopeless, pool, known)
        tried, accepted, confirmed = _round(setup, path[-1], fits[-1], left, tell, known, later, by_swings)
        tried.skipped |= dict.fromkeys(hopeless, FAR_LESS)
        rounds.append(tried)
        if accepted is None:
            break
        path.append(accepted[0])
        fits.append(accepted[1])
        rivals = confirmed
        if confirmed:
            decided.add(accepted[0].names[-1])
    return Path(path, rounds, fits, rivals, frozenset(decided))


def _without(
    hopeless: Collection[str], pool: Sequence[Candidate], known: Round | None
) -> tuple[Sequence[Candidate], Round | None]:
    """Candidates, and a round that put some of them off, without those of which an earlier round found far too little.

    A floor that gives is no small effect: what it explains by itself is not nothing beside what others do.
    """
    if known is not None:
        gone = {c.name: FAR_LESS for c in known.put_off if c.name in hopeless}
        put_off = tuple(c for c in known.put_off if c.name not in hopeless)
        known = replace(known, put_off=put_off, skipped=known.skipped | gone)
    return [c for c in pool if c.name not in hopeless], known


def same(one: Trial, other: Trial) -> bool:
    """Whether two trials are the same effects, fitted alike."""
    return one is other or (one.names == other.names and one.swing.chi2 == other.swing.chi2)


def nothing_of_swings(setup: Setup, trial: Trial) -> bool:
    """Whether a trial leaves nothing of the swings.

    Of a block that slips the median over the windows does not say that: all of them together have to leave nothing.
    """
    if not slips(trial):
        return over_noise(setup, trial) < structure(setup)
    residuals = trial.swing.residuals
    left, free = sum(float(r @ r) for r in residuals), sum(max(r.size - 2, 1) for r in residuals)
    return left < structure(setup) ** 2 * free


def stands_alone(setup: Setup, trial: Trial, whole: Fit) -> bool:
    """Whether nothing is looked for on top of a floor that gives, which takes long, though something is left of swings.

    How it gave before a swing began is known but roughly, and how a corner slips is idealised.  Whole records begin
    from a lean or from rest: they have to be met, but for one that such a slip may have sent another way.  Where all
    releases are met shaken ones must not be missed by far: what acts besides shows by more than how a corner slips.
    """
    within = MISSED_BY_FAR if by_releases(trial) else MISSED
    return trial.costly and setup.by_rotation and rms_but_for_one(whole) < within


def searched(setup: Setup, onto: Trial, pool: Sequence[Candidate], tell: Tell, later: bool) -> Round:
    """What swings say of a pool on top of a trial; later: whether candidates whose runs take long are left out.

    Of the calibrated block everything is refitted: that nothing is found there is a finding.
    """

    def explained(trial: Trial) -> bool:
        return nothing_of_swings(setup, trial)

    chance = bool(onto.parts) and by_chance(setup, onto)
    return search(setup.simulator, onto, pool, tell, explained=explained, later=later, by_chance=chance)


def _round(
    setup: Setup, onto: Trial, whole: Fit, pool: Sequence[Candidate], tell: Tell, known: Round | None = None,
    later: bool = False, by_swings: bool = False,
) -> tuple[Round, Accepted | None, tuple[Rival, ...]]:  # fmt: skip
    """What was tried on top of a trial, what of it is accepted, and the rivals if whole records decided among them.

    whole: the fit on whole records of the trial.
    known: the round as far as it was gone through without candidates whose runs take long.
    later: whether these are left out.
    by_swings: whether whole records are not asked for more.
    """

    def explained(trial: Trial) -> bool:
        return nothing_of_swings(setup, trial)

    tried = searched(setup, onto, pool, tell, later) if known is None else known
    if known is not None and not later and not any(map(explained, (onto, *known.trials))):
        search_costly(setup.simulator, tried, tell, explained)
    accepted, confirmed = _accepted(setup, onto, whole, tried, pool, tell, by_swings=by_swings)
    if later or not tried.put_off:
        return tried, accepted, confirmed
    # Swings that leave nothing say nothing of a soft floor; whole records that are missed still may, and so may swings
    # of which what was accepted leaves more than what was not.
    stands, its_whole = (onto, whole) if accepted is None else accepted
    if explains(setup, stands, its_whole) and not (setup.by_rotation and its_whole.rms > MISSED):
        return tried, accepted, confirmed
    floors = Round(onto, search_costly(setup.simulator, tried, tell, explained))
    found, decided = _accepted(setup, onto, whole, floors, (), tell, hint=-PAYS)
    # As they ended: whole records may have led one of them further, or brought one in.
    own = {t.names: t for t in floors.trials}
    tried.trials = [*(own.pop(t.names, t) for t in tried.trials), *own.values()]
    if found is None:
        return tried, accepted, confirmed
    if confirmed and decided:
        both = ranked(setup, merged(confirmed, decided))
        return tried, (both[0].trial, both[0].whole), both
    if accepted is None or explains_more(setup, found[1], accepted[1]):
        return tried, found, decided
    return tried, accepted, confirmed


def _swings_show_more(setup: Setup, trial: Trial) -> bool:
    """Whether swings leave so much over their noise that they show what else acts, or that another effect does."""
    return not slips(trial) and over_noise(setup, trial) > MUCH_OVER_NOISE * structure(setup)


def _lost_either_way(now: Fit, without: Fit) -> bool:
    """Whether whole records speak neither for an effect nor against it: none that tells is nearly met, or was so.

    Where another effect is missing still, all of them may be lost with this one and without it, a little more or less.
    """
    least, most = np.minimum(now.by_window, without.by_window), np.maximum(now.by_window, without.by_window)
    clearly = (least < MISSED_BY_FAR) | (most > MENDED * least)
    return not bool(np.any(telling(now, without) & clearly))


def _accepted(
    setup: Setup, onto: Trial, whole: Fit, tried: Round, pool: Sequence[Candidate], tell: Tell, hint: float = HINT,
    by_swings: bool = False,
) -> tuple[Accepted | None, tuple[Rival, ...]]:  # fmt: skip
    """The trial of a round that pays, and the rivals if whole records decided among them."""
    accepted: Accepted | None = None
    best = tried.best
    likely = best is not None and pays(onto.swing, best.swing)
    if best is not None and likely:
        now = whole_fit(setup, best)
        if best.costly:
            best, now = in_agreement(setup, best, now)
            tried.trials = [best if t.names == best.names else t for t in tried.trials]
        if gain(setup, whole, now) > LEAST_GAIN or _lost_either_way(now, reweighed(setup, whole, now)):
            accepted = best, now
    # Whole records are rugged: where swings say nothing, or one fit of whole records does not bear them out, or leaves
    # far too much, these have more to say; not where swings leave much themselves, of which more is to be found first.
    # Floors that give begin there from swings alone, and have been fitted so.
    unsettled = accepted is None or (accepted[1].rms > MISSED_BY_FAR and not _swings_show_more(setup, accepted[0]))
    settled = best is not None and likely and (onto.parts or not unsettled or best.costly)
    if by_swings or not setup.by_rotation or settled:
        return accepted, ()
    tell("asking whole records")
    confirmed = asked(setup, onto, whole, tried, pool, hint)
    confirmed = ranked(setup, [r for r in confirmed if gain(setup, whole, r.whole) > LEAST_GAIN])
    if not confirmed or (accepted is not None and not explains_more(setup, confirmed[0].whole, accepted[1])):
        return accepted, ()
    first = confirmed[0]
    for rival in confirmed:
        if all(t.names != rival.trial.names for t in tried.trials):
            tried.trials.append(rival.trial)
    return (first.trial, first.whole), confirmed
