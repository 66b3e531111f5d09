"""The virtual laboratory against closed forms, computer algebra, published impacts and the package's own solvers.

It shares no code with them, so agreement to the accuracy of both is evidence for both.
"""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import sympy
from scipy.integrate import quad, solve_ivp

from rocking import Block, Method1, solve
from rocking.effects import bouncing, load
from studies.campaigns import Channel
from studies.laboratory import contact, event, instruments, slip, table
from studies.laboratory import effects as laboratory_effects
from studies.laboratory.effects import Lab
from studies.laboratory.instruments import point_acceleration
from studies.laboratory.parameters import G, housner, uniform

BREADTH, HEIGHT, RESTITUTION, LEAN = 0.2, 0.6, 0.92, 0.16
BLOCK = Block(BREADTH, HEIGHT)
WORLD = uniform(BREADTH, HEIGHT, BLOCK.mass, RESTITUTION)
STEP = 0.001  # s
END = 4.0  # s
TIME = STEP * np.arange(round(END / STEP) + 1)
STILL = np.zeros(TIME.size)
RNG = np.random.default_rng(11)


class Growing:
    """A sinusoid at 3 Hz that grows to 7 m/s^2, as both simulators see it."""

    max_step = 0.005
    breakpoints = (0.0,)
    has_pitch = False
    parameters = np.array([7.0 / END, 6.0 * math.pi])

    @staticmethod
    def kernel(xp, t, par):
        return par[0] * t * xp.sin(par[1] * t), 0.0 * t


def floor(ax=STILL, az=STILL, pitch=(STILL, STILL, STILL)):
    return table.pieces(STEP, ax, az, pitch)


AT_REST = floor()
GROWING = floor(Growing.kernel(np, TIME, Growing.parameters)[0])


def test_impacts_of_a_free_block() -> None:
    """Nonlinear free rocking from alpha / 2 of a block of 0.2 x 0.8 m, g = 9.81, Housner's e: computed to six digits
    by solve_ivp with events when the project began."""
    world = replace(uniform(0.2, 0.8, 30.0, housner(0.2, 0.8)), gravity=9.81)
    found = event.simulate(world, AT_REST, STEP, 4, 0.5 * world.alpha).impacts[:5, 0]
    assert found == pytest.approx([0.312309, 0.820592, 1.251877, 1.625867, 1.954508], abs=1e-6)


def test_quarter_period_from_the_energy_integral() -> None:
    """Time from a release to the first impact: the integral of d theta / theta' with theta' from the potential."""
    p2 = WORLD.mass * G * math.hypot(WORLD.half_breadth, WORLD.centre_height) / WORLD.corner_inertia
    far = math.cos(WORLD.alpha - LEAN)
    # theta = LEAN (1 - u^2) takes away the singularity at rest.
    time, _ = quad(
        lambda u: 2 * LEAN * u / math.sqrt(2 * p2 * (far - math.cos(WORLD.alpha - LEAN * (1 - u * u)))), 1e-9, 1.0
    )
    first = event.simulate(WORLD, AT_REST, STEP, 4, LEAN).impacts[0, 0]
    assert first == pytest.approx(time, abs=1e-8)


def test_energy_is_lost_at_impacts_alone() -> None:
    response = event.simulate(WORLD, AT_REST, STEP, 1, LEAN)
    R = math.hypot(WORLD.half_breadth, WORLD.centre_height)
    potential = WORLD.mass * G * R * (np.cos(WORLD.alpha - np.abs(response.rotation)) - math.cos(WORLD.alpha))
    energy = 0.5 * WORLD.corner_inertia * response.velocity**2 + potential
    impacts = response.impacts[:6, 0]
    for swing, (a, b) in enumerate(zip(np.insert(impacts, 0, 0.0), impacts, strict=False)):
        inside = energy[(response.time > a) & (response.time < b)]
        assert np.ptp(inside) < 1e-10 * energy[0]
        assert inside[0] == pytest.approx(energy[0] * RESTITUTION ** (2 * swing), rel=1e-9)


