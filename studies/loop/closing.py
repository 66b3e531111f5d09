"""The loop, from a campaign to a finding: calibrate, trace, refit, compare, and predict what nothing saw.

Status   campaigns with records of the response; `studies.loop.outcomes.closing` has those that hold outcomes alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from rocking.effects.learned_memory import LearnedMemory
from studies.campaigns import Campaign
from studies.campaigns.lost_base import used
from studies.loop.fits.fitting import Fit
from studies.loop.learned_curves import Curve, curves
from studies.loop.models.candidates import Candidate
from studies.loop.models.model import LoopModel
from studies.loop.models.names import readable
from studies.loop.observed.spread import floors
from studies.loop.observed.windows import scored_window, struck_before
from studies.loop.records.preparing import Setup, as_declared, prepare
from studies.loop.records.scoring import Errors, errors, leaning, median
from studies.loop.runs.keeping import Keeper
from studies.loop.search.learning_of_records import unseen
from studies.loop.search.revising import Revision, revised, taken_out, without_needless
from studies.loop.search.rounds import Path, stands_alone
from studies.loop.search.searching import traced
from studies.loop.swings.learning import (
    FREEDOMS,
    LEARNED,
    LOSS,
    MEMORY,
    alike,
    between,
    by_itself,
    learn,
    memories,
    profiles,
    renames,
    says_much,
    unnamed,
)
from studies.loop.swings.tracing import baseline, search
from studies.loop.swings.trials import LEAST_GAIN, PAYS, Round, Trial, bic
from studies.loop.whole.floors_that_give import from_whole_records
from studies.loop.whole.remaining import (
    CLOSELY,
    MISSED_BY_FAR,
    begins_roughly,
    by_chance,
    met,
    missed,
    over_noise,
    rms_but_for_one,
    roughly_begun,
    slips,
    structure,
    unexplained,
)
from studies.loop.whole.rivals import TWIN, Rival, near_all, other_forms, standing, twins, twins_from_many
from studies.loop.whole.settling import Settled, intervals, settle
from studies.loop.whole.whole_fits import whole_fit, whole_fit_from_many
from studies.loop.whole.whole_records import (
    MISSED,
    as_the_base_moves_them,
    explains_more,
    halves,
    hinted,
    hints,
    remembering_all,
)

Tell = Callable[[str], None]
Verdict = Literal["effect", "none", "unexplained"]

LOSSES = frozenset({
    "velocity_dependent_restitution", "viscous_damping", "quadratic_drag", "rounded_edges", "concave_base",
    "mass_distribution",
})  # fmt: skip
"""Effects on what is lost, or that together with another restitution look like one."""

OF_THE_BASE = frozenset({"table_pitch", "base_motion_gain", "base_motion_lag"})
"""Effects on how the base moves, in the place of which something between its sensor and the block may stand: what a
plate on springs does to a motion that is slow beside it goes with the acceleration, as a pitch may."""

TOLD_APART = 2.0
"""Difference of the criterion of swings below which they say nothing of two trials.

