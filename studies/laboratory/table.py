"""How the table moves, and what a frame fixed to it feels.

A motion is a displacement: a sum of sines in an envelope of class C4, so that acceleration and its second derivative
(which a pitching table turns into torque) are exact and the table starts and stops at rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb, inf, isinf, pi

import numpy as np
from scipy.interpolate import CubicSpline

Array = np.ndarray
# The polynomial of degree 9 from 0 to 1 whose first four derivatives vanish at both ends.
_RISE = np.polynomial.Polynomial([0, 0, 0, 0, 0, 126, -420, 540, -315, 70])
LOW_PASS = 25.0  # Hz, for the second derivative of a noisy record
HIGH_PASS = 0.15  # Hz, for the displacement of a noisy record


@dataclass(frozen=True)
class Motion:
    """Displacement [m] of the table: amplitude sin(2 pi frequency t + phase), summed, in an envelope."""

    frequency: Array
    amplitude: Array
    phase: Array
    start: float
    rise: float
    hold: float
    fall: float

    @property
    def end(self) -> float:
        """When it is at rest again [s]."""
        return self.start + self.rise + self.hold + self.fall

    def _envelope(self, order: int, t: Array) -> Array:
        piece = _RISE.deriv(order) if order else _RISE
        up = np.clip((t - self.start) / self.rise, 0.0, 1.0)
        down = np.clip((self.end - t) / self.fall, 0.0, 1.0)
        rising = t < self.start + self.rise
        if order == 0:
            return np.where(rising, piece(up), piece(down))
        inside_up = rising & (t > self.start)
        inside_down = (t > self.end - self.fall) & (t < self.end)
        sign = (-1.0) ** order
        return np.where(inside_up, piece(up) / self.rise**order, 0.0) + np.where(
            inside_down, sign * piece(down) / self.fall**order, 0.0
        )

    def derivative(self, order: int, t: Array) -> Array:
        """Derivative of the displacement: 0 gives m, 2 the acceleration in m/s^2, 4 its second derivative."""
        total = np.zeros_like(t)
        omega = 2 * pi * self.frequency
        for k in range(order + 1):
            arg = np.outer(t, omega) + self.phase + 0.5 * pi * k
            total += comb(order, k) * self._envelope(order - k, t) * (np.sin(arg) @ (self.amplitude * omega**k))
        return total

    def scaled(self, factor: float) -> Motion:
        """The same motion, larger."""
        return Motion(self.frequency, self.amplitude * factor, self.phase, self.start, self.rise, self.hold, self.fall)


def ramp(rng: np.random.Generator, frequency: float, peak: float) -> Motion:
    """A sinusoid that grows slowly to an acceleration of `peak` [m/s^2] and stops."""
    cycles = rng.uniform(12.0, 20.0)
    amplitude = np.array([peak / (2 * pi * frequency) ** 2])
    phase = rng.uniform(0.0, 2 * pi, 1)
    return Motion(np.array([frequency]), amplitude, phase, rng.uniform(0.3, 0.6), cycles / frequency, 0.4, 0.6)


def quake(rng: np.random.Generator, peak: float) -> Motion:
    """Noise of 0.6 to 7 Hz in an envelope, with a largest acceleration of `peak` [m/s^2]."""
    frequency = np.sort(rng.uniform(0.6, 7.0, 45))
    # Acceleration falls off above a corner, as strong motion does.
    level = rng.rayleigh(1.0, 45) / (1.0 + (frequency / rng.uniform(2.0, 4.0)) ** 2)
    raw = Motion(
        frequency, level / (2 * pi * frequency) ** 2, rng.uniform(0, 2 * pi, 45),
        rng.uniform(0.3, 0.6), rng.uniform(1.2, 2.0), rng.uniform(1.5, 3.0), rng.uniform(2.0, 4.0),
    )  # fmt: skip
    t = np.arange(0.0, raw.end, 0.004)
    return raw.scaled(peak / np.abs(raw.derivative(2, t)).max())


def second_harmonic(ax: Array, phase: float) -> Array:
    """A cos(2 phi + phase) for the analytic signal A exp(i phi) of a record."""
    n = ax.size
    spectrum = np.fft.fft(ax)
    spectrum[1 : (n + 1) // 2] *= 2.0
    spectrum[n // 2 + 1 :] = 0.0
    spectrum[0] = 0.0
    z = np.fft.ifft(spectrum)
    size = np.abs(z)
    return np.real(z * z * np.exp(1j * phase)) / np.maximum(size, 1e-9 * max(1e-12, size.max()))


@dataclass(frozen=True)
class Table:
    """What the table does besides moving along x: pitch and heave, each a multiple of the motion along x.

    And a plate on springs between the table and the block, which gives along x; and what the air does to the block,
    which for a force on the whole of it is an acceleration of the table that nobody records.
    """

    pitch_acceleration: float = 0.0  # rad/(m/s^2)
    pitch_displacement: float = 0.0  # rad/m
    vertical: float = 0.0
    vertical_second: float = 0.0
    vertical_phase: float = 0.0  # of the second harmonic, rad
    plate_frequency: float = inf  # Hz
    plate_damping: float = 0.05  # over critical
    gusts: tuple[tuple[float, float, float], ...] = ()  # (middle [s], acceleration [m/s^2], width [s]) of each

    def on_top(self, ax: Array, h: float) -> Array:
        """Acceleration [m/s^2] that the block feels for that of the table, from rest; nodes at `h` [s]."""
        return self._on_plate(ax, h) - self._blown(h * np.arange(ax.size))

    def _blown(self, t: Array) -> Array:
        total = np.zeros_like(t)
        for middle, size, width in self.gusts:
            total += size * np.exp(-0.5 * ((t - middle) / width) ** 2)
        return total

    def _on_plate(self, ax: Array, h: float) -> Array:
        if isinf(self.plate_frequency):
            return ax
        pad = 4 * ax.size  # until the plate has come to rest again
        spectrum = np.fft.rfft(np.concatenate([ax, np.zeros(pad)]))
        r = np.fft.rfftfreq(ax.size + pad, h) / self.plate_frequency
        lag = 2j * self.plate_damping * r
        return np.fft.irfft(spectrum * (1.0 + lag) / (1.0 - r**2 + lag), ax.size + pad)[: ax.size]


def _filtered(ax: Array, h: float, power: int) -> Array:
    """Derivative (power > 0) or integral of a record, in the frequency domain, smooth cut-offs at both ends."""
    pad = ax.size // 2
    spectrum = np.fft.rfft(np.concatenate([np.zeros(pad), ax - ax.mean(), np.zeros(pad)]))
    f = np.fft.rfftfreq(ax.size + 2 * pad, h)
    factor = np.zeros_like(f, dtype=complex)
    factor[1:] = (2j * pi * f[1:]) ** power
    taper = 1.0 / (1.0 + (f / LOW_PASS) ** 8) if power > 0 else (f / HIGH_PASS) ** 6 / (1.0 + (f / HIGH_PASS) ** 6)
    return np.fft.irfft(spectrum * factor * taper, ax.size + 2 * pad)[pad : pad + ax.size]


def pieces(h: float, ax: Array, az: Array, pitch: tuple[Array, Array, Array]) -> Array:
    """Cubic pieces of (a_x, a_z, pitch, its rate, its acceleration), shape (n - 1, 5, 4), lowest power first."""
    t = h * np.arange(ax.size)
    columns = np.stack([ax, az, *pitch], axis=1)
    c = CubicSpline(t, columns, axis=0).c  # (4, n - 1, 5), highest power first
    return np.ascontiguousarray(np.transpose(c[::-1], (1, 2, 0)))


def felt_by_motion(motion: Motion | None, h: float, n: int, table: Table) -> Array:
    """Pieces for the true motion, `n` nodes at `h` [s]; a table at rest if there is no motion."""
    if motion is None:
        zero = np.zeros(n)
        return pieces(h, table.on_top(zero, h), zero, (zero, zero, zero))
    t = h * np.arange(n)
    ax = motion.derivative(2, t)
    a, p = table.pitch_acceleration, table.pitch_displacement
    az = table.vertical * ax
    if table.vertical_second:
        az = az + table.vertical_second * second_harmonic(ax, table.vertical_phase)
    turn = [np.zeros(n)] * 3
    if a or p:
        d = [motion.derivative(k, t) for k in range(5)]
        turn = [p * d[k] + a * d[k + 2] for k in range(3)]
    return pieces(h, table.on_top(ax, h), az, (turn[0], turn[1], turn[2]))


def felt_by_record(h: float, ax: Array, az: Array | None, table: Table) -> Array:
    """Pieces for a record already brought to nodes at `h` [s]; heave follows from it where none was measured."""
    a, p = table.pitch_acceleration, table.pitch_displacement
    zero = np.zeros_like(ax)
    heave = table.vertical * ax if az is None else az
    if az is None and table.vertical_second:
        heave = heave + table.vertical_second * second_harmonic(ax, table.vertical_phase)
    angle, rate, acceleration = zero, zero, zero
    if a:
        angle, rate, acceleration = a * ax, a * _filtered(ax, h, 1), a * _filtered(ax, h, 2)
    if p:
        angle, rate, acceleration = (
            angle + p * _filtered(ax, h, -2),
            rate + p * _filtered(ax, h, -1),
            acceleration + p * ax,
        )
    return pieces(h, table.on_top(ax, h), heave, (angle, rate, acceleration))
