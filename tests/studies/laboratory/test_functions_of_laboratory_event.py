"""Functions of the virtual laboratory's rocking block: Newton seen from the ground, SciPy, laws written out.

What runs of whole tests cannot tell apart: each coefficient of the floor's motion, each torque and each share of the
impact law, and when a corner lands or a block stops within a step.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from studies.laboratory import event

from .laboratory_blocks import WORLD
from .laboratory_newton import ODD, cubics, forces

STATES = range(40)


@pytest.mark.parametrize("state", STATES)
def test_a_block_that_rolls_on_its_edge_obeys_newton_seen_from_the_ground(state: int) -> None:
    rng = np.random.default_rng(state)
    c, x, s = cubics(rng), rng.uniform(0.0, 0.1), float(rng.choice([-1, 1]))
    phi, v = rng.uniform(0.0, 0.5), rng.uniform(-2.0, 2.0)
    a = event.acceleration(x, c, s, phi, v, 0.0, 0.0, 0.0, ODD.vector())[0]
    assert forces(ODD, c, x, s, (s * phi, s * v, s * a), (0.0, 0.0, 0.0))[2] == pytest.approx(0.0, abs=1e-8)


@pytest.mark.parametrize("state", STATES)
def test_a_side_lifts_once_the_moment_about_the_other_exceeds_what_adheres(state: int) -> None:
    rng = np.random.default_rng(state)
    c, x = cubics(rng), rng.uniform(0.0, 0.1)
    c[0, 0] += float(rng.choice([-1, 1])) * 14.0  # so that it lifts
    moments = {s: s * forces(ODD, c, x, s, (0.0,) * 3, (0.0,) * 3)[2] * ODD.mass for s in (1.0, -1.0)}
    side = max(moments, key=lambda s: moments[s])
    assert moments[side] > 0.0 > moments[-side]
    for share, lifts in ((0.999, side), (1.001, 0.0)):
        glued = replace(ODD, adhesion=share * moments[side]).vector()
        assert event.side_that_lifts(x, c, 0.0, 0.0, glued) == lifts


def test_of_two_sides_that_lift_the_faster_one_does() -> None:
    """A floor that falls faster than free throws the block; off its middle toward +x, the side of -x rises first."""
    c = np.zeros((5, 4))
    c[1, 0] = -20.0
    for offset, side in ((0.01, -1.0), (-0.01, 1.0)):
        P = replace(WORLD, offset=offset).vector()
        plus, minus = (event.acceleration(0.0, c, s, 0.0, 0.0, 0.0, 0.0, 0.0, P)[0] for s in (1.0, -1.0))
        assert min(plus, minus) > 0.0 and (plus > minus) == (side > 0.0)
        assert event.side_that_lifts(0.0, c, 0.0, 0.0, P) == side


INERTIA = 3.1
# Effect, lean (to the right), angular velocity, angular acceleration of the lean as each law is written.
TORQUES = [
    ({"viscous": 0.3}, 0.2, -0.7, 0.21),
    ({"quadratic": 0.3}, 0.2, -0.7, 0.147),
    ({"quadratic": 0.3}, 0.2, 0.7, -0.147),
    ({"cubic": 5.0}, 0.2, 0.7, -0.04),
    ({"tether_stiffness": 31.0, "tether_plus": 0.15}, 0.2, 0.7, -0.5),
    ({"tether_stiffness": 31.0, "tether_plus": 0.25}, 0.2, 0.7, 0.0),
    ({"tether_stiffness": 31.0, "tether_minus": 0.15}, 0.2, 0.7, 0.0),
    ({"tether_stiffness": 31.0, "tether_minus": 0.15}, -0.2, 0.7, -0.5),
    ({"tether_stiffness": 31.0, "tether_minus": 0.25}, -0.2, 0.7, 0.0),
    ({"side_viscous": 0.3}, 0.2, 0.7, -0.21),
    ({"side_viscous": 0.3}, -0.2, 0.7, 0.0),
    ({"squeeze": 0.4, "squeeze_width": 0.1}, 0.2, 0.7, -0.28 * math.exp(-2.0)),
    ({"brake": 0.4, "brake_at": 0.1, "brake_width": 0.05}, 0.2, 0.7, -0.28 * math.exp(-4.0)),
    ({"brake": 0.4, "brake_at": 0.1, "brake_width": 0.05}, -0.1, 0.7, -0.28 * math.exp(-16.0)),
    ({"rib": 0.5, "rib_period": 0.6}, 0.05, 0.7, 0.25),
    ({"rib": 0.5, "rib_period": 0.6}, -0.05, 0.7, 0.25),
    ({"magnet": 0.4, "magnet_width": 0.1}, 0.2, 0.7, -0.4 * math.exp(-2.0)),
]


@pytest.mark.parametrize(("numbers", "lean", "speed", "expected"), TORQUES)
def test_each_torque_is_as_its_law_is_written(numbers: dict, lean: float, speed: float, expected: float) -> None:
    s = math.copysign(1.0, lean)
    found = event.own_torque(s, abs(lean), speed, 0.0, replace(WORLD, **numbers).vector(), INERTIA)
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("s", [1.0, -1.0])
def test_a_layer_pulls_against_its_strain_and_yields(s: float) -> None:
    """Bouc (1967), Wen (1976), with an exponent of two: z' = theta' - |theta'| z |z| / width^2."""
    P = replace(WORLD, layer=6.2, layer_width=0.03).vector()
    assert event.own_torque(s, 0.2, 0.7, 0.02, P, INERTIA) == pytest.approx(-s * 0.04, rel=1e-12)
    still = np.zeros((5, 4))
    for z in (0.02, -0.02):
        found = event.acceleration(0.0, still, s, 0.2, 0.7, z, 0.0, 0.0, P)[1]
        assert found == pytest.approx(0.7 * s - 0.7 * z * abs(z) / 0.03**2, rel=1e-12)


