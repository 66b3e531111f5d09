"""Every study, quick: files, CF, captions, examples, statements; and what is there is not computed again."""

import json
import runpy
import sys
from pathlib import Path

import matplotlib
import pytest
import xarray as xr
from PIL import Image

import studies
from studies.__main__ import main as listing
from studies.claims.bounds import CLAIMS
from studies.running.files import BadInputError
from studies.running.registry import HERE, modules
from studies.running.registry import studies as registered
from studies.running.study import make, parser_of

sys.path.insert(0, str(Path(__file__).parent))
from cf import by_checker, problems

STUDIES = registered()
# fig16 has its own tests, from the command line; loop_fig16 closes a loop; the others take some ten seconds each.
SLOW = {"contact_judgement", "fig02", "fig03", "fig14", "fig15", "fig16", "loop_fig16", "springs", "tombstones"}


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("studies")


@pytest.fixture(scope="session")
def made(folder):
    """Make a study once, when a test asks for it first."""
    done = {}

    def once(name):
        if name not in done:
            done[name] = make(STUDIES[name], ["--quick", "--out", str(folder), "--workers", "2"])
        return done[name]

    return once


def quick(names):
    return [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in names]


def test_every_module_that_declares_a_study_is_found_and_named_after_it():
    for name in modules():
        assert STUDIES[name.rpartition(".")[2]].name == name.rpartition(".")[2]
    figures = {"fig02", "fig03", "fig14", "fig15", "fig16", "fig17", "fig18", "fig19", "fig20", "fig22", "fig23"}
    assert figures <= set(STUDIES)


@pytest.mark.parametrize("name", quick(STUDIES))
def test_quick_study_writes_files_that_keep_cf_and_pictures_with_captions(name, made, folder):
    written = made(name)
    assert (folder / f"{name}.nc") in written
    assert problems(folder / f"{name}.nc") == []
    with xr.open_dataset(folder / f"{name}.nc") as ds:
        for attribute in ("commit", "command", "inputs", "study"):
            assert ds.attrs[attribute]
        assert ds.attrs["title"] == STUDIES[name].title  # not that of a run in it
        json.loads(ds.attrs["settings"], parse_constant=lambda word: pytest.fail(f"settings: {word} is no JSON"))
    pictures = [path for path in written if path.suffix == ".png"]
    assert pictures
    for path in pictures:
        assert path.with_suffix(".pdf") in written
        with Image.open(path) as image:
            assert len(image.info["Description"]) > 60
            assert min(image.size) > 300


@pytest.mark.parametrize("name", quick(STUDIES))
def test_quick_study_passes_the_compliance_checker_of_ioos(name, made, folder):
    pytest.importorskip("compliance_checker", reason="want compliance-checker, of the extra test")
    made(name)
    assert by_checker(folder / f"{name}.nc") == []


@pytest.mark.parametrize("name", STUDIES)
def test_coordinates_of_the_full_study_ascend(name):
    # CF 1.11, section 5: quick studies have one value of some of them, and would not tell.
    plan = STUDIES[name].plan(parser_of(STUDIES[name]).parse_args([]))
    axes = {axis: getattr(plan, axis) for axis in ("tiny", "frequencies", "gaps") if hasattr(plan, axis)}
    assert {axis: values for axis, values in axes.items() if list(values) != sorted(set(values))} == {}


@pytest.mark.parametrize("name", quick(STUDIES))
def test_statements_are_checked_against_bounds_written_down_beforehand(name, made, folder):
    made(name)
    study = STUDIES[name]
    with xr.open_dataset(folder / f"{name}.nc") as opened:
        ds = opened.load()
    found = study.check(ds)
    for i in range(found.sizes.get("statement", 0)):
        row = found.isel(statement=i)
        key = str(row.statement_key.item())
        assert key.partition(".")[0] == name
        if key in CLAIMS:
            assert int(row.statement_holds) == CLAIMS[key].verdict(float(row.statement_number))
            assert row.statement_bound.item() == CLAIMS[key].decides


@pytest.mark.parametrize("name", quick(STUDIES))
def test_example_of_a_dataset_runs(name, made, folder):
    made(name)
    assert STUDIES[name].example
    matplotlib.use("agg")
    from matplotlib import pyplot

    ds = studies.open(folder / f"{name}.nc")
    exec(STUDIES[name].example, {"ds": ds, "studies": studies})
    pyplot.close("all")


@pytest.mark.parametrize(
    ("given", "option"),
    [
        ("--only fig18", "--only fig18"),
        ("list --quick", "--quick"),
        ("--workers 2", "--workers 2"),
        ("--out x", "--out x"),
    ],
)
def test_the_list_of_studies_refuses_options_that_it_would_drop(given, option):
    with pytest.raises(BadInputError, match=f"^{option}: want it with the word `all`"):
        listing(given.split())


def test_the_name_of_a_study_is_told_its_command():
    with pytest.raises(BadInputError, match=r"^'fig18': want all or list; one .* with `python -m studies.fig18`"):
        listing(["fig18"])


@pytest.mark.parametrize("name", ["fig18"])
def test_what_is_there_with_the_same_settings_is_not_computed_again(name, made, folder, capsys, monkeypatch):
    made(name)
    before = (folder / f"{name}.nc").stat().st_mtime_ns
    capsys.readouterr()
    make(STUDIES[name], ["--quick", "--out", str(folder)])
    assert "is there already" in capsys.readouterr().out
    assert (folder / f"{name}.nc").stat().st_mtime_ns == before
    # Computed anew, the finished runs are taken from where they were kept.
    from studies.families import columns as columns_figures

    monkeypatch.setattr(columns_figures, "criterion", columns_figures.criterion)
    make(STUDIES[name], ["--quick", "--out", str(folder), "--again"])
    assert "is there already" not in capsys.readouterr().out
    with xr.open_dataset(folder / f"{name}.nc") as ds:
        assert ds.overturning_amplitude.size


@pytest.mark.parametrize("name", ["fig14", "fig18", "fig17", "fig02"])
def test_bad_options_are_one_sentence_before_any_work(name, tmp_path):
    from studies.running.files import BadInputError

    for option in ("--friction", "--ramp"):
        if name == "fig02" and option == "--ramp":
            continue
        with pytest.raises(BadInputError, match=f"{option} -1: want a number"):
            make(STUDIES[name], [option, "-1", "--out", str(tmp_path / "none")])
    with pytest.raises(BadInputError, match="--workers 0: want 1 or more"):
        make(STUDIES[name], ["--workers", "0", "--out", str(tmp_path / "none")])
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize("name", ["fig02", "fig20"])
def test_help_says_what_it_is_for(name, capsys, monkeypatch):
    monkeypatch.setattr(sys, "argv", [f"studies.{name}", "--help"])
    with pytest.raises(SystemExit) as left:
        runpy.run_path(str(HERE / f"{name}.py"), run_name="__main__")
    assert left.value.code == 0
    said = capsys.readouterr().out
    for word in ("--quick", "--out", "--again", f"{name}.nc"):
        assert word in said
