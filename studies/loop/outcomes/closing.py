"""Closing the loop where all that was noted is whether the block fell.

The probability of falling stands in for the measured channel: of a model whose motion is known but for its strength.
The ideal block is calibrated (restitution), every effect that outcomes can show is fitted to them, and an effect is
named only if it explains more than chance lets the best of all that were tried explain.

Status   studies/loop_trials.py --channel outcome, on campaigns of a virtual laboratory.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import binom

from studies.campaigns import Campaign
from studies.loop.observed.spread import with_base_noise
from studies.loop.outcomes.candidates import forms, terms
from studies.loop.outcomes.data import OutcomeData, cheap, prepare
from studies.loop.outcomes.finding import OutcomeFinding, Stage, Verdict
from studies.loop.outcomes.likelihood import Noise, probability
from studies.loop.outcomes.prediction import falls_at_strengths
from studies.loop.outcomes.runs import FINE, Runs, falls_of
from studies.loop.outcomes.search import Round, Search, Tried, calibrated, traced
from studies.loop.outcomes.weighing import densely, intervals, near, next_test, twins
from studies.loop.records.preparing import as_declared
from studies.loop.runs.keeping import Keeper
from studies.loop.runs.simulation import Simulator

Tell = Callable[[str], None]

PAYS = 10.0
"""An effect has to raise twice the log-likelihood by this, its parameters priced."""

CHANCE = 0.01
"""And chance may not do as much more often than this."""

MOST_EFFECTS = 2

STRUCTURE = 0.01
"""Structure is left where the floor gives as many wrong outcomes less often than this."""

SLACK = 1.5
"""The floor may be this much higher than estimated: parameters and the effects' forms are not known exactly."""

EXPLAINED = 0.5
"""Share of what the calibrated block misses beyond the floor that an effect has to explain to be the finding."""

FLOOR_DRAWS = 4

DECLARED_NOISE = Noise(0.01, 0.005)
"""Of the declared values, which come without any: one run decides."""


def close(
    campaign: Campaign, *, g: float, tell: Tell = lambda text: None, keeper: Keeper | None = None
) -> OutcomeFinding:
    """Close the loop on a campaign that holds outcomes alone.

    Args:
        campaign: as `studies.campaigns.read` gives it.
        g: gravity at the laboratory [m/s^2].
        tell: is told what is being done.
        keeper: keeps runs that are finished; a later call takes them from there.

    Raises:
        CampaignError: the outcomes cannot support a finding; it says why.
    """
    data = prepare(campaign)
    fitted, group = data.fitted, data.group[data.fitted]
    runs = Runs([data.tests[i] for i in fitted], [data.numbers[i] for i in fitted], campaign.block, keeper)
    search = Search(runs, data.fell[fitted], tell)
    declared = as_declared(campaign, g)
    tell("calibrating the ideal block")
    base = calibrated(search, declared)
    path, rounds = _path(search, base, campaign.conditions.friction)
    chosen = densely(search, path[-1])
    # Where nothing is added the model after is the one before.
    base = base if chosen.parts else chosen
    floor, structure = _floor(data, chosen, tell)
    chosen, verdict, notes = _judged(search, base, chosen, rounds, floor["fit"], structure)
    rivals = near(search, _rivals_of(chosen, rounds), chosen) if chosen.parts else (chosen,)
    shown = {"declared": (declared, DECLARED_NOISE), "before": (base.top.model, base.top.noise),
             "after": (chosen.top.model, chosen.top.noise)}  # fmt: skip
    falls = falls_at_strengths(
        [model for model, _ in shown.values()], [noise.spread for _, noise in shown.values()], data.tests, data.numbers,
        tell, keeper,
    )  # fmt: skip
    stages = {
        name: Stage(model, noise, probability(falls[k], FINE, noise))
        for k, (name, (model, noise)) in enumerate(shown.items())
    }
    return OutcomeFinding(
        data, search, verdict, stages, base, chosen, rivals, _held_out_errors(data, rounds, tell), tuple(rounds),
        intervals(search, chosen, group, floor["fit"]), twins(rivals), floor, structure, (*data.notes, *notes),
        next_test(data, runs, rivals if len(rivals) > 1 else _open(base, chosen, rounds)),
    )  # fmt: skip


def _path(search: Search, base: Tried, friction: float | None) -> tuple[list[Tried], list[Round]]:
    """What was accepted one on top of the other, the calibrated block first, and all rounds.

    friction: of the block on its base [1], where it is declared.
    """
    path, rounds = [base], []
    for depth in range(MOST_EFFECTS):
        # Once something is known there is less to look for.
        thrifty = replace(search, thrift=2 if depth else 1)
        tried = traced(thrifty, path[-1], forms(path[-1].top.model.declared, friction))
        rounds.append(tried)
        if not tried.refined or not pays(search, tried):
            break
        path.append(tried.refined[0])
    return path, rounds


