"""Critical time steps: the paper's estimate, and the body's own with both corners of a side down.

Source  Winkler, Meguro & Yamazaki (1995), eq. (7); own derivation below for the body with lagged damping
Status  runs just below the body's limit stay bounded, runs just above it grow (tests)

The time step reads x(k+1) - 2 x(k) + x(k-1) = -dt^2 inv(M) K x(k) - dt inv(M) C (x(k) - x(k-1)), since the
dashpots see the velocity of half a step before. A solution that changes sign at every step without growing,
x(k) = (-1)^k x, marks the border: (4 M - dt^2 K - 2 dt C) x = 0. With C = (c/k) K (kn = ks = k) this is

    dt < (2/om) (sqrt(1 + xi^2) - xi),   om^2 largest eigenvalue of inv(M) K,   xi = c om/(2 k)

so the damping ratio that counts is that of the fastest mode, larger than c/(2 sqrt(k m)) of a single corner.
Each corner at r from the centroid adds J' diag(ks, kn) J to K and c J' J to C, J = [[1, 0, r_z], [0, 1, -r_x]].
"""

from __future__ import annotations

import math

import numpy as np

from dem import checks
from dem.scenes import Scene
from dem.shapes import FloatArray


def eq7_step(mass: float, stiffness: float) -> float:
    """Critical step of one mass on one spring [s]: 2 sqrt(m/k), mass [kg], stiffness [N/m]; eq. (7).

    Raises ValueError unless both are positive and finite.
    """
    checks.positive("mass", mass, "kg")
    checks.positive("stiffness", stiffness, "N/m")
    return 2.0 * math.sqrt(mass / stiffness)


def critical_step(scene: Scene, kn: float, ks: float, damping: float) -> float:
    """Largest stable step [s] with the two corners of any one side on the floor, sticking.

    kn, ks: normal and shear stiffness of a corner [N/m]; damping: dashpot of a corner, both ways [N s/m].
    Fewer corners or sliding ones only raise the limit. More than two corners at once (a nearly straight
    outline pressed deep) would lower it; such a run then ends as unstable.
    Raises ValueError unless the stiffnesses are positive, the damping not negative, all finite.
    """
    checks.kind("scene", scene, Scene, "a Scene, as single_block(b, h, d, density) makes it")
    checks.positive("kn", kn, "N/m")
    checks.positive("ks", ks, "N/m")
    checks.not_negative("damping", damping, "N s/m")
    mass = np.array([scene.mass, scene.mass, scene.inertia])
    pairs = zip(scene.shape.corners, np.roll(scene.shape.corners, -1, axis=0), strict=True)
    return min(step_of_side(levers_of_side(first, second), mass, kn, ks, damping) for first, second in pairs)


def levers_of_side(first: FloatArray, second: FloatArray) -> FloatArray:
    """J of two corners with the side between them flat on the floor, shape (4, 3)."""
    along = (second - first) / np.hypot(*(second - first))
    rows = []
    for corner in (first, second):
        r_x, r_z = corner @ along, corner[1] * along[0] - corner[0] * along[1]
        rows += [[1.0, 0.0, r_z], [0.0, 1.0, -r_x]]
    return np.array(rows)


def step_of_side(levers: FloatArray, mass: FloatArray, kn: float, ks: float, damping: float) -> float:
    """The dt at which the largest eigenvalue of inv(M) (dt^2 K + 2 dt C) reaches 4; it grows with dt."""
    scaled = levers / np.sqrt(mass)
    stiff, loss = np.array([ks, kn, ks, kn]), 2.0 * damping

    def excess(dt: float) -> float:
        weights = dt * dt * stiff + dt * loss
        return float(np.linalg.eigvalsh(scaled.T @ (weights[:, None] * scaled))[-1]) - 4.0

    low, high = 0.0, 2.0 * math.sqrt(float(mass[0]) / kn)  # one spring under the whole mass: always too long
    while high - low > 1e-12 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(middle) < 0.0 else (low, middle)
    return low
