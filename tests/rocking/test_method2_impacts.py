"""Method 2: impulses of single impacts, against Newton's law, Coulomb's cone and the energy they may not create."""

import math
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rocking import Block, Method2, Mode, scalars
from rocking.form import Form
from rocking.hybrid import Base, Discrete

G = 9.81
STILL = Base(0.0, 0.0)


class Body(NamedTuple):
    """A block by its centre of mass, relative to the base."""

    x_dot: float
    z_dot: float
    theta: float
    omega: float


def arm(block: Block, s: float, theta: float) -> np.ndarray:
    """Corner s from the centre of mass: (s b/2, -h/2) turned clockwise by theta."""
    X, Z = 0.5 * s * block.b, -0.5 * block.h
    return np.array([X * math.cos(theta) + Z * math.sin(theta), -X * math.sin(theta) + Z * math.cos(theta)])


def body(block: Block, s: float, y: Any) -> Body:
    """The motion of the centre of mass from that of corner s; a clockwise spin moves r by omega (r_z, -r_x)."""
    _, _, theta, u, v, omega = y
    r = arm(block, s, theta)
    return Body(u - omega * r[1], v + omega * r[0], theta, omega)


def corner_velocity(block: Block, s: float, motion: Body) -> np.ndarray:
    """(u, v) of corner s."""
    r = arm(block, s, motion.theta)
    return np.array([motion.x_dot + motion.omega * r[1], motion.z_dot - motion.omega * r[0]])


def kinetic(block: Block, motion: Body) -> float:
    """Kinetic energy per mass."""
    rho2 = (block.b**2 + block.h**2) / 12.0
    return 0.5 * (motion.x_dot**2 + motion.z_dot**2 + rho2 * motion.omega**2)


def strike(
    system: Method2, s: float, theta: float, u: float, v: float, omega: float, *, mode: Mode, guard: str
) -> tuple[Body, Body, Discrete]:
    """(before, after, discrete state after) of the impact that `guard` announces; (u, v) belong to corner s."""
    y = (0.0, 0.0, theta, u, v, omega)
    k = system.guard_names.index(guard)
    after, q = system.jump(scalars, y, Discrete(mode, s, 1.0), STILL, system.parameters, k)
    return body(system.block, s, y), body(system.block, float(q.s), after), q


sizes = st.tuples(st.floats(0.1, 1.0), st.floats(0.1, 1.0)).map(lambda size: Block(b=size[0], h=size[1]))
signs = st.sampled_from([-1.0, 1.0])
speeds = st.floats(-3.0, 3.0)
approaches = st.floats(-3.0, -0.01)
tilts = st.floats(0.0, 1.4)
restitutions = st.floats(0.0, 1.0)
# Rounding of a few dozen operations on velocities below ten: 1e-11 of the energy.
ROUNDING = 1e-11


@settings(max_examples=400)
@given(sizes, signs, st.floats(0.02, 1.4), speeds, approaches, speeds, st.floats(0.0, 1.3), restitutions,
       st.floats(-1.0, 1.0))  # fmt: skip
def test_one_corner_impact_bounces_by_e_n_within_the_friction_cone_and_creates_no_energy(
    block: Block, s: float, tilt: float, u: float, v: float, omega: float, mu: float, e_n: float, e_t: float
) -> None:
    system = Method2(block, friction=mu, normal_restitution=e_n, tangential_restitution=e_t, g=G)
    before, after, _ = strike(system, s, s * tilt, u, v, omega, mode=Mode.ROTATION_JUMP, guard="contact")
    r = arm(block, s, s * tilt)
    P = np.array([after.x_dot - before.x_dot, after.z_dot - before.z_dot])
    rho2 = (block.b**2 + block.h**2) / 12.0
    # The impulse acts at the corner and nowhere else.
    assert after.omega - before.omega == pytest.approx((r[1] * P[0] - r[0] * P[1]) / rho2, abs=1e-9)
    # v -> -e_n v; below 5e-5 m/s a series of bounces is finished at once (chatter_time 1e-5 s, 10 m/s^2).
    v_after = corner_velocity(block, s, after)[1]
    bounce = -e_n * v
    assert v_after == pytest.approx(bounce, abs=1e-10) or (v_after == pytest.approx(0.0, abs=1e-10) and bounce < 1e-4)
    assert abs(P[0]) <= mu * P[1] + 1e-10
    assert P[1] > 0.0
    assert kinetic(block, after) <= kinetic(block, before) + ROUNDING * (1.0 + kinetic(block, before))


