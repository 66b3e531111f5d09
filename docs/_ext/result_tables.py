"""Tables of results as Markdown: benchmarks with the day they were taken, checks with what they were held against."""

from __future__ import annotations

import ast
import csv
import re
import subprocess
from pathlib import Path

from effect_heads import head_of, literal

ROOT = Path(__file__).resolve().parents[2]
CHECKS = ROOT / "docs" / "results" / "checks.csv"
ANCHORS = ROOT / "docs" / "results" / "anchors.csv"


def rows_of(path: Path) -> list[dict[str, str]]:
    """Rows of a CSV file by column."""
    with path.open(newline="") as stream:
        return list(csv.DictReader(stream))


def _cell(text: str) -> str:
    """A cell of a table of measurements: short ones on one line, long names with places to break."""
    text = literal(text)
    return text.replace(" ", "\N{NO-BREAK SPACE}") if len(text) <= 20 else re.sub(r"(?<=[_+])", "\u200b", text)


def _command(text: str) -> str:
    """How a benchmark is run, and where its result goes."""
    command, arrow, rest = text.partition(" -> ")
    return f"`{command.strip()}`{arrow and ', which gives '}{literal(rest.strip())}"


def _table(columns: list[str], rows: list[list[str]]) -> str:
    lines = [f"| {' | '.join(columns)} |", "|" + "---|" * len(columns)]
    return "\n".join(lines + [f"| {' | '.join(cell or ' ' for cell in row)} |" for row in rows])


def _boxed(table: str, style: str) -> str:
    """A table with a style of its own."""
    return f"::::{{container}} {style}\n{table}\n::::"


def day_of(path: Path) -> str:
    """The day on which a file was last committed; "not known here" outside of a checkout."""
    command = ["git", "-C", str(path.parent), "log", "-1", "--format=%as", "--", path.name]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip() or "not committed yet"
    except (OSError, subprocess.SubprocessError):
        return "not known here"


def benchmarks_text() -> str:
    """All benchmarks whose results are kept, one section to a file."""
    parts = []
    for path in sorted((ROOT / "benchmarks" / "results").glob("*.csv")):
        title = path.stem.replace("_", " ").capitalize().replace("Dem ", "DEM ")
        parts += [f"## {title}", "", benchmark_text(path), ""]
    return "\n".join(parts)


def benchmark_text(path: Path) -> str:
    """A benchmark: the head of its script, the day, the table."""
    scripts = [ROOT / folder / f"{path.stem}.py" for folder in ("benchmarks", "studies")]
    head = next((ast.get_docstring(ast.parse(s.read_text())) or "" for s in scripts if s.exists()), "")
    title, entries = head_of(head)
    rows = rows_of(path)
    same = {c: rows[0][c] for c in rows[0] if c in ("python", "machine") and len({row[c] for row in rows}) == 1}
    columns = [c for c in rows[0] if c not in same]
    where = f"Python {same['python']} on {same['machine']}" if len(same) == 2 else "see the columns"
    table = _table([c.replace("_", " ") for c in columns], [[_cell(row[c]) for c in columns] for row in rows])
    note = f"*Result of {day_of(path)}, {where}; `benchmarks/results/{path.name}`.*"
    shown = {name: _command(text) if name == "Run" else literal(text) for name, text in entries}
    about = [line for name, text in shown.items() for line in (name, f": {text}", "")]
    return "\n".join([literal(title), "", *about, note, "", _boxed(table, "measured")])


def _numbers(row: dict[str, str]) -> tuple[str, str]:
    """What was found, and what was wanted, with its tolerance."""
    if row["wanted"]:
        wanted = f"{row['wanted']} ± {row['allowed']}" if row["allowed"] not in ("", "0") else row["wanted"]
        return row["found"], wanted
    return (f"`{row['found']}`" if row["found"] else ""), ""


def _check_rows(rows: list[dict[str, str]]) -> str:
    cells = []
    for row in rows:
        found, wanted = _numbers(row)
        found, wanted = (t if t.startswith("`") else literal(t) for t in (found, wanted))
        cells.append([literal(row["claim"]), row["cases"], found.replace("|", "\\|"), wanted, literal(row["beside"])])
    return _boxed(_table(["claim", "cases", "found", "wanted", "held against"], cells), "checks every")


def _says_a_number(found: str) -> bool:
    """Whether what an assertion has left is a comparison of numbers, not of names or types."""
    return bool(found) and not any(sign in found for sign in ("'", '"', "<class", "True", "False"))


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'s' * (number != 1)}"


def _is(number: int) -> str:
    return "is" if number == 1 else "are"


def _heading(file: str) -> str:
    """The subject of a file of tests, in words."""
    words = Path(file).stem.removeprefix("test_").replace("_", " ")
    return words[0].upper() + words[1:]


def checks_text(prefix: str) -> str:
    """All checks of the test files whose path starts with `prefix`, one section to a file."""
    rows = [row for row in rows_of(CHECKS) if row["file"].startswith(prefix)]
    parts = []
    for file in sorted({row["file"] for row in rows}):
        own = [row for row in rows if row["file"] == file]
        head = ast.get_docstring(ast.parse((ROOT / file).read_text())) or ""
        title = literal(" ".join(head.split("\n\n")[0].split()))
        cases = sum(int(row["cases"]) for row in own)
        day = max(row["date"] for row in own)
        shown = [row for row in own if _says_a_number(row["found"])]
        left = len(own) - len(shown)
        more = f"; {left} compare{'s' * (left == 1)} no numbers and {_is(left)} not listed" if left else ""
        note = f"*`{file}`: {_count(len(own), 'test')} in {_count(cases, 'case')}, run on {day}{more}.*"
        parts += [f"## {_heading(file)}", "", title, "", note, "", _check_rows(shown) if shown else "", ""]
    return "\n".join(parts)


def anchors_text() -> str:
    """The checks of `anchors.csv`, in its order, with the number that each found."""
    by_test = {(row["file"], row["test"]): row for row in rows_of(CHECKS)}
    cells = []
    for anchor in rows_of(ANCHORS):
        row = by_test.get((anchor["file"], anchor["test"]))
        found, wanted = _numbers(row) if row else ("*not collected yet*", "")
        cells.append([literal(anchor["what"]), found, wanted, literal(f"{anchor['source']} ({anchor['file']})")])
    return _boxed(_table(["what is checked", "found", "wanted", "source (and where)"], cells), "checks short")
