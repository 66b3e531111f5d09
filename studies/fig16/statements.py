"""Fig. 16's statements: what the paper says of it, as a number against a bound that was set beforehand.

A dimension is named `method`, which is also a keyword of xarray's `sel`: select with `sel({"method": "dem"})`.

Source   Winkler, Meguro & Yamazaki (1995), section "Criteria of overturning for single blocks".
"""

from __future__ import annotations

import json
import math

import numpy as np
import xarray as xr

from rocking import G_STANDARD
from rocking.effects import load
from studies.claims.bounds import CLAIMS
from studies.running.statements import Finding, listed, table


def _linearity(ds: xr.Dataset) -> dict[str, float]:
    """r^2 by block of a straight line through Method 1's criteria."""
    found = {}
    for block, curve in ds.overturning_amplitude.sel({"method": "method1"}).groupby("block"):
        known = curve.squeeze("block").dropna("frequency")
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


def _begins_at_west(ds: xr.Dataset) -> bool:
    """Whether rocking begins where the envelope of the file passes (b/h) g: no effect bears on the base or lift-off."""
    effects = json.loads(ds.attrs.get("settings", "{}")).get("effects", {})
    return all(load(name).ways() <= {"restitution", "modes"} for name in effects)


def _periods_from_onset(ds: xr.Dataset) -> dict[str, float]:
    """At the lowest frequency, periods from when the envelope passes (b/h) g until overturning, by run.

    NaN where an effect moves the start of rocking elsewhere.
    """
    slow = ds.isel(frequency=0)
    # The envelope is a straight line through zero, so time is proportional to it.
    onset = slow.overturning_time * (slow.b / slow.h * G_STANDARD) / slow.overturning_amplitude
    periods = ((slow.overturning_time - onset) * slow.frequency).where(_begins_at_west(ds))
    return {
        f"{method}, Block {block}": float(periods.sel({"method": method, "block": block}))
        for method in ds.method.values
        for block in ds.block.values
    }


def check(ds: xr.Dataset) -> xr.Dataset:
    """The statements of the paper on Fig. 16, each with the number found, the bound and whether it holds."""
    methods = set(ds.method.values)
    found: list[Finding] = []

    def add(word: str, number: float, detail: str = "") -> None:
        found.append(Finding(CLAIMS[f"fig16.{word}"], number, detail))

    if "method1" in methods:
        by_block = _linearity(ds)
        add("linear", float(np.min(list(by_block.values()))), listed(by_block))  # unknown if one of them is
    if {"method1", "method2", "dem"} <= methods:
        add("alike", _log_distance(ds, "method2", "dem") / _log_distance(ds, "method1", "dem"))
    if {"method2", "dem"} <= methods:
        add("beyond", _spread_beyond_3_hz(ds))
    for method in ("method2", "dem"):
        if method in methods:
            add(f"sliding_{method}", _sliding_rotation(ds, method))
    by_run = _periods_from_onset(ds)
    add("at_once", max((n for n in by_run.values() if not math.isnan(n)), default=math.nan), listed(by_run))
    return table(found)
