"""Models on disk: what was written reads back, and what is wrong is named."""

import math
from dataclasses import replace
from pathlib import Path

import pytest
from scipy.integrate import quad

from studies.campaigns import DeclaredBlock
from studies.loop.__main__ import main
from studies.loop.models.candidates import Candidate, candidates
from studies.loop.models.model import LoopModel
from studies.loop.models.model_file import ModelError, read_model, write_model

BLOCK = DeclaredBlock(0.2, 0.8, 0.4, 40.0)
MODEL = LoopModel(
    BLOCK, 0.9123456789012345, {"rounded_edges": {"radius": 0.0031}, "base_tilt": {"angle": -0.002}}, 9.81, 1e-4, 7
)


def test_a_model_reads_back_to_the_same_bits(tmp_path: Path) -> None:
    write_model(MODEL, tmp_path / "model.toml", "a title")
    assert read_model(tmp_path / "model.toml") == MODEL


@pytest.mark.parametrize("candidate", candidates(BLOCK), ids=lambda c: c.name)
def test_whatever_the_loop_may_find_reads_back(tmp_path: Path, candidate: Candidate) -> None:
    values = (*candidate.starts, *candidate.scanned)[0]
    found = LoopModel(BLOCK, 0.93, g=9.81).changed({**candidate.fixed, **values})
    write_model(found, tmp_path / "model.toml")
    assert read_model(tmp_path / "model.toml") == found


def test_infinity_is_a_number_only_where_it_says_that_something_is_not_there(tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    write_model(MODEL, path)
    path.write_text(path.read_text().replace("radius = 0.0031", "radius = inf"))
    with pytest.raises(ModelError, match=r"effects.rounded_edges.radius=inf: want a number that is finite"):
        read_model(path)


@pytest.mark.parametrize(
    ("old", "new", "wanted"),
    [
        ("radius = ", "radios = ", r"effects.rounded_edges has no 'radios', want one of radius"),
        ("[effects.rounded_edges]", "[effects.round_edges]", r"effect 'round_edges' is unknown, want one of"),
        ("radius = 0.0031", "radius = 9.0", r"rounded_edges.radius=9.0 m: want less than half of the breadth"),
        ("radius = 0.0031", 'radius = "3 mm"', r"effects.rounded_edges.radius='3 mm': want a number"),
        ("gravity = 9.81", "", r"model.gravity=None: want a number"),
        ("[block]", "[blok]", r"has no table \[block\]"),
        ("breadth = ", "width = ", r"want breadth, height, depth and mass"),
    ],
)
def test_what_is_wrong_with_a_model_is_named(tmp_path: Path, old: str, new: str, wanted: str) -> None:
    path = tmp_path / "model.toml"
    write_model(MODEL, path)
    text = path.read_text()
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))
    with pytest.raises(ModelError, match=wanted):
        read_model(path)


