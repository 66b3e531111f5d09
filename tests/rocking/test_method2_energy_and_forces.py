"""Method 2 along whole runs: energy that never grows, and contact forces read back from the path by differences."""

import math
from typing import Any

import numpy as np
import pytest

from rocking import Block, Method2, Mode, solve
from rocking.trajectory import BALANCE

G = 9.81


def centre(block: Block, y: Any, s: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(x, z, x', z') of the centre of mass from the state of corner s, rows of y."""
    x, z, theta, u, v, omega = np.asarray(y, float).T
    # The corner is at (s b/2, -h/2) in the block, turned clockwise; a clockwise spin moves it by omega (r_z, -r_x).
    X, Z = 0.5 * s * block.b, -0.5 * block.h
    r_x, r_z = X * np.cos(theta) + Z * np.sin(theta), -X * np.sin(theta) + Z * np.cos(theta)
    return x - r_x, z - r_z, u - omega * r_z, v + omega * r_x


def energy(block: Block, y: Any, s: Any) -> np.ndarray:
    """Kinetic and potential energy per mass over a base at rest."""
    _, z, x_dot, z_dot = centre(block, y, s)
    rho2 = (block.b**2 + block.h**2) / 12.0
    return 0.5 * (x_dot**2 + z_dot**2 + rho2 * np.asarray(y)[:, 5] ** 2) + G * z


def random_system(rng: np.random.Generator) -> tuple[Method2, Any]:
    """A block with random size, friction and restitution, and a random start that leans, slides or flies."""
    block = Block(b=float(rng.uniform(0.1, 0.8)), h=float(rng.uniform(0.3, 1.0)))
    mu = float(rng.uniform(0.05, 1.25))
    system = Method2(
        block,
        friction=mu,
        kinetic_friction=mu * float(rng.uniform(0.6, 1.0)),
        normal_restitution=float(rng.choice([0.0, rng.uniform(0.0, 0.9)])),
        tangential_restitution=float(rng.choice([0.0, rng.uniform(-1.0, 1.0)])),
        chatter_time=1e-4,
        g=G,
    )
    kind = rng.integers(3)
    theta = float(rng.uniform(-1.0, 1.0)) * block.alpha
    if kind == 0:
        initial = system.initial_state(theta=theta, u=float(rng.normal()) * 0.5, omega=float(rng.normal()))
    elif kind == 1:
        initial = system.initial_state(u=float(rng.normal()))
    else:
        initial = system.initial_state(
            theta=theta * float(rng.integers(2)), z=0.1, u=float(rng.normal()), omega=float(rng.normal())
        )
    return system, initial


# Chatterjee & Ruina (1998) and Coulomb: neither an impact nor friction gives energy.  Energies are compared between the
# states after events, which are true steps: steps of relative error 1e-11, a thousand at most between two events, on
# an energy of some 10 J/kg.
@pytest.mark.parametrize("seed", range(10))
def test_free_motion_through_all_modes_never_gains_energy(seed: int) -> None:
    rng = np.random.default_rng(seed)
    spent = np.zeros(len(Mode))
    for _ in range(40):
        system, initial = random_system(rng)
        times = np.linspace(0.0, 2.0, 101)
        run = solve(system, initial=initial, t_end=2.0, save_at=times, rtol=1e-11, atol=1e-14, max_events=5000)
        assert run.reason == "", f"{run} from {initial} by {system}"
        real = run.events.guard != BALANCE
        states = np.vstack([np.array(initial[0])[None], run.events.y_after[real]])
        corners = np.concatenate([[initial[1].s], run.events.s_after[real]])
        values = energy(system.block, states, corners)
        growth = float(np.max(np.diff(values), initial=-math.inf))
        assert growth < 1e-8, f"{growth} J/kg from {initial} by {system}"
        # The other corner is at -s b from the carrying one, turned by theta: neither is ever below the floor.
        height = run.y[:, 1] + np.minimum(0.0, run.s * system.block.b * np.sin(run.theta))
        assert height.min() > -1e-9, f"{height.min()} m from {initial} by {system}"
        spent += run.mode_durations()
    assert np.all(spent[[Mode.SLIDE, Mode.ROTATION, Mode.SLIDE_ROTATION, Mode.ROTATION_JUMP]] > 0.0)
    assert spent[Mode.REST] > 0.0


def interior(run: Any, step: float) -> np.ndarray:
    """Samples whose neighbours belong to the same mode and corner, with no event near."""
    away = np.ones(len(run.t), bool)
    for t in run.events.t[run.events.guard != BALANCE]:
        away &= np.abs(run.t - t) > 2.5 * step
    same = np.zeros(len(run.t), bool)
    same[1:-1] = (run.mode[1:-1] == run.mode[:-2]) & (run.mode[1:-1] == run.mode[2:])
    return np.flatnonzero(away & same)


# Newton: F = x'' + a_x and N = z'' + g + a_z per mass, from the path of the centre of mass by central differences; they
# must turn the block, rho2 omega' = r_z F - r_x N, and obey Coulomb in each mode.  Differences over 2e-4 s leave
# step^2/6 of the third derivative of a velocity, which jerks of up to 1e3 m/s^3 and spins of 10/s keep below 1e-3.
@pytest.mark.parametrize("solver", ["numba", "scipy"])
@pytest.mark.parametrize(
    ("ratio", "mu_s", "mu_k", "e_n", "strength"),
    [(0.25, 0.5, 0.4, 0.3, 6.0), (0.25, 0.22, 0.2, 0.0, 4.0), (0.3, 1.2, 1.0, 0.5, 9.0), (0.6, 0.5, 0.45, 0.2, 9.0)],
)
def test_forces_read_back_from_the_path_obey_newton_and_coulomb(
    window: Any, ratio: float, mu_s: float, mu_k: float, e_n: float, strength: float, solver: str
) -> None:
    block = Block(b=ratio * 0.8, h=0.8)
    system = Method2(block, friction=mu_s, kinetic_friction=mu_k, normal_restitution=e_n, chatter_time=1e-4, g=G)
    motion = window(0.0, 2.0, x=(0.0, strength, 15.0, 0.0), z=(0.0, 4.0, 23.0, 0.7))
    motion.max_step = 2e-3  # for the dense output, which the differences are taken of
    step = 1e-4
    times = np.arange(0.0, 1.2, step)
    run = solve(system, motion, t_end=1.2, save_at=times, solver=solver, rtol=1e-10, max_events=5000)
    assert run.reason == ""
    i = interior(run, step)
    seen = set(run.mode[i].tolist())
    assert len(seen) >= 2
    _, _, x_dot, z_dot = centre(block, run.y, run.s)

    def slope(values: np.ndarray) -> np.ndarray:
        return (values[i + 1] - values[i - 1]) / (2.0 * step)

    a = np.array([motion(float(t)) for t in run.t[i]])
    F, N = slope(x_dot) + a[:, 0], slope(z_dot) + G + a[:, 1]
    theta, s, mode = run.theta[i], run.s[i], run.mode[i]
    X, Z = 0.5 * s * block.b, -0.5 * block.h
    r_x, r_z = X * np.cos(theta) + Z * np.sin(theta), -X * np.sin(theta) + Z * np.cos(theta)
    rho2 = (block.b**2 + block.h**2) / 12.0
    torque = rho2 * slope(run.omega)
    one_corner = np.isin(mode, [Mode.ROTATION, Mode.SLIDE_ROTATION])
    np.testing.assert_allclose((r_z * F - r_x * N)[one_corner], torque[one_corner], rtol=0.0, atol=1e-3)
    flying = np.isin(mode, [Mode.TRANSLATION_JUMP, Mode.ROTATION_JUMP])
    np.testing.assert_allclose(np.stack([F, N])[:, flying], 0.0, atol=1e-3)
    assert np.all(N[~flying] > -1e-3)
    # Height and slope of the path agree with its velocities: x' = u and z' = v for the corner.
    np.testing.assert_allclose(slope(run.y[:, 0]), run.y[i, 3], rtol=0.0, atol=1e-4)
    np.testing.assert_allclose(slope(run.theta), run.omega[i], rtol=0.0, atol=1e-4)
    sliding = np.isin(mode, [Mode.SLIDE, Mode.SLIDE_ROTATION])
    u = run.y[i, 3]
    moving = sliding & (np.abs(u) > 1e-6)
    np.testing.assert_allclose(F[moving], -np.sign(u[moving]) * mu_k * N[moving], rtol=0.0, atol=1e-3)
    sticking = np.isin(mode, [Mode.REST, Mode.ROTATION])
    np.testing.assert_array_equal(u[sticking], 0.0)
    assert np.all(np.abs(F[sticking]) <= mu_s * N[sticking] + 1e-3)
    # Both corners stay above the floor.
    low = run.y[:, 1] + np.minimum(0.0, run.s * block.b * np.sin(run.theta))
    assert low.min() > -1e-7
