"""Fits of whole records: how their samples weigh, and where the starts of many lie."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from studies.campaigns import Channel, DeclaredBlock
from studies.loop.fits.fitting import Fit
from studies.loop.models.model import LoopModel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.windows import Window
from studies.loop.whole import whole_fits

NOISE = 2e-4


def record(sd: float, theta: float = 0.1) -> Window:
    """Four seconds of a rotation sensor, each sample as sure as so many times its noise."""
    t, noise = np.arange(400) * 0.01, np.full(400, NOISE)
    return Window(
        0, 0, 0.0, t, np.arange(400), (Channel("rotation", "rotation", NOISE),), np.arange(400), np.zeros(400), noise,
        theta, 0.0, 0.0, 0.0, sd=sd * noise,
    )  # fmt: skip


def test_other_weights_leave_aside_those_before_and_keep_what_the_records_say(monkeypatch: pytest.MonkeyPatch) -> None:
    """By hand, in units of the sensor's noise: 3 of the record itself, sqrt(8) of base noise, twice its variance."""
    setup: Any = SimpleNamespace(whole=[record(3.0)], noisy=None, campaign=SimpleNamespace(tests=[None]))
    monkeypatch.setattr(whole_fits, "variances", lambda *_, **__: [np.full(400, 8.0 * NOISE**2)])
    model: Any = None
    [found] = whole_fits.weighed_under(setup, model, [record(70.0, theta=0.2)])
    assert found.theta == 0.2 and found.sd == pytest.approx(np.full(400, 5.0 * NOISE), rel=1e-12)


def test_neighbours_reach_two_standard_deviations_within_the_bounds() -> None:
    block = DeclaredBlock(0.15, 0.5, 0.25, 11.25)
    drag = Parameter("quadratic_drag.coefficient", 0.05, 0.0, 20.0)
    found: Any = SimpleNamespace(
        parameters=(drag,), model=LoopModel(block, 0.9, {"quadratic_drag": {"coefficient": 0.3}}),
    )  # fmt: skip
    values = [model.get(drag.name) for model in whole_fits.neighbours(found, np.array([[0.04]]), drag, 11)]
    np.testing.assert_allclose(values, np.maximum(0.3 + 0.2 * np.linspace(-2.0, 2.0, 11), 0.0), atol=1e-12)
    assert whole_fits.neighbours(found, np.array([[0.04]]), Parameter("base_tilt.angle", 1e-3), 11) == []


@dataclass(frozen=True)
class Swing:
    model: Any
    chi2: float = 0.0


@dataclass(frozen=True)
class Some:
    """A trial, as far as these fits look at it."""

    swing: Any
    parts: tuple[Any, ...] = ()
    costly: bool = False
    effects: tuple[str, ...] = ()

    @property
    def parameters(self) -> tuple[Any, ...]:
        return tuple(p for part in self.parts for p in part.parameters)


def test_the_best_of_many_starts_is_taken_and_a_floor_has_one(monkeypatch: pytest.MonkeyPatch) -> None:
    parts = tuple(SimpleNamespace(parameters=(size, "other"), in_swings=seen) for size, seen in ((2, True), (5, False)))
    chi2 = {0: 4.0, 1: 3.0, 2: 1.0, 3: 2.0}
    for name, stub in {
        "whole_fit": lambda setup, t, w: SimpleNamespace(chi2=chi2[t.swing.model], weights=w),
        "sensor_covariance": lambda simulator, fit: "covariance",
        "neighbours": lambda fit, covariance, parameter, count: range(1, parameter + 2),
    }.items():
        monkeypatch.setattr(whole_fits, name, stub)
    setup: Any = SimpleNamespace(simulator=None)
    best: Any = whole_fits.whole_fit_from_many(setup, Some(Swing(0), parts), "weights")  # type: ignore[arg-type]
    assert (best.chi2, best.weights) == (1.0, "weights")
    costly = whole_fits.whole_fit_from_many(setup, Some(Swing(0), parts, True), "weights")  # type: ignore[arg-type]
    assert costly.chi2 == 4.0


