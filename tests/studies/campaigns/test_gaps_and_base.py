"""Missing samples, and base motions made whole and finer."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from rocking import Method1, solve
from studies.campaigns import CampaignError
from studies.campaigns.signals import base_motion, fill_error, gaps, interpolated, upsampled, whole_base

from .conftest import BASE, BLOCK, STEP, read_only


def holed(test, *places):
    values = test.data["base_x"].copy()
    for a, b in places:
        values[a:b] = np.nan
    return replace(test, data={**test.data, "base_x": read_only(values)})


def test_gaps_are_listed():
    values = np.arange(10.0)
    values[[0, 3, 4, 9]] = np.nan
    assert [(g.start, g.stop, g.size) for g in gaps(values)] == [(0, 1, 1), (3, 5, 2), (9, 10, 1)]
    assert gaps(np.arange(5.0)) == []


def test_interpolation_is_exact_for_a_cubic():
    u = np.linspace(-1, 1, 50)
    values = 1 + u - 2 * u**2 + 3 * u**3
    broken = values.copy()
    broken[[10, 11, 12, 30]] = np.nan
    broken[0] = np.nan
    filled = interpolated(broken)
    assert np.isnan(filled[0]) and filled[1:] == pytest.approx(values[1:], abs=1e-13)


def test_short_gaps_of_the_base_are_filled(campaign):
    test = campaign.test("ramp-3Hz")
    broken = holed(test, (300, 302), (700, 705))
    filled = whole_base(broken, "base_x")
    # 3 Hz at 250 Hz: what is left is the noise of the neighbours, 0.004 m/s^2, enlarged by the gap.
    assert np.max(np.abs(filled - test.base_x)) < 0.05
    assert np.array_equal(filled[:300], test.base_x[:300])


@pytest.mark.parametrize(
    ("place", "said"),
    [((700, 706), "6 samples missing from 2.8 s on, in a row, longer than 0.025 s"),
     ((0, 1), "at an end"), ((1495, 1501), "at an end")],
)  # fmt: skip
def test_other_gaps_of_the_base_are_an_error_of_that_test(campaign, place, said):
    broken = holed(campaign.test("ramp-3Hz"), place)
    with pytest.raises(CampaignError, match=f"test 'ramp-3Hz': base_x has .*{said}"):
        base_motion(broken)


def test_the_error_of_filling_is_measured():
    """Against gaps of the same size at other places, whose samples are known."""
    t = STEP * np.arange(4000)
    values = np.sin(2 * np.pi * 8.0 * t)
    stated = fill_error(values, 5)
    actual = []
    for start in range(37, 3900, 61):
        broken = values.copy()
        broken[start : start + 5] = np.nan
        actual.append(interpolated(broken)[start : start + 5] - values[start : start + 5])
    assert stated == pytest.approx(np.sqrt(np.mean(np.square(actual))), rel=0.2)
    assert fill_error(values, 1) < stated < fill_error(values, 12)
    assert np.isnan(fill_error(values[:10], 5))


def test_upsampling_keeps_the_samples_and_the_curve(campaign):
    values = campaign.test("ramp-3Hz").base_x
    fine = upsampled(values, 4)
    assert fine.size == 4 * (values.size - 1) + 1 and np.array_equal(fine[::4], values)
    curve = CubicSpline(np.arange(values.size), values)
    u = np.random.default_rng(1).uniform(0, values.size - 1, 500)
    # A cubic spline with nodes added on it is itself.
    assert CubicSpline(np.arange(fine.size) / 4, fine)(u) == pytest.approx(curve(u), abs=1e-12)
    assert upsampled(values, 1) is not values


def test_motion_runs_the_recorded_base_and_nothing_outside(campaign):
    test = campaign.test("ramp-3Hz")
    motion = base_motion(test)
    a_x, a_z = motion(test.time)
    assert a_x == pytest.approx(test.base_x, abs=1e-12) and not np.any(a_z)
    assert not np.any(motion(np.array([-0.1, test.time[-1] + 0.1]))[0])
    finer = base_motion(test, factor=4)
    u = np.linspace(0.0, test.time[-1], 999)
    assert finer(u)[0] == pytest.approx(motion(u)[0], abs=1e-11) and finer.max_step == pytest.approx(STEP / 4)


def test_a_base_may_be_held_after_its_record(campaign):
    test = campaign.test("ramp-3Hz")
    motion = base_motion(test, outside="hold", until=7.0)
    later = motion(np.array([6.1, 6.9]))[0]
    assert later == pytest.approx(test.base_x[-1], abs=1e-9) and motion(np.array([7.5]))[0] == 0.0
    with pytest.raises(ValueError, match="want 'zero', or 'hold' with a time"):
        base_motion(test, outside="hold")


def test_the_motion_moves_a_block_as_the_true_one_does(campaign):
    """From the recorded base (noise 0.004 m/s^2) to rotation: close until late hops differ."""
    test = campaign.test("ramp-4Hz")
    run = solve(Method1(BLOCK, restitution=0.92), base_motion(test), t_end=test.time[-1], save_at=test.time.copy())
    assert np.sqrt(np.mean((run.theta - test.rotation) ** 2)) < 5e-3


def test_vertical_base_and_tests_without_a_base(campaign):
    test = campaign.test("ramp-3Hz")
    vertical = replace(BASE, name="base_z", kind="base_acceleration_z")
    both = replace(
        test, channels=(*test.channels, vertical), data={**test.data, "base_z": read_only(0.1 * test.base_x)}
    )
    assert base_motion(both)(test.time)[1] == pytest.approx(0.1 * test.base_x, abs=1e-12)
    alone = replace(both, channels=(vertical,), data={"base_z": both.data["base_z"]})
    with pytest.raises(CampaignError, match="vertical base motion alone"):
        base_motion(alone)
    assert base_motion(campaign.test("free-01")) is None


@pytest.mark.parametrize(("values", "factor"), [(np.ones(9), 0), (np.array([1.0, np.nan, 2.0, 3.0]), 2)])
def test_upsampling_wants_whole_records(values, factor):
    with pytest.raises(ValueError, match="want"):
        upsampled(values, factor)
