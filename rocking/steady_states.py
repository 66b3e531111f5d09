"""Steady rocking of the linear block under a sine of constant amplitude, in closed form: where, how far, and if stable.

With tau = p t, x = theta/alpha, w = omega_forcing/p and A the amplitude over g alpha, the linear Method 1 is

    x'' = x - s - A sin(w tau + phi),      x' -> e x', s -> -s   where x = 0.

The symmetric orbit of order n (odd) strikes twice in n periods of the base, and its second half mirrors the first:
x(tau + T) = -x(tau), T = n pi/w.  It starts at an impact with speed v; x(T) = 0 and e x'(T) = -v leave

    k w cos(phi) = P v - tanh(T/2),   k sin(phi) = -Q tanh(T/2) v,   k = A/(1 + w^2),
    P = (1 + e)/(2 e),  Q = (1 - e)/(2 e),

hence one quadratic equation in v, with two orbits, one, or none.  The map from one impact to the next, (time, speed)
to (time, speed after it, mirrored), has determinant e^2 and trace

    tr = -2 e cosh T - e (1 - e)(1 + w^2) Q tanh(T/2) sinh T + e (1 + e) sinh(T)/v,

and the orbit is stable when |tr| < 1 + e^2.  At tr = 1 + e^2 the two orbits meet and vanish, at tr = -(1 + e^2) the
orbit loses its symmetry.

Source   Spanos & Koh (1984), J. Eng. Mech. 110, 1627-1642: steady states of the linear block, their amplitudes and
         stability; Hogan (1989), Proc. R. Soc. London A 425, 441-476: symmetric orbits (1, n), n odd, and the e^2.
         The two equations and the map above are derived here.
Status   symmetric orbits only; where one has lost its symmetry, become chaotic or strikes more often, nothing is said.
         The equation is linear: a peak beyond alpha is an orbit of the equation, not of a real block.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rocking.method1 import Method1
from rocking.validation import positive, real

LONGEST = 300.0
"""Largest T = n pi/w: beyond it exp(2 T) would overflow."""

POINTS_PER_PERIOD = 512
"""Points of a period of the base at which an orbit is looked at; extremes between them are located."""


@dataclass(frozen=True)
class SteadyState:
    """One symmetric orbit, from an impact on; the block leans to +x in the first half."""

    order: int  # n: periods of the base in one of the response
    restitution: float  # e [1]
    velocity: float  # v = omega/(p alpha) just after an impact [1]
    phase: float  # phi: phase of the base's sine at that impact [rad], -pi to pi
    peak: float  # largest |theta|/alpha [1]
    admissible: bool  # x > 0 between the impacts; if not, the block would strike earlier
    half_map: NDArray[np.float64]  # d(time, speed of the next impact)/d(time, speed of this one), shape (2, 2)

    @property
    def multipliers(self) -> NDArray[np.complex128]:
        """Floquet multipliers of the whole orbit, shape (2,): squares of the eigenvalues of `half_map`."""
        return np.asarray(np.linalg.eigvals(self.half_map).astype(complex) ** 2)

    @property
    def stable(self) -> bool:
        """Whether a small disturbance dies away; without loss, e = 1, none does."""
        return self.restitution < 1.0 and bool(np.all(np.abs(self.multipliers) < 1.0))


def _check(ratio: float, e: float, n: int) -> None:
    positive("ratio", ratio, "1")
    if not 0.0 < real(e) <= 1.0:
        raise ValueError(f"e={e!r}: want above 0 to 1")
    if not (real(n) >= 1.0 and real(n) % 2.0 == 1.0):
        raise ValueError(f"n={n!r}: want an odd number of periods, 1 or more (an even one leaves no symmetric orbit)")
    if n * math.pi / ratio > LONGEST:
        raise ValueError(f"ratio={ratio!r}: want at least n pi/{LONGEST:g}={n * math.pi / LONGEST:.3g}")


def _constants(ratio: float, e: float, n: int) -> tuple[float, float, float]:
    """(P, Q tanh(T/2), tanh(T/2)) of the two equations."""
    half = math.tanh(0.5 * n * math.pi / ratio)
    return 0.5 * (1.0 + e) / e, 0.5 * (1.0 - e) / e * half, half


def stable_range(ratio: float, e: float, n: int = 1) -> tuple[float, float]:
    """Amplitudes over g alpha [1] of a stable symmetric orbit of order n (where it is admissible), from low to high.

        low:  (1 + w^2) Q tanh^2(T/2) / sqrt(P^2 + (w Q tanh(T/2))^2), where the two orbits meet; none below it
        high: where tr = -(1 + e^2); inf if that never comes

    With e near 1 and n = 1 the lower end is below the g alpha that starts rocking: between the two a block at rest
    stays at rest, and one that rocks goes on.  With e = 1 no disturbance dies; within the range none grows either.

    Args:
        ratio: w, angular frequency of the base over p [1].
        e: restitution, omega after / before an impact [1], above 0 to 1.
        n: periods of the base in one of the response, odd.

    Raises:
        ValueError: an argument is out of range.
    """
    _check(ratio, e, n)
    P, Q, half = _constants(ratio, e, n)
    T, forced = n * math.pi / ratio, 1.0 + ratio**2
    low = forced * Q * half / math.hypot(P, ratio * Q)
    # tr = -(1 + e^2), divided by e cosh T.
    gap = 2.0 + (1.0 - e) * forced * Q * math.tanh(T) - (1.0 + e * e) / (e * math.cosh(T))
    if gap <= 0.0:
        return low, math.inf
    v = (1.0 + e) * math.tanh(T) / gap
    return low, max(low, forced * math.hypot((P * v - half) / ratio, Q * v))


def steady_states(ratio: float, amplitude: float, e: float, n: int = 1) -> tuple[SteadyState, ...]:
    """The symmetric orbits of order n, the larger one first; none, one or two.

    Args:
        ratio: w, angular frequency of the base over p [1].
        amplitude: A, amplitude of the base over g alpha [1].
        e: restitution [1], above 0 to 1.
        n: periods of the base in one of the response, odd.

    Raises:
        ValueError: an argument is out of range.
    """
    _check(ratio, e, n)
    positive("amplitude", amplitude, "1")
    P, Q, half = _constants(ratio, e, n)
    k = amplitude / (1.0 + ratio**2)
    # (P v - half)^2/w^2 + (Q v)^2 = k^2, written as a v^2 - 2 b v + c = 0.
    a, b, c = P * P + (ratio * Q) ** 2, P * half, half * half - (ratio * k) ** 2
    rest = b * b - a * c
    if rest < 0.0:
        return ()
    large = (b + math.sqrt(rest)) / a
    # The small root by the product of the two: no digits are lost where it is near zero.
    speeds = [large] if rest == 0.0 or c <= 0.0 else [large, c / (a * large)]
    return tuple(_orbit(ratio, amplitude, e, n, v, math.atan2(-Q * v * ratio, P * v - half)) for v in speeds if v > 0.0)


def _orbit(ratio: float, amplitude: float, e: float, n: int, v: float, phase: float) -> SteadyState:
    """The orbit that leaves an impact with v at the phase."""
    lowest, peak = _extremes(ratio, amplitude, n, v, phase)
    return SteadyState(n, e, v, phase, peak, lowest > 0.0, _half_map(ratio, amplitude, e, n, v, phase))


def _half_map(ratio: float, amplitude: float, e: float, n: int, v: float, phase: float) -> NDArray[np.float64]:
    """Derivative of the next impact's (time, mirrored speed after it) by this one's."""
    T = n * math.pi / ratio
    push = amplitude * math.sin(phase)
    leaving, arriving = -1.0 - push, -1.0 + push  # x'' just after the one and just before the other
    # An impact later by dt is one on time with x = -v dt, x' = -x'' dt.
    start = np.array([[-v, 0.0], [-leaving, 1.0]])
    flow = np.array([[math.cosh(T), math.sinh(T)], [math.sinh(T), math.cosh(T)]])
    # x(T) = dx moves the strike by -dx/x'(T), and x' by x'' times that; the speed after is -e x'.
    end = np.array([[e / v, 0.0], [-e * arriving * e / v, -e]])
    return np.asarray(end @ flow @ start)


def _extremes(ratio: float, amplitude: float, n: int, v: float, phase: float) -> tuple[float, float]:
    """Least and largest x strictly within the half orbit."""
    from scipy.optimize import minimize_scalar

    T = n * math.pi / ratio
    k = amplitude / (1.0 + ratio**2)
    # x = 1 + k sin(w tau + phi) + c exp(tau - T) + d exp(-tau), with x(0) = x(T) = 0 and no overflow.
    at_0, at_T = 1.0 + k * math.sin(phase), 1.0 - k * math.sin(phase)
    shrink = math.exp(-T)
    d = -(at_0 - at_T * shrink) / (1.0 - shrink * shrink)
    c = -(at_T - at_0 * shrink) / (1.0 - shrink * shrink)

    def x(tau: float) -> float:
        return 1.0 + k * math.sin(ratio * tau + phase) + c * math.exp(tau - T) + d * math.exp(-tau)

    grid = np.linspace(0.0, T, n * POINTS_PER_PERIOD // 2 + 1)
    values = np.array([x(float(tau)) for tau in grid])

    def extreme(i: int, sign: float) -> float:
        bounds = (float(grid[max(i - 1, 0)]), float(grid[min(i + 1, grid.size - 1)]))
        return float(x(minimize_scalar(lambda tau: sign * x(tau), bounds=bounds, method="bounded").x))

    inner = values[1:-1]
    dips = [i for i in range(1, grid.size - 1) if values[i] < values[i - 1] and values[i] <= values[i + 1]]
    lowest = min([float(inner.min()), *(extreme(i, 1.0) for i in dips)])
    return lowest, extreme(int(values.argmax()), -1.0)


def start(orbit: SteadyState, system: Method1) -> tuple[float, float]:
    """(phase of the base's sine [rad], omega [rad/s]) with which a run at `theta` = 0 starts on the orbit.

    Raises:
        ValueError: the system is not the linear Method 1, to which the orbit belongs.
    """
    if system.form != "linear":
        raise ValueError(f"form={system.form!r}: want 'linear', whose orbits have a closed form")
    return orbit.phase, orbit.velocity * system.block.alpha * system.block.p(system.g)
