"""Every installed effect keeps the contract: what it states of itself, absent it is not there, solvers agree on it."""

import dataclasses
import importlib
import inspect
import math
import re
from typing import Any

import numpy as np
import pytest

from rocking import Block, Method1, solve
from rocking.effect import OF_THE_SENSOR, WAYS, Effect
from rocking.effects import available, base_with, compose, load

NAMES = available()
METHOD_2 = ("bouncing", "sliding")

PRESENT: dict[str, dict[str, float]] = {
    "base_adhesion": {"moment": 25.0},
    "base_motion_gain": {"gain": 1.05},
    "base_motion_lag": {"lag": 0.013},
    "base_tilt": {"angle": 0.02},
    "bouncing": {"normal_restitution": 0.2, "friction": 0.9},
    "compliant_base": {"corner_stiffness": 5e6, "damping_ratio": 0.5},
    "concave_base": {"breadth": 0.17},
    "eccentric_mass": {"offset": -0.012, "apart": 0.7},
    "learned_term": {
        "bias": 0.05,
        "side": 0.03,
        "spring": -0.4,
        "cubic": 2.0,
        "friction": 0.02,
        "damping": -0.1,
        "side_damping": 0.05,
        "drag": -0.1,
        "cubic_damping": 0.02,
        "base": 0.05,
        "restitution_side": 0.01,
        "restitution_speed": -0.02,
        "restitution_square": 0.01,
        "structural": -0.3,
        "side_friction": -0.01,
        "outward": 0.03,
    },
    "learned_base": {"frequency": 9.0, "damping_ratio": 0.1, "share": 0.8},
    "learned_coupling": {"corner_frequency": 0.3},
    "learned_curve": {
        "odd_reach": 0.2,
        "odd_intervals": 3.0,
        **{f"odd_{j}": value for j, value in enumerate((0.1, -0.2, 0.15, 0.05))},
        "even_reach": 0.15,
        "even_intervals": 2.0,
        **{f"even_{j}": value for j, value in enumerate((0.02, -0.03, 0.04))},
    },
    "learned_damping": {
        "low": -0.08,
        "reach": 0.1,
        "intervals": 2.0,
        **{f"damping_{j}": value for j, value in enumerate((-0.2, 0.1, -0.05))},
    },
    "learned_friction": {
        "low": -0.1,
        "high": 0.15,
        "intervals": 3.0,
        **{f"friction_{j}": value for j, value in enumerate((-0.1, 0.05, -0.04, -0.08))},
    },
    "learned_hysteresis": {"stiffness": 30.0, "width": 0.05, "time": 0.7, "strained": 0.5, "exponent": 1.6},
    "learned_memory": {
        "first": -0.05,
        "first_impacts": 3.0,
        "recent": -0.04,
        "recent_time": 0.3,
        "least_speed": 0.05,
        "worn": 0.03,
        "worn_use": 1.5,
        "worn_exponent": 2.0,
        "used": 0.4,
    },
    "learned_mode": {"mass_ratio": 0.02, "height_ratio": 1.2, "frequency": 3.0, "damping_ratio": 0.1},
    "learned_push": {"interval": 0.2, "at_rest": 0.5, "still": 0.01, "push_2": 0.4, "push_3": -0.7},
    "learned_reading": {"square": 0.1, "cubic": -0.3, "play": 0.002, "drift": 1e-3, "base": 1e-3},
    "learned_response": {"frequency": 14.0, "damping_ratio": 0.7},
    "learned_timing": {"pace": 0.01, "lag": 0.02},
    "mass_distribution": {"height": 0.45, "inertia": 6.0},
    "quadratic_drag": {"coefficient": 0.8},
    "rotation_gain": {"gain": 1.1},
    "rotation_offset": {"offset": 0.01},
    "rounded_edges": {"radius": 0.015},
    "sliding": {"friction": 0.8},
    "table_pitch": {"per_acceleration": 1e-4, "per_displacement": 0.02},
    "tether": {"slack": 0.01, "stiffness": 100.0, "side": 1.0},
    "velocity_dependent_restitution": {"slope": -0.1},
    "vertical_motion": {"ratio": 0.1, "second_harmonic_ratio": 0.2, "second_harmonic_quadrature": -0.1},
    "viscous_damping": {"coefficient": 0.4},
}
"""Values at which each effect of this package is there; one that is added asks for its own."""

