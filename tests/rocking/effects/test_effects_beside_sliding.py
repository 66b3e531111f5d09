"""Effects under Method 2: what Method 1 has of them where friction holds, and what stays of Method 2 without them.

Where friction gives way the laboratory of `studies` is the peer, in its own tests.
"""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from excitation import RampedSinusoid
from rocking import Block, Method1, Method2, Mode, scalars, solve, solve_batch
from rocking.composed_method2 import ComposedMethod2
from rocking.effect import Effect
from rocking.effects import compose, load, parse
from rocking.form import Form
from rocking.hybrid import INADMISSIBLE, Base, Discrete
from rocking.method2_equations import LIFT

BLOCK = Block(b=0.2, h=0.8)
G = 9.80665
E = 0.95
WEIGHT = BLOCK.mass * G
MOTION = RampedSinusoid(1.5, 4.0, 3.2)
STILL = Base(0.0, 0.0, 0.0, 0.0)

CASES = {
    "rounded_edges": ["rounded_edges.radius=0.006"],
    "eccentric_mass": ["eccentric_mass.offset=0.004"],
    "mass_distribution": ["mass_distribution.height=0.42", f"mass_distribution.inertia={1.1 * BLOCK.I_c}"],
    "concave_base": ["concave_base.breadth=0.19"],
    "viscous_damping": ["viscous_damping.coefficient=0.3"],
    "quadratic_drag": ["quadratic_drag.coefficient=0.5"],
    "velocity_dependent_restitution": ["velocity_dependent_restitution.slope=-0.01"],
    "tether": ["tether.slack=0.0", f"tether.stiffness={0.3 * WEIGHT * BLOCK.R}"],
    "base_tilt": ["base_tilt.angle=0.01"],
    "table_pitch": ["table_pitch.per_displacement=0.05"],
    "base_adhesion": [f"base_adhesion.moment={0.01 * WEIGHT}"],
    "learned_term": ["learned_term.side=0.1", "learned_term.base=0.05", "learned_term.restitution_side=0.01"],
    "two at once": ["rounded_edges.radius=0.006", "viscous_damping.coefficient=0.3", "base_tilt.angle=0.01"],
}


# Friction of 1.3 holds in all of it, so that only Method 1's motion is left: both are integrated to 1e-11, in other
# coordinates and with other guards.
@pytest.mark.parametrize("theta", [0.0, 0.12, -0.12])
@pytest.mark.parametrize("name", CASES)
def test_where_friction_holds_an_effect_is_that_of_method_1(name: str, theta: float) -> None:
    options: Any = {"t_end": 4.0, "theta": theta, "effects": parse(CASES[name]), "rtol": 1e-11, "atol": 1e-13}
    motion = MOTION if theta == 0.0 else RampedSinusoid(1.5, 4.0, 0.5)
    one = solve(Method1(BLOCK, restitution=E, g=G), motion, **options)
    rough = Method2(BLOCK, friction=1.3, impact_law="two_corner", restitution=E, g=G)
    other = solve(rough, motion, **options)
    assert set(other.events.mode_after) <= {Mode.REST, Mode.ROTATION}
    assert len(one.impact_times) >= 2
    n = min(len(one.impact_times), 12)
    np.testing.assert_allclose(other.impact_times[:n], one.impact_times[:n], rtol=0.0, atol=1e-9)
    end = one.impact_times[n - 1]
    np.testing.assert_allclose(other.theta[other.t < end], one.theta[one.t < end], rtol=0.0, atol=1e-8)
    plain = solve(Method1(BLOCK, restitution=E, g=G), motion, **(options | {"effects": ()}))
    k = min(n, len(plain.impact_times))
    if name != "base_adhesion" or theta == 0.0:  # a lean has broken what adheres
        assert np.abs(plain.impact_times[:k] - one.impact_times[:k]).max() > 1e-5


@pytest.mark.parametrize("name", [name for name in CASES if name != "two at once"])
def test_beside_sliding_an_effect_with_its_absent_values_is_not_there(name: str) -> None:
    sliding = load("sliding")(0.27, 1.0)
    absent = load(name)(**load(name).absent(BLOCK))
    method = Method1(BLOCK, restitution=E, g=G)
    motion = RampedSinusoid(2.5, 3.0, 6.0)
    options: Any = {"t_end": 3.0, "rtol": 1e-13, "atol": 1e-16}
    plain, run = (solve(method, motion, effects=given, **options) for given in ([sliding], [absent, sliding]))
    assert Mode.SLIDE_ROTATION in plain.events.mode_after
    np.testing.assert_array_equal(run.events.mode_after, plain.events.mode_after)
    np.testing.assert_allclose(run.events.t, plain.events.t, rtol=0.0, atol=1e-11)


