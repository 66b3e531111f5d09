"""Tables: each departure by itself on a sine, where it has a closed form."""

import math

import numpy as np
import pytest
from scipy.signal import lsim

import excitation as ex

F, STEP = 3.0, 0.002
SINE = ex.SteadySinusoid(F, 2.0, 20.0, taper_in=4.0, taper_out=4.0)
INNER = slice(3000, 7000)
T = STEP * np.arange(10001)


def shaken(**departures):
    return ex.Table(**departures).shake(SINE, time_step=STEP, end=20.0)


def wave(amplitude, harmonic=1, phase=0.0):
    return amplitude * np.sin(2 * np.pi * harmonic * F * T + phase)[INNER]


def test_a_perfect_table_does_what_it_is_told():
    motion = shaken()
    assert motion.a_x == pytest.approx(SINE(T)[0], abs=0.0)
    assert motion.a_z is None and motion.pitch_angle is None


def test_gain_and_phase_act_on_the_sine():
    """Gain 0.8 and a lag of 0.5 rad between given frequencies of equal values."""
    motion = shaken(frequencies=(0.0, 2.0, 4.0), gain=(0.8, 0.8, 0.8), phase=(0.0, -0.5, -0.5))
    assert motion.a_x[INNER] == pytest.approx(wave(1.6, phase=-0.5), abs=1e-4)


def test_a_second_order_table_has_the_textbook_response():
    """H = 1/(1 - r^2 + 2 i z r) and a delay, at r = 3/12; the table's frequencies are interpolated to 2e-4."""
    z, r, delay = 0.6, F / 12.0, 0.01
    table = ex.Table.second_order(12.0, z, delay)
    response = 1 / (1 - r * r + 2j * z * r) * np.exp(-2j * np.pi * F * delay)
    motion = table.shake(SINE, time_step=STEP, end=20.0)
    assert motion.a_x[INNER] == pytest.approx(wave(2 * abs(response), phase=np.angle(response)), abs=1e-3)


@pytest.mark.parametrize("damping", [1e-4, 0.003, 0.01, 0.05, 0.3, 1.0, 50.0])
def test_between_its_frequencies_a_second_order_table_is_the_oscillator(damping):
    """H = 1/(1 - r^2 + 2 i z r) to 2e-4 of itself up to r = 20, at 40000 ratios, half of them close to resonance."""
    table = ex.Table.second_order(3.0, damping)
    r = np.concatenate([np.geomspace(1e-3, 20.0, 20001), 1.0 + damping * np.sinh(np.linspace(-7.0, 7.0, 20001))])
    r = r[(r > 0.0) & (r < 20.0)]
    exact = 1 / (1 - r * r + 2j * damping * r)
    found = np.interp(3 * r, table.frequencies, table.gain) * np.exp(
        1j * np.interp(3 * r, table.frequencies, table.phase)
    )
    assert np.max(np.abs(found / exact - 1)) < 2e-4
    assert max(table.gain) == pytest.approx(1 / (2 * damping), rel=2e-4) or damping > 0.01


@pytest.mark.parametrize("damping", [0.005, 0.02, 0.3])
def test_a_second_order_table_moves_as_its_oscillator_from_rest(damping):
    """SciPy's exact solution of x'' + 2 z w x' + w^2 x = w^2 a on straight lines, good to (w h)^2/12 = 5e-5, and the
    2e-4 of the table; a ramp at resonance, after which the lightest damping rings for longer than it lasted."""
    ramp, w = ex.RampedSinusoid(2.0, 10.0, 4.0), 4 * np.pi
    motion = ex.Table.second_order(2.0, damping).shake(ramp, time_step=STEP, end=10.0)
    _, expected, _ = lsim(([w * w], [1.0, 2 * damping * w, w * w]), ramp(motion.times)[0], motion.times)
    assert motion.a_x == pytest.approx(expected, abs=2.5e-4 * np.max(np.abs(expected)))


@pytest.mark.parametrize("end", [10.0, 10.1, 12.0])
def test_harmonics_begin_at_rest_whatever_silence_follows(end):
    """The share 0.1 of A(t) at twice the frequency.  What a sudden end at T, of amplitude A, adds to an analytic signal
    before it is A/(pi w (T - t)) (first term of the tail's integral), 0.010 m/s^2 a tenth of a second after the start;
    at twice the frequency it counts three times: once for the amplitude, twice for the phase."""
    ramp = ex.RampedSinusoid(2.0, 10.0, 4.0)
    motion = ex.Table(cross_axis_second_harmonic=0.1).shake(ramp, time_step=0.005, end=end)
    t = motion.times[motion.times < 0.1]
    expected = 0.1 * 0.4 * t * np.cos(2 * (4 * np.pi * t - np.pi / 2))
    assert motion.a_z[: t.size] == pytest.approx(expected, abs=0.1 * 3 * 4.0 / (np.pi * 4 * np.pi * 9.9))


