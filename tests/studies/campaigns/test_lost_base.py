"""Tests of which the base sensor lost a part are used as far as its record can be made whole."""

from dataclasses import replace

import numpy as np
import pytest

from studies.campaigns import CampaignError, read, write
from studies.campaigns.gaps import ALWAYS, LONGEST_FILL
from studies.campaigns.lost_base import as_far_as_known, used
from studies.campaigns.signals import base_motion

from .test_gaps_and_base import holed

LONG = int(LONGEST_FILL / 0.004) + 1
"""Samples in a row that are no longer filled [1]."""


@pytest.mark.parametrize(
    ("place", "left"),
    [((1500, 1501), 1500), ((1480, 1501), 1480), ((700, 700 + LONG), 700), ((700, 705), 1501), ((0, ALWAYS), 1501)],
)
def test_a_test_ends_where_its_base_is_lost(campaign, place, left):
    test = campaign.test("ramp-3Hz")
    found = as_far_as_known(holed(test, place))
    assert found.time.size == left and all(v.size == left for v in found.data.values())
    motion = base_motion(found)
    assert motion is not None and np.isfinite(motion.a_x).all()
    there = np.setdiff1d(np.arange(left), np.arange(*place))
    np.testing.assert_array_equal(motion.a_x[there], test.base_x[there])
    np.testing.assert_array_equal(found.rotation, test.rotation[:left])


def test_what_is_missing_at_the_very_beginning_is_the_first_sample(campaign):
    found = as_far_as_known(holed(campaign.test("ramp-3Hz"), (0, 2)))
    assert found.base_x[0] == found.base_x[1] == found.base_x[2]


@pytest.mark.parametrize("place", [(0, ALWAYS + 1), (10, 10 + LONG)])
def test_a_base_that_is_lost_from_the_beginning_is_an_error_of_that_test(campaign, place):
    with pytest.raises(CampaignError, match=r"test 'ramp-3Hz': base_x has \d+ samples missing from .* without this"):
        as_far_as_known(holed(campaign.test("ramp-3Hz"), place))


def test_a_campaign_says_what_of_it_is_not_used(campaign):
    broken = tuple(holed(t, (900, t.time.size)) if t.id == "ramp-3Hz" else t for t in campaign.tests)
    left = used(replace(campaign, tests=broken))
    said = "test 'ramp-3Hz': its base motion is lost from 3.6 s on, it is used up to there"
    assert left.warnings == (*campaign.warnings, said)
    assert [t.time.size for t in left.tests] == [900 if t.id == "ramp-3Hz" else t.time.size for t in campaign.tests]
    assert used(campaign) == campaign


def test_a_base_channel_of_a_free_test_that_is_empty_was_not_measured(campaign, tmp_path):
    free = next(t for t in campaign.tests if t.kind == "free")
    channel = campaign.test("ramp-3Hz").channel("base_acceleration_x")
    empty = replace(
        free, channels=(*free.channels, channel), data={**free.data, channel.name: np.full(free.time.size, np.nan)}
    )
    others = tuple(empty if t is free else t for t in campaign.tests)
    write(replace(campaign, tests=others), tmp_path)
    assert read(tmp_path).test(free.id).channel("base_acceleration_x") is None