PROMISED = {name for name in PRESENT if not name.startswith("learned_")}


def test_the_effects_that_a_laboratory_is_promised_are_installed() -> None:
    assert set(NAMES) >= PROMISED
    assert list(NAMES) == sorted(NAMES)
    assert not set(NAMES) - set(PRESENT), "an effect without values in PRESENT is not tested"


@pytest.mark.parametrize("name", NAMES)
def test_an_effect_states_its_name_its_parameters_and_their_units(name: str, block: Block) -> None:
    effect = load(name)
    assert issubclass(effect, Effect)
    assert effect.name == name == effect.__module__.rpartition(".")[2]
    assert dataclasses.is_dataclass(effect)
    assert effect.__dataclass_params__.frozen  # type: ignore[attr-defined]
    assert set(effect.units) == set(effect.parameter_names())
    assert set(effect.ranges) <= set(effect.parameter_names())
    assert all(isinstance(unit, str) and unit for unit in effect.units.values())
    absent = effect.absent(block)
    assert set(absent) == set(effect.parameter_names())
    assert all(type(value) is float for value in absent.values())
    effect(**absent)
    # The defaults are the absent values, or None where these depend on the block.
    for field in dataclasses.fields(effect):
        assert field.default is None or field.default == absent[field.name] or name == "compliant_base"
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(effect(**absent), effect.parameter_names()[0], 0.5)


@pytest.mark.parametrize("name", NAMES)
def test_an_effect_says_what_it_does_where_its_limits_are_and_whence_it_comes(name: str, block: Block) -> None:
    head = importlib.import_module(load(name).__module__).__doc__ or ""
    for part in ("Parameters", "Use when", "Limits", "Source", "Status"):
        text = re.search(rf"^{part} +(\S.*)$", head, re.MULTILINE)
        assert text, f"{name} says nothing of {part!r}"
    assert re.search(r"^(Adds|Changes) +\S", head, re.MULTILINE)
    for parameter, unit in load(name).units.items():
        assert re.sub(r"_\d+$", "_0", parameter) in head
        assert unit == "1" or f"[{unit}]" in head or "in SI units of" in head
    assert "absent" in head or set(load(name).absent(block).values()) == {0.0}


@pytest.mark.parametrize("name", NAMES)
def test_an_effect_acts_in_known_ways_alone(name: str) -> None:
    effect = load(name)
    assert effect.ways()
    # A misspelt way would never be called: whatever is public and called belongs to the base class.
    known = {n for n in dir(Effect) if not n.startswith("_")} | set(effect.parameter_names())
    assert not [n for n in vars(effect) if not n.startswith("_") and n not in known]
    arity = {"acceleration": ["xp", "theta", "omega", "s", "base", "values"], "restitution": ["xp", "e", "omega", "s"]}
    for way, names in arity.items():
        if way in effect.ways():
            given = list(inspect.signature(getattr(effect, way)).parameters)
            assert given[: len(names)] == names
            assert given[-1] == "values"
    assert effect.ways() <= set(WAYS)


def test_a_misspelt_way_is_one_that_the_contract_finds() -> None:
    class Misspelt(Effect):
        name = "misspelt"

        def base_moton(self) -> None:
            """Never called."""

    known = {n for n in dir(Effect) if not n.startswith("_")}
    assert [n for n in vars(Misspelt) if not n.startswith("_") and n not in known] == ["base_moton"]
    assert not Misspelt.ways()


def shaken_runs(solver: str, effects: Any, motion: Any, **options: Any) -> Any:
    options = {"t_end": 3.0, "rtol": 1e-13, "atol": 1e-16} | options
    return solve(Method1(Block(b=0.2, h=0.8)), motion, solver=solver, effects=effects, **options)


IDEAL: dict[tuple[str, float], Any] = {}


def ideal(solver: str, motion: Any, theta: float) -> Any:
    if (solver, theta) not in IDEAL:
        IDEAL[solver, theta] = shaken_runs(solver, [], motion, theta=theta)
    return IDEAL[solver, theta]


