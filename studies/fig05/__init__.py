"""Fig. 5 of Winkler, Meguro & Yamazaki (1995): free vibration of Block 1, by Method 1 and by distinct elements.

See          with the damping that fits best, the top of the block moves alike by both methods; below: how close other
             dampings come, what a doubled stiffness or dashpot does, and how well other stiffnesses can be fitted.
Paper says   a damping is found that fits; stiffness moves mainly the frequency, damping mainly the amplitude; for a
             range of stiffness there is a damping that fits as closely, so damping matters more.
Run          python -m studies.fig05 [--quick]  ->  build/studies/fig05.nc, then fig05.png and .pdf

The experiment's curve is not available as numbers, nor is the restitution that was fitted to it. Method 1 stands for
it, nonlinear since a block is, with Housner's restitution and with a larger one.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

import dem
from studies.criteria.overturning import STIFFNESS
from studies.fig05.drawing import figure
from studies.fig05.fit import Released, fitted, measured, misfit
from studies.fig05.statements import check
from studies.running.files import BadInputError
from studies.running.parts import Parts, Result
from studies.running.study import Study
from studies.specimens import specimen

BLOCK = 1
FACTORS = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Of stiffness and dashpot."""

RATIOS = tuple(np.geomspace(3e-3, 2.0, 40).tolist())
"""Shares of critical damping that are tried: c over 2 sqrt(kn m)."""


@dataclass(frozen=True)
class FreePlan:
    """Everything that decides the dataset."""

    restitutions: tuple[float, ...]
    release: float  # tilt over that of unstable balance [1]
    t_end: float = 7.0  # [s], of the paper
    factors: tuple[float, ...] = FACTORS
    ratios: tuple[float, ...] = RATIOS


def arguments(parser: argparse.ArgumentParser) -> None:
    """--restitution and --release."""
    parser.add_argument(
        "--restitution", type=float, nargs="+", metavar="E",
        help="of Method 1, which stands for the experiment (default: Housner's, 0.876, and 0.93)",
    )  # fmt: skip
    parser.add_argument(
        "--release", type=float, default=0.6, metavar="SHARE",
        help="tilt at release over that of unstable balance; not printed in the paper (default: %(default)s)",
    )  # fmt: skip


def plan_of(options: argparse.Namespace) -> FreePlan:
    """The plan that the command line asks for; a restitution that is given twice is taken once.

    Raises:
        BadInputError: an option's value is not one that it can have.
    """
    restitutions = tuple(dict.fromkeys(options.restitution or (specimen(BLOCK).housner_restitution, 0.93)))
    for value in restitutions:
        if not 0.0 < value < 1.0:
            raise BadInputError(f"--restitution {value:g}: want more than 0, less than 1")
    if not 0.0 < options.release < 1.0:
        raise BadInputError(f"--release {options.release:g}: want more than 0, less than 1")
    if options.quick:
        return FreePlan(restitutions, options.release, factors=(0.5, 1.0, 2.0), ratios=RATIOS[::4])
    return FreePlan(restitutions, options.release)


def _one(plan: FreePlan, e: float) -> Result:
    """Everything that is found for one restitution."""
    released = Released(specimen(BLOCK), plan.release, plan.t_end)
    target = released.method1(e)
    tried = [misfit(released, target, ratio, STIFFNESS) for ratio in plan.ratios]
    best = {k: fitted(released, target, plan.ratios, k * STIFFNESS) for k in plan.factors}
    c = best[1.0].damping
    curve = released.elements(c, STIFFNESS)
    changed = {
        "stiffness": [measured(released.run(c, k * STIFFNESS), curve, released) for k in plan.factors],
        "dashpot": [measured(released.run(k * c, STIFFNESS), curve, released) for k in plan.factors],
        "stiffness_ratio_kept": [
            measured(released.run(math.sqrt(k) * c, k * STIFFNESS), curve, released) for k in plan.factors
        ],
    }
    found: Result = {"method1_top": target, "dem_top": curve, "tried": np.array(tried), "damping": c}
    found |= {"best_misfit": np.array([fit.misfit for fit in best.values()])}
    found |= {"best_damping": np.array([fit.damping for fit in best.values()])}
    for name, rows in changed.items():
        found |= {f"{name}_{key}": np.array([getattr(row, key) for row in rows]) for key in rows[0]._fields}
    return found


