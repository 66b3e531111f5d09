"""What a run gives back: sampled motion and energies, how it ended, and the time spent in each mode.

Source  six modes as in Winkler, Meguro & Yamazaki (1995), Method 2 (after Ishiyama)
Status  the energies close (tests)
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from dem.labelled import base_variables, outline_variables
from dem.scenes import Scene
from dem.shapes import FloatArray

if TYPE_CHECKING:
    import xarray as xr

OMEGA_STILL = 1e-3  # a body in the air that turns slower than this [rad/s] is in a jump of translation
SPEED_AT_REST = 1e-3  # a body on two corners with |v_x| + |v_z| + radius |omega| below this [m/s] is at rest


class Mode(enum.IntEnum):
    """The six modes, told apart by the corners that press on the floor (total normal force above 0).

    Two or more corners: REST, or SLIDE where one slides. One: ROTATION, or SLIDE_ROTATION where it slides. None:
    TRANSLATION_JUMP where |omega| < 1e-3 rad/s, else ROTATION_JUMP. Sliding means that the shear spring is clipped.
    """

    REST = 0
    SLIDE = 1
    ROTATION = 2
    SLIDE_ROTATION = 3
    TRANSLATION_JUMP = 4
    ROTATION_JUMP = 5


class Outcome(enum.Enum):
    """How a run ended; the value is a sentence."""

    OVERTURNED = "the block fell on its side"
    AT_REST = "the block stands at rest on its base"
    MOVING = "the block has not fallen and still moves"
    UNSTABLE = "the run was stopped: the motion is not finite or faster than any force here could make it"


@dataclass(frozen=True, eq=False, repr=False)
class Energies:
    """Energies at the sample times [J], each of shape (time,).

    kinetic: m v(t - dt/2) v(t + dt/2)/2, rotation included: the leap-frog's own, m (a dt)^2/8 below that of the
        mean velocity
    potential: m g z of the centroid above the floor
    elastic: sum over corners of F_n^2/2kn + F_s^2/2ks
    dashpot, friction: lost since the start
    onset: lost (or, negative, gained) by the force law where a corner lands or leaves inside a step; scatters about
        0 and is of second order in dt. In assemblies also what the spring of a corner holds that slips off the end of
        its edge, or passes on a smaller overlap there: a loss that softer contacts make larger, whatever dt
    base_work: done by the inertial forces -m a_x and -m a_z since the start
    """

    kinetic: FloatArray
    potential: FloatArray
    elastic: FloatArray
    dashpot: FloatArray
    friction: FloatArray
    onset: FloatArray
    base_work: FloatArray

    def __repr__(self) -> str:
        if not self.kinetic.size:
            return "<Energies: no samples>"
        return (
            f"<Energies: {self.kinetic.size} samples, kinetic up to {self.kinetic.max():.4g} J, lost "
            f"{self.dashpot[-1] + self.friction[-1]:.4g} J, balance within {np.ptp(self.balance):.2g} J>"
        )

    @property
    def balance(self) -> FloatArray:
        """Stored + lost - work of the base [J]: constant but for O(dt^2)."""
        stored = self.kinetic + self.potential + self.elastic
        return stored + self.dashpot + self.friction + self.onset - self.base_work


@dataclass(frozen=True, eq=False, repr=False)
class History:
    """Motion of the centroid relative to the base and what became of the block.

    time [s], x, z [m], theta [rad], omega [rad/s]: shape (time,); the last state is always among them
    base_ax, base_az: acceleration of the base at the samples [m/s^2], shape (time,)
    mode_clock: time spent in each `Mode` until the sample [s], shape (time, mode)
    outcome, side: how it ended; side +1 (fell to +x) or -1, 0 where it did not fall
    end_time: last time reached [s]
    overturning_time: last time at which |theta| passed its balance outwards before the fall [s]; 0 where the run
        began beyond it, NaN where the block did not fall
    mode_seconds: time in each `Mode` until the end [s], shape (6,); mode_seconds_to_overturning: the same until
        overturning_time, NaN where the block did not fall
    settings: every parameter of the run by name
    """

    time: FloatArray
    x: FloatArray
    z: FloatArray
    theta: FloatArray
    omega: FloatArray
    base_ax: FloatArray
    base_az: FloatArray
    energies: Energies
    mode_clock: FloatArray
    outcome: Outcome
    side: int
    end_time: float
    overturning_time: float
    mode_seconds: FloatArray
    mode_seconds_to_overturning: FloatArray
    scene: Scene
    settings: Mapping[str, float | str]

    def __repr__(self) -> str:
        fell = f", side {self.side:+d}, overturning at {self.overturning_time:.6g} s" if self.side else ""
        return (
            f"<History: {self.outcome.value} (t = {self.end_time:.6g} s{fell}; {self.time.size} samples, "
            f"mass {self.scene.mass:.4g} kg, dt {self.settings['dt']:.4g} s)>"
        )

    def to_xarray(self) -> xr.Dataset:
        """Dataset with dims `time`, `mode` and `corner`, SI `units` and `long_name`; outcome and settings as
        attributes."""
        import xarray as xr  # slow to import, and not needed for a run

        variables: dict[str, Any] = {
            name: ("time", getattr(self, name), {"units": unit, "long_name": text})
            for name, (unit, text) in _MOTION.items()
        }
        variables |= base_variables(self.base_ax, self.base_az) | outline_variables([self.scene.shape.corners])
        for field in fields(Energies):
            text = {"long_name": f"energy: {field.name.replace('_', ' ')}", "units": "J"}
            variables[f"energy_{field.name}"] = ("time", getattr(self.energies, field.name), text)
        variables["mode_clock"] = (
            ("time", "mode"),
            self.mode_clock,
            {"units": "s", "long_name": "time in mode so far"},
        )
        for name, until in (("mode_seconds", "the end"), ("mode_seconds_to_overturning", "overturning")):
            variables[name] = ("mode", getattr(self, name), {"units": "s", "long_name": f"time in mode until {until}"})
        coordinates = {
            "time": ("time", self.time, {"units": "s", "long_name": "time"}),
            "mode": ("mode", np.array([mode.name for mode in Mode]), {"long_name": "mode of motion"}),
        }
        outcome = {
            "outcome": self.outcome.name,
            "side": self.side,
            "end_time": self.end_time,
            "overturning_time": self.overturning_time,
            "mass": self.scene.mass,
            "inertia": self.scene.inertia,
            "floor": 1,
        }
        source = {"reference": "distinct element method of Winkler, Meguro & Yamazaki (1995)"}
        return xr.Dataset(variables, coordinates, attrs={**source, **outcome, **self.settings})


_MOTION = {
    "x": ("m", "centroid to the right of the middle of the base"),
    "z": ("m", "centroid above the floor"),
    "theta": ("rad", "rotation, clockwise"),
    "omega": ("rad s-1", "angular velocity, clockwise"),
}
