"""How near to each other bodies of an assembly are listed as touching, and how fast they may move in a step for that.

Contacts are looked for within the skin around a body. What crosses it within a step may pass through another body.

Source  none, own rules
Status  the default step is as short as the skin asks for, whatever the masses (tests)
"""

from __future__ import annotations

import math

import numpy as np

from dem.assembly import Assembly
from dem.shapes import FloatArray, Polygon


def default_skin(assembly: Assembly) -> float:
    """An eighth of the shortest edge or least breadth of anything in the scene, but at most a tenth of a typical
    body."""
    return float(min(_shortest(assembly) / 8.0, 0.1 * np.median([body.shape.radius for body in assembly.bodies])))


def widest_skin(assembly: Assembly) -> float:
    """Half of the shortest edge or least breadth [m]: a list that is wider pairs corners with the wrong ends."""
    return 0.5 * _shortest(assembly)


def way_of_turning(assembly: Assembly, angle: float) -> float:
    """How far the farthest corners of any two bodies may go [m] before the two have turned by the angle [rad], with a
    twentieth of it to spare for the last step."""
    turning = sorted(1.0 / body.shape.radius for body in assembly.bodies)[-2:]
    return 0.95 * angle / math.fsum(turning)


def lowest_to_meet(assembly: Assembly) -> float:
    """Height of the lowest thing that a falling body may meet [m]."""
    lowest = min(float(thing.vertices[:, 1].min()) for thing in assembly.things)
    return min(0.0, lowest) if assembly.floor else lowest


def natural_speed(assembly: Assembly, g: float, lowest: float) -> float:
    """Speed [m/s] that the initial motion and a fall to the height `lowest` [m] can make together."""
    highest = max(body.z + 2.0 * body.shape.radius for body in assembly.bodies)
    fastest = max(abs(b.vx) + abs(b.vz) + b.shape.radius * abs(b.omega) for b in assembly.bodies)
    fall = math.sqrt(2.0 * max(g, 1e-3) * (highest - lowest))
    heaviest = max(body.mass for body in assembly.bodies) / min(body.mass for body in assembly.bodies)
    return (fastest + fall) * math.sqrt(heaviest)


def narrowest_skin(assembly: Assembly, g: float, dt: float) -> float:
    """How far two bodies may come nearer to each other in a step [m], unless something shakes them."""
    return 2.0 * dt * natural_speed(assembly, g, lowest_to_meet(assembly))


def longest_step(assembly: Assembly, g: float, skin: float) -> float:
    """The step [s] of which a skin [m] is the narrowest."""
    return skin / narrowest_skin(assembly, g, 1.0)


def _shortest(assembly: Assembly) -> float:
    """Shortest edge or least breadth of anything in the scene [m]."""
    shapes = [thing.shape for thing in assembly.things]
    return float(min(min(_edges(shape).min(), least_breadth(shape)) for shape in shapes))


def _edges(shape: Polygon) -> FloatArray:
    return np.hypot(*(np.roll(shape.corners, -1, axis=0) - shape.corners).T)


def least_breadth(shape: Polygon) -> float:
    """Least distance of two parallel lines that hold the polygon between them [m]."""
    side = np.roll(shape.corners, -1, axis=0) - shape.corners
    normal = np.stack([side[:, 1], -side[:, 0]], axis=1) / _edges(shape)[:, None]
    inward = (normal * shape.corners).sum(axis=1)[:, None] - normal @ shape.corners.T
    return float(inward.max(axis=1).min())