def test_dry_friction_grows_with_the_lean_or_rubs_on_one_side_from_a_lean_on() -> None:
    P = replace(WORLD, hinge=0.5, guide=0.3, guide_from=0.1).vector()
    states = ((1.0, 0.2), (1.0, 0.1), (1.0, 0.05), (-1.0, 0.2))
    assert [event.rubbing(s, phi, P) for s, phi in states] == pytest.approx([0.4, 0.35, 0.025, 0.1], rel=1e-12)
    still = np.zeros((5, 4))
    free, rubbed = (event.acceleration(0.0, still, 1.0, 0.2, 0.0, 0.0, 0.0, turn, P)[0] for turn in (0.0, -1.0))
    assert rubbed - free == pytest.approx(0.4, rel=1e-12)


@pytest.mark.parametrize(
    ("push", "speed", "sense"),
    [(0.0, 0.3, 1.0), (0.0, -0.3, -1.0), (0.1, 0.0, 0.0), (-0.1, 0.0, 0.0), (1.0, 0.0, 1.0), (-1.0, 0.0, -1.0)],
)
def test_dry_friction_is_against_motion_or_holds_what_it_can(push: float, speed: float, sense: float) -> None:
    """At the lean of balance, where the floor's acceleration alone pushes: a H R / J against 0.4 of friction."""
    P, R = replace(WORLD, hinge=0.4 / WORLD.alpha).vector(), math.hypot(WORLD.half_breadth, WORLD.centre_height)
    c = np.zeros((5, 4))
    c[0, 0] = -push * WORLD.corner_inertia / (WORLD.mass * R)
    free = event.acceleration(0.0, c, 1.0, WORLD.alpha, 0.0, 0.0, 0.0, 0.0, P)[0]
    assert free == pytest.approx(push, abs=1e-9)
    assert event.direction(0.0, c, 1.0, WORLD.alpha, speed, 0.0, 0.0, P) == sense


# Effect, side on which the swing ends, speed, time since the last impact, impacts, use, a_x; what is lost of 0.92.
LOSSES = [
    ({"slope": -0.02}, (1.0, 0.5, 1.0, 3, 0.0, 0.0), 0.01),
    ({"leak": 0.05, "leak_time": 0.5}, (1.0, 0.5, 1.0, 3, 0.0, 0.0), 0.05 * math.exp(-2.0)),
    ({"bedding": 0.05}, (1.0, 0.5, 1.0, 8, 0.0, 0.0), 0.05 * math.exp(-2.0)),
    ({"grind": 0.05, "grind_use": 2.0}, (1.0, 0.5, 1.0, 3, 4.0, 0.0), 0.05 * (1.0 - math.exp(-2.0))),
    ({"heed": 0.01}, (1.0, 0.5, 1.0, 3, 0.0, 2.0), -0.02),
    ({"heed": 0.01}, (-1.0, 0.5, 1.0, 3, 0.0, 2.0), 0.02),
]


