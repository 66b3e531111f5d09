"""How long whole records are believed, and how far estimates that disagree widen an interval."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from studies.campaigns import Channel
from studies.loop.models.parameters import Parameter
from studies.loop.observed.windows import Window
from studies.loop.whole import remaining, settling
from studies.loop.whole.remaining import missed
from studies.loop.whole.settling import (
    FEWEST_SAMPLES,
    PREDICTABLE,
    _apart,
    _disagreement,
    _explains_most,
    _joined,
    _spoilt,
    _together,
    intervals,
    predictable,
)


def window(growth: float, samples: int = 400) -> Window:
    """A record whose deviation by base noise grows exponentially, in units of the sensor's."""
    t, noise = np.arange(samples) * 0.01, np.full(samples, 2e-4)
    return Window(
        0, 0, 0.0, t, np.arange(samples), (Channel("rotation", "rotation", 2e-4),), np.arange(samples),
        np.zeros(samples), noise, 0.1, 0.0, 0.0, 0.0, sd=noise * np.hypot(1.0, 1e-3 * np.exp(growth * t)),
    )  # fmt: skip


def test_a_record_is_believed_until_base_noise_outweighs_the_sensor() -> None:
    [short] = predictable([window(4.0)])
    # hypot(1, x) = 2 at x = sqrt(3): by hand t = ln(1000 sqrt(3)) / 4.
    assert PREDICTABLE == 2.0
    assert short.times[-1] == pytest.approx(np.log(1e3 * np.sqrt(3.0)) / 4.0, abs=0.011)
    assert short.data.size == short.times.size == short.weights.size


# A rotation that is never lost and an accelerometer, which feels the base at once, that is lost from 2.5 s on: the data
# are stacked channel by channel, and the first lost one in time counts.
@pytest.mark.parametrize("order", [1, -1])
def test_the_first_channel_that_is_lost_ends_a_record(order: int) -> None:
    t, n = np.arange(400) * 0.01, 400
    channels = (Channel("rotation", "rotation", 2e-4), Channel("top", "block_acceleration", 0.01))
    lost = np.where(t < 2.5, 0.0, 1.0)
    noise, felt = (np.repeat(pair, n) for pair in ((2e-4, 0.01)[::order], (0.0, 0.05)[::order]))
    motion = np.concatenate([0.0 * t, lost][::order])
    w = Window(
        0, 0, 0.0, t, np.arange(n), channels[::order], np.arange(2 * n), np.zeros(2 * n), noise, 0.1, 0.0, 0.0, 0.0,
        sd=np.sqrt(noise**2 + felt**2 + motion**2), felt=felt,
    )  # fmt: skip
    [short] = predictable([w])
    assert short.times[-1] == pytest.approx(2.5, abs=0.011)
    assert short.felt is not None and short.felt.size == short.data.size == 2 * short.times.size


def test_a_record_without_base_noise_is_believed_whole_and_a_stump_is_left_out() -> None:
    assert predictable([window(0.0)])[0].times.size == 400
    assert predictable([window(60.0)]) == []
    assert predictable([window(0.0, FEWEST_SAMPLES - 1)]) == []


def estimate(values: dict[str, float]) -> Any:
    parameters = tuple(Parameter(name, 1.0) for name in values)
    return SimpleNamespace(parameters=parameters, model=SimpleNamespace(get=values.__getitem__))


def test_estimates_that_disagree_widen_the_interval_by_their_birge_ratio() -> None:
    one, two = estimate({"a": 1.0, "b": 5.0}), estimate({"a": 1.6, "b": 5.0})
    covariances = [np.diag([0.01, 1.0]), np.diag([0.03, 1.0])]
    # 0.6 apart with a variance of 0.04: 9, over two parameters.
    assert _disagreement([one, two], covariances) == pytest.approx(4.5)
    assert _disagreement([one, one], covariances) == 1.0
    assert _disagreement([one], covariances[:1]) == 1.0
    assert _disagreement([one, estimate({"a": 9.0})], [covariances[0], np.eye(1)]) == 1.0


