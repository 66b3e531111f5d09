"""Method 2 of a block of any form on a floor that leans and pitches, with a couple: Lagrange's equations by algebra."""

import functools
import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from rocking import Block, Method1, Method2, Mode, scalars
from rocking.composed_method2 import ComposedMethod2
from rocking.effect import Effect
from rocking.effects import compose
from rocking.form import Form
from rocking.hybrid import Base, Discrete, bind_hooks

G = 9.80665
BLOCK = Block(b=0.2, h=0.8)


@functools.cache
def equations() -> Any:
    """Lagrange's equations of a body (x, z, theta) over a floor that turns by beta about its middle.

    The carrying edge is an arc of radius r about the body point (s a - o, r - H); F and N act at its lowest point.
    Rows, all per unit mass and as A q'' = rhs: three of Lagrange with the unknowns x'', z'', theta'', F, N, and the
    rates of that point's velocity, x_c' - r theta' and z_c'.  The floor's own rate of turning is left out, as it is in
    the package: it is set to zero after the derivatives are taken.
    """
    t = sp.Symbol("t")
    a, r, o, H, rho2, s, g, a_x, a_z, C = sp.symbols("a r o H rho2 s g a_x a_z C")
    th, om, be, ps, xs, zs, xd, zd, F, N = sp.symbols("theta omega beta psi x z xd zd F N")
    x, z, theta, beta = (sp.Function(name)(t) for name in ("x", "z", "theta", "beta"))
    q = [x, z, theta]
    # Clockwise turns; the base's own acceleration is a load on the body in level axes.
    X, Z = x * sp.cos(beta) + z * sp.sin(beta), -x * sp.sin(beta) + z * sp.cos(beta)
    speed2 = X.diff(t) ** 2 + Z.diff(t) ** 2
    lagrangian = speed2 / 2 + rho2 * (theta.diff(t) + beta.diff(t)) ** 2 / 2 - (g + a_z) * Z - a_x * X
    u, w = s * a - o, r - H
    centre = sp.Matrix([x + u * sp.cos(theta) + w * sp.sin(theta), z - u * sp.sin(theta) + w * sp.cos(theta)])
    point = centre - sp.Matrix([r * theta, 0])  # whose rate is the velocity of the lowest point
    jacobian = point.jacobian(q)
    rows = []
    for i, v in enumerate(q):
        inertia = lagrangian.diff(v.diff(t)).diff(t) - lagrangian.diff(v)
        rows.append(inertia - jacobian[0, i] * F - jacobian[1, i] * N - (C if i == 2 else 0))
    rows += list(point.diff(t, 2))
    plain = [
        (x.diff(t, 2), sp.Symbol("q0")), (z.diff(t, 2), sp.Symbol("q1")), (theta.diff(t, 2), sp.Symbol("q2")),
        (beta.diff(t, 2), ps), (x.diff(t), xd), (z.diff(t), zd), (theta.diff(t), om), (beta.diff(t), 0),
        (x, xs), (z, zs), (theta, th), (beta, be),
    ]  # fmt: skip
    rows = [sp.expand(row.subs(plain)) for row in rows]
    A, rhs = sp.linear_eq_to_matrix(rows, [sp.Symbol("q0"), sp.Symbol("q1"), sp.Symbol("q2"), F, N])
    return sp.lambdify((a, r, o, H, rho2, s, g, a_x, a_z, C, th, om, be, ps, xs, zs), (A, rhs), "numpy")


def steady(xp: Any, theta: Any, omega: Any, s: Any, base: Any, values: Any) -> Any:
    return values[0]


@dataclass(frozen=True)
class Steady(Effect):
    """An angular acceleration of a block on a fixed corner [rad/s^2]."""

    k: float = 0.0
    name: ClassVar[str] = "steady"
    acceleration = staticmethod(steady)


forms = st.builds(
    Form, st.floats(0.05, 0.3), st.floats(0.0, 0.04), st.floats(-0.04, 0.04), st.floats(0.2, 0.6), st.just(2.0),
    st.floats(0.05, 0.4),
)  # fmt: skip
signs = st.sampled_from([1.0, -1.0])
bases = st.builds(Base, st.floats(-9.0, 9.0), st.floats(-5.0, 9.0), st.floats(-0.2, 0.2), st.floats(-3.0, 3.0))
KINDS = {
    Mode.ROTATION: "fixed",
    Mode.SLIDE_ROTATION: "sliding",
    Mode.TRANSLATION_JUMP: "free",
    Mode.ROTATION_JUMP: "free",
}


