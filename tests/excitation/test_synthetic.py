"""Stochastic motions against the spectra they are made of, published numbers, and repeatability."""

import math

import numpy as np
import pytest

import excitation as ex


def test_kanai_tajimi_spectrum_has_the_published_shape():
    """Kanai-Tajimi alone (filter far below): 1 at f = 0, (1 + 4 z^2)/(4 z^2) at f_g."""
    ground = ex.KanaiTajimi(1.0, 10.0, ground_frequency=2.0, ground_damping=0.3, filter_frequency=1e-6)
    assert ground.shape([0.001, 2.0]) == pytest.approx([1.0, (1 + 4 * 0.09) / (4 * 0.09)], rel=1e-4)
    # Clough & Penzien's factor at its own frequency is 1/(4 y^2), and nothing is left at 0.
    filtered = ex.KanaiTajimi(1.0, 10.0, ground_frequency=1e4, filter_frequency=0.2, filter_damping=0.5)
    assert filtered.shape([0.0, 0.2]) == pytest.approx([0.0, 1.0], abs=1e-6)


def test_mean_square_over_seeds_is_that_asked_for_under_the_envelope():
    """E[a^2](t) = rms^2 E(t)^2; 200 motions, each with some 30 independent stretches in the strong part: 3 %."""
    ground = ex.KanaiTajimi(1.5, 20.0, rise=2.0, strong_end=12.0, decay=0.3)
    motions = np.array([ground.record(0.02, seed).acceleration for seed in range(200)])
    t = 0.02 * np.arange(motions.shape[1])
    mean = np.sqrt(np.mean(motions**2, axis=0))
    strong = (t > 2.0) & (t < 12.0)
    assert np.sqrt(np.mean(mean[strong] ** 2)) == pytest.approx(1.5, rel=0.03)
    late = (t > 16.0) & (t < 17.0)
    assert np.sqrt(np.mean(mean[late] ** 2)) == pytest.approx(1.5 * math.exp(-0.3 * 4.5), rel=0.15)
    assert np.all(motions[:, 0] == 0.0)


def test_mean_spectrum_of_a_stationary_motion_is_kanai_tajimi():
    """Welch's estimate by SciPy of 40 motions without envelope: 15 % where 40 * 40 segments leave 2.5 % of scatter and
    its window's leakage the rest."""
    from scipy.signal import welch

    ground = ex.KanaiTajimi(1.0, 82.0, rise=0.0, strong_end=100.0)
    spectra = []
    for seed in range(40):
        f, power = welch(ground.record(0.02, seed).acceleration, fs=50.0, nperseg=1024)
        spectra.append(power)
    expected = ground.shape(f)
    expected = expected / np.trapezoid(expected, f)
    band = (f > 0.5) & (f < 20.0)
    ratio = np.mean(spectra, axis=0)[band] / expected[band]
    assert np.mean(ratio) == pytest.approx(1.0, abs=0.02)
    assert np.max(np.abs(ratio - 1.0)) < 0.15


def test_moment_and_corner_frequency_are_the_published_ones():
    """Hanks & Kanamori (1979): M 6 is 10^25.05 dyne cm.  Brune (1970) as in Boore (2003): f_c is
    4.9e6 beta (dsigma/M_0)^(1/3) with beta in km/s, bars and dyne cm."""
    source = ex.PointSource(6.0, 30e3, stress_drop=8e6, shear_velocity=3600.0)
    assert source.moment == pytest.approx(10**25.05 * 1e-7, rel=1e-9)
    assert source.corner_frequency == pytest.approx(4.9e6 * 3.6 * (80.0 / 10**25.05) ** (1 / 3), rel=1e-9)
    assert source.duration == pytest.approx(1 / source.corner_frequency + 0.05 * 30.0, rel=1e-12)


def test_point_source_spectrum_has_the_limits_of_the_omega_square_model():
    """Well below f_c: C M_0 (2 pi f)^2/R.  At f_c half of the flat level C M_0 (2 pi f_c)^2/R."""
    source = ex.PointSource(6.0, 20e3, kappa=0.0, quality=1e12)
    c = 0.55 * 2 / math.sqrt(2) / (4 * math.pi * 2800 * 3500**3)
    flat = c * source.moment * (2 * math.pi * source.corner_frequency) ** 2 / 20e3
    f = source.corner_frequency * np.array([1e-3, 1.0, 1e3])
    assert source.spectrum(f) == pytest.approx(flat * np.array([1e-6, 0.5, 1.0]), rel=1e-5)
    lossy = ex.PointSource(6.0, 20e3, kappa=0.05, quality=1e12)
    assert lossy.spectrum(4.0) / source.spectrum(4.0) == pytest.approx(math.exp(-math.pi * 0.05 * 4.0), rel=1e-9)
    # Anelastic attenuation over the path, exp(-pi f R / (Q beta)), for Q = 150 f^0.4.
    along = ex.PointSource(6.0, 20e3, kappa=0.0, quality=150.0, quality_exponent=0.4, shear_velocity=3500.0)
    source = ex.PointSource(6.0, 20e3, kappa=0.0, quality=1e12, shear_velocity=3500.0)
    lost = math.pi * 4.0 * 20e3 / (150.0 * 4.0**0.4 * 3500.0)
    assert along.spectrum(4.0) / source.spectrum(4.0) == pytest.approx(math.exp(-lost), rel=1e-8)


