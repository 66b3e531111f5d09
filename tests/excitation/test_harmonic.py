"""Steady sinusoids, chirps, and the hold and taper of a ramp, against closed forms and SciPy."""

import math

import numpy as np
import pytest
from scipy.signal import chirp as scipy_chirp
from scipy.signal.windows import tukey

from excitation import Chirp, RampedSinusoid, SinusoidalPitch, SteadySinusoid

T = np.linspace(0.0, 8.0, 4001)


def test_steady_sinusoid_is_a_sine_under_scipys_tukey_window():
    motion = SteadySinusoid(1.5, 3.0, 8.0, phase=0.7, taper_in=2.0, taper_out=2.0)
    expected = 3.0 * tukey(T.size, 0.5) * np.sin(2 * np.pi * 1.5 * T + 0.7)
    assert motion(T)[0] == pytest.approx(expected, abs=1e-12)
    assert motion([-0.1, 8.1])[0] == pytest.approx([0.0, 0.0], abs=0.0)


@pytest.mark.parametrize("sweep", ["linear", "logarithmic"])
@pytest.mark.parametrize("band", [(0.5, 6.0), (7.0, 1.0)])
def test_chirp_is_scipys(sweep, band):
    motion = Chirp(*band, 2.0, 8.0, sweep=sweep, phase=math.pi / 2)
    assert motion(T)[0] == pytest.approx(2.0 * scipy_chirp(T, band[0], 8.0, band[1], method=sweep), abs=1e-10)


@pytest.mark.parametrize("share", [1.0, 0.2, 0.01, 1e-6, -1e-9, 1e-12, 1e-15])
def test_a_logarithmic_chirp_keeps_its_frequency_where_the_ends_are_nearly_equal(share):
    """Phase 2 pi f_0 T (exp(x t/T) - 1)/x with x = log(f_1/f_0), by NumPy's expm1 and log1p; 3000 rad to rounding."""
    f_0, f_1, end = 5.0, 5.0 * (1.0 + share), 90.0
    x, t = np.log1p((f_1 - f_0) / f_0), np.linspace(0.0, end, 9001)
    expected = np.sin(2 * np.pi * f_0 * end / x * np.expm1(x * t / end))
    assert Chirp(f_0, f_1, 1.0, end, sweep="logarithmic")(t)[0] == pytest.approx(expected, abs=1e-11)


def test_tapers_that_fit_exactly_are_taken():
    """0.1 + 0.2 is 0.30000000000000004 and 0.3 - 0.2 is 0.09999999999999998 for a computer."""
    for motion in (
        SteadySinusoid(1.0, 1.0, 0.3, taper_in=0.1, taper_out=0.2),
        Chirp(1.0, 2.0, 1.0, 0.3, taper_in=0.1, taper_out=0.2),
        SinusoidalPitch(1.0, 1.0, 0.3, taper_in=0.1, taper_out=0.2),
    ):
        assert motion.breakpoints == (0.0, 0.1, 0.3)
    # Half a cosine wave up, half of one down: the middles of both are at a half.
    a_x = SteadySinusoid(1.0, 1.0, 0.3, phase=0.0, taper_in=0.1, taper_out=0.2)([0.05, 0.1, 0.2])[0]
    assert a_x == pytest.approx([0.5, 1.0, 0.5] * np.sin(2 * np.pi * np.array([0.05, 0.1, 0.2])), abs=1e-12)


def test_a_linear_chirp_between_equal_frequencies_is_a_sine():
    t = T[1:-1]
    assert Chirp(2.0, 2.0, 1.0, 8.0)(t)[0] == pytest.approx(np.sin(4 * np.pi * t), abs=1e-11)


def test_amplitude_is_held_after_the_ramp_and_fades_out_over_the_taper():
    motion = RampedSinusoid(2.0, 4.0, 6.0, hold=3.0, taper=2.0)
    # Ramp to 6 in 4 s, 6 until 7 s, half way down at 8 s, nothing from 9 s on.
    assert motion.envelope([2.0, 4.0, 5.5, 7.0, 8.0, 9.0, 9.1]) == pytest.approx([3, 6, 6, 6, 3, 0, 0], abs=1e-12)
    assert motion.breakpoints == (0.0, 4.0, 7.0, 9.0)
    assert motion.end == 9.0


def test_departure_of_the_envelope_goes_on_through_the_hold():
    motion = RampedSinusoid(2.0, 4.0, 6.0, hold=40.0, imperfection=0.1, seed=2)
    r = (
        motion.envelope(np.linspace(0.001, 44.0, 9001)) / (6.0 * np.minimum(np.linspace(0.001, 44.0, 9001) / 4.0, 1.0))
        - 1
    )
    # 1 % is the difference of the means on two grids.
    assert math.sqrt(np.mean(r**2)) == pytest.approx(0.1, rel=0.01)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: SteadySinusoid(0.0, 1.0, 1.0), r"frequency=0\.0 Hz"),
        (lambda: SteadySinusoid(1.0, 0.0, 1.0), r"amplitude=0\.0 m/s\^2"),
        (lambda: SteadySinusoid(1.0, 1.0, 1.0, taper_in=0.6, taper_out=0.6), r"taper_in \+ taper_out=1\.2 s"),
        (lambda: SteadySinusoid(1.0, 1.0, 1.0, taper_in=-0.6), r"taper_in=-0\.6 s: want zero or more"),
        (lambda: Chirp(1.0, -2.0, 1.0, 1.0), r"end_frequency=-2\.0 Hz"),
        (lambda: Chirp(1.0, 2.0, 1.0, 1.0, sweep="quadratic"), "sweep='quadratic': want one of linear, logarithmic"),
        (lambda: Chirp(1.0, 1.0, 1.0, 1.0, sweep="logarithmic"), r"end_frequency=1\.0 Hz: want another one"),
        (lambda: RampedSinusoid(1.0, 1.0, 1.0, hold=-1.0), r"hold=-1\.0 s"),
        (lambda: RampedSinusoid(1.0, 1.0, 1.0, taper=math.inf), "taper=inf s"),
    ],
)
def test_bad_argument_is_named_with_its_value(make, message):
    with pytest.raises(ValueError, match=message):
        make()
