"""Pitch in proportion to what the base does horizontally, in closed form.

    pitch(t) = c_d x(t) + c_a a_x(t),   pitch acceleration = c_d a_x(t) + c_a a_x''(t)

x is the displacement of the base from rest.  A motion takes part in c_d if its displacement is a closed formula and
comes to rest (`displacement_kernel`), and in c_a if its acceleration is smooth enough to have a second derivative
everywhere (`snap_kernel`): a jump of angle or rate would be a blow.

Source   `excitation.table` for the two constants: tilt by uneven guides, and by the overturning moment of what stands
         on the table.
Status   both derivatives are checked by integration.  `Table` does the same to samples of any motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from excitation.binding import bound
from excitation.checks import finite
from excitation.motion import Motion

# Names that `bound` puts kernels in.
_below: Any = None
_displacement: Any = None
_snap: Any = None


def _none(xp: Any, t: Any, par: Any) -> Any:
    """What a constant of zero is multiplied by."""
    return 0.0 * t


def _accelerations(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x, a_z) [m/s^2] of the motion itself; par = [c_d, c_a, its ...]."""
    return _below(xp, t, par[2:])


def _pitch(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(pitch [rad], its acceleration [rad/s^2]) at t; par as above."""
    a_x, _ = _below(xp, t, par[2:])
    pitch = par[0] * _displacement(xp, t, par[2:]) + par[1] * a_x
    return pitch, par[0] * a_x + par[1] * _snap(xp, t, par[2:])


@dataclass(frozen=True)
class ProportionalPitch(Motion):
    """A motion whose base pitches in proportion to its displacement and acceleration.

    Args:
        motion: what the base does; one-sine, one-cosine, Ricker and Mavroeidis-Papageorgiou pulses have a displacement;
            Ricker and Gabor pulses, tapered chirps and sinusoids an acceleration smooth enough.
        per_displacement: [rad/m], clockwise positive.
        per_acceleration: [rad/(m/s^2)], clockwise positive.

    Raises:
        ValueError: both constants are zero or one is not finite, or the motion has not what one needs.
    """

    motion: Motion
    per_displacement: float = 0.0
    per_acceleration: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.motion, Motion):
            raise ValueError(f"motion={self.motion!r}: want a motion of this package")
        finite("per_displacement", self.per_displacement, "rad/m")
        finite("per_acceleration", self.per_acceleration, "rad/(m/s^2)")
        if self.per_displacement == self.per_acceleration == 0.0:
            raise ValueError("per_displacement=0.0, per_acceleration=0.0: want one of them or both")
        reasons = {
            "per_displacement": ("displacement_kernel", "a displacement in closed form that comes to rest"),
            "per_acceleration": ("snap_kernel", "an acceleration without jumps of value or slope, in closed form"),
        }
        for name, (kernel, wanted) in reasons.items():
            if getattr(self, name) != 0.0 and getattr(self.motion, kernel) is None:
                raise ValueError(
                    f"{name}={getattr(self, name)!r}: of {self.motion!r}, want {wanted}; `Table` samples any motion"
                )

    @cached_property
    def kernel(self) -> Any:
        """(xp, t, par) -> (a_x, a_z) of the motion."""
        return bound(_accelerations, _below=self.motion.kernel)

    @cached_property
    def pitch_kernel(self) -> Any:  # type: ignore[override]
        """(xp, t, par) -> (pitch, pitch acceleration)."""
        displacement = self.motion.displacement_kernel if self.per_displacement != 0.0 else _none
        snap = self.motion.snap_kernel if self.per_acceleration != 0.0 else _none
        return bound(_pitch, _below=self.motion.kernel, _displacement=displacement, _snap=snap)

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        return np.concatenate([[self.per_displacement, self.per_acceleration], self.motion.parameters])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return self.motion.breakpoints

    @property
    def max_step(self) -> float:
        return self.motion.max_step
