"""The virtual laboratory's block whose foot slips against closed forms and the package, which share no code with it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from rocking import Block, Method1, scalars, solve
from rocking.effects import load
from rocking.impacts import two_corner_impact
from studies.laboratory import event, slip
from studies.laboratory.parameters import G, uniform

from .laboratory_blocks import (
    AT_REST,
    BLOCK,
    BREADTH,
    END,
    HEIGHT,
    LEAN,
    RESTITUTION,
    SAME,
    STEP,
    STILL,
    TIME,
    WORLD,
    Shaking,
    floor,
)

LOSSY = 0.85 * BLOCK.housner_restitution
"""A restitution for which corners alone would have to pull, and for which friction holds in an impact from 0.48 on."""


def test_friction_that_holds_changes_nothing() -> None:
    stuck = slip.simulate(replace(WORLD, friction=0.8), AT_REST, STEP, 4, LEAN)
    held = event.simulate(WORLD, AT_REST, STEP, 4, LEAN)
    # Times, and angular velocities before and after.
    assert stuck.impacts[:8].ravel() == pytest.approx(held.impacts[:8].ravel(), abs=1e-8)


@pytest.mark.parametrize(
    ("restitution", "friction", "lean", "impacts"),
    [
        (RESTITUTION, 0.15, 0.2, 19), (RESTITUTION, 0.2, 0.2, 23),
        (RESTITUTION, 0.22, 0.2, 19), (RESTITUTION, 0.36, 0.0, 22),
        (LOSSY, 0.15, 0.2, 18), (LOSSY, 0.2, 0.2, 16), (LOSSY, 0.22, 0.2, 23), (LOSSY, 0.36, 0.0, 23),
    ],
)  # fmt: skip
def test_impacts_of_a_block_whose_foot_slips_are_those_of_the_package(
    restitution: float, friction: float, lean: float, impacts: int
) -> None:
    """Slip in the swings and in the impacts, and the ratio of angular speeds as far as it makes no energy.

    The laboratory comes to rest earlier than the package; up to there all impacts are compared.
    """
    system, forced = Method1(BLOCK, restitution=restitution, g=G), lean == 0.0
    floor_moves = floor(Shaking.kernel(np, TIME, Shaking.parameters)[0]) if forced else AT_REST
    theirs = solve(
        system, Shaking() if forced else None, t_end=END, theta=lean, effects=[load("sliding")(friction, 1.0)],
        solver="scipy", rtol=1e-11, atol=1e-13,
    ).impact_times[:impacts]  # fmt: skip
    world = replace(WORLD, restitution=restitution)
    ours = slip.simulate(replace(world, friction=friction), floor_moves, STEP, 4, lean).impacts[:impacts, 0]
    assert len(theirs) == impacts
    assert ours == pytest.approx(theirs, abs=1e-9)
    stuck = event.simulate(world, floor_moves, STEP, 4, lean).impacts[:impacts, 0]
    # Slip matters: so far it moves an impact.  A block that loses more rocks less, and slips less.
    common = min(len(stuck), impacts)
    assert abs(ours[:common] - stuck[:common]).max() > (0.05 if restitution == RESTITUTION else 1e-4)


def test_an_impact_keeps_the_ratio_as_far_as_it_makes_no_energy_and_then_is_that_of_the_package() -> None:
    """The laboratory halves an interval, the package solves quadratics; some of the blocks are off their middle."""
    rng, bounded = np.random.default_rng(7), 0
    for _ in range(1000):
        breadth, w, side = rng.uniform(0.1, 0.8), rng.uniform(0.1, 3.0), float(rng.choice([-1, 1]))
        block = Block(breadth, 1.0)
        e = rng.uniform(0.3 * block.housner_restitution, 1.0)
        friction, begun = rng.uniform(0.05, 1.2), w * rng.uniform(-1.5, 1.5)
        offset = breadth * float(rng.choice([-0.1, 0.0, 0.1]))
        world = replace(uniform(breadth, 1.0, block.mass, e), friction=friction, offset=offset)
        speed, slips = slip.strike(side, -w, begun, e, world.vector())
        theirs, turns = two_corner_impact(
            scalars, -side, begun, -side * w, 0.5 * breadth, offset, 0.5, world.inertia / world.mass, friction, e, 1.0
        )
        assert (speed, slips) == pytest.approx((-side * turns, theirs), abs=1e-9 * (w + abs(begun)))
        bounded += speed < e * w * (1.0 - 1e-9)
    # About a fifth of them would make energy.
    assert 150 < bounded < 300


class Pitching(Shaking):
    """The same on a floor that pitches by 0.004 rad at 2 Hz."""

    has_pitch = True

    @staticmethod
    def pitch_kernel(xp, t, par):
        w = 4.0 * math.pi
        return 0.004 * xp.sin(w * t), -0.004 * w * w * xp.sin(w * t)


# How far the effect alone moves an impact is that of `stuck`.  Friction, lean (0: the floor shakes), impacts.
SLIPPING = [(0.22, 0.2, 12), (0.36, 0.0, 12)]


@pytest.mark.parametrize(
    ("name", "friction", "lean", "impacts"),
    [
        *((name, *case) for name in (*SAME, "eccentric_mass") if name != "ideal" for case in SLIPPING),
        ("table_pitch", *SLIPPING[1]),
    ],
)
def test_a_block_whose_foot_slips_has_the_effects_of_the_package(
    name: str, friction: float, lean: float, impacts: int
) -> None:
    """Method 2 with an effect: equations, lift-off and the impact law, each written for itself.

    The package keeps the geometric mean of both sides' restitution of an eccentric block, the laboratory what is gained
    over the balance of angular momentum; the package leaves out the floor's rate of pitch.
    """
    effects, changes = SAME.get(name, ([load("eccentric_mass")(offset=0.002)], {"offset": 0.002}))
    angle = 0.004 * np.sin(4.0 * math.pi * TIME)
    rate = 0.016 * math.pi * np.cos(4.0 * math.pi * TIME)
    pitch = (STILL, STILL, STILL)
    if name == "table_pitch":
        effects, changes, pitch = [], {}, (angle, rate, -((4.0 * math.pi) ** 2) * angle)
    shaken = Shaking.kernel(np, TIME, Shaking.parameters)[0] if lean == 0.0 else STILL
    motion = (Pitching() if name == "table_pitch" else Shaking()) if lean == 0.0 else None
    theirs = solve(
        Method1(BLOCK, restitution=RESTITUTION, g=G), motion, t_end=END, theta=lean,
        effects=[*effects, load("sliding")(friction, 1.0)], rtol=1e-11, atol=1e-13,
    ).impact_times[:impacts]  # fmt: skip
    world = replace(WORLD, friction=friction, **changes)
    ours = slip.simulate(world, floor(shaken, pitch=pitch), STEP, 4, lean).impacts[:impacts, 0]
    apart = {"eccentric_mass": 3e-4, "table_pitch": 2e-4}.get(name, 1e-8)
    assert ours == pytest.approx(theirs, abs=apart)
    stuck = event.simulate(replace(WORLD, **changes), floor(shaken, pitch=pitch), STEP, 4, lean).impacts[:impacts, 0]
    without = slip.simulate(replace(WORLD, friction=friction), floor(shaken), STEP, 4, lean).impacts[:impacts, 0]
    assert abs(ours - stuck).max() > 100.0 * apart
    if name != "base_adhesion":  # which a lean has broken, and a foot that slips
        assert abs(ours - without).max() > 20.0 * apart


@pytest.mark.parametrize("number", slip.FOREIGN)
def test_the_laboratory_of_a_block_that_slides_refuses_what_it_lacks(number: str) -> None:
    with pytest.raises(ValueError, match=f"{number}=0.1: not in the laboratory of a block that slides"):
        slip.simulate(replace(WORLD, friction=0.4, **{number: 0.1}), AT_REST, STEP, 4, 0.1)


def test_a_block_whose_foot_slips_starts_from_its_lean_and_falls_back_alike_from_either_side() -> None:
    right, left = (slip.simulate(replace(WORLD, friction=0.2), AT_REST, STEP, 4, lean) for lean in (LEAN, -LEAN))
    assert right.rotation[0] == pytest.approx(LEAN) and left.rotation[0] == pytest.approx(-LEAN)
    assert left.rotation[:2000] == pytest.approx(-right.rotation[:2000], abs=1e-12)
    # Housner's first interval: the block goes back, not over.
    assert 0.0 < right.rotation[50] < LEAN


LITTLE = replace(WORLD, friction=0.2)


def test_a_standing_block_slides_until_friction_has_stopped_it_and_again_when_the_push_exceeds_it() -> None:
    """Slip V ends after V / (mu g) on a floor that rests; a_x = mu g - 0.01 + 100 t passes mu g at 0.1 ms."""
    still = np.zeros((5, 4))
    used, _, velocity, side = slip.stand(0.0, 0.001, still, 0.0, 1e-4, LITTLE.vector())
    assert used == pytest.approx(1e-4 / (0.2 * G), rel=1e-9) and (velocity, side) == (0.0, 0.0)
    pushed = still.copy()
    pushed[0, :2] = 0.2 * G - 0.01, 100.0
    used, _, velocity, side = slip.stand(0.0, 0.001, pushed, 0.0, 0.0, LITTLE.vector())
    assert used == pytest.approx(1e-4, rel=1e-6) and (velocity, side) == (0.0, 0.0)


def test_slip_that_stops_just_before_an_impact_stops_before_it() -> None:
    """Slip of 0.1 mm/s against its deceleration by Newton's equations; the corner would land only after 0.15 ms."""
    world, phi, speed, kappa = LITTLE, 1.5e-4, -1.0, -LITTLE.friction
    D = -world.half_breadth * math.cos(phi) + world.centre_height * math.sin(phi)
    Z = world.half_breadth * math.sin(phi) + world.centre_height * math.cos(phi)
    # Turning about the centre, falling, and sliding: phi'', acceleration of the corner, normal force over mass.
    newton = np.array([[world.inertia / world.mass, 0.0, -(D + kappa * Z)], [D, 0.0, 1.0], [Z, 1.0, kappa]])
    turning, slipping, _ = np.linalg.solve(newton, [0.0, G - Z * speed**2, D * speed**2])
    used, lean, _, _, velocity = slip.rock(0.0, 2e-4, np.zeros((5, 4)), 1.0, phi, speed, 0.0, -1e-4, world.vector())
    # Over 10 us the deceleration changes by 1e-4 of itself.
    assert used == pytest.approx(1e-4 / slipping, rel=1e-3)
    assert lean == pytest.approx(phi + speed * used + 0.5 * turning * used**2, rel=1e-6)
    assert velocity == 0.0 and lean > 0.0


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_block_with_friction_leaves_the_floor_when_a_growing_push_passes_wests_acceleration(side: float) -> None:
    """a_x = 300 t passes b/h g at 10.9 ms; the step looks for it from 10.5 to 11.5 ms."""
    pushed = np.zeros((5, 4))
    pushed[0, 1] = -300.0 * side
    west = BREADTH / HEIGHT * G / 300.0
    used, _, velocity, lifts = slip.stand(0.0105, 0.001, pushed, 0.0, 0.0, replace(WORLD, friction=0.9).vector())
    assert 0.0105 + used == pytest.approx(west, rel=1e-12)
    assert (velocity, lifts) == (0.0, side)


