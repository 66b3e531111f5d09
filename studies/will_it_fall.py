"""Will it rock, will it fall, and with what margin?  One block and one motion, answered on the command line.

A record is run as it is and mirrored (the block turned round), each with three restitutions, then scaled up and down in
steps of 1 % until the block falls: single responses of a rocking block hang on details, so that the answer is that of
several runs.  Where only a peak acceleration is known, the motion is taken to be one cycle of a sine: with --period or
--pgv the same is done for it; without, the answer is the shortest period that fells the block, and the longer ones that
do not: between those that fell it after an impact and those that fell it without one it may stand.

Source       West's formula, eq. (1) of Winkler, Meguro & Yamazaki (1995), for rocking; Ishiyama (1982) for the peak
             velocity below which nothing falls; Zhang & Makris (2001) for falls after an impact and without one
Status       Method 1, nonlinear: no sliding and no jump.  Against published amplitudes of one-cycle sines (tests)
Run          python -m studies.will_it_fall 0.30 1.80 --pga 0.3g
             python -m studies.will_it_fall 0.30 1.80 --record FILE
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from excitation import PiecewiseLinear, Record, read
from rocking import Block, Method1, solve, solve_batch
from rocking.batch import OUTCOMES, BatchResult
from rocking.block import G_STANDARD
from rocking.closed_forms import ishiyama_velocity, west_acceleration
from studies.running.command_line import run
from studies.running.files import BadInputError

STEP = 1.01
"""Ratio of neighbouring factors at which a motion is tried."""

FACTORS = 400
"""Factors that are tried, from what starts rocking on: up to 53 times it."""

SPREAD = (0.95, 1.0, 1.05)
"""Restitutions that are tried, over the block's own (never above 1)."""

SAMPLES_PER_CYCLE = 200
PERIODS = np.geomspace(0.05, 20.0, 241)
"""Of the cycles that are tried where only a peak is known [s], in steps of 2.5 %."""

IN_WORDS = {1: "one restitution", 2: "two restitutions within 5 %", 3: "three restitutions within 5 %"}


@dataclass(frozen=True)
class Answer:
    """What becomes of a block under a motion; accelerations [m/s^2], times [s], tilt over that of balance [1]."""

    breadth: float
    height: float
    motion: str
    peak: float
    rocking_starts_at: float
    rocks: bool
    onset_time: float | None
    runs: int
    runs_that_fall: int
    falls: str  # "yes", "no", or "perhaps" where the runs disagree
    largest_tilt: float  # above 1 where a block passes its balance and is thrown back; a run that falls counts as 1
    falls_first_at: float | None  # factor on the motion; None if it never does up to `tried_up_to`
    falls_last_at: float | None  # factor at which the most stable of the runs falls first
    tried_up_to: float


def restitutions(block: Block, restitution: float | None) -> tuple[float, ...]:
    """The restitutions of the runs."""
    e = Method1(block, restitution=restitution).e
    return tuple(dict.fromkeys(min(1.0, share * e) for share in SPREAD))


def _none_failed(result: BatchResult) -> BatchResult:
    """The same; ValueError where a run failed, of which nobody can say whether the block stands."""
    failed = int(np.sum(result.outcome == OUTCOMES.index("failed")))
    if failed:
        raise ValueError(f"{failed} of {len(result)} runs failed before they told whether the block falls; want none")
    return result


def _fell(
    systems: Sequence[Method1], record: Record, factors: np.ndarray, t_end: float
) -> tuple[np.ndarray, np.ndarray]:
    """(whether it falls, largest tilt over that of balance), each of shape (system, factor), of a record scaled."""
    motions = [PiecewiseLinear(record.time_step, f * record.acceleration) for f in factors]
    many = [system for system in systems for _ in motions]
    result = _none_failed(solve_batch(many, motions * len(systems), t_end=t_end, solver="taylor"))
    shape = (len(systems), len(motions))
    tilt = result.peak_rotation / systems[0].theta_c
    return np.reshape(result.overturned, shape), np.reshape(tilt, shape)


