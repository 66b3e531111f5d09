"""Processing and measures against closed forms and against eqsig and pyrotd on the same motions."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

import excitation as ex
from excitation.intensities import significant_duration
from excitation.spectra import oscillator


@pytest.fixture(scope="module")
def quake():
    """A made earthquake at rest before and after, with a drift-free start: 20 s at 100 Hz."""
    ground = ex.KanaiTajimi(1.5, 12.0, rise=1.0, strong_end=5.0, decay=0.8)
    return ex.Record(0.01, np.concatenate([np.zeros(200), ground.record(0.01, seed=7).acceleration, np.zeros(600)]))


@pytest.fixture(scope="module")
def pair(quake):
    other = ex.KanaiTajimi(1.2, 12.0, rise=1.0, strong_end=5.0, decay=0.8).record(0.01, seed=8).acceleration
    second = ex.Record(0.01, np.concatenate([np.zeros(200), other, np.zeros(600)]), azimuth_deg=90.0)
    return ex.Record(0.01, quake.acceleration, azimuth_deg=0.0), second


def sine(frequency, step=0.005, length=20.0, amplitude=1.0):
    t = step * np.arange(round(length / step) + 1)
    return ex.Record(step, amplitude * np.sin(2 * np.pi * frequency * t))


@pytest.mark.filterwarnings("ignore")  # warnings of eqsig's own
def test_measures_are_those_of_eqsig(quake):
    import eqsig

    theirs = eqsig.AccSignal(quake.acceleration, quake.time_step)
    ours = ex.intensity(quake)
    assert ours.pga == pytest.approx(theirs.pga, rel=1e-12)
    # eqsig integrates by the trapezium rule; at 100 Hz that is off by (2 pi 8 Hz 0.01 s)^2/12 = 2 % at most, at 8 Hz.
    assert ours.pgv == pytest.approx(theirs.pgv, rel=0.01)
    assert ours.pgd == pytest.approx(theirs.pgd, rel=0.01)
    # Its pi/(2 g) is taken with 9.81.
    assert ours.arias == pytest.approx(eqsig.im.calc_arias_intensity(theirs)[-1] * 9.81 / 9.80665, rel=1e-3)
    assert ours.cav == pytest.approx(eqsig.im.calc_cav(theirs)[-1], rel=1e-9)
    # It takes the sample next to 5 and 95 %: a step at either end.
    low, high = eqsig.im.calc_sig_dur_vals(quake.acceleration, quake.time_step, se=True)
    assert ours.significant_duration == pytest.approx(high - low, abs=2.1 * quake.time_step)


@pytest.mark.filterwarnings("ignore")
def test_response_spectrum_is_that_of_eqsig(quake):
    """Both exact for straight lines between samples; ours looks 40 times a period, it at the samples: 0.5 % of the peak
    at 20 samples a period."""
    import eqsig

    periods = np.array([0.2, 0.3, 0.5, 1.0, 2.0, 4.0])
    theirs = eqsig.AccSignal(quake.acceleration, quake.time_step)
    theirs.generate_response_spectrum(response_times=periods, xi=0.05, min_dt_ratio=8)
    ours = ex.response_spectrum(quake, periods)
    assert ours.displacement == pytest.approx(theirs.s_d, rel=5e-3)
    assert ours.pseudo_acceleration == pytest.approx(theirs.s_a, rel=5e-3)


def padded(record, zeros=6000):
    return np.concatenate([record.acceleration, np.zeros(zeros)])


@pytest.mark.parametrize("damping", [0.02, 0.05, 0.2])
def test_response_spectrum_is_that_of_pyrotd(pyrotd, quake, damping):
    """It works by Fourier transform, with a band-limited record between the samples, ours with straight lines: at 20
    samples a period and more these differ by a per cent.  Zeros behind keep its response from coming round again."""
    pyrotd.processes = 1
    periods = np.array([0.3, 0.5, 1.0, 2.0])
    theirs = pyrotd.calc_spec_accels(quake.time_step, padded(quake), 1 / periods, damping)
    ours = ex.response_spectrum(ex.Record(0.01, padded(quake)), periods, damping)
    assert ours.pseudo_acceleration == pytest.approx(theirs.spec_accel, rel=0.012)


def test_rotd_is_that_of_pyrotd(pyrotd, pair):
    pyrotd.processes = 1
    periods, nn = np.array([0.3, 0.5, 1.0, 2.0]), [0, 50, 100]
    theirs = pyrotd.calc_rotated_spec_accels(
        0.01, padded(pair[0]), padded(pair[1]), 1 / periods, 0.05, percentiles=nn, angles=np.arange(0, 180, 1)
    )
    first, second = (ex.Record(0.01, padded(r)) for r in pair)
    ours = ex.rotd(first, second, periods, percentiles=nn)
    for k, percentile in enumerate(nn):
        expected = theirs.spec_accel[theirs.percentile == percentile]
        assert ours[k] == pytest.approx(expected, rel=0.015)


def test_steady_response_is_the_textbooks_magnification():
    """Amplitude of u under a = sin(2 pi f t): 1/(w^2 sqrt((1-r^2)^2 + (2 z r)^2)); straight lines at 400 samples a
    period lower the load by (pi/400)^2/3, and the transient has died out after 40 s."""
    record = sine(1.0, step=0.0025, length=60.0)
    for period, damping in ((0.5, 0.05), (1.0, 0.05), (2.5, 0.1)):
        u = oscillator(record.acceleration, record.time_step, period, damping)
        r, w = period, 2 * np.pi / period
        expected = 1 / (w**2 * math.hypot(1 - r**2, 2 * damping * r))
        assert np.max(np.abs(u[-4000:])) == pytest.approx(expected, rel=2e-4)


def test_response_to_a_suddenly_constant_acceleration():
    """At rest at first: u = -(a/w^2)(1 - exp(-z w t)(cos w_d t + z w/w_d sin w_d t)), exact also for the first step."""
    z, period, step = 0.1, 0.7, 0.01
    u = oscillator(np.full(300, 2.0), step, period, z)
    w = 2 * np.pi / period
    w_d, t = w * math.sqrt(1 - z * z), step * np.arange(300)
    decay = np.exp(-z * w * t) * (np.cos(w_d * t) + z * w / w_d * np.sin(w_d * t))
    assert u == pytest.approx(-2.0 / w**2 * (1 - decay), abs=1e-12)


def test_stiff_oscillator_moves_with_the_ground(quake):
    """PSA tends to PGA as the period goes to zero."""
    spectrum = ex.response_spectrum(quake, [0.001, 0.005])
    assert spectrum.pseudo_acceleration == pytest.approx(2 * [ex.intensity(quake).pga], rel=0.01)


@settings(max_examples=20)
@given(st.floats(0.1, 10.0), st.floats(0.3, 3.0))
def test_scaling_laws_of_all_measures(factor, stretch):
    """Amplitude by c: PGA, PGV, PGD, CAV and spectrum by c, Arias by c^2, duration by 1.  Time by s: velocities and CAV
    by s, displacements by s^2, Arias and duration by s; a spectrum shifts to periods times s."""
    record = ex.KanaiTajimi(1.0, 5.0).record(0.02, seed=1)
    changed = ex.time_scaled(ex.scaled(record, factor), stretch)
    before, after = ex.intensity(record), ex.intensity(changed)
    expected = (
        factor * before.pga, factor * stretch * before.pgv, factor * stretch**2 * before.pgd,
        factor**2 * stretch * before.arias, factor * stretch * before.cav, stretch * before.significant_duration,
    )  # fmt: skip
    assert tuple(after) == pytest.approx(expected, rel=1e-9)
    periods = np.array([0.3, 1.0])
    ours = ex.response_spectrum(changed, stretch * periods).pseudo_acceleration
    assert ours == pytest.approx(factor * ex.response_spectrum(record, periods).pseudo_acceleration, rel=1e-9)


@given(st.floats(0.01, 100.0))
def test_similitude_keeps_accelerations_and_scales_displacements_with_length(scale):
    record = ex.KanaiTajimi(1.0, 5.0).record(0.05, seed=1)
    model = ex.similar(record, scale)
    assert np.array_equal(model.acceleration, record.acceleration)
    assert model.displacement == pytest.approx(scale * record.displacement, rel=1e-9, abs=1e-12 * scale)


def test_scaled_to_a_value_has_that_value(quake):
    assert ex.intensity(ex.scaled_to(quake, pga=3.0)).pga == pytest.approx(3.0, rel=1e-12)
    assert ex.intensity(ex.scaled_to(quake, pgv=0.4)).pgv == pytest.approx(0.4, rel=1e-12)
    there = ex.response_spectrum(ex.scaled_to(quake, psa=5.0, period=0.7, damping=0.02), [0.7], 0.02)
    assert there.pseudo_acceleration[0] == pytest.approx(5.0, rel=1e-12)


def test_duration_of_an_even_record_is_the_share_asked_for():
    record = ex.Record(0.01, np.ones(1001))
    assert significant_duration(record) == pytest.approx(9.0, rel=1e-12)
    assert significant_duration(record, 0.05, 0.75) == pytest.approx(7.0, rel=1e-12)
    assert significant_duration(ex.Record(0.01, np.zeros(10))) == 0.0


@pytest.mark.parametrize(("before", "after"), [(0.0, 40.0), (60.0, 0.0), (60.0, 40.0)])
def test_zeros_around_a_record_are_no_part_of_its_duration(before, after):
    """5 to 95 % of sin^2 over a cycle of 0.1 s lie 0.0888 s apart: x - sin(4 pi x) / (4 pi) = 0.05 at 0.0560 cycles."""
    step, cycle = 1e-4, np.sin(2.0 * math.pi * np.arange(1001) / 1000)
    rests = [np.zeros(round(length / step)) for length in (before, after)]
    found = significant_duration(ex.Record(step, np.concatenate([rests[0], cycle, rests[1]])))
    edge = brentq(lambda x: x - math.sin(4.0 * math.pi * x) / (4.0 * math.pi) - 0.05, 0.0, 0.25)
    assert found == pytest.approx(0.1 * (1.0 - 2.0 * edge), rel=1e-5)


def test_the_shorter_time_counts_where_the_energy_stands_still_at_a_share():
    """Half of it in each of two bursts of 1 s, 5 s apart: half to all of it lies in the second alone."""
    burst = np.ones(101)
    record = ex.Record(0.01, np.concatenate([burst, np.zeros(500), burst]))
    assert significant_duration(record, 0.0, 0.5) == pytest.approx(1.0, abs=0.011)
    assert significant_duration(record, 0.5, 1.0) == pytest.approx(1.0, abs=0.011)
    assert significant_duration(record, 0.0, 1.0) == pytest.approx(7.01, abs=0.011)


def test_a_record_that_begins_earlier_does_not_state_when(quake):
    dated = replace(quake, start_time="2011-02-22T23:51:42Z")
    assert ex.band_passed(dated, 0.1, 20.0).start_time == dated.start_time
    assert ex.band_passed(dated, 0.1, 20.0, keep_padding=True).start_time == ""


@pytest.mark.parametrize("step", [1e-320, 1e-12, 1e12])
def test_a_step_far_from_that_of_the_record_is_refused(quake, step):
    with pytest.raises(ValueError, match=r"time_step=1.* s: want a ratio to 0.01 s"):
        ex.resampled(quake, step)


def test_arias_and_cav_of_whole_sines():
    """A = 2, 5 s of whole periods: pi/(2 g) A^2 T/2 and A T 2/pi; the trapezium rule is exact for sin^2 over whole
    periods, and for |sin| off by (pi/400)^2/3 at 200 samples a half period."""
    record = sine(1.0, step=0.0025, length=5.0, amplitude=2.0)
    assert ex.intensity(record).arias == pytest.approx(math.pi / (2 * 9.80665) * 4 * 2.5, rel=1e-9)
    assert ex.intensity(record).cav == pytest.approx(2 * 5 * 2 / math.pi, rel=5e-5)


@pytest.mark.parametrize("method", ["acceleration", "velocity"])
@pytest.mark.parametrize("order", [0, 1, 3])
def test_a_polynomial_drift_is_removed(quake, method, order):
    """A drift of the fitted order goes whatever the record: correcting record + drift is correcting the record."""
    tau = np.linspace(0.0, 1.0, quake.acceleration.size)
    drift = np.polyval(np.array([0.3, -0.2, 0.1, 0.05])[: order + 1], tau)
    plain = ex.baseline_corrected(quake, order, method).acceleration
    drifting = ex.baseline_corrected(ex.Record(0.01, quake.acceleration + drift), order, method).acceleration
    assert drifting == pytest.approx(plain, abs=1e-10)


def test_baseline_fit_to_velocity_brings_the_base_to_rest(quake):
    rng = np.random.default_rng(1)
    drifting = ex.Record(0.01, quake.acceleration + 0.05 + 0.002 * rng.normal(size=quake.acceleration.size))
    assert abs(drifting.velocity[-1]) > 0.9
    assert abs(ex.baseline_corrected(drifting, 0).velocity[-1]) < 0.05


def test_band_pass_keeps_what_is_inside_and_shifts_nothing():
    """Two passes of Butterworth order 4 at 0.5 and 10 Hz: |H|^2 = 1/((1 + (0.5/2)^8)(1 + (2/10)^8)) at 2 Hz."""
    record = sine(2.0, length=40.0)
    middle = slice(3000, 5000)
    filtered = ex.band_passed(record, 0.5, 10.0, taper=2.0).acceleration[middle]
    assert filtered == pytest.approx(record.acceleration[middle], abs=2e-3)
    low, high = (
        ex.band_passed(sine(f, length=60.0), 0.5, 10.0, taper=5.0).acceleration[5000:7000] for f in (0.1, 30.0)
    )
    assert np.max(np.abs(low)) < 1e-3 and np.max(np.abs(high)) < 1e-3


@pytest.mark.parametrize(("low", "high", "frequency"), [(2.0, None, 2.0), (None, 5.0, 5.0)])
def test_half_of_the_amplitude_is_left_at_a_corner(low, high, frequency):
    """One pass leaves 1/sqrt(2), two leave 1/2, by the definition of the corner."""
    record = sine(frequency, length=60.0)
    filtered = ex.band_passed(record, low, high, taper=5.0).acceleration[5000:7000]
    assert np.max(np.abs(filtered)) == pytest.approx(0.5, abs=2e-3)


def test_band_pass_of_a_turned_round_record_is_turned_round(quake):
    """No phase shift: forwards and backwards are alike."""
    forth = ex.band_passed(quake, 0.2, 20.0).acceleration
    back = ex.band_passed(ex.Record(0.01, quake.acceleration[::-1]), 0.2, 20.0).acceleration[::-1]
    assert forth == pytest.approx(back, abs=1e-6)


def test_kept_padding_makes_the_record_longer_on_both_sides(quake):
    long = ex.band_passed(quake, 0.5, 20.0, keep_padding=True)
    pad = (long.acceleration.size - quake.acceleration.size) // 2
    # 1.5 n/f_c for n = 8 poles.
    assert pad == math.ceil(1.5 * 8 / 0.5 / 0.01)
    stripped = ex.band_passed(quake, 0.5, 20.0).acceleration
    assert long.acceleration[pad:-pad] == pytest.approx(stripped, abs=1e-15)


@pytest.mark.parametrize("step", [0.0025, 0.002, 0.01, 0.02, 0.0125])
def test_resampled_sine_is_the_sine_at_the_new_times(step):
    """5 Hz is below 0.8 of each Nyquist frequency (25 Hz and more); ends aside, within the filter's 1e-3."""
    record = sine(5.0, length=10.0)
    made = ex.resampled(record, step)
    inner = (made.times > 1.0) & (made.times < 9.0)
    assert made.acceleration[inner] == pytest.approx(np.sin(10 * np.pi * made.times[inner]), abs=1e-3)
    assert made.duration == pytest.approx(10.0, abs=step)