def pays(search: Search, tried: Round) -> bool:
    """Whether the best of a round explains more than chance would."""
    gain = search.criterion(tried.refined[0]) - search.criterion(tried.onto)
    return gain > PAYS and tried.chance <= CHANCE


def _judged(
    search: Search, base: Tried, chosen: Tried, rounds: list[Round], floor: float, structure: float
) -> tuple[Tried, Verdict, list[str]]:
    """What the model after is to be, the verdict, and what has to be said of it."""
    n = search.fell.size
    missed = [_missed(search, tried) for tried in (base, chosen)]
    if structure > STRUCTURE:
        return chosen, "effect" if chosen.parts else "none", _undecided(search, chosen, rounds)
    left = (
        f"{missed[1]} of {n} fitted outcomes are wrong under the model after where its own noise would give "
        f"{floor * n:.0f}"
    )
    excess = [max(m / n - floor, 0.0) for m in missed]
    if chosen.parts and excess[1] <= (1.0 - EXPLAINED) * excess[0]:
        return chosen, "effect", [f"{left}: something else is there as well."]
    search.tell("learning what no effect explains")
    learned = traced(replace(search, thrift=2), chosen, terms(chosen.top.model.declared))
    if learned.refined and pays(search, learned):
        rounds.append(learned)
        return densely(search, learned.refined[0]), "unexplained", [f"{left}: a term was learned that lowers it."]
    return chosen, "unexplained", [f"{left}; no effect and no learned term accounts for the rest."]


def _missed(search: Search, tried: Tried) -> int:
    """Fitted outcomes that are wrong, from the cheap form of the records."""
    falls = search.runs.falls([tried.top.model], FINE)[0]
    return int(np.sum((probability(falls, FINE, tried.top.noise) > 0.5) != search.fell))


def _undecided(search: Search, chosen: Tried, rounds: Sequence[Round]) -> list[str]:
    """What the last round leaves open where nothing was added."""
    last = rounds[-1]
    if not last.refined or chosen.parts:
        return []
    gain = search.criterion(last.refined[0]) - search.criterion(last.onto)
    return [
        f"{search.fell.size} outcomes were fitted. The best of the effects, {last.refined[0].names[-1]}, has an "
        f"evidence "
        f"of {gain:.1f} where {PAYS:g} is asked for, and chance does as well in {100 * last.chance:.2g} % of such "
        f"campaigns (at most {100 * CHANCE:g} % is asked for): these outcomes support no finding, which does "
        f"not say that "
        "there is nothing."
    ]


def _rivals_of(chosen: Tried, rounds: Sequence[Round]) -> Sequence[Tried]:
    return next((tried.refined for tried in rounds if any(t.names == chosen.names for t in tried.refined)), ())


def _open(base: Tried, chosen: Tried, rounds: Sequence[Round]) -> Sequence[Tried]:
    """What a further test would have to tell apart where no rival is near: the two best of the last round."""
    return [chosen, *[t for t in rounds[-1].refined if t.names != chosen.names][:1]]


def _floor(data: OutcomeData, chosen: Tried, tell: Tell) -> tuple[dict[str, float], float]:
    """Share of outcomes that a true model would miss, the base being known to its noise; and how likely what is missed.

    The model's outcomes are compared with those under base noise drawn again.
    """
    tell("how many outcomes a true model would miss")
    block = data.campaign.block
    falls = []
    for seed in range(FLOOR_DRAWS + 1):
        noise = data.base_noise if seed else np.zeros_like(data.base_noise)
        tests = [cheap(test, block) for test in with_base_noise(data.tests, noise, np.random.default_rng(seed))]
        falls.append(falls_of(Simulator(tests, list(data.numbers)), [chosen.top.model])[0])
    flipped = np.mean([other != falls[0] for other in falls[1:]], axis=0)
    floor = {"fit": float(flipped[~data.held].mean()), "holdout": float(flipped[data.held].mean())}
    fitted = data.fitted
    missed = int(np.sum(falls[0][fitted] != data.fell[fitted]))
    # One of so many draws more, so that a floor of nothing is not certain.
    rate = min(SLACK * floor["fit"] + 1.0 / (FLOOR_DRAWS * fitted.size), 0.5)
    return floor, float(binom.sf(missed - 1, fitted.size, rate))


def _held_out_errors(data: OutcomeData, rounds: Sequence[Round], tell: Tell) -> dict[tuple[str, ...], float]:
    """Share of held-out outcomes that the best of each refined form misses, by the cheap form of the records."""
    tell("held-out tests by the rivals")
    held = np.flatnonzero(data.held)
    runs = Runs([data.tests[i] for i in held], [data.numbers[i] for i in held], data.campaign.block)
    every = {t.names: t.top for tried in rounds for t in tried.refined}
    if not every:
        return {}
    falls = runs.falls([point.model for point in every.values()], FINE)
    p = [probability(f, FINE, point.noise) for f, point in zip(falls, every.values(), strict=True)]
    return {names: float(np.mean((q > 0.5) != data.fell[held])) for names, q in zip(every, p, strict=True)}
