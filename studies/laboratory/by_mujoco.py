"""The block in MuJoCo: rigid bodies, contact and friction by an engine that this project did not write.

A box on a plane, or where its edges are round two capsules for edges; it moves in the plane alone.  What the floor
does acts as a force on the centre of mass.  Nothing about impacts is put in: the contact is as stiff as the step
allows and does not bounce, and the ratio of angular speeds over an impact comes out as conservation of momentum about
the new edge has it, within 0.3 % (`ratio_by_momentum`).  Viscous damping is that of a joint, a tether a tendon with a
dead band.  Limits: an edge may fly for some thousandths of a second after an impact; slip lifts a contact a little
(the cone of friction is relaxed), so that a block rocks at a friction of 0.96 b/h, which can only slide.

Source   Todorov, Erez & Tassa (2012), IEEE/RSJ IROS, 5026-5033; needs the package mujoco.
Status   against event.py, which has impacts at an instant, with each effect that both have (tests).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from .effects import HOLDS, Lab
from .event import FALLEN, Response
from .parameters import World, refuse

STEP = 5e-5  # s
SOFTNESS = 4.0 * STEP
"""Time constant of a contact [s]; of two steps the impacts scatter."""
FOREIGN = (
    "quadratic", "adhesion", "slope", "side", "leak", "bedding", "grind", "heed", "cubic", "hinge", "guide",
    "side_viscous", "squeeze", "brake", "rib", "magnet", "layer", "slosh_mass", "stiffness",
)  # fmt: skip
"""What is not built in MuJoCo here."""


def package() -> Any:
    """MuJoCo.

    Raises:
        ValueError: it is not installed.
    """
    try:
        import mujoco
        import mujoco.rollout
    except ModuleNotFoundError as error:
        raise ValueError(f"engine='mujoco': {error}; want the package mujoco (python -m pip install mujoco)") from None
    return mujoco


def check(lab: Lab) -> None:
    """Whether a block in MuJoCo has all that is odd about this laboratory.

    Raises:
        ValueError: it has not.
    """
    refuse(lab.world, FOREIGN, "of the engine 'mujoco'")
    refuse(lab.table, ("pitch_acceleration", "pitch_displacement"), "of the engine 'mujoco'")
    refuse(lab, ("wear", "courses"), "of the engine 'mujoco'")  # restitution is what comes out of the contact


def _edges(world: World) -> Iterator[str]:
    """What the block touches the floor with, about its centre of mass."""
    b, h, r = world.half_breadth, world.centre_height, world.radius
    if r == 0.0:
        yield f'<geom type="box" size="{b:.17g} {b:.17g} {h:.17g}" pos="{-world.offset:.17g} 0 0"/>'
        return
    for side in (-1.0, 1.0):
        x, z = side * (b - r) - world.offset, r - h
        yield f'<geom type="capsule" size="{r:.17g}" fromto="{x:.17g} {-b:.17g} {z:.17g} {x:.17g} {b:.17g} {z:.17g}"/>'


def ratio_by_momentum(world: World) -> float:
    """Angular speed after an impact over that before of a block that stood on two edges, the offset left out [1].

    Angular momentum about the new edge is kept (Housner, 1963, for sharp edges).
    """
    reach, h, c = world.half_breadth - world.radius, world.centre_height, world.inertia / world.mass
    return (c + h**2 - reach**2) / (c + h**2 + reach**2)


def _tether(world: World) -> str:
    if world.tether_stiffness == 0.0:
        return ""
    far = 10.0  # rad, where the block never is
    low, high = -min(world.tether_minus, far), min(world.tether_plus, far)
    return (
        f'<tendon><fixed springlength="{low:.17g} {high:.17g}" stiffness="{world.tether_stiffness:.17g}">'
        '<joint joint="theta" coef="1"/></fixed></tendon>'
    )


def written(world: World) -> str:
    """The model in MuJoCo's own language."""
    mu = HOLDS if math.isinf(world.friction) else world.friction
    inertia = world.inertia
    # The block feels damping by the inertia about the edge that it stands on, the offset left out.
    reach = world.half_breadth - world.radius
    damping = world.viscous * (inertia + world.mass * (reach**2 + world.centre_height**2))
    return f"""<mujoco>
<option timestep="{STEP:.17g}" gravity="0 0 0" integrator="implicitfast" cone="elliptic" impratio="100"
  tolerance="1e-12" iterations="100"/>
<default><geom friction="{mu:.17g} 0 0" condim="3" solref="{SOFTNESS:.17g} 1" solimp="0.99 0.9999 1e-6"/></default>
<worldbody>
<geom type="plane" size="5 5 1"/>
<body>
<inertial pos="0 0 0" mass="{world.mass:.17g}" diaginertia="{inertia:.17g} {inertia:.17g} {inertia:.17g}"/>
<joint name="x" type="slide" axis="1 0 0"/>
<joint name="z" type="slide" axis="0 0 1"/>
<joint name="theta" type="hinge" axis="0 1 0" damping="{damping:.17g}"/>
{"".join(_edges(world))}
</body>
</worldbody>
{_tether(world)}
<actuator><motor joint="x" gear="{world.mass:.17g}"/><motor joint="z" gear="{world.mass:.17g}"/></actuator>
</mujoco>"""


