"""The table of checks: what is read off a test is what the test compared."""

import csv
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]

TESTS = '''
"""Head of the file."""

import numpy as np
import pytest

# From a table.
LENGTHS = [1.0, 2.0]


def test_a_length_is_that_of_the_table():
    assert 2.001 == pytest.approx(LENGTHS[1], abs=0.01)
    assert 1.0 == pytest.approx(LENGTHS[0], abs=0.01)


def test_all_are_close():
    """Against themselves."""
    np.testing.assert_allclose([1.0, 2.0], [1.0, 2.0001], rtol=1e-3)


def test_a_gap_is_a_gap():
    assert [1.0, float("nan")] == pytest.approx([1.0, float("nan")], nan_ok=True)


def test_order():
    assert 1.23456789 < 2.0
'''


def test_comparisons_sources_and_numbers_are_noted(tmp_path):
    # In a folder of its own: the collector finds the file from the root that it is asked to work in.
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "collect_checks.py").write_text((ROOT / "docs" / "collect_checks.py").read_text())
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_made.py").write_text(TESTS)
    (tmp_path / "pyproject.toml").write_text("[tool.pytest.ini_options]\naddopts = '--import-mode=importlib'\n")
    (tmp_path / "docs" / "results").mkdir()
    command = [sys.executable, "docs/collect_checks.py", "tests/test_made.py"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    with (tmp_path / "docs" / "results" / "checks.csv").open(newline="") as stream:
        rows = {row["test"]: row for row in csv.DictReader(stream)}
    length = rows["test_a_length_is_that_of_the_table"]
    # The nearest to its tolerance: 0.001 of 0.01.
    assert (length["found"], length["wanted"], length["allowed"]) == ("2.001", "2", "0.01")
    assert (length["comparisons"], length["cases"], length["share_of_allowed"]) == ("2", "1", "0.1")
    assert length["beside"] == "From a table."
    assert rows["test_all_are_close"]["found"] == "2"
    assert rows["test_all_are_close"]["beside"] == "Against themselves."
    # NaN against NaN is no number.
    assert (rows["test_a_gap_is_a_gap"]["found"], rows["test_a_gap_is_a_gap"]["wanted"]) == ("1", "1")
    assert rows["test_order"]["found"] == "1.23457 < 2.0"
    assert rows["test_order"]["beside"] == "Head of the file."
