"""The block of these tests, a base that moves, and runs with effects given as texts."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from rocking import Block, Method1, solve
from rocking.effects import parse


def ramped_with_vertical(xp: Any, t: Any, par: Any) -> tuple[Any, Any]:
    """A sine whose amplitude grows, and a steady sine up and down."""
    return par[0] * t * xp.sin(par[1] * t), par[2] * xp.sin(par[3] * t)


class Shaken:
    """a_x = rate t sin(omega t), a_z = vertical sin(omega_z t); as a protocol asks for it, known to no package."""

    kernel = staticmethod(ramped_with_vertical)
    breakpoints: tuple[float, ...] = ()

    def __init__(self, rate: float = 3.0, omega: float = 16.0, vertical: float = 1.5, omega_z: float = 23.0) -> None:
        self.parameters = np.array([rate, omega, vertical, omega_z])
        self.max_step = 0.3 / max(omega, omega_z)

    def __call__(self, t: float) -> tuple[float, float]:
        rate, omega, vertical, omega_z = self.parameters
        return rate * t * math.sin(omega * t), vertical * math.sin(omega_z * t)

    def __repr__(self) -> str:
        return f"Shaken({self.parameters.tolist()})"


@pytest.fixture(scope="session")
def shaken() -> type[Shaken]:
    """The base motion of these tests."""
    return Shaken


@pytest.fixture(scope="session")
def block() -> Block:
    """b/h = 1/4, 96 kg."""
    return Block(b=0.2, h=0.8)


@pytest.fixture(scope="session")
def run_with(block: Block) -> Callable[..., Any]:
    """A run of the block with effects such as "rounded_edges.radius=0.003", to sharp tolerances."""

    def run(*texts: str, motion: Any = None, method: Any = None, **options: Any) -> Any:
        options = {"rtol": 1e-11, "atol": 1e-14} | options
        return solve(Method1(block) if method is None else method, motion, effects=parse(texts), **options)

    return run
