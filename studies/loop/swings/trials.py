"""What is tried on swings: sets of effects, each fitted, round by round, and when one more effect pays.

Source   none, own convention
Status   thresholds `PAYS` and `LEAST_GAIN`; studies/loop_trials.py measures how often they find something in nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from studies.loop.fits.fitting import Fit
from studies.loop.models.candidates import Candidate
from studies.loop.models.model import RESTITUTION, LoopModel
from studies.loop.models.parameters import Parameter

PAYS = 60.0
"""An effect has to lower chi-square by this many times max(1, chi-square per sample)."""

LEAST_GAIN = 0.03
"""And the weighted rms of whole records by this share, those aside that are lost with it and without it."""

FURTHER_COSTLY = 4
"""Steps of a fit that is ended again where a run takes long: the search went to the end with those that come near."""

E = Parameter(RESTITUTION, 0.01, 0.02, 1.0)


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
        return tuple(effect for part in self.parts for effect in (part.effect, *part.also))

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


@dataclass(frozen=True)
class First:
    """The best start of a candidate on some of the windows."""

    model: LoopModel
    parameters: tuple[Parameter, ...]
    gained: float  # by how much chi-square of these windows fell


@dataclass
class Round:
    """One round of the search: what was tried on top of what."""

    onto: Trial
    trials: list[Trial] = field(default_factory=list)
    skipped: dict[str, str] = field(default_factory=dict)  # form of the effect: why it was not refitted
    scores: dict[str, float] = field(default_factory=dict)  # by form of the effect
    put_off: tuple[Candidate, ...] = ()  # of those skipped the ones that `search_costly` tries
    refused: tuple[Trial, ...] = ()  # what swings would have taken and whole records speak against
    begun: dict[str, First] = field(default_factory=dict)  # by form: floors that were asked what they promise

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
