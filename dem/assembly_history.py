"""What a run of an assembly gives back: sampled motion of the bodies, energies, falls, openings, and how it ended.

Source  criteria after Winkler, Meguro & Yamazaki (1995): the moment of overturning; separation of the blocks of a
        column
Status  the energies close (tests)
"""

from __future__ import annotations

import enum
import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from dem.assembly import Assembly
from dem.history import Energies
from dem.labelled import base_variables, outline_variables
from dem.shapes import FloatArray

if TYPE_CHECKING:
    import xarray as xr


class Ending(enum.Enum):
    """How a run of an assembly ended; the value is a sentence."""

    FELL = "the run was stopped since bodies had fallen"
    REACHED_END = "the run reached its end"
    UNSTABLE = "the run was stopped: a body's motion is not finite or faster than any force here could make it"
    LEFT = "the run was stopped: a body left the scene"
    INTERRUPTED = "the run was interrupted"


@dataclass(frozen=True)
class Fall:
    """A body that fell: its number and name; overturning_time: when it last passed its tilt of balance outwards before
    it fell [s], or, where it slid off or has no balance of its own, when it fell; time: when the fall was found [s]."""

    body: int
    name: str
    overturning_time: float
    time: float

    def __repr__(self) -> str:
        return f"<Fall of {self.name!r} (body {self.body}): overturned at {self.overturning_time:.6g} s>"


@dataclass(frozen=True)
class Separation:
    """An interface of the scene as it stood: names of the two things; time: when it was first seen open [s], nan if
    never."""

    first: str
    second: str
    time: float

    def __repr__(self) -> str:
        when = f"open at {self.time:.6g} s" if self.time == self.time else "never open"
        return f"<Separation of {self.first!r} and {self.second!r}: {when}>"


@dataclass(frozen=True, eq=False, repr=False)
class AssemblyHistory:
    """Motion of the centroids relative to the table, and what became of the bodies.

    time [s], shape (time,); x, z [m], theta [rad], vx, vz [m/s], omega [rad/s]: shape (time, body)
    base_ax, base_az [m/s^2], base_pitch [rad]: motion of the table, shape (time,)
    bodies: numbers of the bodies kept, names: theirs
    energies: of all bodies, see `dem.Energies`
    ending, reason: how it ended, and a sentence that names the body, the time and the value
    end_time: time of the last sample [s]
    falls: in order of overturning_time; separations: every interface at which two things touched at the start
    settings: every parameter of the run by name
    """

    time: FloatArray
    x: FloatArray
    z: FloatArray
    theta: FloatArray
    vx: FloatArray
    vz: FloatArray
    omega: FloatArray
    base_ax: FloatArray
    base_az: FloatArray
    base_pitch: FloatArray
    bodies: tuple[int, ...]
    names: tuple[str, ...]
    energies: Energies
    ending: Ending
    reason: str
    end_time: float
    falls: tuple[Fall, ...]
    separations: tuple[Separation, ...]
    assembly: Assembly
    settings: Mapping[str, float | str]

    @property
    def overturning_time(self) -> float:
        """Of the first body that overturned [s]; nan if none did."""
        return self.falls[0].overturning_time if self.falls else math.nan

    @property
    def overturned(self) -> str:
        """Name of the first body that overturned; empty if none did."""
        return self.falls[0].name if self.falls else ""

    def __repr__(self) -> str:
        return (
            f"<AssemblyHistory: {self.reason} ({len(self.assembly.bodies)} bodies, {self.time.size} samples of "
            f"{len(self.bodies)}, dt {self.settings['dt']:.4g} s)>"
        )

    def to_xarray(self) -> xr.Dataset:
        """Dataset with dims `time`, `body`, `interface` and `corner`, SI `units` and `long_name`; ending and settings
        as attributes."""
        import xarray as xr  # slow to import, and not needed for a run

        variables: dict[str, Any] = {
            name: (("time", "body"), getattr(self, name), {"units": unit, "long_name": text})
            for name, (unit, text) in _MOTION.items()
        }
        variables |= base_variables(self.base_ax, self.base_az, self.base_pitch)
        variables |= outline_variables(
            [self.assembly.bodies[number].shape.corners for number in self.bodies],
            [wall.vertices for wall in self.assembly.walls],
        )
        for entry in fields(Energies):
            text = {"long_name": f"energy: {entry.name.replace('_', ' ')}", "units": "J"}
            variables[f"energy_{entry.name}"] = ("time", getattr(self.energies, entry.name), text)
        fell = {fall.body: fall.overturning_time for fall in self.falls}
        variables["overturning_time"] = (
            "body",
            np.array([fell.get(number, math.nan) for number in self.bodies]),
            {"units": "s", "long_name": "time of overturning"},
        )
        variables["separation_time"] = (
            "interface",
            np.array([separation.time for separation in self.separations]),
            {"units": "s", "long_name": "time at which the interface first opened"},
        )
        pairs = [f"{separation.first} on {separation.second}" for separation in self.separations]
        coordinates = {
            "time": ("time", self.time, {"units": "s", "long_name": "time"}),
            "body": ("body", np.array(self.names), {"long_name": "name of the body"}),
            "interface": ("interface", np.array(pairs, dtype=np.str_), {"long_name": "names of the two that touch"}),
        }
        attributes = {
            "reference": "distinct element method of Winkler, Meguro & Yamazaki (1995)",
            "title": self.assembly.title,
            "ending": self.ending.name,
            "reason": self.reason,
            "end_time": self.end_time,
            "overturned": self.overturned,
            "floor": int(self.assembly.floor),
        }
        return xr.Dataset(variables, coordinates, attrs=attributes | dict(self.settings))


_MOTION = {
    "x": ("m", "centroid to the right of the origin, in the frame of the table"),
    "z": ("m", "centroid above the floor, in the frame of the table"),
    "theta": ("rad", "rotation since the start, relative to the table, clockwise"),
    "vx": ("m s-1", "velocity to the right, relative to the table"),
    "vz": ("m s-1", "velocity upwards, relative to the table"),
    "omega": ("rad s-1", "angular velocity, relative to the table, clockwise"),
}
