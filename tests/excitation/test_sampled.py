"""Sampled motions against SciPy's spline, polynomials that a cubic holds exactly, and refusals."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from excitation import (
    Combined,
    OneCosinePulse,
    OneSinePulse,
    PiecewiseLinear,
    RampedSinusoid,
    RectangularPulse,
    SampledMotion,
    Table,
    from_xarray,
)


def noise(seed, size=200):
    return np.random.default_rng(seed).normal(size=size)


def test_between_samples_lies_scipys_cubic_spline():
    step, start = 0.005, 0.3
    x, z, p = noise(1), noise(2), 1e-3 * noise(3)
    motion = SampledMotion(step, x, z, p, start=start)
    t = np.random.default_rng(4).uniform(start, motion.end, 3000)
    expected = [CubicSpline(motion.times, values)(t) for values in (x, z)]
    assert np.array(motion(t)) == pytest.approx(np.array(expected), abs=1e-11)
    angle, acceleration = motion.pitch(t)
    assert angle == pytest.approx(CubicSpline(motion.times, p)(t), abs=1e-13)
    # Second derivative: values of 1e-3 over steps of 5e-3 s squared make 1e3 rad/s^2, times rounding.
    assert acceleration == pytest.approx(CubicSpline(motion.times, p)(t, 2), abs=1e-7)


@given(st.lists(st.floats(-5.0, 5.0), min_size=4, max_size=4), st.floats(1e-3, 0.5), st.integers(4, 60))
def test_a_cubic_of_time_is_kept_exactly(coefficients, step, size):
    tau = np.arange(size) / (size - 1)
    motion = SampledMotion(step, np.polyval(coefficients, tau))
    share = np.linspace(0.0, 1.0, 97)
    assert motion(share * motion.end)[0] == pytest.approx(np.polyval(coefficients, share), abs=1e-9)


@given(st.integers(0, 1000), st.floats(0.1, 10.0))
def test_scaling_the_samples_scales_the_motion(seed, factor):
    t = np.linspace(0.0, 0.39, 77)
    small, large = SampledMotion(0.01, noise(seed, 40)), SampledMotion(0.01, factor * noise(seed, 40))
    assert large(t)[0] == pytest.approx(factor * small(t)[0], rel=1e-10, abs=1e-12)


def test_at_rest_before_the_first_and_after_the_last_sample():
    for kind in (SampledMotion, PiecewiseLinear):
        motion = kind(0.1, [1.0, 2.0, 3.0], start=1.0)
        assert motion([0.99, 1.0, 1.2, 1.21])[0] == pytest.approx([0.0, 1.0, 3.0, 0.0], abs=1e-12)
    assert SampledMotion(0.1, [1.0, 2.0, 3.0], start=1.0).breakpoints == (1.0, 1.2)


def test_straight_lines_are_numpys_interpolation():
    motion = PiecewiseLinear(0.02, noise(5), noise(6), start=-1.0)
    t = np.random.default_rng(7).uniform(-1.0, motion.end, 2000)
    expected = [np.interp(t, motion.times, values) for values in (motion.a_x, motion.a_z)]
    assert np.array(motion(t)) == pytest.approx(np.array(expected), abs=1e-12)
    assert motion.breakpoints == tuple(motion.times)


def test_pitch_is_the_second_integral_of_its_acceleration():
    """A cubic's second derivative is linear in each step: two integrations by the trapezium's exact rule."""
    step, p = 0.01, 1e-3 * noise(8, 50)
    motion = SampledMotion(step, np.zeros(50), pitch=p)
    m = motion.pitch(motion.times)[1]
    slope = (p[1] - p[0]) / step - step * (2 * m[0] + m[1]) / 6
    rebuilt, rate = [p[0]], slope
    for m0, m1 in pairwise(m):
        rebuilt.append(rebuilt[-1] + rate * step + step**2 * (2 * m0 + m1) / 6)
        rate += step * (m0 + m1) / 2
    assert np.array(rebuilt) == pytest.approx(p, abs=1e-12)


def test_samples_of_a_formula_come_back_to_the_fourth_power_of_the_step():
    """Cubic splines: halving the step divides the error by 16 (de Boor 1978); 12 allows for the ends."""
    formula = RampedSinusoid(2.0, 2.0, 5.0)
    t = np.linspace(0.3, 1.7, 5003)
    errors = [
        np.max(np.abs(SampledMotion.of(formula, time_step=h, end=2.0)(t)[0] - formula(t)[0])) for h in (0.02, 0.01)
    ]
    assert errors[0] / errors[1] > 12.0
    assert errors[1] < 5.0 * (2 * np.pi * 2.0 * 0.01) ** 4 / 100


def test_a_second_motion_can_be_the_vertical_one():
    motion = SampledMotion.of(
        RampedSinusoid(2.0, 2.0, 5.0), RampedSinusoid(3.0, 2.0, 1.0), time_step=0.005, end=2.0, start=0.5
    )
    t = np.linspace(0.5, 2.0, 301)
    assert motion(t)[1] == pytest.approx(RampedSinusoid(3.0, 2.0, 1.0)(t)[0], abs=1e-5)
    assert motion.start == 0.5 and motion.end == 2.0


@pytest.mark.parametrize("step", [0.03, 0.01, 0.001])
@pytest.mark.parametrize(
    ("pulse", "velocity"),
    [
        (RectangularPulse(1.0, 0.1, start=0.3), 0.1),
        (RectangularPulse(-2.0, 0.1234, start=0.4321), -0.2468),
        (RectangularPulse(1.0, 0.0004, start=0.4321), 0.0004),
        (OneCosinePulse(1.0, 0.45, start=0.3), 0.0),
        (OneCosinePulse(1.0, 0.4567, start=0.3019), 0.0),
    ],
)
def test_samples_of_a_jump_leave_the_base_with_the_velocity_of_the_motion(pulse, velocity, step):
    """Amplitude times duration of a rectangle, zero of a whole cosine, wherever the jumps are between samples, and of a
    rectangle within one step.  A cosine's samples miss its integral by their own a_p omega^2 h^3/12 at the most (the
    rule of Euler and Maclaurin), and a spline's rings of the jumps die out by 0.27 a step: 1e-4 h after nine."""
    own = step**3 * (2 * np.pi / 0.45) ** 2 / 12 if isinstance(pulse, OneCosinePulse) else 0.0
    for motion in (
        SampledMotion.of(pulse, time_step=step, end=1.2),
        Table().shake(pulse, time_step=step, end=1.2),
        SampledMotion.of(Combined(OneSinePulse(1.0, 0.4), pulse), time_step=step, end=1.2),
        SampledMotion.of(OneSinePulse(1.0, 0.4), pulse, time_step=step, end=1.2),
    ):
        values = motion.a_x if motion.a_z is None else motion.a_z
        left = CubicSpline(motion.times, values).integrate(0.0, motion.end)
        assert left == pytest.approx(velocity, abs=own + 2e-4 * step)


