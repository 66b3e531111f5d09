"""The half-sine pulse: the positive half of one sine of acceleration.

    a_x(t) = a_p sin(2 pi (t - start)/T_p),   start <= t <= start + T_p/2

Source   Housner (1963), The behavior of inverted pendulum structures during earthquakes.
Status   closed form; leaves the base with the velocity a_p T_p/pi.
"""

from __future__ import annotations

from typing import Any

from excitation.pulse import FinitePulse, inside


def _acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z) [m/s^2] at t; par = [amplitude, omega, start, duration]."""
    return xp.where(inside(t, par), par[0] * xp.sin(par[1] * (t - par[2])), 0.0), 0.0 * t


class HalfSinePulse(FinitePulse):
    """Half of a sine; `period` is that of the whole sine.  Arguments and errors as `FinitePulse`."""

    kernel = staticmethod(_acceleration)

    @property
    def duration(self) -> float:
        """Time [s] from start to end: half a period."""
        return 0.5 * self.period
