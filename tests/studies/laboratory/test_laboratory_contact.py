"""The virtual laboratory's block on springs against closed forms and the package, which share no code with it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from rocking import Method1, solve
from rocking.effects import load
from studies.laboratory import contact
from studies.laboratory import effects as laboratory_effects
from studies.laboratory.effects import Lab
from studies.laboratory.parameters import G, World, housner

from .laboratory_blocks import AT_REST, BLOCK, BREADTH, HEIGHT, LEAN, SAME, STEP, STILL, TIME, WORLD, floor

SOFT = replace(WORLD, stiffness=2e6, damping=0.0, friction=0.9)


def on_hard_corners(frequency: float, e_n: float, world: World = WORLD, **numbers: float) -> World:
    """Springs of that frequency [Hz] with the mass that a corner meets, which leave so much of a speed."""
    felt = 1.0 / (1.0 / world.mass + world.half_breadth**2 / world.inertia)
    stiffness = felt * (2.0 * math.pi * frequency) ** 2
    ratio = -math.log(e_n) / math.hypot(math.pi, math.log(e_n))
    return replace(world, stiffness=stiffness, damping=2.0 * ratio * math.sqrt(stiffness * felt), **numbers)


@pytest.mark.parametrize("springs", [2.0, 15.0])
def test_a_block_stands_still_on_its_springs(springs: float) -> None:
    stiffness = SOFT.stiffness * (1 if springs == 2 else 2)
    response = contact.simulate(replace(SOFT, springs=springs, stiffness=stiffness), AT_REST, STEP, 4, 0.0)
    assert np.abs(response.rotation).max() < 1e-12
    assert response.centre is not None
    assert np.abs(response.centre[:, 1]).max() < 1e-6


def test_a_block_that_touches_nothing_falls_straight_however_the_floor_turns() -> None:
    """Newton in a frame that rests, seen from one that turns clockwise: second differences."""
    place, velocity, turned, rate, acceleration = np.array([0.7, 5.0]), np.array([0.4, -1.1]), 0.3, 2.0, 5.0

    def seen(t: float) -> np.ndarray:
        at = place + velocity * t - np.array([0.0, 0.5 * G * t * t])
        angle = turned + rate * t + 0.5 * acceleration * t * t
        return np.array([at[0] * math.cos(angle) - at[1] * math.sin(angle),
                         at[0] * math.sin(angle) + at[1] * math.cos(angle)])  # fmt: skip

    h = 1e-4
    before, now, after = seen(-h), seen(0.0), seen(h)
    c = np.zeros((5, 4))
    c[2:, 0] = turned, rate, acceleration
    y = np.array([*now, 0.0, *((after - before) / (2.0 * h)), 0.0, 0.0, 0.0])
    found = contact.rate(0.0, c, y, SOFT.vector())
    # The differences are off by h^2 / 12 of the fourth derivative, some 2e3 m/s^4, and by rounding over h^2.
    assert found[:2] == pytest.approx((after - 2.0 * now + before) / h**2, abs=1e-5)
    assert found[2] == pytest.approx(-acceleration, rel=1e-12)


@pytest.mark.parametrize("springs", [2.0, 15.0])
@pytest.mark.parametrize("lean", [0.2, -0.2])
def test_a_block_is_released_with_its_corner_where_it_stood(springs: float, lean: float) -> None:
    """Turned about that corner, and sunk into the floor; the place along it matters where the floor turns."""
    world = replace(SOFT, springs=springs, offset=0.01)
    corner = math.copysign(world.half_breadth, lean)
    x, z, theta, *rest = contact.start(world, lean)
    arm = np.array([world.offset - corner, world.centre_height])
    assert x == pytest.approx(corner + arm[0] * math.cos(lean) + arm[1] * math.sin(lean), rel=1e-14)
    sunk = -arm[0] * math.sin(lean) + arm[1] * math.cos(lean) - z
    # By no more than the weight on the one spring, or on the bed as wide as it is sunk.
    assert 0.0 < sunk < 0.02
    assert theta == lean and not any(rest)


def test_heave_on_two_springs() -> None:
    """A step of vertical acceleration of the floor: bounce at sqrt(2 k / m) about the new rest."""
    response = contact.simulate(SOFT, floor(az=STILL + 1.0), STEP, 1, 0.0)
    assert response.centre is not None
    omega = math.sqrt(2 * SOFT.stiffness / SOFT.mass)
    assert response.centre[:400, 1] == pytest.approx(-np.cos(omega * response.time[:400]), abs=2e-3)


def test_heave_on_two_springs_while_the_floor_shakes() -> None:
    """A sine of 15 Hz on an oscillator at rest: the forced motion and the free one that begins with it."""
    omega, forced = math.sqrt(2 * SOFT.stiffness / SOFT.mass), 2.0 * math.pi * 15.0
    t = TIME[:500]
    response = contact.simulate(SOFT, floor(az=np.sin(forced * TIME)), STEP, 1, 0.0)
    assert response.centre is not None
    exact = (forced**2 * np.sin(forced * t) - forced * omega * np.sin(omega * t)) / (omega**2 - forced**2)
    # Cubics between samples of the sine leave 2e-7 of it.
    assert response.centre[:500, 1] == pytest.approx(exact, abs=1e-6)


# Two seconds, 14 swings from 0.16 rad.  While a corner slips, the laboratory cuts its spring to what friction gives,
# the package lets spring and dashpot go back together: the more friction, the shorter that is, and the nearer they are.
@pytest.mark.parametrize(("friction", "apart"), [(1.4, 3e-3), (20.0, 1e-4)])
@pytest.mark.parametrize("ratio", [1.0, 3.0])
def test_a_corner_that_bounces_moves_as_the_package_has_it(friction: float, apart: float, ratio: float) -> None:
    frequency, e_n = 250.0, 0.7
    hard = on_hard_corners(frequency, e_n, friction=friction, give=1.0 / ratio)
    response = contact.simulate(hard, AT_REST, STEP, 1, LEAN)
    effect = load("bouncing")(
        normal_restitution=e_n, contact_frequency=frequency, friction=friction, tangential_ratio=ratio
    )
    run = solve(Method1(BLOCK, g=G), theta=LEAN, t_end=2.0, save_at=TIME[:2001], effects=[effect])
    assert np.abs(run.theta - response.rotation[:2001]).max() < apart


# Two seconds of the same, with the laboratory's own law of slip: the package has its events, the laboratory steps that
# move a rotation by up to 5e-6 rad (below).
@pytest.mark.parametrize("friction", [0.5, 1.4])
@pytest.mark.parametrize("ratio", [1.0, 3.0])
def test_a_corner_whose_spring_friction_limits_is_that_of_the_package(friction: float, ratio: float) -> None:
    frequency, e_n = 250.0, 0.7
    hard = on_hard_corners(frequency, e_n, friction=friction, give=1.0 / ratio)
    response = contact.simulate(hard, AT_REST, STEP, 1, LEAN)
    effect = load("bouncing")(
        normal_restitution=e_n, contact_frequency=frequency, friction=friction, tangential_ratio=ratio,
        spring_slider=1.0,
    )  # fmt: skip
    run = solve(Method1(BLOCK, g=G), theta=LEAN, t_end=2.0, save_at=TIME[:2001], effects=[effect])
    assert np.abs(run.theta - response.rotation[:2001]).max() < 1e-5


# Contacts that begin, end, stick or slip anywhere within its steps: three seconds, to a hundredth of a usual sensor's
# noise.  Of steps that go on over them a quarter of the length moves the rotation by 5e-4 to 9e-4 rad.
@pytest.mark.parametrize("friction", [0.7, 1.4])
def test_a_quarter_of_the_step_moves_a_block_on_hard_corners_by_next_to_nothing(
    monkeypatch: pytest.MonkeyPatch, friction: float
) -> None:
    hard = on_hard_corners(450.0, 0.7, friction=friction)
    coarse = contact.simulate(hard, AT_REST[:3000], STEP, 1, LEAN).rotation
    monkeypatch.setattr(contact, "STEP", 0.25 * contact.STEP)
    fine = contact.simulate(hard, AT_REST[:3000], STEP, 1, LEAN).rotation
    assert np.abs(coarse - fine).max() < 5e-6


# Two seconds of a floor that gives; a bed, of which the laboratory sums where a dashpot would have to pull by
# quadrature, to a quarter of a usual sensor's noise.  In series corners slip by another law than the laboratory's.
@pytest.mark.parametrize(("friction", "slider", "apart"), [(20.0, 0.0, 5e-6), (20.0, 1.0, 5e-7), (0.9, 1.0, 5e-7)])
@pytest.mark.parametrize("springs", [2.0, 15.0])
def test_a_soft_floor_is_that_of_the_package(springs: float, friction: float, slider: float, apart: float) -> None:
    k, xi, ratio = 2e6, 0.2, 0.8
    whole = 1.0 if springs == 2.0 else 2.0
    damping = 2.0 * xi * math.sqrt(k * WORLD.mass)
    soft = replace(
        WORLD, stiffness=whole * k, damping=whole * damping, springs=springs, friction=friction, give=1.0 / ratio
    )  # fmt: skip
    response = contact.simulate(soft, AT_REST, STEP, 1, LEAN)
    effect = load("compliant_base")(
        corner_stiffness=k, damping_ratio=xi, spread=whole - 1.0, tangential_ratio=ratio, friction=friction,
        spring_slider=slider,
    )  # fmt: skip
    run = solve(Method1(BLOCK, g=G), theta=LEAN, t_end=2.0, save_at=TIME[:2001], effects=[effect])
    off = np.abs(run.theta - response.rotation[:2001]).max()
    assert off < (apart if springs == 2.0 else 5e-5)


# The same for effects on the equations: a couple of the package's own, beside springs, against the laboratory's torque.
@pytest.mark.parametrize(
    "name",
    [
        "viscous_damping",
        "eccentric_mass",
        *(
            pytest.param(name, marks=pytest.mark.slow)
            for name in ("concave_base", "mass_distribution", "base_tilt", "quadratic_drag", "tether")
        ),
    ],
)
def test_a_corner_that_bounces_has_the_effects_of_the_package(name: str) -> None:
    effects, changes = SAME.get(name, ([load("eccentric_mass")(offset=0.002)], {"offset": 0.002}))
    frequency, e_n = 250.0, 0.7
    numbers = {"friction": 20.0, "give": 1.0 / 3.0}
    hard = on_hard_corners(frequency, e_n, **numbers)
    if name in ("mass_distribution", "concave_base"):  # the spring is that of the block as it is
        so = on_hard_corners(frequency, e_n, world=replace(WORLD, **changes))
        changes = {**changes, "stiffness": so.stiffness, "damping": so.damping}
    ours = contact.simulate(replace(hard, **changes), AT_REST, STEP, 1, LEAN).rotation[:2001]
    bouncing = load("bouncing")(
        normal_restitution=e_n, contact_frequency=frequency, friction=20.0, tangential_ratio=3.0
    )
    run = solve(Method1(BLOCK, g=G), theta=LEAN, t_end=2.0, save_at=TIME[:2001], effects=[*effects, bouncing])
    plain = contact.simulate(hard, AT_REST, STEP, 1, LEAN).rotation[:2001]
    assert np.abs(run.theta - ours).max() < 2e-4
    assert np.abs(plain - ours).max() > 30.0 * 2e-4


def test_a_torque_beside_springs_acts_on_the_side_to_which_the_block_leans() -> None:
    """The mirror image of a block on its springs, a string to -x in place of one to +x."""
    hard, pull = on_hard_corners(250.0, 0.7, friction=20.0), {"tether_stiffness": 40.0}
    right = contact.simulate(replace(hard, tether_plus=0.5 * LEAN, **pull), AT_REST, STEP, 1, LEAN).rotation[:1001]
    left = contact.simulate(replace(hard, tether_minus=0.5 * LEAN, **pull), AT_REST, STEP, 1, -LEAN).rotation[:1001]
    np.testing.assert_allclose(left, -right, atol=1e-9)
    free = contact.simulate(hard, AT_REST, STEP, 1, LEAN).rotation[:1001]
    assert np.abs(free - right).max() > 1e-3


@pytest.mark.parametrize("number", contact.FOREIGN)
def test_the_laboratory_of_a_block_on_springs_refuses_what_it_lacks(number: str) -> None:
    with pytest.raises(ValueError, match=f"{number}=0.001: not in the laboratory of a block on springs"):
        contact.simulate(replace(SOFT, **{number: 0.001}), AT_REST, STEP, 4, 0.1)


@pytest.mark.parametrize("numbers", [{"give": 0.0}, {"stiffness": 0.0}])
def test_springs_that_give_nowhere_are_refused(numbers: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="want springs that give, both above 0"):
        contact.simulate(replace(SOFT, **numbers), AT_REST, STEP, 4, 0.1)


def test_a_corner_that_friction_does_not_hold_slips_as_coulomb_has_it() -> None:
    """x'' = -(a - mu g) of a block that stands on both corners."""
    slippery, a = replace(SOFT, friction=0.12, damping=3e3), 0.2 * G
    response = contact.simulate(slippery, floor(STILL + a), STEP, 1, 0.0)
    assert response.centre is not None
    assert response.centre[200:600, 0].mean() == pytest.approx(-(a - 0.12 * G), rel=1e-4)


def test_two_effects_that_no_laboratory_has_together_are_refused() -> None:
    drawn = laboratory_effects.draw(np.random.default_rng(1))
    lab, _ = laboratory_effects.sliding(Lab(WORLD), drawn, 1.0)
    with pytest.raises(ValueError, match="engine='contact': the laboratory is of 'slip' already"):
        laboratory_effects.bouncing(lab, drawn, 1.0)


def test_stiff_corners_that_do_not_bounce_give_housners_restitution() -> None:
    """Three times the critical damping: what is left to 0.85 of Housner's formula is the contact's duration."""
    felt = 1.0 / (1.0 / WORLD.mass + WORLD.half_breadth**2 / WORLD.inertia)  # mass that the corner meets
    hard = replace(WORLD, stiffness=4e8, damping=6 * math.sqrt(4e8 * felt), friction=0.9)
    response = contact.simulate(hard, AT_REST, STEP, 1, LEAN)
    t, v = response.time, response.velocity
    k = int(np.flatnonzero(np.diff(np.sign(response.rotation)))[0])
    impact = t[k] - response.rotation[k] / v[k]
    # Straight lines on either side, carried to the impact.
    before = np.polyval(np.polyfit(t[k - 12 : k - 1], v[k - 12 : k - 1], 1), impact)
    after = np.polyval(np.polyfit(t[k + 5 : k + 16], v[k + 5 : k + 16], 1), impact)
    assert after / before == pytest.approx(housner(BREADTH, HEIGHT), abs=0.004)