def must_be_absent(name: str, solver: str, motion: Any, theta: float) -> None:
    block = Block(b=0.2, h=0.8)
    effect = load(name)(**load(name).absent(block))
    plain, run = ideal(solver, motion, theta), shaken_runs(solver, [effect], motion, theta=theta)
    assert len(plain.impact_times) >= 3
    assert run.outcome is plain.outcome
    if name in METHOD_2:
        # The same motion told in other coordinates and by other guards: its tip comes out of the force at the corner.
        np.testing.assert_allclose(run.impact_times, plain.impact_times, rtol=0.0, atol=1e-11)
        return
    np.testing.assert_array_equal(run.events.mode_after, plain.events.mode_after)
    np.testing.assert_allclose(run.events.t, plain.events.t, rtol=0.0, atol=1e-12)
    assert run.peak_rotation == pytest.approx(plain.peak_rotation, abs=1e-11)


@pytest.mark.parametrize("theta", [0.0, 0.1])
@pytest.mark.parametrize("solver", ["scipy", "numba"])
@pytest.mark.parametrize("name", NAMES)
def test_an_effect_with_its_absent_values_is_not_there(shaken: Any, name: str, solver: str, theta: float) -> None:
    must_be_absent(name, solver, shaken(), theta)


def diffrax_case(name: str) -> Any:
    """Compiling takes seconds for each kind of equations: one of a kind by default, the others when asked for."""
    default = name in ("rounded_edges",)
    return pytest.param(name, marks=() if default else pytest.mark.slow)


@pytest.mark.parametrize("name", [diffrax_case(name) for name in NAMES])
def test_an_effect_with_its_absent_values_is_not_there_for_diffrax(shaken: Any, name: str) -> None:
    must_be_absent(name, "diffrax", shaken(), 0.1)


def must_agree(name: str, solver: str, motion: Any, *, t_end: float, tolerances: tuple[float, float]) -> None:
    """Events alike and impacts to 1e-8 s against scipy."""
    effect = load(name)(**PRESENT[name])
    options: Any = {"theta": 0.1, "rtol": tolerances[0], "atol": tolerances[1], "t_end": t_end}
    one = shaken_runs("scipy", [effect], motion, **options)
    other = shaken_runs(solver, [effect], motion, **options)
    assert len(one.impact_times) >= 2
    np.testing.assert_array_equal(one.events.guard, other.events.guard)
    np.testing.assert_array_equal(one.events.mode_after, other.events.mode_after)
    np.testing.assert_array_equal(one.events.s_after, other.events.s_after)
    np.testing.assert_allclose(other.impact_times, one.impact_times, rtol=0.0, atol=1e-8)
    assert one.outcome is other.outcome
    assert other.peak_rotation == pytest.approx(one.peak_rotation, abs=1e-7)


def span_of(name: str) -> tuple[float, tuple[float, float]]:
    """How far, and how sharp: springs ring, and a ringing is followed for a swing or two only."""
    return (0.8, (1e-11, 1e-14)) if name == "compliant_base" else (2.0, (1e-12, 1e-15))


@pytest.mark.parametrize("name", NAMES)
def test_solvers_agree_on_an_effect_that_is_there(shaken: Any, name: str) -> None:
    t_end, tolerances = span_of(name)
    must_agree(name, "numba", shaken(), t_end=t_end, tolerances=tolerances)


@pytest.mark.parametrize("name", [diffrax_case(name) for name in NAMES])
def test_diffrax_agrees_on_an_effect_that_is_there(shaken: Any, name: str) -> None:
    t_end, tolerances = span_of(name)
    must_agree(name, "diffrax", shaken(), t_end=t_end, tolerances=tolerances)


ALONE = (*METHOD_2, "compliant_base", "learned_hysteresis", "learned_mode")
"""What has modes or states of its own; `learned_memory`, which has some too, stands for them among all together."""

TOGETHER = [name for name in NAMES if name not in ALONE]


@pytest.mark.slow  # the equations of all effects at once take a minute to compile
@pytest.mark.parametrize("solver", ["numba", "diffrax"])
def test_solvers_agree_on_all_effects_together(shaken: Any, solver: str) -> None:
    effects = [load(name)(**PRESENT[name]) for name in TOGETHER]
    options: Any = {"theta": 0.05, "rtol": 1e-11, "atol": 1e-14, "t_end": 0.8}
    one, other = (shaken_runs(s, effects, shaken(), **options) for s in ("scipy", solver))
    assert len(one.impact_times) >= 2
    np.testing.assert_array_equal(one.events.guard, other.events.guard)
    np.testing.assert_allclose(other.impact_times, one.impact_times, rtol=0.0, atol=1e-8)


