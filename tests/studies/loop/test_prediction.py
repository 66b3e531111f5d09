"""What is written of a prediction: of a run that has to stop, a record that ends in a fall, a base that is lost."""

import csv
import json
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from rocking import Block
from studies.campaigns import Campaign, CampaignError, Channel, Conditions, DeclaredBlock, Test
from studies.loop import prediction
from studies.loop.models.model import LoopModel
from studies.loop.outcomes.runs import falls_of
from studies.loop.runs.simulation import Simulator

BLOCK = Block(0.2, 0.8, 0.4)
DECLARED = DeclaredBlock(0.2, 0.8, 0.4, BLOCK.mass)


IDEAL = LoopModel(DECLARED, 0.95, {}, 9.81)
ROTATION, BASE = Channel("rotation", "rotation", 1e-4), Channel("base_x", "base_acceleration_x", 1e-3)


def forced(samples: int, base: np.ndarray, start: float = 0.0) -> Campaign:
    """A test that a base shakes, to be predicted."""
    data = {"base_x": base[:samples]}
    test = Test("quake-01", "forced", start + 0.004 * np.arange(samples), (BASE,), data)
    return Campaign("", DECLARED, Conditions(), (ROTATION, BASE), (test,))


def rows_of(folder) -> list[dict[str, str]]:
    with (folder / "quake-01.csv").open() as stream:
        return list(csv.DictReader(stream))


def test_a_record_that_stops_in_a_fall_has_overturned_when_it_does_in_a_longer_one(tmp_path) -> None:
    """A push of 0.6 g for 0.6 s, without end above what holds the block: it passes its balance once and for all."""
    base = np.where(np.arange(600) < 150, 5.9, 0.0)
    whole = prediction.write_predictions(IDEAL, forced(600, base), tmp_path)["quake-01"]
    assert whole["overturned"] is True
    theta = np.array([float(row["rotation"]) for row in rows_of(tmp_path) if row["rotation"]])
    for rotation, falls in ((0.8, False), (1.05, True), (1.6, True), (4.0, True)):
        stop = int(np.flatnonzero(np.abs(theta) > rotation * BLOCK.alpha)[0]) + 1
        cut = prediction.write_predictions(IDEAL, forced(stop, base), tmp_path)["quake-01"]
        assert cut["overturned"] is falls
        assert cut["time"] == (pytest.approx(whole["time"], abs=1e-4) if falls else None)
        assert falls_of(Simulator(forced(stop, base).tests), [IDEAL]).tolist() == [[falls]]


def test_clocks_that_count_from_long_ago_keep_their_steps(tmp_path) -> None:
    prediction.write_predictions(IDEAL, forced(200, np.zeros(200), 1.7e9), tmp_path)
    time = np.array([float(row["time"]) for row in rows_of(tmp_path)])
    np.testing.assert_allclose(np.diff(time), 0.004, rtol=0.0, atol=1e-6)


def test_where_the_base_is_lost_nothing_is_predicted_and_it_is_said(tmp_path) -> None:
    base = 3.0 * np.sin(2.0 * np.pi * 2.0 * 0.004 * np.arange(1000))
    lost = base.copy()
    lost[700:] = np.nan
    said: list[str] = []
    found = prediction.write_predictions(IDEAL, forced(1000, lost), tmp_path, said.append)["quake-01"]
    own = rows_of(tmp_path)
    prediction.write_predictions(IDEAL, forced(700, base), tmp_path)
    assert len(own) == 1000 and own[:700] == rows_of(tmp_path)
    assert {row["rotation"] for row in own[700:]} == {""}
    assert found["note"] == "the base motion is lost after 2.796 s: what follows is not predicted"
    assert said == ["quake-01", f"quake-01: {found['note']}"]


def test_a_sensor_on_the_block_is_not_called_as_a_column_that_is_there_besides(tmp_path) -> None:
    sensor = Channel("rotation", "block_acceleration", 1e-3, position=(0.0, 0.8), direction=(1.0, 0.0))
    campaign = replace(forced(200, np.zeros(200)), channels=(sensor, BASE))
    with pytest.raises(CampaignError, match=r"channel 'rotation': a prediction has a column of that name besides"):
        prediction.write_predictions(IDEAL, campaign, tmp_path)


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
    campaign = Campaign("", DECLARED, Conditions(), (rotation,), (test,))
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
