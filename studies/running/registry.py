"""Which studies there are: found by walking the package, no list to edit.

A study is a module of `studies`, or of a package in it, that has a line `STUDY = ...` with a
`studies.running.study.Study`.

Source   none, own convention
Status   every module with such a line is found, and no other is imported (tests)
"""

from __future__ import annotations

import importlib
import re
from pathlib import Path

from studies.running.study import Study

HERE = Path(__file__).resolve().parents[1]
DECLARED = re.compile(r"^STUDY\b[^=\n]*=", re.MULTILINE)


def modules() -> list[str]:
    """Names of the modules that declare a study, figures of the paper first, in the order of their numbers."""
    found = []
    for path in sorted(HERE.rglob("*.py")):
        inside = path.relative_to(HERE)
        if len(inside.parts) <= 2 and DECLARED.search(path.read_text(encoding="utf-8")):
            stem = inside.with_suffix("") if inside.stem != "__init__" else inside.parent
            found.append(".".join(["studies", *stem.parts]))
    return sorted(found, key=lambda name: (not name.startswith("studies.fig"), name))


def studies() -> dict[str, Study]:
    """Every study by its name."""
    found: dict[str, Study] = {}
    for name in modules():
        study = importlib.import_module(name).STUDY
        if study.name in found:
            raise ValueError(f"{name}: a study {study.name!r} is there already, want another name")
        found[study.name] = study
    return found
