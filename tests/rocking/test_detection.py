"""Start of rocking and fall, read off simulated pickups: how late, how often wrongly.

A pickup here is what rocking.instruments reads, with each impact as the jump of the pickup's velocity spread over a few
milliseconds, as its frequency range would, with noise, an offset and, where it says so, a tilt.
"""

import math

import numpy as np
import pytest

from excitation import RampedSinusoid
from rocking import G_STANDARD, Block, Method1, Method2, Mode, solve
from rocking.detection import detect_onset, detect_overturning
from rocking.instruments import accelerometer

STEP = 0.002  # time step of the records [s]
SPREAD = 0.003  # standard deviation of an impact in the record [s]
G = G_STANDARD


def shocks(run, position, t):
    """What the impacts add to the reading along the block [m/s^2]: jumps of omega times the arms, spread in time."""
    omega, added = run.system.state_names.index("omega"), np.zeros_like(t)
    for k in np.flatnonzero((run.events.guard > 0) & (run.events.mode_before != Mode.REST)):
        s, b = run.events.s_after[k], run.system.block.b
        arms = position[0] + 0.5 * s * b, position[0] - 0.5 * s * b  # from the corner that carried, that carries now
        jump = run.events.y_before[k, omega] * arms[0] - run.events.y_after[k, omega] * arms[1]
        near = np.abs(t - run.events.t[k]) < 6.0 * SPREAD
        added[near] += jump * np.exp(-0.5 * ((t[near] - run.events.t[k]) / SPREAD) ** 2)
    return added / (SPREAD * math.sqrt(2.0 * math.pi))


def pickup(run, *, noise, seed, tilt=0.0, offset=0.4, impacts=True):
    """Reading of a pickup at nine tenths of the height, tilted by so many radians to +x."""
    position = (0.0, 0.9 * run.system.block.h)
    reading = accelerometer(run, position, (math.sin(tilt), math.cos(tilt)))
    if impacts:
        reading = reading + shocks(run, position, run.t)
    return reading + offset + np.random.default_rng(seed).normal(0.0, noise, run.t.size)


def system(method, b, h):
    return Method1(Block(b, h)) if method == "method1" else Method2(Block(b, h), friction=0.7)


def shaken(method, b, h, frequency, final, t_end, duration=90.0):
    motion = RampedSinusoid(frequency, duration, final)
    return solve(system(method, b, h), motion, t_end=t_end, save_at=np.arange(0.0, t_end, STEP))


# The paper's bases: 1 to 5 Hz, growing over 90 s, here to 12 m/s^2.  (noise [m/s^2], latest start that is allowed [s]):
# the first swings last milliseconds and are lost in the noise, the more of it the more of them.
LATEST = [(0.01, 0.3), (0.05, 1.0), (0.2, 2.2)]


@pytest.mark.parametrize("method", ["method1", "method2"])
@pytest.mark.parametrize(("noise", "latest"), LATEST)
@pytest.mark.parametrize("frequency", [1.0, 3.0, 5.0])
def test_start_is_found_after_it_and_soon(method, noise, latest, frequency):
    late = []
    for b, h in ((0.225, 0.75), (0.1, 0.5)):
        run = shaken(method, b, h, frequency, 12.0, 40.0)
        for seed in range(4):
            found = detect_onset(run.t, pickup(run, noise=noise, seed=seed))
            assert found.found
            # The mean of a thousand readings or more, with four of its standard deviations.
            assert found.level == pytest.approx(G + 0.4, abs=4.0 * noise / math.sqrt(1000.0))
            late.append(found.time - run.onset_time)
    # One averaging window earlier at most, which is as sharp as a time can be told.
    assert min(late) > -0.01
    assert max(late) < latest
    # In terms of the amplitude that grows by 12 m/s^2 in 90 s: at most 0.3 m/s^2 of 2 to 3.
    assert max(late) * 12.0 / 90.0 < 0.3


@pytest.mark.parametrize("method", ["method1", "method2"])
def test_start_is_found_without_shocks_in_the_record_too(method):
    run = shaken(method, 0.15, 0.5, 2.0, 12.0, 40.0)
    found = detect_onset(run.t, pickup(run, noise=0.05, seed=1, impacts=False))
    assert 0.0 < found.time - run.onset_time < 3.0


def test_start_is_found_to_a_sample_without_noise():
    run = shaken("method1", 0.15, 0.5, 2.0, 12.0, 30.0)
    found = detect_onset(run.t, pickup(run, noise=0.0, seed=0), window=STEP)
    assert found.noise < 1e-12
    # The block leaves rest with no acceleration: 1e-3 m/s^2 takes a few milliseconds to come.
    assert 0.0 <= found.time - run.onset_time < 0.01


