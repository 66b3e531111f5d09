"""Tests of which the base sensor lost a part: used as far as its record can be made whole.

A run feels every sample of the base, so that nothing can be said of a block after a gap that cannot be filled.  One or
two samples at the very beginning are the first one that was read: the base has not begun to move.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from studies.campaigns.errors import CampaignError
from studies.campaigns.gaps import ALWAYS, LONGEST_FILL, gaps
from studies.campaigns.model import Campaign, Test

FEWEST = 20
"""Samples of a test that say something [1]."""


def as_far_as_known(test: Test) -> Test:
    """The test up to where its base is lost; itself if its base can be made whole.

    Raises:
        CampaignError: the base is lost from the beginning, or so soon that nothing is left.
    """
    data, count = dict(test.data), test.time.size
    for channel in test.channels:
        if channel.is_response:
            continue
        values = data[channel.name]
        for gap in gaps(values):
            if gap.start == 0 and gap.size <= ALWAYS and gap.size < values.size:
                data[channel.name] = np.where(np.arange(values.size) < gap.stop, values[gap.stop], values)
                continue
            if gap.start == 0 or gap.stop == values.size or gap.too_long(test.time_step, LONGEST_FILL):
                count = min(count, gap.start)
                if count < FEWEST:
                    raise CampaignError(
                        f"test {test.id!r}: {channel.name} has {gap.size} samples missing from "
                        f"{test.time[gap.start]:.6g} s on, want a base motion that is known for {FEWEST} samples or "
                        "more, or the campaign without this test"
                    )
                break
    if count == test.time.size and all(data[name] is test.data[name] for name in data):
        return test
    return replace(test, time=test.time[:count], data={name: values[:count] for name, values in data.items()})


def used(campaign: Campaign) -> Campaign:
    """The campaign with each test as far as its base is known, and what was left out among the warnings.

    Raises:
        CampaignError: the base of a test is lost from the beginning.
    """
    tests = tuple(as_far_as_known(test) for test in campaign.tests)
    lost = tuple(
        f"test {test.id!r}: its base motion is lost from {test.time[left.time.size]:.6g} s on, it is used up to there"
        for test, left in zip(campaign.tests, tests, strict=True) if left.time.size < test.time.size
    )  # fmt: skip
    return replace(campaign, tests=tests, warnings=(*campaign.warnings, *lost))
