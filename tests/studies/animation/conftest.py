"""Runs that are shown: a column of three that falls, a column by a wall, a single block; and a browser."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest

import dem

sys.path.insert(0, str(Path(__file__).parent))

from browser import CHROMIUM, Browser

G = 9.80665
B, H, D, DENSITY = 0.15, 0.50, 0.25, 597.0


def growing(frequency, rate=0.3 * G):
    """A base acceleration that grows."""

    def motion(t):
        return rate * t * np.sin(2.0 * math.pi * frequency * t), np.zeros_like(t)

    return motion


@pytest.fixture(scope="session")
def column():
    scene = dem.column(3, B, H, D, DENSITY)
    contact = dem.Contact(0.8, damping_ratio=0.1)
    run = dem.simulate_assembly(scene, growing(3.0), t_end=20.0, contact=contact, save_every=100)
    assert run.ending is dem.Ending.FELL
    return run


@pytest.fixture(scope="session")
def by_a_wall():
    scene = dem.column(2, B, H, D, DENSITY, wall_gap=0.05)
    return dem.simulate_assembly(
        scene, growing(2.0), t_end=2.0, contact=dem.Contact(0.8, damping_ratio=0.1), keep=["upper block"]
    )


@pytest.fixture(scope="session")
def block():
    return dem.simulate(
        dem.single_block(B, H, D, DENSITY), growing(1.0), t_end=10.0, mu=0.8, damping_ratio=0.1, dt=2e-5
    )


@pytest.fixture(scope="session")
def browser(tmp_path_factory):
    if CHROMIUM is None:
        pytest.skip("no chromium here: the page is not run")
    opened = Browser(tmp_path_factory.mktemp("profile"))
    yield opened
    opened.close()