def left_out(name: str) -> Any:
    """Without one of the effects the equations are compiled anew: for what is learned when asked for."""
    return pytest.param(name, marks=pytest.mark.slow if name.startswith("learned_") else ())


@pytest.mark.slow
@pytest.mark.parametrize("name", [left_out(n) for n in TOGETHER if not load(n).ways() <= OF_THE_SENSOR])
def test_each_of_all_effects_together_acts(shaken: Any, name: str) -> None:
    # Upright at first, so that adhesion has a say.
    effects = [load(name)(**PRESENT[name]) for name in TOGETHER]
    options: Any = {"rtol": 1e-9, "atol": 1e-12, "t_end": 3.0}
    with_all = shaken_runs("numba", effects, shaken(), **options)
    without = shaken_runs("numba", [e for e in effects if e.name != name], shaken(), **options)
    length = min(with_all.t.size, without.t.size)
    assert np.max(np.abs(with_all.theta[:length] - without.theta[:length])) > 1e-6


@pytest.mark.parametrize("other", ["quadratic_drag", "learned_curve"])
def test_a_batch_of_different_effects_is_refused(other: str) -> None:
    from rocking import solve_batch

    method = Method1(Block(b=0.2, h=0.8))
    systems = [compose(method, [load(name)(**PRESENT[name])]) for name in ("viscous_damping", other)]
    with pytest.raises(ValueError, match="want the same effects"):
        solve_batch(systems, theta=0.1, t_end=1.0)


def test_a_hook_that_takes_a_number_too_many_is_refused(shaken: Any) -> None:
    from rocking.effects import viscous_damping

    class Greedy(viscous_damping.ViscousDamping):
        acceleration = staticmethod(greedy)

    with pytest.raises(ValueError, match=r"greedy: takes a number beyond the 4 that there are of its effect"):
        solve(Method1(Block(b=0.2, h=0.8)), None, theta=0.1, t_end=1.0, effects=[Greedy(0.1)], solver="numba")


def greedy(xp: Any, theta: Any, omega: Any, s: Any, base: Any, values: Any) -> Any:
    return -values[4] * omega


@pytest.mark.slow
def test_a_batch_has_room_for_any_number_of_effects(shaken: Any) -> None:
    from rocking import solve_batch

    names = ("viscous_damping", "quadratic_drag", "tether", "learned_term", "learned_damping", "learned_curve")
    method, motion = Method1(Block(b=0.2, h=0.8)), shaken()
    effects = [load(name)(**PRESENT[name]) for name in names]
    batch = solve_batch([compose(method, effects)], [motion], t_end=2.0, theta=[0.05, 0.1])
    for i, theta in enumerate((0.05, 0.1)):
        single = solve(method, motion, theta=theta, t_end=2.0, effects=effects)
        assert (batch.peak_rotation[i], batch.impacts[i]) == (single.peak_rotation, len(single.impact_times))


@pytest.mark.parametrize("name", TOGETHER)
def test_a_run_of_a_batch_is_the_single_run(shaken: Any, name: str) -> None:
    from rocking import solve_batch

    effect = load(name)(**PRESENT[name])
    method, motion = Method1(Block(b=0.2, h=0.8)), shaken()
    system, base = compose(method, [effect]), base_with(motion, [effect], (0.0, 2.0), method.g)
    batch = solve_batch([system], [base], t_end=2.0, theta=[0.05, 0.1])
    for i, theta in enumerate((0.05, 0.1)):
        single = solve(method, motion, theta=theta, t_end=2.0, effects=[effect])
        assert batch.peak_rotation[i] == single.peak_rotation
        assert batch.impacts[i] == len(single.impact_times)
        assert batch.overturned[i] == single.overturned
        assert batch.t_end[i] == single.t_end or math.isclose(batch.t_end[i], single.t_end, rel_tol=0.0, abs_tol=1e-14)