def test_a_jump_at_the_first_or_the_last_sample_stays_one():
    """The base is at rest outside the samples, so that they begin and end with a jump by themselves."""
    motion = SampledMotion.of(RectangularPulse(2.0, 1.0), time_step=0.1, end=1.0)
    assert np.array_equal(motion.a_x, np.full(11, 2.0))
    later = SampledMotion.of(RectangularPulse(2.0, 1.0, start=1.0), time_step=0.1, start=1.0, end=1.5)
    assert np.array_equal(later.a_x, np.full(6, 2.0))
    lines = PiecewiseLinear(0.1, noise(9, 20))
    assert np.array_equal(SampledMotion.of(lines, time_step=0.1, end=1.9).a_x, lines(lines.times)[0])


@pytest.mark.parametrize(("name", "value"), [("start", None), ("start", np.nan), ("end", "a"), ("end", np.inf)])
def test_a_span_that_is_none_is_named(name, value):
    with pytest.raises(ValueError, match=f"^{name}={value!r} s: want a finite number"):
        SampledMotion.of(RectangularPulse(1.0, 1.0), **({"time_step": 0.1, "start": 0.0, "end": 1.0} | {name: value}))


def test_units_of_a_dataset_are_converted():
    import xarray as xr

    t = 10.0 * np.arange(50)
    ds = xr.Dataset(
        {
            "a_x": ("time", noise(1, 50), {"units": "g"}),
            "a_z": ("time", noise(2, 50), {"units": "cm/s^2"}),
            "pitch": ("time", noise(3, 50), {"units": "mrad"}),
        },
        coords={"time": ("time", t, {"units": "ms"})},
    )
    motion = from_xarray(ds)
    assert motion.time_step == pytest.approx(0.01)
    assert motion.a_x == pytest.approx(9.80665 * noise(1, 50))
    assert motion.a_z == pytest.approx(0.01 * noise(2, 50))
    assert motion.pitch(motion.times)[0] == pytest.approx(1e-3 * noise(3, 50))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda ds: ds.drop_vars("a_x"), "want a_x"),
        (lambda ds: ds.drop_vars("time"), "want time"),
        (lambda ds: ds.assign_coords(time=("time", [0.0, 0.01, 0.03], {"units": "s"})), "equal spacing"),
        (lambda ds: ds.assign_coords(time=("time", [0.0, 0.0, 0.0], {"units": "s"})), "want ascending finite times"),
        (lambda ds: ds.assign(a_x=("time", [1.0, 2.0, 3.0])), "a_x: has units None"),
        (lambda ds: ds.assign_attrs(time_step=0.02), r"time_step=0\.02 s: the times are 0\.01 s apart"),
        (lambda ds: ds.assign_attrs(interpolation="step"), "interpolation='step': want cubic, or linear"),
        (
            lambda ds: ds.assign_attrs(interpolation="linear", time_step=0.01).assign(
                pitch=("time", [0.0, 1.0, 0.0], {"units": "rad"})
            ),
            "interpolation='linear': want cubic, or linear for a base without pitch",
        ),
        (lambda ds: ds.assign(a_x=("time", [1.0, 2.0, 3.0], {"units": "furlong"})), "units 'furlong'"),
        (lambda ds: ds.assign(a_x=("time", [1.0, np.nan, 3.0], {"units": "g"})), "a_x: sample 1 is nan"),
        (lambda ds: ds.assign_attrs(motion_class="Nothing"), "motion_class='Nothing'"),
        (lambda ds: ds.assign_attrs(motion_class="Chirp", motion_arguments="{"), "motion_arguments='{'"),
        (
            lambda ds: ds.assign_attrs(
                motion_class="RectangularPulse", motion_arguments='{"amplitude": 1, "duration": 1}'
            ),
            "a_x: is not that of",
        ),
    ],
)
def test_a_dataset_that_is_no_motion_is_named(change, message):
    ds = SampledMotion(0.01, [1.0, 2.0, 3.0]).to_xarray()
    with pytest.raises(ValueError, match=message):
        from_xarray(change(ds))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"time_step": 0.0}, r"time_step=0\.0 s: want a positive number"),
        ({"a_x": [1.0]}, r"a_x: has shape \(1,\), want 2 samples or more"),
        ({"a_x": [1.0, np.inf]}, "a_x: sample 1 is inf"),
        ({"a_x": ["x", "y"]}, "a_x: want numbers"),
        ({"a_z": [1.0, 2.0]}, "a_z: has 2 samples, want 3"),
        ({"pitch": [1.0]}, "pitch: has shape"),
        ({"start": np.nan}, "start=nan s"),
    ],
)
def test_bad_samples_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        SampledMotion(**({"time_step": 0.01, "a_x": [1.0, 2.0, 3.0]} | arguments))


def test_a_combined_motion_is_its_two_parts():
    x, z = RampedSinusoid(2.0, 2.0, 5.0, imperfection=0.1, seed=1), OneSinePulse(3.0, 0.4, start=0.5)
    motion = Combined(x, z)
    t = np.linspace(-0.2, 2.2, 501)
    assert np.array_equal(motion(t)[0], x(t)[0]) and np.array_equal(motion(t)[1], z(t)[0])
    assert motion.breakpoints == (0.0, 0.5, 0.9, 2.0)
    # One kernel for one pair of kinds: a compiling solver compiles it once.
    assert Combined(x, OneSinePulse(1.0, 0.7)).kernel is motion.kernel


@pytest.mark.parametrize(("time_step", "last"), [(0.4, 1.2), (0.6, 1.2), (0.1, 1.0), (0.25, 1.0), (2.0, 2.0)])
def test_samples_of_a_motion_reach_to_its_end_in_whole_steps(time_step: float, last: float) -> None:
    motion = SampledMotion.of(RampedSinusoid(2.0, 2.0, 5.0), time_step=time_step, end=1.0)
    assert motion.end == pytest.approx(last, abs=1e-12)
    assert motion.times[-2] < 1.0
