"""Tracing: which effect explains what the calibrated block leaves over.

From the calibrated baseline a score test ranks the smooth effects at one linearisation; those that may pay, and all
that have no derivative at nothing, are refitted in full over windows of one swing.  The best is added, and the search
goes on from there, until the next does not pay.  Effects that swings do not show, or show now and then, are
scanned on whole records (`studies.loop.whole.whole_records`).

Source   score (Lagrange multiplier) test: Rao (1948).
Status   thresholds `PAYS` and `LEAST_GAIN`; studies/loop_trials.py measures how often they find something in nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np

from studies.loop.fits.estimating import gains
from studies.loop.fits.fitting import Fit, fit
from studies.loop.fits.linearising import HUBER, objectives, residuals
from studies.loop.models.candidates import Candidate, candidates
from studies.loop.models.model import GRAVITY, MOUNTING, RESTITUTION, LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.windows import Window
from studies.loop.runs.simulation import Simulator

PAYS = 60.0
"""An effect has to lower chi-square by this many times max(1, chi-square per sample)."""

LEAST_GAIN = 0.03
"""And the weighted rms of whole records by this share, those aside that are lost with it and without it."""

SHORTLIST = 8
"""Smooth effects beyond this rank are refitted only if their score comes near that of the first."""

NEAR = 0.02
"""What near means: this share of the best score."""

SOME = 50
"""Windows on which starts are compared."""

SOME_COSTLY = 16
"""The same where a run takes long."""

MOST_COSTLY = 3
"""Candidates on top of a trial whose runs take long that are fitted to all windows: those that explain most on some."""

FURTHER_COSTLY = 4
"""Steps of a fit that is ended again where a run takes long: the search went to the end with those that come near."""

SCOUTED = 2
"""Starts of a candidate with scouts from which all of its parameters are fitted."""

ABOUT = np.linspace(-0.08, 0.08, 17)
"""Speeds over p times the slenderness angle from which a missed swing is tried again, about that of its peak."""

FEW_LOST = 0.1
"""Share of the windows up to which those that are missed are tried from such speeds: beyond, the model is wrong."""

NOTHING = 0.05
"""A gain on some of the windows below this share of `PAYS` promises nothing."""

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
"""A floor that leaves less than this share of what the best of all others leaves of some swings leads."""

NOT_NEEDED = "nothing over the noise; runs take long"
"""What others leave where such a floor is not tried at all."""

HOPEFUL, HOPEFUL_TO_LEAD = 0.3, 0.1
"""A candidate is fitted to the end if it leaves no more than this share of the best one's gain; the second if the best
alone is asked for."""

E = Parameter(RESTITUTION, 0.01, 0.02, 1.0)

G = Parameter(GRAVITY, 0.003, 9.76, 9.84)
"""Gravity as it is anywhere on Earth."""


@dataclass(frozen=True)
class Trial:
    """A set of effects, fitted."""

    names: tuple[str, ...]  # forms of the effects, in the order in which they were added
    parts: tuple[Candidate, ...]
    swing: Fit
    score: float = math.nan  # score of the last one added, before its refit
    calibrated: tuple[Parameter, ...] = (E,)  # what is fitted without any effect

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(part.effect for part in self.parts)

    @property
    def costly(self) -> bool:
        """Whether its runs take long."""
        return any(part.costly for part in self.parts)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All that is fitted of the effects."""
        return tuple(p for part in self.parts for p in part.parameters)

    @property
    def every(self) -> tuple[Parameter, ...]:
        """All that is fitted: of the calibration, then of the effects."""
        return (*self.calibrated, *self.parameters)

    def with_(self, part: Candidate, swing: Fit, score: float = math.nan) -> Trial:
        """The trial with one more effect, fitted."""
        return Trial((*self.names, part.name), (*self.parts, part), swing, score, self.calibrated_with(part))

    def calibrated_with(self, part: Candidate) -> tuple[Parameter, ...]:
        """What is calibrated once an effect is there: no restitution that follows from its parameters."""
        return tuple(p for p in self.calibrated if p.name != RESTITUTION or not part.replaces_restitution)


