"""Campaigns of the virtual laboratory: what is handed over, what is kept back, and how the judge marks a run."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lsim

from studies.campaigns import Channel, Test, read
from studies.laboratory.campaign import make_campaign
from studies.laboratory.effects import NAMED, UNNAMED, Lab, Sensors, draw
from studies.laboratory.event import rubbing
from studies.laboratory.instruments import Bench, reading
from studies.laboratory.judge import check, coverage, judge, tracing
from studies.laboratory.outcomes import make_outcomes
from studies.laboratory.parameters import G, uniform
from studies.laboratory.plans import Plan, check_together, respond, used, worn
from studies.laboratory.prediction import errors, felt, predicted, rms
from studies.laboratory.table import Table, ramp
from studies.laboratory.truth import read_truth


@pytest.fixture(scope="module")
def damped(tmp_path_factory):
    folder = tmp_path_factory.mktemp("damped")
    return folder, make_campaign(5, ["viscous_damping"], folder, nuisances=["missing", "overturns"])


def test_a_campaign_is_read_without_a_word_and_tells_nothing(damped) -> None:
    folder, truth = damped
    campaign = read(folder / "campaign" / "campaign.toml")
    assert not campaign.warnings
    assert sorted(p.name for p in folder.iterdir()) == ["campaign", "predict", "truth"]
    assert {t.kind for t in campaign.tests} == {"free", "forced"}
    assert {math.copysign(1, t.initial_rotation) for t in campaign.tests if t.initial_rotation} == {-1.0, 1.0}
    assert any(np.isnan(t.rotation).any() for t in campaign.tests)
    assert any(np.nanmax(np.abs(t.rotation)) > 0.9 for t in campaign.tests)
    text = (folder / "campaign" / "campaign.toml").read_text() + (folder / "predict" / "campaign.toml").read_text()
    assert "viscous" not in text
    assert f"{truth.restitution}" not in text


def test_later_tests_have_no_response(damped) -> None:
    folder, truth = damped
    ahead = read(folder / "predict" / "campaign.toml")
    assert len(ahead.to_predict) == len(ahead.tests) == 4
    assert set(truth.hidden) == {t.id for t in ahead.tests}
    assert all(truth.hidden[t.id]["time"].size == t.time.size for t in ahead.tests)


def test_truth_is_read_back(damped) -> None:
    folder, truth = damped
    again = read_truth(folder / "truth")
    assert replace(again, hidden={}) == replace(truth, hidden={}, about=again.about)
    for id, columns in truth.hidden.items():
        assert again.hidden[id]["rotation"] == pytest.approx(columns["rotation"], rel=1e-6, abs=1e-9, nan_ok=True)


def test_the_same_seed_gives_the_same_bytes(damped, tmp_path) -> None:
    folder, _ = damped
    make_campaign(5, ["viscous_damping"], tmp_path, nuisances=["missing", "overturns"])
    for path in (folder / "campaign").iterdir():
        assert path.read_bytes() == (tmp_path / "campaign" / path.name).read_bytes()


def test_the_effect_is_seen_and_the_true_model_predicts(damped) -> None:
    _, truth = damped
    assert 2.0 < truth.baseline["fit"] / truth.floor["fit"] < 100.0
    assert truth.baseline["predict"] > 2.0 * truth.floor["predict"]
    assert truth.floor["fit"] < 4 * truth.noise


def test_impacts_may_lose_more_than_housners_do(tmp_path) -> None:
    plain, lossy = (
        make_campaign(3, [], tmp_path / name, nuisances=nuisances)
        for name, nuisances in (("plain", []), ("lossy", ["lossy"]))
    )
    block = read(tmp_path / "lossy" / "campaign" / "campaign.toml").block
    assert block == read(tmp_path / "plain" / "campaign" / "campaign.toml").block
    # Housner (1963) for a uniform rectangle.
    least = 1.0 - 1.5 * math.sin(math.atan(block.breadth / block.height)) ** 2
    assert 0.92 * least < lossy.restitution < least < plain.restitution
    with pytest.raises(ValueError, match="'lossy': want the engine 'event'"):
        make_campaign(3, [], tmp_path, nuisances=["lossy"], engine="mujoco")


def test_accelerometers_are_recorded_beside_the_rotation(tmp_path) -> None:
    """At rest they read gravity along their axes, as they are mounted: cos and sin of it to first order."""
    truth = make_campaign(2, [], tmp_path, nuisances=["accelerometers"])
    campaign = read(tmp_path / "campaign" / "campaign.toml")
    kinds = [c.kind for c in campaign.channels]
    assert kinds == ["rotation", *["block_acceleration"] * 3, "base_acceleration_x"] and truth.channel == "rotation"
    rest = next(t for t in campaign.tests if t.kind == "forced")
    for name, turned in truth.about["mounting"].items():
        axis = next(c for c in campaign.channels if c.name == name).axis
        read_at_rest = float(np.mean(rest.data[name][:50]))
        # 50 samples of 0.03 m/s^2, and the base begins to move: four standard deviations of the former, and 0.01.
        assert read_at_rest == pytest.approx(9.80665 * (axis[1] - turned * axis[0]), abs=0.027), name
    with pytest.raises(ValueError, match="'accelerometers': want 'rotation' alone of the engine 'mujoco'"):
        make_campaign(2, [], tmp_path / "other", nuisances=["accelerometers"], engine="mujoco")
    with pytest.raises(ValueError, match="'accelerometers': want channel='rotation'"):
        make_campaign(2, [], tmp_path / "other", nuisances=["accelerometers"], channel="block_acceleration")


def test_a_noisy_base_is_recorded_beside_a_quiet_rotation(tmp_path) -> None:
    """Four times the noise, as it is declared; the base itself moves as it did."""
    plain, noisy = (
        read(tmp_path / name / "campaign")
        for name, nuisances in (("plain", []), ("noisy", ["noisy_base"]))
        if make_campaign(3, [], tmp_path / name, nuisances=nuisances)
    )
    before, after = ({c.kind: c.noise for c in campaign.channels} for campaign in (plain, noisy))
    assert after == {"rotation": 5e-5, "base_acceleration_x": pytest.approx(4.0 * before["base_acceleration_x"])}
    shaken = [k for k, test in enumerate(plain.tests) if test.kind == "forced"]
    apart = np.concatenate([noisy.tests[k].data["base_x"] - plain.tests[k].data["base_x"] for k in shaken])
    assert apart.std() == pytest.approx(3.0 * before["base_acceleration_x"], rel=0.05)


def test_a_clean_campaign_is_explained_by_the_ideal_block(tmp_path) -> None:
    """The baseline has a restitution to fit; its error is noise of the sensor, and what noise of the base does."""
    truth = make_campaign(3, [], tmp_path)
    assert truth.verdicts == ("none",)
    assert truth.baseline["fit"] == pytest.approx(truth.floor["fit"], rel=0.05)
    assert truth.baseline["restitution"] == pytest.approx(truth.restitution, abs=5e-4)


def test_accelerometers_at_rest_read_gravity_through_their_mounting(tmp_path) -> None:
    truth = make_campaign(4, [], tmp_path, channel="block_acceleration")
    campaign = read(tmp_path / "campaign" / "campaign.toml")
    test = next(t for t in campaign.tests if t.kind == "forced")
    assert test.rotation is None
    quiet = test.time < 0.28
    for name, along, across in (("acc_left", 1.0, 0.0), ("acc_top", 0.0, -1.0)):
        # A sensor turned clockwise by a small angle sees -g sin of it along x.
        turned = truth.about["mounting"][name]
        expected = G * (along * math.cos(turned) + across * math.sin(turned))
        n = int(quiet.sum())
        assert test.data[name][quiet].mean() == pytest.approx(expected, abs=4 * 0.03 / math.sqrt(n))


def test_outcomes(tmp_path) -> None:
    truth = make_outcomes(2, ["concave_base"], tmp_path, motions=3)
    campaign = read(tmp_path / "campaign" / "campaign.toml")
    assert campaign.holds_outcomes_alone
    assert len(campaign.tests) == 18
    assert len({t.motion for t in campaign.tests}) == 3
    fallen = [t.overturned for t in campaign.tests]
    assert any(fallen)
    assert not all(fallen)
    assert len(truth.overturned) == len(read(tmp_path / "predict" / "campaign.toml").to_predict)


LAB = Lab(uniform(0.2, 0.6, 60.0, 0.92))


@pytest.mark.parametrize("name", [*NAMED, *UNNAMED])
def test_every_effect_moves_what_is_recorded(name: str) -> None:
    """In a release or a ramp, and (but for those of the base alone) the more the stronger it is."""
    d = draw(np.random.default_rng(7))
    motion = ramp(np.random.default_rng(1), 3.0, 6.0)
    plans = [
        Plan("a", "free", 250.0, 500, 0.16, 0.16, None, 8),
        Plan("b", "forced", 250.0, 1700, motion=motion, order=9),
    ]
    moved = 0.0
    lab, _ = (NAMED | UNNAMED)[name](LAB, d, 3.0)
    for plan in plans:
        ideal, other = respond(LAB, plan), respond(lab, plan)
        shown = worn(lab, plan.order).sensors.reads(other.rotation)
        moved = max(moved, float(np.nanmax(np.abs(shown - ideal.rotation))))
    if name in ("base_motion_gain", "base_motion_lag", "coupled_sensor"):
        assert lab.sensors != LAB.sensors
    else:
        assert moved > 5e-4


# Recorded over true is SciPy's high-pass, late and of a gain; the true laboratory makes of its record what there was.
@pytest.mark.parametrize("corner", [0.1, 0.5])
def test_a_coupled_sensor_records_what_a_high_pass_leaves_and_its_model_knows_the_rest(corner: float) -> None:
    motion = ramp(np.random.default_rng(1), 3.0, 6.0)
    plan = Plan("b", "forced", 250.0, 1500, motion=motion, order=4)
    sensor = Channel("base", "base_acceleration_x", 1e-3)
    bench = Bench((sensor,), {})
    lab = replace(LAB, sensors=Sensors(base_gain=1.02, base_lag=0.004, base_corner=corner))

    def recorded(lab: Lab) -> np.ndarray:
        read = reading(lab, plan, None, sensor, bench)  # type: ignore[arg-type]
        assert read is not None
        return read

    t = np.arange(plan.samples) / plan.rate
    late = recorded(replace(LAB, sensors=Sensors(base_lag=0.004)))
    _, passed, _ = lsim(([1.0, 0.0], [1.0, 2.0 * math.pi * corner]), late, t)
    most = np.max(np.abs(late))
    # A mean of both ends for the straight line between them: (w step)^2 / 12 of the motion, and of what it was before.
    near = (2.0 * math.pi * corner / plan.rate) ** 2 / 12.0
    np.testing.assert_allclose(1.02 * recorded(lab), passed, rtol=0.0, atol=2.0 * near * most)

    def seen(lab: Lab) -> np.ndarray:
        data = {"base": recorded(lab)}
        return felt(lab, Test("b", "forced", t, (sensor,), data))[:, 0, 0]

    # A 250th of a second of 3 Hz: (W step)^2 / 12 is 5e-4 of what is lost, a share of corner / 3 Hz of the motion.
    there = slice(0, -4)  # a record that is late has not heard of its end
    np.testing.assert_allclose(seen(lab)[there], seen(LAB)[there], rtol=0.0, atol=1e-3 * corner * most)


# Beside a block that slides, or stands on springs, an effect moves what is recorded too, or is refused.  What adheres
# does nothing where friction gives way before it.
@pytest.mark.parametrize("engine", ["sliding", "compliant_base"])
@pytest.mark.parametrize("name", [*NAMED, *UNNAMED])
def test_beside_another_engine_an_effect_is_there_or_refused(engine: str, name: str) -> None:
    try:
        check_together([engine, name])
    except ValueError:
        return
    if (engine, name) == ("sliding", "base_adhesion"):
        return
    d = draw(np.random.default_rng(7))
    one, _ = NAMED[engine](LAB, d, 1.0)
    both, _ = (NAMED | UNNAMED)[name](one, d, 3.0)
    assert both.engine == one.engine
    if worn(both, 9).sensors != one.sensors or both.wear != one.wear:
        return  # seen by the sensor alone, or from test to test
    moved = 0.0
    for plan in (
        Plan("a", "free", 250.0, 300, 0.26, 0.26, None, 8),
        Plan("b", "forced", 250.0, 700, motion=ramp(np.random.default_rng(1), 8.0, 16.0), order=9),
    ):
        moved = max(moved, float(np.nanmax(np.abs(respond(both, plan).rotation - respond(one, plan).rotation))))
    assert moved > 5e-4


def test_what_is_refused_is_what_an_engine_lacks() -> None:
    refused: dict[str, list[str]] = {"sliding": [], "compliant_base": []}
    for engine, names in refused.items():
        for name in {**NAMED, **UNNAMED}:
            try:
                check_together([engine, name])
            except ValueError:
                names.append(name)
    others = ["compliant_base", "winkler_bed", "sliding", "bouncing"]
    rubbing = ["hinge_friction", "one_sided_friction", "one_sided_cable"]
    assert sorted(refused["sliding"]) == sorted(
        [*others, "grinding", "heedful_impacts", *rubbing, "hysteretic_layer", "slosh"]
    )
    at_impacts = [
        "heedful_impacts",
        "velocity_dependent_restitution",
        "restitution_by_side",
        "leaking_restitution",
        "bedding_in",
    ]
    lacking = ["rounded_edges", "base_adhesion", "grinding", *rubbing, "hysteretic_layer", "slosh"]
    assert sorted(refused["compliant_base"]) == sorted([*others, *at_impacts, *lacking])


def test_wear_counts_tests() -> None:
    lab, _ = UNNAMED["wear"](LAB, draw(np.random.default_rng(1)), 1.0)
    assert worn(lab, 5).world.restitution == pytest.approx(0.92 - 5 * lab.wear)


@pytest.mark.parametrize(
    ("name", "of", "field"),
    [
        ("crumbling_edges", "world", "half_breadth"),
        ("settling_floor", "world", "tilt"),
        ("warming_sensor", "sensors", "rotation_gain"),
    ],
)
def test_what_changes_from_test_to_test_does_so_ever_less_or_evenly(name: str, of: str, field: str) -> None:
    lab, _ = UNNAMED[name](LAB, draw(np.random.default_rng(3)), 1.0)
    values = np.array([getattr(getattr(worn(lab, k), of), field) for k in range(6)])
    assert values[0] == getattr(getattr(LAB, of), field)
    shares = np.diff(values)[1:] / np.diff(values)[:-1]
    np.testing.assert_allclose(shares, math.exp(-lab.courses[0].fading), rtol=1e-9)
    assert (shares[0] == pytest.approx(1.0)) == (name == "settling_floor")


def test_a_load_shifts_once() -> None:
    lab, _ = UNNAMED["shifted_load"](LAB, draw(np.random.default_rng(3)), 1.0)
    offsets = [worn(lab, k).world.offset for k in range(12)]
    first = lab.courses[0].before
    assert 3 <= first <= 6
    assert offsets == [0.0] * first + [lab.courses[0].change] * (12 - first)


def test_grinding_sums_the_squares_of_impact_speeds_from_test_to_test() -> None:
    """In the second test the first impact keeps what is left after the sum of the first one, by the formula."""
    ground = replace(LAB, world=replace(LAB.world, grind=0.05, grind_use=1.0))
    plans = [Plan(f"free-{k}", "free", 250.0, 700, 0.2, 0.2, None, k) for k in range(3)]
    lab = used(ground, plans)
    assert lab.uses[0] == 0.0
    for k in (0, 1):
        hits = respond(lab, plans[k]).impacts
        before = lab.uses[k] + np.concatenate([[0.0], np.cumsum(hits[:, 1] ** 2)])
        assert hits.shape[0] > 5
        kept = 0.92 - 0.05 * (1.0 - np.exp(-before[:-1]))
        np.testing.assert_allclose(np.abs(hits[:, 2] / hits[:, 1]), kept, rtol=1e-12)
        assert lab.uses[k + 1] == pytest.approx(before[-1], rel=1e-12)
    assert lab.uses[2] > lab.uses[1] > 0.1
    # A test that is added begins with all of it.
    last = respond(lab, plans[2]).impacts
    assert worn(lab, 3).world.used == pytest.approx(lab.uses[2] + float(np.sum(last[:, 1] ** 2)), rel=1e-12)
    assert used(LAB, plans) is LAB


def test_a_gust_tips_a_block_at_rest_where_it_passes_g_tan_alpha_and_no_base_sensor_shows_it() -> None:
    """A bell of 2 g tan alpha passes the threshold sqrt(2 ln 2) of its widths before its middle."""
    middle, width = 1.0, 0.2
    for sign in (1.0, -1.0):
        size = sign * 2.0 * LAB.world.gravity * math.tan(LAB.world.alpha)
        lab = replace(LAB, table=replace(LAB.table, gusts=((middle, size, width),)))
        moving = ramp(np.random.default_rng(1), 3.0, 1e-6)
        for plan in (
            Plan("free", "free", 500.0, 600, 0.0, 0.0, None, 0),
            Plan("forced", "forced", 500.0, 600, motion=moving, order=1),
        ):
            rotation = respond(lab, plan).rotation
            lifts = np.flatnonzero(rotation != 0.0)[0] / plan.rate
            assert lifts == pytest.approx(middle - width * math.sqrt(2.0 * math.log(2.0)), abs=2.0 / plan.rate)
            assert sign * rotation[450] > 0.0
            base = Channel("base_x", "base_acceleration_x", 0.0)
            read = reading(lab, plan, respond(lab, plan), base, Bench((base,), {}))
            assert read is None if plan.motion is None else np.abs(read).max() <= 1e-6


def test_an_accelerometer_on_a_block_that_stands_in_the_wind_reads_nothing() -> None:
    lab = replace(
        LAB, table=replace(LAB.table, gusts=((1.0, 0.3 * LAB.world.gravity * math.tan(LAB.world.alpha), 0.2),))
    )
    plan = Plan("free", "free", 500.0, 600, 0.0, 0.0, None, 0)
    sensor = Channel("acc", "block_acceleration", 0.0, (0.0, 0.5), (1.0, 0.0))
    read = reading(lab, plan, respond(lab, plan), sensor, Bench((sensor,), {"acc": 0.0}))
    assert read is not None
    np.testing.assert_allclose(read, 0.0, rtol=0.0, atol=1e-12)


def test_impacts_that_heed_the_base_lose_by_its_acceleration_there() -> None:
    """The record of the base at the times of the impacts, along the way in which the block falls."""
    heedful = replace(LAB, world=replace(LAB.world, heed=0.01))
    plan = Plan("b", "forced", 250.0, 700, motion=ramp(np.random.default_rng(1), 8.0, 16.0), order=4)
    hits = respond(heedful, plan).impacts
    assert hits.shape[0] > 5
    along = np.sign(hits[:, 1]) * plan.motion.derivative(2, hits[:, 0])
    np.testing.assert_allclose(hits[:, 2] / hits[:, 1], 0.92 - 0.01 * along, rtol=0.0, atol=1e-6)
    assert np.ptp(along) > 5.0


def test_a_loose_linkage_stays_behind_by_its_play() -> None:
    sensors = replace(LAB.sensors, rotation_play=0.01, rotation_gain=2.0)
    read = sensors.reads(np.array([0.0, 0.005, 0.03, 0.015, np.nan, 0.0, -0.02]))
    np.testing.assert_allclose(read, [0.0, 0.0, 0.04, 0.04, np.nan, 0.02, -0.02], atol=1e-15)


def test_a_plate_on_springs_answers_as_an_oscillator() -> None:
    """From rest, by a Runge-Kutta method of SciPy's; the sensor of the base is below it."""
    h, w = 0.002, 2.0 * math.pi * 12.0
    plate = Table(plate_frequency=12.0, plate_damping=0.1)
    t = h * np.arange(1501)
    ax = ramp(np.random.default_rng(1), 5.0, 6.0).derivative(2, t)
    there = solve_ivp(
        lambda s, y: (y[1], -(w**2) * y[0] - 0.2 * w * y[1] - np.interp(s, t, ax)), (0.0, t[-1]), (0.0, 0.0), t_eval=t,
        rtol=1e-8, atol=1e-12, max_step=h,
    ).y  # fmt: skip
    expected = -(w**2) * there[0] - 0.2 * w * there[1]
    # Straight lines between nodes take (2 pi 5 h)^2 / 12 of what is not there, 3e-4 of 6 m/s^2 and the plate's gain.
    np.testing.assert_allclose(plate.on_top(ax, h), expected, rtol=0.0, atol=5e-3)
    assert np.max(np.abs(expected - ax)) > 1.0
    plan = Plan("b", "forced", 250.0, 400, motion=ramp(np.random.default_rng(1), 5.0, 6.0))
    bench, channel = Bench((), {}), Channel("base_x", "base_acceleration_x")
    on_plate, plain = (
        reading(lab, plan, respond(lab, plan), channel, bench) for lab in (replace(LAB, table=plate), LAB)
    )
    np.testing.assert_array_equal(on_plate, plain)


