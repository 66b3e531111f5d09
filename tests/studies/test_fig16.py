"""Fig. 16 from the command line to the pictures."""

import json
import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from rocking.effects.base_motion_gain import BaseMotionGain
from rocking.effects.rounded_edges import RoundedEdges
from rocking.effects.sliding import Sliding
from studies import fig16
from studies.criteria.overturning import Settings
from studies.fig16.drawing import figure, sensitivity_figure
from studies.fig16.statements import check
from studies.running.study import parser_of, settings_of
from studies.specimens import specimen


def command(*arguments, cwd=None):
    return subprocess.run(
        [sys.executable, "-m", "studies.fig16", *map(str, arguments)], capture_output=True, text=True, cwd=cwd
    )


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fig16")
    done = command("--quick", "--out", folder)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(folder / "fig16.nc") as ds:
        yield folder, done.stdout, ds.load()


def test_quick_run_writes_dataset_and_pictures_and_says_so(quick):
    folder, said, _ = quick
    names = ["fig16.nc", "fig16.pdf", "fig16.png", "fig16_sensitivity.pdf", "fig16_sensitivity.png"]
    assert sorted(path.name for path in folder.iterdir() if not path.name.startswith(".")) == names
    assert all(name in said for name in names)
    for method in ("Method 1", "Method 2", "DEM"):
        assert any(line.startswith(method) and line.endswith(" s") for line in said.splitlines())


def test_dataset_has_dims_units_and_origin(quick):
    _, _, ds = quick
    assert ds.overturning_amplitude.dims == ("method", "block", "frequency")
    assert ds.mode_fraction.dims == ("method", "block", "frequency", "mode")
    assert ds.overturning_amplitude.attrs["units"] == "m s-2"
    assert list(ds.block.values) == [1, 3, 7]
    assert ds.b.values == pytest.approx([0.30, 0.15, 0.10])
    assert all("long_name" in variable.attrs for variable in ds.variables.values())
    # The unit of a statement's number stands beside it, in statement_units.
    numeric = [v for name, v in ds.data_vars.items() if v.dtype.kind == "f" and name != "statement_number"]
    assert all("units" in v.attrs for v in numeric)
    for name in ("commit", "source", "command", "settings", "friction_choice", "damping_choice", "ramp_choice"):
        assert ds.attrs[name]


def test_every_gap_has_a_reason_and_every_amplitude_none(quick):
    _, _, ds = quick
    fell = ds.note == "overturned"
    assert (ds.overturning_amplitude.notnull() == fell).all()
    assert (ds.note != "").all()


@pytest.mark.parametrize("name", ["mode_fraction", "mode_fraction_late"])
def test_shares_of_time_sum_to_one(quick, name):
    _, _, ds = quick
    assert ds[name].sum("mode").where(ds.overturning_amplitude.notnull()).values == pytest.approx(
        np.ones(ds.overturning_amplitude.shape), nan_ok=True
    )


def test_no_method_overturns_below_west(quick):
    # Eq. (1) of the paper: rocking cannot begin before the acceleration passes (b/h) g.
    _, _, ds = quick
    assert (ds.overturning_amplitude > ds.b / ds.h * 9.80665).all()


def test_figures_draw_what_is_in_the_file(quick):
    _, _, ds = quick
    fig = figure(ds)
    drawn = fig.axes[1].get_lines()[2].get_ydata()
    assert drawn == pytest.approx(ds.overturning_amplitude.sel({"method": "dem", "block": 3}).values / 9.80665)
    assert "Frequency" in fig.axes[-1].get_xlabel()
    assert len(sensitivity_figure(ds).axes) == 12


def test_check_counts_what_it_says(quick):
    """Each number recomputed from a table made by hand."""
    frequency = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    curves = np.stack([2.0 * frequency, np.full(5, 4.0), np.full(5, 2.0)])[:, None, :]
    fractions = np.zeros((3, 1, 5, 6))
    fractions[..., 0], fractions[..., 3], fractions[..., 2] = 0.5, 0.3, 0.2
    ds = xr.Dataset(
        {
            "overturning_amplitude": (("method", "block", "frequency"), curves),
            "overturning_time": (("method", "block", "frequency"), curves / 0.1),
            "mode_fraction_late": (("method", "block", "frequency", "mode"), fractions),
        },
        coords={
            "method": ["method1", "method2", "dem"],
            "block": [3],
            "frequency": frequency,
            "mode": quick[2].mode.values,
            "b": ("block", [0.15]),
            "h": ("block", [0.50]),
        },
    )
    found = check(ds)
    numbers = dict(zip(found.statement.values, found.statement_number.values, strict=True))
    by_hand = {
        "Method 1 grows almost linearly with frequency": 1.0,
        # |log(4/2)| over the mean of |log(8/2)| and |log(10/2)| at 4 and 5 Hz: 0.46, at most the bound of 0.5.
        "Method 2 and DEM are alike and far from Method 1 beyond 3 Hz": np.log(2) / np.log([4, 5]).mean(),
        "Method 2 and DEM differ most beyond 3 Hz": 1.0,
        "Method 2: at large amplitude (from 3 Hz on) the motion is mostly sliding rotation": 0.3,
        "DEM: at large amplitude (from 3 Hz on) the motion is mostly sliding rotation": 0.3,
        # The ramp grows by 0.1 m/s^2 a second; at 1 Hz Method 2 falls at 4 m/s^2, West's threshold is 2.942.
        "At the lowest frequency blocks overturn as rocking would begin": (4.0 - 0.3 * 9.80665) / 0.1,
    }
    assert numbers == pytest.approx(by_hand, rel=1e-9)
    assert found.statement_holds.values.tolist() == [1, 1, 0, 0, 0, 0]


