"""Tests that a laboratory might do: releases, ramped sinusoids, earthquakes; each with its true motion."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from . import by_dem, by_mujoco, contact, event, slip
from .effects import NAMED, UNNAMED, Draw, Lab
from .event import Response
from .parameters import G, refuse, uniform
from .table import Motion, Table, felt_by_motion, felt_by_record, quake, ramp

LEAN_NOISE = 3e-4  # rad, of a lean set by hand
QUIET = 4e-4  # rad
ENGINES = {
    "event": event.simulate, "slip": slip.simulate, "contact": contact.simulate,
    "mujoco": by_mujoco.simulate, "dem": by_dem.simulate,
}  # fmt: skip
FOREIGN = {"event": (), "slip": slip.FOREIGN, "contact": contact.FOREIGN}
"""Numbers of a world that the laboratory's own engines lack."""
OTHERS = {"mujoco": by_mujoco.check, "dem": by_dem.check}
"""Engines that are not the laboratory's own, and what tells whether they have all that is asked of them."""


@dataclass(frozen=True)
class Plan:
    """One test: what is done, at which rate it is recorded, and its place in the order of tests."""

    id: str
    kind: str
    rate: float  # Hz
    samples: int
    aimed: float = 0.0  # rad, the lean written down
    lean: float = 0.0  # rad, the lean it had
    motion: Motion | None = None
    order: int = 0
    motion_name: str | None = None


def check_together(effects: Iterable[str], engine: str = "event") -> None:
    """Whether a laboratory has these effects together, before any is planted in earnest.

    Raises:
        ValueError: none has, or there is no such engine to begin with.
    """
    if engine not in ("event", *OTHERS):
        raise ValueError(f"engine={engine!r}: want one of event, {', '.join(OTHERS)}")
    lab = Lab(uniform(0.2, 0.6, 30.0, 0.9), engine=engine)
    for name in effects:
        lab, _ = (NAMED | UNNAMED)[name](lab, Draw(1.0, 0.5, 0.5, 0.5), 1.0)
    if lab.engine in OTHERS:
        OTHERS[lab.engine](lab)
    else:
        refuse(lab.world, FOREIGN[lab.engine], f"of the engine {lab.engine!r}")


def worn(lab: Lab, order: int) -> Lab:
    """The laboratory as it is at the time of a test."""
    for course in lab.courses:
        of = getattr(lab, course.of)
        changed = {course.name: getattr(of, course.name) + course.after(order)}
        lab = replace(lab, **{course.of: replace(of, **changed)})
    if lab.uses:
        lab = replace(lab, world=replace(lab.world, used=lab.uses[order]))
    if not lab.wear:
        return lab
    return replace(lab, world=replace(lab.world, restitution=lab.world.restitution - lab.wear * order))


def used(lab: Lab, plans: Iterable[Plan]) -> Lab:
    """The laboratory with what impacts have taken before each of these tests, all from the first on, and after them."""
    if not lab.world.grind:
        return lab
    uses = [0.0]
    for plan in plans:
        hits = respond(replace(lab, uses=(*[0.0] * plan.order, uses[-1])), plan).impacts
        uses.append(uses[-1] + float(np.sum(hits[:, 1] ** 2)))
    return replace(lab, uses=tuple(uses))


def respond(lab: Lab, plan: Plan) -> Response:
    """What the block truly does in a test."""
    h = 0.5 / plan.rate
    felt = felt_by_motion(plan.motion, h, 2 * plan.samples - 1, lab.table)
    return ENGINES[lab.engine](worn(lab, plan.order).world, felt, h, 2, plan.lean)


def _samples(duration: float, rate: float) -> int:
    return int(np.ceil(duration * rate)) + 1


