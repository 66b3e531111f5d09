"""Baseline correction: taking out the slow drift that turns integrals of a record into nonsense.

Source   the polynomial fits in common use (Chiu 1997, Stable baseline correction of digital strong-motion data; Boore
         2001, Effect of baseline corrections on displacements and response spectra for several recordings of the 1999
         Chi-Chi, Taiwan, earthquake); "velocity" fits v(t) with v(0) = 0 and takes the fit's derivative off the
         acceleration.
Status   a polynomial drift of the fitted order is removed to rounding.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from excitation.checks import whole
from excitation.record import Record

METHODS = ("acceleration", "velocity")
MAX_ORDER = 6


def baseline_corrected(record: Record, order: int = 1, method: str = "velocity") -> Record:
    """The record without its drift.

    Args:
        record: what to correct.
        order: of the polynomial in the acceleration: 0 a constant, 1 a line, up to 6.
        method: "acceleration" fits the acceleration, "velocity" its integral, which weighs slow drift more.

    Raises:
        ValueError: the order or method is none of these, or the record has too few samples for the fit.
    """
    order = whole("order", order, 0, MAX_ORDER)
    if method not in METHODS:
        raise ValueError(f"method={method!r}: want one of {', '.join(METHODS)}")
    if record.acceleration.size < order + 3:
        raise ValueError(f"acceleration: has {record.acceleration.size} samples, want {order + 3} or more")
    # Powers of a time from 0 to 1 keep the fit well conditioned.
    tau = np.linspace(0.0, 1.0, record.acceleration.size)
    powers = np.vander(tau, order + 1, increasing=True)
    if method == "acceleration":
        drift = powers @ _fit(powers, record.acceleration)
    else:
        length = record.duration
        integrals = length * np.column_stack([tau ** (k + 1) / (k + 1) for k in range(order + 1)])
        drift = powers @ _fit(integrals, record.velocity)
    return record.with_samples(record.acceleration - drift, note=f"baseline: order {order} fitted to {method}")


def _fit(columns: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.linalg.lstsq(columns, values, rcond=None)[0])