def test_resampling_lets_nothing_fold_back():
    """45 Hz does not fit into 50 samples a second and would come back as 5 Hz."""
    made = ex.resampled(sine(45.0, length=10.0), 0.02)
    assert np.max(np.abs(made.acceleration[50:-50])) < 1e-3


@settings(max_examples=30)
@given(st.floats(0.0, 360.0))
def test_turning_keeps_the_vector(pair, azimuth):
    first, second = ex.turned(*pair, azimuth)
    before = np.hypot(pair[0].acceleration, pair[1].acceleration)
    assert np.hypot(first.acceleration, second.acceleration) == pytest.approx(before, abs=1e-12)
    again = ex.turned(first, second, 0.0)
    assert again[0].acceleration == pytest.approx(pair[0].acceleration, abs=1e-12)


def test_turned_to_ninety_degrees_is_the_east_component(pair):
    east, south = ex.turned(*pair, 90.0)
    assert east.acceleration == pytest.approx(pair[1].acceleration, abs=1e-14)
    assert south.acceleration == pytest.approx(-pair[0].acceleration, abs=1e-14)
    assert (east.azimuth_deg, south.azimuth_deg) == (90.0, 180.0)


def test_rotd_of_motion_along_a_line_is_its_projection():
    """Along 30 degrees: the peak in direction d is |cos(d - 30)| times that of the line; their median is cos(45)."""
    a = sine(1.0, length=4.0).acceleration
    x, y = (ex.Record(0.005, c * a) for c in (math.cos(math.radians(30)), math.sin(math.radians(30))))
    # 180 directions: the median lies between two of them, half a degree off.
    assert ex.rotd_peaks(x, y) == pytest.approx([0.0, math.cos(math.radians(45)), 1.0], abs=0.01)
    circle = [ex.Record(0.005, f(2 * np.pi * np.arange(801) / 200)) for f in (np.cos, np.sin)]
    assert ex.rotd_peaks(*circle) == pytest.approx([1.0, 1.0, 1.0], abs=2e-4)