def answer(block: Block, record: Record, restitution: float | None = None) -> Answer:
    """Answer for one block under one horizontal record.

    Args:
        block: the block.
        record: acceleration of the base; it is run as it is and mirrored.
        restitution: angular velocity after / before an impact [1], in place of Housner's.

    Raises:
        ValueError: the restitution is out of range, the record is all zeros, or a run failed.
    """
    peak = float(np.max(np.abs(record.acceleration)))
    if peak == 0.0:
        raise ValueError(f"{record!r}: want a record that is not zero throughout")
    systems = [Method1(block, restitution=e) for e in restitutions(block, restitution)]
    starts = west_acceleration(block.b, block.h)
    # A free block has as good as fallen or come down after some 20/p.
    t_end = record.duration + 20.0 / block.p()
    factors = starts / peak * STEP ** np.arange(FACTORS)
    found = [_fell(systems, r, factors, t_end)[0] for r in (record, record.with_samples(-record.acceleration))]
    fell = np.concatenate(found)
    first = [float(factors[row.argmax()]) if row.any() else math.inf for row in fell]
    now = [_fell(systems, r, np.ones(1), t_end) for r in (record, record.with_samples(-record.acceleration))]
    falls_now, tilt = (np.concatenate([part[i] for part in now]) for i in (0, 1))
    onset = solve(
        systems[1 % len(systems)], PiecewiseLinear(record.time_step, record.acceleration), t_end=t_end
    ).onset_time
    count, runs = int(falls_now.sum()), len(fell)
    return Answer(
        breadth=block.b,
        height=block.h,
        motion=repr(record),
        peak=peak,
        rocking_starts_at=starts,
        rocks=not math.isnan(onset),
        onset_time=None if math.isnan(onset) else onset,
        runs=runs,
        runs_that_fall=count,
        falls="yes" if count == runs else "perhaps" if count else "no",
        largest_tilt=float(np.where(falls_now, 1.0, tilt).max()),
        falls_first_at=_finite(min(first)),
        falls_last_at=_finite(max(first)),
        tried_up_to=float(factors[-1]),
    )


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def one_cycle(peak: float, period: float) -> Record:
    """One cycle of a sine with this peak acceleration [m/s^2] and period [s]; its peak velocity is peak period / pi."""
    t = np.arange(SAMPLES_PER_CYCLE + 1) / SAMPLES_PER_CYCLE
    return Record(period / SAMPLES_PER_CYCLE, peak * np.sin(2.0 * math.pi * t), source=f"one cycle of {period:.3g} s")


def felled(block: Block, peak: float, restitution: float | None = None) -> NDArray[np.bool_]:
    """Whether one cycle of a sine of this peak [m/s^2] fells the block in any of the runs, at each of `PERIODS`.

    Raises:
        ValueError: the restitution is out of range, or a run failed.
    """
    systems = [Method1(block, restitution=e) for e in restitutions(block, restitution)]
    pulses = [one_cycle(peak, period) for period in PERIODS.tolist()]
    # The mirrored pulse gives the mirrored run, from a block at rest.
    motions = [PiecewiseLinear(pulse.time_step, pulse.acceleration) for pulse in pulses] * len(systems)
    many = [system for system in systems for _ in pulses]
    t_end = float(PERIODS[-1]) + 20.0 / block.p()
    result = _none_failed(solve_batch(many, motions, t_end=t_end, solver="taylor"))
    return np.asarray(np.reshape(result.overturned, (len(systems), len(pulses))).any(axis=0))


def felling_period(block: Block, peak: float, restitution: float | None = None) -> float | None:
    """Shortest period [s] of one cycle of a sine of this peak [m/s^2] that fells the block in any of the runs.

    None if none up to 20 s does.  Searched in steps of 2.5 % from 0.05 s on; longer ones need not fell it.

    Raises:
        ValueError: as of `felled`.
    """
    fell = felled(block, peak, restitution)
    return float(PERIODS[fell.argmax()]) if fell.any() else None


