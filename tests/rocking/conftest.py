"""The block of most tests and one base motion that can be a pulse, a jump, a steady push or a shaking.

Modules of this folder can be imported by name.
"""

import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rocking import Block

sys.path.insert(0, str(Path(__file__).parent))
# Assertions of a shared module tell what they compared, as those of a test do.
pytest.register_assert_rewrite("functions_of_taylor")


def window_acceleration(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """A steady acceleration, and within a window of time another one with a sine on it."""
    inside = (t >= par[0]) & (t <= par[1])
    tau = t - par[0]
    a_x = par[2] + xp.where(inside, par[4] + par[5] * xp.sin(par[6] * tau + par[7]), 0.0)
    a_z = par[3] + xp.where(inside, par[8] + par[9] * xp.sin(par[10] * tau + par[11]), 0.0)
    return a_x, a_z


class Window:
    """a = steady + (level + amplitude sin(omega (t - start) + phase) from start to stop), for a_x and a_z."""

    kernel = staticmethod(window_acceleration)

    def __init__(
        self,
        start: float = 0.0,
        stop: float = math.inf,
        *,
        steady: tuple[float, float] = (0.0, 0.0),
        x: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
        z: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
    ) -> None:
        self.parameters = np.array([start, stop, *steady, *x, *z], dtype=float)
        self.breakpoints = tuple(t for t in (start, stop) if math.isfinite(t))
        fastest = max(abs(x[2]), abs(z[2]))
        self.max_step = 0.3 / fastest if fastest > 0.0 else math.inf

    def __call__(self, t: float) -> tuple[float, float]:
        start, stop, steady_x, steady_z, *rest = self.parameters
        if not start <= t <= stop:
            return steady_x, steady_z
        x, z = rest[:4], rest[4:]
        tau = t - start
        return (
            steady_x + x[0] + x[1] * math.sin(x[2] * tau + x[3]),
            steady_z + z[0] + z[1] * math.sin(z[2] * tau + z[3]),
        )

    def __repr__(self) -> str:
        return f"Window({self.parameters.tolist()})"


@pytest.fixture(scope="session")
def window() -> type[Window]:
    """The base motion of the tests."""
    return Window


@pytest.fixture(scope="session")
def constant() -> Callable[..., Window]:
    """Constant base acceleration (a_x, a_z) [m/s^2]."""
    return lambda a_x, a_z=0.0: Window(steady=(a_x, a_z))


@pytest.fixture(scope="session")
def sine_pulse() -> Callable[[float, float, float], Window]:
    """amplitude sin(omega t) from 0 to duration."""
    return lambda amplitude, omega, duration: Window(0.0, duration, x=(0.0, amplitude, omega, 0.0))


@pytest.fixture(scope="session")
def slender() -> Block:
    """Block of 0.2 m by 0.8 m: b/h = 1/4."""
    return Block(b=0.2, h=0.8)
