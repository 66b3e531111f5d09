"""Fig. 11 of Winkler, Meguro & Yamazaki (1995): vertical displacements of a rebounding block for different time steps.

See          nearly all of nine steps give a rebounding block that looks right by itself; beside the pivot the larger
             ones are out of step after a few rebounds.
Paper says   a motion that looks stable need not be.
Run          python -m studies.fig11 [--quick]  ->  build/studies/fig11.nc, then fig11.png and .pdf
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from studies.claims.preliminary_bounds import CLAIMS
from studies.families import numerical_stability
from studies.families.numerical_stability import DropPlan, rms
from studies.running.parts import Parts
from studies.running.plot import COLOURS, caption, new_figure
from studies.running.statements import Finding, table
from studies.running.study import Study


def dataset(plan: DropPlan, parts: Parts) -> xr.Dataset:
    """Histories of the nine steps by the paper's rule of onset, of the nominal drop."""
    few = DropPlan(plan.height, (0.0,), plan.nine, (), plan.pivot, ("incremental",))
    return numerical_stability.dataset(few, parts, "fig11").isel(trial=0, onset=0)


def figure(ds: xr.Dataset) -> Figure:
    """One panel a step, the pivot behind."""
    fig = new_figure(11.0, 6.6)
    axes = fig.subplots(3, 3, sharex=True, sharey=True)
    off = rms(ds, ds.difference)
    for ax, step in zip(axes.ravel(), ds.step.values, strict=True):
        at = ds.sel(step=step)
        ax.plot(ds.time, ds.pivot_height * 1e3, color="0.72", lw=2.2, label="pivot")
        ax.plot(ds.time, at.height * 1e3, color=COLOURS["dem"], lw=0.8, label="this step")
        ax.set_title(f"{step:.3g} s: off by {float(off.sel(step=step)) * 1e3:.2g} mm (rms)", fontsize=9)
        ax.grid(alpha=0.3)
    axes[0, 0].legend(fontsize=8, loc="lower right")
    for ax in axes[-1]:
        ax.set_xlabel("Time [s]")
    for ax in axes[:, 0]:
        ax.set_ylabel("Height [mm]")
    caption(
        fig,
        "After Fig. 11 of Winkler, Meguro & Yamazaki (1995): Block 4 dropped from "
        f"{ds.attrs['drop_height'] * 1e3:g} mm, forces incremental from the step that finds the contact on, as in the "
        f"paper; pivot {ds.attrs['pivot_step']:.4g} s. Notice: nearly every step gives a motion that by itself looks "
        "right; only beside the pivot is it seen to be out of step, far below the "
        f"{ds.attrs['eq7_step']:.2g} s of eq. (7).",
    )
    return fig


def check(ds: xr.Dataset) -> xr.Dataset:
    """How many of the nine look stable and are not?"""
    drop = ds.attrs["drop_height"]
    looks_right = ds.height.max("time") <= 1.1 * drop
    is_off = rms(ds, ds.difference) > 0.1 * drop
    seeming = ds.step.values[(looks_right & is_off).values]
    detail = ", ".join(f"{step:.3g} s" for step in np.atleast_1d(seeming))
    return table([Finding(CLAIMS["fig11.seemingly"], float(len(seeming)), detail)])


STUDY = Study(
    name="fig11",
    title="Vertical displacements of a rebounding block for different time steps (Fig. 11)",
    about="A block falls on a rigid base and is thrown back: how does the time step change what is computed?",
    plan=numerical_stability.plan_of,
    dataset=dataset,
    figures={"fig11": figure},
    check=check,
    arguments=numerical_stability.arguments,
    example='ds.height.plot.line(x="time", col="step", col_wrap=3)',
)

if __name__ == "__main__":
    STUDY.run()
