"""Measured campaigns with a hidden truth, written as a laboratory would hand them over.

`make_campaign` writes three folders: `campaign/` (what was measured), `predict/` (later tests without a response) and
`truth/`, so that nothing of the truth lies within what the loop is given.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np

from studies.campaigns import Campaign, Channel, Conditions, DeclaredBlock, Test, write

from .by_mujoco import ratio_by_momentum
from .effects import NAMED, SPOKEN, TWINS, UNNAMED, Draw, Lab, draw
from .instruments import Bench, reading, record, without_response
from .parameters import housner, uniform
from .plans import LEAN_NOISE, Plan, check_together, falls, forced, free, respond, used
from .prediction import calibrated, errors, predicted, predicted_accelerations, rms, rms_of_accelerations
from .table import Table
from .truth import Truth

FREQUENCIES = (2.5, 3.0, 3.5, 4.0, 4.5, 5.0)
NUISANCES = (
    "missing", "clipping", "truncated", "overturns", "mixed_sampling", "vertical_channel", "quantised", "lossy",
    "noisy_base", "accelerometers",
)  # fmt: skip
NOISY_BASE = 4.0  # its noise over that of other campaigns, beside a rotation of QUIET_ROTATION
QUIET_ROTATION = 5e-5  # rad
LOSSY = (0.93, 0.99)  # restitution of a block with lossy impacts, over Housner's
TARGET = {"strong": (4.0, 60.0), "weak": (1.3, 2.2)}  # baseline error over floor
ACCELEROMETER_NOISE = 0.03  # m/s^2
MISALIGNMENT = np.radians(0.5)


def seeded(seed: int, *names: str) -> np.random.Generator:
    """A generator that depends on the seed and on what is planted."""
    return np.random.default_rng([seed, zlib.crc32(" ".join(names).encode())])


def declared_block(rng: np.random.Generator) -> tuple[DeclaredBlock, float]:
    """A uniform block of stone or concrete and its true restitution, somewhat above Housner's."""
    height = round(rng.uniform(0.3, 1.5), 2)
    breadth = round(height * rng.uniform(0.15, 0.45), 3)
    depth = round(breadth * rng.uniform(1.0, 2.0), 3)
    mass = round(breadth * height * depth * rng.uniform(2000, 2700), 2)
    least = max(0.88, housner(breadth, height) + 0.004)
    restitution = rng.uniform(least, max(0.95, least + 0.012))
    return DeclaredBlock(breadth, height, depth, mass), float(restitution)


def plan_tests(rng: np.random.Generator, lab: Lab, rate: float, nuisances: frozenset[str]) -> list[Plan]:
    """Plans of the campaign; motions are sized with the ideal block."""
    plans: list[Plan] = []

    def pace() -> float:
        return float(rng.choice([200.0, 250.0, 500.0])) if "mixed_sampling" in nuisances else rate

    sides = [1.0, -1.0, rng.choice([-1.0, 1.0]), rng.choice([-1.0, 1.0])][: int(rng.integers(3, 5))]
    for k, side in enumerate(sides):
        plans.append(free(rng, lab, f"free-{k + 1:02d}", pace(), side, len(plans)))
    for f in sorted(rng.choice(FREQUENCIES, int(rng.integers(3, 5)), replace=False)):
        plans.append(forced(rng, lab, f"ramp-{f:.1f}Hz-01", pace(), len(plans), float(f)))
    for k in range(int(rng.integers(2, 4))):
        plans.append(forced(rng, lab, f"quake-{k + 1:02d}", pace(), len(plans), None))
    return plans


def plan_ahead(rng: np.random.Generator, lab: Lab, rate: float, first: int) -> list[Plan]:
    """Plans of the tests to predict, done after `first` others."""
    ahead = [free(rng, lab, "free-p01", rate, float(rng.choice([-1.0, 1.0])), first)]
    for f in rng.choice(FREQUENCIES, 2, replace=False):
        ahead.append(forced(rng, lab, f"ramp-{f:.1f}Hz-p01", rate, first + len(ahead), float(f)))
    return [*ahead, forced(rng, lab, "quake-p01", rate, first + 3, None)]


