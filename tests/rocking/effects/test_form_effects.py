"""Effects on form: restitution against a body of points, balance and onset against moments, mirror images, energy."""

import math
from typing import Any

import numpy as np
import pytest

from rocking import Block, Method1, Outcome, solve
from rocking.composed import ComposedMethod1
from rocking.effects import compose, load, parse
from rocking.form import Form

G = 9.80665
FORMS = {
    "rounded": ("rounded_edges.radius=0.03",),
    "off the middle": ("eccentric_mass.offset=0.02",),
    "top-heavy": ("mass_distribution.height=0.55", "mass_distribution.inertia=4.5"),
    "hollow": ("concave_base.breadth=0.15",),
    "all": (
        "rounded_edges.radius=0.02", "eccentric_mass.offset=-0.03", "mass_distribution.height=0.5",
        "mass_distribution.inertia=7", "concave_base.breadth=0.18",
    ),
}  # fmt: skip
SHAPES = {  # half of the flat part a [m], centre of mass (o, H) [m], inertia [kg m^2; None: the uniform block's]
    "rounded": (0.07, 0.0, 0.4, None),
    "off the middle": (0.1, 0.02, 0.4, None),
    "top-heavy": (0.1, 0.0, 0.55, 4.5),
    "hollow": (0.075, 0.0, 0.4, None),
    "all": (0.07, -0.03, 0.5, 7.0),
}


def composed(block: Block, *texts: str, **options: Any) -> ComposedMethod1:
    system = compose(Method1(block, **options), [*parse(texts), load("viscous_damping")()])
    assert isinstance(system, ComposedMethod1)
    return system


def body_of_points(o: float, H: float, mass: float, inertia: float) -> tuple[np.ndarray, np.ndarray]:
    """Places (x, z) and masses of four points with that centre of mass, mass and inertia about it."""
    reach = math.sqrt(inertia / mass)
    angles = 0.7 + 0.5 * math.pi * np.arange(4)
    return np.stack([o + reach * np.cos(angles), H + reach * np.sin(angles)]), np.full(4, 0.25 * mass)


@pytest.mark.parametrize("offset", [0.02, -0.02])
def test_the_tilt_of_unstable_balance_is_the_smaller_of_both_sides(block: Block, offset: float) -> None:
    """Where the centre of mass stands over the nearer corner: tan(theta_c) = (b/2 - |offset|) / (h/2)."""
    nearer = math.atan((0.5 * block.b - abs(offset)) / (0.5 * block.h))
    assert composed(block, f"eccentric_mass.offset={offset!r}").theta_c == pytest.approx(nearer, rel=1e-14)


# Housner's argument, point by point: all turn about the old contact; after it about the new one with the same angular
# momentum about that.
@pytest.mark.parametrize("s", [1.0, -1.0])
@pytest.mark.parametrize("name", FORMS)
def test_an_impact_keeps_the_angular_momentum_about_the_new_contact(block: Block, name: str, s: float) -> None:
    a, o, H, inertia = SHAPES[name]
    places, masses = body_of_points(o, H, block.mass, block.I_c if inertia is None else inertia)

    def momentum(turning_about: float) -> float:
        """Angular momentum about the new contact, clockwise, of the points turning at 1 rad/s about (x, 0)."""
        x, z = places
        u, v = z, -(x - turning_about)
        return float(np.sum(masses * (z * u - (x - new) * v)))

    old, new = s * a, -s * a
    e = composed(block, *FORMS[name]).form.restitution(s)
    assert e * momentum(new) == pytest.approx(momentum(old), rel=1e-12)


@pytest.mark.parametrize("name", FORMS)
def test_each_impact_of_a_run_has_the_restitution_of_its_side(run_with: Any, block: Block, name: str) -> None:
    run = run_with(*FORMS[name], theta=-0.05, t_end=1.5)
    system = composed(block, *FORMS[name])
    impacts = [i for i, k in enumerate(run.events.guard) if k == run.system.guard_names.index("impact")]
    assert len(impacts) >= 3
    for i in impacts:
        ratio = run.events.y_after[i, 1] / run.events.y_before[i, 1]
        assert ratio == pytest.approx(system.form.restitution(-run.events.s_after[i]), rel=1e-12)


# A restitution that is given is the measured one: of a symmetric form that of both sides, else their geometric mean,
# in the proportion of the two that keep angular momentum.
@pytest.mark.parametrize("name", FORMS)
def test_a_restitution_that_is_given_is_that_of_the_form(block: Block, name: str) -> None:
    right, left = composed(block, *FORMS[name], restitution=0.9).restitutions
    form = composed(block, *FORMS[name]).form
    assert math.sqrt(right * left) == pytest.approx(0.9, rel=1e-12)
    assert right / left == pytest.approx(form.restitution(1.0) / form.restitution(-1.0), rel=1e-12)


