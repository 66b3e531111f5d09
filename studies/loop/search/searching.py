"""Where the search goes: on from effect to effect, back where something is left, and to floors that give last of all.

The effect that explains most by itself may be none of those that act together.  So where something is left over, the
search goes on from those that came near the first one, too.  Runs on floors that give take so long that what two other
effects explain is asked first, unless such a floor explains some swings down to their noise, or by far more of them.
Where one coefficient or form without a name explains all, and effects that are quickly tried do not, the search goes
neither way.

Source   none, own convention
Status   a planted pair of which one effect came second to a stand-in for both is found (docs/benchmarks.md)
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache

from studies.loop.fits.fitting import Fit
from studies.loop.models.candidates import OF_THE_ROTATION_SENSOR, Candidate
from studies.loop.models.names import readable
from studies.loop.records.preparing import Setup
from studies.loop.search.revising import set_aside, taken_out
from studies.loop.search.rounds import Path, Tell, followed, nothing_of_swings, same, searched, stands_alone
from studies.loop.swings.learning import MOST_ALIKE, by_itself, inner, open_to, profiles, terms
from studies.loop.swings.tracing import LEADS, all_candidates, floor_promises, search
from studies.loop.swings.trials import LEAST_GAIN, PAYS, Round, Trial, bic, pays
from studies.loop.swings.trying import promise
from studies.loop.whole.floors_of_releases import from_releases, tell_of_floors
from studies.loop.whole.remaining import (
    CLOSELY,
    begins_roughly,
    by_chance,
    declared_noise,
    explains,
    met,
    one_is_lost,
    over_noise,
    remembers,
    rms_but_for_one,
    roughly_begun,
    slips,
    unexplained,
)
from studies.loop.whole.rivals import TWIN
from studies.loop.whole.whole_fits import gain, whole_fit, whole_fit_from_many
from studies.loop.whole.whole_records import MISSED, explains_more, remembering_all

Lead = Callable[[], Trial | None]
"""What gives the coefficient without a name that explains most of the swings, which is searched for once."""

NEARLY_FIRST = 0.5
"""Effects that lower the criterion by this share of what the first one does are gone on from in its place."""

MOST_IN_PLACE_OF_THE_FIRST = 2

NOT_ON_TOP = "floors that give were not tried on top of this; runs take long"

NOT_OF_RELEASES = "no floor meets the releases and serves whole records"

NOT_NEEDED_OF_RELEASES = "another floor meets all releases down to their noise; runs take long"

SURELY = 1.5
"""By how much more than some windows say a form may lower what is left of swings, where that is little."""

ONE_TERM = "one coefficient without a name leaves nothing over the noise, nor of whole records; runs take long"

ONE_BESIDE = "one coefficient without a name beside what was found leaves nothing over the noise; runs take long"

ONE_FORM = "one form without a name leaves nothing over the noise, nor of whole records; runs take long"

ONE_AHEAD = "one coefficient without a name explains more than what was found; runs take long"


def traced(setup: Setup, plain: Trial, tell: Tell) -> Path:
    """The path that serves best; after its own rounds come those of the paths that were left.

    Floors that give are tried where the others leave something over the noise, or whole records are missed: from the
    beginning, and on top of the first effect of a path to which the search went back.  One that leads by far is gone on
    from at once, and stands unless two other effects serve better.
    """
    pool = all_candidates(plain.swing.model, setup.campaign.conditions.friction)
    if not setup.by_rotation:
        pool = tuple(c for c in pool if c.effect not in OF_THE_ROTATION_SENSOR)
    begin = Path([plain], [], [whole_fit(setup, plain)])
    tell("tracing, round 1")
    opening = searched(setup, plain, pool, tell, later=True)
    # One coefficient is asked in far less time than floors, in whose reach what it explains to the end is not.
    lead = cache(lambda: _leading(setup, plain, tell))
    term = None if _nothing_is_left_of_swings(setup, opening) else _coefficient(setup, plain, lead)
    floor = _floor_first(setup, begin, opening, pool, tell) if term is None else None
    if floor is not None and (_enough_alone(setup, floor) or stands_alone(setup, floor.last, floor.whole)):
        return floor
    # Where a coefficient explains swings that no name explains, whole records have no name for them either.
    by_swings = term is not None and all(pays(t.swing, term[0].swing) for t in opening.trials)
    first = floor or followed(setup, begin, pool, tell, later=True, begun=[opening], most=1, by_swings=by_swings)
    greedy: Path | None = None
    if floor is None and term is None and _floor_may_be_behind(setup, begin, opening, first):
        # Two effects are asked in far less time; of a floor they leave something.
        greedy = _greedy(setup, first, pool, tell)
        meant = None if _leaves_nothing(setup, greedy) else _floor_behind(setup, begin, opening, first, tell)
        if meant is not None:
            return meant
    if not explains(setup, first.last, first.whole):
        if term is None and _nothing_is_left_of_swings(setup, opening):
            term = _coefficient(setup, plain, lead)
        path = _without_names(setup, plain, first, pool, term, tell) if term is not None else None
        if path is not None:
            return path
    if by_swings:
        first = followed(setup, begin, pool, tell, later=True, begun=[opening], most=1)
    if floor is not None:
        floor = followed(setup, floor, pool, tell)
        if explains(setup, floor.last, floor.whole):
            return _told(setup, floor, [floor], floor, _merged([floor]))
        first = followed(setup, begin, pool, tell, later=True, begun=[opening], most=1)
    greedy = greedy or _greedy(setup, first, pool, tell)
    if floor is not None and not _serves_better(setup, greedy, floor):
        return _told(setup, floor, [floor, greedy], floor, [_with_reason(r) for r in _merged([floor, greedy])])
    paths = [greedy, *_going_back(setup, greedy, pool, tell)]
    # One effect alone was left in the first round already.
    quick = _best(setup, [greedy, *(p for p in paths[1:] if len(p.trials) > 2)])
    rounds = _merged(paths)
    if not any(r.put_off for r in rounds) or _nothing_is_left(setup, quick):
        return _told(setup, quick, paths, greedy, rounds)
    if _one_term_is_enough(setup, plain, tell):
        rounds = [replace(r, skipped=r.skipped | {c.name: ONE_TERM for c in r.put_off}) for r in rounds]
        return _told(setup, quick, paths, greedy, rounds)
    kinds = _kinds_of_forms(setup, plain, quick) if floor is None else []
    form = None
    if len(kinds) > 1 and kinds[0].goes_on and kinds[0].promise > kinds[1].promise + PAYS:
        form = _form_in_place(setup, plain, quick, [kinds.pop(0)], lead, tell, _floors_are_refused(rounds, plain))
    beside = _term_beside(setup, plain, quick, tell) if floor is None and form is None else None
    if beside is not None:
        why = ONE_BESIDE if len(beside.parts) > 1 else ONE_TERM
        rounds = [replace(r, skipped=r.skipped | {c.name: why for c in r.put_off}) for r in rounds]
        return replace(_told(setup, quick, paths, greedy, rounds), term=beside)
    form = form or _form_in_place(setup, plain, quick, kinds, lead, tell, _floors_are_refused(rounds, plain))
    if form is not None:
        rounds = [replace(r, skipped=r.skipped | {c.name: ONE_FORM for c in r.put_off}) for r in rounds]
        return replace(_told(setup, quick, paths, greedy, rounds), term=form)
    ahead = _term_ahead(setup, quick, rounds, lead) if floor is None else None
    if ahead is not None:
        rounds = [replace(r, skipped=r.skipped | {c.name: ONE_AHEAD for c in r.put_off}) for r in rounds]
        return replace(_told(setup, quick, paths, greedy, rounds), term=ahead)
    third = _with_a_third(setup, quick, pool, tell)
    if third is not None:
        rounds = [_with_reason(r) for r in _merged([third, *paths])]
        return _told(setup, third, [third, *paths], greedy, rounds)
    if tell_of_floors(setup):
        return _with_a_floor_of_releases(setup, quick, paths, greedy, rounds, pool, tell)
    tell("something is left: again with floors that give")
    floors = [followed(setup, begin, pool, tell, begun=_to_go_through_again(rounds))]
    # What stood of the greedy path was gone through again.
    chosen = floors[0]
    if quick is not greedy and not stands_alone(setup, chosen.last, chosen.whole):
        first = Path(quick.trials[:2], floors[0].rounds[:1], quick.fits[:2])
        floors.append(followed(setup, first, pool, tell, begun=_to_go_through_again(rounds)))
        chosen = _best(setup, [quick, *floors])
    rounds = [_with_reason(r) for r in _merged([*paths, *floors])]
    return _told(setup, chosen, [*floors, *paths], greedy, rounds)


def _with_a_floor_of_releases(
    setup: Setup, quick: Path, paths: Sequence[Path], greedy: Path, rounds: Sequence[Round], pool: Sequence[Candidate],
    tell: Tell,
) -> Path:  # fmt: skip
    """The path that serves best, with a floor that meets all releases, alone or on top of the path's first effect."""
    chosen, floors, refused = quick, list[Path](), list[Trial]()
    costly = tuple(c for c in pool if c.costly)
    for length in (1, 2):
        begin = Path(quick.trials[:length], quick.rounds[: length - 1], quick.fits[:length])
        known = next((r for r in rounds if same(r.onto, begin.last)), Round(begin.last))
        if len(begin.trials) < length or any(known.skipped.get(c.name) == NOT_OF_RELEASES for c in costly):
            continue
        found = _floor_of_releases(
            setup, begin, replace(known, put_off=costly, skipped=dict(known.skipped)), tell
        )  # fmt: skip
        if found is None:
            refused.append(begin.last)
            continue
        floors.append(found)
        if stands_alone(setup, found.last, found.whole):
            chosen = found
            break
        chosen = _best(setup, [chosen, found])
    why = {c.name: NOT_OF_RELEASES for c in costly}
    every = [
        _with_reason(replace(r, skipped=r.skipped | why) if any(same(r.onto, t) for t in refused) else r)
        for r in _merged([*paths, *floors])
    ]
    return _told(setup, chosen, [*floors, *paths], greedy, every)


