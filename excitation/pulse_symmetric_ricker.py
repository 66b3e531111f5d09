"""The symmetric Ricker pulse: the second derivative of a Gaussian.

    a_x(t) = a_p (1 - x^2) exp(-x^2/2),   x = sqrt(2) pi (t - centre)/T_p

Source   Ricker (1943), Further developments in the wavelet theory of seismogram structure; in the form used for rocking
         by Vassiliou & Makris (2011), Estimating time scales and length scales in pulselike earthquake acceleration
         records with wavelet analysis.
Status   closed form; the amplitude spectrum of the acceleration peaks at 1/T_p; velocity and displacement end at zero.
"""

from __future__ import annotations

import math
from typing import Any

from excitation.pulse import CentredPulse


def _acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z) [m/s^2] at t; par = [amplitude, omega, centre]."""
    x = par[1] * (t - par[2]) / math.sqrt(2.0)
    return par[0] * (1.0 - x * x) * xp.exp(-0.5 * x * x), 0.0 * t


def _displacement(xp: Any, t: Any, par: Any) -> Any:
    """x [m] at t from rest: -a_p exp(-x^2/2)/x'^2."""
    rate = par[1] / math.sqrt(2.0)
    x = rate * (t - par[2])
    return -par[0] / (rate * rate) * xp.exp(-0.5 * x * x)


def _snap(xp: Any, t: Any, par: Any) -> Any:
    """Second derivative of a_x [m/s^4] at t: -a_p x'^2 He_4(x) exp(-x^2/2), He_4 = x^4 - 6 x^2 + 3."""
    rate = par[1] / math.sqrt(2.0)
    x = rate * (t - par[2])
    return -par[0] * rate * rate * ((x * x - 6.0) * x * x + 3.0) * xp.exp(-0.5 * x * x)


class SymmetricRickerPulse(CentredPulse):
    """The symmetric Ricker pulse.  Arguments and errors as `CentredPulse`."""

    kernel = staticmethod(_acceleration)
    displacement_kernel = staticmethod(_displacement)
    snap_kernel = staticmethod(_snap)
