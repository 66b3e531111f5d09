"""Method 1 against closed forms: free rocking, conservation, onset, and the exact symmetries."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from rocking import Block, Method1, Mode, Outcome, solve
from rocking.closed_forms import zeno_time

G = 9.81


def housner_quarter_period(p: float, alpha: float, theta_0: float) -> float:
    """Time from rest at theta_0 to upright: (1/p) acosh(1 / (1 - theta_0/alpha)), Housner (1963)."""
    return math.acosh(1.0 / (1.0 - theta_0 / alpha)) / p


def nonlinear_quarter_period(p: float, alpha: float, theta_0: float) -> float:
    """The same without linearising: omega^2 = 2 p^2 (cos(alpha - theta_0) - cos(alpha - theta)), by quadrature."""

    def integrand(x: float) -> float:  # theta = theta_0 - x^2 takes away the root singularity at theta_0
        # cos A - cos B = 2 sin((A + B)/2) sin((B - A)/2) keeps its digits as x -> 0.
        gap = 4.0 * p**2 * math.sin(alpha - theta_0 + 0.5 * x * x) * math.sin(0.5 * x * x)
        return 2.0 * x / math.sqrt(gap) if x > 0.0 else 2.0 / (p * math.sqrt(2.0 * math.sin(alpha - theta_0)))

    return quad(integrand, 0.0, math.sqrt(theta_0), epsabs=1e-14, epsrel=1e-13)[0]


def impact_times(quarter: Any, after: Any, p: float, alpha: float, theta_0: float, n: int) -> np.ndarray:
    """Impact times of free rocking from rest at theta_0: a quarter period, then half periods of shrinking swings."""
    times, amplitude = [quarter(p, alpha, theta_0)], theta_0
    for _ in range(n - 1):
        amplitude = after(alpha, amplitude)
        times.append(times[-1] + 2.0 * quarter(p, alpha, amplitude))
    return np.array(times)


# Housner (1963), linear equation: between impacts omega^2 = p^2 alpha^2 (1 - (1 - theta_0/alpha)^2), and each impact
# multiplies omega by e.  Tolerance 2e-8 s: rtol 1e-9 over forty located impacts, one second of them late and fast.
@pytest.mark.parametrize("solver", ["numba", "scipy"])
@pytest.mark.parametrize(
    ("b", "h", "share", "e"), [(0.2, 0.8, 0.5, 0.95), (0.15, 0.5, 0.9, 0.9), (0.5, 1.5, 0.05, 0.98)]
)
def test_linear_free_rocking_decays_as_housner_1963(solver: str, b: float, h: float, share: float, e: float) -> None:
    def after(alpha: float, amplitude: float) -> float:
        energy = e**2 * (1.0 - (1.0 - amplitude / alpha) ** 2)
        return alpha * (1.0 - math.sqrt(1.0 - energy))

    alpha, p = math.atan(b / h), math.sqrt(0.75 * G / (0.5 * math.hypot(b, h)))
    expected = impact_times(housner_quarter_period, after, p, alpha, share * alpha, 40)
    system = Method1(Block(b=b, h=h), form="linear", restitution=e, g=G)
    run = solve(system, theta=share * alpha, t_end=expected[-1] + 1e-3, solver=solver)
    np.testing.assert_allclose(run.impact_times, expected, rtol=0.0, atol=2e-8)


# anchors: first integral and quadrature; five impacts of the block of 0.2 x 0.8 m as printed to six decimals.
PRINTED = [0.312309, 0.820592, 1.251877, 1.625867, 1.954508]


@pytest.mark.parametrize("solver", ["numba", "scipy"])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_nonlinear_free_rocking_has_the_impact_times_of_quadrature(slender: Block, solver: str, side: float) -> None:
    alpha, e = math.atan(0.25), 1.0 - 1.5 * 0.04 / 0.68
    p = math.sqrt(0.75 * G / (0.5 * math.hypot(0.2, 0.8)))

    def after(alpha: float, amplitude: float) -> float:
        # omega^2/(2 p^2) before the impact, times e^2; the next swing ends where cos(alpha - theta) has risen by it.
        energy = e**2 * (math.cos(alpha - amplitude) - math.cos(alpha))
        return alpha - math.acos(math.cos(alpha) + energy)

    expected = impact_times(nonlinear_quarter_period, after, p, alpha, 0.5 * alpha, 5)
    np.testing.assert_allclose(expected, PRINTED, rtol=0.0, atol=5.1e-7)
    run = solve(Method1(slender, g=G), theta=side * 0.5 * alpha, t_end=2.0, solver=solver)
    assert len(run.impact_times) == 5
    # The promise for the two solvers at the default tolerance: 1e-8 s.
    np.testing.assert_allclose(run.impact_times, expected, rtol=0.0, atol=1e-8)


# A fall has a quadrature as well: from upright with omega_0 the tilt theta_c is passed at a time that it gives.
def test_passage_of_the_balance_has_the_time_of_the_quadrature(slender: Block) -> None:
    alpha = math.atan(0.25)
    p2 = 0.75 * G / (0.5 * math.hypot(0.2, 0.8))
    omega_0 = 1.3 * math.sqrt(2.0 * p2 * (1.0 - math.cos(alpha)))

    def slowness(theta: float) -> float:
        return 1.0 / math.sqrt(omega_0**2 - 2.0 * p2 * (math.cos(alpha - theta) - math.cos(alpha)))

    run = solve(Method1(slender, g=G), omega=-omega_0, t_end=5.0)
    assert run.side == -1
    # Solver tolerance 1e-9 and a single swing: 1e-8 s.
    assert run.overturning_time == pytest.approx(quad(slowness, 0.0, alpha, epsabs=1e-13)[0], abs=1e-8)
    fall = quad(slowness, 0.0, 0.5 * math.pi, epsabs=1e-13)[0]
    assert run.t_end == pytest.approx(fall, abs=1e-8)


def energy(block: Block, theta: Any, omega: Any) -> Any:
    """Energy per mass of a block on its corner: (4/3) R^2 omega^2 / 2 + g R cos(alpha - |theta|)."""
    R = 0.5 * math.hypot(block.b, block.h)
    return (2.0 / 3.0) * R**2 * omega**2 + G * R * np.cos(math.atan(block.b / block.h) - np.abs(theta))


def test_free_rocking_without_loss_keeps_its_energy(slender: Block) -> None:
    run = solve(Method1(slender, restitution=1.0, g=G), theta=0.2, t_end=30.0, rtol=1e-11, atol=1e-14)
    assert len(run.impact_times) > 20
    at_start = energy(slender, 0.2, 0.0)
    swing = at_start - energy(slender, 0.0, 0.0)
    # Some 2,000 steps of relative error 1e-11 add up to less than 1e-7 of the energy of the swing.
    np.testing.assert_allclose(energy(slender, run.theta, run.omega), at_start, rtol=0.0, atol=1e-7 * swing)
    same = Method1(slender, restitution=1.0, g=G, form="linear")
    theta = solve(same, theta=0.2, t_end=30.0).theta
    assert np.abs(theta).max() == pytest.approx(0.2, rel=1e-4)


def test_free_rocking_never_gains_energy(slender: Block) -> None:
    run = solve(Method1(slender, g=G), theta=0.24, t_end=10.0)
    # 1e-9 is the relative tolerance of a step, the energy of order 4 J/kg.
    assert np.all(np.diff(energy(slender, run.theta, run.omega)) < 1e-8)


def test_an_impact_multiplies_omega_by_e_and_passes_the_block_to_the_other_corner(slender: Block) -> None:
    run = solve(Method1(slender, restitution=0.83, g=G), theta=0.2, t_end=1.5)
    struck = run.events.guard == 1
    before, after = run.events.y_before[struck], run.events.y_after[struck]
    assert struck.sum() >= 3
    np.testing.assert_allclose(after[:, 1], 0.83 * before[:, 1], rtol=1e-15)
    np.testing.assert_array_equal(after[:, 0], 0.0)
    # Released leaning to +x, so it lands on the -x corner first, and moves to -x then.
    np.testing.assert_array_equal(run.events.s_after[struck][:3], [-1.0, 1.0, -1.0])
    np.testing.assert_array_equal(np.sign(after[:3, 1]), [-1.0, 1.0, -1.0])


# Housner, small swings: half periods 2 omega/(p^2 sin alpha), geometric with ratio e.  The first swing is shorter than
# a solver's first step, the last ones, below rest_speed = 1e-6 p, are dropped.
@pytest.mark.parametrize("omega", [1e-4, 1e-2])
@pytest.mark.parametrize("solver", ["numba", "scipy"])
def test_impacts_from_a_small_push_follow_the_geometric_series_to_rest(
    slender: Block, solver: str, omega: float
) -> None:
    e, p = 0.8, math.sqrt(0.75 * G / (0.5 * math.hypot(0.2, 0.8)))
    run = solve(Method1(slender, restitution=e, g=G), omega=omega, t_end=0.1, solver=solver)
    half_period = 2.0 * omega / (p**2 * math.sin(math.atan(0.25)))
    count = math.ceil(math.log(1e-6 * p / omega) / math.log(e))  # the first with omega e^n < 1e-6 p
    expected = half_period * (1.0 - e ** np.arange(1, count + 1)) / (1.0 - e)
    assert run.outcome is Outcome.AT_REST
    assert len(run.impact_times) == count
    # The lever arm R sin(alpha - theta) shrinks by theta cot(alpha) over a swing of height omega^2/(2 p^2 sin alpha).
    height = omega**2 / (2.0 * p**2 * math.sin(math.atan(0.25)))
    np.testing.assert_allclose(run.impact_times, expected, rtol=height * 4.0 + 1e-9)
    np.testing.assert_array_equal(run.y[-1], 0.0)


# The limit of the rule for the end of a chatter: the impacts accumulate at `zeno_time`, the sum of the whole geometric
# series.  What is dropped of it is the series from the last impact on, which shrinks as `rest_speed` does.
@pytest.mark.parametrize("solver", ["exact", "taylor", "numba", "scipy"])
@pytest.mark.parametrize("e", [0.5, 0.9])
def test_the_time_of_rest_tends_to_the_accumulation_time_of_the_impacts(slender: Block, solver: str, e: float) -> None:
    p, omega = slender.p(G), 1e-4 * slender.p(G) * slender.alpha
    limit = zeno_time(omega, slender.alpha, p, e)
    for rest_speed in (1e-6, 1e-7, 1e-8):
        system = Method1(slender, form="linear", restitution=e, g=G, rest_speed=rest_speed)
        run = solve(system, omega=omega, t_end=2.0 * limit, solver=solver, rtol=1e-12, atol=1e-18, save_at=())
        assert run.outcome is Outcome.AT_REST
        left = limit - run.impact_times[-1]
        # The speed after the last impact lies between e and 1 times the threshold; swings of finite height take longer
        # than those of the series, by (omega/(p alpha))^2 / 3 = 3e-9 of their time at most.
        most = zeno_time(rest_speed * p, slender.alpha, p, e)
        assert e * most - 1e-8 * limit <= left <= most + 1e-8 * limit
    assert left < 1e-3 * limit


@pytest.mark.parametrize("form", ["nonlinear", "linear"])
@pytest.mark.parametrize("a_z", [3.0, -4.0])
def test_constant_vertical_acceleration_is_another_gravity(slender: Block, window: Any, form: Any, a_z: float) -> None:
    # Newton's law in the frame of the base: g + a_z takes the place of g, nothing else changes.
    push = (0.0, 1.5, 14.0, 0.3)
    with_a_z = window(0.1, 2.0, steady=(0.0, a_z), x=push)
    without = window(0.1, 2.0, x=push)
    one = solve(Method1(slender, form=form, restitution=0.9, g=G), with_a_z, t_end=4.0, theta=0.03)
    other = solve(Method1(slender, form=form, restitution=0.9, g=G + a_z), without, t_end=4.0, theta=0.03)
    assert len(one.impact_times) > 3
    # Two roundings of the same formula: no more than the solver's tolerance over a few impacts.
    np.testing.assert_allclose(one.impact_times[:4], other.impact_times[:4], rtol=0.0, atol=1e-9)
    assert one.outcome is other.outcome


@pytest.mark.parametrize("solver", ["numba", "scipy"])
@pytest.mark.parametrize("form", ["nonlinear", "linear"])
def test_the_mirror_image_moves_as_the_mirror_image_to_the_last_bit(
    slender: Block, window: Any, form: Any, solver: str
) -> None:
    runs = [
        solve(
            Method1(slender, form=form, g=G),
            window(0.05, 3.0, x=(0.0, side * 3.0, 14.0, 0.2), z=(0.0, 2.0, 13.0, 1.0)),
            theta=side * 0.02, omega=-side * 0.1, t_end=5.0, solver=solver,
        )
        for side in (1.0, -1.0)
    ]  # fmt: skip
    assert len(runs[0].impact_times) > 3
    np.testing.assert_array_equal(runs[0].events.t, runs[1].events.t)
    np.testing.assert_array_equal(runs[0].y, -runs[1].y)
    np.testing.assert_array_equal(runs[0].s[runs[0].mode != Mode.REST], -runs[1].s[runs[1].mode != Mode.REST])


# (alpha - theta)^2 - (omega/p)^2 is kept until the first impact.  At the start omega in rad/s is more than any tilt.
@pytest.mark.parametrize("solver", ["numba", "scipy", "diffrax", "exact"])
def test_the_largest_tilt_after_a_push_is_that_of_the_first_integral(solver: str) -> None:
    system = Method1(Block(b=0.2, h=0.8), form="linear", restitution=0.8)
    alpha, p = system.block.alpha, system.block.p(system.g)
    theta, omega = 0.02, 0.4
    crest = alpha - math.sqrt((alpha - theta) ** 2 - (omega / p) ** 2)
    assert theta < crest < omega
    run = solve(system, theta=theta, omega=omega, t_end=1.5, solver=solver)
    assert run.peak_rotation == pytest.approx(crest, abs=1e-7)
