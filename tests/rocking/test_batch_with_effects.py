"""Batches with effects: each run is that of `solve` with the same effects; so are the runs of many windows."""

import numpy as np
import pytest

from excitation import RampedSinusoid, SampledMotion
from rocking import Block, Method1, Method2, solve, solve_batch
from rocking.effects import compose, load
from rocking.solvers.numba.windows import Start, run_windows

BLOCK = Block(0.2, 0.8)
MOTION = RampedSinusoid(2.5, 6.0, 7.0)
EFFECTS = [
    load("rounded_edges")(radius=0.004),
    load("viscous_damping")(coefficient=0.3),
    load("velocity_dependent_restitution")(slope=-0.02),
    load("base_tilt")(angle=0.004),
    load("base_motion_gain")(gain=1.05),
]


def test_a_run_of_a_batch_is_the_single_run_with_the_same_effects() -> None:
    systems = [Method1(BLOCK, restitution=e) for e in (0.88, 0.9, 0.92)]
    many = solve_batch(systems, MOTION, t_end=6.0, effects=EFFECTS)
    for k, system in enumerate(systems):
        one = solve(system, MOTION, t_end=6.0, effects=EFFECTS, solver="numba")
        assert many.peak_rotation[k] == one.peak_rotation  # the same code on the same numbers: bit for bit
        assert many.impacts[k] == len(one.impact_times) > 5


def test_blocks_with_effects_of_different_strength_go_in_one_batch() -> None:
    dampings = (0.0, 0.2, 0.8)
    systems = [compose(Method1(BLOCK), [load("viscous_damping")(coefficient=c)]) for c in dampings]
    many = solve_batch(systems, theta=0.15, t_end=2.0)
    # Of a free decay from one lean, the first swing back is the larger the less is lost on the way.
    ones = [solve(s, theta=0.15, t_end=2.0, solver="numba") for s in systems]
    assert [len(r.impact_times) for r in ones] == many.impacts.tolist()
    assert np.all(np.diff([abs(r.theta[400]) for r in ones]) != 0.0)


def test_a_method_that_cannot_carry_an_effect_says_so() -> None:
    with pytest.raises(ValueError, match=r"compliant_base: Method 2 does not carry it"):
        solve_batch(Method2(BLOCK, friction=0.7), MOTION, t_end=1.0, effects=[load("compliant_base")()])
    with pytest.raises(ValueError, match=r"restitution=0.99: .* one side would have"):
        compose(Method1(BLOCK, restitution=0.99), [load("eccentric_mass")(offset=0.05)])


def test_windows_of_several_systems_and_records_are_those_of_single_runs() -> None:
    rng = np.random.default_rng(3)
    motions = [SampledMotion(0.01, rng.normal(size=300)) for _ in range(2)]
    systems = [compose(Method1(BLOCK), [load("quadratic_drag")(coefficient=c)]) for c in (0.1, 0.5)]
    starts, times = [], []
    for k in range(8):
        y, q = systems[k % 2].initial_state(0.02 * (k - 3.5), 0.1)
        starts.append(Start(k % 2, (k // 2) % 2, 0.1 * k, 0.1 * k + 0.7, y, q))
        times.append(np.linspace(0.1 * k, 0.1 * k + 0.7, 5 + k))
    found = run_windows(systems, motions, starts, times)
    at = 0
    for start, t in zip(starts, times, strict=True):
        one = solve(
            systems[start.system], motions[start.motion], t_start=start.t_start, t_end=start.t_end,
            initial=(start.y, start.q), save_at=t, solver="numba",
        )  # fmt: skip
        np.testing.assert_array_equal(found.y[at : at + t.size], one.y)
        at += t.size


def test_the_last_sample_is_kept_though_a_step_may_end_a_rounding_before_it() -> None:
    # Steps whose lengths do not add up to the end: two in a thousand random runs once lost their last sample.
    from excitation import SteadySinusoid

    end = 0.030946827987830185
    motion = SteadySinusoid(1.2857128940200502, 2.4525, 1.4854477434158488)
    run = solve(
        Method1(Block(0.0546875, 0.21875), restitution=1.0, g=9.81), motion, t_end=end, save_at=[end], solver="numba"
    )
    assert run.t.tolist() == [end]


def test_windows_say_which_runs_fell_and_when() -> None:
    """Thrown over from half of balance a block falls, let go from there it does not: as single runs have it."""
    system, t = Method1(BLOCK), np.linspace(0.0, 2.0, 9)
    thrown = [(0.5 * BLOCK.alpha, 1.5), (0.5 * BLOCK.alpha, 0.0), (-0.5 * BLOCK.alpha, -1.5)]
    starts = [Start(0, 0, 0.0, 2.0, *system.initial_state(*state)) for state in thrown]
    found = run_windows([system], [SampledMotion(0.01, np.zeros(300))], starts, [t] * 3)
    ones = [solve(system, theta=a, omega=w, t_end=2.0, solver="numba") for a, w in thrown]
    assert found.fell.tolist() == [True, False, True] == [one.overturned for one in ones]
    assert not found.failed.any() and np.isnan(found.overturning_time[1])
    assert found.overturning_time[[0, 2]] == pytest.approx([ones[0].overturning_time, ones[2].overturning_time])