def test_estimates_of_a_logarithm_are_joined_and_bounded_as_logarithms() -> None:
    """By hand: deviations of log 4 about 1 and of log 2 about 32 weigh 1 to 4, so that 16 comes out."""
    k = Parameter("k", 0.5, 0.05, 100.0, True)
    fits: Any = [SimpleNamespace(parameters=(k,), model=SimpleNamespace(get={"k": v}.__getitem__)) for v in (1.0, 32.0)]
    # Of the outer scale: the value times that of the logarithm.
    covariances = [np.array([[(v * np.log(r)) ** 2]]) for v, r in ((1.0, 4.0), (32.0, 2.0))]
    both, covariance = _joined(("k",), fits, covariances)
    assert k.outer(float(both[0])) == pytest.approx(16.0)
    sd = 0.5 * float(np.sqrt(covariance[0, 0]))
    assert sd == pytest.approx(np.log(2.0) / np.sqrt(1.25))
    assert _disagreement(fits, covariances) == pytest.approx(np.log(32.0) ** 2 / (np.log(4.0) ** 2 + np.log(2.0) ** 2))
    chosen: Any = SimpleNamespace(swing=fits[0], every=(k,))
    settled: Any = SimpleNamespace(whole=fits[1], names=("k",), covariance=np.array([[(32.0 * sd) ** 2]]))
    value, low, high = intervals(chosen, settled)["k"]
    assert (value, low) == (32.0, pytest.approx(32.0 * np.exp(-1.96 * sd)))
    assert high == k.high  # 32 exp(1.96 sd) lies beyond


def test_another_minimum_nearly_as_deep_widens_the_interval_to_reach_it() -> None:
    def minimum(value: float, chi2: float) -> Any:
        found = estimate({"a": value})
        found.chi2 = chi2
        return found

    best, sensor, covariance = minimum(1.0, 900.0), np.array([[1e-4]]), np.array([[4e-4]])
    # As deep: the mean of the squares of 0 and 0.5. With all noise 4 times that of the sensor, 8 in chi-square are 2.
    together = _together(sensor, covariance)
    assert together == pytest.approx(4.0) and _together(covariance, sensor) == 1.0
    assert _apart([best, minimum(1.5, 900.0)], together, covariance)[0, 0] == pytest.approx(0.125)
    share = np.exp(-1.0) / (1.0 + np.exp(-1.0))
    assert _apart([best, minimum(1.5, 908.0)], together, covariance)[0, 0] == pytest.approx(0.25 * share)
    # The same one found again says nothing more; one that is far worse is none.
    assert _apart([best, minimum(1.01, 900.0), minimum(1.5, 1900.0)], together, covariance)[0, 0] == pytest.approx(
        0.0, abs=1e-50
    )


def test_one_lost_record_makes_no_campaign_unexplained(monkeypatch: pytest.MonkeyPatch) -> None:
    def lost(*rms: float, moved: float = 1.0) -> bool:
        """Moved: how far the noise of the base moves each record now and then."""
        values = np.array(rms)
        monkeypatch.setattr(remaining, "_moved", lambda setup, whole, far: np.full(far.sum(), moved))
        found: Any = SimpleNamespace(rms=float(np.sqrt(np.mean(values**2))), by_window=values)
        return missed(SimpleNamespace(), found)  # type: ignore[arg-type]

    # An impact that hangs on the noise of the base loses a record; what acts on a block acts in more than one.
    assert not lost(1.0, 1.1, 0.9, 30.0)
    assert lost(1.0, 1.1, 8.0, 30.0)
    assert not lost(1.0, 2.0, 2.9, 2.9)
    assert lost(8.0)  # of one record there is no other to ask
    # A clean block was called unexplained by two records of which redrawn noise moves its own response further.
    assert not lost(1.0, 1.0, 3.9, 0.7, 7.5, 0.6, moved=14.0)
    assert not lost(1.0, 1.1, 8.0, 30.0, moved=9.0)
    assert lost(1.0, 1.1, 9.5, 30.0, moved=9.0)


@pytest.mark.parametrize(
    ("both", "swings", "spoilt"),
    [(1000.0, 0.0, False), (1150.0, 0.0, False), (1160.0, 0.0, True), (1160.0, 1011.0, False)],
)
def test_estimates_put_together_are_refused_where_they_explain_far_less_than_either(
    monkeypatch: pytest.MonkeyPatch, both: float, swings: float, spoilt: bool
) -> None:
    """By hand: sixty times a mean square of 2.5 are 150 in chi-square, over the 1000 that whole records leave."""
    asked = []

    def leans_alone(simulator: Any, model: Any, parameters: Any, windows: Any, iterations: int) -> Any:
        asked.append((model, parameters, windows))
        return SimpleNamespace(chi2={"both": both, "swings": swings}[model])

    monkeypatch.setattr(settling, "fit_records", leans_alone)
    best: Any = SimpleNamespace(chi2=1000.0, spread=2.5, windows=("w",))
    setup: Any = SimpleNamespace(simulator=None)
    models: Any = ("both", "swings")
    assert _spoilt(setup, *models, best) is spoilt
    assert asked == [("both", [], ("w",)), ("swings", [], ("w",))]


class Model(SimpleNamespace):
    """Numbers by name."""

    def get(self, name: str) -> float:
        return float(getattr(self, name))

    def changed(self, values: dict[str, float]) -> Any:
        return Model(**(vars(self) | values))


