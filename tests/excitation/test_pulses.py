"""Pulses against closed forms of their integrals, published numbers and scaling laws."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from excitation import (
    AntisymmetricRickerPulse,
    GaborPulse,
    HalfSinePulse,
    MavroeidisPapageorgiouPulse,
    OneCosinePulse,
    OneSinePulse,
    RectangularPulse,
    SymmetricRickerPulse,
)

amplitudes = st.floats(0.1, 20.0)
periods = st.floats(0.1, 5.0)


def velocity(motion, start, end):
    """Integral of a_x by SciPy's adaptive quadrature."""
    points = np.linspace(start, end, 41)
    pieces = [quad(lambda t: float(motion(t)[0]), a, b, epsabs=1e-13)[0] for a, b in pairwise(points)]
    return math.fsum(pieces)


def displacement(motion, start, end):
    """Second integral of a_x: the integral of (end - t) a_x(t)."""
    points = np.linspace(start, end, 41)
    pieces = [quad(lambda t: (end - t) * float(motion(t)[0]), a, b, epsabs=1e-13)[0] for a, b in pairwise(points)]
    return math.fsum(pieces)


def test_rectangular_pulse_leaves_amplitude_times_duration():
    pulse = RectangularPulse(3.0, 0.4, start=1.0)
    assert velocity(pulse, 1.0, 1.4) == pytest.approx(1.2, abs=1e-9)
    assert pulse([0.999, 1.0, 1.4, 1.401])[0] == pytest.approx([0.0, 3.0, 3.0, 0.0], abs=0.0)


def test_both_ends_are_in_a_pulse_and_nothing_is_after_its_end():
    for pulse in (OneCosinePulse(2.0, 0.5), RectangularPulse(2.0, 0.5)):
        assert pulse([-1e-9, 0.0, pulse.end, pulse.end + 1e-9])[0] == pytest.approx([0.0, 2.0, 2.0, 0.0], abs=0.0)


@given(amplitudes, periods)
def test_half_sine_leaves_amplitude_times_period_over_pi(a, period):
    pulse = HalfSinePulse(a, period)
    assert velocity(pulse, 0.0, pulse.end) == pytest.approx(a * period / math.pi, rel=1e-9)


def test_one_sine_ends_at_rest_and_displaced():
    pulse = OneSinePulse(2.0, 0.8, start=0.3)
    assert velocity(pulse, 0.3, 1.1) == pytest.approx(0.0, abs=1e-12)
    assert displacement(pulse, 0.3, 1.1) == pytest.approx(2.0 * 0.8**2 / (2 * math.pi), rel=1e-10)


def test_one_cosine_ends_at_rest_where_it_began():
    pulse = OneCosinePulse(2.0, 0.8, start=0.3)
    assert velocity(pulse, 0.3, 1.1) == pytest.approx(0.0, abs=1e-12)
    assert displacement(pulse, 0.3, 1.1) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("kind", [SymmetricRickerPulse, AntisymmetricRickerPulse])
def test_ricker_pulse_reaches_its_amplitude_and_comes_back_to_where_it_began(kind):
    pulse = kind(-3.0, 0.5)
    t = np.linspace(0.0, 2.5, 200001)
    # The grid misses the peak by at most 1e-5 periods: a part in 1e8 of a smooth maximum.
    assert np.max(np.abs(pulse(t)[0])) == pytest.approx(3.0, rel=1e-7)
    assert velocity(pulse, 0.0, 2.5) == pytest.approx(0.0, abs=1e-12)
    assert displacement(pulse, 0.0, 2.5) == pytest.approx(0.0, abs=1e-12)
    assert abs(pulse(0.0)[0]) < 1e-15 * 3.0


@pytest.mark.parametrize("kind", [SymmetricRickerPulse, AntisymmetricRickerPulse])
def test_spectrum_of_a_ricker_pulse_peaks_at_its_frequency(kind):
    """Ricker (1943): T_p is the period at which the Fourier amplitude of the wavelet is largest."""
    dt, period = 0.002, 0.5
    a = kind(1.0, period)(np.arange(0.0, 2.5, dt))[0]
    spectrum = np.abs(np.fft.rfft(a, 2**17))
    assert np.fft.rfftfreq(2**17, dt)[np.argmax(spectrum)] == pytest.approx(1.0 / period, abs=1.0 / (2**17 * dt))


