"""Closed forms against integrations written out here and against published numbers."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rocking import Block
from rocking import closed_forms as cf

# A = a_peak / (g alpha) for omega/p = 1, 2, 4, 8: obtained by integrating the linear equation with located onset
# (DOP853, 1e-12) and bisecting on the amplitude, independently of the formula; five digits kept.
HALF_SINE = {1.0: 1.32240, 2.0: 1.80072, 4.0: 2.79080, 8.0: 4.78707}
FULL_SINE = {1.0: 1.41832, 2.0: 2.34990, 4.0: 5.23896, 8.0: 14.87135}


def overturns_under_sine(A, ratio, half_cycles):
    """x'' = x - 1 + A sin(ratio tau + psi) from A sin(psi) = 1 to the end of the pulse, then free: x + x' > 1 falls."""
    psi = math.asin(1.0 / A)
    end = (half_cycles * math.pi - psi) / ratio

    def slope(tau, y):
        return [y[1], y[0] - 1.0 + A * math.sin(ratio * tau + psi)]

    x, v = solve_ivp(slope, (0.0, end), [0.0, 0.0], "DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
    return x + v > 1.0


@pytest.mark.parametrize(("ratio", "published"), HALF_SINE.items())
def test_half_sine_pulse_is_the_published_number_and_the_threshold_of_the_equation(ratio, published):
    A = cf.half_sine_pulse(ratio)
    assert pytest.approx(published, abs=6e-6) == A
    assert overturns_under_sine(A * (1 + 1e-7), ratio, 1)
    assert not overturns_under_sine(A * (1 - 1e-7), ratio, 1)


@pytest.mark.parametrize(("ratio", "published"), FULL_SINE.items())
def test_full_sine_pulse_is_the_published_number_and_the_threshold_of_the_equation(ratio, published):
    A = cf.full_sine_pulse(ratio)
    assert pytest.approx(published, abs=6e-6) == A
    assert overturns_under_sine(A * (1 + 1e-7), ratio, 2)
    assert not overturns_under_sine(A * (1 - 1e-7), ratio, 2)


@pytest.mark.parametrize("ratio", [0.01, 0.3, 30.0, 300.0])
def test_sine_pulses_keep_their_limits(ratio):
    # A slow pulse acts like a steady push (A -> 1), and a fast half-sine like an impulse: A (2 / ratio) = 1 in x'.
    A = cf.half_sine_pulse(ratio)
    assert A > 1.0
    if ratio < 0.1:
        assert pytest.approx(1.0, abs=1e-3) == A
    if ratio > 100.0:
        assert A * 2.0 / ratio == pytest.approx(1.0, abs=0.02)


def test_rectangular_pulse_matches_housner_as_corrected():
    # exp(p t) = A / (A - 1): A = 1.5, 2, 3 give p t = ln 3, ln 2, ln 1.5.
    for A, pt in ((1.5, math.log(3.0)), (2.0, math.log(2.0)), (3.0, math.log(1.5))):
        assert cf.rectangular_pulse(pt / 2.7, 2.7) == pytest.approx(A, rel=1e-14)


def test_free_rocking_matches_the_integrated_linear_equation():
    """Impacts and peaks of theta'' = -p^2 (s alpha - theta), omega -> e omega, by SciPy events."""
    theta0, alpha, p, e = 0.15, 0.25, 3.3, 0.88
    t, y, s = 0.0, [theta0, 0.0], 1.0
    for n in range(1, 7):

        def landed(_, y):
            return y[0]

        landed.terminal, landed.direction = True, -s
        run = solve_ivp(
            lambda _, y, s=s: [y[1], -p * p * (s * alpha - y[0])], (t, t + 5.0), y, "DOP853", events=landed,
            rtol=1e-11, atol=1e-13, dense_output=True,
        )  # fmt: skip
        if n > 1:
            fine = np.abs(run.sol(np.linspace(t, run.t[-1], 20001))[0])
            assert fine.max() == pytest.approx(cf.free_peak(theta0, alpha, e, n - 1), rel=1e-7)
        t, y, s = run.t[-1], [0.0, e * run.y[1, -1]], -s
        assert t == pytest.approx(cf.free_impact_time(theta0, alpha, p, e, n), abs=1e-8)


def test_zeno_time_is_the_sum_of_the_remaining_swings_when_they_are_small():
    alpha, p, e, omega = 0.25, 3.3, 0.88, 1e-4
    # A swing that starts with omega peaks at alpha (1 - sqrt(1 - (omega / p alpha)^2)); its time by the exact formula.
    total = 0.0
    for n in range(400):
        peak = alpha * (1.0 - math.sqrt(1.0 - (omega * e**n / (p * alpha)) ** 2))
        total += 2.0 * cf.quarter_period(peak, alpha, p)
    # Small against alpha p: the share (omega / p alpha)^2 ~ 1e-8 is neglected; acosh near 1 loses digits beyond 1e-5.
    assert cf.zeno_time(omega, alpha, p, e) == pytest.approx(total, rel=1e-4)


def test_ishiyama_velocity_tends_to_his_rule_of_thumb_for_slender_blocks():
    # Ishiyama (1982): about 10 b / sqrt(h) in cm/s with b and h in cm, that is 1.0 b / sqrt(h) in SI.  Expanded for
    # small b/h his formula is 0.4 sqrt(2 g / 3) b / sqrt(h) (1 + O(b/h)^2), a factor of 1.023 at g = 9.81.
    for b, h in ((0.01, 1.0), (0.02, 4.0)):
        assert cf.ishiyama_velocity(Block(b, h), 9.81) == pytest.approx(1.023 * b / math.sqrt(h), rel=1e-3)


def test_west_acceleration():
    assert cf.west_acceleration(0.3, 1.0, g=9.81) == pytest.approx(2.943, rel=1e-12)
    assert cf.west_acceleration(0.3, 1.0, a_z=-4.905, g=9.81) == pytest.approx(1.4715, rel=1e-12)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: cf.west_acceleration(-1.0, 1.0), r"b=-1\.0 m: want a positive number"),
        (lambda: cf.west_acceleration(0.3, 1.0, a_z=-10.0), r"g \+ a_z="),
        (lambda: cf.quarter_period(0.3, 0.3, 3.0), r"theta0=0\.3 rad: want 0 to below alpha=0\.3"),
        (lambda: cf.free_peak(0.1, 0.3, 1.2, 1), r"e=1\.2: want 0 to 1"),
        (lambda: cf.free_peak(0.1, 0.3, 0.9, -1), r"n=-1: want 0 or more impacts"),
        (lambda: cf.free_impact_time(0.1, 0.3, 3.0, 0.9, 0), r"n=0: want impact 1"),
        (lambda: cf.zeno_time(1e-3, 0.3, 3.0, 1.0), r"e=1\.0: want 0 to below 1"),
        (lambda: cf.rectangular_pulse(0.0, 3.0), r"duration=0\.0 s"),
        (lambda: cf.half_sine_pulse(math.nan), r"frequency ratio=nan 1"),
    ],
)
def test_bad_argument_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