def _floor_first(
    setup: Setup, begin: Path, opening: Round, pool: Sequence[Candidate], tell: Tell
) -> Path | None:  # fmt: skip
    """The path to a floor that gives, where all that is quickly tried leaves something and that alone nothing, or
    little of what the best of these leaves.

    opening: the first round, of which swings alone were asked.
    """
    if _nothing_is_left_of_swings(setup, opening):
        return None
    if tell_of_floors(setup):
        return _floor_of_releases(setup, begin, opening, tell)
    if not declared_noise(setup) or not floor_promises(setup.simulator, opening, tell):
        return None
    tell("something is left: asking floors that give")
    path = followed(setup, begin, pool, tell, begun=_to_go_through_again([opening]), most=1)
    if not path.last.costly:
        return None
    others = min(t.swing.chi2 for t in (opening.onto, *opening.trials))
    # One that explains swings and misses whole records is no place to go on from: nothing is left of swings to add to.
    leads = path.last.swing.chi2 < LEADS * others and not explains(setup, path.last, path.whole)
    return path if leads or _enough_alone(setup, path) else None


def _greedy(setup: Setup, first: Path, pool: Sequence[Candidate], tell: Tell) -> Path:
    """The path on from its first effect; where none was accepted there is nothing to go on from."""
    return followed(setup, first, pool, tell, later=True) if len(first.trials) > 1 else first


