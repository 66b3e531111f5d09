"""loop.nc: what is in it, and the residuals against motions whose equation is known without the solver."""

import dataclasses
import math
from types import SimpleNamespace

import found
import numpy as np
import pytest
import xarray as xr

from rocking import G_STANDARD
from rocking.remembering import LONG_AGO
from studies.campaigns import Channel, DeclaredBlock, Test
from studies.loop.dataset import _answers, dataset, group_names, save
from studies.loop.models.model import LoopModel
from studies.loop.observed.residual_impacts import Impacts, modelled_restitution, onset
from studies.loop.observed.residual_torque import path, residual_torque, stretches
from studies.loop.observed.spread import variances
from studies.loop.observed.windows import record_of
from studies.loop.runs.simulation import Simulator, Struck

NOISE = 1e-5


@pytest.fixture(scope="module")
def tilted():
    return found.tilted()


@pytest.fixture(scope="module")
def saved(tilted, tmp_path_factory):
    """The tree of a finding as it is read from its file."""
    path = tmp_path_factory.mktemp("saved") / "loop.nc"
    save(dataset(tilted), path)
    assert [p.name for p in path.parent.iterdir()] == ["loop.nc"]  # nothing of the writing is left
    with xr.open_datatree(path) as tree:
        yield tree.load()


def test_every_number_has_units_and_a_name(saved):
    for node in saved.subtree:
        for name, values in {**node.data_vars, **node.coords}.items():
            if values.dtype.kind in "fi" and name not in ("round",):
                assert values.attrs["units"], name
                assert values.attrs["long_name"], name


def test_provenance(saved):
    assert {"source", "commit", "command", "title", "Conventions"} <= set(saved.attrs)
    assert saved.attrs["verdict"] == "effect"


def test_each_test_is_there_with_what_it_was_used_for(saved, tilted):
    campaign = tilted.setup.campaign
    groups = {ds.attrs["id"]: ds for ds in saved["tests"].children.values()}
    assert list(groups) == [test.id for test in campaign.tests]
    held = {campaign.tests[k].id for k in tilted.setup.held}
    for id, ds in groups.items():
        expected = "not used" if id == "to predict" else "held out" if id in held else "fitted"
        assert ds.attrs["role"] == expected
        assert ds.attrs["kind"] == campaign.test(id).kind


def test_measured_less_modelled_is_the_residual_and_its_rms_the_error(saved, tilted):
    for ds in saved["tests"].children.values():
        if "rotation_before" not in ds:
            continue
        for stage in ("before", "after"):
            residual = ds[f"rotation_residual_{stage}"]
            assert np.allclose(residual, ds.rotation - ds[f"rotation_{stage}"], equal_nan=True)
            rms = math.sqrt(float(np.nanmean(residual**2)))
            # `studies.loop.closing.errors` computes the error from the windows, which hold the finite samples alone.
            assert rms == pytest.approx(tilted.errors[stage].by_test[ds.attrs["id"]], rel=1e-9)
            assert rms == pytest.approx(float(ds[f"error_{stage}"]), rel=1e-12)


def test_residual_torque_shows_the_tilt_before_and_noise_after(saved):
    before, after, side = [], [], []
    for ds in saved["tests"].children.values():
        if "torque_residual_before" in ds:
            before.append(ds.torque_residual_before / ds.torque_residual_sd_before)
            after.append(ds.torque_residual_after / ds.torque_residual_sd_after)
            side.append(ds.stretch_side)
    z, left = np.concatenate(before), np.concatenate(after)
    # A floor that falls by beta toward +x adds p^2 sin(beta) to theta'' (eq. (2), a_x = -g sin(beta)), on either side.
    assert np.mean(z[np.concatenate(side) > 0]) > 1.0
    assert np.mean(z[np.concatenate(side) < 0]) > 1.0
    assert 0.8 < math.sqrt(float(np.mean(left**2))) < 1.25  # about 100 stretches: one within 0.07


def test_candidates_by_round(saved):
    table = saved["candidates"].to_dataset()
    assert table.evidence.dims == ("round", "form")
    first = table.sel(round=1).evidence
    assert float(first.sel(form="base_tilt")) > 60.0
    assert first.idxmax("form") == "base_tilt"


