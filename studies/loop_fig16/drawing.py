"""Fig. 16 before and after the loop, drawn; and a history that the loop did not see."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from rocking import G_STANDARD
from studies.running.plot import caption, new_figure

G = G_STANDARD
STYLES: dict[str, dict[str, Any]] = {
    "laboratory": {"color": "k", "marker": "s", "label": "laboratory (Method 2)"},
    "declared": {"color": "#CC79A7", "marker": ".", "ls": ":", "label": "Method 1, Housner's restitution"},
    "before": {"color": "#D55E00", "marker": "o", "label": "before: Method 1, calibrated"},
    "after": {"color": "#0072B2", "marker": "x", "ls": "--", "label": "after: what the loop found"},
}


def figure(ds: xr.Dataset) -> Figure:
    """Criteria, time spent sliding, and a history that was held out."""
    fig = new_figure(11.5, 7.2)
    grid = fig.add_gridspec(2, 2, width_ratios=[1.6, 1.0])
    _criteria(fig.add_subplot(grid[0, 0]), ds)
    _sliding(fig.add_subplot(grid[0, 1]), ds)
    _history(fig.add_subplot(grid[1, :]), ds)
    effects = ", ".join(
        f"{name} ({', '.join(f'{key} {value:.4g}' for key, value in values.items())})"
        for name, values in json.loads(ds.attrs["effects"]).items()
    )
    errors = json.loads(ds.attrs["errors"])
    caption(
        fig,
        f"Block {ds.attrs['block']} of Winkler, Meguro & Yamazaki (1995) in a laboratory that is Method 2 with a "
        f"friction of {ds.attrs['friction']:g}. From ramped tests and Method 1 alone the loop found: "
        f"{effects or 'no effect'} [{ds.attrs['verdict']}]. Error of tests held out, median: "
        f"{errors['before'][1]:.2g} rad before, {errors['after'][1]:.2g} rad after (floor "
        f"{ds.attrs['noise_floor']:.2g} rad). Notice: the gap of Fig. 16 between Method 1 and Method 2 opens where the "
        "block slides; calibrating Method 1 alone bends its restitution instead and makes it worse.",
    )
    return fig


def _criteria(ax: Any, ds: xr.Dataset) -> None:
    for model in ds.model.values:
        ax.plot(ds.frequency, ds.overturning_amplitude.sel(model=model) / G, ms=6, **STYLES[str(model)])
    ax.set_xlabel("Frequency of the base motion [Hz]")
    ax.set_ylabel("Envelope of base acceleration\nat overturning [g]")
    ax.set_ylim(bottom=0.0)
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8)


def _sliding(ax: Any, ds: xr.Dataset) -> None:
    step = float(np.diff(ds.frequency).min()) if ds.sizes["frequency"] > 1 else 0.5
    for k, model in enumerate(("laboratory", "after")):
        share = 100.0 * ds.sliding_share.sel(model=model).fillna(0.0)
        ax.bar(ds.frequency + (k - 0.5) * 0.4 * step, share, 0.36 * step, color=STYLES[model]["color"], label=model)
    ax.set_xlabel("Frequency of the base motion [Hz]")
    ax.set_ylabel("Time spent sliding until\noverturning [%]")
    ax.grid(alpha=0.3, axis="y")
    ax.legend(fontsize=8)


def _history(ax: Any, ds: xr.Dataset) -> None:
    names = {"measured": "laboratory", "before": "before", "after": "after"}
    for which in ("before", "measured", "after"):
        style = {k: v for k, v in STYLES[names[which]].items() if k in ("color", "ls")}
        label = "measured" if which == "measured" else which
        ax.plot(ds.time, np.degrees(ds.rotation.sel(history=which)), lw=1.0, label=label, **style)
    largest = float(np.degrees(np.abs(ds.rotation.sel(history="measured")).max()))
    ax.set_ylim(-1.3 * largest, 1.3 * largest)
    ax.set_xlabel("Time [s]")
    ax.set_ylabel("Rotation [°]")
    ax.set_title(f"{ds.attrs['test']}: held out, predicted from the base motion alone")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8, loc="upper left")
