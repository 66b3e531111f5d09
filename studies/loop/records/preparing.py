"""What the loop works on: the records of a campaign, cut into windows, and which tests are held out.

Status   campaigns with a rotation channel, with accelerometers on the block, or with both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studies.campaigns import Campaign, CampaignError, Channel, Test, motion_groups
from studies.campaigns.signals import noise_told
from studies.loop.fits.left_by_base import with_left_by_base
from studies.loop.models.model import LoopModel
from studies.loop.observed.spread import redrawn
from studies.loop.observed.windows import (
    SIDE,
    Record,
    Window,
    in_order,
    record_of,
    swing_windows,
    uses,
    whole_windows,
    with_accelerometers,
)
from studies.loop.records import reconstruction
from studies.loop.runs.keeping import Keeper
from studies.loop.runs.simulation import Simulator
from studies.loop.runs.thinning import base_noise, factors

Array = NDArray[np.float64]

FEWEST_WINDOWS = 8
"""Half-swings below which a campaign supports no finding."""


@dataclass(frozen=True)
class Setup:
    """What the loop works on: records, windows and simulators of one campaign."""

    campaign: Campaign
    simulator: Simulator  # on base records as thin as fits need them
    recorded: Simulator  # on base records as they are, as predictions are
    noisy: Simulator
    records: tuple[Record, ...]  # of all tests with a response
    held: tuple[int, ...]  # indices of tests held out
    swings: tuple[Window, ...]  # of fit tests, one swing each
    whole: tuple[Window, ...]  # of fit tests
    whole_held: tuple[Window, ...]
    start: LoopModel  # the ideal block as declared, accelerometers turned as they read at rest
    notes: tuple[str, ...] = ()

    @property
    def reads_gravity(self) -> bool:
        """Whether some accelerometer on the block looks upward, so that gravity itself is read."""
        return any(
            c.kind == "block_acceleration" and abs(c.axis[1]) > 0.5 for record in self.records for c in record.channels
        )

    @property
    def by_rotation(self) -> bool:
        """Whether the rotation was measured; else accelerometers are all there is."""
        return any(c.kind == "rotation" and c is not SIDE for record in self.records for c in record.channels)


def as_declared(campaign: Campaign, g: float) -> LoopModel:
    """The ideal block as declared, with Housner's restitution where none was measured."""
    e, block = campaign.conditions.restitution, campaign.block
    return LoopModel(block, min(max(block.housner, 0.05), 1.0) if e is None else e, {}, g)


