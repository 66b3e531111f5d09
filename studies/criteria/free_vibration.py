"""Free vibration of a block of distinct elements: its restitution, and the dashpot that gives a restitution.

A block is leaned to one side and released; between one peak tilt and the next it loses energy in the dashpots.
The ratio e = sqrt(E_next / E), E the potential energy at a peak over that upright, is what eq. (4) would need for that
swing.

Source   Winkler, Meguro & Yamazaki (1995), Fig. 5 and section "Material parameters": the damping constant is fitted to
         a free vibration of Block 1, normal and shear alike, and used for all blocks.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

import dem
from dem.free_swings import FRICTION
from rocking import G_STANDARD, Block

RELEASE = 0.4
"""Tilt at release as a share of the tilt of unstable balance."""

SWINGS = 4
"""Swings over which the restitution is averaged."""

STEP_SHARE = 0.05
"""Step of the free vibration as a share of the critical one."""


@dataclass(frozen=True)
class DashpotFit:
    """A dashpot and what it does to the block that it was fitted on."""

    damping: float  # [N s/m]
    damping_ratio: float  # c / (2 sqrt(kn m)) [1]
    restitution: float  # per swing [1]


def scene_of(block: Block) -> dem.Scene:
    """The block as a scene of one distinct element."""
    return dem.single_block(block.b, block.h, block.d, block.density)


def swing_restitution(block: Block, damping: float, *, kn: float, ks: float, g: float = G_STANDARD) -> float:
    """Restitution per swing [1] of a freely rocking distinct element, the geometric mean over the first swings.

    Args:
        block: the block.
        damping: dashpot of a corner, normal and shear [N s/m].
        kn, ks: stiffness of a corner [N/m].
        g: gravity [m/s^2].

    Raises:
        RuntimeError: the block makes fewer swings than the mean needs.
    """
    scene = scene_of(block)
    quarter = math.acosh(1.0 / (1.0 - RELEASE)) / block.p(g)
    dt = STEP_SHARE * dem.critical_step(scene, kn, ks, damping)
    # About the middle of its base, and not about a corner as `dem.let_go`: rounding in x alone moves a dashpot by up to
    # 0.03 %, within what the root is sought to, and with it every run of distinct elements that is chaotic.
    history = dem.simulate(
        scene, t_end=4.0 * quarter * SWINGS, mu=FRICTION, damping=damping, dt=dt, kn=kn, ks=ks, g=g,
        theta0=RELEASE * block.alpha, save_every=max(1, int(quarter / dt / 400)),
    )  # fmt: skip
    # The first peak is the release.
    peaks = dem.swings(history.time, history.theta).peaks[: SWINGS + 1]
    if len(peaks) < SWINGS + 1:
        raise RuntimeError(f"damping={damping:.6g} N s/m: only {len(peaks) - 1} swings of the {SWINGS} wanted")
    energy = np.cos(block.alpha - peaks) - math.cos(block.alpha)
    return float((energy[-1] / energy[0]) ** (0.5 / SWINGS))


def fit_dashpot(block: Block, restitution: float, *, kn: float, ks: float, g: float = G_STANDARD) -> DashpotFit:
    """The dashpot with which a free vibration of `block` has `restitution` per swing.

    Args:
        block: the block of the free vibration.
        restitution: e of eq. (4) [1].
        kn, ks: stiffness of a corner [N/m].
        g: gravity [m/s^2].

    Raises:
        ValueError: no dashpot between a damping ratio of 0.001 and 2 gives it.
    """
    from scipy.optimize import brentq

    critical = 2.0 * math.sqrt(kn * block.mass)

    def excess(log_ratio: float) -> float:
        return swing_restitution(block, critical * math.exp(log_ratio), kn=kn, ks=ks, g=g) - restitution

    low, high = math.log(1e-3), math.log(2.0)
    most, least = excess(low) + restitution, excess(high) + restitution
    if not least <= restitution <= most:
        raise ValueError(
            f"restitution={restitution!r}: want {least:.4f} to {most:.4f}, what a contact with damping "
            "ratio 2 to 0.001 gives in a free vibration"
        )
    log_ratio = float(brentq(excess, low, high, xtol=1e-3))
    damping = critical * math.exp(log_ratio)
    return DashpotFit(damping, math.exp(log_ratio), excess(log_ratio) + restitution)
