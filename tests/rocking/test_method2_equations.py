"""Method 2: motion and contact forces within each mode, against Newton's law for a free rectangle with constraints."""

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from rocking import Block, Method2, Mode, scalars
from rocking.form import Form
from rocking.hybrid import Base, Discrete

G0 = 9.81


def _derive() -> Any:
    """Lagrange's equations of a rectangle (x, z, theta) pushed at a corner, and that corner's acceleration.

    A body point (X, Z) from the centre stands at (x + X cos + Z sin, z - X sin + Z cos), theta clockwise; inertial
    forces of the base are -a_x, -(g + a_z) on the centre.  Returns, all per unit mass, a numerical function of
    (b, h, s, theta, omega, G, a_x) that gives the matrix rows of q'' and of the forces (F, N), and the corner's
    acceleration as J q'' + J_dot q'.
    """
    t = sp.Symbol("t")
    b, h, s, G, a_x = sp.symbols("b h s G a_x")
    th, om, F, N = sp.symbols("theta omega F N")
    x, z, theta = (sp.Function(name)(t) for name in ("x", "z", "theta"))
    q = [x, z, theta]
    X, Z = s * b / 2, -h / 2
    corner = sp.Matrix([x + X * sp.cos(theta) + Z * sp.sin(theta), z - X * sp.sin(theta) + Z * sp.cos(theta)])
    rho2 = (b**2 + h**2) / 12
    speed2 = x.diff(t) ** 2 + z.diff(t) ** 2
    lagrangian = speed2 / 2 + rho2 * theta.diff(t) ** 2 / 2 - G * z - a_x * x
    jacobian = corner.jacobian(q)
    rows = []
    for i, v in enumerate(q):
        inertia = lagrangian.diff(v.diff(t)).diff(t) - lagrangian.diff(v)
        rows.append(inertia - jacobian[0, i] * F - jacobian[1, i] * N)
    rows += list(corner.diff(t, 2))
    plain = [(theta.diff(t, 2), sp.Symbol("q2")), (theta.diff(t), om), (theta, th)]
    plain = [(x.diff(t, 2), sp.Symbol("q0")), (z.diff(t, 2), sp.Symbol("q1")), *plain]
    rows = [sp.expand(row.subs(plain)) for row in rows]
    unknown = [sp.Symbol("q0"), sp.Symbol("q1"), sp.Symbol("q2"), F, N]
    A, rhs = sp.linear_eq_to_matrix(rows, unknown)
    return sp.lambdify((b, h, s, th, om, G, a_x), (A, rhs), "numpy")


EQUATIONS = _derive()


class Truth(NamedTuple):
    """What Newton's law says at one instant."""

    u_dot: float
    v_dot: float
    omega_dot: float
    F: float
    N: float


def newton(kind: str, b: float, h: float, s: float, slip: float, y: tuple[float, ...], base: Base, mu: float) -> Truth:
    """Accelerations of corner s and the forces there: corner "fixed", "sliding" along the floor, or "free"."""
    _, _, theta, _, _, omega = y
    A, rhs = EQUATIONS(b, h, s, theta, omega, G0 + base.a_z, base.a_x)
    A, rhs = np.array(A, float), np.array(rhs, float).ravel()
    # Unknowns x'', z'', theta'', F, N; the first three rows are Newton's, the last two the corner's acceleration,
    # whose remainder (minus rhs) is the part from omega^2.
    corner, remainder = A[3:, :3], -rhs[3:]
    closing = np.zeros((2, 5))
    closing_rhs = np.zeros(2)
    if kind == "fixed":
        closing[:, :3], closing_rhs = corner, -remainder
    elif kind == "sliding":
        closing[0, 3], closing[0, 4] = 1.0, slip * mu  # F = -slip mu N
        closing[1, :3], closing_rhs[1] = corner[1], -remainder[1]
    else:
        closing[0, 3] = closing[1, 4] = 1.0
    solution = np.linalg.solve(np.vstack([A[:3], closing]), np.concatenate([rhs[:3], closing_rhs]))
    u_dot, v_dot = corner @ solution[:3] + remainder
    return Truth(u_dot, v_dot, *solution[2:])


