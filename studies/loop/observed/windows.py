"""Records cut into windows that a model can predict: one swing, several, or the whole record.

Under shaking a small difference grows with each impact, so that a model which is nearly right predicts one half-swing
and not a record.  A window begins at the peak of a swing with a state of its own, which is fitted along with it, or
at the start of the record, from rest or from the lean at release.

Status   windows that begin from rest are whole records only; hops that stay within the noise are in no swing window.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studies.campaigns import Channel, DeclaredBlock, Test
from studies.campaigns.clipping import before_overturning, clipped
from studies.campaigns.smoothing import state
from studies.campaigns.swings import Segmentation, segment
from studies.loop.runs.simulation import NEVER, Peak, Struck

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

PEAK_OVER_NOISE = 12.0
"""Peaks below this many standard deviations begin or end no window."""

SIDE = Channel("side", "rotation")
"""Not a sensor: that the true rotation passes zero where accelerometers show the side to change."""

ANY_SIDE = 9

NEAR_IMPACTS = 2.5
"""Samples about an impact of which what accelerometers read is left out."""

SHARPEST = 1e-12
"""Least variance of the square of a speed [rad^4/s^4]: a record without noise says nothing for certain either."""

BY_THE_BASE = 0.5
"""Share by which shaking may change the square of a speed, one standard deviation."""

RELEASE_SD = 2e-3
"""How far from what was aimed at a lean by hand may be [rad], one standard deviation."""


@dataclass(frozen=True)
class Record:
    """The record of a test as the loop uses it."""

    test: int  # index
    kind: str  # "free" or "forced"
    time: Array  # [s]
    rotation: Array  # reading [rad], NaN where missing, clipped or after a fall; or what accelerometers say of it
    noise: float  # one standard deviation [rad]
    lean: float  # reading at the start [rad]
    lean_sd: float  # 0 where the block starts at rest
    found: Segmentation
    channels: tuple[Channel, ...]  # that are compared
    recorded: Array  # their readings, shape (channel, time), NaN where missing, clipped or after a fall
    observed: Array  # those that are fitted: as recorded, NaN near impacts for accelerometers
    noises: Array  # their standard deviations, shape (channel, time)
    felt: Array | None = None  # what the base sensor's noise does to them sample by sample, shape (channel, time)
    sides: NDArray[np.int64] | None = None  # +1, -1, 0 at rest, `ANY_SIDE` where not known, shape (time,)
    lean_read: bool = True  # whether the lean was read by the sensor; else it is the rotation that was aimed at
    struck: Struck = NEVER  # impacts of the tests before
    squares: tuple[float, ...] = ()  # of the speeds at which the swings ended [rad^2/s^2], where `in_order` was asked


@dataclass(frozen=True)
class Window:
    """A part of a record, with the state at its start and what is known of that beforehand."""

    record: int  # index into the records
    test: int  # index of the test
    start: float  # [s]
    times: Array  # [s]
    index: Indices  # of the times among the samples of the test
    channels: tuple[Channel, ...]
    there: Indices  # which of the readings at the times, stacked channel by channel, have data
    data: Array  # readings [unit of the channel], finite, shape (datum,)
    noise: Array  # one standard deviation of the sensor [unit of the channel], shape (datum,)
    theta: float  # rotation at the start [rad]
    omega: float  # angular velocity at the start [rad/s]
    theta_sd: float  # prior standard deviation about `theta`; inf: free, 0: fixed
    omega_sd: float
    theta_prior: float = 0.0  # reading [rad] that the prior is about, or rotation if it was not read
    lean_read: bool = True  # which of the two
    sd: Array | None = None  # standard deviation of each datum, where it is more than the noise
    felt: Array | None = None  # what the base sensor's noise does to each datum at once, as an accelerometer reads it
    sides: NDArray[np.int64] | None = None  # at the times; accelerometers are compared where the model is on this side
    history: tuple[
        Peak, ...
    ] = ()  # readings at the peaks before the start, from which slip and the like is carried over
    seen: Peak | None = None  # the state at the start as the record alone shows it
    struck: Struck = NEVER  # the impacts before the start
    by_base: float = 0.0  # of the sum of squares over `sd`, what is the base sensor's on average, the state fitted [1]

    @property
    def weights(self) -> Array:
        """One over the standard deviation of each datum [1/unit of the channel]."""
        return 1.0 / (self.noise if self.sd is None else self.sd)

    @property
    def accelerometers(self) -> bool:
        """Whether it holds accelerometers on the block."""
        return any(channel.kind == "block_acceleration" for channel in self.channels)

    def moved(self, theta: float, omega: float) -> Window:
        """The window with another state at its start."""
        return replace(self, theta=theta, omega=omega)

    def until(self, stop: float) -> Window:
        """The part of the window up to a time [s]."""
        count = int(np.searchsorted(self.times, stop + 1e-12))
        channel, k = np.divmod(self.there, self.times.size)
        kept = k < count
        return replace(
            self, times=self.times[:count], index=self.index[:count], there=channel[kept] * count + k[kept],
            data=self.data[kept], noise=self.noise[kept], sd=None if self.sd is None else self.sd[kept],
            felt=None if self.felt is None else self.felt[kept],
            sides=None if self.sides is None else self.sides[:count],
        )  # fmt: skip


def struck_before(record: Record, time: float) -> Struck:
    """The impacts before some time [s] that ended a swing; one of which a gap holds the time counts from the gap.

    With them those of the tests before.
    """
    swings, found = record.found.swings, record.struck
    squares = record.squares or (0.0,) * len(swings)
    for k, swing in enumerate(swings):
        seen = record.found.bounds(k)[1]
        end = seen if math.isfinite(seen) else float(record.time[min(swing.stop, record.time.size - 1)])
        if end >= time:
            break
        after = swings[k + 1] if k + 1 < len(swings) else None
        # A gap may lie within a swing: then both its parts are to one side, and no impact between them.
        if after is not None and after.side == swing.side and np.isnan(record.rotation[swing.stop : after.start]).any():
            continue
        found = Struck(found.impacts + 1, time - end, found.in_all + 1, found.squares + squares[k])
    return found


def squares_of_speeds(found: Segmentation, block: DeclaredBlock, shaken: bool) -> tuple[float, ...]:
    """Square of the speed at which each swing ended [rad^2/s^2].

    What gravity gives a slender block on its way down from the peak, by as much more or less as those are that
    were seen; of a block that is shaken, together with what was seen of that swing itself.
    """
    peaks = np.abs([s.peak for s in found.swings])
    fallen = np.maximum(block.p() ** 2 * peaks * (2.0 * block.alpha - peaks), 0.0)
    seen, variance = np.zeros(peaks.size), np.full(peaks.size, np.inf)
    for i in found.impacts:
        if math.isfinite(i.before) and math.isfinite(i.before_sd):
            seen[i.swing] = i.before**2 - i.before_sd**2
            variance[i.swing] = max((2.0 * i.before * i.before_sd) ** 2 + i.before_sd**4, SHARPEST)
    weighed = float(np.sum(fallen**2 / variance))
    squares = fallen * (max(float(np.sum(fallen * seen / variance)) / weighed, 0.0) if weighed > 0.0 else 1.0)
    if shaken:
        own = np.maximum((BY_THE_BASE * squares) ** 2, np.finfo(np.float64).tiny)
        squares = np.maximum((squares / own + seen / variance) / (1.0 / own + 1.0 / variance), 0.0)
    return tuple(map(float, squares))


def in_order(records: Sequence[Record], block: DeclaredBlock) -> list[Record]:
    """The records of a campaign, in the order in which they were made, each with the impacts of those before."""
    out: list[Record] = []
    before = NEVER
    for record in records:
        squares = squares_of_speeds(record.found, block, record.kind == "forced")
        out.append(replace(record, struck=before, squares=squares))
        last = struck_before(out[-1], math.inf)
        before = NEVER._replace(in_all=last.in_all, squares=last.squares)
    return out


def uses(records: Sequence[Record], tests: int) -> tuple[float, ...]:
    """What impacts had taken by the middle of each test, over what they took in one on average [1], shape (test,).

    Of a test without a record as between its neighbours; nothing where no impact was seen.

    Args:
        records: of `in_order`.
        tests: how many there were.
    """
    ends = [(r.test, r.struck.squares, struck_before(r, math.inf).squares) for r in records]
    if not ends or ends[-1][2] <= 0.0:
        return ()
    each = ends[-1][2] / len(ends)
    middle = [0.5 * (before + after) / each for _, before, after in ends]
    return tuple(np.interp(np.arange(tests), [test for test, _, _ in ends], middle).tolist())


def cut(record: Record, number: int, start: float, stop: float, **state: Any) -> Window:
    """The part of a record from `start` to `stop` [s] as a window.

    Args:
        record: the record.
        number: its index among the records.
        start, stop: [s]; the window's runs begin at `start`.
        state: `theta`, `omega`, `theta_sd`, `omega_sd`, `theta_prior`, `lean_read` of the window.
    """
    first, last = np.searchsorted(record.time, [start - 1e-12, stop + 1e-12])
    seen = np.isfinite(record.observed[:, first:last])
    index = np.flatnonzero(seen.any(axis=0)) + int(first)
    observed = record.observed[:, index].ravel()
    there = np.flatnonzero(np.isfinite(observed))
    noise = record.noises[:, index].ravel()[there]
    felt = None if record.felt is None else record.felt[:, index].ravel()[there]
    sides = None if record.sides is None else record.sides[index]
    return Window(
        number, record.test, start, np.ascontiguousarray(record.time[index]), index, record.channels, there,
        observed[there], noise, **state, sd=None if felt is None else np.hypot(noise, felt), felt=felt, sides=sides,
        struck=struck_before(record, start),
    )  # fmt: skip


def record_of(test: Test, index: int, noise: float, balance: float) -> Record | None:
    """The record of a test with a rotation channel; None if it has none, or too few samples."""
    reading = test.rotation
    if reading is None or int(np.isfinite(reading).sum()) < 20:
        return None
    usable = np.isfinite(reading) & ~clipped(reading) & before_overturning(test.time, reading, balance)
    rotation = np.where(usable, reading, np.nan)
    if int(usable.sum()) < 20:
        return None
    lean, sd, read = 0.0, 0.0, True
    if test.kind == "free":
        lean, sd, read = _lean(test, rotation, noise)
    channel = test.channel("rotation")
    assert channel is not None
    return Record(
        index, test.kind, test.time, rotation, noise, lean, sd, segment(test.time, rotation, noise), (channel,),
        rotation[None, :], rotation[None, :], np.full((1, rotation.size), noise), lean_read=read,
    )  # fmt: skip


def _lean(test: Test, rotation: Array, noise: float) -> tuple[float, float, bool]:
    """Lean at release and its standard deviation [rad], and whether it was read in the first samples or aimed at."""
    found = state(test.time, rotation, float(test.time[0]), noise, widest=0.1)
    if found is None:
        return float(test.initial_rotation or 0.0), RELEASE_SD, False
    return found.rotation, max(2.0 * math.sqrt(float(found.covariance[0, 0])), 0.5 * noise), True


def with_accelerometers(record: Record, test: Test, noises: Mapping[str, float], balance: float) -> Record:
    """The record of a test with a rotation, with the accelerometers that it has besides, up to a fall.

    balance: tilt of unstable balance [rad], as declared.
    """
    sensors = [c for c in test.channels if c.kind == "block_acceleration"]
    if not sensors:
        return record
    assert test.rotation is not None
    fallen = ~before_overturning(test.time, test.rotation, balance)
    recorded = np.array([np.where(clipped(test.data[c.name]) | fallen, np.nan, test.data[c.name]) for c in sensors])
    observed = recorded.copy()
    for impact in record.found.impacts:
        observed[:, np.abs(test.time - impact.time) < NEAR_IMPACTS * test.time_step] = np.nan
    small = ~(np.abs(record.rotation) > 3.0 * record.noise)
    sides = np.where(small, ANY_SIDE, np.sign(np.nan_to_num(record.rotation))).astype(np.int64)
    return replace(
        record, sides=sides, channels=(*record.channels, *sensors), recorded=np.vstack([record.recorded, recorded]),
        observed=np.vstack([record.observed, observed]),
        noises=np.vstack([record.noises, *(np.full((1, small.size), noises[c.name]) for c in sensors)]),
    )  # fmt: skip


def scored_window(records: Sequence[Record], window: Window) -> Window:
    """All that was recorded of a test in the channel that its error is one of, from the state of a whole window.

    That channel is the rotation; the accelerometers where there is none.
    """
    number, record = next((k, r) for k, r in enumerate(records) if r.test == window.test)
    sensors = [k for k, channel in enumerate(record.channels) if channel is not SIDE]
    kept = [k for k in sensors if record.channels[k].kind == "rotation"] or sensors
    own = replace(
        record, channels=tuple(record.channels[k] for k in kept), observed=record.recorded[kept],
        noises=record.noises[kept], felt=None, sides=None,
    )  # fmt: skip
    return cut(
        own, number, window.start, float(record.time[-1]), theta=window.theta, omega=window.omega,
        theta_sd=window.theta_sd, omega_sd=window.omega_sd, theta_prior=window.theta_prior, lean_read=window.lean_read,
    )  # fmt: skip


def _anchors(record: Record) -> list[list[Peak]]:
    """Rows of (time, rotation, velocity) at consecutive peaks with nothing unseen between them."""
    rows: list[list[Peak]] = [[]]
    ending = {impact.swing for impact in record.found.impacts}
    for k, swing in enumerate(record.found.swings):
        low, high = record.found.bounds(k)
        at_start = swing.start == 0 and record.kind == "free"
        usable = (swing.turns or at_start) and abs(swing.peak) > PEAK_OVER_NOISE * record.noise
        if k > 0 and k - 1 not in ending and rows[-1]:
            rows.append([])
        if not usable:
            if rows[-1]:
                rows.append([])
            continue
        found = state(record.time, record.rotation, swing.peak_time, record.noise, low=low, high=high)
        if found is not None:
            rows[-1].append(Peak(swing.peak_time, found.rotation, 0.0 if at_start else found.velocity))
    return rows


def swing_windows(records: Sequence[Record], swings: int = 1) -> list[Window]:
    """Windows from one peak to the one `swings` further on; the state at the start is free."""
    windows = []
    for number, record in enumerate(records):
        rows = _anchors(record)
        peaks = [peak for row in rows for peak in row]
        start = float(record.time[0])
        # A release whose first samples are lost is still where the block comes from.
        released = [Peak(start, record.lean, 0.0)] if record.kind == "free" and record.lean != 0.0 else []
        if peaks and peaks[0].time > start:
            peaks = [*released, *peaks]
        for row in (row for row in rows if len(row) > 1):
            first = peaks.index(row[0])
            for k in range(0, len(row) - 1, swings):
                start, theta, omega = row[k]
                stop = row[min(k + swings, len(row) - 1)][0]
                window = cut(
                    record, number, start, stop, theta=theta, omega=omega, theta_sd=math.inf, omega_sd=math.inf
                )
                if window.times.size >= 8:
                    windows.append(replace(window, history=tuple(peaks[: first + k]), seen=row[k]))
    return windows


def whole_windows(records: Sequence[Record]) -> list[Window]:
    """Each record from its start: from rest, or from a lean that is known only so well.

    Of accelerometers what they read before the first impact, and from there on the rotation, or when the side changes
    where none was read: readings jump there, so that sums of their squares are rugged, and rotations and times of
    impacts are smooth in all that is to be found.
    """
    return [
        cut(
            _until_it_is_struck(record), number, float(record.time[0]), float(record.time[-1]), theta=record.lean,
            omega=0.0, theta_sd=record.lean_sd, omega_sd=0.0, theta_prior=record.lean, lean_read=record.lean_read,
        )
        for number, record in enumerate(records)
    ]  # fmt: skip


def _until_it_is_struck(record: Record) -> Record:
    """The record without what accelerometers read from the first impact on."""
    sensors = np.array([channel.kind == "block_acceleration" for channel in record.channels])
    if not sensors.any():
        return record
    if SIDE in record.channels:
        struck = np.isfinite(record.observed[record.channels.index(SIDE)])
    elif record.kind == "free":
        first = min((i.time for i in record.found.impacts if math.isfinite(i.time)), default=math.inf)
        struck = record.time > first - NEAR_IMPACTS * float(np.median(np.diff(record.time)))
    else:
        # Of a block that is about to rock the rotation shows no impacts as long as it is within the noise.
        assert record.sides is not None
        struck = record.sides != ANY_SIDE
    struck = np.logical_or.accumulate(struck)
    return replace(record, observed=np.where(sensors[:, None] & struck, np.nan, record.observed))
