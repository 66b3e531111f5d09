"""What is read off a trajectory: overturning time and side, time in each mode, outcome, samples, dataset."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rocking import Block, Method1, Method2, Mode, Outcome, solve
from rocking.effects.compliant_base import CompliantBase
from rocking.effects.learned_hysteresis import LearnedHysteresis
from rocking.effects.learned_memory import LearnedMemory
from rocking.effects.learned_mode import LearnedMode

G = 9.81
ALPHA = math.atan(0.25)
P2 = 0.75 * G / (0.5 * math.hypot(0.2, 0.8))
SOLVERS = pytest.mark.parametrize("solver", ["numba", "scipy"])


def outward_passages(side: float, push: tuple[float, float], omega: float) -> tuple[np.ndarray, float]:
    """Times at which |theta| passes alpha outward, and that of the fall, of a block that leans on one side throughout.

    Newton's law written out: theta'' = -p^2 [s sin(alpha - s theta) + (a_x/g) cos(alpha - s theta)],
    a_x = side amplitude sin(frequency t), from s theta = 0.9 alpha.
    """
    amplitude, frequency = push

    def rates(t: float, y: Any) -> list[float]:
        a_x = side * amplitude * math.sin(frequency * t)
        psi = ALPHA - side * y[0]
        return [y[1], -P2 * (side * math.sin(psi) + a_x / G * math.cos(psi))]

    def at_balance(t: float, y: Any) -> float:
        return side * y[0] - ALPHA

    def fallen(t: float, y: Any) -> float:
        return side * y[0] - 0.5 * math.pi

    def upright(t: float, y: Any) -> float:
        return side * y[0]

    at_balance.direction = 1.0  # type: ignore[attr-defined]
    fallen.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(
        rates, (0.0, 20.0), [side * 0.9 * ALPHA, side * omega], "DOP853", events=[at_balance, fallen, upright],
        rtol=1e-12, atol=1e-14,
    )  # fmt: skip
    assert len(found.t_events[2]) == 0, "the case must have no impact"
    return found.t_events[0], float(found.t_events[1][0])


# The push swings the block out over its balance, back, and out again: it overturned at the last passage.
@SOLVERS
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("method", [1, 2])
def test_overturning_time_is_the_last_outward_passage_of_the_balance(
    slender: Block, window: Any, side: float, method: int, solver: str
) -> None:
    push, omega = (1.0, 8.0), 0.3
    passages, fall = outward_passages(side, push, omega)
    assert len(passages) >= 2
    system: Any = Method1(slender, g=G) if method == 1 else Method2(slender, friction=1.3, g=G)
    motion = window(0.0, 20.0, x=(0.0, side * push[0], push[1], 0.0))
    run = solve(system, motion, theta=side * 0.9 * ALPHA, omega=side * omega, t_end=20.0, solver=solver)
    assert run.outcome is Outcome.OVERTURNED
    assert run.overturned
    assert run.side == side
    # Solver tolerance 1e-9, doubled a few times by the balance, from which paths part as exp(4 t) in 1.5 s: 1e-6 s.
    assert run.overturning_time == pytest.approx(passages[-1], abs=1e-6)
    assert run.overturning_time > passages[0] + 0.1
    if method == 1:  # a falling block may slide or lift in Method 2
        assert run.t_end == pytest.approx(fall, abs=1e-6)
    assert run.t[-1] <= run.t_end < 20.0


def test_a_block_that_starts_beyond_its_balance_overturns_at_the_start(slender: Block) -> None:
    run = solve(Method1(slender, g=G), theta=-1.1 * ALPHA, t_end=5.0, t_start=1.0)
    assert (run.overturning_time, run.side) == (1.0, -1)


def test_a_block_that_does_not_fall_has_neither_overturning_time_nor_side(slender: Block, window: Any) -> None:
    # It passes its balance once and is pushed back: no fall.
    motion = window(0.0, 0.5, x=(0.6, 0.0, 0.0, 0.0))
    run = solve(Method1(slender, g=G), motion, theta=0.95 * ALPHA, omega=0.2, t_end=3.0)
    assert np.abs(run.theta).max() > ALPHA
    assert run.outcome is not Outcome.OVERTURNED
    assert math.isnan(run.overturning_time)
    assert run.side == 0
    # The passage of the balance is an event, and no impact: at each of those the block is upright.
    events = run.events
    assert len(run.impact_times) == len(events.t) - 1 > 0
    assert np.abs(events.y_before[np.isin(events.t, run.impact_times), 0]).max() < 1e-9


@SOLVERS
def test_times_in_the_modes_add_up_to_the_run(slender: Block, window: Any, solver: str) -> None:
    system = Method2(slender, friction=0.4, normal_restitution=0.2, chatter_time=1e-4, g=G)
    motion = window(0.3, 0.8, x=(0.0, 6.0, 15.0, 0.0))
    run = solve(system, motion, t_start=0.1, t_end=2.0, solver=solver)
    assert run.mode_durations().sum() == pytest.approx(run.t_end - 0.1, abs=1e-12)
    assert run.mode_durations(until=0.6).sum() == pytest.approx(0.5, abs=1e-12)
    assert run.mode_durations(until=99.0) == pytest.approx(run.mode_durations())
    # Until the push reaches (b/h) g the block rests: a_x = 6 sin(15 (t - 0.3)).
    onset = 0.3 + math.asin(0.25 * G / 6.0) / 15.0
    assert run.onset_time == pytest.approx(onset, abs=1e-9)
    assert run.mode_durations(until=onset)[Mode.REST] == pytest.approx(onset - 0.1, abs=1e-9)
    # Counted over the samples instead: 1.9 ms each, off by one sample at either end of each spell.
    counted = np.bincount(run.mode, minlength=6) * (run.t[1] - run.t[0])
    spells = 1 + np.count_nonzero(np.diff(run.mode))
    np.testing.assert_allclose(run.mode_durations(), counted, rtol=0.0, atol=2.0 * spells * (run.t[1] - run.t[0]))


@SOLVERS
def test_outcomes_tell_rest_from_motion(slender: Block, solver: str) -> None:
    system = Method1(slender, restitution=0.5, g=G)
    assert solve(system, t_end=1.0, solver=solver).outcome is Outcome.AT_REST
    assert solve(system, theta=0.1, t_end=0.1, solver=solver).outcome is Outcome.MOVING
    assert solve(system, theta=0.1, t_end=3.0, solver=solver).outcome is Outcome.AT_REST
    assert solve(system, theta=0.3, t_end=5.0, solver=solver).outcome is Outcome.OVERTURNED


@SOLVERS
def test_a_motion_that_is_not_finite_fails_with_the_reason(slender: Block, constant: Any, solver: str) -> None:
    run = solve(Method1(slender, g=G), constant(math.nan), t_end=1.0, solver=solver)
    assert run.outcome is Outcome.FAILED
    assert "not finite" in run.reason
    assert run.reason in repr(run)


# Nonlinear free motion from rest: omega^2 = 2 p^2 (cos(alpha - theta_0) - cos(alpha - theta)) at every sample.
@SOLVERS
def test_samples_are_kept_at_the_times_asked_for_up_to_the_fall(slender: Block, solver: str) -> None:
    theta_0 = 1.2 * ALPHA
    asked = np.array([0.0, 0.1, 0.10001, 0.5, 0.5, 2.9, 3.0])
    run = solve(Method1(slender, g=G), theta=theta_0, t_end=3.0, save_at=asked, solver=solver)
    assert run.overturned
    np.testing.assert_array_equal(run.t, asked[asked <= run.t_end])
    expected = np.sqrt(2.0 * P2 * (math.cos(ALPHA - theta_0) - np.cos(ALPHA - run.theta)))
    # Dense output of the order of the solver: 1e-7.
    np.testing.assert_allclose(run.omega, expected, rtol=0.0, atol=1e-7)
    assert run.theta[0] == theta_0
    assert len(solve(Method1(slender, g=G), theta=0.1, t_end=1.0, save_at=[], solver=solver).t) == 0


@pytest.mark.parametrize("solver", ["numba", "scipy", "taylor", "exact"])
def test_a_time_that_is_asked_for_twice_is_kept_twice(solver: str) -> None:
    """Until the first impact alpha - theta = (alpha - theta_0) cosh(p t), from rest (Housner 1963, linear)."""
    system = Method1(Block(0.2, 0.8), form="linear", onset="linear", g=G)
    times = np.array([0.0, 0.0, 0.0, 0.1, 0.1, 0.2, 0.2])
    run = solve(system, theta=0.1, t_end=0.2, save_at=times, solver=solver)
    assert run.t == pytest.approx(times, abs=0.0)
    assert run.theta == pytest.approx(ALPHA - (ALPHA - 0.1) * np.cosh(math.sqrt(P2) * times), abs=1e-7)


def test_a_trajectory_is_told_in_one_line(slender: Block) -> None:
    run = solve(Method1(slender, g=G), theta=0.1, t_end=1.0)
    assert repr(run) == f"<Trajectory method1 by numba: 0 to 1 s, {len(run.impact_times)} impacts, still moving>"
    assert repr(run.events) == f"Events({len(run.events)} events)"


@pytest.mark.parametrize("method", [1, 2])
def test_the_dataset_has_units_and_names_on_every_variable(slender: Block, method: int) -> None:
    system: Any = Method1(slender, g=G) if method == 1 else Method2(slender, friction=0.6, g=G)
    run = solve(system, theta=0.2, t_end=2.0)
    dataset = run.to_xarray()
    for name, variable in dataset.variables.items():
        assert variable.attrs["long_name"], name
        if name == "event":
            continue  # words
        if name in ("mode", "mode_after"):  # CF conventions, 3.5: flags have values and meanings in place of units
            assert len(variable.attrs["flag_values"]) == len(variable.attrs["flag_meanings"].split()) == 6
        else:
            assert variable.attrs["units"], name
    # Radian and second are what the solver was given: theta starts at 0.2, omega is its slope.
    assert dataset["theta"].attrs["units"] == "rad"
    assert float(dataset["theta"][0]) == 0.2
    np.testing.assert_array_equal(dataset["time"], run.t)
    np.testing.assert_array_equal(dataset["omega"], run.omega)
    np.testing.assert_array_equal(dataset["event_time"], run.events.t)
    assert list(dataset["event"].to_numpy()[:1]) == ["impact" if method == 1 else "landing"]
    assert dataset["theta"].sel(time=slice(0.0, 1.0)).size == 501
    assert dataset.attrs["outcome"] == "still moving"
    assert "0.2" in dataset.attrs["system"]


GIVES = [
    (LearnedMode(mass_ratio=0.1, frequency=5.0), {"shift": "m", "velocity": "m s-1"}),
    (LearnedHysteresis(stiffness=1.0, width=0.01), {"strain": "rad"}),
    (LearnedMemory(first=0.05), {"impacts": "1", "pause": "s", "use": "(rad s-1)^worn_exponent"}),
]


@pytest.mark.parametrize(("effect", "units"), GIVES, ids=["mode", "hysteresis", "memory"])
def test_states_that_an_effect_brings_along_have_their_units_and_names(
    slender: Block, effect: Any, units: dict[str, str]
) -> None:
    dataset = solve(Method1(slender, g=G), theta=0.1, t_end=0.2, effects=[effect]).to_xarray()
    for name, unit in units.items():
        assert dataset[name].attrs["units"] == unit
        assert " " in dataset[name].attrs["long_name"]


# The centre of mass of an upright block is h/2 = 0.4 m over the floor, its carrying corner 0 m.
def test_the_states_of_a_block_on_springs_are_told_to_be_those_of_its_centre_of_mass(slender: Block) -> None:
    soft = CompliantBase(corner_stiffness=1e7, damping_ratio=0.1)
    for given, height, point in (((soft,), 0.4, "centre of mass"), ((), 0.0, "carrying corner")):
        system: Any = Method1(slender, g=G) if given else Method2(slender, friction=0.6, g=G)
        dataset = solve(system, t_end=0.1, effects=given).to_xarray()
        assert float(dataset["z"][0]) == pytest.approx(height, abs=1e-3)
        assert all(point in dataset[name].attrs["long_name"] for name in "xzuv")
        assert [dataset[name].attrs["units"] for name in "xzuv"] == ["m", "m", "m s-1", "m s-1"]


def lost_at(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """A sine that is no number any more from par[0] on."""
    return xp.where(t > par[0], math.nan, 3.0 * xp.sin(5.0 * t)), 0.0 * t


class Lost:
    """A motion whose formula has a hole within a smooth stretch."""

    kernel = staticmethod(lost_at)
    parameters = np.array([0.3])
    breakpoints: tuple[float, ...] = ()
    max_step = 0.05


@pytest.mark.parametrize("solver", ["numba", "scipy", pytest.param("diffrax", marks=pytest.mark.slow)])
@pytest.mark.parametrize("theta", [0.0, 0.1])
def test_a_motion_that_ceases_to_be_finite_is_not_taken_for_a_matter_of_tolerance(
    slender: Block, solver: str, theta: float
) -> None:
    run = solve(Method1(slender, g=G), Lost(), theta=theta, t_end=1.0, solver=solver)
    assert run.outcome is Outcome.FAILED
    assert "not finite" in run.reason
    assert run.t_end == pytest.approx(0.3, abs=1e-12)
