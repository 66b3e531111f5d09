"""The one-cosine pulse: one full cosine of acceleration, the type-B pulse of near-fault studies.

    a_x(t) = a_p cos(2 pi (t - start)/T_p),   start <= t <= start + T_p

Source   Makris & Roussos (2000), Rocking response of rigid blocks under near-source ground motions: type-B pulse.
Status   closed form; the base ends at rest where it began.
"""

from __future__ import annotations

from typing import Any

from excitation.pulse import FinitePulse, inside


def _acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z) [m/s^2] at t; par = [amplitude, omega, start, duration]."""
    return xp.where(inside(t, par), par[0] * xp.cos(par[1] * (t - par[2])), 0.0), 0.0 * t


def _displacement(xp: Any, t: Any, par: Any) -> Any:
    """x [m] at t from rest: a_p (1 - cos(omega tau))/omega^2, held after the end."""
    tau = xp.minimum(xp.maximum(t - par[2], 0.0), par[3])
    return par[0] / (par[1] * par[1]) * (1.0 - xp.cos(par[1] * tau))


class OneCosinePulse(FinitePulse):
    """One full cosine.  Arguments and errors as `FinitePulse`."""

    kernel = staticmethod(_acceleration)
    displacement_kernel = staticmethod(_displacement)