signs = st.sampled_from([1.0, -1.0])
MANY = ["sliding.friction=0.27", *CASES["two at once"], *CASES["velocity_dependent_restitution"], *CASES["table_pitch"]]


@pytest.mark.parametrize("solver", ["numba", pytest.param("diffrax", marks=pytest.mark.slow)])
def test_solvers_agree_on_a_block_that_slides_with_effects(solver: str) -> None:
    motion = RampedSinusoid(2.5, 2.0, 5.0)
    options: Any = {"t_end": 2.0, "effects": parse(MANY), "rtol": 1e-12, "atol": 1e-14}
    one = solve(Method1(BLOCK, restitution=E, g=G), motion, solver="scipy", **options)
    other = solve(Method1(BLOCK, restitution=E, g=G), motion, solver=solver, **options)
    assert Mode.SLIDE_ROTATION in one.events.mode_after
    np.testing.assert_array_equal(other.events.mode_after, one.events.mode_after)
    np.testing.assert_allclose(other.events.t, one.events.t, rtol=0.0, atol=1e-8)


def test_a_batch_is_many_single_runs() -> None:
    motion = RampedSinusoid(2.5, 2.0, 5.0)
    systems = [compose(Method1(BLOCK, restitution=E, g=G), parse(MANY[:3])) for _ in range(2)]
    systems.append(compose(Method1(BLOCK, restitution=E, g=G), parse([*MANY[:2], "viscous_damping.coefficient=0.6"])))
    many = solve_batch(systems, motion, t_end=2.0)
    for k, system in enumerate(systems):
        one = solve(system, motion, t_end=2.0)
        assert many.impacts[k] == len(one.impact_times)
        assert many.peak_rotation[k] == one.peak_rotation


def test_a_floor_that_leans_and_pitches_drags_a_block_as_newton_has_it() -> None:
    """On a tilt beta, upright: slip begins at tan(beta) = mu and goes on with g (sin beta - mu cos beta)."""
    beta, mu = 0.15, 0.1
    run = solve(
        Method2(BLOCK, friction=mu, g=G), t_end=1.0, effects=parse([f"base_tilt.angle={beta}"]), save_at=[0.0, 1.0]
    )
    assert run.mode[-1] == Mode.SLIDE
    assert run.y[-1, 0] - run.y[0, 0] == pytest.approx(0.5 * G * (math.sin(beta) - mu * math.cos(beta)), rel=1e-9)
    held = solve(Method2(BLOCK, friction=0.16, g=G), t_end=1.0, effects=parse([f"base_tilt.angle={beta}"]))
    assert held.mode[-1] == Mode.REST


def of_the_base(xp: Any, theta: Any, omega: Any, s: Any, base: Any, values: Any) -> Any:
    return values[0] * base.a_x


# A couple that grows while the base slides turns the block over: the normal force leaves the base where friction's
# moment mu g H and the couple M k, M = 4 R^2 / 3, are g a.  k is a share of a_x, which goes as t.
def test_a_slide_on_both_corners_ends_where_the_normal_force_leaves_the_base() -> None:
    class Growing:
        max_step, breakpoints, parameters = 0.01, (0.0,), np.array([5.0])

        @staticmethod
        def kernel(xp: Any, t: Any, par: Any) -> Any:
            return -par[0] * t, 0.0 * t

    @dataclass(frozen=True)
    class Turning(Effect):
        share: float = 0.0
        name: ClassVar[str] = "turning"
        acceleration = staticmethod(of_the_base)

    mu, share = 0.1, -1.0
    run = solve(Method2(BLOCK, friction=mu, g=G), Growing(), t_end=2.0, effects=[Turning(share)], solver="scipy")
    before = list(run.events.mode_before)
    k = before.index(Mode.SLIDE)
    inertia = 4.0 * BLOCK.R**2 / 3.0
    # The floor goes to -x: the block slips to +x, and friction and couple turn it over its +x corner.
    expected = (0.1 - mu * 0.4) * G / (inertia * 5.0 * -share)
    assert run.events.t[k] == pytest.approx(expected, abs=1e-9)
    assert (run.events.mode_after[k], run.events.s_after[k]) == (Mode.SLIDE_ROTATION, 1.0)
    assert run.theta[-1] > 0.0


