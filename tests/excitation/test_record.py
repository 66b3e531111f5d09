"""Records: integrals against closed forms, and round trips through every format that is written."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import excitation as ex
from excitation.formats import WRITERS

several = settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
records = st.builds(
    lambda size, step, amplitude, seed: ex.Record(
        step, amplitude * np.random.default_rng(seed).normal(size=size), component="E-W", azimuth_deg=90.0
    ),
    st.integers(2, 40),
    st.sampled_from([0.005, 0.01, 0.02, 1 / 128, 1 / 60, 0.0333]),
    st.sampled_from([1e-5, 1.0, 30.0]),
    st.integers(0, 10**6),
)
# Of the largest sample: seven digits, nine, eight, all.
DIGITS = {"peer": 1e-7, "dyna": 1e-8, "smc": 1e-7, "columns": 0.0}


@pytest.mark.parametrize("format", WRITERS)
@several
@given(record=records)
def test_what_is_written_is_read_again(tmp_path, format, record):
    path = tmp_path / "record"
    ex.write(path, record, format)
    (again,) = ex.read(path)
    assert again.format == format
    peak = np.max(np.abs(record.acceleration))
    # The peak check of the readers and SMC's one-digit exponent leave at least 1e-11 m/s^2.
    assert again.acceleration == pytest.approx(record.acceleration, rel=1e-15, abs=DIGITS[format] * peak + 1e-11)
    assert again.time_step == pytest.approx(record.time_step, rel=1e-7)
    assert (again.vertical, again.azimuth_deg) == (False, 90.0)


@pytest.mark.parametrize("format", WRITERS)
def test_a_vertical_record_stays_vertical(tmp_path, format):
    record = ex.Record(0.01, [0.1, 0.3, -0.2], component="" if format == "dyna" else "UP", vertical=True)
    ex.write(tmp_path / "record", record, format)
    (again,) = ex.read(tmp_path / "record")
    assert again.vertical and again.azimuth_deg is None


def test_columns_hold_several_records_to_the_last_bit(tmp_path):
    rng = np.random.default_rng(3)
    pair = [ex.Record(1 / 128, rng.normal(size=50), component=name) for name in ("N-S", "U D")]
    ex.write(tmp_path / "pair.csv", pair, "columns")
    again = ex.read(tmp_path / "pair.csv")
    assert [r.component for r in again] == ["N-S", "U_D"]
    assert all(np.array_equal(a.acceleration, b.acceleration) for a, b in zip(again, pair, strict=True))
    with pytest.raises(ValueError, match="records: have time steps"):
        ex.write(tmp_path / "x", [pair[0], ex.Record(0.01, rng.normal(size=50))], "columns")
    with pytest.raises(ValueError, match="record: 2 of them, want one, or one or more in the format columns"):
        ex.write(tmp_path / "x", pair, "peer")
    with pytest.raises(ValueError, match="record: 0 of them"):
        ex.write(tmp_path / "x", [], "columns")


@pytest.mark.parametrize("format", WRITERS)
@several
@given(record=records)
def test_writing_what_was_read_gives_the_same_bytes(tmp_path, format, record):
    """The digits of a format are kept exactly: the second file is the first."""
    first, second = tmp_path / "first", tmp_path / "second"
    ex.write(first, record, format)
    (read,) = ex.read(first)
    ex.write(second, replace(read, source=record.source), format)
    (again,) = ex.read(second)
    assert np.array_equal(again.acceleration, read.acceleration) and again.time_step == read.time_step
    if format == "columns":
        assert np.array_equal(read.acceleration, record.acceleration) and read.time_step == record.time_step
    assert second.read_bytes() == first.read_bytes()


@pytest.mark.parametrize("format", WRITERS)
@pytest.mark.parametrize(
    ("component", "azimuth", "vertical"),
    [
        ("N-S", 0.0, False), ("E-W", 90.0, False), ("", 0.0, False), ("", 67.0, False), ("HNE", 90.0, False),
        ("UP", None, True), ("", None, True), ("DOWN", None, True), ("N65E", 65.0, False), ("L", None, False),
        ("x, (y) [z]\r\nNDATA: 3", 180.0, False),
    ],
)  # fmt: skip
def test_directions_come_back_from_every_format(tmp_path, format, component, azimuth, vertical):
    """Whatever the component is called, what it means is kept: azimuth, vertical and positive upward."""
    record = ex.Record(
        0.01, [0.1, 0.3, -0.2], component=component, azimuth_deg=azimuth, vertical=vertical,
        event="E, v [e]\nNDATA: 7", station="A\rB: C", source="s\n| 5",
    )  # fmt: skip
    ex.write(tmp_path / "record", record, format)
    (again,) = ex.read(tmp_path / "record")
    assert (again.azimuth_deg, again.vertical) == (azimuth, vertical)
    assert again.acceleration == pytest.approx(record.acceleration, rel=1e-6)
    if format in ("peer", "smc"):
        assert again.event == "E, v [e] NDATA: 7"


@pytest.mark.parametrize(
    ("stated", "utc"),
    [
        ("2019-07-28T16:09:19.5", "2019-07-28T16:09:19.500000"),
        ("2019-07-28T16:09:19+03:00", "2019-07-28T13:09:19"),
        ("2019-07-28T22:09:19-05:30", "2019-07-29T03:39:19"),
        ("2019-07-28T16:09:19Z", "2019-07-28T16:09:19"),
    ],
)
def test_a_start_time_with_a_zone_is_written_in_utc(tmp_path, stated, utc):
    ex.write(tmp_path / "x", ex.Record(0.01, [0.1, 0.3], start_time=stated), "dyna")
    assert ex.read(tmp_path / "x")[0].start_time == utc


def test_a_start_time_that_is_none_is_named(tmp_path):
    record = ex.Record(0.01, [0.1, 0.3], start_time="noon")
    with pytest.raises(ValueError, match="start_time='noon': want ISO 8601"):
        ex.write(tmp_path / "x", record, "dyna")


def test_a_format_that_is_not_written_is_named(tmp_path):
    with pytest.raises(ValueError, match="format='knet': want one of peer, dyna, smc, columns"):
        ex.write(tmp_path / "x", ex.Record(0.01, [1.0, 2.0]), "knet")
    with pytest.raises(ValueError, match="acceleration: reaches 1e\\+13 cm/s\\^2, want below"):
        ex.write(tmp_path / "x", ex.Record(0.01, [1.0, 1e11]), "smc")


def test_integrals_of_a_sine_are_its_closed_forms():
    """a = sin(w t): v = (1 - cos(w t))/w, d = (t - sin(w t)/w)/w; the spline is off by (w dt)^4/384 of the peak
    (de Boor 1978) and by more at the ends."""
    w, dt = 2 * np.pi * 1.5, 0.005
    t = dt * np.arange(2001)
    record = ex.Record(dt, np.sin(w * t))
    assert record.velocity == pytest.approx((1 - np.cos(w * t)) / w, abs=2e-8)
    assert record.displacement == pytest.approx((t - np.sin(w * t) / w) / w, abs=2e-7)
    assert record.duration == pytest.approx(10.0)


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-3, 3), st.floats(-3, 3))
def test_integrals_of_a_cubic_are_exact(a, b, c, d):
    t = 0.1 * np.arange(21)
    record = ex.Record(0.1, a + b * t + c * t**2 + d * t**3)
    assert record.velocity == pytest.approx(a * t + b * t**2 / 2 + c * t**3 / 3 + d * t**4 / 4, abs=1e-9)
    expected = a * t**2 / 2 + b * t**3 / 6 + c * t**4 / 12 + d * t**5 / 20
    assert record.displacement == pytest.approx(expected, abs=1e-9)


def test_motion_of_a_record_is_its_spline_and_takes_a_vertical_one():
    rng = np.random.default_rng(1)
    x, z = (ex.Record(0.01, rng.normal(size=30), source="a", component=c) for c in "xz")
    motion = x.motion(z, start=2.0)
    assert np.array_equal(motion.a_x, x.acceleration) and np.array_equal(motion.a_z, z.acceleration)
    assert motion.start == 2.0 and "a x" in repr(motion)
    assert isinstance(x.motion(interpolation="linear"), ex.PiecewiseLinear)
    with pytest.raises(ValueError, match="interpolation='step': want one of cubic, linear"):
        x.motion(interpolation="step")
    with pytest.raises(ValueError, match="records: have 30 and 29 samples"):
        x.motion(ex.Record(0.01, rng.normal(size=29)))


def test_record_goes_to_netcdf_and_back(tmp_path):
    import xarray as xr

    record = ex.Record(
        0.005, np.random.default_rng(2).normal(size=40), component="HNE", azimuth_deg=90.0, station="XX.ABC",
        event="Somewhere", start_time="2019-07-28T16:09:19", source="a.asc", format="dyna", file_units="cm/s^2",
        sha256="00", metadata={"NDATA": "40"},
    )  # fmt: skip
    record.to_xarray().to_netcdf(tmp_path / "record.nc")
    with xr.open_dataset(tmp_path / "record.nc") as ds:
        assert {n: ds[n].attrs["units"] for n in ds.variables} == {
            "time": "s", "acceleration": "m s-2", "velocity": "m s-1", "displacement": "m",
        }  # fmt: skip
        again = ex.Record.from_xarray(ds)
    assert np.array_equal(again.acceleration, record.acceleration)
    for name in (
        "component",
        "azimuth_deg",
        "vertical",
        "station",
        "event",
        "start_time",
        "source",
        "format",
        "metadata",
    ):
        assert getattr(again, name) == getattr(record, name)
    assert again.time_step == record.time_step and again.sha256 == record.sha256
    with pytest.raises(ValueError, match="want acceleration"):
        ex.Record.from_xarray(xr.Dataset({"time": ("time", [0.0, 1.0], {"units": "s"})}))


@pytest.mark.parametrize(
    ("unit", "factor"),
    [
        ("CM/SEC/SEC", 0.01), ("cm/s^2", 0.01), ("cm/sec**2", 0.01), ("cm s-2", 0.01), ("gal", 0.01), ("G", 9.80665),
        ("m/s²", 1.0), ("mg", 0.00980665), ("g/10", 0.980665), ("in/sec2", 0.0254), ("mm/s/s", 0.001), ("m.s^-2", 1.0),
    ],
)  # fmt: skip
def test_spellings_of_units(unit, factor):
    from excitation.units import factor as found

    assert found(unit, "acceleration") == pytest.approx(factor, rel=1e-15)


def test_a_record_shows_itself_in_a_line():
    record = ex.Record(0.005, 2.5 * np.sin(np.arange(20001)), component="HNE", source="a.asc", metadata={"x": "y"})
    assert repr(record) == "Record(a.asc, HNE, 20001 samples at 0.005 s, PGA 2.5 m/s^2)"


def test_bad_records_are_refused():
    with pytest.raises(ValueError, match="acceleration: has shape"):
        ex.Record(0.01, [1.0])
    for azimuth in ("0", np.nan, -30.0, 400.0, [1.0]):
        with pytest.raises(ValueError, match=r"^azimuth_deg=.* deg: want 0 to 360"):
            ex.Record(0.01, [1.0, 2.0], azimuth_deg=azimuth)
    with pytest.raises(ValueError, match=r"time_step=0\.0 s"):
        ex.Record(0.0, [1.0, 2.0])


def turned_by(degrees: float) -> ex.Record:
    """One of two components turned to an azimuth."""
    pair = [ex.Record(0.01, np.ones(9), component=c, azimuth_deg=a) for c, a in (("N", 0.0), ("E", 90.0))]
    return ex.turned(*pair, degrees)[0]


@pytest.mark.parametrize("format", ["peer", "dyna", "columns"])
def test_an_azimuth_of_no_whole_degrees_is_read_back_as_it_was_written(tmp_path, format):
    ex.write(tmp_path / "record", turned_by(37.5), format)
    assert ex.read(tmp_path / "record")[0].azimuth_deg == 37.5


def test_smc_has_room_for_whole_degrees_alone(tmp_path):
    with pytest.raises(ValueError, match=r"azimuth_deg=37.5: want whole degrees for SMC"):
        ex.write(tmp_path / "record", turned_by(37.5), "smc")
    assert not (tmp_path / "record").exists()
    ex.write(tmp_path / "record", turned_by(38.0), "smc")
    assert ex.read(tmp_path / "record")[0].azimuth_deg == 38.0
