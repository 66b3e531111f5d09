"""A mass that swings inside of a block (rocking.inner_mass), against MuJoCo, which knows two bodies and a spring."""

import math

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from excitation import PiecewiseLinear, SteadySinusoid
from rocking import Block, Method1, solve
from rocking.composed import IMPACT, TIP_LEFT, TIP_RIGHT
from rocking.effects import compose, load
from rocking.hybrid import ROTATION, Base, Discrete
from rocking.inner_mass import inside

G = 9.81
BLOCK = Block(b=0.2, h=0.8)
MODE = {"mass_ratio": 0.08, "height_ratio": 1.5, "frequency": 2.5, "damping_ratio": 0.1}
HEIGHT = 1.5 * 0.4  # of the mass [m]
W = 2.0 * math.pi * 2.5  # rad/s

# A body on a hinge along its right edge, and one in it on a slide; together they weigh and turn as the declared block.
TWO_BODIES = """
<mujoco>
  <option timestep="1e-4" gravity="{pull} 0 -{g}" integrator="RK4"/>
  <worldbody>
    <body pos="{a} 0 0">
      <joint type="hinge" axis="0 1 0"/>
      <inertial pos="-{a} 0 {z}" mass="{m}" diaginertia="{i} {i} {i}"/>
      <body pos="-{a} 0 {h}">
        <joint type="slide" axis="1 0 0" stiffness="{k}" damping="{c}"/>
        <inertial pos="0 0 0" mass="{inner}" diaginertia="1e-9 1e-9 1e-9"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


# The same with the inner body on an arm, whose hinge is over the middle of the base.
HUNG = TWO_BODIES.replace("0 {h}", "0 {hinge}").replace(
    """<joint type="slide" axis="1 0 0" stiffness="{k}" damping="{c}"/>
        <inertial pos="0 0 0\"""",
    """<joint type="hinge" axis="0 1 0" damping="{c}"/>
        <inertial pos="0 0 -{arm}\"""",
)


def effect(**changes: float):
    return load("learned_mode")(**(MODE | changes))


def in_mujoco(theta: float, shift: float, a_x: float, times: np.ndarray, scene: str = TWO_BODIES) -> np.ndarray:
    """Rotation [rad] and place of the mass [m] at the times, before the block lands; shape (time, 2)."""
    m, H, a = BLOCK.mass, 0.5 * BLOCK.h, 0.5 * BLOCK.b
    inner = 0.08 * m
    rest = m - inner
    z = (m * H - inner * HEIGHT) / rest
    i = BLOCK.I_c + m * H**2 - inner * HEIGHT**2 - rest * z**2
    arm = G / W**2
    c = inner * 2.0 * 0.1 * W * (arm**2 if scene is HUNG else 1.0)
    model = mujoco.MjModel.from_xml_string(
        scene.format(
            pull=-a_x, g=G, a=a, z=z, m=rest, i=i, h=HEIGHT, inner=inner, k=inner * W**2, c=c, hinge=HEIGHT + arm,
            arm=arm,
        )
    )  # fmt: skip
    data = mujoco.MjData(model)
    # A hinge that turns clockwise takes what hangs from it the other way.
    per = -arm if scene is HUNG else 1.0
    data.qpos[:] = theta, shift / per
    seen = []
    for t in times:
        while data.time < t - 5e-5:
            mujoco.mj_step(model, data)
        seen.append((data.qpos[0], per * data.qpos[1]))
    return np.array(seen)


