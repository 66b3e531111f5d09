"""What is simulated: one rigid body above a rigid, flat, infinite base.

Source  Winkler, Meguro & Yamazaki (1995), Table 1: breadth b, height h, depth d of the blocks
Status  one body; the same scene serves tests, timings and studies
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from dem import checks
from dem.shapes import Polygon, polygon, rectangle


@dataclass(frozen=True, repr=False)
class Scene:
    """One prismatic rigid body: its outline, depth [m] and density [kg/m^3]."""

    shape: Polygon
    depth: float
    density: float

    def __repr__(self) -> str:
        return f"<Scene: {self.shape.outline}, mass {self.mass:.4g} kg>"

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return self.density * self.depth * self.shape.area

    @property
    def inertia(self) -> float:
        """Moment of inertia about the centroid [kg m^2]."""
        return self.density * self.depth * self.shape.second_moment


def single_block(b: float, h: float, d: float, density: float) -> Scene:
    """One rectangular block: breadth b, height h, depth d [m], density [kg/m^3].

    Raises ValueError unless all are positive and finite.
    """
    return _scene(rectangle(b, h), d, density)


def single_polygon(vertices: npt.ArrayLike, d: float, density: float) -> Scene:
    """One convex prism: vertices [m], shape (corner, 2), z up; depth d [m]; density [kg/m^3].

    Raises ValueError for a polygon that `dem.shapes.polygon` refuses, or unless d and density are positive.
    """
    return _scene(polygon(vertices), d, density)


def _scene(shape: Polygon, d: float, density: float) -> Scene:
    checks.positive("d", d, "m")
    checks.positive("density", density, "kg/m^3")
    return Scene(shape, float(d), float(density))
