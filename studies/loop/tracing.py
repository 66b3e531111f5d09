"""Tracing: which effect explains what the calibrated block leaves over.

From the calibrated baseline a score test ranks the smooth effects at one linearisation; those that may pay, and all
that have no derivative at nothing, are refitted in full over windows of one swing.  The best is added, and the search
goes on from there, until the next does not pay.  Effects that swings do not show are scanned on whole records.

Source   score (Lagrange multiplier) test: Rao (1948).
Status   thresholds `PAYS` and `LEAST_GAIN`; benchmarks/loop.py measures how often they find something in nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from studies.loop.candidates import Candidate, candidates
from studies.loop.fitting import Fit, Parameter, fit, gains
from studies.loop.model import RESTITUTION, LoopModel
from studies.loop.simulation import Simulator
from studies.loop.windows import Window

PAYS = 60.0
"""An effect has to lower chi-square by this many times max(1, chi-square per sample)."""

LEAST_GAIN = 0.03
"""And the weighted rms of whole records by this share."""

SHORTLIST = 8
"""Smooth effects beyond this rank are refitted only if their score comes near that of the first."""

NEAR = 0.02
"""What near means: this share of the best score."""

E = Parameter(RESTITUTION, 0.01, 0.02, 1.0)


@dataclass(frozen=True)
class Trial:
    """A set of effects, fitted."""

    names: tuple[str, ...]  # forms of the effects, in the order in which they were added
    parts: tuple[Candidate, ...]
    swing: Fit
    score: float = math.nan  # score of the last one added, before its refit

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(part.effect for part in self.parts)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All that is fitted but restitution."""
        return tuple(p for part in self.parts for p in part.parameters)


@dataclass
class Round:
    """One round of the search: what was tried on top of what."""

    onto: Trial
    trials: list[Trial] = field(default_factory=list)
    skipped: dict[str, str] = field(default_factory=dict)  # form of the effect: why it was not refitted

    @property
    def best(self) -> Trial | None:
        """The trial with the smallest sum of squares, a little in favour of few parameters."""
        return min(self.trials, key=lambda t: bic(t.swing), default=None)


def bic(found: Fit) -> float:
    """Chi-square (Huber's) and the price of the parameters, ln(n) each."""
    return found.chi2 + len(found.parameters) * math.log(max(found.samples, 2))


def pays(without: Fit, found: Fit) -> bool:
    """Whether chi-square falls by enough to speak of an effect."""
    return without.chi2 - found.chi2 > PAYS * max(1.0, found.chi2 / max(found.samples, 1))


def baseline(simulator: Simulator, model: LoopModel, windows: Sequence[Window]) -> Trial:
    """Restitution and the states alone: what a careful engineer would calibrate anyway."""
    starts = sorted({model.restitution, 0.85, 0.93})
    fits = [fit(simulator, model.changed({RESTITUTION: e}), [E], windows) for e in starts]
    return Trial((), (), min(fits, key=lambda f: f.chi2))


def search(
    simulator: Simulator,
    onto: Trial,
    pool: Sequence[Candidate],
    tell: Callable[[str], None] = lambda text: None,
    repeated: bool = False,
) -> Round:
    """Refit every candidate that may pay on top of a trial.

    repeated: whether an effect that is there already may be tried in another form.
    """
    found = Round(onto)
    open_to_it = [c for c in pool if c.in_swings and (repeated or c.effect not in onto.effects)]
    scores = _scores(simulator, onto, [c for c in open_to_it if c.smooth])
    ranked = sorted(scores.items(), key=lambda item: -item[1])
    enough = NEAR * ranked[0][1] if ranked else 0.0
    chosen = {name for k, (name, score) in enumerate(ranked) if k < SHORTLIST or score > enough}
    for candidate in open_to_it:
        if candidate.smooth and candidate.name not in chosen:
            found.skipped[candidate.name] = f"score {scores.get(candidate.name, 0.0):.3g}"
            continue
        tell(candidate.name)
        best = _refitted(simulator, onto, candidate)
        if isinstance(best, str):
            found.skipped[candidate.name] = best
        else:
            trial = Trial(
                (*onto.names, candidate.name), (*onto.parts, candidate), best, scores.get(candidate.name, math.nan)
            )
            found.trials.append(trial)
    return found


def _scores(simulator: Simulator, onto: Trial, smooth: Sequence[Candidate]) -> dict[str, float]:
    model = onto.swing.model
    out: dict[str, float] = {}
    for c in smooth:
        try:
            with_it = model.changed(c.absent(model.declared) if c.effect not in onto.effects else c.nothing)
            out |= gains(simulator, onto.swing, {c.name: c.parameters}, {c.name: with_it})
        except ValueError:
            out[c.name] = math.inf  # it cannot be had at nothing: only a refit can tell
    return out


def _refitted(simulator: Simulator, onto: Trial, candidate: Candidate) -> Fit | str:
    """The best of the fits from all starts, or why there is none."""
    best: Fit | None = None
    reason = "no start led anywhere"
    parameters = [E, *onto.parameters, *candidate.parameters]
    for start in candidate.starts:
        try:
            found = fit(
                simulator, onto.swing.model.changed({**candidate.fixed, **start}), parameters, onto.swing.windows,
                iterations=12, give_up=2.0 * onto.swing.chi2,
            )  # fmt: skip
        except ValueError as refusal:
            reason = str(refusal)
            continue
        if best is None or found.chi2 < best.chi2:
            best = found
        if candidate.smooth and best.converged and best.chi2 < 0.98 * onto.swing.chi2:
            break
    return reason if best is None else best


def all_candidates(model: LoopModel) -> tuple[Candidate, ...]:
    """Everything that the loop can try on this block."""
    return candidates(model.declared)


def rms_of(found: Fit) -> float:
    """Weighted rms over all samples, or nan."""
    return float(found.rms) if np.isfinite(found.rms) else math.nan
