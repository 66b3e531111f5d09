"""The drawings of the report, each a self-contained SVG: histories, and the residual against what it depends on.

Text is drawn as paths and no text of a stranger is drawn, so that a picture looks alike everywhere.
"""

from __future__ import annotations

import base64
import io
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.transforms import blended_transform_factory
from numpy.typing import NDArray

from studies.running.plot import new_figure

Array = NDArray[np.float64]

MEASURED, BEFORE, AFTER, BASE = "#000000", "#D55E00", "#0072B2", "#666666"
STYLE: dict[Any, Any] = {"font.size": 9.0, "axes.spines.top": False, "axes.spines.right": False, "svg.hashsalt": "loop"}
MOST_SAMPLES = 2500
BINS = 9

LEFT, RIGHT, BOTTOM, TOP, LABEL = 1.24, 0.12, 0.48, 0.3, 0.76
"""Margins of a history, and how far its labels are from its axes [inch]: to lay out each anew takes as long as to draw
it, and so all of them have the same scale."""


def svg(figure: Figure) -> str:
    """The figure as a data URI."""
    stream = io.BytesIO()
    with rc_context(STYLE):
        figure.savefig(stream, format="svg", metadata={"Date": None}, transparent=True)
    return "data:image/svg+xml;base64," + base64.b64encode(stream.getvalue()).decode("ascii")


def history(test: xr.Dataset, *, wide: bool) -> str:
    """What was measured and modelled of a test, the residuals below, and the base motion if it has one.

    That is the rotation, or the first accelerometer on the block where no rotation was measured.
    """
    base = test.get("base_acceleration_x")
    ratios = [2.2, 1.2] + ([0.7] if base is not None else [])
    with rc_context(STYLE):
        width, height = 9.6 if wide else 4.2, 1.05 * sum(ratios) + 0.4
        figure = Figure(figsize=(width, height))
        sides = {"left": LEFT / width, "right": 1.0 - RIGHT / width}
        ends = {"bottom": BOTTOM / height, "top": 1.0 - TOP / height, "hspace": 0.2}
        axes = figure.subplots(len(ratios), 1, sharex=True, height_ratios=ratios, gridspec_kw=sides | ends)
        t, shown = _moving(test)
        _rotations(axes[0], test, t, shown)
        _residuals(axes[1], test, t, shown)
        if base is not None:
            axes[2].plot(t, base.values[shown], color=BASE, linewidth=0.6)
            axes[2].set_ylabel("base [m/s²]" if wide else "base\n[m/s²]")
        axes[-1].set_xlabel("time [s]")
        axes[-1].margins(x=0.0)
        for ax in axes:
            ax.yaxis.set_label_coords(-LABEL / (width - LEFT - RIGHT), 0.5)
        return svg(figure)


def _moving(test: xr.Dataset) -> tuple[Array, NDArray[np.intp]]:
    """Times and indices of the samples to show: from the first to the last motion, measured or modelled, thinned."""
    noise = float(test.rotation_noise) if "rotation" in test else 1e-3
    names = ("rotation" if "rotation" in test else "rotation_estimate", "rotation_before", "rotation_after")
    moved = np.flatnonzero(np.any([np.abs(np.nan_to_num(test[name].values)) > 8.0 * noise for name in names], axis=0))
    size = test.sizes["time"]
    margin = max(2, size // 60)
    first, last = (int(moved[0]), int(moved[-1])) if moved.size else (0, size - 1)
    first, last = max(0, first - margin), min(size - 1, last + margin)
    shown = np.arange(first, last + 1, max(1, math.ceil((last - first + 1) / MOST_SAMPLES)))
    return test.time.values[shown], shown


def _compared(test: xr.Dataset) -> tuple[str, str]:
    """Name of the channel to show, and what to call it."""
    return ("rotation", "rotation [rad]") if "rotation" in test else ("block_acceleration_1", "on the block\n[m/s²]")


def _rotations(ax: Any, test: xr.Dataset, t: Array, shown: NDArray[np.intp]) -> None:
    name, label = _compared(test)
    # A broad line, so that a model that lies on it can be seen.
    ax.plot(t, test[name].values[shown], color=MEASURED, linewidth=2.8, alpha=0.4, label="measured")
    for stage, colour, style in (("before", BEFORE, "--"), ("after", AFTER, "-")):
        values = test[f"{name}_{stage}"].values[shown]
        ax.plot(t, values, style, color=colour, linewidth=1.0, label=f"model {stage}")
    largest = float(np.nanmax(np.abs(test[name].values)))
    most = max(float(np.max(np.abs(test[f"{name}_{stage}"].values[shown]))) for stage in ("before", "after"))
    limit = 1.15 * min(most, 2.0 * largest) if most > largest else 1.15 * largest
    ax.set_ylim(-limit, limit)
    ax.set_ylabel(label)
    ax.grid(alpha=0.25)
    # About the middle of the picture: over narrow axes it would reach beyond it.
    middle = blended_transform_factory(ax.figure.transFigure, ax.transAxes)
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), bbox_transform=middle, ncols=3, frameon=False,
              fontsize=8.5, handlelength=1.5, columnspacing=1.2)  # fmt: skip


