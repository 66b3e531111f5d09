"""A run as a moving picture: GIF by Pillow, MP4 by ffmpeg through matplotlib.

Bodies on the left; on the right the base's acceleration and rotations, each with a cursor at the instant shown.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.animation import FFMpegWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image
from tqdm import tqdm

from studies.animation.film import Film
from studies.animation.frames import FILLS, draw_frame
from studies.animation.page import CLIP_DEGREES, TRACED
from studies.running.files import write_whole
from studies.running.plot import new_figure

DPI = 90
SIZE = (8.0, 4.5)
"""Of a picture [inch]; 720 by 405 pixels."""

COLOURS = 128


class Stage:
    """The figure that is drawn anew at each instant: what does not move is drawn once."""

    def __init__(self, film: Film, start: float, end: float) -> None:
        self.film = film
        self.figure = new_figure(*SIZE)
        self.canvas = FigureCanvasAgg(self.figure)
        axes = self.figure.subplot_mosaic([["scene", "base"], ["scene", "rotation"]], height_ratios=[1.0, 1.6])
        self.scene = axes["scene"]
        self.patches = draw_frame(self.scene, film, 0)
        self.clock = self.scene.text(0.02, 0.98, "", transform=self.scene.transAxes, va="top", fontsize=10)
        self.figure.suptitle(film.title, fontsize=11)
        _draw_base(axes["base"], film)
        _draw_rotations(axes["rotation"], film)
        for name in ("base", "rotation"):
            axes[name].set_xlim(start, max(end, start + 1e-9))
        self.cursors = [axes[name].axvline(start, color="#d1242f", lw=1.2) for name in ("base", "rotation")]
        self.moving: list[Any] = [*self.patches, self.clock, *self.cursors]
        self.canvas.draw()
        self.figure.set_layout_engine("none")
        for artist in self.moving:
            artist.set_animated(True)
        self.canvas.draw()
        self.still = self.canvas.copy_from_bbox(self.figure.bbox)

    def show(self, time: float) -> None:
        """Move everything to where it is at a time [s]."""
        for patch, corners in zip(self.patches, self.film.outlines_at(time), strict=True):
            patch.set_xy(corners)
        self.clock.set_text(f"{time:.2f} s")
        for cursor in self.cursors:
            cursor.set_xdata([time, time])

    def picture(self) -> Image.Image:
        """What is shown now."""
        self.canvas.restore_region(self.still)
        for artist in self.moving:
            artist.axes.draw_artist(artist)
        return Image.fromarray(np.asarray(self.canvas.buffer_rgba())[:, :, :3].copy())


def _draw_base(ax: Any, film: Film) -> None:
    for values, line, name in ((film.base_ax, "-", "horizontal"), (film.base_az, "--", "vertical")):
        if values is not None and (values.any() or name == "horizontal"):
            ax.plot(film.time, values, line, color="k", lw=0.9, label=name)
    if len(ax.get_lines()) > 1:
        ax.legend(fontsize=7, loc="upper left")
    ax.set_title("Base acceleration [m/s$^2$]", fontsize=9)
    ax.tick_params(labelsize=8)
    ax.grid(alpha=0.3)


def _draw_rotations(ax: Any, film: Film) -> None:
    largest = np.abs(film.theta).max(axis=0)
    chosen = sorted(np.argsort(-largest, kind="stable")[:TRACED])
    for b in chosen:
        ax.plot(film.time, np.degrees(film.theta[:, b]), color=FILLS[b % len(FILLS)], lw=1.1, label=film.names[b])
    most = min(CLIP_DEGREES, 1.05 * math.degrees(float(largest.max())))
    ax.set_ylim(-max(most, 0.01), max(most, 0.01))
    ax.set_title("Rotation [degrees, clockwise]", fontsize=9)
    ax.set_xlabel("Time [s]", fontsize=9)
    ax.tick_params(labelsize=8)
    ax.legend(fontsize=7, loc="upper left")
    ax.grid(alpha=0.3)


def instants(film: Film, start: float | None, end: float | None, speed: float, fps: float) -> npt.NDArray[Any]:
    """Times that are shown [s]: from start to end, speed/fps apart, the end always among them.

    Raises:
        ValueError: speed or fps is not positive, or the run does not cover start to end.
    """
    for name, value in (("speed", speed), ("fps", fps)):
        if not (math.isfinite(value) and value > 0.0):
            raise ValueError(f"{name}={value}: want a positive number")
    first, last = float(film.time[0]), float(film.time[-1])
    start, end = first if start is None else start, last if end is None else end
    if not first <= start <= end <= last:
        raise ValueError(f"{start} to {end} s: want a stretch within {first:.6g} to {last:.6g} s, which the run covers")
    count = math.floor((end - start) * fps / speed + 1e-9)
    times = start + np.arange(count + 1) * speed / fps
    return times if end - times[-1] < 1e-9 else np.append(times, end)


def write_gif(film: Film, path: Path, times: npt.NDArray[Any], fps: float, progress: bool) -> None:
    """A GIF of these instants. Its frames last a whole number of hundredths of a second, as the format has it."""
    stage = Stage(film, float(times[0]), float(times[-1]))
    duration = max(20, round(100.0 / fps) * 10)

    def pictures() -> Iterator[Image.Image]:
        palette: Image.Image | None = None
        for time in tqdm(times, unit="frame", desc="GIF", disable=None if progress else True):
            stage.show(float(time))
            picture = stage.picture()
            if palette is None:
                palette = picture.quantize(COLOURS)
            yield picture.quantize(palette=palette, dither=Image.Dither.NONE)

    def write(target: Path) -> None:
        made = pictures()
        next(made).save(target, save_all=True, append_images=made, duration=duration, loop=0)

    write_whole(path, write)


def write_mp4(film: Film, path: Path, times: npt.NDArray[Any], fps: float, progress: bool) -> None:
    """An MP4 of these instants.

    Raises:
        RuntimeError: there is no ffmpeg.
    """
    if not FFMpegWriter.isAvailable():
        raise RuntimeError("MP4 needs the program ffmpeg, which is not on the PATH: install it, or save .gif or .html")
    stage = Stage(film, float(times[0]), float(times[-1]))

    def write(target: Path) -> None:
        # yuv420p and even sizes: what browsers and slides play.
        rate: Any = fps  # matplotlib's own hint is too narrow
        writer = FFMpegWriter(fps=rate, codec="libx264", extra_args=["-pix_fmt", "yuv420p", "-vf", EVEN])
        with writer.saving(stage.figure, str(target), DPI):
            for time in tqdm(times, unit="frame", desc="MP4", disable=None if progress else True):
                stage.show(float(time))
                writer.grab_frame()

    write_whole(path, write)


EVEN = "pad=ceil(iw/2)*2:ceil(ih/2)*2"
