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


class OneCosinePulse(FinitePulse):
    """One full cosine.  Arguments and errors as `FinitePulse`."""

    kernel = staticmethod(_acceleration)
