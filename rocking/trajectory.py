"""What a solver returns: states at the times asked for, every event, and how the run ended.

Source   Winkler, Meguro & Yamazaki (1995), "Criteria of overturning for single blocks", for what is read off a run.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rocking.hybrid import Mode

if TYPE_CHECKING:
    import xarray as xr

BALANCE = -1
"""Code of the event "passes the tilt of unstable balance outward", which changes no mode."""

UNITS = {
    "x": "m",
    "z": "m",
    "theta": "rad",
    "u": "m s-1",
    "v": "m s-1",
    "omega": "rad s-1",
    "foot_right": "m",
    "foot_left": "m",
    "impacts": "1",
    "pause": "s",
    "use": "(rad s-1)^worn_exponent",
}
"""Units of the states that systems share by name; a system says in `state_labels` what it means otherwise."""

LONG_NAMES = {
    "x": "position of the carrying corner relative to the base",
    "z": "height of the carrying corner over the floor",
    "theta": "rotation, positive when leaning to +x",
    "u": "horizontal velocity of the carrying corner relative to the base",
    "v": "vertical velocity of the carrying corner relative to the base",
    "omega": "angular velocity",
    "foot_right": "where the right foot touched the floor",
    "foot_left": "where the left foot touched the floor",
    "impacts": "impacts that the block remembers",
    "pause": "time since the last of them",
    "use": "use of the block, of which it is worn",
}


class Outcome(Enum):
    """How a run ended."""

    AT_REST = "at rest"
    MOVING = "still moving"
    OVERTURNED = "overturned"
    FAILED = "failed"


@dataclass(frozen=True, repr=False)
class Events:
    """Located events, one entry each, in the order of time."""

    t: NDArray[np.float64]  # [s], shape (event,)
    guard: NDArray[np.int64]  # index into the system's guard_names, or BALANCE
    mode_before: NDArray[np.int64]
    mode_after: NDArray[np.int64]
    s_after: NDArray[np.float64]  # carrying corner
    y_before: NDArray[np.float64]  # shape (event, state)
    y_after: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        return f"Events({len(self)} events)"


@dataclass(frozen=True, repr=False)
class Trajectory:
    """The motion of one block.

    `t` [s], shape (time,), are the times asked for up to the end of the run; `y`, shape (time, state), the states
    there, named by `system.state_names`; `mode` and `s`, shape (time,), the mode and the carrying corner.
    `peak_rotation` [rad] is the largest |theta| of the whole run, between the samples too.  `effects` are those that
    `solve` was given; `system` and `motion` have them in already.
    """

    system: Any
    motion: Any
    solver: str
    t: NDArray[np.float64]
    y: NDArray[np.float64]
    mode: NDArray[np.int64]
    s: NDArray[np.float64]
    events: Events
    t_start: float
    t_end: float
    first_mode: int
    outcome: Outcome
    reason: str = ""
    statistics: dict[str, int] = field(default_factory=dict)
    peak_rotation: float = math.nan
    effects: tuple[Any, ...] = ()

    def __repr__(self) -> str:
        note = f", {self.reason}" if self.reason else ""
        return (
            f"<Trajectory {self.system.name} by {self.solver}: {self.t_start:g} to {self.t_end:g} s, "
            f"{len(self.impact_times)} impacts, {self.outcome.value}{note}>"
        )

    def _repr_html_(self) -> str:
        """The rotation drawn, for notebooks."""
        from rocking.picture import html_of

        if not self.t.size:
            return ""
        return html_of(self.t, self.theta, f"rotation, up to {self.peak_rotation:.4g} rad; {repr(self)[1:-1]}")

    @property
    def _names(self) -> tuple[str, ...]:
        return tuple(self.system.state_names)

    def _state(self, name: str) -> NDArray[np.float64]:
        return np.asarray(self.y[:, self._names.index(name)])

    @property
    def theta(self) -> NDArray[np.float64]:
        """Rotation [rad], shape (time,)."""
        return self._state("theta")

    @property
    def omega(self) -> NDArray[np.float64]:
        """Angular velocity [rad/s], shape (time,)."""
        return self._state("omega")

    def times_of(self, *names: str) -> NDArray[np.float64]:
        """Times [s] of the events of the guards with these names."""
        wanted = [self.system.guard_names.index(name) for name in names]
        return np.asarray(self.events.t[np.isin(self.events.guard, wanted)])

    @property
    def impact_times(self) -> NDArray[np.float64]:
        """Times [s] at which a corner strikes the floor, shape (impact,)."""
        names = [n for n in ("impact", "landing", "contact") if n in self.system.guard_names]
        return self.times_of(*names)

    @property
    def onset_time(self) -> float:
        """Time [s] at which the block first leaves rest; NaN if it never does."""
        left = (self.events.mode_before == Mode.REST) & (self.events.mode_after != Mode.REST)
        return float(self.events.t[left][0]) if left.any() else math.nan

    @property
    def overturned(self) -> bool:
        """Whether the block fell."""
        return self.outcome is Outcome.OVERTURNED

    @property
    def side(self) -> int:
        """+1 or -1: the side to which the block fell; 0 if it did not."""
        if not self.overturned:
            return 0
        theta = self.events.y_before[-1, self.system.state_names.index("theta")]
        return 1 if theta > 0.0 else -1

    @property
    def overturning_time(self) -> float:
        """Last time [s] at which |theta| passes theta_c outward before the fall; NaN if the block did not fall."""
        passed = self.events.t[self.events.guard == BALANCE]
        if not self.overturned:
            return math.nan
        return float(passed[-1]) if len(passed) else self.t_start

    def mode_durations(self, until: float | None = None) -> NDArray[np.float64]:
        """Time [s] spent in each mode up to `until` (the end if not given), shape (6,), in the order of Mode."""
        end = self.t_end if until is None else min(until, self.t_end)
        edges = np.concatenate([[self.t_start], self.events.t, [self.t_end]]).clip(max=end)
        modes = np.concatenate([[self.first_mode], self.events.mode_after])
        spent = np.zeros(len(Mode))
        known = modes >= 0
        np.add.at(spent, modes[known], np.diff(edges)[known])
        return spent

    def to_xarray(self) -> xr.Dataset:
        """States over `time` and events over `event`, with units."""
        import xarray as xr

        own = getattr(self.system, "state_labels", {})
        labels = {name: own.get(name) or (UNITS.get(name, "1"), LONG_NAMES.get(name, name)) for name in self._names}
        states = {
            name: ("time", self.y[:, i], dict(zip(("units", "long_name"), labels[name], strict=True)))
            for i, name in enumerate(self._names)
        }
        modes = {"flag_values": np.arange(len(Mode)), "flag_meanings": " ".join(m.name.lower() for m in Mode)}
        guards = ["balance", *self.system.guard_names]
        return xr.Dataset(
            {
                **states,
                "mode": ("time", self.mode, {"long_name": "mode of motion", **modes}),
                "s": ("time", self.s, {"units": "1", "long_name": "carrying corner, +1 on the +x side"}),
                "event": ("event_time", [guards[k + 1] for k in self.events.guard], {"long_name": "what happened"}),
                "mode_after": ("event_time", self.events.mode_after, {"long_name": "mode after the event", **modes}),
            },
            coords={
                "time": ("time", self.t, {"units": "s", "long_name": "time"}),
                "event_time": ("event_time", self.events.t, {"units": "s", "long_name": "time of the event"}),
            },
            attrs={
                "system": repr(self.system),
                "motion": repr(self.motion),
                "solver": self.solver,
                "outcome": self.outcome.value,
                "reason": self.reason,
                "overturning_time": self.overturning_time,
                "peak_rotation": self.peak_rotation,
            },
        )
