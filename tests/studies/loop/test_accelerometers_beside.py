"""Accelerometers on the block beside a rotation sensor: what whole records hold of them (studies.loop.observed)."""

import numpy as np
import pytest

from studies.campaigns import read
from studies.laboratory.campaign import make_campaign
from studies.loop.records.preparing import Setup, as_declared, prepare
from studies.loop.swings.tracing import baseline
from studies.loop.whole.remaining import over_noise, structure
from studies.loop.whole.whole_fits import whole_fit
from studies.loop.whole.whole_records import MISSED

G = 9.80665


@pytest.fixture(scope="module")
def clean(tmp_path_factory: pytest.TempPathFactory) -> Setup:
    folder = tmp_path_factory.mktemp("clean")
    make_campaign(2, [], folder, nuisances=["accelerometers"])
    campaign = read(folder / "campaign" / "campaign.toml")
    assert sum(c.kind == "block_acceleration" for c in campaign.channels) == 3
    return prepare(campaign, as_declared(campaign, G))


def test_they_are_held_against_a_whole_record_until_it_is_struck(clean: Setup) -> None:
    """Further on they jump with each impact, and in the last hops a model may lean to the other side."""
    for window in clean.whole:
        record = next(r for r in clean.records if r.test == window.test)
        channel, sample = np.divmod(window.there, window.times.size)
        of_sensors = window.times[sample[channel > 0]]
        assert window.times[sample[channel == 0]].max() > of_sensors.max() + 1.0
        if record.kind == "free":
            assert 0.0 < of_sensors.max() < record.found.impacts[0].time
        else:
            moves = record.time[np.abs(record.rotation) > 3.0 * record.noise][0]
            assert of_sensors.max() < moves


def test_the_ideal_block_leaves_nothing_of_a_clean_campaign(clean: Setup) -> None:
    plain = baseline(clean.simulator, clean.start, clean.swings)
    assert over_noise(clean, plain) < structure(clean)
    assert whole_fit(clean, plain).rms < MISSED