# Let go a little on either side of the tilt at which the centre of mass is over the contact, a block goes to either
# side.  With a rounded edge the contact is at s (a + r phi): balance where tan(phi) = (a - s o) / (H - r).
def test_a_given_restitution_may_be_alike_on_both_sides_of_a_mass_off_the_middle(block: Block) -> None:
    """As measured of a block whose loss is no matter of the kept angular momentum; one between is apart by its root."""
    apart = {
        share: composed(
            block, "eccentric_mass.offset=0.01", f"eccentric_mass.apart={share}", restitution=0.9
        ).restitutions
        for share in (0.0, 0.5, 1.0)
    }
    assert apart[0.0] == (0.9, 0.9)
    assert apart[1.0][0] / apart[1.0][1] == pytest.approx((apart[0.5][0] / apart[0.5][1]) ** 2, rel=1e-12)
    assert apart[1.0][0] != pytest.approx(apart[1.0][1], rel=1e-3)
    with pytest.raises(ValueError, match=r"apart=1\.5"):
        load("eccentric_mass")(offset=0.01, apart=1.5)


@pytest.mark.parametrize("s", [1.0, -1.0])
@pytest.mark.parametrize("name", FORMS)
def test_the_tilt_of_unstable_balance_parts_the_fall_from_the_return(run_with: Any, name: str, s: float) -> None:
    a, o, H, _ = SHAPES[name]
    r = {"rounded": 0.03, "all": 0.02}.get(name, 0.0)
    tilt = math.atan2(a - s * o, H - r)
    back = run_with(*FORMS[name], theta=s * (tilt - 1e-4), t_end=5.0, save_at=[0.5])
    assert 0.0 < s * back.theta[0] < tilt - 1.1e-4
    assert len(back.impact_times) > 0
    over = run_with(*FORMS[name], theta=s * (tilt + 1e-4), t_end=5.0)
    assert over.outcome is Outcome.OVERTURNED
    assert over.side == s
    assert over.overturning_time == 0.0


# West's formula for any form: a push to the side s tips where |a_x| H = g (a - s o).
@pytest.mark.parametrize("s", [1.0, -1.0])
@pytest.mark.parametrize("name", FORMS)
def test_rocking_starts_where_the_push_outweighs_the_weight_about_the_contact(
    run_with: Any, constant: Any, name: str, s: float
) -> None:
    a, o, H, _ = SHAPES[name]
    onset = G * (a - s * o) / H
    # A base that accelerates to -x leans the block to +x.
    assert run_with(*FORMS[name], motion=constant(-s * onset * (1 - 1e-9)), t_end=0.1).outcome is Outcome.AT_REST
    tips = run_with(*FORMS[name], motion=constant(-s * onset * (1 + 1e-6)), t_end=0.1)
    assert tips.onset_time == 0.0
    assert tips.theta[-1] * s > 0.0


@pytest.mark.parametrize("moment", [5.0, 50.0])
def test_adhesion_holds_until_the_push_outweighs_weight_and_moment(
    run_with: Any, constant: Any, block: Block, moment: float
) -> None:
    # m a_x h/2 = m g b/2 + moment.
    onset = (block.mass * G * 0.5 * block.b + moment) / (block.mass * 0.5 * block.h)
    held = run_with(f"base_adhesion.moment={moment}", motion=constant(onset * (1 - 1e-9)), t_end=0.1)
    assert held.outcome is Outcome.AT_REST
    free = run_with(f"base_adhesion.moment={moment}", motion=constant(onset * (1 + 1e-9)), t_end=0.1)
    assert free.onset_time == 0.0
    # It breaks at once: from then on it is the block without adhesion under the same push, from the same state.
    plain = run_with(motion=constant(onset * (1 + 1e-9)), t_end=0.1)
    np.testing.assert_allclose(free.theta, plain.theta, atol=1e-13)
    assert free.theta[-1] < -1e-4


def test_adhesion_holds_again_when_the_block_has_come_to_rest(run_with: Any, window: Any, block: Block) -> None:
    """A jolt breaks it, the block rocks to rest, and a later push between West's and its own does nothing."""
    west = G * block.b / block.h
    push = 1.2 * west
    texts = ("base_adhesion.moment=60",)
    own = west + 60.0 / (0.5 * block.mass * block.h)
    assert west < push < own
    free = window(0.1, 0.3, x=(3.0, 0.0, 0.0, 0.0))
    jolt = window(0.1, 0.25, x=(1.05 * own, 0.0, 0.0, 0.0))
    assert run_with(*texts, motion=free, t_end=0.5).outcome is Outcome.AT_REST
    rocked = run_with(*texts, motion=jolt, t_end=20.0)
    assert rocked.onset_time == pytest.approx(0.1, abs=1e-12)
    assert rocked.outcome is Outcome.AT_REST
    steady = window(0.0, math.inf, x=(push, 0.0, 0.0, 0.0))
    assert run_with(*texts, motion=steady, t_end=1.0).outcome is Outcome.AT_REST
    assert run_with(motion=steady, t_end=1.0).onset_time == 0.0


