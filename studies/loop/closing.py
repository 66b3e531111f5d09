"""The loop, from a campaign to a finding: calibrate, trace, refit, compare, and predict what nothing saw.

Status   campaigns with records of the response; `studies.loop.outcomes.closing` has those that hold outcomes alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from studies.campaigns import Campaign
from studies.loop.candidates import Candidate
from studies.loop.fitting import Fit
from studies.loop.keeping import Keeper
from studies.loop.learned_curves import Curve, curves
from studies.loop.learning import LEARNED, learn, memories
from studies.loop.model import LoopModel
from studies.loop.names import readable
from studies.loop.preparing import Setup, prepare
from studies.loop.revising import Revision, revised
from studies.loop.rivals import Rival, near_all, standing, twins
from studies.loop.scoring import Errors, errors, leaning, median
from studies.loop.settling import Settled, gain, intervals, reweighed, settle, telling, whole_fit
from studies.loop.spread import floor, variances
from studies.loop.tracing import (
    LEAST_GAIN,
    PAYS,
    Round,
    Trial,
    all_candidates,
    baseline,
    bic,
    pays,
    search,
    search_costly,
)
from studies.loop.whole_records import HINT, asked, explains_more, merged, ranked
from studies.loop.windows import PEAK_OVER_NOISE, SIDE, scored_window

Array = NDArray[np.float64]
Tell = Callable[[str], None]
Verdict = Literal["effect", "none", "unexplained"]
Accepted = tuple[Trial, Fit]
"""A trial and its fit on whole records."""

STANDARD_GRAVITY = 9.81
"""Gravity [m/s^2] where the laboratory does not say its own."""

MOST_EFFECTS = 3

MOST_EFFECTS_COSTLY = 2
"""The same where runs take long."""

NOTHING_LEFT = 1.02
"""Rms over the noise in the swings below which no third effect is looked for."""

MISSED_BY_FAR = 3.0
"""Rms of whole records over their noise that cannot be called explained."""

MISSED_RECORDS = 2
"""So many of them have to be missed so: one may be lost to an impact that hung on the noise of the base."""

STRUCTURE = 1.03
"""Rms in the swings over what the noise leaves of it from which structure is left: four of its standard deviations in
ten thousand samples."""

STRUCTURE_OF_ESTIMATED = 1.08
"""The same where the noise is not declared but estimated from the records."""

UNEXPLAINED = 1.05
"""And from which it is too much to speak of an effect alone even where nothing can be learned."""

UNEXPLAINED_OF_ESTIMATED = 1.3
"""The same where the noise is estimated."""


OF_THE_ROTATION_SENSOR = ("rotation_gain", "rotation_offset")


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

    @property
    def learned(self) -> tuple[Curve, ...]:
        """What a learned term looks like."""
        return curves(self.setup, self.settled)

    @property
    def units(self) -> str:
        """Unit of the errors."""
        return "rad" if self.setup.by_rotation else "m/s^2"

    @property
    def metric(self) -> str:
        """What the errors are."""
        if self.setup.by_rotation:
            return "rms rotation, median over tests"
        return "rms of the accelerometers on the block, median over tests (no rotation was measured)"


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
    declared = _declared(campaign, STANDARD_GRAVITY if g is None else g)
    setup = prepare(campaign, declared, keeper)
    tell("calibrating the ideal block")
    plain = baseline(setup.simulator, setup.start, setup.swings, gravity=g is None and setup.reads_gravity)
    path, rounds, fits, rivals, decided = _traced(setup, plain, tell)
    named = Revision(path[-1], fits[-1], tuple(rounds[: len(path) - 1]))
    if not rivals:
        named = revised(setup, plain, path[-1], fits[-1], rounds, tell)
    tell("comparing rivals")
    if not rivals and named.trial.parts:
        near = near_all(setup, named.rounds, named.trial, named.whole)
        rivals = _borne_out(setup, near, named.trial, named.whole)
    stands, whole = (rivals[0].trial, rivals[0].whole) if rivals else (named.trial, named.whole)
    before = settle(setup, plain, fits[0])
    chosen, verdict, after, unlearned = _kept(setup, plain, before, stands, whole, tell)
    if chosen is not stands:
        rivals = ()
    verdict, said = _of_whole_records(setup, chosen, verdict, whole, decided)
    models = {"declared": declared, "before": before.whole.model, "after": after.whole.model}
    windows = {"declared": setup.whole, "before": before.whole.windows, "after": after.whole.windows}
    all_errors = {name: errors(setup, model, windows[name]) for name, model in models.items()}
    scored = [scored_window(setup.records, w) for w in leaning(setup, after.whole.model, setup.whole_held)]
    spread = variances(setup.noisy, len(campaign.tests), after.whole.model, scored, _lean_sds(setup, after.whole.model))
    floors = [floor(w, v) for w, v in zip(scored, spread, strict=True)]
    return Finding(
        setup, verdict, declared, models["before"], models["after"], before.whole, after.whole, chosen, rivals,
        twins(rivals, named.trial), tuple(rounds), named.rounds or tuple(rounds[:1]), all_errors, median(floors),
        intervals(chosen, after), (*setup.notes, *named.said, *said, *unlearned, *_unseen(setup)), after,
    )  # fmt: skip


def _traced(
    setup: Setup, plain: Trial, tell: Tell
) -> tuple[list[Trial], list[Round], list[Fit], tuple[Rival, ...], frozenset[str]]:
    """The trials that were accepted one on top of the other, all rounds, and the fits on whole records.

    Besides, the rivals of the last one where whole records decided among them, and the forms on which they decided.
    """
    pool = all_candidates(plain.swing.model)
    if not setup.by_rotation:
        pool = tuple(c for c in pool if c.effect not in OF_THE_ROTATION_SENSOR)
    path, rounds, fits = [plain], [], [whole_fit(setup, plain)]
    rivals: tuple[Rival, ...] = ()
    decided: set[str] = set()
    for depth in range(MOST_EFFECTS):
        if depth > 1 and path[-1].swing.rms < NOTHING_LEFT:
            break
        if path[-1].costly and (depth >= MOST_EFFECTS_COSTLY or _leaves_nothing(setup, path[-1], fits[-1])):
            break
        tell(f"tracing, round {depth + 1}")
        tried, accepted, confirmed = _round(setup, path[-1], fits[-1], pool, tell)
        rounds.append(tried)
        if accepted is None:
            break
        path.append(accepted[0])
        fits.append(accepted[1])
        rivals = confirmed
        if confirmed:
            decided.add(accepted[0].names[-1])
    return path, rounds, fits, rivals, frozenset(decided)


def _borne_out(setup: Setup, rivals: Sequence[Rival], chosen: Trial, whole: Fit) -> tuple[Rival, ...]:
    """The rivals, the best first: none before the chosen trial that whole records refuse.

    Where they were what brought a soft floor in, those that they refused then are left out.
    """

    def refused(r: Rival) -> bool:
        return setup.by_rotation and r.trial.names != chosen.names and explains_more(setup, whole, r.whole)

    if chosen.costly:
        return tuple(r for r in rivals if r.trial.costly or not refused(r))
    return standing(rivals, refused)


def _round(
    setup: Setup, onto: Trial, whole: Fit, pool: Sequence[Candidate], tell: Tell
) -> tuple[Round, Accepted | None, tuple[Rival, ...]]:
    """What was tried on top of a trial, what of it is accepted, and the rivals if whole records decided among them.

    whole: the fit on whole records of the trial.
    """

    def explained(trial: Trial) -> bool:
        # Where a block slips what is left is a median over the windows, and says nothing of a minority of them.
        return not _slips(trial) and _over_noise(setup, trial) < _structure(setup)

    tried = search(setup.simulator, onto, pool, tell, explained=explained)
    accepted, confirmed = _accepted(setup, onto, whole, tried, pool, tell)
    if not tried.put_off:
        return tried, accepted, confirmed
    # Swings that leave nothing say nothing of a soft floor; whole records that are missed still may, and so may swings
    # of which what was accepted leaves more than what was not.
    stands, its_whole = (onto, whole) if accepted is None else accepted
    if not (setup.by_rotation and missed(its_whole)) and _over_noise(setup, stands) < _structure(setup):
        return tried, accepted, confirmed
    floors = Round(onto, search_costly(setup.simulator, tried, tell))
    found, decided = _accepted(setup, onto, whole, floors, (), tell, hint=-PAYS)
    known = {t.names for t in tried.trials}
    tried.trials += [t for t in floors.trials if t.names not in known]
    if found is None:
        return tried, accepted, confirmed
    if confirmed and decided:
        both = ranked(setup, merged(confirmed, decided))
        return tried, (both[0].trial, both[0].whole), both
    if accepted is None or explains_more(setup, found[1], accepted[1]):
        return tried, found, decided
    return tried, accepted, confirmed


def _accepted(
    setup: Setup, onto: Trial, whole: Fit, tried: Round, pool: Sequence[Candidate], tell: Tell, hint: float = HINT
) -> tuple[Accepted | None, tuple[Rival, ...]]:
    """The trial of a round that pays, and the rivals if whole records decided among them."""
    accepted: Accepted | None = None
    best = tried.best
    likely = best is not None and pays(onto.swing, best.swing)
    if best is not None and likely:
        now = whole_fit(setup, best)
        # Where another effect is missing still, all records may be lost with this one and without it.
        if gain(setup, whole, now) > LEAST_GAIN or not telling(now, reweighed(setup, whole, now)).any():
            accepted = best, now
    # Whole records are rugged: where swings say nothing, or one fit of whole records does not bear them out, or leaves
    # far too much, these have more to say.
    unsettled = accepted is None or accepted[1].rms > MISSED_BY_FAR
    if not setup.by_rotation or (likely and (onto.parts or not unsettled)):
        return accepted, ()
    tell("asking whole records")
    confirmed = asked(setup, onto, whole, tried, pool, hint)
    confirmed = ranked(setup, [r for r in confirmed if gain(setup, whole, r.whole) > LEAST_GAIN])
    if not confirmed or (accepted is not None and not explains_more(setup, confirmed[0].whole, accepted[1])):
        return accepted, ()
    first = confirmed[0]
    if all(t.names != first.trial.names for t in tried.trials):
        tried.trials.append(first.trial)
    return (first.trial, first.whole), confirmed


def _explained(setup: Setup, plain: Trial, named: Trial, tell: Tell) -> tuple[Trial, Verdict]:
    """The trial to keep: the named effects if they leave nothing, else with what was learned of the rest."""
    structured = _over_noise(setup, named) > _structure(setup)
    if not structured and len(named.parts) < 2:
        remembering = _remembering(setup, plain, named, tell)
        if remembering is not None:
            return remembering, "unexplained"
        return named, "effect" if named.parts else "none"
    tell("learning what no effect explains")
    # Effects may stand for something unnamed, several of them above all: learning starts from the calibrated block too.
    # Where they leave nothing, what goes on from swing to swing is not tried in their place: it takes long.
    routes = [learn(setup.simulator, plain, tell, named, going_on=structured)]
    # Beside a floor that gives there is no restitution that a term could bear on.
    if named is not plain and not named.costly:
        routes.append(learn(setup.simulator, named, tell))
    best = min(routes, key=lambda t: bic(t.swing))
    learned = any(part.effect in LEARNED for part in best.parts)
    # Some coefficients are effects with a name: where both leave nothing, the name is the better answer.
    if not learned or bic(best.swing) > bic(named.swing) - PAYS:
        if _over_noise(setup, named) > _unexplained(setup):
            return named, "unexplained"
        return named, "effect" if named.parts else "none"
    if bic(routes[0].swing) < bic(best.swing) + PAYS:
        best = routes[0]
    return best, "unexplained"


def _remembering(setup: Setup, plain: Trial, named: Trial, tell: Tell) -> Trial | None:
    """A restitution that remembers impacts, where it explains swings far better than the one effect that was found.

    In free decays speeds and pauses fall together, so that a loss that depends on the one looks much like one that
    depends on the other, or on the number of the impact.
    """
    if not named.parts or named.costly or _slips(named) or not setup.by_rotation:
        return None
    tell("asking whether impacts remember")
    best = search(setup.simulator, plain, memories(plain.swing.model.declared, plain.swing.windows), tell).best
    return best if best is not None and bic(best.swing) < bic(named.swing) - PAYS else None


def _kept(
    setup: Setup, plain: Trial, before: Settled, stands: Trial, whole: Fit, tell: Tell
) -> tuple[Trial, Verdict, Settled, tuple[str, ...]]:
    """The trial to keep with its verdict, its parameters, and what is to be said of what was not kept.

    before: the calibrated block, settled.
    whole: the fit on whole records of the effects that stand.
    """
    chosen, verdict = _explained(setup, plain, stands, tell)
    by_name = settle(setup, stands, whole) if stands.parts else before
    if chosen is stands:
        return stands, verdict, by_name, ()
    learned = settle(setup, chosen, whole_fit(setup, chosen))
    if _carries(setup, by_name, learned):
        return chosen, verdict, learned, ()
    said = (
        f"what was learned of the swings ({', '.join(map(readable, chosen.names))}) does not carry over whole "
        "records: it was left out"
    )
    if _over_noise(setup, stands) > _structure(setup):
        return stands, "unexplained", by_name, (said,)
    return stands, "effect" if stands.parts else "none", by_name, (said,)


def _carries(setup: Setup, without: Settled, found: Settled) -> bool:
    """Whether a model is nearer to the whole records that were fitted than the one without what was learned."""
    now, then = (errors(setup, s.whole.model, s.whole.windows).fit for s in (found, without))
    return now < then


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
    if verdict == "unexplained" or not (setup.by_rotation and missed(whole)):
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
    # What whole records alone speak for has to explain most of them.
    if len(by_them) == len(chosen.names) and 2 * far > len(whole.windows):
        return "unexplained", notes
    return verdict, notes


def _leaves_nothing(setup: Setup, trial: Trial, whole: Fit) -> bool:
    return _over_noise(setup, trial) < _structure(setup) and not missed(whole)


def missed(whole: Fit) -> bool:
    """Whether whole records cannot be called explained."""
    missed = int(np.count_nonzero(whole.by_window > MISSED_BY_FAR))
    return whole.rms > MISSED_BY_FAR and missed >= min(MISSED_RECORDS, len(whole.by_window))


def _declared(campaign: Campaign, g: float) -> LoopModel:
    e = campaign.conditions.restitution
    model = LoopModel(campaign.block, 0.9 if e is None else e, {}, g)
    if e is not None:
        return model
    housner = 1.0 - 1.5 * math.sin(campaign.block.alpha) ** 2
    return replace(model, restitution=min(max(housner, 0.05), 1.0))


def _over_noise(setup: Setup, trial: Trial) -> float:
    """Rms of the swings over what is left of pure noise once each window has fitted its two states.

    Swings that the trial itself takes for less than one are left out, as they would have been from the beginning: with
    the zero of a sensor off, a hop at rest looks like a swing, and hangs on the noise of the base.  Where a block
    slips, some windows begin with a slip that could not be carried over to them as it was: of those trials it is the
    median over the windows, so that structure has to be in half of them to be seen.
    """
    swing = trial.swing
    if _slips(trial):
        return math.sqrt(float(np.median([r @ r / max(r.size - 2, 1) for r in swing.residuals])))
    left = [swing.residuals[i] for i in swings_that_count(setup, trial)]
    samples = sum(r.size for r in left)
    free = 2 * len(left) + len(swing.parameters)
    return math.sqrt(sum(float(r @ r) for r in left) / max(samples - free, 0.1 * samples, 1.0))


def swings_that_count(setup: Setup, trial: Trial) -> list[int]:
    """Indices of the windows that the trial itself does not take for less than a swing."""
    least = {record.test: PEAK_OVER_NOISE * record.noise for record in setup.records}
    return [i for i, w in enumerate(trial.swing.windows) if abs(w.theta) > least[w.test]]


def _slips(trial: Trial) -> bool:
    return any(part.slips for part in trial.parts)


def _structure(setup: Setup) -> float:
    return STRUCTURE if _declared_noise(setup) else STRUCTURE_OF_ESTIMATED


def _unexplained(setup: Setup) -> float:
    return UNEXPLAINED if _declared_noise(setup) else UNEXPLAINED_OF_ESTIMATED


def _declared_noise(setup: Setup) -> bool:
    return all(c.noise for record in setup.records for c in record.channels if c is not SIDE)


def _unseen(setup: Setup) -> tuple[str, ...]:
    """What the channels of a campaign cannot show."""
    if setup.by_rotation:
        return ()
    return (
        "accelerometers alone were measured: effects that act at lift-off only (adhesion) were not tried, since whole "
        "records hang too finely on when the side changes",
    )


def _lean_sds(setup: Setup, model: LoopModel) -> list[float]:
    """Standard deviations of the leans of held-out tests [rad], as the model takes the sensor that read them."""
    # `theta_sd` is twice the standard deviation of the estimate.
    slopes = (float(model.reading_slope(w.theta)) if w.lean_read else 1.0 for w in setup.whole_held)
    return [0.5 * w.theta_sd / abs(slope) for w, slope in zip(setup.whole_held, slopes, strict=True)]
