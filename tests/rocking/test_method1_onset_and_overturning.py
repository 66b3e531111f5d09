"""Method 1 under pulses: where rest ends, and the smallest pulses that overturn."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from rocking import Block, Method1, Mode, Outcome, scalars, solve
from rocking.hybrid import Base, Discrete

G = 9.81
B, H = 0.2, 0.8
ALPHA = math.atan(B / H)
P = math.sqrt(0.75 * G / (0.5 * math.hypot(B, H)))


def bisected(falls: Callable[[float], bool], low: float, high: float, width: float) -> float:
    """Middle of an interval of that width in which `falls` turns true."""
    assert not falls(low)
    assert falls(high)
    while high - low > width:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if falls(middle) else (middle, high)
    return 0.5 * (low + high)


def falls_at_once(system: Method1, motion: Any, pulse_end: float) -> bool:
    """Whether the block overturns before any impact.

    Close to the threshold the tilt leaves the balance as exp(p t): thirty time constants show 1e-11.
    """
    run = solve(system, motion, t_end=pulse_end + 40.0 / P, save_at=[], rtol=1e-11, atol=1e-15)
    return run.overturned and len(run.impact_times) == 0


@pytest.fixture(scope="module")
def linear(slender: Block) -> Method1:
    """The linear block, which leaves rest at alpha (g + a_z) as its equations do."""
    return Method1(slender, form="linear", onset="linear", g=G)


# Printed: exp(p t1) = A/(A - 1).  Own derivation as a check of the source: the linear block just reaches its balance
# when the share of the push that grows as exp(p t) cancels that of gravity, p int A exp(-p t) dt = 1 over the pulse.
@pytest.mark.parametrize(("A", "printed"), [(1.5, 1.0986), (2.0, 0.6931), (3.0, 0.4055)])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_rectangular_pulse_overturns_from_exp_p_t1_equal_A_over_A_minus_1(
    linear: Method1, window: Any, A: float, printed: float, side: float
) -> None:
    def falls(pt: float) -> bool:
        return falls_at_once(linear, window(0.0, pt / P, x=(side * A * G * ALPHA, 0.0, 0.0, 0.0)), pt / P)

    found = bisected(falls, 0.9 * printed, 1.1 * printed, 1e-9)
    assert math.log(A / (A - 1.0)) == pytest.approx(printed, abs=5.1e-5)  # four decimals as printed
    # Bisected to 1e-9, integrated to 1e-11 per step: 1e-8.
    assert found == pytest.approx(math.log(A / (A - 1.0)), abs=1e-8)


def least_sine(ratio: float, half_periods: int) -> float:
    """Least A = a_peak/(g alpha) of a sine of that many half periods that overturns the linear block without an impact.

    From the onset t0, A sin(omega t0) = 1: p int A sin(omega t) exp(-p (t - t0)) dt = 1 over the rest of the pulse.
    """

    def excess(A: float) -> float:
        start = math.asin(1.0 / A) / ratio  # in units of 1/p
        stop = half_periods * math.pi / ratio
        return quad(lambda t: A * math.sin(ratio * t) * math.exp(start - t), start, stop, epsabs=1e-13)[0] - 1.0

    return brentq(excess, 1.0 + 1e-9, 100.0, xtol=1e-13)


# Numbers printed to five decimals; the first of the full sine to three (its printed fifth decimal is not claimed).
@pytest.mark.parametrize(
    ("half_periods", "ratio", "printed", "digits"),
    [
        (1, 1.0, 1.32240, 5.1e-6),
        (1, 2.0, 1.80072, 5.1e-6),
        (1, 4.0, 2.79080, 5.1e-6),
        (1, 8.0, 4.78707, 5.1e-6),
        (2, 1.0, 1.41832, 5.1e-4),
        (2, 2.0, 2.34990, 5.1e-6),
        (2, 4.0, 5.23896, 5.1e-6),
        (2, 8.0, 14.87135, 5.1e-6),
    ],
)
def test_half_and_full_sines_overturn_from_the_printed_amplitudes(
    linear: Method1, sine_pulse: Any, half_periods: int, ratio: float, printed: float, digits: float
) -> None:
    duration = half_periods * math.pi / (ratio * P)

    def falls(A: float) -> bool:
        return falls_at_once(linear, sine_pulse(A * G * ALPHA, ratio * P, duration), duration)

    found = bisected(falls, 0.97 * printed, 1.03 * printed, 1e-8)
    assert found == pytest.approx(printed, abs=digits)
    # Bisected to 1e-8; the onset is located where the amplitude is read off, and costs as much again.
    assert found == pytest.approx(least_sine(ratio, half_periods), abs=1e-7)


# First overturning amplitudes of one cycle of sine for the nonlinear block of 0.2 x 0.8 m, printed to four digits by a
# solver with located events; two engines with contacts agree within 1 per cent.
@pytest.mark.parametrize(("frequency", "printed"), [(1.0, 2.869), (2.0, 3.419), (3.0, 5.243)])
def test_one_cycle_of_sine_first_overturns_at_the_printed_amplitude(
    slender: Block, sine_pulse: Any, frequency: float, printed: float
) -> None:
    system = Method1(slender, g=G)

    def falls(amplitude: float) -> bool:
        motion = sine_pulse(amplitude, 2.0 * math.pi * frequency, 1.0 / frequency)
        return solve(system, motion, t_end=12.0, save_at=[]).overturned

    below = np.arange(G * B / H, printed - 6e-4, 0.02)
    assert not any(falls(float(a)) for a in below), "it overturns at a smaller amplitude already"
    assert bisected(falls, printed - 0.01, printed + 0.01, 1e-5) == pytest.approx(printed, abs=5.1e-4)


# West's formula, eq. (1) of Winkler, Meguro & Yamazaki (1995): |a_x| = (b/h)(g + a_z); for the linear option alpha.
@pytest.mark.parametrize("a_z", [0.0, 2.0, -3.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("form", "onset", "slope"), [
    ("nonlinear", "west", B / H), ("linear", "west", B / H), ("linear", "linear", ALPHA),
])  # fmt: skip
def test_rocking_starts_where_the_push_reaches_the_onset(
    slender: Block, window: Any, form: Any, onset: Any, slope: float, side: float, a_z: float
) -> None:
    # a_x = 5 sin(0.2 t) grows past the onset once; vertical acceleration constant.
    motion = window(0.0, 5.0, steady=(0.0, a_z), x=(0.0, side * 5.0, 0.2, 0.0))
    run = solve(Method1(slender, form=form, onset=onset, g=G), motion, t_end=5.0)
    # Solver tolerance: the guard crosses zero with 1 m/s^3 and is located to a rounding or two.
    assert run.onset_time == pytest.approx(math.asin(slope * (G + a_z) / 5.0) / 0.2, abs=1e-9)
    # The base pushes towards +x and the block turns back over its -x corner.
    first = np.flatnonzero(run.mode == Mode.ROTATION)[5]
    assert np.sign(run.theta[first]) == -side
    assert run.s[first] == -side


@pytest.mark.parametrize("solver", ["numba", "scipy"])
def test_a_push_just_below_the_onset_leaves_the_block_at_rest(slender: Block, constant: Any, solver: str) -> None:
    onset = B / H * G
    below = solve(Method1(slender, g=G), constant(onset * (1.0 - 1e-12)), t_end=3.0, solver=solver)
    assert below.outcome is Outcome.AT_REST
    assert len(below.events) == 0
    assert math.isnan(below.onset_time)
    above = solve(Method1(slender, g=G), constant(-onset * (1.0 + 1e-6)), t_end=20.0, solver=solver)
    assert (above.onset_time, above.side) == (0.0, 1)


# In a block at rest the base may stay below the onset horizontally and yet pull the floor away: with a_z the onset
# falls to (b/h)(g + a_z), which a vertical sine a_z = -6 sin(t) carries down to a steady push.
def test_a_falling_floor_lets_a_steady_push_start_the_rocking(slender: Block, window: Any) -> None:
    push = 1.5
    motion = window(0.0, 3.0, steady=(push, 0.0), z=(0.0, -6.0, 1.0, 0.0))
    run = solve(Method1(slender, g=G), motion, t_end=3.0)
    assert run.onset_time == pytest.approx(math.asin((G - push * H / B) / 6.0), abs=1e-9)


# Eq. (1) again: what is left of the geometric series is dropped only where the block may stand, |a_x| <= (b/h) g.
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("share", "mode"), [(0.99, Mode.REST), (1.01, Mode.ROTATION)])
def test_a_slow_impact_is_the_last_only_where_the_push_lets_the_block_stand(
    slender: Block, side: float, share: float, mode: Mode
) -> None:
    system = Method1(slender, g=G)
    base = Base(side * share * B / H * G, 0.0)
    omega = 1e-7 * P  # below rest_speed = 1e-6 p
    (_, omega_after), q = system.jump(
        scalars, (0.0, -omega), Discrete(int(Mode.ROTATION), 1.0, 1.0), base, system.parameters, 1
    )
    assert q.mode == mode
    assert omega_after == (0.0 if mode == Mode.REST else pytest.approx(-omega * (1.0 - 1.5 / 17.0), rel=1e-12))