def test_pairs_that_are_not_horizontal_and_at_right_angles_are_refused():
    a = np.sin(np.arange(50.0))
    north = ex.Record(0.01, a, azimuth_deg=10.0)
    for azimuth, apart in ((10.0, 0), (190.0, 180), (99.0, 89)):
        other = ex.Record(0.01, a, azimuth_deg=azimuth)
        for call in (ex.rotd_peaks, ex.rotd, lambda *two: ex.turned(*two, 0.0)):
            with pytest.raises(ValueError, match=f"azimuth_deg: of the records is {apart} deg apart, want 90 or 270"):
                call(north, other)
    up = ex.Record(0.01, a, vertical=True, azimuth_deg=100.0)
    for call in (ex.rotd_peaks, ex.rotd, lambda *two: ex.turned(*two, 0.0)):
        with pytest.raises(ValueError, match=r"second=Record\(.*\): is vertical, want a horizontal record"):
            call(north, up)
        with pytest.raises(ValueError, match=r"first=Record\(.*\): is vertical, want a horizontal record"):
            call(up, north)
    # Right angles to either side, and azimuths that are not known, are taken.
    for azimuth in (100.0, 280.0, None):
        assert ex.rotd_peaks(north, ex.Record(0.01, a, azimuth_deg=azimuth)).shape == (3,)


