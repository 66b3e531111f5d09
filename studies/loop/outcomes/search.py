"""The search over outcomes: calibrate the ideal block, try every effect, close in on those that explain the outcomes.

Near balance a hundredth of restitution decides who falls: the likelihood of outcomes has a sharp peak on a rugged
floor.  It is scanned over the whole range of the parameters and closed in on from the best points, never followed by
derivatives.  What an effect would gain by chance, with all that was tried, is simulated: outcomes are drawn from the
model below and the same models compete for them.

Source   scan: Sobol (1967); closing in: the cross-entropy method, Rubinstein (1999); null of the best of many:
         parametric bootstrap, Davison & Hinkley (1997).
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import qmc

from studies.loop.models.candidates import Candidate
from studies.loop.models.model import RESTITUTION, LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.outcomes.candidates import Form, restitution
from studies.loop.outcomes.likelihood import Array, Bools, Noise, best_over_draws, probability, score
from studies.loop.outcomes.runs import FINE, NOMINAL, Runs
from studies.loop.swings.learning import LEARNED

Tell = Callable[[str], None]

LADDER = (0.5, 0.65, 0.75, 0.8, 0.84, 0.87, 0.89, 0.91, *(0.92 + 0.01 * k for k in range(9)))
"""Restitutions of the calibrated block that are tried first."""

MOST_RUNS, FEWEST_POINTS, MOST_POINTS = 3200, 12, 36
"""A scan of a form has so many runs, but no fewer or more points than these."""

ROUNDS = ((8, 0.1), (6, 0.05), (4, 0.025))
"""Closing in: forms that are kept, and the spread about their best points in shares of the range."""

ELITE = 3
"""Points from which a form is closed in on."""

FINAL = 4
"""Best points of a form that are run at all strengths."""

DRAWS = 400
"""Sets of outcomes drawn for the null."""


@dataclass(frozen=True)
class Point:
    """A model, its log-likelihood and the noise it has it with."""

    model: LoopModel
    value: float
    noise: Noise


@dataclass(frozen=True)
class Tried:
    """A set of effects; `points` are all that were run, the likeliest first; `best` is the best at all strengths."""

    parts: tuple[Candidate, ...]
    parameters: tuple[Parameter, ...]  # restitution first
    points: tuple[Point, ...]
    best: Point | None = None

    @property
    def top(self) -> Point:
        """The best point."""
        return self.points[0] if self.best is None else self.best

    @property
    def names(self) -> tuple[str, ...]:
        """Forms of the effects."""
        return tuple(part.name for part in self.parts)

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(part.effect for part in self.parts)


@dataclass
class Round:
    """What was tried on top of what."""

    onto: Tried
    first: dict[str, Tried] = field(default_factory=dict)  # scans by form
    refined: list[Tried] = field(default_factory=list)  # those closed in on
    skipped: dict[str, str] = field(default_factory=dict)
    chance: float = math.nan  # how often outcomes of the model below give such a gain


@dataclass(frozen=True)
class Search:
    """Runs on the fitted tests, and what was noted of them, shape (test,)."""

    runs: Runs
    fell: Bools
    tell: Tell = lambda text: None
    thrift: int = 1  # by how much fewer points are tried

    @property
    def count(self) -> int:
        """Points of a scan."""
        return max(1, min(max(MOST_RUNS // self.fell.size, FEWEST_POINTS), MOST_POINTS) // self.thrift)

    def points(self, models: Sequence[LoopModel], strengths: Sequence[float] = NOMINAL) -> tuple[Point, ...]:
        """The models with their log-likelihoods, the likeliest first."""
        if not models:
            return ()
        found = score(self.runs.falls(models, strengths), strengths, self.fell)
        points = [Point(m, float(v), n) for m, v, n in zip(models, found.value, found.noise, strict=True)]
        return tuple(sorted(points, key=lambda point: -point.value))

    def settled(self, tried: Tried, count: int = FINAL) -> Tried:
        """With the best of its points at all strengths."""
        return replace(tried, best=self.points([point.model for point in tried.points[:count]], FINE)[0])

    def price(self, parameters: int) -> float:
        """What parameters cost in twice the log-likelihood (Schwarz)."""
        return parameters * math.log(self.fell.size)

    def criterion(self, tried: Tried) -> float:
        """Twice the log-likelihood at all strengths, less the price of the parameters."""
        return 2.0 * tried.top.value - self.price(len(tried.parameters))


def calibrated(search: Search, declared: LoopModel) -> Tried:
    """The ideal block with the restitution under which the outcomes are likeliest."""
    own = (restitution(LADDER[0]),)
    tried = Tried((), own, search.points([declared.changed({RESTITUTION: e}) for e in LADDER]))
    for _, spread in ROUNDS[1:]:
        tried = closer(search, tried, spread / 4.0, search.count // 3, "calibrated")
    return search.settled(tried)


def scanned(search: Search, onto: Tried, form: Form) -> Tried:
    """A form over its whole range, with what was there already let go a little.

    Raises:
        ValueError: no point of the range can be run.
    """
    e = min(onto.top.model.restitution, 0.95)
    known = tuple(_about(p, onto.top.model) for p in onto.parameters[1:])
    own = (restitution(max(0.05, e - 0.12)), *known, *form.candidate.parameters)
    count = max(1, search.count // form.cost)
    # Twice as many as needed, since some of them may be out of what the equations allow.
    size = 2 ** math.ceil(math.log2(2 * count))
    grid = qmc.Sobol(len(own), seed=zlib.crc32(form.candidate.name.encode())).random(size)
    models: list[LoopModel] = []
    refusal = ""
    for row in grid:
        model, why = _model(onto.top.model, form.candidate, own, row)
        refusal = why or refusal
        if model is not None and len(models) < count:
            models.append(model)
    if not models:
        raise ValueError(refusal)
    return Tried((*onto.parts, form.candidate), own, search.points(models))


def _about(p: Parameter, model: LoopModel) -> Parameter:
    """A parameter between sizes not far from where it is."""
    at = p.inner(model.get(p.name))
    ends = sorted((p.outer(at - 0.08), p.outer(at + 0.08)))
    return replace(p, low=ends[0], high=ends[1])


def _model(onto: LoopModel, candidate: Candidate, own: Sequence[Parameter], row: Array) -> tuple[LoopModel | None, str]:
    """The model at a point of the unit cube over the ranges, or why there is none."""
    values = {
        p.name: p.outer(p.inner(p.low) + x * (p.inner(p.high) - p.inner(p.low))) for p, x in zip(own, row, strict=True)
    }
    return _checked(onto.changed({**candidate.fixed, **values}))


def _checked(model: LoopModel) -> tuple[LoopModel | None, str]:
    try:
        model.system  # noqa: B018 (refuses what does not go together)
    except ValueError as error:
        return None, str(error)
    return model, ""


def closer(search: Search, tried: Tried, spread: float, count: int, label: str) -> Tried:
    """More points about the best ones, at a spread in shares of the ranges."""
    rng = np.random.default_rng(zlib.crc32(f"{label} {spread}".encode()))
    models = []
    for k in range(count):
        centre = tried.points[k % min(ELITE, len(tried.points))].model
        step = spread * rng.standard_normal(len(tried.parameters))
        values = {p.name: p.outer(p.inner(centre.get(p.name)) + d) for p, d in zip(tried.parameters, step, strict=True)}
        model, _ = _checked(centre.changed(values))
        models += [] if model is None else [model]
    points = sorted((*tried.points, *search.points(models)), key=lambda point: -point.value)
    return replace(tried, points=tuple(points))


def traced(search: Search, onto: Tried, pool: Sequence[Form]) -> Round:
    """One round: every form scanned, the best closed in on, and what chance would give."""
    out = Round(onto)
    costs = {}
    for number, form in enumerate(pool, 1):
        name = form.candidate.name
        if name in onto.names or (form.candidate.effect in onto.effects and form.candidate.effect not in LEARNED):
            continue
        search.tell(f"round {len(onto.parts) + 1}: trying {name} ({number} of {len(pool)})")
        try:
            out.first[name], costs[name] = scanned(search, onto, form), form.cost
        except ValueError as refusal:
            out.skipped[name] = str(refusal)
    found = list(out.first.items())
    for keep, spread in ROUNDS:
        found = sorted(found, key=lambda pair: -pair[1].points[0].value)[:keep]
        search.tell(f"closing in on {', '.join(name for name, _ in found[:3])} ...")
        count = {name: max(2, search.count // 2 // costs[name]) for name, _ in found}
        found = [(name, closer(search, tried, spread, count[name], name)) for name, tried in found]
        out.first |= dict(found)
    search.tell("comparing the best")
    out.refined = sorted((search.settled(tried) for _, tried in found), key=lambda t: -search.criterion(t))
    out.chance = chance(search, onto, [p.model for t in out.first.values() for p in t.points])
    return out


def chance(search: Search, onto: Tried, models: Sequence[LoopModel], seed: int = 0) -> float:
    """How often outcomes of the model below would let the best of the models gain as much as they do."""
    if not models:
        return 1.0
    below = [point.model for point in onto.points]
    without, within = search.runs.falls(below, NOMINAL), search.runs.falls(models, NOMINAL)
    p = probability(search.runs.falls([onto.top.model], FINE)[0], FINE, onto.top.noise)
    drawn = np.random.default_rng(seed).random((DRAWS, p.size)) < p
    every = np.concatenate([search.fell[None], drawn])
    gain = best_over_draws(within, NOMINAL, every) - best_over_draws(without, NOMINAL, every)
    return float((1 + np.sum(gain[1:] >= gain[0])) / (1 + DRAWS))
