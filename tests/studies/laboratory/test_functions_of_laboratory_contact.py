"""Functions of the virtual laboratory's block on springs: forces at each point of its base, summed.

What runs of whole tests cannot tell apart: which part of a base is in the floor, which spring pushes, holds or slips,
how a block is set down, and each stage of a step.
"""

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from studies.laboratory import contact, event
from studies.laboratory.parameters import World

from .laboratory_blocks import WORLD
from .laboratory_newton import cubics

CORNERS = replace(
    WORLD, offset=0.007, tilt=0.02, stiffness=2e5, damping=300.0, give=0.6, friction=0.4, viscous=0.4, gravity=9.7
)
BED = replace(CORNERS, springs=15.0, damping=0.0)
STATES = range(40)


def on_the_floor(rng: np.random.Generator, deep: float = 0.01) -> np.ndarray:
    """A state of a block that is in the floor to about that depth at one corner or both."""
    theta = rng.uniform(-0.06, 0.06)
    height = CORNERS.centre_height * math.cos(theta) + CORNERS.half_breadth * abs(math.sin(theta))
    return np.array([
        rng.uniform(-0.05, 0.05), height - rng.uniform(0.0, deep), theta, *rng.uniform(-0.3, 0.3, 2),
        rng.uniform(-2.0, 2.0), *rng.uniform(-2e-3, 2e-3, 2),
    ])  # fmt: skip


def point(world: World, y: np.ndarray, xi: float) -> tuple[complex, complex]:
    """(arm from the centre of mass, velocity over the floor) of a point of the base; imaginary is up."""
    arm = complex(xi - world.offset, -world.centre_height) * cmath.exp(-1j * y[2])
    return arm, complex(y[3], y[4]) - 1j * y[5] * arm


def push(world: World, y: np.ndarray, xi: float, share: float = 1.0) -> float:
    """Force up on a point of the base, which pushes alone."""
    arm, velocity = point(world, y, xi)
    depth = -(y[1] + arm.imag)
    return share * max(0.0, world.stiffness * depth - world.damping * velocity.imag) if depth > 0.0 else 0.0


def along(world: World, y: np.ndarray, side: int, held: float) -> float:
    """Force along the floor on a corner: what friction gives of a spring that slips and a dashpot."""
    arm, velocity = point(world, y, side * world.half_breadth)
    if y[1] + arm.imag >= 0.0:
        return 0.0
    share = 1.0 if world.springs == 2 else 0.5
    k, d = share * world.stiffness / world.give, share * world.damping / math.sqrt(world.give)
    most = world.friction * held
    spring = min(most, max(-most, k * y[6 + (side > 0)]))
    return min(most, max(-most, -spring - d * velocity.real))


@pytest.mark.parametrize("world", [CORNERS, BED], ids=["corners", "bed"])
@pytest.mark.parametrize("state", STATES)
def test_a_block_on_springs_is_moved_by_what_each_point_of_its_base_gives(world: World, state: int) -> None:
    """Forces and moments of the whole base, summed; a floor that neither turns nor pitches."""
    rng = np.random.default_rng(state)
    c, x, y = cubics(rng), rng.uniform(0.0, 0.1), on_the_floor(rng)
    c[2:] = 0.0
    corners = {side: push(world, y, side * world.half_breadth) for side in (-1, 1)}
    if world.springs == 2:
        up = sum(corners.values())
        moment = -sum(f * point(world, y, side * world.half_breadth)[0].real for side, f in corners.items())
    else:
        # What is in the floor is cut off by it: where a point's height is zero.
        B = world.half_breadth
        over = [y[1] + point(world, y, xi)[0].imag for xi in (-B, B)]
        edge = [-B + 2.0 * B * over[0] / (over[0] - over[1])] if over[0] * over[1] < 0.0 else None
        up = quad(lambda xi: push(world, y, xi, 0.5 / B), -B, B, points=edge, epsabs=1e-9)[0]
        moment = -quad(
            lambda xi: push(world, y, xi, 0.5 / B) * point(world, y, xi)[0].real, -B, B, points=edge, epsabs=1e-9
        )[0]
        corners = {-1: up, 1: up}
    drags = {side: along(world, y, side, held) for side, held in corners.items()}
    moment += sum(f * point(world, y, side * world.half_breadth)[0].imag for side, f in drags.items())
    reach = world.half_breadth - math.copysign(world.offset, y[2])
    about_corner = world.inertia + world.mass * (reach**2 + world.centre_height**2)
    moment -= about_corner * world.viscous * y[5]
    fx, fz, *_ = event.field(x, c, world.vector())
    found = contact.rate(x, c, y, world.vector())
    expected = (fx + sum(drags.values()) / world.mass, fz + up / world.mass, moment / world.inertia)
    assert found[:3] == pytest.approx(expected, rel=1e-9, abs=1e-9)
    # A corner that is below the floor stretches its spring as fast as it goes along it.
    for i, side in enumerate((-1, 1)):
        arm, velocity = point(world, y, side * world.half_breadth)
        assert found[3 + i] == pytest.approx(velocity.real if y[1] + arm.imag < 0.0 else 0.0, rel=1e-12)