@pytest.mark.parametrize(
    ("texts", "mirrored"),
    [
        (("eccentric_mass.offset=0.02",), ("eccentric_mass.offset=-0.02",)),
        (("base_tilt.angle=0.03",), ("base_tilt.angle=-0.03",)),
        (("tether.slack=0.02", "tether.stiffness=80", "tether.side=1"),
         ("tether.slack=0.02", "tether.stiffness=80", "tether.side=-1")),
        (("rounded_edges.radius=0.02", "eccentric_mass.offset=0.01", "compliant_base.corner_stiffness=inf"),
         ("rounded_edges.radius=0.02", "eccentric_mass.offset=-0.01", "compliant_base.corner_stiffness=inf")),
    ],
)  # fmt: skip
def test_the_mirror_image_of_a_block_under_the_mirrored_push_is_the_mirror_image(
    run_with: Any, shaken: Any, texts: Any, mirrored: Any
) -> None:
    one = run_with(*texts, motion=shaken(), theta=0.05, t_end=1.5)
    other = run_with(*mirrored, motion=shaken(rate=-3.0), theta=-0.05, t_end=1.5)
    assert len(one.impact_times) >= 2
    # Bit for bit: the equations are written in the frame of the carrying side.
    np.testing.assert_array_equal(one.theta, -other.theta)
    np.testing.assert_array_equal(one.events.t, other.events.t)


def height_of_the_centre(theta: np.ndarray, a: float, r: float, o: float, H: float) -> np.ndarray:
    """Height [m] of the centre of mass: the edge's centre is at height r, whichever edge carries."""
    s = np.where(theta >= 0.0, 1.0, -1.0)
    return r - (o - s * a) * np.sin(theta) + (H - r) * np.cos(theta)


def kinetic(theta: np.ndarray, omega: np.ndarray, a: float, r: float, o: float, H: float, rho2: float) -> np.ndarray:
    """Per mass [m^2/s^2]: the body turns about the point of contact, which is right under the edge's centre."""
    s = np.where(theta >= 0.0, 1.0, -1.0)
    along, up = o - s * a, H - r
    x = along * np.cos(theta) + up * np.sin(theta)
    z = height_of_the_centre(theta, a, r, o, H)
    return 0.5 * omega**2 * (rho2 + x**2 + z**2)


@pytest.mark.parametrize("name", ["rounded", "off the middle", "all"])
def test_free_rocking_keeps_its_energy_between_impacts(run_with: Any, block: Block, name: str) -> None:
    a, o, H, inertia = SHAPES[name]
    r = {"rounded": 0.03, "all": 0.02}.get(name, 0.0)
    rho2 = (block.I_c if inertia is None else inertia) / block.mass
    run = run_with(*FORMS[name], theta=-0.05, t_end=2.0, rtol=1e-12, atol=1e-15)
    energy = kinetic(run.theta, run.omega, a, r, o, H, rho2) + G * height_of_the_centre(run.theta, a, r, o, H)
    swing = np.searchsorted(run.impact_times, run.t)
    assert swing.max() >= 3
    for k in range(4):
        part = energy[swing == k]
        assert np.ptp(part) < 1e-10 * abs(part[0])
    # And each impact takes just what its restitution says.
    assert energy[swing == 1][0] < energy[swing == 0][0] - 1e-6


def test_a_concave_base_is_the_block_of_that_breadth_with_the_mass_and_inertia_of_the_other(run_with: Any) -> None:
    # Yim's equation with R, alpha and p^2 = m g R / (I_c + m R^2) of the narrower stand, integrated apart from rocking.
    from scipy.integrate import solve_ivp

    block, breadth = Block(b=0.2, h=0.8), 0.14
    R, alpha = 0.5 * math.hypot(breadth, block.h), math.atan2(breadth, block.h)
    p2 = block.mass * G * R / (block.I_c + block.mass * R**2)
    lands = solve_ivp(
        lambda t, y: (y[1], -p2 * math.sin(alpha - y[0])), (0.0, 2.0), (0.08, 0.0),
        events=lambda t, y: y[0], rtol=1e-12, atol=1e-14,
    )  # fmt: skip
    run = run_with(f"concave_base.breadth={breadth}", theta=0.08, t_end=1.0)
    assert run.impact_times[0] == pytest.approx(lands.t_events[0][0], abs=1e-10)
    # Housner with those: 1 - m R^2/I_O (1 - cos 2 alpha).
    e = 1.0 - block.mass * R**2 / (block.I_c + block.mass * R**2) * (1.0 - math.cos(2.0 * alpha))
    assert run.events.y_after[0, 1] / run.events.y_before[0, 1] == pytest.approx(e, rel=1e-12)


