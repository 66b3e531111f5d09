"""Reading a measured campaign: campaign.toml and its records, everything checked before anything is done with it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from studies.campaigns import plausibility as plausible
from studies.campaigns.declared import Declared, DeclaredTest, read_declared
from studies.campaigns.errors import CampaignError, shown
from studies.campaigns.gaps import LONGEST_FILL, gaps
from studies.campaigns.model import Campaign, Channel, DeclaredBlock, Test
from studies.campaigns.names import record_path
from studies.campaigns.noise import Noise, noise
from studies.campaigns.records import read_record
from studies.campaigns.signs import drive

MAX_SAMPLES = 100_000_000
"""Numbers in all records together (800 MB in memory)."""

FILE = "campaign.toml"

GRAVITY_SLOPE = (5.0, 20.0)
"""Slope of the drive (`signs`) between which the base is in g: 9.8 but for what the block is not as declared."""


def read(path: str | Path) -> Campaign:
    """A measured campaign.

    Args:
        path: campaign.toml, or the folder that holds it.

    Returns:
        The campaign with all its records in memory and `warnings` about what is odd.

    Raises:
        CampaignError: (a ValueError) something is missing, damaged or not in the format's units and signs; one
            sentence with the file, line or test and what was wanted.
    """
    file = Path(path)
    try:
        file = file / FILE if file.is_dir() else file
        exists = file.exists()
    except (OSError, ValueError):
        exists = False
    if not exists:
        raise CampaignError(f"{shown(str(path))}: is not there, want the path of a {FILE}")
    declared = read_declared(file)
    warnings = [*declared.warnings, *plausible.check_block(declared.block, file.name)]
    for channel in declared.channels:
        warnings += plausible.check_channel(channel, declared.block, file.name)
    tests = _tests(file, declared)
    for test in tests:
        warnings += [*plausible.check_record(test, declared.block), *_oddities(test)]
    for channel in declared.channels:
        plausible.check_noise(channel, tests, file.name)
    plausible.check_drive(tests, declared.block)
    plausible.check_returns(tests, declared.block)
    check_signs(tests, declared.block)
    return Campaign(
        declared.title, declared.block, declared.conditions, declared.channels, tests, file, tuple(warnings)
    )


def _tests(file: Path, declared: Declared) -> tuple[Test, ...]:
    tests, total = [], 0
    for entry in declared.tests:
        if entry.initial_rotation is not None:
            plausible.check_lean(entry.id, entry.initial_rotation, declared.block, file.name)
        test = _test(file, entry, declared.channels)
        total += test.time.size * (1 + len(test.data))
        if total > MAX_SAMPLES:
            raise CampaignError(f"{file.name}: its records have more than {MAX_SAMPLES} numbers, want at most that")
        tests.append(test)
    return tuple(tests)


def _test(file: Path, entry: DeclaredTest, channels: Sequence[Channel]) -> Test:
    where = f"{file.name}, test {shown(entry.id)}"
    path = record_path(file.parent, entry.data, where)
    data = read_record(path, shown(entry.data)[1:-1], frozenset(c.name for c in channels))
    time = data.pop("time")
    # A base channel of a free test that is empty throughout was not measured.
    empty = {n for n, v in data.items() if entry.kind == "free" and not np.isfinite(v).any()}
    present = tuple(c for c in channels if c.name in data and (c.is_response or c.name not in empty))
    if entry.kind == "forced" and not any(c.kind == "base_acceleration_x" for c in present):
        found = shown(entry.data)
        raise CampaignError(f"{where}: {found} has no column of kind base_acceleration_x, want one in a forced test")
    ordered = {c.name: data[c.name] for c in present}
    lean, motion = entry.initial_rotation, entry.motion
    return Test(entry.id, entry.kind, time, present, ordered, lean, motion, entry.overturned, entry.data)


def _oddities(test: Test) -> list[str]:
    """Warnings about channels of one kind and gaps in the base."""
    found = []
    kinds = [c.kind for c in test.channels if c.kind != "block_acceleration"]
    for kind in sorted({k for k in kinds if kinds.count(k) > 1}):
        first = test.channel(kind)
        assert first is not None
        found.append(f"test {test.id!r}: has several channels of kind {kind}, of which {first.name!r} counts")
    for channel in test.channels:
        if channel.is_response:
            continue
        longest = max((gap.size for gap in gaps(test.data[channel.name])), default=0)
        if (longest + 1) * test.time_step > LONGEST_FILL and longest:
            found.append(f"test {test.id!r}: {longest} samples of {channel.name!r} are missing in a row")
    return found


def rotation_noise(test: Test) -> Noise | None:
    """Noise of a test's rotation from its record; None where it has none or is too broken to say."""
    if test.rotation is None:
        return None
    try:
        return noise(test.rotation, test.time_step)
    except ValueError:
        return None


def check_signs(tests: Sequence[Test], block: DeclaredBlock) -> None:
    """CampaignError where rotation and base clearly contradict each other in sign, or the base is clearly in g.

    The signs are decided by the correlation of `signs.drive` over all windows of a test: a test contradicts when it
    is below -0.8; the campaign is refused when that is so in most of its forced tests, or in some while others are
    clearly right (above 0.8).
    """
    found = {}
    for test in tests:
        level = rotation_noise(test) if test.kind == "forced" else None
        result = None if level is None else drive(test, block, level)
        if result is not None:
            found[test.id] = result
    opposed = [id for id, result in found.items() if result.opposed]
    right = [id for id, result in found.items() if result.correlation > 0.8]
    if opposed and (2 * len(opposed) > len(found) or right):
        named = ", ".join(shown(id) for id in opposed[:5]) + (" and others" if len(opposed) > 5 else "")
        raise CampaignError(
            f"test {named}: the block rocks against the signs of its base record, want a positive base acceleration to "
            "make it lean toward -x (a negative rotation)"
        )
    slopes = [abs(result.slope) for result in found.values() if abs(result.correlation) > 0.8]
    middle = float(np.median(slopes)) if slopes else 1.0
    if GRAVITY_SLOPE[0] < middle < GRAVITY_SLOPE[1]:
        raise CampaignError(
            f"forced tests: the block rocks as if the base moved {middle:.3g} times as strongly as recorded, want base "
            "accelerations in m/s^2"
        )
