"""Every command under one name: `rocking-studies fig16 --quick` is `python -m studies.fig16 --quick`.

Commands are found by walking the package: each module, or package, that can be run.  With argcomplete (the extra
`completion`) a shell completes their names, options and files; then nothing is run, and only what is completed is
loaded.

Source   none, own convention; completion after argcomplete's protocol (COMP_LINE, _ARGCOMPLETE)
Status   every module that can be run is offered; completed by a real shell (tests)
Run      rocking-studies [COMMAND ...], will-it-fall ...
"""

from __future__ import annotations

import argparse
import ast
import os
import re
import runpy
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parents[1]
ELSEWHERE = {"excitation": HERE.parent / "excitation" / "__main__.py"}
"""Commands of other packages."""

RUNS = re.compile(r'^if __name__ == "__main__"', re.MULTILINE)


def commands() -> dict[str, str]:
    """First sentence of the head of every command, by its name; figures of the paper first."""
    places = {p.stem: p for p in HERE.glob("*.py") if not p.stem.startswith("_")}
    places |= {p.parent.name: p for p in HERE.glob("*/__main__.py")} | ELSEWHERE
    found = {}
    for name in sorted(places, key=lambda name: (not name.startswith("fig"), name)):
        text = places[name].read_text(encoding="utf-8")
        if RUNS.search(text):
            found[name] = " ".join((ast.get_docstring(ast.parse(text)) or "").split("\n\n")[0].split())
    return found


def _parser() -> argparse.ArgumentParser:
    known = commands()
    width = max(map(len, known))
    parser = argparse.ArgumentParser(
        prog="rocking-studies",
        description="Run a command of this package; each says more with --help.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="\n".join(["commands:", *(f"  {name:{width}s}  {about}" for name, about in known.items()), "",
                          f"  {'all':{width}s}  every study in one go, as python -m studies all"]),
    )  # fmt: skip
    parser.add_argument("command", choices=[*known, "all", "list"], metavar="COMMAND", help="one of those below")
    parser.add_argument("options", nargs=argparse.REMAINDER, metavar="...", help="what the command itself takes")
    return parser


def _run_module(prog: str, name: str, options: Sequence[str]) -> None:
    """Run a command as `python -m` does."""
    every = name in ("all", "list")
    module = name if name in ELSEWHERE else "studies" if every else f"studies.{name}"
    sys.argv[:] = [prog, *([name] if every else []), *options]
    runpy.run_module(module, run_name="__main__", alter_sys=True)


def _words() -> list[str]:
    """What stands on the command line before the word that the shell wants completed, without the command itself."""
    from argcomplete import split_line

    line, point = os.environ["COMP_LINE"], int(os.environ["COMP_POINT"])
    _, _, _, words, _ = split_line(line, point)
    return list(words[1:])


def _complete_with_the_commands_own_parser() -> None:
    """From here on the first parser that is given a command line completes it and leaves."""
    import argcomplete

    def complete(parser: argparse.ArgumentParser, args: Sequence[str] | None = None, namespace: Any = None) -> None:
        # Words that the command took off before it asked its parser, as the name of a command.
        taken = len(_words()) - len(sys.argv[1:] if args is None else args)
        os.environ["_ARGCOMPLETE"] = str(int(os.environ["_ARGCOMPLETE"]) + taken)
        argcomplete.autocomplete(parser)

    argparse.ArgumentParser.parse_args = complete  # type: ignore[assignment,method-assign]


def main() -> None:
    """`rocking-studies`: a list of the commands, or one of them."""
    given = sys.argv[1:]
    if "_ARGCOMPLETE" in os.environ:
        _complete_with_the_commands_own_parser()
        given = _words()
    known = [*commands(), "all", "list"]
    if given and given[0] in known:
        _run_module(sys.argv[0], given[0], given[1:])
        return
    parser = _parser()
    if not given and "_ARGCOMPLETE" not in os.environ:
        parser.print_help()
        return
    parser.parse_args(given)


def will_it_fall() -> None:
    """`will-it-fall`: the first question."""
    given = sys.argv[1:]
    if "_ARGCOMPLETE" in os.environ:
        _complete_with_the_commands_own_parser()
        given = _words()
    _run_module(sys.argv[0], "will_it_fall", given)
