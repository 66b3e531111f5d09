"""Records made stronger or weaker: by a factor, or to a wanted peak or spectral value.

Source   plain linear scaling.
Status   everything that is linear in the record scales with it to rounding.
"""

from __future__ import annotations

from excitation.checks import not_zero, positive
from excitation.intensities import peak
from excitation.record import Record
from excitation.spectra import response_spectrum


def scaled(record: Record, factor: float) -> Record:
    """The record times a factor, not zero; negative turns it round."""
    not_zero("factor", factor, "1")
    return record.with_samples(factor * record.acceleration, note=f"scaled by {factor:.9g}")


def scaled_to(
    record: Record,
    *,
    pga: float | None = None,
    pgv: float | None = None,
    psa: float | None = None,
    period: float | None = None,
    damping: float = 0.05,
) -> Record:
    """The record scaled to one wanted value.

    Args:
        record: what to scale.
        pga: wanted largest acceleration [m/s^2].
        pgv: wanted largest velocity [m/s].
        psa: wanted pseudo-acceleration [m/s^2] of the oscillator with `period` [s] and `damping`.
        period, damping: of that oscillator.

    Raises:
        ValueError: not exactly one of pga, pgv and psa is given, it is not positive, or the record is all zeros.
    """
    wanted = {name: value for name, value in (("pga", pga), ("pgv", pgv), ("psa", psa)) if value is not None}
    if len(wanted) != 1:
        raise ValueError(f"pga={pga!r}, pgv={pgv!r}, psa={psa!r}: want exactly one of them")
    if (psa is None) != (period is None):
        raise ValueError(f"psa={psa!r}, period={period!r}: want both or neither")
    ((name, value),) = wanted.items()
    positive(name, value, "m/s" if name == "pgv" else "m/s^2")
    if name == "psa" and period is not None:
        found = float(response_spectrum(record, [period], damping).pseudo_acceleration[0])
    else:
        found = peak(record.acceleration if name == "pga" else record.velocity)
    if found == 0.0:
        raise ValueError(f"{name}: of this record is 0, want a record that moves")
    return scaled(record, value / found)