def test_a_cable_on_one_side_rubs_beyond_its_lean_alone() -> None:
    world = replace(LAB.world, guide=0.5, guide_from=0.1)
    assert [rubbing(s, phi, world.vector()) for s, phi in ((1, 0.05), (1, 0.1), (-1, 0.2))] == [0.0, 0.5, 0.0]


def test_error_of_a_test() -> None:
    measured = np.array([0.0, 0.1, np.nan, 0.1, 1.1, 0.0])
    # Missing samples and those after overturning are left out.
    assert rms(np.array([0.0, 0.2, 0.5, 0.1, 0.3, 0.4]), measured) == pytest.approx(math.sqrt(0.01 / 3))
    # A prediction that falls when the block did not counts as pi / 2 from then on.
    assert rms(np.array([0.0, np.nan]), np.zeros(2)) == pytest.approx(math.pi / 2 / math.sqrt(2))


def finding(**changes):
    two = {"fit": 1e-3, "holdout": 1e-3}
    whole = {
        "verdict": "effect", "effects": ["viscous_damping"], "indistinguishable": [], "candidates": [],
        "next_test": "", "error": {"declared": two, "before": two, "after": two}, "parameters": {},
    }  # fmt: skip
    return whole | changes


def written(folder, truth, found, scale):
    """A run that predicts the truth, and a baseline that is off by `scale`."""
    loop = folder / "loop"
    for name, off in (("predict", 1e-5), ("predict-baseline", scale)):
        (loop / name).mkdir(parents=True)
        for id, columns in truth.hidden.items():
            values = np.stack([columns["time"], columns["rotation"] + off], axis=1)
            np.savetxt(loop / name / f"{id}.csv", values, delimiter=",", header="time,rotation", comments="")
    (loop / "loop.json").write_text(json.dumps(found))
    return loop


