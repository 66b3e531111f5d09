"""The bed of trials: a run that fails is a row that says so, a row that is there is kept, bad names are refused."""

import csv
import json
import sys

import pytest

from studies.laboratory.effects import NAMED, UNNAMED
from studies.loop_trials import main


def test_a_loop_that_fails_is_a_row_and_the_campaign_stays(tmp_path, capsys):
    broken = f"{sys.executable} -c 'raise_SystemExit(3)'"
    assert main(["--effects", "null", "--out", str(tmp_path), "--command", broken]) == 0
    [row] = list(csv.DictReader((tmp_path / "loop_trials.csv").read_text(encoding="utf-8").splitlines()))
    assert row["case"] == "null-1001"
    assert "exit status 1" in row["failed"]
    assert (tmp_path / "null-1001" / "campaign" / "campaign.toml").exists()
    assert "failed                1/1" in capsys.readouterr().out


def test_a_campaign_that_was_closed_is_not_closed_again(tmp_path):
    folder = tmp_path / "null-1001"
    folder.mkdir()
    row = {"case": "null-1001", "truth": "", "failed": "", "verdict": "none", "covered": 0, "parameters": 0}
    (folder / "row.json").write_text(json.dumps(row), encoding="utf-8")
    # No such program: it would fail if it were asked for.
    assert main(["--effects", "null", "--out", str(tmp_path), "--command", "no-such-program"]) == 0
    [found] = list(csv.DictReader((tmp_path / "loop_trials.csv").read_text(encoding="utf-8").splitlines()))
    assert (found["verdict"], found["failed"]) == ("none", "")


@pytest.mark.parametrize(
    ("effects", "said"),
    [
        ("sliding+bouncing", "engine='contact': the laboratory is of 'slip' already, and no engine has both"),
        ("compliant_base+rounded_edges", "not in the laboratory of the engine 'contact'"),
        ("slosh+sliding", "not in the laboratory of the engine 'slip'"),
        ("null+sliding", "'null'"),
    ],
)
def test_effects_that_no_laboratory_has_together_are_refused_at_once(effects, said, capsys):
    with pytest.raises(SystemExit):
        main(["--effects", effects])
    assert f"--effects {effects}: " in (told := capsys.readouterr().err)
    assert said in told


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("--channel outcome --strength weak", "--strength weak: want strong with --channel outcome"),
        ("--channel outcome --nuisances lossy", "--nuisances lossy: want none with --channel outcome"),
        ("--quick --effects tether", "--effects tether: want it without --quick, which has its own"),
    ],
)
def test_options_that_would_have_no_say_are_refused(given, said, tmp_path, capsys):
    with pytest.raises(SystemExit) as left:
        main([*given.split(), "--out", str(tmp_path)])
    assert left.value.code == 2
    assert said in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("given", "near"), [("gremlin", ""), ("sprung_tabel", "; near it: sprung_table")])
def test_an_effect_that_nobody_knows_is_refused_and_help_has_the_list(capsys, given, near):
    """All of them make more than a sentence."""
    count = 1 + len(NAMED) + len(UNNAMED)
    with pytest.raises(SystemExit):
        main(["--effects", given])
    assert capsys.readouterr().err.endswith(f"{given!r}: want some of the {count} that --help names{near}\n")
    with pytest.raises(SystemExit):
        main(["--help"])
    told = " ".join(capsys.readouterr().out.split())
    assert "null, " in told and all(name in told for name in (*NAMED, *UNNAMED))
