"""Fig. 16 drawn: criteria of overturning, time in each mode, and how far the curves move with what is not printed."""

from __future__ import annotations

import json
from collections.abc import Collection
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from studies.criteria.overturning import METHOD_LABELS
from studies.fig16.sensitivity import G
from studies.running.plot import COLOURS, MODE_COLOURS, caption, new_figure

MARKERS = {"method1": "o", "method2": "s", "dem": "^"}
GROUPS = ("friction", "restitution", "ramp", "other")
GROUP_TITLES = {
    "friction": "Friction",
    "restitution": "Restitution (DEM: dashpot fitted to it)",
    "ramp": "Growth of the ramp",
    "other": "Equations, impacts, step",
}


def _criteria_panel(ax: Any, ds: xr.Dataset, block: int) -> None:
    for method in ds.method.values:
        curve = ds.overturning_amplitude.sel({"method": method, "block": block}) / G
        ax.plot(ds.frequency, curve, color=COLOURS[method], marker=MARKERS[method], ms=5, label=METHOD_LABELS[method])
    size = ds.sel(block=block)
    ax.axhline(float(size.b / size.h), color="0.4", lw=1, ls=":", label="West: (b/h) g")
    ax.set_title(f"Block {block}: {float(size.b):g} x {float(size.h):g} m")
    ax.set_ylim(bottom=0.0)
    ax.grid(alpha=0.3)


def _mode_panel(ax: Any, ds: xr.Dataset, block: int) -> None:
    methods = [m for m in ds.method.values if m != "method1"] or ["method1"]
    step = float(np.diff(ds.frequency).min()) if ds.sizes["frequency"] > 1 else 0.5
    width = 0.8 * step / len(methods)
    for i, method in enumerate(methods):
        at = ds.frequency.values + (i - 0.5 * (len(methods) - 1)) * width
        base = np.zeros(ds.sizes["frequency"])
        for mode in ds.mode.values:
            label = str(mode).replace("_", " ")
            share = ds.mode_fraction.sel({"method": method, "block": block, "mode": mode}).fillna(0.0).values
            ax.bar(
                at,
                share,
                width * 0.92,
                base,
                color=MODE_COLOURS[mode],
                label=label if i == 0 else None,
            )
            base = base + share
    ax.set_ylim(0.0, 1.0)
    ax.set_xlabel("Frequency of the base motion [Hz]")


def figure(ds: xr.Dataset) -> Figure:
    """Criteria of overturning (top) and the share of time in each mode (bottom), one column a block."""
    blocks = ds.block.values
    fig = new_figure(4.0 * len(blocks) + 1.6, 7.6)
    axes = fig.subplots(2, len(blocks), squeeze=False, sharex=True, height_ratios=[1.5, 1.0])
    for column, block in enumerate(blocks):
        _criteria_panel(axes[0, column], ds, block)
        _mode_panel(axes[1, column], ds, block)
    commanded = "commanded " if "commanded" in ds.overturning_amplitude.attrs["long_name"] else "base "
    axes[0, 0].set_ylabel(f"Envelope of {commanded}acceleration\nat overturning [g]")
    axes[1, 0].set_ylabel("Share of time until\noverturning")
    axes[0, -1].legend(loc="upper left", bbox_to_anchor=(1.02, 1.0), frameon=False)
    bars = [METHOD_LABELS[m] for m in ds.method.values if m != "method1"] or ["Method 1"]
    axes[1, -1].legend(
        loc="upper left", bbox_to_anchor=(1.02, 1.0), frameon=False, title=" | ".join(bars) + "\n(left to right)"
    )
    settings = json.loads(ds.attrs["settings"])
    restitution = "Housner's" if settings["restitution"] == "none" else f"{settings['restitution']:g}"
    caption(
        fig,
        f"After Fig. 16 of Winkler, Meguro & Yamazaki (1995). {_notice(settings['effects'])} Not printed in the "
        f"paper and chosen here: ramp to {settings['ramp'] / G:.3g} g in {settings['duration']:g} s, friction "
        f"{settings['friction']:g}, restitution {restitution}. {_gaps(ds)}",
    )
    return fig


