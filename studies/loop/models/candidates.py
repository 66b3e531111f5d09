"""What the loop tries: effects with the parameters to fit, where to start and how far they may go.

An effect may be tried in several forms (a pitch with the acceleration or with the displacement; a tether on either
side).  Starts are sizes at which an effect is plainly visible in a usual campaign, on either side of nothing.

Status   sizes are in terms of the block, so that they serve a tombstone and a matchbox alike.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from rocking import G_STANDARD
from rocking.effects import load
from rocking.form import Form
from rocking.soft_floor import BlockOnSoftFloor
from studies.campaigns import DeclaredBlock
from studies.loop.models.model import CHANGE, RESTITUTION, LoopModel
from studies.loop.models.parameters import UNEVEN, Parameter


@dataclass(frozen=True)
class Candidate:
    """A form of an effect: parameters to fit, values to start from, and parameters that stay as they are."""

    name: str  # of this form: the effect's, with what is special about it in brackets
    effect: str
    parameters: tuple[Parameter, ...]
    starts: tuple[Mapping[str, float], ...]
    fixed: Mapping[str, float]
    smooth: bool = True  # whether it has a derivative at its absent value: a score says something
    in_swings: bool = True  # whether swings show it; else whole records alone do
    slips: bool = False  # whether a window begins with a slip that no rotation shows and that is carried over to it
    scanned: tuple[Mapping[str, float], ...] = ()  # values at which whole records are tried where swings do not tell
    replaces_restitution: bool = False  # whether the loss of an impact follows from its own parameters
    costly: bool = False  # whether a run takes tens of times as long as that of a rigid block: fewer rivals are tried
    scouts: tuple[str, ...] = ()  # parameters fitted from each start, the others from the best few alone; all if empty
    scored: int = 0  # so many starts are begun from, those with the largest score of a scout at nothing; all if 0
    screened: int = 0  # so many starts are fitted, those that explain most as they are; all if 0
    parts: int = 0  # of so many parts of the starts, in their order, the best one is fitted besides, without scouts
    after: str = ""  # a form that is tried before; where that promises nothing, this one is left out
    # A parameter of another effect, and the value of it up to which that is the name, by form of the effect.
    beyond: tuple[str, Mapping[str, float]] | None = None
    # Its own parameters, from a model with a form of `beyond` that is the same thing.
    same_as: Callable[[LoopModel], Mapping[str, float]] | None = None
    minima_in: str = ""  # a parameter in which whole records have minima beside each other
    assumed: Mapping[str, float] = field(default_factory=dict)  # of those that stay: other values that may be as right
    otherwise: tuple[Mapping[str, float], ...] = ()  # of those that stay: other laws of the same thing
    also: tuple[str, ...] = ()  # further effects that it is at once

    def nothing(self, block: DeclaredBlock) -> dict[str, float]:
        """Its own parameters at their absent values: what adds nothing where the effect is there in another form."""
        absent = self.absent(block)
        return {p.name: absent[p.name] for p in self.parameters} | dict(self.fixed)

    def absent(self, block: DeclaredBlock) -> dict[str, float]:
        """Full names and values of the parameters at which it is not there."""
        if all("." not in p.name for p in self.parameters):
            return {p.name: 0.0 for p in self.parameters}
        values = {
            effect: load(effect).absent(_block(block)) for effect in (self.effect, *self.also) if effect != CHANGE
        }
        if "mass_distribution" in values:  # what is declared is there without it
            values["mass_distribution"] = {"height": block.centre_height, "inertia": block.I_c}
        every = {f"{effect}.{name}": value for effect, own in values.items() for name, value in own.items()}
        unchanged = {p.name: 0.0 for p in self.parameters if p.name.startswith(f"{CHANGE}.")}
        return every | unchanged | dict(self.fixed)


def _block(declared: DeclaredBlock):  # type: ignore[no-untyped-def]
    from rocking import Block

    return Block(declared.breadth, declared.height, declared.depth, declared.density)


def _one(
    effect: str, name: str, scale: float, starts: Sequence[float], low: float, high: float, *, log: bool = False,
    label: str = "", fixed: Mapping[str, float] | None = None, smooth: bool = True,
) -> Candidate:  # fmt: skip
    full = f"{effect}.{name}"
    held = {f"{effect}.{key}": value for key, value in (fixed or {}).items()}
    return Candidate(
        label or effect, effect, (Parameter(full, scale, low, high, log),), tuple({full: v} for v in starts), held,
        smooth,
    )  # fmt: skip


def candidates(block: DeclaredBlock, friction: float | None = None) -> tuple[Candidate, ...]:
    """All forms of all effects that the loop knows how to fit, for this block.

    friction: of the block on its base [1], where the laboratory declares it.
    """
    return (*_of_the_block(block), *_of_the_contact(block, friction), *_of_the_base(), *_of_the_sensors())


def _of_the_block(block: DeclaredBlock) -> tuple[Candidate, ...]:
    b, H, I = block.breadth, block.centre_height, block.I_c  # noqa: E741
    off = _one(
        "eccentric_mass", "offset", 0.005 * b, [0.01 * b, -0.01 * b], -0.3 * b, 0.3 * b, fixed={"apart": 1.0}
    )  # fmt: skip
    return (
        _one("rounded_edges", "radius", 0.01 * b, [0.01 * b, 0.03 * b], 0.0, 0.3 * b),
        _one("concave_base", "breadth", 0.02 * b, [0.98 * b, 0.94 * b], 0.5 * b, b),
        off,
        # What impacts keep on both sides of it is apart as the kept angular momentum has it, or alike.
        replace(off, name=f"{off.name}[restitution alike]", fixed={"eccentric_mass.apart": 0.0}, after=off.name),
        Candidate(
            "mass_distribution", "mass_distribution",
            (
                Parameter("mass_distribution.height", 0.02 * H, 0.4 * H, 1.8 * H),
                Parameter("mass_distribution.inertia", 0.02 * I, 0.3 * I, 3.0 * I),
            ),
            ({"mass_distribution.height": 1.02 * H, "mass_distribution.inertia": 1.02 * I},
             {"mass_distribution.height": 0.98 * H, "mass_distribution.inertia": 0.98 * I}), {},
        ),
    )  # fmt: skip


OF_THE_ROTATION_SENSOR = ("rotation_gain", "rotation_offset")

FLOORS = 5
"""Floors that give from which a fit begins: those that explain most of some swings as they are."""

PARTS_OF_FLOORS = 5
"""And the best one of so many parts of their range.