def test_same_plan_gives_the_same_numbers(quick):
    _, _, ds = quick
    arguments = parser_of(fig16.STUDY).parse_args(["--quick", "--no-sensitivity", "--methods", "method2", "dem"])
    again = fig16.dataset(fig16.plan_of(arguments))
    assert np.array_equal(again.overturning_amplitude, ds.overturning_amplitude.sel({"method": ["method2", "dem"]}))


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--blocks", "9"], "--blocks 9: want one of 1, 2, 3, 4, 5, 6, 7"),
        (["--blocks", "one"], "--blocks one: want one of 1, 2, 3, 4, 5, 6, 7"),
        (["--methods", "method3"], "--methods method3: want one of method1, method2, dem"),
        (["--solver", "euler"], "--solver euler: want one of diffrax, exact, numba, scipy, taylor"),
        (["--friction", "-0.1"], "--friction -0.1: want a number of 0 or more"),
        (["--friction", "nan"], "--friction nan: want a number of 0 or more"),
        (["--friction", "1.5"], "--friction 1.5: want below 4/3 with Method 2 (a corner may jam)"),
        (["--restitution", "1.1"], "--restitution 1.1: want 0 to 1"),
        (["--restitution", "nan"], "--restitution nan: want 0 to 1"),
        (["--ramp", "0"], "--ramp 0: want a number above 0"),
        (["--ramp", "inf"], "--ramp inf: want a number above 0"),
    ],
)
def test_bad_option_is_one_sentence_before_any_work(arguments, sentence, tmp_path, capsys):
    with pytest.raises(fig16.BadInputError) as refusal:
        fig16.main([*arguments, "--out", str(tmp_path / "out")])
    assert str(refusal.value) == sentence
    assert not (tmp_path / "out").exists()


