"""What an accelerometer on a block of distinct elements reads, and the moments that are read off its vertical record.

The reading is the mean over a sample of (a - g_vector) along the block, at the middle of its top: the change of the
velocity there over the sample, gravity and the base's acceleration with it, and white noise on top.

Source   Winkler, Meguro & Yamazaki (1995), "Shaking table experiments", Figs 2 and 3
Status   against `rocking.instruments` on the same motion (tests)
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dem
from excitation.motion import Motion
from rocking.detection import Fall, Onset, detect_onset, detect_overturning
from studies.criteria.columns import Column, ColumnJob, ColumnSettings, G, history
from studies.specimens import specimen

Array = NDArray[np.float64]

SAMPLE = 1e-3
"""Time between samples [s]."""

NOISE = 0.05
"""Standard deviation of a reading [m/s^2]: of the order of a piezoelectric pickup of the time."""

AFTER_FALL = 2.0
"""Time [s] for which a record goes on after the fall."""


def vertical_reading(run: dem.AssemblyHistory, body: int, height: float, base: Motion) -> tuple[Array, Array]:
    """(times [s], reading along the block [m/s^2]) at the middle of the top of a body of this height [m]."""
    # A run ends with a sample of its own, closer to the one before.
    even = slice(None, run.time.size - (abs(np.diff(run.time[-2:])[0] - SAMPLE) > 1e-6 * SAMPLE))
    time, theta, omega, half = run.time[even], run.theta[even, body], run.omega[even, body], 0.5 * height
    u = run.vx[even, body] + omega * half * np.cos(theta)
    v = run.vz[even, body] - omega * half * np.sin(theta)
    step = np.diff(time)
    middle, tilt = 0.5 * (time[1:] + time[:-1]), 0.5 * (theta[1:] + theta[:-1])
    a_x, a_z = base(middle)
    return middle, (np.diff(u) / step + a_x) * np.sin(tilt) + (np.diff(v) / step + a_z + G) * np.cos(tilt)


def noisy(reading: Array, seed: int) -> Array:
    """The reading with white noise."""
    return reading + NOISE * np.random.default_rng(seed).standard_normal(reading.size)


def onset_record(block: int, frequency: float, settings: ColumnSettings, seed: int) -> dict[str, Any]:
    """A record of one block until well after it begins to rock, and the start that is read off it."""
    x = specimen(block)
    west = x.b / x.h * G / settings.ramp * settings.duration  # when the envelope passes (b/h) g [s]
    run = history(ColumnJob(Column(1), frequency, settings), t_end=min(settings.duration, 1.6 * west), sample=SAMPLE)
    base = settings.motion(frequency)
    t, clean = vertical_reading(run, 0, x.h, base)
    reading = noisy(clean, seed)
    found: Onset = detect_onset(t, reading, quiet=(0.0, 0.5 * west))
    theta = np.abs(run.theta[:, 0])
    corner = run.z[:, 0] - 0.5 * x.h * np.cos(theta) + 0.5 * x.b * np.sin(theta)
    lifted = np.flatnonzero(corner > 0.0)
    true = float(run.time[lifted[0]]) if lifted.size else math.nan
    return {
        "time": t, "reading": reading, "base_acceleration": base(t)[0], "true_time": true, "read_time": found.time,
        "true_amplitude": _peak(base, true), "read_amplitude": _peak(base, found.time), "threshold": found.threshold,
    }  # fmt: skip


def _peak(base: Motion, until: float) -> float:
    """Largest |a_x| [m/s^2] until a time [s]."""
    return math.nan if math.isnan(until) else float(np.abs(base(np.arange(0.0, until + SAMPLE, SAMPLE))[0]).max())


def fall_record(column: Column, frequency: float, settings: ColumnSettings, seed: int) -> dict[str, Any]:
    """A record of the upper block of a column until well after its fall, and the fall that is read off it."""
    job = ColumnJob(column, frequency, settings)
    first = history(job, sample=SAMPLE)
    true = first.overturning_time
    end = min(settings.duration, true + AFTER_FALL) if first.falls else settings.duration
    run = history(job, t_end=end, stop="never", sample=SAMPLE)
    base = settings.motion(frequency)
    t, clean = vertical_reading(run, run.theta.shape[1] - 1, specimen(settings.block).h, base)
    reading = noisy(clean, seed)
    x = specimen(settings.block)
    west = x.b / x.h / column.count * G / settings.ramp * settings.duration
    found: Fall = detect_overturning(t, reading, quiet=(0.0, 0.8 * west), a_x=base(t)[0])
    envelope = [float(base.envelope(moment)) if not math.isnan(moment) else math.nan for moment in (true, found.time)]
    return {
        "time": t, "reading": reading, "base_acceleration": base(t)[0], "true_time": true, "read_time": found.time,
        "true_amplitude": envelope[0], "read_amplitude": envelope[1],
    }  # fmt: skip
