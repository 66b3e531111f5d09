"""The composed equations against Lagrange's, derived by computer algebra from positions in an inertial frame.

The base moves by (X, Z)(t) and turns by psi(t), clockwise, about the middle of where the block stands.  The edge on
which the block rolls has its centre at (s a, r) in the block and, as it rolls without slipping, at (s a + r theta, r)
over the floor.  That is all that goes in; nothing of `rocking.form` does.
"""

import math
from functools import cache, partial
from typing import Any

import numpy as np
import pytest
import sympy as sp

from rocking import Block, Method1, scalars
from rocking.composed import ComposedMethod1
from rocking.effects import compose, parse
from rocking.hybrid import REST, ROTATION, Base, Discrete, bind_hooks
from rocking.method1 import linear_flow, nonlinear_flow
from rocking.soft_floor import BlockOnSoftFloor

BLOCK = Block(b=0.2, h=0.8)
TIME = sp.Symbol("t")
SHAPE = sp.symbols("a r o H rho2 g s")
RATES = sp.symbols("theta omega base_x base_z psi psi_rate psi_acceleration")
SPRINGS = sp.symbols("k c touched_right touched_left")


def turned(angle: Any, x: Any, z: Any) -> tuple[Any, Any]:
    """(x, z) turned clockwise."""
    return x * sp.cos(angle) + z * sp.sin(angle), -x * sp.sin(angle) + z * sp.cos(angle)


def moving_base() -> tuple[Any, Any, Any]:
    return tuple(sp.Function(name)(TIME) for name in ("X", "Z", "psi"))  # type: ignore[return-value]


def plain(expression: Any, *coordinates: Any) -> Any:
    """The expression with symbols in place of functions of time and their derivatives."""
    X, Z, psi = moving_base()
    _, _, base_x, base_z, angle, rate, acceleration = RATES
    known = [(X.diff(TIME, 2), base_x), (Z.diff(TIME, 2), base_z)]
    known += [(psi.diff(TIME, 2), acceleration), (psi.diff(TIME), rate), (psi, angle)]
    return expression.subs([*coordinates, *known]).doit()


@cache
def rolling_acceleration() -> Any:
    """theta'' as a function of SHAPE and RATES."""
    a, r, o, H, rho2, g, s = SHAPE
    X, Z, psi = moving_base()
    theta = sp.Function("theta")(TIME)
    from_edge = turned(theta, o - s * a, H - r)
    over_floor = (s * a + r * theta + from_edge[0], r + from_edge[1])
    x, z = (base + part for base, part in zip((X, Z), turned(psi, *over_floor), strict=True))
    kinetic = (x.diff(TIME) ** 2 + z.diff(TIME) ** 2 + rho2 * (theta + psi).diff(TIME) ** 2) / 2
    lagrangian = kinetic - g * z
    equation = lagrangian.diff(theta.diff(TIME)).diff(TIME) - lagrangian.diff(theta)
    second = sp.Symbol("second")
    equation = plain(
        sp.expand(equation), (theta.diff(TIME, 2), second), (theta.diff(TIME), RATES[1]), (theta, RATES[0])
    )
    acceleration = -equation.subs(second, 0) / equation.diff(second)
    return sp.lambdify([*SHAPE, *RATES], acceleration)


FORMS = {
    "sharp": (),
    "rounded": ("rounded_edges.radius=0.03",),
    "off the middle": ("eccentric_mass.offset=0.02",),
    "top-heavy": ("mass_distribution.height=0.55", "mass_distribution.inertia=4.5"),
    "hollow": ("concave_base.breadth=0.15",),
    "all": (
        "rounded_edges.radius=0.02", "eccentric_mass.offset=-0.03", "mass_distribution.height=0.5",
        "mass_distribution.inertia=7", "concave_base.breadth=0.18",
    ),
}  # fmt: skip
SHAPES = {  # (a, r, o, H, rho2) by hand: a is half of the breadth less the radius, rho2 the inertia over the mass
    "sharp": (0.1, 0.0, 0.0, 0.4, (0.2**2 + 0.8**2) / 12.0),
    "rounded": (0.07, 0.03, 0.0, 0.4, (0.2**2 + 0.8**2) / 12.0),
    "off the middle": (0.1, 0.0, 0.02, 0.4, (0.2**2 + 0.8**2) / 12.0),
    "top-heavy": (0.1, 0.0, 0.0, 0.55, 4.5 / BLOCK.mass),
    "hollow": (0.075, 0.0, 0.0, 0.4, (0.2**2 + 0.8**2) / 12.0),
    "all": (0.07, 0.02, -0.03, 0.5, 7.0 / BLOCK.mass),
}


def composed(name: str) -> ComposedMethod1:
    system = compose(Method1(BLOCK), [*parse(FORMS[name]), *parse(["viscous_damping.coefficient=0"])])
    assert isinstance(system, ComposedMethod1)
    return system


