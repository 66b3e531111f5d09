"""Method 2: which mode follows when a slip stops, a push grows or the floor falls away, by Newton and Coulomb."""

import math
from typing import Any

import pytest

from rocking import Block, Method2, Mode, scalars
from rocking.hybrid import Base, Discrete

G = 9.81
B, H = 0.2, 0.8
BLOCK = Block(b=B, h=H)


def after(system: Method2, mode: Mode, guard: str, y: tuple[float, ...], base: Base, s: float = 1.0) -> Any:
    """(state, discrete state) that follows when that guard ends the mode."""
    k = system.guard_names.index(guard)
    return system.jump(scalars, y, Discrete(int(mode), s, 1.0), base, system.parameters, k)


SIDES = pytest.mark.parametrize("side", [1.0, -1.0])


# Coulomb: at the halt the floor must only hold a_x, up to mu_s (g + a_z), though mu_k (g + a_z) is less than that.
@SIDES
@pytest.mark.parametrize("a_z", [0.0, -4.0, 3.0])
@pytest.mark.parametrize(
    ("share", "mode"), [(0.85, Mode.REST), (0.99, Mode.REST), (1.0, Mode.REST), (1.01, Mode.SLIDE)]
)
def test_an_upright_slide_that_halts_stays_if_static_friction_holds(
    side: float, a_z: float, share: float, mode: Mode
) -> None:
    system = Method2(BLOCK, friction=0.2, kinetic_friction=0.15, g=G)
    base = Base(side * share * 0.2 * (G + a_z), a_z)
    y, q = after(system, Mode.SLIDE, "stick", (0.3, 0.0, 0.0, 1e-17, 0.0, 0.0), base)
    assert q.mode == mode
    assert (y[2], y[3], y[4], y[5]) == (0.0, 0.0, 0.0, 0.0)
    if mode == Mode.SLIDE:  # the floor runs away to +x under the block
        assert q.slip == -side


# Own derivation: the normal force of a slide lies within the base while mu_k <= b/h, the bound itself included.
@pytest.mark.parametrize(("friction", "mode"), [(B / H, Mode.SLIDE), (B / H * (1.0 + 1e-12), Mode.SLIDE_ROTATION)])
def test_a_block_slides_upright_up_to_a_friction_of_b_over_h(friction: float, mode: Mode) -> None:
    system = Method2(BLOCK, friction=0.4, kinetic_friction=friction, g=G)
    _, q = after(system, Mode.REST, "slip", (0.0,) * 6, Base(0.2 * G, 0.0))
    assert q.mode == mode
    for u in (0.3, -0.3):
        _, begun = system.initial_state(u=u)
        assert begun.mode == mode


# The same for a block taller than 1 m, whose b/h is not to be taken for b h.
@pytest.mark.parametrize(("share", "mode"), [(0.99, Mode.REST), (1.01, Mode.ROTATION)])
def test_a_tall_block_that_halts_tips_beyond_wests_formula(share: float, mode: Mode) -> None:
    system = Method2(Block(b=0.5, h=2.0), friction=0.9, kinetic_friction=0.2, g=G)
    _, q = after(system, Mode.SLIDE, "stick", (0.0, 0.0, 0.0, 1e-17, 0.0, 0.0), Base(share * 0.25 * G, 0.0))
    assert q.mode == mode


# Moments about the corner: the block tips where |a_x| > (b/h)(g + a_z), with the vertical acceleration in it, and over
# the corner that the floor drives under it.
@SIDES
@pytest.mark.parametrize("a_z", [0.0, -4.0, 3.0])
@pytest.mark.parametrize(("share", "mode"), [(0.99, Mode.REST), (1.01, Mode.ROTATION)])
def test_an_upright_slide_that_halts_tips_beyond_wests_formula(
    side: float, a_z: float, share: float, mode: Mode
) -> None:
    system = Method2(BLOCK, friction=0.9, kinetic_friction=0.2, g=G)
    base = Base(side * share * B / H * (G + a_z), a_z)
    y, q = after(system, Mode.SLIDE, "stick", (0.3, 0.0, 0.0, 0.0, 0.0, 0.0), base)
    assert q.mode == mode
    if mode == Mode.ROTATION:
        assert q.s == -side
        # The state was that of the +x corner; the block has not moved.
        assert y[0] - 0.5 * B * q.s == pytest.approx(0.3 - 0.5 * B, abs=1e-15)


# With a friction of b/h a block tips and slides at one and the same push: what ended its rest decides.
@SIDES
@pytest.mark.parametrize("below", [1e-12, 1e-9])
def test_a_block_whose_rest_ended_by_tipping_turns_and_by_slipping_slides(side: float, below: float) -> None:
    system = Method2(BLOCK, friction=B / H, kinetic_friction=0.2, g=G)
    base = Base(side * (1.0 - below) * B / H * G, 0.0)
    y, q = after(system, Mode.REST, "tip", (0.0,) * 6, base)
    assert (q.mode, q.s) == (Mode.ROTATION, -side)
    # The state was that of the +x corner; the block has not moved.
    assert y == pytest.approx((0.5 * B * (q.s - 1.0), 0.0, 0.0, 0.0, 0.0, 0.0), abs=1e-15)
    _, q = after(system, Mode.REST, "slip", (0.0,) * 6, base)
    assert (q.mode, q.slip) == (Mode.SLIDE, -side)