def test_a_perfect_run_is_marked_so(damped, tmp_path) -> None:
    _, truth = damped
    c = truth.parameters["viscous_damping.coefficient"]
    given = {"viscous_damping.coefficient": {"value": 1.01 * c, "low": 0.95 * c, "high": 1.05 * c, "level": 0.95}}
    marks = judge(written(tmp_path, truth, finding(parameters=given), 1e-3), truth)
    assert marks["verdict_right"]
    assert marks["traced"] == "exact"
    assert marks["halved"]
    assert (marks["covered"], marks["parameters"]) == (1, 1)
    assert marks["after"] == pytest.approx(1e-5, rel=1e-3)
    assert marks["before"] == pytest.approx(1e-3, rel=1e-3)
    assert marks["claimed_over_true"] == pytest.approx(1e-3 / math.hypot(1e-5, truth.noise), rel=1e-3)


def test_tracing(damped) -> None:
    _, truth = damped
    twin = replace(truth, effects=("base_tilt",), accepted=(("base_tilt",), ("eccentric_mass",)))
    pair = replace(truth, effects=("base_tilt", "tether"), accepted=(("base_tilt", "tether"),))
    assert tracing(["eccentric_mass"], [], twin) == "twin"
    assert tracing(["quadratic_drag"], [["viscous_damping", "quadratic_drag"]], truth) == "set"
    assert tracing(["quadratic_drag"], [[*NAMED]], truth) == "no"
    assert tracing(["quadratic_drag"], [], truth) == "no"
    assert tracing(["tether"], [], pair) == "part"
    assert tracing(["tether", "base_tilt"], [], pair) == "exact"


