"""A study: what is computed, how it is drawn, what the paper says of it, and the command line that all studies share.

The dataset is written first, then drawn; a dataset that is there with the same settings and sources is not computed
again.  Finished runs are kept in a hidden folder beside the files (`studies.running.parts`), for a study that was
interrupted, for others that make the same run, and for drawings that change.

Source   none, own convention
Status   each study runs with --quick in the tests
"""

from __future__ import annotations

import argparse
import json
import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, is_dataclass
from pathlib import Path
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from studies.running.command_line import add_common_arguments, run
from studies.running.files import (
    BadInputError,
    DatasetError,
    clear_unfinished,
    load_dataset,
    provenance,
    save_dataset,
    save_figure,
    writable_folder,
)
from studies.running.json_values import json_values
from studies.running.labelled import PAPER
from studies.running.lock import alone
from studies.running.parts import Parts, hashed, studies_hash
from studies.running.statements import VERDICTS


def _nothing(_: Any) -> None:
    """No further arguments, nothing more to say."""


@dataclass(frozen=True)
class Study:
    """One study; `dataset` computes and draws nothing, `figures` draw only what is in the dataset."""

    name: str  # of its files and of its module
    title: str  # a line
    about: str  # a paragraph for --help
    plan: Callable[[argparse.Namespace], Any]  # everything that decides the result; may raise BadInputError
    dataset: Callable[[Any, Parts], xr.Dataset]
    figures: Mapping[str, Callable[[xr.Dataset], Figure | None]]  # by file name without ending; None: not in this one
    check: Callable[[xr.Dataset], xr.Dataset]  # the paper's statements, as of `studies.running.statements.table`
    arguments: Callable[[argparse.ArgumentParser], None] = _nothing
    say: Callable[[xr.Dataset], None] = _nothing  # prints what else is worth saying
    films: Callable[[xr.Dataset, Path], Sequence[Path]] | None = None  # writes animations into a folder
    example: str = ""  # what a user may do with the dataset `ds`, in Python

    def run(self) -> None:
        """The command line of this study."""
        run(lambda argv: make(self, argv), "finished runs are kept, the same command goes on from there")


def parser_of(study: Study) -> argparse.ArgumentParser:
    """The command line's options."""
    pictures = ", ".join(f"{name}.png/.pdf" for name in study.figures)
    parser = argparse.ArgumentParser(
        prog=f"python -m studies.{study.name}",
        description=f"{study.title}. {study.about}",
        epilog=f"Writes {study.name}.nc, then draws it as {pictures}.",
    )
    study.arguments(parser)
    add_common_arguments(parser)
    parser.add_argument("--again", action="store_true", help="compute even if the dataset is there already")
    parser.add_argument("--workers", type=int, metavar="N", help="runs side by side (default: as many as cores)")
    return parser


def settings_of(plan: Any) -> str:
    """The plan as JSON, for the attributes."""
    said = asdict(plan) if is_dataclass(plan) and not isinstance(plan, type) else plan
    return json.dumps(json_values(said, repr), default=repr, allow_nan=False)


def inputs_of(study: Study, plan: Any) -> str:
    """A hash of everything that decides the dataset."""
    return hashed(study.name, plan, studies_hash())


def there_already(path: Path, inputs: str) -> xr.Dataset | None:
    """The dataset of that file if these inputs made it."""
    if not path.exists():
        return None
    try:
        ds = load_dataset(path)
    except DatasetError:
        return None  # damaged: it is computed again, from the runs that were kept
    return ds if ds.attrs.get("inputs") == inputs else None


def _computed(study: Study, plan: Any, inputs: str, path: Path, workers: int | None, command: str) -> xr.Dataset:
    parts = Parts(path.with_name(".runs"), workers)
    ds = study.dataset(plan, parts)
    ds.attrs |= provenance(study.title, command)  # of a run that is part of the study there may be another title
    ds.attrs = {"settings": settings_of(plan), "references": PAPER} | ds.attrs | {"study": study.name, "inputs": inputs}
    statements = study.check(ds)
    if statements.sizes["statement"]:
        ds = ds.merge(statements, combine_attrs="no_conflicts")
    save_dataset(ds, path)
    parts.clear_outdated()
    return ds


def report(ds: xr.Dataset) -> None:
    """Print the paper's statements with what became of them."""
    for i in range(ds.sizes.get("statement", 0)):
        row = ds.isel(statement=i)
        verdict = VERDICTS[int(row.statement_holds)]
        print(f"{verdict}: {row.statement.item()} [{row.statement_number.item():.3g}; {row.statement_bound.item()}]")
        if row.statement_detail.item():
            print(f"    {row.statement_detail.item()}")


def make(study: Study, argv: list[str]) -> list[Path]:
    """Compute unless it is there already, save, draw, and say what was found; the files written.

    Raises:
        BadInputError: an option's value is not one that it can have.
        OSError: a file cannot be written; runs that are finished are kept.
    """
    arguments = parser_of(study).parse_args(argv)
    if arguments.workers is not None and arguments.workers < 1:
        raise BadInputError(f"--workers {arguments.workers}: want 1 or more")
    plan = study.plan(arguments)
    folder: Path = writable_folder(arguments.out)
    path, inputs = folder / f"{study.name}.nc", inputs_of(study, plan)
    # Dataset and pictures of one run belong together.
    with alone(path):
        clear_unfinished(path)
        ds = None if arguments.again else there_already(path, inputs)
        if ds is None:
            command = shlex.join(["python", "-m", f"studies.{study.name}", *argv])
            ds = _computed(study, plan, inputs, path, arguments.workers, command)
        else:
            print(f"{path} is there already with these settings (--again computes it anew)")
        written = [path]
        for name, draw in study.figures.items():
            if (figure := draw(ds)) is not None:
                written += save_figure(figure, folder, name)
        if study.films is not None:
            written += study.films(ds, folder)
    study.say(ds)
    report(ds)
    print("wrote", ", ".join(str(path) for path in written))
    return written
