"""Outcomes alone: what is refused, what is held out, the likelihood, the files; and whole runs on virtual campaigns."""

import json
import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr

from rocking.effects import available
from studies.campaigns import Campaign, CampaignError, Channel, Conditions, DeclaredBlock, Test, read, write
from studies.laboratory.outcomes import make_outcomes
from studies.loop.__main__ import main
from studies.loop.models.model import LoopModel
from studies.loop.models.model_file import ModelError, read_model
from studies.loop.outcomes import closing as outcomes
from studies.loop.outcomes import search as outcomes_search
from studies.loop.outcomes.candidates import UNSEEN, forms
from studies.loop.outcomes.data import cheap, prepare, scaled
from studies.loop.outcomes.dataset import peak_velocity
from studies.loop.outcomes.finding import candidate_rows
from studies.loop.outcomes.likelihood import Noise, best_over_draws, probability, score, weights
from studies.loop.outcomes.prediction import read_noise, write_outcome_model
from studies.loop.outcomes.runs import falls_of
from studies.loop.outcomes.search import Round
from studies.loop.outcomes.text import reason
from studies.loop.runs.simulation import Simulator

BLOCK = DeclaredBlock(0.15, 0.5, 0.25, 11.25)
BASE = Channel("base", "base_acceleration_x", 0.01)


def pulse(id, peak, motion, overturned, frequency=1.0):
    """One cycle of a sine, which fells a block when it is strong."""
    t = 0.005 * np.arange(601)
    a = np.where((t > 0.5) & (t < 0.5 + 1.0 / frequency), peak * np.sin(2.0 * np.pi * frequency * (t - 0.5)), 0.0)
    return Test(id, "forced", t, (BASE,), {"base": a}, motion=motion, overturned=overturned)


def campaign(falls, motions=6):
    """Tests with these outcomes over some motions, in turn."""
    tests = tuple(pulse(f"run-{k}", 4.0 + k % 5, f"motion {k % motions}", fell) for k, fell in enumerate(falls))
    return Campaign("pulses", BLOCK, Conditions(), (BASE,), tests)