def test_a_mass_distribution_of_another_uniform_block_is_that_block(run_with: Any) -> None:
    taller = Block(b=0.2, h=1.1)
    inertia = taller.I_c / taller.mass * Block(b=0.2, h=0.8).mass
    run = run_with("mass_distribution.height=0.55", f"mass_distribution.inertia={inertia!r}", theta=0.08, t_end=2.0)
    other = solve(Method1(taller), theta=0.08, t_end=2.0, rtol=1e-11, atol=1e-14)
    np.testing.assert_allclose(run.impact_times[:8], other.impact_times[:8], atol=1e-10)


# On the way to a block that stands on no flat part at all, or off its own base.
@pytest.mark.parametrize(
    ("texts", "theta", "falls"),
    [
        (("eccentric_mass.offset=0.0999",), 0.0, False),  # stands, upright and still
        (("eccentric_mass.offset=0.0999",), 3e-4, True),  # balance at 2.5e-4 rad
        (("eccentric_mass.offset=0.0999",), 2e-4, False),
        (("rounded_edges.radius=0.0999",), 4e-4, True),  # balance at 3.3e-4 rad
        (("rounded_edges.radius=0.0999",), 3e-4, False),
        (("concave_base.breadth=0.0002",), 3e-4, True),  # balance at 2.5e-4 rad
    ],
)
@pytest.mark.parametrize("solver", ["scipy", "numba"])
def test_a_block_that_hardly_stands_falls_beyond_its_small_tilt_of_balance(
    run_with: Any, solver: str, texts: Any, theta: float, falls: bool
) -> None:
    run = run_with(*texts, theta=theta, t_end=5.0, solver=solver)
    assert run.overturned is falls
    assert run.outcome is not Outcome.FAILED


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        (("eccentric_mass.offset=0.1",), "offset=0.1 m: want less than half of the breadth it stands on, 0.1 m"),
        (("eccentric_mass.offset=0.08", "concave_base.breadth=0.15"), "offset=0.08 m: want less than half"),
        (("rounded_edges.radius=0.1",), "rounded_edges.radius=0.1 m: want less than half of the breadth, 0.1 m"),
        (("mass_distribution.height=0.05", "rounded_edges.radius=0.06"), "edge_radius=0.06 m: want less than the heig"),
        (("concave_base.breadth=0",), "half_breadth=0.0 m: want a positive number"),
        (("mass_distribution.inertia=0",), "inertia=0.0 kg m\\^2: want a positive number"),
    ],
)
def test_a_form_that_cannot_be_is_refused(run_with: Any, texts: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        run_with(*texts, theta=1e-3, t_end=0.1)


# Own derivation (`rocking.form`): I_c/m + H^2 below a^2, and the floor would have to pull at the old edge.
@pytest.mark.parametrize("solver", ["scipy", "numba"])
def test_a_form_without_momentum_about_its_new_edge_lands_on_both_and_stops(run_with: Any, solver: str) -> None:
    run = run_with(
        "mass_distribution.height=0.05", "mass_distribution.inertia=0.1", theta=0.1, t_end=5.0, solver=solver
    )
    assert run.outcome is Outcome.AT_REST
    assert run.impact_times.size == 1


def test_a_string_on_either_side_pulls_against_the_inertia_about_the_corner_on_that_side() -> None:
    """By hand, the parallel axis theorem: I_c / m + (b/2 -+ o)^2 + (h/2)^2 with the centre of mass o off the middle."""
    block = Block(0.2, 0.8)
    form = Form.of(block).edited(offset=0.03)
    mass, rho2 = form.mass, (0.2**2 + 0.8**2) / 12.0
    right, left = (60.0 / (mass * (rho2 + arm**2 + 0.4**2)) for arm in (0.1 - 0.03, 0.1 + 0.03))
    tether = load("tether")
    assert tether(slack=0.01, stiffness=60.0).values(form) == pytest.approx((0.01, right, left), rel=1e-12)
    assert tether(stiffness=60.0, side=1.0).values(form) == pytest.approx((0.0, right, 0.0), rel=1e-12)
    assert tether(stiffness=60.0, side=-1.0).values(form) == pytest.approx((0.0, 0.0, left), rel=1e-12)
