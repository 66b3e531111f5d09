"""Blocks from a millimetre to a hundred metres and from needles to slabs: right, and never an answer that is no number.

Above b/h = sqrt(2) Housner's ratio is below zero: momentum about the new corner then points back, the floor would have
to pull at the old one, and so the block lands on both and stops, or jumps where the corners bounce.
"""

import math
from typing import Any

import mpmath
import numpy as np
import pytest

from excitation import PiecewiseLinear, RampedSinusoid, SteadySinusoid
from rocking import Block, Method1, Method2, Mode, Outcome, solve, solve_batch
from rocking.effects.rounded_edges import RoundedEdges
from rocking.solvers import available, load

G = 9.81
RATIOS = [0.02, 0.1, 0.5, 1.0, 1.41, 1.5, 2.5, 5.0]
SIZES = [1e-3, 1.0, 100.0]
SHARP = {"rtol": 1e-12, "atol": 1e-15}


def block_of(ratio: float, size: float) -> Block:
    """The block of this b/h whose longer side is `size` [m]."""
    return Block(size * min(1.0, ratio), size * min(1.0, 1.0 / ratio))


def time_down(block: Block, share: float) -> float:
    """Time [s] from release at a share of alpha to upright, of the nonlinear block: quadrature of its energy."""
    alpha = math.atan2(block.b, block.h)
    p2 = 0.75 * G / (0.5 * math.hypot(block.b, block.h))
    top = share * alpha

    # theta = top (1 - w^2) takes the root at the release away; a difference of cosines as a product loses nothing.
    def slowness(w: Any) -> Any:
        theta = top * (1 - w * w)
        rise = 2 * mpmath.sin(alpha - 0.5 * (theta + top)) * mpmath.sin(0.5 * top * w * w)
        return 2 * top * w / mpmath.sqrt(2 * p2 * rise) if w else 2 * mpmath.sqrt(top / (p2 * mpmath.sin(alpha - top)))

    with mpmath.workdps(30):
        return float(mpmath.quad(slowness, [0, 1]))


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize(
    ("method", "solver"),
    [("method1", "numba"), ("method1", "scipy"), ("method1", "taylor"), ("method2", "numba"), ("method2", "scipy")],
)
def test_a_released_block_lands_when_its_energy_says(ratio: float, size: float, solver: str, method: str) -> None:
    block = block_of(ratio, size)
    system: Any = Method1(block, g=G) if method == "method1" else Method2(block, friction=math.inf, g=G)
    down = time_down(block, 0.5)
    run = solve(system, theta=0.5 * block.alpha, t_end=4.0 * down, solver=solver, **SHARP)
    # As of the solvers: to 1e-8 s, and to that share of the time where a swing takes less than a second.
    assert run.impact_times[0] == pytest.approx(down, rel=1e-8)
    assert np.all(np.isfinite(run.y)) and run.outcome in (Outcome.MOVING, Outcome.AT_REST)
    e = max(0.0, 1.0 - 1.5 * math.sin(block.alpha) ** 2)
    events, first = run.events, int(np.searchsorted(run.events.t, run.impact_times[0]))
    assert events.y_after[first, -1] == pytest.approx(e * events.y_before[first, -1], rel=1e-9, abs=0.0)
    assert (events.mode_after[first] == Mode.REST) == (e == 0.0)


# Froude's similitude, from a metre to both ends: the same history in another time, for sliding and bouncing blocks too.
# chatter_time, the one duration among the parameters, is scaled with all others.
@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("size", [1e-3, 100.0])
@pytest.mark.parametrize("e_n", [0.0, 0.3])
def test_a_shaken_block_of_any_size_moves_alike(ratio: float, size: float, e_n: float) -> None:
    runs = []
    for length in (1.0, size):
        block = block_of(ratio, length)
        p = block.p(G)
        system = Method2(block, friction=0.4, normal_restitution=e_n, g=G, chatter_time=1e-3 / p)
        motion = SteadySinusoid(0.4 * p / (2.0 * math.pi), 1.3 * G * min(0.4, ratio), 20.0 / p)
        runs.append(solve(system, motion, theta=0.3 * block.alpha, t_end=3.0 / p, **SHARP))
    one, other = runs
    count = min(4, len(one.events))
    assert count > 0
    np.testing.assert_array_equal(one.events.mode_after[:count], other.events.mode_after[:count])
    times = other.events.t[:count] / math.sqrt(size)
    np.testing.assert_allclose(times, one.events.t[:count], rtol=1e-7)
    assert np.all(np.isfinite(one.y)) and np.all(np.isfinite(other.y))
    assert other.outcome is not Outcome.FAILED