@dataclass
class Round:
    """One round of the search: what was tried on top of what."""

    onto: Trial
    trials: list[Trial] = field(default_factory=list)
    skipped: dict[str, str] = field(default_factory=dict)  # form of the effect: why it was not refitted
    scores: dict[str, float] = field(default_factory=dict)  # by form of the effect
    put_off: tuple[Candidate, ...] = ()  # of those skipped the ones that `search_costly` tries
    refused: tuple[Trial, ...] = ()  # what swings would have taken and whole records speak against
    begun: dict[str, _First] = field(default_factory=dict)  # by form: floors that were asked what they promise

    @property
    def tried(self) -> list[tuple[Trial, bool]]:
        """All that was tried, each with whether it was refused."""
        return [*((t, False) for t in self.trials), *((t, True) for t in self.refused)]

    def updated(self, later: Round) -> Round:
        """This round with what a later one on top of the same trial says of its candidates, of which it has a few."""
        known = {frozenset(t.names) for t, _ in later.tried}
        trials, refused = (
            [*new, *(t for t in old if frozenset(t.names) not in known)]
            for new, old in ((later.trials, self.trials), (later.refused, self.refused))
        )
        tried = {later.added(t).name for t, _ in later.tried}
        skipped = {form: why for form, why in self.skipped.items() if form not in tried}
        return replace(self, trials=trials, refused=tuple(refused), skipped=skipped, scores=self.scores | later.scores)

    def added(self, trial: Trial) -> Candidate:
        """What a trial of this round has beyond that on top of which it was tried."""
        return next(part for part in trial.parts if part.name not in self.onto.names)

    @property
    def best(self) -> Trial | None:
        """The trial with the smallest sum of squares, a little in favour of few parameters."""
        return min(self.trials, key=lambda t: bic(t.swing), default=None)


def bic(found: Fit) -> float:
    """Chi-square (less for windows far off) and the price of the parameters, ln(n) each."""
    return found.chi2 + len(found.parameters) * math.log(max(found.samples, 2))


def pays(without: Fit, found: Fit) -> bool:
    """Whether chi-square falls by enough to speak of an effect."""
    return without.chi2 - found.chi2 > PAYS * max(1.0, found.chi2 / max(found.samples, 1))


def baseline(simulator: Simulator, model: LoopModel, windows: Sequence[Window], *, gravity: bool = False) -> Trial:
    """Restitution, mounting angles and the states alone: what a careful engineer would calibrate anyway.

    gravity: whether the acceleration of gravity is fitted too, since accelerometers read it.
    """
    calibrated = (E, *(mounting(name) for name in model.mountings), *([G] if gravity else []))
    starts = sorted({model.restitution, 0.85, 0.93})
    fits = [fit(simulator, model.changed({RESTITUTION: e}), calibrated, windows) for e in starts]
    return Trial((), (), _with_lost_found(simulator, min(fits, key=lambda f: f.chi2)), calibrated=calibrated)


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
    """
    found = Round(onto)
    open_to_it = [c for c in pool if c.in_swings and (repeated or c.effect not in onto.effects)]
    found.scores |= _scores(simulator, onto, [c for c in open_to_it if c.smooth], some=leading)
    ranked = sorted(found.scores.items(), key=lambda item: -item[1])
    enough = NEAR * ranked[0][1] if ranked else 0.0
    chosen = {name for k, (name, score) in enumerate(ranked) if k < SHORTLIST or score > enough}
    for candidate in open_to_it:
        if candidate.smooth and candidate.name not in chosen:
            found.skipped[candidate.name] = f"score {found.scores.get(candidate.name, 0.0):.3g}"
    tried = [c for c in open_to_it if c.name not in found.skipped]
    _fitted(simulator, [c for c in tried if not c.costly], found, tell, leading)
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

    After a few steps it has to leave less of some swings than all that the round tried, and next to nothing or by far
    less than these (`LEADS`).
    """
    for floor in (c for c in found.put_off if c.beyond is None):
        before = found.begun.get(floor.after)
        if floor.after and (before is None or before.gained <= NOTHING * PAYS):
            continue
        tell(f"{floor.name}, on some swings")
        first = _on_some(simulator, found.onto, floor)
        if isinstance(first, str):
            continue
        found.begun[floor.name] = first
        chosen = _chosen(found.onto, floor)
        noise = sum(found.onto.swing.residuals[i].size - 2 for i in chosen)
        left = _of_some(found.onto.swing, chosen) - first.gained
        least = min(_of_some(t.swing, chosen) for t in (found.onto, *found.trials))
        if left < min(max(NEXT_TO_NOTHING * noise, LEADS * least), least - PAYS):
            return True
    return False


