"""Distinct elements in the plane: a rigid body that touches a moving base through springs, dashpots and friction.

Frame   of the base: x to the right, z up, rotation theta > 0 clockwise (leaning to +x). A positive a_x makes a
        block lean to -x.
Source  Winkler, Meguro & Yamazaki (1995), the distinct element chapters; after Cundall (1971)
Status  one convex body on a flat base
"""

from dem.history import Energies, History, Mode, Outcome
from dem.scenes import Scene, single_block, single_polygon
from dem.shapes import Polygon, polygon, rectangle
from dem.simulate import Motion, simulate
from dem.stability import critical_step, eq7_step

__all__ = [
    "Energies",
    "History",
    "Mode",
    "Motion",
    "Outcome",
    "Polygon",
    "Scene",
    "critical_step",
    "eq7_step",
    "polygon",
    "rectangle",
    "simulate",
    "single_block",
    "single_polygon",
]
