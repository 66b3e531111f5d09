"""The Gabor pulse: a harmonic of velocity under a Gaussian.

    v(t) = A exp(-(alpha tau)^2) cos(2 pi f_p tau + nu),   tau = t - centre,   alpha = pi f_p/gamma

and a_x is its derivative.  gamma counts the oscillations under the Gaussian: at tau = gamma/(2 f_p), where the pulse of
Mavroeidis & Papageorgiou with the same gamma has ended, the Gaussian is down to exp(-pi^2/4) = 0.085.

Source   Gabor (1946), Theory of communication, part 1, the elementary signal exp(-alpha^2 tau^2) cis(2 pi f tau + nu).
         The scaling of alpha by gamma is this module's own.
Status   the integral of a_x is v to rounding; smooth everywhere.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from excitation.checks import finite, not_zero, positive
from excitation.motion import Motion


def _acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z) [m/s^2] at t; par = [velocity amplitude, omega, alpha, nu, centre]."""
    tau = t - par[4]
    envelope = par[0] * xp.exp(-par[2] * par[2] * tau * tau)
    angle = par[1] * tau + par[3]
    a_x = envelope * (-2.0 * par[2] * par[2] * tau * xp.cos(angle) - par[1] * xp.sin(angle))
    return a_x, 0.0 * t


def _snap(xp: Any, t: Any, par: Any) -> Any:
    """Second derivative of a_x [m/s^4] at t: that of v' = Re(q g), g = A exp(-(alpha tau)^2 + i angle), g' = q g."""
    tau, alpha = t - par[4], par[2]
    p = -2.0 * alpha * alpha * tau
    # q = p + i omega; v''' = Re((q^3 + 3 q q') g) with q' = -2 alpha^2.
    real = p * (p * p - 3.0 * par[1] * par[1] - 6.0 * alpha * alpha)
    imaginary = par[1] * (3.0 * p * p - par[1] * par[1] - 6.0 * alpha * alpha)
    angle = par[1] * tau + par[3]
    return par[0] * xp.exp(-alpha * alpha * tau * tau) * (real * xp.cos(angle) - imaginary * xp.sin(angle))


@dataclass(frozen=True)
class GaborPulse(Motion):
    """A velocity pulse under a Gaussian.

    Args:
        velocity: A [m/s], not zero: amplitude of the velocity pulse.
        frequency: f_p [Hz], positive.
        gamma: number of oscillations under the Gaussian, positive.
        nu: phase [rad] of the harmonic.
        centre: time of the middle [s]; 2 gamma/f_p if not given, when the Gaussian at 0 is below 1e-17.

    Raises:
        ValueError: an argument is out of the range above.
    """

    velocity: float
    frequency: float
    gamma: float
    nu: float = 0.0
    centre: float | None = None

    kernel = staticmethod(_acceleration)
    snap_kernel = staticmethod(_snap)

    def __post_init__(self) -> None:
        not_zero("velocity", self.velocity, "m/s")
        positive("frequency", self.frequency, "Hz")
        positive("gamma", self.gamma, "1")
        finite("nu", self.nu, "rad")
        if self.centre is not None:
            finite("centre", self.centre, "s")

    @property
    def middle(self) -> float:
        """Time of the middle [s]."""
        return 2.0 * self.gamma / self.frequency if self.centre is None else self.centre

    @property
    def alpha(self) -> float:
        """Rate of the Gaussian [1/s]."""
        return math.pi * self.frequency / self.gamma

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        return np.array([self.velocity, 2.0 * math.pi * self.frequency, self.alpha, self.nu, self.middle])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """None: the pulse is smooth everywhere."""
        return ()

    @property
    def max_step(self) -> float:
        return 0.05 * min(1.0, self.gamma) / self.frequency

    def base_velocity(self, t: ArrayLike) -> NDArray[np.float64]:
        """Velocity of the base [m/s] at `t` [s], any shape."""
        tau = np.asarray(t, dtype=np.float64) - self.middle
        wave = np.cos(2.0 * math.pi * self.frequency * tau + self.nu)
        return np.asarray(self.velocity * np.exp(-((self.alpha * tau) ** 2)) * wave)
