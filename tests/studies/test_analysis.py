"""Datasets in the hands of users: opened, interpolated, compared, and on a page."""

import math

import numpy as np
import pytest
import xarray as xr

import dem
import studies
from studies.compare import compared
from studies.compare import main as compare
from studies.criteria.overturning import Settings, overturning
from studies.families.onset import OnsetPlan
from studies.running.files import BadInputError, DatasetError, save_dataset, save_figure
from studies.running.index_page import write_index
from studies.running.study import Study
from studies.specimens import specimen


def dataset(factor=1.0, frequencies=(1.0, 2.0, 3.0)):
    f = np.array(frequencies)
    a = {"units": "m s-2", "long_name": "amplitude"}
    ds = xr.Dataset(
        {"amplitude": ("frequency", factor * np.exp(f), a)}, {"frequency": ("frequency", f, {"units": "Hz"})}
    )
    return ds.assign(note=("frequency", ["fell"] * f.size)).assign_attrs(commit="a", settings="s")


def test_open_finds_files_and_makes_units_plot_well(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "build" / "studies").mkdir(parents=True)
    save_dataset(dataset(), tmp_path / "build" / "studies" / "x.nc")
    assert studies.open("x.nc").amplitude.attrs["units"] == "m/s²"
    assert studies.open("x.nc", cf_units=True).amplitude.attrs["units"] == "m s-2"
    with pytest.raises(FileNotFoundError, match=r"y.nc: neither there nor in build/studies"):
        studies.open("y.nc")


def test_runs_of_distinct_elements_have_the_units_of_the_rest(tmp_path):
    """CF conventions, section 3.1: UDUNITS, which knows both; one spelling in all files, that of `rocking`."""
    scene = dem.single_block(0.15, 0.5, 0.25, 597.0)
    one = dem.simulate(scene, t_end=0.001, mu=0.5, damping_ratio=0.2).to_xarray()
    column = dem.simulate_assembly(
        dem.column(2, 0.15, 0.5, 0.25, 597.0), t_end=0.001, contact=dem.Contact(0.5, damping=1.0)
    )
    for ds in (one, column.to_xarray()):
        assert not [v.attrs["units"] for v in ds.variables.values() if "/" in v.attrs.get("units", "")]
        assert ds.omega.attrs["units"] == "rad s-1"
    save_dataset(one, tmp_path / "run.nc")
    older = one.assign(base_ax=one.base_ax.assign_attrs(units="m/s^2"))
    save_dataset(older, tmp_path / "older.nc")
    for name in ("run", "older"):
        assert studies.open(tmp_path / f"{name}.nc").base_ax.attrs["units"] == "m/s²"


def test_criteria_are_interpolated_in_their_logarithm_and_nowhere_else():
    a = dataset().amplitude
    found = studies.interpolated(a, frequency=[1.5, 2.7, 3.5])
    assert found.values[:2] == pytest.approx(np.exp([1.5, 2.7]))
    assert math.isnan(found.values[2])
    assert found.attrs["units"] == "m s-2"
    gap = a.copy(data=[1.0, np.nan, 3.0])
    assert np.isnan(studies.interpolated(gap, frequency=[1.5, 2.5])).all()
    with pytest.raises(ValueError, match="period: want a dimension with numbers, one of frequency"):
        studies.interpolated(a, period=1.0)
    with pytest.raises(ValueError, match="criterion: want positive values"):
        studies.interpolated(a - 10.0, frequency=1.5)


def test_interpolated_criterion_is_near_a_computed_one():
    # Where a block falls at once the criterion is smooth in frequency: a quarter of a hertz off, within 5 %.
    settings = Settings(ramp=20.0, duration=60.0)
    f = np.array([0.5, 0.75, 1.0])
    a = [overturning("method1", specimen(1), x, settings).amplitude for x in f]
    curve = xr.DataArray([a[0], a[2]], {"frequency": f[[0, 2]]}, ["frequency"])
    assert float(studies.interpolated(curve, frequency=0.75)[0]) == pytest.approx(a[1], rel=0.05)


def saved(tmp_path, **datasets):
    for name, ds in datasets.items():
        save_dataset(ds, tmp_path / f"{name}.nc")
    return [str(tmp_path / f"{name}.nc") for name in datasets]


def test_equal_datasets_have_not_moved(tmp_path, capsys):
    compare(saved(tmp_path, a=dataset(), b=dataset().assign_attrs(commit="b")))
    assert "amplitude: 3 values, none moved" in capsys.readouterr().out