sizes = st.floats(0.1, 2.0)
signs = st.sampled_from([-1.0, 1.0])
states = st.tuples(
    st.floats(-3.0, 3.0), st.floats(0.0, 2.0), st.floats(-1.3, 1.3), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0),
    st.floats(-5.0, 5.0),
)  # fmt: skip
bases = st.builds(Base, st.floats(-15.0, 15.0), st.floats(-12.0, 12.0), st.just(0.0), st.just(0.0))
# The two sides are the same rational function, added up in another order: rounding, times terms of up to 1e3.
TOLERANCE = {"rtol": 1e-9, "atol": 1e-9}


def model(b: float, h: float, mu: float, mu_s: float | None = None) -> Method2:
    """A block with that friction."""
    return Method2(Block(b=b, h=h), friction=mu if mu_s is None else mu_s, kinetic_friction=mu, g=G0)


@pytest.mark.parametrize(
    ("mode", "kind"),
    [
        (Mode.ROTATION, "fixed"),
        (Mode.SLIDE_ROTATION, "sliding"),
        (Mode.TRANSLATION_JUMP, "free"),
        (Mode.ROTATION_JUMP, "free"),
    ],
)
@given(b=sizes, h=sizes, s=signs, slip=signs, y=states, base=bases, mu=st.floats(0.0, 1.3))
def test_motion_in_each_mode_obeys_newtons_law(
    mode: Mode, kind: str, b: float, h: float, s: float, slip: float, y: Any, base: Base, mu: float
) -> None:
    system = model(b, h, mu)
    rates = system.flow(scalars, y, Discrete(mode, s, slip), base, system.parameters)
    truth = newton(kind, b, h, s, slip, y, base, mu)
    expected = (y[3], y[4], y[5], truth.u_dot, truth.v_dot, truth.omega_dot)
    np.testing.assert_allclose(rates, expected, **TOLERANCE)


# Both corners down: Newton's law along the floor is u' = F - a_x with F = -slip mu N and N = g + a_z.
@given(slip=signs, s=signs, u=st.floats(-2.0, 2.0), base=bases, mu=st.floats(0.0, 0.5))
def test_a_block_slides_upright_under_coulombs_friction(slip: float, s: float, u: float, base: Base, mu: float) -> None:
    system = model(0.5, 1.0, mu)
    rates = system.flow(scalars, (0.3, 0.0, 0.0, u, 0.0, 0.0), Discrete(Mode.SLIDE, s, slip), base, system.parameters)
    expected = (u, 0.0, 0.0, -slip * mu * (G0 + base.a_z) - base.a_x, 0.0, 0.0)
    np.testing.assert_allclose(rates, expected, rtol=1e-14, atol=1e-14)


@given(base=bases)
def test_a_block_at_rest_stays_where_it_is(base: Base) -> None:
    system = model(0.2, 0.8, 0.7)
    at_rest = (0.1, 0.0, 0.0, 0.0, 0.0, 0.0)
    rates = system.flow(scalars, at_rest, Discrete(Mode.REST, 1.0, 1.0), base, system.parameters)
    np.testing.assert_array_equal(rates, 0.0)


@given(b=sizes, h=sizes, s=signs, slip=signs, y=states, base=bases, mu=st.floats(0.0, 1.3), more=st.floats(0.0, 1.0))
def test_rotation_ends_where_friction_gives_way_or_the_floor_would_pull(
    b: float, h: float, s: float, slip: float, y: Any, base: Base, mu: float, more: float
) -> None:
    system = model(b, h, mu, mu + more)
    value = dict(
        zip(
            system.guard_names,
            system.guards(scalars, y, Discrete(Mode.ROTATION, s, slip), base, system.parameters),
            strict=True,
        )
    )
    truth = newton("fixed", b, h, s, slip, y, base, mu)
    assert value["slip"] == pytest.approx((mu + more) * truth.N - abs(truth.F), rel=1e-9, abs=1e-8)
    assert value["lift"] == pytest.approx(truth.N, rel=1e-9, abs=1e-8)
    assert value["landing"] == s * y[2]
    assert value["fall"] == pytest.approx(0.5 * math.pi - abs(y[2]), rel=1e-15)
    assert value["contact"] > 0.0
    assert value["stick"] > 0.0
    assert value["tip"] > 0.0


