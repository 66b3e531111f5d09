"""Between two edges of a motion every solver looks at the base a little within, as `recording.inner_limits` says."""

import math
from types import SimpleNamespace
from typing import Any

import jax
import jax.numpy as jnp
import pytest

from rocking.solvers.diffrax.loop import _physics
from rocking.solvers.recording import EDGE, inner_limits

CASES = [(0.0, 1.0, 0.25), (3.0, 3.5, math.inf), (3600.0, 3600.25, 0.01), (-2.0, -1.0, 1e-3), (1.0, 1.0 + 1e-12, 5.0)]


@pytest.mark.parametrize(("start", "stop", "longest"), CASES)
def test_limits_lie_within_by_a_share_of_the_longest_step(start: float, stop: float, longest: float) -> None:
    low, high = inner_limits(start, stop, longest)
    assert start < low <= high < stop
    share = EDGE * longest if longest < math.inf else 0.0
    if share < 0.25 * (stop - start):
        # 4 ulp: the rounding of a time.
        assert low - start == pytest.approx(max(share, math.ulp(start)), abs=4.0 * math.ulp(start))
        assert stop - high == pytest.approx(max(share, math.ulp(stop)), abs=4.0 * math.ulp(stop))


@pytest.mark.parametrize(("start", "stop", "longest"), CASES)
def test_the_limits_of_diffrax_are_those_of_the_others(start: float, stop: float, longest: float) -> None:
    with jax.enable_x64(True):
        edges = jnp.asarray([start - 1.0, start, stop, stop + 1.0])
        inputs: Any = SimpleNamespace(edges=edges, max_step=jnp.asarray(longest), par=None, motion_par=None)
        model: Any = None
        physics, end = _physics(model, inputs, 1)
        assert (float(physics.low), float(physics.high)) == inner_limits(start, stop, longest)
        assert float(end) == stop