@pytest.mark.parametrize(("name", "harmonic"), [("second_harmonic", 2), ("third_harmonic", 3)])
def test_harmonics_have_their_share_of_the_amplitude(name, harmonic):
    """A cos(phi) with phi = 2 pi F t - pi/2 gives share A cos(k phi)."""
    motion = shaken(**{name: 0.07})
    added = motion.a_x[INNER] - wave(2.0)
    expected = 0.07 * 2.0 * np.cos(harmonic * (2 * np.pi * F * T - np.pi / 2))[INNER]
    assert added == pytest.approx(expected, abs=2e-4)


def test_harmonics_follow_a_growing_amplitude():
    ramp = ex.RampedSinusoid(F, 20.0, 4.0)
    motion = ex.Table(third_harmonic=0.1).shake(ramp, time_step=STEP, end=20.0)
    added = (motion.a_x - ramp(T)[0])[INNER]
    expected = (0.1 * 4.0 * T / 20.0 * np.cos(3 * (2 * np.pi * F * T - np.pi / 2)))[INNER]
    # The analytic signal of a ramp is off by the sudden end at 20 s, 6 s and eighteen cycles away.
    assert added == pytest.approx(expected, abs=0.02)


def test_cross_axis_motion_is_vertical():
    motion = shaken(cross_axis=0.05, cross_axis_second_harmonic=0.02)
    expected = 0.05 * wave(2.0) + 0.02 * 2.0 * np.cos(2 * (2 * np.pi * F * T - np.pi / 2))[INNER]
    assert motion.a_z[INNER] == pytest.approx(expected, abs=1e-4)
    assert np.array(motion(T[INNER]))[1] == pytest.approx(expected, abs=1e-4)


def test_pitch_follows_acceleration_and_displacement():
    """Of a sine the displacement is -a/w^2, and the pitch acceleration -w^2 times the pitch."""
    w = 2 * np.pi * F
    motion = shaken(pitch_per_acceleration=1e-4)
    pitch, acceleration = motion.pitch(T[INNER])
    assert pitch == pytest.approx(1e-4 * wave(2.0), abs=1e-8)
    # The second derivative of a cubic spline is off by (w h)^2/12.
    assert acceleration == pytest.approx(-(w**2) * 1e-4 * wave(2.0), abs=(w * STEP) ** 2 / 12 * w**2 * 2e-4 * 1.1)
    displaced = shaken(pitch_per_displacement=0.3, displacement_corner=0.05)
    assert displaced.pitch(T[INNER])[0] == pytest.approx(0.3 * wave(-2.0 / w**2), abs=0.3 * 2.0 / w**2 * 0.02)


def test_envelope_wanders_by_the_stated_share():
    """The rms of the departure from 0 to the end is what was asked for, to the 2 % that samples away from the sine's
    zeros leave; none of its cosines is shorter than 4 s, so that its slope stays below rms sqrt(2 * 8) 2 pi/4 s."""
    even = ex.SteadySinusoid(F, 2.0, 20.0)
    told = even(T)[0]
    motion = ex.Table(envelope_imperfection=0.1, envelope_period=4.0, seed=5).shake(even, time_step=STEP, end=20.0)
    large = np.abs(told) > 0.6
    departure = motion.a_x[large] / told[large] - 1.0
    assert math.sqrt(np.mean(departure**2)) == pytest.approx(0.1, rel=0.02)
    assert np.max(np.abs(np.diff(departure) / np.diff(T[large]))) < 0.1 * math.sqrt(16) * 2 * math.pi / 4
    assert not np.array_equal(motion.a_x, shaken(envelope_imperfection=0.1, envelope_period=4.0, seed=6).a_x)


def test_sensors_add_white_noise_of_the_stated_size():
    """10001 samples: the standard deviation is known to 0.7 %, 3 % is four times it; neighbours are not correlated."""
    table = ex.Table(cross_axis=0.05, noise=0.02, seed=3)
    motion = table.shake(SINE, time_step=STEP, end=20.0)
    horizontal, vertical = table.recorded(motion)
    for record, truth in ((horizontal, motion.a_x), (vertical, motion.a_z)):
        noise = record.acceleration - truth
        assert np.std(noise) == pytest.approx(0.02, rel=0.03)
        assert abs(np.corrcoef(noise[1:], noise[:-1])[0, 1]) < 0.05
    assert vertical.vertical and not horizontal.vertical
    again = table.recorded(motion)[0].acceleration
    assert np.array_equal(again, horizontal.acceleration)


