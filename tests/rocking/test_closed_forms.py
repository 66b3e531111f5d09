"""Closed forms against integrations written out here and against published numbers."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from excitation import HalfSinePulse, OneCosinePulse, OneSinePulse, RectangularPulse, SteadySinusoid
from rocking import Block, Method1, Method2, solve, solve_batch
from rocking import closed_forms as cf
from rocking.pulse_overturning import one_impact_band

G = 9.81
BLOCK = Block(0.2, 0.8)

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


# Of a pulse so long that its end says nothing, exp(-p t) = 0, the path to unstable balance is k + l = 0 from where the
# block begins to rock, A sin psi = 1: ratio A cos psi = ratio^2, so that A^2 = 1 + ratio^2.
@pytest.mark.parametrize("ratio", [0.05, 1e-3, 1e-5, 1e-8])
@pytest.mark.parametrize("pulse", [cf.half_sine_pulse, cf.full_sine_pulse])
def test_a_pulse_without_end_has_the_amplitude_at_which_it_may_begin(pulse, ratio):
    assert pulse(ratio) == pytest.approx(math.sqrt(1.0 + ratio**2), rel=3e-13)


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


def falls(pulse, ratio, A, e=0.9):
    """How a run of the linear Method 1 under one pulse of A g alpha ends: (impacts before the fall or None, side).

    The pulse's period is that of the closed forms: omega = ratio p, or its duration ratio/p if it is rectangular.
    """
    p = BLOCK.p(G)
    period = ratio / p if pulse is RectangularPulse else 2.0 * math.pi / (ratio * p)
    system = Method1(BLOCK, form="linear", onset="linear", restitution=e, g=G)
    # Within 1e-6 of the limit a block takes ln(1e6)/p longer; thirty of 1/p are enough for it to fall or come back.
    run = solve(system, pulse(A * G * BLOCK.alpha, period), t_end=period + 30.0 / p, rtol=1e-12, atol=1e-15, save_at=())
    return (len(run.impact_times), run.side) if run.overturned else None


@pytest.mark.parametrize("ratio", [0.7, 2.0, 5.0])
@pytest.mark.parametrize(
    ("pulse", "limit"),
    [
        (RectangularPulse, lambda ratio: cf.rectangular_pulse(ratio / BLOCK.p(G), BLOCK.p(G))),
        (HalfSinePulse, cf.half_sine_pulse),
        (OneSinePulse, cf.full_sine_pulse),
        (OneCosinePulse, cf.full_cosine_pulse),
    ],
)
def test_a_run_falls_without_an_impact_from_the_closed_amplitude_on(pulse, limit, ratio):
    # A base that accelerates to +x tips the block to -x.
    assert falls(pulse, ratio, limit(ratio) * (1.0 + 1e-7)) == (0, -1)
    below = falls(pulse, ratio, limit(ratio) * (1.0 - 1e-7))
    assert below is None or below[0] > 0


@pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0, 4.0, 8.0])
def test_full_cosine_pulse_is_the_threshold_of_the_equation(ratio):
    """x'' = x - 1 + A cos(ratio tau) over one cycle, written out; free then: x + x' > 1 falls."""
    A = cf.full_cosine_pulse(ratio)
    for beyond in (1e-7, -1e-7):
        run = solve_ivp(
            lambda tau, y, A=A * (1.0 + beyond): [y[1], y[0] - 1.0 + A * math.cos(ratio * tau)],
            (0.0, 2.0 * math.pi / ratio), [0.0, 0.0], "DOP853", rtol=1e-12, atol=1e-14, dense_output=True,
        )  # fmt: skip
        assert (run.y[:, -1].sum() > 1.0) == (beyond > 0.0)
        assert run.sol(np.linspace(1e-3, run.t[-1], 2000))[0].min() > 0.0  # no impact on the way


# Both ends of the band after one impact.  The upper one of a sine at ratio 2 and 3 is of impacts after the pulse.
@pytest.mark.parametrize("e", [0.75, 0.9])
@pytest.mark.parametrize(
    ("pulse", "motion", "ratio"),
    [("sine", OneSinePulse, 1.0), ("sine", OneSinePulse, 2.0), ("sine", OneSinePulse, 3.0),
     ("cosine", OneCosinePulse, 2.0), ("cosine", OneCosinePulse, 3.0)],
)  # fmt: skip
def test_a_run_falls_after_one_impact_within_the_band_and_not_outside(pulse, motion, ratio, e):
    band = one_impact_band(ratio, e, pulse)
    assert band is not None
    for edge, inward in ((band.low, 1e-7), (band.high, -1e-7)):
        assert falls(motion, ratio, edge * (1.0 + inward), e) == (1, 1)
        assert falls(motion, ratio, edge * (1.0 - inward), e) in (None, (2, -1), (3, 1))


