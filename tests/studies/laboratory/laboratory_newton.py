"""What the contact gives a block that rocks and slides on a floor that moves and turns, by Newton from the ground."""

import math
from dataclasses import replace

import numpy as np

from studies.laboratory.parameters import World

from .laboratory_blocks import WORLD

ODD = replace(WORLD, radius=0.012, offset=0.007, tilt=0.02, viscous=0.4, tether_stiffness=30.0, tether_plus=0.1,
              tether_minus=0.15, friction=0.3, gravity=9.7)  # fmt: skip


def cubics(rng: np.random.Generator) -> np.ndarray:
    """A piece of the floor's motion (a_x, a_z, pitch and its rates) whose every coefficient matters at 0.1 s."""
    size = np.array([5.0, 3.0, 0.05, 0.5, 5.0])[:, None] * 10.0 ** np.arange(4)
    return size * rng.uniform(-1.0, 1.0, (5, 4))


def motion_of_floor(c: np.ndarray, x: float) -> list[float]:
    """(a_x, a_z, pitch, rate, acceleration) at x."""
    return [float(np.polynomial.Polynomial(row)(x)) for row in c]


def forces(world: World, c: np.ndarray, x: float, s: float, turned: tuple, foot: tuple) -> tuple[float, float, float]:
    """(force along the floor, across it, moment about the centre of mass that is left over), all over the mass.

    What the contact has to give, so that the centre goes as it does: second differences of its place, seen from the
    ground, of a block with rotation, velocity and acceleration `turned` whose foot has place, velocity and
    acceleration `foot`.
    """
    a_x, a_z, pitch, turning, turn_acc = motion_of_floor(c, x)
    angle, rest = world.tilt + pitch, world.half_breadth - world.radius

    def place(t: float) -> np.ndarray:
        theta, slid = (q[0] + q[1] * t + 0.5 * q[2] * t * t for q in (turned, foot))
        lean = angle + turning * t + 0.5 * turn_acc * t * t
        arm = world.offset - s * rest, world.centre_height - world.radius
        along = s * rest + world.radius * theta + slid + arm[0] * math.cos(theta) + arm[1] * math.sin(theta)
        up = world.radius - arm[0] * math.sin(theta) + arm[1] * math.cos(theta)
        return np.array([0.5 * a_x * t * t + along * math.cos(lean) + up * math.sin(lean),
                         0.5 * a_z * t * t - along * math.sin(lean) + up * math.cos(lean)])  # fmt: skip

    h = 2e-3  # sixth order: 1e-10 of the derivative by truncation and by rounding
    weights = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / (180.0 * h * h)
    force = sum(w * place(k * h) for w, k in zip(weights, range(-3, 4), strict=True)) + np.array([0.0, world.gravity])
    along, across = force @ [math.cos(angle), -math.sin(angle)], force @ [math.sin(angle), math.cos(angle)]
    theta = turned[0]
    arm = world.offset - s * rest, world.centre_height - world.radius
    ahead = arm[0] * math.cos(theta) + arm[1] * math.sin(theta)
    high = world.radius - arm[0] * math.sin(theta) + arm[1] * math.cos(theta)
    about_foot = world.inertia / world.mass + ahead**2 + high**2
    slack = world.tether_plus if theta > 0 else world.tether_minus
    pull = world.tether_stiffness / world.mass * math.copysign(max(0.0, abs(theta) - slack), theta)
    own = -about_foot * world.viscous * turned[1] - pull
    # The foot is at -ahead, -high from the centre; clockwise is positive.
    moment = ahead * across - high * along + own - world.inertia / world.mass * (turned[2] + turn_acc)
    return along, across, moment
