"""Up to three formulas as one motion: one along x, another along z, and one that pitches the base.

Status   exact, no sampling.  The combined kernel exists in this process only, so a compiling solver compiles it anew in
         each process (a fraction of a second); samples (`SampledMotion.of`) do not need that.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from excitation.binding import bound
from excitation.motion import Motion

# Names that `bound` puts kernels and places of parameters in.
_horizontal: Any = None
_vertical: Any = None
_pitching: Any = None
_first: Any = None
_second: Any = None


def _alone(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z) [m/s^2] of the first motion at t; par = [first's ..., ...]."""
    return _horizontal(xp, t, par[:_first])


def _both(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x of the first motion, a_x of the second) [m/s^2] at t; par = [first's ..., second's ..., ...]."""
    a_x, _ = _horizontal(xp, t, par[:_first])
    a_z, _ = _vertical(xp, t, par[_first:_second])
    return a_x, a_z


def _pitch_of_first(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """Pitch and its acceleration: those of the first motion."""
    return _pitching(xp, t, par[:_first])


def _pitch_of_last(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """Pitch and its acceleration: those of the last motion."""
    return _pitching(xp, t, par[_second:])


@dataclass(frozen=True)
class Combined(Motion):
    """`horizontal` along x, `vertical`'s a_x along z, and the pitch of `pitching`.

    Args:
        horizontal: any motion.
        vertical: any motion; what it does horizontally happens vertically here.  If not given, a_z is `horizontal`'s.
        pitching: any motion that pitches (`SinusoidalPitch`, `ProportionalPitch`, samples): its pitch is taken and
            nothing else.  If not given, the pitch is `horizontal`'s.

    Raises:
        ValueError: `pitching` does not pitch.
    """

    horizontal: Motion
    vertical: Motion | None = None
    pitching: Motion | None = None

    def __post_init__(self) -> None:
        for name in ("horizontal", "vertical", "pitching"):
            part = getattr(self, name)
            if not (isinstance(part, Motion) or (part is None and name != "horizontal")):
                raise ValueError(f"{name}={part!r}: want a motion of this package")
        if self.pitching is not None and not self.pitching.has_pitch:
            raise ValueError(f"pitching={self.pitching!r}: does not pitch, want a motion that does")

    @property
    def _parts(self) -> tuple[Motion, ...]:
        return tuple(part for part in (self.horizontal, self.vertical, self.pitching) if part is not None)

    @property
    def _places(self) -> tuple[int, int]:
        """Where the parameters of the second and of the last motion begin."""
        first = self.horizontal.parameters.size
        return first, first + (0 if self.vertical is None else self.vertical.parameters.size)

    @cached_property
    def kernel(self) -> Any:
        """(xp, t, par) -> (a_x, a_z), the same object for the same kinds of motion."""
        first, second = self._places
        if self.vertical is None:
            return bound(_alone, _horizontal=self.horizontal.kernel, _first=first)
        kernels = {"_horizontal": self.horizontal.kernel, "_vertical": self.vertical.kernel}
        return bound(_both, **kernels, _first=first, _second=second)

    @cached_property
    def pitch_kernel(self) -> Any:  # type: ignore[override]
        """(xp, t, par) -> (pitch, pitch acceleration)."""
        first, second = self._places
        if self.pitching is None:
            return bound(_pitch_of_first, _pitching=self.horizontal.pitch_kernel, _first=first)
        return bound(_pitch_of_last, _pitching=self.pitching.pitch_kernel, _second=second)

    @property
    def has_pitch(self) -> bool:
        """Whether the base pitches."""
        return self.pitching is not None or self.horizontal.has_pitch

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        return np.concatenate([part.parameters for part in self._parts])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return tuple(sorted({t for part in self._parts for t in part.breakpoints}))

    @property
    def max_step(self) -> float:
        return min(part.max_step for part in self._parts)
