"""The near-fault pulse of Mavroeidis & Papageorgiou: a harmonic of velocity under a raised cosine.

    v(t) = A/2 [1 + cos(2 pi f_p tau/gamma)] cos(2 pi f_p tau + nu),   |tau| <= gamma/(2 f_p),   tau = t - centre

and a_x is its derivative; the displacement it leaves is zero for some phases only.

Source   Mavroeidis & Papageorgiou (2003), A mathematical representation of near-fault ground motions, for the velocity;
         the acceleration is its derivative, taken here.
Status   the integral of a_x is v to rounding; gamma must exceed 1 as in the paper.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from excitation.checks import finite, not_zero, positive, real
from excitation.motion import Motion


def _acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z) [m/s^2] at t; par = [velocity amplitude, omega, omega of the envelope, nu, centre, half length]."""
    tau = t - par[4]
    envelope = 0.5 * (1.0 + xp.cos(par[2] * tau))
    slope = -0.5 * par[2] * xp.sin(par[2] * tau)
    angle = par[1] * tau + par[3]
    a_x = par[0] * (slope * xp.cos(angle) - envelope * par[1] * xp.sin(angle))
    return xp.where((tau >= -par[5]) & (tau <= par[5]), a_x, 0.0), 0.0 * t


def _travel(xp: Any, tau: Any, par: Any) -> Any:
    """Integral of v [m] up to a constant: the product of cosines is a sum of three."""
    slow, fast = par[1] - par[2], par[1] + par[2]
    sides = xp.sin(fast * tau + par[3]) / fast + xp.sin(slow * tau + par[3]) / slow
    return 0.5 * par[0] * (xp.sin(par[1] * tau + par[3]) / par[1] + 0.5 * sides)


def _displacement(xp: Any, t: Any, par: Any) -> Any:
    """x [m] at t from rest, held after the end."""
    tau = xp.minimum(xp.maximum(t - par[4], -par[5]), par[5])
    return _travel(xp, tau, par) - _travel(xp, -par[5], par)


@dataclass(frozen=True)
class MavroeidisPapageorgiouPulse(Motion):
    """The near-fault velocity pulse of Mavroeidis & Papageorgiou (2003).

    Args:
        velocity: A [m/s], not zero: amplitude of the velocity pulse.
        frequency: f_p [Hz], positive: the prevailing frequency.
        gamma: number of oscillations, above 1.
        nu: phase [rad] of the harmonic; 0 is symmetric in velocity, pi/2 antisymmetric.
        centre: time of the middle [s]; gamma/(2 f_p) if not given, when the pulse begins at 0.

    Raises:
        ValueError: an argument is out of the range above.
    """

    velocity: float
    frequency: float
    gamma: float
    nu: float = 0.0
    centre: float | None = None

    kernel = staticmethod(_acceleration)
    displacement_kernel = staticmethod(_displacement)

    def __post_init__(self) -> None:
        not_zero("velocity", self.velocity, "m/s")
        positive("frequency", self.frequency, "Hz")
        if not (math.isfinite(real(self.gamma)) and self.gamma > 1.0):
            raise ValueError(f"gamma={self.gamma!r}: want a number above 1")
        finite("nu", self.nu, "rad")
        if self.centre is not None:
            finite("centre", self.centre, "s")

    @property
    def half_length(self) -> float:
        """Half of the duration [s]."""
        return 0.5 * self.gamma / self.frequency

    @property
    def middle(self) -> float:
        """Time of the middle [s]."""
        return self.half_length if self.centre is None else self.centre

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        omega = 2.0 * math.pi * self.frequency
        return np.array([self.velocity, omega, omega / self.gamma, self.nu, self.middle, self.half_length])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return (self.middle - self.half_length, self.middle + self.half_length)

    @property
    def max_step(self) -> float:
        return 0.05 / self.frequency

    def base_velocity(self, t: ArrayLike) -> NDArray[np.float64]:
        """Velocity of the base [m/s] at `t` [s], any shape."""
        tau = np.asarray(t, dtype=np.float64) - self.middle
        omega = 2.0 * math.pi * self.frequency
        v = 0.5 * self.velocity * (1.0 + np.cos(omega / self.gamma * tau)) * np.cos(omega * tau + self.nu)
        return np.where(np.abs(tau) <= self.half_length, v, 0.0)