LABELS = {
    "frequency": ("Hz", "frequency of four swings"),
    "peak": ("rad", "largest tilt of the fourth swing"),
    "change": ("m", "root mean square change of the displacement of the top"),
}
VARIED = {
    "stiffness": "stiffness changed, dashpot kept",
    "dashpot": "dashpot changed",
    "stiffness_ratio_kept": "stiffness changed, share of critical damping kept",
}


def dataset(plan: FreePlan, parts: Parts) -> xr.Dataset:
    """Displacements of the top over (restitution, time), fits and changes; draws nothing."""
    found = parts.results([(plan, e) for e in plan.restitutions], lambda job: _one(*job), "fig05")
    block = specimen(BLOCK)
    released = Released(block, plan.release, plan.t_end)

    def stacked(name: str) -> np.ndarray:
        return np.array([result[name] for result in found])

    reference = {"reference": "Winkler, Meguro & Yamazaki (1995), Fig. 5"}

    def named(units: str, text: str) -> dict[str, str]:
        return {"units": units, "long_name": text} | reference

    over = ("restitution", "time")
    variables: dict[str, Any] = {
        "method1_top": (over, stacked("method1_top"), named("m", "displacement of the middle of the top, Method 1")),
        "dem_top": (over, stacked("dem_top"), named("m", "displacement of the middle of the top, DEM, best damping")),
        "damping": ("restitution", stacked("damping"), named("N s/m", "dashpot that fits best")),
        "misfit": (
            ("restitution", "ratio"), stacked("tried"), named("1", "root mean square difference over release"),
        ),
        "best_misfit": (
            ("restitution", "factor"), stacked("best_misfit"), named("1", "least misfit at this stiffness"),
        ),
        "best_damping": (
            ("restitution", "factor"), stacked("best_damping"), named("N s/m", "dashpot that fits best then"),
        ),
    }  # fmt: skip
    for name, text in VARIED.items():
        for key, (units, what) in LABELS.items():
            variables[f"{name}_{key}"] = (
                ("restitution", "factor"), stacked(f"{name}_{key}"), named(units, f"{what}; {text}"),
            )  # fmt: skip
    coordinates = {
        "restitution": ("restitution", list(plan.restitutions), {"units": "1", "long_name": "restitution of Method 1"}),
        "time": ("time", released.times, {"units": "s", "long_name": "time"}),
        "ratio": ("ratio", list(plan.ratios), {"units": "1", "long_name": "share of critical damping"}),
        "factor": (
            "factor",
            list(plan.factors),
            {"units": "1", "long_name": "stiffness or dashpot over that of the fit"},
        ),
    }
    ds = xr.Dataset(variables, coordinates)
    return ds.assign_attrs(
        block=BLOCK, mass=block.mass, stiffness=STIFFNESS, release=plan.release,
        release_displacement=float(released.method1(plan.restitutions[0])[0]),
        wave_speed=dem.wave_speed_from_stiffness(block.mass, STIFFNESS, block.h),
        references="Winkler, Meguro & Yamazaki (1995), Fig. 5 and eq. (9)",
        choices=(
            "not printed, chosen here: restitution of Method 1, which is nonlinear (it stands for the experiment; eqs "
            "(2) and (3) as printed are linear), tilt at release; "
            "friction so high that nothing slides; DEM by dem.simulate, step a twentieth of the critical one"
        ),
    )  # fmt: skip


def _say(ds: xr.Dataset) -> None:
    for e in ds.restitution.values:
        at = ds.sel(restitution=e)
        ratio = float(at.damping) / (2.0 * math.sqrt(ds.attrs["stiffness"] * ds.attrs["mass"]))
        print(f"e = {e:.4g}: dashpot {float(at.damping):.4g} N s/m, {ratio:.3g} of critical")


STUDY = Study(
    name="fig05",
    title="Free vibration of Block 1 by Method 1 and by distinct elements (Fig. 5)",
    about=(
        "A block is leaned to one side and let go. The dashpot of the distinct elements is fitted so that the top "
        "moves as by Method 1, as the paper fitted it to an experiment."
    ),
    plan=plan_of,
    dataset=dataset,
    figures={"fig05": figure},
    check=check,
    arguments=arguments,
    say=_say,
    example='ds.dem_top.plot.line(x="time")',
)
