"""A block on two springs and a block of distinct elements, in free vibration.

See          two curves that lie on each other: the same contacts, once as the two-spring foundation, once as elements.
Paper says   the two-spring model of Psycharis & Jennings (1983) is very similar to its contact model.
Run          python -m studies.springs [--quick]  ->  build/studies/springs.nc, then springs.png and .pdf
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import dem
from dem.free_swings import passages
from rocking import Method1, solve
from rocking.effects.compliant_base import CompliantBase
from studies.claims.bounds import CLAIMS
from studies.criteria.free_vibration import RELEASE, scene_of
from studies.criteria.overturning import STIFFNESS
from studies.running.labelled import PAPER
from studies.running.parts import Parts
from studies.running.plot import caption, new_figure
from studies.running.statements import Finding, listed, table
from studies.running.study import Study
from studies.specimens import specimen

BLOCK = 1
RATIOS = (0.1, 0.5, 1.0)
"""Damping ratios of a corner [1]."""

STEP = 1e-5
SAMPLE = 2e-3
SWINGS = 4


@dataclass(frozen=True)
class Plan:
    """What is computed."""

    ratios: tuple[float, ...] = RATIOS
    duration: float = 3.0


@dataclass(frozen=True)
class Job:
    """Both models at one damping ratio."""

    ratio: float
    duration: float


def _both(job: Job) -> dict[str, Any]:
    """Tilts [rad] of both models at the same times, from the same release."""
    block = specimen(BLOCK)
    theta0 = RELEASE * block.alpha
    damping = 2.0 * job.ratio * math.sqrt(STIFFNESS * block.mass)
    elements = dem.let_go(
        scene_of(block), theta0, t_end=job.duration, damping=damping, kn=STIFFNESS, ks=STIFFNESS, dt=STEP,
        interval=SAMPLE,
    )  # fmt: skip
    t = elements.time[:-1]
    springs = solve(
        Method1(block), t_end=job.duration, theta=theta0, save_at=t,
        effects=(CompliantBase(corner_stiffness=STIFFNESS, damping_ratio=job.ratio),),
    )  # fmt: skip
    return {"time": t, "elements": elements.theta[:-1], "springs": springs.theta}


def dataset(plan: Plan, parts: Parts) -> xr.Dataset:
    """Tilts over (damping_ratio, time) by both models."""
    results = parts.results([Job(ratio, plan.duration) for ratio in plan.ratios], _both, "springs")
    dims, units = ("damping_ratio", "time"), {"units": "rad"}
    ratio = {"units": "1", "long_name": "damping ratio of a corner"}
    ds = xr.Dataset(
        {
            "elements": (dims, [r["elements"] for r in results], units | {"long_name": "rotation, distinct elements"}),
            "springs": (dims, [r["springs"] for r in results], units | {"long_name": "rotation, two springs"}),
        },
        coords={
            "damping_ratio": ("damping_ratio", list(plan.ratios), ratio),
            "time": ("time", results[0]["time"], {"units": "s", "long_name": "time"}),
        },
    )
    release = RELEASE * specimen(BLOCK).alpha
    return ds.assign_attrs(
        references=f"{PAPER}, Introduction; Psycharis & Jennings (1983)", release=release, block=BLOCK
    )


def difference(ds: xr.Dataset) -> dict[float, float]:
    """Largest difference over the first swings, over the tilt at release, by damping ratio."""
    found = {}
    for ratio in ds.damping_ratio.values:
        at = ds.sel(damping_ratio=ratio)
        upright = passages(at.elements.values)
        swings = list(pairwise([0, *upright]))[:SWINGS]
        end = swings[-1][1] if swings else at.sizes["time"]
        apart = np.abs(at.elements - at.springs).isel(time=slice(0, end + 1))
        found[float(ratio)] = float(apart.max() / ds.attrs["release"])
    return found


def figure(ds: xr.Dataset) -> Figure:
    """Both models, one panel a damping ratio."""
    fig = new_figure(3.9 * ds.sizes["damping_ratio"] + 0.6, 3.8)
    axes = fig.subplots(1, ds.sizes["damping_ratio"], sharey=True, squeeze=False)[0]
    for ax, ratio in zip(axes, ds.damping_ratio.values, strict=True):
        at = ds.sel(damping_ratio=ratio)
        ax.plot(ds.time, np.degrees(at.elements), color="#009E73", lw=2.2, label="distinct elements")
        ax.plot(ds.time, np.degrees(at.springs), color="k", lw=1, ls="--", label="two springs")
        ax.set_title(f"damping ratio {ratio:g}")
        ax.set_xlabel("Time [s]")
        ax.grid(alpha=0.3)
    axes[0].set_ylabel("Rotation [°]")
    axes[-1].legend(fontsize=8)
    caption(
        fig,
        f"Free vibration of Block {ds.attrs['block']} on contacts of 1.98e7 N/m, as a block on two springs (Psycharis "
        "& Jennings 1983) and as a distinct element. Notice: the curves lie on each other; the dashpots alone take the "
        "energy that an impact takes in Method 1.",
    )
    return fig


def check(ds: xr.Dataset) -> xr.Dataset:
    """How far the two models are from each other."""
    found = difference(ds)
    by_ratio = listed({f"damping ratio {ratio:g}": apart for ratio, apart in found.items()})
    return table([Finding(CLAIMS["springs.alike"], max(found.values()), by_ratio)])


def plan_of(options: argparse.Namespace) -> Plan:
    """The plan that the command line asks for."""
    return Plan((0.5,), 2.0) if options.quick else Plan()


STUDY = Study(
    name="springs",
    title="A block on two springs and a block of distinct elements in free vibration",
    about="Does the two-spring foundation behave as the contact of distinct elements does?",
    plan=plan_of,
    dataset=dataset,
    figures={"springs": figure},
    check=check,
    example='(ds.elements - ds.springs).plot.line(x="time")',
)

if __name__ == "__main__":
    STUDY.run()
