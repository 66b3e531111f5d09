"""Corners on springs that friction holds: what it lets slip, what that takes, and distinct elements with friction."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import simpson

import dem
from rocking import Block, Method1, Mode, solve
from rocking.effects import compose, parse

from .springs import BLOCK, feet, on_springs

G = 9.80665


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_floor_pushed_harder_than_friction_holds_slips_away_under_the_block(side: float, constant: Any) -> None:
    """x'' = -(a - mu g): Coulomb's law on both corners, whatever each of them carries."""
    mu, a = 0.12, 0.2 * G  # under b/h = 0.3: it does not tip
    run = on_springs(2e6, 0.3, mu, motion=constant(side * a), t_end=0.6, save_at=[0.4, 0.6], rtol=1e-10, atol=1e-13)
    assert np.all(run.mode == Mode.REST)
    assert run.y[1, 3] - run.y[0, 3] == pytest.approx(-side * (a - mu * G) * 0.2, rel=1e-6)


@pytest.mark.parametrize(
    "floor",
    [
        ["compliant_base.corner_stiffness=2e6", "compliant_base.damping_ratio=0.3"],
        ["bouncing.normal_restitution=0.3", "bouncing.contact_frequency=150"],
    ],
)
def test_sliding_beside_a_floor_that_gives_is_the_friction_of_its_corners(floor: list[str], constant: Any) -> None:
    """x'' = -(a - mu g), and the same run as of a floor that has the friction itself, however effects are ordered."""
    mu, a = 0.12, 0.2 * G
    own = [*floor, f"{floor[0].partition('.')[0]}.friction={mu}"]
    given: Any = {"t_end": 0.6, "save_at": [0.4, 0.6], "rtol": 1e-10, "atol": 1e-13}
    runs = [
        solve(Method1(BLOCK), constant(a), effects=parse(texts), **given)
        for texts in ([*floor, f"sliding.friction={mu}"], [f"sliding.friction={mu}", *floor], own)
    ]
    assert runs[0].y[1, 3] - runs[0].y[0, 3] == pytest.approx(-(a - mu * G) * 0.2, rel=1e-6)
    for run in runs[1:]:
        np.testing.assert_array_equal(run.y, runs[0].y)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_floor_pushed_less_keeps_the_block_where_its_springs_let_it_go(side: float, constant: Any) -> None:
    mu, a, k, ratio = 0.9, 0.1 * G, 2e6, 0.5  # no foot lifts, though it is pushed at once
    run = on_springs(k, 0.3, mu, ratio, motion=constant(side * a), t_end=1.0, save_at=[0.9, 1.0])
    # Both springs along the floor hold m a; the block leans over them.
    middle = run.y[-1, 0] - 0.25 * math.sin(run.y[-1, 2])
    assert run.y[-1, 3] == pytest.approx(0.0, abs=1e-9)
    assert middle == pytest.approx(-side * BLOCK.mass * a / (2.0 * ratio * k), rel=1e-3)


