"""A sweep from the command line: `python -m studies.sweep FILE.toml --out FILE.nc`."""

from __future__ import annotations

import argparse
import shlex
from pathlib import Path

from studies.running import command_line
from studies.running.files import BadInputError, writable_folder
from studies.sweep.declared import read
from studies.sweep.evaluation import FELL
from studies.sweep.gathering import count
from studies.sweep.running import CHUNK_POINTS, run


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m studies.sweep",
        description=(
            "Criteria of rocking and overturning over any axes, declared in a small TOML, as one labelled dataset. "
            "Written as it goes: the same command goes on where a run was cut off."
        ),
    )
    parser.add_argument("file", type=Path, metavar="FILE.toml", help="what is swept; see studies/sweep/declared.py")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.nc", help="the dataset")
    parser.add_argument("--workers", type=int, metavar="N", help="chunks side by side (default: as many as cores)")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="run on a dask cluster, as tcp://host:8786")
    parser.add_argument(
        "--chunk", type=int, default=CHUNK_POINTS, metavar="POINTS", help="points of a chunk (default: %(default)s)"
    )
    return parser


def main(argv: list[str]) -> None:
    """Check, carry out, write.

    Raises:
        BadInputError: the file or an option is not what it must be.
    """
    arguments = _parser().parse_args(argv)
    try:
        sweep = read(arguments.file)
        writable_folder(arguments.out.parent)
        print(f"{sweep.size} points: {' x '.join(f'{len(v)} {name}' for name, v in sweep.axes.items())}", flush=True)
        with run(
            sweep, arguments.out, workers=arguments.workers, scheduler=arguments.scheduler,
            chunk_points=arguments.chunk, command=shlex.join(["python", "-m", "studies.sweep", *argv]),
        ) as ds:  # fmt: skip
            print(f"{count(ds, FELL)} of {ds.outcome.size} fall; wrote {arguments.out}")
            if ds.attrs["declined"] != "[]":
                print(f"declined: {ds.attrs['declined']}")
    except (ValueError, RuntimeError) as error:
        raise BadInputError(str(error)) from None


if __name__ == "__main__":
    command_line.run(main, "finished chunks are kept, the same command goes on from there")
