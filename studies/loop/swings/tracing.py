"""Tracing: which effect explains what the calibrated block leaves over.

From the calibrated baseline a score test ranks the smooth effects at one linearisation; those that may pay, and all
that have no derivative at nothing, are refitted in full over windows of one swing.  The best is added, and the search
goes on from there, until the next does not pay.  Effects that swings do not show, or show now and then, are
scanned on whole records (`studies.loop.whole.whole_records`).

Source   score (Lagrange multiplier) test: Rao (1948).
Status   studies/loop_trials.py measures how often it finds what is there, and how often something in nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial

from studies.loop.fits.estimating import gains
from studies.loop.fits.fitting import fit
from studies.loop.models.candidates import Candidate, candidates
from studies.loop.models.model import GRAVITY, MOUNTING, RESTITUTION, LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.windows import Window
from studies.loop.runs.at_once import at_once
from studies.loop.runs.simulation import Simulator
from studies.loop.swings.lost_windows import with_lost_found
from studies.loop.swings.trials import FURTHER_COSTLY, PAYS, E, First, Round, Trial
from studies.loop.swings.trying import (
    HOPEFUL,
    HOPEFUL_TO_LEAD,
    NOTHING,
    SOME,
    chosen_for,
    every_so_many,
    nothing_of,
    of_some,
    on_all,
    on_some,
    to_the_end,
)

SHORTLIST = 8
"""Smooth effects beyond this rank are refitted only if their score comes near that of the first."""

NEAR = 0.02
"""What near means: this share of the best score."""

TOO_LITTLE = 0.1
"""Of what nothing but chance is left of, a score is what a refit gains: below this share of `PAYS` it is neither an
effect nor a hint of one."""

FEW = 3
"""So many of those are refitted nonetheless, the first by their scores: whole records may be asked for them."""

NOTHING_OF_SOME = "explains nothing of some swings, of which no more is left than chance leaves"
"""Why what has no score goes no further there."""

MOST_COSTLY = 3
"""Candidates on top of a trial whose runs take long that are fitted to all windows: those that explain most on some."""

UNPROMISING = 0.1
"""A candidate whose runs take long goes no further if it explains less than this share of what others explain of some
swings."""

FAR_LESS = "far less of some swings is explained than by others; runs take long"
"""Why a floor that gives goes no further (`UNPROMISING`)."""

LEADING = 0.5
"""Where the best candidate alone is asked for, those are fitted to all windows that explain this share of what the best
one does of some, or come as near to it as `PAYS`."""

BEHIND = "far less of some swings is explained than by the best"
"""Why others are not."""

NEXT_TO_NOTHING = 1.2
"""What a floor that gives leaves of some swings after a few steps, over what noise does, if it may leave nothing."""

LEADS = 1.0 / 3.0
"""A floor that leaves less than this share of what the best of all others leaves leads."""

NOT_NEEDED = "nothing over the noise; runs take long"
"""What others leave where such a floor is not tried at all."""

G = Parameter(GRAVITY, 0.003, 9.76, 9.84)
"""Gravity as it is anywhere on Earth."""


def baseline(simulator: Simulator, model: LoopModel, windows: Sequence[Window], *, gravity: bool = False) -> Trial:
    """Restitution, mounting angles and the states alone: what a careful engineer would calibrate anyway.

    gravity: whether the acceleration of gravity is fitted too, since accelerometers read it.
    """
    calibrated = (E, *(mounting(name) for name in model.mountings), *([G] if gravity else []))
    starts = sorted({model.restitution, 0.85, 0.93})
    fits = at_once([partial(fit, simulator, model.changed({RESTITUTION: e}), calibrated, windows) for e in starts])
    return Trial((), (), with_lost_found(simulator, min(fits, key=lambda f: f.chi2)), calibrated=calibrated)


def mounting(channel: str) -> Parameter:
    """The mounting angle of an accelerometer as something to fit."""
    return Parameter(f"{MOUNTING}.{channel}", 0.01, -0.5, 0.5)


def search(
    simulator: Simulator,
    onto: Trial,
    pool: Sequence[Candidate],
    tell: Callable[[str], None] = lambda text: None,
    repeated: bool = False,
    explained: Callable[[Trial], bool] = lambda trial: False,
    later: bool = False,
    leading: bool = False,
    by_chance: bool = False,
) -> Round:
    """Refit every candidate that may pay on top of a trial, those that lead nowhere not to the end.

    All starts are tried on some of the windows, the best of each candidate on all of them, and those that come near the
    best of all are fitted until they converge.  Where runs take long, a few candidates alone get beyond the first step.

    repeated: whether an effect that is there already may be tried in another form.
    explained: whether a trial leaves nothing over its noise; candidates whose runs take long, and which have more
        parameters than most, are put off where the trial or a cheaper candidate does so (`search_costly` tries them).
    later: whether they are put off in any case.
    leading: whether the best alone is asked for; some windows are enough for scores then, and candidates that are far
        behind on these go no further.
    by_chance: whether the trial leaves no more of swings than chance does; then scores say what refits gain, and what
        is far from paying is not refitted, but for the first few.
    """
    found = Round(onto)
    open_to_it = [c for c in pool if c.in_swings and (repeated or c.effect not in onto.effects)]
    found.scores |= _scores(simulator, onto, [c for c in open_to_it if c.smooth], some=leading)
    ranked = sorted(found.scores.items(), key=lambda item: -item[1])
    enough = NEAR * ranked[0][1] if ranked else 0.0
    at_least, enough = (FEW, max(enough, TOO_LITTLE * PAYS)) if by_chance else (SHORTLIST, enough)
    chosen = {name for k, (name, score) in enumerate(ranked) if k < at_least or score > enough}
    for candidate in open_to_it:
        if candidate.smooth and candidate.name not in chosen:
            found.skipped[candidate.name] = f"score {found.scores.get(candidate.name, 0.0):.3g}"
    tried = [c for c in open_to_it if c.name not in found.skipped]
    _fitted(simulator, [c for c in tried if not c.costly], found, tell, leading, by_chance)
    found.put_off = tuple(c for c in tried if c.costly)
    already = next((t for t in (onto, *found.trials) if found.put_off and explained(t)), None)
    if already is not None:
        by = f"the fit of {already.names[-1]} leaves" if already.names else "the fit leaves"
    elif later:
        by = "effects that were found after this round leave"
    else:
        search_costly(simulator, found, tell, explained)
        return found
    found.skipped |= {c.name: f"{by} {NOT_NEEDED}" for c in found.put_off}
    return found


def search_costly(
    simulator: Simulator, found: Round, tell: Callable[[str], None] = lambda text: None,
    explained: Callable[[Trial], bool] = lambda trial: False,
) -> list[Trial]:  # fmt: skip
    """Add to a round the candidates that it put off; the trials of these.

    explained: whether a trial leaves nothing over its noise; what is beyond the effect in it is then not tried.
    """
    candidates, found.put_off = found.put_off, ()
    for c in candidates:
        found.skipped.pop(c.name, None)
    before = len(found.trials)
    _fitted(simulator, [c for c in candidates if c.beyond is None], found, tell)
    further = []
    for c in candidates:
        if c.beyond is None:
            continue
        name, most = c.beyond
        softer = (
            t for t in found.trials[before:]
            if (form := found.added(t).name) in most and t.swing.model.get(name) <= most[form]
        )  # fmt: skip
        known = next((t for t in softer if explained(t)), None)
        if known is None:
            further.append(c)
        else:
            found.skipped[c.name] = f"the fit of {found.added(known).name} leaves {NOT_NEEDED}"
    _fitted(simulator, further, found, tell)
    for c in further:
        _by_its_name(simulator, found, c, found.trials[before:])
    return found.trials[before:]


def _by_its_name(simulator: Simulator, found: Round, c: Candidate, trials: Sequence[Trial]) -> None:
    """Have a candidate begin from what was found beyond what another name stands for, too, and come before it.

    Its own starts may all lead to another minimum.
    """
    if c.same_as is None or c.beyond is None:
        return
    onto, (name, most) = found.onto, c.beyond
    forms = [(t, form) for t in trials if (form := found.added(t)).name in most]
    for t, form in forms:
        if t.swing.model.get(name) <= most[form.name]:
            continue
        same = c.same_as(t.swing.model)
        if any(not p.low <= same[p.name] <= p.high for p in c.parameters):
            continue
        effects = {effect: values for effect, values in t.swing.model.effects.items() if effect != form.effect}
        model = replace(t.swing.model, effects=effects).changed({**c.fixed, **same})
        parameters = (*onto.calibrated_with(c), *onto.parameters, *c.parameters)
        swing = fit(simulator, model, parameters, t.swing.windows, iterations=FURTHER_COSTLY)
        own = next((o for o in found.trials if found.added(o).name == c.name), None)
        if own is not None and own.swing.chi2 <= swing.chi2:
            continue
        found.skipped.pop(c.name, None)
        others = [o for o in found.trials if o is not own]
        at = next(i for i, o in enumerate(others) if o is t)
        found.trials[:] = [*others[:at], onto.with_(c, swing), *others[at:]]


def floor_promises(simulator: Simulator, found: Round, tell: Callable[[str], None] = lambda text: None) -> bool:
    """Whether a floor that gives may explain all by itself, of those that a round put off, or most: corners, or a bed.

    After a few steps it has to leave less of some swings than all that the round tried, and next to nothing or, of what
    is over the noise, by far less than these (`LEADS`).
    """
    for floor in (c for c in found.put_off if c.beyond is None):
        before = found.begun.get(floor.after)
        if floor.after and (before is None or before.gained <= NOTHING * PAYS):
            continue
        tell(f"{floor.name}, on some swings")
        first = on_some(simulator, found.onto, floor)
        if isinstance(first, str):
            continue
        found.begun[floor.name] = first
        chosen = chosen_for(found.onto, floor)
        noise = sum(found.onto.swing.residuals[i].size - 2 for i in chosen)
        left = of_some(found.onto.swing, chosen) - first.gained
        least = min(of_some(t.swing, chosen) for t in (found.onto, *found.trials))
        if left < min(max(NEXT_TO_NOTHING * noise, noise + LEADS * (least - noise)), least - PAYS):
            return True
    return False


def _fitted(
    simulator: Simulator, candidates: Sequence[Candidate], found: Round, tell: Callable[[str], None],
    leading: bool = False, by_chance: bool = False,
) -> None:  # fmt: skip
    """Add trials with one of the candidates each to the round, or why there is none."""
    onto = found.onto
    firsts = _begun(simulator, candidates, found, tell)
    if by_chance:
        found.skipped |= {
            c.name: NOTHING_OF_SOME for c, first in firsts if not c.smooth and first.gained <= NOTHING * PAYS
        }
        firsts = [(c, first) for c, first in firsts if c.name not in found.skipped]
    firsts = _promising(onto, firsts, found)
    if leading and firsts:
        most = max(first.gained for _, first in firsts)
        found.skipped |= {c.name: BEHIND for c, first in firsts if first.gained < min(LEADING * most, most - PAYS)}
        firsts = [(c, first) for c, first in firsts if c.name not in found.skipped]
    if onto.costly:
        firsts.sort(key=lambda pair: -pair[1].gained)
        for candidate, _ in firsts[MOST_COSTLY:]:
            found.skipped[candidate.name] = f"{MOST_COSTLY} others explain more of some windows; runs take long"
        firsts = firsts[:MOST_COSTLY]
    fits = at_once([partial(on_all, simulator, onto, candidate, first) for candidate, first in firsts])
    begun = [(candidate, swing) for (candidate, _), swing in zip(firsts, fits, strict=True)]
    lowest = min((t.swing.chi2 for t in found.trials), default=math.inf)
    swings = to_the_end(simulator, onto, begun, tell, lowest, HOPEFUL_TO_LEAD if leading else HOPEFUL)
    found.trials += [onto.with_(c, swing, found.scores.get(c.name, math.nan)) for c, swing in swings]


def _begun(
    simulator: Simulator, candidates: Sequence[Candidate], found: Round, tell: Callable[[str], None]
) -> list[tuple[Candidate, First]]:  # fmt: skip
    """The candidates that lead somewhere on some windows, in their order; the round is told why others do not.

    What takes another form of what went before waits for that, and goes no further where that promises nothing.
    """

    def some(candidate: Candidate) -> First | str:
        tell(candidate.name)
        return found.begun.get(candidate.name) or on_some(simulator, found.onto, candidate)

    answers = dict[str, First | str]()
    names, waiting = {c.name for c in candidates}, list(candidates)
    while waiting:
        now = [c for c in waiting if c.after not in names or c.after in answers]
        waiting = [c for c in waiting if all(c is not other for other in now)]
        for c in now:
            before = answers.get(c.after)
            if isinstance(before, str):
                answers[c.name] = before
            elif before is not None and before.gained <= NOTHING * PAYS:
                answers[c.name] = f"{c.after} promises nothing"
        asked = [c for c in now if c.name not in answers]
        found_of = at_once([partial(some, c) for c in asked])
        answers |= {c.name: answer for c, answer in zip(asked, found_of, strict=True)}
    found.skipped |= {name: answer for name, answer in answers.items() if isinstance(answer, str)}
    return [(c, first) for c in candidates if not isinstance(first := answers[c.name], str)]


def _promising(onto: Trial, firsts: Sequence[tuple[Candidate, First]], found: Round) -> list[tuple[Candidate, First]]:
    """Those of them that may explain as much as others, of which the round holds some; it is told of the rest."""
    if onto.costly or not any(c.costly for c, _ in firsts):
        return list(firsts)
    chosen = chosen_for(onto, next(c for c, _ in firsts if c.costly))
    before, *there = (of_some(t.swing, chosen) for t in (onto, *found.trials))
    least = UNPROMISING * max(0.0, *(before - left for left in there), *(f.gained for c, f in firsts if c.costly))
    kept = []
    for candidate, first in firsts:
        if candidate.costly and first.gained < least:
            found.skipped[candidate.name] = FAR_LESS
        else:
            kept.append((candidate, first))
    return kept


def _scores(simulator: Simulator, onto: Trial, smooth: Sequence[Candidate], some: bool = False) -> dict[str, float]:
    """Of each candidate; infinite where it cannot be had at nothing: only a refit can tell.

    some: whether the windows on which starts are compared are enough.
    """
    fitted = onto.swing
    if some:
        fitted = fitted.of(every_so_many(len(fitted.windows), SOME))
    models: dict[str, LoopModel] = {}
    for c in smooth:
        with suppress(ValueError):
            models[c.name] = onto.swing.model.changed(nothing_of(onto, c))
    found = gains(simulator, fitted, {c.name: c.parameters for c in smooth if c.name in models}, models)
    return {c.name: found.get(c.name, math.inf) for c in smooth}


def all_candidates(model: LoopModel, friction: float | None = None) -> tuple[Candidate, ...]:
    """Everything that the loop can try on this block; its friction [1] where that is declared."""
    return candidates(model.declared, friction)