def test_bad_option_exits_with_status_2_and_no_traceback(tmp_path):
    done = command("--blocks", "9", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "error: --blocks 9: want one of 1, 2, 3, 4, 5, 6, 7\n"
    assert list(tmp_path.iterdir()) == []


def test_out_that_is_a_file_is_refused_before_any_work(tmp_path):
    (tmp_path / "file").write_text("mine")
    done = command("--out", tmp_path / "file" / "deeper")
    assert done.returncode == 2
    assert (
        done.stderr
        == f"error: --out {tmp_path / 'file' / 'deeper'}: want a folder that can be written to (Not a directory)\n"
    )
    assert (tmp_path / "file").read_text() == "mine"


def test_help_says_what_it_is_for_and_names_every_option():
    said = command("--help").stdout
    for word in (
        "Winkler",
        "--methods",
        "--solver",
        "--blocks",
        "--friction",
        "--restitution",
        "--ramp",
        "--quick",
        "--out",
    ):
        assert word in said


def test_run_that_does_not_overturn_is_named(tmp_path):
    done = command(
        "--quick", "--no-sensitivity", "--methods", "method1", "--blocks", "1", "--ramp", "0.2", "--out", tmp_path
    )
    assert done.returncode == 0, done.stderr
    assert "no amplitude: Method 1, Block 1, 1 Hz: standing at the end of the ramp, 1.961 m/s^2 (0.2 g)" in done.stdout


def test_the_dataset_says_which_equations_and_restitution_its_runs_had():
    """Effects are added to the nonlinear equations (`rocking.effects`).  Worn edges let a block stand on b - 2 r:
    angular momentum about the edge that lands gives e = (rho^2 + H^2 - a^2) / (rho^2 + H^2 + a^2), with a = b/2 - r and
    H = h/2."""
    few = fig16.Plan(methods=("method1",), blocks=(3,), frequencies=(1.0,), variations=())
    plain = fig16.dataset(few).attrs
    assert plain["method1_choice"].startswith("linear equations (")
    assert plain["restitution_choice"].startswith("Housner's 1 - 1.5 sin^2(alpha) for Methods 1 and 2;")
    worn = fig16.dataset(replace(few, settings=replace(few.settings, effects=(RoundedEdges(radius=0.02),)))).attrs
    assert worn["method1_choice"].startswith("nonlinear equations, which effects on the block ask for (")
    block = specimen(3)
    about, a = (block.b**2 + block.h**2) / 12.0 + 0.25 * block.h**2, 0.5 * block.b - 0.02
    assert f": Block 3 {(about - a * a) / (about + a * a):.4g};" in worn["restitution_choice"]
    assert "Housner" not in worn["restitution_choice"]


@pytest.mark.parametrize("name", ["restitution", "normal_restitution", "impact_law"])
def test_a_restitution_that_method_2_does_not_have_is_not_said_of_it(name):
    few = fig16.Plan(methods=("method1",), blocks=(3,), frequencies=(1.0,), variations=())
    changed = {"restitution": 0.9, "normal_restitution": 0.3, "impact_law": "kinematic"}[name]
    said = fig16.dataset(replace(few, settings=replace(few.settings, **{name: changed}))).attrs["restitution_choice"]
    assert said.startswith(
        "0.9 for Methods 1 and 2;" if name == "restitution" else "Housner's 1 - 1.5 sin^2(alpha) for Method 1 (that of"
    )


def _few(**settings):
    plan = fig16.Plan(methods=("method1", "method2"), blocks=(3,), frequencies=(1.0,), variations=())
    return fig16.dataset(replace(plan, settings=replace(plan.settings, **settings)))


def test_a_gap_is_explained_by_its_own_reason(quick):
    said = " ".join(figure(quick[2]).get_supxlabel().split())
    assert "Notice: Method 1, which only rocks," in said and said.endswith(
        "A gap means no overturning within the ramp."
    )
    ds = _few(effects=(Sliding(friction=0.5),))
    assert ds.note.values.ravel()[1].startswith("declined: sliding:")
    said = " ".join(figure(ds).get_supxlabel().split())
    assert said.endswith("A gap means no overturning within the ramp, or no run: 1 declined (see `note`).")
    assert "With sliding. Notice whether" in said and "only rocks" not in said


def test_where_the_base_is_another_than_asked_for_the_criterion_is_that_of_the_command():
    """A gain of 0.2: a command five times as large moves the block as the plain base does; West's (b/h) g is passed
    by the base, of which the file has no envelope."""
    plain = _few()
    weak = _few(effects=(BaseMotionGain(gain=0.2),), ramp=5.0 * Settings().ramp)
    name = "overturning_amplitude"
    assert weak[name].values == pytest.approx(5.0 * plain[name].values, rel=1e-6)
    assert plain[name].attrs["long_name"] == "envelope of the base acceleration at overturning"
    assert weak[name].attrs["long_name"] == "envelope of the commanded base acceleration at overturning"
    labels = [figure(ds).axes[0].get_ylabel() for ds in (plain, weak)]
    assert labels == [f"Envelope of {word} acceleration\nat overturning [g]" for word in ("base", "commanded")]

    def periods(ds):
        return dict(zip(*(check(ds)[f"statement_{part}"].values for part in ("key", "number")), strict=True))[
            "fig16.at_once"
        ]

    assert np.isfinite(periods(plain)) and np.isnan(periods(weak))
    lossy = plain.assign_attrs({"settings": json.dumps({"effects": {"velocity_dependent_restitution": {}}})})
    assert periods(lossy) == periods(plain)  # which bears on impacts alone


@pytest.mark.parametrize("name", ["rotation_gain.gain=2", "rotation_offset.offset=0.01"])
def test_effects_that_have_no_say_here_are_refused(name):
    parser = parser_of(fig16.STUDY)
    with pytest.raises(fig16.BadInputError, match="acts on a rotation sensor alone; want one on block or base"):
        fig16.plan_of(parser.parse_args(["--effect", name]))
    twice = ["--effect", "rounded_edges.radius=0.003", "--effect", "rounded_edges.radius=0.004"]
    with pytest.raises(fig16.BadInputError, match=r"^--effect: .*rounded_edges\.radius is given twice, want it once"):
        fig16.plan_of(parser.parse_args(twice))


def test_settings_are_json_for_every_reader():
    def refused(word):
        raise ValueError(f"{word} is no JSON")

    settings = json.loads(_few().attrs["settings"], parse_constant=refused)
    assert settings["damping"] is None  # not given: distinct elements alone have one
    assert json.loads(settings_of({"a": [math.nan, math.inf, 1.0]}), parse_constant=refused) == {
        "a": [None, "inf", 1.0]
    }
