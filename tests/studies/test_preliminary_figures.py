"""Figs 5 and 10 to 12: made by their commands in the small version, and what their numbers must be."""

import importlib
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

import dem
from rocking import Block, Method1, solve
from studies import fig12
from studies.claims.preliminary_bounds import CLAIMS
from studies.criteria.free_vibration import fit_dashpot
from studies.criteria.overturning import STIFFNESS
from studies.families import numerical_stability
from studies.fig05 import fit as fig05_fit
from studies.fig05.fit import Released, fitted, misfit
from studies.running.statements import DOES_NOT, HOLDS
from studies.running.study import make
from studies.specimens import specimen

FIGURES = ("fig05", "fig10", "fig11", "fig12")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("preliminary")
    found = {}
    for name in FIGURES:
        paths = make(importlib.import_module(f"studies.{name}").STUDY, ["--quick", "--out", str(folder)])
        with xr.open_dataset(folder / f"{name}.nc") as ds:
            found[name] = (paths, ds.load())
    return found


@pytest.mark.parametrize("name", FIGURES)
def test_the_small_version_writes_dataset_and_pictures(made, name):
    paths, ds = made[name]
    assert [path.name for path in paths] == [f"{name}.nc", f"{name}.png", f"{name}.pdf"]
    assert all(path.stat().st_size > 1000 for path in paths)
    assert all("long_name" in variable.attrs for variable in ds.variables.values())
    numeric = [v for n, v in ds.data_vars.items() if v.dtype.kind == "f" and not str(n).startswith("statement")]
    assert numeric and all("units" in v.attrs for v in numeric)
    assert all(ds.attrs[key] for key in ("commit", "source", "command", "settings", "choices"))
    assert {str(key).partition(".")[0] for key in ds.statement_key.values} == {name}


def test_fig_5_says_which_method_1_stands_for_the_experiment(made):
    """Against the equations themselves: from 0.6 of the balance the linear ones (eqs (2), (3)) swing otherwise."""
    _, ds = made["fig05"]
    assert "restitution of Method 1, which is nonlinear" in ds.attrs["choices"]
    e, block = float(ds.restitution[0]), specimen(1)
    found = {}
    for form in ("linear", "nonlinear"):
        run = solve(
            Method1(block, restitution=e, form=form), theta=0.6 * block.alpha, t_end=7.0, save_at=ds.time.values,
            solver="scipy",
        )  # fmt: skip
        away = 0.5 * block.b * (1.0 - np.cos(run.theta)) + block.h * np.sin(np.abs(run.theta))
        found[form] = np.abs(np.copysign(away, run.theta) - ds.method1_top.values[0]).max()
    assert found["nonlinear"] < 1e-6 < 1e-3 < found["linear"]


def test_every_statement_is_decided_somewhere(made):
    keys = {str(key) for _, ds in made.values() for key in ds.statement_key.values}
    assert keys == set(CLAIMS)


def test_eq_8_is_that_of_the_histories_in_the_dataset(made):
    _, ds = made["fig12"]
    expected = ((ds.height - ds.pivot_height) ** 2).sum("time")
    assert ds.difference.isel(trial=0).values == pytest.approx(expected.values)
    exact = ((ds.height - ds.exact_height) ** 2).sum("time")
    assert ds.difference_exact.isel(trial=0).values == pytest.approx(exact.values)


def test_the_paper_s_step_and_eq_7_are_in_the_dataset(made):
    _, ds = made["fig12"]
    # 2 sqrt(1.4/1.98e7) = 5.3e-4 s; the paper says around 5e-4 s.
    assert ds.attrs["eq7_step"] == pytest.approx(5.3e-4, rel=0.01)
    assert 2.0e-6 in ds.step.values and ds.of_nine.values.sum() == 9
    # Block 4 on its two corners, and columns of it (mechanics of the time step).
    assert ds.attrs["critical_step"] == pytest.approx(1.9e-4, rel=0.01)
    assert list(ds.attrs["critical_steps_of_columns"]) == sorted(ds.attrs["critical_steps_of_columns"], reverse=True)


