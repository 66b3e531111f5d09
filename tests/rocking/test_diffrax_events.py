"""The diffrax solver: the runs of scipy and numba, every way a run can end, and JAX left as it was found."""

from typing import Any

import numpy as np
import pytest

from excitation import RampedSinusoid
from rocking import Block, Method1, Method2, Mode, Outcome, solve

jax = pytest.importorskip("jax")

G = 9.81
BLOCK = Block(b=0.15, h=0.5)
SYSTEMS = {
    "linear": Method1(BLOCK, form="linear", g=G),
    "nonlinear": Method1(BLOCK, g=G),
    "method 2": Method2(BLOCK, friction=0.7, g=G),
}
SHAKEN = RampedSinusoid(frequency=3.0, duration=4.0, final_amplitude=6.0)
SHARP: dict[str, Any] = {"rtol": 1e-12, "atol": 1e-15}


def by(solver: str, system: Any, motion: Any, t_start: float, t_end: float, **options: Any) -> Any:
    """A run with sharp tolerances and few samples; one length of the arrays serves all tests."""
    save_at = np.linspace(t_start, t_end, 16)
    return solve(system, motion, t_start=t_start, t_end=t_end, solver=solver, save_at=save_at, **SHARP | options)


# After its 4 s the ramped sinusoid leaves the base at rest: the second case is free rocking.
@pytest.mark.parametrize("case", [(0.0, 3.5, 0.0), (5.0, 7.5, 0.15)], ids=["shaken", "free"])
@pytest.mark.parametrize("name", SYSTEMS)
def test_ten_impacts_and_more_have_the_times_of_scipy_and_numba(name: str, case: tuple[float, float, float]) -> None:
    t_start, t_end, theta = case
    run = by("diffrax", SYSTEMS[name], SHAKEN, t_start, t_end, theta=theta)
    assert len(run.impact_times) >= 10
    for other in (by(solver, SYSTEMS[name], SHAKEN, t_start, t_end, theta=theta) for solver in ("scipy", "numba")):
        np.testing.assert_array_equal(run.events.guard, other.events.guard)
        np.testing.assert_array_equal(run.events.s_after, other.events.s_after)
        # The promise of the solvers: impacts located to 1e-8 s.
        np.testing.assert_allclose(run.impact_times, other.impact_times, rtol=0.0, atol=1e-8)
        # Angular accelerations stay below 50 rad/s^2: 1e-8 s are then 5e-7 rad/s; numba's dense output adds 1e-7.
        np.testing.assert_allclose(run.y, other.y, rtol=0.0, atol=1e-6)
        np.testing.assert_array_equal(run.mode, other.mode)
        assert run.peak_rotation == pytest.approx(other.peak_rotation, abs=1e-8)
        assert run.outcome is other.outcome


# More events than the 256 rows of the table between two pauses of the compiled loop.
def test_a_block_that_slides_and_jumps_goes_through_the_modes_of_scipy() -> None:
    system = Method2(BLOCK, friction=0.4, normal_restitution=0.3, g=G)
    motion = RampedSinusoid(frequency=3.0, duration=8.0, final_amplitude=12.0)
    run, other = (by(solver, system, motion, 0.0, 8.0, theta=0.05) for solver in ("diffrax", "scipy"))
    assert len(run.events) > 300
    assert {Mode.SLIDE_ROTATION, Mode.ROTATION_JUMP} <= set(run.events.mode_after.tolist())
    np.testing.assert_array_equal(run.events.guard[:100], other.events.guard[:100])
    np.testing.assert_array_equal(run.events.mode_after[:100], other.events.mode_after[:100])
    np.testing.assert_allclose(run.events.t[:100], other.events.t[:100], rtol=0.0, atol=1e-8)
    np.testing.assert_allclose(run.events.y_after[:100], other.events.y_after[:100], rtol=0.0, atol=1e-6)
    assert np.all(np.diff(run.events.t) >= 0.0)


@pytest.mark.parametrize("name", ["nonlinear", "method 2"])
@pytest.mark.parametrize("amplitude", [12.0, -12.0])
def test_a_block_overturns_when_and_to_the_side_that_scipy_says(name: str, amplitude: float) -> None:
    phase = 0.0 if amplitude > 0.0 else np.pi
    motion = RampedSinusoid(frequency=1.0, duration=4.0, final_amplitude=abs(amplitude), phase=phase)
    run, other = (by(solver, SYSTEMS[name], motion, 0.0, 6.0) for solver in ("diffrax", "scipy"))
    assert run.outcome is Outcome.OVERTURNED
    assert run.side == other.side
    assert run.overturning_time == pytest.approx(other.overturning_time, abs=1e-8)
    assert run.t_end == pytest.approx(other.t_end, abs=1e-8)
    assert len(run.t) == len(other.t)


