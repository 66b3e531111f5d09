"""The Python of the pages runs as printed, the blocks of a page one after the other, and prints what the page says.

A block of text right behind a block of code is what the code prints.
"""

import contextlib
import io
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
PAGES = sorted(p for folder in ("start", "howto", "physics") for p in (DOCS / folder).glob("*.md"))
MADE_BEFORE = {"first_figure.md": "the figure's dataset, which its own test makes: tests/test_readme.py"}
WIDEST = 100  # columns of a block of code: more do not fit on a page
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```\n(?:\n```text\n(.*?)^```)?", flags=re.MULTILINE | re.DOTALL)


def blocks(page: Path, language: str) -> list[tuple[str, str]]:
    """(code, what it prints, empty if the page does not say) of a page."""
    return [(code, text) for name, code, text in BLOCK.findall(page.read_text()) if name == language]


@pytest.mark.parametrize(
    "page",
    [p for p in PAGES if blocks(p, "python") and p.name not in MADE_BEFORE],
    ids=lambda p: f"{p.parent.name}/{p.stem}",
)
def test_python_of_a_page_runs_and_prints_what_the_page_says(page, tmp_path, monkeypatch):
    import matplotlib

    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "page"}
    for number, (code, said) in enumerate(blocks(page, "python"), start=1):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(code, f"{page.name}, block {number}", "exec"), names)
        if said:
            assert printed.getvalue() == said, f"block {number}"
    import matplotlib.pyplot as plt

    plt.close("all")


def test_the_first_answer_is_the_one_on_the_page():
    ((command, said),) = [found for found in blocks(DOCS / "start" / "install.md", "sh") if found[1]]
    words = shlex.split(command)
    assert words[0] == ".venv/bin/python"
    done = subprocess.run([sys.executable, *words[1:]], capture_output=True, text=True, check=True)
    assert done.stdout == said


def test_every_page_with_python_is_run_or_named():
    # A page that is left out says why here.
    left_out = {p.name for p in PAGES if blocks(p, "python")} & set(MADE_BEFORE)
    assert left_out == set(MADE_BEFORE)


@pytest.mark.parametrize("page", [*PAGES, *DOCS.glob("*.md")], ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_code_fits_on_a_page(page):
    lines = [line for _, code, said in BLOCK.findall(page.read_text()) for line in (code + said).splitlines()]
    assert [line for line in lines if len(line) > WIDEST] == []
