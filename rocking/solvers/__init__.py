"""Solvers carry a hybrid system through time; each is a plugin of the entry-point group `rocking.solvers`.

A package adds its own with one line of metadata:

    [project.entry-points."rocking.solvers"]
    mine = "my_package.my_module:MySolver"

A solver locates impacts instead of stepping over them, treats a guard that is zero when a mode begins as just left,
records every event, ends the run at guard 0 (the fall), and declines what it cannot treat in a sentence.
"""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from rocking.hybrid import Discrete, System
from rocking.motion import BaseMotion
from rocking.trajectory import Trajectory

GROUP = "rocking.solvers"


class Solver(Protocol):
    """Carries a hybrid system through time."""

    name: str

    def declines(self, system: System, motion: BaseMotion) -> str | None:
        """A sentence on why this solver cannot treat the system under the motion, or None if it can."""

    def solve(
        self,
        system: System,
        motion: BaseMotion,
        y0: tuple[float, ...],
        q0: Discrete,
        t_span: tuple[float, float],
        *,
        rtol: float,
        atol: float,
        save_at: NDArray[np.float64],
        max_events: int,
    ) -> Trajectory:
        """The trajectory from t_span[0] to the fall or t_span[1]."""


_loaded: dict[str, Solver] = {}
"""Solvers already in use: looking through the installed packages takes longer than a run."""


def _installed() -> dict[str, EntryPoint]:
    return {point.name: point for point in entry_points(group=GROUP)}


def available() -> tuple[str, ...]:
    """Names of the installed solvers, in alphabetical order."""
    return tuple(sorted(_installed()))


def load(name: str) -> Solver:
    """The solver of that name.

    Raises:
        ValueError: no solver of that name is installed.
        ImportError: the plugin is there and does not load; it says which.
    """
    if isinstance(name, str) and name in _loaded:
        return _loaded[name]
    points = _installed()
    if not isinstance(name, str) or name not in points:
        raise ValueError(f"solver={name!r}: want one of {', '.join(sorted(points))}")
    try:
        solver: Any = points[name].load()
    except Exception as error:
        raise ImportError(f"solver {name!r} ({points[name].value}) does not load: {error}") from error
    _loaded[name] = solver()
    return _loaded[name]