WEIGHT = BLOCK.mass * G
SAME = {
    "ideal": ([], {}),
    "rounded_edges": ([load("rounded_edges")(radius=0.004)], {"radius": 0.004}),
    "concave_base": ([load("concave_base")(breadth=0.19)], {"half_breadth": 0.095}),
    "mass_distribution": (
        [load("mass_distribution")(height=0.31, inertia=1.05 * WORLD.inertia)],
        {"centre_height": 0.31, "inertia": 1.05 * WORLD.inertia},
    ),
    "base_tilt": ([load("base_tilt")(angle=0.006)], {"tilt": 0.006}),
    "viscous_damping": ([load("viscous_damping")(coefficient=0.2)], {"viscous": 0.2}),
    "quadratic_drag": ([load("quadratic_drag")(coefficient=0.2)], {"quadratic": 0.2}),
    "velocity_dependent_restitution": ([load("velocity_dependent_restitution")(slope=-0.02)], {"slope": -0.02}),
    "base_adhesion": ([load("base_adhesion")(moment=0.01 * WEIGHT)], {"adhesion": 0.01 * WEIGHT}),
    "tether": (
        [load("tether")(slack=0.05, stiffness=0.03 * WEIGHT)],
        {"tether_stiffness": 0.03 * WEIGHT, "tether_plus": 0.05, "tether_minus": 0.05},
    ),
}


@pytest.mark.parametrize("name", SAME)
@pytest.mark.parametrize("forced", [False, True])
def test_impact_times_are_those_of_the_package(name: str, forced: bool) -> None:
    effects, changes = SAME[name]
    system = Method1(BLOCK, restitution=RESTITUTION, g=G)
    theta, motion = (0.0, Growing()) if forced else (LEAN, None)
    theirs = solve(system, motion, t_end=END, theta=theta, effects=effects, rtol=1e-11, atol=1e-13).impact_times
    ours = event.simulate(replace(WORLD, **changes), GROWING if forced else AT_REST, STEP, 1, theta).impacts[:, 0]
    n = min(12, theirs.size)
    assert n >= 8
    assert ours[:n] == pytest.approx(theirs[:n], abs=1e-6)


def test_an_eccentric_mass_hands_over_as_in_the_package_to_first_order() -> None:
    """Both part the two restitutions as the balance of angular momentum has them.  The package keeps their geometric
    mean, the laboratory what is gained over the balance: they differ by the square of offset over breadth, 1e-4."""
    offset = 0.002
    ours = event.simulate(replace(WORLD, offset=offset), AT_REST, STEP, 1, LEAN).impacts[:6]
    system = Method1(BLOCK, restitution=RESTITUTION, g=G)
    theirs = solve(system, t_end=END, theta=LEAN, effects=[load("eccentric_mass")(offset=offset)]).impact_times[:6]
    assert ours[:, 0] == pytest.approx(theirs, abs=1e-4)
    # The centre of mass is far from the corner that takes over after a swing toward +x: more inertia, less speed.
    far, near = (
        WORLD.inertia + WORLD.mass * (WORLD.centre_height**2 + (WORLD.half_breadth + k * offset) ** 2) for k in (1, -1)
    )
    ratio = np.abs(ours[:, 2] / ours[:, 1])
    assert ratio[0] / ratio[1] == pytest.approx(near / far, rel=1e-9)