def test_window_peaks_at_a_fifth_and_leaves_five_per_cent_at_its_end():
    """Boore (2003): epsilon = 0.2, eta = 0.05, length twice the duration."""
    source = ex.PointSource(6.0, 20e3)
    length = 2 * source.duration
    t = np.linspace(0.0, length, 10001)
    assert t[np.argmax(source.window(t))] == pytest.approx(0.2 * length, rel=1e-3)
    assert source.window([0.2 * length, length]) == pytest.approx([1.0, 0.05], rel=1e-9)


def test_mean_square_spectrum_over_seeds_is_that_of_the_source():
    """120 motions: a squared amplitude scatters by 100 %, a band of 30 frequencies by 2 %; 8 % is four times it."""
    source = ex.PointSource(5.5, 25e3)
    squares = []
    for seed in range(120):
        a = source.record(0.01, seed).acceleration
        squares.append(np.abs(np.fft.rfft(a, 8192) * 0.01) ** 2)
    f = np.fft.rfftfreq(8192, 0.01)
    ratio = np.mean(squares, axis=0) / np.maximum(source.spectrum(f), 1e-30) ** 2
    for low in (1.0, 2.0, 4.0, 8.0, 16.0, 30.0):
        band = (f >= low) & (f < 1.3 * low)
        assert np.mean(ratio[band]) == pytest.approx(1.0, abs=0.08)


@pytest.mark.parametrize("model", [ex.KanaiTajimi(1.0, 10.0), ex.PointSource(6.0, 20e3)])
def test_same_seed_same_motion_other_seed_another(model):
    first, again, other = (model.record(0.01, seed) for seed in (1, 1, 2))
    assert np.array_equal(first.acceleration, again.acceleration)
    assert not np.array_equal(first.acceleration, other.acceleration)
    assert "seed 1" in first.source


def test_spectrum_matching_meets_a_code_like_target():
    """Plateau and descending branch; looked at with eqsig's independent spectrum too."""
    import eqsig

    periods = np.geomspace(0.1, 3.0, 30)
    target = np.where(periods < 0.5, 6.0, 3.0 / periods)
    start = ex.KanaiTajimi(1.0, 20.0, rise=1.5, strong_end=8.0, decay=0.4).record(0.01, seed=3)
    match = ex.matched(start, periods, target, tolerance=0.03)
    assert match.misfit <= 0.03
    found = ex.response_spectrum(match.record, periods).pseudo_acceleration
    assert np.max(np.abs(found / target - 1.0)) == pytest.approx(match.misfit, rel=1e-9)
    theirs = eqsig.AccSignal(match.record.acceleration, 0.01)
    theirs.generate_response_spectrum(response_times=periods, min_dt_ratio=20)
    # Two ways to sample a response: within a per cent of each other.
    assert theirs.s_a == pytest.approx(target, rel=0.045)
    assert "spectrum matched within" in match.record.metadata["processing"]


def test_a_target_that_is_not_met_is_an_error_that_says_how_close():
    start = ex.KanaiTajimi(1.0, 10.0).record(0.02, seed=3)
    with pytest.raises(ValueError, match=r"tolerance=1e-06: the target is missed by .* at best in 3 rounds"):
        ex.matched(start, [0.1, 0.11, 0.12, 1.0], [9.0, 0.1, 9.0, 1.0], tolerance=1e-6, max_rounds=3)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ex.KanaiTajimi(0.0, 10.0), r"rms=0\.0 m/s\^2"),
        (lambda: ex.KanaiTajimi(1.0, 10.0, rise=5.0, strong_end=4.0), r"strong_end=4\.0 s: want not before rise"),
        (lambda: ex.KanaiTajimi(1.0, 10.0).record(6.0, 1), r"time_step=6\.0 s: want at most half"),
        (lambda: ex.KanaiTajimi(1.0, 10.0).record(0.01, -1), "seed=-1: want 0 or more, a whole number"),
        (lambda: ex.KanaiTajimi(1.0, 10.0).record(0.01, None), "seed=None: want 0 or more"),
        (lambda: ex.PointSource(6.0, 1e4).record(0.01, 1.5), r"seed=1\.5: want 0 or more"),
        (lambda: ex.PointSource(6.0, 1e4).record(0.01, None), "seed=None: want 0 or more"),
        (lambda: ex.PointSource(12.0, 1e4), r"magnitude=12\.0 1: want 0 to 9\.5"),
        (lambda: ex.PointSource(6.0, -1.0), r"distance=-1\.0 m"),
        (lambda: ex.PointSource(6.0, 1e4).record(10.0, 1), r"time_step=10\.0 s: want at most a tenth"),
        (lambda: ex.matched(ex.Record(0.1, [1.0, 2.0]), [1.0], [1.0]), "periods=.*want two or more"),
        (lambda: ex.matched(ex.Record(0.1, [1.0, 2.0]), [1.0, 2.0], [1.0]), "pseudo_acceleration: want positive"),
        (lambda: ex.matched(ex.Record(0.1, [0.0, 0.0]), [1.0, 2.0], [1.0, 1.0]), "record: is all zeros"),
    ],
)
def test_bad_argument_is_named_with_its_value(call, message):
    with pytest.raises(ValueError, match=message):
        call()