@pytest.mark.parametrize("why", ["together they explain less", "other minima are as deep"])
@pytest.mark.parametrize(("refused", "value"), [(True, 2.0), (False, 2.6)])
def test_where_estimates_do_not_go_together_the_minimum_counts_that_swings_bear(
    monkeypatch: pytest.MonkeyPatch, why: str, refused: bool, value: float
) -> None:
    """By hand: 0.6 apart in k, with variances of 0.01 and 0.03 and c alike, are a Birge ratio squared of 9 over 2."""
    k, c = Parameter("k", 1.0), Parameter("c", 1.0)

    def at(number: float, *parameters: Parameter) -> Any:
        model = Model(k=number, c=5.0)
        values = {p.name: model.get(p.name) for p in parameters}
        return SimpleNamespace(model=model, parameters=parameters, values=values, windows=(), chi2=900.0)

    swing, minimum = at(2.0, c, k), at(2.6, c, k)
    trial: Any = SimpleNamespace(swing=swing, every=(c, k), costly=True, parts=())
    setup: Any = SimpleNamespace(by_rotation=True, simulator=None, noisy=None)
    covariances = {id(swing): np.diag([0.04, 0.01]), id(minimum): np.diag([0.09, 0.03])}
    deep = why == "other minima are as deep"
    asked = []

    def bears(setup: Any, trial: Any, model: Any) -> bool:
        asked.append(model)
        return not refused

    monkeypatch.setattr(settling, "_while_predictable", lambda *_: [minimum, at(9.0, c, k)] if deep else [minimum])
    monkeypatch.setattr(settling, "_apart", lambda *_: np.diag([0.0, 0.5]))
    monkeypatch.setattr(settling, "_together", lambda *_: 1.0)
    monkeypatch.setattr(settling, "sensor_covariance", lambda *_: None)
    monkeypatch.setattr(settling, "robust_covariance", lambda _, __, f: covariances[id(f)])
    monkeypatch.setattr(settling, "_spoilt", lambda *_: not deep)
    monkeypatch.setattr(settling, "still_fits", bears)
    monkeypatch.setattr(settling, "fit_records", lambda simulator, model, *_, **__: SimpleNamespace(model=model))
    found = settling.settle(setup, trial, at(2.3))
    assert asked == [minimum.model] and found.names == ("c", "k")
    assert found.whole.model.get("k") == value
    expected = 0.01 if refused else 0.53 if deep else 0.03
    birge = max(1.0, 0.6**2 / (0.01 + (0.53 if deep else 0.03)) / 2.0)
    assert found.covariance[1, 1] == pytest.approx(birge * expected)
    assert found.covariance[0, 0] == pytest.approx(birge * (0.04 if refused else 0.09))


@pytest.mark.parametrize(
    ("of_swings", "of_records", "expected"),
    [
        # Numbers of a block of 24 cm whose table also moves up and down: few impacts are predictable. The best minimum
        # of whole records, by 1 in chi-square, lies 75 standard deviations of the swings off.
        (((0.8621, 1.7e-4), (0.1684, 1.6e-3)), (((0.8753, 0.1675), (0.851, 0.1675)), (7.6e-3, 2.5e-3)), 0.8621),
        # Swings say little: what lies between two sharp minima of whole records is explained by neither.
        (((0.861, 0.02), (0.1684, 1.6e-3)), (((0.8753, 0.1675), (0.851, 0.1675)), (3e-4, 2.5e-3)), 0.8753),
    ],
)
def test_between_minima_of_whole_records_that_swings_refuse_swings_decide(
    monkeypatch: pytest.MonkeyPatch, of_swings: Any, of_records: Any, expected: float
) -> None:
    e, r = Parameter("e", 0.01), Parameter("r", 0.01)

    def at(*numbers: float, chi2: float) -> Any:
        model = Model(**dict(zip("er", numbers, strict=True)))
        return SimpleNamespace(model=model, parameters=(e, r), windows="records", chi2=chi2)

    def off(model: Any, numbers: Any, sds: Any) -> float:
        return sum(((model.get(n) - v) / sd) ** 2 for n, v, sd in zip("er", numbers, sds, strict=True))

    def left(simulator: Any, model: Any, parameters: Any, windows: str, **_: Any) -> Any:
        (values, own), (places, sds) = zip(*of_swings, strict=True), of_records
        chi2 = {
            "swings": 6134.0 + off(model, values, own),
            "records": 2579.5 + min(float(k) + off(model, place, sds) for k, place in enumerate(places)),
        }
        return SimpleNamespace(model=model, chi2=chi2[windows])

    swing = at(*(value for value, _ in of_swings), chi2=6134.0)
    swing.windows = "swings"
    minima = [at(*place, chi2=2579.5 + k) for k, place in enumerate(of_records[0])]
    sure = {id(swing): np.diag([sd**2 for _, sd in of_swings])}
    trial: Any = SimpleNamespace(swing=swing, every=(e, r), costly=False, parts=())
    setup: Any = SimpleNamespace(by_rotation=True, simulator=None, noisy=None)
    covariance = np.diag(np.square(of_records[1]))
    monkeypatch.setattr(settling, "_while_predictable", lambda *_: minima)
    monkeypatch.setattr(settling, "sensor_covariance", lambda *_: covariance)
    monkeypatch.setattr(settling, "robust_covariance", lambda _, __, f: sure.get(id(f), covariance))
    monkeypatch.setattr(settling, "fit", left)
    monkeypatch.setattr(settling, "fit_records", left)
    found = settling.settle(setup, trial, at(0.9, 0.2, chi2=0.0))
    assert found.whole.model.get("e") == pytest.approx(expected, abs=3e-4)
    # Of the other one both say the same.
    assert found.whole.model.get("r") == pytest.approx(0.168, abs=1e-3)
    # The interval reaches the other minimum still where swings do not rule it out.
    assert bool(found.covariance[0, 0] ** 0.5 > 5e-3) is (expected != 0.8621)