# 1,000 records of a block that stands, 60 s each: the chance is set to 1 %, of a single reading beyond the threshold.
def test_a_block_that_stands_gives_hardly_a_false_alarm():
    t = np.arange(0.0, 60.0, 0.01)
    alarms = {1: 0, 3: 0}
    for seed in range(1000):
        reading = 9.4 + np.random.default_rng(seed).normal(0.0, 0.05, t.size)
        for count in alarms:
            alarms[count] += detect_onset(t, reading, window=0.02, count=count).found
    # Ten are expected, and the noise is known from 300 windows, to 5 %: thrice the ten covers that.
    assert alarms[1] <= 30
    assert alarms[3] == 0


@pytest.mark.parametrize("frequency", [1.0, 4.0])
def test_a_block_that_never_rocks_is_told_so_though_the_pickup_catches_the_base(frequency):
    run = shaken("method1", 0.4, 0.5, frequency, 7.0, 90.0)  # (b/h) g = 7.8 m/s^2
    assert math.isnan(run.onset_time)
    reading = pickup(run, noise=0.02, seed=3, tilt=0.05)
    a_x = run.motion(run.t)[0]
    told = detect_onset(run.t, reading, reference=a_x)
    assert not told.found
    # The tilt, from the share of a_x: 4,500 readings with 0.02 m/s^2 of noise on an a_x of 0.3 m/s^2 rms give it to
    # 0.001, and three times that is allowed.
    assert told.shares[0] == pytest.approx(math.sin(0.05), abs=0.003)
    # Without the base record the growing share of a_x passes for rocking.
    assert detect_onset(run.t, reading).found


@pytest.mark.parametrize("tilt", [0.03, -0.05])
def test_start_is_found_by_a_tilted_pickup_with_the_base_record(tilt):
    run = shaken("method2", 0.15, 0.5, 3.0, 12.0, 40.0)
    found = detect_onset(run.t, pickup(run, noise=0.05, seed=5, tilt=tilt), reference=run.motion(run.t)[0])
    assert -0.01 < found.time - run.onset_time < 1.0


def test_a_knock_on_the_table_is_not_taken_for_rocking():
    run = shaken("method1", 0.15, 0.5, 2.0, 12.0, 40.0)
    reading = pickup(run, noise=0.05, seed=2)
    knock = np.abs(run.t - 12.0) < 0.008
    reading[knock] += 3.0
    assert detect_onset(run.t, reading, count=1).time == pytest.approx(12.0, abs=0.02)
    assert -0.01 < detect_onset(run.t, reading).time - run.onset_time < 1.0


def fallen(run, *, noise, seed, lying=2.0):
    """(t, a_z, a_x) of a run that ends in the fall, and of the block on its side for a while after it."""
    extra = run.t[-1] + STEP * np.arange(1, round(lying / STEP) + 1)
    t = np.concatenate([run.t, extra])
    a_x = run.motion(t)[0]
    on_its_side = 0.4 + run.side * a_x[run.t.size :] + np.random.default_rng(1000 + seed).normal(0.0, noise, extra.size)
    return t, np.concatenate([pickup(run, noise=noise, seed=seed), on_its_side]), a_x


FALLS = [
    (method, b, h, frequency, final)
    for method in ("method1", "method2")
    for b, h in ((0.3, 1.0), (0.15, 0.5), (0.1, 0.5))
    for frequency in (1.0, 2.0, 3.0)
    for final in (15.0, 30.0)
]


def falls():
    """Runs of which the block falls within 30 s."""
    runs = [shaken(method, b, h, f, final, 30.0, duration=30.0) for method, b, h, f, final in FALLS]
    return [run for run in runs if run.overturned]


def test_a_fall_is_found_between_the_balance_and_the_floor_and_on_the_right_side():
    late = []
    runs = falls()
    assert len(runs) >= 20
    for run in runs:
        for seed in range(2):
            t, a_z, a_x = fallen(run, noise=0.05, seed=seed)
            found = detect_overturning(t, a_z, a_x=a_x)
            assert found.found
            assert found.side == run.side
            assert run.overturning_time < found.time < run.t_end + 0.01
            assert found.upright_until < found.time
            late.append((found.time - run.overturning_time) * run.system.block.p(G))
    # In units of 1/p (0.19 to 0.27 s here): what a block takes from the balance to the floor, most of it near the
    # balance.  Where a ramp reaches overturning in 30 s or more, 0.7 s of it are some 2 % of the amplitude.
    assert 1.0 < np.median(late) < 2.5
    assert max(late) < 3.6


def test_a_record_that_stops_at_the_floor_tells_of_the_fall_too():
    late = []
    for run in falls():
        found = detect_overturning(run.t, pickup(run, noise=0.05, seed=1))
        assert found.found
        assert found.time < run.t_end
        late.append((found.time - run.overturning_time) * run.system.block.p(G))
    assert min(late) > -0.5
    assert max(late) < 3.6