# Kinetic + potential + springs + what dashpots and friction have taken, and what is left in a spring as its foot lifts.
@pytest.mark.parametrize(("mu", "ratio"), [(0.15, 1.0), (0.4, 1.0), (2.0, 1.0), (0.4, 5.0)])
def test_energy_and_what_dashpots_and_friction_take_add_up(mu: float, ratio: float) -> None:
    k, xi = 1e6, 0.1
    t = np.linspace(0.0, 0.45, 90001)
    run = on_springs(k, xi, mu, ratio, theta=0.1, t_end=0.45, save_at=t, rtol=1e-12, atol=1e-15)
    m, c = BLOCK.mass, 2.0 * xi * math.sqrt(k * BLOCK.mass)
    k_t, c_t = ratio * k, 2.0 * xi * math.sqrt(ratio * k * BLOCK.mass)

    _, z, _, u, v, omega = run.y.T[:6]
    energy = 0.5 * m * (u**2 + v**2) + 0.5 * BLOCK.I_c * omega**2 + m * G * z
    power, by_friction, lost = np.zeros_like(energy), np.zeros_like(energy), 0.0
    for side, name in ((1.0, "right_lifts"), (-1.0, "left_lifts")):
        q, height, foot_u, foot_v = feet(run.y, side)
        on = (run.mode == Mode.REST) | ((run.mode == Mode.ROTATION) & (run.s == side))
        energy += np.where(on, 0.5 * (k * height**2 + k_t * q**2), 0.0)
        N = np.maximum(-k * height - c * foot_v, 0.0)
        # Spring and dashpot together are as long as the slider lets them be.
        F = np.clip(-k_t * q - c_t * foot_u, -mu * N, mu * N)
        stretching = -(F + k_t * q) / c_t
        slipping = foot_u - stretching
        power += np.where(on, -(N + k * height) * foot_v + c_t * stretching**2 - F * slipping, 0.0)
        by_friction += np.where(on, -F * slipping, 0.0)
        lifts = run.events.y_before[run.events.guard == run.system.guard_names.index(name)]
        lost += float(np.sum(0.5 * k_t * feet(lifts, side)[0] ** 2))
    taken, edges = 0.0, [0.0, *run.events.t, 0.45]
    for start, stop in pairwise(edges):
        i = np.flatnonzero((run.t > start) & (run.t < stop))
        if i.size > 2:
            taken += simpson(power[i], x=run.t[i])
            taken += power[i[0]] * (run.t[i[0]] - start) + power[i[-1]] * (stop - run.t[i[-1]])
    swing = m * G * (z[0] - run.y[:, 1].min())
    assert len(run.events) > 2
    assert np.all(by_friction > -1e-9 * m * G)
    assert simpson(by_friction, x=run.t) > 1e-4 * swing
    # To the quadrature, which meets kinks where a foot begins to slip.
    assert energy[-1] + taken + lost == pytest.approx(energy[0], abs=2e-6 * swing)


# The distinct element with Coulomb's law on spring and dashpot: while it slips its spring is cut to what friction gives
# and its dashpot is off, here they go back together.  The higher the friction, the shorter that is.
@pytest.mark.parametrize(("mu", "apart"), [(1.0, 5e-4), (3.0, 5e-5), (10.0, 2e-5)])
def test_the_more_friction_the_nearer_the_distinct_element_is(mu: float, apart: float) -> None:
    block, xi = Block(b=0.30, h=1.00, d=0.50), 0.02  # Block 1 of Winkler, Meguro & Yamazaki (1995), Table 1
    history = dem.simulate(
        dem.single_block(0.30, 1.00, 0.50, block.density), t_end=0.9, dt=5e-6, mu=mu, damping_ratio=xi, theta0=0.12,
        save_every=20,
    )  # fmt: skip
    t = history.time[history.time <= 0.9]
    run = on_springs(1.98e7, xi, mu, block=block, theta=0.12, t_end=0.9, save_at=t)
    without = on_springs(1.98e7, xi, math.inf, block=block, theta=0.12, t_end=0.9, save_at=t)
    off = np.abs(run.theta - history.theta[: t.size]).max()
    assert off < apart
    # Held until it leaves the floor a foot takes along what its spring holds.
    assert np.abs(without.theta - history.theta[: t.size]).max() > 2.0 * off


@pytest.mark.parametrize("solver", ["scipy", pytest.param("diffrax", marks=pytest.mark.slow)])
def test_solvers_agree(solver: str) -> None:
    at = np.arange(0.0, 0.4, 0.01)
    runs = [on_springs(1e6, 0.1, 0.4, theta=0.08, t_end=0.4, save_at=at, solver=s) for s in ("numba", solver)]
    assert len(runs[0].impact_times) > 0
    np.testing.assert_allclose(runs[1].theta, runs[0].theta, atol=1e-6)


@pytest.mark.parametrize("xi", [0.01, 0.8, 5.0])
def test_no_damping_makes_contacts_switch_without_end(xi: float) -> None:
    run = on_springs(1.98e7, xi, 0.7, theta=0.12, t_end=1.2)
    assert run.outcome.value != "failed"
    assert run.statistics["steps"] < 30_000


@pytest.mark.parametrize(
    ("texts", "said"),
    [
        (("friction=0",), "friction=0.0: want more than 0, or inf where the corners are held"),
        (("friction=0.5", "damping_ratio=0"), "damping_ratio=0.0: want more than 0 beside friction=0.5"),
    ],
)
def test_numbers_that_cannot_be_are_named(texts: tuple[str, ...], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        compose(Method1(BLOCK), parse([f"compliant_base.{t}" for t in ("corner_stiffness=1e6", *texts)]))