@pytest.mark.parametrize("a_x", [0.0, 0.8])
def test_a_swing_is_that_of_two_bodies(a_x: float) -> None:
    """From a lean, on a base that is at rest or goes away under it; the mass begins where it hangs at that lean."""
    base = PiecewiseLinear(1.0, [a_x, a_x])
    times = np.linspace(0.0, 0.28, 8)
    run = solve(Method1(BLOCK, g=G), base, theta=0.15, t_end=0.28, effects=[effect()], save_at=times)
    assert not len(run.impact_times)
    assert run.y[0, 2] == pytest.approx(G * math.sin(0.15) / W**2, rel=1e-12)
    expected = in_mujoco(0.15, run.y[0, 2], a_x, times)
    np.testing.assert_allclose(run.theta, expected[:, 0], rtol=0.0, atol=2e-8)
    np.testing.assert_allclose(run.y[:, 2], expected[:, 1], rtol=0.0, atol=2e-8)
    # It is no small matter: without the mass the block would be elsewhere.
    plain = solve(Method1(BLOCK, g=G), base, theta=0.15, t_end=0.28, save_at=times)
    assert np.abs(plain.theta - run.theta).max() > 1e-3


@pytest.mark.parametrize("a_x", [0.0, 0.8])
def test_a_swing_of_what_hangs_is_that_of_two_hinges(a_x: float) -> None:
    """The arm of 40 mm is let go at 1.5 rad from plumb, and swings through to the other side."""
    base = PiecewiseLinear(1.0, [a_x, a_x])
    times = np.linspace(0.0, 0.24, 7)
    system = compose(Method1(BLOCK, g=G), [effect(hanging=1.0)])
    shift = -1.35 * G / W**2
    y, q = system.initial_state(0.15, shift=shift)
    run = solve(system, base, initial=(y, q), t_end=0.24, save_at=times)
    assert not len(run.impact_times)
    assert run.y[:, 2].max() > 0.5 * G / W**2
    expected = in_mujoco(0.15, shift, a_x, times, HUNG)
    np.testing.assert_allclose(run.theta, expected[:, 0], rtol=0.0, atol=2e-8)
    np.testing.assert_allclose(run.y[:, 2], expected[:, 1], rtol=0.0, atol=2e-8)
    # It is no spring along the base.
    system = compose(Method1(BLOCK, g=G), [effect()])
    spring = solve(system, base, initial=system.initial_state(0.15, shift=shift), t_end=0.24, save_at=times)
    assert np.abs(spring.theta - run.theta).max() > 1e-3


