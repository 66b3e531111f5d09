"""The pages as files: links within the project lead somewhere, what they import is there, results belong to tests."""

import ast
import csv
import importlib
import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted([*DOCS.glob("*.md"), *DOCS.glob("*/*.md"), ROOT / "README.md", ROOT / "CONTRIBUTING.md"])
EXAMPLES = sorted((DOCS / "gallery").glob("plot_*.py"))


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_links_within_the_project_lead_to_a_file(page):
    for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text()):
        # The gallery's pages are made when the docs are built.
        if re.match(r"[a-z]+:", target) or "auto_gallery" in target:
            continue
        assert (page.parent / target).exists(), target


def imports(code: str) -> list[tuple[str, str]]:
    found = []
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.ImportFrom) and node.module:
            found += [(node.module, alias.name) for alias in node.names]
        elif isinstance(node, ast.Import):
            found += [(alias.name, "") for alias in node.names]
    return found


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda p: p.stem)
def test_what_an_example_imports_is_there(example):
    # The examples themselves run when the docs are built.
    for module, name in imports(example.read_text()):
        loaded = importlib.import_module(module)
        if name and not hasattr(loaded, name):
            importlib.import_module(f"{module}.{name}")


def test_there_are_at_least_fifteen_examples_with_title_and_picture():
    assert len(EXAMPLES) >= 15
    for example in EXAMPLES:
        head = (ast.get_docstring(ast.parse(example.read_text())) or "").splitlines()
        assert set(head[1]) == {"="}, example.name
        assert len(head[1]) == len(head[0])
        assert "plt.show()" in example.read_text()


def rows(name):
    with (DOCS / "results" / name).open(newline="") as stream:
        return list(csv.DictReader(stream))


def test_the_checks_of_the_short_list_are_tests():
    for row in rows("anchors.csv"):
        tree = ast.parse((ROOT / row["file"]).read_text())
        names = {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
        assert row["test"] in names, row["test"]


def test_a_number_that_was_found_lies_within_what_is_allowed():
    # The last digits printed may round a share of 1 up.
    for row in rows("checks.csv"):
        if row["share_of_allowed"]:
            assert float(row["share_of_allowed"]) <= 1.0 + 1e-9, row["test"]


def test_every_citation_is_in_the_bibliography():
    known = set(re.findall(r"^@\w+\{(\w+),", (DOCS / "references.bib").read_text(), flags=re.MULTILINE))
    for page in PAGES:
        for keys in re.findall(r"\{cite:[tp]\}`([^`]+)`", page.read_text()):
            assert set(keys.replace(" ", "").split(",")) <= known, page.name


def test_version_and_licence_are_the_same_wherever_they_stand():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    citation = dict(re.findall(r"^([a-z-]+): (.+)$", (ROOT / "CITATION.cff").read_text(), flags=re.MULTILINE))
    assert (citation["version"], citation["license"]) == (project["version"], project["license"])
    assert f"## {project['version']}" in (ROOT / "CHANGELOG.md").read_text()
    assert project["license"] == "BSD-3-Clause" and (ROOT / "LICENSE").read_text().startswith("BSD 3-Clause")


@pytest.mark.parametrize("package", ["rocking", "dem", "excitation", "studies"])
def test_types_of_a_package_are_for_its_users_too(package):
    # PEP 561: the marker lies in the package and is installed with it.
    data = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["package-data"]
    assert (ROOT / package / "py.typed").exists() and "py.typed" in data[package]


def test_every_package_is_installed():
    packages = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]
    there = {".".join(p.parent.relative_to(ROOT).parts) for top in ("rocking", "dem", "excitation", "studies")
             for p in (ROOT / top).rglob("__init__.py")}  # fmt: skip
    assert set(packages) == there
