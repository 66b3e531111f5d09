"""Where a candidate begins on all windows, with stubs for fits."""

from types import SimpleNamespace
from typing import Any

import pytest

from studies.loop.swings import trying
from studies.loop.swings.trials import PAYS, First


# A strong cubic torque: from the states of the block without it, it left 4.7e6 of the swings and ran to the end of its
# range; from those that records show 7,300, as when it is searched for alone.
@pytest.mark.parametrize(
    ("smooth", "left", "anew"), [(True, 120.0, True), (True, 80.0, False), (False, 80.0, True), (False, 120.0, True)]
)
def test_states_that_serve_a_candidate_worse_than_nothing_of_it_are_begun_anew(
    monkeypatch: pytest.MonkeyPatch, smooth: bool, left: float, anew: bool
) -> None:
    def fit(simulator: Any, model: str, parameters: Any, windows: tuple[str, ...], *, iterations: int) -> Any:
        assert model == "strong"
        return SimpleNamespace(chi2=left, windows=windows) if iterations == 0 else (parameters, windows, iterations)

    monkeypatch.setattr(trying, "fit", fit)
    monkeypatch.setattr(trying, "afresh", lambda simulator, model, windows: ([f"{w} anew" for w in windows], 0.0))
    onto: Any = SimpleNamespace(swing=SimpleNamespace(windows=("a", "b"), chi2=100.0))
    candidate: Any = SimpleNamespace(smooth=smooth)
    first: Any = First("strong", ("p",), PAYS)  # type: ignore[arg-type]
    found = trying.on_all("simulator", onto, candidate, first)  # type: ignore[arg-type]
    assert found == (("p",), ("a anew", "b anew") if anew else ("a", "b"), 4)