def _fitted(
    simulator: Simulator, candidates: Sequence[Candidate], found: Round, tell: Callable[[str], None],
    leading: bool = False,
) -> None:  # fmt: skip
    """Add trials with one of the candidates each to the round, or why there is none."""
    onto, firsts = found.onto, list[tuple[Candidate, _First]]()
    for candidate in candidates:
        promises = any(c.name == candidate.after and first.gained > NOTHING * PAYS for c, first in firsts)
        if not promises and any(c.name == candidate.after for c in candidates):
            found.skipped[candidate.name] = found.skipped.get(candidate.after, f"{candidate.after} promises nothing")
            continue
        tell(candidate.name)
        first = found.begun.get(candidate.name) or _on_some(simulator, onto, candidate)
        if isinstance(first, str):
            found.skipped[candidate.name] = first
        else:
            firsts.append((candidate, first))
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
    begun = [(candidate, _on_all(simulator, onto, candidate, first)) for candidate, first in firsts]
    lowest = min((t.swing.chi2 for t in found.trials), default=math.inf)
    ended = _ended(simulator, onto, begun, tell, lowest, HOPEFUL_TO_LEAD if leading else HOPEFUL)
    found.trials += [onto.with_(c, swing, found.scores.get(c.name, math.nan)) for c, swing in ended]


def _promising(onto: Trial, firsts: Sequence[tuple[Candidate, _First]], found: Round) -> list[tuple[Candidate, _First]]:
    """Those of them that may explain as much as others, of which the round holds some; it is told of the rest."""
    if onto.costly or not any(c.costly for c, _ in firsts):
        return list(firsts)
    chosen = _chosen(onto, next(c for c, _ in firsts if c.costly))
    before, *there = (_of_some(t.swing, chosen) for t in (onto, *found.trials))
    least = UNPROMISING * max(0.0, *(before - left for left in there), *(f.gained for c, f in firsts if c.costly))
    kept = []
    for candidate, first in firsts:
        if candidate.costly and first.gained < least:
            found.skipped[candidate.name] = FAR_LESS
        else:
            kept.append((candidate, first))
    return kept


def _of_some(found: Fit, chosen: Sequence[int]) -> float:
    """Chi-square of some windows, less for those far off."""
    some = [found.windows[i] for i in chosen]
    return float(objectives(found.model, [found.residuals[i] for i in chosen], some, HUBER).sum())


def _scores(simulator: Simulator, onto: Trial, smooth: Sequence[Candidate], some: bool = False) -> dict[str, float]:
    """Of each candidate; infinite where it cannot be had at nothing: only a refit can tell.

    some: whether the windows on which starts are compared are enough.
    """
    fitted = onto.swing
    if some:
        chosen = _every_so_many(len(fitted.windows), SOME)
        fitted = replace(
            fitted,
            windows=tuple(fitted.windows[i] for i in chosen),
            residuals=tuple(fitted.residuals[i] for i in chosen),
        )
    models: dict[str, LoopModel] = {}
    for c in smooth:
        with suppress(ValueError):
            models[c.name] = onto.swing.model.changed(_nothing(onto, c))
    found = gains(simulator, fitted, {c.name: c.parameters for c in smooth if c.name in models}, models)
    return {c.name: found.get(c.name, math.inf) for c in smooth}


def _nothing(onto: Trial, candidate: Candidate) -> dict[str, float]:
    """Parameters of the candidate at which it adds nothing to a trial, within their bounds.

    A span over which nothing changes has none of its own there.
    """
    declared = onto.swing.model.declared
    found = candidate.nothing(declared) if candidate.effect in onto.effects else candidate.absent(declared)
    return found | {p.name: min(max(found[p.name], p.low), p.high) for p in candidate.parameters}