A soft floor makes a swing longer, and one beside it misses all swings; rigid ones miss them by less, and yet a fit goes
from there to the soft one, and from a rigid one does not."""

BOUNCES = 8
"""The same of corners that bounce, of which more is tried."""

ALONG = "compliant_base.tangential_ratio"

OF_THE_SPRING, BY_THE_SPRING, IN_SERIES = 1.0, 2.0, 0.0
"""`spring_slider`: friction limits the spring along the floor alone, which is asked first; it is that of the spring
into the floor alone, too; or spring and dashpot slip together."""

GRIP, LESS_GRIP = 2.0, 1.0
"""Friction of corners on springs [1] where none is declared: more than shaking asks for, so that they slip only where
they are about to leave; and less, of which intervals bear what it would change.  Swings hardly tell it."""

MOST_FRICTION = 10.0
"""Friction with which corners are all but held until they leave."""

SURELY_ROCKS = 1.1
"""Friction over b/h below which a block is taken to slide rather than to rock."""

SOFTEST = 125.0
"""Frequency of a corner on its spring [Hz] below which it is said to give, and from which it is said to bounce."""


HARDEST = 600.0
"""Frequency of a corner on its spring [Hz] up to which it is fitted: far beyond runs take too long."""

STIFFNESS = "compliant_base.corner_stiffness"


def felt_at_a_corner(block: DeclaredBlock) -> float:
    """Mass [kg] that a corner meets, normal to the floor."""
    return block.mass / (1.0 + 0.25 * block.breadth**2 * block.mass / block.I_c)


def no_harder(floor: Candidate, block: DeclaredBlock) -> Candidate:
    """A floor that is fitted no harder than runs allow."""
    hardest = max(
        felt_at_a_corner(block) * (2.0 * math.pi * HARDEST) ** 2, *(start.get(STIFFNESS, 0.0) for start in floor.starts)
    )
    parameters = tuple(replace(p, high=min(p.high, hardest)) if p.name == STIFFNESS else p for p in floor.parameters)
    return replace(floor, parameters=parameters)


def with_friction(floor: Candidate, block: DeclaredBlock) -> Candidate:
    """The same with the friction of its corners fitted as well, where it has any."""
    floor = no_harder(floor, block)
    name = f"{floor.effect}.friction"
    taken = floor.fixed.get(name, math.inf)
    if taken == math.inf:
        return floor
    friction = Parameter(name, 0.3, block.breadth / (2.0 * block.centre_height), MOST_FRICTION, True, UNEVEN)
    return replace(
        floor, parameters=(*floor.parameters, friction), starts=tuple({**start, name: taken} for start in floor.starts),
        fixed={key: value for key, value in floor.fixed.items() if key != name}, assumed={},
    )  # fmt: skip


SLIDES_BELOW = 1.5
"""Friction over b/h up to which a block on a floor that gives is said to slide, where it tells."""


def sliding_on(floor: Candidate) -> Candidate:
    """A floor whose friction is fitted, and under which that is called sliding."""
    own = f"{floor.effect}.friction"
    label, _, form = floor.name.partition("[")
    name = f"{label}[{form.rstrip(']')}, sliding]" if form else f"{label}[sliding]"

    def renamed(full: str) -> str:
        return "sliding.friction" if full == own else full

    return replace(
        floor, name=name, parameters=tuple(replace(p, name=renamed(p.name)) for p in floor.parameters),
        starts=tuple({renamed(full): value for full, value in start.items()} for start in floor.starts),
        fixed={**floor.fixed, "sliding.ratio_kept": 0.0}, also=("sliding",),
    )  # fmt: skip


def _other_slip(effect: str) -> tuple[Mapping[str, float], ...]:
    """The laws of slip that are asked after the first one."""
    return tuple({f"{effect}.spring_slider": law} for law in (BY_THE_SPRING, IN_SERIES))


def grips(block: DeclaredBlock, declared: float | None) -> tuple[float, float]:
    """Friction of corners on springs, and another value of it that may be as right."""
    if declared is None or declared < SURELY_ROCKS * math.tan(block.alpha):
        return GRIP, LESS_GRIP
    return declared, GRIP if declared < GRIP else LESS_GRIP


def _floor(
    label: str, spread: float, stiffnesses: Sequence[float], fixed: Mapping[str, float], *, after: str = "",
    assumed: Mapping[str, float] | None = None, otherwise: tuple[Mapping[str, float], ...] = (),
) -> Candidate:  # fmt: skip
    """A floor that gives; its stiffness along itself is fitted, from that into it, unless that is fixed."""
    parameters = [
        Parameter(STIFFNESS, 0.3, 1e-3 * stiffnesses[0], 10.0 * stiffnesses[-1], True, UNEVEN),
        Parameter("compliant_base.damping_ratio", 0.3, 1e-3, 2.0, True, UNEVEN),
    ]
    start, told = {"compliant_base.damping_ratio": 0.12}, ALONG in fixed
    if not told:
        parameters.append(Parameter(ALONG, 0.5, 0.05, 100.0, True, UNEVEN))
        start[ALONG] = 1.0
    return Candidate(
        label, "compliant_base", tuple(parameters), tuple({STIFFNESS: k, **start} for k in stiffnesses),
        {"compliant_base.spread": spread, **fixed}, smooth=False, replaces_restitution=True, costly=True,
        scouts=("compliant_base.damping_ratio",), screened=FLOORS, parts=PARTS_OF_FLOORS,
        after=after, minima_in="" if told else ALONG, assumed=assumed or {}, otherwise=otherwise,
    )  # fmt: skip


def _of_the_contact(block: DeclaredBlock, friction: float | None) -> tuple[Candidate, ...]:
    grip, other = grips(block, friction)
    weight = block.mass * G_STANDARD
    moment = 0.5 * weight * block.breadth
    # Corners pressed in by 8e-3 to 4e-5 of the breadth under the weight, beyond which a floor is all but rigid and runs
    # take longest, and all but held in place along the floor; a bed, whose pressure moves as the block turns, is felt
    # when it is stiffer still.  The sum of squares has minima in the stiffness less than a factor of two apart.
    soft, of_bed = (
        [float(weight / (sink * block.breadth)) for sink in np.geomspace(8e-3, least, count)]
        for least, count in ((4e-5, 15), (1e-5, 19))
    )
    hard = felt_at_a_corner(block) * (2.0 * math.pi * SOFTEST) ** 2
    slip = {"compliant_base.friction": grip, "compliant_base.spring_slider": OF_THE_SPRING}
    other_slip = _other_slip("compliant_base")
    floors = (
        *(
            _floor(label, spread, starts, slip, assumed={"compliant_base.friction": other}, otherwise=other_slip)
            for label, spread, starts in (("compliant_base", 0.0, soft), ("compliant_base[bed]", 1.0, of_bed))
        ),
        # The two springs of Psycharis & Jennings (1983), and their bed: the floor gives downward alone.
        *(
            _floor(label, spread, starts, {ALONG: math.inf, "compliant_base.friction": math.inf}, after=after)
            for label, spread, starts, after in (
                ("compliant_base[downward]", 0.0, soft, ""),
                ("compliant_base[bed, downward]", 1.0, of_bed, "compliant_base[downward]"),
            )
        ),
    )
    spring = weight * block.R
    tethers = tuple(
        Candidate(
            f"tether[{label}]", "tether",
            (
                Parameter("tether.slack", 0.02 * block.alpha, 0.0, 2.0 * block.alpha),
                Parameter("tether.stiffness", 0.3, 1e-3 * spring, 1e3 * spring, True),
            ),
            tuple({"tether.slack": share * block.alpha, "tether.stiffness": spring} for share in (0.1, 0.3, 0.5, 0.7)),
            {"tether.side": side}, smooth=False,
        )
        for label, side in (("both", 0.0), ("right", 1.0), ("left", -1.0))
    )  # fmt: skip
    # Up to 0.6 of the weight's moment evenly, beyond it up to the bound by equal shares.
    held = np.concatenate([0.024 * np.arange(1, 26), np.geomspace(0.6, 2.0, 9)[1:]])
    return (
        _one("velocity_dependent_restitution", "slope", 0.01, [0.02, -0.02], -0.5, 0.5),
        _one("viscous_damping", "coefficient", 0.05, [0.1], 0.0, 20.0),
        _one("quadratic_drag", "coefficient", 0.05, [0.1], 0.0, 20.0),
        *floors,
        *tethers,
        *_sliding(block),
        Candidate(
            "bouncing", "bouncing", (Parameter("bouncing.normal_restitution", 0.05, 1e-3, 0.95),),
            tuple({"bouncing.normal_restitution": e} for e in (0.05, 0.2, 0.5)),
            {"bouncing.friction": math.inf, "bouncing.contact_frequency": math.inf}, smooth=False, slips=True,
            replaces_restitution=True, scanned=tuple({"bouncing.normal_restitution": 0.05 * k} for k in range(1, 19)),
        ),
        # Energy is made above 0.8.
        Candidate(
            "bouncing[stops]", "bouncing", (Parameter("bouncing.normal_restitution", 0.05, 1e-3, 0.79),),
            tuple({"bouncing.normal_restitution": e} for e in (0.2, 0.5, 0.7)),
            {"bouncing.friction": math.inf, "bouncing.contact_frequency": math.inf, "bouncing.stops": 1.0},
            smooth=False, slips=True, replaces_restitution=True,
            scanned=tuple({"bouncing.normal_restitution": 0.05 * k} for k in range(1, 16)),
        ),
        # A corner that bounces while the other one is still in contact. Below `SOFTEST` the floor is called compliant.
        # The sum of squares has minima beside each other in the frequency.
        Candidate(
            "bouncing[contact]", "bouncing",
            (
                Parameter("bouncing.normal_restitution", 0.05, 1e-3, 0.98, coarser=UNEVEN),
                Parameter("bouncing.contact_frequency", 0.2, SOFTEST, HARDEST, True, UNEVEN),
                Parameter("bouncing.tangential_ratio", 0.5, 0.05, 100.0, True, UNEVEN),
            ),
            tuple({"bouncing.normal_restitution": e, "bouncing.contact_frequency": f, "bouncing.tangential_ratio": 1.0}
                  for f in (200.0, 350.0, 550.0) for e in (0.3, 0.45, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9)),
            {"bouncing.friction": grip, "bouncing.spring_slider": OF_THE_SPRING},
            smooth=False, replaces_restitution=True, costly=True,
            scouts=("bouncing.normal_restitution",), screened=BOUNCES,
            beyond=(STIFFNESS, {f.name: math.inf for f in floors} | {"compliant_base": hard}),
            same_as=bouncing_on,
            minima_in="bouncing.tangential_ratio", assumed={"bouncing.friction": other},
            otherwise=_other_slip("bouncing"),
        ),
        Candidate(
            "base_adhesion", "base_adhesion", (Parameter("base_adhesion.moment", 0.02 * moment, 0.0, 2.0 * moment),),
            (), {}, smooth=False, in_swings=False,
            scanned=tuple({"base_adhesion.moment": float(share) * moment} for share in held),
        ),
    )  # fmt: skip


def bouncing_on(model: LoopModel) -> dict[str, float]:
    """Parameters of `bouncing` with which its contacts are those of a model on springs under its corners.

    Source: `rocking.effects.bouncing`, from the loss and the frequency of a contact to its spring and dashpot.
    """
    assert isinstance(model.system, BlockOnSoftFloor)
    floor, form = model.system, model.system.rigid.form
    felt = form.mass / (1.0 + form.half_breadth**2 / form.rho2)
    share = min(floor.damping_ratio * math.sqrt(form.mass / felt), 1.0 - 1e-12)
    return {
        "bouncing.normal_restitution": math.exp(-math.pi * share / math.sqrt(1.0 - share**2)),
        "bouncing.contact_frequency": math.sqrt(floor.corner_stiffness / felt) / (2.0 * math.pi),
        "bouncing.tangential_ratio": floor.tangential_ratio,
        "bouncing.friction": floor.friction,
        "bouncing.spring_slider": model.effects["compliant_base"].get("spring_slider", IN_SERIES),
    }


def _sliding(block: DeclaredBlock) -> tuple[Candidate, ...]:
    # A block with friction below b/h slides before it rocks; far above, friction holds in all but violent shaking. What
    # slip takes away bends the restitution that was calibrated without it, so that Housner's is a start besides. What
    # an impact keeps while the base slides is not known beforehand.
    slender = 2.0 * block.centre_height
    tips = block.breadth / slender
    frictions = [tips * ratio for ratio in (0.8, 0.95, 1.0, 1.03, 1.07, 1.12, 1.2, 1.3, 1.5, 2.0, 3.0)]
    finely = tips * np.geomspace(0.9, 2.0, 54)
    form = Form.of(_block(block)).edited(mass_height=block.centre_height, inertia=block.I_c)
    starts = [{"sliding.friction": mu} for mu in frictions if mu < 1.3]
    starts += [{RESTITUTION: form.housner_restitution, **start} for start in starts]
    return tuple(
        Candidate(
            name, "sliding", (Parameter("sliding.friction", 0.05 * tips, 0.02, 1.3),),
            tuple(starts), {"sliding.ratio_kept": ratio_kept},
            smooth=False, slips=True,
            scanned=tuple({"sliding.friction": float(mu)} for mu in finely if mu < 1.3), screened=6, after=after,
        )
        for name, ratio_kept, after in (("sliding", 0.0, ""), ("sliding[ratio]", 1.0, "sliding"))
    )  # fmt: skip


def _of_the_base() -> tuple[Candidate, ...]:
    second = tuple(
        Parameter(f"vertical_motion.second_harmonic_{kind}", 0.05, -3.0, 3.0) for kind in ("ratio", "quadrature")
    )
    return (
        _one("base_tilt", "angle", 0.002, [0.004, -0.004], -0.1, 0.1),
        _one("table_pitch", "per_acceleration", 5e-5, [1e-4, -1e-4], -0.02, 0.02, label="table_pitch[acceleration]"),
        _one("table_pitch", "per_displacement", 0.01, [0.02, -0.02], -3.0, 3.0, label="table_pitch[displacement]"),
        _one("vertical_motion", "ratio", 0.02, [0.1, -0.1], -3.0, 3.0, label="vertical_motion[ratio]"),
        Candidate(
            "vertical_motion[second_harmonic]", "vertical_motion", second,
            ({p.name: 0.05 for p in second}, {p.name: -0.05 for p in second}), {},
        ),
        _one("base_motion_gain", "gain", 0.01, [1.02, 0.98], 0.3, 3.0),
        _one("base_motion_lag", "lag", 0.001, [0.004, -0.004], -0.2, 0.2),
    )  # fmt: skip


def _of_the_sensors() -> tuple[Candidate, ...]:
    return (
        _one("rotation_gain", "gain", 0.01, [1.02, 0.98], 0.3, 3.0),
        _one("rotation_offset", "offset", 5e-4, [1e-3, -1e-3], -0.2, 0.2),
    )
