"""The ramped sinusoid and its imperfect envelope."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from excitation import Motion, RampedSinusoid

positive = st.floats(0.05, 50.0)


@given(frequency=positive, duration=positive, amplitude=positive, share=st.floats(0.0, 1.0))
def test_acceleration_is_the_ramp_times_the_sine(frequency, duration, amplitude, share):
    motion = RampedSinusoid(frequency, duration, amplitude)
    t = share * duration
    a_x, a_z = motion(t)
    assert a_x == pytest.approx(amplitude * share * math.sin(2 * math.pi * frequency * t), abs=1e-9 * amplitude)
    assert a_z == 0.0


def test_envelope_is_final_amplitude_at_the_end_and_nothing_after():
    motion = RampedSinusoid(3.0, 90.0, 20.0)
    assert motion.envelope([0.0, 45.0, 90.0]) == pytest.approx([0.0, 10.0, 20.0], rel=1e-15)
    assert motion.envelope([-1.0, 90.001]) == pytest.approx([0.0, 0.0], abs=0.0)
    assert motion([-1.0, 90.001])[0] == pytest.approx([0.0, 0.0], abs=0.0)


def test_phase_shifts_the_sine():
    cosine = RampedSinusoid(1.0, 10.0, 10.0, phase=math.pi / 2)
    t = np.linspace(0.0, 10.0, 101)
    assert cosine(t)[0] == pytest.approx(t * np.cos(2 * np.pi * t), abs=1e-12)


@pytest.mark.parametrize("size", [0.02, 0.1, 0.25])
@pytest.mark.parametrize("seed", range(5))
def test_departure_of_the_envelope_has_the_stated_size_and_keeps_it_positive(size, seed):
    motion = RampedSinusoid(3.0, 90.0, 20.0, imperfection=size, seed=seed)
    # Another grid than the one on which the size was set: 1 % is the difference of the two means.
    t = np.linspace(0.003, 90.0, 17011)
    departure = motion.envelope(t) / (20.0 * t / 90.0) - 1.0
    assert math.sqrt(np.mean(departure**2)) == pytest.approx(size, rel=0.01)
    assert np.all(motion.envelope(t) > 0.0)


def test_departure_is_smooth_on_the_stated_period():
    """A sum of eight cosines no shorter than P: |r'| <= sum |a_i| 2 pi / P."""
    period = 9.0
    motion = RampedSinusoid(3.0, 90.0, 90.0, imperfection=0.1, seed=3, imperfection_period=period)
    t = np.linspace(1.0, 90.0, 100001)
    departure = motion.envelope(t) / t - 1.0
    amplitudes = motion.parameters[4::3]
    assert np.max(np.abs(np.gradient(departure, t))) <= np.sum(np.abs(amplitudes)) * 2 * np.pi / period


def test_departure_lasts_a_tenth_of_the_ramp_if_no_period_is_given():
    usual, given = (
        RampedSinusoid(2.0, 30.0, 5.0, imperfection=0.1, seed=4, imperfection_period=p) for p in (None, 3.0)
    )
    assert np.array_equal(usual.parameters, given.parameters)


def test_same_seed_same_motion_other_seed_another():
    def motion(seed):
        return RampedSinusoid(2.0, 30.0, 5.0, imperfection=0.1, seed=seed)

    assert np.array_equal(motion(4).parameters, motion(4).parameters)
    assert motion(4) == motion(4)
    assert not np.array_equal(motion(4).parameters, motion(5).parameters)


def test_kernel_gives_the_same_under_jax():
    import jax

    motion = RampedSinusoid(2.0, 30.0, 5.0, imperfection=0.1, seed=1)
    t = np.linspace(-1.0, 31.0, 57)
    with jax.enable_x64(True):
        traced = jax.jit(lambda t, par: motion.kernel(jax.numpy, t, par)[0])(t, motion.parameters)
        assert np.asarray(traced) == pytest.approx(motion(t)[0], abs=1e-13)


def test_to_xarray_has_units():
    ds = RampedSinusoid(2.0, 30.0, 5.0).to_xarray(np.linspace(0.0, 30.0, 11))
    assert {name: ds[name].attrs["units"] for name in ("a_x", "a_z", "time")} == {
        "a_x": "m s-2", "a_z": "m s-2", "time": "s",
    }  # fmt: skip
    assert "RampedSinusoid(frequency=2.0" in ds.attrs["motion"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"frequency": 0.0}, r"frequency=0\.0 Hz: want a positive number"),
        ({"frequency": math.nan}, "frequency=nan Hz"),
        ({"duration": -1.0}, r"duration=-1\.0 s: want a positive number"),
        ({"final_amplitude": math.inf}, r"final_amplitude=inf m/s\^2"),
        ({"phase": math.inf}, "phase=inf rad"),
        ({"imperfection": -0.1}, r"imperfection=-0\.1: want 0 to 0\.25"),
        ({"imperfection": 0.3}, r"imperfection=0\.3: want 0 to 0\.25"),
        ({"seed": -1}, "seed=-1: want 0 or more, a whole number"),
        ({"seed": 1.5}, r"seed=1\.5: want 0 or more"),
        ({"seed": None}, "seed=None: want 0 or more"),
        ({"seed": "x"}, "seed='x': want 0 or more"),
        ({"imperfection_period": 0.0}, r"imperfection_period=0\.0 s"),
        ({"imperfection_period": 91.0}, r"imperfection_period=91\.0 s"),
    ],
)
def test_bad_argument_is_named_with_its_value(arguments, message):
    with pytest.raises(ValueError, match=message):
        RampedSinusoid(**({"frequency": 3.0, "duration": 90.0, "final_amplitude": 20.0} | arguments))


def test_times_that_are_not_finite_are_refused():
    with pytest.raises(ValueError, match="want finite times"):
        RampedSinusoid(3.0, 90.0, 20.0)([0.0, math.nan])


def test_ramped_sinusoid_is_a_motion():
    assert issubclass(RampedSinusoid, Motion)
