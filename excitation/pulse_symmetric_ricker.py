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


class SymmetricRickerPulse(CentredPulse):
    """The symmetric Ricker pulse.  Arguments and errors as `CentredPulse`."""

    kernel = staticmethod(_acceleration)
