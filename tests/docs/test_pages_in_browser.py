"""Every page in a browser, wide and narrow: nothing sticks out, every equation is set, every picture is there.

The pages are built from a copy, without running the gallery, so that nothing of the checkout changes.
"""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "studies" / "animation"))
from browser import CHROMIUM, Browser

ROOT = Path(__file__).parents[2]
WIDTHS = (1280, 400)

# What a reader would stumble over. What scrolls by itself (code, wide tables) may be wider than the window.
LOOK = r"""
if (window.MathJax && MathJax.startup) await MathJax.startup.promise;
const width = document.documentElement.clientWidth, article = document.querySelector("article") || document.body;
const scrolls = (e) => {
  for (let p = e.parentElement; p && p !== document.body; p = p.parentElement)
    if (["auto", "scroll", "hidden"].includes(getComputedStyle(p).overflowX)) return true;
  return false;
};
const found = [];
for (const e of article.querySelectorAll("*")) {
  const r = e.getBoundingClientRect();
  if (r.width && r.right > width + 1 && !scrolls(e))
    found.push(`sticks out: ${e.tagName} ${e.textContent.trim().slice(0, 40)}`);
}
if (document.documentElement.scrollWidth > width + 1) found.push("the page scrolls sideways");
for (const e of document.querySelectorAll("mjx-merror")) found.push(`no equation: ${e.textContent.slice(0, 60)}`);
for (const e of document.querySelectorAll("span.math, div.math"))
  if (!e.querySelector("mjx-container")) found.push(`not set: ${e.textContent.slice(0, 60)}`);
for (const e of document.images) if (!e.naturalWidth) found.push(`no picture: ${e.src.split("/").pop()}`);
const raw = article.innerText.match(/\{[a-z:]+\}`|:[a-z]+:`|<!-- made|\$\$|:::|```/g) || [];
return [...found.slice(0, 5), ...raw.slice(0, 3).map((text) => `raw markup: ${text}`)];
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    pytest.importorskip("sphinx", reason="want the extra docs")
    pytest.importorskip("sphinx_gallery", reason="want the extra docs")
    folder = tmp_path_factory.mktemp("pages")
    left = shutil.ignore_patterns("auto_gallery", "_made", "__pycache__", "sg_execution_times.rst")
    shutil.copytree(ROOT / "docs", folder / "docs", ignore=left)
    for path in ROOT.iterdir():
        if path.name != "docs" and not path.name.startswith(".") and path.name != "build":
            (folder / path.name).symlink_to(path)
    command = [sys.executable, "-m", "sphinx", "-q", "-D", "plot_gallery=0", "docs", "built"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    return folder / "built"


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no chromium")
def test_every_page_is_whole_wide_and_narrow(built, tmp_path):
    pages = [p for p in sorted(built.rglob("*.html")) if p.name not in ("genindex.html", "search.html")]
    assert len(pages) > 50
    browser, wrong = Browser(tmp_path / "profile"), {}
    try:
        for page in pages:
            for width in WIDTHS:
                browser.open(page.as_uri(), width, 1000)
                found = browser.run(LOOK)
                # Without a run the gallery has no pictures of its own.
                found = [text for text in found if not ("no picture" in text and "auto_gallery" in page.parts)]
                if found or browser.errors:
                    wrong[f"{page.relative_to(built)} {width}"] = found or "an error of a script"
    finally:
        browser.close()
    assert wrong == {}