@pytest.mark.parametrize(("numbers", "impact", "lost"), LOSSES)
def test_each_loss_of_an_impact_is_as_its_law_is_written(numbers: dict, impact: tuple, lost: float) -> None:
    found = event.restitution(*impact, replace(WORLD, **numbers).vector())
    assert found == pytest.approx(0.92 - lost, rel=1e-12)


def test_restitution_stays_between_none_and_all() -> None:
    impact = (1.0, 0.5, 1.0, 3, 0.0, 0.0)
    assert [event.restitution(*impact, replace(WORLD, slope=slope).vector()) for slope in (-2.0, 2.0)] == [0.0, 1.0]


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_eccentric_mass_parts_restitution_by_the_balance_of_angular_momentum(side: float) -> None:
    """About the new edge, from what turns about the old one; rolling edges are their radius nearer to the middle."""
    world = replace(WORLD, offset=0.007, radius=0.012)

    def balance(offset: float) -> float:
        arms = [
            np.array([offset - edge * (world.half_breadth - world.radius), world.centre_height])
            for edge in (side, -side)
        ]
        before = world.inertia + world.mass * arms[0] @ arms[1]
        return before / (world.inertia + world.mass * arms[1] @ arms[1])

    found = event.restitution(side, 0.5, 1.0, 3, 0.0, 0.0, world.vector())
    assert found / 0.92 == pytest.approx(balance(world.offset) / balance(0.0), rel=1e-12)


@pytest.mark.parametrize("which", [0, 1])
def test_a_step_is_cut_where_a_corner_lands_or_a_swing_turns(which: int) -> None:
    """As SciPy finds it in the same equations: random states, a mass that hangs in the block."""
    rng, h = np.random.default_rng(which), 0.004
    P = replace(ODD, slosh_mass=10.0, slosh_length=0.1, slosh_height=0.35, slosh_damping=1.0).vector()
    cut = 0
    for _ in range(40):
        c, s = cubics(rng), float(rng.choice([-1, 1]))
        phi, v = (rng.uniform(1e-4, 2e-3), -rng.uniform(0.4, 1.0)) if which == 0 else (0.1, rng.uniform(-0.02, 0.02))
        state = (phi, v, rng.uniform(-0.3, 0.3), rng.uniform(-2.0, 2.0))

        def derivative(t, y, c=c, s=s):
            a, dq, ddq = event.acceleration(t, c, s, *y, 0.0, P)
            return y[1], a, dq, ddq

        def changes(t, y, c=c, s=s):
            return y[which]

        changes.terminal = True  # type: ignore[attr-defined]
        exact = solve_ivp(
            derivative, (0.0, h), state, method="DOP853", rtol=1e-12, atol=1e-15, events=changes, first_step=1e-5
        )
        if not len(exact.t_events[0]):
            continue
        cut += 1
        tau = event.locate(0.0, h, c, s, *state, 0.0, P, which)
        assert tau == pytest.approx(exact.t[-1], rel=1e-6)
        after = event.rk4(0.0, tau, c, s, *state, 0.0, P)
        assert after[which] == pytest.approx(0.0, abs=1e-14)
        assert after == pytest.approx(exact.y[:, -1], rel=1e-6, abs=1e-9)
    assert cut > 10


def test_a_mass_that_hangs_in_a_standing_block_is_pushed_along_its_arc() -> None:
    """The field across and along an arm at 0.3 rad, over its length, less what damps it."""
    c = cubics(np.random.default_rng(1))
    P = replace(ODD, slosh_mass=10.0, slosh_length=0.1, slosh_height=0.35, slosh_damping=1.5).vector()
    fx, fz = event.field(0.05, c, P)[:2]
    expected = (math.cos(0.3) * fx + math.sin(0.3) * fz) / 0.1 - 1.5 * 0.7
    assert event.at_rest(0.05, c, 0.3, 0.7, P) == pytest.approx(expected, rel=1e-12)
    assert event.at_rest(0.05, c, 0.3, 0.7, ODD.vector()) == 0.0