def test_equation_of_motion_by_computer_algebra() -> None:
    """Lagrange's equations of a rolling block with a hanging mass on a floor that moves, tilts and pitches."""
    t, r, b, h, m, inertia, o, g = sympy.symbols("t r b h m I o g")
    mass, length, high = sympy.symbols("M l z")
    phi, psi, beta, x0, z0 = (sympy.Function(n)(t) for n in ("phi", "psi", "beta", "x", "z"))

    def world_place(x, z):
        """A point of the pitching floor's frame, seen from the ground; the floor's origin moves."""
        return x0 + x * sympy.cos(beta) + z * sympy.sin(beta), z0 - x * sympy.sin(beta) + z * sympy.cos(beta)

    def of_block(u, w):
        """A point of the block at (u, w) from the centre of the edge, on the floor."""
        x = b - r + r * phi + u * sympy.cos(phi) + w * sympy.sin(phi)
        return x, r - u * sympy.sin(phi) + w * sympy.cos(phi)

    centre = world_place(*of_block(o - (b - r), h - r))
    hinge = of_block(-(b - r), high - r)
    bob = world_place(hinge[0] + length * sympy.sin(psi), hinge[1] - length * sympy.cos(psi))
    kinetic = sympy.Rational(1, 2) * inertia * (phi.diff(t) + beta.diff(t)) ** 2
    potential = 0
    for weight, (x, z) in ((m, centre), (mass, bob)):
        kinetic += sympy.Rational(1, 2) * weight * (x.diff(t) ** 2 + z.diff(t) ** 2)
        potential += weight * g * z
    lagrangian = kinetic - potential
    numbers = {b: 0.1, h: 0.3, m: 70.0, inertia: 2.4, o: 0.003, g: G, r: 0.006, mass: 1.5, length: 0.1, high: 0.35}
    # One state: angles, rates and the floor's motion; the hanging mass on a floor that tilts but does not turn.
    for turns in (False, True):
        if turns:
            numbers[mass] = 0.0
        q1, q2, v1, v2, tilt = 0.11, -0.2, 0.7, -0.4, 0.02
        rate, acc = (0.05, 0.8) if turns else (0.0, 0.0)
        ax, az = 2.1, -0.7
        accelerations = sympy.symbols("a1 a2")
        equations = []
        for q in (phi, psi):
            e = lagrangian.diff(q.diff(t)).diff(t) - lagrangian.diff(q)
            e = e.subs(numbers)
            for f, values in (
                (x0, (0, 0, ax)), (z0, (0, 0, az)), (beta, (tilt, rate, acc)),
                (phi, (q1, v1, accelerations[0])), (psi, (q2, v2, accelerations[1])),
            ):  # fmt: skip
                e = e.subs(f.diff(t, 2), values[2]).subs(f.diff(t), values[1]).subs(f, values[0])
            equations.append(e)
        unknowns = accelerations[:1] if turns else accelerations
        solution = sympy.solve(equations[: len(unknowns)], unknowns)
        world = replace(
            WORLD, half_breadth=0.1, centre_height=0.3, mass=70.0, inertia=2.4, offset=0.003, radius=0.006, tilt=tilt,
            slosh_mass=0.0 if turns else 1.5, slosh_length=0.1, slosh_height=0.35,
        )  # fmt: skip
        one = np.zeros((5, 4))
        one[:, 0] = ax, az, 0.0, rate, acc
        found = event.acceleration(0.0, one, 1.0, q1, v1, q2, v2, 0.0, world.vector())
        assert found[0] == pytest.approx(float(solution[accelerations[0]]), rel=1e-12)
        if not turns:
            assert found[2] == pytest.approx(float(solution[accelerations[1]]), rel=1e-12)


def test_a_step_of_a_block_with_a_hanging_mass_is_of_fourth_order() -> None:
    """Half the step leaves a sixteenth of the error: steps to 16 ms against steps sixteen times as small.

    Every stage has to see all four states half a step on, the speed of the hanging mass too.
    """
    hung = {"slosh_mass": 30.0, "slosh_length": 0.1, "slosh_height": 0.35, "slosh_damping": 8.0}
    world = replace(WORLD, **hung, viscous=0.5).vector()
    moves = np.array([[2.0, -40.0, 0.0, 0.0], [0.5, 30.0, 0.0, 0.0], *np.zeros((3, 4))])

    def after(count: int) -> np.ndarray:
        h, state = 0.016 / count, (0.12, 0.9, -0.3, 4.0)
        for k in range(count):
            state = event.rk4(k * h, h, moves, 1.0, *state, 0.0, world)
        return np.array(state)

    exact = after(64)
    coarse, fine = (np.abs(after(count) - exact) for count in (2, 4))
    assert coarse / fine == pytest.approx(16.0, rel=0.25)


def test_a_floor_s_tilt_and_its_pitch_add_up() -> None:
    """Gravity and the floor's acceleration in the axes of a floor turned by 0.01 and 0.02 rad: those of 0.03 rad."""
    motion = np.zeros((5, 4))
    motion[:3, 0] = 2.0, -0.7, 0.02
    found = event.field(0.0, motion, replace(WORLD, tilt=0.01).vector())
    up, c, s = G - 0.7, math.cos(0.03), math.sin(0.03)
    assert found[:2] == pytest.approx([up * s - 2.0 * c, -up * c - 2.0 * s], rel=1e-14)


