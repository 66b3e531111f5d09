"""Band-pass filtering of records, without phase shift.

A Butterworth filter is run forwards and backwards over the record between zeros, so that what it spreads before the
first and after the last sample is not cut off.

Source   Boore & Bommer (2005), Processing of strong-motion accelerograms: needs, options and consequences; the length
         of the zero pads, 1.5 n/f_c for n poles and the low corner f_c, is that of Converse & Brady (1992), BAP.
         Filters are those of scipy.signal.
Status   two passes square the response of one: at a corner half of the amplitude is left.  Stripping the pads spoils
         displacements (Boore, Sisi & Akkar 2012): keep them where displacements matter.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from excitation.checks import not_negative, real, whole
from excitation.record import Record

MOST_PAD = 100_000_000
"""Samples of the zeros before and after: 800 MB."""


def band_passed(
    record: Record,
    low: float | None,
    high: float | None,
    *,
    order: int = 4,
    taper: float = 0.0,
    keep_padding: bool = False,
) -> Record:
    """The record between two corner frequencies, not shifted in time.

    Args:
        record: what to filter.
        low: low corner [Hz]; None lets everything below through.
        high: high corner [Hz], below half the sampling rate; None lets everything above through.
        order: of the Butterworth filter of one pass, 1 to 12; two passes double it.
        taper: length [s] of a cosine taper at each end before padding.
        keep_padding: whether the zeros' stretches before and after stay in the record, which then begins earlier,
            at a time that it does not state.

    Raises:
        ValueError: no corner is given, they are out of range or order, or the taper is longer than half the record.
    """
    from scipy.signal import butter, sosfiltfilt

    nyquist = 0.5 / record.time_step
    for name, corner in (("low", low), ("high", high)):
        if corner is not None and not 0.0 < real(corner) < nyquist:
            raise ValueError(f"{name}={corner!r} Hz: want above 0 and below half the sampling rate, {nyquist:g} Hz")
    if low is None and high is None:
        raise ValueError("low=None, high=None: want one corner frequency or both")
    if low is not None and high is not None and low >= high:
        raise ValueError(f"low={low!r} Hz: want below high={high!r} Hz")
    order = whole("order", order, 1, 12)
    kind = "bandpass" if low is not None and high is not None else ("highpass" if high is None else "lowpass")
    corners = [c for c in (low, high) if c is not None]
    sections = butter(order, corners if len(corners) > 1 else corners[0], kind, fs=1.0 / record.time_step, output="sos")
    # Two passes have 2 n poles; each pad is 1.5 n/f_c long for them, and at least ten samples.
    pad = max(10, int(np.ceil(1.5 * 2 * order / corners[0] / record.time_step)))
    if pad > MOST_PAD:
        raise ValueError(f"low={low!r}, high={high!r} Hz: take pads of {pad} samples, want at most {MOST_PAD}")
    tapered = record.acceleration * end_taper(record, taper)
    padded = np.concatenate([np.zeros(pad), tapered, np.zeros(pad)])
    filtered = sosfiltfilt(sections, padded, padtype=None)
    kept = filtered if keep_padding else filtered[pad:-pad]
    note = (
        f"Butterworth {kind} {'-'.join(f'{c:g}' for c in corners)} Hz, order {order}, two passes, pads of {pad} samples"
    )
    found = record.with_samples(kept, note=note + (" kept" if keep_padding else " removed"))
    return replace(found, start_time="") if keep_padding else found


def end_taper(record: Record, length: float, name: str = "taper") -> np.ndarray:
    """Factors that rise in the first and fall in the last `length` [s] by half a cosine wave, shape (time,)."""
    from scipy.signal.windows import tukey

    not_negative(name, length, "s")
    if length > 0.5 * record.duration:
        raise ValueError(f"{name}={length!r} s: want at most half of the record, {0.5 * record.duration:g} s")
    return np.asarray(tukey(record.acceleration.size, 2.0 * length / record.duration))


def tapered(record: Record, length: float) -> Record:
    """The record with both ends brought to zero over `length` [s] by half a cosine wave; ValueError if too long."""
    return record.with_samples(record.acceleration * end_taper(record, length, "length"), note=f"taper of {length:g} s")