def _floor_may_be_behind(setup: Setup, begin: Path, opening: Round, first: Path) -> bool:
    """Whether an effect may explain swings in the place of a floor that gives, since it misses whole records.

    Of a block that slips swings say little, and a floor may look like a loss that depends on the speed; of what the
    calibrated block leaves nothing in swings no floor is the reason.
    """
    asked = NOT_OF_RELEASES in opening.skipped.values()
    if asked or not tell_of_floors(setup) or nothing_of_swings(setup, begin.last):
        return False
    return not met(setup, first.whole, MISSED)


def _floor_behind(setup: Setup, begin: Path, opening: Round, first: Path, tell: Tell) -> Path | None:
    """The path to a floor that gives, where whole records prefer it to that of an effect that misses them."""
    found = _floor_of_releases(setup, begin, opening, tell)
    if found is None or not explains_more(setup, found.whole, first.whole):
        return None
    return found if stands_alone(setup, found.last, found.whole) else None


def _floor_of_releases(setup: Setup, begin: Path, opening: Round, tell: Tell) -> Path | None:
    """The path to a floor that meets all releases, if it serves whole records by far better than what there was.

    opening: a round on top of that, which put floors off.
    """
    tell("something is left: asking floors that give")
    found = from_releases(setup, begin.last, opening.put_off, tell)
    if found is None or gain(setup, begin.whole, found[1]) <= LEAST_GAIN:
        opening.skipped |= {c.name: NOT_OF_RELEASES for c in opening.put_off}
        return None
    trial, whole = found
    others = {c.name: NOT_NEEDED_OF_RELEASES for c in opening.put_off if c.name != trial.names[-1]}
    tried = replace(
        opening, trials=[*opening.trials, trial], put_off=(),
        skipped={k: why for k, why in opening.skipped.items() if k != trial.names[-1]} | others,
    )  # fmt: skip
    return replace(begin, trials=[*begin.trials, trial], rounds=[*begin.rounds, tried], fits=[*begin.fits, whole])


