"""Fig. 16's statements: what the paper says of it, as a number against a bound that was set beforehand.

A dimension is named `method`, which is also a keyword of xarray's `sel`: select with `sel({"method": "dem"})`.

Source   Winkler, Meguro & Yamazaki (1995), section "Criteria of overturning for single blocks".
"""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

HOLDS, DOES_NOT, UNDECIDED = 1, 0, -1

LINEAR_R2 = 0.9  # share of variance that a straight line must explain to call a curve almost linear
ALIKE = 0.5  # Method 2 is to be at most half as far from DEM, in the logarithm, as Method 1 is
MOSTLY = 0.5  # "mostly": more than half of the time


def _decide(number: float, holds: bool) -> int:
    return UNDECIDED if math.isnan(number) else (HOLDS if holds else DOES_NOT)


def _linearity(ds: xr.Dataset) -> dict[str, float]:
    """r^2 by block of a straight line through Method 1's criteria."""
    found = {}
    for block, curve in ds.overturning_amplitude.sel({"method": "method1"}).groupby("block"):
        known = curve.squeeze().dropna("frequency")
        few = known.sizes["frequency"] < 3
        found[f"Block {block}"] = math.nan if few else float(np.corrcoef(known.frequency, known)[0, 1]) ** 2
    return found


def _log_distance(ds: xr.Dataset, one: str, other: str) -> float:
    """Mean |log(one / other)| beyond 3 Hz over the points where every method has an amplitude."""
    a = ds.overturning_amplitude.where(ds.frequency > 3.0, drop=True)
    a = a.where(a.notnull().all("method"))
    return float(np.abs(np.log(a.sel({"method": one}) / a.sel({"method": other}))).mean())


def _spread_beyond_3_hz(ds: xr.Dataset) -> float:
    """Mean |log(Method 2 / DEM)| beyond 3 Hz over that up to 3 Hz."""
    a = ds.overturning_amplitude
    apart = np.abs(np.log(a.sel({"method": "method2"}) / a.sel({"method": "dem"})))
    below = float(apart.where(ds.frequency <= 3.0).mean())
    return float(apart.where(ds.frequency > 3.0).mean()) / below if below > 0.0 else math.nan


def _sliding_rotation(ds: xr.Dataset, method: str) -> float:
    """Share of slide rotation in the second half of the way to overturning, from 3 Hz on."""
    share = ds.mode_fraction_late.sel({"method": method}).where(ds.frequency >= 3.0)
    return float(share.sel(mode="slide_rotation").mean())


def _periods_from_onset(ds: xr.Dataset) -> dict[str, float]:
    """At the lowest frequency, periods from when the envelope passes (b/h) g until overturning, by run."""
    slow = ds.isel(frequency=0)
    # The envelope is a straight line through zero, so time is proportional to it.
    onset = slow.overturning_time * (slow.b / slow.h * 9.80665) / slow.overturning_amplitude
    periods = (slow.overturning_time - onset) * slow.frequency
    return {
        f"{method}, Block {block}": float(periods.sel({"method": method, "block": block}))
        for method in ds.method.values
        for block in ds.block.values
    }


def _listed(numbers: dict[str, float]) -> str:
    return "; ".join(f"{name} {number:.2f}" for name, number in numbers.items())


def check(ds: xr.Dataset) -> xr.Dataset:
    """The statements of the paper on Fig. 16, each with the number found, the bound and whether it holds."""
    methods = set(ds.method.values)
    rows: list[tuple[str, float, str, int, str]] = []

    def add(statement: str, number: float, bound: str, holds: bool, detail: str = "") -> None:
        rows.append((statement, number, bound, _decide(number, holds), detail))

    if "method1" in methods:
        by_block = _linearity(ds)
        r2 = float(np.min(list(by_block.values())))  # unknown if one of them is
        add(
            "Method 1 grows almost linearly with frequency", r2,
            f"smallest r^2 over the blocks >= {LINEAR_R2}", r2 >= LINEAR_R2, _listed(by_block),
        )  # fmt: skip
    if {"method1", "method2", "dem"} <= methods:
        ratio = _log_distance(ds, "method2", "dem") / _log_distance(ds, "method1", "dem")
        add(
            "Method 2 and DEM are alike and far from Method 1 beyond 3 Hz", ratio,
            f"distance of Method 2 from DEM over that of Method 1 from DEM (log) <= {ALIKE}", ratio <= ALIKE,
        )  # fmt: skip
    if {"method2", "dem"} <= methods:
        spread = _spread_beyond_3_hz(ds)
        add(
            "Method 2 and DEM differ most beyond 3 Hz", spread,
            "their distance beyond 3 Hz over that up to 3 Hz (log) > 1", spread > 1.0,
        )  # fmt: skip
    for method, label in (("method2", "Method 2"), ("dem", "DEM")):
        if method in methods:
            share = _sliding_rotation(ds, method)
            add(
                f"{label}: at large amplitude (from 3 Hz on) the motion is mostly sliding rotation", share,
                f"share of the second half of the way to overturning > {MOSTLY}", share > MOSTLY,
            )  # fmt: skip
    by_run = _periods_from_onset(ds)
    periods = max((n for n in by_run.values() if not math.isnan(n)), default=math.nan)
    add(
        "At the lowest frequency blocks overturn as rocking would begin", periods,
        "most periods of any run from West's threshold to overturning <= 1", periods <= 1.0, _listed(by_run),
    )  # fmt: skip
    statements, numbers, bounds, holds, details = zip(*rows, strict=True)
    reference = {"reference": "Winkler, Meguro & Yamazaki (1995), Criteria of overturning for single blocks"}
    flags = {"flag_values": [HOLDS, DOES_NOT, UNDECIDED], "flag_meanings": "holds does_not_hold not_decided"}
    return xr.Dataset(
        {
            "statement_number": ("statement", list(numbers), {"units": "1", "long_name": "number found", **reference}),
            "statement_bound": ("statement", list(bounds), {"long_name": "what decides"}),
            "statement_detail": ("statement", list(details), {"long_name": "the number by block or run"}),
            "statement_holds": ("statement", list(holds), {"long_name": "does the statement hold", **flags}),
        },
        coords={"statement": ("statement", list(statements), {"long_name": "statement of the paper"})},
    )
