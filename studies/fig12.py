"""Fig. 12 of Winkler, Meguro & Yamazaki (1995): how far histories of a rebounding block are from the pivot, by eq. (8).

See          on the left what the paper shows, the five smallest steps on a linear axis; on the right all steps, on
             logarithmic axes, and what other rules for the onset of a contact give.
Paper says   stability seems to be lost beyond 3.3e-6 s; 2.0e-6 s is appropriate; eq. (7) would allow 5e-4 s; every
             surrounding block makes the step that is needed smaller.
Run          python -m studies.fig12 [--quick]  ->  build/studies/fig12.nc, then fig12.png and .pdf
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from dem.drop import largest_step_as_good
from studies.claims.preliminary_bounds import CLAIMS
from studies.families import numerical_stability
from studies.families.numerical_stability import DropPlan, rms
from studies.running.parts import Parts
from studies.running.plot import caption, new_figure
from studies.running.statements import Finding, listed, table
from studies.running.study import Study

LOST = 3.3e-6
"""Beyond this step [s] stability seems to be lost, by the paper."""

STYLES = {"incremental": ("#D55E00", "o"), "overlap": ("#0072B2", "s"), "located": ("#009E73", "^")}
NAMES = {"incremental": "incremental (the paper's)", "overlap": "from the overlap", "located": "located"}


def dataset(plan: DropPlan, parts: Parts) -> xr.Dataset:
    """Differences over (trial, onset, step)."""
    return numerical_stability.dataset(plan, parts, "fig12")


def _five(ds: xr.Dataset) -> xr.DataArray:
    """Eq. (8) for the five smallest of the nine steps, by the paper's rule; median over the drops."""
    nine = ds.difference.isel(step=np.flatnonzero(ds.of_nine.values)).sel(onset="incremental")
    return nine.median("trial").isel(step=slice(0, 5))


def _panel(ax: Any, ds: xr.Dataset, name: str) -> None:
    for onset in ds.onset.values:
        colour, marker = STYLES[str(onset)]
        all_drops = ds[name].sel(onset=onset)
        ax.plot(ds.step, all_drops.median("trial"), color=colour, marker=marker, ms=4, lw=1.1, label=NAMES[str(onset)])
        ax.fill_between(ds.step, all_drops.min("trial"), all_drops.max("trial"), color=colour, alpha=0.2, lw=0)
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel("Time step [s]")
    ax.grid(alpha=0.3)


def figure(ds: xr.Dataset) -> Figure:
    """The paper's own axes; then all steps, from the pivot and from the closed form."""
    fig = new_figure(12.5, 4.7)
    axes = fig.subplots(1, 3)
    five = _five(ds)
    axes[0].plot(five.step * 1e6, five, color=STYLES["incremental"][0], marker="o")
    axes[0].axvline(LOST * 1e6, color="0.5", ls=":", label="lost beyond this, by the paper")
    axes[0].axvline(ds.attrs["paper_step"] * 1e6, color="0.2", ls="--", lw=0.9, label="chosen in the paper")
    axes[0].set_xlabel("Time step [1e-6 s]")
    axes[0].set_ylabel("dy, eq. (8) [m$^2$]")
    axes[0].set_title("Five smallest steps", fontsize=10)
    axes[0].legend(fontsize=8, loc="upper left")
    axes[0].grid(alpha=0.3)
    _panel(axes[1], ds, "difference")
    axes[1].axvline(ds.attrs["eq7_step"], color="0.5", ls="-.", lw=0.9)
    axes[1].axvline(ds.attrs["critical_step"], color="0.5", ls="-", lw=0.9)
    axes[1].set_title("From the pivot (lines: stable limit, eq. (7))", fontsize=10)
    _panel(axes[2], ds, "difference_exact")
    paper = ds.difference_exact.sel(onset="incremental", step=ds.attrs["paper_step"]).median("trial")
    axes[2].axhline(float(paper), color="0.2", ls="--", lw=0.9)
    axes[2].set_title("From the closed form (dashed: the paper's choice)", fontsize=10)
    axes[2].legend(fontsize=8, loc="lower right")
    caption(
        fig,
        "After Fig. 12 of Winkler, Meguro & Yamazaki (1995): Block 4 dropped from "
        f"{ds.attrs['drop_height'] * 1e3:g} mm, {ds.attrs['samples']} samples in 2 s; bands: drops changed by up to "
        "0.2 %, which changes where in a step the block lands. Notice: on the paper's axes dy rises from nothing "
        "beyond about 3e-6 s; on logarithmic ones it grows all along, and nothing is lost at one step. A contact "
        "whose onset is located within the step allows a larger one.",
    )
    return fig


