"""The one-sine pulse: one full sine of acceleration, the type-A pulse of near-fault studies.

    a_x(t) = a_p sin(2 pi (t - start)/T_p),   start <= t <= start + T_p

Source   Makris & Roussos (2000), Rocking response of rigid blocks under near-source ground motions: type-A pulse.
Status   closed form; the base ends at rest, displaced by a_p T_p^2/(2 pi).
"""

from __future__ import annotations

from typing import Any

from excitation.pulse import FinitePulse, inside


def _acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z) [m/s^2] at t; par = [amplitude, omega, start, duration]."""
    return xp.where(inside(t, par), par[0] * xp.sin(par[1] * (t - par[2])), 0.0), 0.0 * t


def _displacement(xp: Any, t: Any, par: Any) -> Any:
    """x [m] at t from rest: a_p (tau/omega - sin(omega tau)/omega^2), held after the end."""
    tau = xp.minimum(xp.maximum(t - par[2], 0.0), par[3])
    return par[0] / par[1] * (tau - xp.sin(par[1] * tau) / par[1])


class OneSinePulse(FinitePulse):
    """One full sine.  Arguments and errors as `FinitePulse`."""

    kernel = staticmethod(_acceleration)
    displacement_kernel = staticmethod(_displacement)
