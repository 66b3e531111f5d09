"""The virtual laboratory's block as a distinct element against the laboratory's own block on springs."""

from dataclasses import replace

import numpy as np
import pytest

from studies.laboratory import by_dem, contact, event
from studies.laboratory.campaign import make_campaign
from studies.laboratory.effects import NAMED, Draw, Lab
from studies.laboratory.parameters import uniform
from studies.laboratory.plans import check_together
from studies.laboratory.table import Table, felt_by_motion, ramp
from studies.loop_trials import arguments

H = 2e-3  # s
BLOCK = uniform(0.2, 0.8, 30.0, 0.9)
DRAW = Draw(1.0, 0.5, 0.5, 0.5)
AT_REST = felt_by_motion(None, H, 1501, Table())


def shaken(table: Table) -> np.ndarray:
    motion = ramp(np.random.default_rng(1), 3.0, 3.4)
    return felt_by_motion(motion, H, int((motion.end + 1.0) / H) // 2 * 2 + 1, table)


def rms(difference: np.ndarray) -> float:
    return float(np.sqrt(np.mean(difference**2)))


@pytest.mark.parametrize(
    ("table", "tilt", "lean"),
    [
        (None, 0.0, 0.15),
        pytest.param(Table(), 0.0, 0.0, marks=pytest.mark.slow),
        pytest.param(Table(vertical=0.1), 0.0, 0.0, marks=pytest.mark.slow),
        (Table(), 0.003, 0.0),
    ],
)
def test_corners_give_along_the_floor_as_those_of_the_laboratory_do(table, tilt: float, lean: float) -> None:
    """contact.py, which shares no code with it: as near as a 20th of what the soft floor does, where friction holds.

    At the friction of a campaign they slip in every impact, by two laws: dem cuts the spring and turns the dashpot off.
    """
    felt = AT_REST if table is None else shaken(table)
    world = NAMED["compliant_base"](Lab(BLOCK), DRAW, 1.0)[0].world
    for friction, near in ((20.0, 20.0), (world.friction, 8.0)):
        soft = replace(world, tilt=tilt, friction=friction, give=1.0)
        own = contact.simulate(soft, felt, H, 2, lean).rotation
        hard = event.simulate(replace(BLOCK, restitution=0.9118, tilt=tilt), felt, H, 2, lean).rotation
        assert rms(by_dem.simulate(soft, felt, H, 2, lean).rotation - own) < rms(own - hard) / near


def test_a_block_that_falls_is_not_a_number_from_then_on() -> None:
    soft = NAMED["compliant_base"](Lab(BLOCK, engine="dem"), DRAW, 1.0)[0].world
    response = by_dem.simulate(soft, AT_REST, H, 2, 0.3)
    assert response.fell is not None
    assert np.isfinite(response.rotation[: response.fell]).all()
    assert np.isnan(response.rotation[response.fell :]).all()
    assert np.abs(response.rotation[: response.fell]).max() > 1.1


@pytest.mark.parametrize(
    ("names", "sentence"),
    [
        ([], "want two corners that give"),
        (["winkler_bed"], "springs=15.0: not in the laboratory of the engine 'dem'"),
        (["sliding"], "engine='slip': the laboratory is of 'dem' already"),
        (["compliant_base", "rounded_edges"], "radius=.*: not in the laboratory of the engine 'dem'"),
        (["compliant_base", "concave_base"], "inertia=.*: not in the laboratory of the engine 'dem'"),
        (["compliant_base", "table_pitch"], "pitch_.*: not in the laboratory of the engine 'dem'"),
        (["compliant_base", "bouncing"], "stiffness=.*: another effect has set it already"),
        (["winkler_bed", "bouncing"], "stiffness=.*: another effect has set it already"),
        (["bouncing", "wear"], "wear=.*: not in the laboratory of the engine 'dem'"),
    ],
)
def test_what_it_lacks_is_refused(names: list[str], sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        check_together(names, "dem")


def test_an_engine_that_is_not_there_is_refused() -> None:
    with pytest.raises(ValueError, match="engine='slip': want one of event, mujoco, dem"):
        check_together(["sliding"], "slip")


@pytest.mark.parametrize("name", by_dem.FOREIGN)
def test_nothing_foreign_is_left_out_without_a_word(name: str) -> None:
    soft = NAMED["compliant_base"](Lab(BLOCK, engine="dem"), DRAW, 1.0)[0].world
    with pytest.raises(ValueError, match=f"{name}=.*not in the laboratory of the engine 'dem'"):
        by_dem.simulate(replace(soft, **{name: 0.1}), AT_REST, H, 2, 0.1)


def test_a_floor_that_turns_is_refused() -> None:
    soft = NAMED["compliant_base"](Lab(BLOCK, engine="dem"), DRAW, 1.0)[0].world
    with pytest.raises(ValueError, match="table_pitch: not in the laboratory"):
        by_dem.simulate(soft, shaken(Table(pitch_displacement=0.01)), H, 2, 0.0)


def test_its_corners_give_along_the_floor_which_the_truth_says() -> None:
    lab, parameters = NAMED["compliant_base"](Lab(BLOCK, engine="dem"), DRAW, 1.0)
    assert lab.engine == "dem"
    assert lab.world.give == 1.0
    assert parameters["tangential_ratio"] == 1.0
    soft, parameters = NAMED["compliant_base"](Lab(BLOCK), DRAW, 1.0)
    assert parameters["tangential_ratio"] == pytest.approx(1.0 / soft.world.give)
    assert parameters["tangential_ratio"] != 1.0


def test_trials_take_the_effects_that_it_has(capsys) -> None:
    assert set(arguments(["--engine", "dem"]).effects) == {"compliant_base", "bouncing"}
    assert arguments(["--engine", "dem", "--quick"]).effects == ["compliant_base"]
    with pytest.raises(SystemExit):
        arguments(["--engine", "dem", "--effects", "null"])
    assert "--effects null: stiffness=0.0" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        arguments(["--engine", "dem", "--channel", "block_acceleration"])
    assert "--channel block_acceleration: want rotation of the engine dem" in capsys.readouterr().err


def test_a_campaign_asks_for_a_rotation_sensor(tmp_path) -> None:
    with pytest.raises(ValueError, match="channel='block_acceleration': want 'rotation' alone of the engine 'dem'"):
        make_campaign(1, ["compliant_base"], tmp_path, channel="block_acceleration", engine="dem")
