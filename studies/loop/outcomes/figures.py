"""The drawings of the report on outcomes, each a self-contained SVG.

Text is drawn as paths, and no text of a stranger is drawn.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.lines import Line2D

from studies.loop.outcomes.likelihood import Array
from studies.loop.report.figures import AFTER, BEFORE, MEASURED, STYLE, svg
from studies.running.plot import new_figure

BINS = 8


def by_motion(tests: xr.Dataset, rows: list[str]) -> str:
    """Every test: a row for each motion, along its peak velocity; filled where it fell, marked where a model is wrong.

    Args:
        tests: of loop.nc.
        rows: names of the motions, from the top.
    """
    with rc_context(STYLE):
        figure = new_figure(8.6, 0.9 + 0.185 * len(rows))
        ax = figure.subplots()
        y = np.array([rows.index(str(name)) for name in tests.motion.values])
        x, fell = tests.peak_velocity.values, tests.overturned.values.astype(bool)
        for held in np.flatnonzero([bool(tests.held_out.values[y == k].any()) for k in range(len(rows))]):
            ax.axhspan(held - 0.5, held + 0.5, color="#eef3f8", zorder=0)
        ax.scatter(x[fell], y[fell], s=20, color=MEASURED, zorder=3, linewidth=0.0)
        ax.scatter(x[~fell], y[~fell], s=20, facecolor="white", edgecolor=MEASURED, linewidth=0.8, zorder=3)
        for stage, colour, marker, size in (("before", BEFORE, "s", 62), ("after", AFTER, "x", 46)):
            wrong = (tests[f"probability_{stage}"].values > 0.5) != fell
            if marker == "x":
                ax.scatter(x[wrong], y[wrong], s=size, marker=marker, color=colour, linewidth=1.3, zorder=4)
            else:
                ax.scatter(
                    x[wrong],
                    y[wrong],
                    s=size,
                    marker=marker,
                    facecolor="none",
                    edgecolor=colour,
                    linewidth=1.3,
                    zorder=4,
                )
        ax.set_yticks(range(len(rows)), [str(k + 1) for k in range(len(rows))], fontsize=6.5)
        ax.set_ylim(len(rows) - 0.5, -0.5)
        _logarithmic(ax, x)
        ax.set_xlabel("largest base velocity [m/s]")
        ax.set_ylabel("motion (numbers as in the table)")
        ax.grid(axis="x", which="both", alpha=0.2)
        _legend(ax)
        return svg(figure)


def _logarithmic(ax: Any, x: Array) -> None:
    """A logarithmic axis with few plain numbers on it."""
    ax.set_xscale("log")
    known = x[x > 0.0]
    low, high = float(known.min()), float(known.max())
    ticks = [f * 10.0**k for k in range(-4, 4) for f in (1.0, 2.0, 5.0) if low <= f * 10.0**k <= high]
    ax.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    ax.minorticks_off()


def _legend(ax: Any) -> None:
    def mark(marker: str, text: str, **more: Any) -> Line2D:
        return Line2D([], [], linestyle="none", marker=marker, label=text, **more)

    handles = [
        mark("o", "fell", color=MEASURED, markersize=4.5),
        mark("o", "did not", markerfacecolor="white", markeredgecolor=MEASURED, markersize=4.5),
        mark("s", "wrong before", markerfacecolor="none", markeredgecolor=BEFORE, markersize=7.0),
        mark("x", "wrong after", color=AFTER, markersize=6.0),
    ]
    ax.legend(handles=handles, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4, frameon=False, fontsize=8.5)


def against(tests: xr.Dataset, name: str, label: str) -> str:
    """Probability of falling after, and the share that fell and that each model lets fall, against a measure."""
    with rc_context(STYLE):
        figure = new_figure(4.3, 3.3)
        ax = figure.subplots()
        x, fell = tests[name].values, tests.overturned.values.astype(bool)
        p = tests.probability_after.values
        rng = np.random.default_rng(0)
        shift = 0.012 * rng.standard_normal(x.size)
        for kind, face in ((fell, MEASURED), (~fell, "white")):
            ax.scatter(x[kind], (p + shift)[kind], s=12, facecolor=face, edgecolor=MEASURED, linewidth=0.5, alpha=0.55)
        order = np.argsort(x, kind="stable")
        parts = np.array_split(order, min(BINS, max(2, x.size // 12)))
        at = [float(np.exp(np.mean(np.log(x[part])))) for part in parts]
        for values, colour, style, text in (
            (fell, MEASURED, "-", "fell"),
            (tests.probability_before.values, BEFORE, "--", "before"),
            (p, AFTER, "-", "after"),
        ):
            ax.plot(
                at, [float(np.mean(values[part])) for part in parts], style, color=colour, linewidth=1.6, label=text
            )
        _logarithmic(ax, x)
        ax.set_ylim(-0.05, 1.05)
        ax.set_xlabel(label)
        ax.set_ylabel("probability of falling")
        ax.grid(alpha=0.25)
        ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, frameon=False, fontsize=8.5)
        return svg(figure)


def reliability(tests: xr.Dataset) -> str:
    """Share that fell against the probability that was said, before and after, with standard errors; held-out tests."""
    with rc_context(STYLE):
        figure = new_figure(4.3, 3.3)
        ax = figure.subplots()
        ax.plot([0.0, 1.0], [0.0, 1.0], color="0.6", linewidth=0.8)
        held = tests.held_out.values.astype(bool)
        fell = tests.overturned.values[held].astype(float)
        for stage, colour, marker in (("before", BEFORE, "o"), ("after", AFTER, "s")):
            at, share, error = _binned(tests[f"probability_{stage}"].values[held], fell)
            ax.errorbar(at, share, error, color=colour, marker=marker, markersize=4.5, linewidth=1.2, capsize=2.5,
                        linestyle="none", label=stage)  # fmt: skip
        ax.set_xlim(-0.03, 1.03)
        ax.set_ylim(-0.03, 1.03)
        ax.set_xlabel("probability of falling that was predicted")
        ax.set_ylabel("share that fell (held-out tests)")
        ax.grid(alpha=0.25)
        ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False, fontsize=8.5)
        return svg(figure)


def _binned(p: Array, fell: Array) -> tuple[Array, Array, Array]:
    """(mean probability, share that fell, its standard error) in fifths of probability that hold a test."""
    rows = []
    for k in range(5):
        part = (p >= 0.2 * k) & ((p < 0.2 * (k + 1)) | (k == 4))
        n = int(part.sum())
        if n:
            # Add one fall and one survival: a share of all of few is not certain.
            share = (fell[part].sum() + 1.0) / (n + 2.0)
            rows.append((float(p[part].mean()), float(fell[part].mean()), float(np.sqrt(share * (1.0 - share) / n))))
    at, found, error = np.array(rows).reshape(-1, 3).T
    return at, found, error
