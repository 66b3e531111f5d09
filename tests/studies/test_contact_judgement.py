"""The study of contact judgement and that of convergence: small versions, and what decides their statements."""

from dataclasses import fields, replace

import numpy as np
import pytest
import xarray as xr

import dem
from studies import contact_judgement, dem_convergence
from studies.contact_judgement.runs import (
    DEFAULT,
    DROP_STEP,
    UNITS,
    VARIATIONS,
    Variation,
    column_run,
    drop,
    judgement_of,
    trembled,
)  # fmt: skip
from studies.contact_judgement.statements import CLAIMS, chance, check, shifts
from studies.criteria.columns import ColumnSettings
from studies.running.files import BadInputError
from studies.running.statements import DOES_NOT, HOLDS, UNDECIDED
from studies.running.study import make
from studies.specimens import specimen

SETTINGS = ColumnSettings(ramp=30.0 * 9.80665, damping=2e4)


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    folder = tmp_path_factory.mktemp("judgement")
    paths = make(contact_judgement.STUDY, ["--quick", "--out", str(folder)])
    with xr.open_dataset(folder / "contact_judgement.nc") as ds:
        yield paths, ds.load()


def test_the_small_version_writes_dataset_and_pictures(quick):
    paths, ds = quick
    assert [path.suffix for path in paths] == [".nc", ".png", ".pdf"]
    assert ds.amplitude.dims == ("variation", "frequency", "trial")
    assert all("long_name" in variable.attrs for variable in ds.variables.values())
    assert {str(key) for key in ds.statement_key.values} == set(CLAIMS)
    assert ds.attrs["choices"] and ds.attrs["commit"]


def test_listing_contacts_otherwise_changes_no_bit(quick):
    _, ds = quick
    row = ds.set_index(statement="statement_key").sel(statement="contact_judgement.lists")
    assert float(row.statement_number) == 0.0 and int(row.statement_holds) == HOLDS
    # Lists are made as often as the distance of updating asks for.
    lists = dict(zip(ds.variation.values, ds.lists.values, strict=True))
    assert lists["update_after: 0.001"] > 2.0 * float(ds.default_lists)


def test_every_parameter_of_judgement_is_varied():
    varied = {v.group for v in VARIATIONS}
    assert {field.name for field in fields(dem.ContactJudgement)} <= varied
    assert varied == set(UNITS)
    for variation in VARIATIONS:
        for name, value in variation.judgement:
            assert getattr(judgement_of(variation), name) == value != getattr(dem.ContactJudgement(), name)


@pytest.mark.parametrize("variation", VARIATIONS, ids=lambda v: f"{v.group} {v.label}")
def test_each_variation_differs_from_the_defaults_in_one_thing_alone(variation):
    changed = {
        field.name for field in fields(Variation) if getattr(variation, field.name) != getattr(DEFAULT, field.name)
    } - {"group", "label", "value", "step_share", "drop_step"}
    assert len(changed) <= 1
    assert changed or variation.drop_step != DROP_STEP


def test_a_reach_lifts_what_it_carries_and_is_taken_out_of_the_drop():
    reached = Variation("reach", "1 mm", 1e-3, (("reach", 1e-3),))
    near, far = drop(DEFAULT, SETTINGS), drop(reached, SETTINGS)
    assert near[0] == pytest.approx(far[0], abs=1e-12)
    assert near[-1] == pytest.approx(far[-1], abs=1e-4)  # both lie still in the end


def test_a_run_of_a_column_is_that_of_the_engine():
    found = column_run(DEFAULT, 3.0, 2, SETTINGS)
    motion = replace(SETTINGS, ramp=SETTINGS.ramp * (1.0 - 1e-3)).motion(3.0)
    block, contact = specimen(3), SETTINGS.contact
    scene = dem.column(2, block.b, block.h, block.d, block.density)
    run = dem.simulate_assembly(scene, motion, t_end=90.0, contact=contact, criteria=dem.Criteria(margin=1e3))
    assert found["amplitude"] == float(motion.envelope(run.overturning_time))
    assert found["lists"] > 0.0 and found["seconds"] > 0.0 and "overturned" in found["note"]


