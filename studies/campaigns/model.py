"""A measured campaign in memory: the block as declared, the channels, and the tests with their records.

SI units, angles in radians.  Rotation is relative to the floor and positive when the block leans toward +x; a positive
base acceleration makes it lean toward -x (equations (2) and (3) of Winkler, Meguro & Yamazaki, 1995).  The block frame
has its origin at the middle of the base, x to the right and z up along the block.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rocking import G_STANDARD

Array = NDArray[np.float64]
Kind = Literal["rotation", "base_acceleration_x", "base_acceleration_z", "block_acceleration"]

KINDS: tuple[Kind, ...] = ("rotation", "base_acceleration_x", "base_acceleration_z", "block_acceleration")
RESPONSES: tuple[Kind, ...] = ("rotation", "block_acceleration")
"""Kinds of channel that say what the block did."""

UNITS = {
    "rotation": "rad",
    "base_acceleration_x": "m/s^2",
    "base_acceleration_z": "m/s^2",
    "block_acceleration": "m/s^2",
}


@dataclass(frozen=True)
class DeclaredBlock:
    """The block as a drawing or a ruler and scales say it is.

    `breadth`, `height`, `depth` [m] and `mass` [kg] are always there; `centre_of_mass_height` [m] over the base and
    `inertia` [kg m^2] about the centre of mass where it is not a uniform rectangle, else None.
    """

    breadth: float
    height: float
    depth: float
    mass: float
    centre_of_mass_height: float | None = None
    inertia: float | None = None

    @property
    def density(self) -> float:
        """Mass over the volume of the enclosing box [kg/m^3]."""
        return self.mass / (self.breadth * self.height * self.depth)

    @property
    def centre_height(self) -> float:
        """Height of the centre of mass [m]: declared, or half of the block's."""
        return 0.5 * self.height if self.centre_of_mass_height is None else self.centre_of_mass_height

    @property
    def alpha(self) -> float:
        """Tilt of unstable balance on a level floor [rad]."""
        return math.atan2(0.5 * self.breadth, self.centre_height)

    @property
    def R(self) -> float:
        """Distance from a bottom corner to the centre of mass [m]."""
        return math.hypot(0.5 * self.breadth, self.centre_height)

    @property
    def I_c(self) -> float:
        """Moment of inertia about the centre of mass [kg m^2]: declared, or that of a uniform rectangle."""
        return self.mass * (self.breadth**2 + self.height**2) / 12.0 if self.inertia is None else self.inertia

    @property
    def I_O(self) -> float:
        """Moment of inertia about a bottom corner [kg m^2]."""
        return self.I_c + self.mass * self.R**2

    @property
    def housner(self) -> float:
        """Housner's restitution [1] for this centre of mass and inertia: momentum about the new corner is kept.

        It may be below zero (Housner 1963: of a uniform rectangle, 1 - 1.5 sin^2 alpha).
        """
        return (self.I_c + self.mass * (self.centre_height**2 - 0.25 * self.breadth**2)) / self.I_O

    def p(self, g: float = G_STANDARD) -> float:
        """Frequency parameter [rad/s], sqrt(m g R / I_O)."""
        return math.sqrt(self.mass * g * self.R / self.I_O)

    @property
    def onset_acceleration(self) -> float:
        """Horizontal base acceleration [m/s^2] at which rocking starts: West's formula, g tan(alpha)."""
        return G_STANDARD * math.tan(self.alpha)


@dataclass(frozen=True)
class Conditions:
    """What the laboratory declares of the contact; None where it does not."""

    friction: float | None = None  # static coefficient block/base [1]
    restitution: float | None = None  # angular velocity after over before an impact, eq. (4) [1]


@dataclass(frozen=True)
class Channel:
    """A column of the records.

    `noise` is one standard deviation in the channel's unit (`unit`), None if not declared.  An accelerometer on the
    block (`block_acceleration`) has a `position` [m] and a `direction` in the block frame, as declared; it reads
    (acceleration - g) . direction with g pointing down.
    """

    name: str
    kind: Kind
    noise: float | None = None
    position: tuple[float, float] | None = None
    direction: tuple[float, float] | None = None

    @property
    def unit(self) -> str:
        """Unit of the samples."""
        return UNITS[self.kind]

    @property
    def is_response(self) -> bool:
        """Whether it says what the block did, rather than the base."""
        return self.kind in RESPONSES

    @property
    def axis(self) -> tuple[float, float]:
        """The direction with unit length; ValueError for a channel that has none."""
        if self.direction is None:
            raise ValueError(f"channel {self.name!r}: is of kind {self.kind}, want block_acceleration for an axis")
        length = math.hypot(*self.direction)
        return self.direction[0] / length, self.direction[1] / length


