"""Steady rocking in closed form against runs: an orbit closes, disturbances grow or die as the multipliers say."""

import math

import numpy as np
import pytest

from excitation import SteadySinusoid
from rocking import Block, Method1, Outcome, solve
from rocking.steady_states import SteadyState, stable_range, start, steady_states

G = 9.81
BLOCK = Block(0.2, 0.8)
P = BLOCK.p(G)


def linear(e):
    return Method1(BLOCK, form="linear", restitution=e, g=G)


def base(ratio, amplitude, phase, periods):
    """A g alpha sin(w p t + phase) over so many periods of the sine."""
    frequency = ratio * P / (2.0 * math.pi)
    return SteadySinusoid(frequency, amplitude * G * BLOCK.alpha, periods / frequency, phase)


def run(orbit: SteadyState, ratio, amplitude, halves, solver="numba", faster=0.0):
    """A run from the orbit's impact, disturbed by a share of omega; states in the middles of successive half orbits."""
    phase, omega = start(orbit, linear(orbit.restitution))
    half = orbit.order * math.pi / (ratio * P)
    middles = half * (0.5 + np.arange(halves))
    return solve(
        linear(orbit.restitution), base(ratio, amplitude, phase, orbit.order * (halves + 1)),
        omega=omega * (1.0 + faster), t_end=float(middles[-1]) + 0.1 * half, save_at=middles, solver=solver,
        rtol=1e-12, atol=1e-15,
    )  # fmt: skip


# (w, A, e, n): stable and unstable, both roots, below and above the amplitude that starts rocking (A = 1).
CASES = [(2.0, 0.3, 0.9, 1), (4.0, 8.0, 0.9, 1), (4.0, 15.0, 0.9, 1), (1.0, 0.4, 0.7, 1), (6.0, 1.5, 0.9, 3),
         (4.0, 4.0, 0.9, 3), (6.0, 2.0, 0.9, 5), (3.0, 1.0, 0.95, 1), (3.0, 1.0, 1.0, 1)]  # fmt: skip
ORBITS = [(w, A, orbit) for w, A, e, n in CASES for orbit in steady_states(w, A, e, n)]


def label(value):
    return (
        f"e{value.restitution}-n{value.order}-v{value.velocity:.2f}" if isinstance(value, SteadyState) else f"{value}"
    )


@pytest.mark.parametrize(("ratio", "amplitude", "orbit"), ORBITS, ids=label)
def test_a_run_started_on_an_orbit_closes_after_half_of_it(ratio, amplitude, orbit):
    assert orbit.admissible
    trajectory = run(orbit, ratio, amplitude, 3)
    # Half an orbit later its mirror image, and the orbit itself after two.  Steps of 1e-12 magnified by the largest
    # multiplier here, 54 in an orbit.
    assert trajectory.y[1] == pytest.approx(-trajectory.y[0], abs=1e-9)
    assert trajectory.y[2] == pytest.approx(trajectory.y[0], abs=1e-9)
    half = orbit.order * math.pi / (ratio * P)
    assert trajectory.impact_times == pytest.approx(half * np.arange(1, 3), abs=1e-9)
    assert trajectory.peak_rotation / BLOCK.alpha == pytest.approx(orbit.peak, abs=1e-8)


@pytest.mark.parametrize("solver", ["scipy", pytest.param("diffrax", marks=pytest.mark.slow)])
def test_the_orbit_closes_by_the_other_solvers_too(solver):
    (large, _) = steady_states(3.0, 1.0, 0.95)
    trajectory = run(large, 3.0, 1.0, 3, solver)
    assert trajectory.y[2] == pytest.approx(trajectory.y[0], abs=1e-9)


# The multipliers belong to the orbit, whatever section they are taken on: here the state at a fixed phase of the base.
@pytest.mark.parametrize(("ratio", "amplitude", "orbit"), ORBITS, ids=label)
def test_multipliers_are_those_of_the_stroboscopic_map_by_differences(ratio, amplitude, orbit):
    measured = np.linalg.eigvals(strobe(orbit, ratio, amplitude))
    expected = orbit.multipliers
    # Central differences of 1e-6: (1e-6)^2 of curvature, and 1e-12 of a run over 1e-6.
    scale = np.abs(expected).max()
    assert sorted(np.abs(measured)) == pytest.approx(sorted(np.abs(expected)), abs=2e-5 * scale)
    assert measured.sum() == pytest.approx(expected.sum(), abs=2e-5 * scale)


def strobe(orbit, ratio, amplitude):
    """Derivative of the state one orbit later by the state, in the middle of a half orbit, by central differences."""
    system = linear(orbit.restitution)
    phase, omega = start(orbit, system)
    half = orbit.order * math.pi / (ratio * P)
    first = run(orbit, ratio, amplitude, 1).y[0]
    columns = []
    for change in (np.array([1e-6 * BLOCK.alpha, 0.0]), np.array([0.0, 1e-6 * omega])):
        ends = [
            solve(
                system, base(ratio, amplitude, phase, 4 * orbit.order), t_start=0.5 * half, t_end=2.6 * half,
                initial=system.initial_state(*(first + sign * change)), save_at=[2.5 * half], rtol=1e-12, atol=1e-15,
            ).y[0]
            for sign in (1.0, -1.0)
        ]  # fmt: skip
        columns.append((ends[0] - ends[1]) / (2.0 * change.sum()))
    return np.array(columns).T