def test_left_is_the_mirror_image_of_right() -> None:
    odd = replace(WORLD, offset=0.002, tilt=0.003, radius=0.002, side=0.01, rib=0.2, rib_period=0.08, layer=3.0,
                  layer_width=0.02, slosh_mass=0.0)  # fmt: skip
    even = replace(odd, offset=-0.002, tilt=-0.003, side=-0.01)
    ax, az = GROWING[:, 0], 0.3 * GROWING[:, 0]
    turn = 0.01 * ax
    one = np.stack([ax, az, turn, 0 * ax, 0 * ax], axis=1)
    other = np.stack([-ax, az, -turn, 0 * ax, 0 * ax], axis=1)
    a = event.simulate(odd, one, STEP, 4, 0.0).rotation
    b = event.simulate(even, other, STEP, 4, 0.0).rotation
    assert np.abs(a).max() > 0.02
    assert b == pytest.approx(-a, abs=1e-9)


@pytest.mark.parametrize("damping", [0.0, 0.2])
def test_a_mass_hung_in_a_block_that_stands_swings_as_a_pendulum(damping: float) -> None:
    """Driven near its own frequency until it lifts the block: the sample is that of a pendulum followed by DOP853."""
    world = replace(WORLD, slosh_mass=60.0, slosh_length=0.1, slosh_height=0.35, slosh_damping=damping)
    pushed = floor(0.8 * np.sin(9.9 * TIME))

    def pendulum(t, y):
        pull = 0.8 * math.sin(9.9 * t) * math.cos(y[0]) + G * math.sin(y[0])
        return y[1], -pull / world.slosh_length - damping * y[1]

    swing = solve_ivp(pendulum, (0.0, END), (0.0, 0.0), method="DOP853", rtol=1e-10, atol=1e-12, dense_output=True)
    states = [(t, pushed[k], *swing.sol(t)) for k, t in enumerate(TIME[:-1])]
    vector = world.vector()
    expected = next(t for t, c, q, rate in states if event.side_that_lifts(0.0, c, q, rate, vector) != 0.0)
    found = event.simulate(world, pushed, STEP, 1, 0.0)
    assert found.time[np.flatnonzero(found.rotation)[0]] == pytest.approx(expected, abs=1.5 * STEP)
    assert 1.0 < expected < 3.0


def test_friction_that_holds_changes_nothing() -> None:
    stuck = slip.simulate(replace(WORLD, friction=0.8), AT_REST, STEP, 4, LEAN)
    held = event.simulate(WORLD, AT_REST, STEP, 4, LEAN)
    # Times, and angular velocities before and after.
    assert stuck.impacts[:8].ravel() == pytest.approx(held.impacts[:8].ravel(), abs=1e-8)


class Shaking(Growing):
    """A sinusoid of 6 m/s^2 at 3 Hz."""

    parameters = np.array([6.0, 6.0 * math.pi])

    @staticmethod
    def kernel(xp, t, par):
        return par[0] * xp.sin(par[1] * t), 0.0 * t


@pytest.mark.parametrize(
    ("friction", "lean", "impacts"), [(0.15, 0.2, 1), (0.2, 0.2, 6), (0.22, 0.2, 10), (0.36, 0.0, 20)]
)
def test_impacts_of_a_block_whose_foot_slips_are_those_of_the_package(
    friction: float, lean: float, impacts: int
) -> None:
    """Slip in the swings and in the impacts.

    At little friction the foot slips at last so fast that a corner would have to pull for the laboratory's ratio of
    angular speeds, which is not the package's then.
    """
    system, forced = Method1(BLOCK, restitution=RESTITUTION, g=G), lean == 0.0
    floor_moves = floor(Shaking.kernel(np, TIME, Shaking.parameters)[0]) if forced else AT_REST
    theirs = solve(
        system, Shaking() if forced else None, t_end=END, theta=lean, effects=[load("sliding")(friction, 1.0)],
        solver="scipy", rtol=1e-11, atol=1e-13,
    ).impact_times[:impacts]  # fmt: skip
    ours = slip.simulate(replace(WORLD, friction=friction), floor_moves, STEP, 4, lean).impacts[:impacts, 0]
    assert ours == pytest.approx(theirs, abs=1e-9)
    stuck = event.simulate(WORLD, floor_moves, STEP, 4, lean).impacts[:impacts, 0]
    assert abs(ours - stuck).max() > (0.05 if impacts > 1 else 1e-4)


