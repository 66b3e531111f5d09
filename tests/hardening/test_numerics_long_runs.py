"""An hour of shaking: no drift, no loss of time, and the orbit of the closed form still to the digits of the solver."""

import math
from typing import Any

import numpy as np
import pytest

import dem
from excitation import PiecewiseLinear, SteadySinusoid
from rocking import Block, Method1, Method2, Outcome, solve
from rocking.steady_states import start, steady_states

G = 9.81
BLOCK = Block(0.2, 0.8)
HOUR = 3600.0
RATIO, AMPLITUDE, E = 2.0, 1.0, 0.9
PERIOD = 2.0 * math.pi / (RATIO * BLOCK.p(G))  # of the base, and of the orbit [s]
SYSTEM = Method1(BLOCK, form="linear", restitution=E, g=G)
(ORBIT, _) = steady_states(RATIO, AMPLITUDE, E)


# The orbit is stable: it forgets what a step does wrong, but a clock or a phase of the base that drifted would show in
# every impact.  Times of an hour are kept to 5e-13 s; a step at a tolerance of 1e-12 and its impact cost 1e-11 s.
@pytest.mark.parametrize(("solver", "long"), [("numba", HOUR), pytest.param("scipy", 600.0, marks=pytest.mark.slow)])
def test_after_an_hour_impacts_keep_the_times_of_the_closed_form(solver: str, long: float) -> None:
    assert ORBIT.stable and ORBIT.admissible
    phase, omega = start(ORBIT, SYSTEM)
    motion = SteadySinusoid(1.0 / PERIOD, AMPLITUDE * G * BLOCK.alpha, long + PERIOD, phase)
    run = solve(SYSTEM, motion, omega=omega, t_end=long, save_at=[long], solver=solver, rtol=1e-12, atol=1e-15)
    count = math.floor(long / (0.5 * PERIOD) * (1.0 - 1e-12))
    np.testing.assert_allclose(run.impact_times, 0.5 * PERIOD * np.arange(1, count + 1), rtol=0.0, atol=1e-9)
    assert run.peak_rotation == pytest.approx(ORBIT.peak * BLOCK.alpha, rel=1e-9)


# The same base as a record of 60 samples a period: an orbit close by, on which impacts come after half a period too,
# since samples and orbit mirror themselves.  Times of samples are k dt, whose rounding is that of the hour.
@pytest.mark.parametrize("solver", ["exact", "taylor", "numba"])
def test_on_a_record_of_an_hour_impacts_stay_half_a_period_apart(solver: str) -> None:
    phase, omega = start(ORBIT, SYSTEM)
    dt = PERIOD / 60.0
    k = np.arange(math.ceil(HOUR / dt) + 2)
    a_x = AMPLITUDE * G * BLOCK.alpha * np.sin(2.0 * math.pi / 60.0 * (k % 60) + phase)
    run = solve(SYSTEM, PiecewiseLinear(dt, a_x), omega=omega, t_end=HOUR, save_at=[HOUR], solver=solver)
    # Every half orbit leaves e of a disturbance: 0.9^400 of the difference between the two orbits is below rounding.
    settled = run.impact_times[400:]
    assert settled.size == pytest.approx(HOUR / (0.5 * PERIOD) - 400, abs=1.0)
    np.testing.assert_allclose(np.diff(settled), 0.5 * PERIOD, rtol=0.0, atol=2e-8 if solver == "numba" else 1e-11)
    assert settled[-1] - settled[0] == pytest.approx(0.5 * PERIOD * (settled.size - 1), abs=1e-8)


# With a friction that holds, Method 2 with Housner's impacts is Method 1, and its corner stands where it stood.
def test_a_corner_that_holds_has_not_moved_after_an_hour() -> None:
    system: Any = Method2(BLOCK, friction=1.3, g=G)
    motion = SteadySinusoid(2.0, 1.2 * G * 0.25, HOUR)
    run = solve(system, motion, t_end=HOUR, save_at=np.linspace(0.0, HOUR, 3601))
    assert run.outcome is Outcome.MOVING and run.impact_times.size > 3000
    # A corner is half of the breadth from the middle; at each of the impacts a rounding of 0.2 m may be lost.
    drift = run.events.y_after[:, 0] - 0.5 * BLOCK.b * run.events.s_after
    assert np.abs(drift).max() < 1e-16 * 10 * run.impact_times.size
    assert np.all(np.isfinite(run.y))


# Distinct elements, shaken at half of what tips them: the springs carry the load and nothing creeps in an hour.
@pytest.mark.slow
def test_a_block_of_distinct_elements_stands_where_it_stood_after_an_hour() -> None:
    scene = dem.single_block(0.3, 1.0, 0.5, 597.0)
    k, damping_ratio = 2e5, 0.3
    dt = 0.5 * dem.critical_step(scene, k, k, 2.0 * damping_ratio * math.sqrt(k * scene.mass))
    motion = SteadySinusoid(1.0, 0.15 * G, HOUR, taper_in=5.0, taper_out=5.0)
    run = dem.simulate(
        scene, motion, t_end=HOUR + 10.0, dt=dt, kn=k, ks=k, mu=0.6, damping_ratio=damping_ratio, g=G,
        save_every=max(1, int(1.0 / dt)),
    )  # fmt: skip
    assert np.all(np.isfinite(run.theta))
    # At rest again, where it began, to a ten thousandth of what the springs give under the weight.
    static = scene.mass * G / (2.0 * k)
    assert abs(run.x[-1] - run.x[0]) < 1e-4 * static
    assert abs(run.z[-1] - run.z[0]) < 1e-4 * static
    assert abs(run.theta[-1]) < 1e-4 * static / 0.15
