"""Links that lead outside have the form of one: no network is needed here, `sphinx -b linkcheck` follows them."""

import re
from pathlib import Path
from urllib.parse import urlsplit

import pytest

ROOT = Path(__file__).parents[2]
TEXTS = sorted(
    [*ROOT.glob("*.md"), ROOT / "CITATION.cff", ROOT / "pyproject.toml", ROOT / "docs" / "conf.py"]
    + [p for kind in ("md", "rst", "py", "bib") for p in (ROOT / "docs").rglob(f"*.{kind}")]
    + [p for package in ("rocking", "dem", "excitation", "studies") for p in (ROOT / package).rglob("*.py")]
)
TEXTS = [p for p in TEXTS if "auto_gallery" not in p.parts and p.name != "sg_execution_times.rst"]
ADDRESS = re.compile(r"\b[a-z][a-z+.-]*://[^\s<>\"'`)\]}]+")
DOI = re.compile(r"10\.\d{4,9}/[^\s\"<>]+")
NAMES = {"http://www.w3.org/2000/svg"}  # of XML, not a place
EXAMPLES = ("file:", "tcp://host:", "tcp://127.0.0.1:")  # stand for the reader's own


def problem(address: str) -> str:
    """What is wrong with an address, empty if nothing is."""
    parts = urlsplit(address)
    if parts.scheme != "https":
        return "no https"
    if not re.fullmatch(r"([a-z0-9-]+\.)+[a-z]{2,}", parts.hostname or "") or parts.port or parts.username:
        return "no plain host"
    if parts.hostname == "doi.org" and not DOI.fullmatch(parts.path.lstrip("/")):
        return "no DOI"
    return "ends in a sign of the sentence" if address.endswith((".", ",", ";", ":")) else ""


def test_the_form_is_told_from_what_is_none():
    assert problem("https://doi.org/10.1000/182") == ""
    assert problem("https://doi.org/182") == "no DOI"
    assert problem("http://example.org/a") == "no https"
    assert problem("https://localhost/a") == "no plain host"
    assert problem("https://example.org/a.") == "ends in a sign of the sentence"


@pytest.mark.parametrize("kind", sorted({p.suffix for p in TEXTS}))
def test_addresses_have_the_form_of_one(kind):
    found = {}
    for path in (p for p in TEXTS if p.suffix == kind):
        for address in ADDRESS.findall(path.read_text(encoding="utf-8")):
            if address not in NAMES and not address.startswith(EXAMPLES) and problem(address):
                found[f"{path.relative_to(ROOT)}: {address}"] = problem(address)
    assert found == {}


def test_dois_of_the_references_can_be_resolved_by_their_form():
    # BibTeX's field is the DOI alone: the style puts https://doi.org/ before it.
    fields = re.findall(
        r"^\s*doi\s*=\s*[{\"](.*?)[}\"],?$", (ROOT / "docs" / "references.bib").read_text(), re.M | re.I
    )
    assert [doi for doi in fields if not DOI.fullmatch(doi)] == []
    given = re.findall(r"^\s*doi:\s*\"?([^\s\"]+)", (ROOT / "CITATION.cff").read_text(), re.M)
    assert [doi for doi in given if not DOI.fullmatch(doi)] == []
