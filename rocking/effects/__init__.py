"""Effects: what a real block on a real base has and the ideal one lacks, one to a file, each switched on by itself.

    >>> from rocking import Block, Method1, solve
    >>> from rocking.effects import load
    >>> damped = load("viscous_damping")(coefficient=0.5)
    >>> system = Method1(Block(b=0.2, h=0.8))
    >>> run = solve(system, theta=0.12, t_end=3.0, effects=[damped])
    >>> run.peak_rotation == 0.12
    True

The modules of this folder are the effects; another package adds its own by an entry point of the group
`rocking.effects` that names the class.  What an effect is: `rocking.effect`.
"""

from __future__ import annotations

import importlib
import math
import pkgutil
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cache
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any

from rocking.effect import OF_THE_SENSOR, Effect, Seen

if TYPE_CHECKING:
    from rocking.hybrid import System
    from rocking.motion import BaseMotion

GROUP = "rocking.effects"

SLOTS = 4
"""Hooks, and the numbers that each takes, are filled up to this or twice it and so on: few kinds of loop compile."""


def _nothing_added(xp: Any, theta: Any, omega: Any, s: Any, base: Any, values: Any) -> Any:
    return 0.0 * theta


def _unchanged(xp: Any, e: Any, omega: Any, s: Any, values: Any) -> Any:
    return e


@cache
def _own() -> tuple[str, ...]:
    return tuple(sorted(info.name for info in pkgutil.iter_modules(__path__) if not info.name.startswith("_")))


def available() -> tuple[str, ...]:
    """Names of the effects that are installed, in alphabetical order."""
    return tuple(sorted({*_own(), *(point.name for point in entry_points(group=GROUP))}))


@cache
def load(name: str) -> type[Effect]:
    """The effect of that name.

    Raises:
        ValueError: no effect of that name is installed.
        ImportError: the plugin is there and does not load; it says which.
    """
    if name in _own():
        found = vars(importlib.import_module(f"{__name__}.{name}")).values()
        return next(c for c in found if isinstance(c, type) and issubclass(c, Effect) and c.name == name)
    points = {point.name: point for point in entry_points(group=GROUP)}
    if name not in points:
        raise ValueError(f"effect={name!r}: want one of {', '.join(available())}")
    try:
        effect: Any = points[name].load()
    except Exception as error:
        raise ImportError(f"effect {name!r} ({points[name].value}) does not load: {error}") from error
    if not (isinstance(effect, type) and issubclass(effect, Effect) and effect.name == name):
        raise ImportError(
            f"effect {name!r} ({points[name].value}): want a subclass of rocking.effect.Effect of that name"
        )
    return effect


def parse(texts: Iterable[str]) -> tuple[Effect, ...]:
    """Effects from texts such as "rounded_edges.radius=0.003"; parameters of one effect may come in several.

    Raises:
        ValueError: a text is not of that shape, or the effect or the parameter is unknown, given twice or out of its
            range.
    """
    given: dict[str, dict[str, float]] = {}
    for text in texts:
        left, sign, right = text.partition("=")
        name, dot, parameter = left.strip().rpartition(".")
        if not (sign and dot):
            raise ValueError(f"effect {text!r}: want NAME.PARAMETER=NUMBER")
        known = load(name).parameter_names()
        if parameter not in known:
            raise ValueError(f"effect {text!r}: {name} has no {parameter!r}, want one of {', '.join(known)}")
        if parameter in given.get(name, {}):
            raise ValueError(f"effect {text!r}: {name}.{parameter} is given twice, want it once")
        try:
            given.setdefault(name, {})[parameter] = float(right)
        except ValueError:
            raise ValueError(f"effect {text!r}: {right.strip()!r} is not a number") from None
    return tuple(load(name)(**parameters) for name, parameters in given.items())


def _check(effects: Sequence[Effect]) -> None:
    names = [effect.name for effect in effects]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError(f"effects: {twice[0]!r} is given twice, want it once")


def compose(system: System, effects: Sequence[Effect]) -> System:
    """The system with the effects that act on the block; those on the base and the sensors leave it as it is.

    Args:
        system: the ideal block: for effects on form, flow and impact a nonlinear `Method1`, or a `Method2`.
        effects: at most one of each name.

    Raises:
        ValueError: an effect is given twice, or the system cannot carry it; it says which and why.
    """
    from rocking.form import Form
    from rocking.method1 import Method1
    from rocking.method2 import Method2

    _check(effects)
    acting = [e for e in effects if e.ways_used() - {"base_motion", *OF_THE_SENSOR}]
    if not acting:
        return system
    if not isinstance(system, Method1 | Method2):
        raise ValueError(f"{acting[0].name}: {type(system).__name__} does not carry it, want a Method1 or a Method2")
    if isinstance(system, Method1) and system.form != "nonlinear":
        raise ValueError(f"{acting[0].name}: the linear Method 1 does not carry it, want form='nonlinear'")
    acting = _slipping(acting)
    form = system.shape if isinstance(system, Method2) else Form.of(system.block)
    for effect in acting:
        form = effect.form(form, system.block)
    modes = any("modes" in e.ways_used() for e in acting)
    return (_under_method2 if modes or isinstance(system, Method2) else _under_method1)(system, form, acting)