@given(b=sizes, h=sizes, s=signs, slip=signs, y=states, base=bases, mu=st.floats(0.0, 1.3))
def test_slide_rotation_ends_where_the_slip_stops_or_the_floor_would_pull(
    b: float, h: float, s: float, slip: float, y: Any, base: Base, mu: float
) -> None:
    system = model(b, h, mu)
    value = dict(
        zip(
            system.guard_names,
            system.guards(scalars, y, Discrete(Mode.SLIDE_ROTATION, s, slip), base, system.parameters),
            strict=True,
        )
    )
    truth = newton("sliding", b, h, s, slip, y, base, mu)
    assert value["lift"] == pytest.approx(truth.N, rel=1e-9, abs=1e-8)
    assert value["stick"] == slip * y[3]
    assert value["landing"] == s * y[2]
    assert value["slip"] > 0.0
    assert value["contact"] > 0.0


# The corner that does not carry stands a body vector s b away: height z + s b sin(theta), from the rotation of a
# body point written out.
@pytest.mark.parametrize("mode", [Mode.TRANSLATION_JUMP, Mode.ROTATION_JUMP])
@given(b=sizes, h=sizes, s=signs, y=states, base=bases)
def test_a_jump_ends_where_either_corner_meets_the_floor(
    mode: Mode, b: float, h: float, s: float, y: Any, base: Base
) -> None:
    system = model(b, h, 0.5)
    value = system.guards(scalars, y, Discrete(mode, s, 1.0), base, system.parameters)
    theta = y[2]
    turned = np.array([[math.cos(theta), math.sin(theta)], [-math.sin(theta), math.cos(theta)]])
    from_carrying_to_other = turned @ np.array([-s * b, 0.0])
    named = dict(zip(system.guard_names, value, strict=True))
    assert named["contact"] == y[1]
    assert named["landing"] == pytest.approx(y[1] + from_carrying_to_other[1], abs=1e-14)
    assert (named["slip"], named["stick"], named["lift"], named["tip"]) == (1.0, 1.0, 1.0, 1.0)


# Moments about the leading bottom edge: |a_x| h/2 against G b/2; along the floor: |a_x| against mu_s G.
@given(b=sizes, h=sizes, base=bases, mu_s=st.floats(0.0, 2.0))
def test_rest_ends_by_slip_tip_or_lift(b: float, h: float, base: Base, mu_s: float) -> None:
    system = model(b, h, 0.0, mu_s)
    named = dict(
        zip(
            system.guard_names,
            system.guards(scalars, (0.0,) * 6, Discrete(Mode.REST, 1.0, 1.0), base, system.parameters),
            strict=True,
        )
    )
    gravity = G0 + base.a_z
    assert named["slip"] == pytest.approx(mu_s * gravity - abs(base.a_x), abs=1e-12)
    assert named["tip"] * 0.5 * h == pytest.approx(gravity * 0.5 * b - abs(base.a_x) * 0.5 * h, abs=1e-11)
    assert named["lift"] == pytest.approx(gravity, rel=1e-15)


@pytest.mark.parametrize("mode", [Mode.REST, Mode.ROTATION])
@given(y=states, base=bases)
def test_infinite_friction_never_gives_way(mode: Mode, y: Any, base: Base) -> None:
    system = Method2(Block(b=0.2, h=0.8), friction=math.inf, g=G0)
    values = system.guards(scalars, y, Discrete(mode, 1.0, 1.0), base, system.parameters)
    assert dict(zip(system.guard_names, values, strict=True))["slip"] > 0.0


