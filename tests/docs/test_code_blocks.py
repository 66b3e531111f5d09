"""The Python of the pages runs as printed: the blocks of a page one after the other, in an empty folder."""

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
PAGES = sorted(p for folder in ("start", "howto", "physics") for p in (DOCS / folder).glob("*.md"))
MADE_BEFORE = {"first_figure.md": "the figure's dataset, which its own test makes: tests/test_readme.py"}


def python_of(page: Path) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", page.read_text(), flags=re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize(
    "page", [p for p in PAGES if python_of(p) and p.name not in MADE_BEFORE], ids=lambda p: f"{p.parent.name}/{p.stem}"
)
def test_python_of_a_page_runs(page, tmp_path, monkeypatch, capsys):
    import matplotlib

    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "page"}
    for number, code in enumerate(python_of(page), start=1):
        exec(compile(code, f"{page.name}, block {number}", "exec"), names)
    import matplotlib.pyplot as plt

    plt.close("all")


def test_every_page_with_python_is_run_or_named():
    # A page that is left out says why here.
    left_out = {p.name for p in PAGES if python_of(p)} & set(MADE_BEFORE)
    assert left_out == set(MADE_BEFORE)