@pytest.mark.parametrize("state", STATES)
def test_a_step_cuts_springs_that_friction_does_not_hold_and_lets_go_of_those_above_the_floor(state: int) -> None:
    rng = np.random.default_rng(state)
    y = on_the_floor(rng)
    slipped = y.copy()
    contact.slip(slipped, CORNERS.vector())
    assert (slipped[:6] == y[:6]).all()
    for i, side in enumerate((-1, 1)):
        arm, _ = point(CORNERS, y, side * CORNERS.half_breadth)
        most = CORNERS.friction * push(CORNERS, y, side * CORNERS.half_breadth) * CORNERS.give / CORNERS.stiffness
        kept = min(most, max(-most, y[6 + i])) if y[1] + arm.imag < 0.0 else 0.0
        assert slipped[6 + i] == pytest.approx(kept, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("state", range(200))
def test_contacts_tell_which_springs_push_and_which_corners_are_down_or_slip(state: int) -> None:
    y = on_the_floor(np.random.default_rng(state), deep=0.002)
    expected = 0
    for i, side in enumerate((-1, 1)):
        arm, _ = point(CORNERS, y, side * CORNERS.half_breadth)
        force = push(CORNERS, y, side * CORNERS.half_breadth)
        down = y[1] + arm.imag < 0.0
        slips = down and CORNERS.stiffness / CORNERS.give * abs(y[6 + i]) >= CORNERS.friction * force
        expected |= (force > 0.0) << i | down << (2 + i) | slips << (4 + i)
    assert contact.contacts(y, CORNERS.vector()) == expected


@pytest.mark.parametrize("state", STATES)
def test_contacts_of_a_bed_tell_which_of_its_points_push(state: int) -> None:
    rng = np.random.default_rng(state)
    damped, y = replace(BED, damping=2000.0), on_the_floor(rng)
    places = np.polynomial.legendre.leggauss(15)[0]
    low, high = -BED.half_breadth, BED.half_breadth
    over = [y[1] + point(BED, y, xi)[0].imag for xi in (low, high)]
    cut = low + (high - low) * over[0] / (over[0] - over[1])
    if over[0] * over[1] < 0.0:
        low, high = (low, cut) if over[0] < 0.0 else (cut, high)
    points = 0.5 * (low + high) + 0.5 * (high - low) * places
    expected = sum((push(damped, y, xi) > 0.0) << i for i, xi in enumerate(points))
    assert contact.contacts(y, damped.vector()) & (2**15 - 1) == expected


@pytest.mark.parametrize("world", [CORNERS, BED], ids=["corners", "bed"])
def test_a_block_that_stands_on_springs_begins_at_rest(world: World) -> None:
    """On a floor that leans, off its middle, but for squares of the lean and of the turn, which are counted here.

    What the turn itself adds to the weight's moment, m g H over 2 k b^2 (a bed: k b^2 / 3) of it, is left out.
    """
    stiff, weight, corners = replace(world, friction=5.0, stiffness=4e6), WORLD.mass * 9.7, world.springs == 2
    y, turning_stiffness = contact.start(stiff, 0.0), 4e6 * 0.1**2 * (2.0 if corners else 1.0 / 3.0)
    out = world.offset + world.tilt * WORLD.centre_height
    assert abs(y[2]) == pytest.approx(weight * out / turning_stiffness, rel=1e-6)
    ax, az, turning, *_ = contact.rate(0.0, np.zeros((5, 4)), y, stiff.vector())
    # The weight across the floor is less by its cosine; a block that turns lifts its base by H (1 - cos).
    lifted = WORLD.centre_height * (1.0 - math.cos(y[2])) * 4e6 * (2.0 if corners else 1.0) / weight
    assert ax == pytest.approx(0.0, abs=1e-9)
    assert az == pytest.approx(9.7 * (1.0 - math.cos(world.tilt) - lifted), rel=0.02)
    beside = weight * WORLD.centre_height / turning_stiffness
    assert abs(turning) == pytest.approx(beside * weight * out / world.inertia, rel=0.02) and beside < 0.02


@pytest.mark.parametrize("world", [CORNERS, replace(CORNERS, stiffness=4e6), BED, replace(BED, stiffness=1e5)])
@pytest.mark.parametrize("lean", [0.2, -0.2, 0.01, -0.003])
def test_a_block_that_is_held_at_a_lean_is_borne(world: World, lean: float) -> None:
    """One corner or a part of the bed carries the weight; stretches begin at none."""
    y = contact.start(world, lean)
    assert y[2] == lean and not y[3:].any()
    if world.springs == 2:
        arm = point(world, y, math.copysign(world.half_breadth, lean))[0]
        borne = -world.stiffness * (y[1] + arm.imag)
    else:
        borne = contact.pushes(y, math.sin(lean), math.cos(lean), world.vector())[0]
    assert borne == pytest.approx(world.mass * world.gravity, rel=1e-12)


@pytest.mark.parametrize("world", [CORNERS, BED], ids=["corners", "bed"])
def test_a_step_between_changes_of_contact_is_of_fourth_order(world: World) -> None:
    """Half the step leaves a thirty-second of a single step's error, in all eight numbers; friction holds."""
    rough, rng = replace(world, friction=20.0), np.random.default_rng(2)
    y = np.array([0.01, WORLD.centre_height - 0.004, 0.01, 0.02, -0.05, 0.03, 1e-4, -1e-4])
    c = cubics(rng)

    def derivative(t, z):
        a = contact.rate(t, c, z, rough.vector())
        return np.array([*z[3:6], *a])

    apart = []
    for h in (2e-3, 1e-3):
        exact = solve_ivp(derivative, (0.0, h), y, method="DOP853", rtol=1e-13, atol=1e-16).y[:, -1]
        ours = y.copy()
        contact.advance(0.0, h, c, ours, rough.vector())
        apart.append(np.abs(ours - exact))
    assert apart[0] / apart[1] == pytest.approx(32.0, rel=0.35)


@pytest.mark.parametrize("world", [CORNERS, BED], ids=["corners", "bed"])
def test_a_step_in_which_a_corner_lands_is_cut_up(world: World) -> None:
    """A corner that lands at 0.5 m/s in the midst of a step: a 256th of it alone goes over the landing."""
    P, c, step = replace(world, friction=20.0).vector(), np.zeros((5, 4)), 1e-4
    lean, B, H = 0.05, WORLD.half_breadth, WORLD.centre_height
    height = (B - world.offset) * math.sin(lean) + H * math.cos(lean) + 0.5 * step * 0.5
    begin = np.array([0.0, height, lean, 0.1, -0.5, 0.2, 0.0, 0.0])
    cut, straight, fine = begin.copy(), begin.copy(), begin.copy()
    touching = contact.across(0.0, step, c, cut, contact.contacts(begin, P), P)
    assert touching == contact.contacts(cut, P) != contact.contacts(begin, P)
    contact.advance(0.0, step, c, straight, P)
    for k in range(4000):
        contact.advance(k * step / 4000, step / 4000, c, fine, P)
    assert np.abs(cut - fine)[3:6].max() < contact.FINEST * np.abs(straight - fine)[3:6].max()
    # A second step, in which nothing changes, is one.
    once, parts = cut.copy(), cut.copy()
    contact.advance(step, 0.1 * step, c, once, P)
    assert contact.across(step, 0.1 * step, c, parts, touching, P) == touching
    assert (once == parts).all()
