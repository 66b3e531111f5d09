"""What can be made with `python -m studies.NAME`, from the heads of the files in studies that have a command."""

from __future__ import annotations

import ast
from pathlib import Path

from effect_heads import literal

STUDIES = Path(__file__).resolve().parents[2] / "studies"


def _commands() -> list[tuple[str, str]]:
    """(name, first sentence of the head) of every module or package of studies that can be run."""
    found = []
    for path in sorted([*STUDIES.glob("*.py"), *STUDIES.glob("*/__main__.py")]):
        tree = ast.parse(path.read_text())
        runs = any(isinstance(n, ast.If) and "__name__" in ast.unparse(n.test) for n in tree.body)
        doc = ast.get_docstring(tree)
        if runs and doc and not path.name.startswith("_run"):
            module = path.parent if path.name == "__main__.py" else path.with_suffix("")
            name = ".".join(module.relative_to(STUDIES.parent).parts)
            found.append((name, " ".join(doc.split("\n\n")[0].split())))
    return found


def figures_text() -> str:
    """A table of commands."""
    rows = [f"| `python -m {name}` | {literal(text)} |" for name, text in _commands()]
    return "\n".join(["| command | makes |", "|---|---|", *rows])
