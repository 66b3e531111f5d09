"""Learned reading: a rotation sensor that is not linear, has play, drifts, or feels the base.

Changes     the reading: x + square x^2 + cubic x^3 + c(x) + drift t + base a_x, before a gain and an offset; c a
            natural cubic spline over equal intervals from low to high, beyond which it keeps its last value; x follows
            theta with a play, within which it stays behind; t the time since the record began
Parameters  square [1/rad], cubic [1/rad^2]; low and high, where c begins and ends [rad]; intervals, 1 to `MOST` [1];
            curve_0 ..., coefficients of c [rad], one more than there are intervals, as those of
            `rocking.effects.learned_curve`; play [rad], half of the gap; drift [rad/s]; base [rad/(m/s^2)]; 0 where
            absent
Use when    a sensor bends toward the ends of its range, an arc is read for an angle, or the marks of an encoder are
            uneven; a linkage has play, a zero drifts as the sensor warms up, a camera or a beam shakes with the base:
            how the reading is off, not why
Limits      the play begins in the middle of its gap with the block upright, and a drift with each record; what is
            narrower than an interval is smeared over it; outside of what was measured
            neither series nor curve says anything
Source      a calibration curve (JCGM 200:2012, 4.31) as a series, or as a spline: de Boor, A practical guide to splines
            (1978); drift (4.21) and influence of another quantity (2.52) likewise; the play of Krasnosel'skii &
            Pokrovskii, Systems with hysteresis (1989)
Status      by hand, against SciPy's natural splines, and learned from decays of the laboratory with a cube, or with
            uneven marks, added to what its sensor reads (tests)
"""

from __future__ import annotations

import math
from functools import cache, cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from rocking.effect import Seen
from rocking.effects.learned_curve import none_beyond, rising, tabulated

MOST = 32
"""Intervals of the curve at most."""

MARKS = tuple(f"curve_{j}" for j in range(MOST + 1))
"""Names of its coefficients."""

_FIELDS = [
    ("square", 0.0), ("cubic", 0.0), ("play", 0.0), ("drift", 0.0), ("base", 0.0), ("low", -1.0), ("high", 1.0),
    ("intervals", float(MOST)),
    *((name, 0.0) for name in MARKS),
]  # fmt: skip

_Coefficients: Any = tabulated(_FIELDS)


class LearnedReading(_Coefficients):
    """What a sensor makes of the rotation: by its square and its cube, by a curve, by play, in time, with the base."""

    name: ClassVar[str] = "learned_reading"
    units: ClassVar[dict[str, str]] = dict.fromkeys(MARKS, "rad") | {
        "square": "1/rad", "cubic": "1/rad^2", "play": "rad", "drift": "rad/s", "base": "rad/(m/s^2)",
        "low": "rad", "high": "rad", "intervals": "1",
    }  # fmt: skip
    ranges: ClassVar[dict[str, tuple[float, float]]] = {
        "play": (0.0, 0.5 * math.pi),
        "low": (-0.5 * math.pi, 0.5 * math.pi),
        "high": (-0.5 * math.pi, 0.5 * math.pi),
        "intervals": (1.0, float(MOST)),
    }
    rank: ClassVar[int] = -1  # a gain and an offset are of what the sensor has made of the rotation

    def __post_init__(self) -> None:
        super().__post_init__()
        none_beyond(self, "intervals", MARKS)
        rising(self)

    @cached_property
    def _curve(self) -> Any:
        """c as SciPy's spline; None where it is nothing."""
        own = [float(getattr(self, name)) for name in MARKS[: int(self.intervals) + 1]]
        if not any(own):
            return None
        from scipy.interpolate import BSpline

        width = (self.high - self.low) / (len(own) - 1)
        # Before the first and after the last in line with their neighbours: no second derivative at either end.
        coefficients = [2.0 * own[0] - own[1], *own, 2.0 * own[-1] - own[-2]]
        return BSpline(self.low + width * (np.arange(len(own) + 6) - 3.0), coefficients, 3)

    def reading(self, theta: Any) -> Any:
        """theta + square theta^2 + cubic theta^3 + c(theta) [rad]."""
        bent = theta * (1.0 + theta * (self.square + self.cubic * theta))
        return bent if self._curve is None else bent + self._curve(np.clip(theta, self.low, self.high))

    def recorded(self, theta: Any, seen: Seen) -> Any:
        """The reading of what has come through the play, and what time and the base add [rad], shape (time,)."""
        through = follower(theta, self.play) if self.play > 0.0 else theta
        return self.reading(through) + self.drift * seen.time + self.base * seen.a_x


def follower(theta: NDArray[np.float64], play: float) -> NDArray[np.float64]:
    """What is moved by theta [rad], shape (time,), through a gap of twice the play [rad].

    It has been moved from upright, where it was in the middle of the gap, to the first one of them; where the first
    ones are on their way back, which a peak that stays in the gap hides, as far as the peak from which they come.
    """
    return np.asarray(_follower()(np.ascontiguousarray(theta, dtype=np.float64), float(play)))


@cache
def _follower() -> Any:
    from numba import njit

    def follow(theta: Any, play: Any) -> Any:
        out = np.empty(theta.size)
        last = 0.0
        if theta.size > 2:
            bend = theta[2] - 2.0 * theta[1] + theta[0]
            pace = theta[1] - theta[0] - 0.5 * bend  # of a parabola through three samples, at the first
            if pace * theta[0] < 0.0 and bend * theta[0] < 0.0:
                last = theta[0] - 0.5 * pace * pace / bend
                last = math.copysign(max(abs(last) - play, 0.0), last)
        for k in range(theta.size):
            last = min(max(last, theta[k] - play), theta[k] + play)
            out[k] = last
        return out

    return njit(follow)