def test_a_run_with_too_many_events_fails_with_the_reason_of_scipy() -> None:
    runs = [
        by(solver, SYSTEMS["nonlinear"], SHAKEN, 5.0, 7.5, theta=0.15, max_events=5) for solver in ("diffrax", "scipy")
    ]
    assert [run.outcome for run in runs] == [Outcome.FAILED] * 2
    assert "more than max_events=5 events" in runs[0].reason


def test_friction_without_limit_that_would_have_to_pull_ends_the_run_in_a_sentence() -> None:
    system = Method2(Block(b=0.2, h=0.8), friction=np.inf, g=G)
    motion = RampedSinusoid(frequency=2.0, duration=4.0, final_amplitude=40.0)
    runs = [by(solver, system, motion, 0.0, 4.0) for solver in ("diffrax", "scipy")]
    assert runs[0].outcome is runs[1].outcome is Outcome.FAILED
    assert system.inadmissible_reason in runs[0].reason
    assert runs[0].t_end == pytest.approx(runs[1].t_end, abs=1e-8)


class Poisoned:
    """A push that is not a number from the time par[0] on; counts how often its kernel is traced."""

    traces = 0
    breakpoints: tuple[float, ...] = (1.0,)
    max_step = 0.1

    def __init__(self, start: float, push: float) -> None:
        self.parameters = np.array([start, push])

    @staticmethod
    def kernel(xp: Any, t: Any, par: Any) -> Any:
        Poisoned.traces += 1
        return par[1] + xp.where(t > par[0], xp.sqrt(par[0] - t), 0.0), 0.0 * t


@pytest.mark.slow
def test_a_motion_that_is_not_finite_fails_and_says_so() -> None:
    run = by("diffrax", SYSTEMS["nonlinear"], Poisoned(0.99999, 0.0), 0.0, 2.0, theta=0.1)
    assert run.outcome is Outcome.FAILED
    assert "not finite" in run.reason or "too small" in run.reason


def test_other_numbers_trace_nothing_again() -> None:
    motion = Poisoned(9.0, 0.3)
    first = by("diffrax", SYSTEMS["nonlinear"], motion, 0.0, 2.0, theta=0.1)
    count = Poisoned.traces
    assert count > 0
    other = Method1(Block(b=0.2, h=0.7), restitution=0.8, g=9.0)
    second = by("diffrax", other, Poisoned(9.0, -0.4), 0.1, 2.1, theta=-0.12, omega=0.1, max_events=500)
    assert Poisoned.traces == count
    assert second.impact_times[0] != first.impact_times[0]


def test_the_32_bits_of_other_jax_code_stay_32_bits() -> None:
    double = jax.jit(lambda x: 2.0 * x + jax.numpy.linspace(0.0, 1.0, 3))
    before = double(jax.numpy.ones(3))
    by("diffrax", SYSTEMS["nonlinear"], SHAKEN, 5.0, 7.5, theta=0.1)
    after = double(jax.numpy.ones(3))
    assert before.dtype == after.dtype == jax.numpy.asarray(1.0).dtype == np.float32
    assert not jax.config.jax_enable_x64


# Hairer, Norsett & Wanner (1993), eq. (II.4.11), by hand: scales 1e-6 + 2e-3 and 1e-6 + 0.5e-3.
def test_an_error_is_taken_over_the_larger_state_of_a_step_and_the_absolute_tolerance() -> None:
    from rocking.solvers.diffrax.steps import error_norm

    found = error_norm(np.array([1e-3, 1e-4]), np.array([-2.0, 0.1]), np.array([1.0, -0.5]), 1e-3, 1e-6)
    assert float(found) == pytest.approx(np.sqrt(0.5 * ((1e-3 / 2.001e-3) ** 2 + (1e-4 / 5.01e-4) ** 2)), rel=1e-6)
    alone = error_norm(np.array([3e-6, 4e-6]), np.zeros(2), np.zeros(2), 1e-3, 1e-6)
    assert float(alone) == pytest.approx(np.sqrt(12.5), rel=1e-6)
