"""Between two edges of a motion every solver looks at the base a little within, as `recording.inner_limits` says."""

import math
from types import SimpleNamespace
from typing import Any

import jax
import jax.numpy as jnp
import pytest

from rocking.solvers.diffrax.loop import _next_length, _physics
from rocking.solvers.diffrax.steps import ERROR_ORDER, SHARE_TOLERANCE, Bracket, _narrower, fall_through_zero
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


# Hairer, Norsett & Wanner (1993), sec. II.4: h times 0.9 size^(-1/order), by no more than 5 and no less than 0.2.
@pytest.mark.parametrize(
    ("tried", "size", "cut_short", "expected"),
    [
        (0.1, 0.5, False, 0.1 * 0.9 * 0.5 ** (-1.0 / ERROR_ORDER)),
        (0.1, 1e-9, False, 0.5),
        (0.1, 2.0, True, 0.1 * 0.9 * 2.0 ** (-1.0 / ERROR_ORDER)),  # refused, so the edge is not what shortened it
        (0.1, 1e30, False, 0.02),
        (0.1, math.inf, False, 0.02),
        (1e-6, 1e-9, True, 0.3),  # an edge came after a microsecond: the length before it is kept
        (0.2, 1e-9, True, 1.0),
    ],
)
def test_a_step_cut_short_by_an_edge_does_not_shorten_the_next(
    tried: float, size: float, cut_short: bool, expected: float
) -> None:
    with jax.enable_x64(True):
        next_h = _next_length(jnp.asarray(0.3), jnp.asarray(tried), jnp.asarray(size), jnp.asarray(cut_short))
    assert float(next_h) == pytest.approx(expected, rel=1e-12)


# A guard counts as fallen where it no longer is positive: that side of the zero, which lies at 0.3.
def test_the_share_of_a_fall_through_zero_is_past_it() -> None:
    def guard(share: Any) -> Any:
        return jnp.cos(share + 0.5 * math.pi - 0.3)

    with jax.enable_x64(True):
        low, high = jnp.asarray(0.0), jnp.asarray(1.0)
        share = float(fall_through_zero(guard, jnp.asarray(True), low, guard(low), high, guard(high)))
        assert float(guard(share)) <= 0.0 and 0.3 <= share < 0.3 + 2.0 * SHARE_TOLERANCE
        # Below zero at the low end already: it fell there, not at the high end.
        there = fall_through_zero(guard, jnp.asarray(True), jnp.asarray(0.5), guard(0.5), high, guard(high))
        assert float(there) == 0.5


# Illinois method, Dowell & Jarratt (1971), BIT 11, 168-174: the value at an end that stays twice running is halved.
# By hand: from 1 at 0 and -0.6 at 1 the secant meets zero at 0.625.
@pytest.mark.parametrize(
    ("moved", "there", "expected"),
    [
        (-1, 0.8, (0.625, 0.8, 1.0, -0.3, -1)),
        (1, 0.8, (0.625, 0.8, 1.0, -0.6, -1)),
        (1, -0.2, (0.0, 0.5, 0.625, -0.2, 1)),
        (-1, -0.2, (0.0, 1.0, 0.625, -0.2, 1)),
    ],
)
def test_an_end_that_stays_twice_counts_for_half(moved: int, there: float, expected: tuple[float, ...]) -> None:
    asked = []

    def guard(share: Any) -> Any:
        asked.append(float(share))
        return jnp.asarray(there)

    with jax.enable_x64(True):
        after = _narrower(guard, Bracket(*map(jnp.asarray, (0.0, 1.0, 1.0, -0.6, False, moved, 3))))
    assert asked == [pytest.approx(0.625)]
    got = [float(value) for value in (after.low, after.at_low, after.high, after.at_high, after.moved)]
    assert got == pytest.approx(expected) and int(after.tries) == 4
