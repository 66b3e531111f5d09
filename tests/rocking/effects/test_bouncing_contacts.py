"""Bouncing where contacts last: the spring and the dashpot that it stands for, and what it goes together with."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rocking import Block, Method1, Method2, solve
from rocking.effects import compose, load, parse
from rocking.hybrid import REST, Base, Discrete
from rocking.soft_floor import BlockOnSoftFloor, foot

BLOCK = Block(b=0.174, h=0.85, d=0.265)
METHOD = Method1(BLOCK)
AT_REST = Base(0.0, 0.0, 0.0, 0.0)


def contact(e_n, frequency=250.0):
    return load("bouncing")(normal_restitution=e_n, contact_frequency=frequency)


def test_the_spring_has_the_frequency_that_the_corner_feels():
    made = compose(METHOD, [contact(0.8)])
    assert isinstance(made, BlockOnSoftFloor)
    # The corner feels 1 / (1/m + b^2 / I) with half of the breadth and I = m (b^2 + h^2) / 12 of a rectangle.
    felt = BLOCK.mass / (1.0 + 0.087**2 / ((0.174**2 + 0.85**2) / 12.0))
    assert made.corner_stiffness == pytest.approx(felt * (500.0 * math.pi) ** 2, rel=1e-12)
    # Half a period of the damped oscillation leaves exp(-pi zeta / sqrt(1 - zeta^2)) of the speed.
    zeta = made.damping_ratio * math.sqrt(BLOCK.mass / felt)
    assert math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta**2)) == pytest.approx(0.8, rel=1e-12)


@pytest.mark.parametrize("e_n, zeta", [(1.0, 0.0), (0.0, 1.0)])
def test_ends_of_the_restitution(e_n, zeta):
    made = compose(METHOD, [contact(e_n)])
    felt = made.corner_stiffness / (500.0 * math.pi) ** 2
    assert made.damping_ratio * math.sqrt(BLOCK.mass / felt) == pytest.approx(zeta, abs=1e-12)


@pytest.mark.parametrize("e_n", [0.9, 0.6, 0.3])
def test_a_block_that_comes_down_flat_leaves_as_schwager_and_poeschel_have_it(e_n):
    """Granular Matter 9 (2007) 465-469: a linear dashpot that does not pull, for two corners and the whole mass."""
    made = compose(Method1(BLOCK, g=1e-9), [contact(e_n)])
    par, on_both = made.parameters, Discrete(REST, 1.0, 0.0)

    def rate(_, y):
        return np.array(made.flow(np, y, on_both, AT_REST, par), dtype=float)

    def left(_, y):
        return foot(np, y, 1.0, par).height

    left.terminal, left.direction = True, 1.0
    start = np.array([0.0, par.H - 1e-12, 0.0, 0.0, -0.1, 0.0, par.a, -par.a])
    run = solve_ivp(rate, (0.0, 0.1), start, events=left, rtol=1e-10, atol=1e-15, max_step=1e-5)
    zeta = math.sqrt(2.0) * made.damping_ratio  # c / (m w) with w^2 = 2 k / m
    root = math.sqrt(1.0 - zeta**2)
    closed = math.exp(-zeta / root * (math.pi - math.atan2(2.0 * zeta * root, 1.0 - 2.0 * zeta**2)))
    assert run.y_events[0][0][4] / 0.1 == pytest.approx(closed, rel=1e-5)


def test_a_hard_contact_keeps_more_of_a_swing_the_less_it_damps():
    peaks = []
    for e_n in (0.2, 0.5, 0.8):
        run = solve(METHOD, theta=0.12, t_end=1.2, save_at=np.arange(0.0, 1.2, 0.002), effects=[contact(e_n)])
        peaks.append(-run.theta.min())
    assert 0.06 < peaks[0] < peaks[1] < peaks[2] < 0.12


@pytest.mark.parametrize("solver", ["scipy", "diffrax"])
def test_solvers_agree(solver):
    at = np.arange(0.0, 0.5, 0.01)
    runs = [
        solve(METHOD, theta=0.05, t_end=0.5, save_at=at, effects=[contact(0.6)], solver=name)
        for name in ("numba", solver)
    ]
    assert len(runs[0].impact_times) > 0
    np.testing.assert_allclose(runs[1].theta, runs[0].theta, atol=2e-6)


def test_what_it_goes_together_with():
    assert isinstance(compose(METHOD, [contact(0.5), *parse(["viscous_damping.coefficient=0.1"])]), BlockOnSoftFloor)
    assert isinstance(compose(METHOD, parse(["bouncing.normal_restitution=0.4"])), Method2)
    for other, said in [
        ("rounded_edges.radius=0.01", "it does not go together with rounded_edges"),
        ("base_adhesion.moment=1.0", "it does not go together with base_adhesion"),
        ("compliant_base.corner_stiffness=1e7", "it does not go together with"),
    ]:
        with pytest.raises(ValueError, match=said):
            compose(METHOD, [contact(0.5), *parse([other])])


def test_bad_numbers_are_named():
    with pytest.raises(ValueError, match=r"bouncing\.friction=0\.0: want more than 0 beside bouncing\.contact"):
        compose(METHOD, parse(["bouncing.friction=0", "bouncing.contact_frequency=250"]))
    with pytest.raises(ValueError, match=r"sliding\.friction=0\.4: bouncing\.friction=0\.5 says it too"):
        compose(METHOD, parse(["sliding.friction=0.4", "bouncing.friction=0.5", "bouncing.contact_frequency=250"]))
    with pytest.raises(ValueError, match=r"bouncing\.normal_restitution=1\.0: want less than 1 beside"):
        compose(METHOD, [load("bouncing")(normal_restitution=1.0, friction=0.5, contact_frequency=250.0)])
    with pytest.raises(ValueError, match=r"bouncing\.contact_frequency=-1\.0 Hz: want 0 to inf"):
        parse(["bouncing.contact_frequency=-1"])
    for soft in (0.0, 0.3):
        with pytest.raises(ValueError, match=rf"bouncing\.contact_frequency={soft} Hz: corner_stiffness"):
            compose(METHOD, parse([f"bouncing.contact_frequency={soft}"]))
