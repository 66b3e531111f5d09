"""All studies: a list of them, and every one made in one go with a page of the pictures.

python -m studies               what there is, a line each
python -m studies all [--quick] [--out DIR] [--only NAME ...]
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from studies.running.command_line import DEFAULT_OUT, add_common_arguments, one_of, run
from studies.running.files import NO_ROOM, BadInputError, writable_folder
from studies.running.index_page import write_index
from studies.running.registry import studies
from studies.running.study import Study, make


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m studies",
        description="Studies: without a word, a list of them; with `all`, every one, and index.html with the pictures.",
        epilog="A study whose dataset is there with the same settings and sources is not computed again.",
    )
    parser.add_argument("word", nargs="?", metavar="{all,list}", default="list", help="what to do (default: list)")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="make these alone")
    parser.add_argument("--workers", type=int, metavar="N", help="runs side by side (default: as many as cores)")
    add_common_arguments(parser)
    return parser


def _options(arguments: argparse.Namespace) -> list[str]:
    options = ["--out", str(arguments.out)] + (["--quick"] if arguments.quick else [])
    return options + ([] if arguments.workers is None else ["--workers", str(arguments.workers)])


def _refuse_options(arguments: argparse.Namespace) -> None:
    """A list has no options.

    Raises:
        BadInputError: one is given.
    """
    given = {
        f"--only {' '.join(arguments.only)}": bool(arguments.only), "--quick": arguments.quick,
        f"--workers {arguments.workers}": arguments.workers is not None,
        f"--out {arguments.out}": arguments.out != DEFAULT_OUT,
    }  # fmt: skip
    for option in (option for option, there in given.items() if there):
        raise BadInputError(f"{option}: want it with the word `all`, which makes studies; the list has no options")


def make_all(chosen: dict[str, Study], arguments: argparse.Namespace) -> dict[str, str]:
    """Make these studies one after the other; why one failed, by its name.

    Raises:
        OSError: nothing can be written any more.
    """
    failed = {}
    for number, (name, study) in enumerate(chosen.items(), start=1):
        print(f"--- {name} ({number} of {len(chosen)}): {study.title}", flush=True)
        start = time.perf_counter()
        try:
            make(study, _options(arguments))
        except OSError as error:
            if error.errno in NO_ROOM:  # what comes after could not be kept either
                raise
            failed[name] = f"{type(error).__name__}: {error}"
            print(f"failed: {failed[name]}", flush=True)
        except Exception as error:  # one study that fails does not take the others with it
            failed[name] = f"{type(error).__name__}: {error}"
            print(f"failed: {failed[name]}", flush=True)
        print(f"    {time.perf_counter() - start:.1f} s", flush=True)
    return failed


def main(argv: list[str]) -> None:
    """List, or make all.

    Raises:
        BadInputError: an option's value is not one that it can have, or a study failed.
    """
    arguments = _parser().parse_args(argv)
    found = studies()
    if arguments.word not in ("all", "list"):
        one = f"`python -m studies.{arguments.word}`" if arguments.word in found else "`python -m studies.NAME`"
        raise BadInputError(f"{arguments.word!r}: want all or list; one study is made with {one}")
    if arguments.word == "list":
        _refuse_options(arguments)
        width = max(map(len, found))
        for name, study in found.items():
            print(f"{name:{width}s}  {study.title}")
        return
    for name in arguments.only:
        one_of("--only", [name], tuple(found))
    folder: Path = writable_folder(arguments.out)
    chosen = {name: study for name, study in found.items() if not arguments.only or name in arguments.only}
    failed = make_all(chosen, arguments)
    print("wrote", write_index(folder, found))
    if failed:
        raise BadInputError(f"{len(failed)} of {len(chosen)} studies failed: {', '.join(failed)}")


if __name__ == "__main__":
    run(main, "finished runs are kept, the same command goes on from there")
