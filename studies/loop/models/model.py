"""A model of the tested block: the declared block, its restitution and the effects that it has.

Status   what `baseline.toml` and `model.toml` hold; any solver that serves the effects can run it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rocking import G_STANDARD, Block, Method1
from rocking.effect import AT_THE_START, Effect, Seen
from rocking.effects import base_with, compose, load, read_at, recorded_rotation, rotation_reading
from rocking.hybrid import System
from rocking.motion import BaseMotion
from studies.campaigns import Channel, DeclaredBlock

RESTITUTION = "restitution"
DRIFT, FADING = "restitution_drift", "restitution_drift_fading"
"""Full names of the change of restitution from the first test to the next, and of how fast it fades after that."""

GRAVITY = "gravity"
"""Full name of the acceleration of gravity at the laboratory."""

MOUNTING = "mounting"
"""What the full names of mounting angles begin with: "mounting.CHANNEL"."""

CHANGE = "learned_change"
"""What the full names of changes in the course of a campaign begin with: "learned_change.HOW.PARAMETER".

It is no effect by itself: a parameter of one, or the restitution, is another in each test."""

SLOPE_STEP = 0.01
"""Step of a derivative of the reading [rad]: exact up to the fourth power, and far above rounding."""

MOST_STEPS = 30
"""Of Newton's method; a straight line takes one."""

ENOUGH = 1e-14
"""Step [rad] over 1 and the rotation below which Newton's method has arrived: what is left is rounding."""

ALONG = 9
"""Places between none and a rotation at which its reading has to grow."""


@dataclass(frozen=True)
class Change:
    """How a parameter changes from test to test: evenly, ever less, or all at once.

    It goes by the number of the test, or by what impacts have taken until then, in tests with an average of that.

    Args:
        per_test: from the first test to the next [unit of the parameter].
        fading: by how much that fades from test to test, as exp(-fading number) [1]: 0 goes on for ever, more comes to
            an end, per_test / fading away.
        step: what is added all at once [unit of the parameter].
        from_test: number of the first test that has the step [1].
        by_use: 1 where `per_test` goes by what impacts took, 0 where by the number of the test.
        low, high: what the parameter does not pass.
    """

    per_test: float = 0.0
    fading: float = 0.0
    step: float = 0.0
    from_test: float = 1.0
    by_use: float = 0.0
    low: float = -math.inf
    high: float = math.inf

    def at(self, value: float, number: int, use: float) -> float:
        """The parameter in a test of a number and after some use, which is `value` before all of them."""
        stepped = self.step if number >= self.from_test else 0.0
        gone = float(faded(use if self.by_use else number, self.fading))
        return min(max(value + self.per_test * gone + stepped, self.low), self.high)


def faded(number: Any, fading: float) -> Any:
    """The number of a test as a change counts it that fades: how many times the first one it has added up to [1]."""
    return number if fading == 0.0 else -np.expm1(-fading * np.asarray(number)) / fading