@dataclass(frozen=True, eq=False, repr=False)
class Test:
    """One test: its record and what was noted of it.

    `time` [s], shape (time,), equally spaced; `data` maps the name of each of `channels` to its samples, shape
    (time,), NaN where a sample is missing.  `initial_rotation` [rad] is what was aimed at in a free test.
    """

    __test__ = False  # not a test of this software: pytest shall not collect it

    id: str
    kind: Literal["free", "forced"]
    time: Array
    channels: tuple[Channel, ...] = ()
    data: dict[str, Array] = field(default_factory=dict)
    initial_rotation: float | None = None
    motion: str | None = None
    overturned: bool | None = None
    source: str = ""  # the file, as campaign.toml names it

    def __repr__(self) -> str:
        names = ", ".join(self.data)
        return f"Test({self.id!r}, {self.kind}, {self.time.size} samples at {self.time_step:g} s, [{names}])"

    def __eq__(self, other: object) -> bool:
        """The same test and record; not where the record was read from."""
        if not isinstance(other, Test):
            return NotImplemented
        mine, its = (
            (t.id, t.kind, t.channels, t.initial_rotation, t.motion, t.overturned, tuple(t.data)) for t in (self, other)
        )
        return (
            mine == its
            and np.array_equal(self.time, other.time)
            and all(np.array_equal(v, other.data[k], equal_nan=True) for k, v in self.data.items())
        )

    def __hash__(self) -> int:
        return hash((self.id, self.kind, self.time.size))

    @cached_property
    def time_step(self) -> float:
        """Time between samples [s]."""
        return float(self.time[-1] - self.time[0]) / (self.time.size - 1)

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return float(self.time[-1] - self.time[0])

    def channel(self, kind: Kind) -> Channel | None:
        """The first channel of a kind in this test's record, None if there is none."""
        return next((c for c in self.channels if c.kind == kind), None)

    def _of(self, kind: Kind) -> Array | None:
        found = self.channel(kind)
        return None if found is None else self.data[found.name]

    @property
    def rotation(self) -> Array | None:
        """Rotation [rad], shape (time,), NaN where missing; None if it was not measured."""
        return self._of("rotation")

    @property
    def base_x(self) -> Array | None:
        """Horizontal base acceleration [m/s^2], shape (time,); None if it was not measured."""
        return self._of("base_acceleration_x")

    @property
    def base_z(self) -> Array | None:
        """Vertical base acceleration [m/s^2], shape (time,); None if nobody measured it (it need not be zero)."""
        return self._of("base_acceleration_z")

    @cached_property
    def has_response(self) -> bool:
        """Whether some sample says what the block did."""
        return any(c.is_response and bool(np.isfinite(self.data[c.name]).any()) for c in self.channels)

    @property
    def is_to_predict(self) -> bool:
        """Whether it has neither response nor outcome."""
        return not self.has_response and self.overturned is None


@dataclass(frozen=True, repr=False)
class Campaign:
    """A measured campaign; `warnings` are sentences on what is odd and yet usable."""

    title: str
    block: DeclaredBlock
    conditions: Conditions
    channels: tuple[Channel, ...]
    tests: tuple[Test, ...]
    path: Path = field(default=Path(), compare=False)
    warnings: tuple[str, ...] = field(default=(), compare=False)

    def __repr__(self) -> str:
        return f"Campaign({self.title!r}, {len(self.tests)} tests, {len(self.channels)} channels)"

    def test(self, id: str) -> Test:
        """The test of that id; KeyError if there is none."""
        found = next((t for t in self.tests if t.id == id), None)
        if found is None:
            raise KeyError(f"test {id!r}: want one of {', '.join(t.id for t in self.tests)}")
        return found

    @property
    def measured(self) -> tuple[Test, ...]:
        """Tests with a response, in the order in which they were done."""
        return tuple(t for t in self.tests if t.has_response)

    @property
    def to_predict(self) -> tuple[Test, ...]:
        """Tests with neither response nor outcome."""
        return tuple(t for t in self.tests if t.is_to_predict)

    @property
    def holds_outcomes_alone(self) -> bool:
        """Whether no response was recorded and some outcome was noted."""
        return not self.measured and any(t.overturned is not None for t in self.tests)
