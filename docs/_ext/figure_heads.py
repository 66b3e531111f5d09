"""What can be made on the command line, from the heads of the files that have a command."""

from __future__ import annotations

from effect_heads import literal

from studies.running.commands import ELSEWHERE, commands


def figures_text() -> str:
    """A table of commands."""
    rows = [
        "| `python -m studies` | All studies: a list of them, and every one made in one go with a page of pictures. |"
    ]
    for name, text in commands().items():
        rows.append(f"| `python -m {name if name in ELSEWHERE else f'studies.{name}'}` | {literal(text)} |")
    return "\n".join(["::::{container} commands", "| command | makes |", "|---|---|", *rows, "::::"])
