"""The virtual laboratory's block on springs against closed forms and the package, which share no code with it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from rocking import Method1, solve
from rocking.effects import bouncing, load
from studies.laboratory import contact
from studies.laboratory import effects as laboratory_effects
from studies.laboratory.effects import Lab
from studies.laboratory.parameters import G, housner

from .laboratory_blocks import AT_REST, BLOCK, BREADTH, HEIGHT, LEAN, SAME, STEP, STILL, TIME, WORLD, floor

SOFT = replace(WORLD, stiffness=2e6, damping=0.0, friction=0.9)


@pytest.mark.parametrize("springs", [2.0, 25.0])
def test_a_block_stands_still_on_its_springs(springs: float) -> None:
    stiffness = SOFT.stiffness * (1 if springs == 2 else 2)
    response = contact.simulate(replace(SOFT, springs=springs, stiffness=stiffness), AT_REST, STEP, 4, 0.0)
    assert np.abs(response.rotation).max() < 1e-12
    assert response.centre is not None
    assert np.abs(response.centre[:, 1]).max() < 1e-6


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


# Two seconds, 14 swings from 0.16 rad. The package holds the corner by a spring along the floor, the laboratory by
# friction that creeps: 1 % of the lean apart as the effect has it, a third of that with a spring four times as stiff.
@pytest.mark.parametrize("held, apart", [(bouncing.HELD, 1.6e-3), (4.0 * bouncing.HELD, 6e-4)])
def test_a_corner_that_bounces_moves_as_the_package_has_it(held: float, apart: float, monkeypatch) -> None:
    frequency, e_n = 250.0, 0.7
    felt = 1.0 / (1.0 / WORLD.mass + WORLD.half_breadth**2 / WORLD.inertia)
    stiffness = felt * (2.0 * math.pi * frequency) ** 2
    ratio = -math.log(e_n) / math.hypot(math.pi, math.log(e_n))
    hard = replace(WORLD, stiffness=stiffness, damping=2.0 * ratio * math.sqrt(stiffness * felt), friction=2.0)
    response = contact.simulate(hard, AT_REST, STEP, 1, LEAN)
    monkeypatch.setattr(bouncing, "HELD", held)
    effect = load("bouncing")(normal_restitution=e_n, contact_frequency=frequency)
    run = solve(Method1(BLOCK, g=G), theta=LEAN, t_end=2.0, save_at=TIME[:2001], effects=[effect])
    assert np.abs(run.theta - response.rotation[:2001]).max() < apart


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
    felt = 1.0 / (1.0 / WORLD.mass + WORLD.half_breadth**2 / WORLD.inertia)
    stiffness = felt * (2.0 * math.pi * frequency) ** 2
    ratio = -math.log(e_n) / math.hypot(math.pi, math.log(e_n))
    hard = replace(WORLD, stiffness=stiffness, damping=2.0 * ratio * math.sqrt(stiffness * felt), friction=2.0)
    if name in ("mass_distribution", "concave_base"):  # the spring is that of the block as it is
        world = replace(hard, **changes)
        felt_so = 1.0 / (1.0 / world.mass + world.half_breadth**2 / world.inertia)
        changes = {**changes, "stiffness": stiffness * felt_so / felt, "damping": hard.damping * felt_so / felt}
    ours = contact.simulate(replace(hard, **changes), AT_REST, STEP, 1, LEAN).rotation[:2001]
    bouncing_too = [*effects, load("bouncing")(normal_restitution=e_n, contact_frequency=frequency)]
    run = solve(Method1(BLOCK, g=G), theta=LEAN, t_end=2.0, save_at=TIME[:2001], effects=bouncing_too)
    plain = contact.simulate(hard, AT_REST, STEP, 1, LEAN).rotation[:2001]
    assert np.abs(run.theta - ours).max() < 1.6e-3
    assert np.abs(plain - ours).max() > 4.0 * 1.6e-3


@pytest.mark.parametrize("number", contact.FOREIGN)
def test_the_laboratory_of_a_block_on_springs_refuses_what_it_lacks(number: str) -> None:
    with pytest.raises(ValueError, match=f"{number}=0.001: not in the laboratory of a block on springs"):
        contact.simulate(replace(SOFT, **{number: 0.001}), AT_REST, STEP, 4, 0.1)


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
