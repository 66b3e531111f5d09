"""Effects that single swings do not show, or only hint at, looked for in whole records.

Whole records are rugged: a small difference grows with every impact.  So they are asked only where swings say nothing,
while they are predictable, and from several starts.

Status   planted effects that swings only hint at are traced (studies/loop_trials.py)
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from studies.loop.candidates import Candidate
from studies.loop.fitting import Fit, fit
from studies.loop.preparing import Setup
from studies.loop.rivals import Rival
from studies.loop.scoring import errors
from studies.loop.settling import neighbours, predictable, whole_fit
from studies.loop.tracing import PAYS, Round, Trial, bic

LEAST_OF_A_SCAN = 0.15
"""Share by which an effect that whole records alone show has to lower their rms: their sums of squares are rugged."""

MISSED = 1.3
"""Rms of whole records over their noise from which they are asked about effects that swings only hint at."""

HINT = 6.0
"""What such an effect lowers the criterion of the swings by, at the least: odds of exp(3)."""

MOST_HINTS = 3
"""So many of them are fitted to whole records."""

STARTS = 7
"""Starts of such a fit."""

SPOILT = 1.5
"""A record is spoilt by an effect that makes its rms so many times larger."""

TELLING = 3
"""Records on which the starts are compared."""


def scan(setup: Setup, onto: Trial, whole: Fit, pool: Sequence[Candidate]) -> Trial | None:
    """The best of the effects that whole records alone show, or None if it does not pay.

    Such an effect acts at lift-off; its sum of squares is rugged, so that it is scanned over its range first.
    """
    best: tuple[float, Candidate, dict[str, float]] | None = None
    for candidate in pool:
        if candidate.in_swings or candidate.effect in onto.effects:
            continue
        for start in candidate.starts:
            try:
                model = whole.model.changed(start)
                found = fit(setup.simulator, model, [], whole.windows, huber=10.0, iterations=2)
            except ValueError:
                break  # it does not go together with what is there already
            if best is None or found.chi2 < best[0]:
                best = (found.chi2, candidate, dict(start))
    if best is None or whole.chi2 - best[0] < PAYS * max(1.0, best[0] / whole.samples):
        return None
    _, candidate, start = best
    ended = fit(
        setup.simulator, whole.model.changed(start), candidate.parameters, whole.windows, huber=10.0, iterations=8
    )
    # What a fit of the same records from here gains without the effect is not its own.
    absent = {p.name: candidate.absent(onto.swing.model.declared)[p.name] for p in candidate.parameters}
    without = fit(setup.simulator, ended.model.changed(absent), onto.every, ended.windows, huber=10.0, iterations=8)
    if without.chi2 - ended.chi2 < PAYS * max(1.0, ended.chi2 / whole.samples):
        return None
    value = {p.name: ended.model.get(p.name) for p in candidate.parameters}
    swing = fit(setup.simulator, onto.swing.model.changed(value), onto.every, onto.swing.windows, iterations=3)
    return onto.with_(candidate, swing)


def hints(onto: Trial, tried: Round) -> list[Trial]:
    """The trials of a round that swings hint at, the strongest hints first."""
    likely = [t for t in tried.trials if t.parts[-1].in_swings and bic(t.swing) < bic(onto.swing) - HINT]
    return sorted(likely, key=lambda t: bic(t.swing))[:MOST_HINTS]


def hinted(setup: Setup, onto: Trial, whole: Fit, tried: Round) -> tuple[Rival, ...]:
    """Of the effects that swings only hint at, those that whole records confirm, the best first.

    An effect may be too small for a swing and yet turn the end of a record.  Records are compared while they are
    predictable, and one that is lost altogether counts less (Huber).
    """
    windows = predictable(whole.windows)
    if whole.rms < MISSED or not windows:
        return ()
    without = fit(setup.simulator, whole.model, onto.every, windows, huber=10.0, iterations=8, central=True)
    # The records that are missed most tell the starts apart.
    telling = np.sort(np.argsort(-without.by_window)[:TELLING])
    some = [windows[i] for i in telling]
    found = []
    for trial in hints(onto, tried):
        begun = [
            fit(setup.simulator, model, trial.every, some, huber=10.0, iterations=4, central=True)
            for model in neighbours(trial.swing, trial.parts[-1].parameters[0], STARTS)
        ]
        if not begun:
            continue
        nearest, states = min(begun, key=lambda f: f.chi2), list(windows)
        for i, window in zip(telling, nearest.windows, strict=True):
            states[i] = window
        own = fit(setup.simulator, nearest.model, trial.every, states, huber=10.0, iterations=12, central=True)
        if own.chi2 < (1.0 - LEAST_OF_A_SCAN) ** 2 * without.chi2 and not _at_the_cost_of_others(own, without):
            swings = fit(setup.simulator, own.model, [], onto.swing.windows, iterations=3).windows
            # As whole records have it: how far the swings would let it go is what they say of it.
            swing = fit(setup.simulator, own.model, trial.every, swings, iterations=0)
            settled = onto.with_(trial.parts[-1], swing)
            ended = whole_fit(setup, settled, whole)
            held = errors(setup, ended.model, ended.windows).holdout
            found.append(Rival(settled, ended, bic(own), bic(ended), held))
    return tuple(sorted(found, key=lambda r: r.criterion))


def _at_the_cost_of_others(own: Fit, without: Fit) -> bool:
    """Whether an effect that helps some records spoils others: what really acts does not."""
    return bool(np.any((own.by_window > MISSED) & (own.by_window > SPOILT * without.by_window)))