def test_what_was_done_stands_in_the_metadata(quake):
    made = ex.scaled(ex.band_passed(ex.baseline_corrected(quake, 1), 0.1, 25.0), 2.0)
    steps = made.metadata["processing"].split("; ")
    assert [s.split(" ")[0] for s in steps] == ["baseline:", "Butterworth", "scaled"]


def test_trimmed_record_has_the_samples_of_the_span(quake):
    made = ex.trimmed(quake, 2.0, 5.0)
    assert np.array_equal(made.acceleration, quake.acceleration[200:501])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r: ex.baseline_corrected(r, 9), "order=9: want 0 to 6"),
        (lambda r: ex.baseline_corrected(r, 1, "x"), "method='x': want one of"),
        (lambda r: ex.baseline_corrected(ex.Record(0.1, [1.0, 2.0]), 1), "acceleration: has 2 samples, want 4"),
        (lambda r: ex.band_passed(r, None, None), "want one corner frequency"),
        (lambda r: ex.band_passed(r, 0.1, 60.0), r"high=60\.0 Hz: want above 0 and below half the sampling rate, 50"),
        (lambda r: ex.band_passed(r, 5.0, 1.0), r"low=5\.0 Hz: want below high"),
        (lambda r: ex.band_passed(r, 0.0, 1.0), r"low=0\.0 Hz"),
        (lambda r: ex.band_passed(r, 0.1, 1.0, order=0), "order=0: want 1 to 12"),
        (lambda r: ex.band_passed(r, 0.1, 1.0, taper=100.0), r"taper=100\.0 s: want at most half"),
        (lambda r: ex.tapered(r, -1.0), r"length=-1\.0 s"),
        (lambda r: ex.resampled(r, 0.0), r"time_step=0\.0 s"),
        (lambda r: ex.resampled(r, 0.01 * math.pi), "want a ratio to 0.01 s of small whole"),
        (lambda r: ex.resampled(r, 100.0), r"time_step=100\.0 s: want two samples"),
        (lambda r: ex.time_scaled(r, -1.0), r"factor=-1\.0"),
        (lambda r: ex.similar(r, 0.0), r"length_scale=0\.0"),
        (lambda r: ex.trimmed(r, 3.0, 2.0), r"start=3\.0, end=2\.0 s"),
        (lambda r: ex.scaled(r, 0.0), r"factor=0\.0"),
        (lambda r: ex.scaled_to(r), "want exactly one"),
        (lambda r: ex.scaled_to(r, pga=1.0, pgv=1.0), "want exactly one"),
        (lambda r: ex.scaled_to(r, psa=1.0), "want both or neither"),
        (lambda r: ex.scaled_to(r, pga=-1.0), r"pga=-1\.0 m/s\^2"),
        (lambda r: ex.scaled_to(ex.Record(0.1, [0.0, 0.0]), pga=1.0), "pga: of this record is 0"),
        (lambda r: ex.response_spectrum(r, [0.0]), "want positive numbers"),
        (lambda r: ex.response_spectrum(r, [1.0], damping=1.0), r"damping=1\.0 1: want 0 to 0\.999"),
        (lambda r: ex.rotd(r, r, [1.0], percentiles=[101.0]), "want numbers from 0 to 100"),
        (lambda r: ex.rotd(r, r, [1.0], angles=1), "angles=1: want 2 or more"),
        (lambda r: ex.turned(r, r, 0.0), "want two numbers"),
        (lambda r: significant_duration(r, 0.9, 0.1), "want 0 <= low < high <= 1"),
    ],
)
def test_bad_argument_is_named_with_its_value(quake, call, message):
    with pytest.raises(ValueError, match=message):
        call(quake)


def test_a_share_that_stands_still_is_reached_when_it_was_reached():
    """Two equal pulses with rest between them: half of the intensity is there as the first one ends, not later."""
    pulse, rest = np.array([0.0, 1.0, 2.0, 1.0, 0.0]), np.zeros(40)
    record = ex.Record(0.01, np.concatenate([rest, pulse, rest, pulse, rest]))
    first_ends, second_ends = 0.01 * (40 + 4), 0.01 * (40 + 5 + 40 + 4)
    assert significant_duration(record, 0.5, 1.0) == pytest.approx(second_ends - first_ends, abs=1e-9)