# Its normal force is inside the base for any weight, down to none at all.
@pytest.mark.parametrize("solver", ["scipy", "numba"])
@pytest.mark.parametrize("mu", [0.1, 0.15, 0.2, 0.23, 0.25])
def test_a_block_that_slides_leaves_a_floor_that_falls_without_tripping(mu: float, solver: str) -> None:
    class Falling:
        max_step, breakpoints, parameters = 0.01, (0.0,), np.array([3.0, 14.0, 6.0])

        @staticmethod
        def kernel(xp: Any, t: Any, par: Any) -> Any:
            return -par[0] + 0.0 * t, -par[1] * xp.sin(par[2] * t)

    run = solve(Method2(BLOCK, friction=mu, g=G), Falling(), t_end=0.14, solver=solver)
    assert list(run.events.mode_after) == [Mode.SLIDE, Mode.TRANSLATION_JUMP]
    assert run.events.t[1] == pytest.approx(math.asin(G / 14.0) / 6.0, abs=1e-9)


# By Newton: a corner goes down with -(z'' - omega' r_x - omega^2 r_z) in the air, z'' = -g, omega' = C / rho2.  It
# leaves if that is negative, and has no motion without friction's pull if not.
@given(theta=st.floats(0.05, 0.6), omega=st.floats(-6.0, 6.0), turning=st.floats(-15.0, 15.0), s=signs)
def test_without_a_limit_to_friction_a_corner_leaves_if_it_would_go_up(
    theta: float, omega: float, turning: float, s: float
) -> None:
    system = Method2(BLOCK, friction=math.inf, g=G)
    base = Base(0.0, 0.0, 0.0, turning)
    y = (0.1, 0.0, s * theta, 0.0, 0.0, omega)
    after, q = system.jump(scalars, y, Discrete(Mode.ROTATION, s, 1.0), base, system.parameters, LIFT)
    in_air = system.flow(scalars, y, Discrete(Mode.ROTATION_JUMP, s, 1.0), base, system.parameters)
    assume(abs(in_air[4]) > 1e-6)
    assert q.mode == (Mode.ROTATION_JUMP if in_air[4] > 0.0 else INADMISSIBLE)
    assert after[5] == omega


def swing_over(system: Any, s: float, omega: float, u: float) -> Any:
    """What follows when a block that turns back about corner s lands on the other one."""
    y = (0.0, 0.0, 0.0, u, 0.0, -s * omega)
    mode = Mode.ROTATION if u == 0.0 else Mode.SLIDE_ROTATION
    return system.jump(scalars, y, Discrete(mode, s, 1.0 if u >= 0.0 else -1.0), STILL, system.parameters, 1)


LOW = ["sliding.friction=0.05"]


def test_a_restitution_that_changes_has_to_be_there() -> None:
    plain = Method1(BLOCK, g=G)
    # Neither a torque nor an effect at its absent value asks for one.
    for text in ("learned_term.side=0.1", "velocity_dependent_restitution.slope=0"):
        system: Any = compose(plain, parse([*LOW, text]))
        assert getattr(system, "method", system).impact_law == "frictional"
    compose(plain, parse(["bouncing.normal_restitution=0.2", "learned_term.side=0.1"]))
    changing = parse(["velocity_dependent_restitution.slope=-0.01"])
    system = compose(plain, [*parse(["sliding.friction=0.3"]), *changing])
    assert (system.method.impact_law, system.method.restitution) == ("two_corner", BLOCK.housner_restitution)
    with pytest.raises(ValueError, match=r"velocity_dependent_restitution: friction=0\.05 .* want at least 0\.18"):
        compose(plain, [*parse(LOW), *changing])
    kinematic = Method2(BLOCK, friction=0.5, impact_law="kinematic", tangential_restitution=0.3)
    turning_back = Method2(BLOCK, friction=0.5, tangential_restitution=0.3)
    for method in (kinematic, turning_back, Method2(BLOCK, friction=0.5, normal_restitution=0.2)):
        with pytest.raises(ValueError, match="velocity_dependent_restitution: it changes the restitution, which"):
            compose(method, changing)
    # Rocking impacts of this law have it, whatever landings from the air do.
    both = Method2(BLOCK, friction=0.5, impact_law="two_corner", restitution=0.95, normal_restitution=0.2)
    composed: Any = compose(both, changing)
    assert composed.hooks.striking == 1
    with pytest.raises(ValueError, match=r"impact_law='frictional': an effect changes the restitution, which only"):
        ComposedMethod2(Method2(BLOCK, friction=0.5), composed.hooks)