def _enough_alone(setup: Setup, path: Path) -> bool:
    """Whether a floor leaves nothing of swings, and of whole records.

    These have to be met, or not to be missed by far where it leaves no more than chance does of the swings: as little
    is asked of an effect that is quickly tried, and nothing is looked for on top of such a floor.
    """
    if setup.by_rotation and not by_chance(setup, path.last) and not met(setup, path.whole, MISSED):
        return False
    return explains(setup, path.last, path.whole) or roughly_begun(setup, path.last, path.whole)


def _to_go_through_again(rounds: Sequence[Round]) -> list[Round]:
    """Rounds of their own; what whole records alone brought in, they are asked for again."""
    return [
        replace(r, trials=[t for t in r.trials if r.added(t).in_swings], skipped=dict(r.skipped)) for r in rounds
    ]  # fmt: skip


def _one_term_is_enough(setup: Setup, plain: Trial, tell: Tell) -> bool:
    """Whether a single coefficient without a name explains swings and whole records.

    Then something acts that has no name, and no floor that gives: such a one is in no single coefficient's reach.  A
    little more than chance may be left of the swings where whole records are met closely.
    """
    best = _best_without_a_name(setup, plain, lambda: terms(plain.swing.model.declared), tell)
    return best is not None and _enough(setup, best) is not None


def _term_beside(setup: Setup, plain: Trial, path: Path, tell: Tell) -> Trial | None:
    """What was found with a coefficient without a name beside it, where that leaves nothing and is not refused.

    Names that the coefficient does not need, as swings have it, only mend a record that is lost: it stands by itself.
    """
    if not path.last.parts or slips(path.last) or not setup.by_rotation or not declared_noise(setup):
        return None
    tell("something is left: asking coefficients without a name beside what was found")
    pool = open_to(path.last, by_itself(setup.simulator, path.last))
    best = search(setup.simulator, path.last, pool, tell, repeated=True, leading=True).best
    if best is None or not pays(path.last.swing, best.swing):
        return None
    found = _enough(setup, best)
    if found is None or not explains_more(setup, found[1], path.whole):
        return None
    alone = search(setup.simulator, plain, [best.parts[-1]], tell).best
    return alone if alone is not None and not pays(alone.swing, best.swing) else _needed(setup, plain, *found)


def _needed(setup: Setup, plain: Trial, trial: Trial, whole: Fit) -> Trial:
    """A trial without those of its names that what was added last does not need: swings and whole records say so."""
    for k in reversed(range(len(trial.parts) - 1)):
        less = taken_out(setup, plain, trial, k)
        if pays(less.swing, trial.swing):
            continue
        without = whole_fit(setup, less, whole)
        if not explains_more(setup, whole, without):
            trial, whole = less, without
    return trial


@dataclass(frozen=True)
class _Kind:
    """Forms of one kind without a name."""

    what: str
    pool: Sequence[Candidate]
    goes_on: bool  # whether they have states that go on from swing to swing
    promise: float  # what the criterion of the swings promises to fall by