def test_every_step_divides_the_sampling_interval():
    for step in (numerical_stability.PIVOT, *numerical_stability.NINE, *numerical_stability.MORE):
        assert numerical_stability.INTERVAL / step == pytest.approx(
            round(numerical_stability.INTERVAL / step), rel=1e-12
        )
    last = (numerical_stability.SAMPLES - 1) * numerical_stability.INTERVAL
    assert last == pytest.approx(2.0, abs=1e-3)  # the paper's 2 s


def test_a_drop_is_from_its_height_changed_by_a_share():
    plan = numerical_stability.DropPlan(0.02)
    assert numerical_stability.drop_of(plan).height == 0.02
    assert numerical_stability.drop_of(plan, 0.01).height == pytest.approx(0.0202, rel=1e-14)


def with_differences(ds, difference):
    """fig12's findings where the differences of all rules are these, over the nine steps."""
    nine = ds.isel(step=np.flatnonzero(ds.of_nine.values)).drop_dims("statement")
    for name in ("difference", "difference_exact"):
        nine[name] = (nine[name].dims, np.broadcast_to(difference, nine[name].shape).copy())
    return fig12.check(nine).set_index(statement="statement_key")


def test_the_check_tells_a_threshold_from_a_power(made):
    steps = np.array(numerical_stability.NINE)
    power = with_differences(made["fig12"][1], 1e-8 * (steps / 1e-6) ** 2)
    threshold = with_differences(made["fig12"][1], np.where(steps <= 3.3e-6, 1e-8 * (steps / 1e-6) ** 0.5, 1e-4))
    assert int(power.statement_holds.sel(statement="fig12.lost")) == DOES_NOT
    assert int(threshold.statement_holds.sel(statement="fig12.lost")) == HOLDS
    # All rules are as far off at each step, so the largest step that is as good as the one at 2.0e-6 s is that one.
    assert float(power.statement_number.sel(statement="fig12.larger")) == pytest.approx(1.0)


def test_displacement_of_the_top_is_that_of_the_corner_it_leans_on():
    released = Released(specimen(1), 0.5, 2.0)
    e = released.block.housner_restitution
    run = solve(Method1(released.block, restitution=e), theta=released.tilt, t_end=2.0, save_at=released.times)
    b, h = released.block.b, released.block.h
    s = np.where(run.theta >= 0.0, 1.0, -1.0)
    # From the carrying corner at s b/2, the middle of the top is at (-s b/2, h) before it turns, clockwise positive.
    expected = 0.5 * s * b - 0.5 * s * b * np.cos(run.theta) + h * np.sin(run.theta)
    assert released.method1(e) == pytest.approx(expected, abs=1e-12)
    # Distinct elements start from the same place, but for what the weight presses their corner in.
    assert released.elements(1e4, STIFFNESS)[0] == pytest.approx(expected[0], abs=1e-4)


def test_the_fit_finds_a_dashpot_that_was_planted():
    released = Released(specimen(1), 0.4, 2.0)
    planted = released.dashpot(0.1, STIFFNESS)
    found = fitted(released, released.elements(planted, STIFFNESS), np.geomspace(0.02, 1.0, 12).tolist(), STIFFNESS)
    assert found.damping == pytest.approx(planted, rel=0.01) and found.misfit < 2e-3


# The misfit is a parabola in the logarithm of the ratio, whose bottom lies on either side of the nearest ratio tried.
@pytest.mark.parametrize("planted", [0.08, 0.13])
def test_the_fit_is_finer_than_the_ratios_that_are_tried(monkeypatch, planted):
    monkeypatch.setattr(fig05_fit, "misfit", lambda released, target, ratio, k: 0.01 + np.log(ratio / planted) ** 2)
    released = Released(specimen(1), 0.4, 2.0)
    found = fitted(released, np.zeros(3), [0.05, 0.1, 0.2], STIFFNESS)
    assert found.damping == pytest.approx(released.dashpot(planted, STIFFNESS), rel=1e-3)
    assert found.misfit == pytest.approx(0.01, abs=1e-6)


