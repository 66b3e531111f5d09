"""Campaigns of which only outcomes were noted: many runs of some motions at several sizes, and who fell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from studies.campaigns import Campaign, Channel, Conditions, Test, write

from .campaign import accepted_of, declared_block, planted, seeded, verdict_of
from .effects import SPOKEN, Lab, draw
from .instruments import Bench, record
from .parameters import G, uniform
from .plans import Plan, respond
from .prediction import predicted
from .table import quake
from .truth import Truth

RATE = 200.0  # Hz
SCALES = (0.7, 0.85, 1.0, 1.15, 1.35, 1.6)  # of the motion that just fells the ideal block


def _just_enough(lab: Lab, plan: Plan) -> float:
    """Factor on a motion around which the block begins to fall."""
    low, high = 0.3, 8.0
    assert plan.motion is not None
    for _ in range(7):
        middle = np.sqrt(low * high)
        fell = respond(lab, replace(plan, motion=plan.motion.scaled(middle))).fell is not None
        low, high = (low, middle) if fell else (middle, high)
    return float(np.sqrt(low * high))


def _runs(rng: np.random.Generator, lab: Lab, motions: int, prefix: str) -> list[Plan]:
    onset = G * lab.world.half_breadth / lab.world.centre_height
    plans: list[Plan] = []
    for m in range(motions):
        motion = quake(rng, onset)
        samples = int((motion.end + 1.5) * RATE) + 1
        plan = Plan("", "forced", RATE, samples, motion=motion, motion_name=f"{prefix}{m + 1:02d}")
        enough = _just_enough(lab, plan)
        for k, scale in enumerate(SCALES):
            id = f"{prefix}{m + 1:02d}-{k + 1}"
            plans.append(replace(plan, id=id, motion=motion.scaled(enough * scale), order=len(plans)))
    return plans


def _fell(lab: Lab, tests: Sequence[Test], plans: Sequence[Plan]) -> list[bool]:
    pairs = zip(tests, plans, strict=True)
    return [bool(np.isnan(predicted(lab, t, 0.0, p.order)).any()) for t, p in pairs]


def _wrong(lab: Lab, tests: Sequence[Test], plans: Sequence[Plan], truth: Sequence[bool]) -> float:
    return float(np.mean([a != b for a, b in zip(_fell(lab, tests, plans), truth, strict=True)]))


def make_outcomes(
    seed: int, effects: Sequence[str], folder: Path, *, motions: int = 24, strength: float = 8.0
) -> Truth:
    """Write `folder/campaign` (`motions` motions, six sizes each), `folder/predict` and `folder/truth`.

    `strength` is that of the effects in `effects`, large since an outcome says little.
    """
    effects = list(effects)
    rng = seeded(seed, "outcomes", *effects)
    block, restitution = declared_block(rng)
    ideal = Lab(uniform(block.breadth, block.height, block.mass, restitution))
    lab, parameters = planted(ideal, effects, [draw(rng) for _ in effects], [strength] * len(effects))
    channel = Channel("base_x", "base_acceleration_x", 0.02)
    bench = Bench((channel,), {})
    sets, falls, score = [], [], {}
    for prefix, count in (("motion-", motions), ("later-", max(4, motions // 3))):
        plans = _runs(rng, ideal, count, prefix)
        responses = [respond(lab, p) for p in plans]
        fell = [r.fell is not None for r in responses]
        drawn = [seeded(seed, p.id) for p in plans]
        whole = [record(g, lab, p, r, bench, whole=True) for g, p, r in zip(drawn, plans, responses, strict=True)]
        sets.append((plans, whole))
        falls.append(fell)
    floors = [_wrong(lab, tests, plans, fell) for (plans, tests), fell in zip(sets, falls, strict=True)]
    grid = np.linspace(0.8, 0.99, 12)
    models = [replace(ideal, world=replace(ideal.world, restitution=float(e))) for e in grid]
    first = [_wrong(m, sets[0][1], sets[0][0], falls[0]) for m in models]
    best = models[int(np.argmin(first))]
    score = {"fit": min(first), "predict": _wrong(best, sets[1][1], sets[1][0], falls[1])}
    noted = [[replace(t, overturned=f) for t, f in zip(sets[0][1], falls[0], strict=True)]]
    noted.append([replace(t, overturned=None) for t in sets[1][1]])
    for part, tests in zip(("campaign", "predict"), noted, strict=True):
        campaign = Campaign(f"Outcomes, series {seed}", block, Conditions(), (channel,), tuple(tests))
        write(campaign, Path(folder) / part, compressed=True)
    truth = Truth(
        "outcomes-" + ("+".join(effects) or "null"), tuple(SPOKEN.get(e, e) for e in effects), verdict_of(effects),
        accepted_of(effects), parameters, restitution, "outcome", 0.0, {"fit": floors[0], "predict": floors[1]},
        score, {p.id: f for p, f in zip(sets[1][0], falls[1], strict=True)},
        {"seed": seed, "fallen": float(np.mean(falls[0])), "restitution": float(best.world.restitution)},
    )  # fmt: skip
    truth.write(Path(folder) / "truth")
    return truth