@settings(max_examples=200)
@given(sizes, signs, st.floats(0.02, 1.4), speeds, approaches, speeds, st.floats(0.0, 1.3), restitutions)
def test_a_tangential_coefficient_of_minus_one_is_frictionless_and_of_zero_sticks_if_friction_reaches(
    block: Block, s: float, tilt: float, u: float, v: float, omega: float, mu: float, e_n: float
) -> None:
    for e_t in (-1.0, 0.0):
        system = Method2(block, friction=mu, normal_restitution=e_n, tangential_restitution=e_t, g=G)
        before, after, _ = strike(system, s, s * tilt, u, v, omega, mode=Mode.ROTATION_JUMP, guard="contact")
        P = np.array([after.x_dot - before.x_dot, after.z_dot - before.z_dot])
        if e_t == -1.0:
            assert P[0] == pytest.approx(0.0, abs=1e-11)
        elif abs(P[0]) < mu * P[1] - 1e-9 and e_n == 0.0:
            assert corner_velocity(block, s, after) == pytest.approx([0.0, 0.0], abs=1e-10)


# The one-corner law with e_n = 0: a corner that slips through the impact keeps its direction of slip, and the friction
# it met was the whole of mu P_z against it.
@settings(max_examples=300)
@given(sizes, signs, st.floats(0.02, 1.4), speeds, approaches, speeds, st.floats(0.0, 1.3))
def test_a_corner_that_slips_through_a_plastic_impact_meets_full_friction_against_its_slip(
    block: Block, s: float, tilt: float, u: float, v: float, omega: float, mu: float
) -> None:
    before, after, _ = strike(
        Method2(block, friction=mu, g=G), s, s * tilt, u, v, omega, mode=Mode.ROTATION_JUMP, guard="contact"
    )
    u_after = corner_velocity(block, s, after)[0]
    assume(abs(u_after) > 1e-9)
    P = np.array([after.x_dot - before.x_dot, after.z_dot - before.z_dot])
    assert abs(P[0]) == pytest.approx(mu * P[1], abs=1e-9)
    # With A_xx, A_xz of the corner's response, du = A_xx P_x + A_xz P_z: P_x opposes the slip it leaves.
    assert P[0] * u_after <= 1e-9


RANDOM_IMPACT = {
    "block": sizes, "s": signs, "tilt": tilts, "u": speeds, "v": approaches, "omega": speeds,
    "guard": st.sampled_from(["contact", "landing"]), "mu": st.floats(0.0, 1.3), "e_n": restitutions,
    "e_t": st.floats(-1.0, 1.0),
}  # fmt: skip


def random_flight(system: Method2, s: float, tilt: float, u: float, v: float, omega: float, guard: str) -> Any:
    """An impact from the air: the lower corner lands, whether or not it is the one that the state speaks of."""
    if guard == "contact":
        return strike(system, s, s * tilt, u, v, omega, mode=Mode.ROTATION_JUMP, guard=guard)
    block = system.block
    # The state is that of corner -s, up at s b sin(theta) over the corner s that lands with (u, v).
    theta = s * tilt
    # A spin omega moves the corner -s, at d from s, by omega (d_z, -d_x) more than s.
    d = arm(block, -s, theta) - arm(block, s, theta)
    y = (float(d[0]), float(d[1]), theta, float(u + omega * d[1]), float(v - omega * d[0]), omega)
    k = system.guard_names.index(guard)
    q = Discrete(Mode.ROTATION_JUMP, -s, 1.0)
    after, q_after = system.jump(scalars, y, q, STILL, system.parameters, k)
    return body(block, -s, y), body(block, float(q_after.s), after), q_after


@settings(max_examples=2000)
@given(**RANDOM_IMPACT)
def test_no_impact_from_the_air_creates_energy(
    block: Block, s: float, tilt: float, u: float, v: float, omega: float, guard: str, mu: float, e_n: float, e_t: float
) -> None:
    system = Method2(block, friction=mu, normal_restitution=e_n, tangential_restitution=e_t, g=G)
    before, after, _ = random_flight(system, s, tilt, u, v, omega, guard)
    assert kinetic(block, after) <= kinetic(block, before) + ROUNDING * (1.0 + kinetic(block, before))
    # The floor cannot pull: the block leaves with more upward momentum than it came with.
    assert after.z_dot >= before.z_dot - 1e-11


