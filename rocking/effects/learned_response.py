"""Learned response: the sensor of the rotation answers as a low-pass of second order, late and rounded at impacts.

Changes     the reading: y with y'' + 2 damping_ratio w y' + w^2 y = w^2 theta, w = 2 pi frequency, before what the
            sensor makes of it
Parameters  frequency [Hz], infinite where it is absent; damping_ratio [1]
Use when    a filter follows the sensor, or it hangs on a linkage, a float or an arm with a mass of its own: how the
            reading is off, not why
Limits      an impact is where it is to within the samples about it; before a record the block was held, and before
            another first sample it went as the parabola through the first three says. A filter far above what moves
            only is late: `rocking.effects.learned_timing` says so with one number
Source      dynamic response of an instrument: Doebelin, Measurement Systems (4th ed. 1990), sec. 3.3; exact for
            straight lines as in Nigam & Jennings (1969), Bull. Seismol. Soc. Am. 59, 909, which are drawn so that they
            have the mean of what bends between samples
Status      against its equation by another integrator, a sinusoid and a ramp by hand, and learned from tests with such
            a sensor (tests)
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from rocking.effect import Effect, Seen

APART = 1e-6
"""By how much of them its two rates are kept apart where they would meet."""


@dataclass(frozen=True)
class LearnedResponse(Effect):
    """Frequency [Hz] and damping ratio [1] with which a sensor answers."""

    frequency: float = math.inf
    damping_ratio: float = 0.7

    name: ClassVar[str] = "learned_response"
    units: ClassVar[dict[str, str]] = {"frequency": "Hz", "damping_ratio": "1"}
    ranges: ClassVar[dict[str, tuple[float, float]]] = {"frequency": (0.01, 1e4), "damping_ratio": (0.0, 100.0)}
    rank: ClassVar[int] = -2  # a curve, a gain and an offset are of what has come through

    def recorded(self, theta: Any, seen: Seen) -> Any:
        """The answer to a rotation theta [rad] at these times, shape (time,)."""
        x = np.ascontiguousarray(theta, dtype=np.float64)
        if math.isinf(self.frequency) or x.size < 2:
            return theta
        w = 2.0 * math.pi * self.frequency
        mean, root = -self.damping_ratio * w, w * cmath.sqrt(self.damping_ratio**2 - 1.0)
        if abs(root) < APART * w:
            root = complex(APART * w)
        late, bent = 2.0 * self.damping_ratio / w, (4.0 * self.damping_ratio**2 - 1.0) / w**2
        time = np.ascontiguousarray(seen.time, dtype=np.float64)
        return np.asarray(_answer()(x, _straightened(x, time), time, mean + root, mean - root, late, bent))


def _straightened(x: NDArray[np.float64], t: NDArray[np.float64]) -> NDArray[np.float64]:
    """Corners of straight lines that have between samples the mean of the parabola through three of them."""
    if x.size < 3:
        return x
    steps = np.diff(t)
    bends = 2.0 * np.diff(np.diff(x) / steps) / (steps[:-1] + steps[1:])
    lower = bends * steps[:-1] * steps[1:] / 12.0
    return np.asarray(x - np.concatenate([lower[:1], lower, lower[-1:]]))


@cache
def _answer() -> Any:
    from numba import njit

    def before(x: Any, t: Any, k: Any) -> Any:
        # Pace and bend of the parabola through three samples, at the first of them.
        if t[k] <= 0.0 or k + 2 >= x.size or not math.isfinite(x[k + 1] + x[k + 2]):
            return 0.0, 0.0
        first, second = t[k + 1] - t[k], t[k + 2] - t[k + 1]
        one, two = (x[k + 1] - x[k]) / first, (x[k + 2] - x[k + 1]) / second
        bend = 2.0 * (two - one) / (first + second)
        return one - 0.5 * bend * first, bend

    before = njit(before)

    def answer(x: Any, line: Any, t: Any, r1: Any, r2: Any, late: Any, bent: Any) -> Any:
        out = np.full(x.size, np.nan)
        begun, step = False, -1.0
        y, v, e1, e2 = 0.0, 0.0, 0j, 0j
        for k in range(x.size):
            if not math.isfinite(line[k]):
                begun = False
                continue
            if not begun:
                pace, bend = before(x, t, k)
                y = x[k] - late * pace + bent * bend
                v = pace - late * bend
                begun = True
            else:
                h = t[k] - t[k - 1]
                if abs(h - step) > 1e-9 * h:
                    step = h
                    e1, e2 = np.exp(r1 * h), np.exp(r2 * h)
                slope = (line[k] - line[k - 1]) / h
                apart, drawn = y - (line[k - 1] - late * slope), v - slope
                a = (drawn - r2 * apart) / (r1 - r2)
                b = apart - a
                y = line[k] - late * slope + (a * e1 + b * e2).real
                v = slope + (a * r1 * e1 + b * r2 * e2).real
            out[k] = y
        return out

    return njit(answer)