@settings(max_examples=150)
@pytest.mark.parametrize("mode", KINDS)
@given(
    form=forms, s=signs, slip=signs, base=bases, k=st.floats(-5.0, 5.0), mu=st.floats(0.0, 0.3),
    place=st.floats(-1.0, 1.0), height=st.floats(0.0, 0.5), lean=st.floats(0.0, 1.0), omega=st.floats(-4.0, 4.0),
)  # fmt: skip
def test_motion_and_forces_are_those_of_lagrange(
    mode: Mode, form: Form, s: float, slip: float, base: Base, k: float, mu: float, place: float, height: float,
    lean: float, omega: float,
) -> None:  # fmt: skip
    theta = s * lean
    system = ComposedMethod2(Method2(BLOCK, friction=mu, form=form, g=G), _hooks(k))
    par = bind_hooks(system.parameters, lambda hook: lambda *args: hook(scalars, *args))
    y, q = (place, height, theta, 0.3, 0.2, omega), Discrete(mode, s, slip)
    rates = system.flow(scalars, y, q, base, par)
    guards = dict(zip(system.guard_names, system.guards(scalars, y, q, base, par), strict=True))
    # From the edge's centre, at place + r theta and r above the lowest point, to the centre of mass.
    a, r, o, H = form.half_breadth, form.edge_radius, form.offset, form.mass_height
    u, w = s * a - o, r - H
    x = place + r * theta - (u * math.cos(theta) + w * math.sin(theta))
    z = height + r - (-u * math.sin(theta) + w * math.cos(theta))
    arm_x, arm_z = place + r * theta - x, height - z
    C = k * (form.rho2 + arm_x**2 + arm_z**2)
    A, rhs = equations()(
        a, r, o, H, form.rho2, s, G, base.a_x, base.a_z, C, theta, omega, base.pitch, base.pitch_acceleration, x, z
    )
    A, rhs = np.array(A, float), np.array(rhs, float).ravel()
    corner, remainder = A[3:, :3], -rhs[3:]
    closing, closing_rhs = np.zeros((2, 5)), np.zeros(2)
    if KINDS[mode] == "fixed":
        closing[:, :3], closing_rhs = corner, -remainder
    elif KINDS[mode] == "sliding":
        closing[0, 3], closing[0, 4] = 1.0, slip * mu
        closing[1, :3], closing_rhs[1] = corner[1], -remainder[1]
    else:
        closing[0, 3] = closing[1, 4] = 1.0
    solution = np.linalg.solve(np.vstack([A[:3], closing]), np.concatenate([rhs[:3], closing_rhs]))
    u_dot, v_dot = corner @ solution[:3] + remainder
    # Two ways to add up terms of up to 1e2: rounding.
    np.testing.assert_allclose(rates, (0.3, 0.2, omega, u_dot, v_dot, solution[2]), rtol=1e-9, atol=1e-9)
    F, N = solution[3:]
    if KINDS[mode] == "fixed":
        assert guards["slip"] == pytest.approx(mu * N - abs(F), abs=1e-8)
    if KINDS[mode] != "free":
        assert guards["lift"] == pytest.approx(N, abs=1e-8)


def _hooks(k: float) -> Any:
    return compose(Method1(BLOCK), [Steady(k)]).parameters.hooks


# Moments about either corner of a block at rest, written out: weight, base, pitch, couple and what adheres.
@given(form=forms, base=bases, k=st.floats(-5.0, 5.0), hold=st.floats(0.0, 2.0))
def test_rest_ends_where_the_moment_about_a_corner_turns(form: Form, base: Base, k: float, hold: float) -> None:
    form = form.edited(adhesion=hold * form.mass)
    system = ComposedMethod2(Method2(BLOCK, friction=0.4, form=form, g=G), _hooks(k))
    par = bind_hooks(system.parameters, lambda hook: lambda *args: hook(scalars, *args))
    a, o, H = form.half_breadth, form.offset, form.mass_height
    at_rest = (a, 0.0, 0.0, 0.0, 0.0, 0.0)
    tip = system.guards(scalars, at_rest, Discrete(Mode.REST, 1.0, 1.0), base, par)[-1]
    along = base.a_x * math.cos(base.pitch) - (G + base.a_z) * math.sin(base.pitch)
    normal = base.a_x * math.sin(base.pitch) + (G + base.a_z) * math.cos(base.pitch)
    left = []
    for s in (1.0, -1.0):
        arm = a - s * o
        # The centre of mass, o and H from the middle, is carried along by (H, -o) times the pitch's acceleration.
        pushed = -s * H * (along + base.pitch_acceleration * H) - arm * (normal - base.pitch_acceleration * o)
        inertia = form.rho2 + arm**2 + H**2
        left.append(hold - pushed - s * (k * inertia - form.rho2 * base.pitch_acceleration))
    assert tip * H == pytest.approx(min(left), abs=1e-9)
