"""Corners whose springs along the floor friction limits: Coulomb's law, energy, distinct elements, solvers."""

import math
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numba import njit
from scipy.integrate import simpson

import dem
from rocking import Block, Method1, Mode
from rocking.effects import compose, parse
from rocking.hybrid import Base, Discrete
from rocking.spring_slider import BlockOnSlidingSprings

from . import springs
from .springs import BLOCK, feet

G = 9.80665
on_springs = partial(springs.on_springs, slider=1.0)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_floor_pushed_harder_than_friction_holds_slips_away_under_the_block(side: float, constant: Any) -> None:
    """x'' = -(a - mu g): Coulomb's law on both corners, whatever each of them carries."""
    mu, a = 0.12, 0.2 * G  # under b/h = 0.3: it does not tip
    run = on_springs(2e6, 0.3, mu, motion=constant(side * a), t_end=0.6, save_at=[0.4, 0.6], rtol=1e-10, atol=1e-13)
    assert np.all(run.mode == Mode.REST)
    assert run.y[1, 3] - run.y[0, 3] == pytest.approx(-side * (a - mu * G) * 0.2, rel=1e-6)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_foot_that_turns_back_is_pulled_by_a_spring_stretched_as_far_as_friction_lets_it(
    side: float, constant: Any
) -> None:
    """Where the push that made both feet slip ends, they stick again, with all of mu m g in their springs at first.

    The block then swings on them along the floor, about where they pull no more.
    """
    mu, a, k = 0.12, 0.2 * G, 2e6
    run = on_springs(k, 0.05, mu, motion=constant(side * a), t_end=0.3, rtol=1e-10, atol=1e-13)
    y, q = run.y[-1], Discrete(int(run.mode[-1]), float(run.s[-1]), 0.0)
    assert q.mode == Mode.REST
    system = run.system
    # Brought to a stand where it is: no velocity of feet or block.
    still = (*map(float, y[:3]), 0.0, 0.0, 0.0, *map(float, y[6:]))
    rate = system.flow(np, still, Discrete(q.mode, q.s, 0.0), Base(0.0, 0.0, 0.0, 0.0), system.parameters)
    assert rate[3] == pytest.approx(side * mu * G, rel=1e-3)


# Kinetic + potential + what the floor has taken, of which its springs keep some.
@pytest.mark.parametrize(("mu", "ratio"), [(0.15, 1.0), (0.4, 1.0), (2.0, 1.0), (0.4, 5.0)])
def test_energy_and_what_dashpots_and_friction_take_add_up(mu: float, ratio: float) -> None:
    k, xi = 1e6, 0.1
    t = np.linspace(0.0, 0.45, 90001)
    run = on_springs(k, xi, mu, ratio, theta=0.1, t_end=0.45, save_at=t, rtol=1e-12, atol=1e-15)
    m, c = BLOCK.mass, 2.0 * xi * math.sqrt(k * BLOCK.mass)
    k_t, c_t = ratio * k, 2.0 * xi * math.sqrt(ratio * k * BLOCK.mass)

    _, z, _, u, v, omega = run.y.T[:6]
    energy = 0.5 * m * (u**2 + v**2) + 0.5 * BLOCK.I_c * omega**2 + m * G * z
    taken, stored = np.zeros_like(energy), np.zeros_like(energy)
    for side, name in ((1.0, "right_lifts"), (-1.0, "left_lifts")):
        q, height, foot_u, foot_v = feet(run.y, side)
        on = (run.mode == Mode.REST) | ((run.mode == Mode.ROTATION) & (run.s == side))
        N = np.maximum(-k * height - c * foot_v, 0.0)
        # Never stretched beyond what friction gives; places are integrated over kinks, where a foot ceases to push.
        assert np.all(np.abs(k_t * q[on]) <= mu * N[on] + 1e-5 * m * G)
        F = np.clip(-k_t * q - c_t * foot_u, -mu * N, mu * N)
        stored += np.where(on, 0.5 * (k * height**2 + k_t * q**2), 0.0)
        taken += np.where(on, -N * foot_v - F * foot_u, 0.0)
        # A foot that lifts has let go of its spring.
        lifts = run.events.y_before[run.events.guard == run.system.guard_names.index(name)]
        assert np.sum(0.5 * k_t * feet(lifts, side)[0] ** 2) < 1e-9 * m * G
    work, edges = 0.0, [0.0, *run.events.t, 0.45]
    for start, stop in pairwise(edges):
        i = np.flatnonzero((run.t > start) & (run.t < stop))
        if i.size > 2:
            work += simpson(taken[i], x=run.t[i])
            work += taken[i[0]] * (run.t[i[0]] - start) + taken[i[-1]] * (stop - run.t[i[-1]])
    swing = m * G * (z[0] - run.y[:, 1].min())
    assert len(run.events) > 2
    # What the floor took, to the quadrature, which meets kinks where a foot begins to slip.
    assert energy[-1] + work == pytest.approx(energy[0], abs=2e-6 * swing)
    # Dashpots and friction have had some of it.
    assert work - (stored[-1] - stored[0]) > 1e-4 * swing


