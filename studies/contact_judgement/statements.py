"""What the parameters of contact judgement move, in statements with bounds that were set beforehand.

The paper says only that nobody had examined them; the statements are ours. A shift is the logarithm of the median
criterion over that of the defaults, averaged over the frequencies without its sign; chance is what medians of as many
trials of the defaults themselves are off.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from studies.running.statements import Claim, Finding, listed, table

PLACE = "Contact updating and contact judgement"
DEPENDS = "frequency, growth of the ramp, number of trials"
FALLEN_NUMBER = "largest mean shift over chance"

CLAIMS = {
    claim.key: claim
    for claim in (
        Claim(
            "contact_judgement.lists", "How often contacts are listed, and how far around, changes no result", PLACE,
            "runs, trial by trial, whose criterion or drop differs from the default's", "<=", 0.0,
        ),
        Claim(
            "contact_judgement.reach", "How far off an edge is felt, up to 0.1 mm, matters no more than chance", PLACE,
            FALLEN_NUMBER, "<=", 1.0, depends=DEPENDS,
        ),
        Claim(
            "contact_judgement.end_slack",
            "How far beyond an edge's end a corner may touch, up to 5 mm, matters no more than chance", PLACE,
            FALLEN_NUMBER, "<=", 1.0, depends=DEPENDS,
        ),
        Claim(
            "contact_judgement.facing", "How exactly an edge has to face a corner changes no criterion", PLACE,
            "runs, trial by trial, whose criterion or drop differs from the default's", "<=", 0.0,
        ),
        Claim(
            "contact_judgement.onset", "How a contact begins matters no more than chance for the criterion", PLACE,
            FALLEN_NUMBER, "<=", 1.0, depends=DEPENDS,
        ),
        Claim(
            "contact_judgement.step", "Steps up to half the critical one matter no more than chance for the criterion",
            PLACE, FALLEN_NUMBER, "<=", 1.0, depends=DEPENDS,
        ),
        Claim(
            "contact_judgement.material", "Damping moves the criterion more than any parameter of judgement", PLACE,
            "largest mean shift by damping over the largest by judgement, onset or step", ">", 1.0, depends=DEPENDS,
        ),
    )
}  # fmt: skip

SAME = ("skin", "update_after")
JUDGED = ("reach", "end_slack", "facing", "onset", "step")


def shifts(ds: xr.Dataset) -> NDArray[Any]:
    """Logarithm of the median criterion over that of the defaults, shape (variation, frequency)."""
    base = np.log(ds.default_amplitude.median("default_trial"))
    return (np.log(ds.amplitude.median("trial")) - base).transpose("variation", "frequency").values


def chance(ds: xr.Dataset, trials: int) -> NDArray[Any]:
    """Half width of the middle 95 % of shifts of medians of so many trials drawn from the defaults' own, by
    frequency."""
    random = np.random.default_rng(1)
    logs = np.log(ds.default_amplitude.transpose("frequency", "default_trial").values)
    drawn = random.integers(0, logs.shape[1], (4000, trials))
    medians = np.median(logs[:, drawn], axis=2) - np.median(logs, axis=1)[:, None]
    low, high = np.quantile(medians, [0.025, 0.975], axis=1)
    return 0.5 * (high - low)


def _of(ds: xr.Dataset, *groups: str, largest: float = math.inf) -> xr.Dataset:
    """The variations of these groups up to a value."""
    chosen = np.isin(ds.group.values, groups) & ~(ds.value.values > largest)
    return ds.isel(variation=np.flatnonzero(chosen))


def mean_shift(ds: xr.Dataset) -> xr.DataArray:
    """Mean over the frequencies of the shift without its sign, by variation."""
    return abs(ds["shift"]).mean("frequency")


def _over_chance(ds: xr.Dataset, group: str, largest: float = math.inf) -> tuple[float, str]:
    some = _of(ds, group, largest=largest)
    if not some.sizes["variation"]:
        return math.nan, ""
    ratios = mean_shift(some) / float(ds.chance.mean())
    return float(ratios.max()), listed(dict(zip(map(str, some.variation.values), ratios.values, strict=True)))


def _differing(ds: xr.Dataset, *groups: str) -> tuple[float, str]:
    """Runs of these groups that are not those of the defaults, to the bit."""
    some = _of(ds, *groups)
    if not some.sizes["variation"]:
        return math.nan, ""
    first = ds.default_amplitude.isel(default_trial=slice(0, some.sizes["trial"])).values
    runs = int((some.amplitude.transpose("variation", "frequency", "trial").values != first).sum())
    return float(runs + int((some.difference != ds.default_difference).sum())), f"of {some.amplitude.size} runs"


def check(ds: xr.Dataset) -> xr.Dataset:
    """The statements on contact judgement."""
    rows = [
        ("lists", *_differing(ds, *SAME)),
        ("reach", *_over_chance(ds, "reach", 1e-4)),
        ("end_slack", *_over_chance(ds, "end_slack")),
        ("facing", *_differing(ds, "facing")),
        ("onset", *_over_chance(ds, "onset")),
        ("step", *_over_chance(ds, "step", 0.5)),
    ]
    judged, damped = _of(ds, *JUDGED), _of(ds, "damping")
    known = judged.sizes["variation"] and damped.sizes["variation"]
    ratio = float(mean_shift(damped).max() / mean_shift(judged).max()) if known else math.nan
    found = [Finding(CLAIMS[f"contact_judgement.{word}"], number, text) for word, number, text in rows]
    return table([*found, Finding(CLAIMS["contact_judgement.material"], ratio)])