# Above the band no run falls after one impact; of cosines of ratio 1 to 1.5 some do after two, of sines none.
@pytest.mark.parametrize(
    ("pulse", "motion", "ratio", "e", "some"),
    [("cosine", OneCosinePulse, 1.0, 0.9, True), ("cosine", OneCosinePulse, 1.268, 0.9, True),
     ("sine", OneSinePulse, 3.0, 0.9, False)],
)  # fmt: skip
def test_above_the_band_a_run_falls_after_two_impacts_if_at_all(pulse, motion, ratio, e, some):
    top = cf.full_cosine_pulse(ratio) if pulse == "cosine" else cf.full_sine_pulse(ratio)
    period = 2.0 * math.pi / (ratio * BLOCK.p(G))
    system = Method1(BLOCK, form="linear", onset="linear", restitution=e, g=G)
    amplitudes = np.linspace(one_impact_band(ratio, e, pulse).high * 1.0005, top * 0.9995, 20)
    runs = solve_batch(system, [motion(A * G * BLOCK.alpha, period) for A in amplitudes], t_end=period + 6.0)
    assert runs.overturned.any() == some
    assert np.all(runs.impacts[runs.overturned] >= 2)


# Where the closed form finds no band, runs at 300 amplitudes below that of overturning without an impact stay up.
@pytest.mark.parametrize(
    ("pulse", "motion", "ratio", "e", "top"),
    [("sine", OneSinePulse, 8.0, 0.9, 14.87), ("sine", OneSinePulse, 4.0, 0.75, 5.238),
     ("cosine", OneCosinePulse, 5.0, 0.9, 36.3)],
)  # fmt: skip
def test_a_fast_pulse_or_a_lossy_impact_leaves_no_band(pulse, motion, ratio, e, top):
    assert one_impact_band(ratio, e, pulse) is None
    period = 2.0 * math.pi / (ratio * BLOCK.p(G))
    system = Method1(BLOCK, form="linear", onset="linear", restitution=e, g=G)
    motions = [motion(A * G * BLOCK.alpha, period) for A in np.linspace(1.001, top, 300)]
    assert not solve_batch(system, motions, t_end=period + 30.0 / BLOCK.p(G)).overturned.any()


def test_the_band_widens_with_the_restitution():
    bands = [one_impact_band(3.0, e) for e in (0.8, 0.85, 0.9, 0.95)]
    for narrow, wide in pairwise(bands):
        assert wide.low < narrow.low
        assert narrow.high < wide.high


# Ishiyama (1982): what overturns had at least (b/h) g and his velocity.  Trains of one to ten cycles of a sine at 0.3
# to 6 Hz; their peak velocity, from rest, is 2 a/omega.  Slow ones come near the first limit; the second is far off.
@pytest.mark.parametrize("cycles", [1, 10])
@pytest.mark.parametrize("system", [Method1(Block(0.15, 0.6), g=G), Method2(Block(0.15, 0.6), friction=0.4, g=G)])
def test_no_sine_train_overturns_below_ishiyamas_limits(system, cycles):
    frequency, amplitude = (
        axis.ravel() for axis in np.meshgrid(np.geomspace(0.3, 6.0, 16), 0.25 * G * np.geomspace(1.0, 10.0, 40))
    )
    trains = [SteadySinusoid(f, a, cycles / f) for f, a in zip(frequency, amplitude, strict=True)]
    fell = solve_batch(system, trains, t_end=cycles / 0.3 + 4.0).overturned
    assert 300 < fell.sum() < 600
    acceleration = amplitude[fell] / cf.west_acceleration(0.15, 0.6, g=G)
    velocity = amplitude[fell] / (math.pi * frequency[fell]) / cf.ishiyama_velocity(Block(0.15, 0.6), G)
    assert 1.0 < acceleration.min() < 1.1
    assert 1.0 < velocity.min() < 3.0


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
        (lambda: cf.half_sine_pulse(1e160), r"frequency ratio=1e\+160: want at most 1e\+06"),
        (lambda: cf.full_cosine_pulse(1e160), r"frequency ratio=1e\+160: want at most 1e\+06"),
        (lambda: cf.full_cosine_pulse(-1.0), r"frequency ratio=-1\.0 1"),
        (lambda: one_impact_band(0.1, 0.9), r"ratio=0\.1: want 0\.2 to inf"),
        (lambda: one_impact_band(2.0, 1.1), r"e=1\.1: want 0 to 1"),
        (lambda: one_impact_band(7.228, 0.0, "cosine"), r"e=0\.0: want more than 0"),
        (lambda: one_impact_band(2.0, 0.9, "square"), r"pulse='square': want 'sine' or 'cosine'"),
    ],
)
def test_bad_argument_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