@pytest.mark.parametrize(
    ("effect", "rms", "taken"),
    [
        # What whole records of a floor that gives are met by closely holds the samples of the swings, too.
        ("a floor", 1.05, True),
        ("a floor", 1.2, False),
        ("drag", 1.05, False),
        # And how a mass within was moving when a swing began.
        ("learned_mode", 1.05, True),
        ("learned_mode", 1.2, False),
        # And how many impacts went before one, where all are remembered that are too slow to show.
        ("learned_memory", 1.05, True),
        ("learned_memory", 1.2, False),
    ],
)
def test_what_swings_do_not_bear_is_taken_where_a_floor_meets_whole_records_closely(
    monkeypatch: pytest.MonkeyPatch, effect: str, rms: float, taken: bool
) -> None:
    """compliant_base-68001: 71 more in the swings, where 66 were borne, and whole records met to 1.01 times noise."""
    leans, full = SimpleNamespace(chi2=900.0, model="leans"), SimpleNamespace(chi2=500.0, rms=rms, model="full")
    for name, stub in {
        "fit_records": lambda *_, **__: leans,
        "drawn_out": lambda *_: full,
        "all_at_once": lambda *_: full,
        "weighed_under": lambda *_: [],
        "still_fits": lambda *_: False,
    }.items():
        monkeypatch.setattr(whole_fits, name, stub)
    setup: Any = SimpleNamespace(simulator=None, by_rotation=True, whole=[])
    parameters = (SimpleNamespace(name="learned_memory.first"),) if effect == "learned_memory" else ()
    swings = SimpleNamespace(get={"learned_memory.least_speed": 0.0}.get)
    parts = (SimpleNamespace(parameters=parameters),)
    trial: Any = Some(Swing(swings), parts, costly=effect == "a floor", effects=(effect,))
    assert whole_fits.whole_fit(setup, trial) is (full if taken else leans)


@pytest.mark.parametrize(
    ("coefficients", "slips", "worse", "left", "borne"),
    [
        # A brake on one side: curves that met whole records left 230 and 353 more of 19,911 and 19,904 of the swings.
        (17, False, 353.0, 1.013, True),
        (17, False, 353.0, 1.04, False),
        (17, True, 353.0, 1.013, False),  # of a block that slips it is a median, and says nothing of many of them
        (4, False, 353.0, 1.013, False),
        (4, False, 228.0, 1.04, True),
    ],
)
def test_swings_bear_of_a_curve_what_leaves_no_structure_in_them(
    monkeypatch: pytest.MonkeyPatch, coefficients: int, slips: bool, worse: float, left: float, borne: bool
) -> None:
    def over_noise(setup: Any, trial: Any) -> float:
        # The coefficients are no less free for having been fitted elsewhere.
        return left if trial.swing.model == "there" and trial.swing.parameters == own else 1.0

    there: Any = Fit("there", (), (), 19904.0 + worse, 1.0, 20124, True, ())  # type: ignore[arg-type]
    monkeypatch.setattr(whole_fits, "fit", lambda *_, **__: there)
    monkeypatch.setattr(whole_fits, "over_noise", over_noise)
    monkeypatch.setattr(whole_fits, "structure", lambda setup: 1.03)
    setup: Any = SimpleNamespace(simulator=None)
    own = ("one",) * coefficients
    swing: Any = SimpleNamespace(model="here", chi2=19904.0, windows=(), parameters=own)
    trial: Any = Some(swing, parts=(SimpleNamespace(parameters=own, slips=slips, effect="learned_damping"),))
    assert whole_fits.still_fits(setup, trial, "whole") is borne  # type: ignore[arg-type]


def test_a_record_of_few_samples_has_no_beginning_to_fit() -> None:
    short = replace(record(1.0), times=np.arange(400) * 1e-3)
    assert list(whole_fits.beginnings([record(1.0), short], 0.04)) == []
    parts = whole_fits.beginnings([record(1.0), short.until(0.05)], 0.1)
    assert list(parts) == [0] and parts[0].times[-1] <= 0.1 * 3.99 + 1e-12
