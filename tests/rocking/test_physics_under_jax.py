"""The physics is written once: the same functions traced and compiled by JAX give what plain floats give."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from rocking import Block, Method1, Method2, Mode, scalars
from rocking.hybrid import Base, Discrete

jax = pytest.importorskip("jax")

G = 9.81
BLOCK = Block(b=0.25, h=0.8)
SYSTEMS = {
    "method 1, nonlinear": Method1(BLOCK, g=G),
    "method 1, linear": Method1(BLOCK, form="linear", restitution=0.9, g=G),
    "method 2, frictional": Method2(BLOCK, friction=0.5, kinetic_friction=0.4, normal_restitution=0.3, g=G),
    "method 2, plastic": Method2(BLOCK, friction=0.25, tangential_restitution=0.4, g=G),
    "method 2, kinematic": Method2(BLOCK, friction=0.5, normal_restitution=0.2, impact_law="kinematic", g=G),
    "method 2, two corners": Method2(BLOCK, friction=1.0, impact_law="two_corner", restitution=0.95, g=G),
    "method 2, infinite friction": Method2(BLOCK, friction=math.inf, g=G),
}


def random_states(system: Any, n: int) -> tuple[np.ndarray, ...]:
    """(y, mode, s, slip, a_x, a_z, k) for n random instants, some of them upright, still or on the floor."""
    rng = np.random.default_rng(7)
    y = rng.normal(size=(n, len(system.state_names))) * 0.5
    y[rng.uniform(size=y.shape) < 0.2] = 0.0
    modes = [Mode.REST, Mode.ROTATION] if system.name == "method1" else list(Mode)
    mode = rng.choice(modes, n)
    if system.name == "method2":
        # A corner that flies has no exact zero for a velocity, whose sign would be one of rounding.
        y[:, 4] = np.where(mode >= Mode.TRANSLATION_JUMP, rng.normal(size=n), y[:, 4])
    return (
        y, mode, rng.choice([-1.0, 1.0], n), rng.choice([-1.0, 1.0], n),
        rng.normal(size=n) * 6.0 * (rng.uniform(size=n) < 0.9), rng.normal(size=n) * 6.0,
        rng.integers(1, len(system.guard_names), n),
    )  # fmt: skip


def calls(xp: Any, system: Any) -> dict[str, Callable[..., Any]]:
    """The four functions of a system in an array namespace, each of (y, mode, s, slip, a_x, a_z, k)."""

    def flow(y: Any, mode: Any, s: Any, slip: Any, a_x: Any, a_z: Any, k: Any) -> Any:
        return system.flow(xp, y, Discrete(mode, s, slip), Base(a_x, a_z), system.parameters)

    def guards(y: Any, mode: Any, s: Any, slip: Any, a_x: Any, a_z: Any, k: Any) -> Any:
        return system.guards(xp, y, Discrete(mode, s, slip), Base(a_x, a_z), system.parameters)

    def jump(y: Any, mode: Any, s: Any, slip: Any, a_x: Any, a_z: Any, k: Any) -> Any:
        after, q = system.jump(xp, y, Discrete(mode, s, slip), Base(a_x, a_z), system.parameters, k)
        return (*after, q.mode, q.s, q.slip)

    def balance(y: Any, mode: Any, s: Any, slip: Any, a_x: Any, a_z: Any, k: Any) -> Any:
        return (system.balance(xp, y, system.parameters),)

    return {"flow": flow, "guards": guards, "jump": jump, "balance": balance}


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("function", ["flow", "guards", "jump", "balance"])
def test_traced_physics_equals_plain_physics(name: str, function: str) -> None:
    system = SYSTEMS[name]
    states = random_states(system, 400)
    plain = calls(scalars, system)[function]
    expected = [plain(y.tolist(), *(v.item() for v in rest)) for y, *rest in zip(*states, strict=True)]
    with jax.enable_x64(True):
        traced = jax.jit(jax.vmap(calls(jax.numpy, system)[function]))
        found = np.stack([np.broadcast_to(np.asarray(part, float), 400) for part in traced(*states)], axis=1)
    # Two libraries' sines and another order of sums: rounding of numbers below 1e3.
    np.testing.assert_allclose(found, np.array(expected, float), rtol=1e-11, atol=1e-11)


def test_a_derivative_of_the_flow_is_the_derivative_of_newtons_law() -> None:
    # d omega'/d theta of omega' = -p^2 [s sin(alpha - s theta) + (a_x/g) cos(alpha - s theta)], by hand.
    system, s, theta, a_x = SYSTEMS["method 1, nonlinear"], -1.0, -0.1, 1.3
    with jax.enable_x64(True):
        slope = jax.grad(
            lambda tilt: system.flow(
                jax.numpy, (tilt, 0.3), Discrete(int(Mode.ROTATION), s, 1.0), Base(a_x, 0.0), system.parameters
            )[1]
        )(theta)
    p2, psi = 0.75 * G / (0.5 * math.hypot(0.25, 0.8)), math.atan(0.25 / 0.8) - s * theta
    assert float(slope) == pytest.approx(p2 * (math.cos(psi) - s * a_x / G * math.sin(psi)), rel=1e-12)
