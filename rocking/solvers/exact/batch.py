"""Many blocks at a time through the exact solver: maps, spectra and fragilities of the linear Method 1.

>>> from rocking.solvers.exact.batch import RampedSines, exact_batch
>>> waves = RampedSines(omega=[6.0, 12.0], rate=1.5, duration=10.0)
>>> exact_batch(waves, p=5.3, alpha=0.29, e=0.88, t_end=10.0).overturned.shape
(2,)

Source   as of `rocking.solvers.exact`.
Status   the linear kernel of `rocking.solvers.taylor.lanes`, several runs in the lanes of a vector: the bits of
         `solve(..., solver="taylor")` whatever the number of threads; `solver="exact"` agrees to rounding.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rocking.block import G_STANDARD
from rocking.solvers.devices import checked_precision, chosen, label
from rocking.solvers.taylor.batch import (
    COUNT,
    ENDED,
    FINISHED,
    LARGEST,
    OVERTURNED,
    OVERTURNING,
    SIDE,
    carry_portions,
    start_rows,
)
from rocking.solvers.taylor.records import joined, scaled


class RampedSines(NamedTuple):
    """a_x = rate t sin(omega t + phase) from 0 to duration, 0 outside; each of any shape that broadcasts."""

    omega: ArrayLike  # [rad/s]
    rate: ArrayLike  # [m/s^3]
    duration: ArrayLike  # [s], positive
    phase: ArrayLike = 0.0  # [rad]


class ScaledRecord(NamedTuple):
    """One record for all runs: straight between equally spaced samples, 0 before and after."""

    values: ArrayLike  # a_x [m/s^2], shape (sample,), two or more
    dt: float  # [s], positive
    t_first: float = 0.0  # time of the first sample [s]
    scale: ArrayLike = 1.0  # factor on the values [1], of any shape that broadcasts
    time_scale: ArrayLike = 1.0  # factor on dt [1], positive, of any shape that broadcasts


class ExactBatchResult(NamedTuple):
    """What became of each run; every array has the shape that the arguments broadcast to."""

    overturned: NDArray[np.bool_]
    side: NDArray[np.int64]  # +1 or -1 where it fell, else 0
    overturning_time: NDArray[np.float64]  # [s], last passage of |theta| = alpha before the fall; NaN without a fall
    peak_rotation: NDArray[np.float64]  # largest |theta| [rad]; pi/2 after a fall
    impacts: NDArray[np.int64]
    t_end: NDArray[np.float64]  # end of the run [s]: the fall, or the end asked for
    finished: NDArray[np.bool_]  # False where a run had too many events or got stuck in them
    device: NDArray[np.str_]  # where it was carried and how, as of `rocking.solvers.devices.label`


def _checked(name: str, value: ArrayLike, unit: str, low: float, high: float, *, low_in: bool = True) -> Any:
    """`value` as float64 array; ValueError with its first number outside of low to high."""
    array = np.asarray(value, dtype=np.float64)
    good = np.isfinite(array) & (array >= low if low_in else array > low) & (array <= high)
    if not np.all(good):
        bad = float(np.atleast_1d(array)[~np.atleast_1d(good)][0])
        bracket = "" if low_in else "above "
        raise ValueError(f"{name}={bad!r} {unit}: want {bracket}{low:g} to {high:g}".replace(" to inf", " and finite"))
    return array


def block_columns(p: Any, alpha: Any, g: Any, onset: Any, e: Any, rest_speed: Any) -> list[Any]:
    """(p^2, alpha, g, onset, e, omega_rest), checked."""
    p = _checked("p", p, "rad/s", 0.0, math.inf, low_in=False)
    alpha = _checked("alpha", alpha, "rad", 0.0, 0.5 * math.pi, low_in=False)
    onset = _checked("onset", onset, "1", 0.0, math.inf)
    if np.any(onset < alpha):
        raise ValueError(
            "onset: want alpha or more in every run (a block that starts to rock below falls back at once)"
        )
    rest = _checked("rest_speed", rest_speed, "1", 0.0, math.inf, low_in=False)
    e = _checked("e", e, "1", 0.0, 1.0)
    return [p * p, alpha, _checked("g", g, "m/s^2", 0.0, math.inf, low_in=False), onset, e, rest * p]


def start_columns(theta: Any, omega: Any, t_start: Any, t_end: Any) -> list[Any]:
    """(theta, omega, t_start, t_end), checked."""
    theta = _checked("theta", theta, "rad", -0.5 * math.pi, 0.5 * math.pi)
    if np.any(np.abs(theta) >= 0.5 * math.pi):
        raise ValueError("theta: want between -pi/2 and pi/2, where the block lies on its side")
    t_start = _checked("t_start", t_start, "s", -math.inf, math.inf)
    t_end = _checked("t_end", t_end, "s", -math.inf, math.inf)
    if np.any(t_end <= t_start):
        raise ValueError("t_end: want a time after t_start in every run")
    return [theta, _checked("omega", omega, "rad/s", -math.inf, math.inf), t_start, t_end]


def motion_columns(motion: RampedSines | ScaledRecord) -> list[Any]:
    """What of the motion differs between runs, checked."""
    if isinstance(motion, RampedSines):
        return [
            _checked("omega of the motion", motion.omega, "rad/s", -math.inf, math.inf),
            _checked("phase", motion.phase, "rad", -math.inf, math.inf),
            _checked("rate", motion.rate, "m/s^3", -math.inf, math.inf),
            _checked("duration", motion.duration, "s", 0.0, math.inf, low_in=False),
        ]
    if isinstance(motion, ScaledRecord):
        return [
            _checked("scale", motion.scale, "1", -math.inf, math.inf),
            _checked("time_scale", motion.time_scale, "1", 0.0, math.inf, low_in=False),
        ]
    raise ValueError(f"motion={type(motion).__name__}: want RampedSines or ScaledRecord")


def _record(motion: ScaledRecord) -> tuple[Any, Any]:
    """((t_first, dt), values) of the record, checked."""
    values = np.ascontiguousarray(motion.values, dtype=np.float64)
    if values.ndim != 1 or values.size < 2 or not np.all(np.isfinite(values)):
        raise ValueError("values: want finite accelerations of shape (sample,), two samples or more")
    _checked("dt", motion.dt, "s", 0.0, math.inf, low_in=False)
    _checked("t_first", motion.t_first, "s", -math.inf, math.inf)
    return np.array([motion.t_first, motion.dt], dtype=np.float64), values


def _part(columns: list[Any], shape: tuple[int, ...], first: int, stop: int) -> NDArray[np.float64]:
    """Rows first to stop of the table whose columns are the broadcast arrays."""
    at = np.unravel_index(np.arange(first, stop), shape) if shape else ()
    table = np.empty((stop - first, len(columns)))
    for j, column in enumerate(columns):
        table[:, j] = column if column.ndim == 0 else np.broadcast_to(column, shape)[at]
    return table


def exact_batch(
    motion: RampedSines | ScaledRecord,
    *,
    p: ArrayLike,
    alpha: ArrayLike,
    e: ArrayLike,
    t_end: ArrayLike,
    t_start: ArrayLike = 0.0,
    theta: ArrayLike = 0.0,
    omega: ArrayLike = 0.0,
    onset: ArrayLike | None = None,
    g: ArrayLike = G_STANDARD,
    rest_speed: ArrayLike = 1e-6,
    max_events: int = 1_000_000,
    workers: int | None = None,
    device: str | None = None,
    precision: str = "float64",
) -> ExactBatchResult:
    """Carry many blocks, each to its fall or to t_end, by the linear Method 1 in closed form between impacts.

    All arrays broadcast against each other and against those of the motion; each element is one run.

    Args:
        motion: RampedSines or ScaledRecord.
        p: frequency parameter [rad/s], positive.
        alpha: slenderness angle [rad], 0 to pi/2.
        e: restitution, omega after / before an impact [1], 0 to 1.
        t_end, t_start: times [s].
        theta, omega: rotation [rad] and angular velocity [rad/s] at the start; at rest and upright if both are 0.
        onset: |a_x| / g at which rocking starts [1], alpha or more; West's b/h = tan(alpha) if not given.
        g: acceleration of gravity [m/s^2], positive.
        rest_speed: an impact after which |omega| / p is below this [1] is the last one, if the base
            lets the block stand.
        max_events: a run with more events (impacts, starts, passages of balance) ends unfinished.
        workers: threads on the CPU; as many as there are cores if not given.
        device: "cpu", "gpu" or "jax-cpu" (`rocking.solvers.devices`); if not given, a GPU if JAX finds one and the
            runs are many, else the CPU.
        precision: "float64", or "float32" on a device of JAX, for GPUs that are slow in the other: tilts and times
            to about 1e-6 of themselves, which each impact multiplies. Runs of many impacts are then decided by
            rounding: of 10,000 over 30 s of noise, with 420 impacts on average, 285 fell otherwise than on the
            CPU, in double precision 79. Runs with a rest_speed below 1e-7 may not finish.

    Returns:
        ExactBatchResult of arrays of the broadcast shape.

    Raises:
        ValueError: an argument is out of the range above or not finite, or the shapes do not broadcast.
    """
    groups = [
        block_columns(p, alpha, g, np.tan(np.asarray(alpha, np.float64)) if onset is None else onset, e, rest_speed),
        start_columns(theta, omega, t_start, t_end),
        motion_columns(motion),
    ]
    runs = math.prod(np.broadcast_shapes(*(column.shape for group in groups for column in group)))
    on = checked_precision(precision, chosen(device, runs))
    return carry_arrays("linear", motion, groups, max_events, workers, on, precision)


def carry_arrays(
    form: str,
    motion: RampedSines | ScaledRecord,
    groups: list[list[Any]],
    max_events: int,
    workers: int | None,
    device: Any = None,
    precision: str = "float64",
) -> ExactBatchResult:
    """The runs whose checked columns (blocks, starts, motions) are given; device: one of JAX, or None."""
    if max_events < 1:
        raise ValueError(f"max_events={max_events!r}: want 1 or more")
    if workers is not None and workers < 1:
        raise ValueError(f"workers={workers!r}: want 1 or more")
    shape = np.broadcast_shapes(*(column.shape for group in groups for column in group))

    def part(first: int, stop: int) -> list[NDArray[np.float64]]:
        pars, starts, motions = (_part(group, shape, first, stop) for group in groups)
        return [pars, start_rows(*starts.T), motions if samples is None else scaled(rows[0], *motions.T)]

    samples, rows = joined([_record(motion)]) if isinstance(motion, ScaledRecord) else (None, np.empty((0, 0)))
    if device is None:
        return _result(carry_portions(form, samples, part, math.prod(shape), max_events, workers), shape, label(device))
    from rocking.solvers.exact.jax_batch import carry_on_device

    pars, starts, motions = part(0, math.prod(shape))
    table = carry_on_device(samples, pars, starts, motions, max_events, device, precision=precision)
    return _result(table, shape, label(device, precision))


def _result(rows: NDArray[np.float64], shape: tuple[int, ...], made: str) -> ExactBatchResult:
    def column(k: int) -> Any:
        return rows[:, k].reshape(shape)

    return ExactBatchResult(
        column(OVERTURNED) > 0.0, column(SIDE).astype(np.int64), column(OVERTURNING).copy(), column(LARGEST).copy(),
        column(COUNT).astype(np.int64), column(ENDED).copy(), column(FINISHED) > 0.0,
        np.broadcast_to(np.array(made), shape),
    )  # fmt: skip
