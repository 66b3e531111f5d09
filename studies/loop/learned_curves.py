"""What a learned term looks like: each of its parts as a curve with its 95 % band, over what was measured.

Status   coefficients that enter linearly have a band that follows from their covariance, decays one to first order.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rocking.effects.learned_curve import EVEN, ODD, curve, numbers
from rocking.effects.learned_damping import DAMPING
from rocking.effects.learned_friction import FRICTION
from rocking.effects.learned_push import PUSHES, LearnedPush, course
from rocking.effects.learned_reading import MARKS, LearnedReading
from studies.loop.learned_in_time import (
    amplification,
    answer,
    by_parameters,
    loop,
    passed,
    read,
    ringing,
    there_and_back,
)
from studies.loop.models.model import CHANGE, DRIFT, FADING, LoopModel
from studies.loop.models.names import parameter_units, readable
from studies.loop.observed.windows import struck_before
from studies.loop.records.preparing import Setup
from studies.loop.swings.learning import (
    BASE,
    COUPLING,
    CURVE,
    HYSTERESIS,
    LOSS,
    MEMORY,
    MODE,
    PUSH,
    READING,
    RESPONSE,
    RUBBING,
    TERM,
    TIMING,
)
from studies.loop.whole.settling import Settled

Array = NDArray[np.float64]

POINTS = 121

SLOW = 10.0
"""How far what a coupled sensor passes is drawn, over its corner frequency."""


@dataclass(frozen=True)
class Curve:
    """A part of a learned term: `y` against `x` with the ends of its 95 % band, arrays of shape (point,)."""

    label: str
    description: str
    x: Array
    y: Array
    low: Array
    high: Array
    x_label: str
    y_label: str


@dataclass(frozen=True)
class _Part:
    """Coefficients that act along one axis, each with its function of x."""

    label: str
    description: str
    x_label: str
    y_label: str
    functions: Mapping[str, Callable[[Array], Array]]
    effect: str = TERM


TORQUE = "angular acceleration [rad/s²]"

PARTS = {
    "rotation": _Part(
        "Torque against rotation", "An angular acceleration beyond that of the model without the term, at no speed.",
        "rotation [rad]", TORQUE,
        {"bias": np.ones_like, "side": np.sign, "spring": lambda x: x, "cubic": lambda x: x**3},
    ),
    "speed": _Part(
        "Torque against speed", "The same for a block that leans to +x and turns with that speed.",
        "angular velocity [rad/s]", TORQUE,
        {
            "friction": lambda x: x / np.hypot(x, 0.01), "damping": lambda x: x, "side_damping": lambda x: x,
            "drag": lambda x: np.abs(x) * x, "cubic_damping": lambda x: x**3,
            "side_friction": lambda x: x / np.hypot(x, 0.01), "outward": np.abs,
        },
    ),
    "structural": _Part(
        "Torque along the motion against rotation",
        "An angular acceleration in the direction of the motion, against it where negative, whatever the speed.",
        "rotation [rad]", TORQUE, {"structural": np.abs},
    ),
    "base": _Part(
        "Torque against base acceleration", "An angular acceleration in step with the base.",
        "base acceleration [m/s²]", TORQUE, {"base": lambda x: x},
    ),
    "impact": _Part(
        "Restitution against impact speed",
        "What is added to the restitution; speeds above zero are those of impacts from the +x side.",
        "angular velocity before the impact, signed by side [rad/s]", "change of restitution [1]",
        {
            "restitution_side": np.sign, "restitution_speed": np.abs, "restitution_square": lambda x: x**2,
        },
    ),
    "reading": _Part(
        "Reading against rotation", "What the rotation sensor adds to the rotation, before its gain and its offset.",
        "rotation [rad]", "added to the reading [rad]", {"square": lambda x: x**2, "cubic": lambda x: x**3}, READING,
    ),
    "play": _Part(
        "Reading against speed", "What play takes off the reading of a block that turns one way for long.",
        "angular velocity [rad/s]", "added to the reading [rad]", {"play": lambda x: -np.sign(x)}, READING,
    ),
    "time": _Part(
        "Reading against time", "What is added to the reading as a record goes on.",
        "time since the record began [s]", "added to the reading [rad]", {"drift": lambda x: x},
        READING,
    ),
    "clock": _Part(
        "Clock of the rotation's recorder", "How late a reading is: when it is said to be, less when it was.",
        "time since the record began [s]", "late by [s]",
        {"pace": lambda x: -x, "lag": np.ones_like}, TIMING,
    ),
    "shaken": _Part(
        "Reading against base acceleration", "What is added to the reading while the base is accelerated.",
        "base acceleration [m/s²]", "added to the reading [rad]", {"base": lambda x: x}, READING,
    ),
    "struck": _Part(
        "Restitution against base acceleration", "What is added to the restitution of an impact on a base that moves.",
        "base acceleration in the sense in which the block falls [m/s²]", "change of restitution [1]",
        {"pushed": lambda x: x, "shaken": np.abs}, MEMORY,
    ),
}  # fmt: skip


OF_TIME = ("time", "clock")
"""Those of them that are drawn from the beginning of a record."""

MEMORIES = {
    ("first", "first_impacts"): ("impacts of the test before", 20.0),
    ("recent", "recent_time"): ("time since the impact before [s]", 1.0),
}
"""What a restitution with a memory depends on, and how far it is drawn."""


def curves(setup: Setup, settled: Settled) -> tuple[Curve, ...]:
    """The parts of a learned term that a finding holds; none if nothing was learned."""
    held = {name: k for k, name in enumerate(settled.names)}
    found = []
    for key, part in PARTS.items():
        own = {f"{part.effect}.{name}": function for name, function in part.functions.items()}
        own = {name: function for name, function in own.items() if name in held}
        if own:
            x = np.linspace(0.0 if key in OF_TIME else -1.0, 1.0, POINTS)
            found.append(_linear(part, own, held, settled, x * _reach(setup, key)))
    for part in _splines(settled):
        found.append(
            _linear(part, part.functions, held, settled, np.linspace(-1.0, 1.0, 2 * POINTS) * _reach(setup, "rotation"))
        )
    if any(name.startswith(f"{PUSH}.") for name in held):
        found.append(_pushed(setup, settled, held))
    found += [_decay(setup, settled, held, depth, span) for depth, span in MEMORIES if f"{MEMORY}.{depth}" in held]
    if f"{MEMORY}.worn" in held:
        found.append(_worn(setup, settled, held))
    found += _in_time(setup, settled, held)
    found += _in_the_course(setup, settled, held)
    if DRIFT in held:
        part = _Part(
            "Restitution against the number of the test", "What is added to the restitution as the campaign goes on.",
            "tests done before", "change of restitution [1]", {},
        )  # fmt: skip
        x = np.arange(len(setup.campaign.tests), dtype=np.float64)
        model = settled.whole.model
        if FADING not in held:
            found.append(_linear(part, {DRIFT: lambda x: x}, held, settled, x))
        else:
            drift, fading = model.drift, model.fading
            tests = -np.expm1(-fading * x) / fading
            rows = np.array([tests, drift * (x * np.exp(-fading * x) - tests) / fading])
            found.append(_banded(part, x, drift * tests, rows, [held[DRIFT], held[FADING]], settled))
    return tuple(found)


def _in_the_course(setup: Setup, settled: Settled, held: Mapping[str, int]) -> list[Curve]:
    """What changes from test to test, by parameter."""
    model, found = settled.whole.model, []
    x = np.arange(len(setup.campaign.tests), dtype=np.float64)
    for full in model.acting_changes:
        effect, _, parameter = full.partition(".")
        own = [name for name in held if name == full or (name.startswith(f"{CHANGE}.") and name.endswith(f".{full}"))]
        if not own:
            continue

        def draw(model: LoopModel, effect: str = effect, parameter: str = parameter) -> Array:
            there = [model.in_test(k) for k in range(x.size)]
            return np.array([m.effects_now[effect][parameter] if parameter else m.restitution_now for m in there])

        words = f"{readable(effect)}: {parameter.replace('_', ' ')}" if parameter else "Restitution"
        part = _Part(
            f"{words} against the number of the test", "What it is in each test, in the order in which they were done.",
            "tests done before", f"{words.lower()} [{parameter_units(full)}]", {},
        )  # fmt: skip
        rows = by_parameters(draw, model, own)
        found.append(_banded(part, x, draw(model), rows, [held[name] for name in own], settled))
    return found


def _in_time(setup: Setup, settled: Settled, held: Mapping[str, int]) -> list[Curve]:
    """A mass that swings, a plate under the block, a coupled base sensor, a slow one of the rotation, and what slips or
    creeps."""
    model, found = settled.whole.model, []

    def drawn(effect: str, part: _Part, x: Array, draw: Callable[[LoopModel], Array]) -> Curve:
        own = [name for name in held if name.startswith(f"{effect}.")]
        rows = by_parameters(draw, model, own)
        return _banded(part, x, draw(model), rows, [held[name] for name in own], settled)

    if f"{MODE}.mass_ratio" in held:
        stop = "in a block which stops from 1 rad/s and is held upright then"
        if model.effects[MODE].get("hanging", 0.0) > 0.0:
            label, words = "A mass that hangs inside", f"By a mass that hangs {stop}, to the scale of small swings."
        else:
            label, words = "A mass inside", f"By a mass that swings on a spring {stop}."
        part = _Part(f"{label}: torque after a stop", words, "time [s]", TORQUE, {})
        times = ringing(model)
        found.append(drawn(MODE, part, times, lambda m: answer(m, times)))
    if f"{RESPONSE}.frequency" in held:
        part = _Part(
            "Sensor of the rotation", "What it reads of sinusoids, over what there is.", "frequency [Hz]",
            "read over true [1]", {},
        )  # fmt: skip
        at = np.linspace(0.0, 3.0 * model.get(f"{RESPONSE}.frequency"), POINTS)
        found.append(drawn(RESPONSE, part, at, lambda m: read(m, at)))
    if f"{BASE}.frequency" in held:
        part = _Part(
            "A plate under the block, or a table that resonates",
            "The acceleration under the block over that which the sensor of the base records, in steady shaking.",
            "frequency [Hz]", "amplification [1]", {},
        )  # fmt: skip
        x = np.linspace(0.0, 2.0 * model.get(f"{BASE}.frequency"), POINTS)
        found.append(drawn(BASE, part, x, lambda m: amplification(m, x)))
    if f"{COUPLING}.corner_frequency" in held and model.get(f"{COUPLING}.corner_frequency") > 0.0:
        part = _Part(
            "A base sensor that loses slow motion", "What it recorded over what there was, in steady shaking.",
            "frequency [Hz]", "recorded over true [1]", {},
        )  # fmt: skip
        x = np.linspace(0.0, SLOW * model.get(f"{COUPLING}.corner_frequency"), POINTS)
        found.append(drawn(COUPLING, part, x, lambda m: passed(m, x)))
    if f"{HYSTERESIS}.stiffness" in held:
        part = _Part(
            "Torque that lags, against rotation",
            "From upright to the largest rotation, to the other side and back, as fast as a pendulum of the block's p.",
            "rotation [rad]", TORQUE, {},
        )  # fmt: skip
        reach = _reach(setup, "rotation")
        found.append(drawn(HYSTERESIS, part, there_and_back(reach), lambda m: loop(m, reach)))
    return found


def _splines(settled: Settled) -> list[_Part]:
    """Torques, dampings, frictions and readings against rotation of any shape."""
    torque = "An angular acceleration beyond that of the model without the term, a curve of any shape."
    kinds = (
        (CURVE, "odd_", ODD, "Torque against rotation, alike on both sides", torque, TORQUE),
        (CURVE, "even_", EVEN, "Torque against rotation, with one sign on both sides", torque, TORQUE),
        (
            LOSS, "", DAMPING, "Damping against rotation",
            "An angular acceleration beyond that of the model without the term, for each rad/s; below zero it damps.",
            "angular acceleration over angular velocity [1/s]",
        ),
    )  # fmt: skip
    found = []
    for effect, kind, names, label, words, y_label in kinds:
        if f"{effect}.{names[0]}" not in settled.names:
            continue
        fixed = settled.whole.model.effects[effect]
        reach, n, low = fixed[f"{kind}reach"], int(fixed[f"{kind}intervals"]), fixed.get("low", 0.0)
        units = np.eye(n + 1)
        functions = {
            f"{effect}.{name}": _from(low, reach, unit) if low < 0.0 else _spline(kind, numbers(reach, tuple(unit)))
            for name, unit in zip(names, units, strict=False)
        }
        found.append(_Part(label, words, "rotation [rad]", y_label, functions))
    if {f"{CURVE}.{ODD[0]}", f"{CURVE}.{EVEN[0]}"} <= set(settled.names):
        # What acts on one side alone is half of each: their sum says it.
        odd, even = found[:2]
        both = replace(
            odd, label="Torque against rotation, each side its own", functions={**odd.functions, **even.functions}
        )
        found[:2] = [both]
    if f"{RUBBING}.{FRICTION[0]}" in settled.names:
        low, high, most = (settled.whole.model.effects[RUBBING][name] for name in ("low", "high", "intervals"))
        units = np.eye(round(most) + 1)
        rubs = {f"{RUBBING}.{name}": _from(low, high, unit) for name, unit in zip(FRICTION, units, strict=False)}
        words = "An angular acceleration in the direction of the motion, against it where negative, whatever the speed."
        label, x_label = "Friction against rotation", "rotation [rad]"
        found.append(_Part(label, words, x_label, TORQUE, rubs))
    if f"{READING}.{MARKS[0]}" in settled.names:
        fixed = {name: settled.whole.model.effects[READING][name] for name in ("low", "high", "intervals")}
        ones = {name: LearnedReading(**fixed, **{name: 1.0}) for name in MARKS[: int(fixed["intervals"]) + 1]}
        added = {f"{READING}.{name}": lambda x, one=one: one.reading(x) - x for name, one in ones.items()}
        of_series = PARTS["reading"]
        found.append(
            _Part(
                "Reading against rotation, a curve", of_series.description, of_series.x_label, of_series.y_label, added
            )
        )
    return found


def _pushed(setup: Setup, settled: Settled, held: Mapping[str, int]) -> Curve:
    """What pushes at the same times of every test."""
    fixed = settled.whole.model.effects[PUSH]
    own = [name for name in PUSHES if f"{PUSH}.{name}" in held]
    ones = {name: LearnedPush(interval=fixed["interval"], **{name: 1.0}) for name in own}
    functions = {f"{PUSH}.{name}": lambda x, one=one: course(one, x) for name, one in ones.items()}
    part = _Part(
        "Push at the same times of every test" + ("" if fixed.get("at_rest", 1.0) else " that is shaken"),
        "A force on the whole block to -x over its mass, as much as an acceleration of the base to +x.",
        "time since the test began [s]", "acceleration [m/s²]", functions, PUSH,
    )  # fmt: skip
    return _linear(part, functions, held, settled, np.linspace(0.0, _reach(setup, "time"), 4 * POINTS))


def _spline(kind: str, of_it: tuple[float, ...]) -> Callable[[Array], Array]:
    def there(x: Array) -> Array:
        sign = np.sign(x) if kind == "odd_" else 1.0
        return np.asarray(sign * curve(np, np.abs(x), of_it, 0))

    return there


def _from(low: float, high: float, coefficients: Array) -> Callable[[Array], Array]:
    own = numbers(high - low, tuple(coefficients))
    return lambda x: np.asarray(curve(np, x - low, own, 0))


def _decay(setup: Setup, settled: Settled, held: Mapping[str, int], depth: str, span: str) -> Curve:
    """A restitution that depends on the impacts before, with a band to first order in its two parameters."""
    model = settled.whole.model
    size, width = model.get(f"{MEMORY}.{depth}"), model.get(f"{MEMORY}.{span}")
    x_label, longest = MEMORIES[depth, span]
    if depth == "first":
        longest = max((len(record.found.impacts) for record in setup.records), default=longest)
    x = np.linspace(0.0, longest, POINTS)
    fall = np.exp(-x / width)
    rows = np.array([fall, size * x / width**2 * fall])
    places = [held[f"{MEMORY}.{name}"] for name in (depth, span)]
    part = _Part(
        f"Restitution against the {x_label.partition(' [')[0]}", "What is added to the restitution.", x_label,
        "change of restitution [1]", {},
    )  # fmt: skip
    return _banded(part, x, size * fall, rows, places, settled)


def _worn(setup: Setup, settled: Settled, held: Mapping[str, int]) -> Curve:
    """A restitution that changes with use, with a band to first order in its two parameters."""
    model = settled.whole.model
    size, span, exponent = (model.get(f"{MEMORY}.{name}") for name in ("worn", "worn_use", "worn_exponent"))
    x = np.linspace(0.0, struck_before(setup.records[-1], math.inf).use(exponent), POINTS)
    fall = np.exp(-x / span)
    rows = np.array([1.0 - fall, -size * x / span**2 * fall])
    squares = exponent == 2.0
    part = _Part(
        "Restitution against use", "What is added to the restitution as the campaign goes on.",
        "sum of the squares of the speeds of all impacts before [rad²/s²]" if squares else "all impacts before",
        "change of restitution [1]", {},
    )  # fmt: skip
    return _banded(part, x, size * (1.0 - fall), rows, [held[f"{MEMORY}.worn"], held[f"{MEMORY}.worn_use"]], settled)


def _linear(
    part: _Part, own: Mapping[str, Callable[[Array], Array]], held: Mapping[str, int], settled: Settled, x: Array
) -> Curve:
    rows = np.array([function(x) for function in own.values()])
    y = rows.T @ np.array([settled.whole.model.get(name) for name in own])
    return _banded(part, x, y, rows, [held[name] for name in own], settled)


def _banded(part: _Part, x: Array, y: Array, rows: Array, places: list[int], settled: Settled) -> Curve:
    """The curve y with a band; rows: its derivatives by the parameters at these places, shape (parameter, point)."""
    acting = np.any(rows != 0.0, axis=1)  # what has no say in it may be known as little as it likes
    rows, places = rows[acting], [place for place, acts in zip(places, acting, strict=True) if acts]
    covariance = settled.covariance[np.ix_(places, places)]
    with np.errstate(invalid="ignore"):  # nothing is known of a parameter whose variance is infinite
        variance = np.einsum("ki,kl,li->i", rows, covariance, rows)
    half = 1.96 * np.sqrt(np.where(np.isfinite(variance), np.maximum(variance, 0.0), np.nan))
    return Curve(part.label, part.description, x, y, y - half, y + half, part.x_label, part.y_label)


def _reach(setup: Setup, key: str) -> float:
    """How far the campaign went along an axis."""
    rotation = max(float(np.nanmax(np.abs(record.rotation))) for record in setup.records)
    if key in ("rotation", "structural", "reading"):
        return rotation
    if key in OF_TIME:
        return max(float(record.time[-1] - record.time[0]) for record in setup.records)
    if key in ("base", "shaken", "struck"):
        bases = [t.base_x for t in setup.campaign.tests if t.base_x is not None]
        return max((float(np.nanmax(np.abs(base))) for base in bases), default=1.0)
    speeds = [abs(impact.before) for record in setup.records for impact in record.found.impacts]
    speeds = [speed for speed in speeds if math.isfinite(speed)]
    return max(speeds, default=setup.campaign.block.p() * rotation)
