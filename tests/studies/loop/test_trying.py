"""Where a candidate begins on all windows, with stubs for fits."""

import math
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


# quadratic_drag+tether-101001: a string on one side beside the drag was left after three steps by 400 worse than none,
# was let go for that, and explains 4,100 after some more.
@pytest.mark.parametrize(
    ("left", "converged", "costly", "gained"),
    [(140.0, False, False, 70.0), (140.0, True, False, -40.0), (140.0, False, True, -40.0), (90.0, False, False, 10.0)],
)
def test_a_fit_that_is_worse_than_nothing_goes_on_before_it_is_judged(
    monkeypatch: pytest.MonkeyPatch, left: float, converged: bool, costly: bool, gained: float
) -> None:
    def fit(simulator: Any, model: str, parameters: Any, windows: Any, *, iterations: int) -> Any:
        further = iterations == trying.FURTHER
        return SimpleNamespace(
            chi2=30.0 if further else left, model="there", windows=windows, converged=further or converged
        )

    monkeypatch.setattr(trying, "fit", fit)
    monkeypatch.setattr(trying, "afresh", lambda simulator, model, windows: (windows, 0.0))
    monkeypatch.setattr(trying, "chosen_for", lambda onto, candidate: [0])
    monkeypatch.setattr(trying, "nothing_of", lambda onto, candidate: {})
    monkeypatch.setattr(trying, "of_some", lambda found, chosen: 100.0)
    model = SimpleNamespace(changed=lambda values: "begun")
    onto: Any = SimpleNamespace(
        swing=SimpleNamespace(windows=("a",), model=model), costly=costly, parameters=(), calibrated_with=lambda c: ()
    )
    candidate: Any = SimpleNamespace(
        starts=({"slack": 0.1},), fixed={}, smooth=False, scouts=(), screened=0, costly=False, parameters=(),
        scored=0,
    )  # fmt: skip
    found = trying.on_some("simulator", onto, candidate)  # type: ignore[arg-type]
    assert isinstance(found, First)
    assert found.gained == gained


def test_starts_are_ranked_by_the_score_of_what_enters_linearly(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each at nothing of that, on some of the windows; one that does not run there says nothing."""

    def gains(simulator: Any, fitted: Any, parameters: Any, models: Any) -> dict[str, float]:
        assert fitted.windows == ("a", "c")
        assert all(p == (size,) for p in parameters.values())
        return {k: scores[model["mode.frequency"]] for k, model in models.items()}

    def changed(values: dict[str, float]) -> dict[str, float]:
        assert values["mode.size"] == 0.0 and values["mode.hanging"] == 1.0
        if values["mode.frequency"] == 5.0:
            raise ValueError("out of range")
        return values

    size, frequency = (SimpleNamespace(name=f"mode.{name}") for name in ("size", "frequency"))
    scores = {1.0: 3.0, 2.0: 50.0, 3.0: math.inf, 4.0: 20.0}
    monkeypatch.setattr(trying, "gains", gains)
    model = SimpleNamespace(declared=None, changed=changed)
    some: Any = SimpleNamespace(windows=("a", "c"), model=model)
    candidate: Any = SimpleNamespace(
        starts=tuple({"mode.size": 0.1, "mode.frequency": f} for f in (1.0, 2.0, 3.0, 4.0, 5.0)), scored=2,
        fixed={"mode.hanging": 1.0}, scouts=("mode.size",), parameters=(size, frequency),
        absent=lambda declared: {"mode.size": 0.0, "mode.frequency": 1.0},
    )  # fmt: skip
    best = trying.best_by_score("simulator", some, candidate)  # type: ignore[arg-type]
    assert [start["mode.frequency"] for start in best] == [2.0, 4.0]
    assert all(start["mode.size"] == 0.1 for start in best)


def test_forms_promise_what_their_scores_say_of_some_windows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Over chance, less the price of their parameters; what enters linearly by its size alone at its best start."""

    def gains(simulator: Any, fitted: Any, parameters: Any, models: Any) -> dict[str, float]:
        assert fitted.windows == tuple(range(0, 120, 2))
        own = next(iter(parameters.values()))
        scores = {2: {(): 30.0}, 1: {1.0: 9.0, 2.0: 20.0, 3.0: math.inf}}[len(own)]
        return {k: scores[model.get("mode.frequency", ())] for k, model in models.items()}

    first, second, size, frequency = (
        SimpleNamespace(name=name) for name in ("curve.first", "curve.second", "mode.size", "mode.frequency")
    )
    monkeypatch.setattr(trying, "gains", gains)
    monkeypatch.setattr(trying, "nothing_of", lambda onto, candidate: {p.name: 0.0 for p in candidate.parameters})
    model = SimpleNamespace(changed=dict)
    swing = SimpleNamespace(
        windows=range(120), model=model, samples=150,
        of=lambda chosen: SimpleNamespace(windows=tuple(chosen), model=model),
    )  # fmt: skip
    curve, mode = (
        SimpleNamespace(parameters=parameters, starts=starts, fixed={}, smooth=smooth, scouts=scouts, after="")
        for parameters, starts, smooth, scouts in (
            ((first, second), (), True, ()),
            ((size, frequency), tuple({"mode.frequency": f} for f in (1.0, 2.0, 3.0)), False, ("mode.size",)),
        )
    )
    other = SimpleNamespace(after="mode")
    onto: Any = SimpleNamespace(swing=swing)
    simulator: Any = None
    price = 2.0 * math.log(150.0)
    # Twice what is over chance: 30 of two numbers, 20 of one.
    for pool, score in (((curve,), 56.0), ((mode, other), 38.0), ((curve, mode), 56.0), ((), -math.inf)):
        assert trying.promise(simulator, onto, pool) == pytest.approx(score - price)
        assert trying.promise(simulator, onto, pool, 1.5) == pytest.approx(1.5 * score - price)