@pytest.mark.parametrize(
    ("falls", "motions", "words"),
    [
        ([True] * 30, 6, "all of 30 tests overturned"),
        ([False] * 30, 6, "none of 30 tests overturned"),
        ([True] * 3 + [False] * 27, 6, "3 of 30 tests overturned: want 5 or more that fell"),
        ([True, False] * 8, 6, "16 tests have an outcome: want 24 or more"),
        ([True, False] * 15, 2, "of 2 base motions: want 4 or more"),
    ],
)
def test_outcomes_that_can_support_nothing_are_refused(falls, motions, words, tmp_path, capsys) -> None:
    path = write(campaign(falls, motions), tmp_path / "campaign")
    with pytest.raises(CampaignError, match=words):
        prepare(read(path))
    assert main([str(path), "--out", str(tmp_path / "out"), "--quiet"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: ") and said.count("\n") == 1 and words in said


def test_tests_of_one_motion_are_held_out_together() -> None:
    data = prepare(campaign([True, False] * 20, motions=9))
    for group in np.unique(data.group):
        assert len(set(data.held[data.group == group])) == 1
    assert np.unique(data.group[data.held]).size == 2  # about a quarter of nine
    with_gap = campaign([True, False] * 20, motions=9)
    with_gap = replace(with_gap, tests=(*with_gap.tests, replace(with_gap.tests[0], id="later", overturned=None)))
    data = prepare(with_gap)
    assert len(data.tests) == 40
    assert "1 of 41 tests have no outcome" in data.notes[0]


def test_an_outcome_whose_base_is_lost_is_left_out_and_said() -> None:
    whole = campaign([True, False] * 20, motions=9)
    values = whole.tests[7].data["base"].copy()
    values[200:240] = np.nan
    tests = [replace(test, data={"base": values}) if k == 7 else test for k, test in enumerate(whole.tests)]
    data = prepare(replace(whole, tests=tuple(tests)))
    assert len(data.tests) == len(data.fell) == 39 and 7 not in data.numbers
    [note] = data.notes
    assert "test 'run-7': base has 40 samples missing from 1 s on" in note and note.endswith("its outcome is left out")


def test_the_cheap_form_of_a_motion_is_the_strong_part_of_it() -> None:
    test = pulse("one", 6.0, "m", True)
    short = cheap(test, BLOCK)
    assert short.time_step == pytest.approx(0.015)  # 0.1 / p is 0.0188 s for this block: every third sample
    assert 0.4 < short.time[0] < 0.6 and short.time[-1] > 1.5
    assert np.max(np.abs(short.data["base"])) == pytest.approx(6.0, rel=0.02)
    assert np.array_equal(scaled(test, 1.5).data["base"], 1.5 * test.data["base"])
    # What falls and what does not is as with the whole record.
    peaks = np.linspace(3.0, 12.0, 19)
    tests = [pulse(f"p{k}", peak, "m", None) for k, peak in enumerate(peaks)]
    forms_of_record = (tests, [cheap(t, BLOCK) for t in tests])
    whole, part = (falls_of(Simulator(some), [LoopModel(BLOCK, 0.9)])[0] for some in forms_of_record)
    assert whole.any() and not whole.all()
    assert np.sum(whole != part) <= 1


def test_probability_of_falling() -> None:
    strengths = (-0.2, 0.0, 0.2)
    w = weights(strengths, 0.2)
    assert w[0] / w[1] == pytest.approx(math.exp(-0.5)) and w.sum() == pytest.approx(1.0)
    falls = np.array([[False, False], [False, True], [True, True]])
    p = probability(falls, strengths, Noise(0.2, 0.1))
    assert p == pytest.approx([0.1 + 0.8 * w[2], 0.1 + 0.8 * (w[1] + w[2])])


def test_likelihood_of_one_strength_is_that_of_a_coin() -> None:
    """With k of n wrong the best error rate is k / n, and the log-likelihood minus n times its entropy."""
    n, k = 100, 10
    fell = np.arange(n) < 40
    wrong = fell.copy()
    wrong[:k] = ~wrong[:k]
    found = score(wrong[None, None, :], (0.0,), fell)
    assert found.noise[0].error_rate == 0.1
    assert found.value[0] == pytest.approx(n * (0.1 * math.log(0.1) + 0.9 * math.log(0.9)))
    several = np.array([wrong[None, :], fell[None, :]])
    assert best_over_draws(several, (0.0,), fell[None, :])[0] == pytest.approx(score(several, (0.0,), fell).value.max())


def test_every_effect_is_tried_or_said_to_be_unseen() -> None:
    tried = {form.candidate.effect for form in forms(BLOCK)}
    assert tried | set(UNSEEN) == {name for name in available() if not name.startswith("learned_")}
    assert not tried & set(UNSEEN)
    for form in forms(BLOCK):
        own = form.candidate
        model = LoopModel(BLOCK, 0.95).changed({**own.fixed, **own.starts[0]})
        assert model.system is not None


def test_model_with_its_noise_on_disk(tmp_path) -> None:
    path = tmp_path / "model.toml"
    model, noise = LoopModel(BLOCK, 0.93, {"viscous_damping": {"coefficient": 0.25}}), Noise(0.16, 0.035)
    write_outcome_model(model, noise, path, "a title")
    assert read_noise(path) == noise
    assert read_model(path).effects == model.effects
    path.write_text(path.read_text().replace("error_rate = 0.035", "error_rate = 0.7"))
    with pytest.raises(ModelError, match=r"outcomes.error_rate=0.7: want a number between 0 and 0.5"):
        read_noise(path)


def test_peak_velocity_of_a_wave_train() -> None:
    """A slow envelope of sin(w t) at acceleration a moves with velocity a / w at its height."""
    t = 0.005 * np.arange(8001)
    train = 3.0 * np.exp(-(((t - 20.0) / 5.0) ** 2)) * np.sin(4.0 * np.pi * t)
    test = Test("s", "forced", t, (BASE,), {"base": train})
    assert peak_velocity(test) == pytest.approx(3.0 / (4.0 * np.pi), rel=0.01)


def few(names):
    """The list of forms cut to some of them."""
    return lambda block, friction: tuple(form for form in forms(block, friction) if form.candidate.name in names)


NAMES = ("rounded_edges", "base_tilt")


@pytest.fixture(scope="module")
def rounded(tmp_path_factory):
    """A small virtual campaign of a block with round edges, closed with a short list of effects, and predicted."""
    folder = tmp_path_factory.mktemp("rounded")
    truth = make_outcomes(1, ["rounded_edges"], folder, motions=12)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(outcomes, "forms", few(NAMES))
        patch.setattr(outcomes_search, "MOST_POINTS", 24)
        assert main([str(folder / "campaign"), "--out", str(folder / "loop"), "--quiet"]) == 0
    model = str(folder / "loop" / "model.toml")
    assert main(["predict", model, str(folder / "predict"), "--out", str(folder / "ahead"), "--quiet"]) == 0
    return folder, truth


@pytest.mark.slow
def test_round_edges_are_found_in_outcomes(rounded) -> None:
    folder, truth = rounded
    found = json.loads((folder / "loop" / "loop.json").read_text())
    assert (found["verdict"], found["effects"]) == ("effect", ["rounded_edges"])
    radius = found["parameters"]["rounded_edges.radius"]
    assert radius["low"] <= truth.parameters["rounded_edges.radius"] <= radius["high"]
    error = found["error"]
    assert error["after"]["holdout"] < error["before"]["holdout"]
    assert error["metric"] == "share of outcomes predicted wrong"
    assert set(found["held_out"]) < {t.id for t in read(folder / "campaign").tests}


@pytest.mark.slow
def test_predictions_of_outcomes(rounded) -> None:
    folder, truth = rounded
    said = json.loads((folder / "ahead" / "predict.json").read_text())["tests"]
    assert set(said) == set(truth.overturned)
    for row in said.values():
        assert row["overturned"] == (row["probability"] > 0.5)
    wrong = np.mean([said[id]["overturned"] != fell for id, fell in truth.overturned.items()])
    # `baseline` is what the laboratory's own ideal block with the best restitution scores on the same tests.
    assert wrong < truth.baseline["predict"]


# A named effect that was tried in vain, then something learned in its place, and one more beside that.
def test_what_was_tried_in_any_round_is_among_the_candidates() -> None:
    def tried(*names: str, value: float = 0.0) -> SimpleNamespace:
        return SimpleNamespace(names=names, effects=names, parameters=names, points=[SimpleNamespace(value=value)])

    base, tilt, term = tried(), tried("base_tilt", value=-3.0), tried("learned[spring]", value=20.0)
    edges = tried("learned[spring]", "rounded_edges", value=21.0)
    rounds = (
        Round(base, {"base_tilt": tilt}, [], {"sliding": "friction is declared"}),
        Round(base, {"learned[spring]": term}, [term]),
        Round(term, {"rounded_edges": edges}, []),
    )
    search = SimpleNamespace(criterion=lambda t: 2.0 * t.points[0].value, price=lambda n: 3.0 * n)
    finding: Any = SimpleNamespace(
        rounds=rounds, chosen=term, search=search, rival_errors={}, error=lambda stage: {"holdout": 0.1}
    )
    rows = candidate_rows(finding)
    told = {(row["form"], *row["beside"]): (row["evidence"], row["holdout_error"]) for row in rows}
    assert told["learned[spring]",] == (40.0, 0.1)
    assert told["base_tilt",] == (-9.0, None)
    assert told["rounded_edges", "learned[spring]"] == (-1.0, None)
    assert told["sliding",] == (None, None)
    assert set(UNSEEN) <= {row["form"] for row in rows}
    assert rows[0]["form"] == "learned[spring]"
    content = {"candidates": rows, "indistinguishable": [], "verdict": "unexplained"}
    for row in rows:
        said = reason(row, content, term.names)
        assert ("not tried" in said) == (row["evidence"] is None)
    assert reason(rows[0], content, term.names) == "in the model after"
    # In its place a twin cannot be told from what was chosen; beside it, it adds nothing.
    content["indistinguishable"] = [["rounded_edges", "base_motion_gain"]]
    twin = {"form": "base_motion_gain", "effect": "base_motion_gain"}
    alone, beside = {"beside": [], "evidence": 39.0}, {"beside": ["rounded_edges"], "evidence": -17.0}
    said = [reason(twin | row, content, ("rounded_edges",)) for row in (alone, beside)]
    assert said == ["cannot be told apart from what was chosen", "explains no more than its parameters cost"]


@pytest.mark.slow
def test_files_of_outcomes(rounded) -> None:
    folder, _ = rounded
    content = json.loads((folder / "loop" / "loop.json").read_text())
    with xr.open_datatree(folder / "loop" / "loop.nc") as tree:
        tests = tree["tests"].to_dataset()
        held = tests.held_out.values.astype(bool)
        wrong = (tests.probability_after.values > 0.5) != tests.overturned.values.astype(bool)
        assert wrong[held].mean() == pytest.approx(content["error"]["after"]["holdout"])
        assert set(tree["candidates"].form.values) == set(NAMES)
    page = (folder / "loop" / "report.html").read_text()
    for section in ("verdict", "error", "measured", "residual", "found", "sure", "ruled-out", "next", "concluded"):
        assert f'id="{section}"' in page
    assert "<script" not in page and "http" not in page.split("</style>")[1].replace("http-equiv", "")


@pytest.mark.slow
def test_clean_outcomes_are_found_clean(tmp_path) -> None:
    make_outcomes(1, [], tmp_path, motions=10)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(outcomes, "forms", few(NAMES))
        patch.setattr(outcomes_search, "MOST_POINTS", 24)
        assert main([str(tmp_path / "campaign"), "--out", str(tmp_path / "loop"), "--quiet"]) == 0
    found = json.loads((tmp_path / "loop" / "loop.json").read_text())
    assert (found["verdict"], found["effects"]) == ("none", [])
    assert found["error"]["after"] == found["error"]["before"]