def test_a_model_that_is_not_there_ends_the_command_with_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["predict", str(tmp_path / "model.toml"), str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    assert "model.toml: want a file that can be read" in capsys.readouterr().err


def test_restitution_drifts_with_the_number_of_the_test() -> None:
    assert MODEL.in_test(3).restitution_now == pytest.approx(MODEL.restitution + 1e-4 * 10, rel=1e-15)
    assert LoopModel(BLOCK, 0.9).in_test(3).number == 0


def test_parameters_change_in_the_course_of_a_campaign_and_not_beyond_their_range() -> None:
    """Evenly, ever less, or all at once: the sums of the changes so far; the model is that of the first test."""
    changes = {
        "rounded_edges.radius": {"per_test": 1e-3, "low": 0.0, "high": 0.0055},
        "base_tilt.angle": {"step": 2e-3, "from_test": 3.0},
        "viscous_damping.coefficient": {"per_test": -0.1, "fading": 0.5, "low": 0.0},
        "restitution": {"step": -0.02, "from_test": 2.0},
    }
    effects = {
        "rounded_edges": {"radius": 2e-3}, "base_tilt": {"angle": 1e-3}, "viscous_damping": {"coefficient": 0.3}
    }  # fmt: skip
    model = LoopModel(BLOCK, 0.9, effects, changes=changes)
    for number, radius, angle, restitution in ((0, 2e-3, 1e-3, 0.9), (2, 4e-3, 1e-3, 0.88), (7, 5.5e-3, 3e-3, 0.88)):
        there = model.in_test(number)
        assert there.effects_now["rounded_edges"]["radius"] == pytest.approx(radius, rel=1e-12)
        assert there.effects_now["base_tilt"]["angle"] == pytest.approx(angle, rel=1e-12)
        damping = 0.3 - quad(lambda n: 0.1 * math.exp(-0.5 * n), 0.0, number)[0]
        assert there.effects_now["viscous_damping"]["coefficient"] == pytest.approx(damping, rel=1e-12)
        assert there.restitution_now == pytest.approx(restitution, rel=1e-12)
        assert vars({part.name: part for part in there.parts}["rounded_edges"])["radius"] == pytest.approx(radius)
    assert model.in_test(1).get("rounded_edges.radius") == 2e-3
    assert model.get("learned_change.step.base_tilt.angle") == 2e-3
    assert (
        model.changed({"learned_change.step.base_tilt.angle": 1.0}).in_test(3).effects_now["base_tilt"]["angle"] > 1.0
    )


def test_changes_are_kept_in_the_file(tmp_path: Path) -> None:
    changes = {"base_tilt.angle": {"per_test": 1e-4, "fading": 0.2, "low": -0.1, "high": 0.1}}
    changes["restitution"] = {"per_test": -1e-3, "by_use": 1.0}
    model = LoopModel(BLOCK, 0.9, {"base_tilt": {"angle": 1e-3}}, changes=changes, number=4, uses=(0.5, 1.2, 2.5, 4.0))
    write_model(model, tmp_path / "model.toml")
    found = read_model(tmp_path / "model.toml")
    for number in (0, 3, 50):
        assert found.in_test(number).effects_now == model.in_test(number).effects_now
        assert found.in_test(number).restitution_now == model.in_test(number).restitution_now
    assert found.restitution_now == pytest.approx(0.9 - 1e-3 * 5.0, rel=1e-12)  # after the last test one like all
    assert found.number == 4
    # Of an effect that was taken out no change is left, and none is written that could not be read again.
    without = replace(model, effects={})
    write_model(without, tmp_path / "without.toml")
    assert set(read_model(tmp_path / "without.toml").changes) == {"restitution"}


@pytest.mark.parametrize(
    ("old", "new", "wanted"),
    [
        (
            '[changes."base_tilt.angle"]',
            '[changes."tether.slack"]',
            r"changes.*tether\.slack.*want restitution, or EFFECT",
        ),
        ("fading = 0.2", "fading = -0.2", r"fading=-0\.2: want 0 or more"),
        ("per_test = 0.0001", "per_day = 0.0001", "has no .*per_day.*, want per_test, fading, step"),
        ("uses = []", "uses = [2.0, 1.0]", "uses=.*want numbers from 0 on that do not become less"),
        ("uses = []", "uses = 3", "uses=3: want a list of numbers"),
        ("per_test = 0.0001", "per_test = nan", "per_test=nan: want a number that is finite"),
    ],
)
def test_a_change_that_cannot_be_is_refused(tmp_path: Path, old: str, new: str, wanted: str) -> None:
    changes = {"base_tilt.angle": {"per_test": 1e-4, "fading": 0.2}}
    path = tmp_path / "model.toml"
    write_model(LoopModel(BLOCK, 0.9, {"base_tilt": {"angle": 1e-3}}, changes=changes), path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(ModelError, match=wanted):
        read_model(path)


def test_a_drift_that_fades_comes_to_an_end() -> None:
    """The sum of changes that each are smaller by exp(-fading), and drift / fading away in the end."""
    model = LoopModel(BLOCK, 0.9, drift=-0.004, fading=0.25)
    for number in (0, 1, 7):
        expected = 0.9 - quad(lambda n: 0.004 * math.exp(-0.25 * n), 0.0, number)[0]
        assert model.in_test(number).restitution_now == pytest.approx(expected, rel=1e-12)
    assert model.in_test(10**6).restitution_now == pytest.approx(0.9 - 0.016, rel=1e-12)
    assert replace(model, fading=1e-9).in_test(7).restitution_now == pytest.approx(0.9 - 0.028, rel=1e-6)
