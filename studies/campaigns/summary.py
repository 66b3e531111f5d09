"""A campaign at a glance: one row a test, the noise of each channel, and what is odd."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from studies.campaigns.clipping import clipped, ends_in_motion, overturning_time
from studies.campaigns.gaps import gaps
from studies.campaigns.model import Array, Campaign, Test
from studies.campaigns.noise import Noise, noise
from studies.campaigns.plausibility import LEAST_DRIVE, moved
from studies.campaigns.sampling import independent
from studies.campaigns.signs import Drive, drive
from studies.campaigns.swings import Segmentation, mean_restitution, segment

NOISE_FACTOR = 3.0
"""Declared noise may differ from the estimate by this factor before it is worth a word."""

LONG_GAP = 3
"""Missing samples in a row worth a word: an impact may hide in more."""


@dataclass(frozen=True)
class Look:
    """What one test's record says by itself."""

    test: Test
    noises: dict[str, Noise] = field(default_factory=dict)  # by channel
    segmentation: Segmentation | None = None
    drive: Drive | None = None
    overturning_time: float = math.nan  # [s], as the rotation shows it
    warnings: tuple[str, ...] = ()  # on this test, without its id

    @property
    def zero(self) -> float:
        """Reading of the rotation at rest [rad]; 0 where the record shows no rest."""
        channel = self.test.channel("rotation")
        found = None if channel is None else self.noises.get(channel.name)
        return 0.0 if found is None or math.isnan(found.level) else found.level


def peak(values: Array | None) -> float:
    """Largest magnitude; NaN where there is none."""
    if values is None or not np.isfinite(values).any():
        return math.nan
    return float(np.nanmax(np.abs(values)))


def look(test: Test, campaign: Campaign) -> Look:
    """Noise, swings, drive, fall and oddities of one test."""
    noises = {}
    for channel in test.channels:
        try:
            noises[channel.name] = noise(test.data[channel.name], test.time_step)
        except ValueError:
            continue  # too short or too broken: the table shows none
    rotation = test.channel("rotation")
    found, driven, fell = None, None, math.nan
    if rotation is not None and rotation.name in noises and noises[rotation.name].value > 0.0:
        level = noises[rotation.name]
        values = test.data[rotation.name]
        zero = 0.0 if math.isnan(level.level) else level.level
        found = segment(test.time, values, level.value, zero=zero)
        fell = overturning_time(test.time, values, campaign.block.alpha)
        driven = drive(test, campaign.block, level) if test.kind == "forced" else None
    seen = Look(test, noises, found, driven, fell)
    return Look(test, noises, found, driven, fell, tuple(_warnings(seen, campaign)))


def _warnings(seen: Look, campaign: Campaign) -> list[str]:
    test, said = seen.test, []
    for channel in test.channels:
        values = test.data[channel.name]
        if (rail := int(np.count_nonzero(clipped(values)))) > 0:
            said.append(f"{rail} samples of {channel.name} sit on a rail")
        if (stride := independent(values)[1]) > 1:
            said.append(f"{channel.name} was sampled at one in {stride} lines")
        if channel.is_response and stride == 1 and (holes := [g for g in gaps(values) if g.size > LONG_GAP]):
            said.append(f"{channel.name} has gaps of up to {max(g.size for g in holes)} samples")
    if seen.overturning_time == seen.overturning_time and test.overturned is False:
        said.append("overturned=false, but the rotation shows a fall")
    base = peak(test.base_x) / campaign.block.onset_acceleration
    if test.kind == "forced" and moved(test, campaign.block) and base < LEAST_DRIVE:
        said.append(f"it moved though the base never reaches {LEAST_DRIVE:g} of what rocking takes")
    rotation = test.channel("rotation")
    if rotation is not None and rotation.name in seen.noises:
        level = seen.noises[rotation.name]
        fallen = not math.isnan(seen.overturning_time)
        if not fallen and ends_in_motion(test.data[rotation.name], level.value, seen.zero):
            said.append("it still rocks when the record stops")
        if abs(seen.zero) > 3.0 * level.value:
            said.append(f"it rests at {seen.zero:.2g} rad")
    return said


def channel_noise(looks: list[Look], name: str) -> float:
    """Median over the tests of the noise that their records show in a channel; NaN where none does."""
    found = [each.noises[name].value for each in looks if name in each.noises]
    return float(np.median(found)) if found else math.nan