def _kinds_of_forms(setup: Setup, plain: Trial, path: Path) -> list[_Kind]:
    """What may be asked in the place of a path that leaves something: curves, and what goes on within the block or
    beside it, the more promising first.

    Where the calibrated block leaves no more of swings than chance would, what a form may gain of them is told by its
    score: one that could not be preferred by far is none.
    """
    if not setup.by_rotation or not declared_noise(setup):
        return []
    if by_chance(setup, path.last) and met(setup, path.whole, MISSED):
        return []
    declared, released = plain.swing.model.declared, any(test.kind == "free" for test in setup.simulator.tests)
    pools = (
        ("curves against the rotation", profiles(declared, plain.swing.windows), False),
        ("what goes on within the block", inner(declared, released), True),
    )
    little = by_chance(setup, plain)
    least = bic(plain.swing) - bic(path.last.swing) + PAYS
    found = [
        _Kind(what, pool, goes_on, promise(setup.simulator, plain, pool, SURELY if little else 1.0))
        for what, pool, goes_on in pools
    ]
    return sorted((kind for kind in found if not little or kind.promise > least), key=lambda kind: -kind.promise)


def _form_in_place(
    setup: Setup, plain: Trial, path: Path, kinds: Sequence[_Kind], lead: Lead, tell: Tell, refused: bool
) -> Trial | None:  # fmt: skip
    """A form of many coefficients that leaves nothing of swings and whole records, where a path leaves something.

    Swings have to prefer it by far, and whole records must not refuse it.  Floors that give have been asked alone, and
    of what they do together with something else one such form says little.  Where swings are left with no more than
    chance would leave, and whole records are missed, a form may still be preferred by far: what it does is little in
    any one swing.  Where a coefficient or two say as much of the swings,
    no form is taken that whole records do not prefer to them.

    refused: whether releases refused floors that give; then a form that leaves no more of swings than chance would, and
        that whole records prefer by far, need not meet these: the noise of the base may lose one.
    """
    for kind in kinds:
        tell(f"something is left: asking {kind.what}")
        forms = sorted(search(setup.simulator, plain, kind.pool, tell, leading=True).trials, key=lambda t: bic(t.swing))
        best: tuple[Trial, Fit] | None = None
        for form in forms[:MOST_ALIKE]:
            # Of those that swings do not tell from the first one whole records choose.
            if bic(form.swing) > min(bic(path.last.swing) - PAYS, bic(forms[0].swing) + PAYS):
                break
            found = _enough(setup, form)
            if found is None and refused:
                found = _far_ahead(setup, path, form)
            if found is None or explains_more(setup, path.whole, found[1]):
                continue
            if best is None or explains_more(setup, found[1], best[1]):
                best = found
        if best is not None:
            few = lead()
            if few is None or bic(best[0].swing) < bic(few.swing):
                return best[0]
            return best[0] if explains_more(setup, best[1], whole_fit(setup, few)) else None
    return None


def _far_ahead(setup: Setup, path: Path, form: Trial) -> tuple[Trial, Fit] | None:
    """A form with its fit on whole records, if it leaves no more of swings than chance would, where a path leaves
    structure, and whole records prefer it by far."""
    if not by_chance(setup, form) or over_noise(setup, path.last) <= unexplained(setup):
        return None
    whole = whole_fit(setup, form)
    return (form, whole) if explains_more(setup, whole, path.whole) else None


def _term_ahead(setup: Setup, path: Path, rounds: Sequence[Round], lead: Lead) -> Trial | None:
    """One coefficient without a name, whatever it leaves, that swings and whole records prefer by far to a path of
    effects with one, where no floor meets the releases.

    Neither effects that stand in for what has no name need be gone on from then, nor what is learned on top of them.
    """
    if path.last.costly or slips(path.last) or not _floors_are_refused(rounds, path.trials[0]):
        return None
    best = lead()
    if best is None or not pays(path.last.swing, best.swing):
        return None
    best, whole = remembering_all(setup, best, whole_fit(setup, best))
    return best if explains_more(setup, whole, path.whole) else None


def _floors_are_refused(rounds: Sequence[Round], plain: Trial) -> bool:
    """Whether releases refused floors that give in the place of all else."""
    return any(NOT_OF_RELEASES in r.skipped.values() for r in rounds if same(r.onto, plain))


