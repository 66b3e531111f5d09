"""Rivals that come near: twins are fitted to whole records from more starts before these decide; all fits are stubs."""

from types import SimpleNamespace
from typing import Any

import pytest

from studies.loop.whole import rivals
from studies.loop.whole.rivals import TWIN, Rival, standing, twins_from_many


def rival(effect: str, criterion: float, chi2: float, costly: bool = False) -> Rival:
    whole: Any = SimpleNamespace(chi2=chi2, model=effect, windows=())
    trial: Any = SimpleNamespace(effects=("slope", effect), names=("slope", effect), costly=costly)
    return Rival(trial, whole, criterion, chi2, 1.0)


@pytest.fixture
def better(monkeypatch):
    """From more starts the pitch is met far better; the order of what was asked is kept."""
    asked = []

    def from_many(setup, trial, weights_of, effects):
        assert effects == {trial.effects[1]}  # not what all of them have
        asked.append(trial.effects[1])
        return SimpleNamespace(chi2={"pitch": 10.0}.get(trial.effects[1], 500.0), model="new", windows=())

    monkeypatch.setattr(rivals, "whole_fit_from_many", from_many)
    monkeypatch.setattr(rivals, "bic", lambda fit: fit.chi2 + 1.0)
    monkeypatch.setattr(rivals, "errors", lambda setup, model, windows: SimpleNamespace(holdout=0.5))
    return asked


def by_whole_records(one: Rival, other: Rival) -> bool:
    return one.whole.chi2 < other.whole.chi2 - 50.0


def test_of_twins_the_one_that_more_starts_bring_nearest_to_whole_records_is_preferred(better) -> None:
    given = [rival("pitch", 100.0, 5000.0), rival("gain", 101.0, 300.0), rival("mass", 100.0 + 2.0 * TWIN, 200.0)]
    first = standing(given, lambda r: False, by_whole_records)[0]
    assert first.trial.effects[1] == "gain"  # by one start each
    mended = twins_from_many(None, given, None)
    assert better == ["pitch", "gain"]
    assert [r.whole.chi2 for r in mended] == [10.0, 300.0, 200.0]  # what was better is kept
    assert (mended[0].whole_criterion, mended[0].holdout) == (11.0, 0.5)
    assert mended[1].holdout == 1.0
    assert standing(mended, lambda r: False, by_whole_records)[0].trial.effects[1] == "pitch"


@pytest.mark.parametrize(
    "given",
    [
        [rival("pitch", 100.0, 5000.0), rival("mass", 100.0 + 2.0 * TWIN, 200.0)],
        [rival("pitch", 100.0, 5000.0), rival("pitch", 101.0, 300.0)],  # another form of the same effect
        [rival("pitch", 100.0, 5000.0), rival("floor", 101.0, 300.0, costly=True)],
    ],
)
def test_what_has_no_twin_is_left_as_it_is(better, given) -> None:
    assert twins_from_many(None, given, None) == tuple(given)
    assert not better
