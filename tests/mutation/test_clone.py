"""A break in a clone: seen by a test of the clone, which is then as it was; a test that never ends has seen it too."""

import subprocess
from pathlib import Path

import pytest

from .breaks import breaks_of
from .clone import Clone

SOURCE = "def half(x):\n    return 0.5 * x\n"
TEST = """import pytest, rocking

@pytest.mark.parametrize("x", [3.0], ids=["three - a number"])
def test_half(x):
    assert rocking.half(x) == 1.5
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project in which each package has the same two lines."""
    root = tmp_path / "project"
    for name in ("rocking", "dem", "excitation", "studies"):
        (root / name).mkdir(parents=True)
        (root / name / "__init__.py").write_text(SOURCE)
    (root / "tests").mkdir()
    (root / "tests" / "test_half.py").write_text(TEST)
    git = ("git", "-c", "user.name=a", "-c", "user.email=a@b", "-C", str(root))
    for command in (("init", "-q"), ("add", "."), ("commit", "-qm", "toy")):
        subprocess.run([*git, *command], check=True)
    return root


def test_a_break_is_caught_and_taken_back(project: Path, tmp_path: Path) -> None:
    clone = Clone(project, tmp_path / "clone", "HEAD")
    clone.cache.mkdir()
    groups = [["tests/test_half.py"]]
    one = next(b for b in breaks_of("rocking/__init__.py", SOURCE.encode()) if b.new == "/")
    verdict = clone.judge(one, groups, stuck=60.0)
    assert (verdict.outcome, verdict.test) == ("caught", "tests/test_half.py::test_half[three - a number]")
    assert (clone.tree / "rocking" / "__init__.py").read_text() == SOURCE
    assert not clone.cache.exists(), "the cache of compiled code was not emptied"
    assert clone.run(groups[0], 60.0) == ("survived", "")