def test_gains_are_marked_by_their_departure_from_one(damped) -> None:
    truth = replace(damped[1], parameters={"base_motion_gain.gain": 1.02})
    found = coverage({"base_motion_gain.gain": {"value": 1.03, "low": 1.025, "high": 1.035}}, truth)
    assert found["base_motion_gain.gain"]["error"] == pytest.approx(0.5)
    assert not found["base_motion_gain.gain"]["covered"]


@pytest.mark.parametrize(
    "changes", [{"verdict": "perhaps"}, {"verdict": "none"}, {"error": {}}, {"effects": []},
                {"parameters": {"a.b": {"value": 2.0, "low": 0.0, "high": 1.0}}}]
)  # fmt: skip
def test_a_malformed_finding_is_an_error(changes) -> None:
    with pytest.raises(ValueError, match=r"loop\.json"):
        check(finding(**changes))


def test_the_true_model_scores_the_floor(damped) -> None:
    """The floor is made of the recorded base and fitted leans: what anyone with the right model can reach."""
    folder, truth = damped
    campaign = read(folder / "campaign" / "campaign.toml")
    b = campaign.block
    world = replace(
        uniform(b.breadth, b.height, b.mass, truth.restitution),
        viscous=truth.parameters["viscous_damping.coefficient"],
    )
    assert float(np.median(errors(Lab(world), campaign.tests))) == pytest.approx(truth.floor["fit"], rel=0.05)
    ahead = read(folder / "predict" / "campaign.toml").tests
    scores = [rms(predicted(Lab(world), t, t.initial_rotation or 0.0), truth.hidden[t.id]["rotation"]) for t in ahead]
    assert float(np.median(scores)) == pytest.approx(truth.floor["predict"], rel=1e-3)
