"""What a greedy search accepted, looked at again: effects that are no longer needed go, others give way to better ones.

The effect that is accepted first may stand for several; once these are there, nothing is left to it, or a rival that
explained less by itself explains more.  So each effect is taken out, with the others fitted anew: it stays out where
that costs nothing, and where not, those that came near it in its round are tried in its place.

Source   forward selection with elimination and replacement: Miller (2002), Subset Selection in Regression, ch. 3.
Status   stand-ins of planted pairs are exchanged for what was planted (tests); where whole records decided on the last
         effect nothing is revised
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from studies.loop.fits.fitting import Fit, fit
from studies.loop.models.candidates import Candidate
from studies.loop.models.model import CHANGE, DRIFT, LoopModel
from studies.loop.models.names import readable
from studies.loop.records.preparing import Setup
from studies.loop.swings.tracing import search
from studies.loop.swings.trials import FURTHER_COSTLY, Round, Trial, bic, pays
from studies.loop.whole.rivals import TWIN
from studies.loop.whole.whole_fits import whole_fit, whole_fit_from_many
from studies.loop.whole.whole_records import explains_more

MOST_TRIED = 6
"""Candidates of its round that are tried in the place of an effect: those that explained most in it."""


@dataclass(frozen=True)
class Revision:
    """The trial that stands, its fit on whole records, and of each effect what was tried in its place."""

    trial: Trial
    whole: Fit
    rounds: tuple[Round, ...]  # of each effect: what was tried on top of the others
    said: tuple[str, ...] = ()


def revised(
    setup: Setup, plain: Trial, trial: Trial, whole: Fit, rounds: Sequence[Round], tell: Callable[[str], None]
) -> Revision:
    """The accepted trial without what it does not need, and with what serves better.

    Args:
        setup: what the loop works on.
        plain: the calibrated block.
        trial: as the search accepted it.
        whole: its fit on whole records.
        rounds: of the search; the first ones brought in the effects of the trial, one each.
        tell: is told what is being done.
    """
    sources = {part.name: found for part, found in zip(trial.parts, rounds, strict=False)}
    stands = Revision(trial, whole, tuple(sources.values()))
    if len(trial.parts) < 2:
        return stands
    known = {frozenset(trial.names)}
    said: list[str] = []
    while True:
        tell("looking again at what was accepted first")
        others = [taken_out(setup, plain, stands.trial, k) for k in range(len(stands.trial.parts))]
        shorter = _dropped(setup, stands, others) if len(stands.trial.parts) > 1 else None
        if shorter is not None:
            gone = set(stands.trial.names) - set(shorter.trial.names)
            said += [f"{readable(name)} was accepted at first, and is not needed beside the others" for name in gone]
            stands = shorter
            if len(stands.trial.parts) > 1:
                continue
            others = [plain]
        tried = tuple(
            # The last one of the search was chosen with the others there.
            sources[part.name]
            if part is trial.parts[-1] and not said and sources[part.name].onto.names == without.names
            else _again(setup, without, stands.trial, part, sources[part.name], tell)
            for part, without in zip(stands.trial.parts, others, strict=True)
        )  # fmt: skip
        stands, better = _exchanged(setup, replace(stands, rounds=tried, said=tuple(said)), known)
        if better is None:
            return stands
        old, new = next(n for n in stands.trial.names if n not in better.trial.names), better.trial.names[-1]
        said.append(f"{readable(old)} was accepted at first; beside the others {readable(new)} explains more instead")
        sources[new] = sources.pop(old)
        known.add(frozenset(better.trial.names))
        stands = better


def taken_out(setup: Setup, plain: Trial, trial: Trial, k: int) -> Trial:
    """The trial with one of its effects taken out, and all the others fitted anew."""
    left = plain
    for part in (*trial.parts[:k], *trial.parts[k + 1 :]):
        left = left.with_(part, plain.swing)
    start = _without(trial.swing.model, plain.swing.model, trial.parts[k], left)
    steps = FURTHER_COSTLY if left.costly else 12
    return replace(left, swing=fit(setup.simulator, start, left.every, trial.swing.windows, iterations=steps))


def _without(model: LoopModel, plain: LoopModel, gone: Candidate, left: Trial) -> LoopModel:
    """The model without one of its parts; of an effect that others are a part of, their parameters stay."""
    kept = {name for part in left.parts for name in (*part.fixed, *(p.name for p in part.parameters))}
    own = {*gone.fixed, *(p.name for p in gone.parameters)} - kept
    effects = {
        effect: {name: value for name, value in values.items() if f"{effect}.{name}" not in own}
        for effect, values in model.effects.items() if any(name.startswith(f"{effect}.") for name in kept)
    }  # fmt: skip
    of_changes = tuple(name for name in kept if name.startswith(f"{CHANGE}."))
    changed = [full for full in model.changes if any(name.endswith(f".{full}") for name in of_changes)]
    left_over = replace(model, effects=effects, changes={full: model.changes[full] for full in changed})
    return left_over if DRIFT in kept else replace(left_over, drift=plain.drift, fading=plain.fading)


def _dropped(setup: Setup, stands: Revision, others: Sequence[Trial]) -> Revision | None:
    """The trial without the effect that it needs least, or None if swings or whole records need them all."""
    for less in sorted(others, key=lambda t: t.swing.chi2):
        if pays(less.swing, stands.trial.swing):
            break
        # Whole records are rugged: more is tried before they are taken to refuse.
        for fitted in (_whole_without, _whole_without_from_many):
            whole = fitted(setup, less, stands)
            if not _refused(setup, stands, whole):
                return Revision(less, whole, ())
    return None


def _whole_without(setup: Setup, less: Trial, stands: Revision) -> Fit:
    """What is left of a trial fitted to whole records, from its own swings or from where the trial that stands has it.

    What is not needed may have led to a minimum that is there without it too.
    """
    own = whole_fit(setup, less, stands.whole)
    effects = {name: values for name, values in stands.whole.model.effects.items() if name in less.effects}
    there = replace(less, swing=replace(less.swing, model=replace(stands.whole.model, effects=effects)))
    return min(own, whole_fit(setup, there, stands.whole), key=lambda found: found.chi2)


def _whole_without_from_many(setup: Setup, less: Trial, stands: Revision) -> Fit:
    """The same from starts about what its own swings say."""
    return whole_fit_from_many(setup, less, stands.whole)


def without_needless(
    setup: Setup, plain: Trial, stands: Revision, rounds: Sequence[Round], tell: Callable[[str], None]
) -> Revision | None:
    """What stands without an effect that it does not need, looked at as that was; None if it needs them all.

    To be asked of a trial that took the place of its twin: of what it has in that one's place there may be nothing;
    and where whole records brought in the last effect, since that may be all that there is.

    rounds: of the search.
    """
    if len(stands.trial.parts) < 2:
        return None
    others = [taken_out(setup, plain, stands.trial, k) for k in range(len(stands.trial.parts))]
    shorter = _dropped(setup, stands, others)
    if shorter is None:
        return None
    (gone,) = set(stands.trial.names) - set(shorter.trial.names)
    sources = [
        next(r for r in rounds if any(r.added(t).name == part.name for t, _ in r.tried)) for part in shorter.trial.parts
    ]
    if len(sources) > 1:
        found = revised(setup, plain, shorter.trial, shorter.whole, sources, tell)
    else:
        (part,) = shorter.trial.parts
        found = replace(shorter, rounds=(_again(setup, plain, shorter.trial, part, sources[0], tell),))
    return replace(found, said=(*stands.said, f"{readable(gone)} is not needed beside the others", *found.said))


def _again(
    setup: Setup, without: Trial, trial: Trial, part: Candidate, source: Round, tell: Callable[[str], None]
) -> Round:
    """What came near an effect when it was accepted, tried with the other effects there; the trial itself among it."""
    # Beside a floor that gives runs take long: what the search found has to be enough.
    if trial.costly or not part.in_swings:
        return Round(without, [trial])
    tried = search(setup.simulator, without, _near(source, trial, part), tell)
    return replace(tried, trials=[*tried.trials, trial])


def _near(source: Round, trial: Trial, own: Candidate) -> list[Candidate]:
    """The candidates of a round that explained most in it, without the other effects of the trial, one form of each."""
    best: dict[str, Candidate] = {}
    others = {part.effect for part in trial.parts if part is not own}
    for t in sorted(source.trials, key=lambda t: bic(t.swing)):
        part = t.parts[-1]
        if part.in_swings and not part.costly and part.effect not in others and part.name != own.name:
            best.setdefault(part.effect, part)
    return list(best.values())[:MOST_TRIED]


def _exchanged(setup: Setup, stands: Revision, known: set[frozenset[str]]) -> tuple[Revision, Revision | None]:
    """The trial with one effect exchanged for another that explains more, or None; first, what stood until then.

    What would take its place and whole records refuse is set aside in its round.
    """
    better: Revision | None = None
    refused: set[frozenset[str]] = set()
    found = [
        t for tried in stands.rounds for t in tried.trials
        # A floor that gives was put to whole records when it was tried.
        if frozenset(t.names) not in known and (stands.trial.costly or not t.costly)
    ]  # fmt: skip
    for t in sorted(found, key=lambda t: bic(t.swing)):
        if bic(t.swing) > bic(stands.trial.swing) - TWIN:
            break
        whole = whole_fit(setup, t, stands.whole)
        if not _refused(setup, stands, whole):
            better = Revision(t, whole, ())
            break
        refused.add(frozenset(t.names))
    return replace(stands, rounds=tuple(set_aside(tried, refused) for tried in stands.rounds)), better


def _refused(setup: Setup, stands: Revision, whole: Fit) -> bool:
    """Whether whole records speak against what would take its place; those of accelerometers are not asked."""
    return setup.by_rotation and explains_more(setup, stands.whole, whole)


def set_aside(tried: Round, refused: set[frozenset[str]]) -> Round:
    """The round with these trials among those that were refused."""
    gone = tuple(t for t in tried.trials if frozenset(t.names) in refused)
    left = [t for t in tried.trials if frozenset(t.names) not in refused]
    return replace(tried, trials=left, refused=(*tried.refused, *gone))