def held_out(campaign: Campaign, records: Sequence[Record]) -> tuple[int, ...]:
    """Indices of the tests that neither fit nor choice sees: about a quarter, whole tests, repeats together.

    One free test of three or more (that of the middle lean), and every fourth or so forced motion.
    """
    by_id = {campaign.tests[r.test].id: r for r in records}
    free = [r for r in records if r.kind == "free"]
    held: list[int] = []
    if len(free) >= 3:
        held.append(sorted(free, key=lambda r: abs(r.lean))[len(free) // 2].test)
    groups = [
        [by_id[i].test for i in group if i in by_id and by_id[i].kind == "forced"] for group in motion_groups(campaign)
    ]
    groups = [group for group in groups if group]
    if len(groups) >= 3:
        count = max(1, round(len(groups) / 4))
        for k in range(count):
            held += groups[int((k + 0.5) * len(groups) / count)]
    return tuple(sorted(held))


def prepare(campaign: Campaign, declared: LoopModel, keeper: Keeper | None = None) -> Setup:
    """Records, windows and simulators.

    Args:
        campaign: with records of the response.
        declared: the ideal block as declared.
        keeper: keeps the fits.

    Raises:
        CampaignError: the campaign has no response to learn from, or too little of it.
    """
    noise_of_base = np.array([base_noise(test) for test in campaign.tests])
    thinned = factors(campaign.tests, campaign.block.p(declared.g))
    simulator = Simulator(campaign.tests, keeper=keeper, factors=thinned)
    sensors = [c for c in campaign.channels if c.kind == "block_acceleration"]
    start = reconstruction.mounted(declared, simulator, sensors)
    noises = {c.name: _typical_noise(campaign, c) for c in sensors}
    records, notes = _by_rotation(campaign)
    reader = start
    if records:
        records = [with_accelerometers(r, campaign.tests[r.test], noises, campaign.block.alpha) for r in records]
    else:
        records = reconstruction.records(simulator, start, sensors, noises)
        reader = reconstruction.with_its_mass(simulator, start, records)
        if reader is not start:
            records = reconstruction.records(simulator, reader, sensors, noises)
            notes.append(reconstruction.read_by(reader))
    if not records:
        raise CampaignError(
            "no test has a record of the response: want a rotation channel or accelerometers on the block to learn from"
        )
    if sensors:
        felt = _felt(simulator, start, records, noise_of_base)
        records = [replace(r, felt=f) for r, f in zip(records, felt, strict=True)]
    records = in_order(records, campaign.block)
    held = held_out(campaign, records)
    kept = [r for r in records if r.test not in held]
    swings = swing_windows(kept)
    if any(SIDE in r.channels for r in records):
        swings, lost = reconstruction.put_right(simulator, reader, swings)
        notes += [f"{lost} half-swings left out: the accelerometers do not say when they ended"] if lost else []
    if len(swings) < FEWEST_WINDOWS:
        raise CampaignError(
            f"the records hold {len(swings)} half-swings above 12 times their noise: want {FEWEST_WINDOWS} or more to "
            "learn from (larger motions, or a quieter sensor)"
        )
    noisy = redrawn(campaign.tests, noise_of_base, factors=thinned)
    swings = with_left_by_base(simulator, noisy, len(campaign.tests), start, swings)
    recorded = Simulator(campaign.tests)
    start = replace(start, uses=uses(records, len(campaign.tests)))
    return Setup(
        campaign, simulator, recorded, noisy, tuple(records), held,
        tuple(swings), tuple(whole_windows(kept)), tuple(whole_windows([r for r in records if r.test in held])),
        start, tuple(notes),
    )  # fmt: skip


def _by_rotation(campaign: Campaign) -> tuple[list[Record], list[str]]:
    """The records of tests with a rotation, and what is to be said of those that are left out."""
    records, notes = [], []
    for index, test in enumerate(campaign.tests):
        channel = test.channel("rotation")
        if channel is None or test.rotation is None:
            continue
        noise = channel.noise or noise_told(test.rotation, test.time_step)
        record = None if noise is None else record_of(test, index, noise, campaign.block.alpha)
        if noise is None:
            notes.append(f"test {test.id}: rotation is too short to tell its noise from and none is declared, left out")
        elif record is None:
            notes.append(f"test {test.id}: fewer than 20 usable samples of rotation, left out")
        else:
            records.append(record)
    if records:
        notes += [f"test {test.id}: {what}, left out beside tests with a rotation" for test, what in _without(campaign)]
    return records, notes


def _without(campaign: Campaign) -> list[tuple[Test, str]]:
    """Tests that tell of the response otherwise than by a rotation, and by what."""
    found = []
    for test in campaign.tests:
        if test.rotation is not None:
            continue
        if any(c.kind == "block_acceleration" for c in test.channels):
            found.append((test, "accelerometers alone"))
        elif test.overturned is not None:
            found.append((test, "an outcome alone"))
    return found


def _typical_noise(campaign: Campaign, channel: Channel) -> float:
    """Standard deviation of a channel, declared or the median of what its records show."""
    if channel.noise:
        return float(channel.noise)
    each = [noise_told(t.data[channel.name], t.time_step) for t in campaign.tests if channel.name in t.data]
    seen = [noise for noise in each if noise is not None]
    if each and not seen:
        raise CampaignError(
            f"channel {channel.name!r}: no test has samples enough to tell its noise from; want noise declared"
        )
    return float(np.median(seen)) if seen else 0.0


def _felt(simulator: Simulator, model: LoopModel, records: Sequence[Record], noise_of_base: Array) -> list[Array]:
    """What the base sensor's noise does to accelerometers on the block [unit of the channel], shape (channel, time).

    The base record enters their prediction sample by sample, besides what it does to the motion.
    """
    return [noise_of_base[record.test] * reconstruction.by_base(simulator, model, record) for record in records]
