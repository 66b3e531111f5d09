"""The virtual laboratory's block in MuJoCo against the laboratory's own equations: two engines, one block.

Nothing about impacts is put into MuJoCo, so its ratio of angular speeds is a check of Housner's, too.
"""

import sys
from dataclasses import replace

import numpy as np
import pytest

from studies.campaigns import Test
from studies.laboratory import by_mujoco, event, slip
from studies.laboratory.campaign import make_campaign
from studies.laboratory.effects import Lab
from studies.laboratory.parameters import World, uniform
from studies.laboratory.plans import check_together
from studies.laboratory.prediction import predicted
from studies.laboratory.table import Table, felt_by_motion, ramp
from studies.loop_trials import arguments

H = 2e-3  # s
BLOCK = uniform(0.2, 0.8, 30.0, 0.9)
IDEAL = replace(BLOCK, restitution=by_mujoco.ratio_by_momentum(BLOCK))
NO_TABLE = Table()

WORLDS = {
    "none": {},
    "rounded_edges": {"radius": 0.004},
    "concave_base": {"half_breadth": 0.097},
    "mass_distribution": {"centre_height": 0.41, "inertia": 1.05 * BLOCK.inertia},
    "base_tilt": {"tilt": 0.004},
    "eccentric_mass": {"offset": 0.002},
    "viscous_damping": {"viscous": 0.1},
    "tether": {"tether_stiffness": 30.0, "tether_plus": 0.03},
    "tether to the other side": {"tether_stiffness": 30.0, "tether_minus": 0.03},
    "eccentric_mass on rounded_edges": {"radius": 0.004, "offset": 0.002},
}


def world(**changes: float) -> World:
    """A block whose impacts keep angular momentum, as they do in MuJoCo."""
    changed = replace(BLOCK, **changes)
    return replace(changed, restitution=by_mujoco.ratio_by_momentum(changed))