@pytest.mark.parametrize(("together", "expected"), [(1.0, 4.377e-3), (526.0, 4.482e-3)])
def test_a_minimum_of_whole_records_counts_by_the_noise_of_the_base(
    monkeypatch: pytest.MonkeyPatch, together: float, expected: float
) -> None:
    """A campaign whose floor falls by 4.5 mrad: whole records, the longest above all, are better met at 4.377 mrad by
    673 in chi-square, as if the base had moved each sample by itself.  With all noise the covariance was 526 times that
    with the sensor's alone; swings say 4.490 mrad with a deviation of 0.018."""

    def left(simulator: Any, model: Any, parameters: Any, windows: str, **_: Any) -> Any:
        tilt = model.get("tilt")
        swings, records = ((tilt - 4.490e-3) / 1.84e-5) ** 2, 673.0 * ((tilt - 4.377e-3) / 0.123e-3) ** 2
        return SimpleNamespace(chi2=5638.5 + swings if windows == "swings" else 9651.0 + records)

    monkeypatch.setattr(settling, "fit", left)
    monkeypatch.setattr(settling, "fit_records", left)
    trial: Any = SimpleNamespace(swing=SimpleNamespace(windows="swings"))
    best: Any = SimpleNamespace(model=Model(tilt=4.377e-3), windows="records")
    found = [{"tilt": value} for value in (4.482e-3, 4.377e-3, 4.526e-3)]
    setup: Any = SimpleNamespace(simulator=None)
    assert _explains_most(setup, trial, best, together, found) == {"tilt": expected}


def test_what_an_estimate_does_not_show_is_as_wide_as_the_others_say() -> None:
    one, two = estimate({"a": 1.0, "b": 5.0, "c": 7.0}), estimate({"a": 1.6, "b": 5.5, "c": 7.0})
    covariances = [np.diag([0.01, 0.0, 0.0]), np.diag([0.01, 0.2, 0.0])]
    values, joint = _joined(("a", "b", "c"), [one, two], covariances)
    # Of c neither says anything: it stays, and its interval has no end.
    np.testing.assert_allclose(values, [1.3, 5.5, 7.0])
    np.testing.assert_allclose(np.diag(joint), [0.005, 0.2, np.inf])
    alone = settling._in_its_place(("a", "b", "c"), joint, one, covariances[0])
    np.testing.assert_allclose(np.diag(alone), [0.01, 0.2, np.inf])


def test_what_is_taken_for_known_widens_the_interval_by_how_far_it_carries_the_estimate(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Swings refitted with the other value of what was assumed: as far apart as that is, one standard deviation."""
    asked = []

    def fit(simulator: Any, model: Any, parameters: Any, windows: Any, **how: Any) -> Any:
        asked.append((model.get("grip"), how["iterations"]))
        return SimpleNamespace(model=model.changed({"k": 3.0, "c": 4.8}))

    monkeypatch.setattr(settling, "fit", fit)
    parts = (SimpleNamespace(assumed={}), SimpleNamespace(assumed={"grip": 1.0}))
    swing = SimpleNamespace(model=Model(k=2.0, c=5.0, grip=2.0), windows=())
    trial: Any = SimpleNamespace(swing=swing, parts=parts, every=(Parameter("c", 1.0), Parameter("k", 1.0)))
    added = settling._by_what_is_assumed(SimpleNamespace(simulator=None), trial)  # type: ignore[arg-type]
    np.testing.assert_allclose(added, [[0.04, -0.2], [-0.2, 1.0]], atol=1e-12)
    assert asked == [(1.0, settling.FURTHER_COSTLY)]
