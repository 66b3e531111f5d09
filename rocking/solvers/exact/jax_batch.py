"""Many blocks at a time through the linear Method 1 in closed form, on the device that JAX has: a GPU above all.

Runs go side by side in lanes; a lane whose run is over takes the next.  Every round (`jax_rounds`) is the same
operations for all lanes, so that a GPU carries them in its registers; impacts are located to rounding.

Source   as of `rocking.solvers.exact`.
Status   agrees with the compiled batch of `rocking.solvers.taylor.batch` to rounding, which each impact multiplies, in
         double precision and in single, on the CPU and on a GPU (H200).  How long it takes:
         `benchmarks/maps_on_device.py`.  JAX's 64-bit mode is on while runs are carried, and only then.
"""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from numpy.typing import NDArray

from rocking.hybrid import REST, ROTATION
from rocking.solvers.exact.jax_lanes import RUNNING, Base, Fixed, Moving, begun, constants, idle
from rocking.solvers.exact.jax_rounds import one_step, pass_intervals
from rocking.solvers.recording import FELL, REACHED_END
from rocking.solvers.taylor.columns import COLUMNS
from rocking.solvers.taylor.records import Samples

Array = NDArray[np.float64]

MOST_LANES = 2**17
"""Runs side by side at most: what they hold then fits into the cache of a large GPU.  On an H200 half of it took a
fifth more for 490,000 sinusoids, and a tenth less for as many blocks under a record."""

ROUNDS = 16
"""Rounds after which lanes that are done take the next runs."""


class Runs(NamedTuple):
    """Rows of all runs, and what has become of them."""

    pars: Any
    starts: Any
    motions: Any
    out: Any


class Lanes(NamedTuple):
    """The runs under way."""

    F: Fixed
    M: Moving
    run: Any  # which run each lane carries; the number of runs for none
    next: Any  # the first run that no lane has taken
    out: Any


def summary(F: Fixed, M: Moving) -> Any:
    """Rows of the table that `rocking.solvers.taylor.batch` describes, shape (lane, column)."""
    fell, ended = M.status == FELL, M.status == REACHED_END
    t_end = jnp.where(ended, F.t_end, M.last)
    columns = (
        fell, jnp.where(fell, M.s, 0.0), jnp.where(fell, M.passage, jnp.nan), M.peak, M.impacts, fell | ended, t_end,
        M.onset_time, jnp.where(M.rests, REST, ROTATION),
    )  # fmt: skip
    return jnp.stack([jnp.asarray(column, F.p.dtype) for column in columns], axis=1)


def refill(runs: Runs, lanes: Lanes, wave: bool) -> Lanes:
    """Write down what is over, and put the next runs into the lanes that are free."""
    total = runs.pars.shape[0]
    free = lanes.M.status != RUNNING
    out = lanes.out.at[jnp.where(free, lanes.run, total)].set(summary(lanes.F, lanes.M), mode="drop")
    run = jnp.where(free, jnp.minimum(lanes.next + jnp.cumsum(free) - 1, total), lanes.run)
    takes = free & (run < total)
    row = jnp.minimum(run, total - 1)
    F = constants(runs.pars[row], runs.starts[row], runs.motions[row], wave)
    M = begun(F, runs.starts[row])

    def chosen(new: Any, old: Any) -> Any:
        return jax.tree.map(lambda a, b: jnp.where(takes, a, b), new, old)

    return Lanes(chosen(F, lanes.F), chosen(M, lanes.M), run, jnp.minimum(lanes.next + free.sum(), total), out)


@partial(jax.jit, static_argnames=("wave", "width"))
def carried(runs: Runs, base: Base, max_events: Any, wave: bool, width: int) -> Any:
    """What became of each run, shape (run, column)."""
    row = jnp.zeros(width, jnp.int64)
    F = constants(runs.pars[row], runs.starts[row], runs.motions[row], wave)
    M = idle(begun(F, runs.starts[row]))
    nobody = jnp.full(width, runs.pars.shape[0])
    # XLA would count lanes that it knows to be free at compile time, for many seconds.
    M, nobody = lax.optimization_barrier((M, nobody))
    lanes = refill(runs, Lanes(F, M, nobody, jnp.asarray(0), runs.out), wave)

    def on(lanes: Lanes) -> Any:
        return jnp.any(lanes.M.status == RUNNING)

    def round_(_: Any, lanes: Lanes) -> Lanes:
        M = pass_intervals(lanes.F, base, lanes.M, wave)
        return lanes._replace(M=one_step(lanes.F, base, M, max_events, wave))

    def go(lanes: Lanes) -> Lanes:
        return refill(runs, lax.fori_loop(0, ROUNDS, round_, lanes), wave)

    return lax.while_loop(on, go, lanes).out


def _as(precision: str, numbers: Any, positive: bool = False) -> Any:
    """The numbers in that precision; ValueError if one is beyond its range, or, where it is positive, below it."""
    given = np.asarray(numbers, np.float64)
    if precision == "float64":
        return given
    with np.errstate(over="ignore", under="ignore"):
        kept = given.astype(precision)
    lost = np.isfinite(given) & ~np.isfinite(kept)
    if positive:
        lost |= (given > 0.0) & (kept < np.finfo(precision).tiny)
    if np.any(lost):
        raise ValueError(
            f"precision={precision!r}: does not hold {float(given[lost].flat[0])!r}, want 'float64' for such runs"
        )
    return kept


def carry_on_device(
    record: Samples | None,
    pars: Array,
    starts: Array,
    motions: Array,
    max_events: int,
    device: Any,
    most_lanes: int = MOST_LANES,
    precision: str = "float64",
) -> Array:
    """What became of each run, as `rocking.solvers.taylor.batch.carry_portions` gives it.

    record: None for sinusoids; pars, starts, motions: tables of a row for each run; device: one of JAX; precision:
    of the numbers that it calculates with.
    """
    count = pars.shape[0]
    width = min(most_lanes, max(64, 2 ** (count - 1).bit_length()))
    shared = record if record is not None else (np.zeros(2), np.zeros(2))
    # Where a record begins among the samples is a number of the table.
    if np.size(shared[0]) > 2.0 / np.finfo(precision).eps:
        raise ValueError(
            f"precision={precision!r}: the records have {np.size(shared[0])} samples, too many to count in it"
        )
    tables = (pars, starts, motions, np.full((count, COLUMNS), np.nan))
    # What is very small is zero but among the numbers of a block, which are divided by.
    rows = Runs(*(_as(precision, a, positive=a is pars) for a in tables))
    samples = Base(*(_as(precision, a) for a in shared))
    with jax.enable_x64(True), jax.default_device(device):
        runs, base = jax.device_put((rows, samples), device)
        return np.array(carried(runs, base, jnp.asarray(max_events), record is None, width), np.float64)