def _slipping(effects: Sequence[Effect]) -> list[Effect]:
    """The effects; where corners of one slip by themselves, it has taken the friction that sliding says.

    Raises:
        ValueError: it has a friction, or sliding says what is no matter of friction.
    """
    sliding: Any = next((e for e in effects if e.name == "sliding"), None)
    floor: Any = next((e for e in effects if e.has_feet()), None)
    if sliding is None or floor is None:
        return list(effects)
    if floor.friction < math.inf:
        raise ValueError(f"sliding.friction={sliding.friction!r}: {floor.name}.friction={floor.friction!r} says it too")
    if sliding.ratio_kept:
        raise ValueError(
            f"sliding.ratio_kept={sliding.ratio_kept!r}: want 0 beside {floor.name}, of whose contacts it follows what "
            "an impact keeps"
        )
    taken = replace(floor, friction=sliding.friction)
    return [taken if e is floor else e for e in effects if e is not sliding]


def _under_method2(method: Any, form: Any, effects: Sequence[Effect]) -> System:
    from rocking.composed_method2 import ComposedMethod2
    from rocking.form import Form
    from rocking.method2 import Method2

    leading = [e for e in effects if "modes" in e.ways_used()]
    other = next((e for e in effects if "freedoms" in e.ways_used()), None)
    if other is not None:
        asked = f", which {leading[0].name} asks for," if leading else ""
        raise ValueError(f"{other.name}: Method 2{asked} does not carry it")
    if leading and isinstance(method, Method2):
        raise ValueError(f"{leading[0].name}: want a Method1, a Method2 has its friction and its impacts already")
    own = None if form == Form.of(method.block) else form
    system: Any = method if leading else replace(method, form=own)
    for effect in leading:
        system = effect.modes(system, own)
    striking = [e for e in effects if e.strikes()]
    if striking and system.impact_law != "two_corner":
        # Without bounce and tangential restitution it is the same law, but for a number that can be changed.
        if (system.impact_law, system.normal_restitution, system.tangential_restitution) != ("frictional", 0.0, 0.0):
            raise ValueError(
                f"{striking[0].name}: it changes the restitution, which impacts that bounce or turn back have not as a "
                "number"
            )
        least = form.friction_to_stick()
        if system.mu_k < least:
            raise ValueError(
                f"{striking[0].name}: friction={system.mu_k!r} (kinetic): want at least {least:.6g} or a restitution "
                "that is given; in an impact with less friction the corner slips, and what it keeps is no number that "
                "could be changed"
            )
        system = replace(system, impact_law="two_corner", restitution=form.housner_restitution)
    # Those that do not strike with these numbers are kept where there is what others of a batch may change.
    hooks = _hooks(effects, form, None if system.impact_law == "two_corner" else striking)
    return ComposedMethod2(system, hooks, tuple(effects)) if hooks.pushing + hooks.striking > 0 else system


def _under_method1(method: Any, form: Any, effects: Sequence[Effect]) -> System:
    from rocking.composed import ComposedMethod1

    system: Any = ComposedMethod1(method, form, _hooks(effects, form), tuple(effects))
    further = [e for e in effects if "freedoms" in e.ways_used()]
    if len(further) > 1:
        raise ValueError(f"{further[1].name}: it does not go together with {further[0].name}")
    return further[0].freedoms(system) if further else system


def _hooks(effects: Sequence[Effect], form: Any, striking: Sequence[Effect] | None = None) -> Any:
    """The hooks of the effects and the numbers they take, one row each.

    striking: those that change the restitution; all that may, if not given.
    """
    from rocking.hybrid import Hooks

    pushing = [e for e in effects if "acceleration" in e.ways()]
    striking = [e for e in effects if "restitution" in e.ways()] if striking is None else list(striking)
    slots = _filled(max(len(pushing), len(striking)))
    accelerations = [type(e).acceleration for e in pushing] + [_nothing_added] * (slots - len(pushing))
    restitutions = [type(e).restitution for e in striking] + [_unchanged] * (slots - len(striking))
    rows = {i: e.values(form) for i, e in enumerate(pushing)}
    rows |= {slots + i: e.values(form) for i, e in enumerate(striking)}
    width = _filled(max([0, *map(len, rows.values())]))
    values = tuple((*rows.get(i, ()), *(0.0,) * (width - len(rows.get(i, ())))) for i in range(2 * slots))
    return Hooks(tuple(accelerations), tuple(restitutions), values, len(pushing), len(striking))


def _filled(count: int) -> int:
    """SLOTS, or the power of two times it that holds so many."""
    size = SLOTS
    while size < count:
        size *= 2
    return size


def base_with(motion: BaseMotion, effects: Sequence[Effect], span: tuple[float, float], g: float) -> BaseMotion:
    """What the base really does over the span [s] when `motion` is what is said of it."""
    for effect in sorted(effects, key=lambda e: e.rank):
        motion = effect.base_motion(motion, span, g)
    return motion


def read_at(time: Any, effects: Sequence[Effect]) -> Any:
    """When what the rotation sensor says at these times since its record began [s] happened, shape (time,)."""
    for effect in sorted(effects, key=lambda e: e.rank, reverse=True):
        time = effect.moments(time)
    return time


def rotation_reading(theta: Any, effects: Sequence[Effect]) -> Any:
    """What the rotation sensor says [rad] when the rotation is theta."""
    for effect in sorted(effects, key=lambda e: e.rank):
        theta = effect.reading(theta)
    return theta


def recorded_rotation(theta: Any, effects: Sequence[Effect], seen: Seen) -> Any:
    """What the rotation sensor says [rad] sample by sample, shape (time,), when the rotation is theta.

    theta: from a peak or a rest on; from where else it begins, a sensor that remembers says something else.
    """
    for effect in sorted(effects, key=lambda e: e.rank):
        theta = effect.recorded(theta, seen)
    return theta