@settings(max_examples=1000)
@given(**RANDOM_IMPACT)
def test_kinematic_pairs_that_are_admitted_create_no_energy_at_any_tilt(
    block: Block, s: float, tilt: float, u: float, v: float, omega: float, guard: str, mu: float, e_n: float, e_t: float
) -> None:
    try:
        system = Method2(
            block, friction=mu, normal_restitution=e_n, tangential_restitution=e_t, impact_law="kinematic", g=G
        )
    except ValueError as error:
        assert "energy" in str(error)
        return
    before, after, _ = random_flight(system, s, tilt, u, v, omega, guard)
    assert kinetic(block, after) <= kinetic(block, before) + ROUNDING * (1.0 + kinetic(block, before))


# Friction without limit is the limit of a large friction: finite, e_n exactly, and without creation of energy.
@settings(max_examples=500)
@given(sizes, signs, tilts, speeds, approaches, speeds, st.sampled_from(["contact", "landing"]), restitutions,
       st.floats(-1.0, 1.0))  # fmt: skip
def test_an_impact_on_a_floor_of_infinite_friction_stays_finite_and_creates_no_energy(
    block: Block, s: float, tilt: float, u: float, v: float, omega: float, guard: str, e_n: float, e_t: float
) -> None:
    system = Method2(block, friction=math.inf, normal_restitution=e_n, tangential_restitution=e_t, g=G)
    before, after, _ = random_flight(system, s, tilt, u, v, omega, guard)
    assert np.all(np.isfinite(after))
    assert kinetic(block, after) <= kinetic(block, before) + ROUNDING * (1.0 + kinetic(block, before))
    assert after.z_dot >= before.z_dot - 1e-11


# v -> -e_n v and u -> -e_t u is what the kinematic law means; with e_n = e_t = e it scales both by e.
@settings(max_examples=200)
@given(sizes, signs, st.floats(0.02, 1.4), speeds, st.floats(-3.0, -0.2), speeds, st.floats(0.1, 0.6),
       st.floats(-0.4, 0.4))  # fmt: skip
def test_the_kinematic_law_reverses_both_velocities_of_the_corner(
    block: Block, s: float, tilt: float, u: float, v: float, omega: float, e_n: float, e_t: float
) -> None:
    try:
        system = Method2(
            block, friction=0.3, normal_restitution=e_n, tangential_restitution=e_t, impact_law="kinematic", g=G
        )
    except ValueError:
        assume(False)
    _, after, _ = strike(system, s, s * tilt, u, v, omega, mode=Mode.ROTATION_JUMP, guard="contact")
    assert corner_velocity(block, s, after) == pytest.approx([-e_t * u, -e_n * v], abs=1e-10)


# Centric landing, both corners at once: z'+ = -e_n z', x'+ = (1 - k) x', k = min(1 + e_t, mu (1 + e_n) |z'| / |x'|), as
# long as friction at the base does not trip the block: |P_x| h/2 < P_n b/2.
@settings(max_examples=300)
@given(sizes, signs, speeds, approaches, st.floats(0.0, 1.3), st.floats(0.01, 1.0), st.floats(-1.0, 1.0))
@pytest.mark.parametrize("guard", ["contact", "landing"])
def test_a_flat_landing_bounces_flat_unless_friction_trips_it(
    guard: str, block: Block, s: float, u: float, v: float, mu: float, e_n: float, e_t: float
) -> None:
    system = Method2(block, friction=mu, normal_restitution=e_n, tangential_restitution=e_t, g=G)
    _, after, q = strike(system, s, 0.0, u, v, 0.0, mode=Mode.TRANSLATION_JUMP, guard=guard)
    P_n = (1.0 + e_n) * abs(v)
    taken = min((1.0 + e_t) * abs(u), mu * P_n)
    assume(abs(taken * block.h - P_n * block.b) > 1e-6)
    if taken * block.h < P_n * block.b:
        assume(e_n * abs(v) > 1e-3)  # slower bounces may be finished at once
        assert q.mode == Mode.TRANSLATION_JUMP
        expected = [u - math.copysign(taken, u), -e_n * v, 0.0]
        assert [after.x_dot, after.z_dot, after.omega] == pytest.approx(expected, abs=1e-11)
    else:
        # It trips over the corner that leads: that one alone is struck, and bounces.
        lead = math.copysign(1.0, u)
        assume(e_n * abs(v) > 1e-3)
        assert corner_velocity(block, lead, after)[1] == pytest.approx(-e_n * v, abs=1e-11)
        P_x, P_z = after.x_dot - u, after.z_dot - v
        spin = (-0.5 * block.h * P_x - 0.5 * lead * block.b * P_z) * 12.0 / (block.b**2 + block.h**2)
        assert after.omega == pytest.approx(spin, abs=1e-10)