class Pitching(Shaking):
    """The same on a floor that pitches by 0.004 rad at 2 Hz."""

    has_pitch = True

    @staticmethod
    def pitch_kernel(xp, t, par):
        w = 4.0 * math.pi
        return 0.004 * xp.sin(w * t), -0.004 * w * w * xp.sin(w * t)


# How far the effect alone moves an impact is that of `stuck`.  Friction, lean (0: the floor shakes), impacts: later on
# the foot slips so fast that a corner would have to pull for the laboratory's ratio of angular speeds.
SLIPPING = [(0.22, 0.2, 7), (0.36, 0.0, 2)]


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


def test_an_accelerometer_that_is_mounted_askew_reads_along_its_own_axis(monkeypatch: pytest.MonkeyPatch) -> None:
    """Turned clockwise by an angle, what looked up leans toward +x, and what looked along +x leans down."""
    angle, felt = 0.1, np.array([[2.0, 9.8]])
    monkeypatch.setattr(instruments, "point_acceleration", lambda *_: felt)
    monkeypatch.setattr(instruments, "felt_by_motion", lambda *_: np.zeros((1, 5, 4)))
    plan, lab = SimpleNamespace(motion=None, rate=100.0, samples=1), SimpleNamespace(table=None)

    def read(axis: tuple[float, float]) -> float:
        channel = Channel("it", "block_acceleration", 0.0, (0.0, 0.3), axis)
        [value] = instruments.reading(lab, plan, None, channel, instruments.Bench((channel,), {"it": angle}))
        return float(value)

    assert read((0.0, 1.0)) == pytest.approx(2.0 * math.sin(angle) + 9.8 * math.cos(angle), rel=1e-14)
    assert read((1.0, 0.0)) == pytest.approx(2.0 * math.cos(angle) - 9.8 * math.sin(angle), rel=1e-14)


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


def test_accelerometers_read_the_same_of_a_block_whose_contact_is_resolved() -> None:
    """A foot that sticks: by the motion of the centre of mass, and by that of the edge."""
    rough = replace(WORLD, friction=0.9)
    stuck, rolling = slip.simulate(rough, AT_REST, STEP, 4, LEAN), event.simulate(WORLD, AT_REST, STEP, 4, LEAN)
    for place in ((0.04, 0.5), (-0.1, 0.0), (0.0, 0.6)):
        by_centre = point_acceleration(Lab(rough), stuck, AT_REST, place, every=4)
        by_edge = point_acceleration(Lab(WORLD), rolling, AT_REST, place, every=4)
        until = 50  # samples before the first impact, at which a sample may lie on either side
        assert by_centre[:until] == pytest.approx(by_edge[:until], abs=1e-6)


@pytest.mark.parametrize("world", [WORLD, replace(WORLD, radius=0.01, tilt=0.01)])
def test_accelerometers_read_the_second_derivative_of_their_place(world) -> None:
    """Place of a point by plane geometry (a rolling disc), differentiated twice over the samples."""
    response = event.simulate(world, GROWING, STEP, 1, 0.0)
    x, z = 0.04, 0.5
    found = point_acceleration(Lab(world), response, GROWING[::1], (x, z), every=1)
    theta, r = response.rotation, world.radius
    corner = np.sign(theta) * (world.half_breadth - r)
    place = np.stack(
        [
            corner + r * theta + (x - corner) * np.cos(theta) + (z - r) * np.sin(theta),
            r - (x - corner) * np.sin(theta) + (z - r) * np.cos(theta),
        ]
    )
    own = (place[:, 2:] - 2 * place[:, 1:-1] + place[:, :-2]) / STEP**2
    ax = Growing.kernel(np, TIME, Growing.parameters)[0][1:-1]
    c, s = math.cos(world.tilt), math.sin(world.tilt)
    fx, fz = G * s - ax * c, -G * c - ax * s
    total = own - np.stack([fx, fz])
    inner = theta[1:-1]
    along = total[0] * np.cos(inner) - total[1] * np.sin(inner)
    up = total[0] * np.sin(inner) + total[1] * np.cos(inner)
    # Not across impacts, where the velocity jumps.
    calm = np.abs(inner) > 0.004
    calm &= np.sign(theta[2:]) == np.sign(theta[:-2])
    assert calm.sum() > 500
    assert found[1:-1][calm] == pytest.approx(np.stack([along, up], axis=1)[calm], abs=2e-3)


