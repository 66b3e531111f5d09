"""What a real shaking table does to a command, and what a sensor on it records.

    command -> wandering envelope -> harmonics -> gain and phase -> a_x;   a_z and pitch from a_x
    recorded along the table    a_x cos(pitch) - (g + a_z) sin(pitch) + noise
    recorded normal to it       a_x sin(pitch) + (g + a_z) cos(pitch) - g + noise

Harmonics come from the analytic signal A(t) exp(i phi(t)) of the command: ratio times A cos(2 phi), A cos(3 phi).
A sensor turns with the table, so it takes a share of gravity for acceleration where the table pitches.

Source   the departures that Winkler, Meguro & Yamazaki (1995) name for their tests (slope of the envelope, base
         conditions, vertical disturbance); Conte & Trombetti (2000), Linear dynamic modeling of a uni-axial servo-
         hydraulic shaking table system, for gain and phase as a table's linear part.
Status   each departure by itself against its closed form on a sine.  The defaults are a perfect table.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from excitation.checks import finite, not_negative, numbers, positive, real, whole
from excitation.envelopes import MAX_IMPERFECTION, departure
from excitation.motion import Motion
from excitation.record import Record
from excitation.sampled import SampledMotion
from excitation.units import STANDARD_GRAVITY

LEAST_DAMPING = 1e-4
"""Of a table that follows as an oscillator: with less it rings for thousands of cycles, which no servo does."""

RINGING = 12.0
"""How many times its longest lag a table is followed for: an oscillator's amplitude has then sunk to exp(-12)."""

MOST_RINGING = 2**23
"""Samples for which a table may be followed after the command's end: half a gigabyte of transforms."""


