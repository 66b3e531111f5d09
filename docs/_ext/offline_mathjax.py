"""MathJax beside the pages, so that equations are there without a network.

The files come with the package sphinx-mathjax-offline; its own extension would copy all 24 MB of them and does not know
parallel builds, so only what is needed is copied here: TeX in, HTML out, and the fonts.
"""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx
from sphinx.util.fileutil import copy_asset

NEEDED = ("tex-chtml.js", "output/chtml/fonts")


def copy(app: Sphinx, error: Exception | None) -> None:
    """Copy the files once the pages are written."""
    spec = importlib.util.find_spec("sphinx-mathjax-offline")
    if error is not None or app.builder.format != "html" or spec is None or spec.origin is None:
        return
    source = Path(spec.origin).parent / "static" / "mathjax"
    for name in NEEDED:
        target = Path(app.outdir) / "_static" / "mathjax" / name
        target.parent.mkdir(parents=True, exist_ok=True)
        copy_asset(source / name, target if (source / name).is_dir() else target.parent)


def setup(app: Sphinx) -> dict[str, Any]:
    if importlib.util.find_spec("sphinx-mathjax-offline") is None:
        raise RuntimeError("sphinx-mathjax-offline is not installed: want pip install -e '.[docs]'")
    app.config.mathjax_path = "mathjax/tex-chtml.js"
    app.connect("build-finished", copy)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