def _residuals(ax: Any, test: xr.Dataset, t: Array, shown: NDArray[np.intp]) -> None:
    name, _ = _compared(test)
    for stage, colour, style in (("before", BEFORE, "--"), ("after", AFTER, "-")):
        values = test[f"{name}_residual_{stage}"].values[shown]
        ax.plot(t, values, style, color=colour, linewidth=0.8)
    seen = [test[f"{name}_residual_{stage}"].values[shown] for stage in ("before", "after")]
    limit = 1.15 * min(float(np.nanmax(np.abs(seen))), 2.0 * float(np.nanmax(np.abs(test[name].values))))
    ax.set_ylim(-limit, limit)
    ax.set_ylabel(f"measured\nless model\n[{'rad' if name == 'rotation' else 'm/s²'}]")
    ax.grid(alpha=0.25)


@dataclass(frozen=True)
class Points:
    """Residuals against something: arrays of shape (point,)."""

    x: Array
    before: Array
    after: Array
    sd: Array

    @property
    def there(self) -> NDArray[np.bool_]:
        """Which of them have a residual before."""
        return np.isfinite(self.x) & np.isfinite(self.sd) & (np.isfinite(self.before) | np.isfinite(self.after))

    def over_noise(self, stage: str) -> float:
        """Rms of the residual over its standard deviation [1]; NaN where there is none."""
        z = getattr(self, stage)[self.there] / self.sd[self.there]
        return math.sqrt(float(np.nanmean(z**2))) if np.isfinite(z).any() else math.nan


def dependence(points: Points, x_label: str, y_label: str, *, steps: bool = False) -> str:
    """Residual before and after: each point faint, means over bins with two standard errors.

    steps: whether x takes few values (a side, a number of a test), each a bin of its own.
    """
    with rc_context(STYLE):
        figure = new_figure(3.6, 2.75)
        ax = figure.subplots()
        there = points.there
        x, sd = points.x[there], points.sd[there]
        ax.axhline(0.0, color="0.6", linewidth=0.8)
        width, reach = float(np.ptp(x)) or 1.0, 1e-12
        for stage, colour, marker, shift in (("before", BEFORE, "o", -1.0), ("after", AFTER, "s", 1.0)):
            y = getattr(points, stage)[there]
            if not np.isfinite(y).any():
                continue
            moved = x + shift * (0.02 * width if steps else 0.0)
            ax.plot(moved, y, marker, color=colour, alpha=0.25, markersize=2.5, markeredgewidth=0.0, rasterized=True)
            at, mean, error = binned(moved, y, sd, steps=steps)
            ax.errorbar(at, mean, 2.0 * error, color=colour, marker=marker, markersize=4.5, linewidth=1.2, capsize=2.5,
                        linestyle="none" if steps else "--" if stage == "before" else "-", label=stage)  # fmt: skip
            reach = max(reach, float(np.max(np.abs(mean) + 2.0 * error)), float(np.nanpercentile(np.abs(y), 60.0)))
        # The means are what is to be read; single points far out are cut off.
        ax.set_ylim(-1.4 * reach, 1.4 * reach)
        if steps:
            ax.set_xticks(np.unique(x)[:: max(1, math.ceil(np.unique(x).size / 12))])
        ax.set_xlabel(x_label)
        ax.set_ylabel(y_label)
        ax.grid(alpha=0.25)
        ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False, fontsize=8.5)
        return svg(figure)


def binned(x: Array, y: Array, sd: Array, *, steps: bool = False) -> tuple[Array, Array, Array]:
    """(x, weighted mean, its standard error) over bins, or over each value of x.

    Bins hold about as much information (one over the variance) as each other.  The error is that of the noise, or of
    the scatter in the bin where that is more.
    """
    usable = np.isfinite(y)
    x, y, sd = x[usable], y[usable], sd[usable]
    parts = [np.flatnonzero(x == value) for value in np.unique(x)] if steps else _alike(x, sd)
    rows = []
    for part in parts:
        w = 1.0 / sd[part] ** 2
        mean = float(np.sum(w * y[part]) / np.sum(w))
        scatter = float(np.sum(w * (y[part] - mean) ** 2)) / max(part.size - 1, 1)
        rows.append((float(np.mean(x[part])), mean, math.sqrt(max(1.0, scatter) / float(np.sum(w)))))
    at, mean_, error = np.array(rows).reshape(-1, 3).T
    return at, mean_, error


def _alike(x: Array, sd: Array) -> list[NDArray[np.intp]]:
    """Indices of the bins: along x, of about the same information and at least four points each."""
    order = np.argsort(x, kind="stable")
    told = np.cumsum(1.0 / sd[order] ** 2)
    wanted = told[-1] / min(BINS, max(1, x.size // 4)) if x.size else 0.0
    parts, start = [], 0
    for k in range(x.size):
        enough = told[k] - (told[start - 1] if start else 0.0) >= wanted * (1.0 - 1e-9)
        if enough and k + 1 - start >= 4 and x.size - k - 1 >= 4:
            parts.append(order[start : k + 1])
            start = k + 1
    rest = order[start:]
    if parts and rest.size and told[-1] - told[start - 1] < 0.5 * wanted:
        return [*parts[:-1], np.concatenate([parts[-1], rest])]
    return [*parts, rest] if rest.size else parts


def learned(term: Any) -> str:
    """A learned term with its band."""
    with rc_context(STYLE):
        figure = new_figure(4.6, 3.2)
        ax = figure.subplots()
        x = np.asarray(term.x)
        ax.axhline(0.0, color="0.6", linewidth=0.8)
        ax.fill_between(x, np.asarray(term.low), np.asarray(term.high), color=AFTER, alpha=0.25, linewidth=0.0)
        ax.plot(x, np.asarray(term.y), color=AFTER, linewidth=1.6)
        ax.set_xlabel(term.x_label)
        ax.set_ylabel(term.y_label)
        ax.grid(alpha=0.25)
        return svg(figure)
