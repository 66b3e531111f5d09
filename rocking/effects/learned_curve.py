"""Learned curve: a torque against rotation of any shape, where no effect with a name explains a measurement.

Adds        theta'' += s f(phi) + g(phi), phi = |theta| on the carrying side: f alike on both sides, g with one sign on
            both; each a natural cubic spline over equal intervals from upright to its reach, beyond which it keeps its
            last value
Parameters  odd_reach and even_reach, where f and g end [rad]; odd_intervals and even_intervals, 1 to `MOST` [1];
            odd_0 ... and even_0 ..., coefficients of f and g [rad/s^2], one more than there are intervals: the first is
            the value upright, the last that at the reach, those between about the values at the knots; 0 where absent
Use when    a few coefficients (`learned_term`) do not reach: a pull near upright, ribs, a detent, a cable with slack
Limits      no damping (`learned_damping` has it), no memory; what is narrower than an interval is smeared over it
Source      B-splines: de Boor, A practical guide to splines (1978); the coefficients before the first and after the
            last lie in line with their neighbours, so that the second derivative is zero at both ends
Status      against SciPy's natural splines, and the absent value (tests)
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields, make_dataclass
from typing import Any, ClassVar

from rocking.effect import Effect
from rocking.form import Form

MOST = 16
"""Intervals of a curve at most."""

ODD, EVEN = (tuple(f"{kind}_{j}" for j in range(MOST + 1)) for kind in ("odd", "even"))
"""Names of the coefficients."""

HEAD = 2
"""Numbers of a curve before its coefficients: the width of an interval, and how many there are."""

COUNT = HEAD + MOST + 3
"""Numbers of a curve."""


def curve(xp: Any, phi: Any, numbers: Any, first: int) -> Any:
    """The curve whose numbers begin at that place, at the rotation phi [rad/s^2]."""
    u = xp.minimum(xp.maximum(phi / numbers[first], 0.0), numbers[first + 1])
    total = 0.0 * phi
    for j in range(COUNT - HEAD):
        x = xp.abs(u - (j - 1.0))
        outer, inner = xp.maximum(2.0 - x, 0.0), xp.maximum(1.0 - x, 0.0)
        total = total + numbers[first + HEAD + j] * (outer * outer * outer - 4.0 * inner * inner * inner)
    return total / 6.0


def torque(xp: Any, theta: Any, omega: Any, s: Any, base: Any, values: Any) -> Any:
    """Both curves at this rotation [rad/s^2]."""
    return s * curve(xp, s * theta, values, 0) + curve(xp, s * theta, values, COUNT)


def numbers(reach: float, coefficients: tuple[float, ...]) -> tuple[float, ...]:
    """What `curve` takes, of coefficients one more than there are intervals."""
    n, c = len(coefficients) - 1, coefficients
    ends = (2.0 * c[0] - c[1], *c, 2.0 * c[n] - c[n - 1])
    return (reach / n, float(n), *ends, *(0.0,) * (COUNT - HEAD - len(ends)))


class Tabulated(Effect):
    """An effect of many coefficients, which tells of those that are given."""

    def __repr__(self) -> str:
        own = fields(self)  # type: ignore[arg-type]
        given = [(f.name, getattr(self, f.name)) for f in own if getattr(self, f.name) != f.default]
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in given)})"


def tabulated(names: Sequence[tuple[str, float]]) -> Any:
    """A class with these parameters and their default values, for an effect to be made of."""
    own = [(name, float, value) for name, value in names]
    return make_dataclass("_Coefficients", own, bases=(Tabulated,), frozen=True, repr=False)


def rising(effect: Any) -> None:
    """ValueError unless a curve from low to high begins before it ends."""
    if not effect.low < effect.high:
        raise ValueError(f"{effect.name}.low={effect.low!r} rad: want less than high={effect.high!r}")


def none_beyond(effect: Effect, intervals: str, names: tuple[str, ...]) -> None:
    """Of a curve's coefficients those after the last of its intervals are left at zero.

    Raises:
        ValueError: one is not, or the number of intervals is no whole one.
    """
    n = getattr(effect, intervals)
    if n != int(n):
        raise ValueError(f"{effect.name}.{intervals}={n!r}: want a whole number")
    for name in names[int(n) + 1 :]:
        if getattr(effect, name) != 0.0:
            raise ValueError(
                f"{effect.name}.{name}={getattr(effect, name)!r} {effect.units[name]}: want none beyond "
                f"{names[int(n)]}, the last of {int(n)} intervals"
            )


_FIELDS: list[tuple[str, float]] = []
for _kind, _names in (("odd", ODD), ("even", EVEN)):
    _FIELDS += [(f"{_kind}_reach", 1.0), (f"{_kind}_intervals", float(MOST)), *((name, 0.0) for name in _names)]

_Coefficients: Any = tabulated(_FIELDS)


class LearnedCurve(_Coefficients):
    """Two curves: where they end [rad], their intervals and their coefficients [rad/s^2]."""

    name: ClassVar[str] = "learned_curve"
    units: ClassVar[dict[str, str]] = dict.fromkeys((*ODD, *EVEN), "rad/s^2") | {
        "odd_reach": "rad", "even_reach": "rad", "odd_intervals": "1", "even_intervals": "1",
    }  # fmt: skip
    ranges: ClassVar[dict[str, tuple[float, float]]] = dict.fromkeys(
        ("odd_reach", "even_reach"), (1e-6, 0.5 * math.pi)
    ) | dict.fromkeys(("odd_intervals", "even_intervals"), (1.0, float(MOST)))
    acceleration = staticmethod(torque)

    def __post_init__(self) -> None:
        super().__post_init__()
        for kind, names in (("odd", ODD), ("even", EVEN)):
            none_beyond(self, f"{kind}_intervals", names)

    def values(self, form: Form) -> tuple[float, ...]:
        """The numbers of both curves."""
        out: tuple[float, ...] = ()
        for kind, names in (("odd", ODD), ("even", EVEN)):
            own = names[: int(getattr(self, f"{kind}_intervals")) + 1]
            out += numbers(getattr(self, f"{kind}_reach"), tuple(float(getattr(self, name)) for name in own))
        return out