@dataclass(frozen=True)
class _First:
    """The best start of a candidate on some of the windows."""

    model: LoopModel
    parameters: tuple[Parameter, ...]
    gained: float  # by how much chi-square of these windows fell


def _on_some(simulator: Simulator, onto: Trial, candidate: Candidate) -> _First | str:
    """The best of the fits from all starts after a few steps, or why there is none."""
    chosen = _chosen(onto, candidate)
    some = [onto.swing.windows[i] for i in chosen]
    parameters = (*onto.calibrated_with(candidate), *onto.parameters, *candidate.parameters)
    scouts = tuple(p for p in candidate.parameters if p.name in candidate.scouts)
    begun: list[Fit] = []
    reason = "no start led anywhere"
    nothing = _nothing(onto, candidate)
    starts: list[_Start] = []
    for start in (*candidate.starts, *([nothing] if candidate.smooth else [])):
        try:
            model = onto.swing.model.changed({**candidate.fixed, **start})
            starts.append((model, *((some, 0.0) if candidate.smooth else _afresh(simulator, model, some))))
        except ValueError as refusal:
            reason = str(refusal)
    apart: list[_Start] = []
    if candidate.screened:
        apart = _best_of_parts(starts, candidate.parts)
        starts = sorted(starts, key=lambda start: start[2])[: candidate.screened]
        apart = [start for start in apart if all(start is not other for other in starts)]
    for model, windows, _ in starts:
        try:
            begun.append(fit(simulator, model, scouts or parameters, windows, iterations=2 if scouts else 3))
        except ValueError as refusal:
            reason = str(refusal)
    begun.sort(key=lambda f: f.chi2)
    if scouts:
        starts = [(f.model, f.windows, f.chi2) for f in begun[:SCOUTED]]
        begun = []
        for model, windows, _ in (*starts, *apart):
            try:
                begun.append(fit(simulator, model, parameters, windows, iterations=3))
            except ValueError as refusal:
                reason = str(refusal)
    if not begun:
        return reason
    best = min(begun, key=lambda f: f.chi2)
    return _First(best.model, parameters, _of_some(onto.swing, chosen) - best.chi2)


_Start = tuple[LoopModel, Sequence[Window], float]
"""A model, the windows from where it fits them better as it is, and what it leaves of them."""


def _best_of_parts(starts: Sequence[_Start], parts: int) -> list[_Start]:
    """Of so many parts of the starts, in their order, that which leaves least."""
    each = np.array_split(np.arange(len(starts)), parts) if parts else []
    return [min((starts[i] for i in map(int, part)), key=lambda start: start[2]) for part in each if part.size]


def _chosen(onto: Trial, candidate: Candidate) -> list[int]:
    """Windows on which the starts of a candidate are compared: every so many of them.

    Of one that acts in few of them, those of which the trial leaves most beyond noise: no others hold much to explain.
    """
    windows = onto.swing.windows
    some_of = SOME_COSTLY if candidate.costly or onto.costly else SOME
    if not candidate.slips:
        return _every_so_many(len(windows), some_of)
    left = objectives(onto.swing.model, onto.swing.residuals, windows, HUBER) - [r.size for r in onto.swing.residuals]
    return sorted(int(i) for i in np.argsort(-left, kind="stable")[:some_of])


