"""Effects that change in the course of a campaign: edges that crumble, a floor that settles, a sensor that warms up.

What a parameter does from test to test is one of a few courses: it changes evenly, ever less, or all at once before a
test; the first two by the number of the test, or by what impacts took of the block in those before.  All of them follow
from one derivative of each window by the parameter, so that a score test ranks every effect with every course at the
price of the effects alone; the few that promise most are candidates like any other.

Source   score test: Rao (1948).
Status   what is planted in a laboratory's campaigns is found (tests); within a test nothing changes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studies.loop.fits.estimating import gains_of_changes
from studies.loop.models.candidates import Candidate
from studies.loop.models.model import CHANGE, RESTITUTION, LoopModel, faded
from studies.loop.models.parameters import Parameter
from studies.loop.runs.simulation import Simulator
from studies.loop.swings.tracing import LEADING
from studies.loop.swings.trials import PAYS, E, Trial
from studies.loop.swings.trying import SOME, every_so_many, nothing_of, of_some

MOST = 6
"""Effects with a course that are candidates: those of which the score test expects most for their parameters.  Besides,
what a trial holds already may change."""

CLOCKS = ("number", "use")
"""What a course goes by.  Of each effect the best one by either is a candidate: a course that ends looks much like one
that does not, or like a step before a test."""

LITTLE = 0.2
"""Share of what is over the noise that a score test has to expect of a change, or it is not what acts."""

LEAST_TESTS = 4
"""Tests that were fitted below which a course is not told from what differs between any two of them."""

FADINGS = (0.15, 0.6)
"""Fading from which a change that comes to an end is fitted."""


@dataclass(frozen=True)
class Course:
    """One way for a parameter to change from test to test."""

    words: str  # as in "rounded edges, changing evenly"
    share: NDArray[np.float64]  # of its change that has come about in each test, shape (test,)
    size: str  # which argument of `studies.loop.models.model.Change` is its size
    fixed: Mapping[str, float]  # others of them
    clock: str  # one of `CLOCKS`
    fading: float = 0.0  # from where that is fitted; not if 0


def courses(model: LoopModel, tests: int, fitted: Sequence[int]) -> list[Course]:
    """All that are tried.

    Args:
        model: which knows what impacts have taken before each test.
        tests: of the campaign.
        fitted: the numbers of those that are fitted.
    """
    number, found = np.arange(tests, dtype=np.float64), list[Course]()
    use = np.array([replace(model, number=k).use for k in range(tests)])
    for verb, at, clock in (("changing", number, CLOCKS[0]), ("wearing", use, CLOCKS[1])):
        by_use = {"by_use": float(clock == CLOCKS[1])}
        if clock == CLOCKS[1] and not model.uses:
            continue
        found.append(Course(f"{verb} evenly", at, "per_test", by_use, clock))
        found += [
            Course(f"{verb} ever less, {f:g}", np.asarray(faded(at, f)), "per_test", by_use, clock, f) for f in FADINGS
        ]
    for before in sorted(set(fitted))[1:]:
        share = (number >= before).astype(np.float64)
        found.append(
            Course(f"changed before test {before + 1}", share, "step", {"from_test": float(before)}, CLOCKS[0])
        )
    return found


def changing(simulator: Simulator, onto: Trial, pool: Sequence[Candidate]) -> list[Candidate]:
    """The effects of a pool with the courses that promise most on top of a trial; of restitution a step alone.

    pool: of effects with a name, and of coefficients without; those without a derivative at nothing are left out unless
        the trial has them, coefficients unless they promise far more than any name.
    """
    windows = onto.swing.windows
    fitted = onto.swing.of(every_so_many(len(windows), SOME))
    there = sorted({w.test for w in windows})
    if len(there) < LEAST_TESTS:
        return []
    forms = {c.name: c for c in (*_of_the_pool(onto, pool), *_of_the_trial(onto))}
    models: dict[str, LoopModel] = {}
    for c in forms.values():
        with suppress(ValueError):
            held = c.effect in onto.effects or c.effect == RESTITUTION
            models[c.name] = onto.swing.model if held else onto.swing.model.changed(nothing_of(onto, c))
    tried = {course.words: course for course in courses(onto.swing.model, len(simulator.tests), there)}
    scores = gains_of_changes(
        simulator, fitted, {name: forms[name].parameters for name in models}, models,
        {words: course.share for words, course in tried.items()},
    )  # fmt: skip
    left = of_some(fitted, range(len(fitted.windows))) - sum(max(r.size - 2, 0) for r in fitted.residuals)
    least = max(PAYS, LITTLE * left, LEADING * max(scores.values(), default=0.0))
    price = math.log(max(fitted.samples, 2))
    best: dict[tuple[str, str], tuple[float, Candidate]] = {}
    for (name, words), score in scores.items():
        course, c = tried[words], forms[name]
        # A drift of restitution, and one with what impacts took, are candidates by themselves.
        if score < least or (c.effect == RESTITUTION and course.size == "per_test"):
            continue
        candidate = _with_course(onto, c, course)
        worth = score - price * len(candidate.parameters)
        if worth > best.get((name, course.clock), (-math.inf, None))[0]:
            best[name, course.clock] = worth, candidate
    # In free decays a torque to either side is all but another gain of the sensor: a name says it unless it says less.
    by_name = max((worth for (name, _), (worth, _) in best.items() if not _has_no_name(forms[name])), default=-math.inf)
    best = {k: v for k, v in best.items() if not _has_no_name(forms[k[0]]) or v[0] > by_name + PAYS}
    ranked = sorted(best, key=lambda key: -best[key][0])
    there_already = [key for key in ranked[MOST:] if forms[key[0]].effect in onto.effects]
    return [best[key][1] for key in (*ranked[:MOST], *there_already)]


def _of_the_pool(onto: Trial, pool: Sequence[Candidate]) -> Iterator[Candidate]:
    for c in pool:
        if c.smooth and c.in_swings and not c.costly and not c.also and c.effect not in onto.effects:
            yield c


def _of_the_trial(onto: Trial) -> Iterator[Candidate]:
    """What is there already, and the restitution."""
    for part in onto.parts:
        if part.in_swings and not part.costly and part.effect not in (CHANGE, "") and "." in part.parameters[0].name:
            yield part
    if any(p.name == RESTITUTION for p in onto.calibrated):
        yield Candidate(RESTITUTION, RESTITUTION, (E,), (), {})


def _with_course(onto: Trial, c: Candidate, course: Course) -> Candidate:
    """The effect whose parameters change so; of one that is there already the changes alone."""
    held = c.effect in onto.effects or c.effect == RESTITUTION
    words = course.words.partition(", ")[0]
    own = [Parameter(f"{CHANGE}.{course.size}.{p.name}", _scale(p, course), *_most(p, course)) for p in c.parameters]
    fixed = {f"{CHANGE}.{how}.{p.name}": value for p in c.parameters for how, value in _ends(p, course).items()}
    start: dict[str, float] = {}
    if course.fading:
        own += [Parameter(f"{CHANGE}.fading.{p.name}", 0.3, 0.02, 3.0, log=True) for p in c.parameters]
        start = {f"{CHANGE}.fading.{p.name}": course.fading for p in c.parameters}
    parameters = (*own,) if held else (*c.parameters, *own)
    begin = {p.name: 0.0 for p in own} | start
    starts = (begin,) if held else tuple({**begin, **one} for one in c.starts)
    return Candidate(
        f"learned[{_plainly(c.name)}, {words}]", CHANGE, parameters, starts, {**({} if held else c.fixed), **fixed},
        also=() if held else (c.effect,), replaces_restitution=c.replaces_restitution and not held,
    )  # fmt: skip


def _has_no_name(c: Candidate) -> bool:
    return c.name.startswith("learned[")


def _plainly(name: str) -> str:
    """The name of a form, without brackets: of one that is learned what that is."""
    if name.startswith("learned["):
        return name.removeprefix("learned[").removesuffix("]")
    return name.replace("[", " (").replace("]", ")")


def _scale(p: Parameter, course: Course) -> float:
    """Typical size of a change: that of the parameter by the end of a campaign, whose logarithm may be fitted."""
    size = p.scale * (math.sqrt(p.low * p.high) if p.log else 1.0)
    return size / max(float(course.share[-1]), 1.0)


def _most(p: Parameter, course: Course) -> tuple[float, float]:
    """Bounds of a change: all of the range of the parameter at once."""
    span = p.high - p.low
    return (-span, span) if math.isfinite(span) else (-math.inf, math.inf)


def _ends(p: Parameter, course: Course) -> dict[str, float]:
    """What of `Change` is not fitted."""
    return {**course.fixed, "low": p.low, "high": p.high}
