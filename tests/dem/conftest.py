"""Blocks of Winkler, Meguro & Yamazaki (1995), Table 1, and helpers shared by the tests of `dem`."""

from collections.abc import Callable

import numpy as np
import pytest

import dem

# b, h, d [m], Table 1.
SIZES = {1: (0.30, 1.00, 0.50), 3: (0.15, 0.50, 0.25), 4: (0.075, 0.25, 0.125)}
# The lightest block weighs 1.4 kg (section on numerical stability): 597 kg/m^3.
DENSITY = 597.0


@pytest.fixture(scope="session")
def block() -> Callable[[int], dem.Scene]:
    """The block of that number."""
    return lambda number: dem.single_block(*SIZES[number], DENSITY)


@pytest.fixture(scope="session")
def overlaps() -> Callable[[dem.History], np.ndarray]:
    """Overlap of each corner with the floor at the last sample [m]."""

    def of(history: dem.History) -> np.ndarray:
        corners, theta = history.scene.shape.corners, history.theta[-1]
        return -(history.z[-1] + corners[:, 1] * np.cos(theta) - corners[:, 0] * np.sin(theta))

    return of
