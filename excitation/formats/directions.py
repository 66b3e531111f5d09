"""What sources call a direction, as azimuth and sense.

Source   names in use in the formats of this package: cardinal points, whole degrees, quadrants such as N65E, and the
         vertical ones.
Status   a record's vertical component is positive upward (`excitation.record.Record`), so what points down is turned
         over and called `UP`.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from excitation.record import Record

_UP = {"UP", "UD", "U-D", "V", "Z", "VER", "VERT", "VRT", "VERTICAL", "A_Z", "AZ"}
_DOWN = {"DWN", "DOWN", "DN"}
_CARDINAL = {"N-S": 0.0, "NS": 0.0, "N": 0.0, "E-W": 90.0, "EW": 90.0, "E": 90.0, "S": 180.0, "W": 270.0}


class Direction(NamedTuple):
    """A direction as a record has it."""

    component: str  # as the source names it; UP for what points down
    azimuth_deg: float | None  # clockwise from north
    vertical: bool
    sign: float  # -1 if the source's samples have to be turned over


def direction_of(name: str) -> Direction:
    """The direction that a source names; without azimuth if the name says none."""
    shown = name.strip()
    plain = shown.upper().replace("DEG", "").strip(" .")
    if plain in _DOWN:
        return Direction("UP", None, True, -1.0)
    if plain in _UP or plain.replace("_", "") in _UP:
        return Direction(shown, None, True, 1.0)
    return Direction(shown, _azimuth(plain.replace("_", "")), False, 1.0)


def _azimuth(plain: str) -> float | None:
    if plain in _CARDINAL:
        return _CARDINAL[plain]
    if re.fullmatch(r"\d{1,3}(\.\d+)?", plain) and float(plain) <= 360.0:
        return float(plain) % 360.0
    quadrant = re.fullmatch(r"([NS])(\d{1,2})([EW])", plain)
    if quadrant is None or int(quadrant.group(2)) > 90:
        return None
    from_axis = float(quadrant.group(2)) * (1.0 if quadrant.group(3) == "E" else -1.0)
    return (from_axis if quadrant.group(1) == "N" else 180.0 - from_axis) % 360.0


def name_of(record: Record) -> str:
    """A name of the record's direction that `direction_of` understands, its own if that does."""
    own = direction_of(record.component)
    if own.sign > 0.0 and (own.azimuth_deg, own.vertical) == (record.azimuth_deg, record.vertical):
        return record.component
    if record.vertical:
        return "UP"
    return record.component if record.azimuth_deg is None else f"{record.azimuth_deg:g}"
