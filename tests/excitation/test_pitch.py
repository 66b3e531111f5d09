"""Pitch of its own for formulas: the acceleration is the second derivative, the angle and its rate do not jump."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import excitation as ex

NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)
PITCHING = [
    "sinusoidal pitch", "growing pitch", "pitch by one sine", "pitch by one cosine", "pitch by a symmetric Ricker",
    "pitch by an antisymmetric Ricker", "pitch by Mavroeidis-Papageorgiou", "pitch by Gabor", "pitch by a steady sine",
    "pitch by a chirp", "pitch by a logarithmic chirp", "combined, pitching", "combined, three",
]  # fmt: skip


def second_difference(motion, t, h):
    """theta(t + h) - 2 theta(t) + theta(t - h), from the pitch and from the integral of (h - |s|) theta''(t + s) ds."""
    s = 0.5 * h * (NODES + 1.0)
    integral = sum(0.5 * h * np.sum(WEIGHTS * (h - s) * motion.pitch(t + side * s)[1]) for side in (-1.0, 1.0))
    angles = motion.pitch([t - h, t, t + h])[0]
    return angles[2] - 2.0 * angles[1] + angles[0], integral


@pytest.mark.parametrize("name", PITCHING)
def test_pitch_acceleration_is_the_second_derivative_and_nothing_jumps(motions, name):
    """At breakpoints too, where a jump of angle or rate would leave a difference; Gauss of 24 points is exact to
    rounding over a fraction of a period."""
    motion = motions[name]
    assert motion.has_pitch
    t = np.concatenate([motion.breakpoints, np.random.default_rng(1).uniform(-0.3, 6.5, 60)])
    peak = np.max(np.abs(motion.pitch(np.linspace(-0.5, 7.0, 4001))[0]))
    for middle in t:
        # No other breakpoint within the span, so that the integrand is smooth on either side.
        apart = [abs(b - middle) for b in motion.breakpoints if b != middle]
        h = min([0.05, *apart])
        found, integral = second_difference(motion, middle, h)
        assert found == pytest.approx(integral, abs=1e-12 * peak + 1e-15)


@given(st.floats(0.3, 5.0), st.floats(-0.05, 0.05).filter(lambda a: abs(a) > 1e-4), st.floats(-4.0, 4.0))
def test_sinusoidal_pitch_between_its_tapers_is_the_sine(frequency, amplitude, phase):
    motion = ex.SinusoidalPitch(frequency, amplitude, 20.0, phase=phase, taper_in=2.0, taper_out=3.0)
    t = np.linspace(2.001, 16.999, 101)
    w = 2 * math.pi * frequency
    pitch, acceleration = motion.pitch(t)
    assert pitch == pytest.approx(amplitude * np.sin(w * t + phase), abs=1e-12)
    assert acceleration == pytest.approx(-(w**2) * amplitude * np.sin(w * t + phase), abs=1e-9)
    growing = ex.SinusoidalPitch(frequency, amplitude, 20.0, phase=phase, growing=True, taper_in=2.0, taper_out=3.0)
    assert growing.pitch(t)[0] == pytest.approx(t / 20.0 * pitch, abs=1e-12)
    outside = np.array(motion.pitch([-0.1, 0.0, 20.0, 20.1]))
    assert outside[0] == pytest.approx(0.0, abs=1e-15) and outside[1, [0, 3]] == pytest.approx(0.0, abs=0.0)
    assert np.array(motion(t)) == pytest.approx(0.0, abs=0.0)


@pytest.mark.parametrize(("frequency", "duration", "usual"), [(0.5, 20.0, 2.0), (4.0, 20.0, 0.25), (0.5, 3.0, 1.5)])
def test_a_sinusoidal_pitch_sets_in_and_goes_within_a_period_or_half_of_it_all(frequency, duration, usual):
    assert ex.SinusoidalPitch(frequency, 0.01, duration).tapers == (usual, usual)


def test_pitch_in_proportion_is_that_of_acceleration_and_displacement(motions):
    """c_a a_x itself; c_d times the second integral of a_x by SciPy's quadrature."""
    from scipy.integrate import quad

    for name in PITCHING:
        motion = motions[name]
        if not isinstance(motion, ex.ProportionalPitch):
            continue
        below = motion.motion
        for t in (0.35, 0.9, 1.7, 2.4):
            expected = motion.per_acceleration * float(below(t)[0])
            if motion.per_displacement:
                edges = sorted({-1.0, t, *(b for b in below.breakpoints if b < t)})
                moments = [
                    quad(lambda s, t=t, below=below: (t - s) * float(below(s)[0]), a, b, epsabs=1e-13, limit=200)[0]
                    for a, b in pairwise(edges)
                ]
                expected += motion.per_displacement * math.fsum(moments)
            # Centred pulses begin before any time; a second before it they are below 1e-15 of their peak.
            assert motion.pitch(t)[0] == pytest.approx(expected, abs=1e-11)
        assert np.array_equal(motion(0.9), below(0.9))