def test_parameters(saved, tilted):
    row = saved["parameters"].to_dataset().sel(parameter="base_tilt.angle")
    assert (float(row.value), float(row.low), float(row.high)) == tilted.intervals["base_tilt.angle"]
    assert str(row.unit.values) == "rad"


def test_names_of_groups():
    names = group_names(["a", "_<b>", "<b>", "é", "é", "é"])
    assert names == ["a", "_<b>", "_<b>_", "_é", "_é_", "_é__"]


# A swing made by hand: theta = 0.1 (1 - u^2) + 0.01 (1 - u^2)^2 with u = (t - 0.4) / 0.4.
DECLARED = DeclaredBlock(0.15, 0.5, 0.25, 11.25)
T = 0.001 * np.arange(801)
U = (T - 0.4) / 0.4
THETA = 0.1 * (1.0 - U**2) + 0.01 * (1.0 - U**2) ** 2
THETA_DD = (-0.2 + 0.01 * (12.0 * U**2 - 4.0)) / 0.4**2


def _by_hand(a_x):
    data = {"rotation": THETA, "base": np.full(T.size, a_x)}
    channels = (Channel("rotation", "rotation", NOISE), Channel("base", "base_acceleration_x"))
    test = Test("by hand", "forced", T, channels, data)
    return Simulator([test]), record_of(test, 0, NOISE, DECLARED.alpha), test


@pytest.mark.parametrize("a_x", [0.0, 0.8])
def test_residual_torque_is_what_the_equation_of_motion_leaves(a_x):
    simulator, record, test = _by_hand(a_x)
    parts = stretches(record)
    found = residual_torque(LoopModel(DECLARED, 0.9, g=G_STANDARD), simulator, record, parts)
    # Eq. (2) of the paper, on the +x corner: theta'' = -p^2 [ sin(alpha - theta) + (a_x / g) cos(alpha - theta) ].
    p2 = DECLARED.mass * G_STANDARD * DECLARED.R / DECLARED.I_O
    lean = DECLARED.alpha - THETA
    left = THETA_DD + p2 * (np.sin(lean) + a_x / G_STANDARD * np.cos(lean))
    assert len(parts) == 4
    for (part, side), value in zip(parts, found.value, strict=True):
        # The second derivative of a parabola fitted to f over |u| < 1 is the mean of f'' with weight (1 - u^2)^2.
        u = np.linspace(-1.0, 1.0, part.size)
        weight = (1.0 - u**2) ** 2
        assert side == 1
        assert value == pytest.approx(np.sum(weight * left[part]) / np.sum(weight), abs=2e-4 * abs(left[part]).max())
    seen = path(record, test.base_x, parts)
    assert seen.base_x == pytest.approx(a_x)
    assert np.all(np.diff(seen.omega) < 0.0)


def test_deviation_of_the_residual_torque():
    simulator, record, _ = _by_hand(0.0)
    model, parts, rng = LoopModel(DECLARED, 0.9, g=G_STANDARD), stretches(record), np.random.default_rng(5)
    exact = residual_torque(model, simulator, record, parts)
    draws = []
    for _ in range(60):
        noisy = object.__new__(type(record))
        noisy.__dict__.update(record.__dict__, rotation=THETA + NOISE * rng.standard_normal(T.size))
        draws.append((residual_torque(model, simulator, noisy, parts).value - exact.value) / exact.sd)
    assert np.std(draws) == pytest.approx(1.0, abs=0.15)  # 240 values: one within 0.05


def test_torque_of_a_sensor_that_reads_too_much_is_that_of_the_true_motion():
    simulator, record, _ = _by_hand(0.0)
    parts = stretches(record)
    plain = residual_torque(LoopModel(DECLARED, 0.9, g=G_STANDARD), simulator, record, parts)
    effects = {"rotation_gain": {"gain": 1.1}, "rotation_offset": {"offset": 0.002}}
    read = object.__new__(type(record))
    model = LoopModel(DECLARED, 0.9, effects, G_STANDARD)
    read.__dict__.update(record.__dict__, rotation=np.asarray(model.reading(THETA)))
    assert residual_torque(model, simulator, read, parts).value == pytest.approx(plain.value, rel=1e-6)