def states(seed: int) -> tuple[float, ...]:
    """(s, theta, omega, a_x, a_z, psi, psi', psi'') of a base that shakes and pitches a little."""
    rng = np.random.default_rng(seed)
    s = float(rng.choice([-1.0, 1.0]))
    scales = (0.6, 2.0, 5.0, 3.0, 0.05, 0.5, 10.0)
    theta, *rest = (float(scale * rng.uniform(-1.0, 1.0)) for scale in scales)
    return s, s * abs(theta), *rest


def acceleration(system: Any, state: tuple[float, ...]) -> float:
    s, theta, omega, a_x, a_z, psi, _, psi_acceleration = state
    par = bind_hooks(system.parameters, lambda hook: partial(hook, scalars))
    base = Base(a_x, a_z, psi, psi_acceleration)
    return float(system.flow(scalars, (theta, omega), Discrete(ROTATION, s, 1.0), base, par)[1])


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("name", FORMS)
def test_composed_flow_is_lagranges_equation(name: str, seed: int) -> None:
    s, theta, omega, a_x, a_z, psi, _, psi_acceleration = state = states(seed)
    system = composed(name)
    truth = rolling_acceleration()(*SHAPES[name], system.g, s, theta, omega, a_x, a_z, psi, 0.0, psi_acceleration)
    assert acceleration(system, state) == pytest.approx(truth, rel=1e-12, abs=1e-12)


# What is left out of a pitching base is psi'^2 alone: Coriolis' force does no work on a block that only turns.
@pytest.mark.parametrize("name", FORMS)
def test_what_the_flow_leaves_out_is_the_square_of_the_pitch_rate_alone(name: str) -> None:
    s, theta, omega, a_x, a_z, psi, rate, psi_acceleration = state = states(11)
    system = composed(name)

    def missing(rate: float, omega: float) -> float:
        numbers = (theta, omega, a_x, a_z, psi, rate, psi_acceleration)
        mine = acceleration(system, (s, theta, omega, a_x, a_z, psi, rate, psi_acceleration))
        return float(rolling_acceleration()(*SHAPES[name], system.g, s, *numbers)) - mine

    once = missing(rate, omega)
    assert abs(once) > 1e-3
    assert missing(2.0 * rate, omega) == pytest.approx(4.0 * once, rel=1e-9)
    assert missing(-rate, omega) == pytest.approx(once, rel=1e-9)
    for other in (0.0, -omega, 5.0):
        assert missing(rate, other) == pytest.approx(once, rel=1e-9)
    # The centrifugal force psi'^2 (x, z), worked on by (dx, dz)/dtheta, over the inertia about the point of contact.
    a, r, o, H, rho2 = SHAPES[name]
    d_x, d_z = s * a + r * theta, r
    along, up = o - s * a, H - r
    cos, sin = math.cos(theta), math.sin(theta)
    x, z = d_x + along * cos + up * sin, d_z - along * sin + up * cos
    x_rate, z_rate = r - along * sin + up * cos, -along * cos - up * sin
    inertia = rho2 + x_rate**2 + z_rate**2
    assert once == pytest.approx(rate**2 * (x * x_rate + z * z_rate) / inertia, rel=1e-9)
    assert state[6] == rate


@pytest.mark.parametrize("seed", range(5))
def test_method_1_of_the_ideal_block_on_a_pitching_base_is_lagranges_equation(seed: int) -> None:
    s, theta, omega, a_x, a_z, psi, _, psi_acceleration = states(20 + seed)
    system = Method1(BLOCK)
    base = Base(a_x, a_z, psi, psi_acceleration)
    mine = nonlinear_flow(scalars, (theta, omega), Discrete(ROTATION, s, 1.0), base, system.parameters)[1]
    numbers = (theta, omega, a_x, a_z, psi, 0.0, psi_acceleration)
    truth = rolling_acceleration()(*SHAPES["sharp"], system.g, s, *numbers)
    assert mine == pytest.approx(truth, rel=1e-12, abs=1e-12)


# With sin -> its argument and cos -> 1 in alpha - s theta (eqs (2), (3)) a slender upright block's pitch term differs
# from the exact one by the third order of alpha: 0.75 (sin^2 - alpha^2) = -0.25 alpha^4.
@pytest.mark.parametrize("h", [0.8, 8.0])
def test_the_linear_block_feels_a_pitch_as_the_nonlinear_one_to_the_fourth_order_of_slenderness(h: float) -> None:
    block = Block(b=0.2, h=h)
    q, base = Discrete(ROTATION, 1.0, 1.0), Base(0.0, 0.0, 0.0, 3.0)
    still = Base(0.0, 0.0, 0.0, 0.0)
    par, y = Method1(block).parameters, (0.0, 0.0)
    pushes = [f(scalars, y, q, base, par)[1] - f(scalars, y, q, still, par)[1] for f in (linear_flow, nonlinear_flow)]
    assert pushes[0] - pushes[1] == pytest.approx(3.0 * 0.25 * block.alpha**4, rel=0.05)


