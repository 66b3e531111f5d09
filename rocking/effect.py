"""What an effect is: something real that the ideal block on its ideal base lacks, and the ways in which it may act.

An effect is a frozen dataclass whose fields are its parameters, floats in SI units whose defaults mean "not there".  It
acts in one or more of these ways, each a member that it overrides:

- `acceleration(xp, theta, omega, s, base, values) -> theta''` [rad/s^2]: a plain function, added to the flow;
- `restitution(xp, e, omega, s, values) -> e`: a plain function, applied at an impact to what the form gives;
- `values(form)`: the numbers that these two take by index (the fields, if it does not say otherwise); compiled code
  does not know how many there are;
- `form(form, block)`: shape and mass of the block, lever, lift-off;
- `modes(method, form)`: other modes of motion, by another method;
- `freedoms(system)`: further freedoms: a system with a longer state in place of that of `rocking.composed`;
- `base_motion(motion, span, g)`: what the base really does;
- `reading(theta)`: what the rotation sensor says;
- `recorded(theta, seen)`: what it says from sample to sample, where that depends on more than the rotation of the time;
- `moments(time)`: when what it says at these times happened.

Source   each effect names its own.
Status   `rocking.effects` finds effects and puts them together.
"""

from __future__ import annotations

import dataclasses
import math
import numbers
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from rocking.block import Block
    from rocking.composed import ComposedMethod1
    from rocking.form import Form
    from rocking.hybrid import System
    from rocking.method1 import Method1
    from rocking.method2 import Method2
    from rocking.motion import BaseMotion

WAYS = ("acceleration", "restitution", "form", "modes", "freedoms", "base_motion", "reading", "recorded", "moments")
"""The members by which an effect may act."""

OF_THE_SENSOR = frozenset({"reading", "recorded", "moments"})
"""Those of them that leave the block alone."""


class Seen(NamedTuple):
    """What a rotation sensor may feel besides the rotation, at the samples of a record, arrays of shape (time,)."""

    time: NDArray[np.float64]  # since the record began [s]
    a_x: NDArray[np.float64]  # of the base [m/s^2], horizontal: no gravity is in it where the floor is tilted


AT_THE_START = Seen(np.zeros(1), np.zeros(1))
"""Of a block that is held where it is, on a base that stands still, as a record begins."""


class Effect:
    """Base of effects: acts in no way.

    A subclass is a frozen dataclass that states `name` (that of its module) and `units`, by parameter, and overrides
    what it does.
    """

    name: ClassVar[str] = ""
    units: ClassVar[dict[str, str]] = {}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {}
    """Lowest and highest value of a parameter, where there is one; both are allowed."""

    unbounded: ClassVar[frozenset[str]] = frozenset()
    """Parameters that may be infinite, of those that are not where they are absent."""

    rank: ClassVar[int] = 0
    """Effects on the base and the sensors act in the order of their ranks."""

    acceleration: ClassVar[Callable[..., Any] | None] = None
    restitution: ClassVar[Callable[..., Any] | None] = None

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):  # type: ignore[arg-type]
            value, (low, high) = getattr(self, field.name), self.ranges.get(field.name, (-math.inf, math.inf))
            # What is not there may be said by None or by infinity; nothing else is but a finite number.
            if value == field.default:
                continue
            endless = field.name in self.unbounded and value == math.inf
            number = isinstance(value, numbers.Real) and (endless or math.isfinite(value))
            if not (number and low <= value <= high):
                want = "a number" if (low, high) == (-math.inf, math.inf) else f"{low:g} to {high:g}"
                raise ValueError(f"{self.name}.{field.name}={value!r} {self.units.get(field.name, '1')}: want {want}")

    @classmethod
    def parameter_names(cls) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(field.name for field in dataclasses.fields(cls))  # type: ignore[arg-type]

    def parameters(self) -> dict[str, float]:
        """The parameters that are given, by name."""
        values = {name: getattr(self, name) for name in self.parameter_names()}
        return {name: value for name, value in values.items() if value is not None}

    @classmethod
    def absent(cls, block: Block) -> dict[str, float]:
        """Value of each parameter at which the effect is not there, for this block."""
        fields = dataclasses.fields(cls)  # type: ignore[arg-type]
        return {field.name: float(field.default) for field in fields}  # type: ignore[arg-type]

    @classmethod
    @cache
    def ways(cls) -> frozenset[str]:
        """The ways in which it acts: those of `WAYS` that it overrides."""
        return frozenset(way for way in WAYS if getattr(cls, way) is not getattr(Effect, way))

    def ways_used(self) -> frozenset[str]:
        """Its ways but, for one that acts on modes or freedoms, those of the two that these parameters leave out.

        All its ways, if a subclass does not say otherwise.
        """
        return self.ways()

    def strikes(self) -> bool:
        """Whether, with these parameters, it changes the restitution."""
        return "restitution" in self.ways()

    def values(self, form: Form) -> tuple[float, ...]:
        """Numbers that `acceleration` and `restitution` take."""
        return tuple(float(value) for value in self.parameters().values())

    def form(self, form: Form, block: Block) -> Form:
        """The form with the effect in it."""
        return form

    def modes(self, method: Method1 | Method2, form: Form | None) -> Method2:
        """The block under a method that has the effect's modes; an effect that acts on none is not asked.

        method: Method 1, or the Method 2 that another effect on the modes has made of it.
        form: shape and mass of the block with the effects on these, None where there are none.
        """
        raise ValueError(f"{self.name}: it acts in the ways {sorted(self.ways())}, not on the modes")

    def freedoms(self, system: ComposedMethod1) -> System:
        """A system with the effect's freedoms besides; an effect that has none is not asked."""
        raise ValueError(f"{self.name}: it acts in the ways {sorted(self.ways())}, without further freedoms")

    def has_feet(self) -> bool:
        """Whether it has corners, with these parameters, that slip by themselves, with a `friction` of its own.

        Beside it `sliding` says that friction, and has no modes of its own.
        """
        return False

    def base_motion(self, motion: BaseMotion, span: tuple[float, float], g: float) -> BaseMotion:
        """What the base really does, over the span [s]."""
        return motion

    def reading(self, theta: Any) -> Any:
        """What the rotation sensor says [rad] when the rotation is theta."""
        return theta

    def recorded(self, theta: NDArray[np.float64], seen: Seen) -> NDArray[np.float64]:
        """What the rotation sensor says [rad] sample by sample, shape (time,), from a peak or a rest on."""
        return np.asarray(self.reading(theta))

    def moments(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """When what is read at these times since the record began [s] happened, 0 or more, shape (time,)."""
        return time
