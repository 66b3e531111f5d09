"""The study of contact judgement drawn: what each variation moves, beside chance, and what it costs."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from studies.running.plot import caption, new_figure

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")


def figure(ds: xr.Dataset) -> Figure:
    """One row a variation: shift of the criterion, eq. (8), cost."""
    names = [str(name) for name in ds.variation.values]
    rows = np.arange(len(names))
    fig = new_figure(13.0, 2.2 + 0.235 * len(names))
    criterion, drop, cost = fig.subplots(1, 3, sharey=True, width_ratios=[1.5, 1.0, 1.0])
    for i, (frequency, colour) in enumerate(zip(ds.frequency.values, COLOURS, strict=False)):
        at = ds.sel(frequency=frequency)
        base = float(np.log(at.default_amplitude.median("default_trial")))
        single = (np.log(at.amplitude) - base).transpose("variation", "trial").values
        place = rows + 0.16 * (i - 0.5 * (ds.sizes["frequency"] - 1))
        criterion.plot(single, place[:, None] + np.zeros_like(single), ".", color=colour, ms=3, alpha=0.4)
        criterion.plot(at["shift"], place, "D", color=colour, ms=5, label=f"{frequency:g} Hz")
    most = float(ds.chance.mean())
    criterion.axvspan(-most, most, color="0.88", lw=0, zorder=0, label="chance (95 %)")
    criterion.set_yticks(rows, names, fontsize=8)
    criterion.invert_yaxis()
    criterion.set_xlabel("Criterion of overturning over the defaults' median [ln]\n(dots: single runs)", fontsize=9)
    criterion.legend(fontsize=8, loc="upper left")
    drop.plot(np.maximum(ds.difference, 1e-16), rows, "s", color="k", ms=4)
    drop.axvline(float(ds.default_difference), color="0.4", ls="--", lw=0.9)
    drop.set_xscale("log")
    drop.set_xlabel("Falling block: dy, eq. (8) [m$^2$]\n(dashed: defaults)", fontsize=9)
    cost.plot(ds.cost / ds.default_cost, rows, "o", color="k", ms=4)
    cost.axvline(1.0, color="0.4", ls="--", lw=0.9)
    cost.set_xscale("log")
    cost.set_xlabel("Processor time over that of the defaults", fontsize=9)
    for ax in (criterion, drop, cost):
        ax.grid(alpha=0.3)
        for edge in np.flatnonzero(ds.group.values[1:] != ds.group.values[:-1]):
            ax.axhline(edge + 0.5, color="0.7", lw=0.7)
    caption(
        fig,
        "Parameters of contact judgement, one changed at a time; the paper says that nobody had examined them. Notice: "
        "a single run is chaotic, so a parameter matters only where medians leave the grey band. Skin and distance of "
        "updating, and how exactly an edge has to face a corner, change the cost alone.",
    )
    return fig
