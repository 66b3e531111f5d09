"""Contact judgement: which parameters decide that two bodies touch, and what each of them moves.

See          medians within the grey band are moved no more than by chance; the skin and the distance of updating move
             nothing but the cost; where the column falls at once, nothing moves the criterion of overturning.
Paper says   nobody had yet examined how much these parameters matter (Winkler, Meguro & Yamazaki 1995).
Run          python -m studies.contact_judgement [--quick]  ->  build/studies/contact_judgement.nc, .png and .pdf
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from dem.drop import squared_difference
from studies.contact_judgement.drawing import figure
from studies.contact_judgement.runs import (
    DEFAULT,
    DROP_HEIGHT,
    DROP_PIVOT,
    DROP_SAMPLES,
    QUICK,
    TREMBLE,
    UNITS,
    VARIATIONS,
    Variation,
    column_run,
    drop,
    pivot,
)
from studies.contact_judgement.statements import chance, check, shifts
from studies.criteria.columns import ColumnSettings, G
from studies.running.command_line import positive
from studies.running.files import BadInputError
from studies.running.labelled import frequency_axis
from studies.running.parts import Parts, Result
from studies.running.study import Study


@dataclass(frozen=True)
class JudgementPlan:
    """Everything that decides the dataset."""

    settings: ColumnSettings
    variations: tuple[Variation, ...] = VARIATIONS
    frequencies: tuple[float, ...] = (2.0, 3.0, 4.0)
    trials: int = 6
    default_trials: int = 24  # of the defaults, from which chance is known


def arguments(parser: argparse.ArgumentParser) -> None:
    """--trials and --ramp."""
    parser.add_argument("--trials", type=int, default=6, metavar="N", help="runs of each point (default: %(default)s)")
    parser.add_argument(
        "--ramp", type=float, default=10.0, metavar="G",
        help="acceleration at the end of the 90 s ramp, in g (default: %(default)s)",
    )  # fmt: skip


def plan_of(options: argparse.Namespace) -> JudgementPlan:
    """The plan that the command line asks for."""
    positive("--ramp", options.ramp)
    if options.trials < 2:
        raise BadInputError(f"--trials {options.trials}: want at least 2")
    settings = ColumnSettings(ramp=options.ramp * G)
    if options.quick:
        return JudgementPlan(settings, QUICK, (4.0,), 2, 4)
    return JudgementPlan(settings, trials=options.trials, default_trials=4 * options.trials)


def _jobs(plan: JudgementPlan) -> list[tuple[Variation, float, int, ColumnSettings]]:
    default = [(DEFAULT, f, trial) for f in plan.frequencies for trial in range(plan.default_trials)]
    varied = [(v, f, trial) for v in plan.variations for f in plan.frequencies for trial in range(plan.trials)]
    return [(*job, plan.settings) for job in default + varied]


def _height(job: tuple[Variation | None, ColumnSettings]) -> Result:
    """Of the falling block, with a variation, or of the pivot where there is none."""
    variation, settings = job
    return {"height": pivot(settings) if variation is None else drop(variation, settings)}


def _variables(plan: JudgementPlan, found: list[Result], drops: list[Result]) -> dict[str, Any]:
    many, few = len(plan.frequencies), len(plan.variations)
    first = many * plan.default_trials

    def default(name: str) -> np.ndarray:
        return np.array([run[name] for run in found[:first]]).reshape(many, plan.default_trials)

    def varied(name: str) -> np.ndarray:
        return np.array([run[name] for run in found[first:]]).reshape(few, many, plan.trials)

    reference, others = drops[0]["height"], [d["height"] for d in drops[1:]]
    sums = np.array([squared_difference(reference, z) for z in others])
    envelope = {"units": "m s-2", "long_name": "envelope of the base acceleration at overturning"}
    cost = {"units": "1", "long_name": "processor time over simulated time"}
    lists = {"units": "s-1", "long_name": "lists of contacts made in a simulated second"}
    eq8 = {"units": "m2", "long_name": "sum of squared differences of a falling block from the pivot"}
    eq8["reference"] = "Winkler, Meguro & Yamazaki (1995), eq. (8)"
    over, dims = ("frequency", "default_trial"), ("variation", "frequency", "trial")
    return {
        "default_amplitude": (over, default("amplitude"), envelope),
        "amplitude": (dims, varied("amplitude"), envelope),
        "default_cost": ((), float(np.median(default("seconds"))), cost),
        "cost": ("variation", np.median(varied("seconds"), axis=(1, 2)), cost),
        "default_lists": ((), float(np.median(default("lists"))), lists),
        "lists": ("variation", np.median(varied("lists"), axis=(1, 2)), lists),
        "default_difference": ((), float(sums[0]), eq8),
        "difference": ("variation", sums[1:], eq8),
    }


def dataset(plan: JudgementPlan, parts: Parts) -> xr.Dataset:
    """Criteria, eq. (8) and cost of each variation; draws nothing."""
    settings = plan.settings
    drops = parts.results([(v, settings) for v in (None, DEFAULT, *plan.variations)], _height, "drops")
    found = parts.results(_jobs(plan), lambda job: column_run(*job), "columns")
    named = {"long_name": "what was changed"}
    units = ", ".join(f"{group} [{unit}]" for group, unit in UNITS.items() if unit)
    ds = xr.Dataset(
        _variables(plan, found, drops),
        coords={
            "variation": ("variation", [f"{v.group}: {v.label}" for v in plan.variations], named),
            "group": ("variation", [v.group for v in plan.variations], {"long_name": "parameter"}),
            "value": (
                "variation", [v.value for v in plan.variations], {"long_name": "its value", "units_by_group": units},
            ),
        } | frequency_axis(plan.frequencies),
    )  # fmt: skip
    ds = ds.assign(
        shift=(("variation", "frequency"), shifts(ds),
               {"units": "1", "long_name": "median criterion over that of the defaults, logarithm"}),
        chance=("frequency", chance(ds, plan.trials),
                {"units": "1", "long_name": "half width of 95 % of such shifts among the defaults' own trials"}),
    )  # fmt: skip
    return ds.assign_attrs(
        drop_height=DROP_HEIGHT, drop_pivot_step=DROP_PIVOT, drop_samples=DROP_SAMPLES, tremble=TREMBLE,
        references="Winkler, Meguro & Yamazaki (1995), Contact updating and contact judgement",
        choices=(
            f"free column of two blocks of 0.15 x 0.5 m, ramp to {settings.ramp / G:g} g in {settings.duration:g} s, "
            f"friction {settings.friction:g}, dashpot fitted on Block 1; {plan.trials} trials whose ramps differ by "
            f"{TREMBLE:g} each; Block 4 falling {DROP_HEIGHT * 1e3:g} mm on another for eq. (8)"
        ),
    )  # fmt: skip


def _say(ds: xr.Dataset) -> None:
    print(f"{'':34s} shift    chance   dy [m2]   cost/default")
    for i, name in enumerate(ds.variation.values):
        row = ds.isel(variation=i)
        shift = float(np.abs(row["shift"]).mean())
        cost = float(row.cost / ds.default_cost)
        print(f"{name:34s} {shift:6.3f}   {float(ds.chance.mean()):6.3f}   {float(row.difference):8.2g}  {cost:6.2f}")
    if not math.isfinite(float(ds.amplitude.sum(skipna=False))):
        print("some runs ended without a fall: their criterion is not known")


STUDY = Study(
    name="contact_judgement",
    title="Influence of the parameters of contact judgement",
    about=(
        "When does a corner count as touching an edge, and how often is that looked up? Each parameter of the distinct "
        "elements that has a say in it is varied by itself; what it moves is set beside what chance moves."
    ),
    plan=plan_of,
    dataset=dataset,
    figures={"contact_judgement": figure},
    check=check,
    arguments=arguments,
    say=_say,
    example='ds["shift"].to_pandas()',
)
