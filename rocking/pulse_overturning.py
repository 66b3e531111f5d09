"""Overturning by one cycle of a sine or a cosine after one impact: the band of amplitudes, from the linear equation.

With tau = p t and x = theta/alpha, positive to the side to which the base first tips the block, a swing obeys

    x'' = x - s + A f(w tau),   x = s + c f(w tau) + C cosh(tau) + D sinh(tau),   c = -A/(1 + w^2),

f a sine or a cosine, s = +-1 the side.  A sine leaves rest where A f = 1, a cosine at once.  The block strikes at the
first root of x and goes on with e x' on the side s = -1.  If the pulse ends after that, the block overturns when
-(x + x') > 1 at its end; if it ended before, the block, free, strikes with x'^2 = 1 + E, E = x'^2 - (1 - x)^2 at the
end of the pulse, and overturns when e sqrt(1 + E) > 1.  Only the time of an impact within the pulse has to be found,
everything else is closed.

Source   Zhang & Makris (2001), J. Eng. Mech. 127, 473-483: overturning of blocks by cycloidal pulses with and without
         impact; Makris & Roussos (2000), Geotechnique 50, 243-262.
Status   one impact exactly; without an impact see `closed_forms.full_sine_pulse` and `full_cosine_pulse`.  Long pulses
         also overturn after several impacts: of ratio below 1 at smaller amplitudes, and cosines of ratio up to 1.5 and
         more, of blocks that lose little, at amplitudes between the band and that without an impact.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from rocking.closed_forms import full_cosine_pulse, full_sine_pulse
from rocking.validation import positive, within

Pulse = Literal["sine", "cosine"]

AMPLITUDES = 400
"""Amplitudes between 1 and that of overturning without an impact at which the band is looked for."""

POINTS = 400
"""Points of a swing at which its first root is looked for."""


class Band(NamedTuple):
    """Amplitudes over g alpha [1] between which a block overturns after one impact."""

    low: float
    high: float


class _Swing(NamedTuple):
    """A swing on the side s from (x, v) at the phase psi of the sine, up to the end of the pulse."""

    amplitude: float
    ratio: float
    s: float
    psi: float
    x: float
    v: float

    def state(self, tau: float) -> tuple[float, float]:
        """(x, x') a time tau later."""
        c = -self.amplitude / (1.0 + self.ratio**2)
        start, now = self.psi, self.psi + self.ratio * tau
        C = self.x - self.s - c * math.sin(start)
        D = self.v - c * self.ratio * math.cos(start)
        cosh, sinh = math.cosh(tau), math.sinh(tau)
        x = self.s + c * math.sin(now) + C * cosh + D * sinh
        return x, c * self.ratio * math.cos(now) + C * sinh + D * cosh

    def strike(self, end: float) -> float | None:
        """Time to the first root of x before the phase `end` of the sine, if there is one."""
        from scipy.optimize import brentq

        times = np.linspace(0.0, (end - self.psi) / self.ratio, POINTS + 1)
        before = 0.0
        for t in times[1:].tolist():
            if self.s * self.state(t)[0] < 0.0:
                # At the start itself x is zero too; a bracket from the first point on is empty of it.
                if before == 0.0:
                    before = t * 1e-6
                    if self.s * self.state(before)[0] <= 0.0:
                        return before
                return float(brentq(lambda tau: self.state(tau)[0], before, t, xtol=1e-15, rtol=1e-14))
            before = t
        return None


def _beyond(amplitude: float, ratio: float, e: float, pulse: Pulse) -> float:
    """By how much the block is beyond the balance after exactly one impact; -1 if it strikes never or twice."""
    psi = math.asin(1.0 / amplitude) if pulse == "sine" else 0.5 * math.pi
    end = 2.0 * math.pi if pulse == "sine" else 2.5 * math.pi
    first = _Swing(amplitude, ratio, 1.0, psi, 0.0, 0.0)
    tau = first.strike(end)
    if tau is None:
        x, v = first.state((end - psi) / ratio)
        # With x + v >= 1 it overturns without an impact; else it comes back, and 1 + E is not negative.
        return e * math.sqrt(max(0.0, 1.0 + v * v - (1.0 - x) ** 2)) - 1.0 if x + v < 1.0 else -1.0
    second = _Swing(amplitude, ratio, -1.0, psi + ratio * tau, 0.0, e * first.state(tau)[1])
    if second.strike(end) is not None:
        return -1.0
    x, v = second.state((end - second.psi) / ratio)
    return -(x + v) - 1.0


def _edge(overturns: Callable[[float], bool], inside: float, outside: float) -> float:
    """The amplitude between the two at which overturning begins or ends, by bisection to rounding."""
    while True:
        middle = 0.5 * (inside + outside)
        if middle in (inside, outside):
            return middle
        inside, outside = (middle, outside) if overturns(middle) else (inside, middle)


def one_impact_band(ratio: float, e: float, pulse: Pulse = "sine") -> Band | None:
    """Amplitudes over g alpha [1] between which one cycle overturns a block after one impact; None if nowhere.

    The block falls to the side opposite to the one that it first leans to.  Between the band and the amplitude of
    overturning without an impact it does not fall after one, though it may after two or more (Status); where there are
    several bands, this is the one of largest amplitudes.

    Args:
        ratio: angular frequency of the pulse over p [1], 0.2 or more (shorter swings than the grid's would be missed).
        e: restitution, omega after / before an impact [1], more than 0 to 1.
        pulse: "sine" or "cosine".

    Raises:
        ValueError: an argument is out of range.
    """
    positive("ratio", ratio, "1")
    within("ratio", ratio, 0.2, math.inf)
    within("e", e, 0.0, 1.0)
    if e == 0.0:
        raise ValueError(f"e={e!r}: want more than 0, for a block that an impact stops may tip anew, to either side")
    if pulse not in ("sine", "cosine"):
        raise ValueError(f"pulse={pulse!r}: want 'sine' or 'cosine'")
    top = full_sine_pulse(ratio) if pulse == "sine" else full_cosine_pulse(ratio)
    grid = np.geomspace(1.0 + 1e-6, top * (1.0 - 1e-9), AMPLITUDES).tolist()

    def overturns(amplitude: float) -> bool:
        return _beyond(amplitude, ratio, e, pulse) > 0.0

    falls = [overturns(a) for a in grid]
    if not any(falls):
        return None
    last = max(i for i, fell in enumerate(falls) if fell)
    first = last
    while first > 0 and falls[first - 1]:
        first -= 1
    low = grid[0] if first == 0 else _edge(overturns, grid[first], grid[first - 1])
    high = top if last == len(grid) - 1 else _edge(overturns, grid[last], grid[last + 1])
    return Band(low, high)
