"""The virtual laboratory's rocking block against closed forms, computer algebra, published impacts and the package.

It shares no code with the package, so agreement to the accuracy of both is evidence for both.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy
from scipy.integrate import cumulative_simpson, quad, solve_ivp

from rocking import Method1, solve
from rocking.effects import load
from studies.laboratory import event, table
from studies.laboratory.parameters import G, housner, uniform

from .laboratory_blocks import AT_REST, BLOCK, END, GROWING, LEAN, RESTITUTION, SAME, STEP, TIME, WORLD, Growing, floor


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


@pytest.mark.parametrize("given", [{"guide": 0.3}, {"squeeze": 2.0, "squeeze_width": 0.02}])
def test_what_rubs_takes_the_work_that_it_does(given: dict[str, float]) -> None:
    """Energy between impacts falls by what the torque does along the way; a guide rubs toward +x alone."""
    response = event.simulate(replace(WORLD, **given), AT_REST, STEP, 1, LEAN)
    phi, v = np.abs(response.rotation), response.velocity
    weight, alpha = WORLD.mass * G * math.hypot(WORLD.half_breadth, WORLD.centre_height), WORLD.alpha
    energy = 0.5 * WORLD.corner_inertia * v**2 + weight * (np.cos(alpha - phi) - math.cos(alpha))
    impacts = response.impacts[:4, 0]
    for a, b in zip(np.insert(impacts, 0, 0.0), impacts, strict=False):
        inside = (response.time > a) & (response.time < b)
        if "guide" in given:
            power = given["guide"] * np.abs(v) * (response.rotation > 0.0)
        else:
            power = given["squeeze"] * np.exp(-phi / given["squeeze_width"]) * v**2
        lost = WORLD.corner_inertia * cumulative_simpson(power[inside], x=response.time[inside], initial=0.0)
        assert energy[inside][0] - energy[inside] == pytest.approx(lost, rel=1e-3, abs=1e-6 * energy[0])


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


def test_dry_friction_holds_a_shaken_block_as_the_smooth_one_of_the_package_does() -> None:
    """A guide that rubs on one side holds the block again and again; there the package's creeps instead.

    A tenth of the noise of the records that it missed, 3e-4 rad; smoothed over 0.001 rad/s they were 1.1e-3 rad apart.
    """
    rubs = load("learned_term")(friction=-0.75, side_friction=-0.75)
    system = Method1(BLOCK, restitution=RESTITUTION, g=G)
    theirs = solve(system, Growing(), t_end=2.5, effects=[rubs], rtol=1e-11, atol=1e-13, save_at=TIME[:2501]).theta
    ours = event.simulate(replace(WORLD, guide=1.5), GROWING, STEP, 1, 0.0).rotation[:2501]
    assert np.max(np.abs(ours)) > 0.005
    assert np.max(np.abs(theirs - ours)) < 3e-5


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


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_restitution_differs_by_its_share_on_either_side(side: float) -> None:
    """0.92 by 1.02 where a swing to +x ends, by 0.98 on the other side."""
    P = replace(WORLD, side=0.02).vector()
    kept = event.restitution(side, 0.5, 1.0, 3, 0.0, 0.0, P)
    assert kept == pytest.approx(RESTITUTION * (1.0 + 0.02 * side), rel=1e-14)


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


def test_a_hung_mass_swings_in_a_block_that_stands_to_the_second_order_of_the_step() -> None:
    """The rotation 0.03 s after it has lifted the block, held against that of steps of a sixteenth. One order less, a
    base taken a step off within a step, misses it by 4e-5 rad."""
    world = replace(WORLD, slosh_mass=60.0, slosh_length=0.1, slosh_height=0.35, slosh_damping=0.2)

    def rotation(step: float) -> float:
        times = step * np.arange(round(1.88 / step) + 1)
        still = 0.0 * times
        felt = table.pieces(step, 0.8 * np.sin(9.9 * times), still, (still, still, still))
        found = event.simulate(world, felt, step, 1, 0.0)
        return float(found.rotation[-1])

    finest = rotation(1.5625e-4)
    assert abs(finest) > 1e-4
    assert rotation(2.5e-3) == pytest.approx(finest, abs=2e-7)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_mass_hung_in_a_block_keeps_its_speed_along_its_arc_through_an_impact(side: float) -> None:
    """Newton's equations of block, bob and the pull in the rod, followed from corner to corner by DOP853.

    A hinge at z over the middle of the base goes at omega (z, s b) as the block lands on its whole base from corner s;
    at the impact both omega and s change.
    """
    z, length, bob = 0.4, 0.15, 30.0
    world = replace(WORLD, slosh_mass=bob, slosh_length=length, slosh_height=z)
    b, H, m, J = WORLD.half_breadth, WORLD.centre_height, WORLD.mass, WORLD.corner_inertia

    def rate(t, y, s):
        theta, omega, psi, spin = y
        sin, cos, S, C = math.sin(theta), math.cos(theta), math.sin(psi), math.cos(psi)
        centre = -s * b * cos + H * sin
        x, up = -s * b * cos + z * sin, s * b * sin + z * cos  # the hinge from the corner
        # Rows: moments on the block about the corner, the bob to the right and up; of theta'', psi'' and the pull.
        left = [[J, 0.0, -(up * S + x * C)], [bob * up, bob * length * C, S], [-bob * x, bob * length * S, -C]]
        right = [
            m * G * centre,
            bob * (omega**2 * x + length * spin**2 * S),
            bob * (omega**2 * up - length * spin**2 * C - G),
        ]
        turning, swinging, _ = np.linalg.solve(left, right)
        return omega, turning, spin, swinging

    def flat(t, y, s):
        return y[0]

    flat.terminal = True  # type: ignore[attr-defined]
    found = event.simulate(world, AT_REST, STEP, 1, side * LEAN)
    begin, s, state = 0.0, side, np.array([side * LEAN, 0.0, 0.0, 0.0])
    for impact in range(3):
        flat.direction = -s  # type: ignore[attr-defined]
        swing = solve_ivp(
            rate, (begin, END), state, args=(s,), method="DOP853", events=flat, rtol=1e-11, atol=1e-13,
            dense_output=True,
        )  # fmt: skip
        end, (_, omega, psi, spin) = swing.t[-1], swing.y[:, -1]
        assert found.impacts[impact, 0] == pytest.approx(end, abs=1e-8)
        inside = (found.time > begin) & (found.time < end)
        assert found.rotation[inside] == pytest.approx(swing.sol(found.time[inside])[0], abs=1e-8)
        kept = RESTITUTION * omega
        jerk = z * (kept - omega), -s * b * (kept + omega)
        spin -= (math.cos(psi) * jerk[0] + math.sin(psi) * jerk[1]) / length
        begin, s, state = end, -s, np.array([0.0, kept, psi, spin])


def test_the_last_sample_is_that_of_a_run_that_goes_on() -> None:
    """Its angular acceleration is the floor's at its own time, though no piece of the floor begins there."""
    goes_on = event.simulate(WORLD, GROWING, STEP, 4, LEAN)
    ends = event.simulate(WORLD, GROWING[:2000], STEP, 4, LEAN)
    assert ends.time[-1] == pytest.approx(2.0, abs=1e-9)
    for name in ("rotation", "velocity", "acceleration"):
        last = getattr(ends, name)
        assert last[-1] == pytest.approx(getattr(goes_on, name)[last.size - 1], rel=1e-9)