def test_antisymmetric_ricker_has_the_published_factor():
    """Vassiliou & Makris (2011) print beta = 1.38; in their form a_x = (a_p/beta)(x^2 - 3) x exp(-x^2/2)."""
    from excitation.pulse_antisymmetric_ricker import BETA

    assert pytest.approx(1.38, abs=0.005) == BETA
    x = 0.9
    pulse = AntisymmetricRickerPulse(1.0, 2 * math.pi, centre=0.0)
    assert pulse(x * math.sqrt(3.0))[0] == pytest.approx((x**2 - 3) * x * math.exp(-(x**2) / 2) / 1.38, rel=1e-3)


@settings(max_examples=30)
@given(st.floats(0.2, 3.0), st.floats(0.2, 4.0), st.floats(1.05, 4.0), st.floats(-3.2, 3.2))
def test_mavroeidis_papageorgiou_velocity_is_the_integral_of_its_acceleration(v, f, gamma, nu):
    pulse = MavroeidisPapageorgiouPulse(v, f, gamma, nu)
    for share in (0.21, 0.5, 0.83, 1.0):
        t = share * 2 * pulse.half_length
        assert velocity(pulse, 0.0, t) == pytest.approx(pulse.base_velocity(t), abs=1e-9 * v)


def test_mavroeidis_papageorgiou_peaks_at_its_velocity_when_symmetric():
    """nu = 0: both cosines are 1 in the middle, so v = A there (eq. 3 of the paper)."""
    pulse = MavroeidisPapageorgiouPulse(0.8, 1.5, 2.0)
    assert pulse.base_velocity(pulse.middle) == pytest.approx(0.8, rel=1e-15)
    assert pulse([pulse.breakpoints[0] - 0.01, pulse.breakpoints[1] + 0.01])[0] == pytest.approx([0.0, 0.0], abs=0.0)


@settings(max_examples=30)
@given(st.floats(0.2, 3.0), st.floats(0.2, 4.0), st.floats(0.5, 3.0), st.floats(-3.2, 3.2))
def test_gabor_velocity_is_the_integral_of_its_acceleration(v, f, gamma, nu):
    pulse = GaborPulse(v, f, gamma, nu)
    for share in (0.3, 0.5, 0.61):
        t = share * 2 * pulse.middle
        assert velocity(pulse, 0.0, t) == pytest.approx(pulse.base_velocity(t), abs=1e-9 * v)


@given(amplitudes, st.floats(0.2, 5.0), st.sampled_from([OneSinePulse, OneCosinePulse, SymmetricRickerPulse]))
def test_pulses_scale_with_amplitude_and_period(a, factor, kind):
    share = np.linspace(0.01, 0.99, 37)
    one = kind(1.0, 0.7)(share * 0.7)[0]
    assert kind(a, 0.7 * factor)(share * 0.7 * factor)[0] == pytest.approx(a * one, rel=1e-9, abs=1e-12 * a)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: OneSinePulse(0.0, 1.0), r"amplitude=0\.0 m/s\^2: want a finite number other than zero"),
        (lambda: OneCosinePulse(1.0, -1.0), r"period=-1\.0 s: want a positive number"),
        (lambda: HalfSinePulse(1.0, 1.0, start=math.nan), "start=nan s"),
        (lambda: RectangularPulse(math.inf, 1.0), r"amplitude=inf m/s\^2"),
        (lambda: RectangularPulse(1.0, 0.0), r"duration=0\.0 s"),
        (lambda: SymmetricRickerPulse(1.0, 1.0, centre=math.inf), "centre=inf s"),
        (lambda: MavroeidisPapageorgiouPulse(1.0, 1.0, 1.0), r"gamma=1\.0: want a number above 1"),
        (lambda: GaborPulse(1.0, 1.0, 0.0), r"gamma=0\.0 1: want a positive number"),
    ],
)
def test_bad_argument_is_named_with_its_value(make, message):
    with pytest.raises(ValueError, match=message):
        make()
