"""Frames of a run: a figure of the bodies where they are at given instants, as Figs 17 and 22 of the paper show them.

See          each square is headed by its instant; walls and floor are grey, each body keeps its colour.
Source       Winkler, Meguro & Yamazaki (1995), Figs 17 and 22, for the kind of picture.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from matplotlib.patches import Polygon as Patch

from studies.animation.film import Film, Run, film_of
from studies.running.plot import caption, new_figure

FILLS = ("#E69F00", "#56B4E9", "#009E73", "#F0E442", "#0072B2", "#D55E00", "#CC79A7")
"""Fills of the bodies, repeated (Okabe & Ito 2008)."""

LINE, GROUND = "#1b1f24", "#B0B5BB"


def draw_frame(ax: Any, film: Film, sample: int, view: tuple[float, float, float, float] | None = None) -> list[Patch]:
    """Draw walls, floor and bodies at a sample into `ax`; the patches of the bodies, in their order.

    Args:
        ax: matplotlib axes; axis lines and ticks are switched off.
        film: what is shown.
        sample: number of the sample.
        view: x from, x to, z from, z to [m] (default: `film.view()`, the same for all samples).
    """
    low_x, high_x, low_z, high_z = view or film.view()
    ax.set_xlim(low_x, high_x)
    ax.set_ylim(low_z, high_z)
    ax.set_aspect("equal")
    ax.set_axis_off()
    if film.floor:
        ax.fill_between([low_x, high_x], low_z, 0.0, color=GROUND, lw=0)
    for wall in film.walls:
        ax.add_patch(Patch(wall, facecolor=GROUND, edgecolor=LINE, lw=0.6))
    width = 0.8 if len(film.names) <= 20 else 0.3
    patches = [
        Patch(film.corners(sample, b), facecolor=FILLS[b % len(FILLS)], edgecolor=LINE, lw=width)
        for b in range(len(film.names))
    ]
    for patch in patches:
        ax.add_patch(patch)
    return patches


def frames(
    run: Run | Film | str | Path,
    times: Sequence[float],
    *,
    columns: int | None = None,
    labels: Sequence[str] | None = None,
    note: str = "",
    width: float = 1.9,
) -> Figure:
    """A figure of the bodies at these instants, in order, all in one view.

    Args:
        run: a history, its dataset, a file that holds one, or a film of it.
        times: instants [s]; each is shown by the nearest sample, whose own time heads the square.
        columns: squares in a row (default: at most six).
        labels: more to say of each, below its time (default: nothing).
        note: caption below the figure.
        width: of a square [inch].

    Raises:
        ValueError: no instants, one that the run does not cover, or a label too many or too few.
    """
    film = run if isinstance(run, Film) else film_of(run)
    if not len(times):
        raise ValueError("times=[]: want at least one instant [s]")
    if labels is not None and len(labels) != len(times):
        raise ValueError(f"labels: {len(labels)} for {len(times)} times: want one for each")
    if columns is not None and columns < 1:
        raise ValueError(f"columns={columns}: want at least 1")
    samples = [film.sample_at(float(time)) for time in times]
    across = min(columns or 6, len(samples))
    down = math.ceil(len(samples) / across)
    view = film.view(samples)
    height = width * (view[3] - view[2]) / (view[1] - view[0])
    title = 0.32 + (0.16 if labels is not None else 0.0)
    figure = new_figure(across * (width + 0.15), down * (height + title) + (0.55 if note else 0.1))
    axes = figure.subplots(down, across, squeeze=False).ravel()
    for number, ax in enumerate(axes):
        if number >= len(samples):
            ax.set_axis_off()
            continue
        draw_frame(ax, film, samples[number], view)
        heading = f"{film.time[samples[number]]:.2f} s"
        ax.set_title(heading if labels is None else f"{heading}\n{labels[number]}", fontsize=9)
    if note:
        caption(figure, note)
    return figure