def _notice(effects: Collection[str]) -> str:
    """What is to be seen of the ideal blocks, and what is to be asked of others."""
    if not effects:
        return (
            "Notice: Method 1, which only rocks, needs an acceleration that grows with frequency, while Method 2 and "
            "DEM, which may slide and jump, level off."
        )
    return (
        f"With {', '.join(effects)}. Notice whether Method 1 needs an acceleration that grows with frequency here, "
        "too, and whether Method 2 and DEM level off; West's line is of a block and a base without that."
    )


def _gaps(ds: xr.Dataset) -> str:
    """Why points are missing."""
    kinds = [str(note).partition(":")[0] for note in ds.note.values[ds.overturning_amplitude.isnull().values]]
    other = [f"{kinds.count(kind)} {kind}" for kind in ("declined", "failed") if kind in kinds]
    if not other:
        return "A gap means no overturning within the ramp."
    return f"A gap means no overturning within the ramp, or no run: {' and '.join(other)} (see `note`)."


def _scatter_band(ax: Any, ds: xr.Dataset, method: str, nominal: xr.DataArray) -> None:
    """The range under changes of a few parts in a million."""
    tiny = ds.varied_amplitude.sel({"method": method})[(ds.variation_group == "scatter").values]
    if tiny.sizes["variation"] == 0:
        return
    low = np.fmin(nominal, tiny.min("variation")) / G
    high = np.fmax(nominal, tiny.max("variation")) / G
    ax.fill_between(ds.frequency, low, high, color="0.8", lw=0, label="ramp changed by 1e-6")


def _varied_panel(ax: Any, ds: xr.Dataset, method: str, group: str, block: int) -> None:
    nominal = ds.overturning_amplitude.sel({"method": method, "block": block})
    _scatter_band(ax, ds, method, nominal)
    ax.plot(ds.frequency, nominal / G, color=COLOURS[method], lw=2, marker=MARKERS[method], ms=4, label="as in Fig. 16")
    styles = iter([("--", "x"), (":", "+"), ("-.", "d"), ((0, (5, 1, 1, 1, 1, 1)), "v")])
    members = np.flatnonzero((ds.variation_group == group).values)
    shown = 0
    for i in members:
        curve = ds.varied_amplitude.isel(variation=i).sel({"method": method})
        if (ds.varied_note.isel(variation=i).sel({"method": method}) == "not a parameter of this method").all():
            continue
        line, marker = next(styles)
        shown += 1
        label = str(ds.variation.values[i]) + ("" if curve.notnull().any() else ": none falls, or declined")
        ax.plot(ds.frequency, curve / G, color="k", lw=1, ls=line, marker=marker, ms=4, label=label)
    if not shown:
        text = f"not varied for {METHOD_LABELS[method]}"
        ax.text(0.97, 0.04, text, transform=ax.transAxes, ha="right", color="0.4")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=7, loc="upper left", framealpha=0.8)


def sensitivity_figure(ds: xr.Dataset) -> Figure:
    """How far each method's curve moves with each parameter that the paper does not print."""
    block = int(ds.attrs["sensitivity_block"])
    methods = ds.method.values
    fig = new_figure(17.0, 3.7 * len(methods) + 0.9)
    axes = fig.subplots(len(methods), len(GROUPS), squeeze=False, sharex=True, sharey="row")
    for row, method in enumerate(methods):
        for column, group in enumerate(GROUPS):
            _varied_panel(axes[row, column], ds, method, group, block)
        axes[row, 0].set_ylim(bottom=0.0)
        axes[row, 0].set_ylabel(f"{METHOD_LABELS[method]}\nenvelope at overturning [g]")
    for column, group in enumerate(GROUPS):
        axes[0, column].set_title(GROUP_TITLES[group])
        axes[-1, column].set_xlabel("Frequency of the base motion [Hz]")
    caption(
        fig,
        f"Block {block}: criteria of overturning with one parameter changed at a time. Notice: the grey band, where "
        "nothing but the ramp's sixth digit changes, is what chance does to a single run; only what leaves it is an "
        "effect of the parameter. Each row has its own scale.",
    )
    return fig
