"""What is written of a prediction whose run has to stop: nothing is made up, and it is said."""

import csv
import json
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from rocking import Block
from studies.campaigns import Channel, DeclaredBlock, Test
from studies.loop import prediction
from studies.loop.models.model import LoopModel

BLOCK = Block(0.2, 0.8, 0.4)
DECLARED = DeclaredBlock(0.2, 0.8, 0.4, BLOCK.mass)


def test_what_a_test_wears_the_next_one_finds() -> None:
    """Two equal releases: in the second, impacts go on to lose what those of the first have come to."""
    time = np.arange(1001) * 0.004
    rotation = Channel("rotation", "rotation", 1e-4)
    tests = tuple(
        Test(f"free-{k}", "free", time, (rotation,), {"rotation": np.full(time.size, np.nan)}, initial_rotation=0.2)
        for k in (1, 2)
    )
    campaign: Any = SimpleNamespace(tests=tests, block=DECLARED, channels=(rotation,))
    wear = {"worn": -0.05, "worn_use": 2.0, "worn_exponent": 2.0, "used": 0.5}
    first, second = prediction.predict(LoopModel(DECLARED, 0.95, {"learned_memory": wear}, 9.81), campaign)
    again = LoopModel(DECLARED, 0.95, {"learned_memory": wear | {"used": first.y[-1, 4]}}, 9.81)
    [alone] = prediction.predict(again, SimpleNamespace(tests=tests[:1], block=DECLARED, channels=(rotation,)))
    assert first.y[0, 4] == 0.5 and first.y[-1, 4] > 2.0
    np.testing.assert_array_equal(second.theta, alone.theta)
    assert np.max(np.abs(second.theta - first.theta)) > 0.01


@pytest.mark.parametrize("most", [4, 1_000])
def test_a_run_that_has_to_stop_leaves_the_rest_empty_and_says_so(tmp_path, monkeypatch, most):
    """A free decay has an impact about every half second, so that four of them are over long before eight seconds."""
    monkeypatch.setattr(prediction, "MOST_EVENTS", most)
    time, said = np.arange(2001) * 0.004, list[str]()
    rotation = Channel("rotation", "rotation", 1e-4)
    test = Test("free-01", "free", time, (rotation,), {"rotation": np.full(time.size, np.nan)}, initial_rotation=0.2)
    campaign: Any = SimpleNamespace(tests=(test,), block=DECLARED, channels=(rotation,))
    found = prediction.write_predictions(LoopModel(DECLARED, 0.95, {}, 9.81), campaign, tmp_path, said.append)
    with (tmp_path / "free-01.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    empty = [row["rotation"] == "" for row in rows]
    assert found == json.loads((tmp_path / "predict.json").read_text())["tests"]
    assert found["free-01"]["overturned"] is False
    if most == 1_000:
        assert not any(empty) and said == ["free-01"] and "note" not in found["free-01"]
        return
    stop = empty.index(True)
    assert all(empty[stop:]) and 0.5 < time[stop] < 4.0
    assert (
        found["free-01"]["note"]
        == f"the run of the model stopped after {time[stop - 1]:g} s: what follows is not predicted"
    )
    assert said == ["free-01", f"free-01: {found['free-01']['note']}"]
