"""Convergence: a freely rocking distinct element tends to nonlinear Method 1 as its contacts stiffen.

See          with overdamped corners, times of impacts and peaks come closer in proportion to 1/kn, the tilt that the
             weight makes of the springs; with weaker dashpots they stop coming closer, since the corners bounce.
Paper says   nothing of it; that the two belong together rests on this.
Run          python -m studies.dem_convergence [--quick]  ->  build/studies/dem_convergence.nc, .png and .pdf
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import dem
from rocking import Method1, solve
from studies.criteria.free_vibration import scene_of
from studies.criteria.overturning import STIFFNESS
from studies.running.parts import Parts, Result
from studies.running.plot import caption, new_figure
from studies.running.statements import Claim, Finding, listed, table
from studies.running.study import Study
from studies.specimens import specimen

BLOCK, RELEASE, T_END = 3, 0.12, 1.5
"""Number in Table 1; tilt at release [rad]; end [s]."""

SWINGS = 4
FACTORS = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0)
RATIOS = (0.3, 1.0, 3.0)

PLACE = "not in the paper"
CLAIMS = {
    claim.key: claim
    for claim in (
        Claim(
            "dem_convergence.order",
            "Stiffer, overdamped contacts bring distinct elements to nonlinear Method 1 as 1/kn",
            PLACE, "slope of the logarithm of the error of the impact times over that of kn, damping ratio 3, from the "
            "softest contact to ten times the paper's", "<=", -0.8,
        ),
        Claim(
            "dem_convergence.close", "With the stiffest ones they coincide", PLACE,
            "largest error of the first four impact times, damping ratio 3", "<=", 1e-4, units="s",
        ),
        Claim(
            "dem_convergence.damping", "Stiffness alone does not do it: weakly damped corners bounce", PLACE,
            "error of the impact times at damping ratio 0.3 over that at 3, stiffest contact", ">=", 10.0,
        ),
    )
}  # fmt: skip


@dataclass(frozen=True)
class ConvergencePlan:
    """Everything that decides the dataset."""

    factors: tuple[float, ...] = FACTORS  # of the paper's stiffness
    ratios: tuple[float, ...] = RATIOS  # of critical damping
    step_share: float = 0.05  # of the critical step


def plan_of(options: argparse.Namespace) -> ConvergencePlan:
    """The plan that the command line asks for."""
    return ConvergencePlan((0.1, 1.0, 10.0, 100.0), step_share=0.1) if options.quick else ConvergencePlan()


def _rigid() -> dem.Swings:
    """Impacts and peaks of nonlinear Method 1 with Housner's restitution."""
    block = specimen(BLOCK)
    model = Method1(block, restitution=block.housner_restitution, form="nonlinear")
    run = solve(model, theta=RELEASE, t_end=T_END, save_at=np.linspace(0.0, T_END, 15_001))
    return dem.Swings(np.asarray(run.impact_times), dem.swings(run.t, run.theta).peaks)


def _one(factor: float, ratio: float, share: float) -> Result:
    """Largest errors of the first swings."""
    block, kn = specimen(BLOCK), factor * STIFFNESS
    scene, damping = scene_of(block), 2.0 * ratio * math.sqrt(kn * block.mass)
    dt = share * dem.critical_step(scene, kn, kn, damping)
    run = dem.let_go(scene, RELEASE, t_end=T_END, damping=damping, kn=kn, ks=kn, dt=dt, interval=1e-4)
    found, rigid = dem.swings(run.time, run.theta), _rigid()
    few = min(len(found.passages), len(found.peaks))
    if few < SWINGS:
        return {"time_error": math.nan, "peak_error": math.nan}
    return {
        "time_error": float(np.abs(found.passages[:SWINGS] - rigid.passages[:SWINGS]).max()),
        "peak_error": float(np.abs(found.peaks[:SWINGS] - rigid.peaks[:SWINGS]).max()),
    }


