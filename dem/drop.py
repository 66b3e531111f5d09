"""Numerical stability test of the paper: an undamped block dropped on the base, compared for different time steps.

Source  Winkler, Meguro & Yamazaki (1995), "Numerical stability", Figs 10 to 12 and eq. (8)
Status  the histories tend to the closed form below as the step shrinks (tests)

The paper prints neither the height of the drop nor the number of samples in the sum of eq. (8). Both are arguments
here, and the root mean square difference, which does not hang on the number of samples, goes with the sum. Steps that
divide the sampling interval are sampled without interpolation.

Closed form. Both lower corners land together, so the block is one mass on a spring of stiffness k = 2 kn while it
touches: free flight from height H for t_f = sqrt(2 H/g), then half a wave of angular frequency om = sqrt(k/m) about the
sag m g/k, for t_c = (2/om) (pi - atan(v om/g)), v = g t_f; then up again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dem import checks
from dem.assembly import Assembly, Body
from dem.assembly_history import AssemblyHistory
from dem.assembly_settings import Criteria
from dem.history import History
from dem.materials import Contact
from dem.scenes import Scene
from dem.shapes import FloatArray
from dem.simulate import simulate
from dem.simulate_assembly import simulate_assembly

ONSETS = ("incremental", "overlap", "located")


@dataclass(frozen=True)
class Drop:
    """A drop: height of the base of the block above the floor [m], stiffness of each corner [N/m], gravity [m/s^2]."""

    scene: Scene
    height: float
    kn: float = 1.98e7
    g: float = 9.80665

    def __post_init__(self) -> None:
        for name, value, unit in (("height", self.height, "m"), ("kn", self.kn, "N/m"), ("g", self.g, "m/s^2")):
            checks.positive(name, value, unit)

    @property
    def touching_time(self) -> float:
        """Of one rebound [s]."""
        v = math.sqrt(2.0 * self.g * self.height)
        om = math.sqrt(2.0 * self.kn / self.scene.mass)
        return 2.0 / om * (math.pi - math.atan(v * om / self.g))

    @property
    def period(self) -> float:
        """From one highest point to the next [s]."""
        return 2.0 * math.sqrt(2.0 * self.height / self.g) + self.touching_time

    def exact(self, time: FloatArray) -> FloatArray:
        """Height of the base of the block at these times [s], in closed form [m]."""
        om = math.sqrt(2.0 * self.kn / self.scene.mass)
        sag, v = self.g / om**2, math.sqrt(2.0 * self.g * self.height)
        from_lowest = np.mod(time, self.period) - 0.5 * self.period
        touching = np.abs(from_lowest) < 0.5 * self.touching_time
        deepest = math.hypot(sag, v / om)
        from_highest = 0.5 * self.period - np.abs(from_lowest)
        return np.where(
            touching, -sag - deepest * np.cos(om * from_lowest), self.height - 0.5 * self.g * from_highest**2
        )

    def run(self, dt: float, onset: str, interval: float, samples: int) -> History | AssemblyHistory:
        """The drop by distinct elements, sampled at 0, interval, ... [s].

        dt: step [s], a whole part of the interval; onset: 'incremental' (the paper's), 'overlap' or 'located'
        samples: how many, 2 or more
        Raises ValueError for an unknown onset, fewer samples, a step that is no whole part of the interval, and one at
        or above the critical step.
        """
        checks.positive("dt", dt, "s")
        checks.positive("interval", interval, "s")
        every = round(interval / dt)
        if every < 1 or abs(every * dt / interval - 1.0) > 1e-9:
            raise ValueError(f"dt={dt} s: want a whole part of the sampling interval, {interval} s")
        if onset not in ONSETS:
            raise ValueError(f"onset={onset!r}: want one of {', '.join(ONSETS)}")
        checks.whole("samples", samples, 2)
        t_end = interval * (samples - 1)
        if onset != "located":
            return simulate(
                self.scene, t_end=t_end, mu=1.0, damping=0.0, dt=dt, kn=self.kn, ks=self.kn, onset=onset,
                gap0=self.height, g=self.g, save_every=every,
            )  # fmt: skip
        body = Body(self.scene.shape, 0.0, self.height - self._foot, self.scene.depth, self.scene.density)
        return simulate_assembly(
            Assembly((body,), standing=False), t_end=t_end, dt=dt, onset=onset, g=self.g, save_every=every,
            contact=Contact(1.0, damping=0.0, kn=self.kn, ks=self.kn), criteria=Criteria(stop="never"),
        )  # fmt: skip

    def history(self, dt: float, onset: str, interval: float, samples: int) -> FloatArray:
        """Height of the base of the block at the times 0, interval, ... [m]; arguments and errors as of `run`."""
        z = self.run(dt, onset, interval, samples).z
        return (z[:samples, 0] if z.ndim == 2 else z[:samples]) + self._foot

    @property
    def _foot(self) -> float:
        """Height of the base above the centroid [m], negative."""
        return float(self.scene.shape.corners[:, 1].min())


def squared_difference(pivot: FloatArray, other: FloatArray) -> float:
    """Sum over the samples of the squared differences of the heights [m^2], eq. (8).

    Raises ValueError unless both have the same number of samples.
    """
    if pivot.shape != other.shape:
        raise ValueError(f"samples: {pivot.shape} and {other.shape}: want as many of both")
    return float(((pivot - other) ** 2).sum())


def stiffness_from_wave_speed(mass: float, speed: float, spacing: float) -> float:
    """Spring of two contacting elements [N/m], k = m V^2/dX^2, eq. (9).

    mass: of the element [kg]; speed: of P or S waves in the material [m/s]; spacing: of the elements' centres [m]
    Raises ValueError unless all are positive and finite.
    """
    for name, value, unit in (("mass", mass, "kg"), ("speed", speed, "m/s"), ("spacing", spacing, "m")):
        checks.positive(name, value, unit)
    per_spacing = speed / spacing
    checks.positive("speed/spacing", per_spacing * per_spacing, "1/s^2, squared")
    return mass * per_spacing * per_spacing


def wave_speed_from_stiffness(mass: float, stiffness: float, spacing: float) -> float:
    """The speed [m/s] from which eq. (9) gives this stiffness [N/m]; mass [kg], spacing of centres [m].

    Raises ValueError unless all are positive and finite.
    """
    for name, value, unit in (("mass", mass, "kg"), ("stiffness", stiffness, "N/m"), ("spacing", spacing, "m")):
        checks.positive(name, value, unit)
    return spacing * math.sqrt(stiffness / mass)


def largest_step_as_good(steps: Sequence[float], differences: Sequence[float], bound: float) -> float:
    """Largest step [s] up to which no difference [m^2] exceeds the bound [m^2]; nan if the first one does."""
    best = math.nan
    for step, difference in sorted(zip(steps, differences, strict=True)):
        if not difference <= bound:
            break
        best = step
    return best
