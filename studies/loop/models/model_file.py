"""`baseline.toml` and `model.toml`: a model on disk.

    [block]            as declared: breadth, height, depth [m], mass [kg] ...
    [model]            restitution [1], gravity [m/s^2]
    [effects.NAME]     parameters of each effect, SI units
    [mountings]        by channel, how far an accelerometer on the block is turned from its declared axis [rad]

Status   what was written reads back to the same bits.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import tomli_w

from rocking.effects import available, load
from studies.campaigns import DeclaredBlock
from studies.campaigns.errors import shown
from studies.loop.models.model import RESTITUTION, Change, LoopModel
from studies.running.files import save_text
from studies.running.toml_file import read_toml

TABLES = ("title", "block", "model", "effects", "changes", "mountings", "outcomes")
MODEL_KEYS = ("restitution", "gravity", "restitution_drift", "restitution_drift_fading", "number", "uses")


class ModelError(ValueError):
    """A model file that cannot be used; the message names file and entry."""


def write_model(model: LoopModel, path: Path, title: str = "", more: Mapping[str, Any] | None = None) -> None:
    """Write a model, and further tables by name; the file appears whole or not at all."""
    block = {key: value for key, value in asdict(model.declared).items() if value is not None}
    content: dict[str, Any] = {
        "title": title,
        "block": block,
        "model": {
            "restitution": model.restitution,
            "gravity": model.g,
            "restitution_drift": model.drift,
            "restitution_drift_fading": model.fading,
            "number": model.number,
        },
        "effects": {name: dict(parameters) for name, parameters in model.effects.items()},
        "mountings": dict(model.mountings),
    }
    changes = {name: asdict(Change(**change)) for name, change in model.acting_changes.items()}
    if changes:
        content["changes"] = changes
        content["model"]["uses"] = [*model.uses]
    save_text(tomli_w.dumps(content | dict(more or {})), path)


def read_model(path: Path) -> LoopModel:
    """Read a model.

    Raises:
        ModelError: the file is not there or no TOML, or an entry is missing, unknown or out of its range.
    """
    try:
        content = read_toml(path)
    except ValueError as error:
        raise ModelError(f"{error}; want a model.toml that the loop wrote") from None
    block, model = _table(path, content, "block"), _table(path, content, "model")
    _known(path, "file", content, TABLES)
    _known(path, "model", model, MODEL_KEYS)
    sizes = {key: _number(path, f"block.{key}", value) for key, value in block.items()}
    try:
        declared = DeclaredBlock(**sizes)
    except TypeError:
        raise ModelError(f"{path}: block has {shown(', '.join(block))}, want breadth, height, depth and mass") from None
    found = LoopModel(
        declared,
        _number(path, "model.restitution", model.get("restitution")),
        _effects(path, content.get("effects", {})),
        _number(path, "model.gravity", model.get("gravity")),
        _number(path, "model.restitution_drift", model.get("restitution_drift", 0.0)),
        int(_number(path, "model.number", model.get("number", 0))),
        _mountings(path, content.get("mountings", {})),
        _number(path, "model.restitution_drift_fading", model.get("restitution_drift_fading", 0.0)),
        _changes(path, content.get("changes", {}), content.get("effects", {})),
        _uses(path, model.get("uses", [])),
    )
    if found.fading < 0.0:
        raise ModelError(f"{path}: model.restitution_drift_fading={found.fading}: want 0 or more")
    if not 0.0 <= found.restitution <= 1.0:
        raise ModelError(f"{path}: model.restitution={found.restitution}: want a number from 0 to 1")
    if min(found.declared.breadth, found.declared.height, found.declared.depth, found.declared.mass) <= 0.0:
        raise ModelError(f"{path}: block has sizes {shown(str(sizes))}, want breadth, height, depth and mass above 0")
    try:
        found.system  # noqa: B018 (refuses what does not go together)
    except (TypeError, ValueError, ZeroDivisionError, OverflowError) as error:
        raise ModelError(f"{path}: {error}") from None
    return found


def _known(path: Path, name: str, table: dict[str, Any], keys: tuple[str, ...]) -> None:
    strange = [key for key in table if key not in keys]
    if strange:
        raise ModelError(f"{path}: {name} has no {shown(strange[0])}, want {', '.join(keys)}")


def _table(path: Path, content: dict[str, Any], name: str) -> dict[str, Any]:
    table = content.get(name)
    if not isinstance(table, dict):
        raise ModelError(f"{path}: has no table [{name}], want the model.toml that the loop wrote")
    return table


def _number(path: Path, name: str, value: Any, absent: float = 0.0, unbounded: bool = False) -> float:
    """The value as a number; infinite only where that says that a parameter is not there, or that has no bound."""
    try:
        number = math.nan if isinstance(value, bool) or not isinstance(value, int | float) else float(value)
    except OverflowError:
        number = math.nan
    if not math.isfinite(number) and number != absent and not (unbounded and number == math.inf):
        raise ModelError(f"{path}: {name}={shown(value)}: want a number that is finite")
    return number


def _mountings(path: Path, table: Any) -> dict[str, float]:
    if not isinstance(table, dict):
        raise ModelError(f"{path}: mountings={shown(table)}: want a table of angles by channel")
    return {name: _number(path, f"mountings.{name}", value) for name, value in table.items()}


def _uses(path: Path, values: Any) -> tuple[float, ...]:
    """What impacts had taken by the middle of each test, which cannot become less."""
    if not isinstance(values, list):
        raise ModelError(f"{path}: model.uses={shown(values)}: want a list of numbers")
    found = tuple(_number(path, f"model.uses[{k}]", value) for k, value in enumerate(values))
    if any(later < before for before, later in zip((0.0, *found), found, strict=False)):
        raise ModelError(f"{path}: model.uses={shown(values)}: want numbers from 0 on that do not become less")
    return found


def _changes(path: Path, tables: Any, effects: Any) -> dict[str, dict[str, float]]:
    """How the restitution, or parameters of effects that are there, change in the course of a campaign."""
    if not isinstance(tables, dict):
        raise ModelError(f'{path}: changes={shown(tables)}: want tables [changes."EFFECT.PARAMETER"]')
    hows: dict[str, Any] = {each.name: each.default for each in fields(Change)}
    out: dict[str, dict[str, float]] = {}
    for name, change in tables.items():
        effect, _, parameter = name.partition(".")
        if name != RESTITUTION and parameter not in effects.get(effect, {}):
            raise ModelError(
                f"{path}: changes.{shown(name)}: want {RESTITUTION}, or EFFECT.PARAMETER of what [effects] holds"
            )
        if not isinstance(change, dict):
            raise ModelError(f"{path}: changes.{shown(name)}={shown(change)}: want a table of {', '.join(hows)}")
        _known(path, f"changes.{name}", change, tuple(hows))
        full = f"changes.{name}"
        out[name] = {how: _number(path, f"{full}.{how}", value, hows[how]) for how, value in change.items()}
        if out[name].get("fading", 0.0) < 0.0:
            raise ModelError(f"{path}: {full}.fading={out[name]['fading']}: want 0 or more")
    return out


def _effects(path: Path, tables: Any) -> dict[str, dict[str, float]]:
    out: dict[str, dict[str, float]] = {}
    if not isinstance(tables, dict):
        raise ModelError(f"{path}: effects={shown(tables)}: want tables [effects.NAME]")
    for name, parameters in tables.items():
        if name not in available():
            raise ModelError(f"{path}: effect {shown(name)} is unknown, want one of {', '.join(available())}")
        known = load(name).parameter_names()
        if not isinstance(parameters, dict):
            raise ModelError(f"{path}: effects.{name}={shown(parameters)}: want a table of its parameters")
        strange = [key for key in parameters if key not in known]
        if strange:
            raise ModelError(f"{path}: effects.{name} has no {shown(strange[0])}, want one of {', '.join(known)}")
        defaults: dict[str, Any] = {field.name: field.default for field in fields(load(name))}  # type: ignore[arg-type]
        endless = load(name).unbounded
        out[name] = {
            key: _number(path, f"effects.{name}.{key}", value, defaults[key], key in endless)
            for key, value in parameters.items()
        }
    return out
