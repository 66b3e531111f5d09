"""The scenes of `dem` in MuJoCo and pymunk: the same outlines, masses, friction and base motion, each engine's own
contacts.

The table's motion enters as gravity that changes, as in `dem`. MuJoCo's bodies slide in x and z and turn about y; its
contacts are set as stiff as its step allows, critically damped. pymunk's are rigid, without bounce.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
import pymunk

import dem

G = 9.80665
Look = Callable[[np.ndarray, np.ndarray], bool]


def mujoco_model(scene: dem.Assembly, friction: float, step: float) -> Any:
    """Boxes that touch each other and a plane; every body of the scene must be a rectangle that stands upright."""
    bodies = "".join(
        f'<body pos="{body.x} 0 {body.z}"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
        f'<joint type="hinge" axis="0 1 0"/>'
        f'<geom type="box" size="{x} {body.depth / 2} {z}" mass="{body.mass}"/></body>'
        for body in scene.bodies
        for x, z in [np.ptp(body.shape.corners, axis=0) / 2.0]
    )
    text = f"""<mujoco><option timestep="{step}" cone="elliptic" impratio="10"/>
      <default><geom friction="{friction} 0 0" solref="{2.0 * step} 1" condim="3"/></default>
      <worldbody><geom type="plane" size="0 0 1"/>{bodies}</worldbody></mujoco>"""
    return mujoco.MjModel.from_xml_string(text)


def run_mujoco(
    scene: dem.Assembly, motion: dem.Motion, t_end: float, step: float, friction: float, stop: Look
) -> float:
    """Time at which `stop(height, tilt)` of the bodies first holds, looked at every 10 ms [s]; t_end if never."""
    model = mujoco_model(scene, friction, step)
    data = mujoco.MjData(model)
    start = np.array([body.z for body in scene.bodies])
    steps, every = math.ceil(t_end / step), max(1, round(0.01 / step))
    a_x, a_z = motion(np.arange(steps) * step)
    for k in range(steps):
        model.opt.gravity[:] = (-a_x[k], 0.0, -G - a_z[k])
        mujoco.mj_step(model, data)
        if k % every == 0 and stop(start + data.qpos[1::3], data.qpos[2::3]):
            return k * step
    return t_end


def run_pymunk(
    scene: dem.Assembly, motion: dem.Motion, t_end: float, step: float, friction: float, stop: Look
) -> float:
    """As `run_mujoco`; tilts clockwise positive."""
    space = pymunk.Space()
    space.iterations, space.collision_slop = 30, 1e-5
    ground = pymunk.Segment(space.static_body, (-1e3, -1.0), (1e3, -1.0), 1.0)
    ground.friction = math.sqrt(friction)  # the engine multiplies the two of a pair
    space.add(ground)
    made = []
    for body in scene.bodies:
        thing = pymunk.Body(body.mass, body.inertia)
        thing.position = (body.x, body.z)
        shape = pymunk.Poly(thing, body.shape.corners.tolist())
        shape.friction = math.sqrt(friction)
        space.add(thing, shape)
        made.append(thing)
    steps, every = math.ceil(t_end / step), max(1, round(0.01 / step))
    a_x, a_z = motion(np.arange(steps) * step)
    for k in range(steps):
        space.gravity = (-float(a_x[k]), -G - float(a_z[k]))
        space.step(step)
        if k % every == 0 and stop(
            np.array([thing.position.y for thing in made]), np.array([-thing.angle for thing in made])
        ):
            return k * step
    return t_end