@dataclass(frozen=True)
class LoopModel:
    """The block as declared, a restitution, and effects by name with their parameters.

    Args:
        declared: the block of the campaign.
        restitution: e of eq. (4) [1].
        effects: parameters by name, by effect.
        g: gravity [m/s^2].
        drift: change of restitution from one test to the next, in the order in which they were done [1].
        fading: by how much that change fades from test to test, as exp(-fading number) [1]: 0 goes on for ever, more
            comes to an end, drift / fading away from where it began.
        number: of the test [1], counted from the first of the campaign that was learned from.
        mountings: how far accelerometers on the block are turned from their declared axes, by channel [rad], clockwise
            as the rotation of the block.
        changes: how parameters of effects change in the course of the campaign, by full name, as arguments of `Change`;
            what `effects` says of them, and `restitution`, is of the first test.
        uses: what impacts had taken by the middle of each test of the campaign that was learned from, over what they
            took in one test on average [1]; later ones are taken for average.
    """

    declared: DeclaredBlock
    restitution: float
    effects: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    g: float = G_STANDARD
    drift: float = 0.0
    number: int = 0
    mountings: Mapping[str, float] = field(default_factory=dict)
    fading: float = 0.0
    changes: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    uses: tuple[float, ...] = ()

    @cached_property
    def block(self) -> Block:
        """The rectangle of the declared size and mass."""
        d = self.declared
        return Block(d.breadth, d.height, d.depth, d.density)

    @cached_property
    def parts(self) -> tuple[Effect, ...]:
        """The effects as objects; what the declaration says of the mass is one of them."""
        given = self.effects_now
        declared = {"height": self.declared.centre_of_mass_height, "inertia": self.declared.inertia}
        known = {name: value for name, value in declared.items() if value is not None}
        if known:
            given["mass_distribution"] = known | given.get("mass_distribution", {})
        return tuple(load(name)(**parameters) for name, parameters in given.items())

    @cached_property
    def system(self) -> System:
        """The block with the effects on it.

        Raises:
            ValueError: the effects do not go together, or a parameter is out of its range.
        """
        return compose(Method1(self.block, restitution=self.restitution_now, g=self.g), self.parts)

    @property
    def effects_now(self) -> dict[str, dict[str, float]]:
        """Parameters by name, by effect, in this test."""
        given = {name: dict(parameters) for name, parameters in self.effects.items()}
        for full, change in self.acting_changes.items():
            effect, _, parameter = full.partition(".")
            if parameter:
                given[effect][parameter] = Change(**change).at(given[effect][parameter], self.number, self.use)
        return given

    @property
    def acting_changes(self) -> dict[str, Mapping[str, float]]:
        """Those of the restitution and of parameters that are there: of an effect that was taken out none is left."""
        there = {f"{effect}.{name}" for effect, own in self.effects.items() for name in own} | {RESTITUTION}
        return {full: change for full, change in self.changes.items() if full in there}

    @property
    def use(self) -> float:
        """What impacts have taken by the middle of this test, as of `uses`; its number where none is known."""
        last = len(self.uses) - 1
        return float(self.number) if last < 0 else self.uses[min(self.number, last)] + max(0, self.number - last)

    @property
    def restitution_now(self) -> float:
        """Restitution in this test [1], within 0 and 1."""
        drifted = self.restitution + self.drift * float(faded(self.number, self.fading))
        return min(max(Change(**self.changes.get(RESTITUTION, {})).at(drifted, self.number, self.use), 0.0), 1.0)

    def in_test(self, number: int) -> LoopModel:
        """The model in the test of that number after its own; itself where nothing drifts."""
        if not self.varies or number == 0:
            return self
        known = self._in_tests  # once: of two threads that ask for the first time each may get one of its own
        if number not in known:
            known[number] = replace(self, number=self.number + number)
        return known[number]

    @cached_property
    def varies(self) -> bool:
        """Whether it is another one in another test."""
        return self.drift != 0.0 or bool(self.acting_changes)

    @cached_property
    def _in_tests(self) -> dict[int, LoopModel]:
        """The models in other tests as far as they were asked for, by how many tests later these are."""
        return {}

    def base(self, motion: BaseMotion, span: tuple[float, float]) -> BaseMotion:
        """What the base really did when this was recorded of it."""
        return base_with(motion, self.parts, span, self.g)

    def reading(self, theta: Any) -> Any:
        """What the rotation sensor says [rad]."""
        return rotation_reading(theta, self.parts)

    def recorded(self, theta: NDArray[np.float64], seen: Seen) -> NDArray[np.float64]:
        """What the rotation sensor says [rad] sample by sample, shape (time,), from a peak or a rest on."""
        return np.asarray(recorded_rotation(theta, self.parts, seen), dtype=np.float64)

    @cached_property
    def remembers(self) -> bool:
        """Whether what the rotation sensor says depends on more than the rotation of the time."""
        return any("recorded" in part.ways() for part in self.parts)

    @cached_property
    def timed(self) -> bool:
        """Whether the recorder of the rotation has a clock of its own."""
        return any("moments" in part.ways() for part in self.parts)

    def moments(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """When what the rotation sensor says at these times since its record began [s] happened, shape (time,)."""
        return np.asarray(read_at(time, self.parts), dtype=np.float64)

    def at_peak(self, theta: float) -> float:
        """What the rotation sensor says [rad] of a block that has just come to that rotation [rad] from upright."""
        return (
            float(self.recorded(np.array([theta]), AT_THE_START)[0]) if self.remembers else float(self.reading(theta))
        )

    def peak(self, reading: float) -> float:
        """The rotation [rad] at which it says so; NaN where it says nothing unique."""
        theta = float(self.rotation(reading))
        if self.remembers and math.isfinite(theta):
            theta += reading - self.at_peak(theta)  # play is the same for all that is beyond it
        return theta

    def reading_slope(self, theta: ArrayLike) -> NDArray[np.float64]:
        """How much more the rotation sensor says for a larger rotation [1], at rotations [rad] of any shape."""
        x, h = np.asarray(theta, dtype=np.float64), SLOPE_STEP
        near, far = (self.reading(x + d) - self.reading(x - d) for d in (h, 2.0 * h))
        return np.asarray((8.0 * near - far) / (12.0 * h))

    def rotation(self, reading: ArrayLike) -> NDArray[np.float64]:
        """Rotation [rad] at which the sensor says a reading [rad], of any shape, by Newton's method.

        NaN where the reading does not grow all the way from no rotation to there: it says nothing unique, or never so.
        """
        wanted = np.asarray(reading, dtype=np.float64)
        if not any("reading" in part.ways() for part in self.parts):
            return np.where(np.isfinite(wanted), wanted, np.nan)
        theta = wanted.copy()
        with np.errstate(all="ignore"):
            for _ in range(MOST_STEPS):
                step = (wanted - self.reading(theta)) / self.reading_slope(theta)
                theta = theta + step
                if not np.any(np.abs(step) > ENOUGH * (1.0 + np.abs(theta))):
                    break
            there = np.abs(self.reading(theta) - wanted) <= 1e-9 * (1.0 + np.abs(wanted))
            grows = self.reading_slope(np.multiply.outer(np.linspace(0.0, 1.0, ALONG), theta)) > 0.0
            return np.where(there & np.all(grows, axis=0), theta, np.nan)

    def axis(self, channel: Channel) -> tuple[float, float]:
        """The sensitive axis of an accelerometer on the block as it is mounted, in the block frame, of unit length."""
        x, z = channel.axis
        turned = self.mountings.get(channel.name, 0.0)
        cos, sin = math.cos(turned), math.sin(turned)
        return x * cos + z * sin, -x * sin + z * cos

    def get(self, name: str) -> float:
        """A parameter by its full name, "restitution", "mounting.channel" or "effect.parameter"."""
        own = {RESTITUTION: self.restitution, DRIFT: self.drift, FADING: self.fading, GRAVITY: self.g}
        if name in own:
            return own[name]
        effect, _, parameter = name.partition(".")
        if effect == MOUNTING:
            return float(self.mountings.get(parameter, 0.0))
        if effect == CHANGE:
            how, _, changed = parameter.partition(".")
            return float(self.changes.get(changed, {}).get(how, getattr(Change(), how)))
        return float(self.effects[effect][parameter])

    def changed(self, values: Mapping[str, float]) -> LoopModel:
        """The model with some parameters, by full name, at other values; effects that it lacks are added."""
        effects = {name: dict(parameters) for name, parameters in self.effects.items()}
        own = {RESTITUTION: self.restitution, DRIFT: self.drift, FADING: self.fading, GRAVITY: self.g}
        mountings = dict(self.mountings)
        changes = {name: dict(change) for name, change in self.changes.items()}
        for name, value in values.items():
            if name in own:
                own[name] = float(value)
                continue
            effect, _, parameter = name.partition(".")
            if effect == CHANGE:
                how, _, changed = parameter.partition(".")
                changes.setdefault(changed, {})[how] = float(value)
                continue
            table = mountings if effect == MOUNTING else effects.setdefault(effect, {})
            table[parameter] = float(value)
        return replace(
            self, restitution=own[RESTITUTION], drift=own[DRIFT], fading=own[FADING], g=own[GRAVITY], effects=effects,
            mountings=mountings, changes=changes,
        )  # fmt: skip
