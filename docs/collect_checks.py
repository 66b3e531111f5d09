"""Run the tests and note what each of them compared: the table that the pages on validation are made from.

Noted    for each test: its claim (the name as a sentence), how many cases and comparisons it has, the comparison that
         comes nearest to its tolerance (found, wanted, allowed), and what stands beside the test about its source.
How      as a plugin of pytest: `pytest.approx` and `numpy.testing.assert_allclose` are watched; other assertions
         that pass leave their numbers.
Run      python docs/collect_checks.py [TEST FILES]  ->  docs/results/checks.csv (rows of the files that were run)
"""

from __future__ import annotations

import ast
import csv
import datetime
import io
import math
import os
import platform
import re
import subprocess
import sys
import tempfile
import tokenize
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "docs" / "results" / "checks.csv"
COLUMNS = ("file", "test", "claim", "cases", "comparisons", "found", "wanted", "allowed", "share_of_allowed", "beside",
           "date", "python", "machine")  # fmt: skip
LONGEST = 90  # characters of an assertion's numbers
SKIPPED = ("fuzz", "cache", "import_is_light", "third_party", "test_readme", "tests/docs", "test_command")


class Collector:
    """Watches comparisons while tests run."""

    def __init__(self) -> None:
        self.rows: dict[tuple[str, str], dict[str, Any]] = {}
        self.current: tuple[str, str] | None = None

    def begin(self, item: pytest.Item) -> None:
        file, _, name = item.nodeid.partition("::")
        self.current = (file, name.split("[")[0])

    def compared(self, found: Any, wanted: Any, allowed: Any) -> None:
        """Note one numerical comparison; arrays count with their worst entry."""
        if self.current is None:
            return
        if np.iscomplexobj(found) or np.iscomplexobj(wanted):
            # Real and imaginary part, each with the same tolerance.
            found, wanted = (np.stack([np.real(v), np.imag(v)], axis=-1) for v in (found, wanted))
            allowed = np.asarray(allowed)[..., None]
        try:
            f, w, a = np.broadcast_arrays(*(np.asarray(v, dtype=float) for v in (found, wanted, allowed)))
        except (TypeError, ValueError):
            return
        if f.size == 0 or not np.all(np.isfinite(w)):
            return
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(a > 0.0, np.abs(f - w) / a, np.where(f == w, 0.0, np.inf))
        worst = int(np.argmax(share))
        row = self._row()
        row["comparisons"] += f.size
        if share.flat[worst] <= 1.0 and not row["share_of_allowed"] > share.flat[worst]:
            row |= {
                "found": f"{f.flat[worst]:.9g}", "wanted": f"{w.flat[worst]:.9g}",
                "allowed": f"{a.flat[worst]:.2g}", "share_of_allowed": float(share.flat[worst]),
            }  # fmt: skip

    def passed(self, statement: str, numbers: str) -> None:
        """Note an assertion by itself, where no comparison with a tolerance has been noted."""
        row = self._row()
        row["comparisons"] += 1
        if not row["found"] and any(sign in statement for sign in ("<", ">", "==")):
            row["found"] = readable(numbers)

    def _row(self) -> dict[str, Any]:
        key = self.current or ("", "")
        empty = {"cases": 0, "comparisons": 0, "found": "", "wanted": "", "allowed": "", "share_of_allowed": math.nan}
        return self.rows.setdefault(key, empty)

    def write(self, path: Path) -> None:
        """All rows as CSV."""
        with path.open("w", newline="") as stream:
            writer = csv.DictWriter(stream, COLUMNS)
            writer.writeheader()
            for (file, test), row in sorted(self.rows.items()):
                claim = test.removeprefix("test_").replace("_", " ")
                share = "" if math.isnan(row["share_of_allowed"]) else f"{row['share_of_allowed']:.2g}"
                writer.writerow(
                    row
                    | {
                        "file": file,
                        "test": test,
                        "claim": claim,
                        "beside": beside(file, test),
                        "share_of_allowed": share,
                    }
                    | {"date": datetime.date.today().isoformat(), "python": platform.python_version()}
                    | {"machine": platform.machine()}
                )


def readable(numbers: str) -> str:
    """The first line of an assertion's numbers, six digits each; empty if it holds none."""
    line = re.sub(r"\s+", " ", numbers.split("\n")[0]).strip()
    line = re.sub(r"np\.(?:float|int)\d+\(([^()]*)\)", r"\1", line)
    line = re.sub(r"-?\d+\.\d{6,}(?:e[-+]?\d+)?", lambda match: f"{float(match.group()):.6g}", line)
    if not re.search(r"\d", line) or "array(" in line or "object at 0x" in line:
        return ""
    return line if len(line) <= LONGEST else f"{line[: LONGEST - 1]}…"


@cache
def _comments(file: str) -> dict[int, str]:
    text = (ROOT / file).read_text()
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    return {t.start[0]: t.string.lstrip("# ") for t in tokens if t.type == tokenize.COMMENT and "fmt:" not in t.string}


@cache
def _tree(file: str) -> ast.Module:
    return ast.parse((ROOT / file).read_text())


