"""The one further test that would best settle what is still open.

Among tests that a laboratory could do at once (releases from other leans and on the other side, motions of the campaign
at another size), that in which two models differ most against what the noise of the sensors leaves open: the two that
cannot be told apart, or the nearest rival, or the model with its least certain parameter at the ends of its interval.
Near balance and after many impacts a response hangs finely on the base, and a difference there tells nothing.

Status   a difference after a fall of one of them counts as `FALL`, since a laboratory would rather not break the block.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from studies.campaigns import Test
from studies.loop.closing import Finding
from studies.loop.models.model import LoopModel
from studies.loop.models.names import readable
from studies.loop.observed.spread import with_base_noise
from studies.loop.runs.simulation import Job, Simulator
from studies.loop.runs.thinning import base_noise
from studies.loop.swings.learning import LEARNED
from studies.loop.whole.remaining import missed, swings_that_count

Array = NDArray[np.float64]

LEANS = (0.3, 0.6, 0.9)
"""Of the tilt of unstable balance."""

SIZES = (0.7, 1.4, 2.0)
"""Factors on the motions of the campaign."""

DURATION, STEP = 8.0, 0.005
"""Of a free test [s]."""

FALL = 0.05
"""Most that a difference counts [rad]."""

DRAWS = 8
"""Of the noise of base and lean."""

OF_THE_LEAN = [NormalDist().inv_cdf((d + 0.5) / DRAWS) for d in range(DRAWS)]
"""Noises of the lean over its deviation: so many equally likely ones."""

CLEARLY = 3.0
"""Times that by which a test has to tell two models apart."""


@dataclass(frozen=True)
class _Proposal:
    words: str
    test: Test
    lean: float  # [rad]
    noise: float = 0.0  # of the base sensor [m/s^2]


@dataclass(frozen=True)
class _Question:
    """Two models between which a test is to decide, and what to call them."""

    models: tuple[LoopModel, LoopModel]
    words: str


def next_test(finding: Finding) -> str:
    """A sentence: what to do next, which models it tells apart, and how clearly."""
    if finding.verdict == "unexplained" and not finding.chosen.parts:
        return _repeated(finding)
    question = _question(finding)
    if question is None:
        return (
            "Nothing is open between the effects that were tried; larger leans and motions than those of the campaign "
            "would show effects that act at large rotation only."
        )
    proposals = _proposals(finding)
    simulator = Simulator([p.test for p in proposals], numbers=[0] * len(proposals))
    models = [finding.later(model) for model in question.models]
    jobs = [
        Job(m, k, np.ascontiguousarray(p.test.time), float(p.test.time[0]), p.lean)
        for m in range(2)
        for k, p in enumerate(proposals)
    ]
    answers = simulator.run(models, jobs)
    n = len(proposals)
    read = [[simulator.recorded(models[m], k, answers[m * n + k].theta) for k in range(n)] for m in range(2)]
    apart = np.array([_difference(*pair) for pair in zip(*read, strict=True)])
    k, left = _most_telling(finding, models, read, proposals, apart)
    clearly = apart[k] >= CLEARLY * left
    return (
        f"{proposals[k].words}: {question.words} then differ by {apart[k]:.2g} rad rms, "
        f"{apart[k] / left:.{0 if clearly else 1}f} times what the noise of the sensors leaves open there"
        + ("." if clearly else "; of releases from other leans and these motions at other sizes none tells more.")
    )


def _most_telling(
    finding: Finding, models: Sequence[LoopModel], read: Sequence[Sequence[Array]], proposals: Sequence[_Proposal],
    apart: Array,
) -> tuple[int, float]:  # fmt: skip
    """The test in which the models are furthest apart over what noise leaves open, and how much that is [rad].

    The sensor's own noise is left open in every test, so that none tells more than its difference over that.  Those
    in which the models differ most come first; once one tells as much as that allows of the next, none is left to run.

    read: what the sensor reads without other noise, by model and test.
    apart: rms difference of the models [rad], shape (test,).
    """
    again, noise = _again(proposals), _noise(finding)
    best, most, its_left = 0, -math.inf, noise
    for k in np.argsort(-apart, kind="stable").tolist():
        if apart[k] / noise <= most:
            break
        left = _left_open(again[k], proposals[k], noise, models, [own[k] for own in read])
        if apart[k] / left > most:
            best, most, its_left = k, float(apart[k]) / left, left
    return best, its_left


def _again(proposals: Sequence[_Proposal]) -> list[list[Test]]:
    """Each of the tests under every draw of the noise of its base sensor."""
    rng, sds = np.random.default_rng(0), np.array([p.noise for p in proposals])
    by_draw = [with_base_noise([p.test for p in proposals], sds, rng) for _ in range(DRAWS)]
    return [list(tests) for tests in zip(*by_draw, strict=True)]


def _left_open(
    tests: Sequence[Test], proposal: _Proposal, noise: float, models: Sequence[LoopModel], read: Sequence[Array]
) -> float:
    """Rms by which a test would come out otherwise under other noise of base, lean and sensor [rad].

    By the model that leaves more open.

    tests: it, under draws of the noise of its base.
    noise: of the rotation sensor [rad].
    read: what the sensor reads without other noise, by model.
    """
    noisy = Simulator(tests, numbers=[0] * len(tests))
    leans = [proposal.lean + (noise * d if proposal.test.kind == "free" else 0.0) for d in OF_THE_LEAN]
    time = proposal.test.time
    jobs = [Job(m, d, time, float(time[0]), leans[d]) for m in range(len(models)) for d in range(len(tests))]
    moved = [
        _difference(noisy.recorded(models[job.model], job.test, answer.theta), read[job.model])
        for job, answer in zip(jobs, noisy.run(models, jobs), strict=True)
    ]
    by_model = np.mean(np.square(moved).reshape(len(models), len(tests)), axis=1)
    return math.sqrt(float(by_model.max()) + noise**2)


def _repeated(finding: Finding) -> str:
    """The test to repeat as it was where something is missed and no model differs from the ideal block."""
    tests = finding.setup.campaign.tests
    if finding.setup.by_rotation and missed(finding.setup, finding.after_fit):
        far, windows, what = finding.after_fit.by_window, finding.after_fit.windows, "its record is"
        k = int(np.argmax(far))
    else:
        far, windows, what = finding.chosen.swing.by_window, finding.chosen.swing.windows, "one of its swings is"
        k = max(swings_that_count(finding.setup, finding.chosen) or range(far.size), key=lambda i: far[i])
    return (
        f"Repeat {tests[windows[k].test].id} as it was, and watch whether the block slips, hops or turns about its "
        f"vertical axis: {what} missed by {far[k]:.0f} times the noise.  Where the block does the same again, the "
        "model lacks an effect; where it does not, the record hangs on what nobody can measure."
    )


def _question(finding: Finding) -> _Question | None:
    if finding.verdict == "unexplained":
        learned = any(name in LEARNED for name in finding.chosen.effects)
        other = "the model with what was learned" if learned else f"the one with {_named(finding.chosen.names)}"
        return _Question((finding.before, finding.after), f"the calibrated ideal block and {other}")
    if len(finding.rivals) > 1:
        first, *others = finding.rivals
        second = next((r for r in others if not r.refused), others[0])
        words = f"{_named(first.trial.names)} and {_named(second.trial.names)}"
        return _Question((first.whole.model, second.whole.model), words)
    widest, ratio = "", 0.0
    for name, (value, low, high) in finding.intervals.items():
        if name.partition(".")[0] in finding.chosen.effects and value != 0.0 and (high - low) / abs(value) > ratio:
            widest, ratio = name, (high - low) / abs(value)
    if widest:
        _, low, high = finding.intervals[widest]
        models = (finding.after.changed({widest: low}), finding.after.changed({widest: high}))
        return _Question(models, f"the ends of the interval of {readable(widest)}")
    tried = [trial for tried in finding.rounds[:1] for trial in tried.trials]
    if not tried:
        return None
    best = max(tried, key=lambda trial: -trial.swing.chi2)
    return _Question(
        (finding.after, best.swing.model),
        f"the ideal block and the one with {readable(best.names[-1]).lower()} (of all effects the one that the data "
        "leave most room for)",
    )


def _named(names: tuple[str, ...]) -> str:
    return " with ".join(readable(name).lower() for name in names) or "the ideal block"


def _proposals(finding: Finding) -> list[_Proposal]:
    campaign = finding.setup.campaign
    alpha = campaign.block.alpha
    time: Array = STEP * np.arange(round(DURATION / STEP) + 1, dtype=np.float64)
    out = []
    for share in LEANS:
        for side, name in ((1.0, "+x"), (-1.0, "-x")):
            lean = side * share * alpha
            words = f"Release the block from {abs(lean):.2g} rad on its {name} side"
            out.append(_Proposal(words, Test("", "free", time, initial_rotation=lean), lean))
    for test in campaign.tests:
        channel = test.channel("base_acceleration_x")
        if test.kind != "forced" or channel is None:
            continue
        for size in SIZES:
            data = {c.name: size * test.data[c.name] for c in test.channels if c.kind.startswith("base_")}
            own = tuple(c for c in test.channels if c.name in data)
            words = f"Repeat the motion of {test.id} at {size:g} times its size"
            there = replace(test, channels=own, data=data, overturned=None)
            out.append(_Proposal(words, there, 0.0, base_noise(test)))
    return out


def _noise(finding: Finding) -> float:
    return float(np.median([record.noise for record in finding.setup.records]))


def _difference(one: Array, other: Array) -> float:
    """Rms difference of what the sensor reads [rad]."""
    return math.sqrt(float(np.mean(np.clip(one - other, -FALL, FALL) ** 2)))