def standing_again(fell: NDArray[np.bool_]) -> list[tuple[float, float]]:
    """Stretches of `PERIODS`, first and last of each [s], longer than one that fells, at which the block stands."""
    if not fell.any():
        return []
    stands = ~fell & (np.arange(fell.size) > fell.argmax())
    edges = np.flatnonzero(np.diff(np.concatenate([[False], stands, [False]]).astype(int)))
    return [(float(PERIODS[i]), float(PERIODS[j - 1])) for i, j in zip(edges[::2], edges[1::2], strict=True)]


def _in_words(found: Answer) -> str:
    tried = IN_WORDS[found.runs // 2]
    runs = f"{found.runs_that_fall} of {found.runs} runs: as it is and mirrored, {tried}"
    lines = [_block_line(found.breadth, found.height, found.rocking_starts_at), f"motion   {found.motion}"]
    share = found.peak / found.rocking_starts_at
    since = f", from {found.onset_time:.2f} s on" if found.rocks else ""
    lines.append(f"rocks    {'yes' if found.rocks else 'no'}: the peak is {share:.2f} times what starts rocking{since}")
    tilt = "" if found.runs_that_fall else f"; largest tilt {found.largest_tilt:.2f} of that of balance"
    lines.append(f"falls    {found.falls} ({runs}){tilt}")
    if found.falls_first_at is None:
        lines.append(f"margin   stands up to {found.tried_up_to:.3g} times this motion, the largest that was tried")
    else:
        last = "never in others" if found.falls_last_at is None else f"in all of the runs by {found.falls_last_at:.2f}"
        lines.append(f"margin   first falls at {found.falls_first_at:.2f} times this motion ({last})")
    return "\n".join(lines)


def _block_line(b: float, h: float, starts: float) -> str:
    return f"block    {b:g} x {h:g} m starts to rock at {starts:.3g} m/s^2 ({starts / G_STANDARD:.3g} g)"


def _peak_in_words(block: Block, peak: float, restitution: float | None) -> tuple[str, dict[str, object]]:
    """The answer where a peak is all that is known."""
    restitutions(block, restitution)  # refuses one that cannot be before anything is said
    starts = west_acceleration(block.b, block.h)
    lines = [_block_line(block.b, block.h, starts)]
    facts: dict[str, object] = {"breadth": block.b, "height": block.h, "peak": peak, "rocking_starts_at": starts}
    facts |= {"rocks": peak > starts, "felling_period": None, "stands_again": [], "shortest_period_tried": None}
    facts |= {"velocity_limit": ishiyama_velocity(block)}
    if peak <= starts:
        lines += [f"rocks    no: {peak:.3g} m/s^2 is {peak / starts:.2f} times what starts rocking", "falls    no"]
        lines.append(f"margin   rocking starts at {starts / peak:.2f} times this peak")
        return "\n".join(lines), facts
    lines.append(f"rocks    yes: {peak:.3g} m/s^2 is {peak / starts:.2f} times what starts rocking")
    fell = felled(block, peak, restitution)
    facts["shortest_period_tried"] = float(PERIODS[0])
    if not fell.any():
        lines.append(f"falls    no: not under one cycle of a sine, whatever its period up to {PERIODS[-1]:g} s")
    else:
        period, again = float(PERIODS[fell.argmax()]), standing_again(fell)
        facts |= {"felling_period": period, "stands_again": again}
        or_less = " or less" if fell[0] else ""  # none shorter is tried
        lines.append(
            f"falls    if the push lasts: the shortest cycle of a sine of this peak that fells it takes {period:.2f} s"
            f"{or_less}\n         (peak velocity {peak * period / math.pi:.2g} m/s{or_less})"
        )
        if again:
            listed = ", ".join(f"{a:.2f} s" if f"{a:.2f}" == f"{b:.2f}" else f"{a:.2f} to {b:.2f} s" for a, b in again)
            lines.append(f"         but it stands some longer ones: {listed}")
    limit = ishiyama_velocity(block)
    lines.append(
        f"margin   by Ishiyama's rule (1982) nothing fells it below a peak velocity of {limit:.2g} m/s;\n"
        "         give --period, --pgv or --record for a number"
    )
    return "\n".join(lines), facts


def acceleration(text: str) -> float:
    """m/s^2, or g where the number ends in g."""
    in_g = text.strip().lower().endswith("g")
    try:
        value = float(text.strip()[:-1] if in_g else text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r}: want a number [m/s^2], or one with g as in 0.3g") from None
    if not (math.isfinite(value) and value > 0.0):
        raise argparse.ArgumentTypeError(f"{text!r}: want a positive number")
    return value * G_STANDARD if in_g else value


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m studies.will_it_fall",
        description="Will a free-standing block rock, will it fall, and with what margin?",
        epilog="example: a bookshelf of 0.30 x 1.80 m and a peak of 0.3 g: "
        "python -m studies.will_it_fall 0.30 1.80 --pga 0.3g",
    )
    parser.add_argument("breadth", type=float, help="breadth of the block in the direction of shaking [m]")
    parser.add_argument("height", type=float, help="height [m]")
    motion = parser.add_mutually_exclusive_group(required=True)
    motion.add_argument("--pga", type=acceleration, metavar="A", help="peak acceleration of the floor [m/s^2, or 0.3g]")
    motion.add_argument("--record", type=Path, metavar="FILE", help="a record in any format of python -m excitation")
    parser.add_argument("--period", type=float, metavar="T", help="with --pga: one cycle of a sine of this period [s]")
    parser.add_argument("--pgv", type=float, metavar="V", help="with --pga: one cycle of this peak velocity [m/s]")
    parser.add_argument("--component", metavar="NAME", help="with --record: its strongest horizontal one if not given")
    parser.add_argument("--units", help="with --record: unit of acceleration, where it states none")
    parser.add_argument("--restitution", type=float, metavar="E", help="angular velocity after / before an impact "
                        "(default: Housner's for this block)")  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print the answer as JSON")
    return parser


