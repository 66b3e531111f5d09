"""Outcomes to learn from: which tests count, which are held out, and their base motions in a cheap form.

A fall is decided by the strong part of a motion and by frequencies up to a few times that of the block.  For the search
records are cut to where the base exceeds a share of what it takes to rock the block, and sampled no finer than the
block needs; errors that are reported come from whole records.

Status   share of outcomes that the cheap form flips against the whole records: no more than the sensor's noise does.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.signal import resample_poly

from studies.campaigns import Campaign, CampaignError, DeclaredBlock, Test, motion_groups
from studies.campaigns.gaps import LONGEST_FILL, whole_base
from studies.loop.runs.thinning import base_noise

Array = NDArray[np.float64]

FEWEST_TESTS = 24
"""Outcomes below which nothing can be told from chance."""

FEWEST_OF_A_KIND = 5
"""Falls, and tests without a fall, that there must be."""

FEWEST_MOTIONS = 4
"""Motions below which none can be held out."""

STRONG = 0.5
"""Share of West's onset acceleration from which a motion counts: what is below it hardly decides a fall."""

TAIL = 5.0
"""Time after the strong part that is kept, in units of 1/p."""

STEP = 0.1
"""Longest time between samples, in units of 1/p."""


@dataclass(frozen=True)
class OutcomeData:
    """Tests with an outcome; arrays of shape (test,)."""

    campaign: Campaign
    tests: tuple[Test, ...]  # as recorded
    numbers: tuple[int, ...]  # their places in the campaign
    fell: NDArray[np.bool_]
    group: NDArray[np.int64]  # index of the motion
    held: NDArray[np.bool_]  # tests that neither fit nor choice sees
    notes: tuple[str, ...] = ()

    @property
    def fitted(self) -> NDArray[np.intp]:
        """Indices of the tests that are fitted."""
        return np.flatnonzero(~self.held)

    @cached_property
    def base_noise(self) -> Array:
        """Standard deviation of the horizontal base channel of each test [m/s^2]; zero where it has none."""
        return np.array([base_noise(test) for test in self.tests])


def prepare(campaign: Campaign) -> OutcomeData:
    """The tests with an outcome, and which of their motions are held out.

    Raises:
        CampaignError: the outcomes cannot support a finding; it says why.
    """
    pairs = [(k, test) for k, test in enumerate(campaign.tests) if test.overturned is not None]
    lost = {k: why for k, test in pairs if (why := _lost(test))}
    count = len(campaign.tests) - len(pairs)
    pairs = [(k, test) for k, test in pairs if k not in lost]
    tests, numbers = tuple(test for _, test in pairs), tuple(k for k, _ in pairs)
    fell = np.array([bool(test.overturned) for test in tests], dtype=bool)
    place = {id: k for k, group in enumerate(motion_groups(campaign)) for id in group}
    _, group = np.unique([place[test.id] for test in tests], return_inverse=True)
    _refuse(fell, group, "an outcome and a base motion that is known" if lost else "an outcome")
    notes = [f"{count} of {len(campaign.tests)} tests have no outcome and are left out"] if count else []
    notes += [f"{why}; its outcome is left out" for why in lost.values()]
    return OutcomeData(campaign, tests, numbers, fell, group, np.isin(group, _held(group)), tuple(notes))


def _lost(test: Test) -> str:
    """What is missing of a base motion that cannot be made whole: an outcome is one of all of it."""
    for kind in ("base_acceleration_x", "base_acceleration_z"):
        channel = test.channel(kind)
        if channel is not None:
            try:
                whole_base(test, channel.name, LONGEST_FILL)
            except CampaignError as error:
                return str(error)
    return ""


def _refuse(fell: NDArray[np.bool_], group: NDArray[np.int64], having: str) -> None:
    n, falls, motions = fell.size, int(fell.sum()), int(group.max()) + 1 if fell.size else 0
    if n < FEWEST_TESTS:
        raise CampaignError(f"{n} tests have {having}: want {FEWEST_TESTS} or more to learn from outcomes alone")
    if falls < FEWEST_OF_A_KIND or n - falls < FEWEST_OF_A_KIND:
        said = "all" if falls == n else "none" if falls == 0 else f"{falls}"
        raise CampaignError(
            f"{said} of {n} tests overturned: want {FEWEST_OF_A_KIND} or more that fell and as many that did "
            f"not, since only "
            "the border between them says something of the block"
        )
    if motions < FEWEST_MOTIONS:
        raise CampaignError(
            f"the tests with an outcome are of {motions} base motions: want {FEWEST_MOTIONS} or more, so that tests of "
            "one motion can be held out together"
        )


def _held(group: NDArray[np.int64]) -> list[int]:
    """About a quarter of the motions, evenly over the order in which they were first done."""
    motions = int(group.max()) + 1
    count = max(1, round(motions / 4))
    return [int((k + 0.5) * motions / count) for k in range(count)]


def cheap(test: Test, block: DeclaredBlock) -> Test:
    """The strong part of a test's base motion, sampled no finer than the block needs; a free test as it is."""
    if test.base_x is None or test.kind == "free":
        return test
    columns = {
        c.name: whole_base(test, c.name, LONGEST_FILL)
        for c in (test.channel("base_acceleration_x"), test.channel("base_acceleration_z"))
        if c is not None
    }
    factor = max(1, int(STEP / block.p() / test.time_step))
    size = np.max(np.abs(list(columns.values())), axis=0)
    strong = np.flatnonzero(size > STRONG * block.onset_acceleration)
    first, last = (int(strong[0]), int(strong[-1])) if strong.size else (0, 2 * factor)
    first = max(0, first - 4 * factor)
    last = min(test.time.size - 1, last + int(TAIL / block.p() / test.time_step))
    data = {name: resample_poly(v[first : last + 1], 1, factor) for name, v in columns.items()}
    count = next(iter(data.values())).size
    time = test.time[first] + factor * test.time_step * np.arange(count)
    return replace(test, time=time, data=data, channels=tuple(c for c in test.channels if c.name in data))


def scaled(test: Test, factor: float) -> Test:
    """The test with its base motion so many times as strong."""
    bases = {c.name for c in test.channels if c.kind in ("base_acceleration_x", "base_acceleration_z")}
    return replace(test, data={name: v * factor if name in bases else v for name, v in test.data.items()})