def _enough(setup: Setup, term: Trial) -> tuple[Trial, Fit] | None:
    """A coefficient with its fit on whole records, if it explains them and the swings.

    Of one by which it is told but roughly how a swing begins, whole records alone have a say; which impacts one that
    remembers them remembers is asked first.  Whole records are rugged: where a single one is lost, they are fitted from
    more starts, and the others have to be met.
    """
    if not _of_swings(setup, term) and not remembers(term):
        return None
    term, whole = remembering_all(setup, term, whole_fit(setup, term))
    if not _of_swings(setup, term):
        return None
    within = MISSED if by_chance(setup, term) else CLOSELY
    if met(setup, whole, within):
        return term, whole
    if not one_is_lost(whole):
        return None
    whole = min(whole, whole_fit_from_many(setup, term, whole), key=lambda found: found.chi2)
    return (term, whole) if met(setup, whole, within) or rms_but_for_one(whole) < within else None


def _of_swings(setup: Setup, term: Trial) -> bool:
    """Whether a coefficient explains the swings, or leaves what they say of it to whole records."""
    return begins_roughly(term) or over_noise(setup, term) <= unexplained(setup)


def _nothing_is_left_of_swings(setup: Setup, opening: Round) -> bool:
    """Whether the calibrated block, or an effect of the first round, leaves nothing of the swings."""
    return any(nothing_of_swings(setup, t) for t in (opening.onto, *opening.trials))


def _leading(setup: Setup, plain: Trial, tell: Tell) -> Trial | None:
    """The coefficient without a name that explains most of the swings by itself, of all that may act so."""
    return _best_without_a_name(setup, plain, lambda: by_itself(setup.simulator, plain), tell)


def _coefficient(setup: Setup, plain: Trial, lead: Lead) -> tuple[Trial, Fit] | None:
    """That coefficient, if it explains the swings and whole records."""
    term = lead()
    return _enough(setup, term) if term is not None and pays(plain.swing, term.swing) else None


def _best_without_a_name(
    setup: Setup, plain: Trial, pool: Callable[[], Sequence[Candidate]], tell: Tell
) -> Trial | None:  # fmt: skip
    """Of coefficients the one that explains most of the swings; none where whole records could not have their say."""
    if not setup.by_rotation or not declared_noise(setup):
        return None
    tell("something is left: asking coefficients without a name")
    return search(setup.simulator, plain, pool(), tell, leading=True).best


def _without_names(
    setup: Setup, plain: Trial, first: Path, pool: Sequence[Candidate], coefficient: tuple[Trial, Fit], tell: Tell
) -> Path | None:  # fmt: skip
    """The path that goes no further since one coefficient without a name explains what effects with one do not.

    It leaves nothing where a first effect, and any smooth one on top of it, leave structure, and swings have to prefer
    it by far, whole records not to refuse it; or these prefer it by far to both, and swings do not refuse it.

    first: the path after its first round.
    """
    term, its_whole = coefficient
    path, smooth = first, [c for c in pool if c.smooth]
    if len(first.trials) > 1:
        path = followed(setup, first, smooth, tell, later=True, most=2, by_swings=True)
    by = bic(path.last.swing) - bic(term.swing)
    # Two effects have the freedom to stand for a third of any kind: where whole records prefer the coefficient to both,
    # however these are begun, swings only must not speak against it.
    several = by >= 0.0 and len(path.last.parts) > 1 and explains_more(setup, its_whole, path.whole)
    if several and by < PAYS:
        several = explains_more(setup, its_whole, whole_fit_from_many(setup, path.last, path.whole))
    if (by < PAYS and not several) or explains_more(setup, path.whole, its_whole):
        return None
    if explains(setup, path.last, path.whole) and not several:
        return None
    rounds = []
    for tried in path.rounds:
        left = list(tried.put_off)
        if tried.onto is not plain:
            left += [c for c in pool if not c.smooth and c.effect not in tried.onto.effects]
        rounds.append(replace(tried, put_off=(), skipped=tried.skipped | {c.name: ONE_TERM for c in left}))
    return replace(path, rounds=rounds, term=term)