def test_the_closest_curve_and_the_loss_of_energy_ask_for_the_same_dashpot():
    # Two criteria of one thing: the history of the top over 3 s, and the energy after four swings.
    released = Released(specimen(1), 0.4, 3.0)
    e = released.block.housner_restitution
    by_energy = fit_dashpot(specimen(1), e, kn=STIFFNESS, ks=STIFFNESS)
    target = released.method1(e)
    best = fitted(released, target, np.geomspace(0.1, 1.5, 10).tolist(), STIFFNESS)
    assert best.damping == pytest.approx(by_energy.damping, rel=0.25)
    assert misfit(released, target, by_energy.damping_ratio, STIFFNESS) < 0.03


def test_too_few_swings_have_no_frequency():
    released = Released(specimen(1), 0.4, 0.5)
    row = fig05_fit.measured(released.run(1e4, STIFFNESS), released.elements(1e4, STIFFNESS), released)
    assert np.isnan(row.frequency) and np.isnan(row.peak) and row.change == 0.0


def test_swings_are_counted_from_the_release_and_the_peak_is_the_fourth_s():
    # Half swings of a sine of 2 Hz from its crest, each 0.8 times as large as the one before.
    time = np.linspace(0.0, 2.0, 20001)
    phase = 4.0 * np.pi * time + 0.5 * np.pi
    history = SimpleNamespace(time=time, theta=0.1 * 0.8 ** np.floor(phase / np.pi) * np.sin(phase))
    released = SimpleNamespace(top=lambda history: np.array([3e-3, 4e-3]))
    row = fig05_fit.measured(history, np.zeros(2), released)
    assert row.frequency == pytest.approx(2.0, rel=1e-6)
    assert row.peak == pytest.approx(0.1 * 0.8**3, rel=1e-6)
    assert row.change == pytest.approx(5e-3 / np.sqrt(2.0))


def test_before_the_first_impact_nothing_depends_on_stiffness_or_damping():
    released = Released(specimen(1), 0.6, 0.4)
    curves = [released.elements(c, k) for c, k in ((1e3, STIFFNESS), (1e5, STIFFNESS), (1e4, 4.0 * STIFFNESS))]
    for curve in curves:
        assert curve == pytest.approx(curves[0], abs=2e-4)  # the weight presses the corner in by up to 0.1 mm
    assert dem.eq7_step(1.0, 1.0) == 2.0


@pytest.mark.parametrize(
    ("name", "arguments", "message"),
    [
        ("fig12", ["--height", "0"], "--height 0: want a number above 0"),
        ("fig11", ["--height", "500"], "--height 500: want at most 100 mm"),
        ("fig05", ["--restitution", "1.2"], "--restitution 1.2: want more than 0, less than 1"),
        ("fig05", ["--release", "1"], "--release 1: want more than 0, less than 1"),
    ],
)
def test_bad_options_are_one_sentence(name, arguments, message, tmp_path):
    from studies.running.files import BadInputError

    with pytest.raises(BadInputError, match=message):
        make(importlib.import_module(f"studies.{name}").STUDY, [*arguments, "--out", str(tmp_path)])
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("best", [0.1, 0.4])
def test_a_fit_may_end_at_either_end_of_the_ratios_that_are_tried(best):
    """A stub whose curve comes the closer, the nearer the logarithm of the dashpot is."""
    stub = SimpleNamespace(
        dashpot=lambda ratio, stiffness: ratio * stiffness,
        elements=lambda dashpot, stiffness: np.full(5, 1.0 + abs(np.log(dashpot / stiffness / best))),
    )
    found = fitted(stub, np.ones(5), (0.1, 0.2, 0.4), 3.0)
    assert found.damping == pytest.approx(3.0 * best, rel=1e-9) and found.misfit == pytest.approx(0.0, abs=1e-12)


def test_a_share_of_critical_damping_is_that_of_the_whole_block_on_one_spring():
    """c = 2 xi sqrt(k m), by hand for 4 kg on 100 N/m."""
    released = Released(Block(0.1, 0.4, 0.2, density=500.0), 0.4, 2.0)
    assert released.block.mass == pytest.approx(4.0, rel=1e-12)
    assert released.dashpot(0.3, 100.0) == pytest.approx(12.0, rel=1e-12)