def test_a_block_with_little_friction_slides_and_never_rocks() -> None:
    """Constant 4 m/s^2 against mu g with mu = 0.2 < b / h: the difference is the slip's acceleration."""
    response = slip.simulate(replace(WORLD, friction=0.2), floor(STILL + 4.0), STEP, 4, 0.0)
    assert not response.rotation.any()
    assert response.centre is not None
    assert response.centre[1:, 0] == pytest.approx(-(4.0 - 0.2 * G), rel=1e-12)


@pytest.mark.parametrize("lean", [-LEAN, LEAN])
def test_the_centre_of_a_block_whose_foot_stays_goes_where_its_edge_takes_it(lean: float) -> None:
    """Second differences of its place: an edge of 5 mm that has rolled along the floor, and an arm turned by the lean.

    The fourth derivative is below 150 m/s^4, so that they are off by 150 h^2 / 12 at the most.
    """
    radius, offset = 0.005, 0.004
    world = replace(WORLD, friction=5.0, radius=radius, offset=offset)
    found = slip.simulate(world, AT_REST, STEP, 1, lean)
    assert found.centre is not None
    first = int(found.impacts[0, 0] / STEP)  # the last sample before the first impact
    side, phi = math.copysign(1.0, lean), found.rotation[:first]
    # From the middle of the edge's circle, in the block: where this is, it has rolled by radius times the lean.
    arm = np.array([offset - side * (world.half_breadth - radius), world.centre_height - radius])
    x = radius * phi + arm[0] * np.cos(phi) + arm[1] * np.sin(phi)
    z = radius - arm[0] * np.sin(phi) + arm[1] * np.cos(phi)
    for place, felt in ((x, found.centre[:first, 0]), (z, found.centre[:first, 1])):
        assert felt[1:-1] == pytest.approx(np.diff(place, 2) / STEP**2, abs=150.0 * STEP**2 / 12.0)
        assert np.ptp(felt) > 0.1


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("begun", [-0.9, 0.0, 0.9])
def test_friction_in_an_impact_is_at_the_most_its_share_of_the_vertical_impulse(begun: float, side: float) -> None:
    """Both impulses are changes of the centre's velocity; the ratio of angular speeds is given."""
    world, w, e, friction = replace(WORLD, friction=0.05), 0.7, 0.9, 0.05
    half, height = world.half_breadth, world.centre_height
    speed, slips = slip.strike(side, -w, begun, e, world.vector())
    assert speed == pytest.approx(e * w, rel=1e-12)
    turned_before, turned_after = -side * w, -side * e * w  # to +x: from the edge on `side` to the other one
    along = (slips + turned_after * height) - (begun + turned_before * height)
    # It falls on that edge at half w, and leaves on the other one at half e w.
    assert abs(along) == pytest.approx(friction * half * (w + e * w), rel=1e-12)
    stops = begun + (turned_before - turned_after) * height
    assert np.sign(along) == -np.sign(stops) and np.sign(slips) == np.sign(stops)


