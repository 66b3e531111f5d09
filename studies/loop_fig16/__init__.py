"""The loop on the paper's own gap: what does Method 1 lack at high amplitude?  Fig. 16 before and after.

See          criteria of Method 1 with Housner's restitution and as it was calibrated, of what the loop made of it, and
             of the laboratory; and a history that the loop never saw, before and after.
Paper says   Method 1 goes away from Method 2 and from the tests at high amplitude because a real block slides there.
Laboratory   Method 2 stands for it.  Its ramped tests are recorded up to the fall, with noise on rotation and base;
             the loop is given the records and nothing else.
Run          python -m studies.loop_fig16 [--quick]  ->  build/studies/loop_fig16.nc, then loop_fig16.png and .pdf
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from rocking import G_STANDARD, Method2, Mode, solve
from rocking.effects import load
from rocking.motion import base_at
from studies.campaigns import Campaign, Channel, Conditions, DeclaredBlock, Test
from studies.claims.bounds import CLAIMS
from studies.criteria.overturning import Settings, overturning
from studies.loop.closing import Finding as Closed
from studies.loop.closing import close
from studies.loop.runs.simulation import Job as Run
from studies.loop_fig16.drawing import figure
from studies.running.command_line import one_of, positive
from studies.running.files import BadInputError
from studies.running.labelled import FREQUENCIES, PAPER
from studies.running.parts import Parts, studies_hash
from studies.running.statements import Finding, listed, table
from studies.running.study import Study
from studies.specimens import SIZES, specimen

G = G_STANDARD
MODELS = ("laboratory", "declared", "before", "after")
RECORDED_UNTIL = 0.98
"""Share of the time to overturning after which a test is stopped: the block is caught before it falls."""


@dataclass(frozen=True)
class Laboratory:
    """What is tested, and how well it is measured."""

    block: int = 3
    friction: float = 0.7  # [1]
    tests: tuple[float, ...] = (2.0, 3.0, 3.5, 4.0, 4.5, 5.0)  # frequencies of the ramped tests [Hz]
    rate: float = 250.0  # samples a second
    rotation_noise: float = 5e-4  # one standard deviation [rad]
    base_noise: float = 0.02  # [m/s^2]
    seed: int = 1

    @property
    def system(self) -> Method2:
        """The block as it is."""
        return Method2(specimen(self.block), friction=self.friction)


@dataclass(frozen=True)
class Plan:
    """What is computed."""

    laboratory: Laboratory = Laboratory()
    frequencies: tuple[float, ...] = FREQUENCIES
    sources: str = ""  # of the loop: it decides what is found


@dataclass(frozen=True)
class Criterion:
    """One run of Fig. 16: the laboratory's, or Method 1's with a restitution and with effects, as JSON."""

    block: int
    frequency: float
    friction: float | None  # of the laboratory; None: a model
    restitution: float | None
    effects: str


def campaign(laboratory: Laboratory) -> Campaign:
    """The tests of the laboratory as a measured campaign; what is in it of the block is its size and mass."""
    rng = np.random.default_rng(laboratory.seed)
    channels = (
        Channel("base", "base_acceleration_x", noise=laboratory.base_noise),
        Channel("rotation", "rotation", noise=laboratory.rotation_noise),
    )
    tests = []
    for frequency in laboratory.tests:
        motion = Settings().motion(frequency)
        fall = solve(laboratory.system, motion, t_end=motion.duration, save_at=(), solver="numba").overturning_time
        if math.isnan(fall):
            raise ValueError(
                f"the block stands at the end of the ramp at {frequency:g} Hz: want a motion that fells it"
            )
        time = np.arange(0.0, RECORDED_UNTIL * fall, 1.0 / laboratory.rate)
        run = solve(laboratory.system, motion, t_end=float(time[-1]), save_at=time, solver="numba")
        base = base_at(np, motion, time, np.asarray(motion.parameters)).a_x
        data = {
            "base": base + laboratory.base_noise * rng.standard_normal(time.size),
            "rotation": run.theta + laboratory.rotation_noise * rng.standard_normal(time.size),
        }
        name = f"ramp at {frequency:g} Hz"
        tests.append(Test(name, "forced", time, channels, data, motion=name, overturned=False))
    block = specimen(laboratory.block)
    declared = DeclaredBlock(block.b, block.h, block.d, block.mass)
    return Campaign("Ramped tests of the block by Method 2", declared, Conditions(), channels, tuple(tests))


def _closed(job: Plan) -> dict[str, Any]:
    """What the loop found, as numbers, arrays and texts."""
    found = close(campaign(job.laboratory), g=G, tell=lambda text: print(f"  {text}", file=sys.stderr))
    after = found.after
    return {
        "verdict": found.verdict,
        "effects": json.dumps({name: dict(values) for name, values in after.effects.items()}),
        "alike": json.dumps(found.indistinguishable),
        "intervals": json.dumps(found.intervals),
        "restitution_before": found.before.restitution,
        "restitution_after": after.restitution,
        "errors": json.dumps({name: [e.fit, e.holdout] for name, e in found.errors.items()}),
        "noise_floor": found.noise_floor,
        "candidates": json.dumps([
            {"round": k, "effects": list(t.effects), "rms": t.swing.rms}
            for k, tried in enumerate(found.rounds)
            for t in [tried.onto, *sorted(tried.trials, key=lambda t: t.swing.chi2)]
        ]),
    } | _history(found)  # fmt: skip


def _history(found: Closed) -> dict[str, Any]:
    """The first test held out: time, reading, and what the models before and after make of its base record."""
    index = found.setup.held[0]
    test = found.setup.campaign.tests[index]
    assert test.rotation is not None
    runs = [Run(k, index, test.time, float(test.time[0])) for k in range(2)]
    before, after = found.setup.simulator.run([found.before, found.after], runs)
    return {
        "test": test.id, "time": test.time, "measured": test.rotation, "theta_before": before.theta,
        "theta_after": after.theta,
    }  # fmt: skip


def _criterion(job: Criterion) -> dict[str, Any]:
    if job.friction is not None:
        found = overturning("method2", specimen(job.block), job.frequency, Settings(friction=job.friction))
    else:
        effects = tuple(load(name)(**values) for name, values in json.loads(job.effects).items())
        settings = Settings(restitution=job.restitution, form="nonlinear", effects=effects)
        found = overturning("method1", specimen(job.block), job.frequency, settings)
    sliding = found.mode_fraction[[Mode.SLIDE, Mode.SLIDE_ROTATION]].sum()
    jumping = found.mode_fraction[[Mode.TRANSLATION_JUMP, Mode.ROTATION_JUMP]].sum()
    return {"amplitude": found.amplitude, "sliding": sliding, "jumping": jumping, "note": found.note}


def dataset(plan: Plan, parts: Parts) -> xr.Dataset:
    """Criteria over (model, frequency), what the loop found, and a history that it did not see."""
    [closed] = parts.results([plan], _closed, "loop")
    lab = plan.laboratory
    jobs = [Criterion(lab.block, f, lab.friction, None, "") for f in plan.frequencies]
    jobs += [Criterion(lab.block, f, None, None, "{}") for f in plan.frequencies]
    jobs += [Criterion(lab.block, f, None, closed["restitution_before"], "{}") for f in plan.frequencies]
    after = (closed["restitution_after"], closed["effects"])
    jobs += [Criterion(lab.block, f, None, *after) for f in plan.frequencies]
    runs = parts.results(jobs, _criterion, "loop_fig16")
    shape = (len(MODELS), len(plan.frequencies))
    dims = ("model", "frequency")

    def over(name: str) -> Any:
        return np.array([run[name] for run in runs]).reshape(shape)

    ds = xr.Dataset(
        {
            "overturning_amplitude": (
                dims, over("amplitude"),
                {"units": "m s-2", "long_name": "envelope of the base acceleration at overturning"},
            ),
            "sliding_share": (dims, over("sliding"), {"units": "1", "long_name": "share of the time spent sliding"}),
            "jumping_share": (dims, over("jumping"), {"units": "1", "long_name": "share of the time spent jumping"}),
            "note": (dims, over("note"), {"long_name": "overturned, or why there is no amplitude"}),
            "rotation": (
                ("history", "time"), np.array([closed[k] for k in ("measured", "theta_before", "theta_after")]),
                {"units": "rad", "long_name": "rotation in a test that was held out"},
            ),
        },
        coords={
            "model": ("model", list(MODELS), {"long_name": "model"}),
            "frequency": ("frequency", list(plan.frequencies), {"units": "Hz", "long_name": "frequency of the base"}),
            "history": ("history", ["measured", "before", "after"], {"long_name": "whose history"}),
            "time": ("time", closed["time"], {"units": "s", "long_name": "time"}),
        },
    )  # fmt: skip
    kept = {name: value for name, value in closed.items() if np.ndim(value) == 0}
    return ds.assign_attrs(references=PAPER, block=lab.block, friction=lab.friction, **kept)


def _distance(ds: xr.Dataset, model: str) -> float:
    """Mean |log(model / laboratory)| beyond 3 Hz."""
    a = ds.overturning_amplitude.where(ds.frequency > 3.0, drop=True)
    return float(np.abs(np.log(a.sel(model=model) / a.sel(model="laboratory"))).mean(skipna=False))


def check(ds: xr.Dataset) -> xr.Dataset:
    """Whether sliding was found, with which friction, and how much of the gap is closed."""
    effects = json.loads(ds.attrs["effects"])
    alike = [names for names in json.loads(ds.attrs["alike"]) if "sliding" in names and len(names) <= 3]
    friction = effects.get("sliding", {}).get("friction", math.nan)
    distances = {model: _distance(ds, model) for model in ("declared", "before", "after")}
    errors = {f"{name}, held out": pair[1] for name, pair in json.loads(ds.attrs["errors"]).items()}
    return table([
        Finding(
            CLAIMS["loop_fig16.traced"], float("sliding" in effects or bool(alike)),
            f"{ds.attrs['verdict']}: {', '.join(effects) or 'none'}; alike: {ds.attrs['alike']}",
        ),
        Finding(
            CLAIMS["loop_fig16.friction"], abs(friction / ds.attrs["friction"] - 1.0), listed({"friction": friction}, 5)
        ),
        Finding(
            CLAIMS["loop_fig16.closed"], distances["after"] / distances["before"], listed(distances | errors)
        ),
    ])  # fmt: skip


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--block", type=int, default=3, metavar="N", help="of Table 1 (default: %(default)s)")
    parser.add_argument(
        "--friction", type=float, default=0.7, metavar="MU", help="of the laboratory (default: %(default)s)"
    )
    parser.add_argument("--seed", type=int, default=1, help="of the noise (default: %(default)s)")


def plan_of(options: argparse.Namespace) -> Plan:
    """The plan that the command line asks for.

    Raises:
        BadInputError: an option's value is not one that it can have.
    """
    one_of("--block", [options.block], tuple(SIZES))
    positive("--friction", options.friction)
    if options.friction >= 4.0 / 3.0:
        raise BadInputError(f"--friction {options.friction:g}: want below 4/3 (a corner may jam)")
    if options.seed < 0:
        raise BadInputError(f"--seed {options.seed}: want 0 or more")
    lab = Laboratory(options.block, options.friction, seed=options.seed)
    if options.quick:
        return Plan(replace(lab, tests=(3.0, 4.0, 5.0), rate=125.0), (3.0, 4.0, 5.0), studies_hash())
    return Plan(lab, FREQUENCIES, studies_hash())


def _say(ds: xr.Dataset) -> None:
    for name, (value, low, high) in json.loads(ds.attrs["intervals"]).items():
        print(f"{name} = {value:.5g}  (95 %: {low:.5g} to {high:.5g})")


STUDY = Study(
    name="loop_fig16",
    title="What Method 1 lacks at high amplitude, found by the loop; Fig. 16 before and after",
    about=(
        "Method 2 stands for a laboratory that tests a block under growing shaking. The loop is given the records and "
        "Method 1, and has to find what Method 1 lacks."
    ),
    plan=plan_of,
    dataset=dataset,
    figures={"loop_fig16": figure},
    check=check,
    arguments=_arguments,
    say=_say,
    example='(ds.overturning_amplitude / 9.80665).plot.line(x="frequency")',
)


def main(argv: Sequence[str]) -> None:
    """Compute, save, then draw."""
    from studies.running.study import make

    make(STUDY, list(argv))
