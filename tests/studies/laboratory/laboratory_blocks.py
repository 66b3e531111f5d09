"""A block, floors that shake it and effects on it, as the virtual laboratory and as the package have them."""

import math

import numpy as np

from rocking import Block
from rocking.effects import load
from studies.laboratory import table
from studies.laboratory.parameters import G, uniform

BREADTH, HEIGHT, RESTITUTION, LEAN = 0.2, 0.6, 0.92, 0.16
BLOCK = Block(BREADTH, HEIGHT)
WORLD = uniform(BREADTH, HEIGHT, BLOCK.mass, RESTITUTION)
STEP = 0.001  # s
END = 4.0  # s
TIME = STEP * np.arange(round(END / STEP) + 1)
STILL = np.zeros(TIME.size)


class Growing:
    """A sinusoid at 3 Hz that grows to 7 m/s^2, as both simulators see it."""

    max_step = 0.005
    breakpoints = (0.0,)
    has_pitch = False
    parameters = np.array([7.0 / END, 6.0 * math.pi])

    @staticmethod
    def kernel(xp, t, par):
        return par[0] * t * xp.sin(par[1] * t), 0.0 * t


def floor(ax=STILL, az=STILL, pitch=(STILL, STILL, STILL)):
    return table.pieces(STEP, ax, az, pitch)


AT_REST = floor()
GROWING = floor(Growing.kernel(np, TIME, Growing.parameters)[0])


WEIGHT = BLOCK.mass * G
SAME = {
    "ideal": ([], {}),
    "rounded_edges": ([load("rounded_edges")(radius=0.004)], {"radius": 0.004}),
    "concave_base": ([load("concave_base")(breadth=0.19)], {"half_breadth": 0.095}),
    "mass_distribution": (
        [load("mass_distribution")(height=0.31, inertia=1.05 * WORLD.inertia)],
        {"centre_height": 0.31, "inertia": 1.05 * WORLD.inertia},
    ),
    "base_tilt": ([load("base_tilt")(angle=0.006)], {"tilt": 0.006}),
    "viscous_damping": ([load("viscous_damping")(coefficient=0.2)], {"viscous": 0.2}),
    "quadratic_drag": ([load("quadratic_drag")(coefficient=0.2)], {"quadratic": 0.2}),
    "velocity_dependent_restitution": ([load("velocity_dependent_restitution")(slope=-0.02)], {"slope": -0.02}),
    "base_adhesion": ([load("base_adhesion")(moment=0.01 * WEIGHT)], {"adhesion": 0.01 * WEIGHT}),
    "tether": (
        [load("tether")(slack=0.05, stiffness=0.03 * WEIGHT)],
        {"tether_stiffness": 0.03 * WEIGHT, "tether_plus": 0.05, "tether_minus": 0.05},
    ),
}


class Shaking(Growing):
    """A sinusoid of 6 m/s^2 at 3 Hz."""

    parameters = np.array([6.0, 6.0 * math.pi])

    @staticmethod
    def kernel(xp, t, par):
        return par[0] * xp.sin(par[1] * t), 0.0 * t
