"""Parts of pages that are made while the pages are read: a line `<!-- made: NAME ARGUMENTS -->` becomes Markdown.

effects            the heads of the files in rocking/effects
figures            the heads of the figures in studies
benchmarks         benchmarks/results/*.csv, each with what its script says it is
checks PREFIX      docs/results/checks.csv, the test files whose path starts so
loop_series        benchmarks/results/loop_trials.csv, counted by series
anchors            the checks of docs/results/checks.csv that are named in docs/results/anchors.csv
"""

from __future__ import annotations

import re
from typing import Any

from effect_heads import effects_text
from figure_heads import figures_text
from loop_series import series_text
from result_tables import anchors_text, benchmarks_text, checks_text
from sphinx.application import Sphinx

MARK = re.compile(r"^<!-- made: (\w+) ?(.*?) -->$", re.MULTILINE)
MAKERS = {
    "effects": effects_text,
    "figures": figures_text,
    "benchmarks": benchmarks_text,
    "checks": checks_text,
    "anchors": anchors_text,
    "loop_series": series_text,
}


def fill(app: Sphinx, docname: str, source: list[str]) -> None:
    """Replace the marks of a page."""
    if "<!-- made:" not in source[0]:
        return
    # What is behind these parts is no part of the page's own file: read the page at every build.
    app.env.note_reread()
    source[0] = MARK.sub(lambda match: MAKERS[match.group(1)](*match.group(2).split()), source[0])


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("source-read", fill)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