def channels_of(rng: np.random.Generator, block: DeclaredBlock, kind: str, vertical: bool) -> Bench:
    """The instruments: a rotation sensor, or three accelerometers on the block; the base's in any case."""
    base = round(float(rng.uniform(0.002, 0.008)), 4)
    channels = [Channel("base_x", "base_acceleration_x", base)]
    if vertical:
        channels.append(Channel("base_z", "base_acceleration_z", base))
    if kind == "rotation":
        rotation = Channel("rotation", "rotation", float(rng.choice([1e-4, 2e-4, 3e-4])))
        return Bench((rotation, *channels), {})
    top, half = round(0.97 * block.height, 3), round(0.45 * block.breadth, 3)
    noise = ACCELEROMETER_NOISE
    sensors = (
        Channel("acc_top", "block_acceleration", noise, (0.0, top), (1.0, 0.0)),
        Channel("acc_left", "block_acceleration", noise, (-half, 0.05), (0.0, 1.0)),
        Channel("acc_right", "block_acceleration", noise, (half, 0.05), (0.0, 1.0)),
    )
    return Bench((*sensors, *channels), {c.name: float(rng.normal(0.0, MISALIGNMENT)) for c in sensors})


def _with_accelerometers(bench: Bench, seed: int, block: DeclaredBlock) -> Bench:
    """The instruments with three accelerometers on the block beside its rotation."""
    beside = channels_of(seeded(seed, "accelerometers"), block, "block_acceleration", False)
    sensors = [c for c in beside.channels if c.kind == "block_acceleration"]
    return replace(bench, channels=(bench.channels[0], *sensors, *bench.channels[1:]), mounting=beside.mounting)


def _noisy_base(channel: Channel) -> Channel:
    if channel.kind == "rotation":
        return replace(channel, noise=QUIET_ROTATION)
    if channel.kind == "block_acceleration":
        return channel
    return replace(channel, noise=NOISY_BASE * (channel.noise or 0.0))


def planted(
    ideal: Lab, names: Sequence[str], draws: Sequence[Draw], strengths: Iterable[float]
) -> tuple[Lab, dict[str, float]]:
    """The laboratory with its effects, and their true parameters."""
    lab: Lab = ideal
    parameters: dict[str, float] = {}
    for name, d, k in zip(names, draws, strengths, strict=True):
        lab, own = (NAMED | UNNAMED)[name](lab, d, k)
        parameters |= {f"{SPOKEN.get(name, name)}.{key}": float(value) for key, value in own.items()}
    return lab, parameters


def recorded(
    seed: int, names: Sequence[str], lab: Lab, plans: Sequence[Plan], bench: Bench, *, whole: bool = False
) -> list[Test]:
    """Every test done and written down; noise depends on seed, effects and test alone."""
    return [record(seeded(seed, *names, p.id), lab, p, respond(lab, p), bench, whole=whole) for p in plans]


def visibility(
    ideal: Lab, lab: Lab, bench: Bench, plans: Sequence[Plan], tests: Sequence[Test]
) -> tuple[Lab, float, float]:
    """Calibrated baseline, its median error and that of the true model, over the tests of the campaign."""
    rotation = next((c for c in bench.channels if c.kind == "rotation"), None)
    if rotation is None:
        # Judged in rotation all the same: the strength of an effect is no matter of the instrument.
        seen = Bench((Channel("rotation", "rotation", 2e-4), *[c for c in bench.channels if not c.is_response]), {})
        tests = [record(seeded(0, p.id), lab, p, respond(lab, p), seen) for p in plans]
    model, before = calibrated(replace(ideal, table=Table(), engine="event"), tests)
    return model, before, float(np.median(errors(lab, tests)))


def tuned(seed, names, ideal, plans, bench, draws, strength):
    """Strengths for which baseline over floor comes to a random target, together for all effects."""
    low, high = TARGET[strength]
    rng = seeded(seed, *names, "target")
    whole = replace(bench, nuisances=frozenset())
    target = float(low * (high / low) ** rng.uniform())
    k = np.ones(len(names))
    best = None
    for _ in range(7):
        lab, parameters = planted(ideal, names, draws, k)
        lab = used(lab, plans)
        model, before, floor = visibility(ideal, lab, whole, plans, recorded(seed, names, lab, plans, whole))
        ratio = before / floor
        miss = abs(np.log(ratio / target))
        if best is None or miss < best[0]:
            best = miss, lab, parameters, model, before, floor, k.copy()
        if not names or miss < np.log(1.6):
            break
        # Strong departures saturate once the motions have nothing in common: go gently.
        k = np.clip(k * np.clip((target / ratio) ** 0.8, 0.2, 4.0), 0.03, 10.0)
    assert best is not None
    return best[1:]


