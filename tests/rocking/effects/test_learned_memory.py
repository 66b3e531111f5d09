"""Impacts that remember those before, by hand from impact to impact (rocking.remembering)."""

import math

import numpy as np
import pytest

from excitation import PiecewiseLinear
from rocking import Block, Method1, solve
from rocking import scalars as math_of_floats
from rocking.composed import IMPACT
from rocking.effects import compose, load
from rocking.hybrid import ROTATION, Base
from rocking.remembering import LONG_AGO

BLOCK = Block(b=0.2, h=0.8)
E = 0.9
MEMORY = {"first": -0.06, "first_impacts": 3.0, "recent": -0.04, "recent_time": 0.25}
WEAR = {"worn": 0.05, "worn_use": 2.0, "worn_exponent": 2.0, "used": 0.7}


def ratios(run):
    """(time, omega after over omega before) of the impacts of a run."""
    column, hits = run.system.state_names.index("omega"), run.events.guard == IMPACT
    events = run.events
    hits &= events.mode_after == ROTATION  # after the last one it rests
    return list(zip(events.t[hits], events.y_after[hits, column] / events.y_before[hits, column], strict=True))


@pytest.mark.parametrize("solver", ["numba", "scipy"])
def test_each_impact_has_the_restitution_of_the_formula(solver: str) -> None:
    effect = load("learned_memory")(**MEMORY)
    run = solve(Method1(BLOCK, restitution=E), theta=0.2, t_end=4.0, effects=[effect], solver=solver)
    seen, last = ratios(run), -LONG_AGO
    assert len(seen) > 8
    for n, (t, ratio) in enumerate(seen):
        more = MEMORY["first"] * math.exp(-n / 3.0) + MEMORY["recent"] * math.exp(-(t - last) / 0.25)
        assert ratio == pytest.approx(E + more, abs=1e-9)
        last = t


