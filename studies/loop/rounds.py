"""The search, one effect after the other: what was tried, what swings and whole records accept of it.

The effect that explains most by itself may be none of those that act together.  So where something is left over, the
search goes back, and on from those that came near the first one.  Floors that give come last: their runs take so long
that what two effects explain is asked first.

Source   none, own convention
Status   a pair of effects that leaves nothing is taken before a floor that would, too; a planted pair of which one
         effect came second to a stand-in for both is found (studies/loop_trials.py).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from studies.loop.candidates import Candidate
from studies.loop.fitting import Fit
from studies.loop.preparing import Setup
from studies.loop.remaining import MISSED_BY_FAR, by_chance, explains, over_noise, slips, structure
from studies.loop.rivals import Rival
from studies.loop.settling import gain, reweighed, telling, whole_fit
from studies.loop.tracing import LEAST_GAIN, PAYS, Round, Trial, all_candidates, bic, pays, search, search_costly
from studies.loop.whole_records import HINT, MISSED, asked, explains_more, merged, ranked

Tell = Callable[[str], None]
Accepted = tuple[Trial, Fit]
"""A trial and its fit on whole records."""

MOST_EFFECTS = 3

MOST_EFFECTS_COSTLY = 2
"""The same where runs take long."""

NOTHING_LEFT = 1.02
"""Rms over the noise in the swings below which no third effect is looked for."""

NEARLY_FIRST = 0.5
"""Effects that lower the criterion by this share of what the first one does are gone on from in its place."""

MOST_IN_ITS_PLACE = 2
"""So many of them."""

OF_THE_ROTATION_SENSOR = ("rotation_gain", "rotation_offset")


@dataclass(frozen=True)
class Path:
    """What was accepted, one on top of the other."""

    trials: list[Trial]
    rounds: list[Round]  # all of the search
    fits: list[Fit]  # of the trials on whole records
    rivals: tuple[Rival, ...] = ()  # of the last trial where whole records decided among them
    decided: frozenset[str] = frozenset()  # the forms on which they decided


def traced(setup: Setup, plain: Trial, tell: Tell) -> Path:
    """The search, first without floors that give: their runs take so long that what two effects explain is asked first.

    Where these leave something over the noise, or whole records are missed, the search begins again with floors.
    """
    pool = all_candidates(plain.swing.model)
    if not setup.by_rotation:
        pool = tuple(c for c in pool if c.effect not in OF_THE_ROTATION_SENSOR)
    begin = Path([plain], [], [whole_fit(setup, plain)])
    greedy = _followed(setup, begin, pool, tell, later=True)
    quick = _gone_back(setup, greedy, pool, tell)
    last = quick.trials[-1]
    # Where a block slips what is left is a median over the windows, and says nothing of a minority of them; whole
    # records do.
    known = not slips(last) or quick.fits[-1].rms < MISSED
    little = by_chance(setup, last) or (len(last.parts) < 2 and known)
    if not any(r.put_off for r in quick.rounds) or (little and explains(setup, last, quick.fits[-1])):
        return quick
    tell("something is left: again with floors that give")
    # What whole records alone brought in, they are asked for again.
    begun = [replace(r, trials=[t for t in r.trials if r.added(t).in_swings]) for r in quick.rounds]
    floors = _followed(setup, begin, pool, tell, begun=begun)
    if quick is greedy or _serves_better(setup, floors, quick):
        return floors
    return replace(quick, rounds=_together(_with_more(quick.rounds, floors.rounds), floors.rounds))


def _gone_back(setup: Setup, found: Path, pool: Sequence[Candidate], tell: Tell) -> Path:
    """The path, or where it leaves something one from an effect that came near the first, if that serves better.

    Rounds of paths that were left come after those of the one that is taken.
    """
    if len(found.trials) < 2 or explains(setup, found.trials[-1], found.fits[-1]):
        return found
    best = found
    for trial in _near_the_first(found):
        tell(f"something is left: again from {trial.names[-1]}")
        begin = Path(
            [found.trials[0], trial], [found.rounds[0]], [found.fits[0], whole_fit(setup, trial)]
        )  # fmt: skip
        other = _followed(setup, begin, pool, tell, later=True)
        if len(other.trials) > 2 and _serves_better(setup, other, best):
            best, other = other, best
        best = replace(best, rounds=_together(best.rounds, other.rounds))
        if explains(setup, best.trials[-1], best.fits[-1]):
            break
    return best


def _near_the_first(found: Path) -> list[Trial]:
    """Of the first round the trials of other effects that came near the one that was taken, one of each effect."""
    plain, taken = found.trials[0], found.trials[1]
    enough = NEARLY_FIRST * (bic(plain.swing) - bic(taken.swing))
    best: dict[tuple[str, ...], Trial] = {taken.effects: taken}
    for trial in sorted(found.rounds[0].trials, key=lambda t: bic(t.swing)):
        if pays(plain.swing, trial.swing) and bic(plain.swing) - bic(trial.swing) > enough and not trial.costly:
            best.setdefault(trial.effects, trial)
    return list(best.values())[1 : 1 + MOST_IN_ITS_PLACE]


def _serves_better(setup: Setup, one: Path, other: Path) -> bool:
    """Whether swings speak for one path against another by far, and whole records not against it."""
    if bic(one.trials[-1].swing) > bic(other.trials[-1].swing) - PAYS:
        return False
    return not (setup.by_rotation and explains_more(setup, other.fits[-1], one.fits[-1]))


def _together(own: Sequence[Round], others: Sequence[Round]) -> list[Round]:
    """Rounds, and those of others on top of what they have not."""
    return [*own, *(r for r in others if not any(_same(r.onto, known.onto) for known in own))]


def _with_more(rounds: Sequence[Round], later: Sequence[Round]) -> list[Round]:
    """The rounds; of two on top of the same trial the later one, in which more was tried."""
    return [next((r for r in later if _same(r.onto, known.onto)), known) for known in rounds]


def _followed(
    setup: Setup, begin: Path, pool: Sequence[Candidate], tell: Tell, *, later: bool = False,
    begun: Sequence[Round] = (),
) -> Path:  # fmt: skip
    """The search, one effect after the other.

    begin: what is accepted already.
    later: whether candidates whose runs take long are left out; then two effects have to be enough.
    begun: rounds of a search that left them out.
    """
    path, rounds, fits = list(begin.trials), list(begin.rounds), list(begin.fits)
    rivals: tuple[Rival, ...] = ()
    decided: set[str] = set()
    for depth in range(len(rounds), MOST_EFFECTS):
        if depth > 1 and ((later and not by_chance(setup, path[-1])) or path[-1].swing.rms < NOTHING_LEFT):
            break
        if path[-1].costly and (depth >= MOST_EFFECTS_COSTLY or explains(setup, path[-1], fits[-1])):
            break
        tell(f"tracing, round {depth + 1}")
        known = next((r for r in begun if _same(r.onto, path[-1])), None)
        tried, accepted, confirmed = _round(setup, path[-1], fits[-1], pool, tell, known, later)
        rounds.append(tried)
        if accepted is None:
            break
        path.append(accepted[0])
        fits.append(accepted[1])
        rivals = confirmed
        if confirmed:
            decided.add(accepted[0].names[-1])
    return Path(path, rounds, fits, rivals, frozenset(decided))


def _same(one: Trial, other: Trial) -> bool:
    """Whether two trials are the same effects, fitted alike."""
    return one is other or (one.names == other.names and one.swing.chi2 == other.swing.chi2)


def _round(
    setup: Setup, onto: Trial, whole: Fit, pool: Sequence[Candidate], tell: Tell, known: Round | None = None,
    later: bool = False,
) -> tuple[Round, Accepted | None, tuple[Rival, ...]]:  # fmt: skip
    """What was tried on top of a trial, what of it is accepted, and the rivals if whole records decided among them.

    whole: the fit on whole records of the trial.
    known: the round as far as it was gone through without candidates whose runs take long.
    later: whether these are left out.
    """

    def explained(trial: Trial) -> bool:
        return not slips(trial) and over_noise(setup, trial) < structure(setup)

    tried = search(setup.simulator, onto, pool, tell, explained=explained, later=later) if known is None else known
    if known is not None and not any(map(explained, (onto, *known.trials))):
        search_costly(setup.simulator, tried, tell)
    accepted, confirmed = _accepted(setup, onto, whole, tried, pool, tell)
    if later or not tried.put_off:
        return tried, accepted, confirmed
    # Swings that leave nothing say nothing of a soft floor; whole records that are missed still may, and so may swings
    # of which what was accepted leaves more than what was not.
    stands, its_whole = (onto, whole) if accepted is None else accepted
    if explains(setup, stands, its_whole):
        return tried, accepted, confirmed
    floors = Round(onto, search_costly(setup.simulator, tried, tell))
    found, decided = _accepted(setup, onto, whole, floors, (), tell, hint=-PAYS)
    there = {t.names for t in tried.trials}
    tried.trials += [t for t in floors.trials if t.names not in there]
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