# Without friction two impulses a half-breadth off the centre turn both velocities round to -e_n of what they were, as
# long as neither has to pull: |omega| I_c/m < |v| b/2.  The corner that the state speaks of is the one left lower.
@settings(max_examples=300)
@given(sizes, signs, speeds, st.floats(-3.0, -0.5), st.floats(0.05, 0.95), signs, st.floats(0.1, 0.9))
def test_a_flat_landing_without_friction_turns_its_velocities_round(
    block: Block, s: float, u: float, v: float, share: float, sense: float, e_n: float
) -> None:
    system = Method2(block, friction=0.0, normal_restitution=e_n, g=G)
    inertia = (block.b**2 + block.h**2) / 12.0
    omega = sense * share * abs(v) * 0.5 * min(block.b / inertia, 4.0 / block.b)
    assume(abs(omega) * 0.5 * block.b < 0.95 * abs(v) and e_n * (abs(v) - abs(omega) * 0.5 * block.b) > 1e-3)
    before, after, q = strike(
        system, s, 0.0, u, v - omega * s * 0.5 * block.b, omega, mode=Mode.ROTATION_JUMP, guard="contact"
    )
    assert before.z_dot == pytest.approx(v)
    assert [after.x_dot, after.z_dot, after.omega] == pytest.approx([before.x_dot, -e_n * v, -e_n * omega], abs=1e-10)
    assert (q.mode, q.s) == (Mode.ROTATION_JUMP, math.copysign(1.0, after.omega))


# The same of a centre of mass off its middle, said of the corners: without friction both normal velocities turn to
# -e_n of what they were, whatever the mass between them, and the centre of mass keeps its horizontal velocity.
@settings(max_examples=300)
@given(sizes, signs, speeds, st.floats(-3.0, -0.5), st.floats(-0.9, 0.9), st.floats(-0.4, 0.4), st.floats(0.1, 0.9))
def test_a_flat_landing_off_the_middle_turns_the_velocity_of_either_corner_round(
    block: Block, s: float, u: float, v: float, where: float, off: float, e_n: float
) -> None:
    a, o, H, rho2 = 0.5 * block.b, 0.5 * off * block.b, 0.5 * block.h, (block.b**2 + block.h**2) / 12.0
    # The resultant of the two impulses is at `where` of the half-breadth from the middle.
    omega = abs(v) * (where * a - o) / rho2
    down = {side: v - omega * (side * a - o) for side in (1.0, -1.0)}
    assume(max(down.values()) < -1e-3 / e_n and abs(omega) > 1e-3)
    system = Method2(block, friction=0.0, normal_restitution=e_n, g=G, form=Form.of(block).edited(offset=o))
    y = (0.0, 0.0, 0.0, u, down[s], omega)
    k = system.guard_names.index("contact")
    after, q = system.jump(scalars, y, Discrete(Mode.ROTATION_JUMP, s, 1.0), STILL, system.parameters, k)
    lower = float(q.s)
    up = {lower: after[4], -lower: after[4] + 2.0 * lower * a * after[5]}
    for side in (1.0, -1.0):
        assert up[side] == pytest.approx(-e_n * down[side], abs=1e-10)
    assert after[3] + H * after[5] == pytest.approx(u + H * omega, abs=1e-10)
    assert up[lower] <= up[-lower]


@settings(max_examples=500)
@given(sizes, speeds, approaches, st.floats(-0.5, 0.5), st.floats(0.0, 1.3), restitutions, st.floats(-1.0, 1.0))
def test_a_landing_upright_does_not_depend_on_the_corner_that_the_state_speaks_of(
    block: Block, u: float, v: float, spin: float, mu: float, e_n: float, e_t: float
) -> None:
    system = Method2(block, friction=mu, normal_restitution=e_n, tangential_restitution=e_t, g=G)
    omega = spin * 2.0 * abs(v) / block.b  # slow enough for both corners to come down
    after = []
    for s in (1.0, -1.0):
        for guard in ("contact", "landing"):
            y = (0.0, 0.0, 0.0, u, v - omega * s * 0.5 * block.b, omega)
            mode = Mode.ROTATION_JUMP if omega != 0.0 else Mode.TRANSLATION_JUMP
            k = system.guard_names.index(guard)
            y_after, q = system.jump(scalars, y, Discrete(mode, s, 1.0), STILL, system.parameters, k)
            after.append(body(block, float(q.s), y_after))
    for other in after[1:]:
        assert other == pytest.approx(after[0], abs=1e-9)