@pytest.mark.parametrize(("ratio", "amplitude", "orbit"), ORBITS, ids=label)
def test_determinant_of_the_half_map_is_the_square_of_the_restitution(ratio, amplitude, orbit):
    # Hogan (1989): each impact shrinks areas of (time, speed) by e^2, and nothing else does.
    assert np.linalg.det(orbit.half_map) == pytest.approx(orbit.restitution**2, rel=1e-7)


def distances(orbit, ratio, amplitude, halves, faster):
    """Distance from the orbit in the middle of each half, scaled; the orbit's sides mirrored onto one another."""
    there = run(orbit, ratio, amplitude, 1).y[0]
    disturbed = run(orbit, ratio, amplitude, halves, faster=faster).y
    signs = (-1.0) ** np.arange(len(disturbed))
    return np.linalg.norm((signs[:, None] * disturbed - there) / [BLOCK.alpha, P * BLOCK.alpha], axis=1)


def test_a_disturbance_of_a_stable_orbit_dies_at_the_predicted_rate():
    # Complex multipliers of modulus e^4: each half orbit leaves the share e of a disturbance, on average.
    (large, _) = steady_states(2.0, 1.0, 0.9)
    assert large.stable
    left = distances(large, 2.0, 1.0, 61, 1e-3)
    rate = np.polyfit(np.arange(61), np.log(left), 1)[0]
    # The rotation of the complex pair makes the distance wander by some tens of per cent about the exponential: over
    # 60 half orbits that is less than 0.01 in the exponent.
    assert rate == pytest.approx(math.log(0.9), abs=0.01)


@pytest.mark.parametrize(("ratio", "amplitude", "which"), [(2.0, 1.0, 1), (4.0, 15.0, 0), (4.0, 4.0, 0)])
def test_a_disturbance_of_an_unstable_orbit_grows_at_the_predicted_rate(ratio, amplitude, which):
    orbit = steady_states(ratio, amplitude, 0.9, 3 if amplitude == 4.0 else 1)[which]
    assert not orbit.stable
    largest = np.sqrt(np.abs(orbit.multipliers).max())
    # A growth from 1e-8 to 1e-4: small enough to be linear, long enough for the larger of the two real eigenvalues
    # (their product is e^2) to have taken over.
    halves = int(math.log(1e4) / math.log(largest))
    grown = distances(orbit, ratio, amplitude, halves, 1e-8)
    assert grown[-1] / grown[-2] == pytest.approx(largest, rel=0.005)


@pytest.mark.parametrize("ratio", [1.0, 3.0])
def test_below_the_least_amplitude_rocking_dies_and_above_it_goes_on(ratio):
    low, _ = stable_range(ratio, 0.9)
    assert low < 1.0  # less than what starts it
    orbit, *_ = steady_states(ratio, 1.01 * low, 0.9)
    assert run(orbit, ratio, 1.01 * low, 201).outcome is Outcome.MOVING
    assert run(orbit, ratio, 1.01 * low, 201).y[200] == pytest.approx(run(orbit, ratio, 1.01 * low, 1).y[0], abs=1e-6)
    assert steady_states(ratio, 0.99 * low, 0.9) == ()
    assert run(orbit, ratio, 0.99 * low, 201).outcome is Outcome.AT_REST


def test_beyond_the_upper_amplitude_the_symmetric_orbit_gives_way_to_a_lopsided_one():
    _, high = stable_range(4.0, 0.9)
    for factor, symmetric in ((0.99, True), (1.02, False)):
        orbit = steady_states(4.0, factor * high, 0.9)[0]
        assert orbit.stable is symmetric
        y = run(orbit, 4.0, factor * high, 801, faster=1e-3).y
        assert np.abs(y[-1] + y[-2])[0] / BLOCK.alpha < 1e-6 if symmetric else np.abs(y[-1] + y[-2])[0] > 0.01
        if not symmetric:  # it still closes after one period of the base
            assert y[-1] == pytest.approx(y[-3], abs=1e-3)


@pytest.mark.parametrize("e", [0.7, 0.95])
@pytest.mark.parametrize("ratio", [0.5, 1.0, 4.0])
@pytest.mark.parametrize("n", [1, 3])
def test_the_range_of_stability_ends_where_an_eigenvalue_leaves_the_unit_circle(e, ratio, n):
    low, high = stable_range(ratio, e, n)
    assert steady_states(ratio, low * (1.0 - 1e-9), e, n) == ()
    at_low = np.linalg.eigvals(steady_states(ratio, low * (1.0 + 1e-12), e, n)[0].half_map)
    at_high = np.linalg.eigvals(steady_states(ratio, high, e, n)[0].half_map)
    # At a fold an eigenvalue is one square root away: sqrt(1e-12), times what cosh T <= 8e7 makes of it.
    if ratio > 0.5 * n:
        assert np.abs(at_low - 1.0).min() < 1e-2
        assert np.abs(at_high + 1.0).min() < 1e-6


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: steady_states(0.0, 1.0, 0.9), r"ratio=0\.0 1: want a positive number"),
        (lambda: steady_states(2.0, -1.0, 0.9), r"amplitude=-1\.0 1"),
        (lambda: steady_states(2.0, 1.0, 0.0), r"e=0\.0: want above 0 to 1"),
        (lambda: steady_states(2.0, 1.0, 0.9, 2), r"n=2: want an odd number of periods"),
        (lambda: stable_range(0.001, 0.9), r"ratio=0\.001: want at least n pi/300=0\.0105"),
        (lambda: start(ORBITS[0][2], Method1(BLOCK)), r"form='nonlinear': want 'linear'"),
    ],
)
def test_bad_argument_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