def shaken(frequency: float, peak: float, seed: int, table: Table = NO_TABLE) -> np.ndarray:
    motion = ramp(np.random.default_rng(seed), frequency, peak)
    return felt_by_motion(motion, H, int((motion.end + 1.0) / H) // 2 * 2 + 1, table)


def rms(difference: np.ndarray) -> float:
    return float(np.sqrt(np.mean(difference**2)))


@pytest.mark.parametrize(("name", "lean"), [*((name, 0.15) for name in WORLDS), ("none", -0.15), ("base_tilt", -0.15)])
def test_a_release_is_that_of_the_other_engine(name: str, lean: float) -> None:
    """Three seconds, five impacts and more: 5e-5 to 4e-4 rad apart, where the effects move it by 0.01 rad and more."""
    felt = felt_by_motion(None, H, 1501, NO_TABLE)
    one, other = (e.simulate(world(**WORLDS[name]), felt, H, 2, lean).rotation for e in (by_mujoco, event))
    moved = rms(other - event.simulate(IDEAL, felt, H, 2, lean).rotation)
    assert rms(one - other) < (1e-4 if name == "none" else moved / 40.0)
    assert name == "none" or moved > 0.01


@pytest.mark.parametrize(
    "name",
    [
        "none",
        "rounded_edges",
        *(
            pytest.param(name, marks=pytest.mark.slow)
            for name in ("concave_base", "base_tilt", "eccentric_mass", "viscous_damping", "tether")
        ),
    ],
)
def test_a_shaken_block_is_that_of_the_other_engine(name: str) -> None:
    """A ramp that leaves sensitive motions aside: a tenth of what the effect does, or less."""
    felt = shaken(3.0, 3.4, 1)
    one, other = (e.simulate(world(**WORLDS[name]), felt, H, 2, 0.0).rotation for e in (by_mujoco, event))
    moved = rms(other - event.simulate(IDEAL, felt, H, 2, 0.0).rotation)
    assert rms(one - other) < (1e-4 if name == "none" else moved / 10.0)
    assert np.abs(other).max() > 0.04


def test_heave_is_felt() -> None:
    felt, level = shaken(3.0, 3.4, 1, Table(vertical=0.1)), shaken(3.0, 3.4, 1)
    one, other, without = (
        e.simulate(IDEAL, f, H, 2, 0.0).rotation for e, f in ((by_mujoco, felt), (event, felt), (event, level))
    )
    assert rms(one - other) < rms(other - without) / 20.0


@pytest.mark.slow
@pytest.mark.parametrize(("frequency", "peak"), [(3.5, 4.5), (5.0, 6.0)])
def test_where_friction_gives_way_it_slides_as_the_laboratory_has_it(frequency: float, peak: float) -> None:
    """The laboratory keeps the ratio of angular speeds in an impact in which the new corner slides: so does MuJoCo."""
    felt, slippery = shaken(frequency, peak, 2), replace(IDEAL, friction=0.252)
    one, other = (e.simulate(slippery, felt, H, 2, 0.0).rotation for e in (by_mujoco, slip))
    moved = rms(other - event.simulate(IDEAL, felt, H, 2, 0.0).rotation)
    assert moved > 2e-3
    assert rms(one - other) < moved / 15.0


@pytest.mark.parametrize(("breadth", "height"), [(0.2, 0.8), (0.3, 0.7), (0.1, 0.9)])
def test_the_ratio_over_an_impact_is_housners(breadth: float, height: float) -> None:
    block = uniform(breadth, height, 30.0, 0.5)
    assert by_mujoco.ratio_by_momentum(block) == pytest.approx(1.0 - 1.5 * breadth**2 / (breadth**2 + height**2))
    felt = felt_by_motion(None, 5e-4, 3001, NO_TABLE)
    response = by_mujoco.simulate(block, felt, 5e-4, 1, 0.6 * block.alpha)
    hit = np.flatnonzero(np.diff(np.sign(response.rotation)))[0]
    # 20 ms on either side of it, after what flight there is; energy tells the angular speed at the impact.
    speeds = []
    for k in (hit - 40, hit + 41):
        theta = abs(response.rotation[k])
        rise = block.half_breadth * np.sin(theta) - block.centre_height * (1.0 - np.cos(theta))
        speeds.append(
            np.sqrt(response.velocity[k] ** 2 + 2.0 * block.mass * block.gravity * rise / block.corner_inertia)
        )
    assert speeds[1] / speeds[0] == pytest.approx(by_mujoco.ratio_by_momentum(block), rel=3e-3)


def test_a_block_that_falls_is_not_a_number_from_then_on() -> None:
    response = by_mujoco.simulate(BLOCK, felt_by_motion(None, H, 1501, NO_TABLE), H, 2, 0.3)
    assert response.fell is not None
    assert np.isfinite(response.rotation[: response.fell]).all()
    assert np.isnan(response.rotation[response.fell :]).all()
    assert np.abs(response.rotation[: response.fell]).max() > 1.1


def test_damping_is_that_of_a_block_on_round_edges() -> None:
    """Of edges this round the inertia about a sharp corner would be 2.5 % too large, 1e-3 rad."""
    felt, round_ = felt_by_motion(None, H, 1501, NO_TABLE), world(radius=0.03, viscous=0.3)
    one, other = (e.simulate(round_, felt, H, 2, 0.12).rotation for e in (by_mujoco, event))
    assert rms(one - other) < 2e-4


@pytest.mark.parametrize(
    ("names", "sentence"),
    [
        (["quadratic_drag"], r"quadratic=.*: not in the laboratory of the engine 'mujoco'"),
        (["table_pitch"], r"pitch_\w+=.*: not in the laboratory of the engine 'mujoco'"),
        (["wear"], "wear=.*: not in the laboratory of the engine 'mujoco'"),
        (["compliant_base"], "engine='contact': the laboratory is of 'mujoco' already"),
        (["sliding", "base_adhesion"], "adhesion=.*: not in the laboratory of the engine 'mujoco'"),
        (["sliding", "sliding"], "friction=.*: another effect has set it already"),
    ],
)
def test_what_it_lacks_is_refused(names: list[str], sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        check_together(names, "mujoco")


@pytest.mark.parametrize("name", by_mujoco.FOREIGN)
def test_nothing_foreign_is_left_out_without_a_word(name: str) -> None:
    with pytest.raises(ValueError, match=f"{name}=.*not in the laboratory of the engine 'mujoco'"):
        by_mujoco.simulate(replace(BLOCK, **{name: 0.1}), felt_by_motion(None, H, 5, NO_TABLE), H, 2, 0.1)


def test_a_floor_that_turns_is_refused() -> None:
    with pytest.raises(ValueError, match="table_pitch: not in the laboratory"):
        by_mujoco.simulate(BLOCK, shaken(3.0, 3.4, 1, Table(pitch_displacement=0.01)), H, 2, 0.0)


def test_without_mujoco_it_says_what_to_install(monkeypatch, capsys) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(SystemExit):
        arguments(["--engine", "mujoco"])
    assert "want the package mujoco (python -m pip install mujoco)" in capsys.readouterr().err


def test_trials_take_the_effects_that_it_has(capsys) -> None:
    effects = arguments(["--engine", "mujoco"]).effects
    assert {"null", "rounded_edges", "sliding", "tether"} <= set(effects)
    assert not {"quadratic_drag", "table_pitch", "bouncing", "wear"} & set(effects)
    with pytest.raises(SystemExit):
        arguments(["--engine", "mujoco", "--effects", "quadratic_drag"])
    assert "not in the laboratory of the engine 'mujoco'" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        arguments(["--engine", "mujoco", "--channel", "outcome"])
    assert "--channel outcome: want rotation of the engine mujoco" in capsys.readouterr().err


@pytest.mark.slow
def test_a_campaign_of_it_is_met_by_its_own_model(tmp_path) -> None:
    """The calibrated baseline of a clean campaign is a block of the laboratory's own equations."""
    truth = make_campaign(3, [], tmp_path, engine="mujoco")
    assert truth.about["engine"] == "mujoco"
    assert truth.baseline["fit"] < 1.3 * truth.floor["fit"]
    assert truth.baseline["restitution"] == pytest.approx(truth.restitution, abs=2e-3)


def test_the_rotation_predicted_is_that_of_its_engine() -> None:
    """A laboratory of MuJoCo predicts with MuJoCo."""
    test = Test("free-01", "free", H * 2 * np.arange(100), {}, initial_rotation=0.15)
    rotation = predicted(Lab(IDEAL, engine="mujoco"), test, 0.15)
    own = by_mujoco.simulate(IDEAL, felt_by_motion(None, H, 199, NO_TABLE), H, 2, 0.15).rotation
    assert rotation == pytest.approx(own, abs=1e-12)