def chosen(records: Sequence[Record], component: str | None) -> Record:
    """The component asked for, or the strongest horizontal one; its mean is taken off.

    Raises:
        ValueError: there is none of that name, or no horizontal one.
    """
    names = ", ".join(record.component or "?" for record in records)
    found = [r for r in records if (not r.vertical if component is None else r.component == component)]
    if not found:
        wanted = "a horizontal component" if component is None else f"component {component!r}"
        raise ValueError(f"{records[0].source}: holds {names}, want {wanted}")
    record = max(found, key=lambda r: float(np.max(np.abs(r.acceleration))))
    return record.with_samples(record.acceleration - np.mean(record.acceleration), note="mean removed")


def _record(options: argparse.Namespace) -> Record | None:
    """The motion to run; None where a peak is all that is known."""
    for name in ("component", "units"):
        if getattr(options, name) is not None and options.record is None:
            raise BadInputError(f"--{name} {getattr(options, name)}: want it with --record, not with --pga")
    for name in ("period", "pgv"):
        value = getattr(options, name)
        if value is not None and options.record is not None:
            raise BadInputError(f"--{name} {value}: want it with --pga, not with --record")
        if value is not None and not (math.isfinite(value) and value > 0.0):
            raise BadInputError(f"--{name} {value}: want a positive number")
    if options.record is not None:
        return chosen(read(options.record, units=options.units), options.component)
    if options.period is not None and options.pgv is not None:
        raise BadInputError("--period and --pgv: want one of them, they say the same")
    if options.period is None and options.pgv is None:
        return None
    return one_cycle(options.pga, options.period or math.pi * options.pgv / options.pga)


def main(arguments: list[str]) -> None:
    """Answer one question.

    Raises:
        BadInputError: what was asked for cannot be answered, in one sentence.
    """
    options = _parser().parse_args(arguments)
    try:
        block, record = Block(options.breadth, options.height), _record(options)
        if record is None:
            text, facts = _peak_in_words(block, options.pga, options.restitution)
        else:
            found = answer(block, record, options.restitution)
            text, facts = _in_words(found), asdict(found)
    except OSError as error:
        raise BadInputError(f"{options.record}: want a file that can be read ({error.strerror})") from error
    except ValueError as error:
        raise BadInputError(str(error)) from error
    print(json.dumps(facts, indent=1) if options.json else text)
    sys.stdout.flush()


if __name__ == "__main__":
    run(main)