def _slopes(dy: xr.DataArray) -> tuple[float, float]:
    """Slopes of log dy over log dt: smallest step to 3.3e-6 s, 3.3e-6 s to the next of the nine."""
    steps, values = dy.step.values, dy.values
    at = int(np.argmin(np.abs(steps - LOST)))

    def slope(i: int, j: int) -> float:
        return math.log(values[j] / values[i]) / math.log(steps[j] / steps[i])

    return slope(0, at), slope(at, at + 1)


def check(ds: xr.Dataset) -> xr.Dataset:
    """The paper's statements on the step, and ours on a better one."""
    five, drop, eq7 = _five(ds), ds.attrs["drop_height"], ds.attrs["eq7_step"]
    before, after = _slopes(five)
    papers = rms(ds, ds.difference.sel(onset="incremental")).median("trial")
    nine = papers.isel(step=np.flatnonzero(ds.of_nine.values))
    off = nine.step.values[nine.values > 0.01 * drop]
    columns = np.asarray(ds.attrs["critical_steps_of_columns"])
    bound = float(ds.difference_exact.sel(onset="incremental", step=ds.attrs["paper_step"]).median("trial"))
    located = ds.difference_exact.sel(onset="located").median("trial")
    pivots = float(ds.pivot_difference_exact.sel(onset="incremental").median("trial"))
    as_pivot = largest_step_as_good(ds.step.values, located.values, pivots) / ds.attrs["pivot_step"]
    larger = largest_step_as_good(ds.step.values, located.values, bound) / ds.attrs["paper_step"]
    return table(
        [
            Finding(CLAIMS["fig12.eq7"], abs(eq7 / 5e-4 - 1.0), f"{eq7:.3g} s"),
            Finding(CLAIMS["fig12.far_below"], float(off.min()) / eq7 if len(off) else math.nan),
            Finding(CLAIMS["fig12.lost"], after / before, f"slope {before:.2g} before, {after:.2g} after"),
            Finding(CLAIMS["fig12.seen"], float(five.sel(step=LOST) / five.isel(step=4)),
                    f"fifth step {float(five.step[4]):.3g} s"),
            Finding(CLAIMS["fig12.chosen"], float(papers.sel(step=ds.attrs["paper_step"])) / drop),
            Finding(CLAIMS["fig12.neighbours"], float((columns[1:] / columns[:-1]).max()),
                    listed({f"{n} blocks [s]": step for n, step in enumerate(columns, 1)})),
            Finding(CLAIMS["fig12.larger"], larger, f"{larger * ds.attrs['paper_step']:.3g} s"),
            Finding(CLAIMS["fig12.as_pivot"], as_pivot, f"{as_pivot * ds.attrs['pivot_step']:.3g} s"),
        ]
    )  # fmt: skip


STUDY = Study(
    name="fig12",
    title="Differences from the pivot for different time steps, by eq. (8) (Fig. 12)",
    about="A block falls on a rigid base and is thrown back: which time step is small enough?",
    plan=numerical_stability.plan_of,
    dataset=dataset,
    figures={"fig12": figure},
    check=check,
    arguments=numerical_stability.arguments,
    example='ds.difference.median("trial").plot.line(x="step", xscale="log", yscale="log")',
)

if __name__ == "__main__":
    STUDY.run()
