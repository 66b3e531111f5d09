"""Tolerances are honoured: over six decades the error against a reference stays below a multiple of what is asked.

Solvers without a tolerance ("exact", "taylor") are to be right to rounding at every one.
"""

import math
from typing import Any

import heyoka as hy
import mpmath
import numpy as np
import pytest

from excitation import RampedSinusoid, SteadySinusoid
from rocking import Block, Method1, Method2, solve
from rocking.solvers import available

G = 9.81
BLOCK = Block(b=0.2, h=0.8)
P2, ALPHA = 0.75 * G / (0.5 * math.hypot(0.2, 0.8)), math.atan(0.25)
HOUSNER = 1.0 - 1.5 * 0.04 / 0.68
DECADES = [10.0**-k for k in range(4, 11)]

# A step is allowed an error of rtol of the state, here of order 1; the steps of a swing, and an impact or five after
# it, add up to no more than this many of them.
SHARE = 10.0
ROUNDING = 1e-13  # of a time of a few seconds, where a step is limited by other things than the tolerance


def errors(solver: str, system: Any, reference: np.ndarray, motion: Any = None, **options: Any) -> list[float]:
    """Largest error of the impact times [s] at each tolerance."""
    worst = []
    for rtol in DECADES:
        run = solve(system, motion, rtol=rtol, atol=1e-3 * rtol, solver=solver, save_at=(), **options)
        worst.append(float(np.abs(run.impact_times[: reference.size] - reference).max()))
    return worst


def must_be_honoured(worst: list[float]) -> None:
    for error, rtol in zip(worst, DECADES, strict=True):
        assert error < SHARE * rtol + ROUNDING, f"rtol={rtol:g}: {error:.3g} s of {worst}"


def linear_impacts(share: float, count: int) -> np.ndarray:
    """Impact times [s] of the linear block released at `share` of alpha: Housner (1963), in 40 digits.

    A quarter period is acosh(1/(1 - x))/p, and an impact leaves 1 - (1 - x)^2 multiplied by e^2.
    """
    with mpmath.workdps(40):
        x, t, times = mpmath.mpf(share), mpmath.mpf(0), []
        for _ in range(count):
            quarter = mpmath.acosh(1 / (1 - x)) / mpmath.sqrt(P2)
            t += quarter
            times.append(float(t))
            x = 1 - mpmath.sqrt(1 - mpmath.mpf(HOUSNER) ** 2 * (1 - (1 - x) ** 2))
            t += mpmath.acosh(1 / (1 - x)) / mpmath.sqrt(P2)
        return np.array(times)


def heyoka_impacts(amplitude: float, frequency: float, theta: float, t_end: float) -> np.ndarray:
    """Impact times [s] of the nonlinear block under a sine, by Taylor series of order 20."""
    x, v = hy.make_vars("x", "v")
    psi = ALPHA - hy.par[0] * x
    bend = hy.par[0] * hy.sin(psi) + amplitude / G * hy.sin(2.0 * math.pi * frequency * hy.time) * hy.cos(psi)
    times: list[float] = []

    def strike(ta: Any, _: int) -> bool:
        times.append(ta.time)
        ta.state[:] = [0.0, HOUSNER * ta.state[1]]
        ta.pars[0] = -ta.pars[0]
        return True

    event = hy.t_event(hy.par[0] * x, callback=strike, direction=hy.event_direction.negative)
    ta = hy.taylor_adaptive([(x, v), (v, -P2 * bend)], [theta, 0.0], pars=[1.0], t_events=[event], tol=1e-16)
    ta.propagate_until(t_end)
    return np.array(times)


@pytest.mark.parametrize("solver", available())
def test_free_rocking_of_the_linear_block_to_the_closed_form(solver: str) -> None:
    system = Method1(BLOCK, form="linear", g=G)
    must_be_honoured(errors(solver, system, linear_impacts(0.9, 5), theta=0.9 * ALPHA, t_end=4.0))


# A frequency of 0.2 Hz leaves the steps to the tolerance, but for the largest ones.
@pytest.mark.parametrize("solver", [pytest.param("diffrax", marks=pytest.mark.slow), "numba", "scipy"])
@pytest.mark.parametrize("method", ["method1", "method2"])
def test_shaken_nonlinear_block_to_heyoka(solver: str, method: str) -> None:
    system: Any = Method1(BLOCK, g=G) if method == "method1" else Method2(BLOCK, friction=math.inf, g=G)
    motion = SteadySinusoid(0.2, 0.3, 20.0)
    reference = heyoka_impacts(0.3, 0.2, 0.5 * ALPHA, 3.0)
    assert reference.size >= 4
    worst = errors(solver, system, reference[:4], motion, theta=0.5 * ALPHA, t_end=3.0)
    must_be_honoured(worst)


# Rounding alone is left to the solvers in closed form, whatever is asked for.
@pytest.mark.parametrize("solver", ["exact", "taylor"])
def test_solvers_without_a_tolerance_are_right_at_every_one(solver: str) -> None:
    system = Method1(BLOCK, form="linear", g=G)
    assert max(errors(solver, system, linear_impacts(0.9, 5), theta=0.9 * ALPHA, t_end=4.0)) < ROUNDING


# Slides, bounces and lands: no closed form, so the reference is the other Runge-Kutta pair at 1e-13.
@pytest.mark.parametrize("solver", ["numba", "scipy"])
def test_method_2_that_slides_and_bounces_to_a_run_at_the_limit(solver: str) -> None:
    system = Method2(BLOCK, friction=0.3, kinetic_friction=0.2, normal_restitution=0.4, chatter_time=1e-3, g=G)
    motion = RampedSinusoid(2.0, 10.0, 60.0)
    other = {"numba": "scipy", "scipy": "numba"}[solver]
    options: Any = {"theta": 0.5 * ALPHA, "t_end": 1.5}
    sharp = solve(system, motion, rtol=1e-13, atol=1e-16, solver=other, save_at=(), **options)
    count = 6
    assert len(sharp.events) > count
    worst = []
    for rtol in DECADES:
        run = solve(system, motion, rtol=rtol, atol=1e-3 * rtol, solver=solver, save_at=(), **options)
        np.testing.assert_array_equal(run.events.mode_after[:count], sharp.events.mode_after[:count])
        worst.append(float(np.abs(run.events.t[:count] - sharp.events.t[:count]).max()))
    must_be_honoured(worst)
