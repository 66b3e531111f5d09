"""When one block begins to rock on a table that shakes harder and harder, by each of the three methods.

Two accelerations of the base are read.  At lift-off: |a_x| when the block begins to turn (Methods 1 and 2, for which
eq. (1) is put in, not found; a block that slides has not lifted off) or when a corner of the distinct element first
loses the floor.  When motion follows: the largest |a_x| met until a corner is 0.05 mm off the floor, which no method
puts in.

Source   Winkler, Meguro & Yamazaki (1995), "Criteria of rocking for single blocks", Figs 14 and 15
Status   against closed integration of the first swing (tests)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import dem
from excitation import RampedSinusoid
from rocking import Method1, Method2, Mode, Trajectory, solve
from rocking.effect import Effect
from rocking.hybrid import INADMISSIBLE
from studies.criteria.columns import G, fitted_dashpot
from studies.criteria.overturning import STIFFNESS
from studies.specimens import specimen

OFF_THE_FLOOR = 5e-5
"""Height of a corner over the floor [m] that counts as motion."""

SAMPLE = 1e-3
"""Time between samples [s]."""

BEYOND_WEST = 2.5
"""Runs end when the envelope is so many times (b/h) g."""


@dataclass(frozen=True)
class OnsetSettings:
    """Everything that the start of rocking depends on besides block, frequency and method."""

    ramp: float = 1.0 * G  # envelope at the end [m/s^2]
    duration: float = 90.0  # of the ramp [s]
    imperfection: float = 0.0  # rms departure of the envelope [1]
    seed: int = 0  # of that departure
    friction: float = 0.7  # Method 2 and DEM [1]
    stiffness: float = STIFFNESS  # DEM: kn = ks [N/m]
    effects: tuple[Effect, ...] = ()  # Method 1
    form: Literal["linear", "nonlinear"] = "linear"  # Method 1 without effects; eqs (2) and (3) as printed are linear

    def motion(self, frequency: float) -> RampedSinusoid:
        """The base motion at a frequency [Hz]."""
        return RampedSinusoid(frequency, self.duration, self.ramp, imperfection=self.imperfection, seed=self.seed)


@dataclass(frozen=True)
class OnsetJob:
    """One run."""

    method: str
    block: int
    frequency: float
    settings: OnsetSettings

    @property
    def t_end(self) -> float:
        """When the envelope is well beyond (b/h) g [s]."""
        block, settings = specimen(self.block), self.settings
        return min(settings.duration, BEYOND_WEST * block.b / block.h * G / settings.ramp * settings.duration)


def rocking_start(run: Trajectory) -> float:
    """Time [s] at which a block that stood or slid first turns or leaves the floor; NaN if it never does.

    `Trajectory.onset_time` is when it leaves rest, which is by sliding where friction is below b/h.
    """
    events, standing = run.events, (Mode.REST, Mode.SLIDE)
    begins = np.isin(events.mode_before, standing) & ~np.isin(events.mode_after, (*standing, INADMISSIBLE))
    return float(events.t[begins][0]) if begins.any() else math.nan


def _analytic(job: OnsetJob) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """(times [s], height of the higher corner [m], time of lift-off [s]) by Method 1 or 2."""
    block, settings = specimen(job.block), job.settings
    t = np.arange(0.0, job.t_end, SAMPLE)
    form: Any = "nonlinear" if settings.effects else settings.form
    system: Any = Method1(block, form=form) if job.method == "method1" else Method2(block, friction=settings.friction)
    run = solve(system, settings.motion(job.frequency), t_end=job.t_end, save_at=t, effects=settings.effects)
    return run.t, block.b * np.sin(np.abs(run.theta)), rocking_start(run)


def _distinct_element(job: OnsetJob) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """The same by distinct elements; a corner that is off the floor by any gap has lifted."""
    block, settings = specimen(job.block), job.settings
    contact = dem.Contact(settings.friction, damping=fitted_dashpot(), kn=settings.stiffness, ks=settings.stiffness)
    scene = dem.single(block.b, block.h, block.d, block.density)
    every = max(1, round(SAMPLE / (0.25 * dem.assembly_critical_step(scene, contact))))
    run = dem.simulate_assembly(
        scene, settings.motion(job.frequency), t_end=job.t_end, contact=contact, dt=SAMPLE / every, save_every=every,
    )  # fmt: skip
    theta = np.abs(run.theta[:, 0])
    height = run.z[:, 0] - 0.5 * block.h * np.cos(theta) + 0.5 * block.b * np.sin(theta)
    lifted = np.flatnonzero(height > 0.0)
    return run.time, height, float(run.time[lifted[0]]) if lifted.size else math.nan


def onset(job: OnsetJob) -> dict[str, Any]:
    """Accelerations [m/s^2] and times [s] of the start of rocking, by name; NaN where the block does not rock."""
    base = job.settings.motion(job.frequency)
    try:
        t, height, lift = (_distinct_element if job.method == "dem" else _analytic)(job)
    except ValueError as refusal:
        missing = dict.fromkeys(("lift_acceleration", "lift_time", "onset_acceleration", "onset_time"), math.nan)
        return missing | {"note": f"declined: {refusal}"}
    lifted = math.nan
    if not math.isnan(lift):
        # Distinct elements do not lift at one instant of a sample: the largest |a_x| within it.
        instants = np.linspace(lift - SAMPLE, lift, 5) if job.method == "dem" else np.array([lift])
        lifted = float(np.abs(base(instants)[0]).max())
    moved = np.flatnonzero(height > OFF_THE_FLOOR)
    when = float(t[moved[0]]) if moved.size else math.nan
    largest = float(np.abs(base(t[t <= when])[0]).max()) if moved.size else math.nan
    return {
        "lift_acceleration": lifted,
        "lift_time": lift,
        "onset_acceleration": largest,
        "onset_time": when,
        "note": "rocks"
        if moved.size
        else f"no corner is {1e3 * OFF_THE_FLOOR:g} mm off the floor until {job.t_end:.3g} s",
    }
