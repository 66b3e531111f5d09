"""What campaign.toml declares: block, conditions, channels and tests, each checked key by key.

A key that the format does not know is reported as a warning, or as an error where it looks like a slip of the pen for
one that is not there.
"""

from __future__ import annotations

import difflib
import math
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from studies.campaigns.errors import CampaignError, shown
from studies.campaigns.model import KINDS, Channel, Conditions, DeclaredBlock
from studies.campaigns.names import LONGEST_TEXT, checked_id, printable
from studies.campaigns.records import decoded, read_bytes

MAX_TOML_BYTES = 2 * 1024 * 1024
"""Of campaign.toml; 350 tests take 50 kB."""

TABLES = ("title", "block", "conditions", "channel", "test")
BLOCK_KEYS = ("breadth", "height", "depth", "mass", "centre_of_mass_height", "inertia")
CONDITION_KEYS = ("friction", "restitution")
CHANNEL_KEYS = ("name", "kind", "noise", "position", "direction")
TEST_KEYS = ("id", "kind", "data", "initial_rotation", "motion", "overturned")


@dataclass
class Table:
    """One table of the file with what errors call it; takes values out by name and type."""

    where: str
    values: dict[str, Any]
    keys: tuple[str, ...]
    warnings: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        for key in self.values:
            if key in self.keys:
                continue
            near = difflib.get_close_matches(key, self.keys, 1, 0.8)
            if near and near[0] not in self.values:
                raise CampaignError(f"{self.where}: found the key {shown(key)}, want {near[0]}")
            self.warnings.append(f"{self.where}: the key {shown(key)} is not part of the format and is not used")

    def fail(self, key: str, wanted: str) -> CampaignError:
        """The error about one key."""
        found = f"{key}={shown(self.values[key])}" if key in self.values else f"{key} is missing"
        return CampaignError(f"{self.where}: {found}, want {wanted}")

    def text(self, key: str, wanted: str) -> str:
        """A text that can be printed."""
        value = self.values.get(key)
        if not isinstance(value, str) or not value.strip() or not printable(value) or len(value) > LONGEST_TEXT:
            raise self.fail(key, wanted)
        return value

    def number(self, key: str, unit: str, low: float, high: float, *, strictly: bool = True) -> float:
        """A finite number above `low` (or at it, if not strictly) and up to `high`."""
        value = _finite(self.values.get(key))
        if value is None or not (low < value if strictly else low <= value) or value > high:
            positive = "a positive number" if low == 0.0 and strictly else f"a number from {low:g}"
            limit = "" if math.isinf(high) else f" up to {high:g}"
            raise self.fail(key, f"{positive}{limit} ({unit})")
        return value

    def optional_number(self, key: str, unit: str, low: float, high: float, *, strictly: bool = True) -> float | None:
        """The same, or None if the key is not there."""
        return self.number(key, unit, low, high, strictly=strictly) if key in self.values else None

    def pair(self, key: str, unit: str) -> tuple[float, float]:
        """Two finite numbers."""
        value = self.values.get(key)
        found = [_finite(v) for v in value] if isinstance(value, list) and len(value) == 2 else []
        if len(found) != 2 or found[0] is None or found[1] is None:
            raise self.fail(key, f"two numbers ({unit})")
        return found[0], found[1]