def test_a_table_that_samples_gives_the_same_pitch():
    """`Table` works on samples, by Fourier transform and spline: a thousandth of the peak at 200 samples a period."""
    pulse = ex.SymmetricRickerPulse(3.0, 0.5)
    exact = ex.ProportionalPitch(pulse, per_acceleration=2e-4)
    sampled = ex.Table(pitch_per_acceleration=2e-4).shake(pulse, time_step=0.0025, end=4.0)
    t = np.linspace(0.2, 3.8, 777)
    for found, expected in zip(sampled.pitch(t), exact.pitch(t), strict=True):
        assert found == pytest.approx(expected, abs=1e-3 * np.max(np.abs(expected)))


def test_combined_takes_each_part_from_its_motion():
    x, z = ex.RampedSinusoid(2.0, 2.0, 5.0), ex.OneSinePulse(3.0, 0.4, start=0.5)
    pitch = ex.SinusoidalPitch(1.5, 0.01, 2.5)
    t = np.linspace(-0.2, 2.7, 501)
    motion = ex.Combined(x, z, pitch)
    assert np.array_equal(motion(t)[0], x(t)[0]) and np.array_equal(motion(t)[1], z(t)[0])
    assert np.array_equal(motion.pitch(t), pitch.pitch(t))
    assert motion.breakpoints == tuple(sorted({*x.breakpoints, *z.breakpoints, *pitch.breakpoints}))
    assert motion.max_step == min(x.max_step, z.max_step, pitch.max_step)
    assert not ex.Combined(x, z).has_pitch and ex.Combined(x, pitching=pitch).has_pitch
    assert np.array_equal(ex.Combined(x, pitching=pitch)(t)[1], x(t)[1])
    assert ex.Combined(x, z, ex.SinusoidalPitch(1.0, 0.02, 5.0)).pitch_kernel is motion.pitch_kernel
    nested = ex.Combined(ex.Combined(x, z), pitching=pitch)
    assert np.array_equal(nested(t), motion(t)) and np.array_equal(nested.pitch(t), motion.pitch(t))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ex.SinusoidalPitch(0.0, 1.0, 1.0), r"frequency=0\.0 Hz"),
        (lambda: ex.SinusoidalPitch(1.0, 0.0, 1.0), r"amplitude=0\.0 rad"),
        (lambda: ex.SinusoidalPitch(1.0, 1.0, 1.0, taper_in=0.0), r"taper_in=0\.0 s: want a positive number"),
        (lambda: ex.SinusoidalPitch(1.0, 1.0, 1.0, taper_out=0.9), r"taper_in \+ taper_out=1\.4 s: want at most"),
        (lambda: ex.ProportionalPitch(ex.OneSinePulse(1.0, 1.0)), "per_displacement=0.0, per_acceleration=0.0: want"),
        (
            lambda: ex.ProportionalPitch(ex.HalfSinePulse(1.0, 1.0), per_displacement=0.1),
            r"per_displacement=0\.1: of HalfSinePulse\(.*\), want a displacement in closed form that comes to rest",
        ),
        (
            lambda: ex.ProportionalPitch(ex.SteadySinusoid(1.0, 1.0, 5.0), per_acceleration=0.1),
            r"per_acceleration=0\.1: .*, want an acceleration without jumps",
        ),
        (
            lambda: ex.Combined(ex.OneSinePulse(1.0, 1.0), pitching=ex.OneSinePulse(1.0, 1.0)),
            r"pitching=OneSinePulse\(.*\): does not pitch, want a motion that does",
        ),
        (lambda: ex.Combined(ex.OneSinePulse(1.0, 1.0), 3.0), r"vertical=3\.0: want a motion"),
        (lambda: ex.Combined(None), "horizontal=None: want a motion"),
    ],
)
def test_bad_argument_is_named_with_its_value(make, message):
    with pytest.raises(ValueError, match=message):
        make()
