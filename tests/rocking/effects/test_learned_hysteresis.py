"""A torque that slips and creeps (rocking.hysteretic), by closed forms, by hand and by another effect's code."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rocking import Block, Method1, solve
from rocking.effects import compose, load
from rocking.hybrid import Base

G = 9.81
BLOCK = Block(b=0.2, h=0.8)
STIFF = 0.3 * BLOCK.mass * G * BLOCK.R  # N m/rad
STILL = Base(0.0, 0.0)


def effect(**given: float):
    return load("learned_hysteresis")(stiffness=STIFF, **given)


def test_on_the_way_down_the_strain_follows_dahls_curve() -> None:
    """Toward upright z = -w + (z0 + w) exp(-(theta0 - theta) / w), however fast."""
    w, times = 0.04, np.linspace(0.0, 0.3, 13)
    run = solve(Method1(BLOCK), theta=0.15, t_end=0.3, effects=[effect(width=w, strained=0.5)], save_at=times)
    assert not len(run.impact_times)
    z0 = 0.5 * w * (1.0 - math.exp(-0.15 / w))
    assert run.y[0, 2] == pytest.approx(z0, rel=1e-12)
    expected = -w + (z0 + w) * np.exp(-(0.15 - run.theta) / w)
    np.testing.assert_allclose(run.y[:, 2], expected, rtol=0.0, atol=1e-8)
    assert expected[-1] < 0.0 < expected[0]


def test_with_an_exponent_of_two_the_strain_follows_tangents() -> None:
    """Toward upright dz/dtheta = 1 + |z| z / w^2: z = w tan before it changes sign, w tanh after, by hand."""
    w, times = 0.04, np.linspace(0.0, 0.3, 13)
    given = effect(width=w, strained=0.5, exponent=2.0)
    run = solve(Method1(BLOCK), theta=0.15, t_end=0.3, effects=[given], save_at=times)
    assert not len(run.impact_times)
    z0 = 0.5 * w * math.tanh(0.15 / w)
    assert run.y[0, 2] == pytest.approx(z0, rel=1e-12)
    way = math.atan(z0 / w) - (0.15 - run.theta) / w
    expected = w * np.where(way > 0.0, np.tan(np.maximum(way, 0.0)), np.tanh(way))
    np.testing.assert_allclose(run.y[:, 2], expected, rtol=0.0, atol=1e-8)
    assert expected[-1] < 0.0 < expected[0]


@pytest.mark.parametrize("n", [1.0, 1.5, 3.0, 20.0])
@pytest.mark.parametrize("turned", [1e-6, 0.3, 1.0, 4.0, 500.0])
def test_a_slow_pull_strains_as_its_equation_says(n: float, turned: float) -> None:
    """dz/dx = 1 - z^n by another integrator, both over the width."""
    width = 0.1 / turned
    y, _ = compose(Method1(BLOCK), [effect(width=width, strained=1.0, exponent=n)]).initial_state(0.1)
    other = solve_ivp(lambda _x, z: 1.0 - z**n, (0.0, min(turned, 60.0)), [0.0], rtol=1e-11, atol=1e-14)
    assert y[2] / width == pytest.approx(other.y[0, -1], rel=1e-8)


@pytest.mark.parametrize("n", [1.0, 1.4, 3.0])
@pytest.mark.parametrize("lean", [0.15, -0.15])
def test_a_swing_is_that_of_the_equation_written_out(lean: float, n: float) -> None:
    """I_O theta'' = -+ m g R sin(alpha -+ theta) - k z, slipping and creeping at once, by another integrator."""
    width, time, times = 0.05, 0.4, np.linspace(0.0, 0.3, 9)
    given = effect(width=width, time=time, strained=1.0, exponent=n)
    run = solve(Method1(BLOCK, g=G), theta=lean, t_end=0.3, effects=[given], save_at=times)
    assert not len(run.impact_times)
    s, I_O = math.copysign(1.0, lean), BLOCK.I_c + BLOCK.mass * BLOCK.R**2

    def rates(_t: float, y: np.ndarray) -> tuple[float, float, float]:
        theta, omega, z = y
        weight = -s * BLOCK.mass * G * BLOCK.R * math.sin(BLOCK.alpha - s * theta)
        return (
            omega,
            (weight - STIFF * z) / I_O,
            omega - abs(omega) * z / width * abs(z / width) ** (n - 1.0) - z / time,
        )

    pull = solve_ivp(lambda _x, z: 1.0 - z**n, (0.0, abs(lean) / width), [0.0], rtol=1e-11, atol=1e-14)
    pulled = s * width * float(pull.y[0, -1])
    other = solve_ivp(rates, (0.0, 0.3), (lean, 0.0, pulled), t_eval=times, rtol=1e-11, atol=1e-13)
    np.testing.assert_allclose(run.y, other.y.T, rtol=0.0, atol=1e-8)


def test_what_never_slips_nor_creeps_is_a_spring() -> None:
    """Through impacts as well: the strain is the rotation, and `learned_term.spring` is the same torque."""
    I_O, times = BLOCK.I_c + BLOCK.mass * BLOCK.R**2, np.linspace(0.0, 3.0, 31)
    method = Method1(BLOCK, restitution=0.9)
    run = solve(method, theta=0.15, t_end=3.0, effects=[effect(strained=1.0)], save_at=times)
    spring = load("learned_term")(spring=-STIFF / I_O)
    other = solve(method, theta=0.15, t_end=3.0, effects=[spring], save_at=times)
    assert len(run.impact_times) == len(other.impact_times) >= 5
    np.testing.assert_allclose(run.theta, other.theta, rtol=0.0, atol=1e-7)
    np.testing.assert_allclose(run.y[:, 2], run.theta, rtol=0.0, atol=1e-7)


def test_in_a_block_at_rest_it_creeps_and_does_not_slip() -> None:
    system = compose(Method1(BLOCK), [effect(width=0.01, time=0.5)])
    y, q = system.initial_state(strain=0.02)
    assert system.flow(np, y, q, STILL, system.parameters) == pytest.approx((0.0, 0.0, -0.02 / 0.5))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_strain_tips_a_block_that_its_weight_does_not_hold(sign: float) -> None:
    """m g b / 2 = k z, toward the side that the strain pulls to."""
    system = compose(Method1(BLOCK, g=G), [effect()])
    holds = 0.5 * BLOCK.mass * G * BLOCK.b / STIFF
    for share, tips in ((0.999, False), (1.001, True)):
        y, q = system.initial_state(strain=-sign * share * holds)
        right, left = system.guards(np, y, q, STILL, system.parameters)[2:]
        assert bool((right if sign > 0.0 else left) < 0.0) is tips
        assert (left if sign > 0.0 else right) > 0.0


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"stiffness": -1.0}, r"learned_hysteresis.stiffness=-1.0 N m/rad: want 0 to 1e\+12"),
        ({"width": 0.0}, r"learned_hysteresis.width=0.0 rad: want 1e-09 to 1e\+09"),
        ({"exponent": 0.5}, r"learned_hysteresis.exponent=0.5 1: want 1 to 100"),
        ({"strained": 1.5}, r"learned_hysteresis.strained=1.5 1: want 0 to 1"),
    ],
)
def test_what_cannot_be_is_refused(given: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        load("learned_hysteresis")(**given)