def _every_so_many(count: int, some: int) -> list[int]:
    return list(range(0, count, max(1, count // some)))


def _on_all(simulator: Simulator, onto: Trial, candidate: Candidate, first: _First) -> Fit:
    """The candidate fitted to all windows by a few steps from its best start."""
    whole = onto.swing.windows
    if not candidate.smooth:
        whole = tuple(_afresh(simulator, first.model, whole)[0])
    promising = first.gained > NOTHING * PAYS
    return fit(simulator, first.model, first.parameters, whole, iterations=4 if promising else 1)


def _afresh(simulator: Simulator, model: LoopModel, windows: Sequence[Window]) -> tuple[list[Window], float]:
    """The windows, each from the state that the record shows where the model fits better from there, and chi-square.

    A model that lacks an effect bends the states to what it can do; they are then no place to try the effect from.
    """
    seen = [_as_seen(model, w) for w in windows]
    fitted, plain = (objectives(model, residuals(simulator, model, each), each, HUBER) for each in (windows, seen))
    states = [s if b < a else w for w, s, a, b in zip(windows, seen, fitted, plain, strict=True)]
    return states, float(np.minimum(fitted, plain).sum())


def _as_seen(model: LoopModel, window: Window) -> Window:
    """The window from the state that the record shows, as the model takes its sensor; as it is where there is none."""
    if window.seen is None:
        return window
    theta = model.peak(window.seen.theta)
    if not math.isfinite(theta):
        return window
    return window.moved(theta, window.seen.omega / float(model.reading_slope(theta)))


def _ended(
    simulator: Simulator,
    onto: Trial,
    begun: Sequence[tuple[Candidate, Fit]],
    tell: Callable[[str], None],
    before: float,
    hopeful: float = HOPEFUL,
) -> list[tuple[Candidate, Fit]]:
    """The candidates with their fits, those that come near the best of all until they converge.

    before: the lowest chi-square of candidates that were fitted before.
    hopeful: what near is, of the best one's gain.
    """
    lowest = min([first.chi2 for _, first in begun] + [before])
    near = lowest + max(hopeful * (onto.swing.chi2 - lowest), PAYS)
    out = []
    for candidate, first in begun:
        if first.chi2 > near:
            out.append((candidate, first))
            continue
        swing = first
        if not first.converged:
            tell(f"{candidate.name}, to the end")
            further = fit(simulator, first.model, first.parameters, first.windows, iterations=12)
            swing = further if further.chi2 <= first.chi2 else first
        out.append((candidate, _with_lost_found(simulator, swing)))
    return out


def _with_lost_found(simulator: Simulator, found: Fit) -> Fit:
    """The fit with windows that are missed by far begun again from the states that the record shows.

    Without the effect their states were bent to what the block could do, and some stay in a minimum of their own.  A
    peak of few samples may seem to move so fast that a fit from there ends on the other side of an impact: what is told
    of a peak for certain is that the block stands still there.  A block that all but stops upright in the middle of a
    swing goes on or back by a little speed more or less, which a flat peak does not tell: where few windows are missed
    these begin from the best of several, too.
    """
    lost = np.flatnonzero(found.by_window > HUBER)
    if not lost.size:
        return found
    there = [found.windows[i] for i in lost]
    windows, best = there, objectives(found.model, [found.residuals[i] for i in lost], there, HUBER)
    seen = [_as_seen(found.model, w) for w in there]
    begun = [seen, [w.moved(w.theta, 0.0) for w in seen]]
    if lost.size <= max(1.0, FEW_LOST * len(found.windows)):
        begun.append(_from_the_best_speed(simulator, found.model, seen))
    for starts in begun:
        again = fit(simulator, found.model, [], starts, iterations=8)
        now = objectives(again.model, again.residuals, again.windows, HUBER)
        windows = [new if a < b else old for old, new, a, b in zip(windows, again.windows, now, best, strict=True)]
        best = np.minimum(best, now)
    if windows == there:
        return found
    every = list(found.windows)
    for i, window in zip(lost, windows, strict=True):
        every[i] = window
    whole = fit(simulator, found.model, found.parameters, every, iterations=6)
    return whole if whole.chi2 < found.chi2 else found


def _from_the_best_speed(simulator: Simulator, model: LoopModel, windows: Sequence[Window]) -> list[Window]:
    """The windows, each from that of the speeds about its own (`ABOUT`) from which the model fits best."""
    p_alpha = model.declared.p() * model.declared.alpha
    moved = [[w.moved(w.theta, w.omega + float(share) * p_alpha) for w in windows] for share in ABOUT]
    left = np.array([objectives(model, residuals(simulator, model, each), each, HUBER) for each in moved])
    return [moved[k][i] for i, k in enumerate(np.argmin(left, axis=0))]


def all_candidates(model: LoopModel, friction: float | None = None) -> tuple[Candidate, ...]:
    """Everything that the loop can try on this block; its friction [1] where that is declared."""
    return candidates(model.declared, friction)
