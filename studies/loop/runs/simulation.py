"""Many runs of many models on the tests of a campaign at once.

Status   runs of one kind (same equations, same kind of base motion) go through one compiled, parallel call.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from copy import copy
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from excitation import SampledMotion
from rocking.altered import shaking
from rocking.composed import ComposedMethod1
from rocking.composed_method2 import ComposedMethod2
from rocking.effect import Effect, Seen
from rocking.hybrid import REST, ROTATION, ROTATION_JUMP, TRANSLATION_JUMP, Base, Discrete, System
from rocking.hysteretic import HystereticBlock
from rocking.inner_mass import BlockWithInnerMass
from rocking.method1 import Method1
from rocking.method2 import Method2
from rocking.motion import BaseMotion, base_at, pitch_kernel
from rocking.remembering import LONG_AGO, RememberingBlock
from rocking.soft_floor import BlockOnSoftFloor
from rocking.solvers.numba.windows import Start, run_windows
from studies.campaigns import Test
from studies.campaigns.base_motion import base_motion
from studies.loop.models.model import LoopModel
from studies.loop.runs.keeping import Keeper, digest_of
from studies.loop.runs.thinning import AT_REST, thinned

Array = NDArray[np.float64]

RTOL, ATOL = 1e-8, 1e-11

MOST_EVENTS = 30_000
"""Of a run of a fit, after which it has failed: models that gain from their impacts rattle without end, for seconds.

