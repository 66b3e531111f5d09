"""The antisymmetric Ricker pulse: the third derivative of a Gaussian.

    a_x(t) = (a_p/beta) (x^2 - 3) x exp(-x^2/2),   x = 2 pi (t - centre)/(sqrt(3) T_p)

beta makes a_p the largest acceleration: |x^3 - 3x| exp(-x^2/2) is largest at x^2 = 3 - sqrt(6), where it is 1.3801.

Source   Ricker (1943), Further developments in the wavelet theory of seismogram structure; in the form used for rocking
         by Vassiliou & Makris (2011), Estimating time scales and length scales in pulselike earthquake acceleration
         records with wavelet analysis, with beta = 1.38.
Status   closed form; the amplitude spectrum of the acceleration peaks at 1/T_p; velocity and displacement end at zero.
"""

from __future__ import annotations

import math
from typing import Any

from excitation.pulse import CentredPulse

BETA = math.sqrt(6.0 * (3.0 - math.sqrt(6.0))) * math.exp(-0.5 * (3.0 - math.sqrt(6.0)))
"""Largest value of |x^3 - 3 x| exp(-x^2/2)."""


def _acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z) [m/s^2] at t; par = [amplitude, omega, centre]."""
    x = par[1] * (t - par[2]) / math.sqrt(3.0)
    return par[0] / BETA * (x * x - 3.0) * x * xp.exp(-0.5 * x * x), 0.0 * t


def _displacement(xp: Any, t: Any, par: Any) -> Any:
    """x [m] at t from rest: (a_p/beta) x exp(-x^2/2)/x'^2."""
    rate = par[1] / math.sqrt(3.0)
    x = rate * (t - par[2])
    return par[0] / (BETA * rate * rate) * x * xp.exp(-0.5 * x * x)


def _snap(xp: Any, t: Any, par: Any) -> Any:
    """Second derivative of a_x [m/s^4] at t: (a_p/beta) x'^2 He_5(x) exp(-x^2/2), He_5 = x^5 - 10 x^3 + 15 x."""
    rate = par[1] / math.sqrt(3.0)
    x = rate * (t - par[2])
    return par[0] / BETA * rate * rate * ((x * x - 10.0) * x * x + 15.0) * x * xp.exp(-0.5 * x * x)


class AntisymmetricRickerPulse(CentredPulse):
    """The antisymmetric Ricker pulse.  Arguments and errors as `CentredPulse`."""

    kernel = staticmethod(_acceleration)
    displacement_kernel = staticmethod(_displacement)
    snap_kernel = staticmethod(_snap)
