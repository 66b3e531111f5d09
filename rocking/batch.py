"""Many blocks or motions at once: how each run ended, and how far it tilted.

    from rocking import Block, Method1, solve_batch

A run of a batch is the run that `solve` would give, bit for bit with the solvers numba and taylor and to rounding with
exact and diffrax; only the summary is kept.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rocking.arguments import array_of, check_kinds
from rocking.effect import Effect
from rocking.hybrid import Mode, System
from rocking.motion import BaseMotion, Still, pitch_kernel
from rocking.solvers import load
from rocking.validation import positive, real

if TYPE_CHECKING:
    import xarray as xr

Item = TypeVar("Item")

OUTCOMES = ("at rest", "still moving", "overturned", "failed")
"""How a run can end, by the code in `BatchResult.outcome`."""


@dataclass(frozen=True, repr=False)
class BatchResult:
    """Summary of every run; all arrays of shape (run,)."""

    outcome: NDArray[np.int64]  # index into OUTCOMES
    side: NDArray[np.int64]  # +1 or -1 where the block fell to that side, else 0
    overturning_time: NDArray[np.float64]  # last outward passage of theta_c before the fall [s]; NaN if none
    peak_rotation: NDArray[np.float64]  # largest |theta| [rad]
    onset_time: NDArray[np.float64]  # when the block first left rest [s]; NaN if it never did
    impacts: NDArray[np.int64]  # number of impacts
    t_end: NDArray[np.float64]  # when the run ended [s]
    device: str = "cpu"  # where the runs were carried, as of `rocking.solvers.devices`

    @property
    def overturned(self) -> NDArray[np.bool_]:
        """Whether each block fell."""
        return self.outcome == OUTCOMES.index("overturned")

    def __len__(self) -> int:
        return len(self.outcome)

    def __repr__(self) -> str:
        counts = ", ".join(f"{np.sum(self.outcome == i)} {name}" for i, name in enumerate(OUTCOMES))
        return f"<BatchResult of {len(self)} runs: {counts}>"

    def to_xarray(self, coords: dict[str, Any] | None = None) -> xr.Dataset:
        """The summary over the dimension `run`, with units; `coords` are added to it."""
        import xarray as xr

        flags = {
            "flag_values": np.arange(len(OUTCOMES)),
            "flag_meanings": " ".join(o.replace(" ", "_") for o in OUTCOMES),
        }
        return xr.Dataset(
            {
                "outcome": ("run", self.outcome, {"long_name": "how the run ended", **flags}),
                "side": ("run", self.side, {"units": "1", "long_name": "side of the fall, 0 if none"}),
                "overturning_time": ("run", self.overturning_time, {"units": "s", "long_name": "time of overturning"}),
                "peak_rotation": ("run", self.peak_rotation, {"units": "rad", "long_name": "largest rotation"}),
                "onset_time": ("run", self.onset_time, {"units": "s", "long_name": "first time out of rest"}),
                "impacts": ("run", self.impacts, {"units": "1", "long_name": "number of impacts"}),
                "t_end": ("run", self.t_end, {"units": "s", "long_name": "end of the run"}),
            },
            coords=coords,
            attrs={"device": self.device},
        )


def _as_many(name: str, items: Item | Sequence[Item], count: int) -> Sequence[Item]:
    """`items` for each of `count` runs; a single one serves all.

    Raises:
        ValueError: there are neither one nor `count` of them.
    """
    if not isinstance(items, Sequence) or isinstance(items, str):
        return [items] * count
    if len(items) == 1:
        return [items[0]] * count
    if len(items) != count:
        raise ValueError(f"{name}: {len(items)} of them, want 1 or {count}, one for each run")
    return items


def _per_run(name: str, values: ArrayLike, count: int) -> NDArray[np.float64]:
    array = array_of(name, values)
    if array.shape not in ((), (1,), (count,)):
        raise ValueError(f"{name}: shape {array.shape}, want a number or shape ({count},), one for each run")
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{name}: want finite numbers")
    return np.broadcast_to(array, (count,))


def _count(*items: Any) -> int:
    """The number of runs that the arguments ask for: the longest of them."""
    many = [i for i in items if not isinstance(i, str)]
    return max(len(i) if isinstance(i, Sequence) else np.size(i) if isinstance(i, np.ndarray) else 1 for i in many)


def solve_batch(
    systems: System | Sequence[System],
    motions: BaseMotion | Sequence[BaseMotion] | None = None,
    *,
    t_end: float,
    t_start: float = 0.0,
    theta: ArrayLike = 0.0,
    omega: ArrayLike = 0.0,
    solver: str = "numba",
    rtol: float = 1e-9,
    atol: float = 1e-12,
    max_events: int = 1_000_000,
    effects: Sequence[Effect] = (),
    device: str | None = None,
) -> BatchResult:
    """Carry many blocks, each to its fall or to `t_end`, and keep the summaries.

    Args:
        systems: blocks under one method, one for each run; a single one serves all.
        motions: what the base does, one for each run, of one kind; a single one serves all; at rest if not given.
        t_end, t_start: times [s].
        theta, omega: rotation [rad] and angular velocity [rad/s] at the start, numbers or shape (run,).
        solver: one that has a batch of its own: numba (anything that compiles), taylor and exact (Method 1, the
            latter linear, over ramped sinusoids and records that are straight between samples; some hundred times
            faster), diffrax (whatever JAX traces; runs go in step, which pays on a GPU alone).
        rtol, atol, max_events: as of `solve`.
        effects: what all blocks lack, of `rocking.effects`; for blocks that differ in the parameters of theirs, give
            systems of `rocking.effects.compose`.
        device: "cpu", "gpu" or "jax-cpu" for the solvers exact and diffrax (`rocking.solvers.devices`); if not given,
            a GPU if JAX finds one, else the CPU.

    Raises:
        ValueError: an argument is out of range, the numbers of systems and motions do not fit, they are not of one
            kind, the solver has no batch or declines one of them, or the device is not there.
    """
    many = _count(systems, motions, array_of("theta", theta), array_of("omega", omega))
    if isinstance(systems, Sequence) and not systems:
        raise ValueError("systems: none given, want one or more")
    if not math.isfinite(real(t_start)):
        raise ValueError(f"t_start={t_start!r} s: want a finite number")
    if not (math.isfinite(real(t_end)) and t_end > t_start):
        raise ValueError(f"t_end={t_end!r} s: want a time after t_start={t_start!r} s")
    if not real(max_events) >= 1.0:
        raise ValueError(f"max_events={max_events!r}: want 1 or more")
    positive("rtol", rtol, "1")
    positive("atol", atol, "SI units of the state")
    all_systems = _as_many("systems", systems, many)
    all_motions = _as_many("motions", Still() if motions is None else motions, many)
    shapes = np.shape(theta), np.shape(omega)
    if len(shapes[0]) == len(shapes[1]) == 1 and shapes[0] != shapes[1] and (1,) not in shapes:
        raise ValueError(
            f"theta, omega: shapes {shapes[0]}, {shapes[1]}, want one shape, or a number that serves all runs"
        )
    tilts, speeds = _per_run("theta", theta, many), _per_run("omega", omega, many)
    if np.any(np.abs(tilts) >= 0.5 * math.pi):
        raise ValueError(f"theta={np.max(np.abs(tilts))!r} rad: want between -pi/2 and pi/2")
    if effects:
        all_systems, all_motions = _with_effects(all_systems, all_motions, effects, (float(t_start), float(t_end)))
    for system, motion in zip(all_systems, all_motions, strict=True):
        check_kinds(system, motion, "s")
        if not system.carries_pitch and pitch_kernel(motion) is not None:
            raise ValueError(f"motion={motion!r}: {system.name} does not carry a base that pitches")
    carrier: Any = load(solver)
    if not hasattr(carrier, "solve_batch"):
        raise ValueError(f"solver={solver!r}: it has no batch; want 'numba', 'taylor', 'exact' or 'diffrax'")
    if device is not None and not getattr(carrier, "batch_takes_device", False):
        raise ValueError(f"device={device!r}: solver {solver!r} knows the CPU alone; want 'exact' or 'diffrax' with it")
    where = {} if device is None else {"device": device}
    _no_refusal(carrier, solver, all_systems, all_motions)
    starts = [s.initial_state(float(a), float(w)) for s, a, w in zip(all_systems, tilts, speeds, strict=True)]
    table = carrier.solve_batch(
        all_systems, all_motions, starts, (float(t_start), float(t_end)),
        rtol=rtol, atol=atol, max_events=max_events, **where,
    )  # fmt: skip
    return _result(table, t_start)


def _with_effects(
    systems: Sequence[System], motions: Sequence[BaseMotion], effects: Sequence[Effect], span: tuple[float, float]
) -> tuple[list[System], list[BaseMotion]]:
    """Systems and motions with the effects; what is shared by many runs is made once."""
    from rocking.effects import base_with, compose

    composed = {id(s): compose(s, effects) for s in systems}
    altered = {(id(m), s.g): base_with(m, effects, span, s.g) for s, m in zip(systems, motions, strict=True)}
    return [composed[id(s)] for s in systems], [altered[id(m), s.g] for s, m in zip(systems, motions, strict=True)]


def _no_refusal(carrier: Any, solver: str, systems: Sequence[System], motions: Sequence[BaseMotion]) -> None:
    """ValueError with the sentence of the solver that declines a run; each pair of kinds is asked about once."""
    asked = set()
    for system, motion in zip(systems, motions, strict=True):
        pair = (type(system), getattr(system, "form", None), id(system.flow), id(motion))
        if pair not in asked:
            asked.add(pair)
            refusal = carrier.declines(system, motion)
            if refusal is not None:
                raise ValueError(f"solver={solver!r} declines: {refusal}")


def _result(table: dict[str, Any], t_start: float) -> BatchResult:
    fell, failed = table["fell"], table["failed"]
    resting = np.where(table["last_mode"] == Mode.REST, 0, 1)
    overturning = np.where(np.isnan(table["overturning_time"]), t_start, table["overturning_time"])
    return BatchResult(
        outcome=np.where(fell, 2, np.where(failed, 3, resting)).astype(np.int64),
        side=np.where(fell, np.sign(table["theta_end"]), 0.0).astype(np.int64),
        overturning_time=np.where(fell, overturning, math.nan),
        peak_rotation=table["peak_rotation"],
        onset_time=table["onset_time"],
        impacts=table["impacts"].astype(np.int64),
        t_end=table["t_end"],
        device=table.get("device", "cpu"),
    )