@pytest.mark.parametrize("lean", [-0.2, 0.2])
def test_a_block_that_friction_holds_falls_in_the_same_sample(lean: float) -> None:
    """Pushed over to either side: the number of samples before it lies on its side, where its foot slips a little."""
    pushed = floor(STILL - math.copysign(4.0, lean))
    held = event.simulate(WORLD, pushed, STEP, 4, lean)
    stuck = slip.simulate(replace(WORLD, friction=5.0), pushed, STEP, 4, lean)
    assert held.fell is not None and stuck.fell == held.fell
    leaning = int(np.argmax(np.abs(held.rotation) > 0.9))
    assert stuck.rotation[:leaning] == pytest.approx(held.rotation[:leaning], abs=1e-8)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_round_edge_that_does_not_slip_rolls(side: float) -> None:
    """What turns about the point of contact: d X / d phi is the height over it, d Z / d phi how far it is behind."""
    P, h = replace(WORLD, radius=0.01, offset=0.004).vector(), 1e-5
    for phi in (0.0, 0.1, 0.4):
        before, now, after = (np.array(slip.places(side, phi + k * h, P)) for k in (-1, 0, 1))
        slope = (after - before) / (2.0 * h)
        assert slope[0] == pytest.approx(now[1], rel=1e-9) and slope[1] == pytest.approx(-now[2], rel=1e-9)
