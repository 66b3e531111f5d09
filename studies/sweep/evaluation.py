"""The criteria at the points of a chunk: what a worker computes, on this machine or another.

Under a ramp, the criterion of overturning is the envelope when |theta| last passes the balance before the fall, that of
rocking the largest |a_x| until the block begins to rock.  Under a pulse they are the least amplitudes that fell the
block and that set it rocking, found among amplitudes in geometric steps and then by bisection; what fells it in a
narrower band than a step is missed.  After a pulse a block is watched for 20/p or more.

Source   Winkler, Meguro & Yamazaki (1995), "Criteria of overturning for single blocks"
Status   each point against a run by itself; the pulse against the closed form of a half sine (tests)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dem
import excitation
from excitation import RampedSinusoid
from excitation.motion import Motion
from rocking import WOOD_DENSITY, Block, solve, solve_batch
from rocking.batch import OUTCOMES as OUTCOMES_OF_RUNS
from studies.criteria.columns import G
from studies.criteria.free_vibration import fit_dashpot
from studies.criteria.overturning import STIFFNESS, Settings, system_of
from studies.criteria.rocking_onset import rocking_start
from studies.specimens import specimen
from studies.sweep.declared import RAMP, Sweep, from_mapping

FELL, STANDS, DECLINED, FAILED = 0, 1, 2, 3
OUTCOMES = "overturned stands declined failed"
OFF_THE_FLOOR = 5e-5
"""Height of a corner [m] from which a distinct element rocks."""

VARIABLES: Mapping[str, tuple[str, str]] = {
    "overturning_amplitude": ("m s-2", "base acceleration at overturning"),
    "overturning_time": ("s", "time of overturning under a ramp"),
    "rocking_amplitude": ("m s-2", "base acceleration at the start of rocking"),
    "rocking_time": ("s", "time of the start of rocking under a ramp"),
}
"""Units and names of the numbers; `outcome` comes with them."""

Point = dict[str, Any]
Array = NDArray[np.float64]


@dataclass
class Found:
    """Numbers of a chunk, shape (point,) each, and why points have none: "" where they could be computed."""

    values: dict[str, NDArray[np.float64]]
    outcome: NDArray[np.int8]
    declined: list[str]

    @classmethod
    def nothing(cls, count: int) -> Found:
        """No numbers, standing."""
        return cls(
            {name: np.full(count, math.nan) for name in VARIABLES}, np.full(count, STANDS, np.int8), [""] * count
        )

    def without(self, declined: Sequence[str]) -> Found:
        """The same, but for the points that were declined."""
        self.declined = list(declined)
        self.outcome[[bool(reason) for reason in declined]] = DECLINED
        return self


def points_of(sweep: Sweep, where: Sequence[slice]) -> list[Point]:
    """The points of a chunk in C order."""
    parts = [values[part] for values, part in zip(sweep.axes.values(), where, strict=True)]
    return [dict(sweep.fixed) | dict(zip(sweep.axes, point, strict=True)) for point in product(*parts)]


def block_of(point: Point, depth: float) -> Block:
    """The block of a point."""
    return Block(point["slenderness"] * point["h"], point["h"], depth, density=WOOD_DENSITY)


def _settings(sweep: Sweep, point: Point, block: Block) -> Settings:
    housner = max(block.housner_restitution, 0.0)  # below zero a block lands on both corners and stops
    restitution = None if point["restitution"] == 1.0 else point["restitution"] * housner
    run = sweep.run
    return Settings(friction=point["friction"], restitution=restitution, form=run["form"], solver=run["solver"])


def _motion(sweep: Sweep, point: Point, amplitude: float) -> Motion:
    kind = sweep.excitations[point["excitation"]]
    if kind["kind"] == RAMP:
        return RampedSinusoid(point["frequency"], kind["duration"], amplitude)
    pulse: Any = excitation.formulas()[kind["kind"]]
    made: Motion = pulse(amplitude=amplitude, period=1.0 / point["frequency"])
    return made


def _span(sweep: Sweep, point: Point) -> float:
    """End of the runs of a point [s]: of a pulse, once the block has as good as fallen or come down.

    That takes some 20/p, here the next power of two [s], so that blocks of many sizes have few spans.
    """
    kind = sweep.excitations[point["excitation"]]
    if kind["kind"] == RAMP:
        return float(kind["duration"])
    needed = 2.0 ** math.ceil(math.log2(20.0 / block_of(point, sweep.run["depth"]).p()))
    return 5.0 / point["frequency"] + max(float(kind["after"]), needed)


def _peak(motion: Motion, until: float) -> float:
    """Largest |a_x| [m/s^2] until a time [s]."""
    t = np.append(np.arange(0.0, until, 0.01 * min(motion.max_step * 20.0, until)), until)
    return float(np.abs(motion(t)[0]).max())


@dataclass
class Ends:
    """How runs ended, shape (run,) each; those that could not be made have a sentence in `declined`."""

    fell: NDArray[np.bool_]
    failed: NDArray[np.bool_]
    overturning_time: NDArray[np.float64]  # [s]
    rocking_time: NDArray[np.float64]  # [s]
    declined: NDArray[np.object_]

    @classmethod
    def nothing(cls, count: int, declined: str = "") -> Ends:
        """Runs of which nothing is known, standing, all declined with one sentence where there is one."""
        unknown = np.full(count, math.nan)
        return cls(
            np.zeros(count, bool), np.zeros(count, bool), unknown, unknown.copy(), np.full(count, declined, object)
        )  # fmt: skip


def _analytic(sweep: Sweep, points: Sequence[Point], amplitudes: Sequence[float]) -> Ends:
    """Runs by Method 1 or 2, all of one kind and length."""
    blocks = [block_of(point, sweep.run["depth"]) for point in points]
    systems = [system_of(p["method"], b, _settings(sweep, p, b)) for p, b in zip(points, blocks, strict=True)]
    motions: list[Any] = [_motion(sweep, p, a) for p, a in zip(points, amplitudes, strict=True)]
    done = solve_batch(
        systems, motions, t_end=max(_span(sweep, p) for p in points), solver=sweep.run["solver"],
        rtol=sweep.run["rtol"], atol=sweep.run["atol"],
    )  # fmt: skip
    ends = Ends.nothing(len(points))
    ends.fell, ends.failed = done.overturned, done.outcome == OUTCOMES_OF_RUNS.index("failed")
    ends.overturning_time, ends.rocking_time = done.overturning_time, done.onset_time.copy()
    # Where friction is no more than b/h a block leaves rest by sliding, and the summary knows no more of when it turns.
    slid = np.array([p["method"] == "method2" and p["friction"] < 1.001 * p["slenderness"] for p in points])
    ends.rocking_time[slid] = math.nan
    for i in np.flatnonzero(slid & (done.peak_rotation > 0.0)).tolist():
        ends.rocking_time[i] = rocking_start(
            solve(
                systems[i], motions[i], t_end=_span(sweep, points[i]), solver=sweep.run["solver"],
                rtol=sweep.run["rtol"], atol=sweep.run["atol"], save_at=(),
            )
        )  # fmt: skip
    return ends


@lru_cache(maxsize=64)
def _fitted(restitution: float) -> tuple[float, str]:
    block = specimen(1)
    try:
        return fit_dashpot(
            block, restitution * max(block.housner_restitution, 0.0), kn=STIFFNESS, ks=STIFFNESS
        ).damping, ""
    except ValueError as refusal:
        return math.nan, str(refusal)


def dashpot(restitution: float) -> float:
    """Dashpot [N s/m] that gives Block 1 this restitution over Housner's in a free vibration, as the paper fitted one.

    Raises:
        ValueError: none does.
    """
    damping, refusal = _fitted(restitution)
    if refusal:
        raise ValueError(refusal)
    return damping


def _distinct_elements(sweep: Sweep, points: Sequence[Point], amplitudes: Sequence[float]) -> Ends:
    """The same runs by distinct elements, one after the other."""
    ends = Ends.nothing(len(points))
    for i, (point, amplitude) in enumerate(zip(points, amplitudes, strict=True)):
        block = block_of(point, sweep.run["depth"])
        contact = dem.Contact(point["friction"], damping=dashpot(point["restitution"]), kn=STIFFNESS, ks=STIFFNESS)
        run = dem.simulate_assembly(
            dem.single(block.b, block.h, block.d, block.density), _motion(sweep, point, amplitude),
            t_end=_span(sweep, point), contact=contact,
            # A heavy block leans on its springs by more than that before a corner is off; one that slides may go far.
            criteria=dem.Criteria(gap=OFF_THE_FLOOR, rotation=1.0, margin=1e3),
        )  # fmt: skip
        ends.failed[i] = run.ending in (dem.Ending.UNSTABLE, dem.Ending.LEFT)
        ends.fell[i] = bool(run.falls)
        ends.overturning_time[i] = run.overturning_time
        ends.rocking_time[i] = min((s.time for s in run.separations), default=math.nan)
    return ends


def _run(sweep: Sweep, points: Sequence[Point], amplitudes: Sequence[float]) -> Ends:
    """Runs of one method; those that it or the solver declines have the sentence."""
    try:
        if points[0]["method"] == "dem":
            return _distinct_elements(sweep, points, amplitudes)
        return _analytic(sweep, points, amplitudes)
    except ValueError as refusal:
        if len(points) == 1:
            return Ends.nothing(1, str(refusal))
    # One of them is declined: each by itself, so that the others have their numbers.
    each = [_run(sweep, [p], [a]) for p, a in zip(points, amplitudes, strict=True)]
    return Ends(*(np.concatenate([getattr(e, one.name) for e in each]) for one in fields(Ends)))


def _declines(sweep: Sweep, point: Point) -> str:
    """Why a point cannot be computed; empty if it can."""
    try:
        block = block_of(point, sweep.run["depth"])
        if point["method"] == "dem":
            dashpot(point["restitution"])
        else:
            system_of(point["method"], block, _settings(sweep, point, block))
    except ValueError as refusal:
        return str(refusal)
    return ""


def _ramps(sweep: Sweep, points: Sequence[Point]) -> Found:
    kind = sweep.excitations[points[0]["excitation"]]
    ends = _run(sweep, points, [kind["final_amplitude"]] * len(points))
    found = Found.nothing(len(points))
    for i, point in enumerate(points):
        motion: Any = _motion(sweep, point, kind["final_amplitude"])
        fell, began = ends.overturning_time[i], ends.rocking_time[i]
        found.values["overturning_time"][i], found.values["rocking_time"][i] = fell, began
        if ends.fell[i]:
            found.values["overturning_amplitude"][i] = float(motion.envelope(fell))
        if not math.isnan(began):
            found.values["rocking_amplitude"][i] = _peak(motion, began)
    found.outcome[:] = np.where(ends.failed, FAILED, np.where(ends.fell, FELL, STANDS))
    return found.without(ends.declined.tolist())


def _least(
    sweep: Sweep, points: Sequence[Point], ladder: Array, seen: NDArray[np.bool_],
    felt: Callable[[Ends], NDArray[np.bool_]],
) -> Array:  # fmt: skip
    """Least amplitude at which something is felt [m/s^2]: the first of the ladder, and then by bisection.

    Args:
        sweep: the sweep.
        points: of it, all with one excitation.
        ladder: amplitudes [m/s^2] that were tried, shape (point, step).
        seen: whether it was felt there, of the same shape.
        felt: whether it is, in other runs.
    """
    first, rows = seen.argmax(axis=1), np.arange(len(points))
    low, high = ladder[rows, np.maximum(first - 1, 0)], ladder[rows, first]
    for _ in range(int(sweep.excitations[points[0]["excitation"]]["bisections"])):
        middle = 0.5 * (low + high)
        inside = felt(_run(sweep, points, middle.tolist()))
        low, high = np.where(inside, low, middle), np.where(inside, middle, high)
    return np.asarray(np.where(seen.any(axis=1), high, math.nan))


def _pulses(sweep: Sweep, points: Sequence[Point]) -> Found:
    kind = sweep.excitations[points[0]["excitation"]]
    steps, found = int(kind["steps"]), Found.nothing(len(points))
    west = np.array([0.999 * point["slenderness"] * G for point in points])
    ladder = west[:, None] * np.maximum(kind["highest"] / west, 1.0)[:, None] ** (np.arange(steps + 1) / steps)
    ends = _run(sweep, [point for point in points for _ in range(steps + 1)], ladder.ravel().tolist())
    declined = [next(filter(None, row), "") for row in ends.declined.reshape(ladder.shape)]
    able = np.array([not reason for reason in declined])
    kept = [point for point, one in zip(points, able, strict=True) if one]

    def least(felt: Callable[[Ends], NDArray[np.bool_]]) -> Array:
        values = np.full(len(points), math.nan)
        if kept:
            values[able] = _least(sweep, kept, ladder[able], felt(ends).reshape(ladder.shape)[able], felt)
        return values

    fells = least(lambda e: e.fell)
    found.values["overturning_amplitude"] = fells
    found.values["rocking_amplitude"] = least(lambda e: ~np.isnan(e.rocking_time))
    failed = ends.failed.reshape(ladder.shape).any(axis=1)
    found.outcome[:] = np.where(failed, FAILED, np.where(np.isnan(fells), STANDS, FELL))
    return found.without(declined)


def evaluate(declared: Mapping[str, Any], where: Sequence[tuple[int, int]]) -> dict[str, Any]:
    """What a chunk gives: the variables by name and `outcome`, shape (point,), and `declined`, sentences.

    Args:
        declared: the sweep, as `Sweep.as_json` says it.
        where: (start, stop) along each axis.
    """
    import numba

    numba.set_num_threads(1)  # chunks run side by side
    sweep = from_mapping(declared)
    points = points_of(sweep, [slice(*pair) for pair in where])
    found, reasons = Found.nothing(len(points)), set[str]()
    groups: dict[tuple[Any, ...], list[int]] = {}
    for i, point in enumerate(points):
        reason = _declines(sweep, point)
        if reason:
            found.outcome[i] = DECLINED
            reasons.add(f"{point['method']}: {reason}")
            continue
        # Runs of a batch end together.
        ramp = sweep.excitations[point["excitation"]]["kind"] == RAMP
        key = (
            point["method"],
            point["excitation"],
            ramp,
            _span(sweep, point),
            point["restitution"] == 1.0,
        )
        groups.setdefault(key, []).append(i)
    for key, members in groups.items():
        part = (_ramps if key[2] else _pulses)(sweep, [points[i] for i in members])
        for name, values in part.values.items():
            found.values[name][members] = values
        found.outcome[members] = part.outcome
        reasons |= {f"{key[0]}: {reason}" for reason in part.declined if reason}
    return {**found.values, "outcome": found.outcome, "declined": sorted(reasons)}
