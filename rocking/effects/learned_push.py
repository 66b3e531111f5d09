"""Learned push: a force that depends on nothing but the time, where no effect with a name explains a measurement.

Adds        a_x += c(t): what pushes the whole block to -x with c times its mass is an acceleration of the base to +x;
            c is a cubic spline over equal intervals from the beginning of the run on, zero after the last of them
Parameters  interval, between knots [s]; push_0 ..., 128 at the most, coefficients of c [m/s^2]: of B-splines, the
            first of which has its middle an interval before the beginning; 0 where absent; at_rest, share of it that
            acts where the base never moves by more than still [m/s^2], 0 of what goes with the shaking [1]
Use when    something acts at the same times of every test: a fan that is switched on, a drive that kicks before the
            motion begins, a machine next door that runs through its cycle
Limits      the force goes through the centre of mass; a sensor on the block would feel a force as one, and not as what
            the base does; what is shorter than an interval is smeared over it
Source      B-splines: de Boor, A practical guide to splines (1978); a force on the whole of a body as an acceleration
            of its base: d'Alembert
Status      against SciPy's B-splines, a block that is pushed by a motion of its base, and the absent value (tests)
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from rocking.altered import AlteredMotion, samples_of, table, table_value
from rocking.effects.learned_curve import tabulated
from rocking.motion import BaseMotion

MOST = 128
"""Coefficients at most."""

PUSHES = tuple(f"push_{j}" for j in range(MOST))
"""Names of the coefficients."""

FINER = 4
"""Samples of an interval between which a run goes along a cubic."""

_inner: Any = None
_split: Any = None


def _pushed(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    a_x, a_z = _inner(xp, t, par[:_split])
    return a_x + table_value(xp, t, par[_split:], 0.0), a_z


def bump(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """The cubic B-spline [1] at distances x from its middle, over its interval, of any shape."""
    outer, inner = np.maximum(2.0 - np.abs(x), 0.0), np.maximum(1.0 - np.abs(x), 0.0)
    return (outer**3 - 4.0 * inner**3) / 6.0


def course(push: Any, since: NDArray[np.float64]) -> NDArray[np.float64]:
    """c [m/s^2] of a learned push at times [s] since the beginning, of any shape."""
    total = np.zeros_like(since)
    for j, name in enumerate(PUSHES):
        size = getattr(push, name)
        if size != 0.0:
            total += size * bump(since / push.interval - (j - 1))
    return np.where(since >= 0.0, total, 0.0)


_Coefficients: Any = tabulated([("interval", 0.1), ("at_rest", 1.0), ("still", 0.0), *((name, 0.0) for name in PUSHES)])


class LearnedPush(_Coefficients):
    """What pushes at the same times: the interval between knots [s], its share at rest and the coefficients [m/s^2]."""

    name: ClassVar[str] = "learned_push"
    units: ClassVar[dict[str, str]] = {"interval": "s", "at_rest": "1", "still": "m/s^2"} | dict.fromkeys(
        PUSHES, "m/s^2"
    )
    ranges: ClassVar[dict[str, tuple[float, float]]] = {
        "interval": (1e-3, 1e3),
        "at_rest": (-10.0, 10.0),
        "still": (0.0, 1e3),
    }
    rank: ClassVar[int] = 4  # it acts on the block, whatever the base does

    def base_motion(self, motion: BaseMotion, span: tuple[float, float], g: float) -> BaseMotion:
        """The motion of a base on which the block would move as it does under the force."""
        acting = [j for j, name in enumerate(PUSHES) if getattr(self, name) != 0.0]
        if not acting:
            return motion
        share = 1.0
        if self.at_rest != 1.0 and np.max(np.abs(samples_of(motion, span).a_x)) <= self.still:
            share = self.at_rest
        step = self.interval / FINER
        t = step * np.arange(FINER * (acting[-1] + 1) + 1)
        numbers = table(span, span[0], step, share * course(self, t))
        label = f"a push at {len(acting)} times from {max(acting[0] - 3, 0) * self.interval:.3g} s on"
        return AlteredMotion(motion, numbers, kernel=_pushed, max_step=self.interval, label=label)
