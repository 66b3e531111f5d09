"""The table of the trials of the loop by series, row by row."""

import importlib
from pathlib import Path

EXTENSIONS = Path(__file__).parents[2] / "docs" / "_ext"
RIGHT = {
    "truth": "wear", "verdict": "unexplained", "traced": "no", "covered": "0", "parameters": "0", "before": "4.0",
    "after": "1.0", "after_over_floor": "1.2", "claimed_over_true": "1.1", "cpu_s": "100", "failed": "",
}  # fmt: skip


def test_a_run_that_failed_is_counted_and_is_not_right(monkeypatch):
    monkeypatch.syspath_prepend(str(EXTENSIONS))
    series = importlib.import_module("loop_series")
    fell = dict.fromkeys(RIGHT, "") | {"truth": "bedding_in", "failed": "KeyError"}
    named = fell | {"truth": "tether"}
    told = dict(zip(series.COLUMNS, series._row("1001", [RIGHT, fell, named]), strict=True))
    assert told["campaigns"] == "3" and told["no name, unexplained"] == "1/2" and told["named, traced"] == "0/1"
    assert told["error at least halved"] == "1/1" and told["CPU [s]"] == "100"
