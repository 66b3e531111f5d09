"""Animate a saved run of distinct elements: `python -m studies.animation RUN.nc --out RUN.html`.

A run is saved by `history.to_xarray().to_netcdf("run.nc")`.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from studies.animation.film import film_of
from studies.animation.saving import SUFFIXES, save
from studies.running.command_line import run
from studies.running.files import BadInputError


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m studies.animation",
        description=(
            "Animate a run of distinct elements: a page to play offline (.html), a GIF, or an MP4 (needs ffmpeg). Save "
            "a run with history.to_xarray().to_netcdf('run.nc')."
        ),
    )
    parser.add_argument("run", type=Path, metavar="RUN.nc", help="dataset of a run")
    parser.add_argument(
        "--out", type=Path, action="append", metavar="FILE",
        help=f"what to write, ending in {', '.join(SUFFIXES)}; may be repeated (default: RUN.html beside the run)",
    )  # fmt: skip
    parser.add_argument("--title", help="heading (default: the scene's)")
    parser.add_argument("--start", type=float, metavar="S", help="from this instant on [s]")
    parser.add_argument("--end", type=float, metavar="S", help="until this instant [s]")
    parser.add_argument("--speed", type=float, default=1.0, help="of GIF and MP4: 0.5 is half speed (default: 1)")
    parser.add_argument("--fps", type=float, default=20.0, help="pictures a second of GIF and MP4 (default: 20)")
    return parser


def main(argv: list[str] | None = None) -> None:
    """Read, animate, say what was written."""
    arguments = _parser().parse_args(argv)
    if not arguments.run.is_file():
        raise BadInputError(f"{arguments.run}: want the file of a saved run")
    targets: list[Path] = arguments.out or [arguments.run.with_suffix(".html")]
    try:
        film = film_of(arguments.run)
        for target in targets:
            save(
                film, target, title=arguments.title, start=arguments.start, end=arguments.end, speed=arguments.speed,
                fps=arguments.fps, progress=True,
            )  # fmt: skip
            print("wrote", target)
    except (ValueError, RuntimeError, OSError) as error:
        raise BadInputError(str(error)) from error


if __name__ == "__main__":
    run(main)
