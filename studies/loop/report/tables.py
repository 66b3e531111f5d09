"""The tables of the report as plain rows."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from studies.campaigns import Campaign
from studies.loop.dataset import HELD_OUT
from studies.loop.report.text import amount


@dataclass(frozen=True)
class ErrorRow:
    """Errors of a test [rad, or m/s^2 of accelerometers alone], and where they stand on a logarithmic axis [%]."""

    id: str
    role: str
    before: float
    after: float
    before_at: float
    after_at: float


@dataclass(frozen=True)
class Axis:
    """A logarithmic axis over the errors: whole decades."""

    low: int
    high: int

    def at(self, value: float) -> float:
        """Where a value stands [%]."""
        if not value > 0.0:
            return 0.0
        return min(max(100.0 * (math.log10(value) - self.low) / (self.high - self.low), 0.0), 100.0)

    @property
    def ticks(self) -> list[tuple[str, float]]:
        """(label, place) of each decade."""
        return [(f"{10.0**k:g}", self.at(10.0**k)) for k in range(self.low, self.high + 1)]


def tests_of(tree: xr.DataTree) -> list[xr.Dataset]:
    """Datasets of the tests in the order in which they were done."""
    return sorted((node.to_dataset() for node in tree["tests"].children.values()), key=lambda ds: ds.attrs["number"])


def error_rows(tests: list[xr.Dataset]) -> tuple[list[ErrorRow], Axis]:
    """Errors by test, and the axis on which they are drawn."""
    seen = [ds for ds in tests if "error_before" in ds]
    pairs = [(float(ds.error_before), float(ds.error_after)) for ds in seen]
    known = [v for pair in pairs for v in pair if v > 0.0]
    low = math.floor(math.log10(min(known))) if known else -4
    axis = Axis(low, max(math.ceil(math.log10(max(known))) if known else 0, low + 1))
    rows = [
        ErrorRow(ds.attrs["id"], ds.attrs["role"], before, after, axis.at(before), axis.at(after))
        for ds, (before, after) in zip(seen, pairs, strict=True)
    ]
    return rows, axis


def measured_rows(tests: list[xr.Dataset], campaign: Campaign) -> list[dict[str, str]]:
    """What was measured, a row for each test."""
    rows = []
    for ds in tests:
        test = campaign.test(ds.attrs["id"])
        rows.append(
            {
                "id": test.id,
                "kind": test.kind,
                "motion": test.motion or "",
                "role": ds.attrs["role"],
                "duration": amount(test.duration, "s"),
                "rate": amount(1.0 / test.time_step, "Hz"),
                "rotation": _peak(ds, "rotation", "rad"),
                "share": _share(ds, campaign.block.alpha),
                "base": _peak(ds, "base_acceleration_x", "m/s²"),
            }
        )
    return rows


def _peak(ds: xr.Dataset, name: str, units: str) -> str:
    if name not in ds or not np.isfinite(ds[name].values).any():
        return "–"
    return amount(float(np.nanmax(np.abs(ds[name].values))), units)


def _share(ds: xr.Dataset, alpha: float) -> str:
    if "rotation" not in ds or not np.isfinite(ds.rotation.values).any():
        return "–"
    return f"{100.0 * float(np.nanmax(np.abs(ds.rotation.values))) / alpha:.0f} %"


def onset_rows(tests: list[xr.Dataset]) -> list[dict[str, Any]]:
    """When forced tests first moved: measured, and measured less modelled [s]."""
    return [
        {
            "id": ds.attrs["id"],
            "measured": _finite(ds.onset),
            "before": _finite(ds.onset_residual_before),
            "after": _finite(ds.onset_residual_after),
        }
        for ds in tests
        if "onset" in ds
    ]


def _finite(value: xr.DataArray) -> float | None:
    number = float(value)
    return number if math.isfinite(number) else None


def telling(tests: list[xr.Dataset]) -> list[str]:
    """Ids of up to three tests that show the difference best: held out, forced, and free, of the largest errors."""
    seen = sorted((ds for ds in tests if "error_before" in ds), key=lambda ds: -float(ds.error_before))
    wanted = (
        lambda ds: ds.attrs["role"] == HELD_OUT,
        lambda ds: ds.attrs["kind"] == "forced" and ds.attrs["role"] != HELD_OUT,
        lambda ds: ds.attrs["kind"] == "free" and ds.attrs["role"] != HELD_OUT,
    )
    chosen = [next((ds.attrs["id"] for ds in seen if fits(ds)), None) for fits in wanted]
    return [id for id in chosen if id is not None]
