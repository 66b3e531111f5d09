"""The page of all studies: pictures with their captions, and the paper's statements with what became of them.

Pictures are linked, not copied; a caption is read from its picture, into which it was written.

Source   none, own convention
Status   text is escaped; every study whose dataset is there is on the page (tests)
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from studies.running.files import load_dataset, save_text
from studies.running.statements import VERDICTS
from studies.running.study import Study

PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Studies of free-standing blocks</title>
<style>
 :root { color-scheme: light; }
 body { font: 16px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 0 auto; padding: 1rem; }
 body { color: #1b1f24; }
 nav { columns: 18rem; margin-bottom: 2rem; font-size: .93rem; }
 nav a { display: block; }
 a { color: #0072b2; }
 section { border-top: 1px solid #d0d4d9; padding-top: 1rem; margin-top: 2rem; }
 figure { margin: 1rem 0; }
 img { max-width: 100%; height: auto; border: 1px solid #e3e6e9; }
 figcaption { font-size: .92rem; color: #3c434b; }
 table { border-collapse: collapse; font-size: .9rem; width: 100%; }
 th, td { text-align: left; padding: .35rem .6rem; border-bottom: 1px solid #e3e6e9; vertical-align: top; }
 td.number { font-variant-numeric: tabular-nums; white-space: nowrap; }
 .holds { color: #00664b; } .does { color: #a23c00; } .not { color: #555; }
 .detail { color: #555; font-size: .85rem; overflow-wrap: anywhere; }
 .wide { overflow-x: auto; }
 code, pre { font-size: .88rem; background: #f3f5f7; }
 pre { padding: .5rem .7rem; overflow-x: auto; }
</style>
</head>
<body>
<h1>Studies of free-standing blocks</h1>
<p>After Winkler, Meguro &amp; Yamazaki (1995) and beyond. Each picture shows what is in the dataset below it.</p>
<nav aria-label="studies">
{% for entry in entries %}<a href="#{{ entry.name }}">{{ entry.title }}</a>
{% endfor %}</nav>
{% for entry in entries %}
<section id="{{ entry.name }}">
<h2>{{ entry.title }}</h2>
<p>{{ entry.about }}</p>
{% for picture in entry.pictures %}
<figure>
<a href="{{ picture.file }}">
<img src="{{ picture.file }}" alt="{{ entry.title }}: {{ picture.name }}" loading="lazy"></a>
<figcaption>{{ picture.caption }} <a href="{{ picture.pdf }}">PDF</a></figcaption>
</figure>
{% endfor %}
{% if entry.films %}<p>Animations:
{% for film in entry.films %}<a href="{{ film }}">{{ film }}</a> {% endfor %}</p>
{% endif %}
{% if entry.statements %}
<div class="wide"><table>
<thead><tr><th>Statement</th><th>Number found</th><th>What decides</th><th>Verdict</th></tr></thead>
<tbody>
{% for row in entry.statements %}
<tr><td>{{ row.statement }}{% if row.place %}<div class="detail">{{ row.place }}</div>{% endif %}</td>
<td class="number">{{ row.number }}</td>
<td>{{ row.bound }}{% if row.detail %}<div class="detail">{{ row.detail }}</div>{% endif %}</td>
<td class="{{ row.verdict.split()[0] }}">{{ row.verdict }}</td></tr>
{% endfor %}
</tbody></table></div>
{% endif %}
<p><a href="{{ entry.name }}.nc">{{ entry.name }}.nc</a> &middot; <code>{{ entry.command }}</code>
&middot; {{ entry.source }}, {{ entry.commit }}</p>
{% if entry.example %}<pre>import studies
ds = studies.open("{{ entry.name }}.nc")
{{ entry.example }}</pre>{% endif %}
</section>
{% endfor %}
</body>
</html>
"""


def _caption(path: Path) -> str:
    from PIL import Image

    with Image.open(path) as image:
        return str(image.info.get("Description", ""))


def statements_of(ds: xr.Dataset) -> list[dict[str, Any]]:
    """The paper's statements in a dataset, as rows of text."""
    rows = []
    for i in range(ds.sizes.get("statement", 0)):
        at = ds.isel(statement=i)

        def text(name: str, at: xr.Dataset = at) -> str:
            return str(at[name].item()) if name in at else ""

        unit = text("statement_units")
        number = f"{float(at.statement_number):.3g}" + (f" {unit}" if unit not in ("", "1") else "")
        rows.append(
            {
                "statement": str(at.statement.item()), "place": text("statement_place"), "number": number,
                "bound": text("statement_bound"), "detail": text("statement_detail"),
                "verdict": VERDICTS[int(at.statement_holds)],
            }
        )  # fmt: skip
    return rows


def _entry(folder: Path, study: Study) -> dict[str, Any] | None:
    """What the page says of a study; None where its dataset is not there."""
    path = folder / f"{study.name}.nc"
    if not path.exists():
        return None
    ds = load_dataset(path)
    rows, attributes = statements_of(ds), dict(ds.attrs)
    pictures = [
        {"name": name, "file": f"{name}.png", "pdf": f"{name}.pdf", "caption": _caption(folder / f"{name}.png")}
        for name in study.figures
        if (folder / f"{name}.png").exists()
    ]
    films = [
        f"{study.name}{ending}" for ending in (".html", ".gif", ".mp4") if (folder / f"{study.name}{ending}").exists()
    ]
    return {
        "name": study.name, "title": study.title, "about": study.about, "example": study.example, "films": films,
        "pictures": pictures, "statements": rows, "command": attributes.get("command", ""),
        "source": attributes.get("source", ""), "commit": attributes.get("commit", ""),
    }  # fmt: skip


def write_index(folder: Path, studies: Mapping[str, Study]) -> Path:
    """Write index.html of the studies whose datasets are in the folder; its path.

    A study whose dataset or picture is damaged is left out, which a line on stderr says.
    """
    from jinja2 import Environment

    entries = []
    for study in studies.values():
        try:
            entry = _entry(folder, study)
        except (OSError, AttributeError, KeyError, TypeError, ValueError) as error:
            said = str(error).splitlines()[0] if str(error) else type(error).__name__
            print(f"{study.name}: is left out of index.html, make it again ({said})", file=sys.stderr)
            continue
        entries += [] if entry is None else [entry]
    page = Environment(autoescape=True, trim_blocks=True).from_string(PAGE).render(entries=entries)
    path = folder / "index.html"
    save_text(page, path)
    return path
