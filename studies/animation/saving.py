"""One verb for all kinds of animation: the suffix of the file decides."""

from __future__ import annotations

from pathlib import Path

from studies.animation.film import Film, Run, film_of
from studies.animation.moving import instants, write_gif, write_mp4
from studies.animation.page import write_page

SUFFIXES = (".html", ".gif", ".mp4")


def save(
    run: Run | Film | str | Path,
    path: str | Path,
    *,
    title: str | None = None,
    start: float | None = None,
    end: float | None = None,
    speed: float = 1.0,
    fps: float = 20.0,
    progress: bool = False,
) -> Path:
    """Animate a run; returns the path.

    Args:
        run: a history of `dem`, its dataset, a file that holds one, or a film of it.
        path: .html (a page to play, offline), .gif or .mp4 (needs ffmpeg).
        title: heading (default: the scene's).
        start, end: stretch that is shown [s] (default: the whole run).
        speed: seconds of the run in a second of the GIF or MP4; a page has its own switch.
        fps: pictures a second of the GIF or MP4.
        progress: show a bar.

    Raises:
        ValueError: another suffix, a folder that is not there, a dataset that is not of a run, a stretch that it does
            not cover or, of a page, one between two samples, or a speed or fps that is not positive.
        RuntimeError: an MP4 where there is no ffmpeg.
    """
    path = Path(path)
    if path.suffix not in SUFFIXES:
        raise ValueError(f"path {path}: want a name that ends in {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}")
    if not path.parent.is_dir():
        raise ValueError(f"path {path}: want a folder that is there")
    film = (run if isinstance(run, Film) else film_of(run)).titled(title)
    times = instants(film, start, end, speed, fps)
    if path.suffix == ".html":
        write_page(film.between(float(times[0]), float(times[-1])), path)
    elif path.suffix == ".gif":
        write_gif(film, path, times, fps, progress)
    else:
        write_mp4(film, path, times, fps, progress)
    return path
