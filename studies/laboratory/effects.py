"""What can be wrong with a rocking test: the named effects, and some that have no name.

An effect takes a laboratory, a few fixed random numbers (`Draw`) and a strength (1 is middling), and returns the
laboratory with the effect and its true parameters by the names that the loop would use.  Strength scales every
departure from the ideal, so that a campaign can be made as visible as one likes without changing its kind.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from .parameters import World
from .table import Table

Parameters = dict[str, float]


@dataclass(frozen=True)
class Sensors:
    """What the instruments make of the truth: recorded rotation = gain (x + cubic x^3) + offset, x behind a play."""

    rotation_gain: float = 1.0
    rotation_offset: float = 0.0
    rotation_cubic: float = 0.0  # 1/rad^2
    rotation_play: float = 0.0  # rad, half of the gap in the linkage, in whose middle it is when the block is upright
    base_gain: float = 1.0  # true over recorded
    base_lag: float = 0.0  # s, how late the record is
    base_corner: float = 0.0  # Hz, below which the base sensor, coupled through a capacitor, loses slow motion

    def reads(self, theta: np.ndarray) -> np.ndarray:
        """Reading of the rotation sensor [rad] at the samples of a test, shape (time,), NaN where there is none."""
        x = theta if self.rotation_play == 0.0 else _behind(theta, self.rotation_play)
        return self.rotation_gain * (x + self.rotation_cubic * x**3) + self.rotation_offset


def _behind(theta: np.ndarray, play: float) -> np.ndarray:
    out, at = np.full(theta.size, math.nan), 0.0
    for k in np.flatnonzero(np.isfinite(theta)):
        if abs(theta[k] - at) > play:
            at = theta[k] - math.copysign(play, theta[k] - at)
        out[k] = at
    return out


@dataclass(frozen=True)
class Course:
    """How one of the numbers of a laboratory changes in the course of a campaign."""

    of: str  # "world" or "sensors"
    name: str
    change: float  # from one test to the next, or all at once
    fading: float = 0.0  # by which each such change is less than the one before, as exp(-fading)
    before: int = 0  # the test before which it happens all at once; from test to test if 0

    def after(self, tests: int) -> float:
        """What has come about after so many tests."""
        if self.before:
            return self.change if tests >= self.before else 0.0
        return self.change * sum(math.exp(-self.fading * k) for k in range(tests))


GRIPS = 1.4
"""Friction of corners on springs where none is declared: they slip where they are about to leave, and hardly else."""


@dataclass(frozen=True)
class Lab:
    """Everything that decides what a record says."""

    world: World
    table: Table = field(default_factory=Table)
    sensors: Sensors = field(default_factory=Sensors)
    engine: str = "event"
    wear: float = 0.0  # loss of restitution from one test to the next
    courses: tuple[Course, ...] = ()
    uses: tuple[float, ...] = ()  # rad^2/s^2, of a block that is ground: use before each test in order, and after all
    grip: float = GRIPS  # friction of corners on springs


@dataclass(frozen=True)
class Draw:
    """Fixed random numbers of one planted effect."""

    sign: float
    size: float  # in [0, 1]
    other: float  # in [0, 1]
    choice: float  # in [0, 1]

    def between(self, low: float, high: float) -> float:
        """Log-uniform by `size`."""
        return float(low * (high / low) ** self.size)


def draw(rng: np.random.Generator) -> Draw:
    """Numbers for one effect."""
    return Draw(float(rng.choice([-1.0, 1.0])), *rng.uniform(size=3).tolist())


Effect = Callable[[Lab, Draw, float], tuple[Lab, Parameters]]


def _world(lab: Lab, **changes: Any) -> Lab:
    return replace(lab, world=replace(lab.world, **changes))


HAVE_IT_TOO = {("slip", "mujoco"), ("contact", "dem")}
"""What an effect asks for, and what does as well."""
SETS = {"slip": {"friction": math.inf}, "contact": {"stiffness": 0.0}}
"""What an effect that asks for an engine sets, and its value before."""


def _in(engine: str, lab: Lab) -> Lab:
    """The laboratory with that engine, or with one that has what is asked of it.

    Raises:
        ValueError: another one is chosen, and no engine has both, or another effect has set what this one sets.
    """
    if (engine, lab.engine) in HAVE_IT_TOO:
        for name, absent in SETS[engine].items():
            if getattr(lab.world, name) != absent:
                raise ValueError(f"{name}={getattr(lab.world, name):g}: another effect has set it already")
        return lab
    if lab.engine != "event":
        raise ValueError(f"engine={engine!r}: the laboratory is of {lab.engine!r} already, and no engine has both")
    return replace(lab, engine=engine)


def rounded_edges(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    r = min(0.3, k * d.between(0.008, 0.03)) * lab.world.half_breadth
    return _world(lab, radius=r), {"radius": r}


def concave_base(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    b = lab.world.half_breadth * (1.0 - min(0.3, k * d.between(0.004, 0.015)))
    return _world(lab, half_breadth=b), {"breadth": 2 * b}


def base_tilt(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    angle = d.sign * min(0.2 * lab.world.alpha, k * d.between(0.0015, 0.006))
    return _world(lab, tilt=angle), {"angle": angle}


def eccentric_mass(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    offset = d.sign * min(0.15, k * d.between(0.006, 0.02)) * lab.world.half_breadth
    return _world(lab, offset=offset), {"offset": offset}


def mass_distribution(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    height = lab.world.centre_height * (1.0 + d.sign * min(0.2, k * d.between(0.004, 0.02)))
    inertia = lab.world.inertia * (1.0 + (2 * d.other - 1) * min(0.3, 0.05 * k))
    return _world(lab, centre_height=height, inertia=inertia), {"height": height, "inertia": inertia}


def table_pitch(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    if d.choice < 0.5:
        p = d.sign * k * d.between(1e-5, 5e-5)
        return replace(lab, table=replace(lab.table, pitch_acceleration=p)), {"per_acceleration": p}
    p = d.sign * k * d.between(0.005, 0.03)
    return replace(lab, table=replace(lab.table, pitch_displacement=p)), {"per_displacement": p}


def vertical_motion(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    size = d.sign * k * d.between(0.02, 0.1)
    if d.choice < 0.5:
        return replace(lab, table=replace(lab.table, vertical=size)), {"ratio": size}
    table = replace(lab.table, vertical_second=abs(size), vertical_phase=2 * np.pi * d.other)
    # cos(2 phi + psi) in terms of cos(2 phi) and sin(2 phi).
    parts = abs(size) * np.cos(table.vertical_phase), -abs(size) * np.sin(table.vertical_phase)
    return replace(lab, table=table), {"second_harmonic_ratio": parts[0], "second_harmonic_quadrature": parts[1]}


HOLDS = 2.0
"""Friction that is more than any shaking asks for."""


def compliant_base(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """Two springs with dashpots."""
    lab = _in("contact", lab)
    stiffness, damping = _soft(lab, d, k)
    give = _give(lab, d)
    soft = _world(lab, stiffness=stiffness, damping=damping, springs=2.0, friction=lab.grip, give=give)
    return soft, {"corner_stiffness": stiffness, "tangential_ratio": 1.0 / give}


def winkler_bed(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """A bed, as stiff in all as two corners of this stiffness: the same effect by name."""
    lab = _in("contact", lab)
    stiffness, damping = _soft(lab, d, k)
    give = _give(lab, d)
    bed = _world(lab, stiffness=2 * stiffness, damping=2 * damping, springs=15.0, friction=lab.grip, give=give)
    return bed, {"corner_stiffness": stiffness, "tangential_ratio": 1.0 / give}


def _give(lab: Lab, d: Draw) -> float:
    """Of a corner along the floor over that across it: an element gives both ways alike, bodies about as much."""
    return 1.0 if lab.engine == "dem" else float(1.0 / (0.6 * 5.0**d.choice))


def _soft(lab: Lab, d: Draw, k: float) -> tuple[float, float]:
    sink = min(2e-3, k * d.between(2e-5, 2e-4))  # m, of the block at rest
    stiffness = float(0.5 * lab.world.mass * lab.world.gravity / sink)
    return stiffness, float(2 * (0.1 + 0.3 * d.other) * np.sqrt(stiffness * 0.5 * lab.world.mass))


def velocity_dependent_restitution(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    slope = -k * d.between(0.005, 0.03)
    return _world(lab, slope=slope), {"slope": slope}


def viscous_damping(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    c = k * d.between(0.01, 0.08)
    return _world(lab, viscous=c), {"coefficient": c}


def quadratic_drag(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    c = k * d.between(0.03, 0.3)
    return _world(lab, quadratic=c), {"coefficient": c}


def sliding(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    # A tenth above b/h it hardly slides, below it never rocks; more strength is less friction.
    mu = lab.world.half_breadth / lab.world.centre_height * (1.01 + 0.06 * (0.4 + d.size) / k)
    return _world(_in("slip", lab), friction=mu), {"friction": mu}


def bouncing(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    lab = _in("contact", lab)
    e_n = min(0.8, 0.4 * k * (0.5 + d.size))
    log = np.log(e_n)
    ratio = -log / np.sqrt(np.pi**2 + log**2)
    w = lab.world
    give = _give(lab, d)
    # The corner feels less than the whole block: 1/m_eff = 1/m + b^2/I.
    felt = 1.0 / (1.0 / w.mass + w.half_breadth**2 / w.inertia)
    stiffness = felt * (2 * np.pi * (150.0 + 300.0 * d.other)) ** 2
    hard = _world(
        lab,
        stiffness=stiffness,
        damping=2 * ratio * np.sqrt(stiffness * felt),
        springs=2.0,
        friction=lab.grip,
        give=give,
    )
    return hard, {"normal_restitution": e_n, "tangential_ratio": 1.0 / give}


def base_motion_gain(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    gain = 1.0 + d.sign * min(0.3, k * d.between(0.005, 0.04))
    return replace(lab, sensors=replace(lab.sensors, base_gain=gain)), {"gain": gain}


def base_motion_lag(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    lag = d.sign * min(0.05, k * d.between(1e-3, 8e-3))
    return replace(lab, sensors=replace(lab.sensors, base_lag=lag)), {"lag": lag}


def rotation_gain(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    gain = 1.0 + d.sign * min(0.3, k * d.between(0.005, 0.04))
    return replace(lab, sensors=replace(lab.sensors, rotation_gain=gain)), {"gain": gain}


def rotation_offset(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    offset = d.sign * k * d.between(1e-3, 5e-3)
    return replace(lab, sensors=replace(lab.sensors, rotation_offset=offset)), {"offset": offset}


def tether(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    w = lab.world
    slack = (0.15 + 0.3 * d.other) * w.alpha
    stiffness = k * d.between(0.03, 0.3) * w.mass * w.gravity * np.hypot(w.half_breadth, w.centre_height)
    plus, minus = d.choice > 1 / 3, d.choice < 2 / 3  # a third each: -x alone, both, +x alone
    pulled = _world(
        lab, tether_stiffness=stiffness, tether_plus=slack if plus else np.inf, tether_minus=slack if minus else np.inf
    )
    return pulled, {"slack": slack, "stiffness": stiffness}


def base_adhesion(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    moment = k * d.between(0.05, 0.3) * lab.world.mass * lab.world.gravity * lab.world.half_breadth
    return _world(lab, adhesion=moment), {"moment": moment}


def restitution_by_side(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    return _world(lab, side=d.sign * min(0.03, k * d.between(0.002, 0.01))), {}


def wear(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """Each test leaves the edges a little blunter: restitution falls from test to test."""
    return replace(lab, wear=min(0.012, k * d.between(0.001, 0.004))), {}


def crumbling_edges(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """The edges lose a little in each test, ever less."""
    lost = min(0.01, k * d.between(0.001, 0.004)) * lab.world.half_breadth
    return replace(lab, courses=(*lab.courses, Course("world", "half_breadth", -lost, 0.05 + 0.3 * d.other))), {}


def settling_floor(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """The floor is level at first, and leans a little more after each test."""
    angle = d.sign * min(0.02 * lab.world.alpha, k * d.between(0.0002, 0.001))
    return replace(lab, courses=(*lab.courses, Course("world", "tilt", angle))), {}


def shifted_load(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """Something in the block goes to another place in the middle of the campaign."""
    offset = d.sign * min(0.1, k * d.between(0.006, 0.02)) * lab.world.half_breadth
    moved = Course("world", "offset", offset, before=3 + int(4 * d.other))
    return replace(lab, courses=(*lab.courses, moved)), {}


def warming_sensor(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """The rotation sensor has another gain in each test as it warms up."""
    gain = d.sign * min(0.05, k * d.between(0.002, 0.01))
    return replace(lab, courses=(*lab.courses, Course("sensors", "rotation_gain", gain, 0.1 + 0.3 * d.other))), {}


def cubic_torque(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    w = lab.world
    p2 = w.mass * w.gravity * np.hypot(w.half_breadth, w.centre_height) / w.corner_inertia
    return _world(lab, cubic=d.sign * min(0.5, k * d.between(0.02, 0.1)) * p2 / w.alpha**2), {}


def hinge_friction(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    return _world(lab, hinge=k * d.between(0.05, 0.4)), {}


def one_sided_friction(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """A guide rubs on one side of the block while it leans that way."""
    w = lab.world
    p2 = w.mass * w.gravity * np.hypot(w.half_breadth, w.centre_height) / w.corner_inertia
    return _world(lab, guide=k * d.between(0.002, 0.02) * p2 * w.alpha), {}


def squeezed_air(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """Air goes out of and into the gap under the base, which takes most while it is narrow."""
    width = (0.03 + 0.1 * d.other) * lab.world.alpha
    return _world(lab, squeeze=k * d.between(0.1, 0.8), squeeze_width=width), {}


def one_sided_damping(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    return _world(lab, side_viscous=k * d.between(0.02, 0.15)), {}


def one_sided_brake(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """A vane passes a magnet at one rotation, more or less on one side: eddy currents."""
    w = lab.world
    p = np.sqrt(w.mass * w.gravity * np.hypot(w.half_breadth, w.centre_height) / w.corner_inertia)
    at, width = (0.2 + 0.25 * d.other) * w.alpha, (0.08 + 0.1 * d.choice) * w.alpha
    return _world(lab, brake=k * d.between(0.02, 0.2) * p, brake_at=d.sign * at, brake_width=width), {}


def leaking_restitution(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """The less time since the last impact, the more is lost: air under the base has not come back."""
    return _world(lab, leak=min(0.2, k * d.between(0.01, 0.05)), leak_time=0.15 + 0.25 * d.other), {}


def bedding_in(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """The first impacts of a test lose more than the later ones."""
    return _world(lab, bedding=min(0.2, k * d.between(0.01, 0.04))), {}


def grinding(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """Impacts crush the edges, the more the faster they are, and for all tests to come."""
    w = lab.world
    p2 = w.mass * w.gravity * np.hypot(w.half_breadth, w.centre_height) / w.corner_inertia
    # An impact from half the balance angle has 0.75 p^2 alpha^2; a campaign has a hundred or two of them.
    use = (20.0 + 100.0 * d.other) * p2 * w.alpha**2
    return _world(lab, grind=min(0.1, k * d.between(0.01, 0.04)), grind_use=use), {}


def heedful_impacts(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """An impact loses more if the base is accelerated along with the falling block, and less if against it."""
    return _world(lab, heed=d.sign * min(0.02, k * d.between(0.004, 0.012))), {}


def one_sided_cable(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """A cable rubs while the block leans far toward one side."""
    hung, _ = one_sided_friction(lab, d, k)
    return _world(hung, guide_from=(0.15 + 0.3 * d.other) * lab.world.alpha), {}


def ribbed_cable(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """A cable runs over an edge with ribs: a torque periodic in rotation."""
    return _world(lab, rib=d.sign * k * d.between(0.05, 0.4), rib_period=(0.2 + 0.4 * d.other) * lab.world.alpha), {}


def magnet(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """Something under the base pulls, the less the further the base is."""
    return _world(lab, magnet=k * d.between(0.05, 0.4), magnet_width=(0.02 + 0.08 * d.other) * lab.world.alpha), {}


def hysteretic_layer(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    w = lab.world
    stiffness = k * d.between(0.02, 0.2) * w.mass * w.gravity * np.hypot(w.half_breadth, w.centre_height)
    return _world(lab, layer=stiffness, layer_width=(0.03 + 0.12 * d.other) * w.alpha), {}


def slosh(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """A mass hangs inside the block, over and above what was weighed."""
    w = lab.world
    mass = min(0.1, k * d.between(0.001, 0.01)) * w.mass
    height = w.centre_height * (1.0 + 0.8 * d.other)
    hung = _world(
        lab, slosh_mass=mass, slosh_length=0.25 * w.centre_height, slosh_height=height, slosh_damping=0.3 + d.choice
    )
    return hung, {}


def curved_sensor(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """The rotation sensor is not linear."""
    cubic = d.sign * min(0.15, k * d.between(0.01, 0.05)) / lab.world.alpha**2
    return replace(lab, sensors=replace(lab.sensors, rotation_cubic=cubic)), {}


def loose_linkage(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """The rotation sensor is driven through a joint that has play."""
    play = min(0.05, k * d.between(0.001, 0.005)) * lab.world.alpha
    return replace(lab, sensors=replace(lab.sensors, rotation_play=play)), {}


def coupled_sensor(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """The sensor of the base is coupled through a capacitor."""
    return replace(lab, sensors=replace(lab.sensors, base_corner=min(1.0, k * d.between(0.01, 0.1)))), {}


def sprung_table(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """The block stands on a plate that gives, and the sensor of the base is below it."""
    frequency = (12.0 + 10.0 * d.other) / math.sqrt(k * d.between(0.5, 2.0))
    table = replace(lab.table, plate_frequency=max(8.0, frequency), plate_damping=0.03 + 0.1 * d.choice)
    return replace(lab, table=table), {}


def gusts(lab: Lab, d: Draw, k: float) -> tuple[Lab, Parameters]:
    """A fan that blows at the same times in each test: a force that depends on nothing but the time."""
    size = d.sign * min(0.2, k * d.between(0.005, 0.05)) * lab.world.alpha * lab.world.gravity
    blows = tuple((middle, size, 0.15 + 0.15 * d.choice) for middle in (0.8 + d.other, 3.0 + d.other, 6.5))
    return replace(lab, table=replace(lab.table, gusts=blows)), {}


NAMED: dict[str, Effect] = {
    f.__name__: f
    for f in (
        rounded_edges, concave_base, base_tilt, eccentric_mass, mass_distribution, table_pitch, vertical_motion,
        compliant_base, winkler_bed, velocity_dependent_restitution, viscous_damping, quadratic_drag, sliding, bouncing,
        base_motion_gain, base_motion_lag, rotation_gain, rotation_offset, tether, base_adhesion,
    )
}  # fmt: skip
UNNAMED: dict[str, Effect] = {
    f.__name__: f
    for f in (
        restitution_by_side, wear, cubic_torque, hinge_friction, one_sided_friction, one_sided_damping, squeezed_air,
        one_sided_brake, leaking_restitution, bedding_in, grinding, heedful_impacts, one_sided_cable, ribbed_cable,
        magnet, hysteretic_layer, slosh, curved_sensor, loose_linkage, coupled_sensor, sprung_table, gusts,
        crumbling_edges, settling_floor, shifted_load, warming_sensor,
    )
}  # fmt: skip

SPOKEN = {"winkler_bed": "compliant_base"}
"""What the loop calls an effect, where it is not by the name here."""

TWINS: tuple[frozenset[str], ...] = (
    # Same balance angles on both sides to first order.
    frozenset({"base_tilt", "eccentric_mass"}),
    # Rotation under a horizontal base knows the block by p and the balance angle alone.
    frozenset({"concave_base", "mass_distribution"}),
)
