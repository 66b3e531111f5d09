"""Fig. 20 of Winkler, Meguro & Yamazaki (1995): base motion of 3 Hz and the angles of the two blocks of a free column.

See          two curves that are one until the blocks part; on the right, when they part at other frequencies.
Paper says   the blocks rock together until about 21 s and then under different angles; at low frequency they hardly
             part, and the higher the frequency, the earlier they do.
Run          python -m studies.fig20 [--quick]  ->  build/studies/fig20.nc, then fig20.png and .pdf
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from studies.claims.bounds import CLAIMS
from studies.criteria.columns import Column, ColumnJob, G, criterion
from studies.families import column_runs
from studies.families.columns import LABELS
from studies.running.labelled import FREQUENCIES, QUICK_FREQUENCIES, frequency_axis, gathered
from studies.running.parts import Parts
from studies.running.plot import caption, new_figure
from studies.running.statements import Finding, listed, table
from studies.running.study import Study
from studies.specimens import specimen

COLUMN = Column(2)


@dataclass(frozen=True)
class Plan:
    """The run that is drawn, and the frequencies at which partings are looked for."""

    run: column_runs.RunPlan
    frequencies: tuple[float, ...]


def plan_of(options: argparse.Namespace) -> Plan:
    """The plan that the command line asks for."""
    return Plan(column_runs.plan_of(COLUMN, options), QUICK_FREQUENCIES if options.quick else FREQUENCIES)


def dataset(plan: Plan, parts: Parts) -> xr.Dataset:
    """The run over time, and `at_parting_time`, `at_largest_apart` ... over frequency."""
    ds = column_runs.dataset(plan.run, parts)
    jobs = [ColumnJob(plan.run.column, frequency, plan.run.settings) for frequency in plan.frequencies]
    results = parts.results(jobs, criterion, "fig20")
    found = gathered(results, ("frequency",), (len(plan.frequencies),), LABELS)
    ds = ds.assign({f"at_{name}": variable for name, variable in found.items()})
    ds = ds.assign_coords(frequency_axis(plan.frequencies))
    alpha = specimen(plan.run.settings.block).alpha
    ds["alpha"] = ((), alpha, {"units": "rad", "long_name": "slenderness angle of one block"})
    return ds


def _histories(axes: Any, ds: xr.Dataset) -> None:
    times = column_runs.stage_times(ds)
    falls = times["falls"] if np.isfinite(times["falls"]) else float(ds.time[-1])
    until = ds.sel(time=slice(max(0.0, times["rocks"] - 1.0), falls + 0.15))
    axes[0].plot(until.time, until.base_acceleration / G, color="0.25", lw=0.7)
    axes[0].set_ylabel("Base\nacceleration [g]")
    for body, colour, line in zip(ds.body.values, ("#0072B2", "#D55E00"), ("-", "--"), strict=True):
        axes[1].plot(until.time, np.degrees(until.theta.sel(body=body)), color=colour, ls=line, lw=0.9, label=str(body))
    limit = 1.3 * float(np.degrees(ds.alpha))
    axes[1].set_ylim(-limit, limit)
    axes[1].set_ylabel("Rotation [°]")
    axes[2].plot(until.time, np.degrees(column_runs.separation(until)), color="#009E73", lw=0.9)
    axes[2].set_ylim(0.0, limit)
    axes[2].set_ylabel("Difference of\nthe angles [°]")
    axes[2].set_xlabel("Time [s]")
    for ax in axes:
        for name, t in times.items():
            ax.axvline(t, color="0.5", lw=0.9, ls=":")
            if ax is axes[0]:
                ax.annotate(name, (t, 1.02), xycoords=("data", "axes fraction"), fontsize=8, ha="center")
        ax.grid(alpha=0.3)
    axes[1].legend(fontsize=8, loc="upper left")


def _partings(ax: Any, ds: xr.Dataset) -> None:
    for name, label, colour, marker in (
        ("at_onset_time", "rocks", "#E69F00", "v"),
        ("at_parting_time", "blocks part", "#009E73", "o"),
        ("at_overturning_time", "falls", "#0072B2", "s"),
    ):
        ax.plot(ds.frequency, ds[name], color=colour, marker=marker, ms=5, label=label)
    ax.set_xlabel("Frequency of the base motion [Hz]")
    ax.set_ylabel("Time [s]")
    ax.set_ylim(bottom=0.0)
    ax.legend(fontsize=8)
    ax.grid(alpha=0.3)


def figure(ds: xr.Dataset) -> Figure:
    """Base motion, angles and their difference (left); when what happens at which frequency (right)."""
    fig = new_figure(12.5, 5.6)
    grid = fig.add_gridspec(3, 2, width_ratios=[2.3, 1.0])
    first = fig.add_subplot(grid[0, 0])
    axes = [first, *(fig.add_subplot(grid[i, 0], sharex=first) for i in (1, 2))]
    _histories(axes, ds)
    _partings(fig.add_subplot(grid[:, 1]), ds)
    caption(
        fig,
        f"After Fig. 20 of Winkler, Meguro & Yamazaki (1995): the free column of two blocks of Fig. 17 at "
        f"{ds.attrs['frequency']:g} Hz, by distinct elements. Notice: the blocks turn as one until they part, then "
        "under different angles until one falls. Right: where the middle curve is missing, the column falls as one.",
    )
    return fig


def check(ds: xr.Dataset) -> xr.Dataset:
    """The paper's statements on how the blocks part."""
    from scipy.stats import spearmanr

    times = column_runs.stage_times(ds)
    f = column_runs.said_of(ds, float(ds.attrs["frequency"]))
    parted = ds.at_parting_time.dropna("frequency")
    rank = float(spearmanr(parted.frequency, parted).statistic) if parted.size > 2 else np.nan
    by_frequency = {f"{float(x):g} Hz": float(t) for x, t in zip(ds.frequency, ds.at_parting_time, strict=True)}
    slow = ds.isel(frequency=0)
    apart = slow.at_largest_apart.where(slow.at_overturning_time.notnull())  # until overturning
    return table(
        [
            Finding(CLAIMS["fig20.together"], (times["a joint opens"] - times["rocks"]) * f, listed(times, 4)),
            Finding(CLAIMS["fig20.apart"], (times["falls"] - times["a joint opens"]) * f, listed(times, 4)),
            Finding(CLAIMS["fig20.low"], float(apart), f"at {float(slow.frequency):g} Hz"),
            Finding(CLAIMS["fig20.earlier"], rank, "parting [s]: " + listed(by_frequency)),
        ]
    )


STUDY = Study(
    name="fig20",
    title="Angles of the two blocks of a free column (Fig. 20)",
    about="Do the blocks of a column rock as one, and when do they part?",
    plan=plan_of,
    dataset=dataset,
    figures={"fig20": figure},
    check=check,
    arguments=column_runs.arguments,
    example='ds.theta.plot.line(x="time")',
)

if __name__ == "__main__":
    STUDY.run()