def free(rng: np.random.Generator, lab: Lab, id: str, rate: float, side: float, order: int) -> Plan:
    """A release from 0.45 to 0.8 of the balance angle, recorded until little is left."""
    aimed = round(side * rng.uniform(0.45, 0.8) * lab.world.alpha, 4)
    plan = Plan(id, "free", rate, _samples(10.0, rate), aimed, aimed + rng.normal(0, LEAN_NOISE), None, order)
    theta = respond(Lab(lab.world), plan).rotation
    alive = np.flatnonzero(np.abs(theta) > 0.004 * lab.world.alpha)
    return replace(plan, samples=min(plan.samples, int(alive[-1]) + int(0.4 * rate)))


def _sized(lab: Lab, plan: Plan, low: float, high: float) -> Plan | None:
    """The motion scaled until the ideal block leans to between `low` and `high` of its balance angle, else None."""
    unit, factor, h = plan.motion, 1.0, 0.5 / plan.rate
    assert unit is not None
    felt = felt_by_motion(unit, h, 2 * plan.samples - 1, Table())  # linear in the motion on a table that only slides
    for _ in range(14):
        response = event.simulate(lab.world, factor * felt, h, 2, 0.0)
        largest = np.inf if response.fell is not None else float(np.abs(response.rotation).max()) / lab.world.alpha
        if low <= largest <= high:
            return replace(plan, motion=unit.scaled(factor))
        factor *= 1.09 if largest < low else 0.93
    return None


def _spread(lab: Lab, plan: Plan, noise: float) -> float:
    """RMS by which noise of the base's sensor, taken for motion, moves the ideal block's rotation [rad]."""
    h, n = 0.5 / plan.rate, 2 * plan.samples - 1
    exact = felt_by_motion(plan.motion, h, n, Table())
    t = h * np.arange(n)
    rng = np.random.default_rng(0)
    ax = np.append(exact[:, 0, 0], 0.0) + CubicSpline(t[::2], rng.normal(0.0, noise, plan.samples))(t)
    one = event.simulate(lab.world, exact, h, 2, 0.0).rotation
    other = event.simulate(lab.world, felt_by_record(h, ax, None, Table()), h, 2, 0.0).rotation
    return float(np.sqrt(np.mean((one - other) ** 2)))


def forced(
    rng: np.random.Generator, lab: Lab, id: str, rate: float, order: int, frequency: float | None, noise: float = 0.004
) -> Plan:
    """A ramp at `frequency` [Hz], or an earthquake, that makes the block rock and not fall.

    Of several motions the first that noise of the base's sensor, `noise` [m/s^2], moves by less than QUIET, or else
    the one that it moves least: a laboratory that knows its trade leaves the most chaotic ones alone.
    """
    onset = G * lab.world.half_breadth / lab.world.centre_height
    best: tuple[float, Plan] | None = None
    tried = 0
    for _ in range(60):
        if frequency:
            motion = ramp(rng, frequency, rng.uniform(1.4, 2.2) * onset)
        else:
            motion = quake(rng, rng.uniform(1.4, 2.4) * onset)
        plan = Plan(id, "forced", rate, _samples(motion.end + 1.2, rate), motion=motion, order=order)
        found = _sized(lab, plan, *((0.08, 0.6) if frequency else (0.15, 0.6)))
        if found is None:
            continue
        tried += 1
        spread = _spread(lab, found, noise)
        if best is None or spread < best[0]:
            best = spread, found
        if spread < QUIET or tried == 10:
            break
    if best is None:
        raise ValueError(f"{id}: no motion at {frequency} Hz rocks this block without felling it")
    return best[1]


def falls(rng: np.random.Generator, lab: Lab, id: str, rate: float, order: int) -> Plan:
    """A slow ramp that ends in overturning, with all that is odd about the laboratory."""
    onset = G * lab.world.half_breadth / lab.world.centre_height
    motion = ramp(rng, 1.8, 1.5 * onset)
    plan = Plan(id, "forced", rate, _samples(motion.end + 1.0, rate), motion=motion, order=order)
    while respond(lab, plan).fell is None:
        assert plan.motion is not None
        plan = replace(plan, motion=plan.motion.scaled(1.15))
    return plan