def test_without_the_base_record_the_moment_is_blurred_by_half_a_period_at_most():
    for run in falls()[::3]:
        t, a_z, _ = fallen(run, noise=0.05, seed=1)
        found = detect_overturning(t, a_z)
        assert found.side == 0
        period = 1.0 / run.motion.frequency
        assert run.overturning_time < found.time < run.t_end + 0.5 * period


@pytest.mark.parametrize("method", ["method1", "method2"])
@pytest.mark.parametrize("frequency", [2.0, 5.0])
def test_a_block_that_rocks_and_does_not_fall_is_told_so(method, frequency):
    run = shaken(method, 0.3, 1.0, frequency, 12.0, 60.0)
    assert not run.overturned
    assert run.peak_rotation > 0.01
    assert len(run.impact_times) > 500
    for seed in range(3):
        assert not detect_overturning(run.t, pickup(run, noise=0.1, seed=seed), a_x=run.motion(run.t)[0]).found


T = np.arange(0.0, 10.0, 0.01)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: detect_onset(T, T[1:]), r"t, a_z: shapes \(1000,\) and \(999,\)"),
        (lambda: detect_onset(T, np.where(T > 9.0, math.nan, T)), r"t, a_z: want finite numbers"),
        (lambda: detect_onset(T**2, T), r"t: want ascending times at equal steps"),
        (lambda: detect_onset(T, T, quiet=(0.0, 0.1)), r"quiet=\(0, 0\.1\) s: want at least 20 windows of 0\.01 s"),
        (lambda: detect_onset(T, T, quiet=(20.0, 30.0)), r"quiet=\(20, 30\) s: want at least 20 samples"),
        (lambda: detect_onset(T, T, window=0.0), r"window=0\.0 s"),
        (lambda: detect_onset(T, T, false_alarm=1.0), r"false_alarm=1\.0: want above 0 and below 1"),
        (lambda: detect_onset(T, T, count=0), r"count=0: want 1 or more"),
        (lambda: detect_onset(T, T, reference=T[:5]), r"reference: shape \(1, 5\)"),
        (lambda: detect_onset(T, T, reference=0.0 * T), r"reference: tells nothing while the block stands"),
        (lambda: detect_overturning(T, T, a_x=T[:5]), r"a_x: shape \(5,\)"),
        (lambda: detect_overturning(T, T, g=-1.0), r"g=-1\.0 m/s\^2"),
    ],
)
def test_bad_argument_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


# A step of 0.5 m/s^2 in a record without noise: the mean over 11 samples about a reading knows of it 5 samples before.
def test_a_start_is_early_by_half_a_window_and_no_more_where_there_is_no_noise():
    t = np.arange(0.0, 20.0, 0.001)
    found = detect_onset(t, G + np.where(t >= 12.0, 0.5, 0.0), window=0.011)
    assert found.time == pytest.approx(12.0 - 0.005, abs=1e-9)


# The reading leaves the level at 12 s and counts from 12.98 s on (a threshold of 0.01 m/s^2): the knock at 13.5 s is
# not within the second that begins where it is 0.001 m/s^2, of which the rise, 0.01 m/s^2 in 0.98 s, is the largest.
def test_the_departure_is_that_of_the_second_from_the_start_on():
    t = np.arange(0.0, 20.0, 0.01)
    reading = G + np.maximum(t - 12.0, 0.0) * 0.01 / 0.98 + np.where(np.abs(t - 13.5) < 0.05, 3.0, 0.0)
    found = detect_onset(t, reading, window=0.01, resolution=0.01)
    assert 12.0 < found.time < 12.2
    assert found.departure == pytest.approx((found.time + 0.99 - 12.0) * 0.01 / 0.98, abs=1e-9)


# The pickup of a block that lies reads the same on either side of a base at rest.
def test_a_fall_on_a_base_at_rest_tells_no_side():
    t = np.arange(0.0, 20.0, 0.01)
    found = detect_overturning(t, np.where(t < 15.0, G, 0.0), a_x=np.zeros_like(t))
    assert found.time == pytest.approx(15.0, abs=0.011)
    assert found.side == 0


# For a second it turns so fast that the pickup reads less than gravity, and then it lies: it stood before that second.
def test_a_block_was_upright_until_its_pickup_last_read_gravity() -> None:
    t = np.arange(0.0, 20.0, 0.005)
    read = np.select([t < 2.0, t < 14.0, t < 15.0], [G, G + 0.2, G - 1.0], 0.0)
    found = detect_overturning(t, read)
    assert found.time == pytest.approx(15.0, abs=0.01) and found.upright_until == pytest.approx(14.0, abs=0.02)
