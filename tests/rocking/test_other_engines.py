"""The same block in engines that share no code with this one: MuJoCo, pymunk, and heyoka's Taylor series with events.

MuJoCo and pymunk are told nothing of rocking: a rigid box, a floor, Coulomb friction and a contact without bounce.  The
floor moves by acting with -a_x on everything, which is what an observer on it would see.
"""

import math
from collections.abc import Callable
from typing import Any

import heyoka
import mujoco
import numpy as np
import pymunk
import pytest

from excitation import RampedSinusoid, SteadySinusoid
from rocking import Block, Method1, Method2, solve
from rocking.motion import Still
from rocking.solvers import available, load

G = 9.81
BLOCK = Block(0.2, 0.8)

# First overturning amplitude [m/s^2] of one cycle of a sine at 1, 2 and 3 Hz, nonlinear Method 1 with Housner's e:
# SciPy's solve_ivp with events, and a bisection on the amplitude; four digits.
FIRST = {1.0: 2.869, 2.0: 3.419, 3.0: 5.243}
FREE = 4.0  # time [s] after the pulse in which a block falls or comes back

STEP = 2e-4  # time step [s] of MuJoCo and pymunk
FALLEN = 1.2  # tilt [rad] from which no block comes back, four times that of unstable balance


def cycle(frequency: float, amplitude: float) -> SteadySinusoid:
    return SteadySinusoid(frequency, amplitude, 1.0 / frequency)


def falls(system: Any, frequency: float, amplitude: float, solver: str) -> bool:
    end = 1.0 / frequency + FREE
    return solve(system, cycle(frequency, amplitude), t_end=end, save_at=(), solver=solver).overturned


def threshold(overturns: Callable[[float], bool], expected: float, width: float) -> float:
    """The amplitude at which overturning begins, bisected to 1e-4 of it, from within +-width of the expected one."""
    low, high = expected * (1.0 - width), expected * (1.0 + width)
    assert not overturns(low)
    assert overturns(high)
    while high - low > 1e-4 * expected:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if overturns(middle) else (middle, high)
    return 0.5 * (low + high)


# Half a unit of the last digit printed, and the bisection.  Method 2 with friction that holds is the same block.
@pytest.mark.parametrize("frequency", FIRST)
@pytest.mark.parametrize("solver", ["numba", "scipy", pytest.param("diffrax", marks=pytest.mark.slow)])
def test_first_overturning_amplitude_by_method_1(frequency: float, solver: str) -> None:
    system = Method1(BLOCK, g=G)
    found = threshold(lambda a: falls(system, frequency, a, solver), FIRST[frequency], 0.002)
    assert found == pytest.approx(FIRST[frequency], abs=5e-4 + 1e-4 * found)


@pytest.mark.parametrize("frequency", FIRST)
def test_first_overturning_amplitude_by_method_2_with_friction_that_holds(frequency: float) -> None:
    system = Method2(BLOCK, friction=1.2, g=G)
    found = threshold(lambda a: falls(system, frequency, a, "numba"), FIRST[frequency], 0.002)
    assert found == pytest.approx(FIRST[frequency], abs=5e-4 + 1e-4 * found)


def test_nothing_weaker_overturns() -> None:
    for frequency, amplitude in FIRST.items():
        weaker = np.linspace(0.5, 0.998, 40) * amplitude
        assert not any(falls(Method1(BLOCK, g=G), frequency, float(a), "numba") for a in weaker)


# Contact: elliptic friction cone, mu = 1.2 (far above b/h), reference time of two steps and critical damping, impedance
# 0.9 to 0.99 over 0.1 mm: as hard as the step allows, no bounce.
MODEL = """
<mujoco>
  <option timestep="{step}" gravity="0 0 -{g}" cone="elliptic" iterations="100" tolerance="1e-12"/>
  <default><geom friction="1.2 0 0" condim="3" solref="{twice} 1" solimp="0.9 0.99 0.0001 0.5 2"/></default>
  <worldbody>
    <geom type="plane" size="5 5 1"/>
    <body pos="0 0 {half_h}">
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0"/>
      <geom type="box" size="{half_b} 0.1 {half_h}" mass="10"/>
    </body>
  </worldbody>
</mujoco>
"""


def falls_in_mujoco(frequency: float, amplitude: float) -> bool:
    text = MODEL.format(step=STEP, twice=2.0 * STEP, g=G, half_b=0.5 * BLOCK.b, half_h=0.5 * BLOCK.h)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    gravity, position = model.opt.gravity, data.qpos
    for push in pushes(frequency, amplitude):
        gravity[0] = -push
        mujoco.mj_step(model, data)
        if abs(position[2]) > FALLEN:
            return True
    return False


