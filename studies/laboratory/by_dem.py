"""The block as one distinct element: its corners on springs along and across the floor, with dashpots and friction.

A block of the package `dem`, uniform and with sharp corners.

Source   Winkler, Meguro & Yamazaki (1995), the distinct element method
Status   against contact.py, which shares no code with it, where friction holds, and gives way in impacts (tests)
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

import dem

from .effects import Lab
from .event import FALLEN, Response
from .parameters import World, refuse

STEP = 1e-5  # s
WIDEST = 0.05
"""Largest step over the critical one."""
FOREIGN = (
    "radius", "offset", "viscous", "quadratic", "tether_stiffness", "adhesion", "slope", "side", "leak", "bedding",
    "grind", "heed", "cubic", "hinge", "guide", "side_viscous", "squeeze", "brake", "rib", "magnet", "layer",
    "slosh_mass",
)  # fmt: skip
"""What an element of `dem` lacks."""


def _uniform(world: World) -> dem.Scene:
    """The block; its outline is that of the world.

    Raises:
        ValueError: the inertia is not that of a uniform block.
    """
    breadth, height = 2.0 * world.half_breadth, 2.0 * world.centre_height
    own = world.mass * (breadth**2 + height**2) / 12.0
    if not math.isclose(world.inertia, own, rel_tol=1e-9):
        raise ValueError(f"inertia={world.inertia!r}: not in the laboratory of the engine 'dem', want {own:g}")
    return dem.single_block(breadth, height, 1.0, world.mass / (breadth * height))


def _springs_under_corners(world: World) -> None:
    if not (world.stiffness > 0.0 and world.give > 0.0 and world.springs == 2.0):
        raise ValueError(
            f"stiffness={world.stiffness!r}, give={world.give!r}, springs={world.springs!r}: not in the laboratory of "
            "the engine 'dem', want two corners that give (compliant_base or bouncing)"
        )


def check(lab: Lab) -> None:
    """Whether an element of `dem` has all that is odd about this laboratory.

    Raises:
        ValueError: it has not.
    """
    refuse(lab.world, FOREIGN, "of the engine 'dem'")
    refuse(lab.table, ("pitch_acceleration", "pitch_displacement"), "of the engine 'dem'")
    refuse(lab, ("wear", "courses"), "of the engine 'dem'")
    _springs_under_corners(lab.world)
    _uniform(lab.world)


def _moving(world: World, felt: np.ndarray, h: float) -> Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]:
    """Acceleration of the floor in its own axes, with what its tilt makes of gravity."""
    if np.any(felt[:, 2:]):
        raise ValueError("table_pitch: not in the laboratory of the engine 'dem'")
    sin, cos = math.sin(world.tilt), math.cos(world.tilt)

    def motion(times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        piece = np.clip((times / h).astype(int), 0, felt.shape[0] - 1)
        x = (times - h * piece)[:, None] ** np.arange(4)
        ax, az = (np.einsum("nk,nk->n", felt[piece, k], x) for k in (0, 1))
        down = world.gravity + az
        return ax * cos - down * sin, ax * sin + down * cos - world.gravity

    return motion


def simulate(world: World, felt: np.ndarray, h: float, every: int, theta0: float) -> Response:
    """Rotation of a block on its springs; there is no list of impacts.

    Raises:
        ValueError: the world has an effect that an element lacks, or no stiffness.
        RuntimeError: the element's motion is faster than any force here could make it.
    """
    refuse(world, FOREIGN, "of the engine 'dem'")
    _springs_under_corners(world)
    scene, along = _uniform(world), world.stiffness / world.give
    most = min(STEP, WIDEST * dem.critical_step(scene, world.stiffness, along, world.damping))
    sub = math.ceil(h * every / most)
    samples = felt.shape[0] // every + 1
    history = dem.simulate(
        scene, _moving(world, felt, h), t_end=(samples - 1) * h * every, mu=world.friction, damping=world.damping,
        dt=h * every / sub, kn=world.stiffness, ks=along, theta0=theta0, g=world.gravity, save_every=sub,
    )  # fmt: skip
    if history.outcome is dem.Outcome.UNSTABLE:
        raise RuntimeError(f"stiffness={world.stiffness:g}, damping={world.damping:g}: {history.outcome.value}")
    found = np.full((samples, 2), np.nan)
    n = min(samples, history.time.size)
    found[:n] = np.stack([history.theta[:n], history.omega[:n]], axis=1)
    down = np.flatnonzero(np.abs(found[:, 0]) > FALLEN)
    fell = None
    if down.size or n < samples:
        # It passed the limit before the first sample beyond it.
        fell = max(1, int(down[0])) if down.size else n
        found[fell:] = np.nan
    time = h * every * np.arange(samples)
    nothing = np.full(samples, np.nan)
    return Response(time, found[:, 0].copy(), found[:, 1].copy(), nothing, np.zeros((0, 3)), fell)