def test_accelerometers_on_a_pitching_floor_read_the_second_derivative_of_their_place() -> None:
    """Euler, Coriolis and centripetal terms: the place seen from the ground, differentiated twice over the samples."""
    t = STEP * np.arange(400)
    theta, rate, acc = 0.1 + 0.05 * np.sin(9 * t), 0.45 * np.cos(9 * t), -4.05 * np.sin(9 * t)
    beta, turning, twist = 0.03 * np.sin(14 * t), 0.42 * np.cos(14 * t), -5.88 * np.sin(14 * t)
    still = np.zeros(t.size)
    felt = table.pieces(STEP, still, still, (beta, turning, twist))
    response = event.Response(t, theta, rate, acc, np.zeros((0, 3)), None)
    x, z = 0.04, 0.5
    found = point_acceleration(Lab(WORLD), response, felt, (x, z), every=1)
    across = WORLD.half_breadth + (x - WORLD.half_breadth) * np.cos(theta) + z * np.sin(theta)
    height = -(x - WORLD.half_breadth) * np.sin(theta) + z * np.cos(theta)
    seen = np.stack([
        across * np.cos(beta) + height * np.sin(beta), -across * np.sin(beta) + height * np.cos(beta)
    ])  # fmt: skip
    felt_there = (seen[:, 2:] - 2 * seen[:, 1:-1] + seen[:, :-2]) / STEP**2 + np.array([[0.0], [G]])
    angle = (theta + beta)[1:-1]
    along = felt_there[0] * np.cos(angle) - felt_there[1] * np.sin(angle)
    up = felt_there[0] * np.sin(angle) + felt_there[1] * np.cos(angle)
    # Differences of second order: 14^4 * 0.5 m * 0.03 / 12 of the step squared, 5e-5 m/s^2.
    assert found[1:-1] == pytest.approx(np.stack([along, up], axis=1), abs=2e-4)


@pytest.mark.parametrize("lean", [-0.2, 0.2])
def test_a_block_that_friction_holds_falls_in_the_same_sample(lean: float) -> None:
    """Pushed over to either side: the number of samples before it lies on its side, where its foot slips a little."""
    pushed = floor(STILL - math.copysign(4.0, lean))
    held = event.simulate(WORLD, pushed, STEP, 4, lean)
    stuck = slip.simulate(replace(WORLD, friction=5.0), pushed, STEP, 4, lean)
    assert held.fell is not None and stuck.fell == held.fell
    leaning = int(np.argmax(np.abs(held.rotation) > 0.9))
    assert stuck.rotation[:leaning] == pytest.approx(held.rotation[:leaning], abs=1e-8)


def test_motions_are_the_derivatives_of_their_displacement() -> None:
    for motion in (table.ramp(RNG, 3.5, 4.0), table.quake(RNG, 4.0)):
        t = np.linspace(0.0, motion.end + 0.2, 4001)
        h = t[1] - t[0]
        for k in range(4):
            rough = np.gradient(motion.derivative(k, t), h)
            exact = motion.derivative(k + 1, t)
            assert np.abs(rough - exact)[2:-2].max() < 2e-3 * np.abs(exact).max()
        assert motion.derivative(0, t[-1:])[0] == 0.0
        assert np.abs(motion.derivative(2, t)).max() == pytest.approx(4.0, rel=0.02)


def test_second_harmonic_of_a_sinusoid() -> None:
    t = 0.002 * np.arange(2000)
    found = table.second_harmonic(3.0 * np.cos(2 * np.pi * 4.0 * t + 0.3), 0.5)
    assert found == pytest.approx(3.0 * np.cos(2 * (2 * np.pi * 4.0 * t + 0.3) + 0.5), abs=1e-9)


def test_a_piece_of_the_base_is_its_five_cubics() -> None:
    pieces = np.random.default_rng(3).standard_normal((5, 4))
    for x in (0.0, 0.3, 1.7):
        assert event.base(x, pieces) == pytest.approx([np.polynomial.Polynomial(row)(x) for row in pieces], rel=1e-14)
