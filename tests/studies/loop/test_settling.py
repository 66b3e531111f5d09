"""How long whole records are believed, and how far estimates that disagree widen an interval."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from studies.campaigns import Channel
from studies.loop.fitting import Parameter
from studies.loop.settling import FEWEST_SAMPLES, PREDICTABLE, _disagreement, predictable
from studies.loop.windows import Window


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