HEADINGS = (
    "test", "kind", "duration", "step", "samples", "missing", "base peak", "/onset", "rotation", "impacts",
    "restitution", "drive", "outcome",
)  # fmt: skip
UNITS = ("", "", "s", "s", "", "%", "m/s^2", "1", "alpha", "", "1", "1", "")


def row(each: Look, campaign: Campaign) -> tuple[str, ...]:
    """The cells of a test's row."""
    test, found = each.test, each.segmentation
    values = list(test.data.values())
    missing = 100.0 * float(np.mean([np.mean(~np.isfinite(v)) for v in values])) if values else 0.0
    base = peak(test.base_x)
    e = mean_restitution(found.impacts)[0] if found else math.nan
    return (
        test.id,
        test.kind,
        f"{test.duration:.4g}",
        f"{test.time_step:.4g}",
        str(test.time.size),
        f"{missing:.2g}",
        _cell(base, ".3g"),
        _cell(base / campaign.block.onset_acceleration, ".2f"),
        _cell(peak(test.rotation) / campaign.block.alpha, ".3f"),
        "-" if found is None else str(len(found.impacts)),
        _cell(e, ".3f"),
        "-" if each.drive is None else f"{each.drive.slope:.3f}",
        _outcome(each),
    )


def _cell(value: float, form: str) -> str:
    return "-" if math.isnan(value) else format(value, form)


def _outcome(each: Look) -> str:
    if each.test.is_to_predict:
        return "to predict"
    if not math.isnan(each.overturning_time):
        return f"falls at {each.overturning_time:.4g} s"
    if each.test.overturned is not None:
        return "fell" if each.test.overturned else "stood"
    return "stands" if each.test.rotation is not None else "-"


def _columns(rows: list[tuple[str, ...]]) -> list[str]:
    """Rows with their cells aligned: texts to the left, the rest to the right."""
    widths = [max(len(r[k]) for r in rows) for k in range(len(rows[0]))]
    lines = []
    for r in rows:
        cells = [c.ljust(w) if k in (0, 1) else c.rjust(w) for k, (c, w) in enumerate(zip(r, widths, strict=True))]
        lines.append("  ".join(cells).rstrip())
    return lines


def _noise_rows(campaign: Campaign, looks: list[Look]) -> tuple[list[tuple[str, ...]], list[str]]:
    rows: list[tuple[str, ...]] = [("channel", "kind", "unit", "declared noise", "from the records", "basis")]
    said = []
    for channel in campaign.channels:
        value = channel_noise(looks, channel.name)
        bases: list[str] = [each.noises[channel.name].basis for each in looks if channel.name in each.noises]
        basis = max(set(bases), key=bases.count) if bases else "-"
        declared = math.nan if channel.noise is None else channel.noise
        rows.append((channel.name, channel.kind, channel.unit, _cell(declared, ".3g"), _cell(value, ".3g"), basis))
        ratio = value / declared if declared > 0.0 else math.nan
        if ratio > NOISE_FACTOR or ratio < 1.0 / NOISE_FACTOR:
            said.append(f"channel {channel.name!r}: its records show {ratio:.2g} times the declared noise")
    return rows, said


def together(looks: list[Look]) -> list[str]:
    """The warnings on tests, each once with the tests that it is about."""
    about: dict[str, list[str]] = {}
    for each in looks:
        for text in each.warnings:
            about.setdefault(text, []).append(each.test.id)
    return [f"{text} ({', '.join(ids) if len(ids) <= 8 else f'{len(ids)} tests'})" for text, ids in about.items()]


def summary(campaign: Campaign, looks: list[Look]) -> str:
    """The table of a campaign as text, with its warnings."""
    block = campaign.block
    noises, said = _noise_rows(campaign, looks)
    facts = (
        f"{campaign.title or campaign.path}\n"
        f"block: b={block.breadth:g} m, h={block.height:g} m, d={block.depth:g} m, {block.mass:g} kg "
        f"({block.density:.0f} kg/m^3), alpha={block.alpha:.4f} rad, p={block.p():.3f} rad/s, "
        f"rocks from {block.onset_acceleration:.3g} m/s^2"
    )
    table = _columns([HEADINGS, UNITS, *(row(each, campaign) for each in looks)])
    warnings = [*campaign.warnings, *said, *together(looks)]
    parts = [facts, "\n".join(_columns(noises)), "\n".join(table)]
    if warnings:
        parts.append("\n".join(f"warning: {text}" for text in warnings))
    return "\n\n".join(parts)