def dataset(plan: ConvergencePlan, parts: Parts) -> xr.Dataset:
    """Errors over (ratio, stiffness); draws nothing."""
    jobs = [(factor, ratio, plan.step_share) for ratio in plan.ratios for factor in plan.factors]
    found = parts.results(jobs, lambda job: _one(*job), "convergence")
    shape = (len(plan.ratios), len(plan.factors))

    def stacked(name: str) -> np.ndarray:
        return np.array([result[name] for result in found]).reshape(shape)

    dims, of = ("ratio", "stiffness"), "against nonlinear Method 1"
    return xr.Dataset(
        {
            "time_error": (
                dims, stacked("time_error"),
                {"units": "s", "long_name": f"largest error of the first {SWINGS} impact times {of}"},
            ),
            "peak_error": (
                dims, stacked("peak_error"),
                {"units": "rad", "long_name": f"largest error of the first {SWINGS} peaks {of}"},
            ),
        },
        coords={
            "ratio": ("ratio", list(plan.ratios), {"units": "1", "long_name": "share of critical damping"}),
            "stiffness": (
                "stiffness", STIFFNESS * np.array(plan.factors),
                {"units": "N m-1", "long_name": "stiffness of a corner, both ways"},
            ),
        },
        attrs={
            "block": BLOCK,
            "release": RELEASE,
            "paper_stiffness": STIFFNESS,
            "choices": "Housner's restitution; friction so high that nothing slides; dem.simulate",
        },
    )  # fmt: skip


def figure(ds: xr.Dataset) -> Figure:
    """Errors against stiffness, a line a damping."""
    fig = new_figure(10.0, 4.6)
    axes = fig.subplots(1, 2, sharex=True)
    texts = ("Largest error of four impact times [s]", "Largest error of four peaks [rad]")
    for ax, name, text in zip(axes, ("time_error", "peak_error"), texts, strict=True):
        for ratio, colour in zip(ds.ratio.values, ("#D55E00", "#0072B2", "#009E73"), strict=False):
            ax.plot(ds.stiffness, ds[name].sel(ratio=ratio), "o-", color=colour, ms=4, label=f"damping ratio {ratio:g}")
        first = ds[name].isel(ratio=-1, stiffness=0)
        ax.plot(ds.stiffness, first * ds.stiffness[0] / ds.stiffness, color="0.5", ls=":", label="1/kn")
        ax.axvline(ds.attrs["paper_stiffness"], color="0.6", lw=0.8)
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_xlabel("Stiffness of a corner [N/m]")
        ax.set_title(text, fontsize=10)
        ax.grid(alpha=0.3)
    axes[0].legend(fontsize=8)
    caption(
        fig,
        f"Block {ds.attrs['block']} let go at {ds.attrs['release']:g} rad: distinct elements against nonlinear "
        "Method 1 with Housner's restitution. Notice: with overdamped corners the error goes with 1/kn until that of "
        "the time step is met; weaker dashpots let the corners bounce, and no stiffness cures that. Upright line: the "
        "paper's stiffness.",
    )
    return fig


def check(ds: xr.Dataset) -> xr.Dataset:
    """Does it converge, and does it need damping?"""
    over, weak = ds.time_error.isel(ratio=-1), ds.time_error.isel(ratio=0)
    some = over.where(over.stiffness <= 10.001 * ds.attrs["paper_stiffness"], drop=True)
    slope = float(np.polyfit(np.log(some.stiffness), np.log(some), 1)[0])
    errors = {f"kn {float(k):.3g}": float(e) for k, e in zip(over.stiffness.values, over.values, strict=True)}
    return table(
        [
            Finding(CLAIMS["dem_convergence.order"], slope, listed(errors)),
            Finding(CLAIMS["dem_convergence.close"], float(over.isel(stiffness=-1))),
            Finding(CLAIMS["dem_convergence.damping"], float(weak.isel(stiffness=-1) / over.isel(stiffness=-1))),
        ]
    )


STUDY = Study(
    name="dem_convergence",
    title="Distinct elements tend to nonlinear Method 1 as their contacts stiffen",
    about="A block is leaned and let go: how far are distinct elements from the rigid block, and when are they near?",
    plan=plan_of,
    dataset=dataset,
    figures={"dem_convergence": figure},
    check=check,
    example='ds.time_error.plot.line(x="stiffness", xscale="log", yscale="log")',
)

if __name__ == "__main__":
    STUDY.run()