def _sensed(motion: SampledMotion) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Accelerations [m/s^2] along and normal to the table; no normal one if the table does nothing but move along x."""
    if motion.pitch_angle is None:
        return motion.a_x, motion.a_z
    sine, cosine = np.sin(motion.pitch_angle), np.cos(motion.pitch_angle)
    upward = STANDARD_GRAVITY + (0.0 if motion.a_z is None else motion.a_z)
    return motion.a_x * cosine - upward * sine, motion.a_x * sine + upward * cosine - STANDARD_GRAVITY


def _ratios(damping: float) -> NDArray[np.float64]:
    """Ratios r from 0 to 20 between which 1/(1 - r^2 + 2 i z r) is straight to 2e-4 of itself.

    Steps of a hundredth of r, from where 2 z r is small, and of a fiftieth of sqrt((r - 1)^2 + z^2) from r = 1/2 to 2:
    the response there is 1/(r - 1 - i z) but for a factor, and r - 1 = z sinh(u) lays them.
    """
    least = 0.01 / max(1.0, damping)
    wide = np.geomspace(least, 20.0, math.ceil(100.0 * math.log(20.0 / least)))
    below, above = (math.floor(50.0 * math.asinh(width / damping)) for width in (0.5, 1.0))
    near = 1.0 + damping * np.sinh(np.arange(-below, above + 1) / 50.0)
    return np.concatenate([[0.0], wide, near])


@dataclass(frozen=True, repr=False)
class Table:
    """A shaking table with its departures from the ideal.

    Args:
        frequencies: where gain and phase are given [Hz], ascending, 0 or more; none for a table without.
        gain: output over command at those frequencies, not negative; straight lines between, constant beyond.
        phase: lead of the output at those frequencies [rad], negative for a lag; likewise.
        second_harmonic, third_harmonic: amplitude of the harmonics of the command over the command's.
        cross_axis: vertical over horizontal acceleration.
        cross_axis_second_harmonic: vertical acceleration at twice the frequency over the horizontal one.
        pitch_per_acceleration: [rad/(m/s^2)], clockwise positive.
        pitch_per_displacement: [rad/m], clockwise positive.
        displacement_corner: [Hz]; displacement is what remains above it, since a table cannot drift away.
        envelope_imperfection: rms of the random departure of the amplitude, 0 to 0.25.
        envelope_period: shortest period of that departure [s].
        noise: standard deviation of a sensor's white noise [m/s^2].
        seed: of the departure and of the noise.

    Raises:
        ValueError: an argument is out of the range above.
    """

    frequencies: Sequence[float] = ()
    gain: Sequence[float] = ()
    phase: Sequence[float] = ()
    second_harmonic: float = 0.0
    third_harmonic: float = 0.0
    cross_axis: float = 0.0
    cross_axis_second_harmonic: float = 0.0
    pitch_per_acceleration: float = 0.0
    pitch_per_displacement: float = 0.0
    displacement_corner: float = 0.1
    envelope_imperfection: float = 0.0
    envelope_period: float = 10.0
    noise: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        f, gain, phase = (numbers(n, getattr(self, n)) for n in ("frequencies", "gain", "phase"))
        if not f.shape == gain.shape == phase.shape or f.ndim != 1:
            raise ValueError(f"frequencies, gain, phase: have shapes {f.shape}, {gain.shape}, {phase.shape}, want one")
        if not all(np.all(np.isfinite(v)) for v in (f, gain, phase)) or np.any(np.diff(f) <= 0.0) or np.any(f < 0.0):
            raise ValueError(
                f"frequencies={self.frequencies!r} Hz: want ascending from 0 on, with finite gain and phase"
            )
        # So that two tables of the same numbers are equal, and hashed alike, whatever held them.
        for name, values in (("frequencies", f), ("gain", gain), ("phase", phase)):
            object.__setattr__(self, name, tuple(values.tolist()))
        if np.any(gain < 0.0):
            raise ValueError(f"gain={self.gain!r}: want zero or more")
        for name in ("second_harmonic", "third_harmonic", "cross_axis", "cross_axis_second_harmonic"):
            finite(name, getattr(self, name), "1")
        finite("pitch_per_acceleration", self.pitch_per_acceleration, "rad/(m/s^2)")
        finite("pitch_per_displacement", self.pitch_per_displacement, "rad/m")
        positive("displacement_corner", self.displacement_corner, "Hz")
        positive("envelope_period", self.envelope_period, "s")
        not_negative("noise", self.noise, "m/s^2")
        whole("seed", self.seed, 0)
        if not 0.0 <= real(self.envelope_imperfection) <= MAX_IMPERFECTION:
            raise ValueError(f"envelope_imperfection={self.envelope_imperfection!r}: want 0 to {MAX_IMPERFECTION}")

    @classmethod
    def second_order(cls, natural_frequency: float, damping: float, delay: float = 0.0) -> Table:
        """A table whose servo follows as a damped oscillator does: 1/(1 - r^2 + 2 i z r) exp(-2 pi i f delay).

        Args:
            natural_frequency: [Hz], positive.
            damping: z, 0.0001 or more.
            delay: [s], 0 or more.
        """
        positive("natural_frequency", natural_frequency, "Hz")
        if not (math.isfinite(real(damping)) and damping >= LEAST_DAMPING):
            raise ValueError(f"damping={damping!r} 1: want a number of {LEAST_DAMPING} or more")
        not_negative("delay", delay, "s")
        f = np.unique(natural_frequency * _ratios(damping))
        r = f / natural_frequency
        response = 1.0 / (1.0 - r * r + 2j * damping * r)
        phase = np.unwrap(np.angle(response)) - 2.0 * math.pi * f * delay
        return cls(tuple(f.tolist()), tuple(np.abs(response).tolist()), tuple(phase.tolist()))

    def shake(self, command: Motion, *, time_step: float, end: float, start: float = 0.0) -> SampledMotion:
        """What the table does when it is told to move as `command` from `start` to `end` [s].

        Args:
            command: the wanted motion; its a_x is the command.
            time_step: of the result's samples [s], positive; the fastest harmonic needs ten or so a period.

        Raises:
            ValueError: the step or the span is not positive, or a phase so steep that the table answers for ever.
        """
        wanted = SampledMotion.of(command, time_step=time_step, end=end, start=start)
        told = self._wander(wanted.a_x, time_step)
        a_x = self._respond(told + self._harmonics(told, self.second_harmonic, self.third_harmonic), time_step)
        a_z = self.cross_axis * a_x + self._harmonics(a_x, self.cross_axis_second_harmonic, 0.0)
        pitch = self.pitch_per_acceleration * a_x
        if self.pitch_per_displacement != 0.0:
            pitch = pitch + self.pitch_per_displacement * self._displacement(a_x, time_step)
        return SampledMotion(
            time_step,
            a_x,
            a_z if np.any(a_z) else None,
            pitch if np.any(pitch) else None,
            start=start,
            name=f"table under {command!r}",
        )

    def _wander(self, a_x: NDArray[np.float64], time_step: float) -> NDArray[np.float64]:
        if self.envelope_imperfection == 0.0:
            return a_x
        t = time_step * np.arange(a_x.size)
        rows = departure(self.envelope_imperfection, self.envelope_period, float(t[-1]), self.seed)
        factor = 1.0 + sum(amplitude * np.cos(omega * t + phase) for amplitude, omega, phase in rows)
        return np.asarray(a_x * factor)

    @staticmethod
    def _harmonics(a_x: NDArray[np.float64], second: float, third: float) -> NDArray[np.float64]:
        """Motion at two and three times the frequency of a_x, with the stated shares of its amplitude."""
        if second == 0.0 and third == 0.0:
            return np.zeros_like(a_x)
        from scipy.signal import hilbert

        # Zeros behind, so that what ends suddenly does not come in at the front.
        analytic = hilbert(a_x, 2 * a_x.size)[: a_x.size]
        amplitude = np.abs(analytic)
        turn = np.divide(analytic, amplitude, out=np.zeros_like(analytic), where=amplitude > 0.0)
        return np.asarray(amplitude * (second * (turn**2).real + third * (turn**3).real))

    def _respond(self, a_x: NDArray[np.float64], time_step: float) -> NDArray[np.float64]:
        if len(self.frequencies) == 0:
            return a_x
        # Zeros behind, so that what lags does not come in again at the front.
        ringing = math.ceil(RINGING * self._lag / time_step)
        if ringing > MOST_RINGING:
            raise ValueError(
                f"phase: so steep that the table lags by {self._lag:g} s, want at most "
                f"{MOST_RINGING * time_step / RINGING:g} s at time_step={time_step!r} s"
            )
        size = 2 * max(a_x.size, ringing)
        f = np.fft.rfftfreq(size, time_step)
        gain = np.interp(f, self.frequencies, self.gain)
        phase = np.interp(f, self.frequencies, self.phase)
        return np.asarray(np.fft.irfft(np.fft.rfft(a_x, size) * gain * np.exp(1j * phase), size)[: a_x.size])

    @property
    def _lag(self) -> float:
        """The longest time [s] by which a frequency's group lags or leads: the steepest slope of the phase."""
        slopes = np.diff(self.phase) / np.diff(self.frequencies)
        return float(np.max(np.abs(slopes), initial=0.0)) / (2.0 * math.pi)

    def _displacement(self, a_x: NDArray[np.float64], time_step: float) -> NDArray[np.float64]:
        from excitation.filters import band_passed

        if self.displacement_corner >= 0.5 / time_step:
            raise ValueError(
                f"displacement_corner={self.displacement_corner!r} Hz: want below half the sampling rate, "
                f"{0.5 / time_step:g} Hz"
            )
        high = band_passed(Record(time_step, a_x), self.displacement_corner, None, keep_padding=True)
        pad = (high.acceleration.size - a_x.size) // 2
        return high.displacement[pad : pad + a_x.size]

    def recorded(self, motion: SampledMotion) -> list[Record]:
        """What noisy accelerometers at the axis of pitch record: along the table, and normal to it where it moves so.

        Both turn with the table: a pitch of 1 mrad shows as 0.01 m/s^2.
        """
        rng = np.random.default_rng([self.seed, 1])
        records = []
        for name, values in zip(("a_x", "a_z"), _sensed(motion), strict=True):
            if values is not None:
                noisy = values + self.noise * rng.normal(size=values.size)
                records.append(
                    Record(motion.time_step, noisy, component=name, vertical=name == "a_z", source=motion.name)
                )
        return records

    def __repr__(self) -> str:
        perfect = Table()
        names = [n for n in self.__dataclass_fields__ if getattr(self, n) != getattr(perfect, n)]
        values = {name: getattr(self, name) for name in names}
        shown = {
            name: f"<{len(value)} values>" if isinstance(value, Sequence) and len(value) > 6 else repr(value)
            for name, value in values.items()
        }
        return f"Table({', '.join(f'{name}={text}' for name, text in shown.items())})"

    def without(self, *names: str) -> Table:
        """The same table with the named departures gone (`noise`, `cross_axis`, ...); ValueError for another name."""
        perfect = Table()
        for name in names:
            if name not in self.__dataclass_fields__:
                raise ValueError(f"name={name!r}: want one of {', '.join(self.__dataclass_fields__)}")
        changed = {name: getattr(perfect, name) for name in names}
        if {"frequencies", "gain", "phase"} & changed.keys():
            changed |= {"frequencies": (), "gain": (), "phase": ()}
        return replace(self, **changed)