def test_sensors_on_a_pitching_table_feel_gravity():
    """A table held at an angle of 2 mrad clockwise: its x axis points down, and the sensor at rest shows -g sin(pitch)
    along and g (cos(pitch) - 1) normal to it; at small angles under motion a_x - (g + a_z) pitch, a_z + a_x pitch."""
    held = ex.SampledMotion(0.01, np.zeros(50), pitch=np.full(50, 2e-3))
    along, normal = ex.Table().recorded(held)
    assert along.acceleration == pytest.approx(-9.80665 * math.sin(2e-3), rel=1e-12)
    assert normal.acceleration == pytest.approx(9.80665 * (math.cos(2e-3) - 1), rel=1e-9)
    motion = shaken(cross_axis=0.05, pitch_per_acceleration=1e-4)
    along, normal = ex.Table().recorded(motion)
    tilt = motion.pitch_angle
    # Second order of a tilt of 2e-4 rad.
    assert along.acceleration == pytest.approx(motion.a_x - (9.80665 + motion.a_z) * tilt, abs=2e-7)
    assert normal.acceleration == pytest.approx(motion.a_z + motion.a_x * tilt, abs=1e-6)


def test_a_table_shows_its_departures_alone():
    assert repr(ex.Table()) == "Table()"
    assert repr(ex.Table(noise=0.1, seed=3)) == "Table(noise=0.1, seed=3)"
    shown = repr(ex.Table(frequencies=tuple(range(7)), gain=(1.0,) * 7, phase=(0.0,) * 7))
    assert shown == "Table(frequencies=<7 values>, gain=<7 values>, phase=<7 values>)"


def test_tables_of_the_same_numbers_are_the_same_whatever_held_them():
    f, gain, phase = (0.0, 5.0), (1.0, 0.9), (0.0, -0.2)
    one = ex.Table(frequencies=f, gain=gain, phase=phase)
    other = ex.Table(frequencies=np.array(f), gain=list(gain), phase=np.array(phase))
    assert one == other and hash(one) == hash(other) and repr(one) == repr(other)


def test_a_corner_beyond_the_commands_samples_is_named():
    table = ex.Table(pitch_per_displacement=0.01, displacement_corner=80.0)
    with pytest.raises(ValueError, match=r"displacement_corner=80.0 Hz: want below half the sampling rate, 50 Hz"):
        table.shake(ex.SteadySinusoid(1.0, 2.0, 4.0), time_step=0.01, end=4.0)


def test_dampings_and_phases_that_ring_for_ever_are_refused():
    for damping in (0.0, 1e-5, math.nan, "x"):
        with pytest.raises(ValueError, match=f"damping={damping!r} 1: want a number of 0.0001 or more"):
            ex.Table.second_order(10.0, damping)
    late = ex.Table(frequencies=(0.0, 1.0), gain=(1.0, 1.0), phase=(0.0, -1e6))
    with pytest.raises(ValueError, match=r"phase: so steep that the table lags by 159155 s, want at most 6990.51 s"):
        late.shake(SINE, time_step=0.01, end=1.0)


def test_departures_can_be_taken_away_one_by_one():
    table = ex.Table(second_harmonic=0.1, noise=0.1, frequencies=(1.0,), gain=(2.0,), phase=(0.0,))
    assert table.without("second_harmonic", "noise", "gain") == ex.Table()
    with pytest.raises(ValueError, match="name='colour': want one of frequencies"):
        table.without("colour")


def test_a_recorded_input_like_the_papers_can_be_made_and_read_again(tmp_path):
    """A ramp of 3 Hz over 10 s on a table with everything wrong a little, recorded, written and used as a motion."""
    table = ex.Table(second_harmonic=0.02, cross_axis=0.03, envelope_imperfection=0.05, noise=0.01, seed=1)
    motion = table.shake(ex.RampedSinusoid(3.0, 10.0, 5.0), time_step=0.005, end=10.0)
    horizontal, vertical = table.recorded(motion)
    from excitation.formats import columns

    columns.write(tmp_path / "recorded.csv", horizontal, vertical)
    x, z = ex.read(tmp_path / "recorded.csv")
    again = x.motion(z)
    assert again.a_x == pytest.approx(motion.a_x, abs=0.06) and again.a_z == pytest.approx(motion.a_z, abs=0.06)
    assert z.vertical


@pytest.mark.parametrize(
    ("departures", "message"),
    [
        ({"frequencies": (1.0,)}, "frequencies, gain, phase: have shapes"),
        ({"frequencies": (2.0, 1.0), "gain": (1.0, 1.0), "phase": (0.0, 0.0)}, "want ascending from 0 on"),
        ({"frequencies": (1.0,), "gain": (-1.0,), "phase": (0.0,)}, "gain=.*want zero or more"),
        ({"second_harmonic": math.nan}, "second_harmonic=nan"),
        ({"displacement_corner": 0.0}, r"displacement_corner=0\.0 Hz"),
        ({"envelope_imperfection": 0.5}, r"envelope_imperfection=0\.5: want 0 to 0\.25"),
        ({"noise": -1.0}, r"noise=-1\.0 m/s\^2"),
    ],
)
def test_bad_argument_is_named_with_its_value(departures, message):
    with pytest.raises(ValueError, match=message):
        ex.Table(**departures)
