"""The table of claims: verdicts, what is missing, files, and that no bound is without a study."""

import csv
import math

import numpy as np
import pytest
import xarray as xr

from studies.claims import __main__ as claims
from studies.claims.bounds import CLAIMS
from studies.running.files import BadInputError
from studies.running.registry import studies
from studies.running.statements import DOES_NOT, HOLDS, UNDECIDED, Claim, Finding, table
from studies.running.study import make


@pytest.mark.parametrize(
    ("relation", "number", "verdict"),
    [
        ("<=", 1.0, HOLDS), ("<=", 1.1, DOES_NOT), ("<", 1.0, DOES_NOT), (">", 1.0, DOES_NOT), (">", 1.1, HOLDS),
        (">=", 1.0, HOLDS), (">=", 0.9, DOES_NOT), ("<=", math.nan, UNDECIDED), ("", 1.0, UNDECIDED),
    ],
)  # fmt: skip
def test_verdict_follows_the_bound(relation, number, verdict):
    assert Claim("a.b", "s", "p", "n", relation, 1.0).verdict(number) == verdict


def test_every_claim_has_a_study_and_every_key_is_its_own():
    assert {claim.study for claim in CLAIMS.values()} <= set(studies())
    assert all(key == claim.key for key, claim in CLAIMS.items())
    assert all(claim.statement and claim.place and claim.number for claim in CLAIMS.values())
    assert all(math.isfinite(claim.bound) for claim in CLAIMS.values() if claim.relation)


def test_table_holds_numbers_units_and_flags():
    claim = Claim("a.b", "s", "p", "n", "<=", 1.0, "rad", "d")
    ds = table([Finding(claim, 0.5, "x"), Finding(claim, math.nan)])
    assert ds.statement_holds.values.tolist() == [HOLDS, UNDECIDED]
    assert ds.statement_bound.values[0] == "n <= 1 rad"
    assert ds.statement_holds.dtype == np.int8


def test_command_prints_and_saves_the_table(tmp_path, capsys):
    make(studies()["fig18"], ["--quick", "--out", str(tmp_path)])
    make(studies()["fig19"], ["--quick", "--out", str(tmp_path)])
    capsys.readouterr()
    claims.main(["--out", str(tmp_path)])
    said = capsys.readouterr().out
    assert "[fig19.low]" in said and "NOT MADE" in said
    with xr.open_dataset(tmp_path / "claims.nc") as ds:
        at = ds.isel(statement=ds.statement_key.values.tolist().index("fig19.low"))
        assert at.statement_study.item() == "fig19"
        assert set(CLAIMS) <= set(ds.statement_key.values.tolist())
        with xr.open_dataset(tmp_path / "fig19.nc") as made:
            k = made.statement_key.values.tolist().index("fig19.low")
            assert float(made.statement_number[k]) == pytest.approx(float(at.statement_number), nan_ok=True)
    with (tmp_path / "claims.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) >= len(CLAIMS)
    assert (tmp_path / "claims.txt").read_text() in said


def test_an_empty_folder_is_one_sentence(tmp_path):
    with pytest.raises(BadInputError, match="no dataset of a study is there; python -m studies all makes them"):
        claims.main(["--out", str(tmp_path)])
