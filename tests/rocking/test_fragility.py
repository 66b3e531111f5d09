"""Fragilities: fits against simulated truth and plain minimisation, intervals against tables, and chaotic blocks."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import norm

from excitation import KanaiTajimi, RampedSinusoid, scaled
from rocking import Block, Method1, solve_batch
from rocking.effects import compose, load
from rocking.fragility import fragility, run_records
from rocking.fragility_fit import LognormalFragility, fit_lognormal, fraction

MEDIAN, BETA = 0.46, 0.35


def simulated(seed, cases, *, median=MEDIAN, beta=BETA):
    """Intensities and outcomes of cases whose needed intensity is lognormal."""
    rng = np.random.default_rng(seed)
    im = np.exp(rng.uniform(math.log(median) - 1.0, math.log(median) + 1.0, cases))
    return im, im > median * np.exp(beta * rng.standard_normal(cases))


def test_fit_recovers_the_parameters_of_many_cases():
    fit = fit_lognormal(*simulated(0, 40_000))
    # Three standard deviations as the fit states them; they are 0.3 % and 0.8 %.
    errors = np.sqrt(np.diag(fit.covariance))
    assert errors == pytest.approx([0.003, 0.008], rel=0.3)
    assert abs(math.log(fit.median / MEDIAN)) < 3.0 * errors[0]
    assert abs(math.log(fit.beta / BETA)) < 3.0 * errors[1]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("units", [1.0, 981.0])
def test_fit_is_the_maximum_that_a_plain_search_finds(seed, units):
    im, exceeded = simulated(seed, 80)
    im = units * im

    def minus_log_likelihood(x):
        z = np.log(im / math.exp(x[0])) / math.exp(x[1])
        return -np.sum(np.where(exceeded, norm.logcdf(z), norm.logsf(z)))

    found = minimize(
        minus_log_likelihood, [math.log(units * 0.5), -1.0], method="Nelder-Mead",
        options={"xatol": 1e-10, "fatol": 1e-12, "maxiter": 4000},
    )  # fmt: skip
    fit = fit_lognormal(im, exceeded)
    # A search by values alone cannot tell points apart below the root of the rounding of the likelihood, 1e-7.
    assert [math.log(fit.median), math.log(fit.beta)] == pytest.approx(found.x, abs=1e-6)
    assert fit.log_likelihood == pytest.approx(-found.fun, rel=1e-12)
    # The covariance is the inverse of the second differences of that very function.
    step = 1e-4
    at = np.array([math.log(fit.median), math.log(fit.beta)])
    curvature = np.empty((2, 2))
    for i in range(2):
        for j in range(2):
            corners = [(a, b) for a in (step, -step) for b in (step, -step)]
            curvature[i, j] = sum(
                np.sign(a * b) * minus_log_likelihood(at + a * np.eye(2)[i] + b * np.eye(2)[j]) for a, b in corners
            ) / (4.0 * step**2)
    assert np.linalg.inv(curvature) == pytest.approx(fit.covariance, rel=1e-4)


# 95 % intervals of 400 samples of 100 cases: their coverage has a standard deviation of 1.1 %.
def test_intervals_cover_the_truth_as_often_as_they_say():
    covered = np.zeros(2)
    for seed in range(400):
        fit = fit_lognormal(*simulated(1000 + seed, 100))
        (low, high), (beta_low, beta_high) = fit.intervals(0.95)
        covered += [low < MEDIAN < high, beta_low < BETA < beta_high]
    assert np.all(np.abs(covered / 400 - 0.95) < 0.035)


# 20 records at 8 scales each: the outcomes of one record hang together completely, since a record that needs a certain
# intensity exceeds at every scale beyond it.
def test_intervals_allow_for_records_that_come_at_several_scales():
    scales = np.geomspace(0.2, 1.1, 8)
    covered = {"grouped": 0, "plain": 0}
    for seed in range(300):
        needed = MEDIAN * np.exp(BETA * np.random.default_rng(seed).standard_normal(20))
        im, records = np.repeat(scales, 20), np.tile(np.arange(20), 8)
        outcomes = im > np.tile(needed, 8)
        for name, groups in (("grouped", records), ("plain", None)):
            fit = fit_lognormal(im, outcomes, groups)
            low, high = fit.intervals()[0]
            covered[name] += low < MEDIAN < high
    # Twenty independent records are few for a normal limit, which is why 0.95 is not quite reached.
    assert 0.90 < covered["grouped"] / 300 <= 0.97
    # Taking 160 outcomes for independent makes the interval too narrow by far.
    assert covered["plain"] / 300 < 0.85


def test_probability_of_a_fit_is_the_lognormal():
    fit = LognormalFragility(2.0, 0.5, np.eye(2), 0.0)
    # Phi(ln(im/2)/0.5) for im = 2, 2 e^0.5, 2 e^-1: Phi(0), Phi(1), Phi(-2).
    assert fit.probability([2.0, 2.0 * math.exp(0.5), 2.0 * math.exp(-1.0), 0.0]) == pytest.approx(
        [0.5, 0.8413447460685429, 0.0227501319481792, 0.0], abs=1e-14
    )


X = [0.1, 0.2, 0.3, 0.4]


@pytest.mark.parametrize(
    ("im", "exceeded", "message"),
    [
        (
            X,
            [0, 0, 1, 1],
            r"no case does up to im=0\.2, every one from 0\.3 on; the median is between the two, and beta",
        ),
        ([0.1, 0.2, 0.2, 0.4], [0, 0, 1, 1], r"no case does up to im=0\.2, every one from 0\.2 on"),
        (X, [0, 0, 0, 0], r"no case does, up to im=0\.4; the median is not below that"),
        (X, [1, 1, 1, 1], r"every case does, from im=0\.1 on; the median is not above that"),
        (X, [1, 1, 0, 0], r"every case does up to im=0\.2, none from 0\.3 on; no fragility rises"),
        (X, [1, 0, 1, 0], r"weaker cases exceed more often than stronger ones"),
        ([1.0] * 4, [0, 1, 0, 1], r"no case does up to im=1, every one from 1 on"),
        ([0.0, 1.0], [0, 1], r"im: want positive finite numbers"),
        (X, [0, 1, 2, 1], r"exceeded: want False or True"),
        (X, [0, 1], r"im, exceeded: shapes \(4,\) and \(2,\)"),
    ],
)
def test_outcomes_without_an_estimate_are_refused_with_the_reason(im, exceeded, message):
    with pytest.raises(ValueError, match=message):
        fit_lognormal(im, exceeded)


def test_two_cases_that_overlap_by_a_hair_have_an_estimate():
    # Three stay and three go, one pair the wrong way round by 1 %: a steep fragility, and no absurd one.
    fit = fit_lognormal([0.5, 0.7, 1.01, 1.0, 1.4, 2.0], [0, 0, 0, 1, 1, 1])
    assert 0.9 < fit.median < 1.1
    assert 0.001 < fit.beta < 0.2


# Clopper & Pearson (1934) by the beta distribution: 0 of 10 has the upper bound 1 - 0.025^(1/10); 10 of 10 its mirror.
# Wilson (1927) written out for z = 1.959964.
def test_intervals_of_fractions_are_those_of_their_authors():
    share, low, high = fraction([0, 10], 10)
    assert share.tolist() == [0.0, 1.0]
    assert high[0] == pytest.approx(1.0 - 0.025**0.1, rel=1e-9)
    assert low[1] == pytest.approx(0.025**0.1, rel=1e-9)
    _, low, high = fraction(7, 20, interval="wilson")
    z, p, n = 1.959963984540054, 0.35, 20
    middle, half = (p + z * z / (2 * n)), z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    assert [low, high] == pytest.approx(
        [(middle - half) / (1 + z * z / n), (middle + half) / (1 + z * z / n)], rel=1e-9
    )
    assert np.isnan(fraction(0, 0)[0])
    with pytest.raises(ValueError, match="exceeded, total: want whole numbers"):
        fraction(11, 10)
    with pytest.raises(ValueError, match="interval='wald'"):
        fraction(1, 10, interval="wald")


SCALES = [0.9, 1.0, 1.1, 1.122, 1.2, 1.35]


@pytest.fixture(scope="module")
def records():
    """200 synthetic motions of 10 s, with 1 m/s^2 rms in their strong part."""
    return [KanaiTajimi(1.0, 10.0, strong_end=8.0).record(0.01, seed) for seed in range(200)]


@pytest.fixture(scope="module")
def runs(records):
    """One block under the motions at six scales, two of them 2 % apart."""
    return run_records(
        Method1(Block(0.15, 0.6)), records, SCALES, lambda record, k: scaled(record, k).motion(), t_end=11.0,
        intensity=np.ones(200), intensity_name="rms of the strong part", intensity_units="m s-2",
    )  # fmt: skip


# Yim, Chopra & Penzien (1980): no rule for the single response, and a regular dependence of the probability.
def test_single_responses_scatter_while_their_statistics_repeat(runs):
    fell, tilt = runs.overturned.values, runs.relative_rotation.values
    weaker, stronger = SCALES.index(1.1), SCALES.index(1.122)
    # 2 % stronger motions: one in ten blocks or more that fell does not, ...
    saved = fell[weaker] & ~fell[stronger]
    assert saved.sum() > 0.1 * fell[weaker].sum()
    # ... and of the blocks that stand both times, more than half tilt by 10 % more or less (2 % if it were linear).
    stand = ~fell[weaker] & ~fell[stronger]
    ratio = tilt[stronger, stand] / tilt[weaker, stand]
    assert np.mean(np.abs(ratio - 1.0) > 0.1) > 0.5
    assert ratio.min() < 0.5
    assert ratio.max() > 2.0
    # The fraction that falls rises with the scale, and two halves of the records agree on it and on the fragility.
    assert np.all(np.diff(fell.mean(axis=1)[[0, 1, 2, 4, 5]]) > 0.0)
    halves = [fragility(runs.isel(record=slice(i, i + 100)), limits=[0.5]) for i in (0, 100)]
    for p, q in zip(halves[0].fraction.values.ravel(), halves[1].fraction.values.ravel(), strict=True):
        middle = 0.5 * (p + q)
        # Three standard deviations of the difference of two fractions of 100.
        assert abs(p - q) <= 3.0 * math.sqrt(2.0 * middle * (1.0 - middle) / 100.0) + 1e-12
    medians = np.array([half["median"].values for half in halves])
    # Stated 95 % intervals are some +-2 % wide: the halves differ by less than both together.
    assert np.abs(np.log(medians[0] / medians[1])).max() < 0.05
    for a, b in (halves, halves[::-1]):
        assert np.all(a.median_low.values < b.median_high.values)


def test_the_dataset_says_what_it_holds_and_survives_a_file(runs, tmp_path):
    import xarray as xr

    ds = fragility(runs, limits=[0.5, 1.0])
    assert ds.sizes == {"limit": 3, "scale": 6}
    assert ds["median"].attrs["units"] == "m s-2"
    assert ds.attrs["intensity"] == "rms of the strong part"
    assert all("units" in ds[name].attrs for name in ds.data_vars if name != "reason")
    # A larger limit is exceeded less often, and overturning is the rarest.
    assert np.all(np.diff(ds.fraction.values, axis=0) <= 0.0)
    assert np.all(np.diff(ds["median"].values) >= 0.0)
    assert np.all((ds.fraction_low <= ds.fraction) & (ds.fraction <= ds.fraction_high))
    ds.to_netcdf(tmp_path / "fragility.nc")
    with xr.open_dataset(tmp_path / "fragility.nc") as again:
        xr.testing.assert_allclose(again.drop_vars("reason"), ds.drop_vars("reason"))


@pytest.mark.parametrize("names", [("overturned", "relative_rotation", "intensity"), ("intensity",)])
def test_the_order_of_the_dimensions_says_nothing(runs, names):
    import xarray as xr

    turned = runs.assign({name: runs[name].transpose("record", "scale") for name in names})
    xr.testing.assert_identical(fragility(turned, limits=[0.5]), fragility(runs, limits=[0.5]))


def test_the_fit_describes_the_fractions_of_the_blocks(runs):
    ds = fragility(runs)
    fit = fit_lognormal(runs.intensity.values.ravel(), runs.overturned.values.ravel())
    expected = fit.probability(SCALES)
    # Each fraction of 200 within its own 95 % interval.
    assert np.all((ds.fraction_low.values[-1] < expected) & (expected < ds.fraction_high.values[-1]))


def test_the_likelihood_tells_a_good_measure_of_intensity_from_a_poor_one(runs, records):
    # The same outcomes: the rms with which the motions were made describes them far better than their peak velocity,
    # in which a slow wave counts that a block of this size does not feel.
    velocity = np.multiply.outer(SCALES, [float(np.abs(record.velocity).max()) for record in records])
    outcomes = runs.overturned.values.ravel()
    by_rms = fit_lognormal(runs.intensity.values.ravel(), outcomes)
    by_velocity = fit_lognormal(velocity.ravel(), outcomes)
    assert by_rms.log_likelihood > by_velocity.log_likelihood + 50.0
    assert by_velocity.beta > 2.0 * by_rms.beta


def test_where_nothing_falls_the_reason_stands_in_the_dataset():
    records = [KanaiTajimi(0.5, 5.0).record(0.01, seed) for seed in range(5)]
    few = run_records(
        Method1(Block(0.4, 0.6)), records, [0.5, 1.0], lambda record, k: scaled(record, k).motion(), t_end=6.0
    )
    ds = fragility(few)
    assert math.isnan(ds["median"].values[0])
    assert "no case does, up to im=1" in str(ds.reason.values[0])


# A block on two ribs half as far apart balances at atan((b/4) / (h/2)); its largest rotations are those of the batch.
def test_rotations_are_relative_to_the_balance_of_the_block_with_its_effects():
    system, ribs = Method1(Block(0.3, 1.0)), [load("concave_base")(breadth=0.15)]
    waves = [3.0, 4.0]
    few = run_records(system, waves, [2.0, 3.0], lambda f, k: RampedSinusoid(f, 4.0, k), t_end=6.0, effects=ribs)
    peak = solve_batch(
        compose(system, ribs), [RampedSinusoid(f, 4.0, k) for k in (2.0, 3.0) for f in waves], t_end=6.0
    ).peak_rotation
    assert few.relative_rotation.values.ravel() == pytest.approx(peak / math.atan2(0.075, 0.5), rel=1e-12)
    assert few.attrs["effects"] == "ConcaveBase(breadth=0.15)"
    assert fragility(few).attrs["effects"] == few.attrs["effects"]


MOTION = [KanaiTajimi(0.5, 5.0).record(0.01, 0)]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"records": []}, "records: none given"),
        ({"scales": [1.0, 0.5]}, r"scales=\[1\.0, 0\.5\]: want positive numbers in ascending order"),
        ({"intensity": [1.0, 2.0]}, r"intensity: want positive numbers of shape \(1,\)"),
        ({"intensity": [-1.0]}, r"intensity: want positive numbers"),
    ],
)
def test_bad_argument_is_named(arguments, message):
    call = {"records": MOTION, "scales": [1.0], "build": lambda record, k: scaled(record, k).motion()} | arguments
    with pytest.raises(ValueError, match=message):
        run_records(Method1(Block(0.15, 0.6)), t_end=1.0, **call)


def test_two_records_at_several_scales_tell_no_intervals(runs):
    """Twelve outcomes of two records are no twelve facts, and how far two records differ is no estimate."""
    fell = np.array([[0, 0], [0, 1], [1, 0], [0, 1], [1, 1], [1, 1]], dtype=bool)
    few = runs.isel(record=slice(0, 2)).assign(overturned=(("scale", "record"), fell))
    found = fragility(few).isel(limit=-1)
    expected = fit_lognormal(few.intensity.values.ravel(), fell.ravel())
    assert (float(found["median"]), float(found.beta)) == pytest.approx((expected.median, expected.beta), rel=1e-12)
    assert str(found.reason.values) == "intervals: of 2 records at 6 scales, want 3 records or more"
    assert np.isnan([found[name] for name in ("median_low", "median_high", "beta_low", "beta_high")]).all()
    assert np.isfinite(found.fraction_low).all()
    # At one scale each record is a fact.
    assert "intervals" not in str(fragility(few.isel(scale=[1])).reason.values[-1])
