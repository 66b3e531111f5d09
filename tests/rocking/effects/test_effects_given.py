"""How effects are given: as texts, from another package, to a block that carries them or not."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rocking import Block, Method1, Method2, solve
from rocking.effect import OF_THE_SENSOR
from rocking.effects import available, compose, load, parse

BLOCK = Block(b=0.2, h=0.8)


def test_texts_become_effects_with_their_parameters_put_together() -> None:
    tether, rounded = parse(["tether.slack=0.05", " rounded_edges.radius = 3e-3 ", "tether.stiffness=200"])
    assert (tether.slack, tether.stiffness, tether.side) == (0.05, 200.0, 0.0)  # type: ignore[attr-defined]
    assert rounded == load("rounded_edges")(radius=0.003)
    assert parse([]) == ()
    assert parse(["compliant_base.corner_stiffness=inf"])[0].parameters()["corner_stiffness"] == math.inf


# A block with effects may have other states than the ideal one, or its corners elsewhere: it says itself where it is.
@pytest.mark.parametrize(
    ("system", "text"),
    [
        (Method1(BLOCK), "sliding.friction=0.5"),
        (Method1(BLOCK), "learned_memory.first=0.01"),
        (Method2(BLOCK, friction=0.5), "concave_base.breadth=0.1"),
    ],
)
def test_a_run_from_a_state_of_the_block_with_its_effects_is_that_from_its_rotation(system: Any, text: str) -> None:
    effects = parse([text])
    y, q = compose(system, effects).initial_state(theta=0.02)
    one = solve(system, t_end=0.5, initial=(y, q), effects=effects)
    other = solve(system, t_end=0.5, theta=0.02, effects=effects)
    np.testing.assert_array_equal(one.y, other.y)
    np.testing.assert_array_equal(one.y[0], y)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("rounded_edges", "effect 'rounded_edges': want NAME.PARAMETER=NUMBER"),
        ("rounded_edges.radius", "effect 'rounded_edges.radius': want NAME.PARAMETER=NUMBER"),
        ("radius=0.003", "effect 'radius=0.003': want NAME.PARAMETER=NUMBER"),
        ("rounded_edges.diameter=0.003", "rounded_edges has no 'diameter', want one of radius"),
        ("rounded_edges.radius=a mm", "effect 'rounded_edges.radius=a mm': 'a mm' is not a number"),
        ("round_edges.radius=0.003", "effect='round_edges': want one of .*rounded_edges"),
        ("rounded_edges.radius=-0.003", "rounded_edges.radius=-0.003 m: want 0 to inf"),
        ("rounded_edges.radius=nan", "rounded_edges.radius=nan m: want 0 to inf"),
        ("base_tilt.angle=2", "base_tilt.angle=2.0 rad: want -1.5708 to 1.5708"),
        ("rotation_offset.offset=inf", "rotation_offset.offset=inf rad: want a number"),
        ("viscous_damping.coefficient=inf", "viscous_damping.coefficient=inf 1/s: want 0 to inf"),
        ("tether.side=0.5", "tether.side=0.5: want 1, -1 or 0"),
        ("bouncing.normal_restitution=1.2", "bouncing.normal_restitution=1.2 1: want 0 to 1"),
    ],
)
def test_a_text_that_is_no_effect_is_answered_in_one_sentence(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        parse([text])


def test_a_parameter_that_is_given_twice_is_refused() -> None:
    twice = ["tether.slack=0.05", "tether.stiffness=200", "tether.slack=0.06"]
    with pytest.raises(ValueError, match=r"effect 'tether.slack=0.06': tether.slack is given twice, want it once"):
        parse(twice)


def bounded() -> list[Any]:
    """Each end of each range, a little beyond."""
    found = []
    for name in available():
        for parameter, (low, high) in load(name).ranges.items():
            found += [(name, parameter, low - 1e-3)] if math.isfinite(low) else []
            found += [(name, parameter, high + 1e-3)] if math.isfinite(high) else []
    return found


@pytest.mark.parametrize(("name", "parameter", "value"), bounded())
def test_a_parameter_beyond_its_range_is_named_with_its_value_and_unit(name: str, parameter: str, value: float) -> None:
    with pytest.raises(ValueError) as caught:
        load(name)(**{parameter: value})
    assert f"{name}.{parameter}={value!r}" in str(caught.value)
    assert "want" in str(caught.value)


@pytest.mark.parametrize("value", [math.nan, -math.inf, "0.1", None, 1j])
@pytest.mark.parametrize("name", available())
def test_a_parameter_is_a_finite_number(name: str, value: Any) -> None:
    effect = load(name)
    for parameter in effect.parameter_names():
        default = next(f.default for f in effect.__dataclass_fields__.values() if f.name == parameter)
        if value is default:
            continue
        with pytest.raises(ValueError, match=rf"{name}\.{parameter}="):
            effect(**{parameter: value})


def test_an_effect_is_given_once() -> None:
    with pytest.raises(ValueError, match="effects: 'rounded_edges' is given twice, want it once"):
        compose(Method1(BLOCK), [load("rounded_edges")(radius=0.01), load("rounded_edges")(radius=0.02)])
    with pytest.raises(ValueError, match="'base_tilt' is given twice"):
        solve(Method1(BLOCK), t_end=0.1, effects=[load("base_tilt")(angle=0.01)] * 2)


ON_THE_BLOCK = [name for name in available() if load(name).ways() - {"base_motion", *OF_THE_SENSOR}]
ELSEWHERE = [name for name in available() if name not in ON_THE_BLOCK]


@pytest.mark.parametrize("name", ON_THE_BLOCK)
def test_the_linear_block_and_one_with_effects_do_not_carry_what_acts_on_the_block(name: str) -> None:
    effect = load(name)(**load(name).absent(BLOCK))
    with pytest.raises(ValueError, match=f"{name}: the linear Method 1 does not carry it, want form='nonlinear'"):
        solve(Method1(BLOCK, form="linear"), t_end=0.1, effects=[effect])
    composed = compose(Method1(BLOCK), parse(["viscous_damping.coefficient=0.1"]))
    with pytest.raises(ValueError, match=f"{name}: ComposedMethod1 does not carry it, want a Method1 or a Method2"):
        compose(composed, [effect])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("sliding.friction=0.4", "sliding: want a Method1, a Method2 has its friction and its impacts already"),
        ("bouncing.normal_restitution=0.4", "bouncing: want a Method1, a Method2 has"),
        ("compliant_base.corner_stiffness=1e6", "compliant_base: Method 2 does not carry it"),
        ("learned_mode.mass_ratio=0.1", "learned_mode: Method 2 does not carry it"),
    ],
)
def test_method_2_does_not_carry_other_modes_and_further_freedoms(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        solve(Method2(BLOCK, friction=0.5), t_end=0.1, effects=parse([text]))


@pytest.mark.parametrize("name", ELSEWHERE)
@pytest.mark.parametrize("system", [Method1(BLOCK, form="linear"), Method2(BLOCK, friction=0.5)])
def test_every_block_carries_what_acts_on_base_and_sensors(shaken: Any, name: str, system: Any) -> None:
    effect = load(name)(**load(name).absent(BLOCK))
    options: Any = {"theta": 0.1, "t_end": 0.5, "rtol": 1e-13, "atol": 1e-15}
    run = solve(system, shaken(), effects=[effect], **options)
    plain = solve(system, shaken(), **options)
    np.testing.assert_allclose(run.theta, plain.theta, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        (
            ("sliding.friction=0.5", "compliant_base.damping_ratio=0.1"),
            "compliant_base: Method 2, which sliding asks for, does",
        ),
        (
            ("sliding.friction=0.5", "compliant_base.corner_stiffness=1e6", "compliant_base.friction=0.4"),
            r"sliding.friction=0.5: compliant_base.friction=0.4 says it too",
        ),
        (
            ("compliant_base.corner_stiffness=1e6", "sliding.friction=0.5", "sliding.ratio_kept=0.2"),
            r"sliding.ratio_kept=0.2: want 0 beside compliant_base, of whose contacts",
        ),
        (
            ("learned_mode.mass_ratio=0.1", "bouncing.friction=0.5"),
            "learned_mode: Method 2, which bouncing asks for, do",
        ),
        (
            ("bouncing.normal_restitution=0.5", "velocity_dependent_restitution.slope=-0.01"),
            "velocity_dependent_restitution: it changes the restitution, which impacts that bounce or turn back have",
        ),
        (
            ("bouncing.friction=0.5", "sliding.friction=0.5"),
            r"sliding.friction=0.5: bouncing.friction=0.5 says it too",
        ),
    ],
)
def test_effects_that_do_not_go_together_are_refused(texts: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        compose(Method1(BLOCK), parse(texts))


# The order in which effects are given does not matter: form, hooks and base each put them in an order of their own.
def test_effects_act_alike_in_whatever_order_they_are_given(shaken: Any) -> None:
    texts = [
        "base_tilt.angle=0.02", "vertical_motion.ratio=0.2", "base_motion_lag.lag=0.01", "rounded_edges.radius=0.01",
        "base_motion_gain.gain=1.1", "concave_base.breadth=0.17", "tether.stiffness=50",
        "viscous_damping.coefficient=1",
        "rotation_offset.offset=0.01", "rotation_gain.gain=1.2", "learned_reading.cubic=0.3",
    ]  # fmt: skip
    from rocking.instruments import rotation_sensor

    runs = [
        solve(Method1(BLOCK), shaken(), theta=0.1, t_end=1.0, effects=parse(order)) for order in (texts, texts[::-1])
    ]
    np.testing.assert_allclose(runs[0].theta, runs[1].theta, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(*(rotation_sensor(run) for run in runs), rtol=0.0, atol=1e-12)


@pytest.fixture
def other_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An installed package with an effect, one that cannot be imported and one that is something else."""
    info = tmp_path / "borrowed_effects-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: borrowed-effects\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[rocking.effects]\nsteady_torque = borrowed_effects:SteadyTorque\n"
        "broken_effect = borrowed_effects_missing:Broken\nno_effect = borrowed_effects:NoEffect\n"
    )
    (tmp_path / "borrowed_effects.py").write_text(
        '"""A steady torque.\n\nAdds  theta\'\' += c\n"""\n'
        "from dataclasses import dataclass\n"
        "from typing import ClassVar\n"
        "from rocking.effect import Effect\n"
        "def steady(xp, theta, omega, s, base, values):\n"
        "    return values[0] + 0.0 * theta\n"
        "@dataclass(frozen=True)\n"
        "class SteadyTorque(Effect):\n"
        "    torque: float = 0.0\n"
        "    name: ClassVar[str] = 'steady_torque'\n"
        "    units: ClassVar[dict[str, str]] = {'torque': 'rad/s^2'}\n"
        "    acceleration = staticmethod(steady)\n"
        "class NoEffect:\n"
        "    name = 'no_effect'\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


@pytest.mark.parametrize("solver", ["scipy", "numba"])
def test_an_effect_of_another_package_is_found_and_used(other_package: Path, solver: str) -> None:
    assert {"steady_torque", "broken_effect", "rounded_edges"} <= set(available())
    (torque,) = parse(["steady_torque.torque=4"])
    # At rest the corner carries p^2 sin(alpha) = 4.33 rad/s^2 of it, and no more.
    p2 = 0.75 * 9.80665 / BLOCK.R
    holds = p2 * math.sin(BLOCK.alpha)
    assert 4.0 < holds < 4.5
    assert len(solve(Method1(BLOCK), t_end=1.0, effects=[torque], solver=solver).events) == 0
    run = solve(Method1(BLOCK), t_end=2.0, effects=parse(["steady_torque.torque=4.5"]), solver=solver)
    assert (run.onset_time, run.side) == (0.0, 1)
    other = solve(Method1(BLOCK), t_end=2.0, effects=parse(["steady_torque.torque=-4.5"]), solver=solver)
    assert (other.onset_time, other.side) == (0.0, -1)


def test_a_broken_effect_is_named_and_leaves_the_others_alone(other_package: Path) -> None:
    with pytest.raises(ImportError, match=r"'broken_effect' \(borrowed_effects_missing:Broken\) does not load"):
        load("broken_effect")
    with pytest.raises(ImportError, match=r"'no_effect' \(borrowed_effects:NoEffect\): want a subclass"):
        load("no_effect")
    assert load("rounded_edges").name == "rounded_edges"