# Painleve's paradox: the normal force per unit load 1/D must stay positive.  For a rectangle (m R^2/I_c = 3) the
# least D over tilt is (5 - 3 sqrt(1 + mu^2))/2, zero at mu = 4/3.
@pytest.mark.parametrize("s", [1.0, -1.0])
@pytest.mark.parametrize("slip", [1.0, -1.0])
def test_a_sliding_corner_never_jams_below_a_friction_of_four_thirds(s: float, slip: float) -> None:
    mu = 1.333
    b, h = 0.2, 0.8
    at_rest = Base(0.0, 0.0)
    normal = [
        newton("sliding", b, h, s, slip, (0.0, 0.0, s * tilt, 0.0, 0.0, 0.0), at_rest, mu).N
        for tilt in np.linspace(0.0, 0.5 * math.pi, 400)
    ]
    assert min(normal) > 0.0
    # The worst tilt raises the normal force to 2 / (5 - 3 sqrt(1 + mu^2)) times the weight, where both signs agree.
    worst = 2.0 / (5.0 - 3.0 * math.sqrt(1.0 + mu**2)) * G0
    assert max(normal) <= worst * (1.0 + 1e-9)
    with pytest.raises(ValueError, match="4/3"):
        model(b, h, 4.0 / 3.0)


# Of any mass: D = 1 + (1 - sqrt(1 + mu^2)) R^2 / (2 rho^2) at the worst tilt, zero at mu^2 = (1 + 2 rho^2 / R^2)^2 - 1.
@pytest.mark.parametrize("scale", [0.01, 1.0, 100.0])
@pytest.mark.parametrize("heavy", [0.4, 0.75, 1.3])
def test_a_form_is_refused_from_the_friction_on_at_which_a_sliding_corner_jams(scale: float, heavy: float) -> None:
    block = Block(b=0.2 * scale, h=0.8 * scale)
    form = replace(Form.of(block), inertia=heavy * block.I_c)
    most = math.sqrt((1.0 + 2.0 * form.rho2 / block.R**2) ** 2 - 1.0)
    Method2(block, friction=0.999 * most, g=G0, form=form)
    with pytest.raises(ValueError, match=r"may jam, or math\.inf"):
        Method2(block, friction=1.001 * most, g=G0, form=form)


# A base that falls as fast as a block does carries nothing that could turn it over, nor does one that falls faster.
@pytest.mark.parametrize("fall", [1.0, 1.2])
def test_a_slide_on_a_base_that_falls_freely_is_ended_by_no_tip(fall: float) -> None:
    system = Method2(Block(b=0.3, h=1.0), friction=0.5)
    g = system.parameters.g
    base, state = Base(0.7 * g, -fall * g, 0.0, 0.0), (0.0, 0.0, 0.0, 0.4, 0.0, 0.0)
    values = system.guards(scalars, state, Discrete(Mode.SLIDE, 1.0, 1.0), base, system.parameters)
    named = dict(zip(system.guard_names, values, strict=True))
    assert named["tip"] == pytest.approx(g) and named["lift"] == pytest.approx((1.0 - fall) * g)


@pytest.mark.parametrize("s", [1.0, -1.0])
def test_the_anchor_of_rounded_edges_is_the_centre_of_the_edge(s: float) -> None:
    """It stands r over the lowest point, which is z above the floor, and rolls r theta on from where that one is."""
    block = Block(b=0.2, h=0.8)
    form = replace(Form.of(block), half_breadth=0.09, edge_radius=0.01)
    system = Method2(block, friction=0.3, g=G0, form=form)
    y, rate = (0.5, 0.02, s * 0.1, 0.3, -0.4, 0.7), (0.3, -0.4, 0.7, 1.1, -1.3, 1.7)
    anchor = system.anchor(y, rate, s)
    assert tuple(anchor) == pytest.approx(
        (s * 0.09, 0.01, 0.5 + 0.01 * s * 0.1, 0.03, 1.1 + 0.01 * 1.7, -1.3), rel=1e-14
    )