# With e = 0 every impact is the last one or the first of a swing to either side; all solvers find the same.
@pytest.mark.parametrize("ratio", [1.5, 2.5, 5.0])
@pytest.mark.parametrize("form", ["nonlinear", "linear"])
def test_a_slab_under_shaking_stops_at_each_impact_by_every_solver(ratio: float, form: Any) -> None:
    block = block_of(ratio, 1.0)
    system, p = Method1(block, form=form, onset="west" if form == "nonlinear" else "linear", g=G), block.p(G)
    assert system.e == 0.0
    motion = RampedSinusoid(4.0 * p / (2.0 * math.pi), 6.0 / p, 2.5 * system.parameters.onset * G)
    reference = solve(system, motion, t_end=8.0 / p, solver="scipy", **SHARP)
    assert reference.impact_times.size >= 3
    for solver in available():
        if solver == "diffrax" or load(solver).declines(system, motion):
            continue
        run = solve(system, motion, t_end=8.0 / p, solver=solver, **SHARP)
        np.testing.assert_allclose(run.impact_times, reference.impact_times, rtol=0.0, atol=1e-8)
        landed = np.isin(run.events.t, run.impact_times)
        np.testing.assert_array_equal(run.events.y_after[landed, 1], 0.0)
    for solver in ("numba", "taylor"):
        batch = solve_batch([system] * 3, [motion] * 3, t_end=8.0 / p, solver=solver)
        assert batch.impacts.tolist() == [reference.impact_times.size] * 3
        np.testing.assert_allclose(batch.peak_rotation, reference.peak_rotation, rtol=1e-6)


def test_a_slab_on_a_record_ends_by_the_batch_as_alone() -> None:
    rng = np.random.default_rng(5)
    motion = PiecewiseLinear(0.02, 40.0 * np.convolve(rng.standard_normal(400), np.ones(4) / 4.0))
    system = Method1(Block(1.6, 1.0), g=G)
    runs = [solve(system, motion, t_end=9.0, solver=s, **SHARP) for s in ("scipy", "numba", "taylor")]
    assert runs[0].impact_times.size > 5 and not runs[0].overturned
    for run in runs[1:]:
        np.testing.assert_allclose(run.impact_times[:5], runs[0].impact_times[:5], rtol=0.0, atol=1e-8)
    batch = solve_batch(system, [motion], t_end=9.0, solver="taylor")
    assert batch.impacts.tolist() == [runs[2].impact_times.size]


# The restitution that a slab has by each of the ways to it: never below zero, and never a refusal.
def test_no_way_to_a_slab_has_a_restitution_below_zero() -> None:
    slab = Block(5.0, 1.0)
    assert slab.housner_restitution < 0.0
    assert Method1(slab).parameters.e == 0.0
    run = solve(Method1(slab), theta=0.1, t_end=5.0, effects=[RoundedEdges(radius=0.01)])
    assert run.outcome is Outcome.AT_REST and run.impact_times.size == 1
    # An impact that both corners share may keep from nothing to all of the speed.
    kept = Method2(slab, friction=1.0, impact_law="two_corner", restitution=0.0)
    assert solve(kept, theta=0.1, t_end=5.0).outcome is Outcome.AT_REST
    with pytest.raises(ValueError, match=r"restitution=-0.1: want 0 to 1"):
        Method2(slab, friction=1.0, impact_law="two_corner", restitution=-0.1)


# A slab on corners that bounce leaves the floor, or turns back on its old corner; then it comes to rest.
@pytest.mark.parametrize("friction", [0.1, 0.8])
@pytest.mark.parametrize("size", SIZES)
def test_a_slab_that_bounces_jumps_and_comes_to_rest(friction: float, size: float) -> None:
    block = block_of(2.5, size)
    system = Method2(block, friction, normal_restitution=0.5, g=G, chatter_time=1e-3 / block.p(G))
    run = solve(system, theta=0.2 * block.alpha, t_end=20.0 / block.p(G))
    assert run.outcome is Outcome.AT_REST, run.reason
    assert run.impact_times.size > 1
    assert np.all(np.isfinite(run.y))