def off(slider: float, mu: float, **numbers: Any) -> float:
    """Largest rotation [rad] by which a run is off that of a distinct element with the same contacts."""
    block, xi = Block(b=0.30, h=1.00, d=0.50), 0.02  # Block 1 of Winkler, Meguro & Yamazaki (1995), Table 1
    history = dem.simulate(
        dem.single_block(0.30, 1.00, 0.50, block.density), t_end=0.9, dt=5e-6, mu=mu, damping_ratio=xi, theta0=0.12,
        save_every=20,
    )  # fmt: skip
    t = history.time[history.time <= 0.9]
    run = on_springs(1.98e7, xi, mu, block=block, theta=0.12, t_end=0.9, save_at=t, slider=slider)
    return float(np.abs(run.theta - history.theta[: t.size]).max())


@njit
def stepped(  # type: ignore[no-untyped-def]
    theta, k, k_t, c, c_t, mu, m, inertia, half, high, steps, dt, every, out
):  # fmt: skip
    """Rotations of a block let go from its right corner, in equal steps.

    In each the shear forces that are stored grow by what corners move, and are cut in the store to mu times what the
    springs into the floor give; dashpots act beside them, those along the floor not where a force is cut.
    """
    sin, cos = np.sin(theta), np.cos(theta)
    x, z = half - (half * cos - high * sin), -m * 9.80665 / k + half * sin + high * cos
    u, v, omega = 0.0, 0.0, 0.0
    stored = np.zeros(2)
    for i in range(steps):
        if i % every == 0:
            out[i // every] = theta
        sin, cos = np.sin(theta), np.cos(theta)
        fx, fz, moment = 0.0, -m * 9.80665, 0.0
        for j in range(2):
            along = half if j else -half
            r_x, r_z = along * cos - high * sin, -along * sin - high * cos
            depth, foot_u, foot_v = -(z + r_z), u + omega * r_z, v - omega * r_x
            if depth <= 0.0:
                stored[j] = 0.0
                continue
            force = stored[j] - k_t * foot_u * dt
            cut = abs(force) > mu * k * depth
            stored[j] = min(max(force, -mu * k * depth), mu * k * depth)
            N, F = max(k * depth - c * foot_v, 0.0), stored[j] - (0.0 if cut else c_t * foot_u)
            fx, fz, moment = fx + F, fz + N, moment + r_z * F - r_x * N
        u, v, omega = u + fx / m * dt, v + fz / m * dt, omega + moment / inertia * dt
        x, z, theta = x + u * dt, z + v * dt, theta + omega * dt


@pytest.mark.parametrize(("mu", "ratio"), [(0.5, 1.0), (1.2, 0.7)])
def test_friction_of_the_springs_alone_is_that_of_forces_stored_and_cut_in_steps(mu: float, ratio: float) -> None:
    k, xi, dt, every = 1e7, 0.07, 4e-7, 2500
    m, steps = BLOCK.mass, 1_500_000
    c, c_t = 2.0 * xi * math.sqrt(k * m), 2.0 * xi * math.sqrt(ratio * k * m)
    out = np.empty(steps // every)
    stepped(0.12, k, ratio * k, c, c_t, mu, m, BLOCK.I_c, 0.075, 0.25, steps, dt, every, out)
    at = dt * every * np.arange(out.size)
    off = {
        s: float(np.abs(on_springs(k, xi, mu, ratio, theta=0.12, t_end=0.6, save_at=at, slider=s).theta - out).max())
        for s in (1.0, 2.0)
    }
    assert off[2.0] < 5e-6 < 0.01 * off[1.0]


# Its spring is cut to what friction gives, too; of its dashpot none is left while it slips, here what friction leaves.
@pytest.mark.parametrize(("mu", "apart"), [(0.7, 1e-4), (1.0, 1e-4)])
def test_it_is_the_distinct_element_by_far_nearer_than_a_slider_in_series(mu: float, apart: float) -> None:
    nearer = off(1.0, mu)
    assert nearer < apart
    assert off(0.0, mu) > 3.0 * nearer


@pytest.mark.parametrize("spread", [0.0, 0.5])
@pytest.mark.parametrize("solver", ["scipy", pytest.param("diffrax", marks=pytest.mark.slow)])
def test_solvers_agree(solver: str, spread: float) -> None:
    at = np.arange(0.0, 0.4, 0.01)
    runs = [
        on_springs(1e6, 0.1, 0.4, theta=0.08, t_end=0.4, save_at=at, solver=s, spread=spread) for s in ("numba", solver)
    ]
    assert "left_slips" in {runs[0].system.guard_names[k] for k in runs[0].events.guard if k >= 0}
    np.testing.assert_allclose(runs[1].theta, runs[0].theta, atol=1e-6)


@pytest.mark.parametrize("slider", [1.0, 2.0])
@pytest.mark.parametrize("xi", [0.0, 0.01, 0.8, 5.0])
def test_no_damping_makes_contacts_switch_without_end(xi: float, slider: float) -> None:
    run = on_springs(1.98e7, xi, 0.7, theta=0.12, t_end=1.2, slider=slider)
    assert run.outcome.value != "failed"
    assert run.statistics["steps"] < 60_000


def test_more_friction_than_any_push_asks_for_is_the_slider_in_series() -> None:
    """But for the instants in which contacts end, where what friction gives goes to nothing."""
    at = np.arange(0.0, 1.0, 0.01)
    one, other = (on_springs(1e6, 0.1, 1e4, theta=0.08, t_end=1.0, save_at=at, slider=s).theta for s in (0.0, 1.0))
    np.testing.assert_allclose(one, other, atol=1e-6)


def test_a_run_goes_on_from_a_state_of_it() -> None:
    """Which feet slip is not kept with samples: it follows from the state."""
    at = np.linspace(0.0, 0.6, 1201)
    whole = on_springs(1e6, 0.1, 0.4, theta=0.08, t_end=0.6, save_at=at, rtol=1e-10, atol=1e-13)
    system = whole.system
    assert isinstance(system, BlockOnSlidingSprings)
    slid = np.isin(whole.events.guard, [5, 6])
    k = int(np.searchsorted(at, whole.events.t[slid][3])) + 1
    y, q = system.initial_state(
        float(whole.theta[k]), float(whole.omega[k]), (whole.y[k], Discrete(int(whole.mode[k]), float(whole.s[k]), 1.0))
    )
    np.testing.assert_allclose(y, whole.y[k], atol=1e-15)
    assert (q.mode, q.slip) == (whole.mode[k], 0.0)


@pytest.mark.parametrize(
    ("texts", "said"),
    [
        (("compliant_base.spring_slider=1",), "friction=inf: want it finite where friction limits the springs"),
        (("compliant_base.spring_slider=0.5",), r"compliant_base\.spring_slider=0\.5: want 0, 1 or 2"),
        (
            ("compliant_base.spring_slider=1", "compliant_base.tangential_ratio=inf"),
            r"compliant_base\.spring_slider=1\.0: want 0 beside compliant_base\.tangential_ratio=inf",
        ),
    ],
)
def test_numbers_that_do_not_go_together_are_named(texts: tuple[str, ...], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        compose(Method1(BLOCK), parse(["compliant_base.corner_stiffness=1e6", *texts]))
    with pytest.raises(ValueError, match=r"bouncing\.spring_slider=0\.5: want 0, 1 or 2"):
        compose(Method1(BLOCK), parse(["bouncing.contact_frequency=250", "bouncing.spring_slider=0.5"]))
