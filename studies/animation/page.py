"""A run as one self-contained page: bodies on a canvas, play, scrub, speed, keyboard, histories with a moving cursor.

The page asks nothing of the network (its content policy forbids it), and everything shown is escaped. Its size is
bounded: samples are thinned evenly until there are at most `MOST_FRAMES`, and fewer if their poses would exceed
`MOST_BYTES`; each pose is three 16-bit numbers, so x, z and theta are exact to half of 1/65535 of their range.
"""

from __future__ import annotations

import base64
import json
import math
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from studies.animation.film import Film, FloatArray
from studies.animation.frames import FILLS, GROUND
from studies.running.files import write_whole

MOST_FRAMES = 6000
MOST_BYTES = 3_000_000
"""Poses before they are written as text, which takes a third more."""

TRACED, ROWS, EVENTS = 6, 200, 200
"""Traces shown at first (of the bodies that turn most), rows of the table of places, events listed."""

CLIP_DEGREES = 30.0
"""The axis of rotations ends here, lest a body that lies hides how the others rock."""

SPEEDS = (0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8)
LEVELS = 65535


def thinned(film: Film, most_frames: int = MOST_FRAMES, most_bytes: int = MOST_BYTES) -> tuple[npt.NDArray[Any], int]:
    """Samples that are kept, the last always among them, and every how manieth that is."""
    allowed = max(2, min(most_frames, most_bytes // (6 * len(film.names))))
    every = math.ceil(film.time.size / allowed)
    kept = np.arange(0, film.time.size, every)
    if kept[-1] != film.time.size - 1:
        kept = np.append(kept, film.time.size - 1)
    return kept, every


def page(film: Film, *, most_frames: int = MOST_FRAMES, most_bytes: int = MOST_BYTES) -> str:
    """The page as HTML.

    Args:
        film: what is shown.
        most_frames, most_bytes: bounds on frames, and on the bytes of their poses.

    Raises:
        ValueError: the film has no samples.
    """
    if not film.time.size:
        raise ValueError(f"film={film!r}: want at least one sample")
    kept, every = thinned(film, most_frames, most_bytes)
    poses, low, step = _poses(film, kept)
    base = [a[kept] for a in (film.base_ax, film.base_az) if a is not None]
    if len(base) == 2 and not base[1].any():
        base.pop()
    largest = np.abs(film.theta).max(axis=0)
    traced = sorted(np.argsort(-largest, kind="stable")[:TRACED].tolist())
    view = film.view()
    data = {
        "names": list(film.names),
        "outlines": [_rounded(outline) for outline in film.outlines],
        "walls": [_rounded(wall) for wall in film.walls],
        "floor": film.floor,
        "view": list(view),
        "time": _text(film.time[kept]),
        "poses": _text(poses),
        "low": low,
        "step": step,
        "base": [_coded(values) for values in base],
        "largest": [round(float(value), 6) for value in largest],
        "traced": traced,
        "fills": list(FILLS),
        "ground": GROUND,
        "clip_degrees": CLIP_DEGREES,
    }
    environment = Environment(
        loader=PackageLoader("studies.animation", "."), autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True,
    )  # fmt: skip
    return environment.get_template("page.html.jinja").render(
        title=film.title, ending=film.ending, names=film.names, events=film.events[:EVENTS],
        more_events=max(0, len(film.events) - EVENTS), last_frame=len(kept) - 1, speeds=SPEEDS, rows=ROWS,
        components=len(base), aspect=f"{(view[1] - view[0]) / (view[3] - view[2]):.4g}",
        rule=_rule(film, len(kept), every, step, traced), data=_json(data), style=_own("page.css"),
        script=_own("page.js"),
    )  # fmt: skip


def write_page(film: Film, path: Path) -> None:
    """Write the page, whole or not at all."""
    html = page(film).encode("utf-8")
    write_whole(path, lambda target: target.write_bytes(html))


def _poses(film: Film, kept: npt.NDArray[Any]) -> tuple[npt.NDArray[np.uint16], list[float], list[float]]:
    """(levels of x, z, theta, shape (frame, body, 3); lowest value of each; value of a level of each)."""
    levels = np.empty((len(kept), len(film.names), 3), np.uint16)
    low, step = [], []
    for i, values in enumerate((film.x, film.z, film.theta)):
        levels[:, :, i], least, size = _quantised(values[kept])
        low.append(least)
        step.append(size)
    return levels, low, step


def _quantised(values: FloatArray) -> tuple[npt.NDArray[np.uint16], float, float]:
    least, most = float(values.min()), float(values.max())
    size = (most - least) / LEVELS
    levels = np.rint((values - least) / size) if size > 0.0 else np.zeros_like(values)
    return levels.astype(np.uint16), least, size


def _coded(values: FloatArray) -> dict[str, Any]:
    levels, low, step = _quantised(values)
    return {"values": _text(levels), "low": low, "step": step}


def _text(values: npt.NDArray[Any]) -> str:
    """Little-endian bytes in base 64."""
    return base64.b64encode(np.ascontiguousarray(values, values.dtype.newbyteorder("<")).tobytes()).decode("ascii")


def _rounded(corners: FloatArray) -> list[list[float]]:
    return [[float(f"{value:.9g}") for value in corner] for corner in corners]


def _json(data: dict[str, Any]) -> Markup:
    """JSON that cannot end the element it stands in, whatever the names say."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    return Markup(text.replace("&", r"\u0026").replace("<", r"\u003c").replace(">", r"\u003e"))


def _own(name: str) -> Markup:
    """A file that lies beside this one."""
    return Markup(files("studies.animation").joinpath(name).read_text(encoding="utf-8").strip())


def _rule(film: Film, count: int, every: int, step: list[float], traced: list[int]) -> str:
    """What was thinned and rounded, for the foot of the page."""
    which = f"all {film.time.size} samples" if every == 1 else f"one in {every} of {film.time.size} samples"
    length = max(step[0], step[1]) / 2.0 * 1e3
    bodies = len(film.names)
    shown = (
        "" if bodies == len(traced) else f" At first the {len(traced)} of {bodies} bodies that turn most are traced."
    )
    return (
        f"{count} frames: {which} (at most {MOST_FRAMES} frames and "
        f"{MOST_BYTES / 1e6:g} MB of poses), straight between them; x and z to {length:.2g} mm, rotation to "
        f"{math.degrees(step[2]) / 2.0:.2g}°. Places are those in the frame of the base; the arrow is its horizontal "
        f"acceleration. The axis of rotations ends at {CLIP_DEGREES:g}°.{shown}"
    )