def corner_forces(theta: float, omega: float, s: float, base: Base) -> tuple[float, float]:
    """(F, N) per mass at the fixed corner s: the centre turns about it, F = x'' + a_x, N = z'' + g + a_z.

    theta'' follows from moments about the corner, with I_O = (4/3) R^2 per mass.
    """
    # Centre from the corner: (-s b/2, h/2) turned clockwise by theta.
    X, Z = -0.5 * s * B, 0.5 * H
    c_x, c_z = X * math.cos(theta) + Z * math.sin(theta), -X * math.sin(theta) + Z * math.cos(theta)
    spin = (c_x * (G + base.a_z) - c_z * base.a_x) / (4.0 / 3.0 * 0.25 * (B * B + H * H))
    return c_z * spin - c_x * omega**2 + base.a_x, -c_x * spin - c_z * omega**2 + G + base.a_z


@SIDES
@pytest.mark.parametrize(("share", "sticks"), [(0.85, False), (0.99, False), (1.01, True), (1.2, True)])
def test_a_sliding_corner_that_halts_sticks_if_static_friction_holds(side: float, share: float, sticks: bool) -> None:
    theta, omega, base = side * 0.1, side * 0.8, Base(side * 3.0, 1.0)
    F, N = corner_forces(theta, omega, side, base)
    mu_s = share * abs(F) / N
    system = Method2(BLOCK, friction=mu_s, kinetic_friction=0.7 * mu_s, g=G)
    y, q = after(system, Mode.SLIDE_ROTATION, "stick", (0.0, 0.0, theta, 0.0, 0.0, omega), base, s=side)
    assert q.mode == (Mode.ROTATION if sticks else Mode.SLIDE_ROTATION)
    assert (y[2], y[3], y[5], q.s) == (theta, 0.0, omega, side)
    if not sticks:  # friction acts against the slip
        assert q.slip == -math.copysign(1.0, F)


@SIDES
@pytest.mark.parametrize("a_x", [5.0, -5.0])
def test_a_corner_whose_friction_gives_way_slips_against_the_force(side: float, a_x: float) -> None:
    theta, omega, base = side * 0.1, 0.3, Base(a_x, 0.0)
    F, N = corner_forces(theta, omega, side, base)
    system = Method2(BLOCK, friction=abs(F) / N, g=G)
    y, q = after(system, Mode.ROTATION, "slip", (0.0, 0.0, theta, 0.0, 0.0, omega), base, s=side)
    assert (q.mode, q.slip, y[3]) == (Mode.SLIDE_ROTATION, -math.copysign(1.0, F), 0.0)


# Newton: without contact nothing acts on the block; it keeps the velocities it had.
@pytest.mark.parametrize("u", [0.7, -0.7, 0.0])
def test_a_block_that_the_floor_leaves_keeps_its_velocity(u: float) -> None:
    system = Method2(BLOCK, friction=0.2, g=G)
    base = Base(1.0, -(G + 1e-9))
    mode = Mode.SLIDE if u != 0.0 else Mode.REST
    y, q = after(system, mode, "lift", (0.3, 0.0, 0.0, u, 0.0, 0.0), base)
    assert q.mode == Mode.TRANSLATION_JUMP
    assert y == (0.3, 0.0, 0.0, u, 0.0, 0.0)


@SIDES
def test_a_fast_spin_carries_the_corner_off_the_floor(side: float) -> None:
    # omega^2 h/2 above g: the corner would have to pull, stuck or sliding.
    omega = side * 1.3 * math.sqrt(G / (0.5 * H))
    assert corner_forces(0.05 * side, omega, side, Base(0.0, 0.0))[1] < 0.0
    for mode in (Mode.ROTATION, Mode.SLIDE_ROTATION):
        y, q = after(
            Method2(BLOCK, friction=0.4, g=G), mode, "lift", (0.0, 0.0, 0.05 * side, 0.0, 0.0, omega),
            Base(0.0, 0.0), s=side,
        )  # fmt: skip
        assert q.mode == Mode.ROTATION_JUMP
        assert y == (0.0, 0.0, 0.05 * side, 0.0, 0.0, omega)


# A corner bounces for 2 v/(gamma (1 - e_n)) in all, v the speed it leaves with and gamma = g - omega^2 R cos(psi) the
# rate at which it comes back while the block spins.  Only series shorter than chatter_time are finished at once.
@pytest.mark.parametrize(("omega_share", "share", "bounces"), [
    (0.0, 0.9, False), (0.0, 1.1, True), (0.9, 0.9, False), (0.9, 1.1, True), (1.1, 0.01, True),
])  # fmt: skip
def test_only_a_series_of_bounces_shorter_than_chatter_time_is_finished(
    omega_share: float, share: float, bounces: bool
) -> None:
    e_n, theta, chatter_time = 0.5, 0.3, 1e-7
    lever = 0.5 * B * math.sin(theta) + 0.5 * H * math.cos(theta)  # height of the centre over the +x corner
    omega = math.sqrt(omega_share * G / lever)
    gamma = G - omega**2 * lever
    v_up = share * 0.5 * chatter_time * (1.0 - e_n) * (abs(gamma) if omega_share < 1.0 else G)
    system = Method2(BLOCK, friction=0.5, normal_restitution=e_n, tangential_restitution=-1.0,
                     chatter_time=chatter_time, g=G)  # fmt: skip
    # Frictionless and slow (1e-7 m/s), the impact changes omega by 1e-7 of 4 rad/s: the spin is that before.
    y, q = after(system, Mode.ROTATION_JUMP, "contact", (0.0, 0.0, theta, 0.0, -v_up / e_n, omega), Base(0.0, 0.0))
    if bounces:
        assert q.mode == Mode.ROTATION_JUMP
        assert y[4] == pytest.approx(v_up, rel=1e-9)
    else:
        assert q.mode in (Mode.ROTATION, Mode.SLIDE_ROTATION)
        assert y[4] == 0.0
