"""Fragility: the chance that a block falls, or tilts beyond a limit, as a function of how strong the shaking is.

Single responses of a rocking block are chaotic: a motion scaled up a little may fell it, and scaled up more may not.
What repeats is the distribution over many motions.

    runs = run_records(Method1(Block(0.15, 0.6)), records, scales, lambda r, k: scaled(r, k).motion(), t_end=20.0)
    ds = fragility(runs, limits=[0.5])

Source   Yim, Chopra & Penzien (1980), Earthquake Eng. Struct. Dyn. 8, 565-587: rocking response in terms of
         probabilities, over system parameters and intensity.
Status   one block, motions scaled; fits and intervals in `rocking.fragility_fit`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rocking.arguments import array_of
from rocking.batch import OUTCOMES, solve_batch
from rocking.effect import Effect
from rocking.effects import compose
from rocking.fragility_fit import check_share, fit_lognormal, fraction
from rocking.hybrid import System
from rocking.motion import BaseMotion

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

FAILED = OUTCOMES.index("failed")


def run_records(
    system: System,
    records: Sequence[Any],
    scales: ArrayLike,
    build: Callable[[Any, float], BaseMotion],
    *,
    t_end: float,
    intensity: ArrayLike | None = None,
    intensity_name: str = "scale",
    intensity_units: str = "1",
    progress: bool = False,
    effects: Sequence[Effect] = (),
    **options: Any,
) -> xr.Dataset:
    """One block under every record at every scale.

    Args:
        system: the block under a method.
        records: what `build` takes; with `excitation`, records or seeds.
        scales: factors, positive, ascending, shape (scale,).
        build: the base motion of one record at one scale; motions of one kind and length, as `solve_batch` asks.
        t_end: end of every run [s].
        intensity: intensity of each record at scale 1, in proportion to which it scales (a peak, a spectral value),
            shape (record,); the scale itself is the intensity if not given.
        intensity_name, intensity_units: its name and units, for the attributes.
        progress: whether to show a bar; it counts scales.
        effects: what the block lacks, as of `solve_batch`.
        options: passed on to `solve_batch`.

    Returns:
        Dataset over (scale, record): `overturned`, `relative_rotation` (largest |theta| over theta_c of the block
        with its effects; of a block that fell, that of the fall) and `intensity`.

    Raises:
        ValueError: there is no record, a scale or an intensity is not positive, or as of `solve_batch`.
    """
    import xarray as xr
    from tqdm import tqdm

    factors = np.atleast_1d(array_of("scales", scales))
    if factors.ndim != 1 or factors.size == 0 or not (factors[0] > 0.0 and np.all(np.diff(factors) > 0.0)):
        raise ValueError(f"scales={scales!r}: want positive numbers in ascending order")
    if len(records) == 0:
        raise ValueError("records: none given, want one or more")
    unit = np.ones(len(records)) if intensity is None else array_of("intensity", intensity)
    if unit.shape != (len(records),) or not (np.all(np.isfinite(unit)) and np.all(unit > 0.0)):
        raise ValueError(f"intensity: want positive numbers of shape ({len(records)},), one for each record")
    fell, tilt = (np.empty((factors.size, len(records)), dtype=kind) for kind in (bool, float))
    for i, factor in enumerate(tqdm(factors.tolist(), disable=not progress, desc="scales")):
        motions = [build(record, factor) for record in records]
        result = solve_batch(system, motions, t_end=t_end, effects=effects, **options)
        if np.any(result.outcome == FAILED):
            raise ValueError(
                f"scale={factor!r}: {np.sum(result.outcome == FAILED)} runs failed; solve them alone to see why"
            )
        fell[i], tilt[i] = result.overturned, result.peak_rotation
    name = {"units": intensity_units, "long_name": intensity_name}
    return xr.Dataset(
        {
            "overturned": (("scale", "record"), fell, {"long_name": "whether the block falls"}),
            "relative_rotation": (
                ("scale", "record"),
                tilt / compose(system, effects).theta_c,
                {"units": "1", "long_name": "largest rotation over theta_c"},
            ),
            "intensity": (("scale", "record"), factors[:, None] * unit, name),
        },
        coords={"scale": ("scale", factors, {"units": "1", "long_name": "factor on the records"})},
        attrs={
            "system": repr(system),
            "effects": ", ".join(map(repr, effects)),
            "t_end": t_end,
            "reference": "Yim, Chopra & Penzien (1980)",
        },
    )


def fragility(
    runs: xr.Dataset,
    limits: ArrayLike = (),
    *,
    confidence: float = 0.95,
    interval: Literal["clopper-pearson", "wilson"] = "clopper-pearson",
) -> xr.Dataset:
    """Fractions and lognormal fragilities of overturning, and of exceeding rotations.

    Args:
        runs: from `run_records`.
        limits: values of |theta|/theta_c that count as exceeded beside overturning, shape (limit,).
        confidence: of all intervals.
        interval: as of `fraction`.

    Returns:
        Dataset over `limit` (infinity stands for overturning) with `fraction`, `fraction_low`, `fraction_high` over
        (limit, scale), and `median`, `beta` with `_low`, `_high` over limit, NaN where there is no estimate, for the
        reason in `reason`.  Intervals of the estimates allow for the records that come at several scales; one or two
        records do not tell how far they differ, and where they come more than once the intervals are NaN.

    Raises:
        ValueError: a limit is not positive, or an argument is out of range.
    """
    import xarray as xr

    values = np.append(np.atleast_1d(np.asarray(limits, dtype=np.float64)), math.inf)
    if values.ndim != 1 or not np.all(values > 0.0):
        raise ValueError(f"limits={limits!r}: want positive numbers of shape (limit,)")
    check_share("confidence", confidence)
    # A dataset keeps its names, and may have its dimensions in any order.
    runs = runs.transpose("scale", "record", missing_dims="ignore")
    im, count = runs.intensity.values, runs.sizes["record"]
    labels = np.broadcast_to(np.arange(count), im.shape)
    fell = runs.overturned.values
    fractions, fits, reasons = [], [], []
    for value in values:
        beyond = fell if math.isinf(value) else fell | (runs.relative_rotation.values > value)
        fractions.append(fraction(beyond.sum(axis=1), count, confidence=confidence, interval=interval))
        try:
            fit = fit_lognormal(im.ravel(), beyond.ravel(), labels.ravel() if count > 2 else None)
        except ValueError as error:
            fits.append([math.nan] * 6)
            reasons.append(str(error))
            continue
        if count <= 2 and len(im) > 1:
            fits.append([fit.median, math.nan, math.nan, fit.beta, math.nan, math.nan])
            reasons.append(f"intervals: of {count} records at {len(im)} scales, want 3 records or more")
            continue
        (median_low, median_high), (beta_low, beta_high) = fit.intervals(confidence)
        fits.append([fit.median, median_low, median_high, fit.beta, beta_low, beta_high])
        reasons.append("")
    return _dataset(xr, runs, values, np.array(fractions), np.array(fits), reasons, confidence, interval)


def _dataset(
    xr: Any,
    runs: Any,
    limits: Array,
    fractions: Array,
    fits: Array,
    reasons: list[str],
    confidence: float,
    interval: str,
) -> Any:
    """The dataset of `fragility`; fractions of shape (limit, 3, scale), fits of shape (limit, 6)."""
    units = runs.intensity.attrs["units"]
    named: dict[str, Any] = {}
    for k, suffix in enumerate(("", "_low", "_high")):
        bound = ("", "lower bound of the ", "upper bound of the ")[k]
        named[f"fraction{suffix}"] = (
            ("limit", "scale"), fractions[:, k], {"units": "1", "long_name": f"{bound}fraction of records that exceed"},
        )  # fmt: skip
        named[f"median{suffix}"] = (
            "limit", fits[:, k], {"units": units, "long_name": f"{bound}median of the lognormal fragility"},
        )  # fmt: skip
        named[f"beta{suffix}"] = (
            "limit", fits[:, 3 + k], {"units": "1", "long_name": f"{bound}logarithmic standard deviation"},
        )  # fmt: skip
    named["reason"] = ("limit", reasons, {"long_name": "why there is no estimate, or none of its bounds"})
    limit = ("limit", limits, {"units": "1", "long_name": "|theta|/theta_c that is exceeded; infinity is overturning"})
    return xr.Dataset(
        named,
        coords={"limit": limit, "scale": runs.scale},
        attrs=dict(runs.attrs)
        | {
            "intensity": runs.intensity.attrs["long_name"],
            "confidence": confidence,
            "interval": interval,
            "reference": "Yim, Chopra & Penzien (1980); Baker (2015)",
        },
    )
