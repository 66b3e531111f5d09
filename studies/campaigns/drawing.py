"""A test drawn: rotation with its swings and impacts, the base with what rocking takes, accelerometers on the block."""

from __future__ import annotations

from typing import Any

import numpy as np

from studies.campaigns.clipping import clipped
from studies.campaigns.model import Campaign
from studies.campaigns.summary import Look
from studies.running.plot import caption, new_figure

BASE_X, BASE_Z, ROTATION, IMPACT, PEAK, REST = "#0072B2", "#56B4E9", "#000000", "#D55E00", "#009E73", "#DDDDDD"


def figure(each: Look, campaign: Campaign) -> Any:
    """A matplotlib Figure of one test."""
    test = each.test
    sensors = [c for c in test.channels if c.kind == "block_acceleration"]
    panels = [name for name, there in (
        ("rotation", test.rotation is not None), ("base", test.base_x is not None), ("block", bool(sensors)),
    ) if there]  # fmt: skip
    drawing = new_figure(10.0, 1.2 + 2.4 * max(1, len(panels)))
    axes = drawing.subplots(max(1, len(panels)), 1, sharex=True, squeeze=False)[:, 0]
    for name, ax in zip(panels, axes, strict=False):
        {"rotation": _rotation, "base": _base, "block": _block}[name](ax, each, campaign)
        ax.grid(alpha=0.3)
        ax.margins(x=0.0)
    if not panels:
        axes[0].text(0.5, 0.5, "no channel but time", ha="center", transform=axes[0].transAxes)
        axes[0].set_xlim(test.time[0], test.time[-1])
    axes[-1].set_xlabel("time [s]")
    motion = f", {test.motion}" if test.motion else ""
    # Strangers' texts may hold dollar signs, which are no mathematics.
    drawing.suptitle(f"{test.id} ({test.kind}{motion})".replace("$", r"\$"), fontsize=11)
    caption(drawing, _notice(each).replace("$", r"\$"))
    return drawing


def _legend(ax: Any) -> None:
    """Above the panel, where it hides nothing."""
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=7, ncols=6, frameon=False)


def _notice(each: Look) -> str:
    found = each.segmentation
    seen = "" if found is None else f"{len(found.swings)} swings, {len(found.impacts)} impacts. "
    return seen + ("Odd: " + "; ".join(each.warnings) + "." if each.warnings else "")


def _rotation(ax: Any, each: Look, campaign: Campaign) -> None:
    test, found = each.test, each.segmentation
    assert test.rotation is not None
    ax.plot(test.time, test.rotation, color=ROTATION, linewidth=0.8, label="rotation")
    if found is not None:
        for k, (a, b) in enumerate(found.rests):
            ax.axvspan(test.time[a], test.time[b - 1], color=REST, linewidth=0.0, label="rest" if k == 0 else None)
        ax.plot(
            [i.time for i in found.impacts], [each.zero] * len(found.impacts), "|", color=IMPACT, markersize=9,
            label="impact",
        )  # fmt: skip
        ax.plot(
            [s.peak_time for s in found.swings if s.turns], [s.peak for s in found.swings if s.turns], ".", color=PEAK,
            markersize=5, label="peak of a swing",
        )  # fmt: skip
    largest = np.nanmax(np.abs(test.rotation)) if np.isfinite(test.rotation).any() else 0.0
    if largest > 0.5 * campaign.block.alpha:
        for side in (-1, 1):
            label = "unstable balance, as declared" if side > 0 else None
            ax.axhline(side * campaign.block.alpha, color="0.5", linewidth=0.8, linestyle="--", label=label)
    ax.set_ylabel("rotation [rad]")
    _legend(ax)


def _base(ax: Any, each: Look, campaign: Campaign) -> None:
    test = each.test
    assert test.base_x is not None
    ax.plot(test.time, test.base_x, color=BASE_X, linewidth=0.8, label="along x")
    if test.base_z is not None:
        ax.plot(test.time, test.base_z, color=BASE_Z, linewidth=0.8, label="along z")
    rail = clipped(test.base_x)
    if rail.any():
        ax.plot(test.time[rail], test.base_x[rail], ".", color=IMPACT, label="on a rail")
    for side in (-1, 1):
        label = "onset of rocking (West), as declared" if side > 0 else None
        ax.axhline(side * campaign.block.onset_acceleration, color="0.5", linewidth=0.8, linestyle="--", label=label)
    ax.set_ylabel("base acceleration [m/s²]")
    _legend(ax)


def _block(ax: Any, each: Look, campaign: Campaign) -> None:
    colours = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
    sensors = [c for c in each.test.channels if c.kind == "block_acceleration"]
    for k, channel in enumerate(sensors):
        values = each.test.data[channel.name]
        label = channel.name.replace("$", r"\$")
        ax.plot(each.test.time, values, color=colours[k % len(colours)], linewidth=0.8, label=label)
    ax.set_ylabel("on the block [m/s²]")
    _legend(ax)