A block that is shaken by hardly more than its onset comes to rest and tips again with each turn of the base, within
hundreds of impacts each time."""

KEEPS_ALL = 0.999
"""Restitution from which a block that neither slides nor jumps is said to rattle and not to come to rest: Housner's
where b/h is 0.026, more slender than what stands freely."""

FEWEST_EVENTS, SMALLEST = 3_000, 1e-4
"""A run of one that rattles has failed after so many impacts and, besides, those of a block that all the time rocks
through so small a share of its slenderness."""

HISTORY = 6
"""Peaks before a window over which slip is carried at the most: it is forgotten once the corner sticks."""

FORGOTTEN = 4.0
"""Times in which a motion dies away by e after which it is forgotten: 2 % are left."""

WITHIN = (BlockWithInnerMass, HystereticBlock)
"""Blocks with states of their own that a whole record may not forget."""


class PaddedMotion:
    """A sampled motion with parameters filled up to a common number, so that all tests share one compiled kernel."""

    def __init__(self, motion: SampledMotion, size: int) -> None:
        self.kernel, self.breakpoints = motion.kernel, motion.breakpoints
        # A base at rest has no samples between which something could be missed.
        moves = any(np.any(a) for a in (motion.a_x, motion.a_z) if a is not None)
        self.max_step = motion.max_step if moves else AT_REST
        self.time_step = motion.time_step
        self.parameters = _filled(motion.parameters, size)
        self.label = motion.name

    def filled(self, size: int) -> PaddedMotion:
        """The same with so many parameters."""
        other = copy(self)
        other.parameters = _filled(self.parameters, size)
        return other

    def __repr__(self) -> str:
        return f"PaddedMotion({self.label!r})"


def _filled(parameters: Array, size: int) -> Array:
    return np.concatenate([parameters, np.zeros(size - parameters.size)])


def _padded(motions: Sequence[SampledMotion]) -> list[PaddedMotion]:
    size = max((motion.parameters.size for motion in motions), default=0)
    return [PaddedMotion(motion, size) for motion in motions]


class Peak(NamedTuple):
    """A peak of a record: time [s], rotation [rad] and angular velocity [rad/s]."""

    time: float
    theta: float
    omega: float


class _Leg(NamedTuple):
    """A run from one peak of a record to the next, of which what a rotation does not show is carried over."""

    model: int
    test: int
    first: float  # peak at which the way begins [s]
    depth: int  # legs before this one
    stop: float  # [s]


def _as_they_were(model: LoopModel, peaks: Collection[Peak]) -> dict[Peak, Peak]:
    """Peaks of records as the model takes its sensor; as they were read where that says nothing."""
    read = np.array([peak.theta for peak in peaks])
    theta = np.array([model.peak(x) for x in read]) if model.remembers else model.rotation(read)
    with np.errstate(all="ignore"):
        omega = np.array([peak.omega for peak in peaks]) / model.reading_slope(theta)
    return {
        peak: Peak(peak.time, float(theta[k]), float(omega[k])) if math.isfinite(theta[k]) else peak
        for k, peak in enumerate(peaks)
    }


def _true_peaks(
    models: Sequence[LoopModel], legs: Mapping[_Leg, tuple[Peak, _Leg | None]]
) -> dict[_Leg, Peak]:  # fmt: skip
    """The peaks where legs begin, as their models take the sensor; those of one sensor all at once."""
    sensors: dict[tuple[Effect, ...], tuple[LoopModel, dict[_Leg, Peak]]] = {}
    of_model: dict[int, tuple[Effect, ...]] = {}
    for leg, (peak, _) in legs.items():
        if leg.model not in of_model:
            parts = models[leg.model].parts
            reads = any("reading" in p.ways() for p in parts)
            of_model[leg.model] = tuple(p for p in parts if reads and {"reading", "recorded"} & set(p.ways()))
        sensors.setdefault(of_model[leg.model], (models[leg.model], {}))[1][leg] = peak
    found: dict[_Leg, Peak] = {}
    for sensor, (model, peaks) in sensors.items():
        was = _as_they_were(model, list(dict.fromkeys(peaks.values()))) if sensor else {}
        found |= {leg: was.get(peak, peak) for leg, peak in peaks.items()}
    return found


class Struck(NamedTuple):
    """Impacts before some time that ended a swing: how many of a record, and how long ago the last one was [s].

    With those of the tests before, how many there were, and the sum of the squares of their speeds [rad^2/s^2].
    """

    impacts: int
    pause: float
    in_all: int = 0
    squares: float = 0.0

    def use(self, exponent: float) -> float:
        """Sum of |omega|^exponent over all [(rad/s)^exponent], of exponents 0 and 2."""
        return {0.0: float(self.in_all), 2.0: self.squares}[exponent]


NEVER = Struck(0, LONG_AGO)


class Job(NamedTuple):
    """One run: which model on which test, over which times, from which rotation and speed."""

    model: int
    test: int
    times: Array  # samples [s], ascending; the run starts at `start` and ends with the last
    start: float  # [s]
    theta: float = 0.0  # true rotation at the start [rad]
    omega: float = 0.0  # [rad/s]
    history: tuple[Peak, ...] = ()  # readings at the peaks before the start
    struck: Struck = NEVER  # impacts before the start


class Answer(NamedTuple):
    """What a run gave at its times: true rotation [rad], filled with +-pi/2 after a fall; full states besides."""

    theta: Array
    y: Array  # shape (time, state), NaN after the end
    mode: NDArray[np.int64]
    s: Array
    fell: bool
    failed: bool
    overturning_time: float  # [s], NaN if it did not fall

    def falls_on(self, system: System) -> bool:
        """Whether the end leaves the block beyond its balance and not on its way back: with the base still it falls."""
        known = np.flatnonzero(np.isfinite(self.y[:, 0]))
        if self.fell or self.failed or not known.size:
            return self.fell
        last = self.y[known[-1]]
        state = dict(zip(system.state_names, last, strict=True))
        beyond = float(system.balance(np, last, system.parameters)) > 0.0
        return bool(beyond and state["omega"] * state["theta"] >= 0.0)

    def passes_balance(self, system: System, times: Array) -> float:
        """When it last passes its balance outward [s], between the samples at these times; NaN if it never does."""
        beyond = np.asarray(system.balance(np, self.y.T, system.parameters))
        passed = np.flatnonzero((beyond[:-1] <= 0.0) & (beyond[1:] > 0.0))
        if not passed.size:
            return math.nan
        k = int(passed[-1])
        share = beyond[k] / (beyond[k] - beyond[k + 1])
        return float(times[k] + share * (times[k + 1] - times[k]))


class Simulator:
    """Runs models on the tests of a campaign; threads may share one (`studies.loop.runs.at_once`).

    Args:
        tests: in the order of the indices that jobs use.
        numbers: of the tests, as they were done; their indices if not given.
        keeper: keeps what was found with it (`studies.loop.fits.fitting.fit`); nothing is kept if not given.
        factors: how many samples of each base record are one in runs (`studies.loop.runs.thinning`); 1 if not given.
        most_events: after which a run has failed; what a run of a fit may have if not given.
    """

    def __init__(
        self,
        tests: Sequence[Test],
        numbers: Sequence[int] | None = None,
        keeper: Keeper | None = None,
        factors: Sequence[int] | None = None,
        most_events: int | None = None,
    ) -> None:
        self.tests, self.keeper, self.most_events = tuple(tests), keeper, most_events
        self.numbers = tuple(range(len(self.tests))) if numbers is None else tuple(numbers)
        self.factors = (1,) * len(self.tests) if factors is None else tuple(factors)
        bases = [self._recorded(test) for test in self.tests]
        driving = [thinned(base, factor) for base, factor in zip(bases, self.factors, strict=True)]
        self.bases, self.driving = _padded(bases), _padded(driving)
        self.spans = [(float(test.time[0]), float(test.time[-1])) for test in self.tests]
        self._altered: dict[tuple[int, Any, bool], BaseMotion] = {}
        self._sampled: dict[tuple[int, int], tuple[BaseMotion, Base]] = {}

    @cached_property
    def digest(self) -> str:
        """A hash of the tests."""
        return digest_of(self.tests, self.numbers, self.factors)

    @staticmethod
    def _recorded(test: Test) -> SampledMotion:
        found = base_motion(test)
        if found is not None:
            return found
        return SampledMotion(test.time_step, np.zeros(test.time.size), start=float(test.time[0]))

    def base(self, model: LoopModel, test: int) -> Base:
        """Accelerations [m/s^2] and pitch [rad, rad/s^2] of the base at the samples of a test, as the model has it.

        Every sample of the record: this is what sensors on the block read besides its motion.
        """
        return self._at_samples(self._base(self.in_test(model, test), test), test)

    def in_test(self, model: LoopModel, test: int) -> LoopModel:
        """The model in a test, of one that changes in the course of a campaign."""
        return model.in_test(self.numbers[test])

    def _at_samples(self, motion: BaseMotion, test: int) -> Base:
        known = self._sampled.get((test, id(motion)))
        if known is None or known[0] is not motion:
            if len(self._sampled) > 40 * len(self.tests):
                self._sampled.clear()
            time = self.tests[test].time
            there = base_at(np, motion, time, np.asarray(motion.parameters))
            known = motion, Base(*(value + np.zeros(time.size) for value in there))
            self._sampled[test, id(motion)] = known
        return known[1]

    def seen(self, model: LoopModel, test: int, index: NDArray[np.intp] | slice = slice(None)) -> Seen:
        """What the rotation sensor feels besides the rotation, at the samples of a test or some of them."""
        a_x = self._at_samples(shaking(self._base(self.in_test(model, test), test)), test).a_x
        return Seen(self.tests[test].time[index] - self.spans[test][0], a_x[index])

    def recorded(
        self, model: LoopModel, test: int, theta: Array, index: NDArray[np.intp] | slice = slice(None)
    ) -> Array:
        """Reading of the rotation sensor [rad] at these samples of a test, from a peak or a rest on."""
        there = self.in_test(model, test)
        if not there.remembers:
            return np.asarray(there.reading(theta))
        return there.recorded(theta, self.seen(model, test, index))

    def _driving(self, model: LoopModel, test: int) -> BaseMotion:
        """The base that a run sees: what the model makes of the thinned record.

        What is filtered out of the record is lost of what effects make of it too, and moves the block as little.
        """
        return self._with_effects(model, test, self.driving)

    def _base(self, model: LoopModel, test: int) -> BaseMotion:
        """The base of a test as the model has it, at every sample."""
        return self._with_effects(model, test, self.bases)

    def _with_effects(self, model: LoopModel, test: int, motions: Sequence[PaddedMotion]) -> BaseMotion:
        """What the model makes of the motion of a test; kept, since the parameters of most models leave it alone."""
        acting = tuple(part for part in model.parts if "base_motion" in part.ways())
        if not acting:
            return motions[test]
        key = (test, acting, motions is self.driving)
        known = self._altered.get(key)
        if known is None:
            if len(self._altered) > 80 * len(self.tests):
                self._altered.clear()
            # What an effect makes of a motion is compiled for its number of parameters: once for both kinds.
            size = max(each[test].parameters.size for each in (self.bases, self.driving))
            known = self._altered[key] = model.base(motions[test].filled(size), self.spans[test])
        return known

    def run(self, models: Sequence[LoopModel], jobs: Sequence[Job]) -> list[Answer]:
        """The answers to the jobs, in their order.

        Raises:
            ValueError: a model's effects do not go together or are out of range.
        """
        models, jobs = self._by_test(models, jobs)
        jobs = [self._when(models[job.model], job) for job in jobs]
        return self._run(models, jobs, self._carried(models, jobs))

    def _when(self, model: LoopModel, job: Job) -> Job:
        """The job with its times as they were, where the recorder of the rotation has a clock of its own."""
        if not model.timed:
            return job
        first, last = self.spans[job.test]

        def at(times: Array) -> Array:
            return first + np.minimum(model.moments(times - first), last - first)

        history = [peak.time for peak in job.history]
        start, *before = at(np.array([job.start, *history])).tolist()
        peaks = tuple(peak._replace(time=time) for peak, time in zip(job.history, before, strict=True))
        return job._replace(times=at(job.times), start=start, history=peaks)

    def _carried(self, models: Sequence[LoopModel], jobs: Sequence[Job]) -> list[dict[str, Any]]:
        """What a rotation does not show of the state at the start of each job: slip and height of the corner, impacts.

        A block that slips forgets how fast it did: it is run from peak to peak of the record, each time from the
        rotation that was measured there, and what the run says of the rest is carried over; where its corner sticks at
        the last peak but one, nothing is from before.  One that bounces on a soft floor forgets the sooner, the more is
        lost in it.  What swings inside of a block or yields beside it is carried from the start of the record on.
        """
        known: dict[_Leg, dict[str, Any]] = {}
        tried = {
            i: _Leg(job.model, job.test, job.history[-2].time, 0, job.history[-1].time)
            for i, job in enumerate(jobs)
            if len(job.history) > 1 and isinstance(models[job.model].system, Method2 | ComposedMethod2)
        }
        self._follow(models, {leg: (jobs[i].history[-2], None) for i, leg in tried.items()}, known)
        legs: dict[_Leg, tuple[Peak, _Leg | None]] = {}
        lasts = []
        for i, job in enumerate(jobs):
            sticks = i in tried and not known[tried[i]]
            lasts.append(self._reached(models[job.model], job, legs, 1 if sticks else HISTORY))
        self._follow(models, legs, known)
        remembers = [isinstance(model.system, RememberingBlock) for model in models]
        return [
            _remembered(models[job.model].system, job.struck)
            if remembers[job.model]
            else known[last]
            if last is not None
            else {}
            for job, last in zip(jobs, lasts, strict=True)
        ]

    def _follow(
        self, models: Sequence[LoopModel], legs: Mapping[_Leg, tuple[Peak, _Leg | None]],
        known: dict[_Leg, dict[str, Any]],
    ) -> None:  # fmt: skip
        """Put in `known` what a rotation does not show at the end of each leg, one after the other along a way."""
        legs = {leg: way for leg, way in legs.items() if leg not in known}
        was = _true_peaks(models, legs)
        for depth in range(max((leg.depth for leg in legs), default=-1) + 1):
            now = [(leg, before) for leg, (_, before) in legs.items() if leg.depth == depth]
            runs = [Job(leg.model, leg.test, np.array([leg.stop]), *was[leg]) for leg, _ in now]
            states = [known[before] if before is not None else {} for _, before in now]
            for (leg, _), answer in zip(now, self._run(models, runs, states), strict=True):
                known[leg] = _beside_rotation(models[leg.model].system, answer)

    def _reached(
        self, model: LoopModel, job: Job, legs: dict[_Leg, tuple[Peak, _Leg | None]], slips_over: int = HISTORY
    ) -> _Leg | None:
        """The last of the legs by which a job is reached, all of them put in `legs`; none where it begins with all.

        With each leg go the peak where it begins and the leg before it.  Windows of one record share theirs.

        slips_over: peaks over which the slip of a block is carried that slips.
        """
        history, system = job.history, model.system
        if isinstance(system, WITHIN):
            first, _ = self.spans[job.test]
            # What a shaken block carries has been shaken since the start of the record.
            if self.tests[job.test].kind != "free" and job.start > first:
                history = (Peak(first, float(model.reading(0.0)), 0.0), *history)
        elif isinstance(system, BlockOnSoftFloor):
            history = _not_forgotten(system, history, job.start)
        else:
            history = history[-slips_over:] if isinstance(system, Method2 | ComposedMethod2) else ()
        if not history:
            return None
        stops = [*(peak.time for peak in history[1:]), job.start]
        path = [_Leg(job.model, job.test, history[0].time, k, stop) for k, stop in enumerate(stops)]
        for k in range(len(path) - 1, -1, -1):
            if path[k] in legs:
                break
            legs[path[k]] = history[k], path[k - 1] if k else None
        return path[-1]

    def _run(self, models: Sequence[LoopModel], jobs: Sequence[Job], carried: Sequence[dict[str, Any]]) -> list[Answer]:
        systems = [model.system for model in models]
        groups: dict[Any, list[int]] = {}
        motions: list[BaseMotion] = []
        known: dict[tuple[int, int], tuple[BaseMotion, list[int]]] = {}  # by model and test: its base, and its group
        for i, job in enumerate(jobs):
            place = job.model, job.test
            if place not in known:
                system, motion = systems[job.model], self._driving(models[job.model], job.test)
                hooks = getattr(system.parameters, "hooks", None)
                held = (hooks.accelerations, hooks.restitutions) if hooks is not None else None
                key = (system.flow, held, np.shape(getattr(hooks, "values", ())), motion.kernel, pitch_kernel(motion))
                known[place] = motion, groups.setdefault(key, [])
            motion, group = known[place]
            motions.append(motion)
            group.append(i)
        answers: list[Answer | None] = [None] * len(jobs)
        for members in groups.values():
            for i, answer in zip(members, self._run_group(systems, motions, jobs, carried, members), strict=True):
                answers[i] = answer
        return answers  # type: ignore[return-value]

    def _by_test(self, models: Sequence[LoopModel], jobs: Sequence[Job]) -> tuple[Sequence[LoopModel], Sequence[Job]]:
        """Models that change from test to test as one model for each test that they are asked for."""
        if not any(model.varies for model in models):
            return models, jobs
        every: list[LoopModel] = []
        places: dict[tuple[int, int], int] = {}
        out = []
        for job in jobs:
            key = (job.model, self.numbers[job.test] if models[job.model].varies else 0)
            if key not in places:
                places[key] = len(every)
                every.append(models[job.model].in_test(key[1]))
            out.append(job._replace(model=places[key]))
        return every, out

    def _run_group(
        self, systems: Any, motions: Any, jobs: Sequence[Job], carried: Sequence[dict[str, Any]], members: list[int]
    ) -> list[Answer]:
        own_systems = list(dict.fromkeys(jobs[i].model for i in members))
        own_motions: dict[int, tuple[int, Any]] = {}
        places = {model: k for k, model in enumerate(own_systems)}
        starts = []
        for i in members:
            job = jobs[i]
            place = own_motions.setdefault(id(motions[i]), (len(own_motions), motions[i]))[0]
            y, q = systems[job.model].initial_state(job.theta, job.omega, **carried[i])
            starts.append(Start(places[job.model], place, job.start, float(job.times[-1]), y, q))
        first, most = systems[own_systems[0]], self.most_events
        if most is None:
            longest = max(start.t_end - start.t_start for start in starts)
            most = max(most_events(systems[m], longest) for m in own_systems)
        found = run_windows(
            [systems[m] for m in own_systems], [m for _, m in own_motions.values()], starts,
            [jobs[i].times for i in members], rtol=RTOL, atol=ATOL, max_events=most,
        )  # fmt: skip
        every = found.y[:, first.state_names.index("theta")].copy()
        answers, at = [], 0
        ended = found.fell | found.failed
        for k, (i, fell, failed) in enumerate(zip(members, found.fell.tolist(), found.failed.tolist(), strict=True)):
            part = slice(at, at + jobs[i].times.size)
            at = part.stop
            theta, when = every[part], math.nan
            if ended[k]:
                theta = np.where(np.isnan(theta), _last_side(theta), theta)
            if fell:
                when = float(found.overturning_time[k])
                when = jobs[i].start if math.isnan(when) else when
            answers.append(Answer(theta, found.y[part], found.mode[part], found.s[part], fell, failed, when))
        return answers


def most_events(system: System, seconds: float) -> int:
    """Events after which a run of a fit has failed.

    A block that rocks through r times its slenderness has an impact each 2 sqrt(2 r) / p.
    """
    method = system.method if isinstance(system, ComposedMethod1) else system
    if not isinstance(method, Method1) or method.e < KEEPS_ALL:
        return MOST_EVENTS
    p = method.block.p(method.g)
    return min(MOST_EVENTS, FEWEST_EVENTS + math.ceil(p * seconds / (2.0 * math.sqrt(2.0 * SMALLEST))))


def _not_forgotten(system: BlockOnSoftFloor, history: tuple[Peak, ...], start: float) -> tuple[Peak, ...]:
    """The last peaks since which a block that bounces on its floor has not forgotten how it did; one at the least."""
    # A foot that carries it all sinks and rises again, and this dies away as exp(-c t / 2 m).
    memory = FORGOTTEN * 2.0 / max(system.parameters.c, 1e-9)
    since = [k for k, peak in enumerate(history) if peak.time > start - memory]
    # The run begins at the last peak before that time.
    first = max(since[0] - 1, 0) if since else len(history) - 1
    return history[max(first, len(history) - HISTORY, 0) :]


def _remembered(system: Any, struck: Struck) -> dict[str, Any]:
    """What a block with a memory begins with."""
    return {"impacts": struck.impacts, "pause": struck.pause, "use": struck.use(system.worn_exponent)}


def _beside_rotation(system: Any, answer: Answer) -> dict[str, Any]:
    """Slip and height of the carrying corner at the end of a run; nothing where it sticks to the floor.

    On a soft floor the whole state; of a block with something inside where that is and how it moves.
    """
    mode, y = int(answer.mode[-1]), tuple(map(float, answer.y[-1]))
    if answer.fell or answer.failed or not all(map(math.isfinite, y)):
        return {}
    if isinstance(system, BlockOnSoftFloor):
        return {"beside": (y, Discrete(mode, float(answer.s[-1]), 1.0))}
    state = dict(zip(system.state_names, y, strict=True))
    if isinstance(system, BlockWithInnerMass):
        return {"shift": state["shift"], "slide": system.slide(y, float(answer.s[-1]))}
    if isinstance(system, HystereticBlock):
        return {"strain": state["strain"]}
    if mode in (REST, ROTATION):
        return {}
    if mode in (TRANSLATION_JUMP, ROTATION_JUMP):
        return {"u": state["u"], "z": max(state["z"], 1e-9), "v": state["v"]}
    return {"u": state["u"]}


def _last_side(theta: Array) -> float:
    """+-pi/2 on the side of the last rotation that is known; +pi/2 if none is."""
    known = theta[np.isfinite(theta)]
    return math.copysign(0.5 * math.pi, known[-1]) if known.size else 0.5 * math.pi