def test_what_moved_is_named_with_size_and_place(tmp_path, capsys):
    other = dataset(1.001).assign_attrs(settings="t")
    other["amplitude"][1] = 9.0
    with pytest.raises(SystemExit) as left:
        compare(saved(tmp_path, a=dataset(), b=other))
    assert left.value.code == 1
    said = capsys.readouterr().out
    assert "attribute settings: s -> t" in said
    assert "amplitude: 3 of 3 values moved, by up to 0.218" in said
    assert "at frequency=2.0: 7.38906 -> 9" in said


def test_tolerance_gaps_texts_and_other_axes():
    rows, _ = compared(dataset(), dataset(1.001), rtol=0.01)
    assert all(row.moved == 0 for row in rows)
    gone = dataset()
    gone["amplitude"][0] = np.nan
    gone["note"] = ("frequency", ["stands", "fell", "fell"])
    rows, _ = compared(dataset(), gone)
    by_name = {row.name: row for row in rows}
    assert by_name["amplitude"].moved == 1 and "known in one alone" in by_name["amplitude"].note
    assert by_name["note"].note == "fell -> stands"
    rows, notes = compared(dataset(), dataset(frequencies=(1.0, 2.0, 4.0)))
    assert "frequency: 2 values in both of 3 and 3" in notes
    rows, notes = compared(dataset(frequencies=(1.1, 1.2)), dataset(frequencies=(1.0, 1.15, 1.3)))
    assert "B is interpolated to 2 points of A" in notes[0]
    assert rows[0].name == "amplitude" and rows[0].relative < 0.02


@pytest.mark.parametrize("one", [("a", "b"), (1.0, 2.0)])
def test_datasets_without_a_point_in_common_are_not_called_equal(tmp_path, one):
    other = ("c", "d") if one[0] == "a" else (3.0, 4.0)
    a, b = (xr.Dataset({"x": ("case", [1.0, 2.0])}, {"case": list(names)}) for names in (one, other))
    with pytest.raises(DatasetError, match=f"^case: {one[0]} to {one[1]} of A and {other[0]} to {other[1]} of B; want"):
        compare(saved(tmp_path, a=a, b=b))


def test_a_variable_that_is_lost_moves_and_one_that_is_new_does_not(tmp_path, capsys):
    less = dataset().drop_vars("note")
    with pytest.raises(SystemExit) as left:
        compare(saved(tmp_path, a=dataset(), b=less))
    assert left.value.code == 1
    assert "in A alone: note" in capsys.readouterr().out
    compare(saved(tmp_path, a=less, b=dataset()))
    with pytest.raises(SystemExit):
        compare(saved(tmp_path, a=xr.Dataset({"x": ("t", [])}), b=xr.Dataset({"x": ("t", [])})))


def test_infinities_coordinates_and_units_move_too(tmp_path):
    endless, wide = dataset(), dataset()
    endless["amplitude"][0] = np.inf
    for a, b in ((endless, dataset()), (dataset(), endless)):
        row = next(row for row in compared(a, b)[0] if row.name == "amplitude")
        assert row.moved == 1 and row.where == "frequency=1.0"
    assert not any(row.moved for row in compared(endless, endless)[0])
    rows, _ = compared(dataset().assign_coords(alpha=0.3), wide.assign_coords(alpha=0.9))
    assert [(row.name, row.moved) for row in rows if row.moved] == [("alpha", 1)]
    wide["amplitude"].attrs["units"] = "1"
    assert compared(dataset(), wide)[1] == ["units of amplitude: m s-2 -> 1"]
    with pytest.raises(SystemExit):
        compare(saved(tmp_path, a=dataset(), b=wide))


def test_compare_refuses_what_is_no_dataset(tmp_path):
    (tmp_path / "x.nc").write_text("none")
    with pytest.raises(BadInputError, match=r"x.nc: want a NetCDF dataset"):
        compare([str(tmp_path / "x.nc"), str(tmp_path / "x.nc")])


def test_page_escapes_what_it_shows_and_leaves_out_what_is_not_there(tmp_path):
    from studies.running.plot import caption, new_figure

    fig = new_figure(4.0, 3.0)
    caption(fig, "a < b & <script>alert(1)</script>")
    save_figure(fig, tmp_path, "odd")
    ds = dataset().assign_attrs(command="<b>x</b>", source="s")
    save_dataset(ds, tmp_path / "odd.nc")

    def study(name):
        return Study(name, f"{name} <i>", "about &", OnsetPlan, lambda p, q: ds, {name: lambda d: fig}, lambda d: ds)

    page = write_index(tmp_path, {"odd": study("odd"), "absent": study("absent")}).read_text()
    assert "<script>" not in page and "<b>x" not in page and "<i>" not in page
    assert "a &lt; b &amp; &lt;script&gt;" in page
    assert 'src="odd.png"' in page and "absent" not in page
