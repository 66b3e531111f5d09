"""What was planted in a campaign, what counts as found, and what the true model itself would score."""

from __future__ import annotations

import tomllib
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from studies.running.files import save_text, write_whole


@dataclass(frozen=True)
class Truth:
    """The hidden side of a campaign.

    `accepted` lists the sets of effects that count as traced; `parameters` maps "effect.name" to its true value;
    `floor` and `baseline` are median RMS errors over the tests of the campaign ("fit", of rotation) and over those to
    predict ("predict", of the campaign's own channel, against noise-free truth), or shares of wrong outcomes; `hidden`
    the noise-free responses by test to predict, shape (time,).
    """

    name: str
    effects: tuple[str, ...]
    verdicts: tuple[str, ...]
    accepted: tuple[tuple[str, ...], ...]
    parameters: dict[str, float]
    restitution: float
    channel: str  # rotation, block_acceleration or outcome
    noise: float
    floor: dict[str, float]
    baseline: dict[str, float]
    overturned: dict[str, bool]
    about: dict[str, Any] = field(default_factory=dict)
    hidden: dict[str, dict[str, np.ndarray]] = field(default_factory=dict)

    def write(self, folder: Path) -> None:
        """truth.toml and a CSV of the noise-free response of every test to predict."""
        folder.mkdir(parents=True, exist_ok=True)
        table = asdict(self)
        del table["hidden"]
        for id, columns in self.hidden.items():
            values, header = np.stack(list(columns.values()), axis=1), ",".join(columns)

            def write(target: Path, values: np.ndarray = values, header: str = header) -> None:
                np.savetxt(target, values, fmt="%.7g", delimiter=",", header=header, comments="")

            write_whole(folder / f"{id}.csv", write)
        # Last: where it is, all of the truth is.
        save_text(tomli_w.dumps(_plain(table)), folder / "truth.toml")


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items() if v is not None}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    return value.item() if isinstance(value, np.generic) else value


def read_truth(folder: Path) -> Truth:
    """What `Truth.write` left."""
    with (folder / "truth.toml").open("rb") as file:
        table = tomllib.load(file)
    hidden = {}
    for path in sorted(folder.glob("*.csv")):
        values = np.atleast_1d(np.genfromtxt(path, delimiter=",", names=True))
        hidden[path.stem] = {name: values[name] for name in values.dtype.names or ()}
    for key in ("effects", "verdicts"):
        table[key] = tuple(table[key])
    table["accepted"] = tuple(tuple(a) for a in table["accepted"])
    return Truth(**table, hidden=hidden)
