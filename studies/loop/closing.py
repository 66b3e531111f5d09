"""The loop, from a campaign to a finding: calibrate, trace, refit, compare, and predict what nothing saw.

Status   campaigns with a rotation channel; `studies.loop.outcomes` has those that hold outcomes alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from studies.campaigns import Campaign, CampaignError, motion_groups
from studies.campaigns.signals import noise as estimated_noise
from studies.loop.candidates import Candidate
from studies.loop.fitting import Fit, Parameter, fit, residuals, robust_covariance
from studies.loop.learning import LEARNED, learn
from studies.loop.model import LoopModel
from studies.loop.simulation import Answer, Job, Simulator
from studies.loop.spread import floor, redrawn, variances, weighed
from studies.loop.tracing import LEAST_GAIN, PAYS, E, Round, Trial, all_candidates, baseline, bic, pays, search
from studies.loop.windows import Record, Window, record_of, swing_windows, whole_windows

Array = NDArray[np.float64]
Tell = Callable[[str], None]
Verdict = Literal["effect", "none", "unexplained"]

GRAVITY = 9.81
"""Gravity [m/s^2] where the laboratory does not say its own."""

MOST_EFFECTS = 3

TWIN = 12.0
"""A rival whose criterion is within this of the best cannot be told apart: odds of exp(-6) or better."""

NEAR_TWIN = 400.0
"""Rivals within this after the search are fitted again to the end before they are ruled out."""

STRUCTURE = 1.08
"""Rms over the noise in the swings from which structure is left; the states of a window take some of the noise up."""

UNEXPLAINED = 1.3
"""And from which it is too much to speak of an effect even where nothing can be learned."""

FEWEST_WINDOWS = 8
"""Half-swings below which a campaign supports no finding."""


@dataclass(frozen=True)
class Setup:
    """What the loop works on: records, windows and simulators of one campaign."""

    campaign: Campaign
    simulator: Simulator
    noisy: Simulator
    records: tuple[Record, ...]  # of all tests with a rotation
    held: tuple[int, ...]  # indices of tests held out
    swings: tuple[Window, ...]  # of fit tests, one swing each
    whole: tuple[Window, ...]  # of fit tests
    whole_held: tuple[Window, ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Rival:
    """A set of effects as it ended: fits, criterion and errors."""

    trial: Trial
    whole: Fit
    criterion: float  # bic of the swings
    whole_criterion: float
    holdout: float  # median error over held-out tests [rad]


@dataclass(frozen=True)
class Errors:
    """Median over tests of the rms rotation error [rad], for the tests fitted and those held out."""

    fit: float
    holdout: float
    by_test: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Finding:
    """What closing the loop found."""

    setup: Setup
    verdict: Verdict
    declared: LoopModel
    before: LoopModel
    after: LoopModel
    before_fit: Fit
    after_fit: Fit
    chosen: Trial
    rivals: tuple[Rival, ...]  # of the last round that paid, the chosen first
    indistinguishable: tuple[tuple[str, ...], ...]
    rounds: tuple[Round, ...]
    errors: dict[str, Errors]  # declared, before, after
    noise_floor: float
    intervals: dict[str, tuple[float, float, float]]  # value, low, high by full name
    notes: tuple[str, ...]


def held_out(campaign: Campaign, records: Sequence[Record]) -> tuple[int, ...]:
    """Indices of the tests that neither fit nor choice sees: about a quarter, whole tests, repeats together.

    One free test of three or more (that of the middle lean), and every fourth or so forced motion.
    """
    by_id = {campaign.tests[r.test].id: r for r in records}
    free = [r for r in records if r.kind == "free"]
    held: list[int] = []
    if len(free) >= 3:
        held.append(sorted(free, key=lambda r: abs(r.lean))[len(free) // 2].test)
    groups = [
        [by_id[i].test for i in group if i in by_id and by_id[i].kind == "forced"] for group in motion_groups(campaign)
    ]
    groups = [group for group in groups if group]
    if len(groups) >= 3:
        count = max(1, round(len(groups) / 4))
        for k in range(count):
            held += groups[int((k + 0.5) * len(groups) / count)]
    return tuple(sorted(held))


def prepare(campaign: Campaign) -> Setup:
    """Records, windows and simulators.

    Raises:
        CampaignError: the campaign has no rotation to learn from, or too little of it.
    """
    records, notes = [], []
    for index, test in enumerate(campaign.tests):
        channel = test.channel("rotation")
        if channel is None or test.rotation is None:
            continue
        sd = channel.noise or estimated_noise(test.rotation, test.time_step).value
        record = record_of(test, index, sd, campaign.block.alpha)
        if record is None:
            notes.append(f"test {test.id}: fewer than 20 usable samples of rotation, left out")
        else:
            records.append(record)
    if not records:
        raise CampaignError("no test has a rotation record: want a rotation channel to learn from")
    held = held_out(campaign, records)
    kept = [r for r in records if r.test not in held]
    swings = swing_windows(kept)
    if len(swings) < FEWEST_WINDOWS:
        raise CampaignError(
            f"the records hold {len(swings)} half-swings above 12 times their noise: want {FEWEST_WINDOWS} or more to "
            "learn from (larger motions, or a quieter sensor)"
        )
    base_noise = np.array([_base_noise(campaign, i) for i in range(len(campaign.tests))])
    return Setup(
        campaign, Simulator(campaign.tests), redrawn(campaign.tests, base_noise), tuple(records), held, tuple(swings),
        tuple(whole_windows(kept)), tuple(whole_windows([r for r in records if r.test in held])), tuple(notes),
    )  # fmt: skip


def _base_noise(campaign: Campaign, index: int) -> float:
    test = campaign.tests[index]
    channel = test.channel("base_acceleration_x")
    if channel is None or test.base_x is None:
        return 0.0
    return float(channel.noise or estimated_noise(test.base_x, test.time_step).value)


def error_of(model: LoopModel, answer: Answer, window: Window) -> float:
    """Rms of predicted less measured rotation [rad]; a fall that was not counts as pi/2 from then on."""
    return math.sqrt(float(np.mean((model.reading(answer.theta) - window.data) ** 2)))


def errors(setup: Setup, model: LoopModel, fitted: Sequence[Window]) -> Errors:
    """Errors of a model on whole tests; `fitted` are the windows of the fit tests with their fitted leans."""
    windows = [*fitted, *setup.whole_held]
    answers = setup.simulator.run([model], [Job(0, w.test, w.times, w.start, w.theta, w.omega) for w in windows])
    each = [error_of(model, a, w) for a, w in zip(answers, windows, strict=True)]
    names = [setup.campaign.tests[w.test].id for w in windows]
    n = len(fitted)
    return Errors(_median(each[:n]), _median(each[n:]), dict(zip(names, each, strict=True)))


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if values else math.nan


def whole_fit(setup: Setup, trial: Trial, weights_of: Fit | None = None) -> Fit:
    """The trial refitted on whole records, weighed by what base noise does; the leans alone if that is no better.

    weights_of: a fit on whole records whose standard deviations are used; own ones if not given.
    """
    model = trial.swing.model
    if weights_of is None:
        spreads = variances(setup.noisy, len(setup.campaign.tests), model, setup.whole)
        windows = weighed(setup.whole, spreads)
    else:
        windows = [replace(w, sd=o.sd) for w, o in zip(setup.whole, weights_of.windows, strict=True)]
    leans = fit(setup.simulator, model, [], windows, huber=10.0, iterations=4)
    full = fit(setup.simulator, model, [E, *trial.parameters], leans.windows, huber=10.0, iterations=8)
    if full.chi2 >= leans.chi2 or not _still_fits(setup, trial, full.model):
        return leans
    return full


def _still_fits(setup: Setup, trial: Trial, model: LoopModel) -> bool:
    """Whether parameters from whole records serve the swings too: else that fit is stuck elsewhere."""
    there = fit(setup.simulator, model, [], trial.swing.windows, iterations=3)
    return there.chi2 - trial.swing.chi2 < 30.0 + 0.01 * trial.swing.chi2


@dataclass(frozen=True)
class Settled:
    """The parameters that swings and whole records agree on, with their covariance."""

    whole: Fit  # whole records with these parameters, leans fitted
    names: tuple[str, ...]
    covariance: Array


def settle(setup: Setup, trial: Trial, whole: Fit) -> Settled:
    """Estimates from swings and from whole records put together, each by its robust covariance.

    Whole records are the sharper the longer they run, and the more the noise of the base sensor is in them.
    """
    parameters = [E, *trial.parameters]
    names = tuple(p.name for p in parameters)
    fits = [f for f in (trial.swing, whole) if f.parameters]
    covariances = [robust_covariance(setup.simulator, setup.noisy, f) for f in fits]
    scale = np.array([p.scale * (f_value if p.log else 1.0) for p, f_value in _at(parameters, whole.model)])
    total, weighted = np.zeros((len(names), len(names))), np.zeros(len(names))
    for found, covariance in zip(fits, covariances, strict=True):
        # Parameters that a fit does not have, or does not show, have no information in it.
        own = [names.index(p.name) for p in found.parameters]
        seen = [k for k in range(len(own)) if covariance[k, k] > 0.0]
        at = np.array([own[k] for k in seen], dtype=int)
        part = covariance[np.ix_(seen, seen)] / np.outer(scale[at], scale[at])
        information = np.linalg.pinv(part, rcond=1e-14)
        total[np.ix_(at, at)] += information
        weighted[at] += information @ (np.array([found.model.get(names[k]) for k in at]) / scale[at])
    joint = np.linalg.pinv(total, rcond=1e-14)
    both = scale * (joint @ weighted)
    known = {p.name: min(max(float(v), p.low), p.high) for p, v in zip(parameters, both, strict=True)}
    model = whole.model.changed(known)
    leans = fit(setup.simulator, model, [], whole.windows, huber=10.0, iterations=4)
    return Settled(leans, names, np.asarray(joint * np.outer(scale, scale), dtype=np.float64))


def _at(parameters: Sequence[Parameter], model: LoopModel) -> list[tuple[Parameter, float]]:
    return [(p, abs(model.get(p.name))) for p in parameters]


def scan(setup: Setup, onto: Trial, whole: Fit, pool: Sequence[Candidate]) -> Trial | None:
    """The best of the effects that whole records alone show, or None if it does not pay.

    Such an effect acts at lift-off; its sum of squares is rugged, so that it is scanned over its range first.
    """
    best: tuple[float, Candidate, dict[str, float]] | None = None
    for candidate in pool:
        if candidate.in_swings or candidate.effect in onto.effects:
            continue
        for start in candidate.starts:
            model = whole.model.changed(start)
            found = fit(setup.simulator, model, [], whole.windows, huber=10.0, iterations=2)
            if best is None or found.chi2 < best[0]:
                best = (found.chi2, candidate, dict(start))
    if best is None or whole.chi2 - best[0] < PAYS * max(1.0, best[0] / whole.samples):
        return None
    _, candidate, start = best
    ended = fit(
        setup.simulator, whole.model.changed(start), candidate.parameters, whole.windows, huber=10.0, iterations=8
    )
    value = {p.name: ended.model.get(p.name) for p in candidate.parameters}
    swing = fit(
        setup.simulator, onto.swing.model.changed(value), [E, *onto.parameters], onto.swing.windows, iterations=3
    )
    return Trial((*onto.names, candidate.name), (*onto.parts, candidate), swing)


def close(campaign: Campaign, *, g: float = GRAVITY, tell: Tell = lambda text: None) -> Finding:
    """Close the loop on a campaign with rotation records.

    Args:
        campaign: as `studies.campaigns.read` gives it.
        g: gravity at the laboratory [m/s^2].
        tell: is told what is being done.

    Raises:
        CampaignError: the data cannot support a finding; it says why.
    """
    setup = prepare(campaign)
    declared = _declared(campaign, g)
    tell("calibrating the ideal block")
    plain = baseline(setup.simulator, declared, setup.swings)
    path, rounds, fits = _traced(setup, plain, tell)
    tell("comparing rivals")
    rivals = _rivals(setup, rounds[len(path) - 2], path[-1], fits[-1]) if len(path) > 1 else ()
    if rivals:
        path[-1], fits[-1] = rivals[0].trial, rivals[0].whole
    chosen, verdict = _explained(setup, plain, path[-1], tell)
    if chosen is not path[-1]:
        rivals, fits = (), [*fits, whole_fit(setup, chosen)]
    before, after = settle(setup, plain, fits[0]), settle(setup, chosen, fits[-1])
    models = {"declared": declared, "before": before.whole.model, "after": after.whole.model}
    windows = {"declared": setup.whole, "before": before.whole.windows, "after": after.whole.windows}
    all_errors = {name: errors(setup, model, windows[name]) for name, model in models.items()}
    spread = variances(setup.noisy, len(campaign.tests), after.whole.model, setup.whole_held, _lean_sds(setup))
    floors = [floor(w, v) for w, v in zip(setup.whole_held, spread, strict=True)]
    return Finding(
        setup, verdict, declared, models["before"], models["after"], before.whole, after.whole, chosen, rivals,
        _twins(rivals), tuple(rounds), all_errors, _median(floors), intervals(chosen, after), setup.notes,
    )  # fmt: skip


def _traced(setup: Setup, plain: Trial, tell: Tell) -> tuple[list[Trial], list[Round], list[Fit]]:
    """The trials that were accepted one on top of the other, all rounds, and the fits on whole records."""
    pool = all_candidates(plain.swing.model)
    path, rounds, fits = [plain], [], [whole_fit(setup, plain)]
    for depth in range(MOST_EFFECTS):
        tell(f"tracing, round {depth + 1}")
        tried = search(setup.simulator, path[-1], pool, tell)
        best = tried.best
        if best is None or not pays(path[-1].swing, best.swing):
            tell("scanning whole records")
            best = scan(setup, path[-1], fits[-1], pool)
            tried.trials += [] if best is None else [best]
        rounds.append(tried)
        if best is None:
            break
        now = whole_fit(setup, best)
        if not now.rms < (1.0 - LEAST_GAIN) * _rms_under(setup, fits[-1], now):
            break
        path.append(best)
        fits.append(now)
    return path, rounds, fits


def _explained(setup: Setup, plain: Trial, named: Trial, tell: Tell) -> tuple[Trial, Verdict]:
    """The trial to keep: the named effects if they leave nothing, else with what was learned of the rest."""
    if named.swing.rms < STRUCTURE and len(named.parts) < 2:
        return named, "effect" if named.parts else "none"
    tell("learning what no effect explains")
    # Effects may stand for something unnamed, several of them above all: learning starts from the calibrated block too.
    routes = [learn(setup.simulator, onto, tell) for onto in ([plain] if named is plain else [plain, named])]
    best = min(routes, key=lambda t: bic(t.swing))
    learned = any(part.effect == LEARNED for part in best.parts)
    if not learned or bic(best.swing) > bic(named.swing) - (PAYS if named.swing.rms >= STRUCTURE else 0.0):
        return named, "unexplained" if named.swing.rms > UNEXPLAINED else "effect" if named.parts else "none"
    if bic(routes[0].swing) < bic(best.swing) + PAYS:
        best = routes[0]
    return best, "unexplained"


def _declared(campaign: Campaign, g: float) -> LoopModel:
    e = campaign.conditions.restitution
    model = LoopModel(campaign.block, 0.9 if e is None else e, {}, g)
    if e is not None:
        return model
    housner = 1.0 - 1.5 * math.sin(campaign.block.alpha) ** 2
    return replace(model, restitution=min(max(housner, 0.05), 1.0))


def _lean_sds(setup: Setup) -> list[float]:
    # `theta_sd` is twice the standard deviation of the estimate.
    return [0.5 * w.theta_sd for w in setup.whole_held]


def _rms_under(setup: Setup, found: Fit, weights_of: Fit) -> float:
    """Weighted rms of one fit under the weights of another."""
    windows = [replace(w, sd=o.sd) for w, o in zip(found.windows, weights_of.windows, strict=True)]
    joined = np.concatenate(residuals(setup.simulator, found.model, windows))
    return math.sqrt(float(np.mean(joined**2)))


def _rivals(setup: Setup, tried: Round, best: Trial, whole: Fit) -> tuple[Rival, ...]:
    """The chosen trial and those of its round that come near, each fitted to the end; the best first."""
    found = []
    for trial in sorted(tried.trials, key=lambda t: bic(t.swing)):
        if trial is not best and bic(trial.swing) - bic(best.swing) > NEAR_TWIN:
            continue
        ended = fit(
            setup.simulator, trial.swing.model, [E, *trial.parameters], trial.swing.windows, iterations=20,
            tolerance=1e-6,
        )  # fmt: skip
        settled = replace(trial, swing=ended if ended.chi2 <= trial.swing.chi2 else trial.swing)
        own = whole_fit(setup, settled, whole)
        held = errors(setup, own.model, own.windows).holdout
        found.append(Rival(settled, own, bic(settled.swing), bic(own), held))
    return tuple(sorted(found, key=lambda r: r.criterion))


def _twins(rivals: Sequence[Rival]) -> tuple[tuple[str, ...], ...]:
    """Sets that these data cannot tell apart."""
    if len(rivals) < 2:
        return ()
    best = rivals[0]
    near = [r for r in rivals if r.criterion - best.criterion < TWIN]
    names = list(dict.fromkeys(r.trial.effects[-1] for r in near))
    return (tuple(names),) if len(names) > 1 else ()


def intervals(chosen: Trial, settled: Settled) -> dict[str, tuple[float, float, float]]:
    """Value and 95 % interval of each parameter, with what the base sensor's noise does to it."""
    bounds = {p.name: p for p in (*chosen.swing.parameters, *chosen.parameters)}
    out = {}
    for k, name in enumerate(settled.names):
        value = settled.whole.model.get(name)
        half = 1.96 * math.sqrt(max(float(settled.covariance[k, k]), 0.0))
        out[name] = (value, max(value - half, bounds[name].low), min(value + half, bounds[name].high))
    return out
