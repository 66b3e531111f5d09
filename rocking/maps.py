"""Maps and spectra: which blocks fall, and how far the others tilt, over any sizes, motions and amplitudes.

    >>> from excitation import RampedSinusoid
    >>> from rocking import Block, Method1
    >>> from rocking.maps import overturning_map
    >>> def build(frequency, amplitude):
    ...     return Method1(Block(0.15, 0.50)), RampedSinusoid(frequency, 5.0, amplitude)
    >>> ds = overturning_map(build, {"frequency": [1.0, 4.0], "amplitude": [2.0, 30.0]}, t_end=5.0)
    >>> ds.overturned.dims
    ('frequency', 'amplitude')

Ramped sinusoids and records that are straight between samples go some hundred times faster with `solver="taylor"`
(`"exact"` for the linear form); for a million blocks, from arrays: `rocking.solvers.arrays.taylor_batch`.

Source   Makris & Konstantinidis (2003), Earthquake Eng. Struct. Dyn. 32, 265-289, for the rocking spectrum.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rocking.arguments import array_of
from rocking.batch import solve_batch
from rocking.block import G_STANDARD, Block
from rocking.hybrid import System
from rocking.method1 import Method1
from rocking.motion import BaseMotion
from rocking.validation import positive, real

if TYPE_CHECKING:
    import xarray as xr

Build = Callable[..., tuple[System, BaseMotion | None]]


def _axis(name: str, values: ArrayLike) -> NDArray[np.float64]:
    axis = np.atleast_1d(array_of(name, values))
    if axis.ndim != 1 or axis.size == 0 or not np.all(np.isfinite(axis)):
        raise ValueError(f"{name}: want finite numbers of shape ({name},), one or more")
    return axis


def overturning_map(
    build: Build, axes: Mapping[str, ArrayLike], *, t_end: float, units: Mapping[str, str] | None = None, **options: Any
) -> xr.Dataset:
    """What becomes of a block over every combination of the axes.

    Args:
        build: called with one number for each axis, by name; returns (system, motion), the motion None for a base at
            rest.  Systems are of one method and form, motions of one kind, as `solve_batch` asks.
        axes: values of each axis by name, in the order of the dimensions of the result.
        t_end: end of every run [s].
        units: units of the axes by name, for the attributes.
        options: passed on to `solve_batch` (theta, omega, t_start, rtol, atol, solver, device ...).

    Returns:
        Dataset over the axes with `overturned`, `side`, `overturning_time` [s], `peak_rotation` [rad], `onset_time`
        [s], `impacts`, `outcome` and `t_end` [s].

    Raises:
        ValueError: there is no axis, an axis is empty or not finite, or as of `solve_batch`.
    """
    import xarray as xr

    if not axes:
        raise ValueError("axes: none given, want one or more")
    grid = {name: _axis(name, values) for name, values in axes.items()}
    shape = tuple(axis.size for axis in grid.values())
    points = itertools.product(*(axis.tolist() for axis in grid.values()))
    pairs = [build(**dict(zip(grid, point, strict=True))) for point in points]
    motions = [motion for _, motion in pairs]
    at_rest = all(motion is None for motion in motions)
    if not at_rest and any(motion is None for motion in motions):
        raise ValueError("build: gave a base at rest for some points and a motion for others; want one kind")
    moving = None if at_rest else [motion for motion in motions if motion is not None]
    result = solve_batch([system for system, _ in pairs], moving, t_end=t_end, **options)
    flat = result.to_xarray()
    flat["overturned"] = ("run", result.overturned, {"long_name": "whether the block falls"})
    reshaped = {str(name): (tuple(grid), v.values.reshape(shape), v.attrs) for name, v in flat.data_vars.items()}
    labels = units or {}
    coords = {name: (name, axis, {"units": labels[name]} if name in labels else {}) for name, axis in grid.items()}
    attributes = {"first_system": repr(pairs[0][0]), "first_motion": repr(motions[0]), "device": result.device}
    return xr.Dataset(reshaped, coords, attrs=attributes)


def block_of(p: float, alpha: float, g: float = G_STANDARD) -> Block:
    """The uniform rectangle with frequency parameter p [rad/s] and slenderness angle alpha [rad]: R = 3 g / (4 p^2)."""
    positive("p", p, "rad/s")
    positive("g", g, "m/s^2")
    if not 0.0 < real(alpha) < 0.5 * math.pi:
        raise ValueError(f"alpha={alpha!r} rad: want above 0 and below pi/2")
    R = 3.0 * g / (4.0 * p * p)
    return Block(2.0 * R * math.sin(alpha), 2.0 * R * math.cos(alpha))


def rocking_spectrum(
    motion: BaseMotion,
    period: ArrayLike,
    alpha: ArrayLike,
    *,
    t_end: float,
    restitution: float | None = None,
    g: float = G_STANDARD,
    **options: Any,
) -> xr.Dataset:
    """Rocking spectrum: largest rotation of blocks of every size and slenderness under one motion.

    Args:
        motion: what the base does.
        period: 2 pi / p of the blocks [s], shape (period,): their size.
        alpha: slenderness angles [rad], shape (alpha,).
        t_end: end of every run [s].
        restitution: e of eq. (4) [1] for all; Housner's, which depends on alpha, if not given.
        g: gravity [m/s^2].
        options: passed on to `solve_batch`.

    Returns:
        Dataset over (period, alpha) as of `overturning_map`, and `relative_rotation`, the largest |theta| over alpha
        (NaN where the block falls).

    Raises:
        ValueError: a period or an angle is out of range.
    """

    def build(period: float, alpha: float) -> tuple[System, BaseMotion]:
        return Method1(block_of(2.0 * math.pi / period, alpha, g), restitution=restitution, g=g), motion

    axes = {"period": _axis("period", period), "alpha": _axis("alpha", alpha)}
    if np.any(axes["period"] <= 0.0):
        raise ValueError(f"period={float(axes['period'].min())!r} s: want positive numbers")
    outside = axes["alpha"][(axes["alpha"] <= 0.0) | (axes["alpha"] >= 0.5 * math.pi)]
    if outside.size:
        raise ValueError(f"alpha={float(outside[0])!r} rad: want above 0 and below pi/2")
    ds = overturning_map(build, axes, t_end=t_end, units={"period": "s", "alpha": "rad"}, **options)
    ds.period.attrs["long_name"] = "2 pi / p, the size of the block"
    ds.alpha.attrs["long_name"] = "slenderness angle"
    attributes = {
        "units": "1",
        "long_name": "largest rotation over alpha",
        "reference": "Makris & Konstantinidis (2003)",
    }
    ds["relative_rotation"] = (ds.peak_rotation / ds.alpha).where(~ds.overturned).assign_attrs(attributes)
    return ds