def test_trials_lie_on_both_sides_of_the_ramp():
    assert [round(trembled(trial), 12) for trial in range(5)] == [0.0, 0.001, -0.001, 0.002, -0.002]


def made_up(shift, variations=VARIATIONS, spread=0.1, seed=0):
    """A dataset in which each variation moves the criterion by what `shift` says of it."""
    random = np.random.default_rng(seed)
    trials, many = 6, 24
    amplitude = np.stack([np.exp(shift(v) + spread * random.standard_normal((2, trials))) for v in variations])
    default = np.exp(spread * random.standard_normal((2, many)))
    same = [i for i, v in enumerate(variations) if v.group in ("skin", "update_after", "facing")]
    amplitude[same] = default[:, :trials]
    ds = xr.Dataset(
        {
            "amplitude": (("variation", "frequency", "trial"), amplitude),
            "default_amplitude": (("frequency", "default_trial"), default),
            "difference": ("variation", np.ones(len(variations))),
            "default_difference": 1.0,
        },
        coords={
            "variation": [f"{v.group}: {v.label}" for v in variations],
            "group": ("variation", [v.group for v in variations]),
            "value": ("variation", [v.value for v in variations]),
        },
    )
    ds = ds.assign(shift=(("variation", "frequency"), shifts(ds)), chance=("frequency", chance(ds, trials)))
    return check(ds).set_index(statement="statement_key").statement_holds


def test_what_is_planted_is_found():
    holds = made_up(lambda v: 0.5 * (v.group == "reach") + 2.0 * (v.group == "damping"))
    assert int(holds.sel(statement="contact_judgement.reach")) == DOES_NOT
    assert int(holds.sel(statement="contact_judgement.material")) == HOLDS
    assert int(holds.sel(statement="contact_judgement.lists")) == HOLDS
    holds = made_up(lambda v: 2.0 * (v.group == "step") + 0.5 * (v.group == "damping"))
    assert int(holds.sel(statement="contact_judgement.step")) == DOES_NOT
    assert int(holds.sel(statement="contact_judgement.material")) == DOES_NOT


def test_chance_alone_is_seldom_taken_for_more():
    # Five values of one parameter: the largest of five means of two shifts, each beyond chance once in twenty.
    end_slack = tuple(v for v in VARIATIONS if v.group == "end_slack")
    found = [
        int(made_up(lambda v: 0.0, end_slack, seed=seed).sel(statement="contact_judgement.end_slack"))
        for seed in range(40)
    ]
    assert found.count(HOLDS) >= 24


def test_what_was_not_varied_is_not_decided():
    holds = made_up(lambda v: 0.0, tuple(v for v in VARIATIONS if v.group == "reach"))
    assert int(holds.sel(statement="contact_judgement.step")) == UNDECIDED


@pytest.mark.parametrize(("option", "value", "wanted"), [("--trials", "1", "at least 2"), ("--ramp", "0", "above 0")])
def test_bad_options_are_one_sentence(option, value, wanted, tmp_path):
    with pytest.raises(BadInputError, match=f"{option} {value}: want .*{wanted}"):
        make(contact_judgement.STUDY, [option, value, "--out", str(tmp_path)])


def test_distinct_elements_converge_to_nonlinear_method_1(tmp_path):
    make(dem_convergence.STUDY, ["--quick", "--out", str(tmp_path)])
    with xr.open_dataset(tmp_path / "dem_convergence.nc") as opened:
        ds = opened.load()
    assert (tmp_path / "dem_convergence.png").stat().st_size > 1000
    found = ds.set_index(statement="statement_key").statement_holds
    assert [int(found.sel(statement=key)) for key in dem_convergence.CLAIMS] == [HOLDS, HOLDS, HOLDS]
    over = ds.time_error.sel(ratio=3.0).values
    # The tilt under the weight is m g/(kn b): ten times the stiffness, a tenth of the error, where the step adds none.
    assert over[1] / over[0] == pytest.approx(0.1, rel=0.1)
