"""`baseline.toml` and `model.toml`: a model on disk.

    [block]            as declared: breadth, height, depth [m], mass [kg] ...
    [model]            restitution [1], gravity [m/s^2]
    [effects.NAME]     parameters of each effect, SI units
    [mountings]        by channel, how far an accelerometer on the block is turned from its declared axis [rad]

Status   what was written reads back to the same bits.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import asdict
from pathlib import Path
from typing import Any

import tomli_w

from rocking.effects import available, load
from studies.campaigns import DeclaredBlock
from studies.loop.model import LoopModel


class ModelError(ValueError):
    """A model file that cannot be used; the message names file and entry."""


def write_model(model: LoopModel, path: Path, title: str = "") -> None:
    """Write a model; the file appears whole or not at all."""
    block = {key: value for key, value in asdict(model.declared).items() if value is not None}
    content: dict[str, Any] = {
        "title": title,
        "block": block,
        "model": {
            "restitution": model.restitution,
            "gravity": model.g,
            "restitution_drift": model.drift,
            "number": model.number,
        },
        "effects": {name: dict(parameters) for name, parameters in model.effects.items()},
        "mountings": dict(model.mountings),
    }
    part = path.with_name(path.name + ".part")
    part.write_bytes(tomli_w.dumps(content).encode())
    part.replace(path)


def read_model(path: Path) -> LoopModel:
    """Read a model.

    Raises:
        ModelError: the file is not there or no TOML, or an entry is missing, unknown or out of its range.
    """
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ModelError(f"{path}: cannot be read ({error.strerror}); want a model.toml that the loop wrote") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ModelError(f"{path}: is no TOML: {error}") from None
    block, model = _table(path, content, "block"), _table(path, content, "model")
    sizes = {key: _number(path, f"block.{key}", value) for key, value in block.items()}
    try:
        declared = DeclaredBlock(**sizes)
    except TypeError:
        raise ModelError(f"{path}: block has {', '.join(block)}; want breadth, height, depth and mass") from None
    found = LoopModel(
        declared,
        _number(path, "model.restitution", model.get("restitution")),
        _effects(path, content.get("effects", {})),
        _number(path, "model.gravity", model.get("gravity")),
        _number(path, "model.restitution_drift", model.get("restitution_drift", 0.0)),
        int(_number(path, "model.number", model.get("number", 0))),
        _mountings(path, content.get("mountings", {})),
    )
    try:
        found.system  # noqa: B018 (refuses what does not go together)
    except ValueError as error:
        raise ModelError(f"{path}: {error}") from None
    return found


def _table(path: Path, content: dict[str, Any], name: str) -> dict[str, Any]:
    table = content.get(name)
    if not isinstance(table, dict):
        raise ModelError(f"{path}: has no table [{name}], want the model.toml that the loop wrote")
    return table


def _number(path: Path, name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or math.isnan(value):
        raise ModelError(f"{path}: {name}={value!r}: want a number")
    return float(value)


def _mountings(path: Path, table: Any) -> dict[str, float]:
    if not isinstance(table, dict):
        raise ModelError(f"{path}: mountings={table!r}: want a table of angles by channel")
    return {name: _number(path, f"mountings.{name}", value) for name, value in table.items()}


def _effects(path: Path, tables: Any) -> dict[str, dict[str, float]]:
    out: dict[str, dict[str, float]] = {}
    if not isinstance(tables, dict):
        raise ModelError(f"{path}: effects={tables!r}: want tables [effects.NAME]")
    for name, parameters in tables.items():
        if name not in available():
            raise ModelError(f"{path}: effect {name!r} is unknown, want one of {', '.join(available())}")
        known = load(name).parameter_names()
        if not isinstance(parameters, dict):
            raise ModelError(f"{path}: effects.{name}={parameters!r}: want a table of its parameters")
        strange = [key for key in parameters if key not in known]
        if strange:
            raise ModelError(f"{path}: effects.{name} has no {strange[0]!r}, want one of {', '.join(known)}")
        out[name] = {key: _number(path, f"effects.{name}.{key}", value) for key, value in parameters.items()}
    return out