@pytest.mark.parametrize("solver", ["numba", "scipy", pytest.param("diffrax", marks=pytest.mark.slow)])
def test_an_impact_heeds_how_the_base_is_accelerated(solver: str) -> None:
    """A base that goes to and fro: by its straight lines at the times of the impacts."""
    effect = load("learned_memory")(pushed=-0.02, shaken=0.01)
    nodes = np.tile([0.0, 2.0, 0.0, -2.0], 10)
    motion = PiecewiseLinear(0.1, nodes)
    run = solve(
        Method1(BLOCK, restitution=E), motion, theta=0.15, t_end=3.0, effects=[effect], solver=solver, save_at=[3.0]
    )
    hits = run.events.guard == IMPACT
    moves = run.events.mode_after[hits] == ROTATION
    t, before, after = run.events.t[hits], run.events.y_before[hits, 1], run.events.y_after[hits, 1]
    a_x = np.interp(t, 0.1 * np.arange(nodes.size), nodes)
    kept = E - 0.02 * np.sign(before) * a_x + 0.01 * np.abs(a_x)
    assert moves.sum() > 4 and np.ptp(kept) > 0.03
    np.testing.assert_allclose((after / before)[moves], kept[moves], rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("exponent", [0.0, 1.0, 2.0])
@pytest.mark.parametrize("solver", ["numba", "scipy", pytest.param("diffrax", marks=pytest.mark.slow)])
def test_a_block_wears_by_the_sum_of_powers_of_the_speeds_of_its_impacts(solver: str, exponent: float) -> None:
    effect = load("learned_memory")(**WEAR | {"worn_exponent": exponent}, least_speed=0.1)
    run = solve(
        Method1(BLOCK, restitution=E), theta=0.2, t_end=4.0, effects=[effect], solver=solver, save_at=[0.0, 4.0]
    )
    omega, use = (run.system.state_names.index(name) for name in ("omega", "use"))
    hits = run.events.guard == IMPACT
    speeds, spent = np.abs(run.events.y_before[hits, omega]), 0.7
    moves = run.events.mode_after[hits] == ROTATION
    assert np.sum(speeds > 0.1) > 5
    assert run.y[0, use] == 0.7
    for speed, after, on in zip(speeds, run.events.y_after[hits, omega], moves, strict=True):
        if on:  # after the last one it rests
            assert abs(after) / speed == pytest.approx(E + 0.05 * (1.0 - math.exp(-spent / 2.0)), abs=1e-9)
        spent += speed**exponent if speed > 0.1 else 0.0
    assert run.y[1, use] == pytest.approx(spent, rel=1e-12)


def test_memory_counts_impacts_and_time_through_rest() -> None:
    """A block that stands, is shaken and rocks: no impact before, and after each one the time since it."""
    system = compose(Method1(BLOCK, restitution=E), [load("learned_memory")(**MEMORY)])
    motion = PiecewiseLinear(0.1, [0.0, 5.0, -5.0, 0.0, 0.0])
    run = solve(system, motion, t_end=3.0, save_at=[0.0, 0.04, 3.0])
    impacts, pause = run.system.state_names.index("impacts"), run.system.state_names.index("pause")
    assert run.y[:2, impacts].tolist() == [0.0, 0.0]
    assert run.y[1, pause] == pytest.approx(LONG_AGO + 0.04)
    assert run.y[2, impacts] == len(run.impact_times) > 2
    assert run.y[2, pause] == pytest.approx(3.0 - run.impact_times[-1], abs=1e-9)


def test_without_depth_it_is_the_block_without_memory() -> None:
    damped = load("viscous_damping")(coefficient=0.2)
    times = np.linspace(0.0, 3.0, 31)
    plain = solve(Method1(BLOCK, restitution=E), theta=0.2, t_end=3.0, effects=[damped], save_at=times)
    both = [damped, load("learned_memory")(first_impacts=2.0)]
    other = solve(Method1(BLOCK, restitution=E), theta=0.2, t_end=3.0, effects=both, save_at=times)
    np.testing.assert_allclose(other.theta, plain.theta, rtol=0.0, atol=1e-8)


def test_a_window_begins_with_the_impacts_before_it() -> None:
    """Cut off after the third impact, the state is what is remembered of the impacts so far."""
    system = compose(Method1(BLOCK, restitution=E), [load("learned_memory")(**MEMORY)])
    whole = solve(system, theta=0.2, t_end=3.0, save_at=[3.0])
    hits = ratios(whole)
    start = 0.5 * (hits[2][0] + hits[3][0])
    at = solve(system, theta=0.2, t_end=start, save_at=[start]).y[0]
    y, q = system.initial_state(at[0], at[1], impacts=3.0, pause=start - hits[2][0], use=at[4])
    np.testing.assert_allclose(y, at, rtol=0.0, atol=1e-8)
    assert q.s == math.copysign(1.0, at[0])
    # It hangs on both: begun without them, the next impact would lose otherwise.
    k, base = IMPACT, Base(0.0, 0.0, 0.0, 0.0)
    lost = [
        system.jump(math_of_floats, (0.0, 1.0, *more), q, base, system.parameters, k)[0][1]
        for more in (y[2:], (0.0, LONG_AGO, 0.0))
    ]
    assert lost[0] == pytest.approx(E - 0.06 * math.exp(-1.0) - 0.04 * math.exp(-y[3] / 0.25), rel=1e-9)
    assert lost[1] == pytest.approx(E - 0.06, rel=1e-9)


def test_impacts_that_are_too_slow_are_not_counted() -> None:
    effect = load("learned_memory")(**MEMORY, least_speed=0.3)
    system = compose(Method1(BLOCK, restitution=E), [effect])
    run = solve(system, theta=0.2, t_end=6.0, save_at=[6.0])
    speeds = np.abs(run.events.y_before[run.events.guard == IMPACT, 1])
    assert run.y[0, 2] == np.sum(speeds > 0.3)
    assert 2 < np.sum(speeds > 0.3) < speeds.size - 2


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"first": 1.5}, r"learned_memory.first=1.5 1: want -1 to 1"),
        ({"recent_time": 0.0}, r"learned_memory.recent_time=0.0 s: want 0.0001 to 10000"),
        ({"worn": -2.0}, r"learned_memory.worn=-2.0 1: want -1 to 1"),
        ({"used": -1.0}, r"learned_memory.used=-1.0 \(rad/s\)\^worn_exponent: want 0 to 1e\+12"),
        ({"worn_exponent": 5.0}, r"learned_memory.worn_exponent=5.0 1: want 0 to 4"),
    ],
)
def test_what_is_no_memory_is_refused(given, message) -> None:
    with pytest.raises(ValueError, match=message):
        load("learned_memory")(**given)
    with pytest.raises(ValueError, match="does not go together with"):
        compose(Method1(BLOCK), [load("learned_memory")(first=0.1), load("compliant_base")(corner_stiffness=1e6)])