# Upright and at rest a side begins to carry exactly where its flow would lift it: the guard and the flow are one.
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", FORMS)
def test_a_side_tips_where_lagranges_equation_lifts_it(name: str, seed: int) -> None:
    _, _, _, a_x, a_z, psi, _, psi_acceleration = states(40 + seed)
    system = composed(name)
    par = bind_hooks(system.parameters, lambda hook: partial(hook, scalars))
    base = Base(a_x, a_z, psi, psi_acceleration)
    guards = system.guards(scalars, (0.0, 0.0), Discrete(REST, 1.0, 1.0), base, par)
    for guard, s in zip(guards[2:], (1.0, -1.0), strict=True):
        numbers = (0.0, 0.0, a_x, a_z, psi, 0.0, psi_acceleration)
        lifting = s * rolling_acceleration()(*SHAPES[name], system.g, s, *numbers)
        a, _, o, H, rho2 = SHAPES[name]
        inertia = rho2 + H**2 + (a - s * o) ** 2
        assert guard == pytest.approx(-inertia * lifting, rel=1e-11, abs=1e-12)


@cache
def springs_acceleration() -> Any:
    """(x'', z'', theta'') of the block on two springs and dashpots, by Lagrange and Rayleigh."""
    a, _, o, H, rho2, g, _ = SHAPE
    k, c, *touched = SPRINGS
    X, Z, psi = moving_base()
    coordinates = [sp.Function(name)(TIME) for name in ("x", "z", "theta")]
    x, z, theta = coordinates
    point = [base + part for base, part in zip((X, Z), turned(psi, x, z), strict=True)]
    kinetic = (point[0].diff(TIME) ** 2 + point[1].diff(TIME) ** 2 + rho2 * (theta + psi).diff(TIME) ** 2) / 2
    potential, dissipation = g * point[1], 0
    for side, place in zip((1, -1), touched, strict=True):
        arm = turned(theta, side * a - o, -H)
        foot = (x + arm[0] - place, z + arm[1])
        potential += k * (foot[0] ** 2 + foot[1] ** 2) / 2
        dissipation += c * (foot[0].diff(TIME) ** 2 + foot[1].diff(TIME) ** 2) / 2
    lagrangian = kinetic - potential
    seconds, speeds, places = (sp.symbols(f"{n}_x {n}_z {n}_t") for n in ("second", "speed", "place"))
    known = [(q.diff(TIME, 2), v) for q, v in zip(coordinates, seconds, strict=True)]
    known += [(q.diff(TIME), v) for q, v in zip(coordinates, speeds, strict=True)]
    known += list(zip(coordinates, places, strict=True))
    equations = [
        plain(lagrangian.diff(q.diff(TIME)).diff(TIME) - lagrangian.diff(q) + dissipation.diff(q.diff(TIME)), *known)
        for q in coordinates
    ]
    matrix = sp.Matrix([[e.diff(v) for v in seconds] for e in equations])
    right = -sp.Matrix([e.subs(dict.fromkeys(seconds, 0)) for e in equations])
    return sp.lambdify([*SHAPE, *SPRINGS, *RATES[2:], *places, *speeds], [matrix, right])


@pytest.mark.parametrize("seed", range(4))
def test_two_springs_are_lagranges_equations_with_rayleighs_dashpots(seed: int) -> None:
    rng = np.random.default_rng(60 + seed)
    texts = ["eccentric_mass.offset=0.02", "compliant_base.corner_stiffness=2e6", "compliant_base.damping_ratio=0.3"]
    system = compose(Method1(BLOCK), parse(texts))
    assert isinstance(system, BlockOnSoftFloor)
    par = bind_hooks(system.parameters, lambda hook: partial(hook, scalars))
    # Deep in the floor, so that no dashpot would pull: Lagrange's springs hold both ways.
    place = [float(v) for v in (0.01 * rng.normal(), 0.35 + 0.005 * rng.normal(), 0.05 * rng.normal())]
    speed = [float(v) for v in 0.05 * rng.normal(size=3)]
    touched = [float(v) for v in (0.1 + 0.01 * rng.normal(), -0.1 + 0.01 * rng.normal())]
    base = Base(*(float(v) for v in rng.normal(size=2)), 0.03 * float(rng.normal()), 5.0 * float(rng.normal()))
    y = (*place, *speed, *touched)
    mine = system.flow(scalars, y, Discrete(REST, 1.0, 1.0), base, par)[3:6]
    shape = (0.1, 0.0, 0.02, 0.4, (0.2**2 + 0.8**2) / 12.0, system.g, 1.0)
    k = 2e6 / BLOCK.mass
    c = 2.0 * 0.3 * math.sqrt(k)
    numbers = (k, c, *touched, base.a_x, base.a_z, base.pitch, 0.0, base.pitch_acceleration)
    matrix, right = springs_acceleration()(*shape, *numbers, *place, *speed)
    np.testing.assert_allclose(mine, np.linalg.solve(matrix, right).ravel(), rtol=1e-10, atol=1e-9)