def _field(world: World, felt: np.ndarray, h: float, sub: int) -> np.ndarray:
    """What the floor does at the middle of every step, shape (steps, (x, z))."""
    if np.any(felt[:, 2:]):
        raise ValueError("table_pitch: not in the laboratory of the engine 'mujoco', whose floor cannot turn")
    t = h / sub * (np.arange(sub) + 0.5)
    powers = t[:, None] ** np.arange(4)
    ax, az = (np.einsum("nk,sk->ns", felt[:, k], powers).ravel() for k in (0, 1))
    sin, cos = math.sin(world.tilt), math.cos(world.tilt)
    down = world.gravity + az
    return np.stack([down * sin - ax * cos, -down * cos - ax * sin], axis=1)


def _start(world: World, theta0: float) -> tuple[float, float, float]:
    """Centre of mass (x, z) and tilt of a block that touches the floor and does not move."""
    s = -1.0 if theta0 < 0.0 else 1.0
    r, phi = world.radius, abs(theta0)
    u, w = s * world.offset - (world.half_breadth - r), world.centre_height - r
    z = r - u * math.sin(phi) + w * math.cos(phi)
    x = world.half_breadth - r + r * phi + u * math.cos(phi) + w * math.sin(phi)
    return s * x, z, theta0


def simulate(world: World, felt: np.ndarray, h: float, every: int, theta0: float) -> Response:
    """Rotation of a block in MuJoCo; there is no list of impacts, and `world.restitution` has no say.

    Accelerations are not told: a contact lets go for single steps, in which they are those of a flight.

    Raises:
        ValueError: the world has an effect that is not built here, or MuJoCo is not installed.
    """
    mujoco = package()
    refuse(world, FOREIGN, "of the engine 'mujoco'")
    sub = max(1, round(h / STEP))
    model = mujoco.MjModel.from_xml_string(written(world))
    model.opt.timestep = h / sub
    data = mujoco.MjData(model)
    data.qpos[:3] = _start(world, theta0)
    pushes = _field(world, felt, h, sub)
    whole = mujoco.mjtState.mjSTATE_FULLPHYSICS
    first = np.zeros(mujoco.mj_stateSize(model, whole))
    mujoco.mj_getState(model, data, first, whole)
    states, _ = mujoco.rollout.rollout(model, data, first[None], pushes[None])
    # A state is the time, then the places and the speeds of the joints.
    moves = np.concatenate([first[None], states[0]])[:, 1:]
    theta = moves[:, 2]
    at = sub * every * np.arange(felt.shape[0] // every + 1)
    rotation, velocity = theta[at].copy(), moves[at, model.nq + 2].copy()
    down = np.flatnonzero(np.abs(theta) > FALLEN)
    fell = None
    if down.size:
        fell = int(down[0] // (sub * every)) + 1
        rotation[fell:], velocity[fell:] = np.nan, np.nan
    time = h * every * np.arange(at.size)
    return Response(time, rotation, velocity, np.full(at.size, np.nan), np.zeros((0, 3)), fell)
