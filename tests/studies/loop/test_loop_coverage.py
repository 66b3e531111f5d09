"""Coverage of the loop's intervals: what a row says, rows that are there are kept, an effect is found again."""

import csv
import json

import pytest

from studies import loop_coverage
from studies.loop_coverage import COLUMNS, main, summary
from studies.loop_trials import Case


def row(**changes):
    found = dict.fromkeys(COLUMNS, 0.0) | {"effect": "tether", "parameter": "tether.slack", "z": 1.0, "held": True}
    return found | changes


def test_what_is_there_is_not_fitted_again_and_what_cannot_be_fitted_is_said(tmp_path, capsys, monkeypatch):
    def fitted(case, folder):
        if case.seed == 3:
            raise ValueError(f"{case.name}: no start led anywhere")
        return [row(seed=case.seed)]

    monkeypatch.setattr(loop_coverage, "fitted", fitted)
    (tmp_path / "tether-1").mkdir()
    (tmp_path / "tether-1" / "coverage.json").write_text(json.dumps([row(seed=1, held=False, z=2.5)]), encoding="utf-8")
    (tmp_path / "tether-2").mkdir()
    (tmp_path / "tether-2" / "coverage.json").write_text('[{"effect": ', encoding="utf-8")
    command = ["--effects", "tether", "--first-seed", "1", "--seeds", "3", "--out", str(tmp_path)]
    main(command)
    table = list(csv.DictReader((tmp_path / "loop_coverage.csv").read_text(encoding="utf-8").splitlines()))
    assert [(r["seed"], r["held"]) for r in table] == [("1", "False"), ("2", "True")]
    said = capsys.readouterr()
    assert "not fitted: tether-3: no start led anywhere" in said.err + said.out
    assert "1 of    2 held ( 50%)" in said.out


def test_the_mean_square_of_z_is_one_where_intervals_are_right():
    lines = summary([row(z=z, held=abs(z) < 1.96) for z in (1.0, -1.0, 2.0, 0.0, -2.0)])
    assert lines[-1].startswith("all") and "3 of    5 held ( 60%)" in lines[-1]
    assert lines[-1].endswith("1.41")


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["--effects", "gremlin"], "--effects 'gremlin': want some of rounded_edges, "),
        (["--effects", "base_adhesion"], "--effects 'base_adhesion': want some of"),
        (["--seeds", "0"], "--seeds 0: want 1 or more"),
        (["--first-seed", "-1"], "--first-seed -1: want 0 or more"),
    ],
)
def test_what_cannot_be_is_refused_at_once(given, said, capsys):
    with pytest.raises(SystemExit):
        main(given)
    assert said in capsys.readouterr().err


@pytest.mark.slow
def test_what_was_planted_is_within_five_deviations(tmp_path):
    """One campaign of a laboratory that shares no code with the loop; chance leaves one in two million beyond."""
    [found] = loop_coverage.fitted(Case(("base_motion_lag",), 1001, "strong", "rotation", ()), tmp_path)
    assert found["parameter"] == "base_motion_lag.lag"
    assert abs(found["z"]) < 5.0
    assert found["low"] < found["found"] < found["high"]
    assert abs(found["found"] - found["planted"]) < 0.05 * abs(found["planted"])
