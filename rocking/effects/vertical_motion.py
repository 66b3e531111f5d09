"""Vertical motion: the table also moves up and down as it moves horizontally, and nobody measured it.

Adds        a_z += ratio a_x + the second harmonic of a_x, `second_harmonic_ratio` times its amplitude
            (in phase, and `second_harmonic_quadrature` times in quadrature)
Parameters  ratio, second_harmonic_ratio, second_harmonic_quadrature [1]; 0 where they are absent
Use when    a table's axes are coupled, or its actuator's lever turns as it strokes
Limits      the same ratio at all frequencies; the harmonic is that of the analytic signal A exp(i phi) of a_x, that
            is A cos(2 phi) and A sin(2 phi), and has a clear meaning for narrow-band motion only
Source      Gabor (1946) for the analytic signal
Status      a sinusoid's second harmonic against its formula (tests)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from rocking.altered import AlteredMotion, moving_part, samples_of, table, table_value
from rocking.effect import Effect
from rocking.motion import BaseMotion

_inner: Any = None
_split: Any = None


def _coupled(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    a_x, a_z = _inner(xp, t, par[:_split])
    return a_x, a_z + par[_split] * a_x


def _with_harmonic(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    a_x, a_z = _inner(xp, t, par[:_split])
    return a_x, a_z + par[_split] * a_x + table_value(xp, t, par[_split + 1 :], 0.0)


def second_harmonics(a: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(A cos(2 phi), A sin(2 phi)) of the analytic signal A exp(i phi) of the samples, shape (time,)."""
    from scipy.signal import hilbert

    part = moving_part(a)
    count = part.stop - part.start
    signal = hilbert(np.concatenate([np.zeros(count), a[part], np.zeros(count)]))[count : 2 * count]
    amplitude = np.maximum(np.abs(signal), np.finfo(float).tiny)
    cosine, sine = np.zeros((2, a.size))
    cosine[part], sine[part] = (signal**2 / amplitude).real, (signal**2 / amplitude).imag
    return cosine, sine


@dataclass(frozen=True)
class VerticalMotion(Effect):
    """Vertical over horizontal acceleration of the base [1], and of its second harmonic."""

    ratio: float = 0.0
    second_harmonic_ratio: float = 0.0
    second_harmonic_quadrature: float = 0.0

    name: ClassVar[str] = "vertical_motion"
    units: ClassVar[dict[str, str]] = {
        "ratio": "1", "second_harmonic_ratio": "1", "second_harmonic_quadrature": "1"
    }  # fmt: skip
    rank: ClassVar[int] = 1

    def base_motion(self, motion: BaseMotion, span: tuple[float, float], g: float) -> BaseMotion:
        """The motion with the vertical one added."""
        label = f"vertical motion {self.ratio:g}, {self.second_harmonic_ratio:g}, {self.second_harmonic_quadrature:g}"
        if self.second_harmonic_ratio == 0.0 and self.second_harmonic_quadrature == 0.0:
            return AlteredMotion(motion, [self.ratio], kernel=_coupled, label=label)
        start, step, a_x, own = samples_of(motion, span)
        a_x = a_x[:own]
        cosine, sine = second_harmonics(a_x)
        harmonic = self.second_harmonic_ratio * cosine + self.second_harmonic_quadrature * sine
        numbers = np.concatenate([[self.ratio], table(span, start, step, harmonic, part=moving_part(a_x))])
        return AlteredMotion(motion, numbers, kernel=_with_harmonic, max_step=step, label=label)