def test_models_with_further_freedoms_have_no_residual_torque():
    simulator, record, _ = _by_hand(0.0)
    soft = LoopModel(DECLARED, 0.9, {"compliant_base": {"corner_stiffness": 1e6, "damping_ratio": 0.1}})
    assert np.isnan(residual_torque(soft, simulator, record, stretches(record)).value).all()


def test_restitution_of_the_model_at_a_measured_impact():
    simulator, _, _ = _by_hand(0.0)
    before = np.array([0.0, 1.0]), np.array([LONG_AGO, 0.4])  # how many of the test, how long ago
    before += np.array([3.0, 4.0]), np.array([2.0, 2.5])  # how many of all, and the squares of their speeds
    seen = Impacts(np.array([0.2, 0.6]), np.array([1, -1]), np.array([-0.5, 0.4]), np.zeros(2), np.ones(2), *before)
    slope = {"velocity_dependent_restitution": {"slope": 0.1}}
    plain = modelled_restitution(LoopModel(DECLARED, 0.9), simulator, 0, seen)
    sloping = modelled_restitution(LoopModel(DECLARED, 0.9, slope), simulator, 0, seen)
    assert plain == pytest.approx([0.9, 0.9])
    assert sloping - plain == pytest.approx([0.05, 0.04])  # slope times the speed
    memory = {"learned_memory": {"first": -0.03, "first_impacts": 2.0, "recent": -0.02, "recent_time": 0.2}}
    remembering = modelled_restitution(LoopModel(DECLARED, 0.9, memory), simulator, 0, seen)
    assert remembering - plain == pytest.approx([-0.03, -0.03 * math.exp(-0.5) - 0.02 * math.exp(-2.0)])
    for exponent, use in ((0.0, before[2]), (2.0, before[3])):
        wears = {"learned_memory": {"worn": -0.04, "worn_use": 3.0, "worn_exponent": exponent}}
        worn = modelled_restitution(LoopModel(DECLARED, 0.9, wears), simulator, 0, seen)
        assert worn - plain == pytest.approx(-0.04 * (1.0 - np.exp(-use / 3.0)))


def test_a_block_that_remembers_impacts_has_the_residual_torque_of_one_that_does_not():
    simulator, record, _ = _by_hand(0.0)
    parts = stretches(record)
    plain = residual_torque(LoopModel(DECLARED, 0.9), simulator, record, parts)
    memory = residual_torque(LoopModel(DECLARED, 0.9, {"learned_memory": {"first": -0.03}}), simulator, record, parts)
    np.testing.assert_allclose(memory.value, plain.value, rtol=0.0, atol=1e-9)
    assert np.isfinite(plain.value).any()


def test_onset_is_the_passage_of_a_level():
    t = np.linspace(0.0, 1.0, 11)
    assert onset(t, np.where(t > 0.5, -(t - 0.5), np.nan) + 0.01, 0.25, zero=0.01) == pytest.approx(0.75)
    assert math.isnan(onset(t, 0.1 * t, 0.25))


# What struck the block in the tests before wears it: errors are of runs that know of it, and so are the histories.
def test_runs_that_are_shown_and_redrawn_know_what_struck_the_block_before(tilted):
    class Captured(Exception):  # noqa: N818
        pass

    class Simulator:
        tests = ("noisy",)

        def run(self, models, jobs):
            raise Captured(jobs)

    struck = Struck(0, 9.0, 12, 30.0)
    setup = dataclasses.replace(tilted.setup, recorded=Simulator(), whole_held=())
    windows = [dataclasses.replace(w, struck=struck) for w in tilted.after_fit.windows]
    fit = dataclasses.replace(tilted.after_fit, windows=windows)
    shown = SimpleNamespace(setup=setup, before_fit=fit, after_fit=fit, before=tilted.before, after=tilted.after)
    with pytest.raises(Captured) as captured:
        _answers(shown)
    assert {job.struck for job in captured.value.args[0]} == {struck}
    with pytest.raises(Captured) as captured:
        variances(Simulator(), 1, tilted.after, windows)
    assert {job.struck for job in captured.value.args[0]} == {struck}