def _finite(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


@dataclass(frozen=True)
class DeclaredTest:
    """A test as campaign.toml has it, before its record is read."""

    id: str
    kind: Literal["free", "forced"]
    data: str
    initial_rotation: float | None
    motion: str | None
    overturned: bool | None


@dataclass(frozen=True)
class Declared:
    """All that campaign.toml says."""

    title: str
    block: DeclaredBlock
    conditions: Conditions
    channels: tuple[Channel, ...]
    tests: tuple[DeclaredTest, ...]
    warnings: tuple[str, ...]


def read_declared(path: Path) -> Declared:
    """campaign.toml as declared; CampaignError if something is missing or wrong in it."""
    name = path.name
    text = decoded(read_bytes(path, name, MAX_TOML_BYTES), name)
    try:
        values = tomllib.loads(text)
    except RecursionError:
        raise CampaignError(f"{name}: is nested too deeply, want a campaign") from None
    except ValueError as error:
        raise CampaignError(f"{name}: is not TOML: {shown(str(error))}, want a campaign") from None
    warnings: list[str] = []
    top = Table(name, values, TABLES, warnings)
    block = _block(Table(f"{name}, [block]", _table(top, "block"), BLOCK_KEYS, warnings))
    conditions = Conditions()
    if "conditions" in values:
        conditions = _conditions(Table(f"{name}, [conditions]", _table(top, "conditions"), CONDITION_KEYS, warnings))
    channels = tuple(_channels(top, warnings))
    tests = tuple(_tests(top, warnings))
    title = values.get("title", "")
    if not isinstance(title, str) or len(title) > LONGEST_TEXT:
        raise top.fail("title", f"text of at most {LONGEST_TEXT} characters")
    return Declared(title, block, conditions, channels, tests, tuple(warnings))


def _table(top: Table, key: str) -> dict[str, Any]:
    value = top.values.get(key)
    if not isinstance(value, dict):
        raise top.fail(key, f"a table [{key}]")
    return value


def _tables(top: Table, key: str) -> Iterable[dict[str, Any]]:
    value = top.values.get(key)
    if not isinstance(value, list) or not value or not all(isinstance(v, dict) for v in value):
        raise top.fail(key, f"one table [[{key}]] or more")
    return value


def _block(table: Table) -> DeclaredBlock:
    breadth, height, depth = (table.number(key, "m", 0.0, math.inf) for key in ("breadth", "height", "depth"))
    mass = table.number("mass", "kg", 0.0, math.inf)
    centre = table.optional_number("centre_of_mass_height", "m, inside the block", 0.0, height)
    inertia = table.optional_number("inertia", "kg m^2", 0.0, math.inf)
    return DeclaredBlock(breadth, height, depth, mass, centre, inertia)


def _conditions(table: Table) -> Conditions:
    friction = table.optional_number("friction", "coefficient of static friction", 0.0, 10.0)
    restitution = table.optional_number("restitution", "angular velocity after over before an impact", 0.0, 1.0)
    return Conditions(friction, restitution)


def _channels(top: Table, warnings: list[str]) -> Iterable[Channel]:
    seen: set[str] = set()
    for k, values in enumerate(_tables(top, "channel"), start=1):
        table = Table(f"{top.where}, channel {k}", values, CHANNEL_KEYS, warnings)
        name = table.text("name", "the name of a column")
        if name == "time" or name != name.strip() or set(name) & set(',"'):
            raise table.fail("name", "the name of a column other than time, without commas, quotes and outer blanks")
        if name in seen:
            raise table.fail("name", "each name once")
        seen.add(name)
        table.where = f"{top.where}, channel {shown(name)}"
        yield _channel(table, name)


def _channel(table: Table, name: str) -> Channel:
    kind = table.values.get("kind")
    if not isinstance(kind, str) or kind not in KINDS:
        raise table.fail("kind", f"one of {', '.join(KINDS)}")
    unit = "rad" if kind == "rotation" else "m/s^2"
    noise = table.optional_number("noise", f"{unit}, one standard deviation", 0.0, math.inf, strictly=False)
    position = direction = None
    if kind == "block_acceleration":
        position = table.pair("position", "m, block frame")
        direction = table.pair("direction", "sensitive axis in the block frame")
        if math.hypot(*direction) < 1e-6 or math.isinf(math.hypot(*direction)):
            raise table.fail("direction", "an axis that has a length")
    elif "position" in table.values or "direction" in table.values:
        key = "position" if "position" in table.values else "direction"
        raise table.fail(key, f"it for block_acceleration alone, not for {kind}")
    known = next(k for k in KINDS if k == kind)
    return Channel(name, known, noise, position, direction)


def _tests(top: Table, warnings: list[str]) -> Iterable[DeclaredTest]:
    seen: set[str] = set()
    for k, values in enumerate(_tables(top, "test"), start=1):
        table = Table(f"{top.where}, test {k}", values, TEST_KEYS, warnings)
        if not isinstance(values.get("id"), str):
            raise table.fail("id", "a name")
        id = checked_id(values["id"], table.where)
        if id in seen:
            raise table.fail("id", "each id once")
        seen.add(id)
        table.where = f"{top.where}, test {shown(id)}"
        yield _test(table, id)


def _test(table: Table, id: str) -> DeclaredTest:
    kind = table.values.get("kind")
    if kind not in ("free", "forced"):
        raise table.fail("kind", "free or forced")
    if not isinstance(table.values.get("data"), str):
        raise table.fail("data", "the name of a CSV file")
    lean = table.optional_number("initial_rotation", "rad", -math.pi, math.pi)
    if kind == "free" and (lean is None or lean == 0.0):
        raise table.fail("initial_rotation", "the lean that a free test is released from (rad)")
    if kind == "forced" and lean:
        table.warnings.append(f"{table.where}: initial_rotation={lean:g} rad is not used: a forced test starts upright")
        lean = None
    motion = table.text("motion", "the name of a motion") if "motion" in table.values else None
    overturned = table.values.get("overturned")
    if "overturned" in table.values and not isinstance(overturned, bool):
        raise table.fail("overturned", "true or false")
    return DeclaredTest(id, "free" if kind == "free" else "forced", table.values["data"], lean, motion, overturned)
