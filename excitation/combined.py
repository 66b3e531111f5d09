"""Two formulas as one motion: one along x, another along z.

Status   exact, no sampling.  The combined kernel exists in this process only, so a compiling solver compiles it anew in
         each process (a fraction of a second); samples (`SampledMotion.of`) do not need that.
"""

from __future__ import annotations

from functools import cache, cached_property
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from excitation.motion import Motion

# Three names for what `_bound` puts in their place: the kernels and the number of parameters of the first motion.
_horizontal: Any = None
_vertical: Any = None
_split: Any = None


def _both(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """(a_x of the first motion, a_x of the second) [m/s^2] at t; par = [first's ..., second's ...]."""
    a_x, _ = _horizontal(xp, t, par[:_split])
    a_z, _ = _vertical(xp, t, par[_split:])
    return a_x, a_z


def _first(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """Pitch and its acceleration: those of the first motion."""
    return _horizontal(xp, t, par[:_split])


@cache
def _bound(template: Any, horizontal: Any, vertical: Any, split: int) -> Any:
    """A template above with its names bound: a plain function, whose callees a compiler finds as globals."""
    names = {"_horizontal": horizontal, "_vertical": vertical, "_split": split, "__name__": __name__}
    return FunctionType(template.__code__, names, template.__name__)


class Combined(Motion):
    """`horizontal` along x, with its pitch, and `vertical`'s a_x along z.

    Args:
        horizontal, vertical: any two motions; what the second does horizontally happens vertically here.
    """

    def __init__(self, horizontal: Motion, vertical: Motion) -> None:
        self.horizontal, self.vertical = horizontal, vertical
        self._kernels = [
            _bound(template, first, vertical.kernel, horizontal.parameters.size)
            for template, first in ((_both, horizontal.kernel), (_first, horizontal.pitch_kernel))
        ]

    @property
    def kernel(self) -> Any:
        """(xp, t, par) -> (a_x, a_z), the same object for the same two kinds of motion."""
        return self._kernels[0]

    @property
    def pitch_kernel(self) -> Any:  # type: ignore[override]
        """(xp, t, par) -> (pitch, pitch acceleration)."""
        return self._kernels[1]

    @cached_property
    def parameters(self) -> NDArray[np.float64]:
        return np.concatenate([self.horizontal.parameters, self.vertical.parameters])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return tuple(sorted({*self.horizontal.breakpoints, *self.vertical.breakpoints}))

    @property
    def max_step(self) -> float:
        return min(self.horizontal.max_step, self.vertical.max_step)

    def __repr__(self) -> str:
        return f"Combined({self.horizontal!r}, {self.vertical!r})"