def verdict_of(names: Sequence[str]) -> tuple[str, ...]:
    """The verdicts that are right."""
    if not names:
        return ("none",)
    return ("unexplained",) if any(n in UNNAMED for n in names) else ("effect",)


def accepted_of(names: Sequence[str]) -> tuple[tuple[str, ...], ...]:
    """Sets of effects that count as traced: twins may stand in for each other."""
    known = [SPOKEN.get(n, n) for n in names if n in NAMED]
    choices = [sorted(next((t for t in TWINS if n in t), {n})) for n in known]
    return tuple(tuple(sorted(c)) for c in product(*choices))


def hidden_response(lab: Lab, plan: Plan, bench: Bench) -> dict[str, np.ndarray]:
    """Noise-free rotation, as its sensor would read it, and accelerometer readings of a test to predict."""
    response = respond(lab, plan)
    sensor = Channel("rotation", "rotation")
    columns = {"time": response.time}
    for channel in (sensor, *(c for c in bench.channels if c.kind == "block_acceleration")):
        values = reading(lab, plan, response, channel, bench)
        assert values is not None
        columns[channel.name] = values
    return columns


def score(
    lab: Lab, plans: Sequence[Plan], tests: Sequence[Test], hidden: dict[str, dict[str, np.ndarray]],
    bench: Bench | None = None,
) -> float:  # fmt: skip
    """Median error of a model over the tests to predict, from base records and declared leans, against the truth.

    bench: whose accelerometers on the block it is told in [m/s^2], mounted as they truly are; in rotation if not given.
    """
    scores = []
    for plan, test in zip(plans, tests, strict=True):
        true, lean = hidden[plan.id], test.initial_rotation or 0.0
        if bench is None:
            scores.append(rms(predicted(lab, test, lean, plan.order), true["rotation"]))
        else:
            scores.append(rms_of_accelerations(predicted_accelerations(lab, test, lean, plan.order, bench), true))
    return float(np.median(scores))


def _check_asked(effects: Sequence[str], channel: str, nuisances: Sequence[str], engine: str) -> None:
    """Raise ValueError where an effect or nuisance is not there, or no laboratory has what is asked for together."""
    for given, known in ((effects, NAMED | UNNAMED), (nuisances, NUISANCES)):
        for one in given:
            if one not in known:
                raise ValueError(f"{one!r}: want one of {', '.join(known)}")
    if engine != "event" and "lossy" in nuisances:
        raise ValueError(
            f"'lossy': want the engine 'event' with it, since in {engine!r} losses come out of the contact"
        )
    check_together(effects, engine)
    if channel != "rotation" and "accelerometers" in nuisances:
        raise ValueError(f"'accelerometers': want channel='rotation', beside which they are, not {channel!r}")
    if engine != "event" and (channel != "rotation" or "accelerometers" in nuisances):
        what = f"channel={channel!r}" if channel != "rotation" else "'accelerometers'"
        raise ValueError(f"{what}: want 'rotation' alone of the engine {engine!r}, which tells no accelerations")


