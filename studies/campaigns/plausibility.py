"""Are the units those of the format?  What physics says about sizes, accelerations and rotations.

Each check is for a slip by a factor (mm for m, g for m/s^2, degrees for radians), with wide room for what a strange
block or a strong table can do.  What is odd but possible is a warning.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from rocking import G_STANDARD
from studies.campaigns.errors import CampaignError, shown
from studies.campaigns.model import Array, Channel, DeclaredBlock, Test

DENSITY = (2.0, 30_000.0)
"""kg/m^3, over the enclosing box: foam has 10, osmium 22 600; the breadth may be that of a narrow foot."""

USUAL_DENSITY = (100.0, 12_000.0)

SLENDEREST = 200.0
"""Largest over smallest size of a block."""

GYRATION = (0.1, 2.0)
"""Radius of gyration over half of the diagonal; 0.58 for a rectangle."""

LARGEST_ACCELERATION = 500.0
"""m/s^2, 51 g: shaking tables end far below; 0.5 m/s^2 in mm/s^2 is there."""

LEAST_DRIVE = 0.35
"""Base peak over West's onset acceleration g tan(alpha), median over the tests that moved: 1 or more by physics, half
where the block stands on half of its breadth, about 0.3 for thrice the onset in units of g."""


def check_block(block: DeclaredBlock, name: str) -> list[str]:
    """Warnings about the declared block; CampaignError where its units cannot be SI."""
    where, warnings = f"{name}, [block]", []
    sizes = (block.breadth, block.height, block.depth)
    if max(sizes) > SLENDEREST * min(sizes):
        raise CampaignError(
            f"{where}: breadth, height and depth are {sizes[0]:g}, {sizes[1]:g} and {sizes[2]:g}, want all three in m"
        )
    volume = sizes[0] * sizes[1] * sizes[2]
    density = block.mass / volume if volume > 0.0 else math.inf
    if not DENSITY[0] <= density <= DENSITY[1]:
        raise CampaignError(
            f"{where}: sizes and mass={block.mass:g} make a density of {density:.3g} kg/m^3, want sizes in m and mass "
            f"in kg ({DENSITY[0]:g} to {DENSITY[1]:g} kg/m^3)"
        )
    if not USUAL_DENSITY[0] <= density <= USUAL_DENSITY[1]:
        warnings.append(f"{where}: sizes and mass make an unusual density of {density:.3g} kg/m^3")
    if block.inertia is not None:
        gyration = math.sqrt(block.inertia / block.mass) / (0.5 * math.hypot(block.breadth, block.height))
        if not GYRATION[0] <= gyration <= GYRATION[1]:
            raise CampaignError(
                f"{where}: inertia={block.inertia:g} makes a radius of gyration of {gyration:.3g} half diagonals, want "
                f"kg m^2 about the centre of mass ({GYRATION[0]:g} to {GYRATION[1]:g})"
            )
    return warnings


def check_channel(channel: Channel, block: DeclaredBlock, name: str) -> list[str]:
    """Warnings about a declared channel; CampaignError where its accelerometer is nowhere near the block."""
    where, warnings = f"{name}, channel {shown(channel.name)}", []
    if channel.position is not None:
        x, z = channel.position
        size = max(block.breadth, block.height)
        if max(abs(x), abs(z)) > 10.0 * size:
            raise CampaignError(
                f"{where}: position=[{x:g}, {z:g}] is far off the block, want metres in the block frame"
            )
        if abs(x) > 0.6 * block.breadth or not -0.1 * block.height <= z <= 1.1 * block.height:
            warnings.append(f"{where}: position=[{x:g}, {z:g}] m is off the block")
    if channel.direction is not None and abs(math.hypot(*channel.direction) - 1.0) > 0.01:
        length = math.hypot(*channel.direction)
        warnings.append(f"{where}: direction has length {length:.3g} and is taken as an axis of length 1")
    return warnings


def check_record(test: Test, block: DeclaredBlock) -> list[str]:
    """Warnings about one record; CampaignError where a channel cannot be in SI units or says nothing at all."""
    warnings = []
    for channel in test.channels:
        values = test.data[channel.name]
        there = np.flatnonzero(np.isfinite(values))
        if not there.size:
            warnings.append(_all_missing(test, channel))
            continue
        _check_size(test, channel, values, there)
        if channel.kind in ("base_acceleration_z", "block_acceleration"):
            _check_gravity(test, channel, values[there])
    if test.kind == "free" and test.rotation is not None and test.initial_rotation is not None:
        warnings += _check_release(test, test.rotation, test.initial_rotation, block)
    if test.overturned and test.rotation is not None and np.isfinite(test.rotation).any():
        largest = float(np.nanmax(np.abs(test.rotation)))
        if largest < 0.5 * block.alpha:
            warnings.append(f"test {test.id!r}: overturned=true, but its rotation stays below {largest:.3g} rad")
    return warnings


def _all_missing(test: Test, channel: Channel) -> str:
    others = any(np.isfinite(test.data[c.name]).any() for c in test.channels if c.is_response)
    if not channel.is_response or not (others or test.overturned is not None):
        raise CampaignError(
            f"{test.source}: all samples of {shown(channel.name)} are missing, want some, or no such column in a test "
            "to predict"
        )
    return f"test {test.id!r}: all samples of {shown(channel.name)} are missing"


def _check_size(test: Test, channel: Channel, values: Array, there: NDArray[np.intp]) -> None:
    limit, hint = (math.pi, "radians") if channel.kind == "rotation" else (LARGEST_ACCELERATION, "m/s^2")
    if channel.kind == "block_acceleration":
        # An impact may ring at any level; what it reads most of the time may not.
        size = float(np.median(np.abs(values[there])))
        if size > limit:
            raise CampaignError(f"{test.source}: {shown(channel.name)} mostly reads {size:.4g}, want {hint}")
        return
    worst = int(there[np.argmax(np.abs(values[there]))])
    if abs(values[worst]) > limit:
        raise CampaignError(
            f"{test.source}, line {worst + 2}: {shown(channel.name)} reads {values[worst]:.6g}, want {hint} (at most "
            f"{limit:.4g})"
        )


def _check_gravity(test: Test, channel: Channel, values: Array) -> None:
    reading = float(np.median(values)) / G_STANDARD
    if channel.kind == "base_acceleration_z":
        if abs(abs(reading) - 1.0) < 0.2:
            raise CampaignError(
                f"{test.source}: {shown(channel.name)} reads {reading * G_STANDARD:.4g} m/s^2 at rest, want the "
                "vertical acceleration of the base without gravity"
            )
        return
    up = channel.axis[1]
    if abs(up) > 0.7 and not 0.5 < reading / up < 2.0:
        raise CampaignError(
            f"{test.source}: {shown(channel.name)} mostly reads {reading * G_STANDARD:.4g} m/s^2, want about "
            f"{up * G_STANDARD:.4g}: (acceleration - g) . direction in m/s^2, gravity included"
        )


def _check_release(test: Test, rotation: Array, aimed: float, block: DeclaredBlock) -> list[str]:
    """A free record has to begin about where the block was set."""
    first = rotation[np.isfinite(rotation)][:5]
    if not first.size:
        return []
    begins = float(np.median(first))
    ratio = begins / aimed
    where = f"{test.source}: the record begins at {begins:.4g} rad"
    if abs(begins) > 0.05 * block.alpha and not 0.2 < ratio < 5.0:
        raise CampaignError(f"{where}, want about initial_rotation={aimed:g} rad in sign and size (radians)")
    if abs(aimed) > 0.2 * block.alpha and abs(ratio) < 0.02:
        raise CampaignError(f"{where}, want about initial_rotation={aimed:g} rad (radians)")
    if abs(begins - aimed) > 0.2 * abs(aimed):
        return [f"test {test.id!r}: the record begins at {begins:.4g} rad, initial_rotation is {aimed:g} rad"]
    return []


def check_lean(id: str, lean: float, block: DeclaredBlock, name: str) -> None:
    """CampaignError for a release from so far beyond balance that the angle cannot be in radians."""
    if abs(lean) > 1.5 * block.alpha:
        raise CampaignError(
            f"{name}, test {shown(id)}: initial_rotation={lean:g} is {abs(lean) / block.alpha:.3g} times the tilt of "
            f"unstable balance ({block.alpha:.3g} rad), want radians"
        )


def moved(test: Test, block: DeclaredBlock) -> bool:
    """Whether a forced test shows that the block rocked: a tenth of the balance angle, or an outcome."""
    if test.rotation is not None and np.isfinite(test.rotation).any():
        return float(np.nanmax(np.abs(test.rotation))) > 0.1 * block.alpha
    return bool(test.overturned)


def check_drive(tests: Iterable[Test], block: DeclaredBlock) -> None:
    """CampaignError where the base is too weak, over the forced tests that moved, to be in m/s^2."""
    shares = [
        float(np.nanmax(np.abs(t.base_x))) / block.onset_acceleration
        for t in tests
        if t.kind == "forced" and t.base_x is not None and t.base_z is None and moved(t, block)
    ]
    if shares and float(np.median(shares)) < LEAST_DRIVE:
        raise CampaignError(
            f"forced tests: the block moved in {len(shares)} of them, the median base peak of which is "
            f"{np.median(shares):.3g} of the {block.onset_acceleration:.3g} m/s^2 that rocking takes, want base "
            "accelerations in m/s^2"
        )


def check_returns(tests: Iterable[Test], block: DeclaredBlock) -> None:
    """CampaignError where blocks come back from far beyond balance so often that rotations cannot be in radians."""
    peaks = []
    for test in tests:
        rotation = test.rotation
        if rotation is None or not np.isfinite(rotation).any() or not moved(test, block):
            continue
        there = rotation[np.isfinite(rotation)]
        far = np.flatnonzero(np.abs(there) > 1.5 * block.alpha)
        back = far.size and bool(np.any(np.abs(there[far[0] :]) < 0.2 * block.alpha))
        peaks.append((back, float(np.max(np.abs(there)))))
    returned = [peak for back, peak in peaks if back]
    if len(returned) >= 2 and len(returned) > 0.5 * len(peaks):
        raise CampaignError(
            f"rotation: in {len(returned)} tests the block comes back from up to {max(returned):.3g} rad, beyond 1.5 "
            f"times the tilt of unstable balance ({block.alpha:.3g} rad), want radians"
        )


def check_noise(channel: Channel, tests: Iterable[Test], name: str) -> None:
    """CampaignError where the declared noise is as large as anything that the channel has measured."""
    if not channel.noise:
        return
    sizes = []
    for test in tests:
        values = test.data.get(channel.name)
        if values is not None and np.isfinite(values).any():
            sizes.append(float(np.nanmax(np.abs(values - np.nanmedian(values)))))
    if sizes and channel.noise > 0.5 * max(sizes):
        raise CampaignError(
            f"{name}, channel {shown(channel.name)}: noise={channel.noise:g} {channel.unit}, but its largest reading "
            f"is {max(sizes):.3g} {channel.unit}, want one standard deviation of the noise"
        )
