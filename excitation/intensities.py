"""Measures of how strong a record is.

    Arias    pi/(2 g) integral a^2 dt [m/s]
    CAV      integral |a| dt [m/s]
    D(5-95)  time between 5 and 95 % of the Arias intensity [s]

Source   Arias (1970), A measure of earthquake intensity; Trifunac & Brady (1975), A study on the duration of strong
         earthquake ground motion; EPRI (1988), A criterion for determining exceedance of the operating basis
         earthquake, NP-5930 (CAV).
Status   integrals by the trapezium rule, as in the definitions' sampled forms; agrees with eqsig.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from excitation.record import Record
from excitation.units import STANDARD_GRAVITY


class Intensity(NamedTuple):
    """Measures of one record."""

    pga: float  # largest acceleration [m/s^2]
    pgv: float  # largest velocity [m/s]
    pgd: float  # largest displacement [m]
    arias: float  # [m/s]
    cav: float  # cumulative absolute velocity [m/s]
    significant_duration: float  # 5-95 % of the Arias intensity [s]

    def __repr__(self) -> str:
        return (
            f"<Intensity: PGA {self.pga:.4g} m/s^2, PGV {self.pgv:.4g} m/s, PGD {self.pgd:.4g} m, "
            f"Arias {self.arias:.4g} m/s, CAV {self.cav:.4g} m/s, D5-95 {self.significant_duration:.4g} s>"
        )


def _growth(values: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    """Running integral by the trapezium rule, 0 at first."""
    return np.concatenate([[0.0], np.cumsum(0.5 * step * (values[1:] + values[:-1]))])


def peak(values: NDArray[np.float64]) -> float:
    """Largest absolute value."""
    return float(np.max(np.abs(values)))


def arias(record: Record) -> float:
    """Arias intensity [m/s]."""
    return float(0.5 * np.pi / STANDARD_GRAVITY * _growth(record.acceleration**2, record.time_step)[-1])


def cumulative_absolute_velocity(record: Record) -> float:
    """CAV [m/s]."""
    return float(_growth(np.abs(record.acceleration), record.time_step)[-1])


def significant_duration(record: Record, low: float = 0.05, high: float = 0.95) -> float:
    """Time [s] between two shares of the Arias intensity; 0 for a record of zeros.

    Raises ValueError unless 0 <= low < high <= 1.
    """
    if not 0.0 <= low < high <= 1.0:
        raise ValueError(f"low={low!r}, high={high!r}: want 0 <= low < high <= 1")
    energy = _growth(record.acceleration**2, record.time_step)
    if energy[-1] == 0.0:
        return 0.0
    share = energy / energy[-1]
    # Within a step the share is taken to grow evenly.  Where it stands still at one of them, the shorter time counts.
    after = np.array([np.searchsorted(share, low, side="right"), np.searchsorted(share, high, side="left")])
    before = after - 1
    within = (np.array([low, high]) - share[before]) / (share[after] - share[before])
    first, last = record.times[before] + within * record.time_step
    return float(last - first)


def intensity(record: Record) -> Intensity:
    """All measures of a record; velocity and displacement are those of the record as it is, drift and all."""
    return Intensity(
        peak(record.acceleration),
        peak(record.velocity),
        peak(record.displacement),
        arias(record),
        cumulative_absolute_velocity(record),
        significant_duration(record),
    )