# Contact: friction 1.2, no elasticity, 30 iterations, an overlap of 1 micrometre left alone.
def falls_in_pymunk(frequency: float, amplitude: float) -> bool:
    space = pymunk.Space()
    space.iterations, space.collision_slop = 30, 1e-6
    mass = 10.0
    body = pymunk.Body(mass, mass * (BLOCK.b**2 + BLOCK.h**2) / 12.0)
    body.position = (0.0, 0.5 * BLOCK.h)
    box = pymunk.Poly.create_box(body, (BLOCK.b, BLOCK.h))
    floor = pymunk.Segment(space.static_body, (-5.0, -0.5), (5.0, -0.5), 0.5)
    box.friction, floor.friction = 1.2, 1.0  # their product acts
    box.elasticity = floor.elasticity = 0.0
    space.add(body, box, floor)
    for push in pushes(frequency, amplitude):
        space.gravity = (-push, -G)
        space.step(STEP)
        if abs(body.angle) > FALLEN:
            return True
    return False


def pushes(frequency: float, amplitude: float) -> list[float]:
    """a_x [m/s^2] in the middle of each time step."""
    times = STEP * (np.arange(round((1.0 / frequency + FREE) / STEP)) + 0.5)
    return cycle(frequency, amplitude)(times)[0].tolist()


# Within 1 % is what is claimed; the engines come within 0.1 %.
@pytest.mark.parametrize("frequency", FIRST)
@pytest.mark.parametrize("engine", [falls_in_mujoco, falls_in_pymunk])
def test_first_overturning_amplitude_by_another_engine_is_within_a_hundredth(
    engine: Callable[[float, float], bool], frequency: float
) -> None:
    found = threshold(lambda a: engine(frequency, a), FIRST[frequency], 0.05)
    assert found == pytest.approx(FIRST[frequency], rel=0.01)


def heyoka_impacts(form: str, theta: float, rate: float, frequency: float, t_end: float) -> np.ndarray:
    """Impact times [s] of a block released at theta under rate t sin(2 pi f t), by Taylor series of order 20."""
    hy = heyoka
    alpha, p2, e = math.atan2(0.2, 0.8), 0.75 * G / (0.5 * math.hypot(0.2, 0.8)), 1.0 - 1.5 * 0.04 / 0.68
    x, v = hy.make_vars("x", "v")
    s = hy.par[0]
    push = rate / G * hy.time * hy.sin(2.0 * math.pi * frequency * hy.time)
    psi = alpha - s * x
    bend = s * hy.sin(psi) + push * hy.cos(psi) if form == "nonlinear" else s * psi + push
    times: list[float] = []

    def strike(ta: Any, _: int) -> bool:
        times.append(ta.time)
        ta.state[:] = [0.0, e * ta.state[1]]
        ta.pars[0] = -ta.pars[0]
        return True

    event = hy.t_event(s * x, callback=strike, direction=hy.event_direction.negative)
    ta = hy.taylor_adaptive([(x, v), (v, -p2 * bend)], [theta, 0.0], pars=[1.0], t_events=[event], tol=1e-16)
    ta.propagate_until(t_end)
    return np.array(times)


# anchor of six digits for the free block: quadrature of the first integral, see test_method1_closed_forms.
def test_heyoka_has_the_impacts_of_the_quadrature() -> None:
    times = heyoka_impacts("nonlinear", 0.5 * BLOCK.alpha, 0.0, 1.0, 2.0)
    np.testing.assert_allclose(times, [0.312309, 0.820592, 1.251877, 1.625867, 1.954508], rtol=0.0, atol=5.1e-7)


# diffrax compiles each pair of form and motion for seconds: it meets one, and the agreement suite beside.
CASES = [
    (solver, form, rate, frequency)
    for solver in available()
    for form in ("nonlinear", "linear")
    for rate, frequency in ((0.0, 1.0), (2.5, 2.0), (4.0, 4.0))
    if solver != "diffrax" or (form == "nonlinear" and rate > 0.0)
]


@pytest.mark.parametrize(("solver", "form", "rate", "frequency"), CASES)
def test_impacts_are_those_of_heyoka(solver: str, form: Any, rate: float, frequency: float) -> None:
    system = Method1(BLOCK, form=form, g=G)
    motion = RampedSinusoid(frequency, 10.0, 10.0 * rate) if rate else Still()
    refusal = load(solver).declines(system, motion)
    if refusal is not None:
        pytest.skip(f"{solver} declines: {refusal}")
    expected = heyoka_impacts(form, 0.5 * BLOCK.alpha, rate, frequency, 2.0)
    assert len(expected) >= 4
    run = solve(system, motion, theta=0.5 * BLOCK.alpha, t_end=2.0, solver=solver, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(run.impact_times, expected, rtol=0.0, atol=1e-8)