@pytest.mark.parametrize("hanging", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("theta", [0.3, -0.6])
def test_it_hangs_still_where_its_spring_and_its_weight_are_even(hanging: float, theta: float) -> None:
    system = compose(Method1(BLOCK, g=G), [effect(hanging=hanging)])
    y, q = system.initial_state(theta)
    within = inside(np, y, q, Base(0.0, 0.0), system.parameters)
    assert within.speed == 0.0
    assert within.v_dot == pytest.approx(0.0, abs=1e-12 * G)
    arm = G / W**2
    straight = arm * math.sin(theta)
    assert y[2] == pytest.approx({0.0: straight, 1.0: arm * theta}.get(hanging, y[2]), rel=1e-12)
    assert abs(straight) * (1.0 - 1e-12) <= abs(y[2]) <= abs(arm * theta) * (1.0 + 1e-12)


def test_what_hangs_in_a_block_at_rest_is_a_pendulum_on_the_base() -> None:
    """Too weak a shaking for the block, and yet the arm of 40 mm swings by half a radian."""
    base = SteadySinusoid(2.0, 0.6, 3.0)
    times = np.linspace(0.0, 3.0, 31)
    run = solve(Method1(BLOCK, g=G), base, t_end=3.0, effects=[effect(hanging=1.0)], save_at=times)
    assert run.peak_rotation == 0.0
    arm = G / W**2
    other = solve_ivp(
        lambda t, y: (
            y[1],
            -(G * math.sin(y[0]) + 0.6 * math.sin(4.0 * math.pi * t) * math.cos(y[0])) / arm - 0.2 * W * y[1],
        ),
        (0.0, 3.0), (0.0, 0.0), t_eval=times, rtol=1e-10, atol=1e-13, max_step=0.02,
    )  # fmt: skip
    np.testing.assert_allclose(run.y[:, 2], arm * other.y[0], rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("hanging", [0.0, 1.0])
def test_a_run_goes_on_from_its_velocity_in_the_block(hanging: float) -> None:
    system = compose(Method1(BLOCK, g=G), [effect(hanging=hanging)])
    y, q = system.initial_state(-0.3, 0.7, 0.02, -0.4)
    assert q.s == -1.0
    assert system.slide(y, q.s) == pytest.approx(-0.4, rel=1e-12)
    assert inside(np, y, q, Base(0.0, 0.0), system.parameters).speed == pytest.approx(-0.4, rel=1e-12)


def test_either_side_is_the_image_of_the_other() -> None:
    base = [PiecewiseLinear(1.0, [0.5, sign * 3.0]) for sign in (1.0, -1.0)]
    base[1] = PiecewiseLinear(1.0, [-0.5, -3.0])
    one, other = (
        solve(Method1(BLOCK), motion, theta=lean, t_end=0.9, effects=[effect()], save_at=np.linspace(0.0, 0.9, 10))
        for motion, lean in zip(base, (0.12, -0.12), strict=True)
    )
    assert len(one.impact_times) == len(other.impact_times) >= 1
    np.testing.assert_allclose(one.y, -other.y, rtol=0.0, atol=1e-10)


def test_an_impact_leaves_the_mass_as_it_was() -> None:
    """A spring carries no impulse: place and velocity of the mass over the floor go on, that in the block does not."""
    run = solve(Method1(BLOCK, restitution=0.9), theta=0.15, t_end=2.0, effects=[effect()])
    hits = run.events.guard == IMPACT
    before, after = run.events.y_before[hits], run.events.y_after[hits]
    assert len(before) >= 3
    np.testing.assert_array_equal(before[:, 2:], after[:, 2:])
    np.testing.assert_allclose(after[:, 1], 0.9 * before[:, 1], rtol=1e-12)


def test_in_a_block_at_rest_it_is_an_oscillator_on_the_base() -> None:
    """Too weak a shaking for the block; the mass against its own equation by another integrator."""
    base = SteadySinusoid(2.0, 0.6, 3.0)
    times = np.linspace(0.0, 3.0, 31)
    run = solve(Method1(BLOCK, g=G), base, t_end=3.0, effects=[effect()], save_at=times)
    assert run.peak_rotation == 0.0
    other = solve_ivp(
        lambda t, y: (y[1], -(W**2) * y[0] - 0.2 * W * y[1] - 0.6 * math.sin(4.0 * math.pi * t)), (0.0, 3.0),
        (0.0, 0.0), t_eval=times, rtol=1e-10, atol=1e-13, max_step=0.02,
    )  # fmt: skip
    np.testing.assert_allclose(run.y[:, 2], other.y[0], rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_it_lifts_the_block_when_its_pull_and_the_base_outweigh_the_block(sign: float) -> None:
    """At lift-off, by d'Alembert with the mass at its place and the acceleration that it has."""
    base = SteadySinusoid(2.0, sign * 2.0, 3.0)
    run = solve(Method1(BLOCK, g=G), base, t_end=3.0, effects=[effect()])
    assert run.events.guard[0] in (TIP_LEFT, TIP_RIGHT)
    t, (_, _, shift, speed) = run.events.t[0], run.events.y_before[0]
    side = 1.0 if run.events.guard[0] == TIP_RIGHT else -1.0
    m, H, a, inner = BLOCK.mass, 0.5 * BLOCK.h, 0.5 * BLOCK.b, 0.08 * BLOCK.mass
    pushed = sign * 2.0 * math.sin(4.0 * math.pi * t)
    relative = -(W**2) * shift - 0.2 * W * speed - pushed
    # About the edge that carries: of the rest of the block, and of the mass.
    moment = -(m * H - inner * HEIGHT) * pushed - inner * HEIGHT * (pushed + relative)
    weight = (m - inner) * G * a + inner * G * (a - side * shift)
    assert side * moment == pytest.approx(weight, rel=1e-7)
    # West's formula alone would let it stand.
    assert G * BLOCK.b / BLOCK.h > 2.0


def test_a_stiff_spring_holds_the_mass_in_place() -> None:
    """What it adds falls with the square of the frequency."""
    times = np.linspace(0.0, 0.28, 8)
    plain = solve(Method1(BLOCK), theta=0.15, t_end=0.28, save_at=times)
    off = [
        np.abs(solve(Method1(BLOCK), theta=0.15, t_end=0.28, effects=[effect(frequency=f)], save_at=times).theta
               - plain.theta).max()
        for f in (20.0, 40.0)
    ]  # fmt: skip
    assert off[0] < 1e-3
    assert off[0] / off[1] == pytest.approx(4.0, rel=0.1)


def test_a_pitch_of_the_base_carries_the_mass_along() -> None:
    """In a block at rest, at the height of the mass: it is driven by psi'' h and by the weight along the floor."""
    system = compose(Method1(BLOCK, g=G), [effect()])
    y, q = system.initial_state()
    psi, psi2 = 0.01, 0.3
    rate = system.flow(np, y, q, Base(0.0, 0.0, psi, psi2), system.parameters)
    assert rate[3] == pytest.approx(G * math.sin(psi) - psi2 * HEIGHT, rel=1e-12)


@pytest.mark.parametrize("shift", [0.0, 0.03])
@pytest.mark.parametrize("theta", [0.5, 0.8])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_pitch_carries_the_mass_of_a_leaning_block_along(side: float, theta: float, shift: float) -> None:
    """A point at (x, z) over the middle of the base feels the floor go by psi'' (z, -x).

    The middle place of the mass is s a (1 - cos) + h sin to the right and s a sin + h cos up.  In the axes of the block
    that is psi'' (h + s a sin) along its base and psi'' s a (1 - cos) across.
    """
    system = compose(Method1(BLOCK, g=G), [effect()])
    theta, a, mu, psi2 = side * theta, 0.5 * BLOCK.b, 0.08, 3.0
    y, q = (theta, 0.4, side * shift, 0.7), Discrete(ROTATION, side, 1.0)
    pitching, still = (inside(np, y, q, Base(0.5, -0.3, 0.01, psi), system.parameters) for psi in (psi2, 0.0))
    along = psi2 * (HEIGHT + side * a * math.sin(theta))
    across = psi2 * side * a * (1.0 - math.cos(theta))
    assert pitching.v_dot - still.v_dot == pytest.approx(-along, rel=1e-12)
    # Its force is felt at its place, HEIGHT over the base and `shift` beside the middle.
    turned = mu * (HEIGHT * along + side * shift * across)
    assert pitching.moment - still.moment == pytest.approx(turned, rel=1e-12)
    assert pitching.inertia == still.inertia


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"mass_ratio": 0.6}, r"learned_mode.mass_ratio=0.6 1: want 0 to 0.5"),
        ({"frequency": 0.0}, r"learned_mode.frequency=0.0 Hz: want 1e-06 to 1e\+06"),
        ({"hanging": 1.1}, r"learned_mode.hanging=1.1 1: want 0 to 1"),
        ({"damping_ratio": -0.1}, r"learned_mode.damping_ratio=-0.1 1: want 0 to 1e\+06"),
        ({"height_ratio": 4.0, "mass_ratio": 0.4}, r"mass_ratio=0.4: at a height of 1.6 m more than the moment"),
    ],
)
def test_what_cannot_be_is_refused(given: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        compose(Method1(BLOCK), [effect(**given)])


def test_it_goes_with_one_set_of_further_states_only() -> None:
    with pytest.raises(ValueError, match=r"learned_memory: it does not go together with learned_mode"):
        compose(Method1(BLOCK), [effect(), load("learned_memory")(first=0.1)])