def _nothing_is_left(setup: Setup, path: Path) -> bool:
    """Whether neither swings nor whole records ask for a floor that gives."""
    if not explains(setup, path.last, path.whole):
        return False
    if len(path.last.parts) < 2 and not slips(path.last):
        return True
    # Two effects may stand in for a floor in the swings, but for the end of records hardly. Where a block slips what is
    # left is a median over the windows, and says nothing of a minority of them; whole records do.
    if not slips(path.last):
        return by_chance(setup, path.last) and (not setup.by_rotation or _met_from_some_start(setup, path))
    return _met_from_some_start(setup, path)


def _met_from_some_start(setup: Setup, path: Path) -> bool:
    """Whether whole records are met; these are rugged, and are fitted from more starts before they say no."""
    if not setup.by_rotation:
        return path.whole.rms < MISSED
    return met(setup, path.whole, MISSED) or met(setup, whole_fit_from_many(setup, path.last, path.whole), MISSED)


def _with_a_third(setup: Setup, path: Path, pool: Sequence[Candidate], tell: Tell) -> Path | None:
    """The path with one effect more than two, if nothing is left then.

    Three effects may stand in for much, so that they have to leave no more than chance does of the swings, and to meet
    whole records; these are rugged, and are fitted from more starts before they say no.
    """
    if len(path.trials) != 3 or path.last.costly or slips(path.last) or not declared_noise(setup):
        return None
    tell("something is left: asking for a third effect")
    found = followed(setup, path, [c for c in pool if not c.costly], tell)
    if len(found.trials) == 3 or not by_chance(setup, found.last):
        return None
    if setup.by_rotation and not met(setup, found.whole, MISSED):
        found = replace(found, fits=[*found.fits[:-1], whole_fit_from_many(setup, found.last, found.whole)])
    return found if _leaves_nothing(setup, found) else None


def _going_back(setup: Setup, greedy: Path, pool: Sequence[Candidate], tell: Tell) -> list[Path]:
    """Where a path leaves something, those from effects that came near its first one, up to one that leaves nothing.

    Where it has none, since whole records refused what explains most of the swings, from that: one of two effects may
    spoil what the calibrated block met by chance, and both explain all.
    """
    found: list[Path] = []
    if _leaves_nothing(setup, greedy):
        return found
    for trial in _near_the_first(greedy):
        tell(f"something is left: again from {trial.names[-1]}")
        begin = Path([greedy.trials[0], trial], greedy.rounds[:1], [greedy.fits[0], whole_fit(setup, trial)])
        found.append(followed(setup, begin, pool, tell, later=True))
        if len(found[-1].trials) > 2 and _leaves_nothing(setup, found[-1]):
            break
    return found


def _leaves_nothing(setup: Setup, path: Path) -> bool:
    """Whether swings leave no more than noise does by chance, and whole records are met.

    What a stand-in leaves of two effects is little.  Where noise is estimated, or a block slips, less can be asked.
    """
    if slips(path.last) or not declared_noise(setup):
        return explains(setup, path.last, path.whole)
    return by_chance(setup, path.last) and (not setup.by_rotation or met(setup, path.whole, MISSED))


def _near_the_first(path: Path) -> list[Trial]:
    """Of the first round the trials of other effects that came near the best one, one of each effect."""
    plain = path.trials[0]
    others = [t for t in path.rounds[0].trials if not t.costly and pays(plain.swing, t.swing)]
    ranked = sorted(others, key=lambda t: bic(t.swing))
    gains = [bic(plain.swing) - bic(t.swing) for t in (*path.trials[1:2], *ranked)]
    enough = NEARLY_FIRST * max(gains, default=0.0)
    best: dict[tuple[str, ...], Trial] = {}
    for trial in ranked:
        # What the path took later is looked at again by itself (`revising`).
        if not set(trial.effects) & set(path.last.effects) and bic(plain.swing) - bic(trial.swing) > enough:
            best.setdefault(trial.effects, trial)
    return list(best.values())[:MOST_IN_PLACE_OF_THE_FIRST]


