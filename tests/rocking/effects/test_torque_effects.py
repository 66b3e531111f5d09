"""Damping, drag, tether and restitution by speed: closed forms, quadratures and balances of energy."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad, simpson, solve_ivp
from scipy.optimize import brentq

from excitation import PiecewiseLinear
from rocking import Block, Method1, Outcome

G = 9.80665
SHARP: Any = {"rtol": 1e-12, "atol": 1e-15}


def energy(block: Block, theta: Any, omega: Any) -> Any:
    """Per inertia about the corner [1/s^2]: omega^2/2 + p^2 (cos(alpha - |theta|) - cos(alpha))."""
    p2 = 0.75 * G / block.R
    return 0.5 * omega**2 + p2 * (np.cos(block.alpha - np.abs(theta)) - math.cos(block.alpha))


# The base falls away and is pushed to one side: the plain block tips to the other, and so does one without its effect.
@pytest.mark.parametrize("push", [0.5, -0.5])
@pytest.mark.parametrize("text", ["viscous_damping.coefficient=0", "eccentric_mass.offset=0"])
@pytest.mark.parametrize("solver", ["numba", "scipy", pytest.param("diffrax", marks=pytest.mark.slow)])
def test_above_a_base_that_falls_away_the_block_tips_against_the_push(
    run_with: Any, solver: str, text: str, push: float
) -> None:
    motion = PiecewiseLinear(0.05, np.full(8, push), np.full(8, -14.0))
    plain, other = (run_with(*texts, motion=motion, t_end=0.3, solver=solver, **SHARP) for texts in ((), (text,)))
    assert push * plain.theta[-1] < 0.0
    np.testing.assert_allclose(other.theta, plain.theta, rtol=0.0, atol=1e-10)
    first = other.system.guard_names[other.events.guard[0]]
    assert first == ("tip_left" if push > 0.0 else "tip_right")


# theta'' = -p^2 sin(alpha - theta) - loss(omega), integrated apart from rocking until the corner lands.
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("text", "loss"),
    [
        ("viscous_damping.coefficient=1.5", lambda omega: 1.5 * omega),
        ("quadratic_drag.coefficient=4", lambda omega: 4.0 * abs(omega) * omega),
    ],
)
def test_the_first_landing_is_that_of_the_damped_equation(
    run_with: Any, block: Block, text: str, loss: Any, side: float
) -> None:
    p2 = 0.75 * G / block.R
    lands = solve_ivp(
        lambda t, y: (y[1], -p2 * math.sin(block.alpha - y[0]) - loss(y[1])), (0.0, 3.0), (0.15, 0.0),
        events=lambda t, y: y[0], rtol=1e-12, atol=1e-14,
    )  # fmt: skip
    run = run_with(text, theta=0.15 * side, t_end=2.0)
    assert run.impact_times[0] == pytest.approx(lands.t_events[0][0], abs=1e-10)
    i = int(np.flatnonzero(run.events.guard == 1)[0])
    assert run.events.y_before[i, 1] == pytest.approx(side * lands.y_events[0][0][1], abs=1e-9)


# What a swing loses is the work of the torque along its path: the integral of c omega |omega|^n dt over the samples.
@pytest.mark.parametrize(
    ("text", "power"),
    [
        ("viscous_damping.coefficient=0.8", lambda omega: 0.8 * omega**2),
        ("quadratic_drag.coefficient=3", lambda omega: 3.0 * np.abs(omega) ** 3),
    ],
)
def test_a_torque_dissipates_its_work(run_with: Any, block: Block, text: str, power: Any) -> None:
    run = run_with(text, theta=0.15, t_end=0.6, save_at=np.linspace(0.0, 0.6, 6001), **SHARP)
    swing = np.searchsorted(run.impact_times, run.t)
    assert swing.max() >= 1
    for k in range(2):
        part = swing == k
        lost = -np.ptp(energy(block, run.theta[part], run.omega[part]))
        assert -lost > 1e-3
        assert lost == pytest.approx(-simpson(power(run.omega[part]), x=run.t[part]), rel=1e-8)


# theta'' + c theta' = p^2 (theta - alpha) of a slender block near the upright has exponentials for a solution.
def test_viscous_damping_of_a_slender_block_is_the_sum_of_two_exponentials(run_with: Any) -> None:
    slender, c, start = Block(b=0.02, h=2.0), 0.7, 0.004
    p = math.sqrt(0.75 * G / slender.R)
    roots = [0.5 * (-c + sign * math.hypot(c, 2.0 * p)) for sign in (1.0, -1.0)]
    # theta - alpha = A exp(r1 t) + B exp(r2 t), from rest at `start`.
    total = start - slender.alpha
    A, B = -total * roots[1] / (roots[0] - roots[1]), total * roots[0] / (roots[0] - roots[1])
    lands = brentq(
        lambda t: slender.alpha + A * math.exp(roots[0] * t) + B * math.exp(roots[1] * t), 1e-3, 2.0, xtol=1e-14
    )
    run = run_with(f"viscous_damping.coefficient={c}", method=Method1(slender), theta=start, t_end=1.0)
    # sin(psi) for psi up to 0.01: 1.7e-5 of it.
    assert run.impact_times[0] == pytest.approx(lands, rel=2e-5)


@pytest.mark.parametrize("side", [0, 1, -1])
def test_a_tether_stores_energy_and_gives_it_back(run_with: Any, block: Block, side: int) -> None:
    slack, k = 0.05, 400.0
    texts = (f"tether.slack={slack}", f"tether.stiffness={k}", f"tether.side={side}")
    run = run_with(*texts, method=Method1(block, restitution=1.0), theta=0.13, t_end=3.0, **SHARP)
    beyond = np.maximum(np.abs(run.theta) - slack, 0.0)
    pulls = np.ones_like(run.theta) if side == 0 else np.sign(run.theta) == side
    total = block.I_O * energy(block, run.theta, run.omega) + 0.5 * k * pulls * beyond**2
    assert len(run.impact_times) >= 4
    assert np.ptp(total) < 1e-9 * total[0]


# A block that would fall is caught where the pull's energy takes up the rest.
def test_the_reach_into_a_tether_follows_from_the_balance_of_energy(run_with: Any, block: Block) -> None:
    slack, k, omega = 0.2, 6000.0, 1.2
    run = run_with(f"tether.slack={slack}", f"tether.stiffness={k}", theta=0.1, omega=omega, t_end=1.0, **SHARP)
    start = block.I_O * energy(block, 0.1, omega)

    def spare(theta: float) -> float:
        return start - block.I_O * float(energy(block, theta, 0.0)) - 0.5 * k * (theta - slack) ** 2

    reach = brentq(spare, slack, 1.0, xtol=1e-14)
    assert reach > block.alpha
    assert run.peak_rotation == pytest.approx(reach, abs=1e-9)
    assert run.outcome is not Outcome.OVERTURNED
    assert run_with(theta=0.1, omega=omega, t_end=5.0).outcome is Outcome.OVERTURNED


def test_a_tether_on_one_side_leaves_the_other_alone(run_with: Any) -> None:
    texts = ("tether.slack=0.02", "tether.stiffness=5000", "tether.side=-1")
    free, tied = (run_with(*t, theta=0.15, t_end=0.8, **SHARP) for t in ((), texts))
    assert tied.impact_times[0] == pytest.approx(free.impact_times[0], abs=1e-11)
    assert abs(tied.theta.min()) < 0.6 * abs(free.theta.min())


# A tether that is taut from the start (slack 0) stiffens the upright block; a swing's time by quadrature of energy.
def test_a_taut_tether_shortens_a_swing_as_the_quadrature_of_energy_says(run_with: Any, block: Block) -> None:
    k, start = 300.0, 0.1
    run = run_with(f"tether.stiffness={k}", theta=start, t_end=1.0, **SHARP)

    def well(theta: float) -> float:
        return float(energy(block, theta, 0.0)) + 0.5 * k / block.I_O * theta**2

    # theta = start (1 - x^2) takes the root's singularity away.
    time, _ = quad(
        lambda x: 2.0 * start * x / math.sqrt(2.0 * (well(start) - well(start * (1.0 - x * x)))), 0.0, 1.0,
        epsabs=1e-12, epsrel=1e-12,
    )  # fmt: skip
    assert run.impact_times[0] == pytest.approx(time, abs=1e-9)


@pytest.mark.parametrize(("slope", "most"), [(-0.15, 1.0), (0.1, 1.0), (-5.0, 1.0), (5.0, 1.0)])
def test_each_impact_has_the_restitution_of_its_speed(run_with: Any, block: Block, slope: float, most: float) -> None:
    run = run_with(f"velocity_dependent_restitution.slope={slope}", theta=0.15, t_end=2.0)
    impacts = np.flatnonzero(run.events.guard == 1)
    before, after = run.events.y_before[impacts, 1], run.events.y_after[impacts, 1]
    expected = np.clip(1.0 - 1.5 * math.sin(block.alpha) ** 2 + slope * np.abs(before), 0.0, most)
    np.testing.assert_allclose(after, expected * before, rtol=1e-13, atol=0.0)
    if slope == -5.0:
        # e = 0 is allowed and stops the block at its first impact.
        assert len(impacts) == 1
        assert run.outcome is Outcome.AT_REST


@pytest.mark.parametrize(
    "texts",
    [
        ("base_tilt.angle=0.05",),
        ("base_tilt.angle=-0.2",),
        ("tether.stiffness=3000",),
        ("tether.slack=0.01", "tether.stiffness=1e6"),
        ("viscous_damping.coefficient=3",),
        ("quadratic_drag.coefficient=3",),
        ("velocity_dependent_restitution.slope=-0.3",),
        ("eccentric_mass.offset=0.02",),
        ("rounded_edges.radius=0.03",),
        ("base_adhesion.moment=20",),
        ("base_tilt.angle=0.04", "eccentric_mass.offset=0.01", "rounded_edges.radius=0.02"),
    ],
)
@pytest.mark.parametrize("solver", ["scipy", "numba"])
def test_a_block_that_is_left_alone_comes_to_rest(run_with: Any, solver: str, texts: Any) -> None:
    tilted_left = any("-0.2" in text for text in texts)
    # On the steep floor that falls to the left it is let go so near the upright that it does not go over.
    theta = 0.002 if tilted_left else 0.05
    run = run_with(*texts, theta=theta, t_end=60.0, solver=solver, rtol=1e-9, atol=1e-12)
    assert run.outcome is Outcome.AT_REST
    assert abs(run.omega[-1]) == 0.0 == abs(run.theta[-1])