Source: Kass & Raftery (1995), J. Am. Stat. Assoc. 90, 773-795: "not worth more than a bare mention"."""

REFUTED = 1.5
"""Held-out error over what a true model would score from which it can refute an effect: what this project aims at."""

STANDARD_GRAVITY = 9.81
"""Gravity [m/s^2] where the laboratory does not say its own."""


@dataclass(frozen=True)
class Finding:
    """What closing the loop found."""

    setup: Setup
    verdict: Verdict
    declared: LoopModel
    before: LoopModel
    after: LoopModel
    before_fit: Fit
    after_fit: Fit
    chosen: Trial
    rivals: tuple[Rival, ...]  # each has one effect in place of another, the chosen first
    indistinguishable: tuple[tuple[str, ...], ...]
    rounds: tuple[Round, ...]  # of the search
    deciding: tuple[Round, ...]  # of each effect with a name: what was tried in its place
    errors: dict[str, Errors]  # declared, before, after
    noise_floor: float
    intervals: dict[str, tuple[float, float, float]]  # value, low, high by full name
    notes: tuple[str, ...]
    settled: Settled  # the parameters of the model after and their covariance

    @property
    def every_round(self) -> tuple[Round, ...]:
        """The rounds of the search, with what was tried in them again, and those in which effects were tried again."""
        last = {id(r.onto): r for r in self.deciding}
        again = (r for r in self.deciding if all(r.onto is not known.onto for known in self.rounds))
        return (*(r.updated(last[id(r.onto)]) if id(r.onto) in last else r for r in self.rounds), *again)

    def later(self, model: LoopModel) -> LoopModel:
        """A model of the block as the campaign leaves it: after so many tests, and with the use that it has had."""
        model = replace(model, number=len(self.setup.campaign.tests))
        if MEMORY not in model.effects:
            return model
        (memory,) = (part for part in model.parts if isinstance(part, LearnedMemory))
        use = struck_before(self.setup.records[-1], math.inf).use(memory.worn_exponent)
        return model.changed({f"{MEMORY}.used": use})

    @property
    def learned(self) -> tuple[Curve, ...]:
        """What a learned term looks like."""
        return curves(self.setup, self.settled)

    @property
    def units(self) -> str:
        """Unit of the errors."""
        return _units(self.setup)

    @property
    def metric(self) -> str:
        """What the errors are."""
        if self.setup.by_rotation:
            return "rms rotation, median over tests"
        return "rms of the accelerometers on the block, median over tests (no rotation was measured)"


def _units(setup: Setup) -> str:
    return "rad" if setup.by_rotation else "m/s^2"


def close(
    campaign: Campaign, *, g: float | None = None, tell: Tell = lambda text: None, keeper: Keeper | None = None
) -> Finding:
    """Close the loop on a campaign with records of the response.

    Args:
        campaign: as `studies.campaigns.read` gives it.
        g: gravity at the laboratory [m/s^2]; if not given, `STANDARD_GRAVITY`, or what accelerometers on the block
            read.
        tell: is told what is being done.
        keeper: keeps fits that are finished; a later call takes them from there.

    Raises:
        CampaignError: the data cannot support a finding; it says why.
    """
    campaign = used(campaign)
    declared = as_declared(campaign, STANDARD_GRAVITY if g is None else g)
    setup = prepare(campaign, declared, keeper)
    tell("calibrating the ideal block")
    plain = baseline(setup.simulator, setup.start, setup.swings, gravity=g is None and setup.reads_gravity)
    path = traced(setup, plain, tell)
    rivals, rounds = path.rivals, path.rounds
    named = Revision(path.trials[-1], path.fits[-1], tuple(rounds[: len(path.trials) - 1]))
    if path.term is not None:
        # Names stand for what has none: they are neither revised nor compared, and nothing is learned on top of them.
        named, rivals = Revision(plain, path.fits[0], ()), ()
    elif not rivals:
        named = revised(setup, plain, path.trials[-1], path.fits[-1], rounds, tell)
    else:
        # What whole records brought in last may be all that there is: nothing has asked for what came before it since.
        named, rivals = _all_needed(setup, plain, named, rivals, rounds, tell)
        rivals = as_the_base_moves_them(setup, rivals)
    tell("comparing rivals")
    if not rivals and named.trial.parts:
        named, rivals = _compared(setup, plain, named, rounds, tell)
    stands, whole = (rivals[0].trial, rivals[0].whole) if rivals else (named.trial, named.whole)
    stands = _led(setup, stands, whole)
    before = settle(setup, plain, path.fits[0])
    chosen, verdict, after, unlearned = _kept(setup, plain, path, before, stands, whole, tell)
    if chosen is not stands:
        rivals = ()
    no_swing_shows = path.term is None and not stands.parts and over_noise(setup, stands) <= structure(setup)
    decided = set(path.decided)
    if no_swing_shows:
        decided |= set(chosen.names)
    elif path.rivals:  # of twins another one may stand than that on which whole records decided at first
        decided |= set(chosen.names) - set(path.last.names)
    verdict, said = _of_whole_records(setup, chosen, verdict, whole, decided)
    models = {"declared": declared, "before": before.whole.model, "after": after.whole.model}
    windows = {"declared": setup.whole, "before": before.whole.windows, "after": after.whole.windows}
    all_errors = {name: errors(setup, model, windows[name]) for name, model in models.items()}
    # Rivals are held against each other as whole records have them; what is kept is also what swings make of it.
    rivals = tuple(
        replace(r, holdout=all_errors["after"].holdout) if r.trial.names == chosen.names else r for r in rivals
    )
    scored = [scored_window(setup.records, w) for w in leaning(setup, after.whole.model, setup.whole_held)]
    lean_sds = _lean_sds(setup, after.whole.model)
    own_floors = floors(setup.simulator, setup.noisy, len(campaign.tests), after.whole.model, scored, lean_sds)
    verdict, refuted = _of_held_out(setup, verdict, chosen, all_errors, median(own_floors))
    sure = intervals(chosen, after)
    verdict, unsure = _of_intervals(verdict, chosen, sure)
    return Finding(
        setup, verdict, declared, models["before"], models["after"], before.whole, after.whole, chosen, rivals,
        twins(rivals, named.trial), tuple(rounds), named.rounds or tuple(rounds[:1]), all_errors, median(own_floors),
        sure,
        (
            *setup.notes, *_of_the_search(path, stands), *named.said, *said, *refuted, *unsure, *_of_forms(rivals),
            *_of_what_is_assumed(chosen), *unlearned, *_unseen(setup),
        ),
        after,
    )  # fmt: skip


def _led(setup: Setup, stands: Trial, whole: Fit) -> Trial:
    """What stands, out of a minimum of the swings that whole records, asked from many starts, have left."""
    # On floors that give it was led so when it was accepted.
    return stands if stands.costly else from_whole_records(setup, stands, whole)


def _all_needed(
    setup: Setup, plain: Trial, named: Revision, rivals: tuple[Rival, ...], rounds: Sequence[Round], tell: Tell
) -> tuple[Revision, tuple[Rival, ...]]:
    """What whole records decided on, with its rivals; without an effect that is not needed, and then without them.

    rounds: of the search.
    """
    shorter = without_needless(setup, plain, named, rounds, tell)
    return (named, rivals) if shorter is None else (shorter, ())


def _compared(
    setup: Setup, plain: Trial, named: Revision, rounds: Sequence[Round], tell: Tell
) -> tuple[Revision, tuple[Rival, ...]]:
    """What stands beside its rivals, the best first, each of its effects needed.

    rounds: of the search.
    """
    while True:
        near = near_all(setup, named.rounds, named.trial, named.whole)
        rivals = _borne_out(setup, near, named.trial, named.whole)
        best = rivals[0] if rivals else None
        if best is None or best.trial.names == named.trial.names:
            return named, rivals
        shorter = without_needless(setup, plain, replace(named, trial=best.trial, whole=best.whole), rounds, tell)
        if shorter is None or len(shorter.trial.parts) >= len(named.trial.parts):
            return named, rivals
        named = shorter


def _explained(
    setup: Setup, plain: Trial, bare: Fit, named: Trial, whole: Fit, tell: Tell
) -> tuple[Trial, Verdict]:  # fmt: skip
    """The trial to keep: the named effects if they leave nothing, else with what was learned of the rest.

    bare: the fit on whole records of the calibrated block.
    whole: that of the named effects.
    """
    structured = over_noise(setup, named) > structure(setup)
    if not structured:
        other = _otherwise(setup, plain, bare, named, whole, tell)
        if other is not None:
            return other, "unexplained"
    if not structured and len(named.parts) < 2:
        # Of what no swing shows whole records may say what it is.
        seen = named.parts or not (setup.by_rotation and missed(setup, whole))
        learned = None if seen else unseen(setup, plain, whole, tell)
        if learned is not None:
            return learned, "unexplained"
        return named, "effect" if named.parts else "none"
    if roughly_begun(setup, named, whole) or stands_alone(setup, named, whole):
        return named, "effect"
    # What is learned of noise is not worth its time: names that leave no more than that stand.
    # Where a block slips, swings do not say by chance; whole records do.
    slipped = slips(named) and setup.by_rotation and met(setup, whole, MISSED)
    if not structured and (slipped or by_chance(setup, named)):
        return named, "effect"
    tell("learning what no effect explains")
    # Effects may stand for something unnamed, several of them above all: learning starts from the calibrated block too.
    # Where they leave nothing, what goes on from swing to swing is not tried in their place: it takes long.
    routes = [learn(setup.simulator, plain, tell, named, going_on=structured)]
    # Beside a floor that gives there is no restitution that a term could bear on.
    if named is not plain and not named.costly:
        routes.append(learn(setup.simulator, named, tell))
    best = min(routes, key=lambda t: bic(t.swing))
    something = any(part.effect in LEARNED for part in best.parts)
    # Some coefficients are effects with a name: where both leave nothing, the name is the better answer.
    # Where the block alone leaves no more either, what was learned only undoes what whole records brought in.
    if not something or bic(best.swing) > min(bic(named.swing), bic(plain.swing)) - PAYS:
        if over_noise(setup, named) > unexplained(setup):
            return named, "unexplained"
        return named, "effect" if named.parts else "none"
    # What has a name keeps it, beside what has none.
    by_choice = routes[::-1] if renames(routes[0]) else routes
    return next(t for t in by_choice if bic(t.swing) < bic(best.swing) + PAYS), "unexplained"


def _otherwise(
    setup: Setup, plain: Trial, bare: Fit, named: Trial, whole: Fit, tell: Tell
) -> Trial | None:  # fmt: skip
    """One law without a name, where it explains far more than what was found.

    In free decays speeds and pauses fall together, so that a loss that depends on the one looks much like one that
    depends on the other, on the number of the impact, on the side, or on how near to upright the block is; and two
    effects may stand in for a third of any kind.  What swings do not tell apart whole records may, since what is wrong
    adds up in them.
    """
    several = len(named.parts) > 1
    if named.costly or slips(named) or not setup.by_rotation or not named.parts:
        return None
    closely = rms_but_for_one(whole) < CLOSELY
    if not closely:
        # Whole records are rugged: what stands is fitted to them from more starts before it is doubted.
        whole = min(whole, whole_fit_from_many(setup, named, whole), key=lambda f: f.chi2)
        closely = rms_but_for_one(whole) < CLOSELY
    if closely and several:
        return _one_in_place_of(setup, plain, named, whole, tell)
    if not several and not set(named.effects) & LOSSES:
        # A string that is slack up to some lean looks much like any other torque that grows with it.
        one = None
        if set(named.effects) & OF_THE_BASE:
            under = between(setup.simulator, plain.swing.windows)
            one = _one_in_place_of(setup, plain, named, whole, tell, under, TWIN)
        if one is not None or closely or met(setup, whole, CLOSELY):
            return one
        one = _one_in_place_of(setup, plain, named, whole, tell)
        if one is not None or bic(named.swing) <= bic(plain.swing) - PAYS:
            return one
        # Whole records alone speak for it, and are not met: they are asked what else does.
        one = unseen(setup, plain, bare, tell)
        return one if one is not None and explains_more(setup, whole_fit(setup, one, whole), whole) else None
    tell("asking whether one law without a name explains it")
    declared, windows = plain.swing.model.declared, plain.swing.windows
    laws = (*memories(declared, windows), *(c for c in profiles(declared, windows) if c.effect == LOSS))
    by_law = search(setup.simulator, plain, laws, tell)
    best = by_law.best
    if not several and best is not None:
        if bic(best.swing) < bic(named.swing) - PAYS:
            return best
        if not closely and bic(best.swing) < bic(named.swing) + PAYS:
            best, there = remembering_all(setup, best, whole_fit(setup, best, whole))
            if _preferred(setup, best, there, named, whole):
                return best
    if closely:
        return None
    by_term = search(setup.simulator, plain, unnamed(declared), tell)
    # Two effects have the freedom to explain swings of something else, a single one that explains them has not.
    open_to_it = [
        t for t in (*by_law.trials, *by_term.trials) if several or bic(t.swing) < bic(named.swing) + PAYS
    ]  # fmt: skip
    likely = [
        remembering_all(setup, t, whole_fit(setup, t))[0] if MEMORY in t.effects else t
        for t in hints(plain, replace(by_law, trials=open_to_it))
    ]
    found = hinted(setup, plain, bare, replace(by_law, trials=likely))
    return next((r.trial for r in found[:1] if _preferred(setup, r.trial, r.whole, named, whole)), None)


def _preferred(setup: Setup, one: Trial, there: Fit, named: Trial, whole: Fit) -> bool:
    """Whether whole records prefer a law without a name; one of more parameters than the names have has to mend them.

    Where a record hangs on the noise of the base, such a law leaves a little less of it than the truth does.

    there, whole: its fit on whole records, and that of the names.
    """
    freer = len(one.parameters) > len(named.parameters)
    return halves(setup, there, whole) if freer else explains_more(setup, there, whole)


def _one_in_place_of(
    setup: Setup, plain: Trial, named: Trial, whole: Fit, tell: Tell, pool: Sequence[Candidate] | None = None,
    within: float = TOLD_APART,
) -> Trial | None:  # fmt: skip
    """One coefficient without a name that whole records prefer to effects with a name, and swings do not speak against.

    A late recorder of the rotation moves swings as an early base does, and releases as that does not.

    pool: of what it is; all that may act by itself if not given.
    within: by how much less of the criterion of swings the names leave where these do not speak against it.
    """
    pool = by_itself(setup.simulator, plain) if pool is None else pool
    tell("asking whether one coefficient without a name explains more")
    best = search(setup.simulator, plain, pool, tell, leading=True).best
    if best is None or bic(best.swing) > bic(named.swing) + within:
        return None
    best, there = remembering_all(setup, best, whole_fit(setup, best, whole))
    return best if explains_more(setup, there, whole) else None


def _kept(
    setup: Setup, plain: Trial, path: Path, before: Settled, stands: Trial, whole: Fit, tell: Tell
) -> tuple[Trial, Verdict, Settled, tuple[str, ...]]:
    """The trial to keep with its verdict, its parameters, and what is to be said of what was not kept.

    path: the one that the search took.
    before: the calibrated block, settled.
    whole: the fit on whole records of the effects that stand.
    """
    verdict: Verdict = "unexplained"
    if path.term is not None:
        chosen = _further(setup, plain, path.term, tell)
    else:
        chosen, verdict = _explained(setup, plain, path.fits[0], stands, whole, tell)
    by_name = settle(setup, stands, whole) if stands.parts else before
    if chosen is stands:
        return stands, verdict, by_name, ()
    chosen, its_whole = _shaped(setup, plain, chosen, tell)
    learned = settle(setup, chosen, its_whole)
    now, then = (errors(setup, s.whole.model, s.whole.windows) for s in (learned, by_name))
    what = f"what was learned ({', '.join(map(readable, chosen.names))})"
    carries = _carries(setup, by_name, learned, now.fit, then.fit)
    if not carries and now.fit <= (1.0 + LEAST_GAIN) * then.fit:
        # Where medians of a few tests hardly differ, what whole records alone make of either may say it.
        carries = setup.by_rotation and explains_more(setup, its_whole, whole)
    if not carries:
        said = f"{what} does not carry over whole records: it was left out"
    # Either error is a median of a few tests: what is better on the one by far may be a little worse on the other.
    elif now.holdout * now.fit > then.holdout * then.fit:
        said = (
            f"{what} raises the error of the tests held out from {then.holdout:.3g} to {now.holdout:.3g} "
            f"{_units(setup)}, where that of those fitted goes from {then.fit:.3g} to {now.fit:.3g}: it was left out"
        )
    else:
        return chosen, verdict, learned, ()
    # What explains more of the fitted tests than the names do is no truer for that, and nor are the names.
    doubted = bool(stands.parts) and carries
    if doubted or over_noise(setup, stands) > structure(setup):
        return stands, "unexplained", by_name, (said,)
    return stands, "effect" if stands.parts else "none", by_name, (said,)


def _further(setup: Setup, plain: Trial, term: Trial, tell: Tell) -> Trial:
    """One coefficient without a name, or what is learned in its place where it is ahead of all names and not all that
    acts."""
    if begins_roughly(term) or over_noise(setup, term) <= unexplained(setup):
        return term
    tell("learning what no effect explains")
    more = learn(setup.simulator, plain, tell)
    return more if bic(more.swing) < bic(term.swing) - PAYS else term


def _shaped(setup: Setup, plain: Trial, found: Trial, tell: Tell) -> tuple[Trial, Fit]:
    """What was learned with its fit on whole records, in the form that misses these least of those alike to swings."""
    found, whole = remembering_all(setup, found, whole_fit(setup, found))
    if not setup.by_rotation or found.costly or whole.rms < MISSED or found.parts[-1].effect in FREEDOMS:
        return found, whole
    if not says_much(plain, found):  # of what acts it has no form
        return found, whole
    tell("asking whole records which form it has")
    less = taken_out(setup, plain, found, len(found.parts) - 1)
    for other in alike(setup.simulator, less, found, tell):
        other, there = remembering_all(setup, other, whole_fit(setup, other))
        if explains_more(setup, there, whole):
            found, whole = other, there
    return found, whole


def _carries(setup: Setup, without: Settled, found: Settled, now: float, then: float) -> bool:
    """Whether a model is nearer to the whole records that were fitted than the one without what was learned.

    The error that is reported is a median, of which the ends of records that hang on the noise of the base may be most:
    where that does not speak for it, what is told for certain of all records may.

    now, then: that error with it and without.
    """
    return now < then or (setup.by_rotation and explains_more(setup, found.whole, without.whole))


def _of_whole_records(
    setup: Setup, chosen: Trial, verdict: Verdict, whole: Fit, decided: Collection[str]
) -> tuple[Verdict, list[str]]:
    """The verdict once whole records are looked at, and what is to be said of them.

    decided: the forms on which they decided.
    """
    by_them = [name for name in chosen.names if name in decided]
    notes = [
        f"single swings do not settle on {name}: whole records decided, as far as the noise of the base leaves "
        "them predictable"
        for name in by_them
    ]
    if verdict == "unexplained" or not (setup.by_rotation and missed(setup, whole)):
        return verdict, notes
    if verdict == "none":
        notes.append(
            f"single swings are explained down to their noise, whole records are missed by {whole.rms:.1f} times "
            "theirs: something acts that no swing shows and none of the effects tried explains"
        )
        return "unexplained", notes
    far = int(np.count_nonzero(whole.by_window > MISSED_BY_FAR))
    notes.append(
        f"{far} of {len(whole.windows)} whole records are missed by more than {MISSED_BY_FAR:g} times their noise with "
        "what was found: it does not carry to their end, and something else may act"
    )
    # What whole records alone speak for has to explain them.
    return "unexplained" if len(by_them) == len(chosen.names) else verdict, notes


def _of_held_out(
    setup: Setup, verdict: Verdict, chosen: Trial, found: Mapping[str, Errors], floor: float
) -> tuple[Verdict, tuple[str, ...]]:
    """The verdict once the held-out tests are predicted, and what is to be said of them.

    They have no say in what the model is; but what does not lower their error, where more than the noise is left to
    lower, is not what acts, however well it fits the others.

    found: errors before and after.
    floor: what the model after would score on them if it were true.
    """
    before, after = found["before"].holdout, found["after"].holdout
    if verdict != "effect" or not (after >= before and after > REFUTED * floor):
        return verdict, ()
    return "unexplained", (
        f"with {' and '.join(map(readable, chosen.names))} the error of the tests that were fitted goes from "
        f"{found['before'].fit:.3g} to {found['after'].fit:.3g} {_units(setup)}, and that of the tests held out is not "
        f"lowered, {before:.3g} before and {after:.3g} after: something else acts",
    )


def _of_intervals(
    verdict: Verdict, chosen: Trial, sure: Mapping[str, tuple[float, float, float]]
) -> tuple[Verdict, tuple[str, ...]]:
    """The verdict once it is known how sure the parameters are: what may be nothing at all is no effect that was found.

    sure: value and ends of the interval of each parameter.
    """

    def may_be_nothing(part: Candidate) -> bool:
        absent = part.absent(chosen.swing.model.declared)
        return all(p.name in sure and sure[p.name][1] <= absent[p.name] <= sure[p.name][2] for p in part.parameters)

    if verdict != "effect" or not all(may_be_nothing(part) for part in chosen.parts):
        return verdict, ()
    return "unexplained", (
        f"the intervals of {' and '.join(map(readable, chosen.names))} hold its absence: it may not be there, and "
        "the ideal block does not explain the records",
    )


def _borne_out(setup: Setup, rivals: Sequence[Rival], chosen: Trial, whole: Fit) -> tuple[Rival, ...]:
    """The rivals, the best first: none before the chosen trial that whole records refuse.

    Where they were what brought a soft floor in, those that they refused then are left out.
    """

    def refused(r: Rival) -> bool:
        return r.trial.names != chosen.names and explains_more(setup, whole, r.whole)

    if chosen.costly:
        return tuple(r for r in rivals if r.trial.costly or not refused(r))
    rivals = twins_from_many(setup, rivals, whole)
    return standing(rivals, refused, lambda r, first: explains_more(setup, r.whole, first.whole))


def _of_the_search(path: Path, stands: Trial) -> tuple[str, ...]:
    """What the search says of the paths that it left, if what it took stands."""
    return path.said if set(stands.names) == set(path.last.names) else ()


def _of_forms(rivals: Sequence[Rival]) -> tuple[str, ...]:
    """What is to be said of other forms of the effects that were found."""
    return tuple(
        f"{readable(mine)} or {readable(its).lower()}: these data do not tell which of these forms the effect has"
        for mine, its in other_forms(rivals)
    )


def _of_what_is_assumed(chosen: Trial) -> tuple[str, ...]:
    """What is to be said of numbers that were taken for known."""
    return tuple(
        f"{name} was not fitted but taken as {chosen.swing.model.get(name):g}; intervals reach as far as "
        f"{other:g} would carry the estimates"
        for part in chosen.parts
        for name, other in part.assumed.items()
    )


def _unseen(setup: Setup) -> tuple[str, ...]:
    """What the channels of a campaign cannot show."""
    if setup.by_rotation:
        return ()
    return (
        "accelerometers alone were measured: effects that act at lift-off only (adhesion) were not tried, since no "
        "swing shows them, and of whole records little else is compared than when the side changes",
    )


def _lean_sds(setup: Setup, model: LoopModel) -> list[float]:
    """Standard deviations of the leans of held-out tests [rad], as the model takes the sensor that read them."""
    # Where it was read, `theta_sd` is twice the standard deviation of the estimate.
    return [
        0.5 * w.theta_sd / abs(float(model.in_test(w.test).reading_slope(w.theta))) if w.lean_read else w.theta_sd
        for w in setup.whole_held
    ]