def make_campaign(
    seed: int,
    effects: Sequence[str],
    folder: Path,
    *,
    strength: str = "strong",
    channel: str = "rotation",
    nuisances: Sequence[str] = (),
    name: str | None = None,
    engine: str = "event",
) -> Truth:
    """Write `folder/campaign`, `folder/predict` and `folder/truth`; the truth.

    Args:
        seed: with the effects, fixes everything.
        effects: names out of NAMED and UNNAMED; none for a clean campaign.
        strength: "strong" or "weak": error of the calibrated baseline over that of the true model, TARGET.
        channel: "rotation" or "block_acceleration".
        nuisances: out of NUISANCES.
        engine: "event", which effects may replace by one that has them, "mujoco" or "dem".

    Raises:
        ValueError: an effect or nuisance that is not there, or effects that no laboratory has together.
    """
    effects = list(effects)
    _check_asked(effects, channel, nuisances, engine)
    label = name or "+".join(effects) or "null"
    rng = seeded(seed, *effects)
    block, restitution = declared_block(rng)
    least = housner(block.breadth, block.height)
    if "lossy" in nuisances:
        restitution = least * float(seeded(seed, "lossy").uniform(*LOSSY))
    if engine == "mujoco":
        restitution = least
    ideal = Lab(uniform(block.breadth, block.height, block.mass, restitution), engine=engine)
    odd = frozenset(nuisances)
    vertical = "vertical_channel" in odd and "vertical_motion" not in effects
    bench = replace(channels_of(rng, block, channel, vertical), nuisances=odd)
    if "noisy_base" in odd:
        bench = replace(bench, channels=tuple(map(_noisy_base, bench.channels)))
    if "accelerometers" in odd and channel == "rotation":
        bench = _with_accelerometers(bench, seed, block)
    if vertical:
        ideal = replace(ideal, table=Table(vertical=float(rng.uniform(-0.06, 0.06))))
    rate = float(rng.choice([200.0, 250.0, 250.0, 500.0]))
    plans = plan_tests(rng, ideal, rate, odd)
    draws = [draw(rng) for _ in effects]
    slipping = 0.7 if rng.uniform() < 0.6 else None
    ideal = ideal if slipping is None else replace(ideal, grip=slipping)
    noted = round(float(restitution + rng.normal(0.0, 0.008)), 3) if rng.uniform() < 0.5 else None
    lab, parameters, model, before, floor, k = tuned(seed, effects, ideal, plans, bench, draws, strength)
    if "overturns" in odd:
        plans.append(falls(rng, lab, "ramp-1.8Hz-01", rate, len(plans)))
    lab = used(lab, plans)
    tests = recorded(seed, effects, lab, plans, bench)
    for _ in range(6):
        ahead = plan_ahead(rng, ideal, rate, len(plans))
        lab = used(lab, [*plans, *ahead])
        later = recorded(seed, effects, lab, ahead, replace(bench, nuisances=frozenset()), whole=True)
        hidden = {p.id: hidden_response(lab, p, bench) for p in ahead}
        scores = {"floor": score(lab, ahead, later, hidden), "baseline": score(model, ahead, later, hidden)}
        # Later tests in which chaos hides the effect from the true model itself are of no use to a judge.
        if not effects or strength == "weak" or scores["baseline"] > 3.0 * scores["floor"]:
            break
    conditions = Conditions(slipping if "sliding" not in effects else None, noted)
    title = f"Block of {block.height:g} m, free and forced tests, series {seed}"
    for part, done in (("campaign", tests), ("predict", [without_response(t) for t in later])):
        write(Campaign(title, block, conditions, bench.channels, tuple(done)), Path(folder) / part)
    if channel == "block_acceleration":
        parts = (("floor", lab), ("baseline", model))
        scores = {name: score(one, ahead, later, hidden, bench) for name, one in parts}
    noise = next(c.noise for c in bench.channels if c.is_response) or 0.0
    truth = Truth(
        name=label,
        effects=tuple(SPOKEN.get(n, n) for n in effects),
        verdicts=verdict_of(effects),
        accepted=accepted_of(effects),
        parameters=parameters,
        restitution=ratio_by_momentum(lab.world) if engine == "mujoco" else lab.world.restitution,
        channel=channel,
        noise=noise,
        floor={"fit": floor, "predict": scores["floor"]},
        baseline={"fit": before, "predict": scores["baseline"], "restitution": model.world.restitution},
        overturned={p.id: bool(np.isnan(hidden[p.id]["rotation"]).any()) for p in ahead},
        about={
            "seed": seed, "strength": strength, "strengths": k.tolist(), "nuisances": sorted(odd),
            "engine": lab.engine, "lean_noise": LEAN_NOISE, "mounting": bench.mounting,
        },
        hidden=hidden,
    )  # fmt: skip
    truth.write(Path(folder) / "truth")
    return truth