def test_a_system_that_does_not_carry_a_pitch_says_so() -> None:
    class Level(Method1):
        carries_pitch = False

    for run in (solve, solve_batch):
        with pytest.raises(ValueError, match="method1 does not carry a base that pitches"):
            run(Level(BLOCK), MOTION, t_end=0.1, effects=parse(CASES["table_pitch"]))  # type: ignore[operator]


forms = st.builds(
    Form, st.floats(0.05, 0.15), st.floats(0.0, 0.02), st.floats(-0.02, 0.02), st.floats(0.3, 0.6), st.just(1.0),
    st.floats(0.02, 0.2),
)  # fmt: skip


def restitution_of(form: Form, part: float) -> float:
    """From nothing (at -1) over that of the form (at 0) to the greatest that both sides can have (at 1)."""
    right, left = form.restitution(1.0), form.restitution(-1.0)
    assume(min(right, left) > 0.1)
    low = math.sqrt(right * left)
    high = math.sqrt(min(right / left, left / right))
    return low + part * (high - low) if part > 0.0 else low * (1.0 + part)


@pytest.mark.parametrize("friction", [math.inf, 0.6, 0.1])
@given(form=forms, part=st.floats(-0.9, 0.999), s=signs)
def test_of_any_form_each_side_has_its_own_restitution(friction: float, form: Form, part: float, s: float) -> None:
    e = restitution_of(form, part)
    try:
        system = Method2(BLOCK, friction=friction, impact_law="two_corner", restitution=e, form=form, g=G)
    except ValueError:
        assume(False)
    y, q = swing_over(system, s, 1.0, 0.0)
    given_side = form.restitutions(e)[0 if s > 0.0 else 1]
    assert -s * y[5] == pytest.approx(given_side, abs=1e-12)
    assert (q.s, y[4]) == (-s, 0.0)
    assert y[3] == 0.0 or friction < form.friction_to_stick(e)


# Momentum of the whole impact: along the floor no more than friction's share of what goes normal to it, and no energy.
@pytest.mark.parametrize("ratio_kept", [0.0, 0.6, 1.0])
@given(form=forms, part=st.floats(-1.0, 1.0), s=signs, u=st.floats(-2.0, 2.0), mu=st.floats(0.25, 1.0))
def test_impacts_of_any_form_that_slides_make_no_energy_and_keep_to_friction(
    ratio_kept: float, form: Form, part: float, s: float, u: float, mu: float
) -> None:
    e = restitution_of(form, part)
    law: Any = {"impact_law": "two_corner", "restitution": e, "ratio_kept": ratio_kept}
    try:
        system = Method2(BLOCK, friction=mu, form=form, g=G, **law)
    except ValueError:
        assume(False)
    y, q = swing_over(system, s, 1.0, u)
    assume(q.mode in (Mode.ROTATION, Mode.SLIDE_ROTATION) and q.s == -s)

    def motion(corner: float, u: float, omega: float) -> tuple[float, float, float]:
        """Velocity of the centre of mass of an upright block that turns on a corner; kinetic energy."""
        r_x, r_z = corner * form.half_breadth - form.offset, -form.mass_height
        x, z = u - omega * r_z, omega * r_x
        return x, z, 0.5 * (x * x + z * z + form.rho2 * omega * omega)

    before, after = motion(s, u, -s), motion(-s, y[3], y[5])
    assert after[2] <= before[2] * (1.0 + 1e-12)
    P_x, P_z = after[0] - before[0], after[1] - before[1]
    assert abs(P_x) <= mu * P_z + 1e-12 * (1.0 + abs(u))


def test_a_form_in_which_a_sliding_corner_may_jam_is_refused() -> None:
    # Of a rectangle the limit is 4/3; half of its inertia about the centre makes it sqrt((1 + 1/3)^2 - 1) = 0.88.
    form = Form.of(BLOCK)
    half = form.edited(inertia=0.5 * form.inertia)
    limit = math.sqrt((1.0 + 1.0 / 3.0) ** 2 - 1.0)
    Method2(BLOCK, friction=0.999 * limit, form=half)
    with pytest.raises(ValueError, match="a sliding corner of"):
        Method2(BLOCK, friction=1.001 * limit, form=half)
    with pytest.raises(ValueError, match=r"form='linear': want a rocking\.form\.Form"):
        Method2(BLOCK, friction=0.5, form="linear")  # type: ignore[arg-type]
