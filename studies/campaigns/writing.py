"""Writing a campaign so that reading it gives the same again, to the last bit of every sample."""

from __future__ import annotations

import gzip
import math
from functools import partial
from pathlib import Path
from typing import Any

import tomli_w

from studies.campaigns.errors import CampaignError
from studies.campaigns.model import Campaign, Channel, Test
from studies.campaigns.names import checked_id
from studies.campaigns.reading import FILE
from studies.running.files import write_whole


def write(campaign: Campaign, folder: str | Path, *, compressed: bool = False) -> Path:
    """Write campaign.toml and `<id>.csv` for each test; the path of campaign.toml.

    Args:
        campaign: what to write; `path`, `warnings` and the tests' `source` are not kept.
        folder: made if need be; files of the same names are written over.
        compressed: whether the records are gzipped (`<id>.csv.gz`).

    Raises:
        CampaignError: the id of a test cannot be a file name, or two are the same.
        OSError: the folder cannot be written to.
    """
    folder = Path(folder)
    ids = [checked_id(test.id, "campaign") for test in campaign.tests]
    for k, id in enumerate(ids):
        if id in ids[:k]:
            raise CampaignError(f"test {id!r}: is there twice, want each id once")
    folder.mkdir(parents=True, exist_ok=True)
    ending = ".csv.gz" if compressed else ".csv"
    for test in campaign.tests:
        data = _csv(test).encode("utf-8")
        # No time stamp: the same campaign gives the same bytes.
        packed = gzip.compress(data, mtime=0) if compressed else data
        write_whole(folder / f"{test.id}{ending}", partial(Path.write_bytes, data=packed))
    text = tomli_w.dumps(_toml(campaign, ending)).encode("utf-8")
    write_whole(folder / FILE, lambda target: target.write_bytes(text))
    return folder / FILE


def _without_none(**values: Any) -> dict[str, Any]:
    return {key: value for key, value in values.items() if value is not None}


def _toml(campaign: Campaign, ending: str) -> dict[str, Any]:
    block, conditions = campaign.block, campaign.conditions
    declared = _without_none(friction=conditions.friction, restitution=conditions.restitution)
    return {
        "title": campaign.title,
        "block": _without_none(
            breadth=block.breadth, height=block.height, depth=block.depth, mass=block.mass,
            centre_of_mass_height=block.centre_of_mass_height, inertia=block.inertia,
        ),
        **({"conditions": declared} if declared else {}),
        "channel": [_channel(channel) for channel in campaign.channels],
        "test": [_test(test, ending) for test in campaign.tests],
    }  # fmt: skip


def _channel(channel: Channel) -> dict[str, Any]:
    position = None if channel.position is None else list(channel.position)
    direction = None if channel.direction is None else list(channel.direction)
    return _without_none(
        name=channel.name, kind=channel.kind, noise=channel.noise, position=position, direction=direction
    )


def _test(test: Test, ending: str) -> dict[str, Any]:
    return _without_none(
        id=test.id, kind=test.kind, data=f"{test.id}{ending}", initial_rotation=test.initial_rotation,
        motion=test.motion, overturned=test.overturned,
    )  # fmt: skip


def _csv(test: Test) -> str:
    columns = [test.time.tolist(), *(test.data[c.name].tolist() for c in test.channels)]
    header = ",".join(["time", *(c.name for c in test.channels)])
    lines = (",".join("" if math.isnan(v) else repr(v) for v in row) for row in zip(*columns, strict=True))
    return "\n".join([header, *lines, ""])