def _best(setup: Setup, paths: Sequence[Path]) -> Path:
    """The path that serves best, the first one if none does better by far."""
    best = paths[0]
    for path in paths[1:]:
        # What is more than the best one has was tried on top of it; the first of several beside nothing was not.
        more = bool(best.last.names) and set(best.last.names) < set(path.last.names)
        if not more and _serves_better(setup, path, best):
            best = path
    return best


def _serves_better(setup: Setup, one: Path, other: Path) -> bool:
    """Whether swings or whole records speak for one path against another by far, and the others do not against it."""
    by = _by_swings(one, other)
    if not setup.by_rotation:
        return by > 0
    if by > 0:
        return not explains_more(setup, other.whole, one.whole)
    if by < 0 or not explains_more(setup, one.whole, other.whole):
        return False
    # Whole records are rugged: the one that they would refuse is fitted to them from more starts first.
    return explains_more(setup, one.whole, whole_fit_from_many(setup, other.last, other.whole))


def _by_swings(one: Path, other: Path) -> int:
    """1 where swings speak for one path against another by far, -1 where for the other, 0 where for neither."""
    better, worse = sorted((one.last.swing, other.last.swing), key=bic)
    if bic(worse) - bic(better) <= PAYS * max(1.0, better.chi2 / max(better.samples, 1)):
        return 0
    return 1 if better is one.last.swing else -1


def _told(
    setup: Setup, chosen: Path, paths: Sequence[Path], greedy: Path, rounds: Sequence[Round]
) -> Path:  # fmt: skip
    """The path with the rounds of all, its own first, and what is to be said of those that were left."""
    names, said, refused = _named(chosen.last), list[str](), set[frozenset[str]]()
    for path in paths:
        its, mine = set(path.last.names), set(chosen.last.names)
        if its <= mine or mine <= its:
            continue
        if abs(bic(path.last.swing) - bic(chosen.last.swing)) < TWIN:
            alike = f"swings do not tell {_named(path.last)} from {names}"
            by_whole = setup.by_rotation and explains_more(setup, chosen.whole, path.whole)
            said.append(f"{alike}; whole records speak for the latter" if by_whole else alike)
        elif _by_swings(path, chosen) > 0 and setup.by_rotation and explains_more(setup, chosen.whole, path.whole):
            refused.add(frozenset(path.last.names))
            said.append(
                f"{_named(path.last)} would explain more of the swings than {names}; whole records speak against it"
            )
    left = greedy.trials[1] if greedy.last.names else greedy.last
    together = len(chosen.last.names) > 1 and not set(left.names) & set(chosen.last.names)
    if together and left is greedy.rounds[0].best and not any(_named(left) in text for text in said):
        said.append(f"{_named(left)} explains most by itself, {names} explain more together")
    own = []
    for k, tried in enumerate(chosen.rounds):
        everything = next(r for r in rounds if same(r.onto, tried.onto))
        own.append(_holding(everything, chosen.trials[k + 1]) if k + 1 < len(chosen.trials) else everything)
    others = [set_aside(r, refused) for r in rounds if not any(same(r.onto, mine.onto) for mine in own)]
    return replace(chosen, rounds=[*own, *others], said=tuple(dict.fromkeys(said)))


def _named(trial: Trial) -> str:
    return " with ".join(map(readable, trial.names))


def _merged(paths: Iterable[Path]) -> list[Round]:
    """All rounds, once each: of several on top of the same trial what was tried in any of them."""
    out: list[Round] = []
    for tried in (r for path in paths for r in path.rounds):
        k = next((i for i, known in enumerate(out) if same(known.onto, tried.onto)), None)
        if k is None:
            out.append(tried)
        elif out[k] is not tried:
            out[k] = replace(out[k].updated(tried), put_off=tried.put_off)
    return out


def _holding(tried: Round, trial: Trial) -> Round:
    """The round with this trial among what was tried, in the place of one of the same effects."""
    return replace(tried, trials=[*(t for t in tried.trials if t.names != trial.names), trial])


def _with_reason(tried: Round) -> Round:
    """The round; floors that were not tried on top of it say why."""
    left = (c for c in tried.put_off if tried.skipped.get(c.name) != NOT_OF_RELEASES)
    return replace(tried, skipped=tried.skipped | {c.name: NOT_ON_TOP for c in left})