def _above(comments: dict[int, str], line: int) -> list[str]:
    """Comment lines that end just above a line."""
    first = line
    while first - 1 in comments:
        first -= 1
    return [comments[i] for i in range(first, line)]


def beside(file: str, test: str) -> str:
    """What stands beside a test about its source: comments above it and its constants, its docstring, comments in it.

    The head of the file where there is none of these.
    """
    tree, comments = _tree(file), _comments(file)
    found = next((n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef) and n.name == test), None)
    parts: list[str] = []
    if found is not None:
        used = {n.id for n in ast.walk(found) if isinstance(n, ast.Name) and n.id.isupper()}
        for node in tree.body:
            if isinstance(node, ast.Assign) and any(isinstance(t, ast.Name) and t.id in used for t in node.targets):
                parts += _above(comments, node.lineno)
        parts += _above(comments, min([found.lineno, *(d.lineno for d in found.decorator_list)]))
        parts += [" ".join((ast.get_docstring(found) or "").split())]
        parts += [comments[i] for i in sorted(comments) if found.lineno < i <= (found.end_lineno or 0)]
    text = " ".join(part for part in parts if part)
    return text or " ".join((ast.get_docstring(tree) or "").split("\n\n")[0].split())


COLLECTOR = Collector()


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Any:
    """One case more, and comparisons are its."""
    COLLECTOR.begin(item)
    COLLECTOR._row()["cases"] += 1
    yield
    COLLECTOR.current = None


def pytest_assertion_pass(item: pytest.Item, lineno: int, orig: str, expl: str) -> None:
    """An assertion held; those with pytest.approx have been noted already."""
    if "approx(" not in orig and COLLECTOR.current is not None:
        COLLECTOR.passed(orig, expl)


def pytest_configure(config: pytest.Config) -> None:
    """Watch pytest.approx and numpy.testing.assert_allclose."""

    def watched(kind: type, of: Any) -> None:
        plain = kind.__eq__

        def compare(self: Any, actual: Any) -> bool:
            same = plain(self, actual)
            if same:
                of(self, actual)
            return same

        kind.__eq__ = compare  # type: ignore[assignment,method-assign]

    def scalar(self: Any, actual: Any) -> None:
        try:
            allowed = self.tolerance
        except ValueError:  # NaN against NaN, where the test allows it: no tolerance to speak of
            return
        COLLECTOR.compared(actual, self.expected, allowed)

    # Sequences and arrays are compared entry by entry with the scalar kind.
    watched(type(pytest.approx(1.0)), scalar)
    allclose = np.testing.assert_allclose

    def noted(actual: Any, desired: Any, rtol: float = 1e-7, atol: float = 0.0, **options: Any) -> None:
        allclose(actual, desired, rtol=rtol, atol=atol, **options)
        COLLECTOR.compared(actual, desired, atol + rtol * np.abs(np.asarray(desired, dtype=float)))

    np.testing.assert_allclose = noted


def pytest_unconfigure(config: pytest.Config) -> None:
    """Write what was noted to the file that the parent process asked for."""
    target = os.environ.get("ROCKING_CHECKS")
    if target:
        COLLECTOR.write(Path(target))


def collected(file: str, folder: Path) -> list[dict[str, str]]:
    """Rows of one test file, run in a process of its own; raises RuntimeError if a test fails."""
    target = folder / "checks.csv"
    # Assertions that pass speak up only where the test files are compiled so; hence compiled files of their own.
    environment = os.environ | {"ROCKING_CHECKS": str(target), "PYTHONPYCACHEPREFIX": str(folder / "pyc")}
    environment["PYTHONPATH"] = os.pathsep.join([str(ROOT / "docs"), *filter(None, [os.environ.get("PYTHONPATH")])])
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-p", "collect_checks", "-p", "no:cacheprovider",
               "-o", "enable_assertion_pass_hook=true", file]  # fmt: skip
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    if done.returncode not in (0, 5):
        raise RuntimeError(f"{file}: tests fail\n{done.stdout[-2000:]}")
    with target.open(newline="") as stream:
        return list(csv.DictReader(stream))


def _save(rows: list[dict[str, str]]) -> None:
    with RESULTS.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)


def main(files: list[str]) -> None:
    """Run the files (all tests that compare numbers if none is named) and put their rows into the table."""
    from tqdm import tqdm

    every = sorted(str(p.relative_to(ROOT)) for p in (ROOT / "tests").rglob("test_*.py"))
    wanted = files or [f for f in every if not any(word in f for word in SKIPPED)]
    rows: list[dict[str, str]] = []
    if RESULTS.exists():
        with RESULTS.open(newline="") as stream:
            rows = [row for row in csv.DictReader(stream) if (ROOT / row["file"]).exists()]
    failed = []
    with tempfile.TemporaryDirectory() as folder:
        for file in tqdm(wanted, unit="file"):
            try:
                new = collected(file, Path(folder))
            except RuntimeError as error:
                failed.append(str(error))
                continue
            rows = [row for row in rows if row["file"] != file] + new
            _save(sorted(rows, key=lambda row: (row["file"], row["test"])))
    if failed:
        sys.exit("\n".join(failed))


if __name__ == "__main__":
    main(sys.argv[1:])
