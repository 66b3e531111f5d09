"""Columns of equal blocks of distinct elements, free or next to a wall, under a ramped sinusoid.

The criterion of overturning is the envelope of the base acceleration when the first block passes its balance before it
falls.  The column rocks once a corner of the lowest block is off the floor, and two blocks have parted once the angles
of theirs differ by 5 % of alpha.

Source   Winkler, Meguro & Yamazaki (1995), "Block assemblies", Figs 17 to 23: blocks of h = 0.5 m, b/h = 0.3
Status   the engine: tests/dem; the criteria against a finely sampled history (tests)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dem
from excitation import RampedSinusoid
from rocking import G_STANDARD, Block
from studies.criteria.free_vibration import fit_dashpot
from studies.criteria.overturning import STIFFNESS
from studies.specimens import specimen

G = G_STANDARD
COLUMN_BLOCK = 3
"""Number in Table 1 of the blocks of the columns."""

PARTED = 0.05
"""Difference of two angles over alpha [1] from which blocks have parted."""

OFF_THE_FLOOR = 1e-4
"""Gap [m] from which a corner has left what it stood on."""

SAMPLE = 5e-3
"""Time between samples [s] from which partings are read."""


@cache
def fitted_dashpot(number: int = 1, stiffness: float = STIFFNESS) -> float:
    """Dashpot [N s/m] that gives Block `number` Housner's restitution in a free vibration, as the paper fitted one."""
    block = specimen(number)
    return fit_dashpot(block, block.housner_restitution, kn=stiffness, ks=stiffness).damping


@dataclass(frozen=True)
class Column:
    """Equal blocks on top of each other; wall_gap [m] of a wall at the left, NaN without one."""

    count: int
    wall_gap: float = math.nan

    @property
    def label(self) -> str:
        """What it is, in words."""
        number = {1: "one block", 2: "two blocks", 3: "three blocks"}.get(self.count, f"{self.count} blocks")
        if math.isnan(self.wall_gap):
            return f"{number}, free"
        return f"{number}, wall" + (f" at {1e3 * self.wall_gap:g} mm" if self.wall_gap else "")

    def assembly(self, block: Block) -> dem.Assembly:
        """The scene of distinct elements."""
        gap = None if math.isnan(self.wall_gap) else self.wall_gap
        return dem.column(self.count, block.b, block.h, block.d, block.density, wall_gap=gap)


@dataclass(frozen=True)
class ColumnSettings:
    """Everything that a criterion depends on besides column and frequency."""

    ramp: float = 3.0 * G  # envelope at the end [m/s^2]
    duration: float = 90.0  # of the ramp [s]: "about 90 s" in the paper
    friction: float = 0.7  # [1]; the paper says only that it exceeds b/h
    damping: float = math.nan  # dashpot of a corner [N s/m]; fitted on Block 1 if not given
    stiffness: float = STIFFNESS  # kn = ks [N/m], printed
    vertical: float = 0.0  # vertical base acceleration over the horizontal one [1]
    block: int = COLUMN_BLOCK

    @property
    def contact(self) -> dem.Contact:
        """One set of parameters for all contacts, as in the paper."""
        c = fitted_dashpot() if math.isnan(self.damping) else self.damping
        return dem.Contact(self.friction, damping=c, kn=self.stiffness, ks=self.stiffness)

    def motion(self, frequency: float) -> RampedSinusoid:
        """The base motion at a frequency [Hz]."""
        return RampedSinusoid(frequency, self.duration, self.ramp)


@dataclass(frozen=True)
class ColumnJob:
    """One run."""

    column: Column
    frequency: float
    settings: ColumnSettings


def history(
    job: ColumnJob, *, t_end: float | None = None, stop: str = "fall", sample: float = SAMPLE
) -> dem.AssemblyHistory:
    """The run: motion of all blocks until one falls (or as `stop` says), sampled each `sample` seconds.

    Raises:
        ValueError: as of `dem.simulate_assembly`.
    """
    settings = job.settings
    scene, contact, base = (
        job.column.assembly(specimen(settings.block)),
        settings.contact,
        settings.motion(job.frequency),
    )

    def motion(t: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        a_x, _ = base(t)
        return a_x, settings.vertical * a_x

    dt = 0.25 * dem.assembly_critical_step(scene, contact)
    every = max(1, round(sample / dt))
    return dem.simulate_assembly(
        scene, motion, t_end=t_end or settings.duration, contact=contact, dt=sample / every, save_every=every,
        criteria=dem.Criteria(stop=stop, gap=OFF_THE_FLOOR, rotation=1.0, margin=1e3),
    )  # fmt: skip


def parting(run: dem.AssemblyHistory, alpha: float, until: float) -> tuple[float, float]:
    """(time [s] at which two neighbours part, largest difference of two angles over alpha before `until` [s])."""
    if run.theta.shape[1] < 2:
        return math.nan, math.nan
    apart = np.abs(np.diff(run.theta, axis=1)).max(axis=1) / alpha
    before = run.time <= until
    parted = np.flatnonzero((apart > PARTED) & before)
    largest = float(apart[before].max()) if before.any() else math.nan
    return (float(run.time[parted[0]]) if parted.size else math.nan), largest


def criterion(job: ColumnJob) -> dict[str, Any]:
    """What a run gives, by name; NaN where it gives none, and then `note` says why."""
    unknown = dict.fromkeys(
        ("overturning_amplitude", "overturning_time", "onset_time", "parting_time", "largest_apart", "fallen"), math.nan
    )
    try:
        run = history(job)
    except ValueError as refusal:
        return unknown | {"note": f"declined: {refusal}"}
    if run.ending in (dem.Ending.UNSTABLE, dem.Ending.LEFT):
        return unknown | {"note": f"failed: {run.reason}"}
    base = job.settings.motion(job.frequency)
    lifts = [s.time for s in run.separations if "floor" in (s.first, s.second)]
    found = unknown | {"onset_time": min(lifts, default=math.nan)}
    fell = run.overturning_time
    until = fell if run.falls else run.end_time
    parted, apart = parting(run, specimen(job.settings.block).alpha, until)
    found |= {"parting_time": parted, "largest_apart": apart}
    if not run.falls:
        return found | {"note": f"standing at the end of the ramp, {job.settings.ramp:.4g} m/s^2"}
    found |= {"overturning_time": fell, "overturning_amplitude": float(base.envelope(fell))}
    return found | {"fallen": float(run.falls[0].body), "note": "overturned"}
